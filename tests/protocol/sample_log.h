/**
 * @file
 * A small gaze log with one record of each kind, and its content.
 */
#ifndef GZ_TESTS_PROTOCOL_SAMPLE_LOG_H
#define GZ_TESTS_PROTOCOL_SAMPLE_LOG_H

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <zlib.h>

#include "protocol/gaze_log.h"

enum { SAMPLE_LOG_RECORDS = 7, SAMPLE_LOG_SAMPLES = 3 };

struct sample_log {
	struct gz_gaze_log_header header;
	struct gz_gaze_log_record records[SAMPLE_LOG_RECORDS];
	char text[8192];
	size_t size;
	size_t header_size;                    /* bytes of the header */
	size_t record_end[SAMPLE_LOG_RECORDS]; /* bytes up to the record's newline, inclusive */
};

static inline struct gz_gaze_log_header sample_header(void)
{
	return (struct gz_gaze_log_header) {
		.tracker = "Tab\there \\ and there",
		.serial = "",
		.rate_hz = 1200.1,
		.has_display = true,
		.display = { .px = { 1920, 1080 }, .mm = { 564.7, 1.0 / 3 }, .distance_mm = 600 },
		.started = "2031-05-06T07:08:09Z",
		.software = "gazed 0.1.0",
		.setting_count = 2,
		.settings = { { "fixation_deg_s", "30 20" }, { "smoothing", "" } },
	};
}

static inline struct gz_gaze_log_record full_sample(uint64_t seq)
{
	struct gz_gaze_log_record record = { .kind = GZ_GAZE_LOG_SAMPLE };
	record.sample = (struct gz_sample) {
		.seq = seq,
		.device_ns = -5,
		.host_ns = 1000000000 + (int64_t)seq,
		.point = { 0.1f, -0.0f },
		.valid = true,
		.eye = { { { 0.25f, 1.5f },
			   true,
			   1,
			   3.3f,
			   { -30.5f, 2, 600 },
			   { 0.1f, 0.2f, 0.9f } },
			 { { FLT_MAX, -FLT_MIN },
			   false,
			   0,
			   FLT_TRUE_MIN,
			   { 1e-20f, -1e20f, 7 },
			   { INFINITY, -INFINITY, 0 } } },
	};
	return record;
}

static inline void sample_records(struct gz_gaze_log_record records[SAMPLE_LOG_RECORDS])
{
	records[0] = full_sample(7);
	records[1] = (struct gz_gaze_log_record) {
		.kind = GZ_GAZE_LOG_GAP, .host_ns = 2, .missing = 3, .text = "device lost them"
	};
	records[2] = (struct gz_gaze_log_record) { .kind = GZ_GAZE_LOG_SAMPLE,
						   .sample = gz_sample_unmeasured() };
	records[2].sample.seq = UINT64_MAX;
	records[3] = (struct gz_gaze_log_record) { .kind = GZ_GAZE_LOG_MARK,
						   .host_ns = INT64_MIN,
						   .text = "a\tb\nc\rd\\e \xc3\xa4" };
	records[4] = (struct gz_gaze_log_record) { .kind = GZ_GAZE_LOG_WINDOW,
						   .host_ns = 5,
						   .window_px = { -10, 0, 1920, 1080 } };
	records[5] = (struct gz_gaze_log_record) { .kind = GZ_GAZE_LOG_SCENE,
						   .host_ns = 1000000009,
						   .still_scene = true };
	records[6] = full_sample(9);
	records[6].sample.still_scene = true;
}

/** Write the whole log, including the line "#end". */
static inline void sample_log_make(struct sample_log *log)
{
	size_t length;
	memset(log, 0, sizeof *log);
	log->header = sample_header();
	sample_records(log->records);
	assert_int_equal(
		gz_gaze_log_print_header(&log->header, log->text, sizeof log->text, &log->size),
		GZ_OK);
	log->header_size = log->size;
	for (int i = 0; i < SAMPLE_LOG_RECORDS; i++) {
		assert_int_equal(gz_gaze_log_print_record(&log->records[i], log->text + log->size,
							  sizeof log->text - log->size, &length),
				 GZ_OK);
		log->size += length;
		log->record_end[i] = log->size;
	}
	uint32_t crc =
		(uint32_t)crc32_z(crc32_z(0, NULL, 0), (unsigned char *)log->text, log->size);
	assert_int_equal(gz_gaze_log_print_end(SAMPLE_LOG_SAMPLES, crc, log->text + log->size,
					       sizeof log->text - log->size, &length),
			 GZ_OK);
	log->size += length;
}

static inline uint32_t float_bits(float value)
{
	uint32_t bits;
	memcpy(&bits, &value, sizeof bits);
	return bits;
}

/** Equal bit for bit, except that any NaN equals any other. */
static inline void assert_same_float(float actual, float expected)
{
	if (isnan(actual) && isnan(expected))
		return;
	if (float_bits(actual) != float_bits(expected))
		fail_msg("%a is not %a", (double)actual, (double)expected);
}

static inline void assert_same_sample(const struct gz_sample *a, const struct gz_sample *b)
{
	assert_true(a->seq == b->seq);
	assert_true(a->device_ns == b->device_ns);
	assert_true(a->host_ns == b->host_ns);
	assert_same_float(a->point.x, b->point.x);
	assert_same_float(a->point.y, b->point.y);
	assert_int_equal(a->valid, b->valid);
	assert_int_equal(a->lost_before, b->lost_before);
	assert_int_equal(a->still_scene, b->still_scene);
	for (int i = 0; i < GZ_EYE_COUNT; i++) {
		const struct gz_eye_sample *ea = &a->eye[i], *eb = &b->eye[i];
		assert_same_float(ea->point.x, eb->point.x);
		assert_same_float(ea->point.y, eb->point.y);
		assert_int_equal(ea->valid, eb->valid);
		assert_same_float(ea->confidence, eb->confidence);
		assert_same_float(ea->pupil_mm, eb->pupil_mm);
		for (int k = 0; k < 3; k++) {
			assert_same_float(ea->origin_mm[k], eb->origin_mm[k]);
			assert_same_float(ea->direction[k], eb->direction[k]);
		}
	}
}

static inline void assert_same_record(const struct gz_gaze_log_record *a,
				      const struct gz_gaze_log_record *b)
{
	assert_int_equal(a->kind, b->kind);
	if (b->kind == GZ_GAZE_LOG_SAMPLE) {
		assert_same_sample(&a->sample, &b->sample);
		return;
	}
	assert_true(a->host_ns == b->host_ns);
	assert_true(a->missing == b->missing);
	assert_string_equal(a->text, b->text);
	assert_true(a->duration_ns == b->duration_ns);
	assert_string_equal(a->keys, b->keys);
	assert_memory_equal(a->window_px, b->window_px, sizeof a->window_px);
	assert_int_equal(a->still_scene, b->still_scene);
}

#endif
