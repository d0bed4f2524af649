/**
 * @file
 * The part of the window that loads scenes on threads, shows them, and holds scenes ready. Internal
 * to view/; main thread only.
 */
#ifndef GZ_VIEW_WINDOW_LOADING_H
#define GZ_VIEW_WINDOW_LOADING_H

#include <stdbool.h>

#include "base/result.h"
#include "protocol/gaze.h"
#include "render/data/series_list.h"
#include "render/scene/scene.h"

struct gz_window;

/** What to load. Zero-initialised except for the path: a scene file with its own settings. */
struct gz_window_load_request {
	/** Path of what gz_scene_open() accepts. Files named in a scene are looked up beside it
	 *  first. */
	char path[GZ_PATH_SIZE];
	bool has_raw; /**< path is a raw file with layout raw */
	struct gz_raw_layout raw;
	/** UID of the DICOM series; empty: what scene and options say. */
	char series_uid[GZ_SERIES_SIZE];
	/** Slices that do not lie evenly are interpolated, if scene and options do not resample
	 * them. */
	bool resample;
	/** Keys of the command line replace the scene's; for what was named there. */
	bool by_options;
	/** Keep the user's settings of method, rays, light, attention and view. Volume, transfer
	 *  function, camera, clip box, display and tables of spacings are always the new scene's.
	 */
	bool keep;
};

/**
 * Load a scene, and show it when it is ready. The scene shown stays until then, and also if loading
 * fails or is cancelled. A panel shows the progress. A loading that goes on is cancelled.
 *
 * Both volumes are in memory meanwhile. If there is no room for both, the scene shown is closed and
 * loading begins again, with a warning.
 *
 * @param request  copied
 * @retval GZ_OK          loading has begun; later failures are logged. Parts are told by
 * scene_leaving and scene_shown
 * @retval GZ_ERR_NO_MEM  loading has not begun; logged
 */
enum gz_result gz_window_load(struct gz_window *window,
			      const struct gz_window_load_request *request);

/** Load the latest file again, with slices that do not lie evenly resampled: what was refused, or
 * is shown shifted. */
void gz_window_load_resampled(struct gz_window *window);

/** Whether a gz_window_load() goes on, or waits for a series to be chosen. */
bool gz_window_is_loading(const struct gz_window *window);

/** The series that the path which is being loaded stands for, from when the first is known until
 * one is chosen or the loading is cancelled; NULL: there is nothing to choose. Rows and pictures
 * still come. */
struct gz_series_list *gz_window_offered_series(const struct gz_window *window);

/** Path of what holds those series. */
const char *gz_window_offering_path(const struct gz_window *window);

/** Load one of the series that are offered. @param uid  shorter than GZ_SERIES_SIZE @return as
 *  gz_window_load() */
enum gz_result gz_window_choose_series(struct gz_window *window, const char *uid);

/** Cancel the loading, if one goes on. */
void gz_window_cancel_loading(struct gz_window *window);

/** Path of the scene shown, as in its request; "": there is no scene. */
const char *gz_window_scene_path(const struct gz_window *window);

/** Change the path of the scene shown, which was saved there; shorter than GZ_PATH_SIZE. */
void gz_window_rename_scene(struct gz_window *window, const char *path);

/** Close the scene shown, if there is one: the window is empty. */
void gz_window_close_scene(struct gz_window *window);

/** A scene held ready, which is shown without loading. */
struct gz_window_held;

/** State of a held scene. */
enum gz_window_held_state {
	GZ_HELD_COMING,
	GZ_HELD_READY,
	GZ_HELD_FAILED, /**< why has been logged */
};

/**
 * Load a scene in addition to those that are loaded, and hold it ready with its renderer. It is not
 * shown.
 *
 * @param request        copied; its keep is ignored
 * @param[out] out_held  owned by the caller: gz_window_release(), in its part's close at the latest
 * @retval GZ_ERR_NO_MEM  logged
 */
enum gz_result gz_window_preload(struct gz_window *window,
				 const struct gz_window_load_request *request,
				 struct gz_window_held **out_held);

/** State of a held scene. @param[out] out_share  share loaded, 0 to 1; may be NULL */
enum gz_window_held_state gz_window_held_state(const struct gz_window_held *held,
					       double *out_share);

/**
 * Show a held scene with the settings it was loaded with. The previous scene is freed, unless it is
 * held too. A loading that goes on is cancelled. The scene stays held, and can be shown again.
 *
 * @retval GZ_ERR_INVAL  it is not ready
 * @return else, after a lost context, what gz_frame_maker_start() returns; logged, and no scene is
 *         shown then
 */
enum gz_result gz_window_show(struct gz_window *window, struct gz_window_held *held);

/** Free a held scene and set to NULL; if it is shown, the window is empty. Accepts a pointer to
 *  NULL. */
void gz_window_release(struct gz_window *window, struct gz_window_held **held);

/** Why no scene has been shown since the program was started: the last failure. GZ_OK while loading
 *  goes on, and once any scene has been shown. */
enum gz_result gz_window_loading_outcome(const struct gz_window *window);

#endif
