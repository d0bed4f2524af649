/* The part that plots what frames cost, with a slider for the time budget and the settings of the
 * method below. */
#include <math.h>
#include <stdio.h>

#include <GLFW/glfw3.h>

#include "base/clock.h"
#include "view/frame/stats.h"
#include "view/panels/settings_panel.h"
#include "view/panels/widgets.h"
#include "view/settings/scene_keys.h"
#include "view/window/window_state.h"

/* Unscaled (chosen: names and values of settings fit, and a frame is wider than a pixel). */
#define WIDTH       380.0f
#define PLOT_HEIGHT 110.0f
/* Greatest budget of the slider (chosen: ten frames a second). */
#define BUDGET_SLIDER_MS 100.0

/* Time for which the panel stays as it is (chosen: numbers can be read; drawing it for every frame
 * would be a part of what it shows). */
#define REST_NS 200000000

struct gz_window_frame_times {
	struct gz_frame_history history, shown;
	int64_t shown_ns; /* since when it is shown */
	int64_t begun_ns; /* this turn's frame */
	bool newer;       /* the panel is open, and there are frames that it does not show */
};

/* ---- the plot ---- */

/* Where columns of numbers begin, as shares of the panel. */
#define MEDIAN_SHARE 0.45F
#define P95_SHARE    0.7F

/* Okabe and Ito, "Color Universal Design" (2008): colour-blind viewers can tell them apart. */
static const struct {
	const char *name;
	struct gz_paint paint;
} cost_parts[GZ_FRAME_PARTS] = {
	[GZ_FRAME_PLAN] = { "plan", { 240, 228, 66, 255 } },
	[GZ_FRAME_CAST] = { "cast", { 86, 180, 233, 255 } },
	[GZ_FRAME_RECONSTRUCT] = { "reconstruct", { 0, 178, 130, 255 } },
	[GZ_FRAME_REST] = { "rest", { 170, 170, 170, 255 } },
};

static const struct gz_paint budget_paint = { 230, 159, 0, 255 };
static const struct gz_paint grid_paint = { 255, 255, 255, 40 };

struct plot_area {
	struct gz_place corner, size;
};

/* 1, 2 or 5 times a power of ten, at least @p least. */
static double round_up_to_125(double least)
{
	const double ten = pow(10, floor(log10(least)));
	return ten * (least <= ten ? 1 : least <= 2 * ten ? 2 : least <= 5 * ten ? 5 : 10);
}

/* A frame as a stack of its parts; parts too small to be seen are left out. */
static void draw_cost_column(const struct plot_area *area, float left, float right,
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
				  (struct gz_place) { right, from }, cost_parts[part].paint, 0);
		from = to;
	}
}

static void draw_cost_level(const struct plot_area *area, double ms, double px_per_ms,
			    struct gz_paint paint)
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

static void draw_cost_plot(const struct gz_frame_history *history, double budget_ms,
			   const struct plot_area *area)
{
	const double p95 = gz_frame_history_quantile_ms(history, GZ_FRAME_PARTS, 0.95);
	const double top = round_up_to_125(fmax(1, fmax(1.2 * p95, 1.1 * budget_ms)));
	const double px_per_ms = (double)area->size.y / top;
	const float width = area->size.x / GZ_FRAME_HISTORY_SIZE;
	const struct gz_place end = { area->corner.x + area->size.x,
				      area->corner.y + area->size.y };
	gz_draw_rectangle(GZ_LAYER_PANEL, area->corner, end, gz_paint_ground, 0);
	for (size_t i = 0; i < history->count; i++) {
		const float right = end.x - (float)i * width;
		draw_cost_column(area, right - width, right, gz_frame_history_at(history, i),
				 px_per_ms);
	}
	draw_cost_level(area, top, px_per_ms, grid_paint);
	draw_cost_level(area, top / 2, px_per_ms, grid_paint);
	if (budget_ms > 0)
		draw_cost_level(area, budget_ms, px_per_ms, budget_paint);
}

static void draw_cost_row(struct gz_paint paint, const char *name, const char *median,
			  const char *p95)
{
	gz_widget_text(paint, name);
	gz_widgets_same_line(MEDIAN_SHARE);
	gz_widget_text(gz_paint_plain, median);
	gz_widgets_same_line(P95_SHARE);
	gz_widget_text(gz_paint_plain, p95);
}

static void draw_cost_numbers(const struct gz_frame_history *history)
{
	char name[48], median[24], p95[24];
	snprintf(name, sizeof name, "%zu frame%s, ms", history->count,
		 history->count == 1 ? "" : "s");
	draw_cost_row(gz_paint_plain, name, "median", "p95");
	for (int part = 0; part <= GZ_FRAME_PARTS; part++) {
		const bool total = part == GZ_FRAME_PARTS;
		snprintf(median, sizeof median, "%.2f",
			 gz_frame_history_quantile_ms(history, (enum gz_frame_part)part, 0.5));
		snprintf(p95, sizeof p95, "%.2f",
			 gz_frame_history_quantile_ms(history, (enum gz_frame_part)part, 0.95));
		draw_cost_row(total ? gz_paint_plain : cost_parts[part].paint,
			      total ? "all" : cost_parts[part].name, median, p95);
	}
}

/* The plot, one column a frame, the newest at the right, and its numbers. budget_ms: a line; 0:
 * none. */
static void draw_costs(const struct gz_frame_history *history, double budget_ms)
{
	struct plot_area area;
	gz_widget_area(PLOT_HEIGHT, &area.corner, &area.size);
	draw_cost_plot(history, budget_ms, &area);
	draw_cost_numbers(history);
}

/* ---- the part ---- */

