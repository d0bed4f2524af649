/**
 * @file
 * Constants of casting that the cpu backend's C and the gl backend's shaders share: both take them
 * from here. The text is also put in front of every shader, so it holds nothing but comments and
 * #defines that mean the same in C and in GLSL 4.30: whole numbers (with U where unsigned), and
 * single-precision numbers with F.
 */
#ifndef GZ_RENDER_CAST_CONSTANTS_H
#define GZ_RENDER_CAST_CONSTANTS_H

/** Rays along a tile's edge. */
#define GZ_TILE_EDGE 4
/** Most lattices of a plan. */
#define GZ_PLAN_LAYERS_MAX 6
/** Most step multipliers of a plan. */
#define GZ_PLAN_STEPS_MAX 32

/** Edge of a macrocell, voxels. */
#define GZ_MACROCELL_EDGE 8
/** Between cells of reach where something shows, below, and empty ones. */
#define GZ_REACH_BORDER 128
#define GZ_REACH_MAX    127

/** Entries of a transfer table. Chosen: 16 between two grey levels of 8-bit data, so that the
 * nearest entry is near enough; 32 KiB, of which a scene uses a part, stay close to the processor.
 */
#define GZ_TRANSFER_TABLE_SIZE 4096

/** Values at either end of a segment that a pre-integrated table tells apart. Chosen: finer than
 * the grey levels of 8-bit data; 2 MiB a step length, of which segments, whose ends are seldom far
 * apart, use what lies near the diagonal. */
#define GZ_PREINTEGRATED_SIZE 512

/** A ray ends when less than this share of the light behind it would come through. */
#define GZ_TRANSMITTANCE_END (1.0F / 1024.0F)

/** A last, partial segment shorter than this share of a step is left out: chosen, far below what
 *  changes a pixel. */
#define GZ_LAST_SEGMENT_LEAST 1e-4F

/** Cosine of the angle between a surface and the view from which on the surface counts as seen from
 * that side. Chosen: 3.6 degrees, the rim of a ball that is .2 % of its radius. */
#define GZ_LIGHT_FACING 0.0625F
/** Gradient at which light has half its effect, of the transfer function's range per voxel length.
 * Chosen by looking: below, faces cut through the noise of CT scans speckle; edges of solid things
 * have five times as much and more. */
#define GZ_LIGHT_GRADIENT 0.02F

/** The linear congruential step of gz_ray_jitter()'s hash (Press et al., Numerical Recipes, 7.1).
 */
#define GZ_JITTER_MULTIPLIER 1664525U
#define GZ_JITTER_INCREMENT  1013904223U

#endif
