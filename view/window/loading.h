/**
 * @file
 * The part of the window that loads scenes, on threads while the window goes on, and shows them:
 * the one that the program was started with too. Internal to view/; main thread only.
 */
#ifndef GZ_VIEW_WINDOW_LOADING_H
#define GZ_VIEW_WINDOW_LOADING_H

#include <stdbool.h>

#include "base/result.h"
#include "protocol/gaze.h"
#include "render/scene/scene.h"
#include "view/window/part.h"

/** What is to be shown. Zero-initialised but for the path: a scene's file as it is. */
struct gz_window_load_request {
	/** Of a scene's file, beside which names in the scene are looked up first, or of whatever
	 *  gz_scene_open() takes. */
	char path[GZ_PATH_SIZE];
	bool has_raw; /**< @p raw is the layout of the raw file that @p path is */
	struct gz_raw_layout raw;
	/** The command line's keys come before the scene's own. For what was named there. */
	bool by_options;
	/** What the user has set stays: method and its parameters, look of rays and light,
	 *  attention, view. Volume, transfer function, camera, clip box, display and tables of
	 *  spacings are the new scene's in any case. */
	bool keep;
};

/**
 * Load a scene and show it once it is there, in place of the one shown, which stays until then, and
 * for good where the loading fails or is cancelled. While that takes a moment a panel tells how far
 * it is. A loading that goes on already is cancelled.
 *
 * Both volumes are in memory for the while; where that has no room for them the one shown is closed
 * and the loading begins again, with a warning.
 *
 * @param request  copied
 * @return GZ_OK: it has begun, parts are told by scene_leaving and scene_shown; what goes wrong
 *         later is logged. GZ_ERR_NO_MEM: it has not; logged
 */
enum gz_result gz_window_load(struct gz_window *window,
			      const struct gz_window_load_request *request);

/** Whether gz_window_load() has begun something that is not shown yet. */
bool gz_window_is_loading(const struct gz_window *window);

/** Stop that; nothing if there is none. */
void gz_window_cancel_loading(struct gz_window *window);

/** Path of the scene shown, as its request had it; "" without one. */
const char *gz_window_scene_path(const struct gz_window *window);

/** The scene shown has been saved, and is the one at @p path from now on, which is shorter than
 * GZ_PATH_SIZE. */
void gz_window_rename_scene(struct gz_window *window, const char *path);

/** Close the scene shown, if any: the window is as if started without one. */
void gz_window_close_scene(struct gz_window *window);

/** A scene kept ready, to be shown without any loading. */
struct gz_window_held;

/** How far a held scene is. */
enum gz_window_held_state {
	GZ_HELD_COMING,
	GZ_HELD_READY,
	GZ_HELD_FAILED, /**< why has been logged */
};

/**
 * Load a scene beside those that are there, and hold it ready: its renderer too. Nothing of it is
 * seen.
 *
 * @param request     copied; its keep counts for nothing
 * @param[out] out_held  owned by the caller: gz_window_release(), in its part's close at the latest
 * @retval GZ_ERR_NO_MEM  logged
 */
enum gz_result gz_window_preload(struct gz_window *window,
				 const struct gz_window_load_request *request,
				 struct gz_window_held **out_held);

/** @param[out] out_share  how much of it is done, 0 to 1; may be NULL */
enum gz_window_held_state gz_window_held_state(const struct gz_window_held *held,
					       double *out_share);

/**
 * Show a held scene, as it was loaded, in place of the one shown; that is freed unless it is held
 * too. A loading that goes on is cancelled. The scene stays held, and can be shown again.
 *
 * @retval GZ_ERR_INVAL  it is not ready
 * @return also what gz_frame_maker_start() returns, after a lost context; logged, and then no scene
 *         is shown
 */
enum gz_result gz_window_show(struct gz_window *window, struct gz_window_held *held);

/** Free a held scene and set to NULL; where it is the one shown the window is without a scene.
 *  Accepts a pointer to NULL. */
void gz_window_release(struct gz_window *window, struct gz_window_held **held);

/** What a load that the program was started for has come to: GZ_OK while it goes on, and once any
 *  scene has been shown. */
enum gz_result gz_window_loading_outcome(const struct gz_window *window);

/** The part. */
extern const struct gz_window_part gz_window_loading;

#endif
