/**
 * @file
 * Names of what a window writes without being asked for a name: by the time of day.
 */
#ifndef GZ_VIEW_CAPTURE_FILE_NAME_H
#define GZ_VIEW_CAPTURE_FILE_NAME_H

#include "base/result.h"
#include "protocol/gaze.h"

/**
 * "FOLDER/gazeview-YYYYmmdd-HHMMSS" by local time with @p ending behind it, and "_2", "_3", …,
 * which sort behind it, before that where there is one already.
 *
 * @param[out] out_path  of nothing that is there
 * @retval GZ_ERR_FULL   the path is too long, or there are a hundred of this second
 */
enum gz_result gz_capture_name(const char *folder, const char *ending, char out_path[GZ_PATH_SIZE]);

#endif
