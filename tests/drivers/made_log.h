/**
 * @file
 * Makes gaze logs on disk for tests.
 */
#ifndef GZ_TESTS_DRIVERS_MADE_LOG_H
#define GZ_TESTS_DRIVERS_MADE_LOG_H

#include <stdio.h>
#include <string.h>
#include <zlib.h>

#include "protocol/gaze_log.h"

struct made_log {
	FILE *file;
	uint32_t crc;
	uint64_t samples;
};

static inline void made_log_write(struct made_log *made, const char *text, size_t length)
{
	made->crc = (uint32_t)crc32(made->crc, (const Bytef *)text, (uInt)length);
	fwrite(text, 1, length, made->file);
}

/** Begin a log at @p path with a header. @return whether that worked */
static inline bool made_log_begin(struct made_log *made, const char *path)
{
	static char text[16384];
	size_t length;
	struct gz_gaze_log_header header = { .tracker = "made",
					     .serial = "S1",
					     .rate_hz = 500,
					     .has_display = true,
					     .display = gz_display_default(1280, 1024),
					     .started = "2030-01-02T03:04:05Z",
					     .software = "test" };
	*made = (struct made_log) { .file = fopen(path, "w") };
	if (!made->file || gz_gaze_log_print_header(&header, text, sizeof text, &length) != GZ_OK)
		return false;
	made_log_write(made, text, length);
	return true;
}

static inline void made_log_record(struct made_log *made, const struct gz_gaze_log_record *record)
{
	char line[GZ_GAZE_LOG_LINE_SIZE];
	size_t length;
	if (gz_gaze_log_print_record(record, line, sizeof line, &length) != GZ_OK)
		return;
	made->samples += record->kind == GZ_GAZE_LOG_SAMPLE;
	made_log_write(made, line, length);
}

static inline void made_log_sample(struct made_log *made, uint64_t seq, int64_t host_ns)
{
	struct gz_gaze_log_record record = { .kind = GZ_GAZE_LOG_SAMPLE,
					     .sample = gz_sample_unmeasured() };
	record.sample.seq = seq;
	record.sample.host_ns = host_ns;
	record.sample.device_ns = host_ns / 2;
	record.sample.valid = true;
	record.sample.point = (struct gz_point) { 0.5f, 0.25f };
	made_log_record(made, &record);
}

static inline void made_log_gap(struct made_log *made, int64_t host_ns, uint64_t missing)
{
	struct gz_gaze_log_record record = {
		.kind = GZ_GAZE_LOG_GAP, .host_ns = host_ns, .missing = missing, .text = "gap"
	};
	made_log_record(made, &record);
}

static inline void made_log_end(struct made_log *made)
{
	char line[64];
	size_t length;
	if (gz_gaze_log_print_end(made->samples, made->crc, line, sizeof line, &length) == GZ_OK)
		fwrite(line, 1, length, made->file);
	fclose(made->file);
}

#endif
