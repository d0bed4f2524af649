/**
 * @file
 * From particles to a volume: the value of the nearest particle, or a sum of smooth kernels (SPH).
 *
 * The sum is that of splashsurf, which normalises by the particles' own densities, so that the
 * field of GZ_PARTICLE_FILL is about 1 inside a liquid at rest and falls to 0 outside, whatever the
 * masses are:
 *
 *     A(x) = sum_j V_j A_j W(x - x_j),   V_j = 1 / sum_k W(x_j - x_k)
 *
 * with the cubic spline W of Monaghan, "Smoothed particle hydrodynamics", Annu. Rev. Astron.
 * Astrophys. 30, 1992, in the form of compact support h = 2 * smoothing * radius: for q = |x| / h,
 * W is proportional to 6 (q^3 - q^2) + 1 up to q = 1/2, and 2 (1 - q)^3 up to 1. Its constant
 * cancels. (splashsurf_lib: density_map.rs, kernel.rs; Loeschner, Boettcher, Jeske, Bender,
 * "Weighted Laplacian Smoothing for Surface Reconstruction of Particle-based Fluids", VMV 2023.) A
 * surface at 0.6 is splashsurf's preset.
 */
#ifndef GZ_RENDER_PARTICLES_PARTICLE_GRID_H
#define GZ_RENDER_PARTICLES_PARTICLE_GRID_H

#include <stdbool.h>

#include "base/log.h"
#include "base/option.h"
#include "base/result.h"
#include "render/data/volume.h"
#include "render/particles/particles.h"

/** How particles become voxels: scene key particles.grid. */
enum gz_particle_gridding {
	GZ_GRIDDING_SPH,     /**< a sum of kernels: smooth */
	GZ_GRIDDING_NEAREST, /**< the value of the nearest particle; 0 where none is near */
	GZ_GRIDDING_COUNT,
};

/** "sph", "nearest"; NULL-terminated, in the order of the enum. */
extern const char *const gz_particle_gridding_names[];

/** Least and most voxels along the longest edge. Chosen: a row of voxels fills a SIMD register; and
 *  the largest volume that the renderer takes. */
#define GZ_PARTICLE_CELLS_MIN 8
#define GZ_PARTICLE_CELLS_MAX GZ_VOLUME_DIM_MAX

/** How to make voxels of particles. */
struct gz_particle_grid {
	enum gz_particle_gridding gridding;
	enum gz_particle_value value;
	int cells;     /**< voxels along the longest edge: GZ_PARTICLE_CELLS_MIN to …_MAX */
	double radius; /**< of a particle, in the file's unit; 0: half the edge of a cube that is as
			  large as the volume V of a particle, the median of up to 1024 of them,
			  with a kernel that reaches twice as far as the usual neighbour */
	double smoothing; /**< SPH: smoothing length in radii, above 0; splashsurf's preset is 2 */
	double reach;     /**< nearest: a particle farther away than this many voxels counts as
			     none; 0: a voxel, or two radii if that is more */
	bool portable;    /**< without the instructions that only some processors have; same bits */
	int threads;      /**< 0: one per processor; else as for gz_workers_create() */
};

/** What the time points of a series of files share. Zero-initialised: not known. */
struct gz_particle_frame {
	int count;                    /**< time points; 0: not known */
	double least[3], greatest[3]; /**< corners of the box of all particles */
	double radius;                /**< of the first file's particles; 0: no two lie apart */
	double value_range[2];        /**< least and greatest value */
};

/** Number of options of particles. */
#define GZ_PARTICLE_GRID_OPTIONS 6

/** Table over struct gz_particle_grid: keys "particles.grid", "particles.value", … */
extern const struct gz_option gz_particle_grid_options[GZ_PARTICLE_GRID_OPTIONS];

/** The presets of the table: SPH, fill, 256 cells, radius 0, smoothing 2, reach 0; on all
 *  processors. */
struct gz_particle_grid gz_particle_grid_preset(void);

/**
 * Make a volume of particles. Its voxels are floats, its spacing is in the particles' unit, and its
 * axes are theirs. It holds the box of the particles, or the one that their format promises, and a
 * margin as wide as a particle reaches. The same particles give the same bits for any number of
 * threads.
 *
 * @param name     of the particles, in messages and progress
 * @param loading  progress, cancelling and memory, as for gz_volume_load(); may be NULL. With its
 *                 number_range, or if the particles have several time points, the volume's range
 *                 covers all of them; what exceeds it is cut off, with a message
 * @param[out] out_volume  written on GZ_OK; the caller frees it with gz_volume_free()
 * @retval GZ_ERR_INVAL      @p grid is out of range; not logged
 * @retval GZ_ERR_FORMAT     the radius does not fit the particles: it is less than a millionth of
 *                           the box, or so many particles lie within it that the sum would take
 *                           minutes; logged
 * @retval GZ_ERR_NO_MEM     logged
 * @retval GZ_ERR_FULL, GZ_ERR_NOT_FOUND, GZ_ERR_IO  of gz_volume_allocate_in(); logged
 * @retval GZ_ERR_CANCELLED  @p loading stopped it; not logged
 */
enum gz_result gz_particles_to_volume(const struct gz_particles *particles,
				      const struct gz_particle_grid *grid, const char *name,
				      const struct gz_loading *loading, const struct gz_log *log,
				      struct gz_volume *out_volume);

/**
 * Load the particles of a file as a volume. All time points of a file have the radius that follows
 * from the first one, and the same grid. The first of several numbered files stands for them all
 * (render/particles/particle_series.h), a time point each.
 *
 * @param[in,out] frame  of such a series: found, which reads all files, unless it is known from
 *                       another time point; untouched for other files. NULL: found each time
 * @return what gz_particles_load() and gz_particles_to_volume() return
 */
enum gz_result gz_particle_volume_load(const char *path, const struct gz_particle_grid *grid,
				       struct gz_particle_frame *frame,
				       const struct gz_loading *loading, const struct gz_log *log,
				       struct gz_volume *out_volume);

/** Estimate the radius of particles as for struct gz_particle_grid, in their unit; 0 if no two of
 *  them lie apart. Results of gz_octree_build(). */
enum gz_result gz_particles_find_radius(const struct gz_particles *particles, double *out_radius);

#endif
