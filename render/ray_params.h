/**
 * @file
 * How rays are integrated, whatever the plan and the backend: the sections [render], [light] and
 * [clip] of a scene.
 */
#ifndef GZ_RENDER_RAY_PARAMS_H
#define GZ_RENDER_RAY_PARAMS_H

#include <stdbool.h>
#include <stddef.h>

#include "base/option.h"

/** Limits of ray_sampling_rate. Chosen: a step of 20 voxels shows nothing, one of 1/32 changes no
 *  picture. */
#define GZ_RAY_SAMPLING_RATE_MIN 0.05
#define GZ_RAY_SAMPLING_RATE_MAX 32

enum gz_interpolation { GZ_INTERPOLATION_TRILINEAR, GZ_INTERPOLATION_NEAREST };

enum gz_shading {
	GZ_SHADING_NONE,     /**< the transfer function's colour as it is */
	GZ_SHADING_GRADIENT, /**< Blinn-Phong by the gradient, see struct gz_light */
};

/** How the transfer function is applied along a ray. */
enum gz_integration {
	GZ_INTEGRATION_SAMPLED,       /**< to the value in the middle of each segment */
	GZ_INTEGRATION_PREINTEGRATED, /**< to all values between those at both ends of a segment,
					 taken as linear between (Engel, Kraus and Ertl 2001) */
};

/** What a light's direction turns with. */
enum gz_light_frame {
	GZ_LIGHT_CAMERA, /**< x right, y up, z towards the viewer */
	GZ_LIGHT_WORLD,
};

/**
 * One light, far away and white, and how surfaces answer it. With N the unit gradient of the data
 * (world units, central differences one voxel to each side), L towards the light and H halfway
 * between L and the ray back to the eye, a sample's colour c becomes
 *
 *   c * (ambient * (1 - occlusion) + diffuse * |N.L|) + specular * |N.H|^shininess
 *
 * clamped to [0, 1] a channel (Blinn 1977). Both sides of a surface are lit. Where the gradient is
 * too small to have a direction, c stays as it is. Nothing of it changes opacity.
 */
struct gz_light {
	double direction[3];               /**< towards the light; any length but 0 */
	int frame;                         /**< enum gz_light_frame */
	double ambient, diffuse, specular; /**< [0, 1] */
	double shininess;                  /**< [1, 1000] */
	double occlusion; /**< how much of the ambient light what lies around may take, [0, 1]; 0 =
			     none is looked for */
	double occlusion_radius; /**< how far around, voxel lengths */
};

/** The part of the box that is shown: shares of its edges, 0 to 1 along x, y, z, least below
 *  greatest. Samples stay where they are without it. */
struct gz_clip_box {
	double least[3], greatest[3];
};

/** How rays are integrated. */
struct gz_ray_params {
	double ray_sampling_rate; /**< samples per voxel length at full resolution */
	int interpolation;        /**< enum gz_interpolation */
	int integration;          /**< enum gz_integration */
	int shading;              /**< enum gz_shading */
	bool levels;              /**< where steps and rays lie more than a voxel apart, sample a
				     coarser level of the volume (Levoy and Whitaker 1990) */
	int jitter; /**< seed of a shift of each ray's samples, up to half a step; 0 = none */
	double background[3]; /**< [0, 1] each */
	struct gz_light light;
	struct gz_clip_box clip;
};

/** Table over struct gz_ray_params: "render.…", "light.…", "clip.…". */
extern const struct gz_option gz_ray_options[];
extern const size_t gz_ray_option_count;

/** The table's presets. */
struct gz_ray_params gz_ray_params_default(void);

/** Whether every field is within its range, as the table would have it, and the box holds
 *  something. */
bool gz_ray_params_valid(const struct gz_ray_params *rays);

#endif
