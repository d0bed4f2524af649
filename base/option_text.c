/* Option tables as text: INI files and command lines are read into them, help and INI files are
 * printed from them. */
#include <stdlib.h>
#include <string.h>

#include "base/ini.h"
#include "base/option.h"

#define GZ_LOG_MODULE "option"

/* Size of a buffer for a key as typed. */
enum { TYPED_KEY_SIZE = 128 };

/* One pass over a file or a command line, which refuses a key that is given twice. */
struct option_reader {
	const struct gz_option_binding *bindings;
	size_t count;
	const struct gz_log *log;
	int *first_place; /* per option over all bindings: line or argument that gave it; 0: none */
	int given_at; /* if the last key was refused as given twice, its first place; otherwise 0 */
	char message[GZ_OPTION_MESSAGE_SIZE]; /* why the last key or value was refused */
};

static enum gz_result option_reader_init(struct option_reader *reader,
					 const struct gz_option_binding *bindings, size_t count,
					 const struct gz_log *log)
{
	size_t options = 0;
	for (size_t b = 0; b < count; b++)
		options += bindings[b].count;
	int *places = calloc(options + 1, sizeof *places);
	if (!places)
		return GZ_ERR_NO_MEM;
	*reader = (struct option_reader) {
		.bindings = bindings,
		.count = count,
		.log = log,
		.first_place = places,
	};
	return GZ_OK;
}

/* Set @p key to @p text. @p place is the line or argument number, from 1. On failure the reader's
 * message says what is wrong and what is allowed. */
static bool set_read_option(struct option_reader *reader, const char *key, const char *text,
			    int place)
{
	size_t b = 0;
	const struct gz_option *option = gz_options_find(reader->bindings, reader->count, key, &b);
	reader->given_at = 0;
	if (!option) {
		const char *near = gz_options_nearest(reader->bindings, reader->count, key);
		if (near)
			snprintf(reader->message, sizeof reader->message,
				 "unknown key; did you mean %s?", near);
		else
			snprintf(reader->message, sizeof reader->message,
				 "unknown key; --help lists all keys");
		return false;
	}

	size_t index = (size_t)(option - reader->bindings[b].options);
	int *first = &reader->first_place[index];
	for (size_t before = 0; before < b; before++)
		first += reader->bindings[before].count;
	if (*first) {
		reader->given_at = *first;
		snprintf(reader->message, sizeof reader->message,
			 "given twice; keep one of the two");
		return false;
	}

	if (gz_option_parse(option, text, reader->bindings[b].target, reader->message,
			    sizeof reader->message) != GZ_OK)
		return false;
	*first = place;
	if (reader->bindings[b].given)
		reader->bindings[b].given[index] = true;
	return true;
}

/* An INI file that is read into options. */
struct option_file {
	struct option_reader reader;
	const char *name; /* in messages */
};

static enum gz_result set_option_from_item(void *user, const struct gz_ini_item *item)
{
	struct option_file *file = user;
	struct option_reader *reader = &file->reader;
	char key[512];
	if (!item->name)
		return GZ_OK;
	snprintf(key, sizeof key, "%s.%s", item->section, item->name);
	if (set_read_option(reader, key, item->value, item->line))
		return GZ_OK;
	if (reader->given_at)
		snprintf(reader->message, sizeof reader->message,
			 "given twice, first in line %d; keep one", reader->given_at);
	gz_err(reader->log, "%s:%d: %s: %s", file->name, item->line, key, reader->message);
	return GZ_ERR_FORMAT;
}

enum gz_result gz_options_read_text(const struct gz_option_binding *bindings, size_t count,
				    const char *name, const char *text, size_t size,
				    const struct gz_log *log)
{
	struct option_file file = { .name = name };
	enum gz_result result = option_reader_init(&file.reader, bindings, count, log);
	if (result != GZ_OK)
		return result;
	result = gz_ini_read_text(name, text, size, set_option_from_item, &file, log);
	free(file.reader.first_place);
	return result;
}

