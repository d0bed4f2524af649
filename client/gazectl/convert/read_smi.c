/* The reader of samples that SMI's IDF Converter and BeGaze export as text: lines "## Key:\tvalue",
 * a line that names the columns, then lines of type SMP (samples) and MSG (messages), separated by
 * tabs. Times are in us, points ("L POR X [px]") in pixels of the calibration area; a point 0 0 was
 * not measured. Diameters of pupils are in mm ("L Mapped Diameter [mm]") or in pixels of the eye
 * camera ("L Dia X [px]"). The columns are those of files in public data sets. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/clock.h"
#include "client/gazectl/convert/recording_format.h"

#define GZ_LOG_MODULE "smi"

enum { SMI_TIME, SMI_TYPE, SMI_TRIAL, SMI_LINE_COLUMNS };

enum { SMI_X, SMI_Y, SMI_PUPIL_MM, SMI_PUPIL_PX, SMI_EYE_COLUMNS };

static const char *const smi_line_names[SMI_LINE_COLUMNS] = { "Time", "Type", "Trial" };

/* '#' stands for L or R. */
static const char *const smi_eye_names[SMI_EYE_COLUMNS] = {
	[SMI_X] = "# POR X [px]",
	[SMI_Y] = "# POR Y [px]",
	[SMI_PUPIL_MM] = "# Mapped Diameter [mm]",
	[SMI_PUPIL_PX] = "# Dia X [px]",
};

struct smi {
	struct gz_text_lines *lines;
	struct gz_convert_settings known; /* the settings, completed from the file */
	const struct gz_recording_sink *sink;
	struct gz_convert_counts *counts;
	bool named; /* the columns */
	bool pupil_mm;
	size_t line[SMI_LINE_COLUMNS];
	size_t eye[GZ_EYE_COUNT][SMI_EYE_COLUMNS];
	double trial; /* of the last line; NaN before the first */
	struct gz_text_fields fields;
	struct gz_gaze_log_record record;
};

static bool smi_recognises(const char *line)
{
	return gz_text_begins(line, "## [iView]") || gz_text_begins(line, "## [BeGaze]");
}

/* Take "## Key:\tvalue\tvalue". What the user has given counts more. */
static void take_smi_setting(struct smi *smi, const char *text)
{
	static const char rate[] = "Sample Rate:", area[] = "Calibration Area:";
	static const char size[] = "Stimulus Dimension [mm]:", distance[] = "Head Distance [mm]:";
	struct gz_convert_settings *known = &smi->known;
	double value[2] = { 0, 0 };
	const char *values = strchr(text, ':');
	if (!values++)
		return;
	for (int i = 0; i < 2 && gz_text_take_number(&values, &value[i]); i++)
		;
	if (gz_text_begins(text, rate) && known->rate_hz == 0 && value[0] > 0 && value[0] <= 1e5)
		known->rate_hz = value[0];
	else if (gz_text_begins(text, distance) && known->distance_mm == 0 && value[0] > 0)
		known->distance_mm = value[0];
	for (int i = 0; i < 2; i++) {
		if (gz_text_begins(text, area) && known->display_px[i] == 0 && value[i] >= 1 &&
		    value[i] <= GZ_DISPLAY_SIDE_MAX_PX)
			known->display_px[i] = (int)value[i];
		if (gz_text_begins(text, size) && known->display_mm[i] == 0 && value[i] > 0)
			known->display_mm[i] = value[i];
	}
}

static size_t find_smi_column(const struct gz_text_fields *names, const char *pattern, char side)
{
	char name[32];
	snprintf(name, sizeof name, "%s", pattern);
	if (name[0] == '#')
		name[0] = side;
	for (size_t i = 0; i < names->count; i++)
		if (strcmp(names->field[i], name) == 0)
			return i;
	return GZ_TEXT_FIELDS_MAX;
}

static bool find_smi_columns(struct smi *smi)
{
	bool points = false;
	for (int c = 0; c < SMI_LINE_COLUMNS; c++)
		smi->line[c] = find_smi_column(&smi->fields, smi_line_names[c], ' ');
	for (int eye = 0; eye < GZ_EYE_COUNT; eye++) {
		size_t *columns = smi->eye[eye];
		for (int c = 0; c < SMI_EYE_COLUMNS; c++)
			columns[c] = find_smi_column(&smi->fields, smi_eye_names[c],
						     eye == GZ_EYE_LEFT ? 'L' : 'R');
		points |=
			columns[SMI_X] < GZ_TEXT_FIELDS_MAX && columns[SMI_Y] < GZ_TEXT_FIELDS_MAX;
		smi->pupil_mm |= columns[SMI_PUPIL_MM] < GZ_TEXT_FIELDS_MAX;
	}
	return points && smi->line[SMI_TIME] < GZ_TEXT_FIELDS_MAX;
}

