#include "render/raycast/raycast.h"

#include <stdlib.h>
#include <string.h>

#include "base/clock.h"
#include "render/raycast/cpu/cpu_raycaster.h"
#include "render/raycast/gl/gl_raycaster.h"
#include "render/raycast/shared/detail.h"
#include "render/raycast/shared/raycaster.h"
#include "render/raycast/shared/step_bound.h"

#define GZ_LOG_MODULE "raycast"

const struct gz_raycaster_ops *const gz_raycaster_backends[] = { &gz_gl_raycaster_ops,
								 &gz_cpu_raycaster_ops, NULL };

static const struct gz_raycaster_ops *find_raycaster_backend(const char *name)
{
	for (size_t i = 0; gz_raycaster_backends[i]; i++)
		if (strcmp(gz_raycaster_backends[i]->name, name) == 0)
			return gz_raycaster_backends[i];
	return NULL;
}

/* gl if a GPU runs it, else cpu, which is faster than OpenGL in software. */
static enum gz_result create_best_raycaster(const struct gz_backend_params *params,
					    const struct gz_log *log,
					    struct gz_raycaster **out_raycaster)
{
	struct gz_backend_params hardware = *params;
	hardware.gl_hardware_only = true;
	if (gz_gl_raycaster_ops.create(&hardware, log, out_raycaster) == GZ_OK)
		return GZ_OK;
	return gz_cpu_raycaster_ops.create(params, log, out_raycaster);
}

static enum gz_result refuse_unknown_backend(const char *backend, const struct gz_log *log)
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
		return create_best_raycaster(params, log, out_raycaster);
	const struct gz_raycaster_ops *ops = find_raycaster_backend(backend);
	return ops ? ops->create(params, log, out_raycaster) : refuse_unknown_backend(backend, log);
}

