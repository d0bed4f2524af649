/* DICOM files from anywhere, read without the process that protects the viewer: whatever the bytes,
 * loading ends, and what is loaded keeps the promises of volume.h. */
#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "render/decode/dicom/dicom_load.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

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

static void make_folder(void)
{
	if (folder[0])
		return;
	strcpy(folder, "/dev/shm/gazecast-fuzz-XXXXXX");
	if (!mkdtemp(folder)) {
		strcpy(folder, "/tmp/gazecast-fuzz-XXXXXX");
		require(mkdtemp(folder) != NULL);
	}
	snprintf(path, sizeof path, "%s/a.dcm", folder);
	atexit(remove_folder);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	struct gz_volume volume = { 0 };
	make_folder();
	FILE *file = fopen(path, "wb");
	require(file != NULL);
	require(fwrite(data, 1, size, file) == size);
	require(fclose(file) == 0);
	const struct gz_volume_file dicom = { .path = path };
	if (gz_dicom_load(&dicom, NULL, &volume) != GZ_OK)
		return 0;
	for (int i = 0; i < 3; i++) {
		require(volume.dims[i] >= 1 && volume.dims[i] <= GZ_VOLUME_DIM_MAX);
		require(isfinite(volume.spacing[i]) && volume.spacing[i] > 0);
	}
	require(isfinite(volume.slope) && volume.slope != 0 && isfinite(volume.intercept));
	require(volume.stored_min <= volume.stored_max);
	gz_volume_free(&volume);
	return 0;
}
