#include "base/option.h"

#include <errno.h>
#include <limits.h>
#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include "base/text.h"

static const char blanks[] = " \t";

int gz_option_count(const struct gz_option *option)
{
	if (option->type == GZ_OPTION_SIZE)
		return 2;
	return option->count > 0 ? option->count : 1;
}

__attribute__((format(printf, 3, 4))) static enum gz_result refuse_option(char *message,
									  size_t message_size,
									  const char *format, ...)
{
	if (message && message_size > 0) {
		va_list arguments;
		va_start(arguments, format);
		vsnprintf(message, message_size, format, arguments);
		va_end(arguments);
	}
	return GZ_ERR_INVAL;
}

static void describe_choices(const struct gz_option *option, char *text, size_t size)
{
	size_t used = 0;
	text[0] = '\0';
	for (int i = 0; option->choices[i] && used < size; i++) {
		const char *join = i == 0 ? "" : option->choices[i + 1] ? ", " : " or ";
		int n = snprintf(text + used, size - used, "%s%s", join, option->choices[i]);
		used += n > 0 ? (size_t)n : 0;
	}
}

static void describe_range(const struct gz_option *option, char *text, size_t size)
{
	const char *each = option->type == GZ_OPTION_SIZE ? " for each side" : "";
	bool below = option->min > -HUGE_VAL && option->min > -1e300;
	bool above = option->max < HUGE_VAL && option->max < 1e300;
	if (below && above)
		snprintf(text, size, "%.10g to %.10g%s", option->min, option->max, each);
	else if (below)
		snprintf(text, size, "at least %.10g%s", option->min, each);
	else if (above)
		snprintf(text, size, "at most %.10g%s", option->max, each);
	else
		snprintf(text, size, "any number");
}

void gz_option_allowed(const struct gz_option *option, char *text, size_t size)
{
	switch (option->type) {
	case GZ_OPTION_BOOL:
		snprintf(text, size, "true or false");
		return;
	case GZ_OPTION_STRING:
		snprintf(text, size, "at most %.0f bytes", option->max - 1);
		return;
	case GZ_OPTION_CHOICE:
		describe_choices(option, text, size);
		return;
	case GZ_OPTION_INT:
	case GZ_OPTION_DOUBLE:
	case GZ_OPTION_SIZE:
		describe_range(option, text, size);
		return;
	}
	text[0] = '\0';
}

static enum gz_result refuse_out_of_range(const struct gz_option *option, const char *word,
					  char *message, size_t message_size)
{
	char allowed[GZ_OPTION_MESSAGE_SIZE];
	gz_option_allowed(option, allowed, sizeof allowed);
	bool interval = strstr(allowed, " to ") != NULL;
	return refuse_option(message, message_size,
			     interval ? "%s is outside %s" : "%s is refused; allowed: %s", word,
			     allowed);
}

static enum gz_result refuse_option_value(const struct gz_option *option, const char *value,
					  const char *what, char *message, size_t message_size)
{
	char allowed[GZ_OPTION_MESSAGE_SIZE];
	gz_option_allowed(option, allowed, sizeof allowed);
	return refuse_option(message, message_size, "%.80s %s %s",
			     value[0] ? value : "an empty value", what, allowed);
}

/* Move *text past leading blanks. @return the length of the word there; 0 at the end */
static size_t find_word(const char **text)
{
	*text += strspn(*text, blanks);
	return strcspn(*text, blanks);
}

static bool parse_whole_word(const char *word, long *out_value)
{
	char *end;
	/* strtol() also accepts "+" and leading blanks; the caller has removed the blanks. */
	if (word[strspn(word, "+-0123456789")] != '\0')
		return false;
	errno = 0;
	long value = strtol(word, &end, 10);
	if (end == word || *end)
		return false;
	*out_value = value; /* on overflow LONG_MIN or LONG_MAX, which no option's range holds */
	return true;
}

/* False for NaN. */
static bool in_range(const struct gz_option *option, double value)
{
	return value >= option->min && value <= option->max;
}