enum gz_result gz_options_read_file(const struct gz_option_binding *bindings, size_t count,
				    const char *path, const struct gz_log *log)
{
	struct option_file file = { .name = path };
	enum gz_result result = option_reader_init(&file.reader, bindings, count, log);
	if (result != GZ_OK)
		return result;
	result = gz_ini_read_file(path, set_option_from_item, &file, log);
	free(file.reader.first_place);
	return result;
}

/* A search for the line that gives a key. */
struct line_search {
	const char *key;
	int line; /* the last one that gives it; 0: none */
};

static enum gz_result compare_item(void *user, const struct gz_ini_item *item)
{
	struct line_search *search = user;
	size_t section = strlen(item->section);
	if (item->name && strncmp(search->key, item->section, section) == 0 &&
	    search->key[section] == '.' && strcmp(search->key + section + 1, item->name) == 0)
		search->line = item->line;
	return GZ_OK;
}

int gz_options_file_line(const char *path, const char *key)
{
	struct line_search search = { .key = key };
	gz_ini_read_file(path, compare_item, &search, NULL);
	return search.line;
}

/* Whether two keys are equal if dashes and underscores are. */
static bool is_same_option_key(const char *known, const char *typed)
{
	for (; *known && *typed; known++, typed++) {
		char a = *known == '-' ? '_' : *known;
		char b = *typed == '-' ? '_' : *typed;
		if (a != b)
			return false;
	}
	return *known == *typed;
}

static const struct gz_option *find_typed_option(const struct option_reader *reader,
						 const char *typed)
{
	for (size_t b = 0; b < reader->count; b++) {
		for (size_t i = 0; i < reader->bindings[b].count; i++) {
			const struct gz_option *option = &reader->bindings[b].options[i];
			if (is_same_option_key(option->key, typed))
				return option;
		}
	}
	return NULL;
}

static enum gz_result refuse_unknown_argument(const struct option_reader *reader, const char *typed)
{
	const char *near = gz_options_nearest(reader->bindings, reader->count, typed);
	if (near)
		gz_err(reader->log, "--%s: unknown option; did you mean --%s?", typed, near);
	else
		gz_err(reader->log, "--%s: unknown option; --help lists all options", typed);
	return GZ_ERR_INVAL;
}

/* Read the option at argv[*at] and move *at to its last argument. */
static enum gz_result read_option_argument(struct option_reader *reader, int argc,
					   char *const *argv, int *at)
{
	char typed[TYPED_KEY_SIZE];
	const char *argument = argv[*at] + 2;
	size_t length = strcspn(argument, "=");
	const char *value = argument[length] == '=' ? argument + length + 1 : NULL;
	if (length >= sizeof typed) {
		gz_err(reader->log, "--%.40s…: unknown option; --help lists all options", argument);
		return GZ_ERR_INVAL;
	}
	memcpy(typed, argument, length);
	typed[length] = '\0';

	const struct gz_option *option = find_typed_option(reader, typed);
	if (!option)
		return refuse_unknown_argument(reader, typed);
	int place = *at;
	if (!value && option->type == GZ_OPTION_BOOL)
		value = "true";
	if (!value && (*at + 1 >= argc || strncmp(argv[*at + 1], "--", 2) == 0)) {
		char allowed[GZ_OPTION_MESSAGE_SIZE];
		gz_option_allowed(option, allowed, sizeof allowed);
		gz_err(reader->log, "--%s: needs a value: %s (%s)", typed, option->help, allowed);
		return GZ_ERR_INVAL;
	}
	if (!value)
		value = argv[++*at];
	if (set_read_option(reader, option->key, value, place))
		return GZ_OK;
	gz_err(reader->log, "--%s: %s", typed, reader->message);
	return GZ_ERR_INVAL;
}

/* Take "-h" for "--help", where there is such a switch. @return false: it is none */
static bool read_help_letter(struct option_reader *reader, const char *argument, int at)
{
	const struct gz_option *option =
		strcmp(argument, "-h") == 0 ? find_typed_option(reader, "help") : NULL;
	return option && set_read_option(reader, option->key, "true", at);
}

