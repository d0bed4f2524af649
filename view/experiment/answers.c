#include "view/experiment/answers.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/file.h"
#include "base/text.h"
#include "view/experiment/experiment_internal.h"
#include "view/experiment/participants.h"
#include "view/experiment/staircase.h"

#define GZ_LOG_MODULE "experiment"

/* Largest file to continue, bytes. Chosen: more than the largest number of trials needs. */
enum { MOST_BYTES = 1 << 26 };

struct gz_answers {
	const struct gz_log *log;
	const struct gz_experiment *experiment;
	const struct gz_sequence *sequence;
	struct gz_answers_request request;
	char path[GZ_PATH_SIZE];
	int fd;
	size_t done, next; /* rows; index of the next trial */
	int run;
	bool listed; /* the participant is in the list */
};

bool gz_answers_label_valid(const char *label)
{
	return gz_experiment_is_word(label) && strlen(label) < GZ_PARTICIPANT_SIZE;
}

/* Whether --answers names the file itself. */
static bool is_answer_file(const char *place)
{
	const char *ending = strrchr(place, '.');
	return ending && ending > place && strcmp(ending, ".tsv") == 0;
}

enum gz_result gz_answers_path(const struct gz_experiment *experiment,
			       const struct gz_answers_request *request, char *path, size_t size)
{
	if (is_answer_file(request->place))
		return gz_text_print(path, size, "%s", request->place);
	return gz_text_print(path, size, "%s/sub-%s%s%s_task-%s_events.tsv",
			     request->place[0] ? request->place : ".", request->participant,
			     request->session[0] ? "_ses-" : "", request->session,
			     experiment->params.name);
}

static struct gz_answer_row answer_row_of(const struct gz_answers *answers,
					  const struct gz_trial_result *result, int64_t start_ns,
					  const struct gz_trial_equipment *equipment)
{
	return (struct gz_answer_row) {
		.experiment = answers->experiment,
		.participant = answers->request.participant,
		.session = answers->request.session,
		.run = answers->run,
		.start_ns = start_ns,
		.result = result,
		.gaze_source = answers->request.gaze_source,
		.version = answers->request.version,
		.equipment = equipment,
	};
}

static enum gz_result refuse_io(const struct gz_answers *answers, const char *what)
{
	gz_err(answers->log, "%s: %s: %s; free some space or choose another --answers",
	       answers->path, what, strerror(errno));
	return GZ_ERR_IO;
}

/* Write the text and flush it to the disk. */
static enum gz_result append_row(const struct gz_answers *answers, const struct gz_text *text)
{
	if (text->failed)
		return GZ_ERR_NO_MEM;
	if (gz_write_all(answers->fd, text->bytes, text->length) < text->length ||
	    fsync(answers->fd) != 0)
		return refuse_io(answers, "cannot be written");
	return GZ_OK;
}

/* The names of the columns. The caller frees the text. */
static struct gz_text header_text(void)
{
	struct gz_text text = { 0 };
	for (size_t i = 0; i < gz_answer_column_count; i++)
		gz_text_add(&text, "%s%s", i ? "\t" : "", gz_answer_columns[i].name);
	gz_text_add(&text, "\n");
	return text;
}

/* The text of a file to continue. */
struct lines {
	char *text, *next;
	size_t size, whole; /* bytes of complete lines */
	int number;
};

static enum gz_result read_lines(const struct gz_answers *answers, struct lines *lines)
{
	struct stat facts;
	if (fstat(answers->fd, &facts) != 0 || lseek(answers->fd, 0, SEEK_SET) != 0)
		return refuse_io(answers, "cannot be read");
	if (facts.st_size > MOST_BYTES) {
		gz_err(answers->log, "%s: too large for a file of answers; check the path",
		       answers->path);
		return GZ_ERR_FORMAT;
	}
	lines->text = malloc((size_t)facts.st_size + 1);
	if (!lines->text)
		return GZ_ERR_NO_MEM;
	while (lines->size < (size_t)facts.st_size) {
		ssize_t got = read(answers->fd, lines->text + lines->size,
				   (size_t)facts.st_size - lines->size);
		if (got < 0 && errno != EINTR)
			return refuse_io(answers, "cannot be read");
		if (got == 0)
			break;
		lines->size += got > 0 ? (size_t)got : 0;
	}
	lines->text[lines->size] = '\0';
	const char *last = memrchr(lines->text, '\n', lines->size);
	lines->whole = last ? (size_t)(last - lines->text) + 1 : 0;
	lines->next = lines->text;
	return GZ_OK;
}

/* The next complete line without its newline; NULL after the last. */
static char *next_row(struct lines *lines)
{
	if (lines->next >= lines->text + lines->whole)
		return NULL;
	char *line = lines->next;
	char *end = memchr(line, '\n', (size_t)(lines->text + lines->whole - line));
	*end = '\0';
	lines->next = end + 1;
	lines->number++;
	return line;
}

