/**
 * @file
 * What all points of a picture of surfaces share, in the form that kernels and shaders take.
 */
#ifndef GZ_RENDER_SURFACE_SHARED_SURFACE_FRAME_H
#define GZ_RENDER_SURFACE_SHARED_SURFACE_FRAME_H

#include <stdbool.h>
#include <stdint.h>

#include "render/light/cube_pictures.h"
#include "render/light/surroundings.h"
#include "render/picture/camera.h"
#include "render/raycast/shared/lighting.h"
#include "render/raycast/shared/ray_params.h"
#include "render/surface/shared/surface_meshes.h"

/** The frame. Lengths and places are in mm, in the frame of struct gz_mesh. */
struct gz_surface_frame {
	/** The ray of pixel (x, y), as in struct gz_ray_frame. */
	float origin00[3], origin_dx[3], origin_dy[3];
	float direction00[3], direction_dx[3], direction_dy[3];
	bool clipped;
	float clip_least[3], clip_greatest[3]; /**< only what lies between shows */
	float clip_plane[4];                   /**< struct gz_clip_bounds */
	struct gz_cast_light light;            /**< without occlusion */
	bool shadows;
	float lift;                         /**< how far above a surface its shadow rays begin */
	uint32_t background;                /**< as a pixel */
	struct gz_seen_surroundings around; /**< lengths in mm */
	int bounces;              /**< surfaces of glass that a ray meets at most; 0: no glass */
	float refractive_index;   /**< of glass */
	float least_reflection;   /**< share that glass reflects along its normal */
	float absorbed_per_mm[3]; /**< by glass: log2 of what is left, 0 or less */
	float world_per_mm;
};

/** The colour of an item: its object's own, or that of the settings. */
void gz_surface_colour(const struct gz_surface_item *item, const struct gz_surface_look *look,
		       float out_colour[3]);

/** Make the frame of a picture. @param meshes  shows something  @param cube  prepared  @param
 *  camera  the picture's rays, world units */
struct gz_surface_frame gz_surface_frame_make(const struct gz_surface_meshes *meshes,
					      const struct gz_cube_pictures *cube,
					      const struct gz_ray_params *rays,
					      const struct gz_ray_frame *camera);

#endif
