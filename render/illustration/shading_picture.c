#include "render/illustration/shading_picture.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "render/illustration/depth_blur.h"
#include "render/illustration/feature_lines.h"
#include "render/illustration/shading_map.h"
#include "render/illustration/shading_parameters.h"
#include "render/illustration/tone_curve.h"

/* Rows of a part of the work. Chosen: planes of 16 rows stay in the second-level cache. */
enum { ROWS_A_PART = 16 };

/* How much farther than a pixel its neighbours are at an inner line, share of the scene's depth.
 * Chosen: folds of a bone show, and its round sides do not. */
#define LINE_THRESHOLD 0.004F

/* The planes in between. */
enum picture_plane {
	PLANE_MAP,
	PLANE_NEARNESS, /* depth from 0 (near) to 1 (far) */
	PLANE_EDGE_ROWS,
	PLANE_EDGE,
	PLANE_SHADOW_ROWS,
	PLANE_SHADOW,
	PLANE_HAZE,
	PLANE_SCENE,
	PLANE_STRONG,
	PLANE_THIN,
	PICTURE_PLANES,
};

struct gz_shading_picture {
	float *memory;
	size_t capacity; /* floats of a plane */
	float *planes[PICTURE_PLANES];
	struct gz_tone_histogram *histograms; /* of each worker */
	int histogram_count;
	struct gz_tone_curve curve;
	struct gz_haze_table haze;
	struct gz_gaussian edge, shadow;
};

/* What the workers of a frame share. */
struct picture_job {
	struct gz_shading_picture *picture;
	const struct gz_shading_frame *frame;
	const struct gz_shading_settings *settings;
	struct gz_shading_weights weights;
};

enum gz_result gz_shading_picture_create(struct gz_shading_picture **out_picture)
{
	*out_picture = calloc(1, sizeof **out_picture);
	return *out_picture ? GZ_OK : GZ_ERR_NO_MEM;
}

void gz_shading_picture_destroy(struct gz_shading_picture **picture)
{
	if (!*picture)
		return;
	free((*picture)->memory);
	free((*picture)->histograms);
	free(*picture);
	*picture = NULL;
}

static enum gz_result make_picture_room(struct gz_shading_picture *picture, size_t pixels,
					int threads)
{
	if (picture->histogram_count < threads) {
		free(picture->histograms);
		picture->histogram_count = 0;
		picture->histograms = calloc((size_t)threads, sizeof *picture->histograms);
		if (!picture->histograms)
			return GZ_ERR_NO_MEM;
		picture->histogram_count = threads;
	}
	if (picture->capacity < pixels) {
		free(picture->memory);
		picture->capacity = 0;
		picture->memory = calloc(pixels, PICTURE_PLANES * sizeof *picture->memory);
		if (!picture->memory)
			return GZ_ERR_NO_MEM;
		picture->capacity = pixels;
	}
	for (size_t i = 0; i < PICTURE_PLANES; i++)
		picture->planes[i] = picture->memory + i * picture->capacity;
	return GZ_OK;
}

static struct gz_plane_band band_of_part(const struct gz_shading_frame *frame, size_t part)
{
	const int first = (int)part * ROWS_A_PART, rest = frame->height - first;
	return (struct gz_plane_band) { frame->width, frame->height, first,
					first + (rest < ROWS_A_PART ? rest : ROWS_A_PART) };
}

static void copy_floats(const void *plane, size_t from, size_t count, float *out)
{
	memcpy(out, (const char *)plane + from * sizeof *out, count * sizeof *out);
}

/* Before the histogram is complete: depth from 0 to 1, tone that is counted, and both blurs along
 * rows. */
