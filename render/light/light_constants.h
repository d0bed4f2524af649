/**
 * @file
 * Constants of lighting. C and shaders share them: this text also
 * stands in front of every shader that needs it, so it holds nothing but comments and #defines that
 * mean the same in C and in GLSL 4.30: whole numbers (with U where unsigned), and single-precision
 * numbers with F.
 */
#ifndef GZ_RENDER_LIGHT_LIGHT_CONSTANTS_H
#define GZ_RENDER_LIGHT_LIGHT_CONSTANTS_H

/** Cosine of the angle between a surface and the view from which on the surface counts as seen from
 * that side. Chosen: 3.6 degrees, the rim of a ball that is .2 % of its radius. */
#define GZ_LIGHT_FACING 0.0625F
/** Gradient at which light has half its effect, of the transfer function's range per voxel length.
 * Chosen by looking: below, faces cut through the noise of CT scans speckle; edges of solid things
 * have five times as much and more. */
#define GZ_LIGHT_GRADIENT 0.02F

#endif
