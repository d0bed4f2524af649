#include <inttypes.h>

#include "protocol/gaze_log.h"
#include "protocol/gaze_log_text.h"

/* Read by people and spreadsheets; the reader goes by position. */
static const char columns[] = "seq\tdevice_ns\thost_ns\tgaze_x\tgaze_y\tgaze_valid"
			      "\teye0_x\teye0_y\teye0_valid\teye0_confidence\teye0_pupil_mm"
			      "\teye0_origin_x_mm\teye0_origin_y_mm\teye0_origin_z_mm"
			      "\teye0_dir_x\teye0_dir_y\teye0_dir_z"
			      "\teye1_x\teye1_y\teye1_valid\teye1_confidence\teye1_pupil_mm"
			      "\teye1_origin_x_mm\teye1_origin_y_mm\teye1_origin_z_mm"
			      "\teye1_dir_x\teye1_dir_y\teye1_dir_z";

static void print_text_line(struct gz_text *text, const char *key, const char *value)
{
	gz_text_print(text, "#%s ", key);
	gz_text_print_escaped(text, value);
	gz_text_print(text, "\n");
}

static void print_double_line(struct gz_text *text, const char *key, double value)
{
	gz_text_print(text, "#%s ", key);
	gz_text_print_double(text, value);
	gz_text_print(text, "\n");
}

static void print_display(struct gz_text *text, const struct gz_display *display)
{
	gz_text_print(text, "#display_px %d\t%d\n", display->px[0], display->px[1]);
	gz_text_print(text, "#display_mm ");
	gz_text_print_double(text, display->mm[0]);
	gz_text_print(text, "\t");
	gz_text_print_double(text, display->mm[1]);
	gz_text_print(text, "\n");
	print_double_line(text, "distance_mm", display->distance_mm);
}

enum gz_result gz_gaze_log_print_header(const struct gz_gaze_log_header *header, char *text,
					size_t size, size_t *out_length)
{
	struct gz_text out;
	gz_text_begin(&out, text, size);
	gz_text_print(&out, "#gazecast-log 1\n");
	print_text_line(&out, "tracker", header->tracker);
	print_text_line(&out, "serial", header->serial);
	print_double_line(&out, "rate_hz", header->rate_hz);
	if (header->has_display)
		print_display(&out, &header->display);
	print_text_line(&out, "started", header->started);
	print_text_line(&out, "software", header->software);
	for (size_t i = 0; i < header->setting_count; i++) {
		gz_text_print(&out, "#pipeline.%s ", header->settings[i].key);
		gz_text_print_escaped(&out, header->settings[i].value);
		gz_text_print(&out, "\n");
	}
	gz_text_print(&out, "#columns %s\n", columns);
	return gz_text_end(&out, out_length);
}

static void print_float_field(struct gz_text *text, float value)
{
	gz_text_print(text, "\t");
	gz_text_print_float(text, value);
}

static void print_eye(struct gz_text *text, const struct gz_eye_sample *eye)
{
	print_float_field(text, eye->point.x);
	print_float_field(text, eye->point.y);
	gz_text_print(text, "\t%d", eye->valid);
	print_float_field(text, eye->confidence);
	print_float_field(text, eye->pupil_mm);
	for (int i = 0; i < 3; i++)
		print_float_field(text, eye->origin_mm[i]);
	for (int i = 0; i < 3; i++)
		print_float_field(text, eye->direction[i]);
}

static void print_sample(struct gz_text *text, const struct gz_sample *sample)
{
	gz_text_print(text, "%" PRIu64 "\t", sample->seq);
	if (sample->device_ns != GZ_NO_DEVICE_TIME)
		gz_text_print(text, "%" PRId64, sample->device_ns);
	gz_text_print(text, "\t%" PRId64, sample->host_ns);
	print_float_field(text, sample->point.x);
	print_float_field(text, sample->point.y);
	gz_text_print(text, "\t%d", sample->valid);
	print_eye(text, &sample->eye[GZ_EYE_RIGHT]);
	print_eye(text, &sample->eye[GZ_EYE_LEFT]);
}

enum gz_result gz_gaze_log_print_record(const struct gz_gaze_log_record *record, char *text,
					size_t size, size_t *out_length)
{
	const int *window = record->window_px;
	struct gz_text out;
	gz_text_begin(&out, text, size);
	switch (record->kind) {
	case GZ_GAZE_LOG_SAMPLE:
		print_sample(&out, &record->sample);
		break;
	case GZ_GAZE_LOG_GAP:
		gz_text_print(&out, "!gap\t%" PRId64 "\t%" PRIu64 "\t", record->host_ns,
			      record->missing);
		gz_text_print_escaped(&out, record->text);
		break;
	case GZ_GAZE_LOG_MARK:
		gz_text_print(&out, "!mark\t%" PRId64 "\t", record->host_ns);
		gz_text_print_escaped(&out, record->text);
		break;
	case GZ_GAZE_LOG_WINDOW:
		gz_text_print(&out, "!window\t%" PRId64 "\t%d\t%d\t%d\t%d", record->host_ns,
			      window[0], window[1], window[2], window[3]);
		break;
	}
	gz_text_print(&out, "\n");
	return gz_text_end(&out, out_length);
}

enum gz_result gz_gaze_log_print_end(uint64_t samples, uint32_t crc, char *text, size_t size,
				     size_t *out_length)
{
	struct gz_text out;
	gz_text_begin(&out, text, size);
	gz_text_print(&out, "#end %" PRIu64 " %08" PRIx32 "\n", samples, crc);
	return gz_text_end(&out, out_length);
}