static enum gz_result take_smi_columns(struct smi *smi, char *line)
{
	const struct gz_log *log = smi->known.log;
	gz_text_split(line, '\t', &smi->fields);
	smi->named = true;
	if (!find_smi_columns(smi)) {
		gz_err(log,
		       "%s:%llu: there are no columns Time and L POR X [px] (or R …); export the "
		       "samples with the point of regard",
		       smi->known.name, (unsigned long long)gz_text_lines_number(smi->lines));
		return GZ_ERR_FORMAT;
	}
	if (smi->known.display_px[0] == 0 || smi->known.display_px[1] == 0) {
		gz_err(log,
		       "%s: no Calibration Area before the samples; give the size of the display "
		       "with --display.px WxH",
		       smi->known.name);
		return GZ_ERR_FORMAT;
	}
	struct gz_gaze_log_header header = gz_recording_header(&smi->known, "SMI");
	if (!smi->pupil_mm)
		snprintf(header.pupil_unit, sizeof header.pupil_unit,
			 "arbitrary (SMI px of the eye camera)");
	return smi->sink->header(smi->sink->user, &header);
}

static void take_smi_eye(const struct smi *smi, const size_t *columns, struct gz_eye_sample *eye)
{
	double x_px = gz_text_field_number(&smi->fields, columns[SMI_X]);
	double y_px = gz_text_field_number(&smi->fields, columns[SMI_Y]);
	double pupil = gz_text_field_number(&smi->fields,
					    columns[smi->pupil_mm ? SMI_PUPIL_MM : SMI_PUPIL_PX]);
	if (x_px != 0 || y_px != 0)
		eye->point = gz_recording_point(x_px / smi->known.display_px[0],
						y_px / smi->known.display_px[1]);
	eye->valid = isfinite(eye->point.x);
	if (pupil > 0 && pupil < 1e9)
		eye->pupil_mm = (float)pupil; /* or px, as the header says */
}

static enum gz_result send_smi_mark(struct smi *smi)
{
	static const char prefix[] = "# Message: ";
	size_t column = smi->line[SMI_TRIAL] + 1;
	const char *text = column < smi->fields.count ? smi->fields.field[column] : "";
	if (gz_text_begins(text, prefix))
		text += sizeof prefix - 1;
	smi->record.kind = GZ_GAZE_LOG_MARK;
	gz_text_copy(smi->record.text, sizeof smi->record.text, text);
	return smi->sink->record(smi->sink->user, &smi->record);
}

static enum gz_result send_smi_sample(struct smi *smi)
{
	struct gz_sample *sample = &smi->record.sample;
	*sample = gz_sample_unmeasured();
	sample->seq = smi->counts->samples++;
	sample->host_ns = sample->device_ns = smi->record.host_ns;
	for (int eye = 0; eye < GZ_EYE_COUNT; eye++)
		take_smi_eye(smi, smi->eye[eye], &sample->eye[eye]);
	smi->record.kind = GZ_GAZE_LOG_SAMPLE;
	return smi->sink->record(smi->sink->user, &smi->record);
}

/* Between trials the recording was paused. */
static enum gz_result follow_trial(struct smi *smi)
{
	double trial = gz_text_field_number(&smi->fields, smi->line[SMI_TRIAL]);
	bool next = isfinite(trial) && isfinite(smi->trial) && trial != smi->trial;
	smi->trial = isfinite(trial) ? trial : smi->trial;
	if (!next)
		return GZ_OK;
	smi->record.kind = GZ_GAZE_LOG_GAP;
	smi->record.missing = 0;
	snprintf(smi->record.text, sizeof smi->record.text, "recording was paused");
	return smi->sink->record(smi->sink->user, &smi->record);
}

static enum gz_result take_smi_data(struct smi *smi, char *line)
{
	gz_text_split(line, '\t', &smi->fields);
	double time_us = gz_text_field_number(&smi->fields, smi->line[SMI_TIME]);
	const char *type = smi->line[SMI_TYPE] < smi->fields.count
				   ? smi->fields.field[smi->line[SMI_TYPE]]
				   : "SMP";
	bool mark = strcmp(type, "MSG") == 0;
	if (!(fabs(time_us) < 9e15) || (!mark && strcmp(type, "SMP") != 0)) {
		smi->counts->skipped++;
		return GZ_OK;
	}
	smi->record.host_ns = (int64_t)llround(time_us * (double)GZ_NS_PER_US);
	enum gz_result result = follow_trial(smi);
	if (result != GZ_OK)
		return result;
	return mark ? send_smi_mark(smi) : send_smi_sample(smi);
}

static enum gz_result take_smi_line(struct smi *smi, char *line)
{
	if (line[0] == '\0')
		return GZ_OK;
	if (gz_text_begins(line, "## ")) {
		if (!smi->named)
			take_smi_setting(smi, line + strlen("## "));
		return GZ_OK;
	}
	return smi->named ? take_smi_data(smi, line) : take_smi_columns(smi, line);
}

static enum gz_result read_smi_export(struct gz_text_lines *lines,
				      const struct gz_convert_settings *settings,
				      const struct gz_recording_sink *sink,
				      struct gz_convert_counts *counts)
{
	struct smi smi = {
		.lines = lines, .known = *settings, .sink = sink, .counts = counts, .trial = NAN
	};
	char *line;
	enum gz_result result = GZ_OK;
	while (result == GZ_OK || result == GZ_ERR_FULL) {
		result = gz_text_lines_next(lines, &line);
		if (result == GZ_OK)
			result = take_smi_line(&smi, line);
		else if (result == GZ_ERR_FULL)
			counts->skipped++;
	}
	return result == GZ_ERR_END ? GZ_OK : result;
}

const struct gz_recording_reader gz_recording_reader_smi = {
	.name = "smi",
	.help = "samples exported as text by SMI's IDF Converter or BeGaze",
	.recognises = smi_recognises,
	.read = read_smi_export,
};
