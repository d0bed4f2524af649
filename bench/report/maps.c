/* Time and error over the gaze, with the picture behind. */
#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "bench/report/names.h"
#include "bench/report/study_charts.h"
#include "bench/study/stage.h"
#include "render/frame/picture_maker.h"

#define GZ_LOG_MODULE "report"

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

/* ---- the picture behind ---- */

/* Widest picture that is rendered for a report, px. Chosen: more than it is ever shown with. */
#define WIDTH_MAX 640

static void picture_path(const struct gz_study_scene *scene, const char *folder,
			 char out_path[GZ_PATH_SIZE])
{
	char name[2 * GZ_STUDY_TEXT_SIZE + 16];
	snprintf(name, sizeof name, "standard-%s-%s", scene->name, scene->transfer);
	for (char *byte = name; *byte; byte++)
		if (!isalnum((unsigned char)*byte) && !strchr("._-", *byte))
			*byte = '-';
	snprintf(out_path, GZ_PATH_SIZE, "%.400s/%s.png", folder, name);
}

/* The scene's transfer function that shows what the study saw; false if it has none. */
static bool find_transfer(const struct gz_stage *stage, const struct gz_study_scene *was,
			  struct gz_transfer *out_transfer)
{
	char name[GZ_STUDY_TEXT_SIZE], hash[GZ_STUDY_HASH_SIZE];
	for (size_t i = 0; i < gz_stage_transfer_count(stage); i++)
		if (gz_stage_transfer(stage, i, name, out_transfer) == GZ_OK &&
		    gz_stage_data_hash(stage, out_transfer, hash) == GZ_OK &&
		    strcmp(hash, was->data_hash) == 0)
			return true;
	return false;
}

static enum gz_result render_standard(const struct gz_scene *scene, const struct gz_camera *camera,
				      const struct gz_log *log, struct gz_image *picture)
{
	const struct gz_picture_maker_params params = {
		.backend = "cpu",
		.backend_params = { .wait_for_bricks = true },
	};
	const struct gz_foveation standard = gz_foveation_full();
	const struct gz_display display = gz_display_default(picture->width, picture->height);
	const struct gz_picture_request request = {
		.camera = camera,
		.settings = &scene->settings.rays,
		.foveation = &standard,
		.display = &display,
		.focus = gz_focus_at((struct gz_point) { 0.5F, 0.5F }),
		.width = picture->width,
		.height = picture->height,
		.image = picture,
	};
	struct gz_object objects[GZ_SCENE_LISTED_MAX];
	struct gz_picture_maker *maker = NULL;
	struct gz_image *made;
	const size_t count =
		gz_scene_list_objects(scene, objects, sizeof objects / sizeof objects[0]);
	enum gz_result result = gz_picture_maker_create(&params, log, &maker);
	if (result == GZ_OK)
		result = gz_picture_maker_show(maker, objects, count);
	if (result == GZ_OK)
		result = gz_picture_make(maker, &request, &made, NULL);
	gz_picture_maker_destroy(&maker);
	return result;
}

static enum gz_result render_scene(const struct gz_study *study, size_t place,
				   const struct gz_log *log, struct gz_image *picture)
{
	const struct gz_study_scene *was = &study->scenes[place];
	struct gz_stage stage = { .log = log };
	const int *size = study->sizes[0];
	const int width = size[0] < WIDTH_MAX ? size[0] : WIDTH_MAX;
	const int height = (int)fmax(1, round((double)width * size[1] / size[0]));
	if (access(was->path, R_OK) != 0 || gz_stage_load(&stage, was->path) != GZ_OK)
		return GZ_ERR_NOT_FOUND;
	enum gz_result result = find_transfer(&stage, was, &stage.scene.transfer)
					? gz_image_resize(picture, width, height)
					: GZ_ERR_NOT_FOUND;
	if (result == GZ_OK)
		result = render_standard(&stage.scene, &was->camera, log, picture);
	gz_stage_free(&stage);
	return result;
}

