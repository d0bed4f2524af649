/**
 * @file
 * Numbers that the slicer's shaders share with C, beside those of gl_cast.h. Literal numbers, since
 * they are pasted into the shaders' text.
 */
#ifndef GZ_RENDER_SLICES_GL_GL_SLICE_UNITS_H
#define GZ_RENDER_SLICES_GL_GL_SLICE_UNITS_H

/** Texture unit of the first layer's blended slices; the others follow. Every OpenGL 4.3 has 16
 *  units. */
#define GZ_GL_UNIT_BLENDED 8
/** GZ_GL_STORAGE_POINTS of gl_plan.h. */
#define GZ_GL_SLICE_STORAGE_POINTS 1

/** Locations of the arrays of join.comp, which have GZ_PLAN_LAYERS_MAX members each. */
#define GZ_GL_JOIN_LATTICES 2
#define GZ_GL_JOIN_POINTS   8
#define GZ_GL_JOIN_SOLIDS   14

/** Locations of the other uniforms: of slices.vert and slices.frag, and of join.comp. */
enum { GZ_GL_SLICES_LATTICE, GZ_GL_SLICES_POINTS, GZ_GL_SLICES_GAP };
enum { GZ_GL_JOIN_PICTURE, GZ_GL_JOIN_BACKGROUND };

#endif
