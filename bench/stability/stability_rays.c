/* A frame against what is wanted, ray by ray. */
#include "bench/stability/stability_rays.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define NO_RAY 255

/* The steps by which pixels were cast, places in the plan's list; NO_RAY between them. */
static void mark_tile(const struct gz_plan *plan, const struct gz_tile *tile, uint8_t *steps)
{
	const uint32_t active = gz_plan_tile_active(plan, tile);
	const int spacing = plan->layers[tile->layer].spacing;
	for (int i = 0; i < GZ_TILE_EDGE * GZ_TILE_EDGE; i++) {
		const int x = tile->x + gz_tile_columns[tile->pattern][i] * spacing;
		const int y = tile->y + gz_tile_rows[i] * spacing;
		if (!(active >> i & 1) || x >= plan->width || y >= plan->height)
			continue;
		/* A pixel shows the first region that holds it: another's ray there is not seen. */
		int layer = tile->layer;
		if (plan->reconstruction == GZ_RECONSTRUCT_REGIONS)
			for (layer = 0; !gz_region_holds(&plan->layers[layer].region, x, y);)
				layer++;
		if (layer == tile->layer)
			steps[(size_t)y * (size_t)plan->width + (size_t)x] = tile->step;
	}
}

static void mark_rays(const struct gz_plan *plan, uint8_t *steps)
{
	memset(steps, NO_RAY, (size_t)plan->width * (size_t)plan->height);
	for (size_t i = 0; i < plan->tile_count; i++)
		mark_tile(plan, &plan->tiles[i], steps);
}

/* Differences of the pixels held against something so far. */
struct differences {
	size_t count, by_levels[256];
	int worst;
	size_t worst_pixel;
	const struct gz_image *worst_wanted;
};

static void compare(const struct gz_image *got, const struct gz_image *wanted, size_t pixel,
		    struct differences *differences)
{
	const int apart = gz_stability_apart(got, wanted, pixel);
	differences->count++;
	differences->by_levels[apart]++;
	if (!differences->worst_wanted || apart > differences->worst) {
		differences->worst = apart;
		differences->worst_pixel = pixel;
		differences->worst_wanted = wanted;
	}
}

/* The least difference that all but a share of the pixels are within. */
static int levels_off(const struct differences *differences, double share)
{
	size_t left = (size_t)(share * (double)differences->count);
	int levels = 255;
	while (levels > 0 && differences->by_levels[levels] <= left)
		left -= differences->by_levels[levels--];
	return levels;
}

/* Least and greatest of each channel over a block of pixels. */
struct block {
	uint8_t least[3], greatest[3];
};

static void widen(struct block *block, const uint8_t *least, const uint8_t *greatest)
{
	for (int c = 0; c < 3; c++) {
		block->least[c] = least[c] < block->least[c] ? least[c] : block->least[c];
		block->greatest[c] =
			greatest[c] > block->greatest[c] ? greatest[c] : block->greatest[c];
	}
}

static struct block around(const struct block *blocks, int columns, int rows, int column, int row)
{
	struct block hull = { { 255, 255, 255 }, { 0, 0, 0 } };
	for (int y = row > 0 ? row - 1 : 0; y <= row + 1 && y < rows; y++)
		for (int x = column > 0 ? column - 1 : 0; x <= column + 1 && x < columns; x++) {
			const struct block *block = &blocks[y * columns + x];
			widen(&hull, block->least, block->greatest);
		}
	return hull;
}

static bool beyond(const struct block *hull, const uint8_t *pixel)
{
	bool is = false;
	for (int c = 0; c < 3; c++) /* a level for rounding */
		is = is || pixel[c] + 1 < hull->least[c] || pixel[c] > hull->greatest[c] + 1;
	return is;
}

/* What no pixel may lie beyond: what `standard` shows around it, by any of the plan's steps. Rays
 * that another region hides are among that. */
struct hulls {
	int edge, columns, rows; /* of blocks: an interpolation never looks farther than its edge */
	int inner[2]; /* pixels with lattice points on all sides: beyond the last one within the
			 picture there are rays that it does not show */
	struct block *blocks;
};

static enum gz_result start_hulls(const struct gz_plan *plan, struct hulls *hulls)
{
	int spacing = 1;
	for (int i = 0; i < plan->layer_count; i++)
		spacing = plan->layers[i].spacing > spacing ? plan->layers[i].spacing : spacing;
	hulls->edge = 2 * spacing;
	hulls->columns = (plan->width + hulls->edge - 1) / hulls->edge;
	hulls->rows = (plan->height + hulls->edge - 1) / hulls->edge;
	hulls->inner[0] = (plan->width - 1) / spacing * spacing;
	hulls->inner[1] = (plan->height - 1) / spacing * spacing;
	const size_t count = (size_t)hulls->columns * (size_t)hulls->rows;
	hulls->blocks = malloc(count * sizeof *hulls->blocks);
	if (!hulls->blocks)
		return GZ_ERR_NO_MEM;
	for (size_t i = 0; i < count; i++)
		hulls->blocks[i] = (struct block) { { 255, 255, 255 }, { 0, 0, 0 } };
	return GZ_OK;
}

static void widen_hulls(struct hulls *hulls, const struct gz_image *image)
{
	const uint8_t *colour = image->pixels;
	for (int y = 0; y < image->height; y++)
		for (int x = 0; x < image->width; x++, colour += 4)
			widen(&hulls->blocks[y / hulls->edge * hulls->columns + x / hulls->edge],
			      colour, colour);
}

