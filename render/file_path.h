/**
 * @file
 * File names: endings, and names relative to another file.
 */
#ifndef GZ_RENDER_FILE_PATH_H
#define GZ_RENDER_FILE_PATH_H

#include <stdbool.h>
#include <stddef.h>

#include "base/result.h"

/** Whether @p path ends in @p ending, upper and lower case being the same. */
bool gz_path_ends(const char *path, const char *ending);

/**
 * The path of @p name as seen from the folder of @p file: an absolute name stays.
 *
 * @param[out] out_path  @p size bytes
 * @retval GZ_ERR_FULL   it does not fit; @p out_path is an empty string
 */
enum gz_result gz_path_beside(const char *file, const char *name, char *out_path, size_t size);

#endif
