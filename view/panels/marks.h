/**
 * @file
 * What lies over the picture and is no panel: the text line, the list of keys, the gaze cursor, the
 * letters of a patient's sides. Inside a frame of panels/widgets.h.
 */
#ifndef GZ_VIEW_MARKS_H
#define GZ_VIEW_MARKS_H

#include "view/draw/letters.h"
#include "view/panels/widgets.h"

/** Draw a text on a dark ground at the top left, @p below being the lower edge of the one above it
 * (0: none). @return its own lower edge */
float gz_marks_draw_caption(float below, struct gz_paint paint, const char *text);

/** Draw a text on a dark ground at the bottom left, lines wrapped at the window's edge. @return
 * the height that it and its margin take */
float gz_marks_draw_low_caption(struct gz_paint paint, const char *text);

/** Draw a cross at @p at, the window's screen coordinates. */
void gz_marks_draw_cross(struct gz_place at);

/** Draw letters at the edges. */
void gz_marks_draw_letters(const struct gz_letters *letters);

/**
 * Draw what goes on at the lower right: "what 1:05", behind a red dot where it is a recording.
 *
 * @param row  0 is the lowest
 */
void gz_marks_draw_running(int row, const char *what, bool recording, int64_t seconds);

/** Draw @p text over the middle: each line centred, dark, in twice the interface's size. */
void gz_marks_draw_message(const char *text);

#endif