/* Parse one number of an INT, DOUBLE or SIZE and check its range. */
static enum gz_result parse_option_number(const struct gz_option *option, const char *word,
					  double *out_value, char *message, size_t message_size)
{
	long whole = 0;
	bool is_double = option->type == GZ_OPTION_DOUBLE;
	if (is_double ? !gz_number_parse(word, out_value) : !parse_whole_word(word, &whole))
		return refuse_option_value(option, word,
					   is_double ? "is not a number; allowed:"
						     : "is not a whole number; allowed:",
					   message, message_size);
	if (!is_double) {
		if (whole < INT_MIN || whole > INT_MAX)
			return refuse_out_of_range(option, word, message, message_size);
		*out_value = (double)whole;
	}
	if (!in_range(option, *out_value))
		return refuse_out_of_range(option, word, message, message_size);
	return GZ_OK;
}

static void store_numbers(const struct gz_option *option, const double *values, void *field)
{
	int count = gz_option_count(option);
	if (option->type == GZ_OPTION_DOUBLE) {
		memcpy(field, values, (size_t)count * sizeof *values);
		return;
	}
	for (int i = 0; i < count; i++)
		((int *)field)[i] = (int)values[i];
}

static enum gz_result parse_option_numbers(const struct gz_option *option, const char *text,
					   void *field, char *message, size_t message_size)
{
	double values[GZ_OPTION_NUMBERS_MAX] = { 0 };
	int wanted = gz_option_count(option);
	if (wanted > GZ_OPTION_NUMBERS_MAX)
		return refuse_option(message, message_size, "an option holds at most %d numbers",
				     GZ_OPTION_NUMBERS_MAX);
	const char *rest = text;
	for (int i = 0; i < wanted; i++) {
		char word[64];
		size_t length = find_word(&rest);
		if (length == 0)
			return refuse_option(message, message_size,
					     "%d number%s expected, %d given%s", wanted,
					     wanted > 1 ? "s" : "", i,
					     wanted > 1 ? "; separate them by blanks" : "");
		snprintf(word, sizeof word, "%.*s", (int)(length < 63 ? length : 63), rest);
		if (length >= sizeof word)
			return refuse_option_value(option, word,
						   "… is too long for a number; allowed:", message,
						   message_size);
		enum gz_result result =
			parse_option_number(option, word, &values[i], message, message_size);
		if (result != GZ_OK)
			return result;
		rest += length;
	}
	if (find_word(&rest) > 0)
		return refuse_option(message, message_size,
				     "unexpected \"%.80s\" after %d number%s", rest, wanted,
				     wanted > 1 ? "s" : "");
	store_numbers(option, values, field);
	return GZ_OK;
}

static enum gz_result parse_option_size(const struct gz_option *option, const char *text,
					void *field, char *message, size_t message_size)
{
	double values[2] = { 0 };
	const char *cross = strchr(text, 'x');
	if (!cross || cross == text || !cross[1] || strlen(text) > 32)
		return refuse_option(message, message_size,
				     "%.80s is not a size; write WIDTHxHEIGHT, as in 1920x1080",
				     text[0] ? text : "an empty value");
	char width[33];
	snprintf(width, sizeof width, "%.*s", (int)(cross - text), text);
	enum gz_result result =
		parse_option_number(option, width, &values[0], message, message_size);
	if (result == GZ_OK)
		result = parse_option_number(option, cross + 1, &values[1], message, message_size);
	if (result == GZ_OK)
		store_numbers(option, values, field);
	return result;
}

static enum gz_result parse_option_bool(const struct gz_option *option, const char *text,
					void *field, char *message, size_t message_size)
{
	static const char *const words[] = { "false", "no", "off", "0", "true", "yes", "on", "1" };
	for (size_t i = 0; i < sizeof words / sizeof *words; i++) {
		if (strcmp(words[i], text) == 0) {
			*(bool *)field = i >= 4;
			return GZ_OK;
		}
	}
	return refuse_option_value(option, text, "is not", message, message_size);
}

static enum gz_result parse_option_choice(const struct gz_option *option, const char *text,
					  void *field, char *message, size_t message_size)
{
	for (int i = 0; option->choices[i]; i++) {
		if (strcmp(option->choices[i], text) == 0) {
			*(int *)field = i;
			return GZ_OK;
		}
	}
	return refuse_option_value(option, text, "is not", message, message_size);
}

static enum gz_result parse_option_string(const struct gz_option *option, const char *text,
					  void *field, char *message, size_t message_size)
{
	size_t size = (size_t)option->max;
	size_t length = strlen(text);
	if (length >= size)
		return refuse_option(message, message_size,
				     "too long: %zu bytes, at most %zu are allowed", length,
				     size - 1);
	if (strpbrk(text, "\r\n"))
		return refuse_option(message, message_size,
				     "the value contains a line break; remove it");
	memset(field, 0, size); /* equal settings are equal bytes */
	memcpy(field, text, length);
	return GZ_OK;
}

