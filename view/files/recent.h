/**
 * @file
 * The list of recently shown files: $XDG_STATE_HOME/gazecast/recent, otherwise
 * ~/.local/state/gazecast/recent (XDG Base Directory Specification 0.8). One absolute path a line,
 * newest first.
 */
#ifndef GZ_VIEW_FILES_RECENT_H
#define GZ_VIEW_FILES_RECENT_H

#include <stdbool.h>
#include <stddef.h>

#include "base/log.h"
#include "base/result.h"
#include "protocol/gaze.h"
#include "render/picture/image.h"

/** Largest number of paths. Chosen: a list that can be read at a glance. */
#define GZ_RECENT_MAX 12

/** The list. Zero-initialised: empty. */
struct gz_recent {
	char paths[GZ_RECENT_MAX][GZ_PATH_SIZE];
	size_t count;
};

/**
 * The path of the list's file.
 *
 * @retval GZ_ERR_NOT_FOUND  neither XDG_STATE_HOME nor HOME is an absolute path, or it is too long
 */
enum gz_result gz_recent_file(char out_path[GZ_PATH_SIZE]);

/** Read the list. Lines that are not absolute paths or are too long are skipped; a missing file
 * gives an empty list. */
void gz_recent_read(const char *file, struct gz_recent *out_recent);

/** Move @p path, made absolute, to the top of the list. A path that does not exist, is too long or
 * contains a line break is ignored. */
void gz_recent_add(struct gz_recent *recent, const char *path);

/** Whether @p path is the newest of the list. */
bool gz_recent_is_first(const struct gz_recent *recent, const char *path);

/**
 * Where the small picture of a recent file is kept: beside the list, under a name made of the path.
 *
 * @retval GZ_ERR_NOT_FOUND  as gz_recent_file()
 */
enum gz_result gz_recent_picture(const char *path, char out_path[GZ_PATH_SIZE]);

/** Write such a picture as PNG, creating its folders. @return what gz_image_write_png() returns */
enum gz_result gz_recent_write_picture(const struct gz_image *image, const char *file,
				       const struct gz_log *log);

/**
 * Write the list, creating its folders.
 *
 * @retval GZ_ERR_IO  the file cannot be written, as in a read-only home; logged as information
 */
enum gz_result gz_recent_write(const struct gz_recent *recent, const char *file,
			       const struct gz_log *log);

#endif
