/**
 * @file
 * Colours of charts and of the report, for light and dark pages.
 *
 * Methods keep theirs in every report. They differ in lightness and in shape of their points too,
 * so that no one needs to tell hues apart, and each is dark (or light) enough to be read as text:
 * contrast of at least 4.5 (WCAG 2.2, 1.4.3).
 */
#ifndef GZ_BENCH_REPORT_PALETTE_H
#define GZ_BENCH_REPORT_PALETTE_H

#include <stdint.h>

#include "bench/report/text.h"

/** Colours that are no method's. */
#define GZ_COLOUR_INK  0x1b1f24 /**< axes, text */
#define GZ_COLOUR_GRID 0xdfe3e8 /**< lines of the grid */
#define GZ_COLOUR_MUTE 0x5c6570 /**< what is said by the way */
#define GZ_COLOUR_PALE 0xcdd3da /**< the front, behind everything */
#define GZ_COLOUR_PAGE 0xfdfdfe /**< halos: the page itself */

/** How a method looks. */
struct gz_method_look {
	uint32_t colour; /**< on a light page, 0xRRGGBB */
	int point;       /**< gnuplot's type of point */
};

/** The look of a method; unknown ones look like each other. */
struct gz_method_look gz_method_look(const char *method);

/** Add to @p out the SVG @p svg of gnuplot, with a style that turns its colours on dark pages. */
void gz_palette_add_dark(struct gz_text *out, const char *svg);

#endif
