/* The technique's drawer: a slicer, and what it shows. */
#include <stdlib.h>
#include <string.h>

#include "base/clock.h"
#include "render/slices/gl/gl_slicer.h"
#include "render/slices/slices_technique.h"

#define GZ_LOG_MODULE "slices"

struct slices_drawer {
	struct gz_drawer base;
	struct gz_gl_slicer *slicer;
	const struct gz_log *log;
	struct gz_object shown; /* no volume: nothing yet */
	double prepare_ms;      /* since the last picture */
};

static struct slices_drawer *slices_of(struct gz_drawer *drawer)
{
	return (struct slices_drawer *)drawer;
}

static const struct gz_gl_slicer *slicer_of(const struct gz_drawer *drawer)
{
	return ((const struct slices_drawer *)drawer)->slicer;
}

static enum gz_result check_object(const struct slices_drawer *self,
				   const struct gz_object *objects, size_t count)
{
	if (objects[0].mesh) {
		gz_err(self->log, "slices does not show meshes; take the technique isosurface");
		return GZ_ERR_UNSUPPORTED;
	}
	if (count != 1 || !objects[0].volume || !objects[0].transfer) {
		gz_err(self->log, "slices shows one volume in a picture; %zu objects are given",
		       count);
		return GZ_ERR_UNSUPPORTED;
	}
	return GZ_OK;
}

static enum gz_result slices_show(struct gz_drawer *drawer, const struct gz_object *objects,
				  size_t count)
{
	struct slices_drawer *self = slices_of(drawer);
	const struct gz_object *object = &objects[0];
	enum gz_result result = check_object(self, objects, count);
	if (result != GZ_OK)
		return result;
	const int64_t start_ns = gz_clock_now_ns();
	const bool same_volume = self->shown.volume == object->volume &&
				 self->shown.data_revision == object->data_revision;
	const bool same_transfer = same_volume && self->shown.transfer == object->transfer &&
				   self->shown.transfer_revision == object->transfer_revision;
	self->shown.volume = NULL; /* until all of it is set */
	if (!same_volume)
		result = gz_gl_slicer_set_volume(self->slicer, object->volume);
	if (result == GZ_OK && !same_transfer)
		result = gz_gl_slicer_set_transfer(self->slicer, object->transfer);
	if (result == GZ_OK)
		self->shown = *object;
	self->prepare_ms += gz_ns_to_ms(gz_clock_now_ns() - start_ns);
	return result;
}

static enum gz_result slices_draw(struct gz_drawer *drawer, const struct gz_shot *shot,
				  struct gz_image *image, struct gz_frame_stats *out_stats)
{
	struct slices_drawer *self = slices_of(drawer);
	const enum gz_result result = gz_gl_slicer_draw(self->slicer, shot, image, out_stats);
	if (result != GZ_OK)
		return result;
	if (out_stats)
		out_stats->prepare_ms += self->prepare_ms;
	self->prepare_ms = 0;
	return GZ_OK;
}

static bool slices_keeps_on_device(const struct gz_drawer *drawer, const struct gz_shot *shot)
{
	(void)shot;
	(void)drawer;
	return true;
}

static unsigned slices_picture_texture(const struct gz_drawer *drawer)
{
	return gz_gl_slicer_picture_texture(slicer_of(drawer));
}

static const char *slices_backend(const struct gz_drawer *drawer)
{
	(void)drawer;
	return gz_slices_technique.backends[0];
}

static const char *slices_describe(const struct gz_drawer *drawer)
{
	return gz_gl_slicer_describe(slicer_of(drawer));
}

static void slices_destroy(struct gz_drawer *drawer)
{
	struct slices_drawer *self = slices_of(drawer);
	gz_gl_slicer_destroy(&self->slicer);
	free(self);
}

static const struct gz_drawer_ops slices_ops = {
	.show = slices_show,
	.draw = slices_draw,
	.keeps_on_device = slices_keeps_on_device,
	.picture_texture = slices_picture_texture,
	.backend = slices_backend,
	.describe = slices_describe,
	.destroy = slices_destroy,
};

enum gz_result gz_slices_check(const char *backend, const struct gz_backend_params *params,
			       const struct gz_log *log)
{
	(void)params; /* threads and instruction sets are of other backends */
	if (!backend || strcmp(backend, "auto") == 0 ||
	    strcmp(backend, gz_slices_technique.backends[0]) == 0)
		return GZ_OK;
	gz_err(log, "slices has no backend '%s': it is drawn by OpenGL; take --backend gl",
	       backend);
	return GZ_ERR_NOT_FOUND;
}

enum gz_result gz_slices_create(const char *backend, const struct gz_backend_params *params,
				const struct gz_log *log, struct gz_drawer **out_drawer)
{
	static const struct gz_backend_params defaults = { 0 };
	enum gz_result result = gz_slices_check(backend, params, log);
	if (result != GZ_OK)
		return result;
	struct slices_drawer *self = calloc(1, sizeof *self);
	if (!self)
		return GZ_ERR_NO_MEM;
	self->base.ops = &slices_ops;
	self->log = log;
	result = gz_gl_slicer_create(params ? params : &defaults, log, &self->slicer);
	if (result != GZ_OK) {
		free(self);
		return result;
	}
	*out_drawer = &self->base;
	return GZ_OK;
}
