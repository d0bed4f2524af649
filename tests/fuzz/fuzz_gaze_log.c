/* Gaze logs from anywhere: whatever the bytes, reading ends, and what is read can be written. */
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "protocol/gaze_log.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void require(bool holds)
{
	if (!holds)
		abort();
}

static void check_header(const struct gz_gaze_log_header *header)
{
	static char text[GZ_GAZE_LOG_HEADER_SIZE];
	size_t length;
	require(gz_gaze_log_print_header(header, text, sizeof text, &length) == GZ_OK);
	require(!header->has_display || gz_display_valid(&header->display));
	require(memchr(text, '\0', length) == NULL);
}

/* A record printed and read again prints the same. */
static void check_record(const struct gz_gaze_log_record *record)
{
	static const char version[] = "#gazecast-log 1\n";
	char text[sizeof version + GZ_GAZE_LOG_LINE_SIZE], again[GZ_GAZE_LOG_LINE_SIZE];
	char *line = text + sizeof version - 1;
	size_t length, again_length;
	struct gz_gaze_log_reader *reader;
	struct gz_gaze_log_record read;
	memcpy(text, version, sizeof version - 1);
	require(gz_gaze_log_print_record(record, line, GZ_GAZE_LOG_LINE_SIZE, &length) == GZ_OK);
	require(gz_gaze_log_open_memory("again", text, sizeof version - 1 + length, NULL,
					&reader) == GZ_OK);
	require(gz_gaze_log_read(reader, &read) == GZ_OK);
	gz_gaze_log_close(&reader);
	require(gz_gaze_log_print_record(&read, again, sizeof again, &again_length) == GZ_OK);
	require(again_length == length && memcmp(again, line, length) == 0);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	struct gz_gaze_log_reader *reader;
	struct gz_gaze_log_record record;
	if (gz_gaze_log_open_memory("fuzz", data, size, NULL, &reader) != GZ_OK)
		return 0;
	check_header(gz_gaze_log_header(reader));
	size_t lines = 0;
	enum gz_result result;
	while ((result = gz_gaze_log_read(reader, &record)) != GZ_ERR_END) {
		require(++lines <= size); /* every line has at least its newline */
		require(result == GZ_OK || result == GZ_ERR_FORMAT);
		if (result == GZ_OK)
			check_record(&record);
	}
	require(gz_gaze_log_ending(reader) != GZ_GAZE_LOG_UNREAD);
	gz_gaze_log_close(&reader);
	return 0;
}
