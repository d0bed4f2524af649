/**
 * @file
 * The part of the window that runs an experiment: full screen, and alone (window->alone). Its
 * scenes are held ready in experiment_scenes.c. Internal to view/; main thread only.
 */
#ifndef GZ_VIEW_WINDOW_EXPERIMENT_H
#define GZ_VIEW_WINDOW_EXPERIMENT_H

#include <stdbool.h>
#include <stdint.h>

#include "view/experiment/sitting.h"
#include "view/panels/experiment_screen.h"
#include "view/window/loading.h"

/** A scene of the experiment. */
struct gz_experiment_scene {
	char path[GZ_PATH_SIZE];
	struct gz_window_held *held; /**< NULL: not loaded */
	bool retried;                /**< loading failed once, before others made room */
	struct gz_experiment_scene *next;
};

/** State of part experiment. */
struct gz_window_experiment {
	struct gz_sitting *sitting;
	struct gz_run run;
	struct gz_viewer_link *link; /**< for marks, if the window has no link */
	struct gz_experiment_scene *scenes;
	struct gz_view_settings view; /**< replaces the scenes': nothing over the picture */
	/** The alternative whose picture is made at present; NULL: none. */
	const struct gz_alternative *shown;
	size_t warm_index;     /**< number of the trial that is warmed up, from 1; 0: none */
	int warm_left;         /**< its intervals that have not been cast yet */
	bool warming;          /**< one of them is being cast */
	bool frame_made;       /**< a frame was made since shown was set */
	int64_t start_ns;      /**< of the first trial; 0: not begun */
	int64_t refresh_ns;    /**< of the display */
	int64_t turn_ns;       /**< when the last turn began, and in which phase */
	int64_t turn_spent_ns; /**< time from the turn before to the last one */
	enum gz_run_phase turn_phase;
	bool gaze_told; /**< the source can tell whether the eye is seen */
	bool gaze_there;
	bool absence_told; /**< the missing gaze was logged */
	double px_per_deg; /**< of the framebuffer */
	bool placed;       /**< the window is in full screen */
	/** The buttons that are on the screen, their keys, and of which phase. */
	struct gz_experiment_button buttons[GZ_EXPERIMENT_ANSWERS_MAX];
	int button_keys[GZ_EXPERIMENT_ANSWERS_MAX];
	size_t button_count;
	enum gz_run_phase button_phase;
	int button_bright;   /**< the one below the mouse; -1: none */
	bool pointer_hidden; /**< the mouse cursor is not shown */
};

/** Load scenes of the next trials. @return GZ_OK; else why a scene of the present trial cannot be
 *  shown; logged */
enum gz_result gz_experiment_load_ahead(struct gz_window *window);

/** Whether all scenes of the present trial are ready. */
bool gz_experiment_scenes_ready(const struct gz_window_experiment *state);

/** Progress of loading, 0 to 1; 1: nothing is loading. */
double gz_experiment_loaded_share(const struct gz_window_experiment *state);

/** Make the picture of an alternative, whose scene is ready. @return what gz_window_show(),
 *  gz_scene_load_table() and gz_scene_find_cube() return; logged */
enum gz_result gz_experiment_show(struct gz_window *window,
				  const struct gz_alternative *alternative);

/** Release every scene. */
void gz_experiment_release_scenes(struct gz_window *window);

/**
 * Begin the experiment, which takes the window.
 *
 * @param options  with a participant; borrowed, outlives the window
 * @return what gz_sitting_open() returns; logged. Then there is no experiment.
 */
enum gz_result gz_window_experiment_begin(struct gz_window *window,
					  const struct gz_sitting_options *options);

/** Result of the experiment: GZ_OK without one and once all trials are answered, GZ_ERR_CANCELLED
 * if it was left, or did not begin, else why it ended. Logged. */
enum gz_result gz_window_experiment_outcome(struct gz_window *window);

#endif
