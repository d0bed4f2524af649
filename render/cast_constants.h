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
#define GZ_PLAN_LAYERS_MAX 5
/** Most step multipliers of a plan. */
#define GZ_PLAN_STEPS_MAX 32

/** Edge of a macrocell, voxels. */
#define GZ_MACROCELL_EDGE 8

/** Entries of a transfer table. Chosen: 16 between two grey levels of 8-bit data, so that the
 * nearest entry is near enough; 32 KiB, of which a scene uses a part, stay close to the processor.
 */
#define GZ_TRANSFER_TABLE_SIZE 4096

/** A ray ends when less than this share of the light behind it would come through. */
#define GZ_TRANSMITTANCE_END (1.0F / 1024.0F)

/** A last, partial segment shorter than this share of a step is left out: chosen, far below what
 *  changes a pixel. */
#define GZ_LAST_SEGMENT_LEAST 1e-4F

#endif
