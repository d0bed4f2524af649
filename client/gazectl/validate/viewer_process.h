/**
 * @file
 * gazeview as a child that shows targets, and the lines in which it tells what is on the display.
 */
#ifndef GZ_CLIENT_GAZECTL_VALIDATE_VIEWER_PROCESS_H
#define GZ_CLIENT_GAZECTL_VALIDATE_VIEWER_PROCESS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <sys/types.h>

#include "base/log.h"
#include "base/result.h"
#include "protocol/display.h"

/** Longest line that is understood, with its NUL. */
#define GZ_VIEWER_LINE_SIZE 256

/** What a line tells of. */
enum gz_viewer_event_kind {
	GZ_VIEWER_SCREEN, /**< the display's pixels */
	GZ_VIEWER_SHOWN,
	GZ_VIEWER_HIDDEN,
	GZ_VIEWER_FINISHED,
	GZ_VIEWER_CANCELLED,
	GZ_VIEWER_GONE, /**< it has closed its output: it has ended, or is about to */
};

/** One line, understood. */
struct gz_viewer_event {
	enum gz_viewer_event_kind kind;
	int px[2];             /**< SCREEN; 0 0 if it does not know */
	size_t index, count;   /**< SHOWN, HIDDEN (index only) */
	struct gz_point point; /**< SHOWN: on the display */
	int64_t time_ns;       /**< all but SCREEN and GONE: host time */
};

/**
 * Understand one line, without its newline.
 *
 * @param[out] out_event  written on success only
 * @retval GZ_ERR_FORMAT  it is none of the lines of view/target_window.h, or has numbers that
 *                        cannot be: an index not below the count, a place that is not finite
 */
enum gz_result gz_viewer_event_parse(const char *line, struct gz_viewer_event *out_event);

/** A running gazeview. Zero-initialised is none. */
struct gz_viewer_process {
	pid_t process; /**< 0: none */
	int out;       /**< its standard output, to be polled; -1 when it is closed */
	const struct gz_log *log;
	size_t used;
	char buffer[GZ_VIEWER_LINE_SIZE];
};

/**
 * Start it.
 *
 * @param program    path of gazeview; empty: beside this program, else in PATH
 * @param arguments  behind its name, NULL-terminated
 * @param log        borrowed; may be NULL
 * @retval GZ_ERR_NOT_FOUND  there is no such program; logged
 * @retval GZ_ERR_NO_MEM     no room for a process; logged
 */
enum gz_result gz_viewer_process_start(struct gz_viewer_process *viewer, const char *program,
				       const char *const *arguments, const struct gz_log *log);

/**
 * Take the next line that is there; never waits.
 *
 * @retval GZ_ERR_TIMEOUT  none is there now
 * @retval GZ_ERR_FORMAT   a line that is not understood, logged; go on or give up
 */
enum gz_result gz_viewer_process_read(struct gz_viewer_process *viewer,
				      struct gz_viewer_event *out_event);

/**
 * End it if it still runs, and wait until it has gone.
 *
 * @return its exit status; -1 if a signal ended it or there was none
 */
int gz_viewer_process_end(struct gz_viewer_process *viewer);

#endif
