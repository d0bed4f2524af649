/**
 * @file
 * Places of the gaze from a table of numbers: a CSV file.
 *
 * Each line is a place: how far it lies from the left and from the top, parted by a comma,
 * semicolon, tab or blanks; what follows on the line is left alone. A first line that does not
 * begin with a number is a heading. Empty lines, and lines that begin with #, are left out.
 */
#ifndef GZ_BENCH_STUDY_GAZE_PATH_TABLE_H
#define GZ_BENCH_STUDY_GAZE_PATH_TABLE_H

#include "base/log.h"
#include "base/result.h"
#include "protocol/display.h"

/** Takes one place. @return GZ_OK, or what ends the reading */
typedef enum gz_result gz_gaze_place_function(void *user, struct gz_point gaze);

/**
 * Read a table.
 *
 * @param size  of the picture in whose pixels the places are; NULL: they are shares of the picture
 * @retval GZ_ERR_NOT_FOUND  no such file; logged
 * @retval GZ_ERR_FORMAT     a line is no place, or lies a hundred pictures away; logged with its
 *                           number
 * @retval GZ_ERR_IO, GZ_ERR_NO_MEM  logged
 * @return what @p take has returned instead of GZ_OK
 */
enum gz_result gz_gaze_path_table_read(const char *path, const int size[2],
				       const struct gz_log *log, gz_gaze_place_function *take,
				       void *user);

#endif
