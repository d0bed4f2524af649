#include "client/gazectl/convert/text_lines.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <zlib.h>

#include "base/text.h"
#include "base/utf8.h"

enum { CHUNK = 65536 };

struct gz_text_lines {
	gzFile file; /* NULL: memory is read */
	const unsigned char *memory;
	size_t memory_left;
	uint64_t number;
	bool again;           /* see gz_text_lines_again() */
	size_t filled, taken; /* bytes of the chunk */
	unsigned char chunk[CHUNK];
	char line[GZ_TEXT_LINE_SIZE];
};

static enum gz_result result_of_errno(void)
{
	switch (errno) {
	case ENOENT:
	case ENOTDIR:
		return GZ_ERR_NOT_FOUND;
	case EACCES:
	case EPERM:
		return GZ_ERR_ACCESS;
	case ENOMEM:
		return GZ_ERR_NO_MEM;
	default:
		return GZ_ERR_IO;
	}
}

enum gz_result gz_text_lines_open(const char *path, struct gz_text_lines **out_lines)
{
	struct gz_text_lines *lines = calloc(1, sizeof *lines);
	if (!lines)
		return GZ_ERR_NO_MEM;
	errno = 0;
	lines->file = gzopen(path, "rbe");
	if (!lines->file) {
		enum gz_result result = errno ? result_of_errno() : GZ_ERR_NO_MEM;
		free(lines);
		return result;
	}
	*out_lines = lines;
	return GZ_OK;
}

enum gz_result gz_text_lines_open_memory(const void *bytes, size_t size,
					 struct gz_text_lines **out_lines)
{
	struct gz_text_lines *lines = calloc(1, sizeof *lines);
	if (!lines)
		return GZ_ERR_NO_MEM;
	lines->memory = bytes;
	lines->memory_left = size;
	*out_lines = lines;
	return GZ_OK;
}

/* Read the next bytes into the chunk. @return how many; 0 at the end, negative on failure */
static int fill_chunk(struct gz_text_lines *lines)
{
	if (lines->file)
		return gzread(lines->file, lines->chunk, CHUNK);
	size_t size = lines->memory_left < CHUNK ? lines->memory_left : CHUNK;
	if (size > 0)
		memcpy(lines->chunk, lines->memory, size);
	lines->memory += size;
	lines->memory_left -= size;
	return (int)size;
}

/* Read one line into the buffer. @retval GZ_ERR_END  there is none */
static enum gz_result gather_line(struct gz_text_lines *lines, size_t *out_length)
{
	size_t length = 0;
	bool any = false, too_long = false;
	for (;;) {
		if (lines->taken == lines->filled) {
			int size = fill_chunk(lines);
			if (size < 0)
				return GZ_ERR_IO;
			if (size == 0 && !any)
				return GZ_ERR_END;
			if (size == 0)
				break;
			lines->filled = (size_t)size;
			lines->taken = 0;
		}
		any = true;
		unsigned char byte = lines->chunk[lines->taken++];
		if (byte == '\n')
			break;
		if (length < GZ_TEXT_LINE_SIZE - 1)
			lines->line[length++] = byte ? (char)byte : ' ';
		else
			too_long = true;
	}
	*out_length = length;
	return too_long ? GZ_ERR_FULL : GZ_OK;
}

enum gz_result gz_text_lines_next(struct gz_text_lines *lines, char **out_line)
{
	static const char mark[] = "\xef\xbb\xbf";
	size_t length = 0;
	if (!lines->again) {
		enum gz_result result = gather_line(lines, &length);
		if (result == GZ_OK || result == GZ_ERR_FULL)
			lines->number++;
		if (result != GZ_OK)
			return result;
		if (length > 0 && lines->line[length - 1] == '\r')
			length--;
		lines->line[length] = '\0';
	}
	lines->again = false;
	*out_line = lines->line;
	if (lines->number == 1 && strncmp(lines->line, mark, sizeof mark - 1) == 0)
		*out_line += sizeof mark - 1;
	return GZ_OK;
}

void gz_text_lines_again(struct gz_text_lines *lines)
{
	lines->again = true;
}

uint64_t gz_text_lines_number(const struct gz_text_lines *lines)
{
	return lines->number;
}

void gz_text_lines_close(struct gz_text_lines **lines)
{
	if (!lines || !*lines)
		return;
	if ((*lines)->file)
		gzclose((*lines)->file);
	free(*lines);
	*lines = NULL;
}

static char *unquote(char *field)
{
	size_t length = strlen(field);
	if (length < 2 || field[0] != '"' || field[length - 1] != '"')
		return field;
	field[length - 1] = '\0';
	return field + 1;
}

static void split_at_blanks(char *line, struct gz_text_fields *fields)
{
	char *word;
	while (fields->count < GZ_TEXT_FIELDS_MAX &&
	       (word = gz_number_next_word(&line, " \t")) != NULL)
		fields->field[fields->count++] = word;
}

void gz_text_split(char *line, char separator, struct gz_text_fields *out_fields)
{
	out_fields->count = 0;
	if (separator == ' ') {
		split_at_blanks(line, out_fields);
		return;
	}
	while (line && out_fields->count < GZ_TEXT_FIELDS_MAX) {
		char *end = strchr(line, separator);
		if (end)
			*end++ = '\0';
		out_fields->field[out_fields->count++] = unquote(line);
		line = end;
	}
}

double gz_text_field_number(const struct gz_text_fields *fields, size_t index)
{
	char number[64];
	double value;
	if (index >= fields->count)
		return NAN;
	const char *field = fields->field[index];
	field += strspn(field, " ");
	size_t length = strcspn(field, " ");
	if (length == 0 || length >= sizeof number || field[length + strspn(field + length, " ")])
		return NAN;
	memcpy(number, field, length);
	number[length] = '\0';
	char *comma = strchr(number, ',');
	if (comma)
		*comma = '.';
	return gz_number_parse(number, &value) ? value : NAN;
}

bool gz_text_take_number(const char **text, double *out_value)
{
	char number[64];
	const char *at = *text + strspn(*text, " \t");
	size_t length = strcspn(at, " \t");
	if (length >= sizeof number)
		return false;
	memcpy(number, at, length);
	number[length] = '\0';
	if (!gz_number_parse(number, out_value))
		return false;
	*text = at + length + strspn(at + length, " \t");
	return true;
}

bool gz_text_begins(const char *text, const char *word)
{
	return strncasecmp(text, word, strlen(word)) == 0;
}

void gz_text_copy(char *to, size_t size, const char *text)
{
	const char *from = text;
	size_t used = 0, left = strlen(text);
	while (left > 0) {
		size_t length = gz_utf8_length(from, left);
		if (used + (length ? length : 1) >= size)
			break;
		if (length == 0)
			to[used++] = '?';
		for (size_t i = 0; i < length; i++)
			to[used++] = from[i];
		from += length ? length : 1;
		left -= length ? length : 1;
	}
	to[used] = '\0';
}
