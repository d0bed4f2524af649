/* Rows about gazes and sizes at the limits: every pixel written, nothing refused that should not
 * be. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "bench/stability/stability_bench.h"
#include "render/plan/method.h"

static const struct gz_point centre = { 0.5F, 0.5F };

/* Gaze points; NaN and infinite ones come last. */
static const struct gz_point gazes[] = {
	{ 0.5F, 0.5F },   { 0, 0.5F },        { 0.5F, 1 },        { 0, 0 },    { 1, 1 },
	{ 0.98F, 0.02F }, { -0.01F, 0.4F },   { -0.4F, 0.5F },    { 0.5F, 3 }, { 1e30F, -1e30F },
	{ NAN, 0.5F },    { 0.2F, INFINITY }, { -INFINITY, NAN },
};
enum { GAZES = sizeof gazes / sizeof gazes[0], PLACES = GAZES - 3 };

static const char unwritten[] = "pixels that were not written";

/* Nothing shows but the background, which is another one each frame: what was not written, be it a
 * pixel or a ray's colour between frames, still has an earlier one. */
static enum gz_result check_written(struct gz_stability_bench *bench,
				    const struct gz_stability_view *view,
				    const struct gz_foveation *foveation, struct gz_point gaze,
				    int grey, struct gz_stability_outcome *outcome)
{
	static const struct gz_transfer clear = { .count = 1,
						  .points = { { 0.5, { 1, 1, 1 }, 0 } } };
	struct gz_stability_scene scene = bench->settings.scene;
	struct gz_image image = { 0 };
	size_t missed = 0;
	scene.transfer = &clear;
	for (int c = 0; c < 3; c++)
		scene.rays.background[c] = grey / 255.0;
	const enum gz_result result =
		gz_stability_frame_at(bench, &scene, foveation, view, gaze, &image);
	for (size_t i = 0; i < (size_t)view->width * (size_t)view->height && result == GZ_OK; i++) {
		const uint8_t *p = image.pixels + 4 * i;
		missed += p[0] != grey || p[1] != grey || p[2] != grey || p[3] != 255;
	}
	gz_image_free(&image);
	if (result != GZ_OK)
		return result;
	return gz_stability_take(outcome, 0, (double)missed, (struct gz_stability_place) { 0 },
				 "%dx%d, the gaze at %g, %g", view->width, view->height,
				 (double)gaze.x, (double)gaze.y);
}

/* Pixels of the fovea, or of all where @p fovea is NULL, that differ. */
static enum gz_result take_equal(const struct gz_image *got, const struct gz_image *wanted,
				 const uint8_t *fovea, struct gz_point gaze,
				 struct gz_stability_outcome *outcome)
{
	size_t other = 0, worst = 0;
	int most = -1;
	for (size_t i = 0; i < (size_t)got->width * (size_t)got->height; i++) {
		const int apart = !fovea || fovea[i] ? gz_stability_apart(got, wanted, i) : 0;
		other += apart > 0;
		if (apart > most) {
			most = apart;
			worst = i;
		}
	}
	return gz_stability_take(outcome, 1, (double)other,
				 (struct gz_stability_place) { got, wanted, worst },
				 "the gaze at %g, %g: %s", (double)gaze.x, (double)gaze.y,
				 fovea ? "the fovea, against standard" : "against the centre");
}

/* State for each gaze in turn. */
struct pictures {
	struct gz_image full, lost, image;
	uint8_t *fovea;
};

