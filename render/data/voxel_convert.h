/**
 * @file
 * Numbers of a file to voxels of a volume, a row at a time.
 */
#ifndef GZ_RENDER_DATA_VOXEL_CONVERT_H
#define GZ_RENDER_DATA_VOXEL_CONVERT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "render/data/volume.h"

/** How one type of number is read. */
struct gz_voxel_conversion {
	size_t size;             /**< bytes of a number in the file */
	enum gz_voxel_type type; /**< what it becomes */
	double offset;           /**< number = voxel + offset */
	/** @p source need not be aligned; @p swap: its byte order is not the host's. */
	void (*convert)(const uint8_t *source, size_t count, bool swap, void *target);
};

/** One a raw type. */
extern const struct gz_voxel_conversion gz_voxel_conversions[GZ_RAW_TYPE_COUNT];

/** Write @p count voxels to @p target, @p stride voxels apart (may be negative). */
void gz_voxel_scatter(enum gz_voxel_type type, const void *source, size_t count, void *target,
		      ptrdiff_t stride);

#endif
