#include "view/panels/legend.h"

#include <stdio.h>

#include "view/panels/widgets.h"

/* Unscaled (chosen: six numbers stand apart). */
#define MARGIN  8.0f
#define PADDING 6.0f
#define WIDTH   240.0f
#define BAR     12.0f

/* Pieces of the bar, each of which fades. */
enum { PIECES = 18 };

struct scale {
	struct gz_place corner; /* of the bar */
	float width, height;
};

static struct gz_paint paint_of(double share)
{
	uint8_t rgb[3];
	gz_viridis(share, rgb);
	return (struct gz_paint) { rgb[0], rgb[1], rgb[2], 255 };
}

static void draw_bar(const struct scale *scale)
{
	for (int i = 0; i < PIECES; i++) {
		const float left = scale->corner.x + scale->width * (float)i / PIECES;
		const float right = scale->corner.x + scale->width * (float)(i + 1) / PIECES;
		gz_draw_fading_rectangle(
			GZ_LAYER_PICTURE, (struct gz_place) { left, scale->corner.y },
			(struct gz_place) { right, scale->corner.y + scale->height },
			paint_of((double)i / PIECES), paint_of((double)(i + 1) / PIECES));
	}
}

static void draw_number(const struct scale *scale, double share, double number)
{
	char text[32];
	snprintf(text, sizeof text, "%.3g", number);
	const struct gz_place room = gz_text_room(1, text);
	const struct gz_place at = {
		scale->corner.x + (float)share * (scale->width - room.x),
		scale->corner.y + scale->height,
	};
	gz_draw_text(GZ_LAYER_PICTURE, at, 1, gz_paint_plain, text);
}

/* From the least to the greatest value of the plan, under the bar's upper edge. */
static void draw_span(const struct scale *scale, double from, double to)
{
	const float left = scale->corner.x + (float)from * scale->width;
	const float right = scale->corner.x + (float)to * scale->width;
	const float unit = gz_widgets_scale(), y = scale->corner.y - 2 * unit;
	gz_draw_rectangle(GZ_LAYER_PICTURE, (struct gz_place) { left - unit, y - 2 * unit },
			  (struct gz_place) { right + unit, y }, gz_paint_plain, 0);
}

float gz_legend_draw(float below, enum gz_view_overlay overlay, const struct gz_plan_cells *cells,
		     double rays_per_px)
{
	const bool steps = overlay == GZ_OVERLAY_STEP;
	const double per_number = steps ? 1 : rays_per_px;
	const float unit = gz_widgets_scale(), line = gz_widgets_line_height();
	const struct gz_place corner = { MARGIN * unit, below + MARGIN * unit };
	const float padding = PADDING * unit;
	const struct scale scale = {
		.corner = { corner.x + padding, corner.y + 2 * padding + line },
		.width = WIDTH * unit,
		.height = BAR * unit,
	};
	const struct gz_place end = { scale.corner.x + scale.width + padding,
				      scale.corner.y + scale.height + line + padding };
	gz_draw_rectangle(GZ_LAYER_PICTURE, corner, end, gz_paint_ground, PADDING);
	gz_draw_text(GZ_LAYER_PICTURE,
		     (struct gz_place) { corner.x + padding, corner.y + padding / 2 }, 1,
		     gz_paint_plain, steps ? "step, times the scene's" : "spacing of rays, px");
	draw_bar(&scale);
	draw_span(&scale, gz_plan_cells_share(cells->least, cells->end),
		  gz_plan_cells_share(cells->most, cells->end));
	for (double value = 1; value <= cells->end; value *= 2)
		draw_number(&scale, gz_plan_cells_share(value, cells->end), value / per_number);
	return end.y;
}
