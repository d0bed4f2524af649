/**
 * @file
 * Silhouettes and feature lines of a picture, by Laplacian filters on its planes of object ids and
 * of depth (Saito and Takahashi, "Comprehensible rendering of 3-D shapes", SIGGRAPH 1990; Pfisterer
 * 2007, section 4.3.2, eq. 4.1). Lines lie on the side of the nearer object.
 */
#ifndef GZ_RENDER_ILLUSTRATION_FEATURE_LINES_H
#define GZ_RENDER_ILLUSTRATION_FEATURE_LINES_H

#include <stdbool.h>
#include <stdint.h>

/** The filters of eq. 4.1, by their number of neighbours. The first two draw lines a pixel wide,
 * the others two. */
enum gz_line_filter {
	GZ_LINES_4,  /**< L1: the neighbours above, below, left and right */
	GZ_LINES_8,  /**< L2: all around */
	GZ_LINES_12, /**< L3: up to two steps away */
	GZ_LINES_24, /**< L4: the square of five by five */
	GZ_LINE_FILTER_COUNT,
};

/** What a pixel of a plane of lines is. One threshold at 1/4 gives all lines, one at 3/4 the
 *  silhouettes alone. */
#define GZ_LINE_NONE       0.0F
#define GZ_LINE_INNER      0.5F /**< depth bends here: an edge or a fold within an object */
#define GZ_LINE_SILHOUETTE 1.0F /**< another object, or the background, is farther */

/** Pixels that are filtered at once. Chosen: all planes of a tile stay in the caches of a core. */
enum {
	GZ_LINE_COLUMNS = 64,
	GZ_LINE_ROWS = 16,
	GZ_LINE_REACH = 2, /**< of the widest filter, px to each side */
};

/** What lines are found in: a tile of a picture and what surrounds it, row 0 on top. Beyond the
 *  picture its border repeats. */
struct gz_line_window {
	/** 0 is the background. The tile's first pixel is at [GZ_LINE_REACH][GZ_LINE_REACH]. */
	uint32_t ids[GZ_LINE_ROWS + 2 * GZ_LINE_REACH][GZ_LINE_COLUMNS + 2 * GZ_LINE_REACH];
	/** 0 (near) to 1 (far); 1 at the background */
	float depth[GZ_LINE_ROWS + 2 * GZ_LINE_REACH][GZ_LINE_COLUMNS + 2 * GZ_LINE_REACH];
};

/**
 * Find the lines of a tile.
 *
 * Silhouettes: for each pixel the ids around it are renamed, 1/2 for the pixel's own object, 1 for
 * farther and 0 for nearer ones, and the filter is applied; a positive sum is a silhouette. Of two
 * objects at one depth the one of the lower id counts as nearer. Inner lines: the filter is applied
 * to depth; a mean over the neighbours above @p threshold is a line. The background has no lines.
 * Does not allocate. Threads: any.
 *
 * @param rows            of the tile, 1 to GZ_LINE_ROWS; the window has 2 * GZ_LINE_REACH more
 * @param threshold       depth by which the neighbours' mean is farther, above 0
 * @param[out] out_lines  @p rows rows of GZ_LINE_COLUMNS: GZ_LINE_NONE, GZ_LINE_INNER and
 *                        GZ_LINE_SILHOUETTE
 * @return false: there are none
 */
bool gz_feature_lines(const struct gz_line_window *window, int rows, enum gz_line_filter filter,
		      float threshold, float *out_lines);

#endif
