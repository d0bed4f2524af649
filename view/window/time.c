/* The part that shows the time points of a series: one after the other, or one that is chosen. */
#include <math.h>
#include <stdio.h>

#include <GLFW/glfw3.h>

#include "base/clock.h"
#include "render/data/time_steps.h"
#include "view/panels/widgets.h"
#include "view/window/time.h"
#include "view/window/window_state.h"

#define GZ_LOG_MODULE "window"

/* Rate unless --play gives one, steps per second. Chosen: a heart's or a breath's dozen of phases
 * takes about a second. */
#define RATE_PRESET 10.0

/* Unscaled. The marks of recordings lie below the panel. */
#define PANEL_WIDTH  320.0F
#define PANEL_BOTTOM 80.0F

enum { NONE = -1 };

struct gz_window_time {
	struct gz_playback playback;
	double rate;
	int wanted; /* time point that is coming; NONE: none */
	bool open;  /* the panel */
	bool begun; /* --play was obeyed */
};

static bool is_series_shown(const struct gz_window *window)
{
	return window->maker && !window->alone && gz_frame_time_points(window->maker) > 1;
}

bool gz_window_time_plays(const struct gz_window *window)
{
	return window->time->playback.playing;
}

/* Called on the thread that loads. */
static void wake_loop_for_time_point(void *user)
{
	(void)user;
	glfwPostEmptyEvent();
}

static void stop_playing(struct gz_window *window)
{
	window->time->playback.playing = false;
	window->time->wanted = NONE;
	gz_window_wake_panels(window);
}

static void play_or_pause(struct gz_window *window, int number)
{
	struct gz_window_time *self = window->time;
	(void)number;
	if (self->playback.playing)
		stop_playing(window);
	else
		gz_playback_start(&self->playback, self->rate, gz_clock_now_ns());
	gz_window_wake_panels(window);
}

/* The time point that is shown or coming. */
static int time_point_in_view(const struct gz_window *window)
{
	return window->time->wanted == NONE ? gz_frame_time_point(window->maker)
					    : window->time->wanted;
}

static void go_to_time_point(struct gz_window *window, int time_point)
{
	window->time->wanted = time_point;
	gz_window_wake_panels(window);
}

static void step_in_time(struct gz_window *window, int direction)
{
	const int count = gz_frame_time_points(window->maker);
	window->time->playback.playing = false;
	go_to_time_point(window, (time_point_in_view(window) + direction + count) % count);
}

static void toggle_time_panel(struct gz_window *window, int number)
{
	(void)number;
	window->time->open = !window->time->open;
	gz_window_wake_panels(window);
}

static const struct gz_window_action time_actions[] = {
	{ .letter = 'k',
	  .keys = "K",
	  .help = "play or pause the time points of a series",
	  .name = "Play time points",
	  .menu = GZ_MENU_PICTURE,
	  .section = 3,
	  .words = "movie animation 4d",
	  .applies = is_series_shown,
	  .run = play_or_pause },
	{ .letter = '.',
	  .repeats = true,
	  .number = 1,
	  .keys = ". ,",
	  .help = "next or previous time point",
	  .applies = is_series_shown,
	  .run = step_in_time },
	{ .letter = ',',
	  .repeats = true,
	  .number = -1,
	  .applies = is_series_shown,
	  .run = step_in_time },
	{ .letter = 'j',
	  .keys = "J",
	  .help = "show or hide the panel of the time points",
	  .name = "Time points",
	  .menu = GZ_MENU_PICTURE,
	  .section = 3,
	  .applies = is_series_shown,
	  .run = toggle_time_panel },
};

/* Show the time point that was taken. */
static void show_taken(struct gz_window *window)
{
	struct gz_window_time *self = window->time;
	self->wanted = NONE;
	if (!gz_window_let_data_go(window)) {
		gz_warn(window->log, "the time point stays while a session is recorded or shown");
		stop_playing(window);
		return;
	}
	/* Why it fails has been logged. */
	if (gz_frame_show_taken(window->maker) != GZ_OK)
		stop_playing(window);
	const int shown = gz_frame_time_point(window->maker);
	window->settings.time_point = window->shown.time_point = shown + 1;
	gz_playback_shown(&self->playback, gz_clock_now_ns());
	gz_frame_expect_time_point(window->maker, (shown + 1) % gz_frame_time_points(window->maker),
				   wake_loop_for_time_point);
	window->cast_needed = true;
	gz_window_wake_panels(window);
}

