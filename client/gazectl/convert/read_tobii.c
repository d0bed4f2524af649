/* The reader of tab-separated tables from Tobii's programs: Tobii Pro Lab ("Gaze point left X [DACS
 * px]"), Tobii Studio ("GazePointLeftX (ADCSpx)") and the matrices of the Matlab SDK
 * ("LGazePos2dx"). Columns are found by their names, in any order; the names are those of exports
 * in public data sets. A decimal comma is accepted. */
#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/clock.h"
#include "client/gazectl/convert/recording_format.h"

#define GZ_LOG_MODULE "tobii"

/* Columns of one eye. */
enum eye_column {
	X_NORM,
	Y_NORM,
	X_PX,
	Y_PX,
	X_MM,
	Y_MM,
	VALIDITY,
	PUPIL,
	ORIGIN,
	EYE_COLUMNS = ORIGIN + 3,
};

/* Columns of the line. */
enum line_column { DEVICE_US, HOST_US, HOST_MS, SENSOR, EVENT, WIDTH, HEIGHT, LINE_COLUMNS };

enum { NAMES_MAX = 4, NOWHERE = GZ_TEXT_FIELDS_MAX };

/* Names of columns, reduced to lower-case letters and digits. '?' stands for "left" or "right", '#'
 * for "l" or "r". */
static const char *const eye_names[EYE_COLUMNS][NAMES_MAX] = {
	[X_NORM] = { "gazepoint?xdacsnorm", "#gazepos2dx" },
	[Y_NORM] = { "gazepoint?ydacsnorm", "#gazepos2dy" },
	[X_PX] = { "gazepoint?xdacspx", "gazepoint?xadcspx", "gazepoint?x" },
	[Y_PX] = { "gazepoint?ydacspx", "gazepoint?yadcspx", "gazepoint?y" },
	[X_MM] = { "gazepoint?xdacsmm", "gazepoint?xadcsmm" },
	[Y_MM] = { "gazepoint?ydacsmm", "gazepoint?yadcsmm" },
	[VALIDITY] = { "validity?", "#validity" },
	[PUPIL] = { "pupildiameter?mm", "pupil?", "pupildiameter?", "#pupildm" },
	[ORIGIN] = { "eyeposition?xdacsmm", "eyepos?xadcsmm", "#eyepos3dx" },
	[ORIGIN + 1] = { "eyeposition?ydacsmm", "eyepos?yadcsmm", "#eyepos3dy" },
	[ORIGIN + 2] = { "eyeposition?zdacsmm", "eyepos?zadcsmm", "#eyepos3dz" },
};

static const char *const line_names[LINE_COLUMNS][NAMES_MAX] = {
	[DEVICE_US] = { "eyetrackertimestampus", "eyetrackertimestamp", "time" },
	[HOST_US] = { "recordingtimestampus" },
	[HOST_MS] = { "recordingtimestampms", "recordingtimestamp", "reltimestamp" },
	[SENSOR] = { "sensor" },
	[EVENT] = { "event", "studioevent" },
	[WIDTH] = { "recordingresolutionwidth" },
	[HEIGHT] = { "recordingresolutionheight" },
};

struct columns {
	size_t eye[GZ_EYE_COUNT][EYE_COLUMNS];
	size_t line[LINE_COLUMNS];
};

struct tobii {
	const struct gz_convert_settings *settings;
	struct gz_convert_settings known; /* the settings, completed from the file */
	const struct gz_recording_sink *sink;
	struct gz_convert_counts *counts;
	struct columns columns;
	bool sent_header;
	struct gz_text_fields fields;
	struct gz_gaze_log_record record;
};

/* Reduce the name of a column to lower-case letters and digits. "[μs]" becomes "us". */
static void plain_name(const char *name, char *plain, size_t size)
{
	size_t used = 0;
	for (; *name && used + 1 < size; name++) {
		unsigned char c = (unsigned char)*name, next = (unsigned char)name[1];
		if (isascii(c) && isalnum(c))
			plain[used++] = (char)tolower(c);
		else if ((c == 0xce && next == 0xbc) || (c == 0xc2 && next == 0xb5))
			plain[used++] = 'u';
	}
	plain[used] = '\0';
}

/* Replace '?' or '#' in @p pattern by the side of the eye. */
static void name_of_side(const char *pattern, enum gz_eye eye, char *name, size_t size)
{
	size_t at = strcspn(pattern, "?#");
	const char *side = eye == GZ_EYE_LEFT ? "left" : "right";
	int length = pattern[at] == '#' ? 1 : (int)strlen(side);
	if (pattern[at])
		snprintf(name, size, "%.*s%.*s%s", (int)at, pattern, length, side,
			 pattern + at + 1);
	else
		snprintf(name, size, "%s", pattern);
}

static size_t find_column(const struct gz_text_fields *names, const char *const *patterns,
			  enum gz_eye eye)
{
	char wanted[64], found[128];
	for (int p = 0; p < NAMES_MAX && patterns[p]; p++) {
		name_of_side(patterns[p], eye, wanted, sizeof wanted);
		for (size_t i = 0; i < names->count; i++) {
			plain_name(names->field[i], found, sizeof found);
			if (strcmp(found, wanted) == 0)
				return i;
		}
	}
	return NOWHERE;
}

