#include "view/window/frame_times.h"

#include <stdlib.h>

#include <GLFW/glfw3.h>

#include "base/clock.h"
#include "view/frame/stats.h"
#include "view/panels/frame_times_panel.h"
#include "view/panels/settings_panel.h"
#include "view/panels/widgets.h"
#include "view/settings/scene_keys.h"
#include "view/window/gaze_settings.h"
#include "view/window/window_state.h"

/* Unscaled (chosen: names and values of settings fit, and a frame has more than a pixel). */
#define WIDTH 380.0f
/* Chosen: ten frames a second are few. */
#define BUDGET_SLIDER_MS 100.0

struct gz_window_frame_times {
	struct gz_frame_history history;
	int64_t begun_ns; /* this turn's frame */
};

static void toggle(struct gz_window *window, int number)
{
	(void)number;
	window->settings.view.frame_times = !window->settings.view.frame_times;
	gz_window_wake_panels(window);
}

static bool is_open(const struct gz_window *window)
{
	return window->settings.view.frame_times;
}

static const struct gz_window_action actions[] = {
	{ .key = GLFW_KEY_ESCAPE, .applies = is_open, .run = toggle },
	{ .letter = 'b',
	  .keys = "B",
	  .help = "frame times, and a slider for the time to keep",
	  .run = toggle },
};

static enum gz_result open_part(struct gz_window *window)
{
	window->frame_times = calloc(1, sizeof *window->frame_times);
	return window->frame_times ? GZ_OK : GZ_ERR_NO_MEM;
}

/* What another scene took tells nothing of this one. */
static void begin_scene(struct gz_window *window)
{
	window->frame_times->history = (struct gz_frame_history) { 0 };
}

/* Before the frame is cast, if it is. */
static void begin(struct gz_window *window, struct gz_window_gaze *gaze)
{
	(void)gaze;
	window->frame_times->begun_ns = gz_clock_now_ns();
}

static void keep(struct gz_window *window)
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
}

static bool setting_applies(const void *user, const char *key)
{
	return gz_setting_applies(user, key);
}

/* Its own slider: the table's range is too wide for one. */
static void draw_budget(struct gz_window *window)
{
	static const struct gz_number_range range = {
		.least = 0,
		.greatest = BUDGET_SLIDER_MS,
		.slider = true,
		.format = "%.0f ms",
	};
	gz_widgets_disable(!gz_setting_applies(&window->settings, "attention.budget_ms"));
	gz_widget_label("time to keep");
	gz_widgets_same_line(0.45F);
	gz_widgets_next_width(0);
	gz_widget_doubles("##budget", &window->settings.attention.budget_ms, 1, &range);
	gz_widget_tooltip("what 95 of 100 frames may take, plan to reconstruction; 0: no limit");
	gz_widgets_enable();
}

static void draw_settings(struct gz_window *window)
{
	static const char *const prefixes[] = { "foveation.", NULL };
	const struct gz_settings_panel rows = {
		.bindings = window->tables.bindings,
		.count = GZ_VIEW_SCENE_TABLES,
		.applies = setting_applies,
		.user = &window->settings,
	};
	draw_budget(window);
	gz_settings_rows_draw(&rows, prefixes);
}

static void draw_panels(struct gz_window *window, const struct gz_window_gaze *gaze)
{
	(void)gaze;
	const struct gz_panel_place place = {
		.at = gz_window_gaze_panel_shown(window) ? GZ_PANEL_BOTTOM_RIGHT
							 : GZ_PANEL_TOP_LEFT,
		.width = WIDTH,
		.margin_top = window->panels_top,
	};
	bool *shown = &window->settings.view.frame_times;
	if (!*shown || !window->maker)
		return;
	if (gz_panel_begin("Frame times", &place, shown)) {
		gz_frame_times_draw(&window->frame_times->history,
				    window->settings.attention.budget_ms);
		gz_widget_separator();
		draw_settings(window);
	}
	gz_panel_end();
}

static void close_part(struct gz_window *window)
{
	free(window->frame_times);
	window->frame_times = NULL;
}

const struct gz_window_part gz_window_frame_times_part = {
	.name = "frame times",
	.title = "picture",
	.actions = actions,
	.action_count = sizeof actions / sizeof actions[0],
	.open = open_part,
	.scene_shown = begin_scene,
	.gaze = begin,
	.presented = keep,
	.panels = draw_panels,
	.close = close_part,
};
