/* Printing the lines of a gaze log, and writing them to a file. */
#include <errno.h>
#include <inttypes.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#include <zlib.h>

#include "base/file.h"
#include "base/text.h"
#include "protocol/gaze_log_lines.h"

/* Size of any number printed here: sign, 17 digits, point of up to 6 bytes, exponent. */
enum { NUMBER_SIZE = 48 };

void gz_gaze_log_text_begin(struct gz_gaze_log_text *text, char *bytes, size_t size)
{
	*text = (struct gz_gaze_log_text) { .bytes = bytes, .size = size, .full = size == 0 };
}

enum gz_result gz_gaze_log_text_end(struct gz_gaze_log_text *text, size_t *out_length)
{
	if (text->full)
		return GZ_ERR_FULL;
	*out_length = text->length;
	return GZ_OK;
}

void gz_gaze_log_text_print(struct gz_gaze_log_text *text, const char *format, ...)
{
	if (text->full)
		return;
	size_t left = text->size - text->length;
	va_list arguments;
	va_start(arguments, format);
	int length = vsnprintf(text->bytes + text->length, left, format, arguments);
	va_end(arguments);
	if (length < 0 || (size_t)length >= left)
		text->full = true;
	else
		text->length += (size_t)length;
}

void gz_gaze_log_text_print_escaped(struct gz_gaze_log_text *text, const char *plain)
{
	static const char escaped[] = GZ_GAZE_LOG_ESCAPED;
	for (; *plain; plain++) {
		const char *at = strchr(escaped, *plain);
		if (at)
			gz_gaze_log_text_print(text, "\\%c",
					       GZ_GAZE_LOG_ESCAPE_LETTERS[at - escaped]);
		else
			gz_gaze_log_text_print(text, "%c", *plain);
	}
}

void gz_gaze_log_text_print_float(struct gz_gaze_log_text *text, float value)
{
	if (isnan(value))
		return;
	if (isinf(value)) {
		gz_gaze_log_text_print(text, value > 0 ? "inf" : "-inf");
		return;
	}
	char number[NUMBER_SIZE];
	snprintf(number, sizeof number, "%.9g", (double)value);
	gz_number_normalise_point(number);
	gz_gaze_log_text_print(text, "%s", number);
}

void gz_gaze_log_text_print_double(struct gz_gaze_log_text *text, double value)
{
	char number[NUMBER_SIZE];
	snprintf(number, sizeof number, "%.15g", value);
	if (strtod(number, NULL) != value)
		snprintf(number, sizeof number, "%.17g", value);
	gz_number_normalise_point(number);
	gz_gaze_log_text_print(text, "%s", number);
}

/* For people and spreadsheets; the reader identifies fields by their position. */
static const char columns[] = "seq\tdevice_ns\thost_ns\tgaze_x\tgaze_y\tgaze_valid"
			      "\teye0_x\teye0_y\teye0_valid\teye0_confidence\teye0_pupil_mm"
			      "\teye0_origin_x_mm\teye0_origin_y_mm\teye0_origin_z_mm"
			      "\teye0_dir_x\teye0_dir_y\teye0_dir_z"
			      "\teye1_x\teye1_y\teye1_valid\teye1_confidence\teye1_pupil_mm"
			      "\teye1_origin_x_mm\teye1_origin_y_mm\teye1_origin_z_mm"
			      "\teye1_dir_x\teye1_dir_y\teye1_dir_z";

static void print_text_line(struct gz_gaze_log_text *text, const char *key, const char *value)
{
	gz_gaze_log_text_print(text, "#%s ", key);
	gz_gaze_log_text_print_escaped(text, value);
	gz_gaze_log_text_print(text, "\n");
}

static void print_double_line(struct gz_gaze_log_text *text, const char *key, double value)
{
	gz_gaze_log_text_print(text, "#%s ", key);
	gz_gaze_log_text_print_double(text, value);
	gz_gaze_log_text_print(text, "\n");
}

static void print_display_lines(struct gz_gaze_log_text *text, const struct gz_display *display)
{
	gz_gaze_log_text_print(text, "#display_px %d\t%d\n", display->px[0], display->px[1]);
	gz_gaze_log_text_print(text, "#display_mm ");
	gz_gaze_log_text_print_double(text, display->mm[0]);
	gz_gaze_log_text_print(text, "\t");
	gz_gaze_log_text_print_double(text, display->mm[1]);
	gz_gaze_log_text_print(text, "\n");
	print_double_line(text, "distance_mm", display->distance_mm);
}

