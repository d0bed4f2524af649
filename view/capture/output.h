/**
 * @file
 * The files that gazeview writes: a check before anything is loaded, and names made from the time.
 */
#ifndef GZ_VIEW_CAPTURE_OUTPUT_H
#define GZ_VIEW_CAPTURE_OUTPUT_H

#include <stddef.h>

#include "base/log.h"
#include "base/result.h"
#include "protocol/gaze.h"
#include "view/options/options.h"

/** The folder of @p path; "." if the path has none. Cut to @p size bytes. */
void gz_output_folder(const char *path, char *out, size_t size);

/**
 * Check that the files of --out, --print, --video, --stats, --write-mesh and --write-volume can be
 * written: each exists and is writable, or its folder is.
 *
 * @retval GZ_ERR_IO  one cannot be written; logged with the option and the remedy
 */
enum gz_result gz_output_check(const struct gz_view_options *options, const struct gz_log *log);

/**
 * A name for a file that the window writes: "FOLDER/gazeview-YYYYmmdd-HHMMSS" in local time and
 * @p ending. If that exists, "_2", "_3", … is inserted before the ending; these sort after it.
 *
 * @param[out] out_path  a path that does not exist
 * @retval GZ_ERR_FULL   the path is too long, or 100 files of this second exist
 */
enum gz_result gz_capture_name(const char *folder, const char *ending, char out_path[GZ_PATH_SIZE]);

#endif
