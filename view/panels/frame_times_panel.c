#include "view/panels/frame_times_panel.h"

#include <math.h>
#include <stdio.h>

#include "view/panels/widgets.h"

/* Unscaled. */
#define HEIGHT 110.0f
/* Where numbers begin, as shares of the panel. */
#define MEDIAN_SHARE 0.45F
#define P95_SHARE    0.7F

/* Okabe and Ito, "Color Universal Design" (2008): told apart by all. */
static const struct {
	const char *name;
	struct gz_paint paint;
} parts[GZ_FRAME_PARTS] = {
	[GZ_FRAME_PLAN] = { "plan", { 240, 228, 66, 255 } },
	[GZ_FRAME_CAST] = { "cast", { 86, 180, 233, 255 } },
	[GZ_FRAME_RECONSTRUCT] = { "reconstruct", { 0, 178, 130, 255 } },
	[GZ_FRAME_REST] = { "rest", { 170, 170, 170, 255 } },
};

static const struct gz_paint budget_paint = { 230, 159, 0, 255 };
static const struct gz_paint grid_paint = { 255, 255, 255, 40 };

struct area {
	struct gz_place corner, size;
};

/* 1, 2 or 5 times a power of ten, at least @p least. */
static double round_up(double least)
{
	const double ten = pow(10, floor(log10(least)));
	return ten * (least <= ten ? 1 : least <= 2 * ten ? 2 : least <= 5 * ten ? 5 : 10);
}

/* A frame as parts on top of one another; those that are not seen are left out. */
static void draw_column(const struct area *area, float left, float right,
			const struct gz_frame_cost *cost, double px_per_ms)
{
	const float bottom = area->corner.y + area->size.y;
	double sum = 0;
	float from = bottom;
	for (int part = 0; part < GZ_FRAME_PARTS; part++) {
		sum += cost->ms[part];
		const float to = fmaxf(area->corner.y, bottom - (float)(sum * px_per_ms));
		if (from - to < 0.5F)
			continue;
		gz_draw_rectangle(GZ_LAYER_PANEL, (struct gz_place) { left, to },
				  (struct gz_place) { right, from }, parts[part].paint, 0);
		from = to;
	}
}

static void draw_level(const struct area *area, double ms, double px_per_ms, struct gz_paint paint)
{
	char text[32];
	const float y = area->corner.y + area->size.y - (float)(ms * px_per_ms);
	snprintf(text, sizeof text, "%g ms", ms);
	gz_draw_line(GZ_LAYER_PANEL, (struct gz_place) { area->corner.x, y },
		     (struct gz_place) { area->corner.x + area->size.x, y }, paint, 1);
	paint.alpha = 255;
	gz_draw_text(GZ_LAYER_PANEL, (struct gz_place) { area->corner.x + 3, y + 1 }, 1, paint,
		     text);
}

static void draw_plot(const struct gz_frame_history *history, double budget_ms,
		      const struct area *area)
{
	const double p95 = gz_frame_history_quantile_ms(history, GZ_FRAME_PARTS, 0.95);
	const double top = round_up(fmax(1, fmax(1.2 * p95, 1.1 * budget_ms)));
	const double px_per_ms = (double)area->size.y / top;
	const float width = area->size.x / GZ_FRAME_HISTORY_SIZE;
	const struct gz_place end = { area->corner.x + area->size.x,
				      area->corner.y + area->size.y };
	gz_draw_rectangle(GZ_LAYER_PANEL, area->corner, end, gz_paint_ground, 0);
	for (size_t i = 0; i < history->count; i++) {
		const float right = end.x - (float)i * width;
		draw_column(area, right - width, right, gz_frame_history_at(history, i), px_per_ms);
	}
	draw_level(area, top, px_per_ms, grid_paint);
	draw_level(area, top / 2, px_per_ms, grid_paint);
	if (budget_ms > 0)
		draw_level(area, budget_ms, px_per_ms, budget_paint);
}

static void draw_cells(struct gz_paint paint, const char *name, const char *median, const char *p95)
{
	gz_widget_text(paint, name);
	gz_widgets_same_line(MEDIAN_SHARE);
	gz_widget_text(gz_paint_plain, median);
	gz_widgets_same_line(P95_SHARE);
	gz_widget_text(gz_paint_plain, p95);
}

static void draw_numbers(const struct gz_frame_history *history)
{
	char name[48], median[24], p95[24];
	snprintf(name, sizeof name, "%zu frames, ms", history->count);
	draw_cells(gz_paint_plain, name, "median", "p95");
	for (int part = 0; part <= GZ_FRAME_PARTS; part++) {
		const bool total = part == GZ_FRAME_PARTS;
		snprintf(median, sizeof median, "%.2f",
			 gz_frame_history_quantile_ms(history, (enum gz_frame_part)part, 0.5));
		snprintf(p95, sizeof p95, "%.2f",
			 gz_frame_history_quantile_ms(history, (enum gz_frame_part)part, 0.95));
		draw_cells(total ? gz_paint_plain : parts[part].paint,
			   total ? "all" : parts[part].name, median, p95);
	}
}

void gz_frame_times_draw(const struct gz_frame_history *history, double budget_ms)
{
	struct area area;
	gz_widget_area(HEIGHT, &area.corner, &area.size);
	draw_plot(history, budget_ms, &area);
	draw_numbers(history);
}
