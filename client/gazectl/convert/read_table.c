/* The reader of any table with named columns, separated by tabs, semicolons or commas, whichever
 * the first line has. The user says what the columns are (struct gz_convert_table). */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/clock.h"
#include "client/gazectl/convert/recording_format.h"

#define GZ_LOG_MODULE "table"

enum table_column {
	T_TIME,
	T_X,
	T_Y,
	T_CONFIDENCE,
	T_RIGHT_X,
	T_RIGHT_Y,
	T_RIGHT_CONFIDENCE,
	T_RIGHT_PUPIL,
	T_LEFT_X,
	T_LEFT_Y,
	T_LEFT_CONFIDENCE,
	T_LEFT_PUPIL,
	T_MARK,
	TABLE_COLUMNS,
};

/* As in --table.columns. */
static const char *const meanings[TABLE_COLUMNS] = {
	[T_TIME] = "time",
	[T_X] = "x",
	[T_Y] = "y",
	[T_CONFIDENCE] = "confidence",
	[T_RIGHT_X] = "right_x",
	[T_RIGHT_Y] = "right_y",
	[T_RIGHT_CONFIDENCE] = "right_confidence",
	[T_RIGHT_PUPIL] = "right_pupil_mm",
	[T_LEFT_X] = "left_x",
	[T_LEFT_Y] = "left_y",
	[T_LEFT_CONFIDENCE] = "left_confidence",
	[T_LEFT_PUPIL] = "left_pupil_mm",
	[T_MARK] = "mark",
};

static const double time_unit_ns[] = {
	[GZ_TABLE_S] = 1e9, [GZ_TABLE_MS] = 1e6, [GZ_TABLE_US] = 1e3, [GZ_TABLE_NS] = 1
};

struct table {
	const struct gz_convert_settings *settings;
	const struct gz_recording_sink *sink;
	struct gz_convert_counts *counts;
	char separator;
	size_t columns[TABLE_COLUMNS];
	size_t where; /* column of which lines must have a value; GZ_TEXT_FIELDS_MAX: none */
	const char *value;
	double side[2]; /* what is 1 in x and y */
	struct gz_text_fields fields;
	struct gz_gaze_log_record record;
};

/* Whether @p text, of @p length bytes, is @p name. */
static bool is_name(const char *text, size_t length, const char *name)
{
	return strlen(name) == length && memcmp(text, name, length) == 0;
}

static size_t find_named_column(const struct gz_text_fields *names, const char *name, size_t length)
{
	for (size_t i = 0; i < names->count; i++)
		if (is_name(name, length, names->field[i]))
			return i;
	return GZ_TEXT_FIELDS_MAX;
}

/* Take one "meaning=column". */
static enum gz_result take_assignment(struct table *table, const char *text, size_t length)
{
	const struct gz_convert_settings *settings = table->settings;
	const char *equals = memchr(text, '=', length);
	size_t name_length = equals ? (size_t)(equals - text) : length;
	int c = 0;
	while (c < TABLE_COLUMNS && !is_name(text, name_length, meanings[c]))
		c++;
	if (c == TABLE_COLUMNS || !equals) {
		gz_err(settings->log,
		       "--table.columns: \"%.*s\" is not MEANING=COLUMN; meanings: time, x, y, "
		       "confidence, left_x, left_y, left_confidence, left_pupil_mm, the same with "
		       "right_, mark",
		       (int)length, text);
		return GZ_ERR_FORMAT;
	}
	table->columns[c] = find_named_column(&table->fields, equals + 1, length - name_length - 1);
	if (table->columns[c] < GZ_TEXT_FIELDS_MAX)
		return GZ_OK;
	gz_err(settings->log, "%s:1: there is no column \"%.*s\"", settings->name,
	       (int)(length - name_length - 1), equals + 1);
	return GZ_ERR_FORMAT;
}