static enum gz_result read_all_arguments(struct option_reader *reader, int argc, char *const *argv,
					 struct gz_operands *operands)
{
	bool options_ended = false;
	for (int at = 1; at < argc; at++) {
		const char *argument = argv[at];
		if (!options_ended && strcmp(argument, "--") == 0) {
			options_ended = true;
		} else if (!options_ended && strncmp(argument, "--", 2) == 0) {
			enum gz_result result = read_option_argument(reader, argc, argv, &at);
			if (result != GZ_OK)
				return result;
		} else if (!options_ended && argument[0] == '-' && argument[1]) {
			if (read_help_letter(reader, argument, at))
				continue;
			gz_err(reader->log,
			       "%s: options begin with two dashes; --help lists all options",
			       argument);
			return GZ_ERR_INVAL;
		} else if (!operands) {
			gz_err(reader->log, "%s: unexpected argument; --help lists all options",
			       argument);
			return GZ_ERR_INVAL;
		} else if (operands->count == GZ_OPERANDS_MAX) {
			gz_err(reader->log, "%s: more than %d arguments; give fewer", argument,
			       GZ_OPERANDS_MAX);
			return GZ_ERR_INVAL;
		} else {
			operands->items[operands->count++] = argument;
		}
	}
	return GZ_OK;
}

enum gz_result gz_options_read_arguments(const struct gz_option_binding *bindings, size_t count,
					 int argc, char *const *argv,
					 struct gz_operands *out_operands, const struct gz_log *log)
{
	struct option_reader reader;
	struct gz_operands operands = { .count = 0 };
	enum gz_result result = option_reader_init(&reader, bindings, count, log);
	if (result != GZ_OK)
		return result;
	result = read_all_arguments(&reader, argc, argv, out_operands ? &operands : NULL);
	free(reader.first_place);
	if (result == GZ_OK && out_operands)
		*out_operands = operands;
	return result;
}

/* Widest first column of --help; the text of longer entries moves to the right. Chosen: half of an
 * 80-column terminal. */
enum { WIDEST_ENTRY = 40 };

static const char *value_name(const struct gz_option *option)
{
	switch (option->type) {
	case GZ_OPTION_BOOL:
		return "";
	case GZ_OPTION_INT:
	case GZ_OPTION_DOUBLE:
		return gz_option_count(option) > 1 ? " 'N N …'" : " N";
	case GZ_OPTION_STRING:
		return " TEXT";
	case GZ_OPTION_CHOICE:
		return " NAME";
	case GZ_OPTION_SIZE:
		return " WxH";
	}
	return "";
}

/* Columns of a UTF-8 text: its bytes without the continuation bytes. */
static int utf8_columns(const char *text)
{
	int n = 0;
	for (; *text; text++)
		n += ((unsigned char)*text & 0xC0) != 0x80;
	return n;
}

static void describe_entry(const struct gz_option *option, char *text, size_t size)
{
	snprintf(text, size, "--%s%s", option->key, value_name(option));
}

static int widest_entry(const struct gz_option_binding *bindings, size_t count)
{
	int widest = 0;
	for (size_t b = 0; b < count; b++) {
		for (size_t i = 0; i < bindings[b].count; i++) {
			char entry[GZ_OPTION_MESSAGE_SIZE];
			describe_entry(&bindings[b].options[i], entry, sizeof entry);
			int width = utf8_columns(entry);
			if (width > widest && width <= WIDEST_ENTRY)
				widest = width;
		}
	}
	return widest;
}

