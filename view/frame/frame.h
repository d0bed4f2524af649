/**
 * @file
 * One frame: gaze to attention to plan to picture, with what each step cost. Headless and window
 * share it.
 */
#ifndef GZ_VIEW_FRAME_FRAME_H
#define GZ_VIEW_FRAME_FRAME_H

#include "base/log.h"
#include "base/result.h"
#include "render/picture/image.h"
#include "render/scene/scene.h"
#include "render/technique/technique.h"
#include "view/frame/stats.h"
#include "view/gaze/gaze_source.h"
#include "view/options/options.h"

/** A scene with the renderer that shows it. */
struct gz_frame_maker;

/** What one frame is to be. */
struct gz_frame_request {
	const struct gz_scene_settings *settings; /**< all but volume, transfer and display count */
	const struct gz_display *display;         /**< of the picture: it fills this one */
	int width, height;                        /**< of the finished picture, px */
	bool on_device;       /**< leave the picture on the graphics device if it is made there */
	bool loss_is_callers; /**< a lost context is returned, not made up for by cpu */
};

/** Which scene a maker is to show. */
struct gz_frame_scene {
	/** Of a scene's file, beside which names in the scene are looked up first, or of whatever
	 *  gz_scene_open() takes. */
	const char *path;
	/** The layout of the raw file that @p path is; NULL: the options' or what its name tells.
	 */
	const struct gz_raw_layout *raw;
	/** The command line's keys come before the scene's own. */
	bool by_options;
	/** These come before both, but for volume, transfer function, camera, clip box and display,
	 *  and a table of spacings; NULL: nothing stays. */
	const struct gz_scene_settings *kept;
};

/** The scene that the options name, with their keys. */
struct gz_frame_scene gz_frame_scene_of_options(const struct gz_view_options *options);

/**
 * Load a scene. Everything is borrowed until the call returns, but for the log.
 *
 * @param options  for scene->by_options, and what a renderer will need
 * @param loading  who is told how far it is, and may stop it; NULL for nobody
 * @param log      outlives the maker
 * @param[out] out_maker  owned by the caller: gz_frame_maker_destroy()
 * @return what gz_scene_load() returns; logged but for GZ_ERR_CANCELLED, which @p loading gives
 *
 * Threads: any.
 */
enum gz_result gz_frame_maker_create(const struct gz_view_options *options,
				     const struct gz_frame_scene *scene,
				     const struct gz_loading *loading, const struct gz_log *log,
				     struct gz_frame_maker **out_maker);

/**
 * Make the renderer, before the first frame.
 *
 * @param options     as before; outlives the maker
 * @param gl_context  of the window that shows the pictures, outlives the maker; NULL without one
 * @return what gz_picture_maker_show() returns; logged
 */
enum gz_result gz_frame_maker_start(struct gz_frame_maker *maker,
				    const struct gz_view_options *options,
				    struct gz_gl_context *gl_context);

/** Make a renderer of the cpu backend, whatever the options say. @return as before; logged */
enum gz_result gz_frame_maker_start_cpu(struct gz_frame_maker *maker,
					const struct gz_view_options *options);

/** Whether gz_frame_maker_start() would begin with the cpu backend, which may be made on any
 * thread.
 */
bool gz_frame_takes_cpu(const struct gz_view_options *options, struct gz_gl_context *gl_context,
			const struct gz_log *log);

/** Destroy the renderer, while its context is there; another may be started. */
void gz_frame_maker_stop(struct gz_frame_maker *maker);

/** Whether it has a renderer. */
bool gz_frame_maker_started(const struct gz_frame_maker *maker);

/** The scene as loaded and overridden. Valid until the maker is destroyed. */
const struct gz_scene *gz_frame_maker_scene(const struct gz_frame_maker *maker);

/**
 * Show the scene by another transfer function from the next frame on; what earlier frames saw is
 * forgotten. Between frames, after gz_frame_maker_start().
 *
 * @param transfer  valid; copied
 * @return what gz_raycaster_set_transfer() returns; logged
 */
enum gz_result gz_frame_set_transfer(struct gz_frame_maker *maker,
				     const struct gz_transfer *transfer);

/**
 * Let the attention (render/attention/attention.h) take the gaze of the next frame.
 *
 * @param reading  its point is on @p display
 * @param time_ns  of the frame, from any origin: a log's own time, else the host's
 * @return whether the plan of the next frame differs from that of the last one made; true before
 *         the first
 */
bool gz_frame_attend(struct gz_frame_maker *maker, const struct gz_attention_params *params,
		     const struct gz_gaze_reading *reading, const struct gz_display *display,
		     int64_t time_ns);

/**
 * Take a focus as it was, in place of gz_frame_attend(): a replay does not depend on what frames
 * took when they were recorded, or take now.
 *
 * @param reading  what was known of the gaze then, for the record of the frame
 */
void gz_frame_set_focus(struct gz_frame_maker *maker, const struct gz_gaze_reading *reading,
			const struct gz_focus *focus);

/** What the attention took last: gz_frame_attend() or gz_frame_set_focus(). */
const struct gz_gaze_reading *gz_frame_reading(const struct gz_frame_maker *maker);

/** What casts its rays: "cpu", "gl". After gz_frame_maker_start(); static text. */
const char *gz_frame_backend(const struct gz_frame_maker *maker);

/** Forget what earlier frames saw: temporal.accumulate begins anew with the next. */
void gz_frame_forget(struct gz_frame_maker *maker);

/** Whether the plan stays as it is while the gaze does; else gz_frame_attend() is due each frame.
 */
bool gz_frame_settled(const struct gz_frame_maker *maker);

/** Whether the same frame again may turn out finer: the time to keep has made it coarse, and a few
 *  more frames will tell whether it must be. */
bool gz_frame_refinable(const struct gz_frame_maker *maker);

/** Whether further frames that ask for the same would still change the picture:
 * temporal.accumulate.
 */
bool gz_frame_settling(const struct gz_frame_maker *maker);

/**
 * Render one frame, sharp where gz_frame_attend() left it; before the first in the centre.
 *
 * @param[out] out_image   the picture, owned by the maker, valid until the next call; NULL where
 *                         it stayed on the device: see gz_frame_texture()
 * @param[out] out_record  what it cost
 * @retval GZ_ERR_INVAL   the picture at the scene's image_sampling_rate is too large or vanishes,
 *                        or the camera is none; logged
 * @retval GZ_ERR_NO_MEM  no room; logged
 * @retval GZ_ERR_NO_DEVICE  the context is lost, and that is the caller's; logged
 */
enum gz_result gz_frame_make(struct gz_frame_maker *maker, const struct gz_frame_request *request,
			     struct gz_image **out_image, struct gz_frame_record *out_record);

/** OpenGL's name of the texture with the last picture that stayed on the device, valid until the
 * next frame. */
unsigned gz_frame_texture(const struct gz_frame_maker *maker);

/** The plan of the last picture; without tiles before the first. Valid until the next frame. */
const struct gz_plan *gz_frame_plan(const struct gz_frame_maker *maker);

/** Log why no letters can be drawn, where the volume does not tell its sides. */
void gz_frame_tell_unoriented(const struct gz_frame_maker *maker);

/** Draw a cross at a place of the display that the picture fills; nothing where it is outside. */
void gz_frame_draw_cross(struct gz_image *image, struct gz_point at);

/** Destroy and set to NULL. Accepts a pointer to NULL. */
void gz_frame_maker_destroy(struct gz_frame_maker **maker);

#endif
