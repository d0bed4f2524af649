/* Rows about structures thinner than a step or a spacing. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "bench/stability/stability_bench.h"
#include "render/plan/method.h"

/* A pixel shows something where the converged picture is so far from the background, and has lost
 * it where half of that is missing. Chosen: plainly seen on any display. */
#define SHOWS_LEVELS 60

/* Difference of a pixel from the background, grey levels. */
static double shown_at(const struct gz_image *image, size_t pixel, const double background[3])
{
	double most = 0;
	for (size_t c = 0; c < 3; c++)
		most = fmax(most, fabs(image->pixels[4 * pixel + c] - 255 * background[c]));
	return most;
}

/* Pictures in which lost pixels are counted. */
struct search {
	const struct gz_stability_scene *scene;
	struct gz_stability_view view;
	struct gz_foveation foveation;
	const struct gz_image *converged;
	struct gz_image standard; /* what it loses is not the method's fault */
	bool absolute;            /* but in the fovea it must not have lost anything either */
	struct gz_image image;
	uint8_t *fovea;
	/* Over all gazes: pixels that show something, by where they are, and those lost. */
	size_t foveal, elsewhere, lost_elsewhere;
	double most_elsewhere; /* %, of all rules */
};

static bool is_lost_pixel(const struct search *search, const struct gz_image *image, size_t pixel,
			  double there)
{
	return shown_at(image, pixel, search->scene->rays.background) < there / 2;
}

static enum gz_result look_at(struct search *search, struct gz_point gaze, const char *what,
			      struct gz_stability_outcome *outcome)
{
	size_t lost = 0, worst = 0;
	gz_stability_mark_fovea(&search->foveation, &search->view, gaze, false, search->fovea);
	for (size_t i = 0; i < (size_t)search->view.width * (size_t)search->view.height; i++) {
		const double there = shown_at(search->converged, i, search->scene->rays.background);
		if (there <= SHOWS_LEVELS)
			continue;
		const bool is = is_lost_pixel(search, &search->image, i, there);
		const bool was = is && is_lost_pixel(search, &search->standard, i, there);
		if (!search->fovea[i]) {
			search->elsewhere++;
			search->lost_elsewhere += is && !was;
			continue;
		}
		search->foveal++;
		if (gz_method_of(&search->foveation)->sharp_at_gaze && is &&
		    (search->absolute || !was)) {
			lost++;
			worst = i;
		}
	}
	return gz_stability_take(
		outcome, 0, (double)lost,
		(struct gz_stability_place) { &search->image, search->converged, worst },
		"%s, the gaze at %.2f, %.2f, steps by %s", what, (double)gaze.x, (double)gaze.y,
		gz_step_rule_names[search->foveation.step_rule]);
}

/* Gazes all over the picture, by one rule; the share lost outside the fovea is over all of them. */
static enum gz_result look_around(struct gz_stability_bench *bench, struct search *search,
				  const char *what, struct gz_stability_outcome *outcome)
{
	enum gz_result result = GZ_OK;
	search->elsewhere = search->lost_elsewhere = 0;
	if (!search->converged)
		return GZ_ERR_INVAL;
	for (int i = 0; i < 9 && result == GZ_OK; i++) {
		const struct gz_point gaze = { 0.3F + 0.2F * (float)(i % 3),
					       0.3F + 0.2F * (float)(i / 3) };
		result = gz_stability_frame_at(bench, search->scene, &search->foveation,
					       &search->view, gaze, &search->image);
		if (result == GZ_OK)
			result = look_at(search, gaze, what, outcome);
	}
	if (result != GZ_OK)
		return result;
	const double share = search->elsewhere > 0 ? 100 * (double)search->lost_elsewhere /
							     (double)search->elsewhere
						   : 0;
	search->most_elsewhere = fmax(search->most_elsewhere, share);
	return gz_stability_take(outcome, 1, share, (struct gz_stability_place) { 0 },
				 "%s, steps by %s", what,
				 gz_step_rule_names[search->foveation.step_rule]);
}

