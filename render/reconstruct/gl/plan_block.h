/**
 * @file
 * What shaders are told of a plan: the uniform block of shaders/plan.glsl, byte for byte by the
 * rules of std140, and the numbers of OpenGL's binding points.
 */
#ifndef GZ_RENDER_RECONSTRUCT_GL_PLAN_BLOCK_H
#define GZ_RENDER_RECONSTRUCT_GL_PLAN_BLOCK_H

#include <stdint.h>

#include "render/plan/plan_constants.h"

/* Plain numbers: they are pasted into the shaders' text. */

/** Invocations of a work-group of rays: four tiles. Chosen: a warp of 32 or a wave of 64 is full,
 *  and rays of neighbouring tiles take similar ways. */
#define GZ_GL_GROUP_SIZE 64
/** Rays of all tile patterns together. */
#define GZ_GL_TILE_POINTS 32

/** Image unit of the lattice points: the last that every OpenGL has; techniques use the lower ones.
 */
#define GZ_GL_IMAGE_POINTS 7

/** Binding points of uniform blocks: one for the plan, one for the technique's own. */
enum gz_gl_block { GZ_GL_BLOCK_PLAN, GZ_GL_BLOCK_TECHNIQUE };

/** Binding points of storage buffers: GZ_GL_STORAGE_TECHNIQUE and above are the technique's own. */
enum gz_gl_storage {
	GZ_GL_STORAGE_TILES,
	GZ_GL_STORAGE_POINTS,
	GZ_GL_STORAGE_SPANS,
	GZ_GL_STORAGE_TECHNIQUE,
};

/** The block. Vectors of three have a fourth component that nobody reads. */
struct gz_gl_plan_block {
	uint32_t plan[4];                           /**< layers; 1 for a pyramid; width; height */
	uint32_t layers[GZ_PLAN_LAYERS_MAX][4];     /**< first point, columns, rows, spacing */
	float region_places[GZ_PLAN_LAYERS_MAX][4]; /**< centre, half size, px */
	/** Share of a layer for each radius inside the rim, 0 = no band; 1 for an ellipse. */
	float region_fades[GZ_PLAN_LAYERS_MAX][4];
	uint32_t tile_points[GZ_GL_TILE_POINTS][4]; /**< column and row of a tile's rays */
};

#endif
