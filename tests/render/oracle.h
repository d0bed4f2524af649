/**
 * @file
 * A ray caster in the plainest C, independent of render/'s kernels: what `standard` must equal.
 * Double precision, a pixel at a time, no table, no skipping.
 */
#ifndef GZ_TESTS_RENDER_ORACLE_H
#define GZ_TESTS_RENDER_ORACLE_H

#include "render/data/levels.h"
#include "render/raycast/shared/raycaster.h"

struct oracle_occlusion;

/** Colour of pixel (x, y), each channel [0, 1]. */
void oracle_pixel(const struct gz_volume *volume, const struct gz_transfer *transfer,
		  const struct gz_camera *camera, const struct gz_ray_params *rays, int width,
		  int height, int x, int y, double out_rgb[3]);

/** The same with occlusion, which may be NULL: oracle_light.h. */
void oracle_pixel_occluded(const struct gz_volume *volume, const struct gz_transfer *transfer,
			   const struct gz_camera *camera, const struct gz_ray_params *rays,
			   const struct oracle_occlusion *occlusion, int width, int height, int x,
			   int y, double out_rgb[3]);

/** The same with samples of a coarser level of @p volume. */
void oracle_level_pixel(const struct gz_volume *volume, const struct gz_level *level,
			const struct gz_transfer *transfer, const struct gz_camera *camera,
			const struct gz_ray_params *rays, int width, int height, int x, int y,
			double out_rgb[3]);

/** The stored value at a place in voxel coordinates. */
double oracle_sample(const struct gz_volume *volume, int interpolation, const double at[3]);

#endif
