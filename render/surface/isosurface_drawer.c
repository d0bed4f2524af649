/* The technique's drawer: a caster of rays or a rasteriser, and what it shows. */
#include <stdlib.h>
#include <string.h>

#include "render/raycast/shared/ray_params.h"
#include "render/surface/cpu/surface_caster.h"
#include "render/surface/gl/surface_raster.h"
#include "render/surface/isosurface_technique.h"

#define GZ_LOG_MODULE "isosurface"

static const char cpu_name[] = "cpu", gl_name[] = "gl";

/* The rasteriser makes pictures of its own. In those of several techniques rays meet surfaces, so
 * the drawer of gl has a caster, too, once it is needed. */
struct isosurface_drawer {
	struct gz_drawer base;
	const struct gz_log *log;
	struct gz_backend_params params;
	struct gz_surface_raster *raster; /* NULL: the backend is cpu */
	struct gz_surface_caster *caster; /* NULL: none yet */
	struct gz_object *objects;        /* shown */
	size_t count;
};

static struct isosurface_drawer *isosurface_of(struct gz_drawer *drawer)
{
	return (struct isosurface_drawer *)drawer;
}

static const struct isosurface_drawer *isosurface_read(const struct gz_drawer *drawer)
{
	return (const struct isosurface_drawer *)drawer;
}

static enum gz_result isosurface_show(struct gz_drawer *drawer, const struct gz_object *objects,
				      size_t count)
{
	struct isosurface_drawer *self = isosurface_of(drawer);
	struct gz_object *copy = malloc((count > 0 ? count : 1) * sizeof *copy);
	if (!copy)
		return GZ_ERR_NO_MEM;
	memcpy(copy, objects, count * sizeof *copy);
	enum gz_result result = GZ_OK;
	if (self->raster)
		result = gz_surface_raster_show(self->raster, objects, count);
	if (self->caster && result == GZ_OK)
		result = gz_surface_caster_show(self->caster, objects, count);
	if (result != GZ_OK) {
		free(copy);
		return result;
	}
	free(self->objects);
	self->objects = copy;
	self->count = count;
	return GZ_OK;
}

static struct gz_surface_shot surface_shot_of(const struct gz_shot *shot)
{
	return (struct gz_surface_shot) {
		.camera = shot->camera,
		.rays = shot->settings,
		.plan = shot->plan,
		.refined = shot->refined,
		.keeps_rays = shot->keeps_rays,
		.hits = shot->hits,
		.shades = shot->shades,
		.shade_count = shot->shade_count,
	};
}

/* Make the caster of a drawer whose backend is gl, and show it the objects. */
static enum gz_result add_caster(struct isosurface_drawer *self)
{
	if (self->caster)
		return GZ_OK;
	enum gz_result result = gz_surface_caster_create(&self->params, self->log, &self->caster);
	if (result == GZ_OK)
		result = gz_surface_caster_show(self->caster, self->objects, self->count);
	if (result != GZ_OK)
		gz_surface_caster_destroy(&self->caster);
	return result;
}

/* Whether the device draws a picture. Rays find surfaces in the voxels, and the processor casts
 * them; without Embree all are triangles. */
static bool draws_on_device(const struct isosurface_drawer *self, const struct gz_shot *shot)
{
	const struct gz_ray_params *rays = shot->settings;
	return self->raster &&
	       (rays->surface.source != GZ_SURFACE_VOXELS || !gz_surface_caster_present());
}

/* Rays refine plans, the rasteriser does not. Behind glass, neighbouring rays see different things
 * however near they are, so a few first rays tell nothing (docs/results.md). */
static double isosurface_bound_plan(struct gz_drawer *drawer, const struct gz_shot *shot,
				    struct gz_plan_request *request)
{
	const struct gz_ray_params *rays = shot->settings;
	request->refines = !draws_on_device(isosurface_of(drawer), shot) &&
			   rays->surface.material != GZ_MATERIAL_GLASS;
	return 0;
}

static enum gz_result isosurface_draw(struct gz_drawer *drawer, const struct gz_shot *shot,
				      struct gz_image *image, struct gz_frame_stats *out_stats)
{
	struct isosurface_drawer *self = isosurface_of(drawer);
	const struct gz_surface_shot surfaces = surface_shot_of(shot);
	if (draws_on_device(self, shot))
		return gz_surface_raster_draw(self->raster, &surfaces, image, NULL, out_stats);
	const enum gz_result result = image ? add_caster(self) : GZ_ERR_INVAL;
	return result == GZ_OK
		       ? gz_surface_caster_draw(self->caster, &surfaces, image, NULL, out_stats)
		       : result;
}

