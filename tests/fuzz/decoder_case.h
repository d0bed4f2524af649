/**
 * @file
 * A file from anywhere for a loader of the decoder process, without the process that protects the
 * viewer: whatever the bytes, loading ends, and what is loaded keeps the promises of volume.h.
 */
#ifndef GZ_TESTS_FUZZ_DECODER_CASE_H
#define GZ_TESTS_FUZZ_DECODER_CASE_H

#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "fuzz/fuzz_folder.h"
#include "render/data/volume_import.h"

/** A loader of the decoder process. */
typedef enum gz_result decoder_loader(const struct gz_volume_file *file, const char *choice,
				      struct gz_volume *out_volume);

static char folder[64], path[128];

static void require(bool holds)
{
	if (!holds)
		abort();
}

static void remove_folder(void)
{
	unlink(path);
	rmdir(folder);
}

static void make_folder(const char *name)
{
	if (folder[0])
		return;
	fuzz_folder_make(folder);
	snprintf(path, sizeof path, "%s/%s", folder, name);
	atexit(remove_folder);
}

static void check_volume(const struct gz_volume *volume)
{
	for (int i = 0; i < 3; i++) {
		require(volume->dims[i] >= 1 && volume->dims[i] <= GZ_VOLUME_DIM_MAX);
		require(isfinite(volume->spacing[i]) && volume->spacing[i] > 0);
	}
	require(isfinite(volume->slope) && volume->slope != 0 && isfinite(volume->intercept));
	require(volume->stored_min <= volume->stored_max);
}

/** Make the bytes a file of this name, alone in its folder. */
static inline void write_decoder_case(const char *name, const uint8_t *data, size_t size)
{
	make_folder(name);
	FILE *out = fopen(path, "wb");
	require(out != NULL);
	require(fwrite(data, 1, size, out) == size);
	require(fclose(out) == 0);
}

/** Load the file. */
static inline void run_decoder_case(decoder_loader *load, const struct gz_loading *loading)
{
	struct gz_volume volume = { 0 };
	const struct gz_volume_file file = { .path = path, .loading = loading };
	if (load(&file, NULL, &volume) != GZ_OK)
		return;
	check_volume(&volume);
	gz_volume_free(&volume);
}

#endif
