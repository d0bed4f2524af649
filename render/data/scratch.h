/**
 * @file
 * Nameless files on a disk that hold voxels, so that a volume may be larger than memory.
 */
#ifndef GZ_RENDER_DATA_SCRATCH_H
#define GZ_RENDER_DATA_SCRATCH_H

#include <stddef.h>

#include "base/result.h"

/**
 * Make a file without a name in a folder; its disk space is free again when it is closed and no
 * longer mapped.
 *
 * @param[out] out_fd  to read and write, closed on exec; owned by the caller
 * @retval GZ_ERR_NOT_FOUND  no such folder; not logged
 * @retval GZ_ERR_IO         no file can be made there; not logged
 */
enum gz_result gz_scratch_open(const char *folder, int *out_fd);

/**
 * Give the file its size, above 0. Its blocks are reserved, so that a full disk is an error here
 * and not a signal later.
 *
 * @retval GZ_ERR_FULL  the disk is full; not logged
 * @retval GZ_ERR_IO    not logged
 */
enum gz_result gz_scratch_reserve(int fd, size_t bytes);

#endif