enum gz_result gz_raycaster_check(const char *backend, const struct gz_backend_params *params,
				  const struct gz_log *log)
{
	if (backend && strcmp(backend, "auto") != 0 && !find_raycaster_backend(backend))
		return refuse_unknown_backend(backend, log);
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

enum gz_result gz_raycaster_draw(struct gz_raycaster *raycaster, const struct gz_shot *shot,
				 struct gz_image *image, struct gz_frame_stats *out_stats)
{
	if (!gz_ray_params_valid(shot->settings) || shot->plan->layer_count < 1 ||
	    (!image && !raycaster->ops->picture_texture))
		return GZ_ERR_INVAL;
	return raycaster->ops->draw(raycaster, shot, image, out_stats);
}

enum gz_result gz_raycaster_shade(struct gz_raycaster *raycaster, const struct gz_shot *shot,
				  struct gz_shade *out_shade)
{
	const struct gz_ray_params *rays = shot->settings;
	if (!gz_ray_params_valid(rays))
		return GZ_ERR_INVAL;
	if (rays->light.shadow_steps > 0)
		return raycaster->ops->shade(raycaster, shot, out_shade);
	*out_shade = (struct gz_shade) { 0 };
	return GZ_OK;
}

enum gz_result gz_raycaster_render(struct gz_raycaster *raycaster, const struct gz_camera *camera,
				   const struct gz_ray_params *rays, const struct gz_plan *plan,
				   struct gz_image *image, struct gz_frame_stats *out_stats)
{
	const struct gz_shot shot = { .camera = camera, .settings = rays, .plan = plan };
	return gz_raycaster_draw(raycaster, &shot, image, out_stats);
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

/* The technique's drawer: a ray caster, and what it shows. */
struct raycast_drawer {
	struct gz_drawer base;
	struct gz_raycaster *raycaster;
	const struct gz_log *log;
	struct gz_object shown; /* no volume: nothing yet */
	double prepare_ms;      /* since the last picture */
	struct gz_step_bound step_bound;
};

static struct raycast_drawer *raycast_of(struct gz_drawer *drawer)
{
	return (struct raycast_drawer *)drawer;
}

static void warn_narrow_range(const struct gz_object *object, const struct gz_log *log)
{
	const struct gz_transfer *transfer = object->transfer;
	if (!gz_transfer_range_divides(transfer, object->volume))
		gz_warn(log,
			"the transfer function's range %g to %g is too narrow for the volume's "
			"values in single precision: it is shown as a step; widen it",
			transfer->range[0], transfer->range[1]);
}

static enum gz_result raycast_show(struct gz_drawer *drawer, const struct gz_object *objects,
				   size_t count)
{
	struct raycast_drawer *self = raycast_of(drawer);
	const struct gz_object *object = &objects[0];
	if (object->mesh) {
		gz_err(self->log, "raycast does not show meshes; take the technique isosurface");
		return GZ_ERR_UNSUPPORTED;
	}
	if (count != 1 || !object->volume || !object->transfer) {
		gz_err(self->log, "raycast shows one volume in a picture; %zu objects are given",
		       count);
		return GZ_ERR_UNSUPPORTED;
	}
	const int64_t start_ns = gz_clock_now_ns();
	const bool same_volume = self->shown.volume == object->volume &&
				 self->shown.data_revision == object->data_revision;
	const bool same_transfer = same_volume && self->shown.transfer == object->transfer &&
				   self->shown.transfer_revision == object->transfer_revision;
	const bool new_function = self->shown.transfer != object->transfer ||
				  self->shown.transfer_revision != object->transfer_revision;
	enum gz_result result = GZ_OK;
	self->shown.volume = NULL; /* until all of it is set */
	if (!same_volume) {
		gz_step_bound_forget_volume(&self->step_bound);
		result = gz_raycaster_set_volume(self->raycaster, object->volume);
	}
	if (result == GZ_OK && !same_transfer)
		result = gz_raycaster_set_transfer(self->raycaster, object->transfer);
	if (result == GZ_OK && new_function)
		warn_narrow_range(object, self->log);
	if (result == GZ_OK) {
		gz_step_bound_set_function(&self->step_bound, object->transfer);
		self->shown = *object;
	}
	self->prepare_ms += gz_ns_to_ms(gz_clock_now_ns() - start_ns);
	return result;
}

static double raycast_bound_plan(struct gz_drawer *drawer, const struct gz_shot *shot,
				 struct gz_plan_request *request)
{
	struct raycast_drawer *self = raycast_of(drawer);
	const struct gz_volume *volume = self->shown.volume;
	request->refines = volume && self->raycaster->ops->refines(self->raycaster);
	if (!volume || request->height <= 0) /* gz_plan_update() refuses those */
		return 0;
	request->steps_per_px =
		gz_detail_steps_per_px(volume, shot->camera, shot->settings, request->height);
	return gz_step_bound_plan(&self->step_bound, volume, shot->settings, self->log, request);
}

static enum gz_result raycast_draw(struct gz_drawer *drawer, const struct gz_shot *shot,
				   struct gz_image *image, struct gz_frame_stats *out_stats)
{
	struct raycast_drawer *self = raycast_of(drawer);
	const enum gz_result result = gz_raycaster_draw(self->raycaster, shot, image, out_stats);
	if (result == GZ_OK && out_stats)
		out_stats->prepare_ms += self->prepare_ms;
	if (result == GZ_OK)
		self->prepare_ms = 0;
	return result;
}

static enum gz_result raycast_shade(struct gz_drawer *drawer, const struct gz_shot *shot,
				    struct gz_shade *out_shade)
{
	return gz_raycaster_shade(raycast_of(drawer)->raycaster, shot, out_shade);
}

static unsigned raycast_picture_texture(const struct gz_drawer *drawer)
{
	return gz_raycaster_picture_texture(((const struct raycast_drawer *)drawer)->raycaster);
}

static bool raycast_keeps_on_device(const struct gz_drawer *drawer, const struct gz_shot *shot)
{
	(void)shot;
	return ((const struct raycast_drawer *)drawer)->raycaster->ops->picture_texture != NULL;
}

static const char *raycast_backend(const struct gz_drawer *drawer)
{
	return ((const struct raycast_drawer *)drawer)->raycaster->ops->name;
}

static const char *raycast_describe(const struct gz_drawer *drawer)
{
	return gz_raycaster_describe(((const struct raycast_drawer *)drawer)->raycaster);
}

static void raycast_destroy(struct gz_drawer *drawer)
{
	struct raycast_drawer *self = raycast_of(drawer);
	gz_raycaster_destroy(&self->raycaster);
	gz_step_bound_free(&self->step_bound);
	free(self);
}

static const struct gz_drawer_ops raycast_ops = {
	.show = raycast_show,
	.bound_plan = raycast_bound_plan,
	.draw = raycast_draw,
	.shade = raycast_shade,
	.keeps_on_device = raycast_keeps_on_device,
	.picture_texture = raycast_picture_texture,
	.backend = raycast_backend,
	.describe = raycast_describe,
	.destroy = raycast_destroy,
};

static enum gz_result raycast_create(const char *backend, const struct gz_backend_params *params,
				     const struct gz_log *log, struct gz_drawer **out_drawer)
{
	struct raycast_drawer *self = calloc(1, sizeof *self);
	if (!self)
		return GZ_ERR_NO_MEM;
	self->base.ops = &raycast_ops;
	self->log = log;
	const enum gz_result result = gz_raycaster_create(backend, params, log, &self->raycaster);
	if (result != GZ_OK) {
		free(self);
		return result;
	}
	*out_drawer = &self->base;
	return GZ_OK;
}

static size_t raycast_bind(void *settings, struct gz_option_binding *out_bindings, size_t room)
{
	struct gz_option_binding bindings[GZ_RAY_BINDINGS];
	gz_ray_params_bind(settings, bindings);
	const size_t count = room < GZ_RAY_SAMPLE_BINDINGS ? room : GZ_RAY_SAMPLE_BINDINGS;
	memcpy(out_bindings, bindings, count * sizeof bindings[0]);
	return GZ_RAY_SAMPLE_BINDINGS;
}

static const char *const raycast_backends[] = { "gl", "cpu", NULL };

const struct gz_technique gz_raycast_technique = {
	.name = "raycast",
	.help = "casts rays through a volume, coloured by its transfer function",
	.shows = GZ_OBJECT_VOLUME | GZ_OBJECT_PARTICLES,
	.objects_max = 1,
	.backends = raycast_backends,
	.backends_agree = true,
	.tells_depths = true,
	.sharing = GZ_SHARES_AS_CLEAR,
	.check = gz_raycaster_check,
	.create = raycast_create,
	.settings_size = sizeof(struct gz_ray_params),
	.bind = raycast_bind,
};
