#include "view/session/session_reader.h"

#include <errno.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <zlib.h>

#include "view/session/session.h"
#include "view/settings/scene_keys.h"

#define GZ_LOG_MODULE "session"

enum { MESSAGE_SIZE = 256, WORD_SIZE = 64 };

struct gz_session_reader {
	const struct gz_log *log;
	char name[GZ_PATH_SIZE];
	FILE *file;
	struct gz_session_header header;
	uint64_t line_number;     /* of the current line */
	bool pending;             /* the current line has not been parsed yet */
	uint32_t crc, crc_before; /* of all bytes with and without the current line */
	enum gz_result ended;     /* result of all further reads; GZ_OK: not ended */
	uint64_t frames;
	int64_t time_ns;                        /* of the last frame */
	char line[GZ_SESSION_LINE_SIZE + 2];    /* with newline and NUL */
	char scratch[GZ_SESSION_LINE_SIZE + 2]; /* copy of the line, to be split */
};

__attribute__((format(printf, 2, 3))) static enum gz_result refuse_session_line(
	struct gz_session_reader *reader, const char *format, ...)
{
	char what[MESSAGE_SIZE];
	va_list arguments;
	va_start(arguments, format);
	vsnprintf(what, sizeof what, format, arguments);
	va_end(arguments);
	gz_err(reader->log, "%s:%llu: %s", reader->name, (unsigned long long)reader->line_number,
	       what);
	return reader->ended = GZ_ERR_FORMAT;
}

static enum gz_result end_cut(struct gz_session_reader *reader)
{
	gz_warn(reader->log, "%s: the session was cut short; %llu frames are complete",
		reader->name, (unsigned long long)reader->frames);
	return reader->ended = GZ_ERR_END;
}

/* Read the next line, without its newline, into the reader's buffer. */
static enum gz_result next_session_line(struct gz_session_reader *reader)
{
	if (reader->pending) {
		reader->pending = false;
		return GZ_OK;
	}
	errno = 0;
	if (!fgets(reader->line, sizeof reader->line, reader->file)) {
		if (!ferror(reader->file))
			return end_cut(reader);
		gz_err(reader->log, "%s: cannot be read: %s", reader->name, strerror(errno));
		return reader->ended = GZ_ERR_IO;
	}
	reader->line_number++;
	const size_t length = strlen(reader->line);
	if (length == 0 || reader->line[length - 1] != '\n') {
		if (length <= GZ_SESSION_LINE_SIZE && feof(reader->file))
			return end_cut(reader);
		return refuse_session_line(reader,
					   "line too long, or contains a NUL; the file is damaged");
	}
	reader->crc_before = reader->crc;
	reader->crc = (uint32_t)crc32(reader->crc, (const Bytef *)reader->line, (uInt)length);
	reader->line[length - 1] = '\0';
	return GZ_OK;
}

static bool is_end(const struct gz_session_reader *reader)
{
	return strncmp(reader->line, "#end", 4) == 0;
}

static enum gz_result parse_header_line(struct gz_session_reader *reader)
{
	strcpy(reader->scratch, reader->line);
	if (gz_session_parse_header_line(reader->scratch, &reader->header) == GZ_OK)
		return GZ_OK;
	return refuse_session_line(reader, "%.40s: invalid value; the file is damaged",
				   reader->line);
}

static enum gz_result read_session_header(struct gz_session_reader *reader)
{
	enum gz_result r = next_session_line(reader);
	if (r == GZ_OK && strcmp(reader->line, GZ_SESSION_FIRST_LINE) != 0)
		r = refuse_session_line(reader, "not \"" GZ_SESSION_FIRST_LINE
						"\": not a session, or one of a later version");
	if (r == GZ_OK)
		r = next_session_line(reader);
	while (r == GZ_OK && reader->line[0] == '#' && !is_end(reader)) {
		r = parse_header_line(reader);
		if (r == GZ_OK)
			r = next_session_line(reader);
	}
	if (r == GZ_ERR_END) /* cut short after the header: reading finds no frames */
		return reader->line_number > 0
			       ? GZ_OK
			       : refuse_session_line(reader,
						     "the file is empty; nothing was recorded");
	if (r != GZ_OK)
		return r;
	reader->pending = true;
	if (reader->header.volume.dims[0] > 0 && reader->header.volume.spacing[0] > 0)
		return GZ_OK;
	return refuse_session_line(
		reader, "#volume_dims or #volume_spacing is missing; the file is damaged");
}

