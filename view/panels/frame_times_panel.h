/**
 * @file
 * The plot of what frames cost. Inside a panel of panels/widgets.h.
 */
#ifndef GZ_VIEW_FRAME_TIMES_PANEL_H
#define GZ_VIEW_FRAME_TIMES_PANEL_H

#include "view/frame/stats.h"

/** Draw the plot, a column a frame, the newest at the right, and its numbers. @param budget_ms a
 * line; 0: none */
void gz_frame_times_draw(const struct gz_frame_history *history, double budget_ms);

#endif
