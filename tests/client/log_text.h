/**
 * @file
 * Gaze logs made line by line, as text in memory.
 */
#ifndef GZ_TESTS_CLIENT_LOG_TEXT_H
#define GZ_TESTS_CLIENT_LOG_TEXT_H

#include <stddef.h>
#include <stdint.h>

#include "protocol/gaze_log.h"

/** A log as it grows. */
struct log_text {
	char *bytes;
	size_t size;
	uint64_t samples;
};

/** Begin with a header: tracker "fake", 1000 Hz, a display 50.4 deg wide. */
void log_text_begin(struct log_text *text);

/** Add any record. */
void log_text_record(struct log_text *text, const struct gz_gaze_log_record *record);

/** Add a sample of both eyes at (x, y), valid, at @p host_ns. */
void log_text_sample(struct log_text *text, int64_t host_ns, float x, float y);

/** Add a gap. */
void log_text_gap(struct log_text *text, int64_t host_ns, uint64_t missing);

/** Add a mark. */
void log_text_mark(struct log_text *text, int64_t host_ns, const char *label);

/** Add a line unchanged, with its newline. */
void log_text_line(struct log_text *text, const char *line);

/** Add the correct end line. */
void log_text_end(struct log_text *text);

/** 2 s at 1000 Hz from 10 s on: 1 s at (0.3, 0.5), a saccade of 40 ms, then (0.7, 0.5); x of every
 * other sample is @p jitter to the right. */
void log_text_look_right(struct log_text *text, float jitter);

/** Free the bytes. */
void log_text_free(struct log_text *text);

#endif