static enum gz_result take_assignments(struct table *table)
{
	const char *given = table->settings->table.columns, *text = given ? given : "";
	enum gz_result result = GZ_OK;
	for (int c = 0; c < TABLE_COLUMNS; c++)
		table->columns[c] = GZ_TEXT_FIELDS_MAX;
	while (result == GZ_OK && *text) {
		size_t length = strcspn(text, ";");
		result = take_assignment(table, text, length);
		text += length + (text[length] == ';');
	}
	return result;
}

/* Take --table.where COLUMN=VALUE. */
static enum gz_result take_condition(struct table *table)
{
	const char *given = table->settings->table.where, *text = given ? given : "";
	const char *equals = strchr(text, '=');
	table->where = GZ_TEXT_FIELDS_MAX;
	if (!text[0])
		return GZ_OK;
	if (equals)
		table->where = find_named_column(&table->fields, text, (size_t)(equals - text));
	table->value = equals ? equals + 1 : "";
	if (table->where < GZ_TEXT_FIELDS_MAX)
		return GZ_OK;
	gz_err(table->settings->log,
	       "--table.where: \"%s\" is not COLUMN=VALUE with a column of %s", text,
	       table->settings->name);
	return GZ_ERR_FORMAT;
}

static bool has_column(const struct table *table, enum table_column column)
{
	return table->columns[column] < GZ_TEXT_FIELDS_MAX;
}

/* What is missing, or NULL. */
static const char *missing_in_table(const struct table *table)
{
	const struct gz_convert_settings *settings = table->settings;
	bool points = (has_column(table, T_X) && has_column(table, T_Y)) ||
		      (has_column(table, T_LEFT_X) && has_column(table, T_LEFT_Y)) ||
		      (has_column(table, T_RIGHT_X) && has_column(table, T_RIGHT_Y));
	if (!points)
		return "name the columns of x and y, as in --table.columns \"time=t;x=gx;y=gy\"";
	if (!has_column(table, T_TIME) && settings->rate_hz == 0)
		return "name the column of the time, or give --rate-hz for lines at equal "
		       "intervals";
	if (settings->table.points == GZ_TABLE_PX &&
	    (settings->display_px[0] == 0 || settings->display_px[1] == 0))
		return "the points are in pixels: give --display.px WxH, or --table.points "
		       "fraction";
	if (settings->table.points == GZ_TABLE_MM &&
	    (settings->display_mm[0] == 0 || settings->display_mm[1] == 0))
		return "the points are in mm: give --display.mm \"W H\"";
	return NULL;
}

static void choose_sides(struct table *table)
{
	const struct gz_convert_settings *settings = table->settings;
	for (int i = 0; i < 2; i++)
		table->side[i] = settings->table.points == GZ_TABLE_PX   ? settings->display_px[i]
				 : settings->table.points == GZ_TABLE_MM ? settings->display_mm[i]
									 : 1;
}

static enum gz_result read_table_columns(struct table *table, struct gz_text_lines *lines)
{
	char *line;
	enum gz_result result = gz_text_lines_next(lines, &line);
	if (result != GZ_OK)
		return result == GZ_ERR_END || result == GZ_ERR_FULL ? GZ_ERR_FORMAT : result;
	table->separator = strchr(line, '\t') ? '\t' : strchr(line, ';') ? ';' : ',';
	gz_text_split(line, table->separator, &table->fields);
	result = take_assignments(table);
	if (result == GZ_OK)
		result = take_condition(table);
	if (result != GZ_OK)
		return result;
	const char *missing = missing_in_table(table);
	if (missing) {
		gz_err(table->settings->log, "%s: %s", table->settings->name, missing);
		return GZ_ERR_FORMAT;
	}
	choose_sides(table);
	struct gz_gaze_log_header header = gz_recording_header(table->settings, "table");
	return table->sink->header(table->sink->user, &header);
}

static double table_number(const struct table *table, enum table_column column)
{
	return gz_text_field_number(&table->fields, table->columns[column]);
}

/* A point, and whether it was measured: both coordinates are there, and the confidence, if there is
 * one, is above 0. @param first  the column of x; those of y and of the confidence follow */
