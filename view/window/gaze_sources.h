/**
 * @file
 * The part of the window that has the sources of the gaze: which one is asked for, which others
 * there are, and how far a log has been gone through. What is asked for is settings.view.gaze, by
 * whatever it was changed. Internal to view/.
 */
#ifndef GZ_VIEW_WINDOW_GAZE_SOURCES_H
#define GZ_VIEW_WINDOW_GAZE_SOURCES_H

#include "view/window/part.h"
#include "view/window/window_state.h"

/** What M goes through, in this order. */
enum gz_window_source {
	GZ_WINDOW_DAEMON,
	GZ_WINDOW_MOUSE,
	GZ_WINDOW_POINTER,
	GZ_WINDOW_ENDPOINT,
	GZ_WINDOW_LOG,
	GZ_WINDOW_FIXED,
	GZ_WINDOW_SOURCE_COUNT,
};

/** Time in a log. */
struct gz_window_log_clock {
	int64_t base_ns;   /**< where it was at anchor_ns, from its first sample */
	int64_t anchor_ns; /**< host time; 0: it has not been looked at */
	bool paused;
	bool seeking; /**< it is on its way there, and its clock waits */
};

/** The part's state. */
struct gz_window_sources {
	struct gz_gaze_choice choice; /**< what window->source was made of */
	char text[GZ_PATH_SIZE];      /**< the same as --gaze has it */
	/** Each of the sources as --gaze has it; empty where none is known. */
	char named[GZ_WINDOW_SOURCE_COUNT][GZ_PATH_SIZE];
	struct gz_window_log_clock log;
	char linked[GZ_PATH_SIZE];       /**< the latest channel that window->link is beside */
	bool pointer_told;               /**< the daemon there was told of the pointer */
	char tracker_seen[GZ_NAME_SIZE]; /**< that the local daemon reads; empty: not known */
};

/** The part. */
extern const struct gz_window_part gz_window_gaze_sources;

/** Which of the sources is asked for. */
enum gz_window_source gz_window_source_now(const struct gz_window *window);

/** Ask for the gaze from somewhere else, as --gaze has it. What it is refused for is logged; then
 * all stays. */
void gz_window_ask_for_gaze(struct gz_window *window, const char *text);

/** Read the source that is asked for, as of now. There is one. */
void gz_window_read_source(struct gz_window *window, struct gz_gaze_reading *out_reading);

/** Let a log's time stand still, or go on. */
void gz_window_pause_log(struct gz_window *window, bool paused);

/** Go to a place in a log, ns from its first sample. */
void gz_window_seek_log(struct gz_window *window, int64_t place_ns);

#endif
