/**
 * @file
 * Which volume something was made of: sessions and pictures keep it, to tell where the data have
 * become others.
 */
#ifndef GZ_RENDER_DATA_VOLUME_IDENTITY_H
#define GZ_RENDER_DATA_VOLUME_IDENTITY_H

#include <stdbool.h>
#include <stdint.h>

#include "render/data/volume.h"

/** What two volumes hardly share by chance. */
struct gz_volume_identity {
	int dims[3];
	enum gz_voxel_type type;
	double spacing[3];
	double least, greatest; /**< data values, as of slope and intercept */
	bool has_crc;           /**< voxels were looked at: none are at hand of a file of bricks */
	uint32_t crc;           /**< CRC-32 of some of the voxels, see gz_volume_identify() */
};

/**
 * Tell which volume it is.
 *
 * The CRC is of 4096 runs of 64 bytes, evenly strewn over the voxels, or of all where they are
 * fewer: enough to tell volumes apart, and quick for one of any size.
 */
struct gz_volume_identity gz_volume_identify(const struct gz_volume *volume);

/** Whether both are of one volume; of a CRC that one of them lacks, nothing is asked. */
bool gz_volume_identity_same(const struct gz_volume_identity *a,
			     const struct gz_volume_identity *b);

#endif