enum gz_result gz_gaze_log_print_header(const struct gz_gaze_log_header *header, char *text,
					size_t size, size_t *out_length)
{
	struct gz_gaze_log_text out;
	gz_gaze_log_text_begin(&out, text, size);
	gz_gaze_log_text_print(&out, "#gazecast-log 1\n");
	print_text_line(&out, "tracker", header->tracker);
	print_text_line(&out, "serial", header->serial);
	print_double_line(&out, "rate_hz", header->rate_hz);
	if (header->has_display)
		print_display_lines(&out, &header->display);
	print_text_line(&out, "started", header->started);
	print_text_line(&out, "software", header->software);
	if (header->pupil_unit[0])
		print_text_line(&out, "pupil_unit", header->pupil_unit);
	if (header->scene_camera)
		print_text_line(&out, "coordinates", GZ_GAZE_LOG_SCENE_CAMERA);
	for (size_t i = 0; i < header->setting_count; i++) {
		gz_gaze_log_text_print(&out, "#pipeline.%s ", header->settings[i].key);
		gz_gaze_log_text_print_escaped(&out, header->settings[i].value);
		gz_gaze_log_text_print(&out, "\n");
	}
	gz_gaze_log_text_print(&out, "#columns %s\n", columns);
	return gz_gaze_log_text_end(&out, out_length);
}

static void print_float_field(struct gz_gaze_log_text *text, float value)
{
	gz_gaze_log_text_print(text, "\t");
	gz_gaze_log_text_print_float(text, value);
}

static void print_eye_fields(struct gz_gaze_log_text *text, const struct gz_eye_sample *eye)
{
	print_float_field(text, eye->point.x);
	print_float_field(text, eye->point.y);
	gz_gaze_log_text_print(text, "\t%d", eye->valid);
	print_float_field(text, eye->confidence);
	print_float_field(text, eye->pupil_mm);
	for (int i = 0; i < 3; i++)
		print_float_field(text, eye->origin_mm[i]);
	for (int i = 0; i < 3; i++)
		print_float_field(text, eye->direction[i]);
}

static void print_sample_fields(struct gz_gaze_log_text *text, const struct gz_sample *sample)
{
	gz_gaze_log_text_print(text, "%" PRIu64 "\t", sample->seq);
	if (sample->device_ns != GZ_NO_DEVICE_TIME)
		gz_gaze_log_text_print(text, "%" PRId64, sample->device_ns);
	gz_gaze_log_text_print(text, "\t%" PRId64, sample->host_ns);
	print_float_field(text, sample->point.x);
	print_float_field(text, sample->point.y);
	gz_gaze_log_text_print(text, "\t%d", sample->valid);
	print_eye_fields(text, &sample->eye[GZ_EYE_RIGHT]);
	print_eye_fields(text, &sample->eye[GZ_EYE_LEFT]);
}

/* The duration and the keys come only if there are any, so that a plain mark is as short as ever.
 */
static void print_mark_fields(struct gz_gaze_log_text *text,
			      const struct gz_gaze_log_record *record)
{
	gz_gaze_log_text_print(text, "!mark\t%" PRId64 "\t", record->host_ns);
	gz_gaze_log_text_print_escaped(text, record->text);
	if (record->duration_ns == 0 && !record->keys[0])
		return;
	gz_gaze_log_text_print(text, "\t%" PRId64, record->duration_ns);
	if (!record->keys[0])
		return;
	gz_gaze_log_text_print(text, "\t");
	gz_gaze_log_text_print_escaped(text, record->keys);
}

enum gz_result gz_gaze_log_print_record(const struct gz_gaze_log_record *record, char *text,
					size_t size, size_t *out_length)
{
	const int *window = record->window_px;
	struct gz_gaze_log_text out;
	gz_gaze_log_text_begin(&out, text, size);
	switch (record->kind) {
	case GZ_GAZE_LOG_SAMPLE:
		print_sample_fields(&out, &record->sample);
		break;
	case GZ_GAZE_LOG_GAP:
		gz_gaze_log_text_print(&out, "!gap\t%" PRId64 "\t%" PRIu64 "\t", record->host_ns,
				       record->missing);
		gz_gaze_log_text_print_escaped(&out, record->text);
		break;
	case GZ_GAZE_LOG_MARK:
		print_mark_fields(&out, record);
		break;
	case GZ_GAZE_LOG_WINDOW:
		gz_gaze_log_text_print(&out, "!window\t%" PRId64 "\t%d\t%d\t%d\t%d",
				       record->host_ns, window[0], window[1], window[2], window[3]);
		break;
	case GZ_GAZE_LOG_SCENE:
		gz_gaze_log_text_print(&out, "!scene\t%" PRId64 "\t%s", record->host_ns,
				       record->still_scene ? GZ_GAZE_LOG_STILL
							   : GZ_GAZE_LOG_MOVING);
		break;
	}
	gz_gaze_log_text_print(&out, "\n");
	return gz_gaze_log_text_end(&out, out_length);
}

enum gz_result gz_gaze_log_print_end(uint64_t samples, uint32_t crc, char *text, size_t size,
				     size_t *out_length)
{
	struct gz_gaze_log_text out;
	gz_gaze_log_text_begin(&out, text, size);
	gz_gaze_log_text_print(&out, "#end %" PRIu64 " %08" PRIx32 "\n", samples, crc);
	return gz_gaze_log_text_end(&out, out_length);
}

