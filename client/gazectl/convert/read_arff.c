/* The reader of ARFF files as the GazeCom data set and sp_tool have them (Agtzidis, Startsev and
 * Dorr, "In the pursuit of (ground) truth", 2016): "@ATTRIBUTE" names each column, "%@METADATA"
 * gives the display, and lines of values follow "@DATA". Times are in us, points in pixels from the
 * top left corner, of both eyes together; confidence 0 means that nothing was measured. Other
 * columns, as labels of coders, are ignored. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/clock.h"
#include "client/gazectl/convert/recording_format.h"

#define GZ_LOG_MODULE "arff"

enum arff_column { ARFF_TIME, ARFF_X, ARFF_Y, ARFF_CONFIDENCE, ARFF_COLUMNS };

struct arff {
	struct gz_text_lines *lines;
	struct gz_convert_settings known; /* the settings, completed from the file */
	const struct gz_recording_sink *sink;
	struct gz_convert_counts *counts;
	size_t attributes; /* so far */
	size_t columns[ARFF_COLUMNS];
	bool data; /* @DATA has come */
	struct gz_gaze_log_record record;
};

static bool arff_recognises(const char *line)
{
	return gz_text_begins(line, "@relation") || gz_text_begins(line, "%@METADATA");
}

/* Take "%@METADATA width_px 1280.0": what the user has given counts more. */
static void take_metadata(struct arff *arff, const char *text)
{
	static const char *const px_names[] = { "width_px", "height_px" };
	static const char *const mm_names[] = { "width_mm", "height_mm" };
	static const char distance_name[] = "distance_mm";
	double value;
	text += strspn(text, " \t");
	size_t length = strcspn(text, " \t");
	const char *number = text + length;
	if (!gz_text_take_number(&number, &value) || !(value > 0 && value <= 1e5))
		return;
	for (int i = 0; i < 2; i++) {
		if (strncmp(text, px_names[i], length) == 0 && arff->known.display_px[i] == 0 &&
		    value >= 1 && value <= GZ_DISPLAY_SIDE_MAX_PX)
			arff->known.display_px[i] = (int)value;
		if (strncmp(text, mm_names[i], length) == 0 && arff->known.display_mm[i] == 0)
			arff->known.display_mm[i] = value;
	}
	if (strncmp(text, distance_name, length) == 0 && arff->known.distance_mm == 0)
		arff->known.distance_mm = value;
}

/* Take "@ATTRIBUTE x NUMERIC"; its place among the attributes is its column. */
static void take_attribute(struct arff *arff, const char *text)
{
	static const char *const names[ARFF_COLUMNS] = { "time", "x", "y", "confidence" };
	text += strspn(text, " \t'\"");
	size_t length = strcspn(text, " \t'\"");
	for (int c = 0; c < ARFF_COLUMNS; c++)
		if (strlen(names[c]) == length && gz_text_begins(text, names[c]))
			arff->columns[c] = arff->attributes;
	arff->attributes++;
}

static enum gz_result begin_arff_data(struct arff *arff)
{
	const struct gz_log *log = arff->known.log;
	arff->data = true;
	if (arff->columns[ARFF_TIME] == GZ_TEXT_FIELDS_MAX ||
	    arff->columns[ARFF_X] == GZ_TEXT_FIELDS_MAX ||
	    arff->columns[ARFF_Y] == GZ_TEXT_FIELDS_MAX) {
		gz_err(log, "%s:%llu: the attributes time, x and y are needed", arff->known.name,
		       (unsigned long long)gz_text_lines_number(arff->lines));
		return GZ_ERR_FORMAT;
	}
	if (arff->known.display_px[0] == 0 || arff->known.display_px[1] == 0) {
		gz_err(log,
		       "%s: the points are in pixels, but the size of the display is missing; give "
		       "it with --display.px WxH",
		       arff->known.name);
		return GZ_ERR_FORMAT;
	}
	const struct gz_gaze_log_header header = gz_recording_header(&arff->known, "ARFF");
	return arff->sink->header(arff->sink->user, &header);
}

static enum gz_result take_arff_values(struct arff *arff, char *line)
{
	struct gz_text_fields fields;
	struct gz_sample *sample = &arff->record.sample;
	gz_text_split(line, ',', &fields);
	double time_us = gz_text_field_number(&fields, arff->columns[ARFF_TIME]);
	if (!(fabs(time_us) < 9e15)) {
		arff->counts->skipped++;
		return GZ_OK;
	}
	*sample = gz_sample_unmeasured();
	sample->seq = arff->counts->samples++;
	sample->host_ns = (int64_t)llround(time_us * (double)GZ_NS_PER_US);
	double x_px = gz_text_field_number(&fields, arff->columns[ARFF_X]);
	double y_px = gz_text_field_number(&fields, arff->columns[ARFF_Y]);
	double confidence = gz_text_field_number(&fields, arff->columns[ARFF_CONFIDENCE]);
	sample->point = gz_recording_point(x_px / arff->known.display_px[0],
					   y_px / arff->known.display_px[1]);
	sample->valid = isfinite(sample->point.x) && !(confidence <= 0);
	arff->record.kind = GZ_GAZE_LOG_SAMPLE;
	return arff->sink->record(arff->sink->user, &arff->record);
}

static enum gz_result take_arff_line(struct arff *arff, char *line)
{
	static const char metadata[] = "%@METADATA", attribute[] = "@ATTRIBUTE", data[] = "@DATA";
	if (gz_text_begins(line, metadata))
		take_metadata(arff, line + sizeof metadata - 1);
	else if (gz_text_begins(line, attribute))
		take_attribute(arff, line + sizeof attribute - 1);
	else if (gz_text_begins(line, data))
		return arff->data ? GZ_OK : begin_arff_data(arff);
	else if (arff->data && line[0] && line[0] != '%')
		return take_arff_values(arff, line);
	return GZ_OK;
}

static enum gz_result read_arff_file(struct gz_text_lines *lines,
				     const struct gz_convert_settings *settings,
				     const struct gz_recording_sink *sink,
				     struct gz_convert_counts *counts)
{
	struct arff arff = { .lines = lines, .known = *settings, .sink = sink, .counts = counts };
	char *line;
	enum gz_result result = GZ_OK;
	for (int c = 0; c < ARFF_COLUMNS; c++)
		arff.columns[c] = GZ_TEXT_FIELDS_MAX;
	while (result == GZ_OK || result == GZ_ERR_FULL) {
		result = gz_text_lines_next(lines, &line);
		if (result == GZ_OK)
			result = take_arff_line(&arff, line);
		else if (result == GZ_ERR_FULL)
			counts->skipped++;
	}
	return result == GZ_ERR_END ? GZ_OK : result;
}

const struct gz_recording_reader gz_recording_reader_arff = {
	.name = "arff",
	.help = ".arff of GazeCom and sp_tool",
	.recognises = arff_recognises,
	.read = read_arff_file,
};