enum gz_result gz_option_parse(const struct gz_option *option, const char *text, void *target,
			       char *message, size_t message_size)
{
	void *field = (char *)target + option->offset;
	switch (option->type) {
	case GZ_OPTION_BOOL:
		return parse_option_bool(option, text, field, message, message_size);
	case GZ_OPTION_INT:
	case GZ_OPTION_DOUBLE:
		return parse_option_numbers(option, text, field, message, message_size);
	case GZ_OPTION_STRING:
		return parse_option_string(option, text, field, message, message_size);
	case GZ_OPTION_CHOICE:
		return parse_option_choice(option, text, field, message, message_size);
	case GZ_OPTION_SIZE:
		return parse_option_size(option, text, field, message, message_size);
	}
	return refuse_option(message, message_size, "an option of unknown type");
}

static void format_double(double value, char text[GZ_NUMBER_SIZE])
{
	if (isfinite(value))
		gz_number_print(value, text);
	else
		snprintf(text, GZ_NUMBER_SIZE, "%g", value);
}

static void format_numbers(const struct gz_option *option, const void *field, char *text,
			   size_t size)
{
	const char *join = option->type == GZ_OPTION_SIZE ? "x" : " ";
	size_t used = 0;
	for (int i = 0; i < gz_option_count(option) && used < size; i++) {
		char number[64];
		if (option->type == GZ_OPTION_DOUBLE)
			format_double(((const double *)field)[i], number);
		else
			snprintf(number, sizeof number, "%d", ((const int *)field)[i]);
		int n = snprintf(text + used, size - used, "%s%s", i == 0 ? "" : join, number);
		used += n > 0 ? (size_t)n : 0;
	}
}

enum gz_result gz_option_format(const struct gz_option *option, const void *target, char *text,
				size_t size)
{
	const void *field = (const char *)target + option->offset;
	char whole[GZ_OPTION_TEXT_SIZE] = "";
	switch (option->type) {
	case GZ_OPTION_BOOL:
		snprintf(whole, sizeof whole, "%s", *(const bool *)field ? "true" : "false");
		break;
	case GZ_OPTION_INT:
	case GZ_OPTION_DOUBLE:
	case GZ_OPTION_SIZE:
		format_numbers(option, field, whole, sizeof whole);
		break;
	case GZ_OPTION_STRING:
		snprintf(whole, sizeof whole, "%s", (const char *)field);
		break;
	case GZ_OPTION_CHOICE:
		snprintf(whole, sizeof whole, "%s", option->choices[*(const int *)field]);
		break;
	}
	if (size > 0)
		text[0] = '\0';
	if (strlen(whole) >= size)
		return GZ_ERR_FULL;
	memcpy(text, whole, strlen(whole) + 1);
	return GZ_OK;
}

static bool numbers_hold(const struct gz_option *option, const void *field)
{
	for (int i = 0; i < gz_option_count(option); i++) {
		const double value = option->type == GZ_OPTION_DOUBLE ? ((const double *)field)[i]
								      : ((const int *)field)[i];
		if (!in_range(option, value))
			return false;
	}
	return true;
}

static bool choice_holds(const struct gz_option *option, int index)
{
	for (int i = 0; option->choices[i]; i++)
		if (i == index)
			return true;
	return false;
}

bool gz_option_holds(const struct gz_option *option, const void *target)
{
	const void *field = (const char *)target + option->offset;
	switch (option->type) {
	case GZ_OPTION_BOOL:
		return true;
	case GZ_OPTION_STRING:
		return memchr(field, '\0', (size_t)option->max) != NULL;
	case GZ_OPTION_CHOICE:
		return choice_holds(option, *(const int *)field);
	case GZ_OPTION_INT:
	case GZ_OPTION_DOUBLE:
	case GZ_OPTION_SIZE:
		return numbers_hold(option, field);
	}
	return false;
}

bool gz_options_hold(const struct gz_option *options, size_t count, const void *target)
{
	for (size_t i = 0; i < count; i++)
		if (!gz_option_holds(&options[i], target))
			return false;
	return true;
}

