/* Parsing the lines of a gaze log: fields, header, records. */
#include <errno.h>
#include <inttypes.h>
#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "protocol/gaze_log_lines.h"

/* A field may begin neither with blanks nor with "+", which strtoll() and its relatives accept. */
static bool begins_number(const char *field)
{
	size_t sign = field[0] == '-';
	return (field[sign] >= '0' && field[sign] <= '9') || field[sign] == '.';
}

bool gz_field_int64(const char *field, int64_t *out_value)
{
	if (!begins_number(field))
		return false;
	char *end;
	errno = 0;
	int64_t value = strtoimax(field, &end, 10);
	if (errno != 0 || *end != '\0' || end == field)
		return false;
	*out_value = value;
	return true;
}

bool gz_field_uint64(const char *field, uint64_t *out_value)
{
	if (!begins_number(field) || field[0] == '-')
		return false;
	char *end;
	errno = 0;
	uint64_t value = strtoumax(field, &end, 10);
	if (errno != 0 || *end != '\0' || end == field)
		return false;
	*out_value = value;
	return true;
}

bool gz_field_crc(const char *field, uint32_t *out_value)
{
	if (strlen(field) != 8 || strspn(field, "0123456789abcdef") != 8)
		return false;
	*out_value = (uint32_t)strtoul(field, NULL, 16);
	return true;
}

/* Whether it is a decimal number: strtod() also accepts "nan(7)" and "0x1p3". */
static bool is_decimal_number(const char *field)
{
	return begins_number(field) && field[strspn(field, "0123456789+-.eE")] == '\0';
}

bool gz_field_float(const char *field, locale_t c_locale, float *out_value)
{
	if (field[0] == '\0') {
		*out_value = NAN;
		return true;
	}
	bool negative = field[0] == '-';
	if (strcmp(field + negative, "inf") == 0) {
		*out_value = negative ? -INFINITY : INFINITY;
		return true;
	}
	if (!is_decimal_number(field))
		return false;
	char *end;
	float value = strtof_l(field, &end, c_locale);
	if (*end != '\0' || end == field || isinf(value))
		return false;
	*out_value = value;
	return true;
}

bool gz_field_double(const char *field, locale_t c_locale, double *out_value)
{
	if (!is_decimal_number(field))
		return false;
	char *end;
	double value = strtod_l(field, &end, c_locale);
	if (*end != '\0' || end == field || isinf(value))
		return false;
	*out_value = value;
	return true;
}

bool gz_field_text(const char *field, char *out_plain, size_t size)
{
	static const char letters[] = GZ_GAZE_LOG_ESCAPE_LETTERS;
	size_t length = 0;
	for (; *field; field++) {
		char c = *field;
		if (c == '\\') {
			const char *at = *++field ? strchr(letters, *field) : NULL;
			if (!at)
				return false;
			c = GZ_GAZE_LOG_ESCAPED[at - letters];
		}
		if (length + 1 >= size)
			return false;
		out_plain[length++] = c;
	}
	out_plain[length] = '\0';
	return true;
}

/* One blank or tab ends a key, and each but the last of several numbers. */
static const char separators[] = " \t";

static const char settings_prefix[] = "pipeline.";

/* Cut @p text at its first separator. @return what follows, or an empty string */
static char *cut_at_separator(char *text)
{
	char *end = text + strcspn(text, separators);
	if (*end == '\0')
		return end;
	*end = '\0';
	return end + 1;
}

bool gz_gaze_log_parse_version(char *line)
{
	const char *version = cut_at_separator(line);
	return strcmp(line, "#gazecast-log") == 0 && strcmp(version, "1") == 0;
}

bool gz_gaze_log_parse_end(char *line, uint64_t *out_samples, uint32_t *out_crc)
{
	char *samples = cut_at_separator(line);
	const char *crc = cut_at_separator(samples);
	return strcmp(line, "#end") == 0 && gz_field_uint64(samples, out_samples) &&
	       gz_field_crc(crc, out_crc);
}

