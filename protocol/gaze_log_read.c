#include <errno.h>
#include <inttypes.h>
#include <locale.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <zlib.h>

#include "protocol/gaze_log_lines.h"

#define GZ_LOG_MODULE "gaze_log"

enum {
	CHUNK_SIZE = 65536, /* bytes read at once; chosen: many lines */
	FAULTS_LOGGED = 10, /* malformed lines that are logged; chosen: enough to see a pattern */
};

/* What was read as the next line. */
enum line_kind {
	LINE_WHOLE,
	LINE_TOO_LONG,   /* longer than a line may be */
	LINE_UNREADABLE, /* contains a NUL */
	LINE_END,        /* no further newline: the log ends, perhaps in the middle of a line */
	LINE_FAILED,     /* reading failed; logged */
};

struct gz_gaze_log_reader {
	const struct gz_log *log;
	char *name;
	FILE *file; /* NULL: the log is in memory */
	locale_t c_locale;

	const char *bytes; /* the chunk, or the caller's memory */
	size_t size, next; /* of bytes; offset of the next line */
	char *chunk;
	bool failed;

	char line[GZ_GAZE_LOG_LINE_SIZE]; /* the last line that was read, without its newline, with
					     a NUL */
	enum line_kind kind;
	bool line_peeked; /* line was read ahead and not used yet */
	uint64_t line_number;
	uint32_t crc;        /* of all bytes up to and including line */
	uint32_t crc_before; /* of all bytes before line */

	uint64_t samples, faults;
	bool still_scene; /* of the next sample */
	enum gz_gaze_log_ending ending;
	struct gz_gaze_log_header header;
};

/* Read the next chunk. @return false at the end and on failure */
static bool refill_log_bytes(struct gz_gaze_log_reader *reader)
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

/* Copy the part of the line that is in the present bytes. *length counts the bytes that do not fit,
 * too. @return whether the newline was found */
static bool take_line_piece(struct gz_gaze_log_reader *reader, size_t *length)
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

static enum line_kind read_log_line(struct gz_gaze_log_reader *reader)
{
	size_t length = 0;
	reader->crc_before = reader->crc;
	bool whole = false;
	while (!whole && (reader->next < reader->size || refill_log_bytes(reader)))
		whole = take_line_piece(reader, &length);
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

/* Read a line ahead, unless one has been read ahead already. */
static enum line_kind peek_log_line(struct gz_gaze_log_reader *reader)
{
	if (!reader->line_peeked)
		reader->kind = read_log_line(reader);
	reader->line_peeked = true;
	return reader->kind;
}

static bool read_version_line(struct gz_gaze_log_reader *reader)
{
	enum line_kind kind = peek_log_line(reader);
	reader->line_peeked = false;
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
	reader->line_peeked = false;
	if (reader->kind != LINE_WHOLE)
		return refuse_header(reader,
				     "the header line contains a NUL or is longer than 2048 bytes");
	const char *fault =
		gz_gaze_log_parse_header(reader->line, reader->c_locale, state, &reader->header);
	if (!fault)
		return GZ_OK;
	/* The parser has cut the line after its key. */
	gz_err(reader->log, "%s:%" PRIu64 ": %s: %s", reader->name, reader->line_number,
	       reader->line, fault);
	return GZ_ERR_FORMAT;
}

static bool next_is_header_line(struct gz_gaze_log_reader *reader)
{
	enum line_kind kind = peek_log_line(reader);
	return kind != LINE_END && kind != LINE_FAILED && reader->line[0] == '#' &&
	       !is_end_line(reader->line);
}

static enum gz_result read_log_header(struct gz_gaze_log_reader *reader)
{
	struct gz_gaze_log_header_state state = { 0 };
	bool version_read = read_version_line(reader);
	if (!version_read && !reader->failed) {
		gz_err(reader->log,
		       "%s:1: not a gaze log of version 1, which begins with #gazecast-log 1",
		       reader->name);
		return GZ_ERR_FORMAT;
	}
	while (version_read && next_is_header_line(reader)) {
		enum gz_result result = read_header_line(reader, &state);
		if (result != GZ_OK)
			return result;
	}
	return reader->failed ? GZ_ERR_IO : GZ_OK;
}

static enum gz_result create_log_reader(const char *name, const struct gz_log *log,
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
		gz_err(log, "%s: out of memory", name);
		gz_gaze_log_close(&reader);
		return GZ_ERR_NO_MEM;
	}
	*out_reader = reader;
	return GZ_OK;
}

