/* The reader of gaze_positions.csv as Pupil Player exports it (docs.pupil-labs.com, "Raw data
 * exporter"): a line for each gaze datum, columns named in the first line, norm_pos with its origin
 * at the bottom left of the scene camera's picture, eye 0 is the right eye. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/clock.h"
#include "client/gazectl/convert/recording_format.h"

#define GZ_LOG_MODULE "pupil"

enum column {
	TIME,
	CONFIDENCE,
	X,
	Y,
	BASE_DATA,
	CENTER0,
	NORMAL0 = CENTER0 + 3,
	CENTER1 = NORMAL0 + 3,
	NORMAL1 = CENTER1 + 3,
	COLUMN_COUNT = NORMAL1 + 3,
};

/* Names of the columns. gaze_timestamp is called "timestamp" by versions before 1.8. */
static const char *const column_names[COLUMN_COUNT] = {
	"gaze_timestamp",   "confidence",       "norm_pos_x",       "norm_pos_y",
	"base_data",        "eye_center0_3d_x", "eye_center0_3d_y", "eye_center0_3d_z",
	"gaze_normal0_x",   "gaze_normal0_y",   "gaze_normal0_z",   "eye_center1_3d_x",
	"eye_center1_3d_y", "eye_center1_3d_z", "gaze_normal1_x",   "gaze_normal1_y",
	"gaze_normal1_z",
};

static bool pupil_recognises(const char *line)
{
	return strstr(line, "norm_pos_x") && strstr(line, "norm_pos_y") &&
	       strstr(line, "timestamp") && strchr(line, ',');
}

/* Find the index of each column, GZ_TEXT_FIELDS_MAX for a missing one. @return whether the
 * necessary ones exist */
static bool find_pupil_columns(const struct gz_text_fields *names, size_t columns[COLUMN_COUNT])
{
	for (int c = 0; c < COLUMN_COUNT; c++) {
		columns[c] = GZ_TEXT_FIELDS_MAX;
		for (size_t i = 0; i < names->count; i++)
			if (strcmp(names->field[i], column_names[c]) == 0 ||
			    (c == TIME && strcmp(names->field[i], "timestamp") == 0))
				columns[c] = i;
	}
	return columns[TIME] < GZ_TEXT_FIELDS_MAX && columns[CONFIDENCE] < GZ_TEXT_FIELDS_MAX &&
	       columns[X] < GZ_TEXT_FIELDS_MAX && columns[Y] < GZ_TEXT_FIELDS_MAX;
}

/* The eyes from which a datum was computed: base_data is "<time>-<eye> …". Without it, both. */
static void find_eyes(const struct gz_text_fields *fields, size_t column, bool eyes[GZ_EYE_COUNT])
{
	eyes[GZ_EYE_RIGHT] = eyes[GZ_EYE_LEFT] = true;
	if (column >= fields->count || !fields->field[column][0])
		return;
	eyes[GZ_EYE_RIGHT] = strstr(fields->field[column], "-0") != NULL;
	eyes[GZ_EYE_LEFT] = strstr(fields->field[column], "-1") != NULL;
}

static void take_pupil_eye(const struct gz_text_fields *fields, const size_t *center,
			   const size_t *normal, struct gz_eye_sample *eye)
{
	for (int i = 0; i < 3; i++) {
		eye->origin_mm[i] = (float)gz_text_field_number(fields, center[i]);
		eye->direction[i] = (float)gz_text_field_number(fields, normal[i]);
	}
}

static bool take_pupil_sample(const struct gz_text_fields *fields,
			      const size_t columns[COLUMN_COUNT], struct gz_sample *out_sample)
{
	bool eyes[GZ_EYE_COUNT];
	double time_s = gz_text_field_number(fields, columns[TIME]);
	double confidence = gz_text_field_number(fields, columns[CONFIDENCE]);
	double x = gz_text_field_number(fields, columns[X]);
	double y = gz_text_field_number(fields, columns[Y]);
	if (!(fabs(time_s) < 9e9) || !(confidence >= 0 && confidence <= 1))
		return false;
	*out_sample = gz_sample_unmeasured();
	out_sample->host_ns = (int64_t)llround(time_s * (double)GZ_NS_PER_S);
	find_eyes(fields, columns[BASE_DATA], eyes);
	for (int e = 0; e < GZ_EYE_COUNT; e++) {
		struct gz_eye_sample *eye = &out_sample->eye[e];
		if (!eyes[e])
			continue;
		take_pupil_eye(fields, &columns[e == GZ_EYE_RIGHT ? CENTER0 : CENTER1],
			       &columns[e == GZ_EYE_RIGHT ? NORMAL0 : NORMAL1], eye);
		eye->confidence = (float)confidence;
		eye->point = gz_recording_point(x, 1 - y);
		/* For Pupil a datum with confidence 0 is not a measurement. */
		eye->valid = confidence > 0 && isfinite(eye->point.x);
	}
	return true;
}

static enum gz_result read_pupil_columns(struct gz_text_lines *lines,
					 const struct gz_convert_settings *settings,
					 size_t columns[COLUMN_COUNT])
{
	char *line;
	struct gz_text_fields names;
	enum gz_result result = gz_text_lines_next(lines, &line);
	if (result == GZ_OK) {
		gz_text_split(line, ',', &names);
		if (find_pupil_columns(&names, columns))
			return GZ_OK;
	}
	gz_err(settings->log,
	       "%s:1: the columns gaze_timestamp, confidence, norm_pos_x and norm_pos_y are needed",
	       settings->name);
	return GZ_ERR_FORMAT;
}

static enum gz_result read_pupil_export(struct gz_text_lines *lines,
					const struct gz_convert_settings *settings,
					const struct gz_recording_sink *sink,
					struct gz_convert_counts *counts)
{
	size_t columns[COLUMN_COUNT];
	struct gz_text_fields fields;
	struct gz_gaze_log_record record = { .kind = GZ_GAZE_LOG_SAMPLE };
	enum gz_result result = read_pupil_columns(lines, settings, columns);
	if (result != GZ_OK)
		return result;
	gz_warn(settings->log,
		"%s: the points are in the picture of the scene camera, not on a display",
		settings->name);
	struct gz_gaze_log_header header = gz_recording_header(settings, "Pupil");
	header.scene_camera = true;
	char *line;
	result = sink->header(sink->user, &header);
	while (result == GZ_OK || result == GZ_ERR_FULL) {
		result = gz_text_lines_next(lines, &line);
		if (result == GZ_OK && line[0]) {
			gz_text_split(line, ',', &fields);
			if (take_pupil_sample(&fields, columns, &record.sample)) {
				record.sample.seq = counts->samples++;
				result = sink->record(sink->user, &record);
			} else {
				counts->skipped++;
			}
		} else if (result == GZ_ERR_FULL) {
			counts->skipped++;
		}
	}
	return result == GZ_ERR_END ? GZ_OK : result;
}

const struct gz_recording_reader gz_recording_reader_pupil = {
	.name = "pupil",
	.help = "Pupil's gaze_positions.csv",
	.recognises = pupil_recognises,
	.read = read_pupil_export,
};
