#include "bench/answers/answer_table.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/order.h"
#include "base/text.h"

#define GZ_LOG_MODULE "answers"

/* Largest file, bytes. Chosen: as large as gazeview continues. */
enum { MOST_BYTES = 1 << 26 };

/* Most cells of a row. Chosen: twice those of a table. */
enum { CELLS_MAX = 128 };

/* Columns that are read. */
enum column {
	TRIAL_TYPE,
	PRACTICE,
	CORRECT,
	RESPONSE,
	RESPONSE_TIME,
	SCENE_1,
	SETTINGS_1,
	SETTINGS_2,
	STAIRCASE,
	STAIRCASE_VALUE,
	COLUMNS
};

static const char *const column_names[COLUMNS] = {
	[TRIAL_TYPE] = "trial_type",
	[PRACTICE] = "practice",
	[CORRECT] = "correct",
	[RESPONSE] = "response",
	[RESPONSE_TIME] = "response_time",
	[SCENE_1] = "scene_1",
	[SETTINGS_1] = "settings_1",
	[SETTINGS_2] = "settings_2",
	[STAIRCASE] = "staircase",
	[STAIRCASE_VALUE] = "staircase_value",
};

/* A file being read. */
struct reader {
	struct gz_answer_table *table;
	const char *path, *key;
	const struct gz_log *log;
	int line;
	size_t at[COLUMNS], cells; /* where each column is; cells of a row */
};

static enum gz_result refuse_file(const struct reader *reader, const char *what)
{
	gz_err(reader->log, "%s:%d: %s; give a table that gazeview --experiment wrote",
	       reader->path, reader->line, what);
	return GZ_ERR_FORMAT;
}

static size_t split_cells(char *line, char *cells[CELLS_MAX])
{
	size_t count = 0;
	for (char *cell = strsep(&line, "\t"); cell; cell = strsep(&line, "\t")) {
		if (count == CELLS_MAX)
			return CELLS_MAX + 1;
		cells[count++] = cell;
	}
	return count;
}

static enum gz_result read_header(struct reader *reader, char *line)
{
	char *cells[CELLS_MAX], what[96];
	reader->cells = split_cells(line, cells);
	for (size_t c = 0; c < COLUMNS; c++) {
		reader->at[c] = CELLS_MAX;
		for (size_t i = 0; i < reader->cells && i < CELLS_MAX; i++)
			if (strcmp(cells[i], column_names[c]) == 0)
				reader->at[c] = i;
		if (reader->at[c] < CELLS_MAX)
			continue;
		snprintf(what, sizeof what, "no column %s", column_names[c]);
		return refuse_file(reader, what);
	}
	return GZ_OK;
}

static struct gz_answer_group *find_or_add_group(struct gz_answer_table *table, const char *name,
						 const char *key)
{
	for (size_t i = 0; i < table->group_count; i++)
		if (strcmp(table->groups[i].name, name) == 0 &&
		    strcmp(table->groups[i].key, key) == 0)
			return &table->groups[i];
	struct gz_answer_group *grown =
		realloc(table->groups, (table->group_count + 1) * sizeof *grown);
	if (!grown)
		return NULL;
	table->groups = grown;
	struct gz_answer_group *group = &grown[table->group_count++];
	*group = (struct gz_answer_group) { .trials = 0 };
	snprintf(group->name, sizeof group->name, "%s", name);
	snprintf(group->key, sizeof group->key, "%s", key);
	return group;
}

/* Count an answer to a value, in their order. */
static enum gz_result count_value(struct gz_answer_group *group, double value, bool right)
{
	size_t at = 0;
	while (at < group->count_count && group->counts[at].value < value)
		at++;
	if (at == group->count_count || group->counts[at].value != value) {
		struct gz_value_count *grown =
			realloc(group->counts, (group->count_count + 1) * sizeof *grown);
		if (!grown)
			return GZ_ERR_NO_MEM;
		group->counts = grown;
		memmove(&grown[at + 1], &grown[at], (group->count_count - at) * sizeof *grown);
		grown[at] = (struct gz_value_count) { .value = value };
		group->count_count++;
	}
	group->counts[at].trials++;
	group->counts[at].right += right;
	return GZ_OK;
}

