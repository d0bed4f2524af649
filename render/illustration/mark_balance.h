/**
 * @file
 * Lines that are as dark as the shading map around each place of the picture.
 *
 * gz_hatch_choose() knows how long the strokes of the whole mesh are for its area, but not how they
 * lie: where strokes run together they draw too dark, and gaps are too light. So the lines are
 * drawn, what they draw is compared with the map around each point of a lattice, and the lines
 * there become wider or thinner; GZ_HATCH_ROUNDS times, since wider lines also overlap more. Only
 * widths change. A stroke that shows still shows and stays in its place, so strokes nest as before;
 * what a place is compared by moves with the lines, so widths change little from frame to frame.
 *
 * A lattice's point weighs the pixels around it by a tent, which reaches to its neighbours; all
 * tents together weigh each pixel by 1. Away from the gaze, where marks are larger, tents are wider
 * by powers of 2, which are sums of the small ones.
 */
#ifndef GZ_RENDER_ILLUSTRATION_HATCH_BALANCE_H
#define GZ_RENDER_ILLUSTRATION_HATCH_BALANCE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/result.h"
#include "base/workers.h"
#include "render/illustration/stipple_sheet.h"
#include "render/illustration/stipple_view.h"

/** How often lines are drawn and compared. Chosen: a third round brings squares of 32 px nearer to
 *  the map by less than 0.001 (root mean square). */
#define GZ_HATCH_ROUNDS 2

/** Most that a width is multiplied or divided by. Chosen: anything wider would be no line. */
#define GZ_HATCH_WIDTH_CHANGE 3.0F

/** Which pixels lines draw, and how dark. All pointers are borrowed. */
struct gz_hatch_target {
	const struct gz_plane *tone; /**< GZ_PLANE_VALUE: brightness wanted */
	const struct gz_plane *ids;  /**< GZ_PLANE_ID of the same size */
	/** Whether lines draw the objects 1 to hatched_count; no other pixel counts. */
	const bool *hatched;
	size_t hatched_count;
	double size_px;                       /**< width of lines at the gaze, above 0 */
	const struct gz_stipple_scale *scale; /**< NULL: 1 everywhere */
};

/** What a balance works with. Zero-initialised is empty; keep it from frame to frame. Sizes are
 *  bytes. */
struct gz_hatch_balance {
	struct gz_stipple_sheet sheet; /**< the lines, as they are drawn */
	uint8_t *mask, *wanted;        /**< of each pixel: 1 where it counts; ink, 0 to 255 */
	size_t mask_size, wanted_size;
	float *widths; /**< two of each piece, as they were */
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
enum gz_result gz_hatch_balance_lines(struct gz_hatch_balance *balance,
				      const struct gz_hatch_target *target,
				      struct gz_stipple_piece *pieces, size_t count,
				      struct gz_workers *workers);

/** Free what it holds and zero it. */
void gz_hatch_balance_free(struct gz_hatch_balance *balance);

#endif
