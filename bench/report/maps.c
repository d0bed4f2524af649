/* Time and error over the gaze, with the picture behind. */
#include <math.h>
#include <stdio.h>

#include "bench/report/chart_parts.h"
#include "bench/report/names.h"
#include "bench/report/picture.h"
#include "bench/report/study_charts.h"

/* Width of the picture behind, px: as wide as it is shown on a screen of high resolution. Its light
 * is taken down to this share so that points stand out. Both chosen. */
#define PICTURE_WIDTH 400
#define PICTURE_LIGHT 0.55

/* Maps of one group that are drawn at most; the tables have all. */
#define MAPS_MAX 16

/* Points whose neighbours are looked for, and the width of gnuplot's round point of size 1 on these
 * canvases, px. */
#define NEAREST_MAX 1000
#define POINT_PX    7.5

/* What all maps of a group share. */
struct background {
	bool has_picture;
	int width, height;             /**< of the coordinates, px */
	double picture_dx, picture_dy; /**< coordinates a pixel */
};

static void dim(struct gz_image *image)
{
	for (size_t i = 0; i < (size_t)image->width * (size_t)image->height * 4; i++)
		if (i % 4 != 3)
			image->pixels[i] = (uint8_t)(image->pixels[i] * PICTURE_LIGHT);
}

/* The study's picture of the scene, small and dimmed, where gnuplot finds it. */
static enum gz_result prepare(const struct gz_summary *summary, const struct gz_group *group,
			      const struct gz_charts *charts, struct background *out)
{
	char path[GZ_PATH_SIZE];
	const int *size = summary->study->sizes[group->size];
	struct gz_image whole = { 0 }, small = { 0 };
	*out = (struct background) { .width = size[0], .height = size[1] };
	/* Random cameras each see something else. */
	if (summary->study->camera_count > 0)
		return GZ_OK;
	enum gz_result result = gz_report_picture(summary->study, group->scene, charts->folder,
						  charts->log, &whole);
	if (result != GZ_OK)
		return result == GZ_ERR_NO_MEM ? result : GZ_OK;
	const int width = whole.width < PICTURE_WIDTH ? whole.width : PICTURE_WIDTH;
	const int height = (int)fmax(1, round((double)width * size[1] / size[0]));
	result = gz_image_resize(&small, width, height);
	if (result == GZ_OK) {
		gz_image_resample(&whole, &small);
		dim(&small);
		gz_charts_path(charts, "picture.png", path);
		result = gz_image_write_png(&small, path, charts->log);
		out->has_picture = result == GZ_OK;
		out->picture_dx = (double)size[0] / width;
		out->picture_dy = (double)size[1] / height;
	}
	gz_image_free(&whole);
	gz_image_free(&small);
	return result;
}

void gz_map_chart_name(const struct gz_summary *summary, const struct gz_group *group,
		       size_t series, bool of_error, char out_name[256])
{
	char kind[64];
	snprintf(kind, sizeof kind, "map-%s-%zu", of_error ? "error" : "time",
		 group->series[series].variant + 1);
	gz_chart_name(summary, kind, group, out_name);
}

/* What a map shows. */
struct shown {
	bool of_error;
	enum gz_error_reference reference;
	enum gz_error_measure measure;
};

static double value_of(const struct gz_series_point *point, const struct shown *shown)
{
	return shown->of_error ? gz_error_value(shown->measure, &point->errors[shown->reference])
			       : point->frame_ms;
}

/* Points in the picture's pixels; the range of the values that are finite. */
static size_t add_points(const struct gz_series *series, const struct background *background,
			 const struct shown *shown, struct gz_text *table, double range[2])
{
	size_t count = 0;
	range[0] = INFINITY;
	range[1] = -INFINITY;
	for (size_t i = 0; i < series->point_count; i++) {
		const struct gz_series_point *point = &series->points[i];
		const double value = value_of(point, shown);
		if (!isfinite(value) || !isfinite(point->gaze.x) || !isfinite(point->gaze.y))
			continue;
		gz_text_add(table, "%.6g\t%.6g\t%.6g\n", point->gaze.x * background->width,
			    point->gaze.y * background->height, value);
		range[0] = fmin(range[0], value);
		range[1] = fmax(range[1], value);
		count++;
	}
	return count;
}

/* Mean distance from a point to the nearest other one, px of the picture; of the first
 * NEAREST_MAX. */
