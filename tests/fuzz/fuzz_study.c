/* The files of a study from anywhere: study.json, then, behind a NUL, lines of frames.csv. What is
 * accepted can be counted, written as JSON and read back as the same. */
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "bench/study/columns.h"
#include "bench/study/study_json.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void require(bool holds)
{
	if (!holds)
		abort();
}

static void read_back(const struct gz_study *study)
{
	static struct gz_study again; /* of some size */
	char what[1024];
	json_t *json = gz_study_to_json(study);
	require(json != NULL);
	require(gz_study_from_json(json, "again", NULL, &again) == GZ_OK);
	require(!gz_study_differs(&again, study, what, sizeof what));
	gz_study_free(&again);
	json_decref(json);
}

/* Each line as the next row of the first units; a line of names says what follows it. */
static void read_rows(const struct gz_study *study, const char *text, size_t size)
{
	const size_t per = gz_study_unit_rows(study), units = gz_study_unit_count(study);
	struct gz_study_layout layout = { .count = 0 };
	for (int id = 0; id < GZ_STUDY_COLUMNS; id++)
		if (!gz_study_columns[id].later)
			layout.columns[layout.count++] = id;
	for (size_t i = 0; size > 0 && i / per < units; i++) {
		const char *end = memchr(text, '\n', size);
		const size_t length = end ? (size_t)(end - text) : size;
		struct gz_study_row row = gz_study_unit_row(study, i / per, i % per);
		char what[1024];
		/* Not strndup(), which the address sanitizer lets read on to a NUL. */
		char *line = malloc(length + 1);
		require(line != NULL);
		memcpy(line, text, length);
		line[length] = '\0';
		if (!gz_study_rows_parse_head(line, &layout) &&
		    gz_study_rows_parse(study, &layout, line, &row, what, sizeof what))
			require(row.plan_ms >= 0 || row.plan_ms != row.plan_ms);
		free(line);
		text += end ? length + 1 : length;
		size -= end ? length + 1 : length;
	}
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	static struct gz_study study;
	const char *text = (const char *)data;
	const char *end = memchr(data, 0, size);
	const size_t length = end ? (size_t)(end - text) : size;
	json_t *json = json_loadb(text, length, JSON_REJECT_DUPLICATES, NULL);
	if (json && gz_study_from_json(json, "fuzz", NULL, &study) == GZ_OK) {
		require(study.variant_count > 0 && study.frames_per_point > 0 && study.points);
		require(gz_study_shard_unit_count(&study) <= gz_study_unit_count(&study));
		read_back(&study);
		if (end)
			read_rows(&study, end + 1, size - length - 1);
		gz_study_free(&study);
	}
	json_decref(json);
	return 0;
}
