/* Volume files from anywhere: the first byte chooses the kind, the rest is the file. Whatever the
 * bytes, loading ends, takes no more memory than the file can fill, and what is loaded keeps the
 * promises of volume.h. */
#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "render/data/volume.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static const char *const names[] = { "a.nii", "a.nii.gz",  "a.nrrd",   "a.nhdr", "a.mha",
				     "a.mhd", "a.raw.zst", "a.raw.gz", "a.dcm" };
#define NAME_COUNT (sizeof names / sizeof names[0])

static char folder[64];

static void require(bool holds)
{
	if (!holds)
		abort();
}

static void path_of(const char *name, char *out, size_t size)
{
	snprintf(out, size, "%s/%s", folder, name);
}

static void remove_folder(void)
{
	char path[128];
	for (size_t i = 0; i < NAME_COUNT; i++) {
		path_of(names[i], path, sizeof path);
		unlink(path);
	}
	rmdir(folder);
}

static void make_folder(void)
{
	if (folder[0])
		return;
	strcpy(folder, "/dev/shm/gazecast-fuzz-XXXXXX");
	if (!mkdtemp(folder)) {
		strcpy(folder, "/tmp/gazecast-fuzz-XXXXXX");
		require(mkdtemp(folder) != NULL);
	}
	atexit(remove_folder);
}

static void check_volume(const struct gz_volume *v)
{
	volatile uint8_t sum = 0; /* so that every byte is read */
	for (int i = 0; i < 3; i++) {
		require(v->dims[i] >= 1 && v->dims[i] <= GZ_VOLUME_DIM_MAX);
		require(isfinite(v->spacing[i]) && v->spacing[i] > 0);
	}
	require(isfinite(v->slope) && v->slope != 0 && isfinite(v->intercept));
	require(isfinite(v->stored_min) && v->stored_min <= v->stored_max);
	require(isfinite(v->stored_max));
	size_t size = gz_volume_voxel_count(v) * gz_voxel_size(v->type);
	for (size_t i = 0; i < size + GZ_VOLUME_PADDING; i++)
		sum = (uint8_t)(sum + ((const uint8_t *)v->voxels)[i]);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	static const struct gz_raw_layout raw = { .dims = { 9, 7, 5 },
						  .type = GZ_RAW_FLOAT32,
						  .spacing = { 1, 1, 1 } };
	struct gz_volume volume;
	char path[128];
	if (size < 1)
		return 0;
	make_folder();
	const char *name = names[data[0] % NAME_COUNT];
	path_of(name, path, sizeof path);
	FILE *file = fopen(path, "wb");
	require(file != NULL);
	require(fwrite(data + 1, 1, size - 1, file) == size - 1);
	require(fclose(file) == 0);
	bool headerless = strstr(name, ".raw") != NULL;
	if (gz_volume_load(path, headerless ? &raw : NULL, NULL, NULL, &volume) == GZ_OK) {
		check_volume(&volume);
		gz_volume_free(&volume);
	}
	return 0;
}