static void begin_part(void *user, size_t part, int worker)
{
	const struct picture_job *job = user;
	const struct gz_shading_frame *frame = job->frame;
	const struct gz_plane_band band = band_of_part(frame, part);
	float *const *planes = job->picture->planes;
	const size_t from = (size_t)band.first * (size_t)band.width;
	const size_t count = (size_t)(band.end - band.first) * (size_t)band.width;
	float *map = planes[PLANE_MAP] + from, *nearness = planes[PLANE_NEARNESS] + from;
	float *room = planes[PLANE_SCENE] + from;
	copy_floats(frame->depth, from, count, room);
	gz_shading_viewer_distance(room, count, frame->near, frame->far, nearness);
	copy_floats(frame->tone, from, count, map);
	for (size_t i = 0; i < count; i++) {
		const bool empty = frame->ids[from + i] == 0;
		nearness[i] = empty ? 1 : nearness[i];
		map[i] = empty ? 1 : map[i];
	}
	gz_tone_count(map, frame->ids + from, count, &job->picture->histograms[worker]);
	if (job->settings->edge_light > 0)
		gz_blur_along_rows(&job->picture->edge, &band, planes[PLANE_NEARNESS],
				   planes[PLANE_EDGE_ROWS]);
	if (job->settings->overlap_shadow > 0)
		gz_blur_along_rows(&job->picture->shadow, &band, planes[PLANE_NEARNESS],
				   planes[PLANE_SHADOW_ROWS]);
}

/* Gather what scene information takes away: 1 - scene = product of all 1 - w P. */
static void gather_information(const float *values, size_t count, double weight, float *scene)
{
	for (size_t i = 0; i < count; i++)
		scene[i] = 1 - (1 - scene[i]) * (1 - (float)weight * values[i]);
}

/* The scene information of a part; uses the planes of edge light and shadow as room before those
 * are blurred. */
static bool fill_scene(const struct picture_job *job, size_t from, size_t count)
{
	const struct gz_shading_frame *frame = job->frame;
	const struct gz_shading_settings *settings = job->settings;
	float *scene = job->picture->planes[PLANE_SCENE] + from;
	float *room = job->picture->planes[PLANE_EDGE] + from;
	const bool by_object = settings->object_distance > 0 && frame->object_distance_mm;
	if (!(settings->importance > 0) && !(settings->viewer_distance > 0) && !by_object)
		return false;
	memset(scene, 0, count * sizeof *scene);
	if (settings->importance > 0) {
		gz_shading_unimportance(frame->ids + from, count, frame->importances,
					frame->objects, room);
		gather_information(room, count, settings->importance, scene);
	}
	if (settings->viewer_distance > 0)
		gather_information(job->picture->planes[PLANE_NEARNESS] + from, count,
				   settings->viewer_distance, scene);
	if (by_object) {
		float *distances = job->picture->planes[PLANE_SHADOW] + from;
		copy_floats(frame->object_distance_mm, from, count, distances);
		gz_shading_object_distance(distances, count, (float)settings->object_distance_mm,
					   room);
		gather_information(room, count, settings->object_distance, scene);
	}
	return true;
}

static void fill_lines(const struct picture_job *job, const struct gz_plane_band *band,
		       struct gz_shading_layers *layers)
{
	float *const *planes = job->picture->planes;
	const struct gz_line_planes found_in = { job->frame->ids, planes[PLANE_NEARNESS] };
	const int width = job->settings->line_width;
	gz_feature_lines(&found_in, band, (enum gz_line_filter)(GZ_LINES_4 + width - 1),
			 LINE_THRESHOLD, planes[PLANE_STRONG]);
	layers->strong_lines = planes[PLANE_STRONG];
	if (width == 1 && !layers->scene)
		return;
	gz_feature_lines(&found_in, band, GZ_LINES_4, LINE_THRESHOLD, planes[PLANE_THIN]);
	layers->thin_lines = planes[PLANE_THIN];
}

