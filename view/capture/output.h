/**
 * @file
 * Where gazeview's files go: looked at before anything is loaded or rendered for them.
 */
#ifndef GZ_VIEW_CAPTURE_OUTPUT_H
#define GZ_VIEW_CAPTURE_OUTPUT_H

#include "protocol/gaze.h"
#include <stddef.h>

#include "base/log.h"
#include "base/result.h"
#include "view/options/options.h"

/** The folder that @p path is in: "." where it names none. Cut to @p size bytes. */
void gz_output_folder(const char *path, char *out, size_t size);

/**
 * Check that the files that the options name (--out, --video, --stats, --write-volume) can be made:
 * that their folders are there and may be written to, or they are there themselves.
 *
 * @retval GZ_ERR_IO  one cannot; logged with the option and the remedy
 */
enum gz_result gz_output_check(const struct gz_view_options *options, const struct gz_log *log);

/**
 * "FOLDER/gazeview-YYYYmmdd-HHMMSS" by local time with @p ending behind it, and "_2", "_3", …,
 * which sort behind it, before that where there is one already.
 *
 * @param[out] out_path  of nothing that is there
 * @retval GZ_ERR_FULL   the path is too long, or there are a hundred of this second
 */
enum gz_result gz_capture_name(const char *folder, const char *ending, char out_path[GZ_PATH_SIZE]);

#endif
