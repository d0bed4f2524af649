/* The technique's drawer: a caster of rays or a rasteriser, and what it shows. Rays find what is at
 * a place, so the drawer of gl has a caster, too, once it is needed. */
#include <stdlib.h>
#include <string.h>

#include "render/illustration/cpu/illustrate_caster.h"
#include "render/illustration/gl/illustrate_raster.h"
#include "render/illustration/technique/illustrate_technique.h"
#include "render/raycast/shared/ray_params.h"

#define GZ_LOG_MODULE "illustrate"

static const char cpu_name[] = "cpu", gl_name[] = "gl";

struct illustrate_drawer {
	struct gz_drawer base;
	const struct gz_log *log;
	struct gz_backend_params params;
	struct gz_illustrate_raster *raster; /* NULL: the backend is cpu */
	struct gz_illustrate_caster *caster; /* NULL: none yet */
	struct gz_object *objects;           /* shown */
	size_t count;
};

static struct illustrate_drawer *illustrate_of(struct gz_drawer *drawer)
{
	return (struct illustrate_drawer *)drawer;
}

static const struct illustrate_drawer *illustrate_read(const struct gz_drawer *drawer)
{
	return (const struct illustrate_drawer *)drawer;
}

static enum gz_result illustrate_show(struct gz_drawer *drawer, const struct gz_object *objects,
				      size_t count)
{
	struct illustrate_drawer *self = illustrate_of(drawer);
	struct gz_object *copy = malloc((count > 0 ? count : 1) * sizeof *copy);
	if (!copy)
		return GZ_ERR_NO_MEM;
	memcpy(copy, objects, count * sizeof *copy);
	enum gz_result result = GZ_OK;
	if (self->raster)
		result = gz_illustrate_raster_show(self->raster, objects, count);
	if (self->caster && result == GZ_OK)
		result = gz_illustrate_caster_show(self->caster, objects, count);
	if (result != GZ_OK) {
		free(copy);
		return result;
	}
	free(self->objects);
	self->objects = copy;
	self->count = count;
	return GZ_OK;
}

/* The number of the object with a name; 0: none has it. */
static uint32_t find_named_object(const struct illustrate_drawer *self, const char *name)
{
	for (size_t i = 0; name[0] && i < self->count; i++)
		if (self->objects[i].name && strcmp(self->objects[i].name, name) == 0)
			return self->objects[i].id;
	return 0;
}

static enum gz_result illustrate_draw(struct gz_drawer *drawer, const struct gz_shot *shot,
				      struct gz_image *image, struct gz_frame_stats *out_stats)
{
	const struct illustrate_drawer *self = illustrate_read(drawer);
	const struct gz_ray_params *rays = shot->settings;
	if ((!image && !self->raster) || !gz_ray_params_valid(rays))
		return GZ_ERR_INVAL;
	const struct gz_illustrate_shot illustrated = {
		.camera = shot->camera,
		.plan = shot->plan,
		.look = &rays->illustration,
		.clip = &rays->clip,
		.isovalue = rays->surface.isovalue,
		.chosen_id = find_named_object(self, rays->illustration.chosen_object),
	};
	if (self->raster)
		return gz_illustrate_raster_draw(self->raster, &illustrated, image, NULL,
						 out_stats);
	return gz_illustrate_caster_draw(self->caster, &illustrated, image, NULL, out_stats);
}

/* Make the caster of a drawer whose backend is gl, and show it the objects. */
static enum gz_result add_caster(struct illustrate_drawer *self)
{
	if (self->caster)
		return GZ_OK;
	enum gz_result result =
		gz_illustrate_caster_create(&self->params, self->log, &self->caster);
	if (result == GZ_OK)
		result = gz_illustrate_caster_show(self->caster, self->objects, self->count);
	if (result != GZ_OK)
		gz_illustrate_caster_destroy(&self->caster);
	return result;
}

