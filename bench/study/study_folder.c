#include "bench/study/study_folder.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include "bench/study/columns.h"
#include "bench/study/study_json.h"

#define GZ_LOG_MODULE "study"

#define ASKED_FILE "study.json"
#define ROWS_FILE  "frames.csv"

static enum gz_result find_path(const char *folder, const char *name, const struct gz_log *log,
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
		gz_err(log, "%s: no such file: name a folder that gazebench run --out made", path);
		return GZ_ERR_NOT_FOUND;
	}
	gz_err(log, "%s: cannot be read: %s", path, strerror(errno));
	return GZ_ERR_IO;
}

static enum gz_result read_asked(const char *folder, const struct gz_log *log,
				 struct gz_study *out_study)
{
	char path[GZ_PATH_SIZE];
	FILE *file = NULL;
	enum gz_result result = find_path(folder, ASKED_FILE, log, path);
	if (result == GZ_OK)
		result = open_to_read(path, log, &file);
	if (result != GZ_OK)
		return result;
	json_error_t error;
	json_t *json = json_loadf(file, JSON_REJECT_DUPLICATES, &error);
	fclose(file);
	if (!json) {
		gz_err(log, "%s:%d: %s: the study is damaged; measure it again", path, error.line,
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
	struct gz_study_layout layout;
	char *line; /* getline()'s */
	size_t line_size;
	size_t line_number;
	size_t capacity;       /* of study->rows */
	bool to_go_on;         /* rows will be added: all columns must be there */
	long long whole_bytes; /* up to the end of the last whole unit */
};

/* The next line without its newline; false at the end, where a last line without one is cut. */
static bool next_row_line(struct reader *reader)
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
		if (!next_row_line(reader)) {
			study->row_count = before;
			return GZ_OK;
		}
		struct gz_study_row row = gz_study_unit_row(study, unit, k);
		if (!gz_study_rows_parse(study, &reader->layout, reader->line, &row, what,
					 sizeof what)) {
			gz_err(reader->log, "%s:%zu: %s: the study is damaged; measure it again",
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
	if (!next_row_line(reader))
		return GZ_OK; /* ended before it had begun */
	if (!gz_study_rows_parse_head(reader->line, &reader->layout)) {
		gz_err(reader->log,
		       "%s:1: does not name the columns of this version; measure it "
		       "again, or use the program that made it",
		       reader->path);
		return GZ_ERR_FORMAT;
	}
	if (reader->to_go_on && reader->layout.count != GZ_STUDY_COLUMNS) {
		gz_err(reader->log, "%s: is of an earlier version: it can be read, but not resumed",
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
	if (whole && next_row_line(reader)) {
		gz_err(reader->log,
		       "%s:%zu: there are more lines than the study has; measure it again",
		       reader->path, reader->line_number);
		return GZ_ERR_FORMAT;
	}
	return GZ_OK;
}

/* Whether there are as many rows as the study says. */
static enum gz_result check_row_count(const struct reader *reader)
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
	       "%s:%zu: the study says that it is complete, but has %zu of %zu rows; measure it "
	       "again",
	       reader->path, reader->line_number, study->row_count, rows);
	return GZ_ERR_FORMAT;
}

static enum gz_result read_rows(const char *folder, const struct gz_log *log,
				struct gz_study *study, long long *out_whole_bytes)
{
	char path[GZ_PATH_SIZE];
	struct reader reader = {
		.path = path, .log = log, .study = study, .to_go_on = out_whole_bytes != NULL
	};
	enum gz_result result = find_path(folder, ROWS_FILE, log, path);
	if (result == GZ_OK)
		result = open_to_read(path, log, &reader.file);
	if (result != GZ_OK)
		return result;
	result = read_units(&reader);
	if (result == GZ_OK)
		result = check_row_count(&reader);
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
	enum gz_result result = read_asked(folder, log, study);
	if (result == GZ_OK)
		result = read_rows(folder, log, study, NULL);
	if (result == GZ_OK)
		*out_study = *study;
	else
		gz_study_free(study);
	free(study);
	return result;
}

/* ---- writing: whatever ends the program leaves a folder that can be read ---- */

struct gz_study_writer {
	const struct gz_log *log;
	const struct gz_study *study;
	char folder[GZ_PATH_SIZE];
	char rows_path[GZ_PATH_SIZE];
	int file;        /* frames.csv, locked while it is open; -1 = none */
	long long bytes; /* of it, all whole units */
};

static enum gz_result fail_to_write(const struct gz_log *log, const char *path, int error)
{
	if (error == ENOSPC || error == EDQUOT || error == EFBIG) {
		gz_err(log,
		       "%s: no room left: %s; make room and run the same command again to resume",
		       path, strerror(error));
		return GZ_ERR_FULL;
	}
	gz_err(log, "%s: cannot be written: %s", path, strerror(error));
	return GZ_ERR_IO;
}

/* All of it, or an errno. */
static int write_whole(int file, const char *bytes, size_t size)
{
	while (size > 0) {
		const ssize_t written = write(file, bytes, size);
		if (written < 0 && errno != EINTR)
			return errno;
		if (written > 0) {
			bytes += written;
			size -= (size_t)written;
		}
	}
	return 0;
}

/* So that the names of new files are on the disk, too. */
static void sync_folder(const char *folder)
{
	const int file = open(folder, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
	if (file < 0)
		return;
	if (fsync(file) != 0)
		errno = 0; /* some file systems cannot */
	close(file);
}

/* A file that is either as it was or all new: written beside it and renamed over it. */
static enum gz_result replace_file(const char *folder, const char *name, const char *text,
				   const struct gz_log *log)
{
	char path[GZ_PATH_SIZE], part[GZ_PATH_SIZE];
	char part_name[GZ_NAME_SIZE];
	snprintf(part_name, sizeof part_name, ".%s.part", name);
	enum gz_result result = find_path(folder, name, log, path);
	if (result == GZ_OK)
		result = find_path(folder, part_name, log, part);
	if (result != GZ_OK)
		return result;
	const int file = open(part, O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
	if (file < 0)
		return fail_to_write(log, path, errno);
	int error = write_whole(file, text, strlen(text));
	if (error == 0 && fdatasync(file) != 0)
		error = errno;
	if (close(file) != 0 && error == 0)
		error = errno;
	if (error == 0 && rename(part, path) != 0)
		error = errno;
	if (error != 0) {
		unlink(part);
		return fail_to_write(log, path, error);
	}
	sync_folder(folder);
	return GZ_OK;
}

static enum gz_result write_json(const char *folder, const struct gz_study *study,
				 const struct gz_log *log)
{
	char *text = gz_study_to_text(study, folder);
	if (!text) {
		gz_err(log, "%s: no memory, or a name that is not UTF-8", folder);
		return GZ_ERR_NO_MEM;
	}
	const enum gz_result result = replace_file(folder, ASKED_FILE, text, log);
	free(text);
	return result;
}

/* Whether a folder is empty, or holds only the remains of a writer killed at its start. */
static bool is_empty(const char *folder)
{
	DIR *directory = opendir(folder);
	bool empty = directory != NULL;
	const struct dirent *entry;
	while (empty && (entry = readdir(directory)) != NULL)
		empty = strcmp(entry->d_name, ".") == 0 || strcmp(entry->d_name, "..") == 0 ||
			strcmp(entry->d_name, "." ASKED_FILE ".part") == 0;
	if (directory)
		closedir(directory);
	return empty;
}

static bool has_study(const char *folder, const struct gz_log *log)
{
	char path[GZ_PATH_SIZE];
	return find_path(folder, ASKED_FILE, log, path) == GZ_OK && access(path, F_OK) == 0;
}

enum gz_result gz_study_folder_check(const char *folder, const struct gz_log *log)
{
	if (access(folder, F_OK) != 0 || is_empty(folder) || has_study(folder, log))
		return GZ_OK;
	gz_err(log, "%s: exists and is not a study; name a new folder", folder);
	return GZ_ERR_BUSY;
}

/* Make the folder, or take an empty one. */
static enum gz_result make_study_folder(const char *folder, const struct gz_log *log)
{
	const enum gz_result result = gz_study_folder_check(folder, log);
	if (result != GZ_OK || mkdir(folder, 0777) == 0 || errno == EEXIST)
		return result;
	if (errno == ENOENT) {
		gz_err(log, "%s: its parent folder does not exist: make it first", folder);
		return GZ_ERR_IO;
	}
	return fail_to_write(log, folder, errno);
}

static enum gz_result open_rows(struct gz_study_writer *writer)
{
	const enum gz_result result =
		find_path(writer->folder, ROWS_FILE, writer->log, writer->rows_path);
	if (result != GZ_OK)
		return result;
	writer->file = open(writer->rows_path, O_WRONLY | O_CREAT | O_CLOEXEC, 0666);
	if (writer->file < 0)
		return fail_to_write(writer->log, writer->rows_path, errno);
	if (flock(writer->file, LOCK_EX | LOCK_NB) == 0)
		return GZ_OK;
	gz_err(writer->log,
	       "%s: another gazebench is writing this study; wait until it has finished",
	       writer->folder);
	return GZ_ERR_BUSY;
}

/* The text is complete on the disk on success; otherwise the file is unchanged. */
static enum gz_result append_to_rows(struct gz_study_writer *writer, const char *text, size_t size)
{
	int error = 0;
	if (lseek(writer->file, writer->bytes, SEEK_SET) < 0)
		error = errno;
	if (error == 0)
		error = write_whole(writer->file, text, size);
	if (error == 0 && fdatasync(writer->file) != 0)
		error = errno;
	if (error == 0) {
		writer->bytes += (long long)size;
		return GZ_OK;
	}
	if (ftruncate(writer->file, writer->bytes) != 0)
		gz_warn(writer->log, "%s: an incomplete line stays at its end; readers ignore it",
			writer->rows_path);
	return fail_to_write(writer->log, writer->rows_path, error);
}

/* Append rows, or without any the line of names. */
static enum gz_result append_rows(struct gz_study_writer *writer, const struct gz_study_row *rows,
				  size_t count)
{
	char *text = NULL;
	size_t size = 0;
	FILE *memory = open_memstream(&text, &size);
	if (!memory)
		return GZ_ERR_NO_MEM;
	if (count == 0)
		gz_study_rows_print_head(memory);
	for (size_t i = 0; i < count; i++)
		gz_study_rows_print(writer->study, &rows[i], memory);
	const bool whole = !ferror(memory);
	enum gz_result result = fclose(memory) == 0 && whole ? GZ_OK : GZ_ERR_NO_MEM;
	if (result == GZ_OK)
		result = append_to_rows(writer, text, size);
	free(text);
	return result;
}

static enum gz_result begin_rows(struct gz_study_writer *writer)
{
	if (ftruncate(writer->file, writer->bytes) != 0)
		return fail_to_write(writer->log, writer->rows_path, errno);
	return writer->bytes == 0 ? append_rows(writer, NULL, 0) : GZ_OK;
}

/* Refuse the study in the folder if it is not the requested one. */
static enum gz_result check_same(const struct gz_study_writer *writer, const struct gz_study *there)
{
	char what[3 * GZ_STUDY_TEXT_SIZE];
	const struct gz_study *study = writer->study;
	if (gz_study_differs(study, there, what, sizeof what)) {
		gz_err(writer->log, "%s: holds another study: %s; name another folder",
		       writer->folder, what);
		return GZ_ERR_INVAL;
	}
	if (study->shard == there->shard && study->shard_count == there->shard_count)
		return GZ_OK;
	gz_err(writer->log, "%s: holds shard %d/%d, not %d/%d; name another folder", writer->folder,
	       there->shard + 1, there->shard_count, study->shard + 1, study->shard_count);
	return GZ_ERR_INVAL;
}

static enum gz_result resume_folder(struct gz_study_writer *writer, size_t *out_done)
{
	struct gz_study *there = calloc(1, sizeof *there);
	if (!there)
		return GZ_ERR_NO_MEM;
	enum gz_result result = read_asked(writer->folder, writer->log, there);
	if (result == GZ_OK)
		result = check_same(writer, there);
	if (result == GZ_OK)
		result = open_rows(writer);
	if (result == GZ_OK)
		result = read_rows(writer->folder, writer->log, there, &writer->bytes);
	if (result == GZ_OK) {
		*out_done = there->row_count / gz_study_unit_rows(there);
		result = begin_rows(writer);
	}
	gz_study_free(there);
	free(there);
	return result;
}

static enum gz_result begin_folder(struct gz_study_writer *writer, size_t *out_done)
{
	enum gz_result result = make_study_folder(writer->folder, writer->log);
	if (result == GZ_OK)
		result = write_json(writer->folder, writer->study, writer->log);
	if (result == GZ_OK)
		result = open_rows(writer);
	if (result == GZ_OK)
		result = begin_rows(writer);
	if (result == GZ_OK)
		*out_done = 0;
	return result;
}

enum gz_result gz_study_writer_open(const char *folder, const struct gz_study *study,
				    const struct gz_log *log, struct gz_study_writer **out_writer,
				    size_t *out_done)
{
	struct gz_study_writer *writer = calloc(1, sizeof *writer);
	if (!writer)
		return GZ_ERR_NO_MEM;
	writer->log = log;
	writer->study = study;
	writer->file = -1;
	enum gz_result result = GZ_OK;
	if (snprintf(writer->folder, GZ_PATH_SIZE, "%s", folder) >= GZ_PATH_SIZE) {
		gz_err(log, "%s: a name this long cannot be opened", folder);
		result = GZ_ERR_IO;
	}
	if (result == GZ_OK)
		result = has_study(folder, log) ? resume_folder(writer, out_done)
						: begin_folder(writer, out_done);
	if (result != GZ_OK) {
		gz_study_writer_destroy(&writer);
		return result;
	}
	*out_writer = writer;
	return GZ_OK;
}

enum gz_result gz_study_writer_add(struct gz_study_writer *writer, const struct gz_study_row *rows)
{
	return append_rows(writer, rows, gz_study_unit_rows(writer->study));
}

enum gz_result gz_study_writer_finish(struct gz_study_writer *writer)
{
	struct gz_study *complete = malloc(sizeof *complete);
	if (!complete)
		return GZ_ERR_NO_MEM;
	*complete = *writer->study;
	complete->complete = true;
	const enum gz_result result = write_json(writer->folder, complete, writer->log);
	free(complete);
	return result;
}

void gz_study_writer_destroy(struct gz_study_writer **writer)
{
	if (!*writer)
		return;
	if ((*writer)->file >= 0)
		close((*writer)->file);
	free(*writer);
	*writer = NULL;
}

enum gz_result gz_study_write(const char *folder, const struct gz_study *study,
			      const struct gz_log *log)
{
	struct gz_study_writer *writer = NULL;
	size_t done;
	if (has_study(folder, log)) {
		gz_err(log, "%s: already holds a study; name a new folder", folder);
		return GZ_ERR_BUSY;
	}
	struct gz_study *unfinished = malloc(sizeof *unfinished);
	if (!unfinished)
		return GZ_ERR_NO_MEM;
	*unfinished = *study;
	unfinished->complete = false;
	enum gz_result result = gz_study_writer_open(folder, unfinished, log, &writer, &done);
	if (result == GZ_OK && study->row_count > 0)
		result = append_rows(writer, study->rows, study->row_count);
	if (result == GZ_OK && study->complete)
		result = gz_study_writer_finish(writer);
	gz_study_writer_destroy(&writer);
	free(unfinished);
	return result;
}