static enum gz_result check_gaze(struct gz_stability_bench *bench,
				 const struct gz_stability_view *view, int which,
				 struct pictures *pictures, struct gz_stability_outcome *outcome)
{
	const struct gz_point gaze = gazes[which];
	enum gz_result result =
		check_written(bench, view, &bench->foveation, gaze, 1 + 17 * which, outcome);
	if (result == GZ_OK)
		result = gz_stability_frame_at(bench, &bench->settings.scene, &bench->foveation,
					       view, gaze, &pictures->image);
	if (result != GZ_OK)
		return result;
	if (which >= PLACES)
		return take_equal(&pictures->image, &pictures->lost, NULL, gaze, outcome);
	if (!gz_method_of(&bench->foveation)->sharp_at_gaze)
		return GZ_OK;
	gz_stability_mark_fovea(&bench->foveation, view, gaze, false, pictures->fovea);
	return take_equal(&pictures->image, &pictures->full, pictures->fovea, gaze, outcome);
}

/* A gaze beyond the edge sees less of the picture well than one at the edge: its plan takes fewer
 * rays, unless one at the edge takes them all. */
static enum gz_result check_outside(struct gz_stability_bench *bench,
				    const struct gz_stability_view *view, struct gz_image *image,
				    struct gz_stability_outcome *outcome)
{
	static const struct gz_point at_edge = { 0, 0.5F }, beyond = { -0.4F, 0.5F };
	uint64_t rays[2] = { 0 };
	enum gz_result result = GZ_OK;
	if (!gz_method_of(&bench->foveation)->follows_gaze)
		return GZ_OK;
	for (int i = 0; i < 2 && result == GZ_OK; i++) {
		result = gz_stability_frame_at(bench, &bench->settings.scene, &bench->foveation,
					       view, i ? beyond : at_edge, image);
		rays[i] = bench->stats.rays;
	}
	if (result != GZ_OK || rays[0] >= (uint64_t)view->width * (uint64_t)view->height)
		return result;
	gz_stability_name(outcome, 2, "% of the rays at the edge taken for a gaze beyond it", 99.9);
	return gz_stability_take(outcome, 2, 100 * (double)rays[1] / (double)rays[0],
				 (struct gz_stability_place) { 0 }, "the gaze at %g, %g",
				 (double)beyond.x, (double)beyond.y);
}

enum gz_result gz_stability_gaze(struct gz_stability_bench *bench,
				 struct gz_stability_outcome *outcome)
{
	const struct gz_stability_view view = gz_stability_scene_view(bench);
	struct pictures pictures = { .fovea = malloc((size_t)view.width * (size_t)view.height) };
	enum gz_result result = pictures.fovea ? GZ_OK : GZ_ERR_NO_MEM;
	gz_stability_name(outcome, 0, unwritten, 0);
	gz_stability_name(outcome, 1, "pixels that are not what they should be", 0);
	if (result == GZ_OK)
		result =
			gz_stability_standard(bench, &bench->settings.scene, &view, &pictures.full);
	if (result == GZ_OK)
		result = gz_stability_frame_at(bench, &bench->settings.scene, &bench->foveation,
					       &view, centre, &pictures.lost);
	for (int i = 0; i < GAZES && result == GZ_OK; i++)
		result = check_gaze(bench, &view, i, &pictures, outcome);
	if (result == GZ_OK)
		result = check_outside(bench, &view, &pictures.image, outcome);
	free(pictures.fovea);
	gz_image_free(&pictures.full);
	gz_image_free(&pictures.lost);
	gz_image_free(&pictures.image);
	return result;
}