/* By every step rule, without the pixels that standard loses. */
static enum gz_result look_by_rules(struct gz_stability_bench *bench, struct search *search,
				    const char *what, struct gz_stability_outcome *outcome)
{
	int rules[GZ_STABILITY_RULES_MAX];
	const int count = gz_stability_rules(bench, rules);
	enum gz_result result =
		gz_stability_standard(bench, search->scene, &search->view, &search->standard);
	if (result == GZ_OK)
		result = gz_stability_converged_picture(bench, search->scene, &search->view,
							&search->converged);
	for (int rule = 0; rule < count && result == GZ_OK; rule++) {
		search->foveation.step_rule = rules[rule];
		result = look_around(bench, search, what, outcome);
	}
	return result;
}

static void name_numbers(struct gz_stability_outcome *outcome, double bound)
{
	gz_stability_name(outcome, 0, "pixels lost in the fovea", 0);
	gz_stability_name(outcome, 1, "% of what shows elsewhere lost, standard's losses apart",
			  bound);
}

static enum gz_result start_look(struct search *search)
{
	search->fovea = malloc((size_t)search->view.width * (size_t)search->view.height);
	return search->fovea ? GZ_OK : GZ_ERR_NO_MEM;
}

static void finish_look(struct search *search, struct gz_stability_outcome *outcome)
{
	const size_t used = strlen(outcome->note);
	snprintf(outcome->note + used, sizeof outcome->note - used,
		 "%zu pixels of foveas showed something", search->foveal);
	gz_image_free(&search->image);
	gz_image_free(&search->standard);
	free(search->fovea);
}

/* Half a voxel, which standard loses nothing by, and 1 to 4. */
static const double thin_steps[] = { 0.5, 1, 2, 3, 4 };

enum gz_result gz_stability_thin(struct gz_stability_bench *bench,
				 struct gz_stability_outcome *outcome)
{
	static const struct gz_transfer white = {
		.count = 2, .points = { { 0.1, { 1, 1, 1 }, 0 }, { 0.4, { 1, 1, 1 }, 0.95 } }
	};
	struct gz_stability_scene scene = {
		.transfer = &white,
		.camera = { .eye = { 0.8, 1.3, 0.35 }, .up = { 0, 0, 1 }, .fov_deg = 40 },
		.rays = gz_ray_params_default()
	};
	struct search search = { .scene = &scene, .view = gz_stability_small_view(160, 120) };
	search.foveation = gz_stability_small_foveation(bench, &search.view);
	/* Steps of 4 voxels, and 8 times as long where the eye sees least, may lose all that
	 * standard has kept, two fifths. */
	name_numbers(outcome, 45);
	enum gz_result result = start_look(&search);
	if (result == GZ_OK)
		result = gz_stability_volume(bench, GZ_STABILITY_WIRES, &scene.volume);
	for (size_t i = 0; i < sizeof thin_steps / sizeof thin_steps[0] && result == GZ_OK; i++) {
		char what[64];
		snprintf(what, sizeof what, "a step of %g voxels at the gaze", thin_steps[i]);
		scene.rays.ray_sampling_rate = 1 / thin_steps[i];
		search.absolute = i == 0;
		search.most_elsewhere = 0;
		result = look_by_rules(bench, &search, what, outcome);
		const size_t used = strlen(outcome->note);
		snprintf(outcome->note + used, sizeof outcome->note - used,
			 "%s%.1f %% with steps of %g",
			 used ? ", " : "lost outside the fovea: ", search.most_elsewhere,
			 thin_steps[i]);
	}
	const size_t used = strlen(outcome->note);
	snprintf(outcome->note + used, sizeof outcome->note - used, " voxels at the gaze; ");
	finish_look(&search, outcome);
	return result;
}

enum gz_result gz_stability_lost(struct gz_stability_bench *bench,
				 struct gz_stability_outcome *outcome)
{
	struct search search = { .scene = &bench->settings.scene,
				 .view = gz_stability_scene_view(bench),
				 .foveation = bench->foveation };
	/* Chosen: scenes sample their content finely enough. */
	name_numbers(outcome, 5);
	enum gz_result result = start_look(&search);
	if (result == GZ_OK)
		result = look_by_rules(bench, &search, "the scene", outcome);
	finish_look(&search, outcome);
	return result;
}
