#include <string.h>

#include "base/option.h"
#include "base/option_internal.h"

/* Widest first column of --help; longer entries push their text to the right. Chosen: half of an
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

/* Columns that a UTF-8 text takes: its bytes less the continuation bytes. */
static int columns(const char *text)
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
			int width = columns(entry);
			if (width > widest && width <= WIDEST_ENTRY)
				widest = width;
		}
	}
	return widest;
}

/* " (0.1 to 100; default 1.0)", or less where there is less to say. */
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

void gz_options_print_help(const struct gz_option_binding *bindings, size_t count, FILE *out)
{
	int width = widest_entry(bindings, count);
	for (size_t b = 0; b < count; b++) {
		for (size_t i = 0; i < bindings[b].count; i++) {
			const struct gz_option *option = &bindings[b].options[i];
			char entry[GZ_OPTION_MESSAGE_SIZE];
			char limits[2 * GZ_OPTION_MESSAGE_SIZE];
			describe_entry(option, entry, sizeof entry);
			describe_limits(option, limits, sizeof limits);
			int pad = width - columns(entry);
			fprintf(out, "  %s%*s  %s%s\n", entry, pad > 0 ? pad : 0, "", option->help,
				limits);
		}
	}
}

/* Whether a file can hold the value: inih removes blanks around it and what follows " ;". */
static bool fits_file(const char *value)
{
	size_t length = strlen(value);
	if (length == 0)
		return true;
	if (strchr(" \t", value[0]) || strchr(" \t", value[length - 1]) || value[0] == ';')
		return false;
	return !strstr(value, " ;") && !strstr(value, "\t;") && !strpbrk(value, "\r\n");
}

/* Begin a section where @p option's is not the one written last; whether the option has one. */
static bool print_section(const struct gz_option *option, const char **section,
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

static void print_value(const struct gz_option *option, const void *target, FILE *out)
{
	char value[GZ_OPTION_TEXT_SIZE];
	char limits[2 * GZ_OPTION_MESSAGE_SIZE];
	const char *name = strrchr(option->key, '.') + 1;
	describe_limits(option, limits, sizeof limits);
	fprintf(out, "; %s%s\n", option->help, limits);
	if (gz_option_format(option, target, value, sizeof value) != GZ_OK || !fits_file(value))
		fprintf(out, "; the present value cannot stand in a file\n; %s =\n", name);
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
			if (print_section(option, &section, &section_length, out))
				print_value(option, bindings[b].target, out);
		}
	}
}
