/* The reader of EyeLink recordings of gaze positions as edf2asc writes them (.asc): SR Research,
 * "EyeLink 1000 User Manual", section "ASC file format". A sample line has a time in ms and, for
 * each tracked eye, left before right, x and y in pixels and the size of the pupil in a unit of its
 * own. The fields after them (velocities, resolution, head target, flags) are ignored. Lines of
 * events that the tracker's parser found (EFIX, ESACC, EBLINK) follow their last sample. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/clock.h"
#include "base/text.h"
#include "client/gazectl/convert/recording_format.h"

#define GZ_LOG_MODULE "eyelink"

/* A mode ("!MODE RECORD …") that comes at most this long before the first block belongs to it.
 * Chosen: in some files it comes 1 to 3 ms before START, in others after it. */
static const double EARLY_MS = 5;

struct eyelink {
	struct gz_text_lines *lines;
	const struct gz_convert_settings *settings;
	const struct gz_recording_sink *sink;
	struct gz_convert_counts *counts;
	bool eye[GZ_EYE_COUNT];
	double rate_hz;
	char pupil_unit[GZ_NAME_SIZE];
	double rectangle_px[4]; /* left, top, right, bottom of the screen's pixels, inclusive */
	bool has_rectangle;
	bool sent_header;
	bool has_early; /* the mode came before the first block */
	double early_ms;
	char early_text[GZ_GAZE_LOG_TEXT_SIZE];
	bool recording; /* inside a block of samples */
	double last_ms;
	int same_ms; /* samples before this one with the same whole millisecond */
	uint64_t seq;
	struct gz_gaze_log_record record; /* large */
};

static bool eyelink_recognises(const char *line)
{
	return strncmp(line, "** CONVERTED FROM", 17) == 0 ||
	       strncmp(line, "** VERSION: EYELINK", 19) == 0;
}

static int64_t ns_of_ms(double ms)
{
	return (int64_t)llround(ms * (double)GZ_NS_PER_MS);
}

static bool is_time_ms(double ms)
{
	return ms >= 0 && ms < 1e12;
}

static enum gz_result send_eyelink_header(struct eyelink *eyelink)
{
	struct gz_convert_settings settings = *eyelink->settings;
	if (eyelink->sent_header)
		return GZ_OK;
	eyelink->sent_header = true;
	if (settings.rate_hz == 0)
		settings.rate_hz = eyelink->rate_hz;
	for (int i = 0; i < 2 && eyelink->has_rectangle; i++)
		if (settings.display_px[i] == 0)
			settings.display_px[i] =
				(int)(eyelink->rectangle_px[2 + i] - eyelink->rectangle_px[i] + 1);
	struct gz_gaze_log_header header = gz_recording_header(&settings, "EyeLink");
	snprintf(header.pupil_unit, sizeof header.pupil_unit, "%s",
		 eyelink->pupil_unit[0] ? eyelink->pupil_unit : "arbitrary (EyeLink)");
	return eyelink->sink->header(eyelink->sink->user, &header);
}

static enum gz_result send_eyelink_record(struct eyelink *eyelink)
{
	enum gz_result result = send_eyelink_header(eyelink);
	return result == GZ_OK ? eyelink->sink->record(eyelink->sink->user, &eyelink->record)
			       : result;
}

/* Parse "GAZE_COORDS <left> <top> <right> <bottom>", or DISPLAY_COORDS with the same numbers. */
static void take_rectangle(struct eyelink *eyelink, const char *text)
{
	double r[4];
	if (gz_text_begins(text, "GAZE_COORDS "))
		text += strlen("GAZE_COORDS ");
	else if (gz_text_begins(text, "DISPLAY_COORDS "))
		text += strlen("DISPLAY_COORDS ");
	else
		return;
	for (int i = 0; i < 4; i++)
		if (!gz_text_take_number(&text, &r[i]) || fabs(r[i]) > GZ_DISPLAY_SIDE_MAX_PX)
			return;
	if (r[2] <= r[0] || r[3] <= r[1])
		return;
	memcpy(eyelink->rectangle_px, r, sizeof r);
	eyelink->has_rectangle = true;
}

