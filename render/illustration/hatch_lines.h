/**
 * @file
 * Which strokes of a surface a picture shows.
 *
 * A stroke shows where the length of all strokes before it is below the length that the tone asks
 * for: with a width w and a density d = gz_hatch_density(),
 *
 *   length before < d / w * px² per mm² / px per mm along the stroke * area of the surface, mm²
 *
 * As with stipples, those that show at a place are always the first ones; strokes keep their place
 * while the view turns. They have one width on the screen, and taper where they are about to
 * vanish: the last GZ_HATCH_TAPER of the strokes at a place are thinner, so that none appears at
 * once.
 */
#ifndef GZ_RENDER_ILLUSTRATION_HATCH_LINES_H
#define GZ_RENDER_ILLUSTRATION_HATCH_LINES_H

#include <stddef.h>

#include "base/result.h"
#include "base/workers.h"
#include "render/illustration/hatch_strokes.h"
#include "render/illustration/stipple_sheet.h"
#include "render/illustration/stipple_view.h"

/** Share of the strokes of a place that are thinner than the others. Chosen by eye. */
#define GZ_HATCH_TAPER 0.5F

/** Which part of the ink strokes draw. */
enum gz_hatch_layer {
	GZ_HATCH_ONLY,  /**< all of it */
	GZ_HATCH_FIRST, /**< all of light tones, less and less of dark ones */
	GZ_HATCH_CROSS, /**< the rest, by strokes that cross the first ones */
};

/**
 * The ink of a layer. Both layers together, drawn independently, cover 1 - (1 - a) (1 - b) of the
 * paper, which is all of it.
 *
 * @param ink  wanted in the drawing, [0, 1]
 */
float gz_hatch_layer_ink(enum gz_hatch_layer layer, float ink);

/** The lines' area for each area of the picture that covers a share of the paper: see
 *  gz_stipple_density(). Strokes run side by side and overlap little. @param ink  [0, 1] */
float gz_hatch_density(float ink);

/** Pieces of the lines of a picture. Zero-initialised is empty; keep it from frame to frame. */
struct gz_hatch_lines {
	size_t count, capacity;
	struct gz_stipple_piece *pieces; /**< those that follow each other are one line */
};

/**
 * Append the lines of a mesh to a picture. The same lines in the same order for any number of
 * threads. Start with lines->count = 0.
 *
 * @param workers  share the work; NULL for the calling thread alone
 * @retval GZ_ERR_INVAL   the view is not valid; nothing is appended
 * @retval GZ_ERR_NO_MEM  not logged; nothing is appended
 */
enum gz_result gz_hatch_choose(const struct gz_hatch_strokes *strokes,
			       const struct gz_stipple_view *view, enum gz_hatch_layer layer,
			       struct gz_workers *workers, struct gz_hatch_lines *lines);

/** Free what it holds and zero it. */
void gz_hatch_lines_free(struct gz_hatch_lines *lines);

#endif
