/**
 * @file
 * A volume to a NRRD file that most programs read.
 */
#ifndef GZ_RENDER_NRRD_WRITE_H
#define GZ_RENDER_NRRD_WRITE_H

#include "base/log.h"
#include "base/result.h"
#include "render/volume/volume.h"

/**
 * Write @p volume as NRRD, encoding raw, under another name until it is whole. Voxels are written
 * as they are stored; as signed integers where the intercept says that they are.
 *
 * @param loading  told how far it is, may stop it
 * @retval GZ_ERR_INVAL        @p volume has no voxels
 * @retval GZ_ERR_UNSUPPORTED  its values are scaled, which NRRD cannot say; logged
 * @retval GZ_ERR_IO           @p path cannot be written; logged
 * @retval GZ_ERR_FULL         the disk is full; logged
 * @retval GZ_ERR_CANCELLED    @p loading said so; not logged
 *
 * On failure nothing is left behind.
 */
enum gz_result gz_nrrd_write(const struct gz_volume *volume, const char *path,
			     const struct gz_loading *loading, const struct gz_log *log);

#endif
