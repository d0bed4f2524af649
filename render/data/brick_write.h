/**
 * @file
 * A volume to a file of bricks.
 */
#ifndef GZ_RENDER_DATA_BRICK_WRITE_H
#define GZ_RENDER_DATA_BRICK_WRITE_H

#include "base/log.h"
#include "base/result.h"
#include "render/data/volume.h"

/**
 * Write @p volume and its coarser levels to @p path, under another name until it is whole.
 *
 * @param volume   with voxels; if these are in a scratch file, so are those of the levels
 * @param path     replaced if it exists
 * @param loading  told how far it is, may stop it; its scratch is where the levels are kept, NULL
 * for memory: an eighth of the volume, and an eighth of that
 * @retval GZ_ERR_INVAL      @p volume has no voxels
 * @retval GZ_ERR_IO         @p path cannot be written; logged
 * @retval GZ_ERR_FULL       the disk is full; logged
 * @retval GZ_ERR_NO_MEM     no room for the levels; logged
 * @retval GZ_ERR_CANCELLED  @p loading said so; not logged
 *
 * On failure nothing is left behind.
 */
enum gz_result gz_bricks_write(const struct gz_volume *volume, const char *path,
			       const struct gz_loading *loading, const struct gz_log *log);

#endif
