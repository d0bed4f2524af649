#include "view/caster.h"

#include <string.h>

#define GZ_LOG_MODULE "gazeview"

static enum gz_result give_scene(struct gz_caster *caster)
{
	enum gz_result r = gz_renderer_set_volume(caster->renderer, &caster->scene->volume);
	if (r == GZ_OK)
		r = gz_renderer_set_transfer(caster->renderer, &caster->scene->transfer);
	return r;
}

static bool is_cpu(const struct gz_caster *caster)
{
	return caster->renderer && strcmp(caster->renderer->ops->name, "cpu") == 0;
}

/* Whether cpu may take over after @p failure. */
static bool may_replace(const struct gz_caster *caster, enum gz_result failure)
{
	if (is_cpu(caster) || (failure == GZ_ERR_NO_DEVICE && caster->loss_is_callers))
		return false;
	return failure == GZ_ERR_NO_DEVICE || failure == GZ_ERR_NO_MEM ||
	       (failure == GZ_ERR_UNSUPPORTED && caster->chooses);
}

static enum gz_result replace(struct gz_caster *caster)
{
	gz_warn(caster->log, "the cpu backend casts the rays from now on");
	gz_renderer_destroy(&caster->renderer);
	enum gz_result r = gz_renderer_create("cpu", &caster->cpu, caster->log, &caster->renderer);
	if (r == GZ_OK)
		r = give_scene(caster);
	return r;
}

static void begin(struct gz_caster *caster, const struct gz_view_options *options,
		  const struct gz_scene *scene, const struct gz_log *log)
{
	*caster = (struct gz_caster) {
		.log = log,
		.scene = scene,
		.cpu = { .threads = options->threads,
			 .simd = options->simd,
			 .wait_for_bricks = options->bricks == GZ_BRICKS_AUTO
						    ? options->headless
						    : options->bricks == GZ_BRICKS_WAIT },
		.chooses = strcmp(options->backend, "auto") == 0,
	};
}

static enum gz_result start(struct gz_caster *caster, const char *backend,
			    const struct gz_renderer_params *params)
{
	enum gz_result r = gz_renderer_create(backend, params, caster->log, &caster->renderer);
	if (r == GZ_OK) {
		r = give_scene(caster);
		if (caster->chooses && may_replace(caster, r))
			r = replace(caster);
	}
	if (r == GZ_ERR_NO_MEM)
		gz_err(caster->log,
		       "no memory for the renderer; close other programs or take a smaller "
		       "volume");
	else if (r == GZ_OK)
		gz_debug(caster->log, "%s", gz_renderer_describe(caster->renderer));
	if (r != GZ_OK)
		gz_renderer_destroy(&caster->renderer);
	return r;
}

bool gz_caster_takes_cpu(const struct gz_view_options *options, struct gz_gl_context *gl_context,
			 const struct gz_log *log)
{
	struct gz_caster caster;
	begin(&caster, options, NULL, log);
	if (strcmp(options->backend, "cpu") == 0)
		return true;
	struct gz_renderer_params params = caster.cpu;
	params.gl_context = gl_context;
	if (!caster.chooses || gz_renderer_create("auto", &params, log, &caster.renderer) != GZ_OK)
		return false;
	const bool cpu = is_cpu(&caster);
	gz_renderer_destroy(&caster.renderer);
	return cpu;
}

enum gz_result gz_caster_start(struct gz_caster *caster, const struct gz_view_options *options,
			       struct gz_gl_context *gl_context, const struct gz_scene *scene,
			       const struct gz_log *log)
{
	begin(caster, options, scene, log);
	struct gz_renderer_params params = caster->cpu;
	params.gl_context = gl_context;
	params.gl_memory_bytes = (size_t)options->gl_memory_mib << 20;
	return start(caster, options->backend, &params);
}

enum gz_result gz_caster_start_cpu(struct gz_caster *caster, const struct gz_view_options *options,
				   const struct gz_scene *scene, const struct gz_log *log)
{
	begin(caster, options, scene, log);
	return start(caster, "cpu", &caster->cpu);
}

enum gz_result gz_caster_render(struct gz_caster *caster, const struct gz_scene_settings *settings,
				const struct gz_plan *plan, bool on_device, struct gz_image *image,
				struct gz_frame_stats *out_stats)
{
	caster->on_device = on_device && !is_cpu(caster);
	enum gz_result r = gz_renderer_render(caster->renderer, &settings->camera, &settings->rays,
					      plan, caster->on_device ? NULL : image, out_stats);
	if (!may_replace(caster, r))
		return r;
	caster->on_device = false;
	r = replace(caster);
	if (r == GZ_OK)
		r = gz_renderer_render(caster->renderer, &settings->camera, &settings->rays, plan,
				       image, out_stats);
	return r;
}

void gz_caster_free(struct gz_caster *caster)
{
	gz_renderer_destroy(&caster->renderer);
	*caster = (struct gz_caster) { 0 };
}
