/**
 * @file
 * The lattices on which rasterised pictures are drawn: the rectangles of a plan
 * (gz_plan_rectangles()), each wider by a band in which it fades into the coarser one behind it
 * (Guenter et al. 2012, Foveated 3D Graphics).
 */
#ifndef GZ_RENDER_LAYERS_RASTER_LAYERS_H
#define GZ_RENDER_LAYERS_RASTER_LAYERS_H

#include "render/plan/plan.h"

/** Width of the band, in spacings of the coarser layer. Chosen: the interpolated points of the
 *  coarser layer are seen as blocks if the layers change within one of them. */
#define GZ_RASTER_BAND_SPACINGS 2

/** One lattice. Point (i, j) is the ray of the plan's pixel (from[0] + i * spacing, from[1] + j *
 *  spacing), which may lie beyond the picture. */
struct gz_raster_layer {
	int from[2];
	int spacing;     /**< px */
	int points[2];   /**< columns and rows */
	int solid[2][2]; /**< the plan's rectangle, where the layer alone is shown: from, to, px */
	int band; /**< px around the solid rectangle in which the layer fades; 0 for the first */
	/** Points that only finer layers' pixels would read, so they are not drawn: from, to, by
	 *  column and row. Empty if from >= to along an axis. */
	int hidden[2][2];
};

/**
 * The lattices of a plan, coarsest first, which covers the whole picture.
 *
 * @param[out] out_layers  the first so many are written
 * @return how many, 1 to GZ_PLAN_RECTANGLES_MAX
 */
int gz_raster_layers_make(const struct gz_plan *plan,
			  struct gz_raster_layer out_layers[GZ_PLAN_RECTANGLES_MAX]);

/** How much of pixel (@p x, @p y) a layer that is not the first shows: 1 in its solid rectangle, 0
 *  beyond the band around it, as share_of() of shaders/layers.glsl has it. */
float gz_raster_layer_share(const struct gz_raster_layer *layer, int x, int y);

/** Points of a lattice that are drawn. */
uint64_t gz_raster_layer_drawn(const struct gz_raster_layer *layer);

#endif
