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

#include "fuzz/fuzz_folder.h"
#include "render/data/volume.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

/* New names are put last: the corpus has indices. */
static const char *const names[] = { "a.nii", "a.nii.gz",  "a.nrrd",   "a.nhdr", "a.mha",
				     "a.mhd", "a.raw.zst", "a.raw.gz", "a.mgz",  "a.hdr",
				     "a.img", "a",         "a.mgh",    "a.inv3" };
#define NAME_COUNT (sizeof names / sizeof names[0])

/* Files of 4 KiB that headers may name. */
static const char *const others[] = { "v0.raw", "v1.raw" };
#define OTHER_COUNT (sizeof others / sizeof others[0])

static char folder[64];

static void require(bool holds)
{
	if (!holds)
		abort();
}

static const uint8_t voxels[4096];

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
	for (size_t i = 0; i < OTHER_COUNT; i++) {
		path_of(others[i], path, sizeof path);
		unlink(path);
	}
	rmdir(folder);
}

static void write_bytes(const char *name, const uint8_t *bytes, size_t size)
{
	char path[128];
	path_of(name, path, sizeof path);
	FILE *file = fopen(path, "wb");
	require(file != NULL);
	require(fwrite(bytes, 1, size, file) == size);
	require(fclose(file) == 0);
}

/* The other half of a pair: voxels for a header, a header for voxels. */
static void write_other_half(const char *name)
{
	/* NIfTI-1, 9 x 7 x 5 floats; offsets are those of nifti1.h */
	static const struct {
		size_t at;
		uint8_t value;
	} numbers[] = {
		{ 0, 0x5c },  { 1, 1 },     { 40, 3 },    { 42, 9 },    { 44, 7 },    { 46, 5 },
		{ 70, 16 },   { 72, 32 },   { 82, 0x80 }, { 83, 0x3f }, { 86, 0x80 }, { 87, 0x3f },
		{ 90, 0x80 }, { 91, 0x3f }, { 344, 'n' }, { 345, 'i' }, { 346, '1' },
	};
	uint8_t header[348] = { 0 };
	if (strcmp(name, "a.hdr") == 0)
		write_bytes("a.img", voxels, sizeof voxels);
	if (strcmp(name, "a.img") != 0)
		return;
	for (size_t i = 0; i < sizeof numbers / sizeof numbers[0]; i++)
		header[numbers[i].at] = numbers[i].value;
	write_bytes("a.hdr", header, sizeof header);
}

static void make_folder(void)
{
	if (folder[0])
		return;
	fuzz_folder_make(folder);
	/* DICOM is read by another process: fuzz_dicom looks at it. */
	setenv("GAZECAST_DECODER", "/nowhere/gazedecode", 1);
	atexit(remove_folder);
	for (size_t i = 0; i < OTHER_COUNT; i++)
		write_bytes(others[i], voxels, sizeof voxels);
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
	if (!v->voxels) /* bricks, which have a target of their own */
		return;
	size_t size = gz_volume_bytes(v);
	for (size_t i = 0; v->colours && i < gz_volume_voxel_count(v); i++)
		require(v->colours[i] >> 24 ==
			(v->colour == GZ_COLOUR_ALPHA ? ((const uint8_t *)v->voxels)[i] : 255));
	for (size_t i = 0; i < size + GZ_VOLUME_PADDING; i++)
		sum = (uint8_t)(sum + ((const uint8_t *)v->voxels)[i]);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	static const struct gz_raw_layout raw = { .dims = { 9, 7, 5 },
						  .type = GZ_RAW_FLOAT32,
						  .spacing = { 1, 1, 1 } };
	/* The size says what values of colours are, too: all of it can be reached. */
	const struct gz_loading loading = { .opacity = (enum gz_opacity_source)(size % 3) };
	struct gz_volume volume;
	char path[128];
	if (size < 1)
		return 0;
	make_folder();
	const char *name = names[data[0] % NAME_COUNT];
	path_of(name, path, sizeof path);
	write_bytes(name, data + 1, size - 1);
	write_other_half(name);
	bool headerless = strstr(name, ".raw") != NULL;
	if (gz_volume_load(path, headerless ? &raw : NULL, &loading, NULL, &volume) == GZ_OK) {
		check_volume(&volume);
		gz_volume_free(&volume);
	}
	return 0;
}
