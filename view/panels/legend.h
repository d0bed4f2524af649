/**
 * @file
 * What the colours of the overlay say: a scale with numbers. Inside a frame of panels/widgets.h.
 */
#ifndef GZ_VIEW_LEGEND_H
#define GZ_VIEW_LEGEND_H

#include "render/scene/view_settings.h"
#include "view/draw/overlay.h"

/**
 * Draw it at the top left, below @p below.
 *
 * @param overlay      what @p cells were made for
 * @param cells        with their scale, and what is marked on it: from the least to the most
 * @param rays_per_px  of the picture: what spacings are told in pixels by
 * @return its lower edge
 */
float gz_legend_draw(float below, enum gz_view_overlay overlay, const struct gz_plan_cells *cells,
		     double rays_per_px);

#endif
