/**
 * @file
 * A volume to a NRRD file that most programs read.
 */
#ifndef GZ_RENDER_DATA_NRRD_WRITE_H
#define GZ_RENDER_DATA_NRRD_WRITE_H

#include "base/log.h"
#include "base/result.h"
#include "render/data/volume.h"

/**
 * Write @p volume as NRRD, encoding raw, under another name until it is whole. NRRD cannot say that
 * values are scaled, so that the values themselves are written: as integers of 8 or 16 bits where
 * all of them are such, those with a negative intercept signed; else as floats.
 *
 * @param loading  told how far it is, may stop it
 * @retval GZ_ERR_INVAL        @p volume has no voxels
 * @retval GZ_ERR_IO           @p path cannot be written; logged
 * @retval GZ_ERR_FULL         the disk is full; logged
 * @retval GZ_ERR_CANCELLED    @p loading said so; not logged
 *
 * On failure nothing is left behind.
 */
enum gz_result gz_nrrd_write(const struct gz_volume *volume, const char *path,
			     const struct gz_loading *loading, const struct gz_log *log);

#endif
