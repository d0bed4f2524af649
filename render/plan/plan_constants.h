/**
 * @file
 * Sizes of a plan, shared by C and shaders. The build puts this text in front of every shader that
 * needs it. It may hold only comments and #defines that mean the same in C and in GLSL 4.30: whole
 * numbers (with U if unsigned) and single-precision numbers with F.
 */
#ifndef GZ_RENDER_PLAN_PLAN_CONSTANTS_H
#define GZ_RENDER_PLAN_PLAN_CONSTANTS_H

/** Rays along a tile's edge. */
#define GZ_TILE_EDGE 4
/** Most lattices of a plan. */
#define GZ_PLAN_LAYERS_MAX 6
/** Most step multipliers of a plan. */
#define GZ_PLAN_STEPS_MAX 32

#endif
