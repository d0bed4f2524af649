/**
 * @file
 * What has been shown lately: a list in $XDG_STATE_HOME/gazecast/recent, else
 * ~/.local/state/gazecast/recent (XDG Base Directory Specification 0.8), one absolute path a line,
 * the latest first.
 */
#ifndef GZ_VIEW_FILES_RECENT_H
#define GZ_VIEW_FILES_RECENT_H

#include <stddef.h>

#include "base/log.h"
#include "base/result.h"
#include "protocol/gaze.h"

/** Chosen: a list that is taken in at a glance. */
#define GZ_RECENT_MAX 12

/** Zero-initialised is empty. */
struct gz_recent {
	char paths[GZ_RECENT_MAX][GZ_PATH_SIZE];
	size_t count;
};

/** Where the list is kept. @retval GZ_ERR_NOT_FOUND  neither variable is set, or too long */
enum gz_result gz_recent_file(char out_path[GZ_PATH_SIZE]);

/** Read a list; lines that are no absolute path or too long are left out. A file that is not there
 *  is an empty list. */
void gz_recent_read(const char *file, struct gz_recent *out_recent);

/** Put a path on top, made absolute; it is in the list once. Nothing for what is not there. */
void gz_recent_add(struct gz_recent *recent, const char *path);

/** Write a list, making its folder. GZ_ERR_IO: it cannot be written; logged */
enum gz_result gz_recent_write(const struct gz_recent *recent, const char *file,
			       const struct gz_log *log);

#endif
