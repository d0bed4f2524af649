#include <errno.h>
#include <inttypes.h>
#include <locale.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <zlib.h>

#include "protocol/gaze_log_parse.h"

#define GZ_LOG_MODULE "gaze_log"

enum {
	CHUNK_SIZE = 65536, /* read from the file at once; chosen: large against a line */
	FAULTS_LOGGED =
		10, /* malformed lines told of one by one; chosen: enough to see a pattern */
};

/* What stands at the reader's place in the log. */
enum line_kind {
	LINE_WHOLE,
	LINE_TOO_LONG,   /* longer than a line may be; skipped */
	LINE_UNREADABLE, /* with a NUL in it */
	LINE_END,        /* no further newline: the log is over, what is left is no whole line */
	LINE_FAILED,     /* reading failed; logged */
};

struct gz_gaze_log_reader {
	const struct gz_log *log;
	char *name;
	FILE *file; /* NULL: memory */
	locale_t c_locale;

	const char *bytes; /* chunk, or the caller's memory */
	size_t size, next; /* of bytes; where the next line begins */
	char *chunk;
	bool failed;

	char line[GZ_GAZE_LOG_LINE_SIZE]; /* without its newline, ended by a NUL */
	enum line_kind kind;
	bool line_waits; /* line was read ahead and is still to be used */
	uint64_t line_number;
	uint32_t crc;        /* of everything up to and with line */
	uint32_t crc_before; /* of everything before line */

	uint64_t samples, faults;
	enum gz_gaze_log_ending ending;
	struct gz_gaze_log_header header;
};

/* Get further bytes. False at the end and on failure. */
static bool refill(struct gz_gaze_log_reader *reader)
{
	if (!reader->file || reader->failed)
		return false;
	reader->size = fread(reader->chunk, 1, CHUNK_SIZE, reader->file);
	reader->next = 0;
	if (reader->size == 0 && ferror(reader->file)) {
		gz_err(reader->log, "%s: cannot read: %s", reader->name, strerror(errno));
		reader->failed = true;
	}
	return reader->size > 0;
}

/* Copy what belongs to the line from the bytes at hand; true once its newline was among them.
 * @p length counts also what no longer fits. */
static bool take_piece(struct gz_gaze_log_reader *reader, size_t *length)
{
	const char *from = reader->bytes + reader->next;
	size_t left = reader->size - reader->next;
	const char *newline = memchr(from, '\n', left);
	size_t piece = newline ? (size_t)(newline - from) : left;
	size_t room = sizeof reader->line - 1;
	if (*length < room)
		memcpy(reader->line + *length, from,
		       piece < room - *length ? piece : room - *length);
	*length += piece;
	piece += newline != NULL;
	reader->crc = (uint32_t)crc32_z(reader->crc, (const unsigned char *)from, piece);
	reader->next += piece;
	return newline != NULL;
}

static enum line_kind next_line(struct gz_gaze_log_reader *reader)
{
	size_t length = 0;
	reader->crc_before = reader->crc;
	bool whole = false;
	while (!whole && (reader->next < reader->size || refill(reader)))
		whole = take_piece(reader, &length);
	if (!whole)
		return reader->failed ? LINE_FAILED : LINE_END;
	reader->line_number++;
	if (length > sizeof reader->line - 1) {
		reader->line[sizeof reader->line - 1] = '\0';
		return LINE_TOO_LONG;
	}
	reader->line[length] = '\0';
	return memchr(reader->line, '\0', length) ? LINE_UNREADABLE : LINE_WHOLE;
}

/* Make the line the next to be used, unless one waits already. */
static enum line_kind look_at_line(struct gz_gaze_log_reader *reader)
{
	if (!reader->line_waits)
		reader->kind = next_line(reader);
	reader->line_waits = true;
	return reader->kind;
}

static bool read_version(struct gz_gaze_log_reader *reader)
{
	enum line_kind kind = look_at_line(reader);
	reader->line_waits = false;
	return kind == LINE_WHOLE && gz_gaze_log_parse_version(reader->line);
}

static bool is_end_line(const char *line)
{
	return strncmp(line, "#end", 4) == 0 && strchr(" \t", line[4]);
}