static enum gz_result start_reader(const char *name, FILE *file, const struct gz_log *log,
				   struct gz_session_reader **out_reader)
{
	struct gz_session_reader *reader = calloc(1, sizeof *reader);
	if (!reader) {
		fclose(file);
		return GZ_ERR_NO_MEM;
	}
	reader->log = log;
	reader->file = file;
	reader->crc = (uint32_t)crc32(0, NULL, 0);
	snprintf(reader->name, sizeof reader->name, "%s", name);
	const enum gz_result r = read_session_header(reader);
	if (r != GZ_OK) {
		gz_session_close(&reader);
		return r;
	}
	*out_reader = reader;
	return GZ_OK;
}

enum gz_result gz_session_open(const char *path, const struct gz_log *log,
			       struct gz_session_reader **out_reader)
{
	char name[GZ_PATH_SIZE];
	struct stat status;
	if (gz_text_print(name, sizeof name, "%s/" GZ_SESSION_FRAMES, path) != GZ_OK) {
		gz_err(log, "%s: the path is too long; move the session", path);
		return GZ_ERR_FULL;
	}
	if (stat(name, &status) != 0 || !S_ISREG(status.st_mode)) {
		gz_err(log,
		       "%s: not a session: there is no file %s; name the folder of a recorded "
		       "session",
		       path, name);
		return GZ_ERR_NOT_FOUND;
	}
	FILE *file = fopen(name, "rbe");
	if (!file) {
		gz_err(log, "%s: cannot be opened: %s", name, strerror(errno));
		return GZ_ERR_IO;
	}
	return start_reader(name, file, log, out_reader);
}

enum gz_result gz_session_open_memory(const char *name, const char *text, size_t size,
				      const struct gz_log *log,
				      struct gz_session_reader **out_reader)
{
	/* fmemopen() in mode "r" does not write to the buffer. */
	FILE *file = fmemopen((void *)(uintptr_t)text, size, "rb");
	return file ? start_reader(name, file, log, out_reader) : GZ_ERR_NO_MEM;
}

const struct gz_session_header *gz_session_header(const struct gz_session_reader *reader)
{
	return &reader->header;
}

/* Split off the key and the value of a !set line, in scratch. */
static bool cut_set(struct gz_session_reader *reader, char **out_key, char **out_value)
{
	strcpy(reader->scratch, reader->line);
	*out_key = reader->scratch + sizeof GZ_SESSION_SET_WORD;
	*out_value = strchr(*out_key, '\t');
	if (!*out_value)
		return false;
	*(*out_value)++ = '\0';
	return true;
}

static enum gz_result parse_set_line(struct gz_session_reader *reader,
				     struct gz_session_state *state)
{
	struct gz_view_live_tables tables;
	char *key, *value, message[MESSAGE_SIZE / 2];
	size_t binding;
	if (!cut_set(reader, &key, &value))
		return refuse_session_line(reader,
					   "a setting without a value; the file is damaged");
	gz_view_pick_live_tables(&state->settings, &tables);
	const struct gz_option *option =
		gz_options_find(tables.bindings, tables.count, key, &binding);
	if (!option)
		return refuse_session_line(
			reader, "%.*s: unknown setting; the file is damaged or of a later version",
			WORD_SIZE, key);
	const bool table = strcmp(key, "foveation.table") == 0;
	if (table && strchr(value, '/'))
		return refuse_session_line(reader,
					   "foveation.table: not a file in the session's folder");
	state->table_changed = state->table_changed || table;
	state->templates_changed =
		state->templates_changed || strcmp(strrchr(key, '.'), ".template") == 0;
	if (gz_option_parse(option, value, tables.bindings[binding].target, message,
			    sizeof message) != GZ_OK)
		return refuse_session_line(reader, "%.*s: %s", WORD_SIZE, key, message);
	return GZ_OK;
}

/* The lines of a .tf file, separated by tabs. */
static enum gz_result parse_transfer_line(struct gz_session_reader *reader,
					  struct gz_session_state *state)
{
	char name[GZ_PATH_SIZE + 32];
	char *text = strcpy(reader->scratch, reader->line + sizeof GZ_SESSION_TRANSFER_WORD);
	for (char *tab = text; (tab = strchr(tab, '\t'));)
		*tab = '\n';
	snprintf(name, sizeof name, "%s:%llu: %s", reader->name,
		 (unsigned long long)reader->line_number, GZ_SESSION_TRANSFER_WORD);
	/* gz_transfer_parse() logs errors under that name. */
	if (gz_transfer_parse(name, text, strlen(text), reader->log, &state->transfer) != GZ_OK)
		return reader->ended = GZ_ERR_FORMAT;
	state->transfer_changed = true;
	return GZ_OK;
}

