#include "base/number.h"

#include <errno.h>
#include <locale.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

bool gz_number_parse(const char *word, double *out_value)
{
	if (!word[0] || word[strspn(word, "+-.eE0123456789")] != '\0')
		return false;
	/* The standard C locale: always there, so this cannot fail and allocates nothing in glibc.
	 */
	locale_t plain = newlocale(LC_ALL_MASK, "C", (locale_t)0);
	if (plain == (locale_t)0)
		return false;
	char *end;
	double value = strtod_l(word, &end, plain);
	freelocale(plain);
	if (end == word || *end != '\0' || !isfinite(value))
		return false;
	*out_value = value;
	return true;
}

bool gz_number_parse_whole(const char *word, long long *out_value)
{
	if (!word[0] || word[strspn(word, "+-0123456789")] != '\0')
		return false;
	char *end;
	errno = 0;
	long long value = strtoll(word, &end, 10);
	if (end == word || *end != '\0' || errno == ERANGE)
		return false;
	*out_value = value;
	return true;
}

void gz_number_normalise_point(char *number)
{
	static const char others[] = "0123456789+-e";
	size_t before = strspn(number, others);
	if (number[before] == '\0')
		return;
	/* What is neither digit, sign nor exponent is the point; it may be several bytes. */
	const char *after = number + before + strcspn(number + before, others);
	number[before] = '.';
	memmove(number + before + 1, after, strlen(after) + 1);
}

void gz_number_print(double value, char text[GZ_NUMBER_SIZE])
{
	double back;
	/* "600", not "6e+02". */
	if (fabs(value) < 1e15 && value == (double)(long long)value) {
		snprintf(text, GZ_NUMBER_SIZE, "%.0f", value);
		return;
	}
	/* 17 digits tell every double apart (IEEE 754-2008, 5.12.2). */
	for (int digits = 1; digits <= 17; digits++) {
		snprintf(text, GZ_NUMBER_SIZE, "%.*g", digits, value);
		gz_number_normalise_point(text);
		if (gz_number_parse(text, &back) && back == value)
			return;
	}
}

double gz_number_of_float(float value)
{
	char text[GZ_NUMBER_SIZE];
	double back;
	for (int digits = 1; digits < 9; digits++) {
		snprintf(text, sizeof text, "%.*g", digits, (double)value);
		gz_number_normalise_point(text);
		if (gz_number_parse(text, &back) && (float)back == value)
			return back;
	}
	return (double)value;
}

char *gz_number_next_word(char **text, const char *blanks)
{
	char *word = *text + strspn(*text, blanks);
	if (!*word)
		return NULL;
	char *end = word + strcspn(word, blanks);
	*text = *end ? end + 1 : end;
	*end = '\0';
	return word;
}
