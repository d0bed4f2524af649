#include "bench/report/crops.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "bench/metrics/metrics.h"
#include "bench/report/names.h"
#include "bench/report/study_charts.h"
#include "bench/study/stage.h"

#define GZ_LOG_MODULE "report"

/* Variants of a group that get crops; the pictures of more would make a page that is slow to load.
 * Gap between the squares, px. How much stronger differences are shown. All chosen. */
#define SERIES_MAX 16
#define GAP_PX     2
#define STRONGER   4

/* What crops need. */
struct cropping {
	const struct gz_summary *summary;
	const char *folder;
	const struct gz_group *group; /* in turn */
	struct gz_stage stage;
	struct gz_image standard, test;
	struct gz_map weights; /* of the pixels at the gaze in question */
	double *column_sums;   /* of a band of rows, one a column */
	struct gz_crops crops;
};

/* ---- the point ---- */

struct ranked {
	double cost;
	const struct gz_series_point *point;
};

static int compare_ranked(const void *a, const void *b)
{
	const struct ranked *x = a, *y = b;
	return (x->cost > y->cost) - (x->cost < y->cost);
}

/* The point with the worst or the median error of a series against standard, which the crops show
 * too; NULL where none was measured. */
static const struct gz_series_point *find_point(const struct gz_group *group, size_t series,
						enum gz_error_measure measure, bool worst)
{
	const struct gz_series *of = &group->series[series];
	struct ranked *ranked = calloc(of->point_count, sizeof ranked[0]);
	size_t count = 0;
	if (!ranked)
		return NULL;
	for (size_t i = 0; i < of->point_count; i++) {
		const double value =
			gz_error_value(measure, &of->points[i].errors[GZ_AGAINST_STANDARD]);
		const double cost = gz_error_cost(gz_error_metrics[measure].kind, value);
		if (!isnan(cost))
			ranked[count++] = (struct ranked) { cost, &of->points[i] };
	}
	qsort(ranked, count, sizeof ranked[0], compare_ranked);
	const struct gz_series_point *point =
		count == 0 ? NULL : ranked[worst ? count - 1 : count / 2].point;
	free(ranked);
	return point;
}

/* ---- its pictures ---- */

static enum gz_result draw_variant(struct cropping *cropping, size_t variant,
				   const struct gz_series_point *point, struct gz_image *image)
{
	const struct gz_study *study = cropping->summary->study;
	const struct gz_group *group = cropping->group;
	const struct gz_variant_settings *settings = &cropping->stage.variants[variant];
	const struct gz_camera camera =
		gz_study_camera(study, group->scene, study->points[point->point].camera);
	const struct gz_display display = gz_study_display(study, group->scene, group->size);
	const struct gz_picture_request request = {
		.camera = &camera,
		.settings = &settings->rays,
		.foveation = &settings->foveation,
		.display = &display,
		.focus = gz_focus_at(point->gaze),
		.width = study->sizes[group->size][0],
		.height = study->sizes[group->size][1],
		.image = image,
	};
	struct gz_image *made;
	return gz_picture_make(cropping->stage.backends[group->backend], &request, &made, NULL);
}

/* ---- where to cut ---- */

struct window {
	int x, y, side;
};

/* Difference of a pixel, by what it counts for the eye. */
static double seen_difference(const struct cropping *cropping, size_t pixel)
{
	int sum = 0;
	for (size_t c = 0; c < 3; c++)
		sum += abs(cropping->test.pixels[4 * pixel + c] -
			   cropping->standard.pixels[4 * pixel + c]);
	return sum * (double)cropping->weights.values[pixel];
}

/* Add a row to the sums of columns, or take it away. */
static void add_row(struct cropping *cropping, int row, double sign)
{
	const size_t width = (size_t)cropping->test.width;
	for (size_t x = 0; x < width; x++)
		cropping->column_sums[x] +=
			sign * seen_difference(cropping, (size_t)row * width + x);
}

