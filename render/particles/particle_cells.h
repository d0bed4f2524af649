/**
 * @file
 * What the two ways to grid particles share. Inside this room only.
 */
#ifndef GZ_RENDER_PARTICLES_PARTICLE_CELLS_H
#define GZ_RENDER_PARTICLES_PARTICLE_CELLS_H

#include <stdatomic.h>
#include <stdbool.h>
#include <stdint.h>

#include "base/workers.h"
#include "render/data/volume.h"
#include "render/particles/octree.h"
#include "render/particles/particle_grid.h"
#include "render/particles/particle_kernels.h"

/** Particles and their grid, in units of the box: its longest edge is 1. */
struct gz_particle_cells {
	const struct gz_particles *particles;
	const char *name;
	const struct gz_loading *loading;
	struct gz_octree tree;
	int dims[3];
	float origin[3]; /**< centre of voxel 0, 0, 0 */
	float voxel;     /**< its edge */
	float support;   /**< how far a particle reaches */
	float *weights;  /**< SPH: 1 / sum of kernels at each particle, in the tree's order, times
			    its value */
	const struct gz_particle_kernels *kernels;
	float *voxels;               /**< of the volume that is filled */
	double share_from, share_to; /**< of progress that the present work stands for */
	atomic_size_t parts_done;
	size_t parts;
	atomic_uint_fast64_t pairs; /**< of particles, whose kernels were summed */
	atomic_int result;          /**< enum gz_result: why threads should stop */
};

/** Pairs of particles beyond which a sum is refused. Chosen: some minutes of a core. */
#define GZ_PARTICLE_PAIRS_MAX (UINT64_C(1) << 36)

/** Whether threads should go on; the calling one, number 0, reports progress. */
bool gz_particle_cells_go_on(struct gz_particle_cells *cells, int worker);

/** Compute the weights. @retval GZ_ERR_FULL  more than GZ_PARTICLE_PAIRS_MAX; not logged
 *  @retval GZ_ERR_NO_MEM, GZ_ERR_CANCELLED  not logged */
enum gz_result gz_particle_weights_find(struct gz_particle_cells *cells,
					struct gz_workers *workers);

/** Fill the voxels by the sum of kernels. @retval GZ_ERR_CANCELLED  not logged */
enum gz_result gz_particle_sum_fill(struct gz_particle_cells *cells, struct gz_workers *workers);

/** Fill the voxels by the nearest particles. @retval GZ_ERR_NO_MEM, GZ_ERR_CANCELLED  not logged */
enum gz_result gz_particle_nearest_fill(struct gz_particle_cells *cells,
					struct gz_workers *workers);

#endif
