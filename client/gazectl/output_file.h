/**
 * @file
 * A file that appears under its name only when it is whole: written beside it and renamed.
 */
#ifndef GZ_CLIENT_GAZECTL_OUTPUT_FILE_H
#define GZ_CLIENT_GAZECTL_OUTPUT_FILE_H

#include <stdbool.h>
#include <stdio.h>
#include <zlib.h>

#include "base/log.h"
#include "base/result.h"
#include "protocol/gaze.h"

/** A file being written; zero-initialised is none. */
struct gz_output_file {
	int fd;
	FILE *text; /**< one of these two, where it was asked for */
	gzFile gzip;
	bool open;
	char path[GZ_PATH_SIZE];
	char partial[GZ_PATH_SIZE + 8];
};

/** How a file is written. */
enum gz_output_kind {
	GZ_OUTPUT_RAW,  /**< by its descriptor */
	GZ_OUTPUT_TEXT, /**< by stdio */
	GZ_OUTPUT_GZIP, /**< by zlib */
};

/**
 * Begin.
 *
 * @param overwrite  whether a file of that name may be replaced
 * @retval GZ_ERR_BUSY   there is one and it may not; logged with the remedy
 * @retval GZ_ERR_INVAL  @p path is too long; logged
 * @retval GZ_ERR_IO, GZ_ERR_NO_MEM  logged
 */
enum gz_result gz_output_begin(struct gz_output_file *file, const char *path, bool overwrite,
			       enum gz_output_kind kind, const struct gz_log *log);

/**
 * Whether @p path is a name for a picture, which is SVG whatever it is called. "" is none and good.
 *
 * @retval GZ_ERR_INVAL  it ends in something else; logged with the remedy
 */
enum gz_result gz_output_check_svg(const char *path, const struct gz_log *log);

/**
 * End: give the file its name if @p complete, else remove it. Does nothing to one that is none.
 *
 * @retval GZ_ERR_IO  not all of it could be written: removed; logged
 */
enum gz_result gz_output_end(struct gz_output_file *file, bool complete, const struct gz_log *log);

#endif
