/**
 * @file
 * Messages: the latest in a corner, all in a list. Inside a frame of panels/widgets.h.
 */
#ifndef GZ_VIEW_NOTICES_PANEL_H
#define GZ_VIEW_NOTICES_PANEL_H

#include <stdbool.h>
#include <stddef.h>

#include "view/panels/notices.h"

/** Draw @p count messages at the lower right, the first lowest. @return the one that was clicked;
 *  @p count: none */
size_t gz_notices_panel_draw(const struct gz_notice *notices, size_t count);

/** Draw all there are, with how long ago each was, in the middle. @param now_ns host time @param
 * open becomes false once its cross is clicked */
void gz_notices_list_draw(const struct gz_notice *notices, size_t count, int64_t now_ns,
			  bool *open);

#endif