static enum gz_result send_plain_mark(struct eyelink *eyelink, double ms, const char *text)
{
	eyelink->record.kind = GZ_GAZE_LOG_MARK;
	eyelink->record.host_ns = ns_of_ms(ms);
	eyelink->record.duration_ns = 0;
	eyelink->record.keys[0] = '\0';
	gz_text_copy(eyelink->record.text, sizeof eyelink->record.text, text);
	return send_eyelink_record(eyelink);
}

static void keep_early_mode(struct eyelink *eyelink, double ms, const char *text)
{
	if (eyelink->recording || !gz_text_begins(text, "!MODE"))
		return;
	eyelink->has_early = true;
	eyelink->early_ms = ms;
	gz_text_copy(eyelink->early_text, sizeof eyelink->early_text, text);
}

/* Send the mode of the first block, if it came before the block, as its first mark. */
static enum gz_result send_early_mark(struct eyelink *eyelink)
{
	if (!eyelink->has_early)
		return GZ_OK;
	eyelink->has_early = false;
	return send_plain_mark(eyelink, eyelink->early_ms, eyelink->early_text);
}

/* Whether the lines at the beginning of a block have come, so that a header can be made. */
static bool knows_header(const struct eyelink *eyelink)
{
	return eyelink->recording && eyelink->rate_hz > 0 && eyelink->has_rectangle;
}

/* Take "MSG <time> <text>": screen coordinates, or a mark. */
static enum gz_result take_eyelink_message(struct eyelink *eyelink, const char *text)
{
	double ms;
	if (!gz_text_take_number(&text, &ms) || !is_time_ms(ms))
		return GZ_OK;
	take_rectangle(eyelink, text);
	/* Marks before the first block are dropped but for its mode: the header, which must come
	 * before them, needs the rate and the size of the screen. */
	if (!eyelink->sent_header && !knows_header(eyelink)) {
		keep_early_mode(eyelink, ms, text);
		return GZ_OK;
	}
	enum gz_result result = send_early_mark(eyelink);
	return result == GZ_OK ? send_plain_mark(eyelink, ms, text) : result;
}

/* An event of the tracker's parser, and the names of the numbers after its duration. */
struct parsed_event {
	const char *line; /* how its line begins */
	const char *text; /* of the mark */
	const char *keys[6];
};

static const struct parsed_event parsed_events[] = {
	{ "EFIX", "fixation", { "x_px", "y_px", "pupil" } },
	{ "ESACC",
	  "saccade",
	  { "start_x_px", "start_y_px", "end_x_px", "end_y_px", "amplitude_deg",
	    "peak_velocity_deg_s" } },
	{ "EBLINK", "blink", { NULL } },
};

static void print_event_keys(const struct parsed_event *event, const struct gz_text_fields *fields,
			     char *keys, size_t size)
{
	char number[32];
	size_t used = (size_t)snprintf(keys, size, "{\"source\":\"EyeLink\",\"eye\":\"%s\"",
				       fields->field[1][0] == 'L' ? "left" : "right");
	for (size_t i = 0; i < sizeof event->keys / sizeof *event->keys && event->keys[i]; i++) {
		double value = gz_text_field_number(fields, 5 + i);
		if (!isfinite(value))
			continue;
		snprintf(number, sizeof number, "%.9g", value);
		gz_number_normalise_point(number);
		used += (size_t)snprintf(keys + used, size - used, ",\"%s\":%s", event->keys[i],
					 number);
	}
	snprintf(keys + used, size - used, "}");
}

/* Take "EFIX L <start> <end> <duration> …" as a mark with a duration; all in ms. */
static enum gz_result take_parsed_event(struct eyelink *eyelink, const struct parsed_event *event,
					char *line)
{
	struct gz_text_fields fields;
	gz_text_split(line, ' ', &fields);
	double start_ms = gz_text_field_number(&fields, 2);
	double duration_ms = gz_text_field_number(&fields, 4);
	if (!eyelink->sent_header || fields.count < 5 || !is_time_ms(start_ms) ||
	    !is_time_ms(duration_ms)) {
		eyelink->counts->skipped++;
		return GZ_OK;
	}
	struct gz_gaze_log_record *record = &eyelink->record;
	record->kind = GZ_GAZE_LOG_MARK;
	record->host_ns = ns_of_ms(start_ms);
	record->duration_ns = ns_of_ms(duration_ms);
	snprintf(record->text, sizeof record->text, "%s", event->text);
	print_event_keys(event, &fields, record->keys, sizeof record->keys);
	return send_eyelink_record(eyelink);
}

