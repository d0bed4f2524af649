/**
 * @file
 * How rays are integrated: the section [render] of a scene with its light and clip region, the same
 * for every plan and backend; and a picture's rays in the coordinates that the kernels use.
 */
#ifndef GZ_RENDER_RAYCAST_SHARED_RAY_PARAMS_H
#define GZ_RENDER_RAYCAST_SHARED_RAY_PARAMS_H

#include <stdbool.h>
#include <stddef.h>

#include "base/option.h"
#include "render/data/clip_region.h"
#include "render/data/volume.h"
#include "render/illustration/illustration_look.h"
#include "render/light/environment.h"
#include "render/light/light.h"
#include "render/light/surface_look.h"
#include "render/light/surroundings.h"
#include "render/picture/camera.h"
#include "render/raycast/shared/slicing.h"

/** Limits of ray_sampling_rate. Chosen: a step of 20 voxels shows nothing, one of 1/32 changes no
 *  picture. */
#define GZ_RAY_SAMPLING_RATE_MIN 0.05
#define GZ_RAY_SAMPLING_RATE_MAX 32

enum gz_interpolation {
	GZ_INTERPOLATION_TRILINEAR,
	GZ_INTERPOLATION_NEAREST,
	GZ_INTERPOLATION_AUTO, /**< nearest for volumes of labels, else trilinear */
};

enum gz_shading {
	GZ_SHADING_NONE,     /**< the transfer function's colour */
	GZ_SHADING_GRADIENT, /**< Blinn-Phong with the gradient as normal: struct gz_light */
};

/** How the transfer function is applied along a ray. */
enum gz_integration {
	GZ_INTEGRATION_SAMPLED,       /**< to the value in the middle of each segment */
	GZ_INTEGRATION_PREINTEGRATED, /**< to all values between those at both ends of a segment,
					 taken as linear between (Engel, Kraus and Ertl 2001) */
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
	struct gz_clip_region clip;
	struct gz_environment environment;
	struct gz_surface_look surface;           /**< for techniques that show surfaces */
	struct gz_slicing slicing;                /**< for techniques that draw slices */
	struct gz_illustration_look illustration; /**< for techniques that illustrate */
};

/** Table over the members of struct gz_ray_params that are no structs: "render.…". */
extern const struct gz_option gz_ray_options[];
extern const size_t gz_ray_option_count;

/** The tables that gz_ray_params_bind() gives. Those of samples of a volume come first: the ray
 *  caster has them and no others. Those of surfaces follow, then those of slices, then those of
 *  illustrations. */
enum gz_ray_binding {
	GZ_RAY_BINDING_RENDER,
	GZ_RAY_BINDING_LIGHT,
	GZ_RAY_BINDING_CLIP,
	GZ_RAY_BINDING_ENVIRONMENT,
	GZ_RAY_SAMPLE_BINDINGS,
	GZ_RAY_BINDING_SURFACE = GZ_RAY_SAMPLE_BINDINGS,
	GZ_RAY_SURFACE_BINDINGS,
	GZ_RAY_BINDING_SLICES = GZ_RAY_SURFACE_BINDINGS,
	GZ_RAY_BINDING_ILLUSTRATION,
	GZ_RAY_BINDINGS = GZ_RAY_BINDING_ILLUSTRATION + GZ_ILLUSTRATION_BINDINGS,
};

/** Every table over the parts of @p rays: "render.…", "light.…", "clip.…", "environment.…",
 *  "isosurface.…", "slices.…", "illustration.…", "shading_map.…". The bindings have no flags and
 * borrow @p rays. */
void gz_ray_params_bind(struct gz_ray_params *rays,
			struct gz_option_binding out_bindings[GZ_RAY_BINDINGS]);

/** The table's presets. */
struct gz_ray_params gz_ray_params_default(void);

/** Whether every field is within its range, as the table would have it, and the box holds
 *  something. */
bool gz_ray_params_valid(const struct gz_ray_params *rays);

/** Whether samples are lit: by gradients, or with shadows. */
bool gz_ray_params_lit(const struct gz_ray_params *rays);

/**
 * Make what rays see of the surroundings.
 *
 * @param volume          its box stands on the floor
 * @param cube            the pictures, or none
 * @param towards         unit vector towards the light, in world directions
 * @param lengths_a_unit  of the wanted unit of length in a world unit
 * @param[out] out_seen   borrows the cube's texels
 */
void gz_ray_params_surroundings(const struct gz_ray_params *rays, const struct gz_volume *volume,
				const struct gz_cube *cube, const float towards[3],
				double lengths_a_unit, struct gz_seen_surroundings *out_seen);

/** Whether every option has equal values. */
bool gz_ray_params_same(const struct gz_ray_params *a, const struct gz_ray_params *b);

/** Whether a sample is the voxel that it lies in, not a mean of eight. */
bool gz_ray_samples_nearest(const struct gz_ray_params *rays, const struct gz_volume *volume);

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

/** A picture's rays through one level of a volume, in voxel coordinates: voxel i along an axis
 * spans [i, i + 1), its datum lies at i + 1/2. */
struct gz_voxel_rays {
	struct gz_ray_frame frame;
	double world_per_voxel[3]; /**< of the full volume: world units per voxel along each axis */
};

/** Turn the rays of a camera into those of a level. @p factor is the ratio of the volume's voxels
 * to the level's along each axis: 1 for the full volume. */
void gz_voxel_rays_make(const struct gz_volume *volume, const int factor[3],
			const struct gz_ray_frame *world, struct gz_voxel_rays *out_rays);

#endif
