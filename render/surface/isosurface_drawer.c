/* The technique's drawer: a caster of surfaces. */
#include <stdlib.h>
#include <string.h>

#include "render/surface/cpu/surface_caster.h"
#include "render/surface/isosurface_technique.h"

#define GZ_LOG_MODULE "isosurface"

struct isosurface_drawer {
	struct gz_drawer base;
	struct gz_surface_caster *caster;
};

static struct gz_surface_caster *caster_of(const struct gz_drawer *drawer)
{
	return ((const struct isosurface_drawer *)drawer)->caster;
}

static enum gz_result isosurface_show(struct gz_drawer *drawer, const struct gz_object *objects,
				      size_t count)
{
	return gz_surface_caster_show(caster_of(drawer), objects, count);
}

static struct gz_surface_shot surface_shot_of(const struct gz_shot *shot)
{
	return (struct gz_surface_shot) {
		.camera = shot->camera,
		.rays = shot->settings,
		.plan = shot->plan,
		.hits = shot->hits,
	};
}

static enum gz_result isosurface_draw(struct gz_drawer *drawer, const struct gz_shot *shot,
				      struct gz_image *image, struct gz_frame_stats *out_stats)
{
	const struct gz_surface_shot surfaces = surface_shot_of(shot);
	return image ? gz_surface_caster_draw(caster_of(drawer), &surfaces, image, NULL, out_stats)
		     : GZ_ERR_INVAL;
}

static enum gz_result isosurface_cast_hits(struct gz_drawer *drawer, const struct gz_shot *shot,
					   struct gz_frame_stats *out_stats)
{
	const struct gz_surface_shot surfaces = surface_shot_of(shot);
	return gz_surface_caster_draw(caster_of(drawer), &surfaces, NULL, NULL, out_stats);
}

static bool isosurface_keeps_on_device(const struct gz_drawer *drawer)
{
	(void)drawer;
	return false;
}

static unsigned isosurface_picture_texture(const struct gz_drawer *drawer)
{
	(void)drawer;
	return 0;
}

static const char *isosurface_backend(const struct gz_drawer *drawer)
{
	(void)drawer;
	return gz_isosurface_technique.backends[0];
}

static const char *isosurface_describe(const struct gz_drawer *drawer)
{
	return gz_surface_caster_describe(caster_of(drawer));
}

static void isosurface_destroy(struct gz_drawer *drawer)
{
	struct isosurface_drawer *self = (struct isosurface_drawer *)drawer;
	gz_surface_caster_destroy(&self->caster);
	free(self);
}

static const struct gz_drawer_ops isosurface_ops = {
	.show = isosurface_show,
	.draw = isosurface_draw,
	.cast_hits = isosurface_cast_hits,
	.keeps_on_device = isosurface_keeps_on_device,
	.picture_texture = isosurface_picture_texture,
	.backend = isosurface_backend,
	.describe = isosurface_describe,
	.destroy = isosurface_destroy,
};

enum gz_result gz_isosurface_check(const char *backend, const struct gz_backend_params *params,
				   const struct gz_log *log)
{
	const bool known = !backend || strcmp(backend, "auto") == 0 ||
			   strcmp(backend, gz_isosurface_technique.backends[0]) == 0;
	if (!known) {
		gz_err(log, "isosurface has no backend '%s': there are auto, %s", backend,
		       gz_isosurface_technique.backends[0]);
		return GZ_ERR_NOT_FOUND;
	}
	return params ? gz_surface_caster_check(params, log) : GZ_OK;
}

enum gz_result gz_isosurface_create(const char *backend, const struct gz_backend_params *params,
				    const struct gz_log *log, struct gz_drawer **out_drawer)
{
	enum gz_result result = gz_isosurface_check(backend, params, log);
	if (result != GZ_OK)
		return result;
	struct isosurface_drawer *self = calloc(1, sizeof *self);
	if (!self)
		return GZ_ERR_NO_MEM;
	self->base.ops = &isosurface_ops;
	result = gz_surface_caster_create(params, log, &self->caster);
	if (result != GZ_OK) {
		free(self);
		return result;
	}
	*out_drawer = &self->base;
	return GZ_OK;
}
