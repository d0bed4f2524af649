#include "base/ini.h"

#include <errno.h>
#include <ini.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define GZ_LOG_MODULE "option"

/* Largest file read, bytes. Chosen: a thousand times what every option together needs. */
enum { MOST_BYTES = 1 << 20 };

/* Longest section name that inih keeps whole, bytes (its MAX_SECTION less the NUL). */
enum { MOST_SECTION = 49 };

/* One pass of inih over a text. inih asks next_line() for each line and calls take_value() for each
 * value before it asks for the next one, so that `line` is the line of the value. */
struct pass {
	gz_ini_take *take;
	void *user;
	const struct gz_log *log;
	const char *name;
	const char *rest, *end;
	int line;
	bool value_expected; /* the last line was neither blank, comment nor section */
	enum gz_result result;
};

static void refuse_line(struct pass *pass, const char *what)
{
	gz_err(pass->log, "%s:%d: %s", pass->name, pass->line, what);
	pass->result = GZ_ERR_FORMAT;
}

/* What is wrong with the text after '[', or NULL. inih would take the first two in silence. */
static const char *section_fault(const char *line)
{
	const char *close = strchr(line, ']');
	if (!close)
		return "section without ']'; write [name]";
	if (close - line - 1 > MOST_SECTION)
		return "section name is longer than 49 bytes; shorten it";
	const char *after = close + 1 + strspn(close + 1, " \t");
	if (*after && *after != ';' && *after != '#')
		return "text after ']'; put it on a line of its own";
	return NULL;
}

static void begin_section(struct pass *pass, const char *line)
{
	char section[MOST_SECTION + 1];
	size_t length = strcspn(line + 1, "]");
	memcpy(section, line + 1, length);
	section[length] = '\0';
	pass->result = pass->take(pass->user,
				  &(struct gz_ini_item) { .section = section, .line = pass->line });
}

static bool check_line(struct pass *pass, const char *line)
{
	pass->value_expected = false;
	if (*line == '[') {
		const char *fault = section_fault(line);
		if (fault)
			refuse_line(pass, fault);
		else
			begin_section(pass, line);
	} else {
		pass->value_expected = *line && *line != ';' && *line != '#';
	}
	return pass->result == GZ_OK;
}

static void skip_byte_order_mark(struct pass *pass)
{
	if (pass->end - pass->rest >= 3 && memcmp(pass->rest, "\xef\xbb\xbf", 3) == 0)
		pass->rest += 3;
}

/* The next line for inih, without the blanks around it: inih would take an indented line as more of
 * the value above. NULL at the end and after a refusal. */
static char *next_line(char *line, int size, void *user)
{
	struct pass *pass = user;
	if (pass->result == GZ_OK && pass->value_expected)
		refuse_line(pass, "no \"name = value\" here; write one, or begin a comment with ;");
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
		refuse_line(pass, "a zero byte; this is not a text file");
		return NULL;
	}
	if (length >= (size_t)size) {
		char what[80];
		snprintf(what, sizeof what, "%zu bytes in a line; at most %d are read", length,
			 size - 1);
		refuse_line(pass, what);
		return NULL;
	}
	memcpy(line, start, length);
	line[length] = '\0';
	return check_line(pass, line) ? line : NULL;
}

/* inih's callback for "name = value". */
static int take_value(void *user, const char *section, const char *name, const char *value)
{
	struct pass *pass = user;
	pass->value_expected = false;
	if (pass->result != GZ_OK)
		return 0;
	if (!section[0]) {
		refuse_line(pass, "a value before the first section; begin with [section]");
		return 0;
	}
	/* inih sees a comment behind a blank alone: "name =; text" would be a value. */
	if (value[0] == ';') {
		refuse_line(pass, "a value that begins with ';'; put a blank before a comment");
		return 0;
	}
	pass->result =
		pass->take(pass->user, &(struct gz_ini_item) { section, name, value, pass->line });
	return pass->result == GZ_OK;
}

enum gz_result gz_ini_read_text(const char *name, const char *text, size_t size, gz_ini_take *take,
				void *user, const struct gz_log *log)
{
	struct pass pass = {
		.take = take,
		.user = user,
		.log = log,
		.name = name,
		.rest = text,
		.end = text + size,
	};
	int fault = size ? ini_parse_stream(next_line, &pass, take_value, &pass) : 0;
	if (fault < 0 && pass.result == GZ_OK)
		pass.result = GZ_ERR_NO_MEM;
	if (fault > 0 && pass.result == GZ_OK) {
		pass.line = fault;
		refuse_line(&pass, "not an INI line; write [section] or name = value");
	}
	return pass.result;
}

static enum gz_result read_whole(FILE *file, const char *path, const struct gz_log *log,
				 char **out_text, size_t *out_size)
{
	char *text = malloc(MOST_BYTES + 1);
	if (!text)
		return GZ_ERR_NO_MEM;
	size_t size = fread(text, 1, MOST_BYTES + 1, file);
	if (ferror(file)) {
		gz_err(log, "%s: cannot be read: %s", path, strerror(errno));
		free(text);
		return GZ_ERR_IO;
	}
	if (size > MOST_BYTES) {
		gz_err(log, "%s: longer than %d bytes, so no settings file; check the path", path,
		       MOST_BYTES);
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
	enum gz_result result = read_whole(file, path, log, &text, &size);
	fclose(file);
	if (result == GZ_OK)
		result = gz_ini_read_text(path, text, size, take, user, log);
	free(text);
	return result;
}