static enum gz_result refuse_line(const struct gz_answers *answers, const struct lines *lines,
				  const char *what)
{
	gz_err(answers->log,
	       "%s:%d: %s; continue with the experiment, seed, session and --gaze it was started "
	       "with, or start another --session",
	       answers->path, lines->number, what);
	return GZ_ERR_FORMAT;
}

/* Compare a row with the sequence. */
static enum gz_result check_row(struct gz_answers *answers, const struct lines *lines, char *line)
{
	char expected[GZ_ANSWER_CELL_SIZE], what[256];
	if (answers->next == answers->sequence->count)
		return refuse_line(answers, lines, "more rows than trials");
	const struct gz_trial_result result = {
		.index = answers->next,
		.presentation = &answers->sequence->presentations[answers->next],
	};
	struct gz_staircase *staircase = result.presentation->condition->staircase;
	bool answered = false, right = false;
	gz_staircase_place(staircase);
	const struct gz_answer_row row = answer_row_of(answers, &result, 0, NULL);
	for (size_t i = 0; i < gz_answer_column_count; i++) {
		const struct gz_answer_column *column = &gz_answer_columns[i];
		char *cell = strsep(&line, "\t");
		if (!cell)
			return refuse_line(answers, lines, "a row has too few cells");
		if (strcmp(column->name, "run") == 0 && atoi(cell) >= answers->run)
			answers->run = atoi(cell) + 1;
		if (strcmp(column->name, "response") == 0)
			answered = strcmp(cell, "n/a") != 0;
		if (strcmp(column->name, "correct") == 0)
			right = strcmp(cell, "1") == 0;
		if (!column->identity)
			continue;
		column->print(&row, expected, sizeof expected);
		if (strcmp(cell, expected) == 0)
			continue;
		snprintf(what, sizeof what, "%s is %.60s, but this experiment has %.60s",
			 column->name, cell, expected);
		return refuse_line(answers, lines, what);
	}
	if (answered)
		gz_staircase_take(staircase, right);
	answers->done++;
	answers->next = gz_sequence_next(answers->sequence, answers->next + 1);
	return line ? refuse_line(answers, lines, "a row has too many cells") : GZ_OK;
}

static enum gz_result check_lines(struct gz_answers *answers, struct lines *lines)
{
	struct gz_text header = header_text();
	char *line = next_row(lines);
	if (header.failed) {
		gz_text_free(&header);
		return GZ_ERR_NO_MEM;
	}
	enum gz_result result = GZ_OK;
	if (!line)
		lines->number = 1;
	const size_t length = header.length - 1; /* without the newline */
	/* After a power cut the file may hold the beginning of the header. */
	if (line ? strlen(line) != length || memcmp(line, header.bytes, length) != 0
		 : lines->size > length || memcmp(lines->text, header.bytes, lines->size) != 0)
		result = refuse_line(answers, lines,
				     "the columns differ from those of this version");
	gz_text_free(&header);
	while (result == GZ_OK && (line = next_row(lines)) != NULL)
		result = check_row(answers, lines, line);
	return result;
}

/* Remove the incomplete row that a power cut leaves. */
static enum gz_result cut_partial_row(const struct gz_answers *answers, const struct lines *lines)
{
	if (lines->whole < lines->size) {
		gz_warn(answers->log, "%s: the last row is incomplete; its trial is repeated",
			answers->path);
		if (ftruncate(answers->fd, (off_t)lines->whole) != 0)
			return refuse_io(answers, "cannot be written");
	}
	if (lseek(answers->fd, 0, SEEK_END) < 0)
		return refuse_io(answers, "cannot be written");
	return GZ_OK;
}

static enum gz_result write_header(const struct gz_answers *answers)
{
	struct gz_text header = header_text();
	const enum gz_result result = append_row(answers, &header);
	gz_text_free(&header);
	return result;
}

/* Two programs must not write the same file. */
static enum gz_result lock_answers(const struct gz_answers *answers)
{
	if (flock(answers->fd, LOCK_EX | LOCK_NB) == 0)
		return GZ_OK;
	gz_err(answers->log, "%s: another gazeview is writing it; end that one first",
	       answers->path);
	return GZ_ERR_BUSY;
}

static enum gz_result resume_answers(struct gz_answers *answers)
{
	struct lines lines = { 0 };
	answers->fd = open(answers->path, O_RDWR | O_CLOEXEC);
	if (answers->fd < 0 && errno == ENOENT) {
		gz_err(answers->log, "%s: does not exist; leave out --resume", answers->path);
		return GZ_ERR_NOT_FOUND;
	}
	if (answers->fd < 0)
		return refuse_io(answers, "cannot be opened");
	enum gz_result result = lock_answers(answers);
	if (result == GZ_OK)
		result = read_lines(answers, &lines);
	if (result == GZ_OK)
		result = check_lines(answers, &lines);
	if (result == GZ_OK && answers->next == answers->sequence->count) {
		gz_err(answers->log, "%s: all %zu trials are answered; start another --session",
		       answers->path, answers->done);
		result = GZ_ERR_BUSY;
	}
	if (result == GZ_OK)
		result = cut_partial_row(answers, &lines);
	if (result == GZ_OK && lines.whole == 0)
		result = write_header(answers);
	free(lines.text);
	return result;
}

