/**
 * @file
 * Constants of lighting, shared by C and shaders: this file is put in front of every shader that
 * needs it. It may hold only comments and #defines that mean the same in C and in GLSL 4.30: whole
 * numbers (unsigned ones with U) and single-precision numbers with F.
 */
#ifndef GZ_RENDER_LIGHT_LIGHT_CONSTANTS_H
#define GZ_RENDER_LIGHT_LIGHT_CONSTANTS_H

/** Above this cosine of the angle between normal and view, a surface counts as seen from that side.
 * Chosen: 3.6 degrees, on a ball a rim of 0.2 % of its radius. */
#define GZ_LIGHT_FACING 0.0625F
/** Gradient at which light has half its effect, as a share of the transfer function's range per
 * voxel length. Chosen by eye: below it, cut faces speckle from the noise of CT scans; edges of
 * solid objects have five times as much and more. */
#define GZ_LIGHT_GRADIENT 0.02F
/** Steps towards the light begin this far from the sample, voxel lengths. Chosen by eye: the first
 *  block then reaches no farther back than to the sample, and slices of a CT scan cast no stripes
 *  on their own surface. */
#define GZ_SHADOW_START 3.0F
/** Steps towards the light that are shorter, voxel lengths, read voxels, longer ones blocks of
 * them. Chosen: at twice its length the tent of the first blocks, of two voxels, spans the step. */
#define GZ_SHADOW_DIRECT 3.0F
/** The first steps towards the light are never lengthened. Chosen: they show where things touch. */
#define GZ_SHADOW_FIRST 4.0F
/** A sample is black once less than 1 / 2^this of the light arrives. Chosen: a quarter of a grey
 *  level. */
#define GZ_SHADOW_BLACK 10.0F

/** Cosines of the angles from the light where the sun's halo begins and where its disc is white.
 *  Chosen by eye: 5 and 2 degrees, so that coarse rays meet it too. */
#define GZ_SUN_RIM  0.9962F
#define GZ_SUN_DISC 0.9994F
/** Distance at which half of the floor's contrast is left, world units. Chosen by eye. */
#define GZ_FLOOR_HALF 3.0F
/** A ray that falls less for each unit of its way does not meet the floor. Chosen: it would meet it
 *  where nothing but the horizon is left. */
#define GZ_FLOOR_FALL 1e-4F

#endif
