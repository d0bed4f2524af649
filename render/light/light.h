/**
 * @file
 * The directional light: section [light] of a scene, and the numbers that are the same for all
 * samples of a frame.
 */
#ifndef GZ_RENDER_LIGHT_LIGHT_H
#define GZ_RENDER_LIGHT_LIGHT_H

#include <stdbool.h>
#include <stddef.h>

#include "base/option.h"
#include "render/data/volume.h"
#include "render/picture/camera.h"
#include "render/transfer/transfer_table.h"

/** Greatest number of steps towards the light. Chosen: twice as many change no picture. */
#define GZ_SHADOW_STEPS_MAX 64

/** Most cells of the grid of shadows, unless even the coarsest has more. Chosen: half as many as
 *  voxels along each edge of 320; two cores take some 50 ms for them. */
#define GZ_LIGHT_GRID_MOST ((size_t)1 << 22)

/** The axes that a light's direction refers to. */
enum gz_light_frame {
	GZ_LIGHT_CAMERA, /**< x right, y up, z towards the viewer */
	GZ_LIGHT_WORLD,
};

/**
 * One distant white light, and how surfaces reflect it. At a sample with the colour c let
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
 * with o the ambient occlusion, see render/light/occlusion.h. The sample's colour becomes
 * c + w (lit - c), each channel clamped to [0, 1]: if the gradient is too small to have a
 * direction, c does not change. Lighting never changes opacity. f and s are ramps, not steps,
 * because a surface seen edge-on would otherwise be bright or dark by chance. The constants are in
 * render/light/light_constants.h.
 *
 * A light.reflection r above 0 adds what the surface mirrors: lit becomes lit + m (S - lit), with
 * m = r + (1 - r) (1 - |N.V|)^5 (Schlick 1994) and S what the surroundings
 * (render/light/environment.h) show from the sample in the direction 2 (N.V) N - V. No shadow falls
 * on it.
 *
 * Shadows are single in-scattering: of the light that goes straight to the sample, the share T
 * arrives, and the rest is kept back on its way through the volume (Beer and Lambert). d and s are
 * multiplied by T, and c itself by ambient + (1 - ambient) T before the step to lit, so that smoke,
 * which has no gradient, has shadows too. With n steps, s = GZ_SHADOW_START, and R = shadow_reach
 * or, if that is less, the longest way through the box along the light, step i goes from
 * s + (R - s) (i / n)^2 to s + (R - s) ((i + 1) / n)^2 voxel lengths from the sample, as far as the
 * clip region reaches. So the first steps are fine and show where things touch, and far shadows are
 * soft. A step of length l and its middle at p
 * multiplies T by
 *
 *   2^(l e(p))                   if it is planned shorter than GZ_SHADOW_DIRECT voxel lengths, with
 *                                e the extinction of the value there
 *   2^(-l m(p) / 2^(i + 1))      if longer, with m what the cells of level i keep back there
 *                                (render/raycast/shared/shadow_cells.h), interpolated trilinearly
 *                                between their middles, and i the greatest whole number with
 *                                GZ_SHADOW_DIRECT 2^i up to the planned length, or the last level
 *
 * so that cells are about as large as steps are long. On the way from surfaces of other techniques
 * steps lead from i / n to (i + k) / n from the fifth on (GZ_SHADOW_FIRST), where the plan lets the
 * steps of rays be k times as long as the scene's.
 *
 * T is 0 where a surface of another technique in the picture stands in the way, s or more from the
 * place.
 *
 * Samples do not walk themselves. T is found so in the middles of a grid's cells, kept in units of
 * 1/65535, and is trilinear between them. The cells are those of the finest level that has at most
 * GZ_LIGHT_GRID_MOST of them, two voxel lengths long up to 320^3 voxels. Level, steps and T refer
 * to the full volume for samples of all levels of detail.
 */
struct gz_light {
	double direction[3];               /**< towards the light; any length but 0 */
	int frame;                         /**< enum gz_light_frame */
	double ambient, diffuse, specular; /**< [0, 1] */
	double shininess;                  /**< [1, 1000] */
	double reflection;                 /**< share of the surroundings that a surface mirrors
					      when looked at straight, [0, 1]; 0: none at all */
	double occlusion;        /**< share of ambient light that surroundings can block, [0, 1];
				    0 turns ambient occlusion off */
	double occlusion_radius; /**< voxel lengths */
	int shadow_steps;        /**< towards the light from each cell; 0 turns shadows off */
	double shadow_reach;     /**< how far they go at most, voxel lengths */
};

/** Table over struct gz_light: "light.…". */
extern const struct gz_option gz_light_options[];
extern const size_t gz_light_option_count;

/** Whether every field is within its range and the direction is not zero. */
bool gz_light_valid(const struct gz_light *light);

/** Unit vector towards the light, in world directions, for the camera that made @p rays. */
void gz_light_direction(const struct gz_light *light, const struct gz_ray_frame *rays,
			double out_direction[3]);

/** The direction towards the light as the viewer sees it: right, up, towards the viewer; length 1.
 */
void gz_light_seen(const struct gz_light *light, const struct gz_ray_frame *rays,
		   double out_seen[3]);

/**
 * Turn the light around the middle of the picture, in its own frame. A light on the viewer's side
 * moves right by @p right_deg and down by @p down_deg; one behind moves against that, as a ball
 * would that is turned in front. The direction is then of length 1, in steps of 1e-5.
 */
void gz_light_turn(struct gz_light *light, const struct gz_ray_frame *rays, double right_deg,
		   double down_deg);

/** The factor for each axis that turns the difference between the stored values one voxel to either
 *  side into the gradient of struct gz_light. */
void gz_light_gradient_scale(const struct gz_volume *volume, const struct gz_transfer_table *table,
			     double out_scale[3]);

#endif
