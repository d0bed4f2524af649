#include "render/renderer.h"

#include <math.h>
#include <string.h>

#include "render/cpu/cpu_renderer.h"
#include "render/gl/gl_renderer.h"

#define GZ_LOG_MODULE "render"

const struct gz_renderer_ops *const gz_backends[] = { &gz_gl_renderer_ops, &gz_cpu_renderer_ops,
						      NULL };

static const struct gz_renderer_ops *find_backend(const char *name)
{
	for (size_t i = 0; gz_backends[i]; i++)
		if (strcmp(gz_backends[i]->name, name) == 0)
			return gz_backends[i];
	return NULL;
}

/* gl where a GPU does its work, else cpu: it is faster than OpenGL on the same processor. */
static enum gz_result create_best(const struct gz_renderer_params *params, const struct gz_log *log,
				  struct gz_renderer **out_renderer)
{
	struct gz_renderer_params hardware = *params;
	hardware.gl_hardware_only = true;
	if (gz_gl_renderer_ops.create(&hardware, log, out_renderer) == GZ_OK)
		return GZ_OK;
	return gz_cpu_renderer_ops.create(params, log, out_renderer);
}

static enum gz_result refuse_backend(const char *backend, const struct gz_log *log)
{
	char names[128] = "auto";
	for (size_t i = 0; gz_backends[i]; i++) {
		strncat(names, ", ", sizeof names - strlen(names) - 1);
		strncat(names, gz_backends[i]->name, sizeof names - strlen(names) - 1);
	}
	gz_err(log, "no backend '%s': there are %s", backend, names);
	return GZ_ERR_NOT_FOUND;
}

enum gz_result gz_renderer_create(const char *backend, const struct gz_renderer_params *params,
				  const struct gz_log *log, struct gz_renderer **out_renderer)
{
	static const struct gz_renderer_params defaults = { 0 };
	params = params ? params : &defaults;
	if (!backend || strcmp(backend, "auto") == 0)
		return create_best(params, log, out_renderer);
	const struct gz_renderer_ops *ops = find_backend(backend);
	return ops ? ops->create(params, log, out_renderer) : refuse_backend(backend, log);
}

enum gz_result gz_renderer_check(const char *backend, const struct gz_renderer_params *params,
				 const struct gz_log *log)
{
	if (backend && strcmp(backend, "auto") != 0 && !find_backend(backend))
		return refuse_backend(backend, log);
	return params ? gz_cpu_renderer_check(params, log) : GZ_OK;
}

enum gz_result gz_renderer_set_volume(struct gz_renderer *renderer, const struct gz_volume *volume)
{
	return renderer->ops->set_volume(renderer, volume);
}

enum gz_result gz_renderer_set_transfer(struct gz_renderer *renderer,
					const struct gz_transfer *transfer)
{
	return renderer->ops->set_transfer(renderer, transfer);
}

enum gz_result gz_renderer_render(struct gz_renderer *renderer, const struct gz_camera *camera,
				  const struct gz_ray_params *rays, const struct gz_plan *plan,
				  struct gz_image *image, struct gz_frame_stats *out_stats)
{
	if (!gz_ray_params_valid(rays) || plan->layer_count < 1 ||
	    (!image && !renderer->ops->picture_texture))
		return GZ_ERR_INVAL;
	return renderer->ops->render(renderer, camera, rays, plan, image, out_stats);
}

unsigned gz_renderer_picture_texture(const struct gz_renderer *renderer)
{
	return renderer->ops->picture_texture ? renderer->ops->picture_texture(renderer) : 0;
}

const char *gz_renderer_describe(const struct gz_renderer *renderer)
{
	return renderer->ops->describe(renderer);
}

void gz_renderer_destroy(struct gz_renderer **renderer)
{
	if (!*renderer)
		return;
	(*renderer)->ops->destroy(*renderer);
	*renderer = NULL;
}
