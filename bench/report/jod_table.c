#include "bench/report/jod_table.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/text.h"
#include "bench/study/csv.h"

#define GZ_LOG_MODULE "report"

/* Bytes of the largest table. Chosen: thousands of values. */
#define FILE_SIZE_MAX ((size_t)1 << 20)

/* Of no visible difference. */
#define JOD_MOST 10

static const char heading[] = "scene,method,jod,how";

struct jod_reading {
	const struct gz_study *study;
	const struct gz_log *log;
	int line;
	struct gz_jod_table *table;
};

static enum gz_result refuse_value(const struct jod_reading *reading, const char *what)
{
	gz_err(reading->log, "%s:%d: %s", reading->table->path, reading->line, what);
	return GZ_ERR_FORMAT;
}

static bool take_text(char **line, char out_text[GZ_STUDY_TEXT_SIZE])
{
	const char *field = gz_csv_next_field(line);
	return field && field[0] &&
	       snprintf(out_text, GZ_STUDY_TEXT_SIZE, "%s", field) < GZ_STUDY_TEXT_SIZE;
}

static void warn_of_stranger(const struct jod_reading *reading, const struct gz_jod_value *value)
{
	const struct gz_study *study = reading->study;
	bool scene = false, method = false;
	for (size_t i = 0; i < study->scene_count; i++)
		scene = scene || strcmp(study->scenes[i].name, value->scene) == 0;
	for (size_t i = 0; i < study->variant_count; i++)
		method = method || strcmp(study->variants[i].text, value->method) == 0;
	if (!scene || !method)
		gz_warn(reading->log, "%s:%d: the study has no %s %s: the value is not shown",
			reading->table->path, reading->line, scene ? "method" : "scene",
			scene ? value->method : value->scene);
}

static enum gz_result read_value(struct jod_reading *reading, char *line)
{
	struct gz_jod_table *table = reading->table;
	struct gz_jod_value value;
	const bool named = take_text(&line, value.scene) && take_text(&line, value.method);
	const char *number = named ? gz_csv_next_field(&line) : NULL;
	if (!number || !gz_number_parse(number, &value.jod) || !(value.jod <= JOD_MOST))
		return refuse_value(reading, "no value: give scene, method, JOD of at most 10, and "
					     "how it was measured");
	if (!take_text(&line, value.how) || line)
		return refuse_value(reading, "say in the fourth column, the last one, how the "
					     "value was measured");
	if (gz_jod_table_find(table, value.scene, value.method))
		return refuse_value(reading, "an earlier line has this scene and method");
	struct gz_jod_value *values =
		realloc(table->values, (table->count + 1) * sizeof *table->values);
	if (!values)
		return GZ_ERR_NO_MEM;
	table->values = values;
	table->values[table->count++] = value;
	warn_of_stranger(reading, &value);
	return GZ_OK;
}

static enum gz_result read_values(struct jod_reading *reading, char *text)
{
	enum gz_result result = GZ_OK;
	char nothing[1] = "";
	for (text = text ? text : nothing; text && result == GZ_OK;) {
		char *line = text, *end = strchr(text, '\n');
		text = end ? end + 1 : NULL;
		if (end)
			*end = '\0';
		line[strcspn(line, "\r")] = '\0';
		reading->line++;
		if (reading->line == 1) {
			if (strcmp(line, heading) != 0)
				result = refuse_value(
					reading, "the first line must be scene,method,jod,how");
		} else if (line[0] && line[0] != '#') {
			result = read_value(reading, line);
		}
	}
	return result;
}

enum gz_result gz_jod_table_read(const char *path, const struct gz_study *study,
				 const struct gz_log *log, struct gz_jod_table *out_table)
{
	const struct gz_text_file file = { path, "table of JOD", FILE_SIZE_MAX };
	struct gz_jod_table table = { 0 };
	struct jod_reading reading = { .study = study, .log = log, .table = &table };
	struct gz_text text = { 0 };
	snprintf(table.path, sizeof table.path, "%s", path);
	enum gz_result result = gz_text_load(&text, &file, log);
	if (result == GZ_OK)
		result = read_values(&reading, text.bytes);
	gz_text_free(&text);
	if (result == GZ_ERR_NO_MEM)
		gz_err(log, "%s: no memory", path);
	if (result == GZ_OK)
		*out_table = table;
	else
		gz_jod_table_free(&table);
	return result;
}

const struct gz_jod_value *gz_jod_table_find(const struct gz_jod_table *table, const char *scene,
					     const char *method)
{
	for (size_t i = 0; table && i < table->count; i++)
		if (strcmp(table->values[i].scene, scene) == 0 &&
		    strcmp(table->values[i].method, method) == 0)
			return &table->values[i];
	return NULL;
}

void gz_jod_table_free(struct gz_jod_table *table)
{
	free(table->values);
	*table = (struct gz_jod_table) { 0 };
}
