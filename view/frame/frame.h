/**
 * @file
 * One frame of gazeview: gaze to attention to plan to picture, with what each step cost. Shared by
 * the window and headless rendering. One thread, unless a function says otherwise.
 */
#ifndef GZ_VIEW_FRAME_FRAME_H
#define GZ_VIEW_FRAME_FRAME_H

#include "base/log.h"
#include "base/result.h"
#include "render/attention/interest.h"
#include "render/illustration/illustration_automatic.h"
#include "render/picture/image.h"
#include "render/scene/scene.h"
#include "render/technique/technique.h"
#include "view/frame/stats.h"
#include "view/gaze/gaze_source.h"
#include "view/options/options.h"

/** A scene and the renderer that shows it. */
struct gz_frame_maker;

/** What one frame shows. */
struct gz_frame_request {
	/** Volume, transfer, display and the data of objects are ignored. */
	const struct gz_scene_settings *settings;
	const struct gz_display *display; /**< the picture fills it */
	int width, height;                /**< of the finished picture, px */
	bool on_device;       /**< leave the picture on the graphics device if made there */
	bool loss_is_callers; /**< return a lost context instead of falling back to cpu */
};

/** Which scene a maker shows. */
struct gz_frame_scene {
	/** Path of the scene file, or of anything else that gz_scene_open() accepts. Files named in
	 * the scene are looked up beside it first. */
	const char *path;
	/** Layout of a raw file; NULL: from the options, otherwise from the file's name. */
	const struct gz_raw_layout *raw;
	/** UID of the DICOM series to show in place of what scene and options say; NULL: theirs. */
	const char *series_uid;
	/** Slices that do not lie evenly are interpolated, if scene and options do not resample
	 * them. */
	bool resample;
	/** The command line's keys replace the scene's. */
	bool by_options;
	/** Settings that replace both, except volume, transfer function, camera, clip box, display
	 * and spacing table; NULL: none. */
	const struct gz_scene_settings *kept;
};

/** The scene that the options name, with the command line's keys. */
struct gz_frame_scene gz_frame_scene_of_options(const struct gz_view_options *options);

/**
 * Load a scene. All arguments but the log are borrowed until the call returns.
 *
 * @param options  used if scene->by_options, and for the renderer to come
 * @param loading  receives the progress and may cancel; NULL: none
 * @param log      outlives the maker
 * @param[out] out_maker  the caller frees it with gz_frame_maker_destroy()
 * @return the results of gz_scene_open(); logged except GZ_ERR_CANCELLED and GZ_ERR_CHOICE, which
 *         @p loading causes
 *
 * Threads: any.
 */
enum gz_result gz_frame_maker_create(const struct gz_view_options *options,
				     const struct gz_frame_scene *scene,
				     const struct gz_loading *loading, const struct gz_log *log,
				     struct gz_frame_maker **out_maker);

/**
 * Create the renderer. Call it before the first frame.
 *
 * @param options     the options of gz_frame_maker_create(); outlive the maker
 * @param gl_context  of the window that shows the pictures, outlives the maker; NULL: no window
 * @return the results of gz_picture_maker_show(); logged
 */
enum gz_result gz_frame_maker_start(struct gz_frame_maker *maker,
				    const struct gz_view_options *options,
				    struct gz_gl_context *gl_context);

/** Create a renderer of the cpu backend whatever the options say. Results as for
 * gz_frame_maker_start(); logged. */
enum gz_result gz_frame_maker_start_cpu(struct gz_frame_maker *maker,
					const struct gz_view_options *options);

/**
 * Let the renderer of gz_frame_maker_start_cpu() make way for one of gz_frame_maker_start() once
 * the settings ask for a technique that cpu does not draw. From then on each technique gets the
 * backend that the options choose for it. Call it after the renderer is started, which withdraws
 * it.
 *
 * @param options, gl_context  as for gz_frame_maker_start(); frames are made where the context may
 *                             be used
 */