static void toggle_frame_times(struct gz_window *window, int number)
{
	(void)number;
	window->settings.view.frame_times = !window->settings.view.frame_times;
	gz_window_wake_panels(window);
}

static bool are_frame_times_open(const struct gz_window *window)
{
	return window->settings.view.frame_times;
}

static bool are_frame_times_on(const struct gz_window *window, int number)
{
	(void)number;
	return window->settings.view.frame_times;
}

static const struct gz_window_action frame_times_actions[] = {
	{ .key = GLFW_KEY_ESCAPE, .applies = are_frame_times_open, .run = toggle_frame_times },
	{ .letter = 'b',
	  .keys = "B",
	  .help = "frame times, and a slider for the time budget",
	  .name = "Frame times and budget",
	  .menu = GZ_MENU_PICTURE,
	  .section = 2,
	  .words = "fps speed performance panel",
	  .is_on = are_frame_times_on,
	  .run = toggle_frame_times },
};

/* Costs of another scene say nothing of this one. */
static void forget_frame_times(struct gz_window *window)
{
	window->frame_times->history = (struct gz_frame_history) { 0 };
	window->frame_times->shown = (struct gz_frame_history) { 0 };
}

/* Before a frame is cast. */
static void note_frame_start(struct gz_window *window, struct gz_window_gaze *gaze)
{
	(void)gaze;
	window->frame_times->begun_ns = gz_clock_now_ns();
}

static void keep_frame_cost(struct gz_window *window)
{
	struct gz_window_frame_times *self = window->frame_times;
	const struct gz_frame_record *record = &window->record;
	const int64_t now_ns = gz_clock_now_ns();
	if (!window->frame_new)
		return;
	const struct gz_frame_cost cost = {
		.shown_ns = now_ns,
		.ms = { [GZ_FRAME_PLAN] = record->plan_ms,
			[GZ_FRAME_CAST] = record->cast_ms,
			[GZ_FRAME_RECONSTRUCT] = record->reconstruct_ms,
			[GZ_FRAME_REST] = gz_ns_to_ms(now_ns - self->begun_ns) - record->plan_ms -
					  record->cast_ms - record->reconstruct_ms },
	};
	gz_frame_history_add(&self->history, &cost);
	self->newer = window->settings.view.frame_times;
}

static int64_t frame_times_rest_ns(const struct gz_window_frame_times *self)
{
	return self->shown.count > 0 ? self->shown_ns + REST_NS - gz_clock_now_ns() : 0;
}

static void follow_frames(struct gz_window_frame_times *self)
{
	if (!self->newer || frame_times_rest_ns(self) > 0)
		return;
	self->shown = self->history;
	self->shown_ns = gz_clock_now_ns();
	self->newer = false;
}

/* The last frames before a rest are shown, too. */
static void turn_frame_times(struct gz_window *window)
{
	const struct gz_window_frame_times *self = window->frame_times;
	if (self->newer && frame_times_rest_ns(self) <= 0)
		window->present_needed = true;
}

static double frame_times_patience_s(const struct gz_window *window)
{
	const struct gz_window_frame_times *self = window->frame_times;
	return self->newer ? fmax(0, gz_ns_to_s(frame_times_rest_ns(self))) : INFINITY;
}

/* The range of the option is too wide for a slider. */
static void draw_budget(struct gz_window *window)
{
	static const struct gz_number_range range = {
		.least = 0,
		.greatest = BUDGET_SLIDER_MS,
		.slider = true,
		.format = "%.0f ms",
	};
	gz_widgets_disable(!gz_setting_applies(&window->settings, "attention.budget_ms"));
	gz_widget_label(gz_paint_plain, "time budget");
	gz_widgets_same_line(0.45F);
	gz_widgets_next_width(0);
	gz_widget_doubles("##budget", &window->settings.attention.budget_ms, 1, &range);
	gz_widget_tooltip(
		"95 % of frames take no longer, from plan to reconstruction; 0: no limit");
	gz_widgets_enable();
}

static void draw_settings(struct gz_window *window)
{
	static const char *const prefixes[] = { "foveation.", NULL };
	const struct gz_settings_panel rows = gz_window_settings_rows(window);
	draw_budget(window);
	gz_settings_rows_draw(&rows, prefixes);
}

static void draw_frame_times(struct gz_window *window, const struct gz_window_gaze *gaze)
{
	(void)gaze;
	const struct gz_panel_place place = {
		.at = gz_window_gaze_panel_open(window) ? GZ_PANEL_BOTTOM_RIGHT : GZ_PANEL_TOP_LEFT,
		.width = WIDTH,
		.margin_top = window->panels_top,
	};
	bool *shown = &window->settings.view.frame_times;
	if (!*shown || !window->maker) {
		window->frame_times->shown.count = 0;
		window->frame_times->newer = false;
		return;
	}
	if (window->frame_times->shown.count == 0)
		window->frame_times->newer = true;
	follow_frames(window->frame_times);
	if (gz_panel_begin("Frame times", &place, shown)) {
		draw_costs(&window->frame_times->shown, window->settings.attention.budget_ms);
		gz_widget_separator();
		draw_settings(window);
	}
	gz_panel_end();
}

const struct gz_window_part gz_window_frame_times_part = {
	.name = "frame times",
	.title = "picture",
	GZ_PART_ACTIONS(frame_times_actions),
	GZ_PART_STATE(frame_times),
	.scene_shown = forget_frame_times,
	.turn = turn_frame_times,
	.gaze = note_frame_start,
	.presented = keep_frame_cost,
	.panels = draw_frame_times,
	.patience_s = frame_times_patience_s,
};
