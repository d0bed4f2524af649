#include "bench/study/study_rows.h"

#include <inttypes.h>
#include <math.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include "base/text.h"

/* What a line begins with says what it is of; then come the numbers of the table. */
#define HEAD "scene,transfer,width,height,backend,variant,point,camera,frame,gaze_x,gaze_y"

enum kind { TIME, COUNT, ERROR };

#define ERRORS(name)                                                                               \
	{ #name "_psnr_db", ERROR, offsetof(struct gz_study_row, name.psnr_db) },                  \
		{ #name "_ssim", ERROR, offsetof(struct gz_study_row, name.ssim) },                \
		{ #name "_flip", ERROR, offsetof(struct gz_study_row, name.flip) },                \
		{ #name "_foveal_psnr_db", ERROR,                                                  \
		  offsetof(struct gz_study_row, name.foveal_psnr_db) },                            \
		{ #name "_foveal_ssim", ERROR, offsetof(struct gz_study_row, name.foveal_ssim) },  \
		{ #name "_foveal_flip", ERROR, offsetof(struct gz_study_row, name.foveal_flip) },  \
		{ #name "_perceived_psnr_db", ERROR,                                               \
		  offsetof(struct gz_study_row, name.perceived_psnr_db) },                         \
		{ #name "_perceived_ssim", ERROR,                                                  \
		  offsetof(struct gz_study_row, name.perceived_ssim) },                            \
	{                                                                                          \
#name "_perceived_flip", ERROR, offsetof(struct gz_study_row, name.perceived_flip) \
	}

static const struct column {
	const char *name;
	enum kind kind;
	size_t offset;
} columns[] = {
	{ "plan_ms", TIME, offsetof(struct gz_study_row, plan_ms) },
	{ "cast_ms", TIME, offsetof(struct gz_study_row, cast_ms) },
	{ "reconstruct_ms", TIME, offsetof(struct gz_study_row, reconstruct_ms) },
	{ "frame_ms", TIME, offsetof(struct gz_study_row, frame_ms) },
	{ "gpu_ms", TIME, offsetof(struct gz_study_row, gpu_ms) },
	{ "rays", COUNT, offsetof(struct gz_study_row, rays) },
	{ "samples", COUNT, offsetof(struct gz_study_row, samples) },
	ERRORS(converged),
	ERRORS(standard),
	{ "flicker", ERROR, offsetof(struct gz_study_row, flicker) },
	{ "reference_db", ERROR, offsetof(struct gz_study_row, reference_db) },
};

enum { COLUMNS = sizeof columns / sizeof columns[0] };

void gz_study_rows_print_head(FILE *file)
{
	fputs(HEAD, file);
	for (size_t i = 0; i < COLUMNS; i++)
		fprintf(file, ",%s", columns[i].name);
	fputc('\n', file);
}

bool gz_study_rows_is_head(const char *line)
{
	if (strncmp(line, HEAD, sizeof HEAD - 1) != 0)
		return false;
	line += sizeof HEAD - 1;
	for (size_t i = 0; i < COLUMNS; i++) {
		const size_t length = strlen(columns[i].name);
		if (*line++ != ',' || strncmp(line, columns[i].name, length) != 0)
			return false;
		line += length;
	}
	return *line == '\0';
}

/* A field of text; between quotes where it must be (RFC 4180). */
static void print_text(const char *text, FILE *file)
{
	if (!strpbrk(text, ",\"")) {
		fputs(text, file);
		return;
	}
	fputc('"', file);
	for (; *text; text++) {
		if (*text == '"')
			fputc('"', file);
		fputc(*text, file);
	}
	fputc('"', file);
}

/* Shortest of those that read back as the same double, as a rule. */
static void print_number(double value, FILE *file)
{
	char text[40];
	if (isnan(value)) {
		fputs("nan", file);
		return;
	}
	if (isinf(value)) {
		fputs(value > 0 ? "inf" : "-inf", file);
		return;
	}
	snprintf(text, sizeof text, "%.9g", value);
	gz_number_normalise_point(text);
	fputs(text, file);
}

void gz_study_rows_print(const struct gz_study *study, const struct gz_study_row *row, FILE *file)
{
	const struct gz_study_scene *scene = &study->scenes[row->scene];
	print_text(scene->name, file);
	fputc(',', file);
	print_text(scene->transfer, file);
	fprintf(file, ",%d,%d,", study->sizes[row->size][0], study->sizes[row->size][1]);
	print_text(study->backends[row->backend], file);
	fputc(',', file);
	print_text(study->variants[row->variant].text, file);
	fprintf(file, ",%" PRIu32 ",%" PRIu32 ",%" PRIu32 ",", row->point,
		study->points[row->point].camera, row->frame);
	print_number(gz_number_of_float(row->gaze.x), file);
	fputc(',', file);
	print_number(gz_number_of_float(row->gaze.y), file);
	for (size_t i = 0; i < COLUMNS; i++) {
		const char *at = (const char *)row + columns[i].offset;
		uint64_t count;
		double number;
		fputc(',', file);
		if (columns[i].kind == COUNT) {
			memcpy(&count, at, sizeof count);
			fprintf(file, "%" PRIu64, count);
		} else {
			memcpy(&number, at, sizeof number);
			print_number(number, file);
		}
	}
	fputc('\n', file);
}

/* Cut the next field off *line, which is moved behind its comma, or set to NULL behind the last
 * field. NULL where there is none, or its quotes do not end. */
static char *next_field(char **line)
{
	char *field = *line, *to;
	if (!field)
		return NULL;
	if (*field != '"') {
		*line = strchr(field, ',');
		if (*line)
			*(*line)++ = '\0';
		return field;
	}
	const char *from = field + 1;
	for (to = field; *from && (*from != '"' || from[1] == '"'); from++) {
		from += *from == '"';
		*to++ = *from;
	}
	if (*from != '"' || (from[1] != ',' && from[1] != '\0'))
		return NULL;
	*line = from[1] == ',' ? field + (from + 2 - field) : NULL;
	*to = '\0';
	return field;
}

static bool text_is(char **line, const char *name, const char *expected, char *what, size_t size)
{
	const char *field = next_field(line);
	if (field && strcmp(field, expected) == 0)
		return true;
	snprintf(what, size, "%s is '%s' where '%s' follows", name, field ? field : "", expected);
	return false;
}

static bool whole_is(char **line, const char *name, long long expected, char *what, size_t size)
{
	char text[24];
	snprintf(text, sizeof text, "%lld", expected);
	return text_is(line, name, text, what, size);
}

static bool gaze_is(char **line, const char *name, float expected, char *what, size_t size)
{
	const char *field = next_field(line);
	double value;
	if (field && gz_number_parse(field, &value) && (float)value == expected)
		return true;
	snprintf(what, size, "%s is '%s' where %.9g follows", name, field ? field : "",
		 (double)expected);
	return false;
}

static bool parse_double(const char *field, enum kind kind, double *out_value)
{
	if (strcmp(field, "nan") == 0)
		*out_value = NAN;
	else if (kind == ERROR && strcmp(field, "inf") == 0)
		*out_value = INFINITY;
	else
		return gz_number_parse(field, out_value) && (kind != TIME || *out_value >= 0);
	return true;
}

static bool parse_number(const char *field, const struct column *column, struct gz_study_row *row)
{
	char *at = (char *)row + column->offset;
	long long whole;
	double number;
	if (column->kind == COUNT) {
		if (!gz_number_parse_whole(field, &whole) || whole < 0)
			return false;
		const uint64_t count = (uint64_t)whole;
		memcpy(at, &count, sizeof count);
		return true;
	}
	if (!parse_double(field, column->kind, &number))
		return false;
	memcpy(at, &number, sizeof number);
	return true;
}

static bool is_of(const struct gz_study *study, const struct gz_study_row *row, char **line,
		  char *what, size_t size)
{
	const struct gz_study_scene *scene = &study->scenes[row->scene];
	const struct gz_study_point *point = &study->points[row->point];
	return text_is(line, "scene", scene->name, what, size) &&
	       text_is(line, "transfer", scene->transfer, what, size) &&
	       whole_is(line, "width", study->sizes[row->size][0], what, size) &&
	       whole_is(line, "height", study->sizes[row->size][1], what, size) &&
	       text_is(line, "backend", study->backends[row->backend], what, size) &&
	       text_is(line, "variant", study->variants[row->variant].text, what, size) &&
	       whole_is(line, "point", row->point, what, size) &&
	       whole_is(line, "camera", point->camera, what, size) &&
	       whole_is(line, "frame", row->frame, what, size) &&
	       gaze_is(line, "gaze_x", point->gaze.x, what, size) &&
	       gaze_is(line, "gaze_y", point->gaze.y, what, size);
}

bool gz_study_rows_parse(const struct gz_study *study, char *line, struct gz_study_row *row,
			 char *what, size_t what_size)
{
	if (!is_of(study, row, &line, what, what_size))
		return false;
	for (size_t i = 0; i < COLUMNS; i++) {
		const char *field = next_field(&line);
		if (field && parse_number(field, &columns[i], row))
			continue;
		snprintf(what, what_size, "%s is '%s', which is no such number", columns[i].name,
			 field ? field : "");
		return false;
	}
	if (line)
		snprintf(what, what_size, "there is more than %s", columns[COLUMNS - 1].name);
	return line == NULL;
}