void gz_frame_maker_let_choose(struct gz_frame_maker *maker, const struct gz_view_options *options,
			       struct gz_gl_context *gl_context);

/** Whether gz_frame_maker_start() would choose the cpu backend, which any thread may create. */
bool gz_frame_takes_cpu(const struct gz_view_options *options, struct gz_gl_context *gl_context,
			const struct gz_log *log);

/** Whether the cpu backend can draw all techniques of the scene. If not, gz_frame_maker_start()
 * must choose. */
bool gz_frame_cpu_suffices(const struct gz_frame_maker *maker);

/** Destroy the renderer while its context exists. Another one may be started. */
void gz_frame_maker_stop(struct gz_frame_maker *maker);

/** Whether the maker has a renderer. */
bool gz_frame_maker_started(const struct gz_frame_maker *maker);

/** The scene as loaded, with all overrides. Valid until the maker is destroyed. */
const struct gz_scene *gz_frame_maker_scene(const struct gz_frame_maker *maker);

/** Settings of section view as the scene has them, without those of the command line or of the
 * scene before; NULL: there are no such. */
const struct gz_view_settings *gz_frame_maker_own_view(const struct gz_frame_maker *maker);

/** gz_scene_list_objects() for the objects that the last frame showed. */
size_t gz_frame_list_objects(const struct gz_frame_maker *maker,
			     struct gz_object out_objects[GZ_SCENE_LISTED_MAX]);

/**
 * Use another transfer function from the next frame on, and drop what earlier frames accumulated.
 * Call it between frames, after gz_frame_maker_start().
 *
 * @param transfer  valid; copied
 * @return the results of gz_picture_maker_show(); logged
 */
enum gz_result gz_frame_set_transfer(struct gz_frame_maker *maker,
				     const struct gz_transfer *transfer);

/** How many time points the scene's volume has; 1: it is not a series. */
int gz_frame_time_points(const struct gz_frame_maker *maker);

/** The time point that is shown, from 0. */
int gz_frame_time_point(const struct gz_frame_maker *maker);

/**
 * Take a time point from where gz_frame_expect_time_point() loads it. It is shown by
 * gz_frame_show_taken(), so that threads can stop using the present one in between.
 *
 * @param time_point  from 0
 * @param wait        wait until it is loaded
 * @retval GZ_OK           it is ready to be shown
 * @retval GZ_ERR_TIMEOUT  it is being loaded
 * @return otherwise what gz_scene_load_time_point() returns; logged
 */
enum gz_result gz_frame_take_time_point(struct gz_frame_maker *maker, int time_point, bool wait);

/**
 * Show the time point that was taken from the next frame on, and drop what earlier frames
 * accumulated. The volume of gz_frame_maker_scene() changes: no thread may use it meanwhile. If it
 * cannot be shown, the present one stays.
 *
 * @retval GZ_ERR_INVAL  none was taken
 * @return otherwise the results of gz_picture_maker_show(); logged
 */
enum gz_result gz_frame_show_taken(struct gz_frame_maker *maker);

/** Load a time point ahead on a thread; those outside the series are ignored. @p finished is called
 *  on the thread when it is loaded; may be NULL; the same in each call for a maker. */
void gz_frame_expect_time_point(struct gz_frame_maker *maker, int time_point,
				void (*finished)(void *user));

/**
 * Pass the gaze of the next frame to the attention (render/attention/attention.h).
 *
 * @param reading  its point is on @p display
 * @param time_ns  of the frame, from any origin: the log's time, otherwise the host's
 * @return whether the next frame's plan, or what it raises in importance, differs from that of the
 *         last frame made; true before the first frame
 */
bool gz_frame_attend(struct gz_frame_maker *maker, const struct gz_attention_params *params,
		     const struct gz_gaze_reading *reading, const struct gz_display *display,
		     int64_t time_ns);