static bool has_points(const struct columns *columns)
{
	for (int eye = 0; eye < GZ_EYE_COUNT; eye++)
		for (int c = X_NORM; c <= X_MM; c += 2)
			if (columns->eye[eye][c] != NOWHERE && columns->eye[eye][c + 1] != NOWHERE)
				return true;
	return false;
}

static bool find_tobii_columns(const struct gz_text_fields *names, struct columns *columns)
{
	for (int eye = 0; eye < GZ_EYE_COUNT; eye++)
		for (int c = 0; c < EYE_COLUMNS; c++)
			columns->eye[eye][c] = find_column(names, eye_names[c], (enum gz_eye)eye);
	for (int c = 0; c < LINE_COLUMNS; c++)
		columns->line[c] = find_column(names, line_names[c], GZ_EYE_LEFT);
	bool timed = columns->line[DEVICE_US] != NOWHERE || columns->line[HOST_US] != NOWHERE ||
		     columns->line[HOST_MS] != NOWHERE;
	return timed && has_points(columns);
}

static bool tobii_recognises(const char *line)
{
	static const char *const words[] = {
		"Gaze point left X",  "GazePointLeftX",  "LGazePos2dx",
		"Gaze point right X", "GazePointRightX", "RGazePos2dx"
	};
	for (size_t i = 0; i < sizeof words / sizeof *words; i++)
		if (strstr(line, words[i]) && strchr(line, '\t'))
			return true;
	return false;
}

static double field_number(const struct tobii *tobii, size_t column)
{
	return gz_text_field_number(&tobii->fields, column);
}

static bool is_time(double value, double unit_ns)
{
	return fabs(value) * unit_ns < 9e18;
}

/* Read the times of a line. The clock of the recording counts as the host's; without it, the clock
 * of the tracker does. */
static bool take_times(const struct tobii *tobii, struct gz_sample *sample)
{
	double device_us = field_number(tobii, tobii->columns.line[DEVICE_US]);
	double host_us = field_number(tobii, tobii->columns.line[HOST_US]);
	double host_ms = field_number(tobii, tobii->columns.line[HOST_MS]);
	if (is_time(device_us, 1e3))
		sample->device_ns = (int64_t)llround(device_us * 1e3);
	if (is_time(host_us, 1e3))
		sample->host_ns = (int64_t)llround(host_us * 1e3);
	else if (is_time(host_ms, 1e6))
		sample->host_ns = (int64_t)llround(host_ms * 1e6);
	else if (sample->device_ns != GZ_NO_DEVICE_TIME)
		sample->host_ns = sample->device_ns;
	else
		return false;
	return true;
}

/* Whether the validity is "Valid", or a code for an eye that was found with certainty (0) or
 * probably (1). Without the column, true. */
static bool is_valid(const struct tobii *tobii, size_t column)
{
	if (column >= tobii->fields.count)
		return true;
	double code = field_number(tobii, column);
	return isfinite(code) ? code >= 0 && code <= 1
			      : gz_text_begins(tobii->fields.field[column], "valid");
}

/* The point on the normalised display area, from the columns that exist; NaN if there is none. */
static struct gz_point take_tobii_point(const struct tobii *tobii, const size_t *columns)
{
	const struct gz_convert_settings *known = &tobii->known;
	double x = field_number(tobii, columns[X_NORM]), y = field_number(tobii, columns[Y_NORM]);
	if (!isfinite(x) || !isfinite(y)) {
		x = field_number(tobii, columns[X_PX]) / known->display_px[0];
		y = field_number(tobii, columns[Y_PX]) / known->display_px[1];
	}
	if (!isfinite(x) || !isfinite(y)) {
		x = field_number(tobii, columns[X_MM]) / known->display_mm[0];
		y = field_number(tobii, columns[Y_MM]) / known->display_mm[1];
	}
	return gz_recording_point(x, y);
}

static void take_tobii_eye(const struct tobii *tobii, const size_t *columns,
			   struct gz_eye_sample *eye)
{
	eye->point = take_tobii_point(tobii, columns);
	eye->valid = is_valid(tobii, columns[VALIDITY]) && isfinite(eye->point.x);
	double pupil_mm = field_number(tobii, columns[PUPIL]);
	if (pupil_mm > 0)
		eye->pupil_mm = (float)pupil_mm;
	for (int i = 0; i < 3; i++)
		eye->origin_mm[i] = (float)field_number(tobii, columns[ORIGIN + i]);
}

/* Send the header once. The size of the recording is in every line. */
static enum gz_result send_tobii_header(struct tobii *tobii)
{
	if (tobii->sent_header)
		return GZ_OK;
	tobii->sent_header = true;
	for (int i = 0; i < 2; i++) {
		double px = field_number(tobii, tobii->columns.line[WIDTH + i]);
		if (tobii->known.display_px[i] == 0 && px >= 1 && px <= GZ_DISPLAY_SIDE_MAX_PX)
			tobii->known.display_px[i] = (int)px;
	}
	struct gz_gaze_log_header header = gz_recording_header(&tobii->known, "Tobii");
	return tobii->sink->header(tobii->sink->user, &header);
}