/* Take "PUPIL AREA" or "PUPIL DIAMETER": what the size of the pupil is, in a unit of its own. */
static void take_pupil_line(struct eyelink *eyelink, const char *text)
{
	bool diameter = strstr(text, "DIAMETER") != NULL;
	snprintf(eyelink->pupil_unit, sizeof eyelink->pupil_unit, "arbitrary (EyeLink %s)",
		 diameter ? "diameter" : "area");
}

/* Take "SAMPLES GAZE LEFT RIGHT … RATE 500.00 …": the eyes and the rate of the next block. */
static enum gz_result take_samples_line(struct eyelink *eyelink, char *line)
{
	struct gz_text_fields fields;
	bool gaze = false;
	eyelink->eye[GZ_EYE_LEFT] = eyelink->eye[GZ_EYE_RIGHT] = false;
	gz_text_split(line, ' ', &fields);
	for (size_t i = 1; i < fields.count; i++) {
		const char *word = fields.field[i];
		gaze |= strcmp(word, "GAZE") == 0;
		eyelink->eye[GZ_EYE_LEFT] |= strcmp(word, "LEFT") == 0;
		eyelink->eye[GZ_EYE_RIGHT] |= strcmp(word, "RIGHT") == 0;
		double rate_hz = gz_text_field_number(&fields, i + 1);
		if (strcmp(word, "RATE") == 0 && rate_hz > 0 && rate_hz <= 1e5)
			eyelink->rate_hz = rate_hz;
	}
	if (gaze)
		return GZ_OK;
	gz_err(eyelink->settings->log,
	       "%s:%llu: the samples are not gaze positions; convert the recording again with the "
	       "gaze output of edf2asc",
	       eyelink->settings->name, (unsigned long long)gz_text_lines_number(eyelink->lines));
	return GZ_ERR_UNSUPPORTED;
}

static enum gz_result begin_block(struct eyelink *eyelink, const char *text)
{
	double ms;
	bool first = !eyelink->sent_header;
	if (!gz_text_take_number(&text, &ms) || !is_time_ms(ms))
		ms = eyelink->last_ms;
	eyelink->recording = true;
	eyelink->last_ms = -1;
	if (first) {
		eyelink->has_early &= fabs(ms - eyelink->early_ms) <= EARLY_MS;
		return GZ_OK;
	}
	eyelink->record.kind = GZ_GAZE_LOG_GAP;
	eyelink->record.host_ns = ns_of_ms(ms);
	eyelink->record.missing = 0;
	snprintf(eyelink->record.text, sizeof eyelink->record.text, "recording was paused");
	return send_eyelink_record(eyelink);
}

/* The time of a sample. At 2000 Hz two samples have the same millisecond. */
static int64_t sample_time_ns(struct eyelink *eyelink, double ms)
{
	double period_ms = eyelink->rate_hz > 0 ? 1000 / eyelink->rate_hz : 0;
	eyelink->same_ms = ms == eyelink->last_ms && period_ms < 1 ? eyelink->same_ms + 1 : 0;
	eyelink->last_ms = ms;
	return ns_of_ms(ms + eyelink->same_ms * period_ms);
}

static void take_eyelink_eye(const struct eyelink *eyelink, const struct gz_text_fields *fields,
			     size_t first, struct gz_eye_sample *eye)
{
	const double *r = eyelink->rectangle_px;
	double x_px = gz_text_field_number(fields, first);
	double y_px = gz_text_field_number(fields, first + 1);
	eye->point = gz_recording_point((x_px - r[0]) / (r[2] - r[0] + 1),
					(y_px - r[1]) / (r[3] - r[1] + 1));
	eye->valid = isfinite(eye->point.x);
	double pupil = gz_text_field_number(fields, first + 2); /* 0: no pupil was found */
	if (pupil > 0 && pupil < 1e9)
		eye->pupil_mm = (float)pupil; /* the header says that it is not mm */
}

