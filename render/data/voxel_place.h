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

/** How numbers of one type become voxels. */
struct gz_voxel_conversion {
	size_t size;             /**< bytes of a number in the file */
	enum gz_voxel_type type; /**< of the voxels */
	double offset;           /**< number = voxel + offset */
	/** Convert @p count numbers. @p source need not be aligned; @p swap: its byte order is not
	 *  the host's. */
	void (*convert)(const uint8_t *source, size_t count, bool swap, void *target);
};

/** Indexed by enum gz_raw_type. */
extern const struct gz_voxel_conversion gz_voxel_conversions[GZ_RAW_TYPE_COUNT];

/** Write @p count voxels to @p target, @p stride voxels apart (may be negative). */
void gz_voxel_scatter(enum gz_voxel_type type, const void *source, size_t count, void *target,
		      ptrdiff_t stride);

/** Where the voxels of a file are placed in a volume. */
struct gz_voxel_place {
	int dims[3];         /**< of the file, the fastest first */
	ptrdiff_t first;     /**< index in the volume of the file's first voxel */
	ptrdiff_t stride[3]; /**< step in the volume along each axis of the file, voxels; negative
				if the axis is flipped */
};

/**
 * How many voxels to place at once.
 *
 * @param type   of the volume's voxels
 * @param index  number of the first of them in the file: 0, or where the previous slab ended
 * @return 1 to gz_voxel_place_most(); no more than are left
 */
size_t gz_voxel_place_next(const struct gz_voxel_place *place, enum gz_voxel_type type,
			   uint64_t index);

/** The most voxels that gz_voxel_place_next() asks for. They take at most 2 MiB, 1/128 of the
 * volume, or one row or slice of it, whichever is largest. */
size_t gz_voxel_place_most(const struct gz_voxel_place *place, enum gz_voxel_type type);

/**
 * Place voxels in @p volume.
 *
 * @param voxels  in the order of the file, already converted
 * @param index   number of the first voxel in the file
 * @param count   the result of gz_voxel_place_next() for @p index and the volume's type, or one of
 *                more bytes
 */
void gz_voxel_place(const struct gz_voxel_place *place, const struct gz_volume *volume,
		    const void *voxels, uint64_t index, size_t count);

#endif
