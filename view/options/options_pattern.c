/* Names of several pictures by one pattern: --out. */
#include <stdio.h>
#include <string.h>

#include "view/options/options.h"

#define GZ_LOG_MODULE "gazeview"

/* The whole of a pattern's grammar, in one place. */
struct pattern {
	size_t start, end; /* of the conversion; equal if there is none */
	bool zeros;
	int width;
	int conversions;
};

static bool scan_pattern(const char *text, struct pattern *out_pattern)
{
	struct pattern pattern = { 0 };
	for (size_t i = 0; text[i]; i++) {
		if (text[i] != '%')
			continue;
		if (text[i + 1] == '%') {
			i++;
			continue;
		}
		size_t at = i + 1;
		pattern.start = i;
		pattern.zeros = text[at] == '0';
		at += pattern.zeros;
		pattern.width = 0;
		if (text[at] >= '1' && text[at] <= '9')
			pattern.width = text[at++] - '0';
		if (text[at] != 'd')
			return false;
		pattern.end = at + 1;
		pattern.conversions++;
		i = at;
	}
	*out_pattern = pattern;
	return true;
}

enum gz_result gz_pattern_check(const char *pattern, int frames, const struct gz_log *log)
{
	struct pattern scanned;
	if (!scan_pattern(pattern, &scanned)) {
		gz_err(log,
		       "--out %s: only %%d, %%4d or %%04d (width 1 to 9) may follow a percent "
		       "sign; "
		       "write %%%% for the sign itself",
		       pattern);
		return GZ_ERR_INVAL;
	}
	if (scanned.conversions > 1) {
		gz_err(log, "--out %s: the frame number stands there %d times; once is enough",
		       pattern, scanned.conversions);
		return GZ_ERR_INVAL;
	}
	if (frames > 1 && scanned.conversions == 0) {
		gz_err(log,
		       "--out %s: several frames need a number in the name, as in "
		       "frame-%%04d.png",
		       pattern);
		return GZ_ERR_INVAL;
	}
	return GZ_OK;
}

enum gz_result gz_pattern_format(const char *pattern, int number, char *path, size_t size)
{
	struct pattern scanned;
	if (!scan_pattern(pattern, &scanned) || scanned.conversions > 1)
		return GZ_ERR_INVAL;
	size_t used = 0;
	for (size_t i = 0; pattern[i]; i++) {
		if (used + 1 >= size)
			return GZ_ERR_FULL;
		if (scanned.conversions == 1 && i == scanned.start) {
			int length =
				snprintf(path + used, size - used, scanned.zeros ? "%0*d" : "%*d",
					 scanned.width, number);
			if (length < 0 || (size_t)length >= size - used)
				return GZ_ERR_FULL;
			used += (size_t)length;
			i = scanned.end - 1;
			continue;
		}
		i += pattern[i] == '%'; /* "%%" */
		path[used++] = pattern[i];
	}
	path[used] = '\0';
	return GZ_OK;
}