/**
 * Set a recorded focus, and what was raised, in place of gz_frame_attend(), so that a replay
 * depends neither on the times of the recorded frames nor on those of its own.
 *
 * @param reading  the recorded gaze, for the frame's record
 */
void gz_frame_set_focus(struct gz_frame_maker *maker, const struct gz_gaze_reading *reading,
			const struct gz_focus *focus);

/** Raise an object, or values of a volume, in importance from the next frame on, as it was
 * recorded. gz_frame_attend() decides anew. */
void gz_frame_set_raised(struct gz_frame_maker *maker, const struct gz_raised *raised);

/** The transfer function that the last frame showed: the scene's, and what is raised of its values.
 *  Valid until the next frame. */
const struct gz_transfer *gz_frame_transfer(const struct gz_frame_maker *maker);

/** What the next frame raises in importance because it is looked at. */
struct gz_raised gz_frame_raised(const struct gz_frame_maker *maker);

/** Change the combined settings of an illustration in the next frame as it was recorded, in place
 * of what follows from the last frame (render/illustration/illustration_automatic.h). */
void gz_frame_set_change(struct gz_frame_maker *maker, const struct gz_illustration_change *change);

/** How the last frame's settings of an illustration were changed. */
struct gz_illustration_change gz_frame_change(const struct gz_frame_maker *maker);

/** The settings that the last frame was made with: the scene's, and what followed what it showed.
 *  Valid until the next frame; undefined before the first. */
const struct gz_ray_params *gz_frame_rays(const struct gz_frame_maker *maker);

/** The reading last passed to gz_frame_attend() or gz_frame_set_focus(). */
const struct gz_gaze_reading *gz_frame_reading(const struct gz_frame_maker *maker);

/** The name of the backend, "cpu" or "gl"; static text. Call it after gz_frame_maker_start(). */
const char *gz_frame_backend(const struct gz_frame_maker *maker);

/**
 * The backend for pictures with which frames are compared: that of the frames, unless cpu draws the
 * same. So a comparison shows what foveation changes, and not what backends do.
 *
 * @return "cpu" or "gl"; static text. Call it after gz_frame_maker_start()
 */
const char *gz_frame_standard_backend(const struct gz_frame_maker *maker);

/** How far gz_frame_prepare() is. */
enum gz_frame_ready {
	GZ_FRAME_READY,       /**< the next frame need not wait */
	GZ_FRAME_PREPARING,   /**< it must; finished is called when asking again is worth it */
	GZ_FRAME_CANNOT_WAIT, /**< it must, and nothing can be done beside the frames */
};

/**
 * Make triangles of the settings' isovalue ready on a thread of its own, while frames with
 * GZ_SURFACE_VOXELS go on.
 *
 * @param finished  called on the thread; may be NULL
 */
enum gz_frame_ready gz_frame_prepare(struct gz_frame_maker *maker,
				     const struct gz_scene_settings *settings,
				     void (*finished)(void *user));

/**
 * Make the surfaces of the scene's labels ready, with the look of the settings, on threads of their
 * own. Frames go on, with those that are shown. GZ_FRAME_READY: gz_frame_show_labels() can show
 * them. GZ_FRAME_CANNOT_WAIT: they cannot be made; logged.
 *
 * @param finished  called on the threads; may be NULL
 */
enum gz_frame_ready gz_frame_prepare_labels(struct gz_frame_maker *maker,
					    const struct gz_scene_settings *settings,
					    void (*finished)(void *user));

/**
 * Show the surfaces that gz_frame_prepare_labels() has made ready from the next frame on. Those of
 * gz_frame_maker_scene() change: no thread may use them meanwhile. If it fails, the present ones
 * stay.
 *
 * @retval GZ_ERR_INVAL  there are none
 * @return otherwise what gz_picture_maker_show() returns; logged
 */
enum gz_result gz_frame_show_labels(struct gz_frame_maker *maker);

/** Whether a thread of gz_frame_prepare_labels() is still at work. */
bool gz_frame_making_labels(const struct gz_frame_maker *maker);

