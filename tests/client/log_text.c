#include "suite.h"

#include "log_text.h"

#include <stdlib.h>
#include <string.h>
#include <zlib.h>

#include "base/clock.h"

static void append(struct log_text *text, const char *bytes, size_t size)
{
	text->bytes = realloc(text->bytes, text->size + size);
	assert_non_null(text->bytes);
	memcpy(text->bytes + text->size, bytes, size);
	text->size += size;
}

void log_text_begin(struct log_text *text)
{
	*text = (struct log_text) { 0 };
	struct gz_gaze_log_header header = {
		.tracker = "fake",
		.serial = "s1",
		.rate_hz = 1000,
		.has_display = true,
		.display = gz_display_default(1920, 1080),
		.started = "2031-05-06T07:08:09Z",
		.software = "gazed 0.1.0",
	};
	char bytes[8192];
	size_t length;
	assert_int_equal(gz_gaze_log_print_header(&header, bytes, sizeof bytes, &length), GZ_OK);
	append(text, bytes, length);
}

void log_text_record(struct log_text *text, const struct gz_gaze_log_record *record)
{
	char bytes[GZ_GAZE_LOG_LINE_SIZE];
	size_t length;
	assert_int_equal(gz_gaze_log_print_record(record, bytes, sizeof bytes, &length), GZ_OK);
	append(text, bytes, length);
	text->samples += record->kind == GZ_GAZE_LOG_SAMPLE;
}

void log_text_sample(struct log_text *text, int64_t host_ns, float x, float y)
{
	struct gz_gaze_log_record record = { .kind = GZ_GAZE_LOG_SAMPLE,
					     .sample = gz_sample_unmeasured() };
	struct gz_sample *sample = &record.sample;
	sample->seq = text->samples;
	sample->host_ns = host_ns;
	sample->point = (struct gz_point) { x, y };
	sample->valid = true;
	for (int i = 0; i < GZ_EYE_COUNT; i++) {
		sample->eye[i].point = sample->point;
		sample->eye[i].valid = true;
		sample->eye[i].confidence = 1;
		sample->eye[i].pupil_mm = 3;
	}
	log_text_record(text, &record);
}

void log_text_gap(struct log_text *text, int64_t host_ns, uint64_t missing)
{
	const struct gz_gaze_log_record record = {
		.kind = GZ_GAZE_LOG_GAP, .host_ns = host_ns, .missing = missing, .text = "lost"
	};
	log_text_record(text, &record);
}

void log_text_mark(struct log_text *text, int64_t host_ns, const char *label)
{
	struct gz_gaze_log_record record = { .kind = GZ_GAZE_LOG_MARK, .host_ns = host_ns };
	assert_in_range(strlen(label), 0, sizeof record.text - 1);
	strcpy(record.text, label);
	log_text_record(text, &record);
}

void log_text_line(struct log_text *text, const char *line)
{
	append(text, line, strlen(line));
}

void log_text_end(struct log_text *text)
{
	char bytes[256];
	size_t length;
	uint32_t crc = (uint32_t)crc32(0, (const unsigned char *)text->bytes, (uInt)text->size);
	assert_int_equal(gz_gaze_log_print_end(text->samples, crc, bytes, sizeof bytes, &length),
			 GZ_OK);
	append(text, bytes, length);
}

void log_text_look_right(struct log_text *text, float jitter)
{
	for (int i = 0; i < 2000; i++) {
		float travelled = i < 1000 ? 0 : i < 1040 ? (float)(i - 1000) / 40 : 1;
		float x = 0.3f + 0.4f * travelled + (i % 2 ? jitter : 0);
		log_text_sample(text, 10 * GZ_NS_PER_S + i * GZ_NS_PER_MS, x, 0.5f);
	}
}

void log_text_free(struct log_text *text)
{
	free(text->bytes);
	*text = (struct log_text) { 0 };
}
