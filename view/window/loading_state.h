/**
 * @file
 * What loading.c, scene_swap.c and held_scenes.c share. Internal to view/.
 */
#ifndef GZ_VIEW_WINDOW_LOADING_STATE_H
#define GZ_VIEW_WINDOW_LOADING_STATE_H

#include "view/window/load_job.h"
#include "view/window/window_state.h"

/** See loading.h. */
struct gz_window_held {
	struct gz_window_held *next;
	struct gz_load_job *job;      /**< until it has finished */
	struct gz_frame_maker *maker; /**< then; NULL: it has failed */
	char path[GZ_PATH_SIZE];
};

/** State of the part. */
struct gz_window_loading_state {
	struct gz_load_job *job;   /**< whose scene will be shown; NULL: none */
	bool again;                /**< it has begun again, the scene before it being closed */
	struct gz_load_job *ended; /**< cancelled ones that have not finished yet */
	int64_t asked_ns;          /**< when the scene shown was asked for; 0: told already */
	struct gz_window_held *held;
	const struct gz_window_held
		*shown;          /**< that holds window->maker; NULL: the window owns it */
	char path[GZ_PATH_SIZE]; /**< of the scene shown */
	bool any_shown;
	enum gz_result outcome;
};

/** Show the scene of a maker that has a renderer, with @p settings over those it was loaded with
 * where they are not NULL. There is none at the moment. */
void gz_window_take_maker(struct gz_window *window, struct gz_frame_maker *maker, const char *path,
			  const struct gz_scene_settings *settings);

/** The scene shown is no more: parts are told, and nothing is freed. @return its maker, NULL if
 *  there was none */
struct gz_frame_maker *gz_window_leave_maker(struct gz_window *window);

/** Take the maker of a job that has finished well as the scene shown. What was shown stays where
 * that fails. @return what gz_frame_maker_start() returns; logged */
enum gz_result gz_window_swap_to_job(struct gz_window *window, struct gz_load_job *job);

/** Whether cpu casts the rays of the next scene: as gz_frame_takes_cpu() says, and from
 *  GZ_WINDOW_LOSSES_TO_CPU on. */
bool gz_window_takes_cpu(struct gz_window *window);

/** Give a maker its renderer, by the backend asked for or, from GZ_WINDOW_LOSSES_TO_CPU on, by cpu.
 *  @return what gz_frame_maker_start() returns; logged */
enum gz_result gz_window_start_maker(struct gz_window *window, struct gz_frame_maker *maker);

/** Look after held scenes in loading. */
void gz_window_turn_held(struct gz_window *window);

/** Their renderers go with the context; they are made anew when they are shown. */
void gz_window_stop_held(struct gz_window *window);

#endif
