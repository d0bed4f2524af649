/**
 * @file
 * gazeview as a child process that shows targets, and the lines in which it reports them.
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

/** Room for a line with its NUL, bytes; longer lines are not understood. */
#define GZ_VIEWER_LINE_SIZE 256

/** What a line reports. */
enum gz_viewer_event_kind {
	GZ_VIEWER_SCREEN,    /**< the monitor that shows the targets */
	GZ_VIEWER_SHOWN,     /**< a target has appeared */
	GZ_VIEWER_HIDDEN,    /**< a target has vanished */
	GZ_VIEWER_FINISHED,  /**< all targets were shown */
	GZ_VIEWER_CANCELLED, /**< the person has cancelled */
	GZ_VIEWER_GONE, /**< not a line: it has closed its output, so it has ended or soon will */
};

/** A parsed line. */
struct gz_viewer_event {
	enum gz_viewer_event_kind kind;
	struct gz_monitor_place monitor; /**< SCREEN; zeroed if unknown */
	size_t index, count;             /**< SHOWN, HIDDEN (index only) */
	struct gz_point point;           /**< SHOWN: on the display */
	int64_t time_ns;                 /**< host time; not in SCREEN and GONE */
};

/**
 * Parse one line, without its newline.
 *
 * @param[out] out_event  written on success only
 * @retval GZ_ERR_FORMAT  it is none of the lines of view/target/target_window.h, or has invalid
 *                        numbers: an index not below the count, a point that is not finite
 */
enum gz_result gz_viewer_event_parse(const char *line, struct gz_viewer_event *out_event);

/** A running gazeview. Zero-initialised: none. */
struct gz_viewer_process {
	pid_t process; /**< 0: none */
	int out;       /**< its standard output; -1: closed */
	const struct gz_log *log;
	size_t used;
	char buffer[GZ_VIEWER_LINE_SIZE];
};

/**
 * Start gazeview.
 *
 * @param[out] viewer  filled; gz_viewer_process_end()
 * @param program      path of gazeview; empty: in the directory of this program, else in PATH
 * @param arguments    arguments after its name, NULL-terminated, at most 40
 * @param log          borrowed; may be NULL
 * @retval GZ_ERR_NOT_FOUND  the program does not exist or cannot be run; logged
 * @retval GZ_ERR_NO_MEM     no pipe or no process; logged
 */
enum gz_result gz_viewer_process_start(struct gz_viewer_process *viewer, const char *program,
				       const char *const *arguments, const struct gz_log *log);

/**
 * Read the next line. Never waits.
 *
 * @param[out] out_event  written on success only
 * @retval GZ_ERR_TIMEOUT  there is no line now
 * @retval GZ_ERR_FORMAT   the line is not understood; logged; the next call goes on after it
 */
enum gz_result gz_viewer_process_read(struct gz_viewer_process *viewer,
				      struct gz_viewer_event *out_event);

/**
 * End gazeview if it is still running, and wait until it has ended. One that does not react to
 * SIGTERM within two seconds is killed.
 *
 * @return its exit status; -1 if a signal ended it, or if none was running
 */
int gz_viewer_process_end(struct gz_viewer_process *viewer);

#endif
