/**
 * @file
 * What casts the rays of a scene: the backend that was asked for or, where it fails for good, cpu
 * in its place, so that no frame is lost.
 */
#ifndef GZ_VIEW_CASTER_H
#define GZ_VIEW_CASTER_H

#include "base/log.h"
#include "base/result.h"
#include "render/renderer.h"
#include "render/scene.h"
#include "view/options.h"

/** A renderer with what it takes to replace it. Zero-initialised holds none. */
struct gz_caster {
	const struct gz_log *log;
	const struct gz_scene *scene;
	struct gz_renderer *renderer;
	struct gz_renderer_params cpu; /**< of the one that would replace it */
	bool chooses;                  /**< --backend auto */
	bool loss_is_callers; /**< set by the caller: a lost context is returned, since the caller
				 makes another */
	bool on_device;       /**< the last picture is the renderer's texture */
};

/**
 * Make the renderer that the options name and give it the scene. Where they leave the choice and gl
 * does not take the scene, that is cpu, with a line that says why.
 *
 * @param options     its texts outlive the caster
 * @param gl_context  a window's, borrowed, outlives the caster; NULL: gl makes one without a window
 * @param scene       borrowed, outlives the caster
 * @return what gz_renderer_create(), gz_renderer_set_volume() and gz_renderer_set_transfer()
 *         return; logged
 */
enum gz_result gz_caster_start(struct gz_caster *caster, const struct gz_view_options *options,
			       struct gz_gl_context *gl_context, const struct gz_scene *scene,
			       const struct gz_log *log);

/** Whether gz_caster_start() would begin with the cpu backend: that one may be made on any thread.
 */
bool gz_caster_takes_cpu(const struct gz_view_options *options, struct gz_gl_context *gl_context,
			 const struct gz_log *log);

/** Make a renderer of the cpu backend, whatever the options say, and give it the scene. @return as
 *  gz_caster_start(); logged */
enum gz_result gz_caster_start_cpu(struct gz_caster *caster, const struct gz_view_options *options,
				   const struct gz_scene *scene, const struct gz_log *log);

/**
 * gz_renderer_render(); where the graphics device fails for good (its context is lost, its memory
 * is full), or gl was chosen by "auto" and cannot do what is asked, cpu renders this frame and all
 * that follow, with a line that says so.
 *
 * @param settings   the frame's camera and rays
 * @param on_device  leave the picture on the device, where it is made there: caster->on_device then
 *                   says so and @p image is not touched
 */
enum gz_result gz_caster_render(struct gz_caster *caster, const struct gz_scene_settings *settings,
				const struct gz_plan *plan, bool on_device, struct gz_image *image,
				struct gz_frame_stats *out_stats);

/** Destroy the renderer and zero the struct. */
void gz_caster_free(struct gz_caster *caster);

#endif