/* Refuse to overwrite an existing file, and log how many trials it has. */
static enum gz_result refuse_present(const struct gz_answers *answers)
{
	struct lines lines = { 0 };
	struct gz_answers there = *answers;
	size_t rows = 0;
	there.fd = open(answers->path, O_RDONLY | O_CLOEXEC);
	there.log = NULL;
	if (there.fd >= 0 && read_lines(&there, &lines) == GZ_OK)
		while (next_row(&lines))
			rows++;
	free(lines.text);
	if (there.fd >= 0)
		close(there.fd);
	gz_err(answers->log,
	       "%s: already exists, with %zu of %zu trials; continue it with --resume, or start "
	       "another --session",
	       answers->path, rows > 0 ? rows - 1 : 0, answers->sequence->count);
	return GZ_ERR_BUSY;
}

static enum gz_result make_new(struct gz_answers *answers)
{
	answers->fd = open(answers->path, O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0644);
	if (answers->fd < 0 && errno == EEXIST)
		return refuse_present(answers);
	if (answers->fd < 0)
		return refuse_io(answers, "cannot be created");
	enum gz_result result = lock_answers(answers);
	return result == GZ_OK ? write_header(answers) : result;
}

enum { COLUMNS_PATH_SIZE = GZ_PATH_SIZE + 8 };

/* The file that describes the columns. */
static void print_columns_path(const struct gz_answers *answers, char path[COLUMNS_PATH_SIZE])
{
	snprintf(path, COLUMNS_PATH_SIZE, "%.*s.json",
		 (int)(strlen(answers->path) - strlen(".tsv")), answers->path);
}

static void write_columns(const struct gz_answers *answers)
{
	char path[COLUMNS_PATH_SIZE];
	print_columns_path(answers, path);
	if (gz_answer_columns_write(path, answers->experiment, answers->request.version) != GZ_OK)
		gz_warn(answers->log, "%s: cannot be written; the answers are written without it",
			path);
}

enum gz_result gz_answers_open(const struct gz_experiment *experiment,
			       const struct gz_sequence *sequence,
			       const struct gz_answers_request *request, const struct gz_log *log,
			       struct gz_answers **out_answers)
{
	struct gz_answers *answers = calloc(1, sizeof *answers);
	if (!answers)
		return GZ_ERR_NO_MEM;
	*answers = (struct gz_answers) {
		.log = log,
		.experiment = experiment,
		.sequence = sequence,
		.request = *request,
		.fd = -1,
		.run = 1,
	};
	enum gz_result result =
		gz_answers_path(experiment, request, answers->path, sizeof answers->path);
	if (result != GZ_OK)
		gz_err(log, "--answers: the path is too long; choose another folder");
	else
		result = request->resume ? resume_answers(answers) : make_new(answers);
	if (result != GZ_OK) {
		if (answers->fd >= 0)
			close(answers->fd);
		free(answers);
		return result;
	}
	write_columns(answers);
	*out_answers = answers;
	return GZ_OK;
}

size_t gz_answers_done(const struct gz_answers *answers)
{
	return answers->done;
}

size_t gz_answers_next(const struct gz_answers *answers)
{
	return answers->next;
}

const char *gz_answers_file(const struct gz_answers *answers)
{
	return answers->path;
}

/* Once a run, and in a folder only: a file of one's own has its own list. */
static void list_participant(struct gz_answers *answers)
{
	const struct gz_answers_request *request = &answers->request;
	const struct gz_participant participant = {
		.label = request->participant,
		.session = request->session,
		.notes = request->notes,
	};
	if (!answers->listed && !is_answer_file(request->place))
		gz_participants_list(request->place[0] ? request->place : ".", &participant,
				     answers->log);
	answers->listed = true;
}

enum gz_result gz_answers_write(struct gz_answers *answers, const struct gz_trial_result *result,
				int64_t start_ns, const struct gz_trial_equipment *equipment)
{
	char cell[GZ_ANSWER_CELL_SIZE];
	const struct gz_answer_row row = answer_row_of(answers, result, start_ns, equipment);
	struct gz_text text = { 0 };
	for (size_t i = 0; i < gz_answer_column_count; i++) {
		gz_answer_columns[i].print(&row, cell, sizeof cell);
		gz_text_add(&text, "%s%s", i ? "\t" : "", cell);
	}
	gz_text_add(&text, "\n");
	const enum gz_result written = append_row(answers, &text);
	gz_text_free(&text);
	if (written == GZ_OK) {
		list_participant(answers);
		answers->done++;
		answers->next = gz_sequence_next(answers->sequence, result->index + 1);
	}
	return written;
}

void gz_answers_close(struct gz_answers **answers)
{
	struct gz_answers *closed = *answers;
	if (!closed)
		return;
	if (closed->done == 0) {
		char path[COLUMNS_PATH_SIZE];
		unlink(closed->path);
		print_columns_path(closed, path);
		unlink(path);
	}
	close(closed->fd);
	free(closed);
	*answers = NULL;
}