/* " (0.1 to 100; default 1.0)", or the part of it that applies. */
static void describe_limits(const struct gz_option *option, char *text, size_t size)
{
	char allowed[GZ_OPTION_MESSAGE_SIZE] = "";
	bool has_preset = option->preset && option->preset[0];
	if (option->type != GZ_OPTION_BOOL && option->type != GZ_OPTION_STRING)
		gz_option_allowed(option, allowed, sizeof allowed);
	bool says_default = has_preset && !(option->type == GZ_OPTION_BOOL &&
					    strcmp(option->preset, "false") == 0);
	text[0] = '\0';
	if (allowed[0] && says_default)
		snprintf(text, size, " (%s; default %s)", allowed, option->preset);
	else if (allowed[0])
		snprintf(text, size, " (%s)", allowed);
	else if (says_default)
		snprintf(text, size, " (default %s)", option->preset);
}

/* As describe_limits(), but a switch tells how it is set: alone, or after '='. */
static void describe_use(const struct gz_option *option, char *text, size_t size)
{
	const char *preset = option->preset ? option->preset : "";
	if (option->type != GZ_OPTION_BOOL)
		describe_limits(option, text, size);
	else if (strcmp(preset, "true") == 0 || strcmp(preset, "yes") == 0)
		snprintf(text, size, " (default yes; --%s=no switches it off)", option->key);
	else
		text[0] = '\0';
}

void gz_options_print_help(const struct gz_option_binding *bindings, size_t count, FILE *out)
{
	int width = widest_entry(bindings, count);
	for (size_t b = 0; b < count; b++) {
		for (size_t i = 0; i < bindings[b].count; i++) {
			const struct gz_option *option = &bindings[b].options[i];
			char entry[GZ_OPTION_MESSAGE_SIZE];
			char limits[2 * GZ_OPTION_MESSAGE_SIZE];
			describe_entry(option, entry, sizeof entry);
			describe_use(option, limits, sizeof limits);
			int pad = width - utf8_columns(entry);
			fprintf(out, "  %s%*s  %s%s\n", entry, pad > 0 ? pad : 0, "", option->help,
				limits);
		}
	}
}

/* Whether an INI file can hold the value: inih removes the blanks around it and all after " ;". */
static bool fits_ini_file(const char *value)
{
	size_t length = strlen(value);
	if (length == 0)
		return true;
	if (strchr(" \t", value[0]) || strchr(" \t", value[length - 1]) || value[0] == ';')
		return false;
	return !strstr(value, " ;") && !strstr(value, "\t;") && !strpbrk(value, "\r\n");
}

/* Print the option's section if it is not the one printed last. @return false if it has none */
static bool print_option_section(const struct gz_option *option, const char **section,
				 size_t *section_length, FILE *out)
{
	const char *dot = strrchr(option->key, '.');
	if (!dot)
		return false;
	size_t length = (size_t)(dot - option->key);
	if (!*section || length != *section_length || strncmp(*section, option->key, length) != 0)
		fprintf(out, "%s[%.*s]\n", *section ? "\n" : "", (int)length, option->key);
	*section = option->key;
	*section_length = length;
	return true;
}

static void print_option_value(const struct gz_option *option, const void *target, FILE *out)
{
	char value[GZ_OPTION_TEXT_SIZE];
	char limits[2 * GZ_OPTION_MESSAGE_SIZE];
	const char *name = strrchr(option->key, '.') + 1;
	describe_limits(option, limits, sizeof limits);
	fprintf(out, "; %s%s\n", option->help, limits);
	if (gz_option_format(option, target, value, sizeof value) != GZ_OK || !fits_ini_file(value))
		fprintf(out, "; this value cannot be written in a file\n; %s =\n", name);
	else
		fprintf(out, "%s =%s%s\n", name, value[0] ? " " : "", value);
}

void gz_options_print_file(const struct gz_option_binding *bindings, size_t count, FILE *out)
{
	const char *section = NULL;
	size_t section_length = 0;
	for (size_t b = 0; b < count; b++) {
		for (size_t i = 0; i < bindings[b].count; i++) {
			const struct gz_option *option = &bindings[b].options[i];
			if (print_option_section(option, &section, &section_length, out))
				print_option_value(option, bindings[b].target, out);
		}
	}
}
