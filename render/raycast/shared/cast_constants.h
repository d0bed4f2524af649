/**
 * @file
 * Constants of casting that C and shaders share. This text is put in front of every shader that
 * needs it, so it holds only comments and #defines that mean the same in C and in GLSL 4.30: whole
 * numbers (with U if unsigned) and single-precision numbers with F.
 */
#ifndef GZ_RENDER_RAYCAST_SHARED_CAST_CONSTANTS_H
#define GZ_RENDER_RAYCAST_SHARED_CAST_CONSTANTS_H

/** Edge of a macrocell, voxels. */
#define GZ_MACROCELL_EDGE 8
/** Values of reach (macrocells.h) up to this belong to cells where something shows, those above to
 *  empty ones. */
#define GZ_REACH_BORDER 128
#define GZ_REACH_MAX    127

/** A ray ends when less than this share of the light behind it would come through. */
#define GZ_TRANSMITTANCE_END (1.0F / 1024.0F)

/** A last, partial segment shorter than this share of a step is left out: chosen, far below what
 *  changes a pixel. */
#define GZ_LAST_SEGMENT_LEAST 1e-4F

/** With a transfer table of more entries than usual, a pre-integrated segment between entries less
 * than this apart takes the entry in the middle. Chosen: a peak of such a table has four entries.
 */
#define GZ_CLOSE_ENTRIES 5.0F

/** The linear congruential step of gz_ray_jitter()'s hash (Press et al., Numerical Recipes, 7.1).
 */
#define GZ_JITTER_MULTIPLIER 1664525U
#define GZ_JITTER_INCREMENT  1013904223U

#endif
