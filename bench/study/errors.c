#include "bench/study/errors.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* What the threads share when weights are made: part 0 is the fovea, part 1 the eye's acuity. */
struct weighing {
	struct gz_error_weights *weights;
	const struct gz_display *display;
	struct gz_point gaze;
	int width, height;
	enum gz_result results[2];
};

static void weigh(void *user, size_t part, int worker)
{
	struct weighing *weighing = user;
	struct gz_error_weights *weights = weighing->weights;
	(void)worker;
	weighing->results[part] =
		part == 0 ? gz_weights_ring(weighing->display, weighing->gaze, weighing->width,
					    weighing->height, 0, GZ_FOVEA_DEG, &weights->foveal)
			  : gz_weights_acuity(weighing->display, weighing->gaze, weighing->width,
					      weighing->height, &weights->perceived);
}

/* Leave out what is nearer to an edge than SSIM's window reaches. */
static enum gz_result crop(const struct gz_map *map, struct gz_map *out_map)
{
	enum { RADIUS = 5 }; /* GZ_SSIM_GAUSSIAN */
	const int width = map->width - 2 * RADIUS, height = map->height - 2 * RADIUS;
	const enum gz_result result = gz_map_resize(out_map, width, height);
	if (result != GZ_OK)
		return result;
	for (int y = 0; y < height; y++)
		memcpy(out_map->values + (size_t)y * (size_t)width,
		       map->values + (size_t)(y + RADIUS) * (size_t)map->width + RADIUS,
		       (size_t)width * sizeof *map->values);
	return GZ_OK;
}

enum gz_result gz_error_weights_make(struct gz_error_weights *weights,
				     const struct gz_display *display, struct gz_point gaze,
				     int width, int height, struct gz_workers *workers)
{
	struct weighing weighing = { weights, display, gaze, width, height, { GZ_OK, GZ_OK } };
	gz_workers_run(workers, weigh, &weighing, 2);
	for (int i = 0; i < 2; i++)
		if (weighing.results[i] != GZ_OK)
			return weighing.results[i];
	weights->any_foveal = gz_map_mean(&weights->foveal) > 0;
	enum gz_result result = crop(&weights->foveal, &weights->foveal_ssim);
	if (result == GZ_OK)
		result = crop(&weights->perceived, &weights->perceived_ssim);
	/* Pictures smaller than the window have no SSIM. */
	return result == GZ_ERR_INVAL ? GZ_OK : result;
}

enum gz_result gz_error_maps_make(struct gz_error_maps *maps, const struct gz_image *reference,
				  const struct gz_image *test, double px_per_deg,
				  struct gz_workers *workers)
{
	enum gz_result result = gz_squared_error(reference, test, &maps->squared);
	if (result == GZ_OK)
		result = gz_flip(reference, test, px_per_deg, workers, &maps->flip);
	if (result != GZ_OK)
		return result;
	result = gz_ssim(reference, test, GZ_SSIM_GAUSSIAN, workers, &maps->ssim);
	maps->has_ssim = result == GZ_OK;
	return result == GZ_ERR_INVAL ? GZ_OK : result;
}

static double foveal_mean(const struct gz_map *map, const struct gz_map *foveal, bool any)
{
	return any ? gz_map_weighted_mean(map, foveal) : NAN;
}

struct gz_study_errors gz_error_maps_weigh(const struct gz_error_maps *maps,
					   const struct gz_error_weights *weights)
{
	const bool any = weights->any_foveal;
	struct gz_study_errors errors = gz_study_errors_unmeasured();
	errors.psnr_db = gz_psnr_db(gz_map_mean(&maps->squared));
	if (any)
		errors.foveal_psnr_db =
			gz_psnr_db(gz_map_weighted_mean(&maps->squared, &weights->foveal));
	errors.perceived_psnr_db =
		gz_psnr_db(gz_map_weighted_mean(&maps->squared, &weights->perceived));
	errors.flip = gz_map_mean(&maps->flip);
	errors.foveal_flip = foveal_mean(&maps->flip, &weights->foveal, any);
	errors.perceived_flip = gz_map_weighted_mean(&maps->flip, &weights->perceived);
	if (!maps->has_ssim)
		return errors;
	errors.ssim = gz_map_mean(&maps->ssim);
	errors.foveal_ssim = foveal_mean(&maps->ssim, &weights->foveal_ssim,
					 any && gz_map_mean(&weights->foveal_ssim) > 0);
	errors.perceived_ssim = gz_map_weighted_mean(&maps->ssim, &weights->perceived_ssim);
	return errors;
}

struct gz_study_errors gz_errors_none(const struct gz_error_weights *weights, bool has_ssim)
{
	const bool any = weights->any_foveal;
	const bool any_ssim = any && has_ssim && gz_map_mean(&weights->foveal_ssim) > 0;
	return (struct gz_study_errors) {
		.psnr_db = INFINITY,
		.foveal_psnr_db = any ? INFINITY : NAN,
		.perceived_psnr_db = INFINITY,
		.ssim = has_ssim ? 1 : NAN,
		.foveal_ssim = any_ssim ? 1 : NAN,
		.perceived_ssim = has_ssim ? 1 : NAN,
		.flip = 0,
		.foveal_flip = any ? 0 : NAN,
		.perceived_flip = 0,
	};
}

enum gz_result gz_errors_change(const struct gz_image *before, const struct gz_image *after,
				const struct gz_error_weights *weights, struct gz_map *scratch,
				double *out_change)
{
	if (before->width != after->width || before->height != after->height ||
	    before->width != weights->perceived.width ||
	    before->height != weights->perceived.height)
		return GZ_ERR_INVAL;
	const enum gz_result result = gz_map_resize(scratch, before->width, before->height);
	if (result != GZ_OK)
		return result;
	const size_t count = (size_t)before->width * (size_t)before->height;
	for (size_t i = 0; i < count; i++) {
		const uint8_t *a = before->pixels + 4 * i, *b = after->pixels + 4 * i;
		const int sum = abs(a[0] - b[0]) + abs(a[1] - b[1]) + abs(a[2] - b[2]);
		scratch->values[i] = (float)sum / 3;
	}
	*out_change = gz_map_weighted_mean(scratch, &weights->perceived);
	return GZ_OK;
}

void gz_error_maps_free(struct gz_error_maps *maps)
{
	gz_map_free(&maps->squared);
	gz_map_free(&maps->ssim);
	gz_map_free(&maps->flip);
	maps->has_ssim = false;
}

void gz_error_weights_free(struct gz_error_weights *weights)
{
	gz_map_free(&weights->foveal);
	gz_map_free(&weights->perceived);
	gz_map_free(&weights->foveal_ssim);
	gz_map_free(&weights->perceived_ssim);
	weights->any_foveal = false;
}
