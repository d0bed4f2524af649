/**
 * @file
 * Volumes of formulas and of noise, for the tests of meshes.
 */
#ifndef GZ_TESTS_RENDER_MESH_FIELDS_H
#define GZ_TESTS_RENDER_MESH_FIELDS_H

#include <stdint.h>

#include "render/data/volume.h"

/** A formula: the data value at a place, mm; the origin is the centre of the volume's box. */
typedef double field_formula(const double place[3]);

/** A ball of radius 20 mm, and a ring of radii 18 and 7 mm round the z axis: the distance into it,
 *  mm. */
double field_ball(const double place[3]);
double field_ring(const double place[3]);

/** A volume of a formula. Integers are cut to -8 to 8 and cover that range; slope and intercept
 * take it back. */
struct gz_volume field_volume(field_formula *formula, const int dims[3], const double spacing[3],
			      enum gz_voxel_type type);

/** A random number, 0 to 1. */
double field_random(uint32_t *seed);

/** A volume of random numbers: all of 0 to 255 for integers, and 0 to 1 for floats. Its outermost
 *  voxels are 0 if @p walled. */
struct gz_volume field_noise(const int dims[3], enum gz_voxel_type type, uint32_t seed, int walled);

#endif
