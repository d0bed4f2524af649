/**
 * @file
 * From the numbers of a file to the voxels of a volume: conversion of types, and placing in a
 * volume whose axes are turned.
 *
 * If the volume's fastest axis is not the file's, neighbours in memory are rows or slices apart in
 * the file. Voxels are therefore placed in slabs of as many rows or slices as fill a cache line of
 * the volume, in small tiles, so that each line is written once and not once for each voxel.
 */
#ifndef GZ_RENDER_DATA_VOXEL_PLACE_H
#define GZ_RENDER_DATA_VOXEL_PLACE_H

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

/** Where the voxels of a file go. */
struct gz_voxel_place {
	int dims[3];         /**< of the file, the fastest first */
	ptrdiff_t first;     /**< the volume's voxel that the file's first one is */
	ptrdiff_t stride[3]; /**< voxels of the volume from one to the next along each axis of the
				file; negative where it is flipped */
};

/**
 * How many voxels to place at once.
 *
 * @param type   of the volume's voxels
 * @param index  of the first of them in the file: 0, or where the slab before ended
 * @return 1 to gz_voxel_place_most(); no more than are left
 */
size_t gz_voxel_place_next(const struct gz_voxel_place *place, enum gz_voxel_type type,
			   uint64_t index);

/** The most that gz_voxel_place_next() asks for. Their bytes are at most 2 MiB, 1/128 of the volume
 *  or one row or slice of it, whichever is the most. */
size_t gz_voxel_place_most(const struct gz_voxel_place *place, enum gz_voxel_type type);

/**
 * Put voxels into @p volume.
 *
 * @param voxels  in the order of the file, converted already
 * @param index   the first one's number in the file
 * @param count   what gz_voxel_place_next() told for @p index
 */
void gz_voxel_place(const struct gz_voxel_place *place, const struct gz_volume *volume,
		    const void *voxels, uint64_t index, size_t count);

#endif