/** Forget what gz_frame_prepare_labels() makes, and wait for its threads. */
void gz_frame_drop_labels(struct gz_frame_maker *maker);

/** Drop what earlier frames accumulated and how plans have grown: temporal.accumulate and
 *  foveation.still_growth start again with the next frame. */
void gz_frame_forget(struct gz_frame_maker *maker);

/** Whether plan and importance stay the same while the gaze does; otherwise call gz_frame_attend()
 * each frame. */
bool gz_frame_settled(const struct gz_frame_maker *maker);

/** Whether rendering the same frame again may give a finer picture: the budget has made the plan
 * coarse and is still adapting. */
bool gz_frame_refinable(const struct gz_frame_maker *maker);

/** Whether further equal frames would still change the picture: temporal.accumulate,
 *  foveation.still_growth. */
bool gz_frame_settling(const struct gz_frame_maker *maker);

/**
 * Render one frame with the focus of gz_frame_attend() or gz_frame_set_focus(); at the centre
 * before either was called.
 *
 * @param[out] out_image   the picture, owned by the maker and valid until the next call; NULL if it
 *                         stayed on the device: see gz_frame_texture()
 * @param[out] out_record  what the frame cost
 * @retval GZ_ERR_INVAL      the picture has no or too many rays at the scene's image_sampling_rate,
 *                           the camera is invalid, or no object is visible; logged
 * @retval GZ_ERR_NO_MEM     out of memory; logged
 * @retval GZ_ERR_NO_DEVICE  the context is lost and request->loss_is_callers is set; logged
 */
enum gz_result gz_frame_make(struct gz_frame_maker *maker, const struct gz_frame_request *request,
			     struct gz_image **out_image, struct gz_frame_record *out_record);

/**
 * Make a small picture beside the frames, with all rays, of what the last frame showed. What frames
 * accumulate starts again.
 *
 * @param[in,out] image  resized
 * @return the results of gz_frame_make(); logged
 */
enum gz_result gz_frame_preview(struct gz_frame_maker *maker,
				const struct gz_scene_settings *settings, int width, int height,
				struct gz_image *image);

/**
 * The object that is seen most at a point of a picture.
 *
 * @param settings  of the picture; it shows what the last frame showed
 * @param width, height  of the picture, px
 * @param point     normalised
 * @return a number of gz_scene_list_objects(); 0: none, or a technique that cannot tell
 */
uint32_t gz_frame_object_at(struct gz_frame_maker *maker, const struct gz_scene_settings *settings,
			    int width, int height, struct gz_point point);

/**
 * Write the drawing of a frame for print: the marks that draw it, with every pixel cast, wherever
 * somebody looks. The frame must be drawn by marks: illustration.drawing is stipples or hatches.
 *
 * @param request  of the frame; its size in pixels decides how large marks are on paper
 * @return what gz_picture_print() returns; logged
 */
enum gz_result gz_frame_print(struct gz_frame_maker *maker, const struct gz_frame_request *request,
			      const struct gz_print *print);

/** OpenGL's name of the texture with the last picture that stayed on the device. Valid until the
 * next frame. */
unsigned gz_frame_texture(const struct gz_frame_maker *maker);

/** The plan of the last picture; without tiles before the first. Valid until the next frame. */
const struct gz_plan *gz_frame_plan(const struct gz_frame_maker *maker);

/** Warn that no letters can be drawn if the volume does not store its orientation. */
void gz_frame_tell_unoriented(const struct gz_frame_maker *maker);

/** Draw a cross at @p at, a point on the picture, 0 to 1. Parts outside the picture are cut. */
void gz_frame_draw_cross(struct gz_image *image, struct gz_point at);

/** Destroy the maker and set the pointer to NULL. Accepts NULL and a pointer to NULL. */
void gz_frame_maker_destroy(struct gz_frame_maker **maker);

#endif