static enum gz_result refuse_header(const struct gz_gaze_log_reader *reader, const char *fault)
{
	gz_err(reader->log, "%s:%" PRIu64 ": %s", reader->name, reader->line_number, fault);
	return GZ_ERR_FORMAT;
}

static enum gz_result read_header_line(struct gz_gaze_log_reader *reader,
				       struct gz_gaze_log_header_state *state)
{
	reader->line_waits = false;
	if (reader->kind != LINE_WHOLE)
		return refuse_header(reader, "a header line with a NUL or of more than 2048 bytes");
	const char *fault =
		gz_gaze_log_parse_header(reader->line, reader->c_locale, state, &reader->header);
	if (!fault)
		return GZ_OK;
	/* The parser has cut the line behind its key. */
	gz_err(reader->log, "%s:%" PRIu64 ": %s: %s", reader->name, reader->line_number,
	       reader->line, fault);
	return GZ_ERR_FORMAT;
}

static bool header_goes_on(struct gz_gaze_log_reader *reader)
{
	enum line_kind kind = look_at_line(reader);
	return kind != LINE_END && kind != LINE_FAILED && reader->line[0] == '#' &&
	       !is_end_line(reader->line);
}

static enum gz_result read_header(struct gz_gaze_log_reader *reader)
{
	struct gz_gaze_log_header_state state = { 0 };
	bool version_read = read_version(reader);
	if (!version_read && !reader->failed) {
		gz_err(reader->log,
		       "%s:1: not a gaze log of version 1: it must begin with #gazecast-log 1",
		       reader->name);
		return GZ_ERR_FORMAT;
	}
	while (version_read && header_goes_on(reader)) {
		enum gz_result result = read_header_line(reader, &state);
		if (result != GZ_OK)
			return result;
	}
	return reader->failed ? GZ_ERR_IO : GZ_OK;
}

static enum gz_result prepare(const char *name, const struct gz_log *log,
			      struct gz_gaze_log_reader **out_reader)
{
	struct gz_gaze_log_reader *reader = calloc(1, sizeof *reader);
	if (reader) {
		reader->log = log;
		reader->crc = (uint32_t)crc32_z(0, NULL, 0);
		reader->name = strdup(name);
		reader->c_locale = newlocale(LC_ALL_MASK, "C", (locale_t)0);
	}
	if (!reader || !reader->name || !reader->c_locale) {
		gz_err(log, "%s: no memory to read it", name);
		gz_gaze_log_close(&reader);
		return GZ_ERR_NO_MEM;
	}
	*out_reader = reader;
	return GZ_OK;
}

/* Hand a reader that is ready to read over to the caller, or close it. */
static enum gz_result finish_open(struct gz_gaze_log_reader *reader,
				  struct gz_gaze_log_reader **out_reader)
{
	enum gz_result result = read_header(reader);
	if (result == GZ_OK)
		*out_reader = reader;
	else
		gz_gaze_log_close(&reader);
	return result;
}

static enum gz_result open_file(struct gz_gaze_log_reader *reader, const char *path)
{
	reader->chunk = malloc(CHUNK_SIZE);
	if (!reader->chunk) {
		gz_err(reader->log, "%s: no memory to read it", path);
		return GZ_ERR_NO_MEM;
	}
	reader->bytes = reader->chunk;
	reader->file = fopen(path, "rbe");
	if (reader->file) {
		setvbuf(reader->file, NULL, _IONBF, 0); /* chunk is the buffer */
		return GZ_OK;
	}
	enum gz_result result = errno == ENOENT ? GZ_ERR_NOT_FOUND : GZ_ERR_IO;
	gz_err(reader->log, "cannot open %s: %s; check the path", path, strerror(errno));
	return result;
}

enum gz_result gz_gaze_log_open(const char *path, const struct gz_log *log,
				struct gz_gaze_log_reader **out_reader)
{
	struct gz_gaze_log_reader *reader;
	enum gz_result result = prepare(path, log, &reader);
	if (result != GZ_OK)
		return result;
	result = open_file(reader, path);
	if (result != GZ_OK) {
		gz_gaze_log_close(&reader);
		return result;
	}
	return finish_open(reader, out_reader);
}

