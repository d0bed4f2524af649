#include "bench/study/columns.h"

#include <inttypes.h>
#include <math.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include "base/text.h"
#include "bench/study/csv.h"

/* The first fields identify the row; the columns of the table follow. */
#define PLACE_NAMES "scene,transfer,width,height,backend,variant,point,camera,frame,gaze_x,gaze_y"

#define AT(field) offsetof(struct gz_study_row, field)

/* clang-format off */
#define TIME(field) \
	.name = #field, .unit = "ms", .type = GZ_COLUMN_TIME, .join = GZ_JOIN_FRAMES, .offset = AT(field)
#define COUNT(field) \
	.name = #field, .unit = "", .type = GZ_COLUMN_COUNT, .join = GZ_JOIN_MEAN, .offset = AT(field)
#define ERROR(field) \
	.name = #field, .type = GZ_COLUMN_ERROR, .join = GZ_JOIN_SAME, .offset = AT(field)

/* One error against one reference. */
#define ERROR_AGAINST(of, field, of_unit, text) \
	{ .name = #of "_" #field, .unit = of_unit, .type = GZ_COLUMN_ERROR, .join = GZ_JOIN_SAME, \
	  .offset = AT(of.field), .meaning = text }

/* The nine errors against one reference. */
#define ERRORS(of, reference) \
	ERROR_AGAINST(of, psnr_db, "dB", "PSNR against " reference ", all pixels alike"), \
	ERROR_AGAINST(of, ssim, "", "SSIM, likewise"), \
	ERROR_AGAINST(of, flip, "", "FLIP, likewise"), \
	ERROR_AGAINST(of, foveal_psnr_db, "dB", "PSNR against " reference " within the fovea"), \
	ERROR_AGAINST(of, foveal_ssim, "", "SSIM, likewise"), \
	ERROR_AGAINST(of, foveal_flip, "", "FLIP, likewise"), \
	ERROR_AGAINST(of, perceived_psnr_db, "dB", "PSNR against " reference ", pixels weighted by acuity"), \
	ERROR_AGAINST(of, perceived_ssim, "", "SSIM, likewise"), \
	ERROR_AGAINST(of, perceived_flip, "", "FLIP, likewise")

const struct gz_study_column gz_study_columns[GZ_STUDY_COLUMNS] = {
	[GZ_COLUMN_PLAN] = { TIME(plan_ms), .title = "plan", .meaning = "making the plan" },
	[GZ_COLUMN_CAST] = { TIME(cast_ms), .title = "cast", .meaning = "casting the rays" },
	[GZ_COLUMN_RECONSTRUCT] = { TIME(reconstruct_ms), .title = "reconstruct",
		.meaning = "filling the pixels between rays" },
	[GZ_COLUMN_FRAME] = { TIME(frame_ms), .meaning = "the whole frame, by the monotonic clock" },
	[GZ_COLUMN_GPU] = { TIME(gpu_ms), .title = "GPU",
		.meaning = "cast and reconstruction by the graphics device's own clock; `nan` on `cpu` "
			   "and where a processor does the device's work" },
	[GZ_COLUMN_RAYS] = { COUNT(rays), .meaning = "rays cast" },
	[GZ_COLUMN_SAMPLES] = { COUNT(samples), .meaning = "interpolations of voxels" },
	[GZ_COLUMN_CONVERGED] = ERRORS(converged, "the converged picture"),
	[GZ_COLUMN_STANDARD] = ERRORS(standard, "`standard`"),
	[GZ_COLUMN_FLICKER] = { ERROR(flicker), .unit = "of 255",
		.meaning = "mean change of the picture while the gaze trembles by a pixel" },
	[GZ_COLUMN_REFERENCE] = { ERROR(reference_db), .unit = "dB",
		.meaning = "PSNR of the converged picture against one of half its step" },
	[GZ_COLUMN_PREPARE] = { TIME(prepare_ms), .title = "prepare", .later = true,
		.meaning = "preparation that the technique keeps for later frames; the first counted "
			   "frame has that of the warm-up frames, too" },
	[GZ_COLUMN_TURNING] = { ERROR(turning_error), .unit = "of 255", .later = true,
		.meaning = "what the eye sees come and go that does not in `standard`, while the camera "
			   "turns" },
	[GZ_COLUMN_CAMERA_PATH] = { ERROR(camera_path_error), .unit = "of 255", .later = true,
		.meaning = "the same while the camera follows `--camera-path`; `nan` without" },
};
/* clang-format on */

double gz_study_column_value(enum gz_study_column_id column, const struct gz_study_row *row)
{
	const char *at = (const char *)row + gz_study_columns[column].offset;
	uint64_t count;
	double number;
	if (gz_study_columns[column].type == GZ_COLUMN_COUNT) {
		memcpy(&count, at, sizeof count);
		return (double)count;
	}
	memcpy(&number, at, sizeof number);
	return number;
}

void gz_study_rows_print_head(FILE *file)
{
	fputs(PLACE_NAMES, file);
	for (int id = 0; id < GZ_STUDY_COLUMNS; id++)
		fprintf(file, ",%s", gz_study_columns[id].name);
	fputc('\n', file);
}