static enum gz_result illustrate_pick(struct gz_drawer *drawer,
				      const struct gz_pick_request *request,
				      struct gz_pick *out_pick)
{
	struct illustrate_drawer *self = illustrate_of(drawer);
	const struct gz_ray_params *rays = request->settings;
	if (!gz_ray_params_valid(rays))
		return GZ_ERR_INVAL;
	/* A build without Embree says so once, when the drawer of cpu is asked for. */
	if (!gz_illustrate_caster_present())
		return GZ_ERR_UNSUPPORTED;
	const enum gz_result result = add_caster(self);
	if (result != GZ_OK)
		return result;
	const struct gz_illustrate_shot illustrated = {
		.camera = request->camera,
		.look = &rays->illustration,
		.clip = &rays->clip,
		.isovalue = rays->surface.isovalue,
	};
	return gz_illustrate_caster_pick(self->caster, &illustrated, request, out_pick);
}

static enum gz_result illustrate_print(struct gz_drawer *drawer, const struct gz_print *print)
{
	const struct illustrate_drawer *self = illustrate_of(drawer);
	return self->raster ? gz_illustrate_raster_print(self->raster, print)
			    : gz_illustrate_caster_print(self->caster, print);
}

static bool illustrate_keeps_on_device(const struct gz_drawer *drawer, const struct gz_shot *shot)
{
	(void)shot;
	return illustrate_read(drawer)->raster;
}

static unsigned illustrate_picture_texture(const struct gz_drawer *drawer)
{
	const struct illustrate_drawer *self = illustrate_read(drawer);
	return self->raster ? gz_illustrate_raster_picture(self->raster) : 0;
}

static const char *illustrate_backend(const struct gz_drawer *drawer)
{
	return illustrate_read(drawer)->raster ? gl_name : cpu_name;
}

static const char *illustrate_describe(const struct gz_drawer *drawer)
{
	const struct illustrate_drawer *self = illustrate_read(drawer);
	return self->raster ? gz_illustrate_raster_describe(self->raster)
			    : gz_illustrate_caster_describe(self->caster);
}

static void illustrate_destroy(struct gz_drawer *drawer)
{
	struct illustrate_drawer *self = illustrate_of(drawer);
	gz_illustrate_raster_destroy(&self->raster);
	gz_illustrate_caster_destroy(&self->caster);
	free(self->objects);
	free(self);
}

static const struct gz_drawer_ops illustrate_ops = {
	.show = illustrate_show,
	.draw = illustrate_draw,
	.pick = illustrate_pick,
	.print = illustrate_print,
	.keeps_on_device = illustrate_keeps_on_device,
	.picture_texture = illustrate_picture_texture,
	.backend = illustrate_backend,
	.describe = illustrate_describe,
	.destroy = illustrate_destroy,
};

/* Whether a backend, known or "auto", is gl. */
static bool takes_gl(const char *backend)
{
	if (!backend || strcmp(backend, "auto") == 0)
		return !gz_illustrate_caster_present();
	return strcmp(backend, gl_name) == 0;
}

enum gz_result gz_illustrate_check(const char *backend, const struct gz_backend_params *params,
				   const struct gz_log *log)
{
	static const struct gz_backend_params defaults = { 0 };
	const bool known = !backend || strcmp(backend, "auto") == 0 ||
			   gz_technique_has_backend(&gz_illustrate_technique, backend);
	if (!known) {
		gz_err(log, "illustrate has no backend '%s': there are auto, %s, %s", backend,
		       gl_name, cpu_name);
		return GZ_ERR_NOT_FOUND;
	}
	return takes_gl(backend) ? GZ_OK
				 : gz_illustrate_caster_check(params ? params : &defaults, log);
}

enum gz_result gz_illustrate_create(const char *backend, const struct gz_backend_params *params,
				    const struct gz_log *log, struct gz_drawer **out_drawer)
{
	enum gz_result result = gz_illustrate_check(backend, params, log);
	if (result != GZ_OK)
		return result;
	struct illustrate_drawer *self = calloc(1, sizeof *self);
	if (!self)
		return GZ_ERR_NO_MEM;
	self->base.ops = &illustrate_ops;
	self->log = log;
	if (params)
		self->params = *params;
	result = takes_gl(backend) ? gz_illustrate_raster_create(params, log, &self->raster)
				   : gz_illustrate_caster_create(params, log, &self->caster);
	if (result != GZ_OK) {
		free(self);
		return result;
	}
	*out_drawer = &self->base;
	return GZ_OK;
}
