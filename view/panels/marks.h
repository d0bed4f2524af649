/**
 * @file
 * What lies over the picture and is no panel: captions, the gaze cursor, the letters of a patient's
 * sides, the legend of the tint, and messages in the middle. Inside a frame of panels/widgets.h.
 */
#ifndef GZ_VIEW_PANELS_MARKS_H
#define GZ_VIEW_PANELS_MARKS_H

#include "render/scene/view_settings.h"
#include "view/draw/letters.h"
#include "view/draw/overlay.h"
#include "view/panels/widgets.h"

/** Draw a text on a dark ground at the top left, below the caption whose lower edge is @p below (0:
 *  none). @return its own lower edge */
float gz_marks_draw_caption(float below, struct gz_paint paint, const char *text);

/** Draw a text on a dark ground at the bottom left, wrapped at the window's edge. @return height of
 *  the text with its margin */
float gz_marks_draw_low_caption(struct gz_paint paint, const char *text);

/** Draw a cross at @p at, in screen coordinates of the window. */
void gz_marks_draw_cross(struct gz_place at);

/** Draw letters at the edges of the window. */
void gz_marks_draw_letters(const struct gz_letters *letters, struct gz_place corner,
			   struct gz_place opposite);

/**
 * Draw the scale of the tint at the top left, below @p below.
 *
 * @param overlay      what @p cells were made for
 * @param cells        their scale is drawn, and a line from their least to their greatest value
 * @param rays_per_px  of the picture: converts spacings of the plan to px of the picture
 * @return lower edge of the legend
 */
float gz_marks_draw_legend(float below, enum gz_view_overlay overlay,
			   const struct gz_plan_cells *cells, double rays_per_px);

/**
 * Draw what is going on at the lower right: "what 1:05", behind a red dot if it is a recording.
 *
 * @param row  0 is the lowest
 */
void gz_marks_draw_running(int row, const char *what, bool recording, int64_t seconds);

/** Draw one line of text in the middle of the window's width, @p size times the interface's text.
 *  @return its lower edge */
float gz_marks_draw_centred(enum gz_layer layer, float y, float size, struct gz_paint paint,
			    const char *text);

/** Draw @p text in the middle of the window: each line centred, dark, twice the interface's size.
 */
void gz_marks_draw_message(const char *text);

/** How much of the first line of @p text fits into @p width: whole words, at least one. @return
 *  bytes, at most 511 */
size_t gz_marks_fit(const char *text, float size, float width);

#endif
