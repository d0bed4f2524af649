/**
 * @file
 * The part of the window that has the sources of the gaze, what it gives each turn, and what the
 * window reports to the daemon. The source asked for is settings.view.gaze, whoever changes it.
 * Internal to view/; main thread only.
 */
#ifndef GZ_VIEW_WINDOW_GAZE_H
#define GZ_VIEW_WINDOW_GAZE_H

#include "view/window/window_state.h"

/** Sources, in the order in which M goes through them. */
enum gz_window_source {
	GZ_WINDOW_DAEMON,
	GZ_WINDOW_MOUSE,
	GZ_WINDOW_POINTER,
	GZ_WINDOW_ENDPOINT,
	GZ_WINDOW_LOG,
	GZ_WINDOW_FIXED,
	GZ_WINDOW_SOURCE_COUNT,
};

/** Clock of a gaze log. */
struct gz_window_log_clock {
	int64_t base_ns;   /**< position at anchor_ns, from the first sample */
	int64_t anchor_ns; /**< host time; 0: the clock has not begun */
	bool paused;
	bool seeking; /**< the log is being read up to its position, and the clock waits */
};

/** State of part gaze. */
struct gz_window_sources {
	struct gz_gaze_choice choice; /**< what window->source was made from */
	char text[GZ_PATH_SIZE];      /**< the same as text of --gaze */
	/** Each source as text of --gaze; empty: not known. */
	char named[GZ_WINDOW_SOURCE_COUNT][GZ_PATH_SIZE];
	struct gz_window_log_clock log;
	char linked[GZ_PATH_SIZE];       /**< latest channel of the daemon of window->link */
	bool pointer_told;               /**< the pointer was reported to that daemon */
	char tracker_seen[GZ_NAME_SIZE]; /**< tracker of the local daemon; empty: not known */
};

/** The source asked for. */
enum gz_window_source gz_window_source_now(const struct gz_window *window);

/** Ask for another source, by text of --gaze. If that fails, the present one stays; logged. */
void gz_window_ask_for_gaze(struct gz_window *window, const char *text);

/** Pause a log, or go on. */
void gz_window_pause_log(struct gz_window *window, bool paused);

/** Go to a position in a log, ns from its first sample. */
void gz_window_seek_log(struct gz_window *window, int64_t place_ns);

/** The gaze of this turn, on a framebuffer of @p width times @p height px. */
void gz_window_gaze_now(struct gz_window *window, int width, int height,
			struct gz_window_gaze *out_gaze);

/** Longest time until the gaze must be read again, s, if no event comes before. */
double gz_window_gaze_patience_s(const struct gz_window *window);

/** Report to the daemon of the gaze where the window is and, for the source "pointer", where the
 * mouse is, if that has changed. Waits for nothing. */
void gz_window_report(struct gz_window *window);

#endif
