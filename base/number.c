#include "base/number.h"

#include <errno.h>
#include <locale.h>
#include <math.h>
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