/* Read the header; on success pass the reader to the caller, otherwise close it. */
static enum gz_result open_with_header(struct gz_gaze_log_reader *reader,
				       struct gz_gaze_log_reader **out_reader)
{
	enum gz_result result = read_log_header(reader);
	if (result == GZ_OK)
		*out_reader = reader;
	else
		gz_gaze_log_close(&reader);
	return result;
}

static enum gz_result open_log_file(struct gz_gaze_log_reader *reader, const char *path)
{
	reader->chunk = malloc(CHUNK_SIZE);
	if (!reader->chunk) {
		gz_err(reader->log, "%s: out of memory", path);
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
	enum gz_result result = create_log_reader(path, log, &reader);
	if (result != GZ_OK)
		return result;
	result = open_log_file(reader, path);
	if (result != GZ_OK) {
		gz_gaze_log_close(&reader);
		return result;
	}
	return open_with_header(reader, out_reader);
}

enum gz_result gz_gaze_log_open_memory(const char *name, const void *bytes, size_t size,
				       const struct gz_log *log,
				       struct gz_gaze_log_reader **out_reader)
{
	struct gz_gaze_log_reader *reader;
	enum gz_result result = create_log_reader(name, log, &reader);
	if (result != GZ_OK)
		return result;
	reader->bytes = bytes;
	reader->size = size;
	return open_with_header(reader, out_reader);
}

const struct gz_gaze_log_header *gz_gaze_log_header(const struct gz_gaze_log_reader *reader)
{
	return &reader->header;
}

enum gz_gaze_log_ending gz_gaze_log_ending(const struct gz_gaze_log_reader *reader)
{
	return reader->ending;
}

static enum gz_result end_log(struct gz_gaze_log_reader *reader, enum gz_gaze_log_ending ending,
			      const char *reason)
{
	reader->ending = ending;
	if (reason)
		gz_warn(reader->log,
			"%s: %s; %" PRIu64 " samples found, %" PRIu64 " malformed lines skipped",
			reader->name, reason, reader->samples, reader->faults);
	return GZ_ERR_END;
}

/* Compare the "#end" line with what was read. */
static enum gz_result check_end_line(struct gz_gaze_log_reader *reader)
{
	uint32_t crc_before = reader->crc_before, crc;
	uint64_t samples;
	if (!gz_gaze_log_parse_end(reader->line, &samples, &crc))
		return end_log(reader, GZ_GAZE_LOG_CORRUPTED, "the #end line is malformed");
	if (crc != crc_before)
		return end_log(reader, GZ_GAZE_LOG_CORRUPTED,
			       "the checksum is wrong: the log was changed");
	if (samples != reader->samples)
		return end_log(reader, GZ_GAZE_LOG_CORRUPTED,
			       "the number of samples in the #end line is wrong");
	if (reader->next < reader->size || refill_log_bytes(reader))
		return end_log(reader, GZ_GAZE_LOG_CORRUPTED,
			       "there are bytes after the #end line");
	if (reader->failed)
		return GZ_ERR_IO;
	return end_log(reader, GZ_GAZE_LOG_WHOLE, NULL);
}

static enum gz_result refuse_log_line(struct gz_gaze_log_reader *reader, const char *fault)
{
	if (reader->faults++ < FAULTS_LOGGED)
		gz_warn(reader->log, "%s:%" PRIu64 ": %s; the line is skipped", reader->name,
			reader->line_number, fault);
	return GZ_ERR_FORMAT;
}

static enum gz_result parse_log_line(struct gz_gaze_log_reader *reader,
				     struct gz_gaze_log_record *out_record)
{
	if (reader->line[0] == '#')
		return is_end_line(reader->line)
			       ? check_end_line(reader)
			       : refuse_log_line(reader, "a header line after the header");
	struct gz_gaze_log_record record = { 0 };
	const char *fault = gz_gaze_log_parse_record(reader->line, reader->c_locale, &record);
	if (fault)
		return refuse_log_line(reader, fault);
	reader->samples += record.kind == GZ_GAZE_LOG_SAMPLE;
	if (record.kind == GZ_GAZE_LOG_SCENE)
		reader->still_scene = record.still_scene;
	record.sample.still_scene = reader->still_scene;
	*out_record = record;
	return GZ_OK;
}

enum gz_result gz_gaze_log_read(struct gz_gaze_log_reader *reader,
				struct gz_gaze_log_record *out_record)
{
	if (reader->ending != GZ_GAZE_LOG_UNREAD)
		return GZ_ERR_END;
	enum line_kind kind = peek_log_line(reader);
	reader->line_peeked = false;
	switch (kind) {
	case LINE_WHOLE:
		return parse_log_line(reader, out_record);
	case LINE_TOO_LONG:
		return refuse_log_line(reader, "longer than 2048 bytes");
	case LINE_UNREADABLE:
		return refuse_log_line(reader, "contains a NUL");
	case LINE_END:
		return end_log(reader, GZ_GAZE_LOG_CUT, "no #end line: the recording was cut off");
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

/* Bytes at the end of the file that are searched. Chosen: the marks after the last sample are
 * shorter. */
enum { TAIL_SIZE = 65536 };

/* Read the end of the file. @return bytes read; 0 if there are none or reading failed */
static size_t read_log_tail(FILE *file, char *bytes)
{
	if (fseek(file, 0, SEEK_END) != 0)
		return 0;
	const long size = ftell(file);
	const long from = size > TAIL_SIZE ? size - TAIL_SIZE : 0;
	const size_t got =
		size > 0 && fseek(file, from, SEEK_SET) == 0 ? fread(bytes, 1, TAIL_SIZE, file) : 0;
	/* A NUL must not end the text; its line is malformed anyway. */
	for (size_t i = 0; i < got; i++)
		if (!bytes[i])
			bytes[i] = '?';
	return got;
}

static bool is_sample_line(char *line, locale_t c_locale, int64_t *out_host_ns)
{
	struct gz_gaze_log_record record;
	if (gz_gaze_log_parse_record(line, c_locale, &record) || record.kind != GZ_GAZE_LOG_SAMPLE)
		return false;
	*out_host_ns = record.sample.host_ns;
	return true;
}

/* Search backwards for a sample: from the last line with a newline to the first one that is whole.
 * Cuts the text into lines. */
static enum gz_result find_last_sample(char *text, locale_t c_locale, int64_t *out_host_ns)
{
	char *newline = strrchr(text, '\n');
	while (newline) {
		*newline = '\0';
		newline = strrchr(text, '\n');
		if (newline && is_sample_line(newline + 1, c_locale, out_host_ns))
			return GZ_OK;
	}
	return GZ_ERR_FORMAT;
}

enum gz_result gz_gaze_log_find_last(const char *path, int64_t *out_host_ns)
{
	FILE *file = fopen(path, "rbe");
	if (!file)
		return errno == ENOENT ? GZ_ERR_NOT_FOUND : GZ_ERR_IO;
	char *text = malloc(TAIL_SIZE + 1);
	locale_t c_locale = newlocale(LC_ALL_MASK, "C", (locale_t)0);
	enum gz_result r = text && c_locale ? GZ_ERR_IO : GZ_ERR_NO_MEM;
	const size_t size = text && c_locale ? read_log_tail(file, text) : 0;
	if (size > 0) {
		text[size] = '\0';
		r = find_last_sample(text, c_locale, out_host_ns);
	}
	if (c_locale)
		freelocale(c_locale);
	free(text);
	fclose(file);
	return r;
}
