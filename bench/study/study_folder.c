#include "bench/study/study_folder.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "bench/study/study_files.h"
#include "bench/study/study_json.h"
#include "bench/study/study_rows.h"

#define GZ_LOG_MODULE "study"

enum gz_result gz_study_file_path(const char *folder, const char *name, const struct gz_log *log,
				  char out_path[GZ_PATH_SIZE])
{
	const int length = snprintf(out_path, GZ_PATH_SIZE, "%s/%s", folder, name);
	if (length > 0 && length < GZ_PATH_SIZE)
		return GZ_OK;
	gz_err(log, "%s: a name this long cannot be opened; move the folder", folder);
	return GZ_ERR_IO;
}

static enum gz_result open_to_read(const char *path, const struct gz_log *log, FILE **out_file)
{
	*out_file = fopen(path, "re");
	if (*out_file)
		return GZ_OK;
	if (errno == ENOENT || errno == ENOTDIR) {
		gz_err(log,
		       "%s: no such file: name the folder of a study, as gazebench run --out "
		       "made it",
		       path);
		return GZ_ERR_NOT_FOUND;
	}
	gz_err(log, "%s: cannot be read: %s", path, strerror(errno));
	return GZ_ERR_IO;
}

enum gz_result gz_study_read_asked(const char *folder, const struct gz_log *log,
				   struct gz_study *out_study)
{
	char path[GZ_PATH_SIZE];
	FILE *file = NULL;
	enum gz_result result = gz_study_file_path(folder, GZ_STUDY_JSON, log, path);
	if (result == GZ_OK)
		result = open_to_read(path, log, &file);
	if (result != GZ_OK)
		return result;
	json_error_t error;
	json_t *json = json_loadf(file, JSON_REJECT_DUPLICATES, &error);
	fclose(file);
	if (!json) {
		gz_err(log, "%s:%d: %s: the study is damaged; measure it anew", path, error.line,
		       error.text);
		return GZ_ERR_FORMAT;
	}
	result = gz_study_from_json(json, path, log, out_study);
	json_decref(json);
	return result;
}

/* frames.csv in reading. */
struct reader {
	const char *path;
	const struct gz_log *log;
	struct gz_study *study;
	FILE *file;
	char *line; /* getline()'s */
	size_t line_size;
	size_t line_number;
	size_t capacity;       /* of study->rows */
	long long whole_bytes; /* up to the end of the last whole unit */
};

/* The next line without its newline; false at the end, where a last line without one is cut. */
static bool next_line(struct reader *reader)
{
	const ssize_t length = getline(&reader->line, &reader->line_size, reader->file);
	if (length < 1 || reader->line[length - 1] != '\n')
		return false;
	reader->line[length - 1] = '\0';
	reader->line_number++;
	return true;
}

static enum gz_result keep_row(struct reader *reader, const struct gz_study_row *row)
{
	struct gz_study *study = reader->study;
	if (study->row_count == reader->capacity) {
		const size_t capacity = reader->capacity ? 2 * reader->capacity : 1024;
		struct gz_study_row *rows = reallocarray(study->rows, capacity, sizeof *rows);
		if (!rows) {
			gz_err(reader->log, "%s: no memory for %zu rows", reader->path, capacity);
			return GZ_ERR_NO_MEM;
		}
		study->rows = rows;
		reader->capacity = capacity;
	}
	study->rows[study->row_count++] = *row;
	return GZ_OK;
}

static enum gz_result read_unit(struct reader *reader, size_t unit, bool *out_whole)
{
	struct gz_study *study = reader->study;
	const size_t before = study->row_count, rows = gz_study_unit_rows(study);
	char what[3 * GZ_STUDY_TEXT_SIZE];
	*out_whole = false;
	for (size_t k = 0; k < rows; k++) {
		if (!next_line(reader)) {
			study->row_count = before;
			return GZ_OK;
		}
		struct gz_study_row row = gz_study_unit_row(study, unit, k);
		if (!gz_study_rows_parse(study, reader->line, &row, what, sizeof what)) {
			gz_err(reader->log, "%s:%zu: %s: the study is damaged; measure it anew",
			       reader->path, reader->line_number, what);
			return GZ_ERR_FORMAT;
		}
		const enum gz_result result = keep_row(reader, &row);
		if (result != GZ_OK)
			return result;
	}
	*out_whole = true;
	reader->whole_bytes = ftello(reader->file);
	return GZ_OK;
}

static enum gz_result read_units(struct reader *reader)
{
	const struct gz_study *study = reader->study;
	const size_t units = gz_study_shard_unit_count(study);
	bool whole = true;
	if (!next_line(reader))
		return GZ_OK; /* ended before it had begun */
	if (!gz_study_rows_is_head(reader->line)) {
		gz_err(reader->log,
		       "%s:1: does not name the columns of this version; measure it "
		       "anew, or use the program that made it",
		       reader->path);
		return GZ_ERR_FORMAT;
	}
	reader->whole_bytes = ftello(reader->file);
	for (size_t i = 0; i < units && whole; i++) {
		const size_t unit = (size_t)study->shard + i * (size_t)study->shard_count;
		const enum gz_result result = read_unit(reader, unit, &whole);
		if (result != GZ_OK)
			return result;
	}
	if (whole && next_line(reader)) {
		gz_err(reader->log,
		       "%s:%zu: there are more lines than the study has; measure it anew",
		       reader->path, reader->line_number);
		return GZ_ERR_FORMAT;
	}
	return GZ_OK;
}

/* Whether the rows are what the study says of itself. */
static enum gz_result check_complete(const struct reader *reader)
{
	const struct gz_study *study = reader->study;
	const size_t rows = gz_study_shard_unit_count(study) * gz_study_unit_rows(study);
	if (ferror(reader->file)) {
		gz_err(reader->log, "%s: cannot be read: %s", reader->path, strerror(errno));
		return GZ_ERR_IO;
	}
	if (!study->complete || study->row_count == rows)
		return GZ_OK;
	gz_err(reader->log,
	       "%s:%zu: the study says that it is complete, and %zu of %zu rows are there; measure "
	       "it anew",
	       reader->path, reader->line_number, study->row_count, rows);
	return GZ_ERR_FORMAT;
}

enum gz_result gz_study_read_rows(const char *folder, const struct gz_log *log,
				  struct gz_study *study, long long *out_whole_bytes)
{
	char path[GZ_PATH_SIZE];
	struct reader reader = { .path = path, .log = log, .study = study };
	enum gz_result result = gz_study_file_path(folder, GZ_STUDY_ROWS, log, path);
	if (result == GZ_OK)
		result = open_to_read(path, log, &reader.file);
	if (result != GZ_OK)
		return result;
	result = read_units(&reader);
	if (result == GZ_OK)
		result = check_complete(&reader);
	fclose(reader.file);
	free(reader.line);
	if (result == GZ_OK && out_whole_bytes)
		*out_whole_bytes = reader.whole_bytes;
	return result;
}

enum gz_result gz_study_read(const char *folder, const struct gz_log *log,
			     struct gz_study *out_study)
{
	struct gz_study *study = calloc(1, sizeof *study);
	if (!study)
		return GZ_ERR_NO_MEM;
	enum gz_result result = gz_study_read_asked(folder, log, study);
	if (result == GZ_OK)
		result = gz_study_read_rows(folder, log, study, NULL);
	if (result == GZ_OK)
		*out_study = *study;
	else
		gz_study_free(study);
	free(study);
	return result;
}