enum gz_result gz_stability_sizes(struct gz_stability_bench *bench,
				  struct gz_stability_outcome *outcome)
{
	static const int sizes[][2] = { { 1, 1 },    { 7, 3 },     { 97, 61 },
					{ 8191, 1 }, { 64, 64 },   { 2, 1031 },
					{ 1031, 2 }, { 2, 16384 }, { GZ_IMAGE_SIDE_MAX, 2 } };
	static const struct gz_point places[] = {
		{ 0.5F, 0.5F }, { 0.02F, 0.98F }, { -0.4F, 0.5F }, { NAN, 0.5F }
	};
	enum gz_result result = GZ_OK;
	int grey = 3;
	gz_stability_name(outcome, 0, unwritten, 0);
	for (size_t s = 0; s < sizeof sizes / sizeof sizes[0]; s++)
		for (size_t g = 0; g < sizeof places / sizeof places[0] && result == GZ_OK;
		     g++, grey += 13) {
			const struct gz_stability_view view =
				gz_stability_small_view(sizes[s][0], sizes[s][1]);
			const struct gz_foveation foveation =
				gz_stability_small_foveation(bench, &view);
			result = check_written(bench, &view, &foveation, places[g], grey % 255,
					       outcome);
		}
	if (result != GZ_OK)
		return result;
	const struct gz_display display = gz_display_default(GZ_IMAGE_SIDE_MAX, 2);
	const struct gz_plan_request beyond =
		gz_plan_request_make(&bench->foveation, &display, centre, GZ_IMAGE_SIDE_MAX + 1, 2);
	struct gz_plan plan = { 0 };
	const bool refused = gz_plan_update(&beyond, &plan) == GZ_ERR_INVAL;
	gz_plan_free(&plan);
	gz_stability_name(outcome, 1, "sizes beyond the limit that were taken", 0);
	return gz_stability_take(outcome, 1, refused ? 0 : 1, (struct gz_stability_place) { 0 },
				 "%d px wide", GZ_IMAGE_SIDE_MAX + 1);
}

/* ---- frames that have nothing in common ---- */

/* Frames until memory has settled. Chosen: all methods and sizes have been used many times. */
enum { SETTLED = 500 };

static long resident_kib(void)
{
	long pages = 0, resident = 0;
	FILE *in = fopen("/proc/self/statm", "r");
	if (!in || fscanf(in, "%ld %ld", &pages, &resident) != 2)
		resident = 0;
	if (in)
		fclose(in);
	return resident * (sysconf(_SC_PAGESIZE) / 1024);
}

/* Another method, size, gaze and step rule each frame. */
static enum gz_result churn_frame(struct gz_stability_bench *bench, int frame,
				  struct gz_image *image)
{
	static const int sides[] = { 64, 33, 64, 1, 48, 7, 63 };
	const int count = sizeof sides / sizeof sides[0];
	const struct gz_stability_view view =
		gz_stability_small_view(sides[frame % count], sides[frame / 2 % count]);
	const struct gz_point gaze = { (float)(frame % 23) / 20 - 0.1F,
				       (float)(frame % 31) / 25 - 0.1F };
	struct gz_foveation foveation = gz_stability_small_foveation(bench, &view);
	foveation.method = frame % GZ_METHOD_COUNT;
	foveation.step_rule = frame / 3 % 4;
	return gz_stability_frame_at(bench, &bench->settings.scene, &foveation, &view, gaze, image);
}

enum gz_result gz_stability_churn(struct gz_stability_bench *bench,
				  struct gz_stability_outcome *outcome)
{
	const int frames = bench->settings.churn_frames;
	struct gz_foveation with_table = bench->foveation;
	struct gz_image image = { 0 };
	long settled_kib = 0;
	enum gz_result result = GZ_OK;
	for (int i = 0; i < GZ_METHOD_COUNT; i++)
		if (gz_methods[i].needs_table)
			with_table.method = i;
	gz_stability_use_method(bench, &with_table, NULL, bench->every_step_rule);
	/* Chosen: a byte more a frame would be a hundredth of it, a leaked picture a hundred times
	 * as much. */
	gz_stability_name(outcome, 0, "KiB of memory more than at the start", 512);
	for (int frame = 0; frame < frames && result == GZ_OK; frame++) {
		result = churn_frame(bench, frame, &image);
		if (frame == SETTLED)
			settled_kib = resident_kib();
	}
	gz_image_free(&image);
	if (result != GZ_OK)
		return result;
	return gz_stability_take(outcome, 0, (double)(resident_kib() - settled_kib),
				 (struct gz_stability_place) { 0 }, "%d frames of all methods",
				 frames);
}
