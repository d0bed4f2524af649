#define GZ_LOG_MODULE "sim"

#include "sim/targets.h"

#include <errno.h>
#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Longest line and file: chosen, far above what a list of GZ_TARGETS_MAX places needs. */
enum { LINE_SIZE = 256, FILE_SIZE_MAX = 65536 };

static const double PLACE_MIN = -0.5;
static const double PLACE_MAX = 1.5;
static const double WEIGHT_MAX = 1000;

/** Read up to four numbers of @p line. @return how many; -1 if something else stands there */
static int read_numbers(const char *line, double out_number[4])
{
	int count = 0;
	for (;;) {
		line += strspn(line, " \t\r");
		if (*line == '\0' || *line == '#')
			return count;
		char *end;
		double number = strtod(line, &end);
		bool ended = strchr(" \t\r#", *end) != NULL; /* also at the final NUL */
		if (end == line || !ended || !isfinite(number) || count == 4)
			return -1;
		out_number[count++] = number;
		line = end;
	}
}

static bool is_place(double x)
{
	return x >= PLACE_MIN && x <= PLACE_MAX;
}

/** Parse one line. @return GZ_OK, with *out_target.weight 0 for an empty line */
static enum gz_result parse_line(const char *line, struct gz_target *out_target)
{
	double number[4] = { 0, 0, 1, 0 };
	int count = read_numbers(line, number);
	if (count == 0) {
		*out_target = (struct gz_target) { .weight = 0 };
		return GZ_OK;
	}
	if ((count != 2 && count != 3) || !is_place(number[0]) || !is_place(number[1]) ||
	    number[2] <= 0 || number[2] > WEIGHT_MAX)
		return GZ_ERR_FORMAT;
	*out_target = (struct gz_target) {
		.point = { (float)number[0], (float)number[1] },
		.weight = number[2],
	};
	return GZ_OK;
}

enum gz_result gz_targets_parse(const char *name, const char *text, size_t size,
				const struct gz_log *log, struct gz_targets *out_targets)
{
	struct gz_targets targets = { .count = 0 };
	int number = 0;
	for (size_t at = 0; at < size;) {
		const char *end = memchr(text + at, '\n', size - at);
		size_t length = end ? (size_t)(end - text) - at : size - at;
		char line[LINE_SIZE];
		struct gz_target target;
		number++;
		bool fits = length < sizeof line && !memchr(text + at, '\0', length);
		if (fits) {
			memcpy(line, text + at, length);
			line[length] = '\0';
		}
		if (!fits || parse_line(line, &target) != GZ_OK) {
			gz_err(log,
			       "%s:%d: not a target; write \"x y\" or \"x y weight\", x and y "
			       "%g to %g, weight above 0 up to %g",
			       name, number, PLACE_MIN, PLACE_MAX, WEIGHT_MAX);
			return GZ_ERR_FORMAT;
		}
		if (target.weight > 0 && targets.count == GZ_TARGETS_MAX) {
			gz_err(log, "%s:%d: more than %d targets; leave some out", name, number,
			       GZ_TARGETS_MAX);
			return GZ_ERR_FORMAT;
		}
		if (target.weight > 0)
			targets.target[targets.count++] = target;
		at += length + 1;
	}
	if (targets.count == 0) {
		gz_err(log, "%s: no targets; write a line \"x y\" for each", name);
		return GZ_ERR_FORMAT;
	}
	*out_targets = targets;
	return GZ_OK;
}

/** Read all of @p file. */
static enum gz_result read_all(FILE *file, const char *path, const struct gz_log *log, char *text,
			       size_t *out_size)
{
	*out_size = fread(text, 1, FILE_SIZE_MAX + 1, file);
	if (ferror(file)) {
		gz_err(log, "cannot read %s: %s; name a readable file", path, strerror(errno));
		return GZ_ERR_IO;
	}
	if (*out_size > FILE_SIZE_MAX) {
		gz_err(log, "%s: longer than %d bytes: not a target list", path, FILE_SIZE_MAX);
		return GZ_ERR_FORMAT;
	}
	return GZ_OK;
}

enum gz_result gz_targets_load(const char *path, const struct gz_log *log,
			       struct gz_targets *out_targets)
{
	FILE *file = fopen(path, "rb");
	if (!file) {
		enum gz_result missing = errno == ENOENT ? GZ_ERR_NOT_FOUND : GZ_ERR_IO;
		gz_err(log, "cannot open %s: %s; check sim.targets", path, strerror(errno));
		return missing;
	}
	size_t size = 0;
	char *text = malloc(FILE_SIZE_MAX + 1);
	enum gz_result r = text ? read_all(file, path, log, text, &size) : GZ_ERR_NO_MEM;
	if (r == GZ_OK)
		r = gz_targets_parse(path, text, size, log, out_targets);
	free(text);
	fclose(file);
	return r;
}