/* The planes of one part, and which there are. */
static struct gz_shading_layers fill_layers(const struct picture_job *job,
					    const struct gz_plane_band *band)
{
	struct gz_shading_picture *picture = job->picture;
	const struct gz_shading_settings *settings = job->settings;
	float *const *planes = picture->planes;
	const size_t from = (size_t)band->first * (size_t)band->width;
	const size_t count = (size_t)(band->end - band->first) * (size_t)band->width;
	struct gz_shading_layers layers = { .ids = job->frame->ids,
					    .depth = planes[PLANE_NEARNESS] };
	if (fill_scene(job, from, count))
		layers.scene = planes[PLANE_SCENE];
	if (settings->edge_light > 0) {
		gz_blur_along_columns(&picture->edge, band, planes[PLANE_EDGE_ROWS],
				      planes[PLANE_EDGE]);
		layers.blurred_edge = planes[PLANE_EDGE];
	}
	if (settings->overlap_shadow > 0) {
		gz_blur_along_columns(&picture->shadow, band, planes[PLANE_SHADOW_ROWS],
				      planes[PLANE_SHADOW]);
		layers.blurred_shadow = planes[PLANE_SHADOW];
	}
	if (settings->haze > 0) {
		gz_shading_haze(planes[PLANE_NEARNESS] + from, count, &picture->haze,
				planes[PLANE_HAZE] + from);
		layers.haze = planes[PLANE_HAZE];
	}
	if (settings->lines > 0)
		fill_lines(job, band, &layers);
	return layers;
}

static void end_part(void *user, size_t part, int worker)
{
	const struct picture_job *job = user;
	const struct gz_plane_band band = band_of_part(job->frame, part);
	float *map = job->picture->planes[PLANE_MAP];
	const size_t from = (size_t)band.first * (size_t)band.width;
	const size_t count = (size_t)(band.end - band.first) * (size_t)band.width;
	const struct gz_shading_layers layers = fill_layers(job, &band);
	(void)worker;
	gz_tone_apply(&job->picture->curve, job->frame->ids + from, count, map + from);
	gz_shading_map_compose(&layers, &band, &job->weights, 1, map);
}

static void begin_frame(struct picture_job *job)
{
	struct gz_shading_picture *picture = job->picture;
	const struct gz_shading_settings *settings = job->settings;
	const double height = job->frame->height;
	gz_gaussian_make(settings->edge_light_width * height, &picture->edge);
	gz_gaussian_make(settings->overlap_shadow_width * height, &picture->shadow);
	gz_haze_table_make(settings->haze_near, settings->haze_far, settings->haze_exponent,
			   &picture->haze);
	memset(picture->histograms, 0,
	       (size_t)picture->histogram_count * sizeof *picture->histograms);
	job->weights = (struct gz_shading_weights) {
		.scene = 1, /* its weights are in the plane */
		.edge_light = (float)settings->edge_light,
		.overlap_shadow = (float)settings->overlap_shadow,
		.haze = (float)settings->haze,
		.lines = (float)settings->lines,
		.background = (float)settings->haze_background,
	};
}

enum gz_result gz_shading_picture_compose(struct gz_shading_picture *picture,
					  const struct gz_shading_frame *frame,
					  const struct gz_shading_settings *settings,
					  struct gz_workers *workers, const float **out_map)
{
	struct picture_job job = { .picture = picture, .frame = frame, .settings = settings };
	if (frame->width < 1 || frame->height < 1 || !(frame->near < frame->far) ||
	    !gz_options_hold(gz_shading_options, gz_shading_option_count, settings))
		return GZ_ERR_INVAL;
	const size_t pixels = (size_t)frame->width * (size_t)frame->height;
	const size_t parts = ((size_t)frame->height + ROWS_A_PART - 1) / ROWS_A_PART;
	const enum gz_result result = make_picture_room(picture, pixels, gz_workers_count(workers));
	if (result != GZ_OK)
		return result;
	begin_frame(&job);
	gz_workers_run(workers, begin_part, &job, parts);
	gz_tone_curve_make(picture->histograms, (size_t)picture->histogram_count, &picture->curve);
	gz_tone_curve_soften((float)settings->equalisation, &picture->curve);
	gz_workers_run(workers, end_part, &job, parts);
	*out_map = picture->planes[PLANE_MAP];
	return GZ_OK;
}

void gz_shading_grey(const float *map, size_t count, uint32_t *out_pixels)
{
	for (size_t i = 0; i < count; i++) {
		const float low = map[i] > 0 ? map[i] : 0;
		const float value = low < 1 ? low : 1;
		const uint32_t grey = (uint32_t)(int)(value * 255 + 0.5F);
		out_pixels[i] = UINT32_C(0xFF000000) | grey << 16 | grey << 8 | grey;
	}
}
