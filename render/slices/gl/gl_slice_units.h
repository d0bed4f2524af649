/**
 * @file
 * Numbers that the slicer's shaders share with C, beside those of gl_cast.h. Literal numbers, since
 * they are pasted into the shaders' text.
 */
#ifndef GZ_RENDER_SLICES_GL_GL_SLICE_UNITS_H
#define GZ_RENDER_SLICES_GL_GL_SLICE_UNITS_H

/** Texture unit of a layer's blended slices. */
#define GZ_GL_UNIT_BLENDED 8

/** Locations of the uniforms of slices.vert and slices.frag. */
enum { GZ_GL_SLICES_LATTICE, GZ_GL_SLICES_POINTS, GZ_GL_SLICES_GAP };

#endif