enum gz_result gz_report_picture(const struct gz_study *study, size_t scene, const char *folder,
				 const struct gz_log *log, struct gz_image *picture)
{
	char path[GZ_PATH_SIZE];
	picture_path(&study->scenes[scene], folder, path);
	if (access(path, R_OK) == 0)
		return gz_image_read_png(path, log, picture);
	const enum gz_result result = render_scene(study, scene, log, picture);
	if (result == GZ_OK)
		return gz_image_write_png(picture, path, log);
	if (result != GZ_ERR_NO_MEM)
		gz_warn(log, "%s: its maps have no picture: %s is missing or has changed",
			study->scenes[scene].name, study->scenes[scene].path);
	return result == GZ_ERR_NO_MEM ? result : GZ_ERR_NOT_FOUND;
}

/* Shared by all maps of a group. */
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
static enum gz_result prepare_background(const struct gz_summary *summary,
					 const struct gz_group *group,
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

/* The content of a map. */
struct shown {
	bool of_error;
	enum gz_error_reference reference;
	enum gz_error_measure measure;
	double range[2]; /* of the values that are finite; set by add_map_points() */
};

static double map_value(const struct gz_series_point *point, const struct shown *shown)
{
	return shown->of_error ? gz_error_value(shown->measure, &point->errors[shown->reference])
			       : point->frame_ms;
}

/* Points in the picture's pixels. */
static size_t add_map_points(const struct gz_series *series, const struct background *background,
			     struct shown *shown, struct gz_text *table)
{
	size_t count = 0;
	shown->range[0] = INFINITY;
	shown->range[1] = -INFINITY;
	for (size_t i = 0; i < series->point_count; i++) {
		const struct gz_series_point *point = &series->points[i];
		const double value = map_value(point, shown);
		if (!isfinite(value) || !isfinite(point->gaze.x) || !isfinite(point->gaze.y))
			continue;
		gz_text_add(table, "%.6g\t%.6g\t%.6g\n", point->gaze.x * background->width,
			    point->gaze.y * background->height, value);
		shown->range[0] = fmin(shown->range[0], value);
		shown->range[1] = fmax(shown->range[1], value);
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

static double tick_step_of(double span)
{
	const double power = pow(10, floor(log10(span / 4)));
	const double digit = span / 4 / power;
	return power * (digit < 1.5 ? 1 : digit < 3.5 ? 2 : digit < 7.5 ? 5 : 10);
}

static void add_map_settings(const struct gz_summary *summary, const struct gz_series *series,
			     const struct background *background, const struct shown *shown,
			     const struct gz_canvas *canvas, struct gz_text *settings)
{
	char words[GZ_NAMES_SIZE], title[2 * GZ_NAMES_SIZE];
	const double least =
		shown->of_error && shown->range[0] > 0 && shown->range[1] > shown->range[0] * 1.001
			? shown->range[0]
			: shown->range[0] * 0.999;
	const double greatest = fmax(shown->range[1], least + 1e-9 + fabs(least) * 0.002);
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
		    tick_step_of(greatest - least));
}

static enum gz_result draw_map(const struct gz_summary *summary, const struct gz_group *group,
			       size_t place, const struct background *background,
			       struct shown *shown, struct gz_charts *charts)
{
	char name[GZ_NAMES_SIZE];
	const struct gz_series *series = &group->series[place];
	struct gz_text table = { 0 };
	enum gz_result result = GZ_OK;
	const size_t count = add_map_points(series, background, shown, &table);
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
		add_map_settings(summary, series, background, shown, &canvas, &settings);
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
	enum gz_result result = prepare_background(summary, group, charts, &background);
	for (size_t i = 0; i < group->series_count && i < MAPS_MAX && result == GZ_OK; i++) {
		result = draw_map(summary, group, i, &background, &time, charts);
		if (result == GZ_OK && has_error)
			result = draw_map(summary, group, i, &background, &error, charts);
	}
	return result;
}
