/**
 * @file
 * Memory in a nameless file, for what may be larger than the machine's memory.
 */
#ifndef GZ_RENDER_DATA_SCRATCH_H
#define GZ_RENDER_DATA_SCRATCH_H

#include <stddef.h>

#include "base/result.h"

/**
 * Map @p bytes of a new nameless file in the folder @p folder, zeroed. Its blocks are reserved
 * first, so that a full disk is an error here and not a signal later.
 *
 * @param[out] out_memory  ended by munmap(), which frees the blocks too
 * @retval GZ_ERR_NOT_FOUND  no such folder
 * @retval GZ_ERR_FULL       the disk has no room for it
 * @retval GZ_ERR_IO         no file can be made there
 * @retval GZ_ERR_NO_MEM     no room in the address space
 */
enum gz_result gz_scratch_map(const char *folder, size_t bytes, void **out_memory);

#endif
