#include "view/window/gaze_settings.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <GLFW/glfw3.h>

#include "base/clock.h"
#include "view/panels/gaze_panel.h"
#include "view/panels/widgets.h"
#include "view/window/displays.h"
#include "view/window/gaze_sources.h"
#include "view/window/latency.h"
#include "view/window/window_state.h"

/* The place in a log is drawn anew no more often (chosen: a slider is seen to move). */
#define PLACE_INTERVAL_NS (GZ_NS_PER_S / 5)

enum { TEXT_SIZE = 512 };

struct gz_window_gaze_settings {
	struct gz_gaze_panel panel;
	int64_t drawn_ns;
	char note[TEXT_SIZE], latency[TEXT_SIZE];
};

/* The rows are the sources that M goes through. */
_Static_assert((int)GZ_GAZE_PANEL_SOURCE_COUNT == (int)GZ_WINDOW_SOURCE_COUNT &&
		       (int)GZ_GAZE_PANEL_LOG == (int)GZ_WINDOW_LOG &&
		       (int)GZ_GAZE_PANEL_FIXED == (int)GZ_WINDOW_FIXED &&
		       (int)GZ_GAZE_PANEL_ENDPOINT == (int)GZ_WINDOW_ENDPOINT,
	       "rows of the panel");

static void print_note(const struct gz_window *window, char *text, size_t size)
{
	static const char *const reasons[] = {
		[GZ_TRACKER_DISPLAY_ALONE] = "the only one",
		[GZ_TRACKER_DISPLAY_NAMED] = "as chosen",
		[GZ_TRACKER_DISPLAY_DESCRIBED] = "as the daemon describes it",
		[GZ_TRACKER_DISPLAY_WINDOW] = "which the window is on",
	};
	const struct gz_tracker_display choice = gz_window_tracker_display(window);
	const struct gz_monitor *monitor = gz_window_tracker_monitor(window);
	if (!monitor)
		snprintf(text, size, "no monitor is known");
	else
		snprintf(text, size, "%s%s, %s", monitor->name,
			 choice.named_is_absent ? ", the named one not being there" : "",
			 window->options->gaze_fills_window
				 ? "but --gaze-fills-window takes the window for it"
				 : reasons[choice.reason]);
}

static void print_latency(const struct gz_window *window, char *text, size_t size)
{
	struct gz_latency latency;
	char age[64] = "", scanout[64] = "";
	text[0] = '\0';
	if (!gz_window_latency(window, &latency))
		return;
	if (latency.age_known)
		snprintf(age, sizeof age, "\n%6.1f  the sample's age when taken", latency.age_ms);
	if (latency.scanout_ms > 0)
		snprintf(scanout, sizeof scanout, "\n%6.1f  half a refresh, estimated",
			 latency.scanout_ms);
	snprintf(text, size,
		 "From gaze to photon, ms, medians of %d frames:%s\n%6.1f  the frame, to its "
		 "hand-over\n%6.1f  swap to fence%s\n%6.1f  in all, without the display's own",
		 latency.frames, age, latency.frame_ms, latency.present_ms, scanout,
		 latency.total_ms);
}

/* What is typed stays as long as nothing else is asked for. */
static void show_texts(const struct gz_window *window, struct gz_gaze_panel *panel)
{
	const struct gz_window_sources *sources = window->sources;
	if (!panel->endpoint[0])
		memcpy(panel->endpoint, sources->named[GZ_WINDOW_ENDPOINT], sizeof panel->endpoint);
	if (!panel->log[0])
		memcpy(panel->log, sources->named[GZ_WINDOW_LOG], sizeof panel->log);
	panel->point[0] = panel->point[1] = 0.5;
	if (sources->choice.kind == GZ_GAZE_FIXED) {
		panel->point[0] = (double)sources->choice.point.x;
		panel->point[1] = (double)sources->choice.point.y;
	}
}

static void show_log(const struct gz_window *window, struct gz_gaze_panel *panel)
{
	struct gz_gaze_log_place place;
	panel->has_log = window->source && gz_gaze_source_log_place(window->source, &place);
	if (!panel->has_log)
		return;
	panel->log_paused = window->sources->log.paused;
	panel->log_s = gz_ns_to_s(place.at_ns);
	panel->log_length_s = place.length_ns > 0 ? gz_ns_to_s(place.length_ns) : 0;
}

