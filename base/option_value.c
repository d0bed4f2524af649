#include <errno.h>
#include <limits.h>
#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include "base/number.h"
#include "base/option.h"
#include "base/option_internal.h"

/* Most numbers in one option: a 4x4 matrix. Chosen. */
enum { MOST_NUMBERS = 16 };

static const char blanks[] = " \t";

int gz_option_count(const struct gz_option *option)
{
	if (option->type == GZ_OPTION_SIZE)
		return 2;
	return option->count > 0 ? option->count : 1;
}

__attribute__((format(printf, 3, 4))) static enum gz_result refuse(char *message,
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

static enum gz_result refuse_range(const struct gz_option *option, const char *word, char *message,
				   size_t message_size)
{
	char allowed[GZ_OPTION_MESSAGE_SIZE];
	gz_option_allowed(option, allowed, sizeof allowed);
	bool interval = strstr(allowed, " to ") != NULL;
	return refuse(message, message_size,
		      interval ? "%s is outside %s" : "%s is refused; %s is allowed", word,
		      allowed);
}

static enum gz_result refuse_value(const struct gz_option *option, const char *value,
				   const char *what, char *message, size_t message_size)
{
	char allowed[GZ_OPTION_MESSAGE_SIZE];
	gz_option_allowed(option, allowed, sizeof allowed);
	return refuse(message, message_size, "%.80s %s %s", value[0] ? value : "an empty value",
		      what, allowed);
}

/* The length of the word at *text, which is moved past leading blanks; 0 at the end. */
static size_t next_word(const char **text)
{
	*text += strspn(*text, blanks);
	return strcspn(*text, blanks);
}

static bool parse_int(const char *word, long *out_value)
{
	char *end;
	/* strtol() also takes leading blanks, which the caller has removed, and "+". */
	if (word[strspn(word, "+-0123456789")] != '\0')
		return false;
	errno = 0;
	long value = strtol(word, &end, 10);
	if (end == word || *end)
		return false;
	*out_value = value; /* LONG_MIN or LONG_MAX on overflow: outside any option's range */
	return true;
}

/* False for NaN. */
static bool in_range(const struct gz_option *option, double value)
{
	return value >= option->min && value <= option->max;
}

/* One number of an INT, DOUBLE or SIZE, within its range. */
static enum gz_result parse_number(const struct gz_option *option, const char *word,
				   double *out_value, char *message, size_t message_size)
{
	long whole = 0;
	bool is_double = option->type == GZ_OPTION_DOUBLE;
	if (is_double ? !gz_number_parse(word, out_value) : !parse_int(word, &whole))
		return refuse_value(option, word,
				    is_double ? "is not a number; allowed:"
					      : "is not a whole number; allowed:",
				    message, message_size);
	if (!is_double) {
		if (whole < INT_MIN || whole > INT_MAX)
			return refuse_range(option, word, message, message_size);
		*out_value = (double)whole;
	}
	if (!in_range(option, *out_value))
		return refuse_range(option, word, message, message_size);
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

static enum gz_result parse_numbers(const struct gz_option *option, const char *text, void *field,
				    char *message, size_t message_size)
{
	double values[MOST_NUMBERS] = { 0 };
	int wanted = gz_option_count(option);
	if (wanted > MOST_NUMBERS)
		return refuse(message, message_size, "more than %d numbers", MOST_NUMBERS);
	const char *rest = text;
	for (int i = 0; i < wanted; i++) {
		char word[64];
		size_t length = next_word(&rest);
		if (length == 0)
			return refuse(message, message_size, "%d of %d numbers given; give %d%s", i,
				      wanted, wanted, wanted > 1 ? ", separated by blanks" : "");
		snprintf(word, sizeof word, "%.*s", (int)(length < 63 ? length : 63), rest);
		if (length >= sizeof word)
			return refuse_value(option, word,
					    "… is too long for a number; allowed:", message,
					    message_size);
		enum gz_result result =
			parse_number(option, word, &values[i], message, message_size);
		if (result != GZ_OK)
			return result;
		rest += length;
	}
	if (next_word(&rest) > 0)
		return refuse(message, message_size, "unexpected \"%.80s\" after %d number%s", rest,
			      wanted, wanted > 1 ? "s" : "");
	store_numbers(option, values, field);
	return GZ_OK;
}

static enum gz_result parse_size(const struct gz_option *option, const char *text, void *field,
				 char *message, size_t message_size)
{
	double values[2] = { 0 };
	const char *cross = strchr(text, 'x');
	if (!cross || cross == text || !cross[1] || strlen(text) > 32)
		return refuse(message, message_size,
			      "%.80s is not a size; write WIDTHxHEIGHT, as in 1920x1080",
			      text[0] ? text : "an empty value");
	char width[33];
	snprintf(width, sizeof width, "%.*s", (int)(cross - text), text);
	enum gz_result result = parse_number(option, width, &values[0], message, message_size);
	if (result == GZ_OK)
		result = parse_number(option, cross + 1, &values[1], message, message_size);
	if (result == GZ_OK)
		store_numbers(option, values, field);
	return result;
}

static enum gz_result parse_bool(const struct gz_option *option, const char *text, void *field,
				 char *message, size_t message_size)
{
	static const char *const words[] = { "false", "no", "off", "0", "true", "yes", "on", "1" };
	for (size_t i = 0; i < sizeof words / sizeof *words; i++) {
		if (strcmp(words[i], text) == 0) {
			*(bool *)field = i >= 4;
			return GZ_OK;
		}
	}
	return refuse_value(option, text, "is not", message, message_size);
}

static enum gz_result parse_choice(const struct gz_option *option, const char *text, void *field,
				   char *message, size_t message_size)
{
	for (int i = 0; option->choices[i]; i++) {
		if (strcmp(option->choices[i], text) == 0) {
			*(int *)field = i;
			return GZ_OK;
		}
	}
	return refuse_value(option, text, "is not", message, message_size);
}

static enum gz_result parse_string(const struct gz_option *option, const char *text, void *field,
				   char *message, size_t message_size)
{
	size_t size = (size_t)option->max;
	size_t length = strlen(text);
	if (length >= size)
		return refuse(message, message_size, "%zu bytes are too many; at most %zu", length,
			      size - 1);
	if (strpbrk(text, "\r\n"))
		return refuse(message, message_size, "a line break inside the value; remove it");
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
		return parse_bool(option, text, field, message, message_size);
	case GZ_OPTION_INT:
	case GZ_OPTION_DOUBLE:
		return parse_numbers(option, text, field, message, message_size);
	case GZ_OPTION_STRING:
		return parse_string(option, text, field, message, message_size);
	case GZ_OPTION_CHOICE:
		return parse_choice(option, text, field, message, message_size);
	case GZ_OPTION_SIZE:
		return parse_size(option, text, field, message, message_size);
	}
	return refuse(message, message_size, "an option of unknown type");
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