static enum gz_result isosurface_cast_hits(struct gz_drawer *drawer, const struct gz_shot *shot,
					   struct gz_frame_stats *out_stats)
{
	struct isosurface_drawer *self = isosurface_of(drawer);
	const struct gz_surface_shot surfaces = surface_shot_of(shot);
	const enum gz_result result = add_caster(self);
	return result == GZ_OK
		       ? gz_surface_caster_draw(self->caster, &surfaces, NULL, NULL, out_stats)
		       : result;
}

static enum gz_result isosurface_shade(struct gz_drawer *drawer, const struct gz_shot *shot,
				       struct gz_shade *out_shade)
{
	struct isosurface_drawer *self = isosurface_of(drawer);
	const struct gz_surface_shot surfaces = surface_shot_of(shot);
	const enum gz_result result = add_caster(self);
	return result == GZ_OK ? gz_surface_caster_shade(self->caster, &surfaces, out_shade)
			       : result;
}

static enum gz_result isosurface_pick(struct gz_drawer *drawer,
				      const struct gz_pick_request *request,
				      struct gz_pick *out_pick)
{
	struct isosurface_drawer *self = isosurface_of(drawer);
	const struct gz_surface_shot surfaces = {
		.camera = request->camera,
		.rays = request->settings,
	};
	/* A build without Embree says so once, when the drawer of cpu is asked for. */
	const enum gz_result result =
		gz_surface_caster_present() ? add_caster(self) : GZ_ERR_UNSUPPORTED;
	return result == GZ_OK ? gz_surface_caster_pick(self->caster, &surfaces, request, out_pick)
			       : result;
}

static bool isosurface_keeps_on_device(const struct gz_drawer *drawer, const struct gz_shot *shot)
{
	return draws_on_device(isosurface_read(drawer), shot);
}

/* The tree of the other's meshes is lost, and goes with it. */
static void isosurface_take_prepared(struct gz_drawer *drawer, struct gz_drawer *from)
{
	const struct isosurface_drawer *self = isosurface_of(drawer), *other = isosurface_of(from);
	if (self->raster && other->caster)
		gz_surface_raster_take(self->raster, gz_surface_caster_meshes(other->caster));
}

static unsigned isosurface_picture_texture(const struct gz_drawer *drawer)
{
	const struct isosurface_drawer *self = isosurface_read(drawer);
	return self->raster ? gz_surface_raster_picture(self->raster) : 0;
}

static const char *isosurface_backend(const struct gz_drawer *drawer)
{
	return isosurface_read(drawer)->raster ? gl_name : cpu_name;
}

static const char *isosurface_describe(const struct gz_drawer *drawer)
{
	const struct isosurface_drawer *self = isosurface_read(drawer);
	return self->raster ? gz_surface_raster_describe(self->raster)
			    : gz_surface_caster_describe(self->caster);
}

static void isosurface_destroy(struct gz_drawer *drawer)
{
	struct isosurface_drawer *self = isosurface_of(drawer);
	gz_surface_raster_destroy(&self->raster);
	gz_surface_caster_destroy(&self->caster);
	free(self->objects);
	free(self);
}

static const struct gz_drawer_ops isosurface_ops = {
	.show = isosurface_show,
	.bound_plan = isosurface_bound_plan,
	.draw = isosurface_draw,
	.cast_hits = isosurface_cast_hits,
	.shade = isosurface_shade,
	.pick = isosurface_pick,
	.take_prepared = isosurface_take_prepared,
	.keeps_on_device = isosurface_keeps_on_device,
	.picture_texture = isosurface_picture_texture,
	.backend = isosurface_backend,
	.describe = isosurface_describe,
	.destroy = isosurface_destroy,
};

/* Whether a backend, known or "auto", is gl. */
static bool takes_gl(const char *backend)
{
	if (!backend || strcmp(backend, "auto") == 0)
		return !gz_surface_caster_present();
	return strcmp(backend, gl_name) == 0;
}

enum gz_result gz_isosurface_check(const char *backend, const struct gz_backend_params *params,
				   const struct gz_log *log)
{
	static const struct gz_backend_params defaults = { 0 };
	const bool known = !backend || strcmp(backend, "auto") == 0 ||
			   gz_technique_has_backend(&gz_isosurface_technique, backend);
	if (!known) {
		gz_err(log, "isosurface has no backend '%s': there are auto, %s, %s", backend,
		       gl_name, cpu_name);
		return GZ_ERR_NOT_FOUND;
	}
	return takes_gl(backend) ? GZ_OK
				 : gz_surface_caster_check(params ? params : &defaults, log);
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
	self->log = log;
	if (params)
		self->params = *params;
	result = takes_gl(backend) ? gz_surface_raster_create(&self->params, log, &self->raster)
				   : gz_surface_caster_create(&self->params, log, &self->caster);
	if (result != GZ_OK) {
		free(self);
		return result;
	}
	*out_drawer = &self->base;
	return GZ_OK;
}