/* The best window of a band of rows, whose sums are those of the columns. */
static void search_band(const struct cropping *cropping, int y, double *most, struct window *best)
{
	double sum = 0;
	for (int x = 0; x < cropping->test.width; x++) {
		sum += cropping->column_sums[x];
		if (x >= best->side)
			sum -= cropping->column_sums[x - best->side];
		if (x >= best->side - 1 && sum > *most) {
			*most = sum;
			best->x = x - best->side + 1;
			best->y = y;
		}
	}
}

/* The square with the greatest difference; round the gaze if there is none. */
static struct window find_window(struct cropping *cropping, struct gz_point gaze)
{
	const int width = cropping->test.width, height = cropping->test.height;
	const int shorter = width < height ? width : height;
	struct window best = { .side = shorter < GZ_CROP_PX ? shorter : GZ_CROP_PX };
	best.x = (int)fmin(fmax((double)gaze.x * width - best.side / 2., 0), width - best.side);
	best.y = (int)fmin(fmax((double)gaze.y * height - best.side / 2., 0), height - best.side);
	double most = 1e-6;
	memset(cropping->column_sums, 0, (size_t)width * sizeof cropping->column_sums[0]);
	for (int y = 0; y < height; y++) {
		add_row(cropping, y, 1);
		if (y >= best.side)
			add_row(cropping, y - best.side, -1);
		if (y >= best.side - 1)
			search_band(cropping, y - best.side + 1, &most, &best);
	}
	return best;
}

/* ---- the file ---- */

static void put_square(const struct cropping *cropping, const struct window *window, int panel,
		       struct gz_image *out)
{
	for (int y = 0; y < window->side; y++)
		for (int x = 0; x < window->side; x++) {
			const size_t from =
				4 * ((size_t)(window->y + y) * (size_t)cropping->test.width +
				     (size_t)(window->x + x));
			uint8_t *to =
				out->pixels + 4 * ((size_t)y * (size_t)out->width +
						   (size_t)(panel * (window->side + GAP_PX) + x));
			for (size_t c = 0; c < 3; c++) {
				const int test = cropping->test.pixels[from + c];
				const int standard = cropping->standard.pixels[from + c];
				const int apart = STRONGER * abs(test - standard);
				to[c] = (uint8_t)(panel == 0    ? test
						  : panel == 1  ? standard
						  : apart > 255 ? 255
								: apart);
			}
		}
}

static enum gz_result write_crop(const struct cropping *cropping, const struct window *window,
				 const char *path)
{
	struct gz_image out = { 0 };
	enum gz_result result = gz_image_resize(&out, 3 * window->side + 2 * GAP_PX, window->side);
	if (result != GZ_OK)
		return result;
	memset(out.pixels, 255, 4 * (size_t)out.width * (size_t)out.height);
	for (int panel = 0; panel < 3; panel++)
		put_square(cropping, window, panel, &out);
	result = gz_image_write_png(&out, path, cropping->stage.log);
	gz_image_free(&out);
	return result;
}

static double away_deg(const struct cropping *cropping, const struct window *window,
		       struct gz_point gaze)
{
	const struct gz_group *group = cropping->group;
	const struct gz_display display =
		gz_study_display(cropping->summary->study, group->scene, group->size);
	const struct gz_point middle = {
		((float)window->x + (float)window->side / 2) / (float)cropping->test.width,
		((float)window->y + (float)window->side / 2) / (float)cropping->test.height,
	};
	return gz_display_angle_deg(&display, gaze, middle);
}

static enum gz_result make_crop(struct cropping *cropping, const struct gz_series_point *point,
				struct gz_crop *crop)
{
	const struct gz_group *group = cropping->group;
	const struct gz_study *study = cropping->summary->study;
	const struct gz_display display = gz_study_display(study, group->scene, group->size);
	const int *size = study->sizes[group->size];
	const size_t variant = group->series[crop->series].variant;
	char kind[32], name[GZ_NAMES_SIZE];
	enum gz_result result = draw_variant(cropping, variant, point, &cropping->test);
	if (result == GZ_OK)
		result = draw_variant(cropping, group->series[group->standard].variant, point,
				      &cropping->standard);
	if (result == GZ_OK)
		result = gz_weights_acuity(&display, point->gaze, size[0], size[1],
					   &cropping->weights);
	if (result != GZ_OK)
		return result;
	const struct window window = find_window(cropping, point->gaze);
	snprintf(kind, sizeof kind, "crop-%s-%zu", crop->worst ? "worst" : "median", variant + 1);
	gz_chart_name(cropping->summary, kind, group, name);
	snprintf(crop->path, sizeof crop->path, "%.700s/%s.png", cropping->folder, name);
	crop->gaze = point->gaze;
	crop->away_deg = away_deg(cropping, &window, point->gaze);
	return write_crop(cropping, &window, crop->path);
}

