#include "bench/study/errors.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/command.h"
#include "bench/metrics/metrics.h"
#include "bench/study/hash.h"

#define GZ_LOG_MODULE "reference"

/* Shared by the threads that make weights: part 0 is the fovea, part 1 the eye's acuity. */
struct weighing {
	struct gz_error_weights *weights;
	const struct gz_display *display;
	struct gz_point gaze;
	int width, height;
	enum gz_result results[2];
};

static void weigh_part(void *user, size_t part, int worker)
{
	struct weighing *weighing = user;
	struct gz_error_weights *weights = weighing->weights;
	static const double fovea_deg[2] = { 0, GZ_FOVEA_DEG };
	(void)worker;
	weighing->results[part] =
		part == 0 ? gz_weights_ring(weighing->display, weighing->gaze, weighing->width,
					    weighing->height, fovea_deg, &weights->foveal)
			  : gz_weights_acuity(weighing->display, weighing->gaze, weighing->width,
					      weighing->height, &weights->perceived);
}

/* Cut off the edges that SSIM's window does not reach. */
static enum gz_result crop_to_windows(const struct gz_map *map, struct gz_map *out_map)
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
	gz_workers_run(workers, weigh_part, &weighing, 2);
	for (int i = 0; i < 2; i++)
		if (weighing.results[i] != GZ_OK)
			return weighing.results[i];
	weights->any_foveal = gz_map_mean(&weights->foveal) > 0;
	enum gz_result result = crop_to_windows(&weights->foveal, &weights->foveal_ssim);
	if (result == GZ_OK)
		result = crop_to_windows(&weights->perceived, &weights->perceived_ssim);
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

/* ---- the converged picture ---- */

const char *gz_reference_cache(const char *given, char room[GZ_PATH_SIZE])
{
	if (given[0])
		return given;
	const char *cache = getenv("XDG_CACHE_HOME"), *home = getenv("HOME");
	int length = -1;
	/* Relative ones are to be ignored, says the specification. */
	if (cache && cache[0] == '/')
		length = snprintf(room, GZ_PATH_SIZE, "%s/gazecast/references", cache);
	else if (home && home[0] == '/')
		length = snprintf(room, GZ_PATH_SIZE, "%s/.cache/gazecast/references", home);
	return length > 0 && length < GZ_PATH_SIZE ? room : NULL;
}

struct gz_ray_params gz_reference_rays(const struct gz_ray_params *rays, double rate)
{
	struct gz_ray_params converged = *rays;
	converged.ray_sampling_rate = rate;
	converged.integration = GZ_INTEGRATION_SAMPLED;
	converged.early_termination = false;
	converged.levels = false;
	converged.jitter = 0;
	return converged;
}

/* Hash of all that the picture depends on. */
static enum gz_result name_of(const struct gz_reference_request *request,
			      const struct gz_ray_params *rays, char out_hex[GZ_STUDY_HASH_SIZE])
{
	const struct gz_camera *camera = request->camera;
	struct gz_hash *hash = NULL;
	const enum gz_result result = gz_hash_begin(&hash);
	if (result != GZ_OK)
		return result;
	gz_hash_add_text(hash, "gazecast reference 1");
	gz_hash_add_text(hash, request->program);
	gz_hash_add_text(hash, request->data_hash);
	for (int axis = 0; axis < 3; axis++) {
		gz_hash_add_number(hash, camera->eye[axis]);
		gz_hash_add_number(hash, camera->look_at[axis]);
		gz_hash_add_number(hash, camera->up[axis]);
	}
	gz_hash_add_number(hash, camera->projection);
	gz_hash_add_number(hash, camera->projection == GZ_PROJECTION_PERSPECTIVE ? camera->fov_deg
										 : camera->height);
	gz_hash_add_number(hash, request->width);
	gz_hash_add_number(hash, request->height);
	gz_hash_add_rays(hash, rays);
	return gz_hash_end(&hash, out_hex);
}

/* mkdir -p */
static bool make_folders(const char *folder)
{
	char path[GZ_PATH_SIZE];
	snprintf(path, sizeof path, "%s", folder);
	for (char *slash = strchr(path + 1, '/'); slash; slash = strchr(slash + 1, '/')) {
		*slash = '\0';
		if (mkdir(path, 0777) != 0 && errno != EEXIST)
			return false;
		*slash = '/';
	}
	return mkdir(path, 0777) == 0 || errno == EEXIST;
}

static enum gz_result render_converged(const struct gz_reference_request *request, double rate,
				       struct gz_image *image)
{
	const struct gz_ray_params rays = gz_reference_rays(request->rays, rate);
	struct gz_foveation foveation = gz_foveation_full();
	foveation.step_rule = GZ_STEP_NONE;
	const struct gz_picture_request picture = {
		.camera = request->camera,
		.settings = &rays,
		.foveation = &foveation,
		.display = request->display,
		.focus = gz_focus_at((struct gz_point) { 0.5F, 0.5F }),
		.width = request->width,
		.height = request->height,
		.image = image,
	};
	struct gz_image *made;
	return gz_picture_make(request->maker, &picture, &made, NULL);
}

/* A picture of the cache, or a new one. */
static enum gz_result get_picture(const struct gz_reference_request *request,
				  const struct gz_log *log, double rate, struct gz_image *image,
				  bool *out_made)
{
	const struct gz_ray_params rays = gz_reference_rays(request->rays, rate);
	char hex[GZ_STUDY_HASH_SIZE], path[GZ_PATH_SIZE + GZ_STUDY_HASH_SIZE + 8];
	enum gz_result result = name_of(request, &rays, hex);
	if (result != GZ_OK)
		return result;
	if (request->cache) {
		snprintf(path, sizeof path, "%s/%s.png", request->cache, hex);
		if (access(path, R_OK) == 0 && gz_image_read_png(path, log, image) == GZ_OK &&
		    image->width == request->width && image->height == request->height)
			return GZ_OK;
	}
	if (gz_command_interrupted())
		return GZ_ERR_CANCELLED;
	*out_made = true;
	result = render_converged(request, rate, image);
	if (result == GZ_OK && request->cache &&
	    (!make_folders(request->cache) || gz_image_write_png(image, path, log) != GZ_OK))
		gz_warn(log, "%s: cannot keep a reference; it is made again when needed",
			request->cache);
	return result;
}

enum gz_result gz_reference_get(const struct gz_reference_request *request,
				const struct gz_log *log, struct gz_image *image,
				struct gz_image *half_step, double *out_db, bool *out_made)
{
	struct gz_map squared = { 0 };
	bool made = false;
	enum gz_result result = get_picture(request, log, GZ_REFERENCE_RATE, image, &made);
	if (result == GZ_OK)
		result = get_picture(request, log, 2.0 * GZ_REFERENCE_RATE, half_step, &made);
	if (result == GZ_OK)
		result = gz_squared_error(image, half_step, &squared);
	if (result == GZ_OK) {
		*out_db = gz_psnr_db(gz_map_mean(&squared));
		*out_made = made;
		if (*out_db < GZ_REFERENCE_LEAST_DB)
			gz_warn(log,
				"the converged picture of %dx%d is %.1f dB from one of half its "
				"step, not %d: smaller errors are meaningless",
				request->width, request->height, *out_db, GZ_REFERENCE_LEAST_DB);
	} else if (result != GZ_ERR_CANCELLED) {
		gz_err(log, "cannot make the converged picture of %dx%d: %s", request->width,
		       request->height, gz_result_text(result));
	}
	gz_map_free(&squared);
	return result;
}