static enum gz_result take_eyelink_sample(struct eyelink *eyelink, char *line)
{
	struct gz_text_fields fields;
	gz_text_split(line, ' ', &fields);
	double ms = gz_text_field_number(&fields, 0);
	if (!is_time_ms(ms) || fields.count < 4) {
		eyelink->counts->skipped++;
		return GZ_OK;
	}
	if (!eyelink->has_rectangle) {
		gz_err(eyelink->settings->log,
		       "%s: no GAZE_COORDS before the samples; give the size of the screen with "
		       "--display.px WxH",
		       eyelink->settings->name);
		return GZ_ERR_FORMAT;
	}
	enum gz_result result = send_early_mark(eyelink);
	if (result != GZ_OK)
		return result;
	struct gz_sample *sample = &eyelink->record.sample;
	*sample = gz_sample_unmeasured();
	sample->seq = eyelink->seq++;
	sample->host_ns = sample->device_ns = sample_time_ns(eyelink, ms);
	size_t first = 1;
	for (int eye = GZ_EYE_LEFT; eye >= GZ_EYE_RIGHT; eye--) {
		if (!eyelink->eye[eye])
			continue;
		take_eyelink_eye(eyelink, &fields, first, &sample->eye[eye]);
		first += 3;
	}
	eyelink->record.kind = GZ_GAZE_LOG_SAMPLE;
	eyelink->counts->samples++;
	return send_eyelink_record(eyelink);
}

static enum gz_result take_eyelink_line(struct eyelink *eyelink, char *line)
{
	if (line[0] >= '0' && line[0] <= '9')
		return eyelink->recording ? take_eyelink_sample(eyelink, line) : GZ_OK;
	if (strncmp(line, "MSG", 3) == 0)
		return take_eyelink_message(eyelink, line + 3);
	if (strncmp(line, "PUPIL", 5) == 0)
		take_pupil_line(eyelink, line);
	if (strncmp(line, "SAMPLES", 7) == 0)
		return take_samples_line(eyelink, line);
	if (strncmp(line, "START", 5) == 0)
		return begin_block(eyelink, line + 5);
	if (strncmp(line, "END", 3) == 0)
		eyelink->recording = false;
	for (size_t i = 0; i < sizeof parsed_events / sizeof *parsed_events; i++)
		if (strncmp(line, parsed_events[i].line, strlen(parsed_events[i].line)) == 0)
			return take_parsed_event(eyelink, &parsed_events[i], line);
	/* Other lines are settings, or beginnings of events, whose end says all. */
	return GZ_OK;
}

static enum gz_result read_eyelink_export(struct gz_text_lines *lines,
					  const struct gz_convert_settings *settings,
					  const struct gz_recording_sink *sink,
					  struct gz_convert_counts *counts)
{
	struct eyelink eyelink = {
		.lines = lines, .settings = settings, .sink = sink, .counts = counts, .last_ms = -1
	};
	if (settings->display_px[0] > 0 && settings->display_px[1] > 0) {
		eyelink.rectangle_px[2] = settings->display_px[0] - 1;
		eyelink.rectangle_px[3] = settings->display_px[1] - 1;
		eyelink.has_rectangle = true;
	}
	char *line;
	enum gz_result result;
	while ((result = gz_text_lines_next(lines, &line)) == GZ_OK || result == GZ_ERR_FULL) {
		if (result == GZ_ERR_FULL) {
			counts->skipped++;
			continue;
		}
		result = take_eyelink_line(&eyelink, line);
		if (result != GZ_OK)
			return result;
	}
	return result == GZ_ERR_END ? GZ_OK : result;
}

const struct gz_recording_reader gz_recording_reader_eyelink = {
	.name = "eyelink",
	.help = "EyeLink .asc with gaze positions",
	.recognises = eyelink_recognises,
	.read = read_eyelink_export,
};