static void turn_time(struct gz_window *window)
{
	struct gz_window_time *self = window->time;
	if (!is_series_shown(window))
		return;
	if (self->playback.playing || self->wanted != NONE)
		window->motion_ns = gz_clock_now_ns();
	const int shown = gz_frame_time_point(window->maker);
	if (self->wanted == NONE && gz_playback_due(&self->playback, gz_clock_now_ns()))
		self->wanted = (shown + 1) % gz_frame_time_points(window->maker);
	if (self->wanted == shown)
		self->wanted = NONE;
	if (self->wanted == NONE)
		return;
	gz_frame_expect_time_point(window->maker, self->wanted, wake_loop_for_time_point);
	const enum gz_result r = gz_frame_take_time_point(window->maker, self->wanted, false);
	if (r == GZ_OK)
		show_taken(window);
	else if (r != GZ_ERR_TIMEOUT)
		stop_playing(window);
}

static void begin_series(struct gz_window *window)
{
	struct gz_window_time *self = window->time;
	const double asked = window->options->play;
	self->playback.playing = false;
	self->wanted = NONE;
	if (self->rate == 0)
		self->rate = asked > 0 ? asked : RATE_PRESET;
	if (!is_series_shown(window))
		return;
	self->open = true;
	if (asked > 0 && !self->begun)
		gz_playback_start(&self->playback, self->rate, gz_clock_now_ns());
	self->begun = true;
}

static void leave_series(struct gz_window *window)
{
	window->time->playback.playing = false;
	window->time->wanted = NONE;
}

static void draw_rate(struct gz_window_time *self)
{
	const struct gz_number_range range = { .least = 0.1,
					       .greatest = 60,
					       .slider = true,
					       .logarithmic = true,
					       .format = "%.3g per second" };
	gz_widgets_same_line(0.3F);
	gz_widgets_next_width(0);
	if (gz_widget_doubles("##rate", &self->rate, 1, &range) && self->playback.playing)
		gz_playback_start(&self->playback, self->rate, gz_clock_now_ns());
}

static void draw_time_panel(struct gz_window *window, const struct gz_window_gaze *gaze)
{
	struct gz_window_time *self = window->time;
	(void)gaze;
	if (!self->open || !is_series_shown(window))
		return;
	const int count = gz_frame_time_points(window->maker);
	const struct gz_panel_place place = { .at = GZ_PANEL_BOTTOM_RIGHT,
					      .margin_bottom = PANEL_BOTTOM * gz_widgets_scale(),
					      .width = PANEL_WIDTH };
	char format[48];
	snprintf(format, sizeof format, "time point %%d of %d", count);
	const struct gz_number_range points = {
		.least = 1, .greatest = count, .slider = true, .format = format
	};
	if (gz_panel_begin("Time points", &place, &self->open)) {
		int number = time_point_in_view(window) + 1;
		gz_widgets_next_width(0);
		if (gz_widget_ints("##time point", &number, 1, &points)) {
			self->playback.playing = false;
			go_to_time_point(window, number - 1);
		}
		if (gz_widget_button(self->playback.playing ? "pause" : "play"))
			play_or_pause(window, 0);
		gz_widget_tooltip("K; a full stop and a comma go forth and back");
		draw_rate(self);
	}
	gz_panel_end();
}

static double time_patience_s(const struct gz_window *window)
{
	const struct gz_window_time *self = window->time;
	/* A time point that is coming wakes the loop. */
	if (!is_series_shown(window) || !self->playback.playing || self->wanted != NONE)
		return INFINITY;
	return fmax(0, gz_ns_to_s(self->playback.due_ns - gz_clock_now_ns()));
}

const struct gz_window_part gz_window_time_part = {
	.name = "time",
	.title = "picture",
	GZ_PART_ACTIONS(time_actions),
	GZ_PART_STATE(time),
	.scene_shown = begin_series,
	.scene_leaving = leave_series,
	.turn = turn_time,
	.panels = draw_time_panel,
	.patience_s = time_patience_s,
};
