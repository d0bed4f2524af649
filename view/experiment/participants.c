#include "view/experiment/participants.h"

#include <errno.h>
#include <fcntl.h>
#include <stdbool.h>
#include <string.h>
#include <sys/file.h>
#include <unistd.h>

#include "base/sizes.h"
#include "base/text.h"

#define GZ_LOG_MODULE "experiment"

/* Largest file, bytes. Chosen: more than any study has participants. */
enum { MOST_BYTES = 1 << 24 };

/* A missing value, as BIDS has it. */
#define NONE "n/a"

static const char description[] =
	"{\n"
	"  \"participant_id\": {\n"
	"    \"Description\": \"Label of the participant, as in the names of files.\"\n"
	"  },\n"
	"  \"notes\": {\n"
	"    \"Description\": \"What the experimenter noted, by session.\"\n"
	"  }\n"
	"}\n";

/* The list being changed. */
struct list {
	const struct gz_participant *participant;
	const struct gz_log *log;
	char path[GZ_PATH_SIZE];
	struct gz_text before, after;
	size_t columns;   /* of the file before */
	size_t notes_at;  /* column of the notes */
	bool notes_added; /* there was no such column */
	bool listed;      /* the participant has a row */
	int line;
};

static enum gz_result refuse_list(const struct list *list, const char *what)
{
	gz_err(list->log, "%s:%d: %s; the participant is not listed there", list->path, list->line,
	       what);
	return GZ_ERR_FORMAT;
}

/* Add the notes of this session to a cell. */
static void add_notes_cell(struct list *list, const char *cell)
{
	const struct gz_participant *participant = list->participant;
	const bool empty = !cell[0] || strcmp(cell, NONE) == 0;
	char notes[GZ_NOTES_SIZE + 64];
	if (gz_text_print(notes, sizeof notes, "%s%s%s%s", participant->session[0] ? "ses-" : "",
			  participant->session, participant->session[0] ? ": " : "",
			  participant->notes) != GZ_OK ||
	    !participant->notes[0] || strstr(cell, notes))
		gz_text_add(&list->after, "%s", empty ? NONE : cell);
	else
		gz_text_add(&list->after, "%s%s%s", empty ? "" : cell, empty ? "" : "; ", notes);
}

static enum gz_result take_list_header(struct list *list, char *line)
{
	size_t count = 0;
	bool found = false;
	for (char *cell = strsep(&line, "\t"); cell; cell = strsep(&line, "\t"), count++) {
		if (count == 0 && strcmp(cell, "participant_id") != 0)
			return refuse_list(list, "the first column is not participant_id");
		if (strcmp(cell, "notes") == 0 && !found) {
			list->notes_at = count;
			found = true;
		}
		gz_text_add(&list->after, "%s%s", count ? "\t" : "", cell);
	}
	list->columns = count;
	if (!found) {
		list->notes_at = count;
		list->notes_added = true;
		gz_text_add(&list->after, "\tnotes");
	}
	gz_text_add(&list->after, "\n");
	return GZ_OK;
}

static bool is_listed_as(const char *cell, const char *label)
{
	return strncmp(cell, "sub-", 4) == 0 && strcmp(cell + 4, label) == 0;
}

static enum gz_result take_list_row(struct list *list, char *line)
{
	size_t count = 0;
	bool here = false;
	for (char *cell = strsep(&line, "\t"); cell; cell = strsep(&line, "\t"), count++) {
		if (count == 0)
			here = is_listed_as(cell, list->participant->label);
		gz_text_add(&list->after, "%s", count ? "\t" : "");
		if (here && count == list->notes_at)
			add_notes_cell(list, cell);
		else
			gz_text_add(&list->after, "%s", cell);
	}
	if (count != list->columns)
		return refuse_list(list, "not as many cells as columns");
	if (list->notes_added) {
		gz_text_add(&list->after, "\t");
		if (here)
			add_notes_cell(list, "");
		else
			gz_text_add(&list->after, NONE);
	}
	gz_text_add(&list->after, "\n");
	list->listed = list->listed || here;
	return GZ_OK;
}

/* A row with nothing but the label and the notes. */
static void add_list_row(struct list *list)
{
	gz_text_add(&list->after, "sub-%s", list->participant->label);
	for (size_t i = 1; i < list->columns + list->notes_added; i++) {
		gz_text_add(&list->after, "\t");
		if (i == list->notes_at)
			add_notes_cell(list, "");
		else
			gz_text_add(&list->after, NONE);
	}
	gz_text_add(&list->after, "\n");
}

static enum gz_result read_list(struct list *list)
{
	static const char first_header[] = "participant_id\tnotes\n";
	const struct gz_text_file file = { list->path, "list of participants", MOST_BYTES };
	if (access(list->path, F_OK) != 0)
		gz_text_add(&list->before, first_header);
	else if (gz_text_load(&list->before, &file, list->log) != GZ_OK)
		return GZ_ERR_IO;
	if (list->before.failed)
		return GZ_ERR_NO_MEM;
	enum gz_result result = GZ_OK;
	char *rest = list->before.bytes;
	do {
		char *line = strsep(&rest, "\n");
		list->line++;
		if (line)
			line[strcspn(line, "\r")] = '\0';
		result = list->line == 1 ? take_list_header(list, line) : take_list_row(list, line);
	} while (result == GZ_OK && rest && *rest);
	return result;
}

static enum gz_result change_list(struct list *list)
{
	enum gz_result result = read_list(list);
	if (result == GZ_OK && !list->listed)
		add_list_row(list);
	if (result == GZ_OK)
		result = gz_text_write(&list->after, list->path, list->log);
	return result;
}

static enum gz_result describe_list(const char *folder, const struct gz_log *log)
{
	char path[GZ_PATH_SIZE];
	struct gz_text text = { 0 };
	if (gz_text_print(path, sizeof path, "%s/participants.json", folder) != GZ_OK)
		return GZ_ERR_IO;
	if (access(path, F_OK) == 0)
		return GZ_OK;
	gz_text_add(&text, "%s", description);
	const enum gz_result result = gz_text_write(&text, path, log);
	gz_text_free(&text);
	return result;
}

enum gz_result gz_participants_list(const char *folder, const struct gz_participant *participant,
				    const struct gz_log *log)
{
	struct list list = { .participant = participant, .log = log };
	if (gz_text_print(list.path, sizeof list.path, "%s/participants.tsv", folder) != GZ_OK) {
		gz_err(log, "%.60s...: the path is too long; choose another folder", folder);
		return GZ_ERR_IO;
	}
	/* The file is replaced when it is written, so the folder is locked. */
	const int lock = open(folder, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
	if (lock < 0 || flock(lock, LOCK_EX) != 0)
		gz_warn(log, "%s: cannot be locked: %s", folder, strerror(errno));
	enum gz_result result = change_list(&list);
	if (result == GZ_OK)
		result = describe_list(folder, log);
	if (lock >= 0)
		close(lock);
	gz_text_free(&list.before);
	gz_text_free(&list.after);
	return result;
}
