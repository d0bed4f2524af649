/**
 * @file
 * Marks that are as dark as the shading map around each place of the picture.
 *
 * gz_hatch_choose() knows how long the strokes of the whole mesh are for its area, but not how they
 * lie: where strokes run together they draw too dark, and gaps are too light. Points lie evenly,
 * but where surfaces meet or end, those of one know nothing of the other's, and large ones reach
 * over. So the marks are drawn, what they draw is compared with the map around each point of a
 * lattice, and the marks there become larger or smaller; GZ_MARK_ROUNDS times, since larger marks
 * also overlap more. Only sizes change. A mark that shows still shows and stays in its place, so
 * marks nest as before; what a place is compared by moves with the marks, so sizes change little
 * from frame to frame.
 *
 * A lattice's point weighs the pixels around it by a tent, which reaches to its neighbours; all
 * tents together weigh each pixel by 1. Away from the gaze, where marks are larger, tents are wider
 * by powers of 2, which are sums of the small ones.
 */
#ifndef GZ_RENDER_ILLUSTRATION_MARK_BALANCE_H
#define GZ_RENDER_ILLUSTRATION_MARK_BALANCE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/result.h"
#include "base/workers.h"
#include "render/illustration/stipple_sheet.h"
#include "render/illustration/stipple_view.h"

/** How often marks are drawn and compared. Chosen: a third round brings squares of 32 px nearer to
 *  the map by less than 0.001 (root mean square). */
#define GZ_MARK_ROUNDS 2

/** Most that a width is multiplied or divided by. Chosen: anything wider would be no line. */
#define GZ_HATCH_WIDTH_CHANGE 3.0F

/** Most that a radius is multiplied or divided by. Chosen: stipples keep about one size. */
#define GZ_STIPPLE_RADIUS_CHANGE 1.35F

/** Which pixels marks draw, and how dark. All pointers are borrowed. */
struct gz_mark_target {
	const struct gz_plane *tone; /**< GZ_PLANE_VALUE: brightness wanted */
	const struct gz_plane *ids;  /**< GZ_PLANE_ID of the same size */
	/** Whether these marks draw the objects 1 to drawn_count; no other pixel counts. */
	const bool *drawn;
	size_t drawn_count;
	double size_px; /**< width of lines, or diameter of discs, at the gaze; above 0 */
	const struct gz_stipple_scale *scale; /**< NULL: 1 everywhere */
};

/** What a balance works with. Zero-initialised is empty; keep it from frame to frame. Sizes are
 *  bytes. */
struct gz_mark_balance {
	struct gz_stipple_sheet sheet; /**< the marks, as they are drawn */
	uint8_t *mask, *wanted;        /**< of each pixel: 1 where it counts; ink, 0 to 255 */
	size_t mask_size, wanted_size;
	float *widths; /**< two of each piece, or one of each disc, as they were */
	size_t widths_size;
	float *sums; /**< of the lattice's points, at each width of tents, and of rows of cells */
	size_t sums_size;
};

/**
 * Change the widths of the lines of a picture. The same bits for any number of threads.
 *
 * @param pieces   @p count pieces, all of which draw the target's objects
 * @param workers  share the work; NULL for the calling thread alone
 * @retval GZ_ERR_INVAL   planes do not fit each other, or the width is out of range
 * @retval GZ_ERR_NO_MEM  not logged; widths are as they were
 */
enum gz_result gz_mark_balance_lines(struct gz_mark_balance *balance,
				     const struct gz_mark_target *target,
				     struct gz_stipple_piece *pieces, size_t count,
				     struct gz_workers *workers);

/** Change the radii of the discs of a picture, by at most GZ_STIPPLE_RADIUS_CHANGE; as
 *  gz_mark_balance_lines(). */
enum gz_result gz_mark_balance_discs(struct gz_mark_balance *balance,
				     const struct gz_mark_target *target,
				     struct gz_stipple_disc *discs, size_t count,
				     struct gz_workers *workers);

/** Free what it holds and zero it. */
void gz_mark_balance_free(struct gz_mark_balance *balance);

#endif
