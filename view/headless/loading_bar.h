/**
 * @file
 * The progress bar at a terminal while a volume is loaded, and cancelling by Ctrl-C.
 */
#ifndef GZ_VIEW_HEADLESS_LOADING_BAR_H
#define GZ_VIEW_HEADLESS_LOADING_BAR_H

#include <signal.h>
#include <stdbool.h>
#include <stdint.h>

#include "base/log.h"
#include "render/data/loading.h"

/** The bar. Pass its loading to gz_scene_open(); it must not move until gz_loading_bar_end(). */
struct gz_loading_bar {
	struct gz_loading loading;
	const struct gz_log *log;
	int64_t begin_ns, next_ns;
	bool terminal; /**< stderr is a terminal */
	bool drawn;    /**< the bar is shown, or the line has been written */
	struct sigaction interrupt, terminate; /**< previous handlers */
};

/**
 * Start a bar. If stderr is a terminal, it appears after 0.3 s and is redrawn in place; otherwise
 * one line is logged after a second. SIGINT and SIGTERM cancel the loading until
 * gz_loading_bar_end(); a second signal of the same kind ends the program. Only one bar may exist
 * in a process.
 */
void gz_loading_bar_begin(struct gz_loading_bar *bar, const struct gz_log *log);

/** Clear the bar, restore the signal handlers, and raise the signal that cancelled the loading, if
 * any, for the previous handler. */
void gz_loading_bar_end(struct gz_loading_bar *bar);

/**
 * Print the text of a bar without control characters, at most 78 columns.
 *
 * @param what     what is loaded; the beginning of a long text is cut
 * @param share    fraction done, 0 to 1
 * @param spent_s  time so far, s; gives the time left once share is above 0.01
 */
void gz_loading_bar_text(const char *what, double share, double spent_s, char *out, size_t size);

#endif