static enum gz_result add_time(struct gz_answer_group *group, double time_s)
{
	double *grown = realloc(group->times_s, (group->time_count + 1) * sizeof *grown);
	if (!grown)
		return GZ_ERR_NO_MEM;
	group->times_s = grown;
	grown[group->time_count++] = time_s;
	return GZ_OK;
}

/* The value of a key in "key=value key=value"; false: it is not there. */
static bool find_value(const char *settings, const char *key, double *out_value)
{
	const size_t length = strlen(key);
	for (const char *at = settings; (at = strstr(at, key)) != NULL; at += length) {
		char number[64];
		if ((at > settings && at[-1] != ' ') || at[length] != '=')
			continue;
		snprintf(number, sizeof number, "%.*s", (int)strcspn(at + length + 1, " "),
			 at + length + 1);
		return gz_number_parse(number, out_value);
	}
	return false;
}

/* What varied in this trial, and its value; false: nothing. */
static bool value_of_row(const struct reader *reader, char *cells[CELLS_MAX], double *out_value)
{
	if (!reader->key[0])
		return gz_number_parse(cells[reader->at[STAIRCASE_VALUE]], out_value);
	return find_value(cells[reader->at[SETTINGS_1]], reader->key, out_value) ||
	       find_value(cells[reader->at[SETTINGS_2]], reader->key, out_value);
}

static enum gz_result count_row(struct reader *reader, char *cells[CELLS_MAX])
{
	const bool right = strcmp(cells[reader->at[CORRECT]], "1") == 0;
	double value = 0, time_s = 0;
	const bool varies = value_of_row(reader, cells, &value);
	const char *varied = reader->key[0] ? reader->key : cells[reader->at[STAIRCASE]];
	struct gz_answer_group *group = find_or_add_group(
		reader->table, cells[reader->at[reader->key[0] ? SCENE_1 : TRIAL_TYPE]],
		varies ? varied : "");
	if (!group)
		return GZ_ERR_NO_MEM;
	group->trials++;
	group->right += right;
	enum gz_result result = GZ_OK;
	if (gz_number_parse(cells[reader->at[RESPONSE_TIME]], &time_s))
		result = add_time(group, time_s);
	return result == GZ_OK && varies ? count_value(group, value, right) : result;
}

static enum gz_result read_answer_row(struct reader *reader, char *line)
{
	char *cells[CELLS_MAX];
	if (split_cells(line, cells) != reader->cells)
		return refuse_file(reader, "not as many cells as columns");
	const char *correct = cells[reader->at[CORRECT]];
	if (strcmp(cells[reader->at[PRACTICE]], "0") != 0)
		reader->table->practice++;
	else if (strcmp(correct, "n/a") == 0)
		reader->table->unjudged++;
	else if (strcmp(cells[reader->at[RESPONSE]], "n/a") == 0)
		reader->table->late++;
	else
		return count_row(reader, cells);
	return GZ_OK;
}

enum gz_result gz_answer_table_add(struct gz_answer_table *table, const char *path, const char *key,
				   const struct gz_log *log)
{
	struct reader reader = { .table = table, .path = path, .key = key, .log = log };
	struct gz_text text = { 0 };
	const struct gz_text_file file = { path, "table of answers", MOST_BYTES };
	enum gz_result result = gz_text_load(&text, &file, log);
	char *rest = text.bytes;
	while (result == GZ_OK && rest && *rest) {
		char *line = strsep(&rest, "\n");
		reader.line++;
		line[strcspn(line, "\r")] = '\0';
		result = reader.line == 1 ? read_header(&reader, line)
					  : read_answer_row(&reader, line);
	}
	if (result == GZ_OK && reader.line == 0)
		result = refuse_file(&reader, "empty");
	gz_text_free(&text);
	return result;
}

double gz_answer_group_median_s(struct gz_answer_group *group)
{
	const size_t count = group->time_count;
	if (count == 0)
		return NAN;
	qsort(group->times_s, count, sizeof *group->times_s, gz_compare_doubles);
	return (group->times_s[(count - 1) / 2] + group->times_s[count / 2]) / 2;
}

void gz_answer_table_free(struct gz_answer_table *table)
{
	for (size_t i = 0; i < table->group_count; i++) {
		free(table->groups[i].times_s);
		free(table->groups[i].counts);
	}
	free(table->groups);
	*table = (struct gz_answer_table) { 0 };
}