static const char *parse_header_name(char *value, char out_name[GZ_NAME_SIZE])
{
	return gz_field_text(value, out_name, GZ_NAME_SIZE)
		       ? NULL
		       : "the text is longer than 63 bytes or contains an unknown escape";
}

static const char *parse_header_rate(char *value, locale_t c_locale, double *out_rate_hz)
{
	double rate_hz;
	if (!gz_field_double(value, c_locale, &rate_hz) || rate_hz < 0)
		return "the rate must be a number of 0 or more";
	*out_rate_hz = rate_hz;
	return NULL;
}

static const char *parse_display_px(char *value, struct gz_display *display)
{
	const char *height = cut_at_separator(value);
	int64_t px[2];
	if (!gz_field_int64(value, &px[0]) || !gz_field_int64(height, &px[1]) || px[0] < 1 ||
	    px[0] > GZ_DISPLAY_SIDE_MAX_PX || px[1] < 1 || px[1] > GZ_DISPLAY_SIDE_MAX_PX)
		return "expected the display's width and height in pixels, 1 to 32768 each";
	display->px[0] = (int)px[0];
	display->px[1] = (int)px[1];
	return NULL;
}

static const char *parse_display_mm(char *value, locale_t c_locale, struct gz_display *display)
{
	const char *height = cut_at_separator(value);
	if (!gz_field_double(value, c_locale, &display->mm[0]) ||
	    !gz_field_double(height, c_locale, &display->mm[1]) || display->mm[0] <= 0 ||
	    display->mm[1] <= 0)
		return "expected the display's width and height in mm, above 0 each";
	return NULL;
}

static const char *parse_viewing_distance(char *value, locale_t c_locale,
					  struct gz_display *display)
{
	if (!gz_field_double(value, c_locale, &display->distance_mm) || display->distance_mm <= 0)
		return "expected the viewing distance in mm, above 0";
	return NULL;
}

static const char *parse_pipeline_setting(const char *key, const char *value,
					  struct gz_gaze_log_header *header)
{
	for (size_t i = 0; i < header->setting_count; i++)
		if (strcmp(header->settings[i].key, key) == 0)
			return "given twice";
	if (header->setting_count == GZ_GAZE_LOG_SETTINGS_MAX)
		return "more than 128 settings";
	struct gz_gaze_log_setting *setting = &header->settings[header->setting_count];
	if (key[0] == '\0' || strlen(key) >= sizeof setting->key)
		return "the name of a setting must have 1 to 63 bytes";
	if (!gz_field_text(value, setting->value, sizeof setting->value))
		return "the value is longer than 127 bytes or contains an unknown escape";
	snprintf(setting->key, sizeof setting->key, "%s", key);
	header->setting_count++;
	return NULL;
}

/* Header lines that may come once; each is a bit of gz_gaze_log_header_state.seen. */
enum header_key {
	TRACKER,
	SERIAL,
	RATE,
	PX,
	MM,
	DISTANCE,
	STARTED,
	SOFTWARE,
	PUPIL_UNIT,
	COORDINATES,
	KEY_COUNT
};

static const char *const key_names[KEY_COUNT] = {
	[TRACKER] = "tracker",         [SERIAL] = "serial",     [RATE] = "rate_hz",
	[PX] = "display_px",           [MM] = "display_mm",     [DISTANCE] = "distance_mm",
	[STARTED] = "started",         [SOFTWARE] = "software", [PUPIL_UNIT] = "pupil_unit",
	[COORDINATES] = "coordinates",
};

static const char *parse_header_value(enum header_key key, char *value, locale_t c_locale,
				      struct gz_gaze_log_header_state *state,
				      struct gz_gaze_log_header *header)
{
	switch (key) {
	case TRACKER:
		return parse_header_name(value, header->tracker);
	case SERIAL:
		return parse_header_name(value, header->serial);
	case RATE:
		return parse_header_rate(value, c_locale, &header->rate_hz);
	case PX:
		return parse_display_px(value, &state->display);
	case MM:
		return parse_display_mm(value, c_locale, &state->display);
	case DISTANCE:
		return parse_viewing_distance(value, c_locale, &state->display);
	case STARTED:
		return parse_header_name(value, header->started);
	case SOFTWARE:
		return parse_header_name(value, header->software);
	case PUPIL_UNIT:
		return parse_header_name(value, header->pupil_unit);
	case COORDINATES:
		header->scene_camera = strcmp(value, GZ_GAZE_LOG_SCENE_CAMERA) == 0;
		return header->scene_camera ? NULL
					    : "the only coordinates that are named are those "
					      "of a scene camera";
	case KEY_COUNT:
		break;
	}
	return NULL;
}

