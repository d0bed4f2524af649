/* Messages of a decoder process from anywhere, sent by a process that plays them: whatever they
 * are, decoding ends, nothing is left of the process, and what is taken keeps the promises of
 * decode.h. */
#include <errno.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/utf8.h"
#include "render/data/series_list.h"
#include "render/decode/decode.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static char path[64];

static void require(bool holds)
{
	if (!holds)
		abort();
}

static void remove_messages(void)
{
	unlink(path);
}

static void make_messages_file(void)
{
	if (path[0])
		return;
	snprintf(path, sizeof path, "%s/gazecast-fuzz-%ld",
		 access("/dev/shm", W_OK) == 0 ? "/dev/shm" : "/tmp", (long)getpid());
	atexit(remove_messages);
}

static bool always_goes_on(void *user, double share)
{
	(void)user;
	require(share >= 0 && share <= 1);
	return true;
}

static enum gz_result accept_one_byte(void *user, const struct gz_decode_header *header,
				      struct gz_decode_place *out_place)
{
	(void)user;
	(void)header;
	*out_place = (struct gz_decode_place) { .bytes = 1 };
	return GZ_OK;
}

static void check_clean(const char *text, size_t size)
{
	char copy[GZ_DECODE_TEXT_SIZE];
	require(size <= sizeof copy && memchr(text, 0, size) != NULL);
	strcpy(copy, text);
	gz_utf8_clean(copy);
	require(strcmp(copy, text) == 0);
}

static void check_list(struct gz_series_list *list)
{
	const size_t count = gz_series_list_count(list);
	struct gz_series_row row;
	require(count <= GZ_DECODE_SERIES_MAX);
	for (size_t i = 0; i < count; i++) {
		row.version = 0;
		require(gz_series_list_update(list, i, &row) && row.series.slices >= 0);
		check_clean(row.series.uid, sizeof row.series.uid);
		check_clean(row.series.date, sizeof row.series.date);
		check_clean(row.series.modality, sizeof row.series.modality);
		check_clean(row.series.patient, sizeof row.series.patient);
		check_clean(row.series.description, sizeof row.series.description);
		check_clean(row.series.reason, sizeof row.series.reason);
	}
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	struct gz_series_list *list;
	struct gz_decoded decoded;
	make_messages_file();
	FILE *file = fopen(path, "wb");
	require(file != NULL);
	require(fwrite(data, 1, size, file) == size);
	require(fclose(file) == 0);
	require(gz_series_list_create(NULL, &list) == GZ_OK);
	const struct gz_decode_listener listener = gz_series_list_listener(list);
	const struct gz_decode_job job = {
		.format = "played",
		.path = path,
		.program = MESSAGE_PLAYER,
		.scratch_fd = -1,
		.goes_on = always_goes_on,
		.accept = accept_one_byte,
		.listener = &listener,
	};
	const enum gz_result result = gz_decode_run(&job, &decoded);
	if (result == GZ_OK)
		require(decoded.mapped == 1 && munmap(decoded.voxels, decoded.mapped) == 0);
	require(result != GZ_ERR_CHOICE || gz_series_list_count(list) > 0);
	require(waitpid(-1, NULL, WNOHANG) == -1 && errno == ECHILD);
	check_list(list);
	gz_series_list_free(&list);
	return 0;
}
