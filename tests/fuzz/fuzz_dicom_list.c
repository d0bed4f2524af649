/* DICOM files from anywhere in a list of series, read without the process that protects the viewer:
 * as a DICOMDIR and as an image beside it. Whatever the bytes, listing ends, and what is told keeps
 * the promises of decode.h. */
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/utf8.h"
#include "fuzz/fuzz_folder.h"
#include "render/decode/dicom/dicom_list.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static char folder[64], paths[2][128];

static void require(bool holds)
{
	if (!holds)
		abort();
}

static void remove_medium(void)
{
	for (int i = 0; i < 2; i++)
		unlink(paths[i]);
	rmdir(folder);
}

static void make_medium(void)
{
	if (folder[0])
		return;
	fuzz_folder_make(folder);
	snprintf(paths[0], sizeof paths[0], "%s/DICOMDIR", folder);
	snprintf(paths[1], sizeof paths[1], "%s/IM1", folder);
	atexit(remove_medium);
}

static uint32_t told; /* series so far */

static void check_text(const char *text, size_t size)
{
	char copy[sizeof(struct gz_decode_series)];
	require(memchr(text, 0, size) != NULL);
	strcpy(copy, text);
	gz_utf8_clean(copy);
	require(strcmp(copy, text) == 0);
}

static enum gz_result check_series(void *user, const struct gz_decode_series *series)
{
	(void)user;
	told++;
	require(told <= GZ_DECODE_SERIES_MAX && series->slices >= 0);
	/* A UID is as the file has it, unless there is a reason not to choose it. */
	require(memchr(series->uid, 0, sizeof series->uid) != NULL);
	check_text(series->date, sizeof series->date);
	check_text(series->modality, sizeof series->modality);
	check_text(series->patient, sizeof series->patient);
	check_text(series->description, sizeof series->description);
	require(memchr(series->reason, 0, sizeof series->reason) != NULL);
	return GZ_OK;
}

static void check_picture(void *user, uint32_t index, const struct gz_decode_picture *picture)
{
	(void)user;
	require(index < told && picture->band < GZ_DECODE_PICTURE_BANDS);
}

static void check_refusal(void *user, uint32_t index, const char *why)
{
	(void)user;
	require(index < told && why[0] != '\0');
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	const struct gz_decode_listener listener = { .series = check_series,
						     .picture = check_picture,
						     .refused = check_refusal };
	make_medium();
	for (int i = 0; i < 2; i++) {
		FILE *file = fopen(paths[i], "wb");
		require(file != NULL);
		require(fwrite(data, 1, size, file) == size);
		require(fclose(file) == 0);
	}
	for (int i = 0; i < 2; i++) {
		const struct gz_volume_file dicom = { .path = paths[i] };
		told = 0;
		const enum gz_result result = gz_dicom_list(&dicom, &listener, NULL);
		require(result != GZ_OK && (result != GZ_ERR_CHOICE || told > 0));
	}
	return 0;
}
