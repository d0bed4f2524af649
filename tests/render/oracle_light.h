/**
 * @file
 * Light by the plainest C, as render/raycast/shared/ray_params.h and render/light/occlusion.h say
 * in words.
 */
#ifndef GZ_TESTS_RENDER_ORACLE_LIGHT_H
#define GZ_TESTS_RENDER_ORACLE_LIGHT_H

#include "render/data/levels.h"
#include "render/raycast/shared/raycaster.h"

/** What lies around each cell. */
struct oracle_occlusion {
	int dims[3], edge[3];
	double *cells;
};

/** Make it for the radius and the clip box of @p rays; free() its cells. */
struct oracle_occlusion oracle_occlusion_make(const struct gz_volume *volume,
					      const struct gz_transfer *transfer,
					      const struct gz_ray_params *rays);

/** Light a colour.
 *
 *  @param occlusion  NULL where none is asked for
 *  @param at         voxel coordinates of the level
 *  @param direction  of the ray, world, unit length */
void oracle_shade(const struct gz_volume *volume, const struct gz_level *level,
		  const struct gz_transfer *transfer, const struct gz_camera *camera,
		  const struct gz_ray_params *rays, const struct oracle_occlusion *occlusion,
		  const double at[3], const double direction[3], double rgb[3]);

#endif