const char *gz_gaze_log_parse_header(char *line, locale_t c_locale,
				     struct gz_gaze_log_header_state *state,
				     struct gz_gaze_log_header *header)
{
	static const unsigned whole_display = 1u << PX | 1u << MM | 1u << DISTANCE;
	char *value = cut_at_separator(line);
	const char *name = line + 1;
	if (strncmp(name, settings_prefix, sizeof settings_prefix - 1) == 0)
		return parse_pipeline_setting(name + sizeof settings_prefix - 1, value, header);

	int key = 0;
	while (key < KEY_COUNT && strcmp(name, key_names[key]) != 0)
		key++;
	if (key == KEY_COUNT)
		return NULL; /* "#columns", or a key of a later version */
	if (state->seen & 1u << key)
		return "given twice";
	const char *fault =
		parse_header_value((enum header_key)key, value, c_locale, state, header);
	if (fault)
		return fault;
	state->seen |= 1u << key;
	if ((state->seen & whole_display) == whole_display) {
		header->has_display = true;
		header->display = state->display;
	}
	return NULL;
}

/* The fields of a line that have not been read. */
struct line_fields {
	char *next; /* NULL: none */
	locale_t c_locale;
};

/* Cut off the next field. @return NULL if there is none */
static const char *cut_off_field(struct line_fields *fields)
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

static bool take_int64_field(struct line_fields *fields, int64_t *out_value)
{
	const char *field = cut_off_field(fields);
	return field && gz_field_int64(field, out_value);
}

static bool take_uint64_field(struct line_fields *fields, uint64_t *out_value)
{
	const char *field = cut_off_field(fields);
	return field && gz_field_uint64(field, out_value);
}

static bool take_int_field(struct line_fields *fields, int *out_value)
{
	int64_t value;
	if (!take_int64_field(fields, &value) || value < INT_MIN || value > INT_MAX)
		return false;
	*out_value = (int)value;
	return true;
}

static bool take_device_ns(struct line_fields *fields, int64_t *out_value)
{
	const char *field = cut_off_field(fields);
	if (field && field[0] == '\0') {
		*out_value = GZ_NO_DEVICE_TIME;
		return true;
	}
	return field && gz_field_int64(field, out_value);
}

/* An empty field was not measured, so nothing says that it is valid. */
static bool take_valid_field(struct line_fields *fields, bool *out_value)
{
	const char *field = cut_off_field(fields);
	if (!field || (field[0] && strcmp(field, "0") != 0 && strcmp(field, "1") != 0))
		return false;
	*out_value = field[0] == '1';
	return true;
}

static bool take_float_field(struct line_fields *fields, float *out_value)
{
	const char *field = cut_off_field(fields);
	return field && gz_field_float(field, fields->c_locale, out_value);
}

static bool take_float_fields(struct line_fields *fields, float *out_values, size_t count)
{
	for (size_t i = 0; i < count; i++)
		if (!take_float_field(fields, &out_values[i]))
			return false;
	return true;
}

static bool take_text_field(struct line_fields *fields, char *out_text)
{
	const char *field = cut_off_field(fields);
	return field && gz_field_text(field, out_text, GZ_GAZE_LOG_TEXT_SIZE);
}

static bool take_eye_fields(struct line_fields *fields, struct gz_eye_sample *eye)
{
	return take_float_field(fields, &eye->point.x) && take_float_field(fields, &eye->point.y) &&
	       take_valid_field(fields, &eye->valid) &&
	       take_float_field(fields, &eye->confidence) &&
	       take_float_field(fields, &eye->pupil_mm) &&
	       take_float_fields(fields, eye->origin_mm, 3) &&
	       take_float_fields(fields, eye->direction, 3);
}

