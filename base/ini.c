#include "base/ini.h"

#include <errno.h>
#include <ini.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define GZ_LOG_MODULE "option"

/* Largest file that is read, bytes. Chosen: a thousand times what all options together need. */
enum { FILE_SIZE_MAX = 1 << 20 };

/* Longest section name that inih does not cut, bytes: its MAX_SECTION without the NUL. */
enum { SECTION_LENGTH_MAX = 49 };

/* A text while inih reads it. inih calls next_ini_line() for each line, and take_ini_value() for
 * the value on it before it asks for the next line. So `line` is the line of the value. */
struct ini_pass {
	gz_ini_take *take;
	void *user;
	const struct gz_log *log;
	const char *name;
	const char *rest, *end;
	int line;
	bool value_expected; /* the last line is not blank, a comment or a section */
	enum gz_result result;
};

static void refuse_ini_line(struct ini_pass *pass, const char *what)
{
	gz_err(pass->log, "%s:%d: %s", pass->name, pass->line, what);
	pass->result = GZ_ERR_FORMAT;
}

/* What is wrong with a section line, or NULL. inih itself accepts the first two faults silently. */
static const char *section_fault(const char *line)
{
	const char *close = strchr(line, ']');
	if (!close)
		return "section without ']'; write [name]";
	if (close - line - 1 > SECTION_LENGTH_MAX)
		return "section name is longer than 49 bytes; shorten it";
	const char *after = close + 1 + strspn(close + 1, " \t");
	if (*after && *after != ';' && *after != '#')
		return "text after ']'; put it on a line of its own";
	return NULL;
}

static void pass_section(struct ini_pass *pass, const char *line)
{
	char section[SECTION_LENGTH_MAX + 1];
	size_t length = strcspn(line + 1, "]");
	memcpy(section, line + 1, length);
	section[length] = '\0';
	pass->result = pass->take(pass->user,
				  &(struct gz_ini_item) { .section = section, .line = pass->line });
}

static bool check_line(struct ini_pass *pass, const char *line)
{
	pass->value_expected = false;
	if (*line == '[') {
		const char *fault = section_fault(line);
		if (fault)
			refuse_ini_line(pass, fault);
		else
			pass_section(pass, line);
	} else {
		pass->value_expected = *line && *line != ';' && *line != '#';
	}
	return pass->result == GZ_OK;
}

static void skip_byte_order_mark(struct ini_pass *pass)
{
	if (pass->end - pass->rest >= 3 && memcmp(pass->rest, "\xef\xbb\xbf", 3) == 0)
		pass->rest += 3;
}

/* The next line for inih, without the blanks around it: inih takes an indented line for a
 * continuation of the value above. NULL at the end and after a refusal. */
static char *next_ini_line(char *line, int size, void *user)
{
	struct ini_pass *pass = user;
	if (pass->result == GZ_OK && pass->value_expected)
		refuse_ini_line(pass, "expected \"name = value\"; a comment begins with ;");
	if (pass->result != GZ_OK || pass->rest == pass->end)
		return NULL;

	if (pass->line++ == 0)
		skip_byte_order_mark(pass);
	const char *start = pass->rest;
	const char *newline = memchr(start, '\n', (size_t)(pass->end - start));
	const char *stop = newline ? newline : pass->end;
	pass->rest = newline ? newline + 1 : pass->end;
	while (start < stop && (*start == ' ' || *start == '\t'))
		start++;
	while (stop > start && (stop[-1] == ' ' || stop[-1] == '\t' || stop[-1] == '\r'))
		stop--;

	size_t length = (size_t)(stop - start);
	if (memchr(start, '\0', length)) {
		refuse_ini_line(pass, "contains a zero byte; this is not a text file");
		return NULL;
	}
	if (length >= (size_t)size) {
		char what[80];
		snprintf(what, sizeof what, "the line has %zu bytes; at most %d are allowed",
			 length, size - 1);
		refuse_ini_line(pass, what);
		return NULL;
	}
	memcpy(line, start, length);
	line[length] = '\0';
	return check_line(pass, line) ? line : NULL;
}

