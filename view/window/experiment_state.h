/**
 * @file
 * What the files of part experiment share; nobody else includes it.
 */
#ifndef GZ_VIEW_WINDOW_EXPERIMENT_STATE_H
#define GZ_VIEW_WINDOW_EXPERIMENT_STATE_H

#include <stdbool.h>
#include <stdint.h>

#include "view/experiment/sitting.h"
#include "view/window/loading.h"

/** A scene that the experiment shows, held ready. */
struct gz_experiment_scene {
	char path[GZ_PATH_SIZE];
	struct gz_window_held *held; /**< NULL: not loaded */
	bool retried;                /**< it failed before others made room */
	struct gz_experiment_scene *next;
};

/** State of part experiment. */
struct gz_window_experiment {
	struct gz_sitting *sitting;
	struct gz_run run;
	struct gz_viewer_link *link; /**< for marks, where the window has none */
	struct gz_experiment_scene *scenes;
	struct gz_view_settings view; /**< in place of the scenes': nothing over the picture */
	/** Whose picture the window makes now; NULL: none. */
	const struct gz_alternative *shown;
	size_t warm_index;     /**< the trial that is made ready, from 1; 0: none */
	int warm_left;         /**< its intervals that have not been cast yet */
	bool warming;          /**< one of them is being cast */
	bool frame_made;       /**< since shown was set */
	int64_t start_ns;      /**< of the first trial; 0: not yet */
	int64_t refresh_ns;    /**< of the display */
	int64_t turn_ns;       /**< when the last turn began, and in which phase */
	int64_t turn_spent_ns; /**< from the one before to that */
	enum gz_run_phase turn_phase;
	bool gaze_told; /**< the source tells whether the eye is seen */
	bool gaze_there;
	bool absence_told; /**< that there is no daemon */
	double px_per_deg; /**< of the framebuffer */
	bool placed;       /**< full screen */
};

/** Load ahead what the next trials show. @return GZ_OK, or why a scene of the trial cannot be
 *  shown; logged */
enum gz_result gz_experiment_load_ahead(struct gz_window *window);

/** Whether all that the trial shows is loaded. */
bool gz_experiment_scenes_ready(const struct gz_window_experiment *state);

/** How much of what is loading is done, 0 to 1; 1: nothing is loading. */
double gz_experiment_loaded_share(const struct gz_window_experiment *state);

/** Let the window make the picture of an alternative, whose scene is ready. @return what
 *  gz_window_show() and gz_scene_load_table() return; logged */
enum gz_result gz_experiment_show(struct gz_window *window,
				  const struct gz_alternative *alternative);

/** Release every scene. */
void gz_experiment_release_scenes(struct gz_window *window);

#endif