/* Whether the scene shows what was measured, and all backends of the study run here. */
static bool enter_scene(struct cropping *cropping)
{
	const struct gz_study *study = cropping->summary->study;
	const struct gz_study_scene *was = &study->scenes[cropping->group->scene];
	char hash[GZ_STUDY_HASH_SIZE];
	return access(was->path, R_OK) == 0 &&
	       gz_stage_enter(&cropping->stage, study, cropping->group->scene, NULL) == GZ_OK &&
	       gz_stage_data_hash(&cropping->stage, &cropping->stage.transfer, hash) == GZ_OK &&
	       strcmp(hash, was->data_hash) == 0;
}

static enum gz_result add_crops(struct cropping *cropping, enum gz_error_measure measure,
				size_t series)
{
	const struct gz_group *group = cropping->group;
	enum gz_result result = GZ_OK;
	for (int worst = 1; worst >= 0 && result == GZ_OK; worst--) {
		struct gz_crop *crop = &cropping->crops.items[cropping->crops.count];
		const struct gz_series_point *point = find_point(group, series, measure, worst);
		if (!point)
			continue;
		*crop = (struct gz_crop) {
			.group = (size_t)(group - cropping->summary->groups),
			.series = series,
			.worst = worst,
			.error = gz_error_value(measure, &point->errors[GZ_AGAINST_STANDARD]),
		};
		result = make_crop(cropping, point, crop);
		cropping->crops.count += result == GZ_OK;
	}
	return result;
}

static enum gz_result crop_group(struct cropping *cropping)
{
	const struct gz_group *group = cropping->group;
	const int *size = cropping->summary->study->sizes[group->size];
	const size_t last = group->series_count < SERIES_MAX ? group->series_count : SERIES_MAX;
	enum gz_error_measure measure;
	if (group->standard == GZ_SERIES_NONE || !gz_group_measure(group, &measure) ||
	    !enter_scene(cropping))
		return GZ_OK;
	free(cropping->column_sums);
	cropping->column_sums = calloc((size_t)size[0], sizeof cropping->column_sums[0]);
	enum gz_result result = cropping->column_sums ? GZ_OK : GZ_ERR_NO_MEM;
	for (size_t i = 0; i < last && result == GZ_OK; i++)
		if (i != group->standard)
			result = add_crops(cropping, measure, i);
	return result;
}

enum gz_result gz_crops_make(const struct gz_summary *summary, const char *folder,
			     const struct gz_log *log, struct gz_crops *out_crops)
{
	struct cropping cropping = { .summary = summary,
				     .folder = folder,
				     .stage = { .log = log } };
	cropping.crops.items =
		calloc(2 * (size_t)SERIES_MAX * summary->group_count, sizeof(struct gz_crop));
	enum gz_result result = cropping.crops.items ? GZ_OK : GZ_ERR_NO_MEM;
	for (size_t i = 0; i < summary->group_count && result == GZ_OK; i++) {
		cropping.group = &summary->groups[i];
		result = crop_group(&cropping);
	}
	if (result == GZ_ERR_NO_MEM)
		gz_err(log, "%s: no memory for crops", folder);
	if (result != GZ_OK)
		gz_crops_free(&cropping.crops);
	*out_crops = cropping.crops;
	gz_stage_free(&cropping.stage);
	gz_image_free(&cropping.standard);
	gz_image_free(&cropping.test);
	gz_map_free(&cropping.weights);
	free(cropping.column_sums);
	return result;
}

void gz_crops_free(struct gz_crops *crops)
{
	free(crops->items);
	*crops = (struct gz_crops) { 0 };
}