static void show(struct gz_window *window, struct gz_window_gaze_settings *self)
{
	struct gz_gaze_panel *panel = &self->panel;
	const struct gz_view_settings *view = &window->settings.view;
	panel->margin_top = window->panels_top;
	panel->margin_bottom = window->panels_bottom;
	panel->right = window->settings.view.frame_times;
	panel->source = (int)gz_window_source_now(window);
	panel->pointer_refused = window->sources->tracker_seen[0] &&
				 strcmp(window->sources->tracker_seen, "pointer") != 0;
	show_texts(window, panel);
	show_log(window, panel);
	panel->monitors = gz_window_monitors(window);
	panel->tracker_display =
		view->tracker_display[0]
			? gz_monitor_named(panel->monitors, view->tracker_display) + 1
			: 0;
	print_note(window, self->note, sizeof self->note);
	print_latency(window, self->latency, sizeof self->latency);
	panel->tracker_display_note = self->note;
	panel->latency = self->latency;
	panel->cursor = view->gaze_cursor;
	panel->trail = view->trail;
	panel->vsync = view->vsync;
	panel->frozen = window->gaze_frozen;
}

/* The sources follow the setting in the next turn: in this frame others look at the one there is.
 */
static void ask_for_source(struct gz_window *window, const struct gz_gaze_panel *panel)
{
	const struct gz_window_sources *sources = window->sources;
	const int at = panel->source;
	char text[GZ_PATH_SIZE] = "";
	if (at == GZ_GAZE_PANEL_FIXED)
		snprintf(text, sizeof text, "%.4g,%.4g", panel->point[0], panel->point[1]);
	else
		snprintf(text, sizeof text, "%s",
			 at == GZ_GAZE_PANEL_ENDPOINT ? panel->endpoint
			 : at == GZ_GAZE_PANEL_LOG    ? panel->log
						      : sources->named[at]);
	if (strcmp(text, sources->text) == 0)
		gz_window_seek_log(window, 0); /* the same log: from its start */
	memset(window->settings.view.gaze, 0, sizeof window->settings.view.gaze);
	memcpy(window->settings.view.gaze, text, strlen(text));
}

/* By its name, which stays when numbers change. */
static void choose_display(struct gz_window *window, const struct gz_gaze_panel *panel)
{
	char *named = window->settings.view.tracker_display;
	const int at = panel->tracker_display - 1;
	memset(named, 0, sizeof window->settings.view.tracker_display);
	if (at >= 0 && at < panel->monitors->count)
		snprintf(named, sizeof window->settings.view.tracker_display, "%s",
			 panel->monitors->monitors[at].name);
}

static void obey(struct gz_window *window, const struct gz_gaze_panel *panel,
		 const struct gz_gaze_panel_answer *answer)
{
	struct gz_view_settings *view = &window->settings.view;
	if (answer->source)
		ask_for_source(window, panel);
	if (answer->log_paused)
		gz_window_pause_log(window, panel->log_paused);
	if (answer->log_s)
		gz_window_seek_log(window, (int64_t)(panel->log_s * (double)GZ_NS_PER_S));
	if (answer->tracker_display)
		choose_display(window, panel);
	view->gaze_cursor = panel->cursor;
	view->trail = panel->trail;
	view->vsync = panel->vsync;
	window->gaze_frozen = panel->frozen;
}

static void draw(struct gz_window *window, const struct gz_window_gaze *gaze)
{
	struct gz_window_gaze_settings *self = window->gaze_settings;
	(void)gaze;
	if (!self->panel.open || !window->maker)
		return;
	self->drawn_ns = gz_clock_now_ns();
	show(window, self);
	const struct gz_gaze_panel_answer answer = gz_gaze_panel_draw(&self->panel);
	obey(window, &self->panel, &answer);
}

/* A log goes on, and its slider with it. */
static bool follows(struct gz_window *window, const struct gz_window_gaze *gaze)
{
	const struct gz_window_gaze_settings *self = window->gaze_settings;
	(void)gaze;
	return self->panel.open && self->panel.has_log && !window->sources->log.paused &&
	       gz_clock_now_ns() - self->drawn_ns > PLACE_INTERVAL_NS;
}

static void toggle(struct gz_window *window, int number)
{
	(void)number;
	window->gaze_settings->panel.open = !window->gaze_settings->panel.open;
	gz_window_wake_panels(window);
}

static const struct gz_window_action actions[] = {
	{ .key = GLFW_KEY_ESCAPE, .applies = gz_window_gaze_panel_shown, .run = toggle },
	{ .letter = 'g',
	  .keys = "G",
	  .help = "gaze: source, log, display, latency",
	  .run = toggle },
};

static enum gz_result open_part(struct gz_window *window)
{
	window->gaze_settings = calloc(1, sizeof *window->gaze_settings);
	return window->gaze_settings ? GZ_OK : GZ_ERR_NO_MEM;
}

static void close_part(struct gz_window *window)
{
	free(window->gaze_settings);
	window->gaze_settings = NULL;
}

bool gz_window_gaze_panel_shown(const struct gz_window *window)
{
	return window->gaze_settings && window->gaze_settings->panel.open;
}

const struct gz_window_part gz_window_gaze_settings_part = {
	.name = "gaze settings",
	.title = "gaze",
	.actions = actions,
	.action_count = sizeof actions / sizeof actions[0],
	.open = open_part,
	.follows = follows,
	.panels = draw,
	.close = close_part,
};
