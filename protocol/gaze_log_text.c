#include "protocol/gaze_log_text.h"

#include <errno.h>
#include <inttypes.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/number.h"

/* Room for any number printed here: sign, 17 digits, point of up to 6 bytes, exponent. */
enum { NUMBER_SIZE = 48 };

static const char escaped[] = "\\\t\n\r";
static const char escape_letter[] = "\\tnr";

void gz_text_begin(struct gz_text *text, char *bytes, size_t size)
{
	*text = (struct gz_text) { .bytes = bytes, .size = size, .full = size == 0 };
}

enum gz_result gz_text_end(struct gz_text *text, size_t *out_length)
{
	if (text->full)
		return GZ_ERR_FULL;
	*out_length = text->length;
	return GZ_OK;
}

void gz_text_print(struct gz_text *text, const char *format, ...)
{
	if (text->full)
		return;
	size_t left = text->size - text->length;
	va_list arguments;
	va_start(arguments, format);
	int length = vsnprintf(text->bytes + text->length, left, format, arguments);
	va_end(arguments);
	if (length < 0 || (size_t)length >= left)
		text->full = true;
	else
		text->length += (size_t)length;
}

void gz_text_print_escaped(struct gz_text *text, const char *plain)
{
	for (; *plain; plain++) {
		const char *at = strchr(escaped, *plain);
		if (at)
			gz_text_print(text, "\\%c", escape_letter[at - escaped]);
		else
			gz_text_print(text, "%c", *plain);
	}
}

void gz_text_print_float(struct gz_text *text, float value)
{
	if (isnan(value))
		return;
	if (isinf(value)) {
		gz_text_print(text, value > 0 ? "inf" : "-inf");
		return;
	}
	char number[NUMBER_SIZE];
	snprintf(number, sizeof number, "%.9g", (double)value);
	gz_number_normalise_point(number);
	gz_text_print(text, "%s", number);
}

void gz_text_print_double(struct gz_text *text, double value)
{
	char number[NUMBER_SIZE];
	snprintf(number, sizeof number, "%.15g", value);
	if (strtod(number, NULL) != value)
		snprintf(number, sizeof number, "%.17g", value);
	gz_number_normalise_point(number);
	gz_text_print(text, "%s", number);
}

/* strtoll() and its like skip blanks and read "+5"; a field may begin with neither. */
static bool begins_number(const char *field)
{
	size_t sign = field[0] == '-';
	return (field[sign] >= '0' && field[sign] <= '9') || field[sign] == '.';
}

bool gz_field_int64(const char *field, int64_t *out_value)
{
	if (!begins_number(field))
		return false;
	char *end;
	errno = 0;
	int64_t value = strtoimax(field, &end, 10);
	if (errno != 0 || *end != '\0' || end == field)
		return false;
	*out_value = value;
	return true;
}

bool gz_field_uint64(const char *field, uint64_t *out_value)
{
	if (!begins_number(field) || field[0] == '-')
		return false;
	char *end;
	errno = 0;
	uint64_t value = strtoumax(field, &end, 10);
	if (errno != 0 || *end != '\0' || end == field)
		return false;
	*out_value = value;
	return true;
}

bool gz_field_crc(const char *field, uint32_t *out_value)
{
	if (strlen(field) != 8 || strspn(field, "0123456789abcdef") != 8)
		return false;
	*out_value = (uint32_t)strtoul(field, NULL, 16);
	return true;
}

/* Decimal digits only: strtod() would also read "nan(7)" and "0x1p3". */
static bool is_decimal(const char *field)
{
	return begins_number(field) && field[strspn(field, "0123456789+-.eE")] == '\0';
}

bool gz_field_float(const char *field, locale_t c_locale, float *out_value)
{
	if (field[0] == '\0') {
		*out_value = NAN;
		return true;
	}
	bool negative = field[0] == '-';
	if (strcmp(field + negative, "inf") == 0) {
		*out_value = negative ? -INFINITY : INFINITY;
		return true;
	}
	if (!is_decimal(field))
		return false;
	char *end;
	float value = strtof_l(field, &end, c_locale);
	if (*end != '\0' || end == field || isinf(value))
		return false;
	*out_value = value;
	return true;
}

bool gz_field_double(const char *field, locale_t c_locale, double *out_value)
{
	if (!is_decimal(field))
		return false;
	char *end;
	double value = strtod_l(field, &end, c_locale);
	if (*end != '\0' || end == field || isinf(value))
		return false;
	*out_value = value;
	return true;
}

bool gz_field_text(const char *field, char *out_plain, size_t size)
{
	size_t length = 0;
	for (; *field; field++) {
		char c = *field;
		if (c == '\\') {
			const char *at = *++field ? strchr(escape_letter, *field) : NULL;
			if (!at)
				return false;
			c = escaped[at - escape_letter];
		}
		if (length + 1 >= size)
			return false;
		out_plain[length++] = c;
	}
	out_plain[length] = '\0';
	return true;
}
