#include <limits.h>
#include <string.h>

#include "protocol/gaze_log_parse.h"
#include "protocol/gaze_log_text.h"

/* The fields of a line that are still to be read. NULL: no more. */
struct fields {
	char *next;
	locale_t c_locale;
};

/* Cut off the next field. NULL if there is none. */
static const char *take(struct fields *fields)
{
	char *field = fields->next;
	if (!field)
		return NULL;
	char *tab = strchr(field, '\t');
	if (tab)
		*tab++ = '\0';
	fields->next = tab;
	return field;
}

static bool take_int64(struct fields *fields, int64_t *out_value)
{
	const char *field = take(fields);
	return field && gz_field_int64(field, out_value);
}

static bool take_uint64(struct fields *fields, uint64_t *out_value)
{
	const char *field = take(fields);
	return field && gz_field_uint64(field, out_value);
}

static bool take_int(struct fields *fields, int *out_value)
{
	int64_t value;
	if (!take_int64(fields, &value) || value < INT_MIN || value > INT_MAX)
		return false;
	*out_value = (int)value;
	return true;
}

static bool take_device_ns(struct fields *fields, int64_t *out_value)
{
	const char *field = take(fields);
	if (field && field[0] == '\0') {
		*out_value = GZ_NO_DEVICE_TIME;
		return true;
	}
	return field && gz_field_int64(field, out_value);
}

static bool take_bool(struct fields *fields, bool *out_value)
{
	const char *field = take(fields);
	if (!field || (strcmp(field, "0") != 0 && strcmp(field, "1") != 0))
		return false;
	*out_value = field[0] == '1';
	return true;
}

static bool take_float(struct fields *fields, float *out_value)
{
	const char *field = take(fields);
	return field && gz_field_float(field, fields->c_locale, out_value);
}

static bool take_floats(struct fields *fields, float *out_values, size_t count)
{
	for (size_t i = 0; i < count; i++)
		if (!take_float(fields, &out_values[i]))
			return false;
	return true;
}

static bool take_text(struct fields *fields, char *out_text)
{
	const char *field = take(fields);
	return field && gz_field_text(field, out_text, GZ_GAZE_LOG_TEXT_SIZE);
}

static bool take_eye(struct fields *fields, struct gz_eye_sample *eye)
{
	return take_float(fields, &eye->point.x) && take_float(fields, &eye->point.y) &&
	       take_bool(fields, &eye->valid) && take_float(fields, &eye->confidence) &&
	       take_float(fields, &eye->pupil_mm) && take_floats(fields, eye->origin_mm, 3) &&
	       take_floats(fields, eye->direction, 3);
}

static bool take_sample(struct fields *fields, struct gz_sample *sample)
{
	sample->lost_before = 0;
	return take_uint64(fields, &sample->seq) && take_device_ns(fields, &sample->device_ns) &&
	       take_int64(fields, &sample->host_ns) && take_float(fields, &sample->point.x) &&
	       take_float(fields, &sample->point.y) && take_bool(fields, &sample->valid) &&
	       take_eye(fields, &sample->eye[GZ_EYE_RIGHT]) &&
	       take_eye(fields, &sample->eye[GZ_EYE_LEFT]) && !fields->next;
}

static bool take_gap(struct fields *fields, struct gz_gaze_log_record *record)
{
	return take_int64(fields, &record->host_ns) && take_uint64(fields, &record->missing) &&
	       take_text(fields, record->text) && !fields->next;
}

static bool take_mark(struct fields *fields, struct gz_gaze_log_record *record)
{
	return take_int64(fields, &record->host_ns) && take_text(fields, record->text) &&
	       !fields->next;
}

static bool take_window(struct fields *fields, struct gz_gaze_log_record *record)
{
	if (!take_int64(fields, &record->host_ns))
		return false;
	for (int i = 0; i < 4; i++)
		if (!take_int(fields, &record->window_px[i]))
			return false;
	return !fields->next;
}

const char *gz_gaze_log_parse_record(char *line, locale_t c_locale,
				     struct gz_gaze_log_record *out_record)
{
	struct fields fields = { line, c_locale };
	if (line[0] != '!') {
		out_record->kind = GZ_GAZE_LOG_SAMPLE;
		return take_sample(&fields, &out_record->sample) ? NULL : "malformed sample";
	}
	const char *kind = take(&fields);
	if (strcmp(kind, "!gap") == 0) {
		out_record->kind = GZ_GAZE_LOG_GAP;
		return take_gap(&fields, out_record) ? NULL : "malformed !gap";
	}
	if (strcmp(kind, "!mark") == 0) {
		out_record->kind = GZ_GAZE_LOG_MARK;
		return take_mark(&fields, out_record) ? NULL : "malformed !mark";
	}
	if (strcmp(kind, "!window") == 0) {
		out_record->kind = GZ_GAZE_LOG_WINDOW;
		return take_window(&fields, out_record) ? NULL : "malformed !window";
	}
	return "unknown record";
}
