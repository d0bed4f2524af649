#include <string.h>

#include "base/option.h"
#include "base/option_internal.h"

#define GZ_LOG_MODULE "option"

/* Room for a key as typed. */
enum { KEY_SIZE = 128 };

static bool same_key(const char *known, const char *typed)
{
	for (; *known && *typed; known++, typed++) {
		char a = *known == '-' ? '_' : *known;
		char b = *typed == '-' ? '_' : *typed;
		if (a != b)
			return false;
	}
	return *known == *typed;
}

/* The option typed, with dashes and underscores alike, or NULL. */
static const struct gz_option *find_typed(const struct gz_option_reader *reader, const char *typed)
{
	for (size_t b = 0; b < reader->count; b++) {
		for (size_t i = 0; i < reader->bindings[b].count; i++) {
			const struct gz_option *option = &reader->bindings[b].options[i];
			if (same_key(option->key, typed))
				return option;
		}
	}
	return NULL;
}

static enum gz_result refuse_unknown(const struct gz_option_reader *reader, const char *typed,
				     const struct gz_log *log)
{
	const char *near = gz_options_nearest(reader->bindings, reader->count, typed);
	if (near)
		gz_err(log, "--%s: unknown option; did you mean --%s?", typed, near);
	else
		gz_err(log, "--%s: unknown option; --help lists them all", typed);
	return GZ_ERR_INVAL;
}

/* Read the option at argv[*at] and move *at to its last argument. */
static enum gz_result read_option(struct gz_option_reader *reader, int argc, char *const *argv,
				  int *at, const struct gz_log *log)
{
	char typed[KEY_SIZE];
	const char *argument = argv[*at] + 2;
	size_t length = strcspn(argument, "=");
	const char *value = argument[length] == '=' ? argument + length + 1 : NULL;
	if (length >= sizeof typed) {
		gz_err(log, "--%.40s…: unknown option; --help lists them all", argument);
		return GZ_ERR_INVAL;
	}
	memcpy(typed, argument, length);
	typed[length] = '\0';

	const struct gz_option *option = find_typed(reader, typed);
	if (!option)
		return refuse_unknown(reader, typed, log);
	int place = *at;
	if (!value && option->type == GZ_OPTION_BOOL)
		value = "true";
	if (!value && (*at + 1 >= argc || strncmp(argv[*at + 1], "--", 2) == 0)) {
		char allowed[GZ_OPTION_MESSAGE_SIZE];
		gz_option_allowed(option, allowed, sizeof allowed);
		gz_err(log, "--%s: needs a value: %s (%s)", typed, option->help, allowed);
		return GZ_ERR_INVAL;
	}
	if (!value)
		value = argv[++*at];

	char message[GZ_OPTION_MESSAGE_SIZE];
	int first = 0;
	if (gz_option_reader_set(reader, option->key, value, place, &first, message,
				 sizeof message) == GZ_OK)
		return GZ_OK;
	gz_err(log, "--%s: %s", typed, message);
	return GZ_ERR_INVAL;
}

static enum gz_result read_all(struct gz_option_reader *reader, int argc, char *const *argv,
			       const char **out_positional, int *out_count,
			       const struct gz_log *log)
{
	bool options_ended = false;
	*out_count = 0;
	for (int at = 1; at < argc; at++) {
		const char *argument = argv[at];
		if (!options_ended && strcmp(argument, "--") == 0) {
			options_ended = true;
		} else if (!options_ended && strncmp(argument, "--", 2) == 0) {
			enum gz_result result = read_option(reader, argc, argv, &at, log);
			if (result != GZ_OK)
				return result;
		} else if (!options_ended && argument[0] == '-' && argument[1]) {
			gz_err(log, "%s: options begin with two dashes; --help lists them all",
			       argument);
			return GZ_ERR_INVAL;
		} else if (!out_positional) {
			gz_err(log, "%s: not an option; --help lists what can be given", argument);
			return GZ_ERR_INVAL;
		} else {
			out_positional[(*out_count)++] = argument;
		}
	}
	return GZ_OK;
}

enum gz_result gz_options_read_arguments(const struct gz_option_binding *bindings, size_t count,
					 int argc, char *const *argv, const char **out_positional,
					 int *out_positional_count, const struct gz_log *log)
{
	struct gz_option_reader reader;
	int positional = 0;
	enum gz_result result = gz_option_reader_init(&reader, bindings, count);
	if (result != GZ_OK)
		return result;
	result = read_all(&reader, argc, argv, out_positional, &positional, log);
	gz_option_reader_free(&reader);
	if (result == GZ_OK && out_positional_count)
		*out_positional_count = positional;
	return result;
}
