/* Recordings of other programs from anywhere: whatever the bytes, each reader ends, its times and
 * points can be printed into a log, and the header comes first and once. */
#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include "client/gazectl/convert/recording_format.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

struct seen {
	unsigned headers;
	uint64_t samples;
};

static void require(bool holds)
{
	if (!holds)
		abort();
}

static enum gz_result take_header(void *user, const struct gz_gaze_log_header *header)
{
	static char text[GZ_GAZE_LOG_HEADER_SIZE];
	struct seen *seen = user;
	size_t length;
	require(seen->headers++ == 0);
	require(!header->has_display || gz_display_valid(&header->display));
	require(gz_gaze_log_print_header(header, text, sizeof text, &length) == GZ_OK);
	return GZ_OK;
}

static enum gz_result take_record(void *user, const struct gz_gaze_log_record *record)
{
	static char text[GZ_GAZE_LOG_LINE_SIZE];
	struct seen *seen = user;
	size_t length;
	require(seen->headers == 1);
	seen->samples += record->kind == GZ_GAZE_LOG_SAMPLE;
	require(gz_gaze_log_print_record(record, text, sizeof text, &length) == GZ_OK);
	if (record->kind == GZ_GAZE_LOG_SAMPLE)
		for (int i = 0; i < GZ_EYE_COUNT; i++)
			require(!record->sample.eye[i].valid ||
				(isfinite(record->sample.eye[i].point.x) &&
				 isfinite(record->sample.eye[i].point.y)));
	return GZ_OK;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	for (size_t i = 0; gz_recording_readers[i]; i++) {
		struct seen seen = { 0 };
		struct gz_text_lines *lines = NULL;
		struct gz_convert_counts counts = { 0 };
		const struct gz_convert_settings settings = {
			.name = "fuzz",
			.rate_hz = 100,
			.table = { "x=x;y=y;left_x=lx;left_y=ly;left_pupil_mm=lp;mark=m", "",
				   GZ_TABLE_S, GZ_TABLE_FRACTION },
		};
		const struct gz_recording_sink sink = { &seen, take_header, take_record };
		if (gz_text_lines_open_memory(data, size, &lines) != GZ_OK)
			return 0;
		enum gz_result result =
			gz_recording_readers[i]->read(lines, &settings, &sink, &counts);
		require(result == GZ_OK || result == GZ_ERR_FORMAT || result == GZ_ERR_UNSUPPORTED);
		require(counts.samples == seen.samples);
		gz_text_lines_close(&lines);
	}
	return 0;
}
