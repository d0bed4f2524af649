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
 * One light, far away and white, and how surfaces answer it. At a sample with the colour c let
 *
 *   g = gradient of the data in world directions, in units of the transfer function's value (0 to 1
 *       over its range) per voxel length: along each axis the central difference between what lies
 *       one voxel to either side, interpolated as the samples are, clamped at the box
 *   N = g / |g|, V towards the eye along the ray, L towards the light, H halfway between V and L
 *   f = clamp(N.V / GZ_LIGHT_FACING, -1, 1): which side the eye sees; both are lit alike
 *   d = max(f * N.L, 0)
 *   s = |N.H|^shininess * min(d / GZ_LIGHT_FACING, 1)                        (Blinn 1977)
 *   lit = c * (ambient * (1 - occlusion * o) + diffuse * d) + specular * s
 *   w = |g|^2 / (|g|^2 + GZ_LIGHT_GRADIENT^2)
 *
 * with o what lies around, see render/occlusion.h. The sample's colour becomes c + w (lit - c),
 * clamped to [0, 1] a channel: where the gradient is too small to have a direction, c stays as it
 * is. Nothing of it changes opacity. f and s are ramps, not steps, because a side that is seen edge
 * on would otherwise be bright or dark by chance. The constants are in render/cast_constants.h.
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

/**
 * The part of the box that is shown: shares of its edges, 0 to 1 along x, y, z, least below
 * greatest. A ray is cut into segments from where it enters the whole box, so samples stay where
 * they are without it; a segment that a face of the clip box cuts is sampled in the middle of what
 * is left of it and has the opacity of that length, as the last segment of every ray.
 */
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
	int jitter;               /**< seed of gz_ray_jitter(); 0 = none */
	bool early_termination;   /**< a ray ends when less than GZ_TRANSMITTANCE_END of the light
				     behind it would come through; else when none would */
	double background[3];     /**< [0, 1] each */
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

/** The share of light with which a ray ends: GZ_TRANSMITTANCE_END, or 0 without early termination.
 */
float gz_ray_end_transmittance(const struct gz_ray_params *rays);

/**
 * By how much the segments of the ray through pixel (x, y) begin before it enters the box, [0, 1)
 * of a step: the first segment then is what lies within the box, treated as one cut by a clip face.
 * 24 bits of a hash of x, y and the seed: the first component of pcg3d (Jarzynski and Olano, Hash
 * Functions for GPU Rendering, JCGT 9(3), 2020), in arithmetic modulo 2^32 the same everywhere:
 *
 *   a, b, c = each of x, y, seed * GZ_JITTER_MULTIPLIER + GZ_JITTER_INCREMENT
 *   a += b c;  b += c a;  c += a b;  each ^= itself >> 16;  a += b c;  the shift is (a >> 8) / 2^24
 *
 * 0 for a seed of 0.
 */
float gz_ray_jitter(int x, int y, int seed);

#endif
