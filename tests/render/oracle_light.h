/**
 * @file
 * Light by the plainest C, as render/raycast/shared/ray_params.h and render/light/occlusion.h say
 * in words.
 */
#ifndef GZ_TESTS_RENDER_ORACLE_LIGHT_H
#define GZ_TESTS_RENDER_ORACLE_LIGHT_H

#include "render/data/levels.h"
#include "render/raycast/shared/raycaster.h"

/** Most levels of shadow cells. */
#define ORACLE_SHADOW_LEVELS 8

/** What lies around each cell, and what blocks of voxels keep back of the light. */
struct oracle_occlusion {
	int dims[3], edge[3];
	double *cells;
	bool exact_shadows; /**< many small steps through the volume itself, not those of the
			       scene */
	int levels;
	int level_dims[ORACLE_SHADOW_LEVELS][3], level_edge[ORACLE_SHADOW_LEVELS][3];
	double *kept[ORACLE_SHADOW_LEVELS]; /**< powers of two, for a cell's nominal length */
	double *arriving; /**< shares of the light in the middles of the cells of level 0 */
};

/** The clip plane of @p rays in the world: a place is cut off where its product with @p out_normal
 * is above the level that is returned. Without a plane no place is. */
double oracle_plane(const struct gz_volume *volume, const struct gz_ray_params *rays,
		    double out_normal[3]);

/** Make the blocks of shadows for the clip region of @p rays, and what light arrives for the
 * camera.
 */
void oracle_shadows_make(const struct gz_volume *volume, const struct gz_transfer *transfer,
			 const struct gz_camera *camera, const struct gz_ray_params *rays,
			 struct oracle_occlusion *occlusion);

/** Free what both hold. */
void oracle_occlusion_free(struct oracle_occlusion *occlusion);

/** Make it for the radius and the clip region of @p rays: oracle_occlusion_free(). */
struct oracle_occlusion oracle_occlusion_make(const struct gz_volume *volume,
					      const struct gz_transfer *transfer,
					      const struct gz_ray_params *rays);

/** What a ray from a place in the world sees of the surroundings, none or a sky. @param direction
 * of unit length */
void oracle_surroundings(const struct gz_volume *volume, const struct gz_camera *camera,
			 const struct gz_ray_params *rays, const double place[3],
			 const double direction[3], double out_rgb[3]);

/** Light a colour.
 *
 *  @param occlusion  NULL where neither occlusion nor shadows are asked for
 *  @param at         voxel coordinates of the level
 *  @param direction  of the ray, world, unit length */
void oracle_shade(const struct gz_volume *volume, const struct gz_level *level,
		  const struct gz_transfer *transfer, const struct gz_camera *camera,
		  const struct gz_ray_params *rays, const struct oracle_occlusion *occlusion,
		  const double at[3], const double direction[3], double rgb[3]);

#endif