static bool numbers_are_same(const double *a, const double *b, int count)
{
	for (int i = 0; i < count; i++)
		if (a[i] != b[i] && !(isnan(a[i]) && isnan(b[i])))
			return false;
	return true;
}

bool gz_option_same(const struct gz_option *option, const void *a, const void *b)
{
	const void *field_a = (const char *)a + option->offset;
	const void *field_b = (const char *)b + option->offset;
	const int count = gz_option_count(option);
	switch (option->type) {
	case GZ_OPTION_BOOL:
		return *(const bool *)field_a == *(const bool *)field_b;
	case GZ_OPTION_STRING:
		return strncmp(field_a, field_b, (size_t)option->max) == 0;
	case GZ_OPTION_CHOICE:
	case GZ_OPTION_INT:
	case GZ_OPTION_SIZE:
		return memcmp(field_a, field_b, (size_t)count * sizeof(int)) == 0;
	case GZ_OPTION_DOUBLE:
		return numbers_are_same(field_a, field_b, count);
	}
	return false;
}

bool gz_options_same(const struct gz_option *options, size_t count, const void *a, const void *b)
{
	for (size_t i = 0; i < count; i++)
		if (!gz_option_same(&options[i], a, b))
			return false;
	return true;
}

enum gz_result gz_options_preset(const struct gz_option_binding *binding)
{
	enum gz_result result = GZ_OK;
	for (size_t i = 0; i < binding->count; i++) {
		const struct gz_option *option = &binding->options[i];
		if (!option->preset)
			continue;
		enum gz_result parsed =
			gz_option_parse(option, option->preset, binding->target, NULL, 0);
		if (parsed != GZ_OK)
			result = parsed;
	}
	return result;
}

const struct gz_option *gz_options_find(const struct gz_option_binding *bindings, size_t count,
					const char *key, size_t *out_binding)
{
	for (size_t b = 0; b < count; b++) {
		for (size_t i = 0; i < bindings[b].count; i++) {
			if (strcmp(bindings[b].options[i].key, key) != 0)
				continue;
			if (out_binding)
				*out_binding = b;
			return &bindings[b].options[i];
		}
	}
	return NULL;
}

/* Longest key compared by edit distance, with its NUL. Chosen: longer than the keys of any table.
 */
enum { NEAR_KEY_SIZE = 64 };

/* Levenshtein distance, computed row by row: Wagner and Fischer, "The String-to-String Correction
 * Problem", J. ACM 21(1), 1974, algorithm X. */
static size_t edit_distance(const char *a, const char *b)
{
	size_t row[NEAR_KEY_SIZE];
	size_t width = strlen(b);
	for (size_t j = 0; j <= width; j++)
		row[j] = j;
	for (size_t i = 0; a[i]; i++) {
		size_t diagonal = row[0];
		row[0] = i + 1;
		for (size_t j = 0; j < width; j++) {
			size_t best = diagonal + (a[i] != b[j]);
			if (row[j + 1] + 1 < best)
				best = row[j + 1] + 1;
			if (row[j] + 1 < best)
				best = row[j] + 1;
			diagonal = row[j + 1];
			row[j + 1] = best;
		}
	}
	return row[width];
}

static const char *after_section(const char *key)
{
	const char *dot = strrchr(key, '.');
	return dot ? dot + 1 : key;
}

const char *gz_options_nearest(const struct gz_option_binding *bindings, size_t count,
			       const char *key)
{
	const char *nearest = NULL;
	/* Similar: at most a third of the key differs, or two letters of a short one, but no more
	 * than half of it. Chosen. */
	const size_t length = strlen(key);
	size_t least = length / 3 > 2 ? length / 3 : length / 2 < 2 ? length / 2 : 2;
	if (length >= NEAR_KEY_SIZE)
		return NULL;
	for (size_t b = 0; b < count; b++) {
		for (size_t i = 0; i < bindings[b].count; i++) {
			const char *known = bindings[b].options[i].key;
			if (strlen(known) >= NEAR_KEY_SIZE)
				continue;
			size_t distance = edit_distance(key, known);
			/* The right name with the wrong section, or without one, is similar too. */
			if (strcmp(after_section(key), after_section(known)) == 0 && distance > 1)
				distance = 1;
			if (distance > least || (nearest && distance == least))
				continue;
			least = distance;
			nearest = known;
		}
	}
	return nearest;
}