/* Callback of inih for "name = value". */
static int take_ini_value(void *user, const char *section, const char *name, const char *value)
{
	struct ini_pass *pass = user;
	pass->value_expected = false;
	if (pass->result != GZ_OK)
		return 0;
	if (!section[0]) {
		refuse_ini_line(pass, "value before the first section; write [section] above it");
		return 0;
	}
	/* inih finds a comment only after a blank: it would read "name =; text" as a value. */
	if (value[0] == ';') {
		refuse_ini_line(pass,
				"a value cannot begin with ';'; put a blank before a comment");
		return 0;
	}
	pass->result =
		pass->take(pass->user, &(struct gz_ini_item) { section, name, value, pass->line });
	return pass->result == GZ_OK;
}

enum gz_result gz_ini_read_text(const char *name, const char *text, size_t size, gz_ini_take *take,
				void *user, const struct gz_log *log)
{
	if (size == 0)
		return GZ_OK;
	struct ini_pass pass = {
		.take = take,
		.user = user,
		.log = log,
		.name = name,
		.rest = text,
		.end = text + size,
	};
	int fault = ini_parse_stream(next_ini_line, &pass, take_ini_value, &pass);
	if (fault < 0 && pass.result == GZ_OK)
		pass.result = GZ_ERR_NO_MEM;
	if (fault > 0 && pass.result == GZ_OK) {
		pass.line = fault;
		refuse_ini_line(&pass, "not an INI line; write [section] or name = value");
	}
	return pass.result;
}

static enum gz_result read_ini_file(FILE *file, const char *path, const struct gz_log *log,
				    char **out_text, size_t *out_size)
{
	char *text = malloc(FILE_SIZE_MAX + 1);
	if (!text)
		return GZ_ERR_NO_MEM;
	size_t size = fread(text, 1, FILE_SIZE_MAX + 1, file);
	if (ferror(file)) {
		gz_err(log, "%s: cannot be read: %s", path, strerror(errno));
		free(text);
		return GZ_ERR_IO;
	}
	if (size > FILE_SIZE_MAX) {
		gz_err(log,
		       "%s: longer than %d bytes, too long for a settings file; check the path",
		       path, FILE_SIZE_MAX);
		free(text);
		return GZ_ERR_FORMAT;
	}
	*out_text = text;
	*out_size = size;
	return GZ_OK;
}

enum gz_result gz_ini_read_file(const char *path, gz_ini_take *take, void *user,
				const struct gz_log *log)
{
	FILE *file = fopen(path, "rb");
	if (!file && errno == ENOENT) {
		gz_err(log, "%s: no such file; check the path", path);
		return GZ_ERR_NOT_FOUND;
	}
	if (!file) {
		gz_err(log, "%s: cannot be opened: %s", path, strerror(errno));
		return GZ_ERR_IO;
	}
	char *text = NULL;
	size_t size = 0;
	enum gz_result result = read_ini_file(file, path, log, &text, &size);
	fclose(file);
	if (result == GZ_OK)
		result = gz_ini_read_text(path, text, size, take, user, log);
	free(text);
	return result;
}

static const char blanks[] = " \t\r";

/* A line of an INI text, without its line break, and its parts. */
struct ini_line {
	const char *start, *end;
	const char *name, *name_end; /* of the value or section; NULL if it is neither */
	const char *value;           /* after '=' and blanks; NULL if it gives no value */
	bool is_section, is_comment;
};

static const char *skip_ini_blanks(const char *at, const char *end)
{
	while (at < end && strchr(blanks, *at))
		at++;
	return at;
}

static const char *trim_blanks(const char *start, const char *end)
{
	while (end > start && strchr(blanks, end[-1]))
		end--;
	return end;
}

