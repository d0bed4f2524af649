#include "bench/study/reference.h"

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

/* Of all that the picture depends on. */
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
static enum gz_result get(const struct gz_reference_request *request, const struct gz_log *log,
			  double rate, struct gz_image *image, bool *out_made)
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
		gz_warn(log, "%s: cannot keep a reference; it is made again where it is needed",
			request->cache);
	return result;
}

enum gz_result gz_reference_get(const struct gz_reference_request *request,
				const struct gz_log *log, struct gz_image *image,
				struct gz_image *half_step, double *out_db, bool *out_made)
{
	struct gz_map squared = { 0 };
	bool made = false;
	enum gz_result result = get(request, log, GZ_REFERENCE_RATE, image, &made);
	if (result == GZ_OK)
		result = get(request, log, 2.0 * GZ_REFERENCE_RATE, half_step, &made);
	if (result == GZ_OK)
		result = gz_squared_error(image, half_step, &squared);
	if (result == GZ_OK) {
		*out_db = gz_psnr_db(gz_map_mean(&squared));
		*out_made = made;
		if (*out_db < GZ_REFERENCE_LEAST_DB)
			gz_warn(log,
				"the converged picture of %dx%d is %.1f dB from one of half its "
				"step, not %d: errors smaller than that tell nothing",
				request->width, request->height, *out_db, GZ_REFERENCE_LEAST_DB);
	} else if (result != GZ_ERR_CANCELLED) {
		gz_err(log, "cannot make the converged picture of %dx%d: %s", request->width,
		       request->height, gz_result_text(result));
	}
	gz_map_free(&squared);
	return result;
}
