/** @file
 * An animal made of tubes: soft tissue, a rough skin and a skeleton of thin bones.
 */
#pragma once

#include "render/data/volume.h"

/** All tubes of the animal, and how finely they are drawn. */
struct gz_chameleon;

/**
 * Lay out the animal for voxels of @p voxel_length, in units of half the longest edge of the box:
 * what is thinner becomes fainter instead of broken. The caller frees it with
 * gz_chameleon_destroy().
 *
 * @retval GZ_ERR_NO_MEM
 */
enum gz_result gz_chameleon_create(double voxel_length, struct gz_chameleon **out_chameleon);

/** Accepts NULL and half-built ones. */
void gz_chameleon_destroy(struct gz_chameleon **chameleon);

/**
 * One row of values, 0 to 1. Any number of threads may do this with the same @p chameleon.
 *
 * @param y,z         of the row, -1 to 1
 * @param first,step  x of the first value, and between two, more than 0
 * @param count       of values
 */
void gz_chameleon_row(const struct gz_chameleon *chameleon, double y, double z, double first,
		      double step, int count, float *out_values);