static double nearest_px(const struct gz_series *series, const struct background *background)
{
	const size_t count = series->point_count < NEAREST_MAX ? series->point_count : NEAREST_MAX;
	double sum = 0;
	for (size_t i = 0; i < count; i++) {
		double nearest = INFINITY;
		for (size_t k = 0; k < count; k++) {
			const struct gz_point a = series->points[i].gaze,
					      b = series->points[k].gaze;
			if (k != i)
				nearest = fmin(nearest,
					       hypot((double)(a.x - b.x) * background->width,
						     (double)(a.y - b.y) * background->height));
		}
		sum += fmin(nearest, background->width);
	}
	return sum / (double)count;
}

static double step_of(double span)
{
	const double power = pow(10, floor(log10(span / 4)));
	const double digit = span / 4 / power;
	return power * (digit < 1.5 ? 1 : digit < 3.5 ? 2 : digit < 7.5 ? 5 : 10);
}

static void add_settings(const struct gz_summary *summary, const struct gz_series *series,
			 const struct background *background, const struct shown *shown,
			 const struct gz_canvas *canvas, const double range[2],
			 struct gz_text *settings)
{
	char words[GZ_NAMES_SIZE], title[2 * GZ_NAMES_SIZE];
	const double least = shown->of_error && range[0] > 0 && range[1] > range[0] * 1.001
				     ? range[0]
				     : range[0] * 0.999;
	const double greatest = fmax(range[1], least + 1e-9 + fabs(least) * 0.002);
	const double scale =
		(double)(canvas->width - canvas->left - canvas->right) / background->width;
	const double size = fmin(fmax(nearest_px(series, background) * scale / POINT_PX, 0.5), 2);
	gz_variant_words(&summary->study->variants[series->variant], words);
	snprintf(title, sizeof title, "%.100s: %s", words,
		 shown->of_error ? gz_error_metrics[shown->measure].title : "ms a frame");
	gz_chart_set_text(settings, "title_text", title);
	gz_text_add(settings,
		    "has_picture = %d\npicture_width = %d\npicture_height = %d\n"
		    "picture_dx = %.9g\npicture_dy = %.9g\npoint_size = %.4g\n"
		    "value_first = %.9g\nvalue_last = %.9g\nvalue_step = %.9g\n",
		    background->has_picture, background->width, background->height,
		    background->picture_dx, background->picture_dy, size, least, greatest,
		    step_of(greatest - least));
}

static enum gz_result draw_map(const struct gz_summary *summary, const struct gz_group *group,
			       size_t place, const struct background *background,
			       const struct shown *shown, struct gz_charts *charts)
{
	char name[GZ_NAMES_SIZE];
	double range[2];
	const struct gz_series *series = &group->series[place];
	struct gz_text table = { 0 };
	enum gz_result result = GZ_OK;
	const size_t count = add_points(series, background, shown, &table, range);
	gz_map_chart_name(summary, group, place, shown->of_error, name);
	/* One SVG does for all pages: maps stand side by side. */
	for (int kind = 0; kind < GZ_CANVAS_KINDS && result == GZ_OK && count > 0; kind++) {
		struct gz_text settings = { 0 };
		struct gz_canvas canvas = gz_canvas_of(GZ_CANVAS_NARROW);
		if (kind == GZ_CANVAS_NARROW)
			continue;
		canvas.kind = kind;
		canvas.left = canvas.right = 14;
		canvas.top = 30;
		canvas.bottom = 40;
		canvas.height = canvas.top + canvas.bottom +
				(canvas.width - 28) * background->height / background->width;
		add_settings(summary, series, background, shown, &canvas, range, &settings);
		result = gz_charts_draw(charts, "heat.gp", name, &canvas, &settings, &table);
		gz_text_free(&settings);
	}
	gz_text_free(&table);
	return result;
}

enum gz_result gz_maps_draw(const struct gz_summary *summary, const struct gz_group *group,
			    struct gz_charts *charts)
{
	struct background background;
	struct shown time = { 0 };
	struct shown error = { .of_error = true, .reference = gz_group_reference(group) };
	const bool has_error = gz_group_measure(group, &error.measure);
	enum gz_result result = prepare(summary, group, charts, &background);
	for (size_t i = 0; i < group->series_count && i < MAPS_MAX && result == GZ_OK; i++) {
		result = draw_map(summary, group, i, &background, &time, charts);
		if (result == GZ_OK && has_error)
			result = draw_map(summary, group, i, &background, &error, charts);
	}
	return result;
}
