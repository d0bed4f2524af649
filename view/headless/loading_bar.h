/**
 * @file
 * What somebody at a terminal sees while a volume is loaded, and Ctrl-C meanwhile.
 */
#ifndef GZ_VIEW_HEADLESS_LOADING_BAR_H
#define GZ_VIEW_HEADLESS_LOADING_BAR_H

#include <signal.h>
#include <stdbool.h>
#include <stdint.h>

#include "base/log.h"
#include "render/data/loading.h"

/** One loading. Its loading goes to gz_scene_load(); it must stay where it is until the end. */
struct gz_loading_bar {
	struct gz_loading loading;
	const struct gz_log *log;
	int64_t begin_ns, next_ns;
	bool terminal; /**< stderr is one */
	bool drawn;    /**< a bar stands there, or the line has been written */
	struct sigaction interrupt, terminate; /**< what was there before */
};

/**
 * Make a bar that appears on stderr once loading has taken a moment: drawn anew in place where that
 * is a terminal, else one line of the log after a second. SIGINT and SIGTERM stop the loading until
 * gz_loading_bar_end(); a second one of a kind ends the program. One at a time in a process.
 */
void gz_loading_bar_begin(struct gz_loading_bar *bar, const struct gz_log *log);

/** Wipe the bar, give the signals back, and raise the one that stopped the loading, if any, for
 * whoever had it before. */
void gz_loading_bar_end(struct gz_loading_bar *bar);

/** Write the text of a bar, without control characters, to @p out: what, share and seconds left,
 *  which are known once there is a share. At most 78 columns; a long name loses its beginning. */
void gz_loading_bar_text(const char *what, double share, double spent_s, char *out, size_t size);

#endif