/* Size of the longest "#end" line: two numbers. */
enum { END_LINE_SIZE = 64 };

static uint64_t count_samples(const unsigned char *lines, size_t size)
{
	uint64_t samples = 0;
	const unsigned char *end = lines + size;
	while (lines < end) {
		samples += *lines != '#' && *lines != '!';
		const unsigned char *newline = memchr(lines, '\n', (size_t)(end - lines));
		lines = newline ? newline + 1 : end;
	}
	return samples;
}

/* The first @p size bytes of the buffer, which are whole lines, have been written: count them. */
static void count_written_lines(struct gz_gaze_log_writer *writer, size_t size)
{
	writer->crc = (uint32_t)crc32(writer->crc, writer->buffer, (uInt)size);
	writer->samples += count_samples(writer->buffer, size);
	writer->size += size;
}

static enum gz_result write_end_line(struct gz_gaze_log_writer *writer)
{
	char line[END_LINE_SIZE];
	size_t length = 0;
	enum gz_result result =
		gz_gaze_log_print_end(writer->samples, writer->crc, line, sizeof line, &length);
	if (result != GZ_OK)
		return result;
	size_t done = gz_write_all(writer->fd, (const unsigned char *)line, length);
	return done == length ? GZ_OK : GZ_ERR_IO;
}

/* Only @p done bytes of the buffer could be written. Cut the file after its last whole line and end
 * the log there; the space freed by the cut usually suffices for the line "#end". */
static void cut_after_last_line(struct gz_gaze_log_writer *writer, size_t done)
{
	const unsigned char *newline = done ? memrchr(writer->buffer, '\n', done) : NULL;
	size_t whole = newline ? (size_t)(newline + 1 - writer->buffer) : 0;
	count_written_lines(writer, whole);
	off_t size = (off_t)writer->size;
	bool cut = ftruncate(writer->fd, size) == 0 && lseek(writer->fd, size, SEEK_SET) == size;
	if (cut && write_end_line(writer) != GZ_OK && ftruncate(writer->fd, size) != 0)
		return; /* an unfinished line is left; readers ignore it */
}

enum gz_result gz_gaze_log_writer_begin(struct gz_gaze_log_writer *writer, int fd,
					const struct gz_gaze_log_header *header)
{
	writer->fd = fd;
	writer->crc = (uint32_t)crc32(0, NULL, 0);
	writer->size = 0;
	writer->samples = 0;
	writer->still_scene = false;
	writer->used = 0;
	return gz_gaze_log_print_header(header, (char *)writer->buffer, sizeof writer->buffer,
					&writer->used);
}

enum gz_result gz_gaze_log_writer_flush(struct gz_gaze_log_writer *writer)
{
	if (writer->used == 0)
		return GZ_OK;
	size_t done = gz_write_all(writer->fd, writer->buffer, writer->used);
	if (done < writer->used) {
		int error = errno;
		cut_after_last_line(writer, done);
		writer->used = 0;
		errno = error;
		return GZ_ERR_IO;
	}
	count_written_lines(writer, writer->used);
	writer->used = 0;
	return GZ_OK;
}

static enum gz_result add_log_line(struct gz_gaze_log_writer *writer,
				   const struct gz_gaze_log_record *record)
{
	if (sizeof writer->buffer - writer->used < GZ_GAZE_LOG_LINE_SIZE) {
		enum gz_result result = gz_gaze_log_writer_flush(writer);
		if (result != GZ_OK)
			return result;
	}
	size_t length = 0;
	enum gz_result result =
		gz_gaze_log_print_record(record, (char *)writer->buffer + writer->used,
					 sizeof writer->buffer - writer->used, &length);
	if (result == GZ_OK)
		writer->used += length;
	return result;
}

enum gz_result gz_gaze_log_writer_add(struct gz_gaze_log_writer *writer,
				      const struct gz_gaze_log_record *record)
{
	const struct gz_sample *sample = &record->sample;
	if (record->kind == GZ_GAZE_LOG_SCENE)
		writer->still_scene = record->still_scene;
	if (record->kind == GZ_GAZE_LOG_SAMPLE && sample->still_scene != writer->still_scene) {
		const struct gz_gaze_log_record scene = { .kind = GZ_GAZE_LOG_SCENE,
							  .host_ns = sample->host_ns,
							  .still_scene = sample->still_scene };
		enum gz_result result = add_log_line(writer, &scene);
		if (result != GZ_OK)
			return result;
		writer->still_scene = sample->still_scene;
	}
	return add_log_line(writer, record);
}

enum gz_result gz_gaze_log_writer_end(struct gz_gaze_log_writer *writer)
{
	enum gz_result result = gz_gaze_log_writer_flush(writer);
	if (result != GZ_OK)
		return result;
	result = write_end_line(writer);
	if (result != GZ_OK) {
		int error = errno;
		cut_after_last_line(writer, 0);
		errno = error;
	}
	return result;
}