enum gz_result gz_gaze_log_open_memory(const char *name, const void *bytes, size_t size,
				       const struct gz_log *log,
				       struct gz_gaze_log_reader **out_reader)
{
	struct gz_gaze_log_reader *reader;
	enum gz_result result = prepare(name, log, &reader);
	if (result != GZ_OK)
		return result;
	reader->bytes = bytes;
	reader->size = size;
	return finish_open(reader, out_reader);
}

const struct gz_gaze_log_header *gz_gaze_log_header(const struct gz_gaze_log_reader *reader)
{
	return &reader->header;
}

enum gz_gaze_log_ending gz_gaze_log_ending(const struct gz_gaze_log_reader *reader)
{
	return reader->ending;
}

static enum gz_result end_with(struct gz_gaze_log_reader *reader, enum gz_gaze_log_ending ending,
			       const char *reason)
{
	reader->ending = ending;
	if (reason)
		gz_warn(reader->log,
			"%s: %s; %" PRIu64 " samples found, %" PRIu64 " malformed lines skipped",
			reader->name, reason, reader->samples, reader->faults);
	return GZ_ERR_END;
}

/* The line is an "#end". */
static enum gz_result check_end(struct gz_gaze_log_reader *reader)
{
	uint32_t crc_before = reader->crc_before, crc;
	uint64_t samples;
	if (!gz_gaze_log_parse_end(reader->line, &samples, &crc))
		return end_with(reader, GZ_GAZE_LOG_CORRUPTED, "the #end line is malformed");
	if (crc != crc_before)
		return end_with(reader, GZ_GAZE_LOG_CORRUPTED,
				"the checksum is not that of the log, which was changed");
	if (samples != reader->samples)
		return end_with(reader, GZ_GAZE_LOG_CORRUPTED,
				"the #end line tells another number of samples");
	if (reader->next < reader->size || refill(reader))
		return end_with(reader, GZ_GAZE_LOG_CORRUPTED, "bytes behind the #end line");
	if (reader->failed)
		return GZ_ERR_IO;
	return end_with(reader, GZ_GAZE_LOG_WHOLE, NULL);
}

static enum gz_result refuse_line(struct gz_gaze_log_reader *reader, const char *fault)
{
	if (reader->faults++ < FAULTS_LOGGED)
		gz_warn(reader->log, "%s:%" PRIu64 ": %s; the line is skipped", reader->name,
			reader->line_number, fault);
	return GZ_ERR_FORMAT;
}

static enum gz_result use_line(struct gz_gaze_log_reader *reader,
			       struct gz_gaze_log_record *out_record)
{
	if (reader->line[0] == '#')
		return is_end_line(reader->line)
			       ? check_end(reader)
			       : refuse_line(reader, "a header line behind the header");
	struct gz_gaze_log_record record = { 0 };
	const char *fault = gz_gaze_log_parse_record(reader->line, reader->c_locale, &record);
	if (fault)
		return refuse_line(reader, fault);
	reader->samples += record.kind == GZ_GAZE_LOG_SAMPLE;
	*out_record = record;
	return GZ_OK;
}

enum gz_result gz_gaze_log_read(struct gz_gaze_log_reader *reader,
				struct gz_gaze_log_record *out_record)
{
	if (reader->ending != GZ_GAZE_LOG_UNREAD)
		return GZ_ERR_END;
	enum line_kind kind = look_at_line(reader);
	reader->line_waits = false;
	switch (kind) {
	case LINE_WHOLE:
		return use_line(reader, out_record);
	case LINE_TOO_LONG:
		return refuse_line(reader, "longer than a line may be (2048 bytes)");
	case LINE_UNREADABLE:
		return refuse_line(reader, "a NUL in the text");
	case LINE_END:
		return end_with(reader, GZ_GAZE_LOG_CUT, "no #end line: the recording was cut");
	case LINE_FAILED:
		break;
	}
	return GZ_ERR_IO;
}

void gz_gaze_log_close(struct gz_gaze_log_reader **reader)
{
	struct gz_gaze_log_reader *old = *reader;
	if (!old)
		return;
	*reader = NULL;
	if (old->file)
		fclose(old->file);
	if (old->c_locale)
		freelocale(old->c_locale);
	free(old->chunk);
	free(old->name);
	free(old);
}