/* The column of this name, length bytes; GZ_STUDY_COLUMNS: none. */
static enum gz_study_column_id find_study_column(const char *name, size_t length)
{
	enum gz_study_column_id id = 0;
	while (id < GZ_STUDY_COLUMNS && (strlen(gz_study_columns[id].name) != length ||
					 strncmp(gz_study_columns[id].name, name, length) != 0))
		id++;
	return id;
}

bool gz_study_rows_parse_head(const char *line, struct gz_study_layout *out_layout)
{
	struct gz_study_layout layout = { .count = 0 };
	bool there[GZ_STUDY_COLUMNS] = { false };
	if (strncmp(line, PLACE_NAMES, sizeof PLACE_NAMES - 1) != 0)
		return false;
	line += sizeof PLACE_NAMES - 1;
	while (*line == ',') {
		const size_t length = strcspn(++line, ",");
		const enum gz_study_column_id id = find_study_column(line, length);
		if (id == GZ_STUDY_COLUMNS || there[id])
			return false;
		there[id] = true;
		layout.columns[layout.count++] = id;
		line += length;
	}
	for (int id = 0; id < GZ_STUDY_COLUMNS; id++)
		if (!there[id] && !gz_study_columns[id].later)
			return false;
	*out_layout = layout;
	return *line == '\0';
}

/* A field of text; between quotes where it must be (RFC 4180). */
static void print_csv_text(const char *text, FILE *file)
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

/* Nine significant digits: short, and exact enough for times and errors. */
static void print_csv_number(double value, FILE *file)
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
	print_csv_text(scene->name, file);
	fputc(',', file);
	print_csv_text(scene->transfer, file);
	fprintf(file, ",%d,%d,", study->sizes[row->size][0], study->sizes[row->size][1]);
	print_csv_text(study->backends[row->backend], file);
	fputc(',', file);
	print_csv_text(study->variants[row->variant].text, file);
	fprintf(file, ",%" PRIu32 ",%" PRIu32 ",%" PRIu32 ",", row->point,
		study->points[row->point].camera, row->frame);
	print_csv_number(gz_number_of_float(row->gaze.x), file);
	fputc(',', file);
	print_csv_number(gz_number_of_float(row->gaze.y), file);
	for (int id = 0; id < GZ_STUDY_COLUMNS; id++) {
		fputc(',', file);
		if (gz_study_columns[id].type == GZ_COLUMN_COUNT) {
			uint64_t count;
			memcpy(&count, (const char *)row + gz_study_columns[id].offset,
			       sizeof count);
			fprintf(file, "%" PRIu64, count);
		} else {
			print_csv_number(gz_study_column_value(id, row), file);
		}
	}
	fputc('\n', file);
}

static bool text_is(char **line, const char *name, const char *expected, char *what, size_t size)
{
	const char *field = gz_csv_next_field(line);
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
	const char *field = gz_csv_next_field(line);
	double value;
	if (field && gz_number_parse(field, &value) && (float)value == expected)
		return true;
	snprintf(what, size, "%s is '%s' where %.9g follows", name, field ? field : "",
		 (double)expected);
	return false;
}

static bool parse_double(const char *field, enum gz_study_column_type type, double *out_value)
{
	if (strcmp(field, "nan") == 0)
		*out_value = NAN;
	else if (type == GZ_COLUMN_ERROR && strcmp(field, "inf") == 0)
		*out_value = INFINITY;
	else
		return gz_number_parse(field, out_value) &&
		       (type != GZ_COLUMN_TIME || *out_value >= 0);
	return true;
}

static bool parse_number(const char *field, const struct gz_study_column *column,
			 struct gz_study_row *row)
{
	char *at = (char *)row + column->offset;
	long long whole;
	double number;
	if (column->type == GZ_COLUMN_COUNT) {
		if (!gz_number_parse_whole(field, &whole) || whole < 0)
			return false;
		const uint64_t count = (uint64_t)whole;
		memcpy(at, &count, sizeof count);
		return true;
	}
	if (!parse_double(field, column->type, &number))
		return false;
	memcpy(at, &number, sizeof number);
	return true;
}

static bool is_line_of(const struct gz_study *study, const struct gz_study_row *row, char **line,
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

bool gz_study_rows_parse(const struct gz_study *study, const struct gz_study_layout *layout,
			 char *line, struct gz_study_row *row, char *what, size_t what_size)
{
	if (!is_line_of(study, row, &line, what, what_size))
		return false;
	for (size_t i = 0; i < layout->count; i++) {
		const struct gz_study_column *column = &gz_study_columns[layout->columns[i]];
		const char *field = gz_csv_next_field(&line);
		if (field && parse_number(field, column, row))
			continue;
		snprintf(what, what_size, "%s is '%s', which is not such a number", column->name,
			 field ? field : "");
		return false;
	}
	if (line)
		snprintf(what, what_size, "there is more than %s",
			 gz_study_columns[layout->columns[layout->count - 1]].name);
	return line == NULL;
}
