/**
 * @file
 * A picture of a recording: the path of the gaze over the display with its fixations, and both
 * coordinates over time. SVG, which any browser shows.
 */
#ifndef GZ_CLIENT_GAZECTL_INSPECT_LOG_PICTURE_H
#define GZ_CLIENT_GAZECTL_INSPECT_LOG_PICTURE_H

#include <stdio.h>

#include "base/log.h"
#include "base/result.h"
#include "protocol/gaze_log.h"

/** Most points of the path that are drawn; the picture says if the path is cut there. Chosen: a
 * file of about a megabyte. */
#define GZ_LOG_PICTURE_POINTS 60000

/** Most fixations that are drawn; further ones are left out. */
#define GZ_LOG_PICTURE_FIXATIONS 5000

/**
 * Draw the log in @p reader, which is read to its end.
 *
 * @param name      title of the picture
 * @param first_ns  host time of the first sample
 * @param last_ns   host time of the last sample
 * @param out       takes the picture; the caller checks ferror()
 * @param log       takes a warning for settings that cannot be applied; may be NULL
 * @retval GZ_ERR_NO_MEM  no memory for the points
 * @retval GZ_ERR_IO      reading failed; logged by the reader
 */
enum gz_result gz_log_picture(struct gz_gaze_log_reader *reader, const char *name, int64_t first_ns,
			      int64_t last_ns, const struct gz_log *log, FILE *out);

#endif
