/**
 * @file
 * One tile of a shading map: all steps that follow the histogram, while its pixels are in the
 * caches of a core. Within this room.
 */
#ifndef GZ_RENDER_ILLUSTRATION_SHADING_TILE_H
#define GZ_RENDER_ILLUSTRATION_SHADING_TILE_H

#include <stdbool.h>

#include "render/illustration/depth_blur.h"
#include "render/illustration/feature_lines.h"
#include "render/illustration/shading_map.h"
#include "render/illustration/shading_parameters.h"
#include "render/illustration/shading_picture.h"
#include "render/illustration/tone_curve.h"

/** Pixels of a tile. */
enum {
	GZ_SHADING_TILE_COLUMNS = GZ_LINE_COLUMNS,
	GZ_SHADING_TILE_ROWS = GZ_LINE_ROWS,
	GZ_SHADING_TILE_PIXELS = GZ_LINE_COLUMNS * GZ_LINE_ROWS,
};

/** Blurred depth of a frame, on the cells of its level. */
struct gz_blurred_cells {
	int level, width, height;
	const float *cells; /**< NULL: not wanted */
};

/** What all tiles of a frame share. All pointers are borrowed. */
struct gz_shading_shared {
	const struct gz_shading_frame *frame;
	const struct gz_shading_settings *settings;
	struct gz_depth_range range;
	struct gz_blurred_cells edge, shadow;
	const struct gz_tone_curve *curve;
	const struct gz_haze_table *haze;
	struct gz_shading_weights weights;
	float *map; /**< of the whole picture; NULL: not wanted */
	/** Whether tiles show objects, tile by tile: GZ_SHADING_TILE_ROWS rows of the picture have
	 *  tile_columns of them. */
	const uint8_t *filled;
	int tile_columns;
	uint32_t *out_pixels; /**< likewise, as gz_shading_grey() makes them; NULL: not wanted */
};

/** Planes of a tile, row by row; room of each worker. */
struct gz_shading_tile {
	struct gz_line_window window;
	float strong[GZ_SHADING_TILE_PIXELS], thin[GZ_SHADING_TILE_PIXELS];
};

/** How many tiles lie side by side in a picture of a width or height; @p edge: of a tile. */
static inline int gz_shading_tiles(int pixels, int edge)
{
	return (pixels + edge - 1) / edge;
}

/**
 * Look at a row of a frame: depth as shares of the scene's (gz_depth_share()), and which tiles it
 * shows objects in.
 *
 * @param[in,out] filled  of the tiles that the row lies in: 1 where it shows an object, otherwise
 *                        as it is
 * @param[out] out_shares  NULL: not wanted
 */
void gz_shading_row_survey(const struct gz_shading_frame *frame, int y,
			   const struct gz_depth_range *range, uint8_t *filled, float *out_shares);

/** Compose the tile whose first pixel is (@p x, @p y), multiples of its size. Threads: any, each
 *  with room of its own. */
void gz_shading_tile_compose(const struct gz_shading_shared *shared, int x, int y,
			     struct gz_shading_tile *room);

#endif