static struct ini_line parse_ini_line(const char *start, const char *text_end)
{
	const char *end = memchr(start, '\n', (size_t)(text_end - start));
	struct ini_line line = { .start = start, .end = end ? end : text_end };
	const char *first = skip_ini_blanks(start, line.end);
	line.is_comment = first < line.end && (*first == ';' || *first == '#');
	line.is_section = first < line.end && *first == '[';
	if (line.is_section) {
		const char *close = memchr(first, ']', (size_t)(line.end - first));
		line.name = first + 1;
		line.name_end = close ? close : line.end;
	} else if (!line.is_comment) {
		const char *sign = first;
		while (sign < line.end && *sign != '=' && *sign != ':')
			sign++;
		if (sign < line.end) {
			line.name = first;
			line.name_end = trim_blanks(first, sign);
			line.value = skip_ini_blanks(sign + 1, line.end);
		}
	}
	return line;
}

static bool is_called(const struct ini_line *line, const char *name)
{
	const size_t length = strlen(name);
	return line->name && (size_t)(line->name_end - line->name) == length &&
	       strncmp(line->name, name, length) == 0;
}

/* The end of a value: before the blanks and the ';' that begin a comment, or the line's last
 * blanks.
 */
static const char *end_of_value(const struct ini_line *line)
{
	const char *end = line->end;
	for (const char *at = line->value; at < line->end; at++)
		if (*at == ';' && at > line->start && strchr(blanks, at[-1])) {
			end = at;
			break;
		}
	return trim_blanks(line->value, end);
}

/* Where a key is set in a text. */
struct key_place {
	size_t from, to;    /* the bytes that a new value replaces */
	bool found;         /* the key is given */
	size_t line, next;  /* if found: beginning of its line, and of the next */
	bool section_found; /* if not found: whether the section exists; a new line goes to `from`
			     */
};

static struct key_place find_key_place(const struct gz_text *text, const char *section,
				       const char *name)
{
	struct key_place place = { .from = text->length, .to = text->length };
	const char *end = text->bytes ? text->bytes + text->length : NULL;
	bool inside = false;
	for (const char *at = text->bytes; at && at < end;) {
		const struct ini_line line = parse_ini_line(at, end);
		at = line.end < end ? line.end + 1 : end;
		if (line.is_section)
			inside = is_called(&line, section);
		if (!inside)
			continue;
		if (!line.is_section && is_called(&line, name)) {
			place.from = (size_t)(line.value - text->bytes);
			place.to = (size_t)(end_of_value(&line) - text->bytes);
			place.line = (size_t)(line.start - text->bytes);
			place.next = (size_t)(at - text->bytes);
			place.found = true;
			return place;
		}
		if (line.is_section || line.name) {
			place.from = place.to = (size_t)(at - text->bytes);
			place.section_found = true;
		}
	}
	return place;
}

void gz_ini_text_set(struct gz_text *text, const char *section, const char *name, const char *value)
{
	struct gz_text edited = { 0 };
	const struct key_place place = find_key_place(text, section, name);
	const char *bytes = text->bytes ? text->bytes : "";
	gz_text_add_bytes(&edited, bytes, place.from);
	if (place.found) {
		gz_text_add(&edited, "%s", value);
	} else {
		if (edited.length > 0 && edited.bytes[edited.length - 1] != '\n')
			gz_text_add(&edited, "\n");
		if (!place.section_found)
			gz_text_add(&edited, "[%s]\n", section);
		gz_text_add(&edited, "%s = %s\n", name, value);
	}
	gz_text_add_bytes(&edited, bytes + place.to, text->length - place.to);
	edited.failed |= text->failed;
	gz_text_free(text);
	*text = edited;
}

bool gz_ini_text_remove(struct gz_text *text, const char *section, const char *name)
{
	const struct key_place place = find_key_place(text, section, name);
	if (!place.found)
		return false;
	memmove(text->bytes + place.line, text->bytes + place.next, text->length - place.next + 1);
	text->length -= place.next - place.line;
	return true;
}

bool gz_ini_text_has(const struct gz_text *text, const char *section, const char *name)
{
	return find_key_place(text, section, name).found;
}