static bool take_table_point(const struct table *table, enum table_column first,
			     struct gz_point *out_point)
{
	*out_point = gz_recording_point(table_number(table, first) / table->side[0],
					table_number(table, first + 1) / table->side[1]);
	return isfinite(out_point->x) && !(table_number(table, first + 2) <= 0);
}

static void take_table_eye(const struct table *table, enum table_column first,
			   struct gz_eye_sample *eye)
{
	double confidence = table_number(table, first + 2);
	double pupil_mm = table_number(table, first + 3);
	eye->valid = take_table_point(table, first, &eye->point);
	if (confidence >= 0 && confidence <= 1)
		eye->confidence = (float)confidence;
	if (pupil_mm > 0 && pupil_mm < 100)
		eye->pupil_mm = (float)pupil_mm;
}

/* The time of a line; without a column, that of the line with this number. */
static bool take_table_time(const struct table *table, int64_t *out_ns)
{
	const struct gz_convert_settings *settings = table->settings;
	double ns = has_column(table, T_TIME)
			    ? table_number(table, T_TIME) * time_unit_ns[settings->table.time_unit]
			    : (double)table->counts->samples * 1e9 / settings->rate_hz;
	if (!(fabs(ns) < 9e18))
		return false;
	*out_ns = (int64_t)llround(ns);
	return true;
}

static enum gz_result take_table_mark(struct table *table)
{
	size_t column = table->columns[T_MARK];
	if (column >= table->fields.count || !table->fields.field[column][0])
		return GZ_OK;
	table->record.kind = GZ_GAZE_LOG_MARK;
	gz_text_copy(table->record.text, sizeof table->record.text, table->fields.field[column]);
	return table->sink->record(table->sink->user, &table->record);
}

static enum gz_result take_table_line(struct table *table, char *line)
{
	struct gz_sample *sample = &table->record.sample;
	gz_text_split(line, table->separator, &table->fields);
	if (table->where < GZ_TEXT_FIELDS_MAX &&
	    (table->where >= table->fields.count ||
	     strcmp(table->fields.field[table->where], table->value) != 0))
		return GZ_OK;
	*sample = gz_sample_unmeasured();
	if (!take_table_time(table, &sample->host_ns)) {
		table->counts->skipped++;
		return GZ_OK;
	}
	table->record.host_ns = sample->host_ns;
	enum gz_result result = take_table_mark(table);
	if (result != GZ_OK)
		return result;
	sample->valid = take_table_point(table, T_X, &sample->point);
	take_table_eye(table, T_RIGHT_X, &sample->eye[GZ_EYE_RIGHT]);
	take_table_eye(table, T_LEFT_X, &sample->eye[GZ_EYE_LEFT]);
	sample->seq = table->counts->samples++;
	table->record.kind = GZ_GAZE_LOG_SAMPLE;
	return table->sink->record(table->sink->user, &table->record);
}

static enum gz_result read_named_table(struct gz_text_lines *lines,
				       const struct gz_convert_settings *settings,
				       const struct gz_recording_sink *sink,
				       struct gz_convert_counts *counts)
{
	struct table table = { .settings = settings, .sink = sink, .counts = counts };
	char *line;
	enum gz_result result = read_table_columns(&table, lines);
	while (result == GZ_OK || result == GZ_ERR_FULL) {
		result = gz_text_lines_next(lines, &line);
		if (result == GZ_OK && line[0])
			result = take_table_line(&table, line);
		else if (result == GZ_ERR_FULL)
			counts->skipped++;
	}
	return result == GZ_ERR_END ? GZ_OK : result;
}

/* Nothing tells such a table from another. */
static bool table_recognises(const char *line)
{
	(void)line;
	return false;
}

const struct gz_recording_reader gz_recording_reader_table = {
	.name = "table",
	.help = "any .tsv or .csv, with --table.columns",
	.recognises = table_recognises,
	.read = read_named_table,
};