static bool take_sample_fields(struct line_fields *fields, struct gz_sample *sample)
{
	sample->lost_before = 0;
	return take_uint64_field(fields, &sample->seq) &&
	       take_device_ns(fields, &sample->device_ns) &&
	       take_int64_field(fields, &sample->host_ns) &&
	       take_float_field(fields, &sample->point.x) &&
	       take_float_field(fields, &sample->point.y) &&
	       take_valid_field(fields, &sample->valid) &&
	       take_eye_fields(fields, &sample->eye[GZ_EYE_RIGHT]) &&
	       take_eye_fields(fields, &sample->eye[GZ_EYE_LEFT]) && !fields->next;
}

static bool take_gap_fields(struct line_fields *fields, struct gz_gaze_log_record *record)
{
	return take_int64_field(fields, &record->host_ns) &&
	       take_uint64_field(fields, &record->missing) &&
	       take_text_field(fields, record->text) && !fields->next;
}

static bool take_mark_keys(struct line_fields *fields, char *out_keys)
{
	const char *field = cut_off_field(fields);
	return field && field[0] && gz_field_text(field, out_keys, GZ_GAZE_LOG_KEYS_SIZE);
}

/* A mark may have a duration, and then further keys. */
static bool take_mark_fields(struct line_fields *fields, struct gz_gaze_log_record *record)
{
	record->duration_ns = 0;
	record->keys[0] = '\0';
	if (!take_int64_field(fields, &record->host_ns) || !take_text_field(fields, record->text))
		return false;
	if (fields->next &&
	    (!take_int64_field(fields, &record->duration_ns) || record->duration_ns < 0))
		return false;
	return !fields->next || (take_mark_keys(fields, record->keys) && !fields->next);
}

static bool take_window_fields(struct line_fields *fields, struct gz_gaze_log_record *record)
{
	if (!take_int64_field(fields, &record->host_ns))
		return false;
	for (int i = 0; i < 4; i++)
		if (!take_int_field(fields, &record->window_px[i]))
			return false;
	return !fields->next;
}

static bool take_scene_fields(struct line_fields *fields, struct gz_gaze_log_record *record)
{
	if (!take_int64_field(fields, &record->host_ns))
		return false;
	const char *field = cut_off_field(fields);
	if (!field || fields->next)
		return false;
	record->still_scene = strcmp(field, GZ_GAZE_LOG_STILL) == 0;
	return record->still_scene || strcmp(field, GZ_GAZE_LOG_MOVING) == 0;
}

const char *gz_gaze_log_parse_record(char *line, locale_t c_locale,
				     struct gz_gaze_log_record *out_record)
{
	struct line_fields fields = { line, c_locale };
	if (line[0] != '!') {
		out_record->kind = GZ_GAZE_LOG_SAMPLE;
		return take_sample_fields(&fields, &out_record->sample) ? NULL : "malformed sample";
	}
	const char *kind = cut_off_field(&fields);
	if (strcmp(kind, "!gap") == 0) {
		out_record->kind = GZ_GAZE_LOG_GAP;
		return take_gap_fields(&fields, out_record) ? NULL : "malformed !gap";
	}
	if (strcmp(kind, "!mark") == 0) {
		out_record->kind = GZ_GAZE_LOG_MARK;
		return take_mark_fields(&fields, out_record) ? NULL : "malformed !mark";
	}
	if (strcmp(kind, "!window") == 0) {
		out_record->kind = GZ_GAZE_LOG_WINDOW;
		return take_window_fields(&fields, out_record) ? NULL : "malformed !window";
	}
	if (strcmp(kind, "!scene") == 0) {
		out_record->kind = GZ_GAZE_LOG_SCENE;
		return take_scene_fields(&fields, out_record) ? NULL : "malformed !scene";
	}
	return "unknown record";
}
