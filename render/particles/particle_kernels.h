/**
 * @file
 * The inner loops of gridding, once for each instruction set. All give the same bits: each voxel
 * and each lane of a sum is computed by the same operations, and none of them is fused. Inside this
 * room only.
 */
#ifndef GZ_RENDER_PARTICLES_PARTICLE_KERNELS_H
#define GZ_RENDER_PARTICLES_PARTICLE_KERNELS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/** Particles of a list are summed in this many lanes; the list is filled up to a multiple. */
#define GZ_PARTICLE_SUM_LANES 16

/** A particle, in units of voxels, and the rows of voxels to be changed. */
struct gz_particle_splat {
	float at[3];      /**< voxel i has its centre at i */
	float reach;      /**< above 0; voxels farther away are not changed */
	float weight;     /**< sum */
	uint32_t number;  /**< nearest */
	int length;       /**< voxels of a row along x; 1 or more */
	int least[2];     /**< rows from here along y and z, */
	int end[2];       /**< up to before here, may be changed */
	size_t stride[2]; /**< voxels from a row to the next along y and z */
};

/** Loops for one instruction set. */
struct gz_particle_kernels {
	/** Add weight times the cubic spline of particle_grid.h, which is 1 at its centre. @p
	 * voxels has row (least[0], least[1]) at its beginning. */
	void (*add)(const struct gz_particle_splat *splat, float *voxels);
	/** Take the particle where it is nearer than @p squared tells, or as near and of a lesser
	 *  number. Both arrays begin as voxels of add does. */
	void (*compare)(const struct gz_particle_splat *splat, float *squared, uint32_t *number);
	/**
	 * The sum of the splines of all particles of a list at a point, each 1 at its centre.
	 *
	 * @param at           x, y and z of the particles, @p count each
	 * @param count        a multiple of GZ_PARTICLE_SUM_LANES
	 * @param per_support  1 over the reach of a spline
	 */
	double (*sum)(float *const at[3], size_t count, const float point[3], float per_support);
};

/** Loops that every processor runs. */
extern const struct gz_particle_kernels gz_particle_kernels_portable;

/** Loops for AVX2. Only where the project is built for x86-64. */
extern const struct gz_particle_kernels gz_particle_kernels_avx2;

/** The fastest loops that this processor runs, or the portable ones. Static. */
const struct gz_particle_kernels *gz_particle_kernels_find(bool portable);

#endif