static size_t count_seams(const struct hulls *hulls, const struct gz_image *got, size_t *out_pixel)
{
	size_t count = 0;
	*out_pixel = 0;
	for (int y = 0; y <= hulls->inner[1]; y++)
		for (int x = 0; x <= hulls->inner[0]; x++) {
			const size_t pixel = (size_t)y * (size_t)got->width + (size_t)x;
			const struct block hull = around(hulls->blocks, hulls->columns, hulls->rows,
							 x / hulls->edge, y / hulls->edge);
			if (!beyond(&hull, got->pixels + 4 * pixel))
				continue;
			count++;
			*out_pixel = pixel;
		}
	return count;
}

/* Against `standard` with each step that the plan has, or with the one asked for. */
static enum gz_result compare_all(struct gz_stability_bench *bench,
				  const struct gz_stability_check *check,
				  const struct gz_image *got, const uint8_t *steps,
				  struct gz_image *worst_wanted, struct differences *differences,
				  struct hulls *hulls)
{
	const size_t pixels = (size_t)got->width * (size_t)got->height;
	enum gz_result result = GZ_OK;
	for (int step = 0; step < bench->plan.step_count && result == GZ_OK; step++) {
		struct gz_stability_scene scene = *check->scene;
		const struct gz_image *wanted = NULL;
		const double rate = scene.rays.ray_sampling_rate / (double)bench->plan.steps[step];
		if (check->fine_rate == 0 &&
		    (!memchr(steps, step, pixels) || rate < GZ_RAY_SAMPLING_RATE_MIN))
			continue; /* not taken, or beyond what a scene can be told */
		scene.rays.ray_sampling_rate = check->fine_rate > 0 ? check->fine_rate : rate;
		result = gz_stability_wanted_picture(bench, &scene, &check->view, &wanted);
		if (result != GZ_OK)
			break;
		widen_hulls(hulls, wanted);
		const struct gz_image *before = differences->worst_wanted;
		for (size_t i = 0; i < pixels; i++)
			if (check->fine_rate > 0 ? check->between || steps[i] != NO_RAY
						 : steps[i] == step)
				compare(got, wanted, i, differences);
		/* The bench may drop a picture while it makes the next. */
		if (differences->worst_wanted != before)
			result = gz_image_resize(worst_wanted, got->width, got->height);
		if (differences->worst_wanted != before && result == GZ_OK) {
			memcpy(worst_wanted->pixels, wanted->pixels, pixels * 4);
			differences->worst_wanted = worst_wanted;
		}
		if (check->fine_rate > 0)
			break;
	}
	return result;
}

static enum gz_result judge_frame(struct gz_stability_bench *bench,
				  const struct gz_stability_check *check,
				  const struct gz_image *got, uint8_t *steps,
				  struct gz_stability_outcome *outcome)
{
	/* The user's transfer function may be steeper than rounding is fine. */
	const bool shared = check->scene->volume == bench->settings.scene.volume ||
			    strcmp(bench->backend, "cpu") != 0;
	const char *rule = gz_step_rule_names[check->foveation.step_rule];
	struct differences differences = { 0 };
	struct hulls hulls = { 0 };
	struct gz_image wanted = { 0 };
	size_t seam = 0;
	mark_rays(&bench->plan, steps);
	enum gz_result result = start_hulls(&bench->plan, &hulls);
	if (result == GZ_OK)
		result = compare_all(bench, check, got, steps, &wanted, &differences, &hulls);
	if (result == GZ_OK && differences.count > 0)
		result = gz_stability_take(
			outcome, 0, levels_off(&differences, shared ? 0.001 : 0),
			(struct gz_stability_place) { got, &wanted, differences.worst_pixel },
			"%s, steps by %s", check->name, rule);
	if (result == GZ_OK && outcome->number_count > 1) {
		const size_t seams = count_seams(&hulls, got, &seam);
		result = gz_stability_take(outcome, 1, (double)seams,
					   (struct gz_stability_place) { 0 },
					   "%s, steps by %s, at %zu, %zu", check->name, rule,
					   seam % (size_t)got->width, seam / (size_t)got->width);
	}
	free(hulls.blocks);
	gz_image_free(&wanted);
	return result;
}

enum gz_result gz_stability_check_rays(struct gz_stability_bench *bench,
				       const struct gz_stability_check *check,
				       struct gz_stability_outcome *outcome)
{
	struct gz_image got = { 0 };
	uint8_t *steps = malloc((size_t)check->view.width * (size_t)check->view.height);
	enum gz_result result = steps ? GZ_OK : GZ_ERR_NO_MEM;
	if (result == GZ_OK)
		result = gz_stability_frame_at(bench, check->scene, &check->foveation, &check->view,
					       check->gaze, &got);
	if (result == GZ_OK)
		result = judge_frame(bench, check, &got, steps, outcome);
	gz_image_free(&got);
	free(steps);
	return result;
}

enum gz_result gz_stability_check_rules(struct gz_stability_bench *bench,
					const struct gz_stability_check *check,
					struct gz_stability_outcome *outcome)
{
	int rules[GZ_STABILITY_RULES_MAX];
	const int count = gz_stability_rules(bench, rules);
	enum gz_result result = GZ_OK;
	for (int i = 0; i < count && result == GZ_OK; i++) {
		struct gz_stability_check ruled = *check;
		ruled.foveation.step_rule = rules[i];
		result = gz_stability_check_rays(bench, &ruled, outcome);
	}
	return result;
}
