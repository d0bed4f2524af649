#include "render/raycast/shared/raycaster.h"

#include <math.h>
#include <string.h>

#include "render/raycast/cpu/cpu_raycaster.h"
#include "render/raycast/gl/gl_raycaster.h"

#define GZ_LOG_MODULE "render"

const struct gz_raycaster_ops *const gz_raycaster_backends[] = { &gz_gl_raycaster_ops,
								 &gz_cpu_raycaster_ops, NULL };

static const struct gz_raycaster_ops *find_backend(const char *name)
{
	for (size_t i = 0; gz_raycaster_backends[i]; i++)
		if (strcmp(gz_raycaster_backends[i]->name, name) == 0)
			return gz_raycaster_backends[i];
	return NULL;
}

/* gl where a GPU does its work, else cpu: it is faster than OpenGL on the same processor. */
static enum gz_result create_best(const struct gz_backend_params *params, const struct gz_log *log,
				  struct gz_raycaster **out_raycaster)
{
	struct gz_backend_params hardware = *params;
	hardware.gl_hardware_only = true;
	if (gz_gl_raycaster_ops.create(&hardware, log, out_raycaster) == GZ_OK)
		return GZ_OK;
	return gz_cpu_raycaster_ops.create(params, log, out_raycaster);
}

static enum gz_result refuse_backend(const char *backend, const struct gz_log *log)
{
	char names[128] = "auto";
	for (size_t i = 0; gz_raycaster_backends[i]; i++) {
		strncat(names, ", ", sizeof names - strlen(names) - 1);
		strncat(names, gz_raycaster_backends[i]->name, sizeof names - strlen(names) - 1);
	}
	gz_err(log, "no backend '%s': there are %s", backend, names);
	return GZ_ERR_NOT_FOUND;
}

enum gz_result gz_raycaster_create(const char *backend, const struct gz_backend_params *params,
				   const struct gz_log *log, struct gz_raycaster **out_raycaster)
{
	static const struct gz_backend_params defaults = { 0 };
	params = params ? params : &defaults;
	if (!backend || strcmp(backend, "auto") == 0)
		return create_best(params, log, out_raycaster);
	const struct gz_raycaster_ops *ops = find_backend(backend);
	return ops ? ops->create(params, log, out_raycaster) : refuse_backend(backend, log);
}

enum gz_result gz_raycaster_check(const char *backend, const struct gz_backend_params *params,
				  const struct gz_log *log)
{
	if (backend && strcmp(backend, "auto") != 0 && !find_backend(backend))
		return refuse_backend(backend, log);
	return params ? gz_cpu_raycaster_check(params, log) : GZ_OK;
}

enum gz_result gz_raycaster_set_volume(struct gz_raycaster *raycaster,
				       const struct gz_volume *volume)
{
	return raycaster->ops->set_volume(raycaster, volume);
}

enum gz_result gz_raycaster_set_transfer(struct gz_raycaster *raycaster,
					 const struct gz_transfer *transfer)
{
	return raycaster->ops->set_transfer(raycaster, transfer);
}

enum gz_result gz_raycaster_render(struct gz_raycaster *raycaster, const struct gz_camera *camera,
				   const struct gz_ray_params *rays, const struct gz_plan *plan,
				   struct gz_image *image, struct gz_frame_stats *out_stats)
{
	if (!gz_ray_params_valid(rays) || plan->layer_count < 1 ||
	    (!image && !raycaster->ops->picture_texture))
		return GZ_ERR_INVAL;
	return raycaster->ops->render(raycaster, camera, rays, plan, image, out_stats);
}

unsigned gz_raycaster_picture_texture(const struct gz_raycaster *raycaster)
{
	return raycaster->ops->picture_texture ? raycaster->ops->picture_texture(raycaster) : 0;
}

const char *gz_raycaster_describe(const struct gz_raycaster *raycaster)
{
	return raycaster->ops->describe(raycaster);
}

void gz_raycaster_destroy(struct gz_raycaster **raycaster)
{
	if (!*raycaster)
		return;
	(*raycaster)->ops->destroy(*raycaster);
	*raycaster = NULL;
}