static enum gz_result take_tobii_event(struct tobii *tobii, int64_t host_ns)
{
	size_t column = tobii->columns.line[EVENT];
	if (column >= tobii->fields.count || !tobii->fields.field[column][0])
		return GZ_OK;
	tobii->record.kind = GZ_GAZE_LOG_MARK;
	tobii->record.host_ns = host_ns;
	gz_text_copy(tobii->record.text, sizeof tobii->record.text, tobii->fields.field[column]);
	return tobii->sink->record(tobii->sink->user, &tobii->record);
}

static bool is_of_another_sensor(const struct tobii *tobii)
{
	size_t column = tobii->columns.line[SENSOR];
	return column < tobii->fields.count && tobii->fields.field[column][0] &&
	       !gz_text_begins(tobii->fields.field[column], "eye");
}

static bool has_measurement(const struct gz_sample *sample)
{
	for (int eye = 0; eye < GZ_EYE_COUNT; eye++)
		if (isfinite(sample->eye[eye].point.x) || isfinite(sample->eye[eye].origin_mm[0]))
			return true;
	return false;
}

static enum gz_result take_tobii_line(struct tobii *tobii, char *line)
{
	struct gz_sample *sample = &tobii->record.sample;
	gz_text_split(line, '\t', &tobii->fields);
	enum gz_result result = send_tobii_header(tobii);
	if (result != GZ_OK)
		return result;
	*sample = gz_sample_unmeasured();
	if (!take_times(tobii, sample)) {
		tobii->counts->skipped++;
		return GZ_OK;
	}
	result = take_tobii_event(tobii, sample->host_ns);
	if (result != GZ_OK || is_of_another_sensor(tobii))
		return result;
	for (int eye = 0; eye < GZ_EYE_COUNT; eye++)
		take_tobii_eye(tobii, tobii->columns.eye[eye], &sample->eye[eye]);
	/* A line for an event only has no time of the tracker and no measurement. A line for lost
	 * gaze has the time. */
	if (!has_measurement(sample) && sample->device_ns == GZ_NO_DEVICE_TIME &&
	    tobii->columns.line[DEVICE_US] != NOWHERE)
		return GZ_OK;
	sample->seq = tobii->counts->samples++;
	tobii->record.kind = GZ_GAZE_LOG_SAMPLE;
	return tobii->sink->record(tobii->sink->user, &tobii->record);
}

static bool needs_px(const struct tobii *tobii)
{
	const struct columns *columns = &tobii->columns;
	const size_t *eye = columns->eye[GZ_EYE_LEFT][X_PX] != NOWHERE ? columns->eye[GZ_EYE_LEFT]
								       : columns->eye[GZ_EYE_RIGHT];
	return eye[X_PX] != NOWHERE && eye[X_NORM] == NOWHERE && tobii->known.display_px[0] == 0 &&
	       columns->line[WIDTH] == NOWHERE && tobii->known.display_mm[0] == 0;
}

static enum gz_result read_tobii_columns(struct tobii *tobii, struct gz_text_lines *lines)
{
	char *line;
	const struct gz_log *log = tobii->settings->log;
	if (gz_text_lines_next(lines, &line) == GZ_OK) {
		gz_text_split(line, '\t', &tobii->fields);
		if (find_tobii_columns(&tobii->fields, &tobii->columns)) {
			if (!needs_px(tobii))
				return GZ_OK;
			gz_err(log,
			       "%s: the points are in pixels, but the size of the display is "
			       "missing; give it with --display.px WxH",
			       tobii->settings->name);
			return GZ_ERR_FORMAT;
		}
	}
	gz_err(log,
	       "%s:1: there are no columns for a timestamp and for the gaze points of an eye; "
	       "export them from Tobii Pro Lab as a single standard file (.tsv)",
	       tobii->settings->name);
	return GZ_ERR_FORMAT;
}

static enum gz_result read_tobii_export(struct gz_text_lines *lines,
					const struct gz_convert_settings *settings,
					const struct gz_recording_sink *sink,
					struct gz_convert_counts *counts)
{
	struct tobii tobii = {
		.settings = settings, .known = *settings, .sink = sink, .counts = counts
	};
	char *line;
	enum gz_result result = read_tobii_columns(&tobii, lines);
	while (result == GZ_OK || result == GZ_ERR_FULL) {
		result = gz_text_lines_next(lines, &line);
		if (result == GZ_OK && line[0])
			result = take_tobii_line(&tobii, line);
		else if (result == GZ_ERR_FULL)
			counts->skipped++;
	}
	return result == GZ_ERR_END ? GZ_OK : result;
}

const struct gz_recording_reader gz_recording_reader_tobii = {
	.name = "tobii",
	.help = ".tsv from Tobii Pro Lab or Tobii Studio",
	.recognises = tobii_recognises,
	.read = read_tobii_export,
};