static enum gz_result parse_end_line(struct gz_session_reader *reader)
{
	uint64_t frames;
	uint32_t crc;
	strcpy(reader->scratch, reader->line);
	if (!gz_session_parse_end(reader->scratch, &frames, &crc))
		return refuse_session_line(reader, "invalid last line; the file is damaged");
	if (frames != reader->frames || crc != reader->crc_before)
		gz_warn(reader->log,
			"%s: the file was changed: %llu of %llu frames, or other contents",
			reader->name, (unsigned long long)reader->frames,
			(unsigned long long)frames);
	return reader->ended = GZ_ERR_END;
}

static enum gz_result parse_raise_line(struct gz_session_reader *reader,
				       struct gz_session_state *state)
{
	strcpy(reader->scratch, reader->line);
	if (gz_session_parse_raised(reader->scratch, &state->raised) == GZ_OK)
		return GZ_OK;
	return refuse_session_line(reader, GZ_SESSION_RAISE_WORD
				   ": not an object, a share and a range; the file is damaged");
}

static enum gz_result parse_finer_line(struct gz_session_reader *reader,
				       struct gz_session_state *state)
{
	strcpy(reader->scratch, reader->line);
	if (gz_session_parse_finer(reader->scratch, &state->finer) == GZ_OK)
		return GZ_OK;
	return refuse_session_line(reader, GZ_SESSION_FINER_WORD
				   ": not how much finer plans are; the file is damaged");
}

static enum gz_result parse_change_line(struct gz_session_reader *reader,
					struct gz_session_state *state)
{
	strcpy(reader->scratch, reader->line);
	if (gz_session_parse_change(reader->scratch, &state->change) == GZ_OK)
		return GZ_OK;
	return refuse_session_line(reader, GZ_SESSION_ADAPT_WORD
				   ": not five changes of settings; the file is damaged");
}

static enum gz_result parse_frame_line(struct gz_session_reader *reader,
				       const struct gz_session_state *state,
				       struct gz_session_frame *out_frame)
{
	struct gz_session_frame frame;
	const char *what = "";
	strcpy(reader->scratch, reader->line);
	if (gz_session_parse_frame(reader->scratch, &frame, &what) != GZ_OK)
		return refuse_session_line(reader, "%s: invalid in a frame; the file is damaged",
					   what);
	if (frame.time_ns < reader->time_ns)
		return refuse_session_line(reader,
					   "time_ns: earlier than that of the previous frame");
	reader->time_ns = frame.time_ns;
	reader->frames++;
	frame.focus.finer = state->finer > 0 ? state->finer : 1;
	frame.raised = state->raised;
	frame.change = state->change;
	*out_frame = frame;
	return GZ_OK;
}

static bool begins_with(const char *line, const char *word)
{
	const size_t length = strlen(word);
	return strncmp(line, word, length) == 0 && line[length] == '\t';
}

enum gz_result gz_session_read(struct gz_session_reader *reader, struct gz_session_state *state,
			       struct gz_session_frame *out_frame)
{
	state->transfer_changed = state->table_changed = state->templates_changed = false;
	while (reader->ended == GZ_OK && next_session_line(reader) == GZ_OK) {
		if (begins_with(reader->line, GZ_SESSION_SET_WORD))
			(void)parse_set_line(reader, state);
		else if (begins_with(reader->line, GZ_SESSION_TRANSFER_WORD))
			(void)parse_transfer_line(reader, state);
		else if (begins_with(reader->line, GZ_SESSION_RAISE_WORD))
			(void)parse_raise_line(reader, state);
		else if (begins_with(reader->line, GZ_SESSION_FINER_WORD))
			(void)parse_finer_line(reader, state);
		else if (begins_with(reader->line, GZ_SESSION_ADAPT_WORD))
			(void)parse_change_line(reader, state);
		else if (is_end(reader))
			(void)parse_end_line(reader);
		else
			return parse_frame_line(reader, state, out_frame);
	}
	return reader->ended;
}

void gz_session_print_place(const struct gz_session_reader *reader, char *text, size_t size)
{
	snprintf(text, size, "%s:%llu", reader->name, (unsigned long long)reader->line_number);
}

uint64_t gz_session_frames_read(const struct gz_session_reader *reader)
{
	return reader->frames;
}

void gz_session_close(struct gz_session_reader **reader)
{
	if (!*reader)
		return;
	fclose((*reader)->file);
	free(*reader);
	*reader = NULL;
}
