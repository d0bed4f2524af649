#include <errno.h>
#include <ini.h>
#include <stdlib.h>
#include <string.h>

#include "base/option.h"
#include "base/option_internal.h"

#define GZ_LOG_MODULE "option"

/* Largest file read, bytes. Chosen: a thousand times what every option together needs. */
enum { MOST_BYTES = 1 << 20 };

/* Longest section name that inih keeps whole, bytes (its MAX_SECTION less the NUL). */
enum { MOST_SECTION = 49 };

/* One pass of inih over a text. inih asks next_line() for each line and calls take_value() for each
 * value before it asks for the next one, so that `line` is the line of the value. */
struct pass {
	struct gz_option_reader reader;
	const struct gz_log *log;
	const char *name;
	const char *rest, *end;
	int line;
	bool value_expected; /* the last line was neither blank, comment nor section */
	const char *wanted;  /* the key that is looked for, where nothing is read */
	int wanted_line;
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

static bool check_line(struct pass *pass, const char *line)
{
	const char *fault = NULL;
	pass->value_expected = false;
	if (*line == '[')
		fault = section_fault(line);
	else
		pass->value_expected = *line && *line != ';' && *line != '#';
	if (fault)
		refuse_line(pass, fault);
	return !fault;
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
	char key[512];
	char message[GZ_OPTION_MESSAGE_SIZE];
	int first = 0;
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
	snprintf(key, sizeof key, "%s.%s", section, name);
	if (pass->wanted) {
		if (strcmp(key, pass->wanted) == 0)
			pass->wanted_line = pass->line;
		return 1;
	}
	if (gz_option_reader_set(&pass->reader, key, value, pass->line, &first, message,
				 sizeof message) == GZ_OK)
		return 1;
	if (first)
		snprintf(message, sizeof message, "given twice, first in line %d; keep one", first);
	gz_err(pass->log, "%s:%d: %s: %s", pass->name, pass->line, key, message);
	pass->result = GZ_ERR_FORMAT;
	return 0;
}

enum gz_result gz_options_read_text(const struct gz_option_binding *bindings, size_t count,
				    const char *name, const char *text, size_t size,
				    const struct gz_log *log)
{
	struct pass pass = { .log = log, .name = name, .rest = text, .end = text + size };
	enum gz_result result = gz_option_reader_init(&pass.reader, bindings, count);
	if (result != GZ_OK)
		return result;
	int fault = size ? ini_parse_stream(next_line, &pass, take_value, &pass) : 0;
	if (fault < 0 && pass.result == GZ_OK)
		pass.result = GZ_ERR_NO_MEM;
	if (fault > 0 && pass.result == GZ_OK) {
		pass.line = fault;
		refuse_line(&pass, "not an INI line; write [section] or name = value");
	}
	gz_option_reader_free(&pass.reader);
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

enum gz_result gz_options_read_file(const struct gz_option_binding *bindings, size_t count,
				    const char *path, const struct gz_log *log)
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
		result = gz_options_read_text(bindings, count, path, text, size, log);
	free(text);
	return result;
}

int gz_options_file_line(const char *path, const char *key)
{
	char *text = NULL;
	size_t size = 0;
	FILE *file = fopen(path, "rb");
	if (!file)
		return 0;
	enum gz_result result = read_whole(file, path, NULL, &text, &size);
	fclose(file);
	if (result != GZ_OK)
		return 0;
	struct pass pass = { .name = path, .rest = text, .end = text + size, .wanted = key };
	if (size > 0)
		ini_parse_stream(next_line, &pass, take_value, &pass);
	free(text);
	return pass.wanted_line;
}
