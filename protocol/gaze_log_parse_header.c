#include <stdio.h>
#include <string.h>

#include "protocol/gaze_log_parse.h"
#include "protocol/gaze_log_text.h"

/* A key is ended by one blank or tab; so is each of several numbers. */
static const char separators[] = " \t";

static const char settings_prefix[] = "pipeline.";

/* Cut @p text at its first separator. @return what follows, an empty string if nothing does */
static char *cut(char *text)
{
	char *end = text + strcspn(text, separators);
	if (*end == '\0')
		return end;
	*end = '\0';
	return end + 1;
}

bool gz_gaze_log_parse_version(char *line)
{
	const char *version = cut(line);
	return strcmp(line, "#gazecast-log") == 0 && strcmp(version, "1") == 0;
}

bool gz_gaze_log_parse_end(char *line, uint64_t *out_samples, uint32_t *out_crc)
{
	char *samples = cut(line);
	const char *crc = cut(samples);
	return strcmp(line, "#end") == 0 && gz_field_uint64(samples, out_samples) &&
	       gz_field_crc(crc, out_crc);
}

static const char *parse_name(char *value, char out_name[GZ_NAME_SIZE])
{
	return gz_field_text(value, out_name, GZ_NAME_SIZE)
		       ? NULL
		       : "text is too long (63 bytes) or has an unknown escape";
}

static const char *parse_rate(char *value, locale_t c_locale, double *out_rate_hz)
{
	double rate_hz;
	if (!gz_field_double(value, c_locale, &rate_hz) || rate_hz < 0)
		return "not a rate, a number of 0 or more";
	*out_rate_hz = rate_hz;
	return NULL;
}

static const char *parse_px(char *value, struct gz_display *display)
{
	const char *height = cut(value);
	int64_t px[2];
	if (!gz_field_int64(value, &px[0]) || !gz_field_int64(height, &px[1]) || px[0] < 1 ||
	    px[0] > GZ_DISPLAY_SIDE_MAX_PX || px[1] < 1 || px[1] > GZ_DISPLAY_SIDE_MAX_PX)
		return "not a display's width and height in pixels, 1 to 32768 each";
	display->px[0] = (int)px[0];
	display->px[1] = (int)px[1];
	return NULL;
}

static const char *parse_mm(char *value, locale_t c_locale, struct gz_display *display)
{
	const char *height = cut(value);
	if (!gz_field_double(value, c_locale, &display->mm[0]) ||
	    !gz_field_double(height, c_locale, &display->mm[1]) || display->mm[0] <= 0 ||
	    display->mm[1] <= 0)
		return "not a display's width and height in mm, above 0 each";
	return NULL;
}

static const char *parse_distance(char *value, locale_t c_locale, struct gz_display *display)
{
	if (!gz_field_double(value, c_locale, &display->distance_mm) || display->distance_mm <= 0)
		return "not a viewing distance in mm, above 0";
	return NULL;
}

static const char *parse_setting(const char *key, const char *value,
				 struct gz_gaze_log_header *header)
{
	for (size_t i = 0; i < header->setting_count; i++)
		if (strcmp(header->settings[i].key, key) == 0)
			return "given twice";
	if (header->setting_count == GZ_GAZE_LOG_SETTINGS_MAX)
		return "more settings than the 128 that a header can hold";
	struct gz_gaze_log_setting *setting = &header->settings[header->setting_count];
	if (key[0] == '\0' || strlen(key) >= sizeof setting->key)
		return "a setting's name has 1 to 63 bytes";
	if (!gz_field_text(value, setting->value, sizeof setting->value))
		return "value is too long (127 bytes) or has an unknown escape";
	snprintf(setting->key, sizeof setting->key, "%s", key);
	header->setting_count++;
	return NULL;
}

/* The lines that may come once, by their bit in gz_gaze_log_header_state.seen. */
enum header_key { TRACKER, SERIAL, RATE, PX, MM, DISTANCE, STARTED, SOFTWARE, KEY_COUNT };

static const char *const key_names[KEY_COUNT] = {
	[TRACKER] = "tracker", [SERIAL] = "serial",     [RATE] = "rate_hz",
	[PX] = "display_px",   [MM] = "display_mm",     [DISTANCE] = "distance_mm",
	[STARTED] = "started", [SOFTWARE] = "software",
};

static const char *parse_value(enum header_key key, char *value, locale_t c_locale,
			       struct gz_gaze_log_header_state *state,
			       struct gz_gaze_log_header *header)
{
	switch (key) {
	case TRACKER:
		return parse_name(value, header->tracker);
	case SERIAL:
		return parse_name(value, header->serial);
	case RATE:
		return parse_rate(value, c_locale, &header->rate_hz);
	case PX:
		return parse_px(value, &state->display);
	case MM:
		return parse_mm(value, c_locale, &state->display);
	case DISTANCE:
		return parse_distance(value, c_locale, &state->display);
	case STARTED:
		return parse_name(value, header->started);
	case SOFTWARE:
		return parse_name(value, header->software);
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
	char *value = cut(line);
	const char *name = line + 1;
	if (strncmp(name, settings_prefix, sizeof settings_prefix - 1) == 0)
		return parse_setting(name + sizeof settings_prefix - 1, value, header);

	int key = 0;
	while (key < KEY_COUNT && strcmp(name, key_names[key]) != 0)
		key++;
	if (key == KEY_COUNT)
		return NULL; /* "#columns", and what later versions add */
	if (state->seen & 1u << key)
		return "given twice";
	const char *fault = parse_value((enum header_key)key, value, c_locale, state, header);
	if (fault)
		return fault;
	state->seen |= 1u << key;
	if ((state->seen & whole_display) == whole_display) {
		header->has_display = true;
		header->display = state->display;
	}
	return NULL;
}
