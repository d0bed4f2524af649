/* The part that shows the panel of the gaze: source, position in a log, the tracker's display, what
 * is shown of the gaze, and the latency; and does what is asked for in it. */
#include <stdio.h>
#include <string.h>

#include <GLFW/glfw3.h>

#include "base/clock.h"
#include "view/panels/widgets.h"
#include "view/window/displays.h"
#include "view/window/gaze.h"
#include "view/window/latency.h"
#include "view/window/window_state.h"

/* Interval of drawing the position in a log (chosen: the slider is seen to move). */
#define PLACE_INTERVAL_NS (GZ_NS_PER_S / 5)

/* Unscaled (chosen: a path can be read beside its name). */
#define WIDTH       360.0f
#define LABEL_SHARE 0.32f

/* A fixed point may lie beside the picture. */
#define POINT_LEAST    -1.0
#define POINT_GREATEST 2.0

enum { TEXT_SIZE = 512 };

/* What the panel shows and changes. */
struct gaze_panel {
	bool open;                       /* false once its cross was clicked */
	bool right;                      /* it appears at the lower right, as the left is taken */
	float margin_top, margin_bottom; /* kept free, screen coordinates */
	int source;                      /* enum gz_window_source */
	bool pointer_refused;            /* the daemon reads another tracker */
	char endpoint[GZ_PATH_SIZE];     /* as typed */
	char log[GZ_PATH_SIZE];          /* as typed */
	double point[2];                 /* of the fixed source */
	bool has_log;                    /* the next fields are of a log */
	bool log_paused;                 /* its clock is paused */
	double log_s, log_length_s;      /* position; length 0: not known */
	const struct gz_monitor_list *monitors;
	int tracker_display;              /* 0: automatic; n: the n-th of them */
	const char *tracker_display_note; /* which one that is, and why */
	bool cursor, trail, frozen, vsync;
	const char *latency; /* lines; empty: nothing is measured yet */
};

/* What was changed in the panel. */
struct gaze_panel_answer {
	bool source; /* another source, or its text or point */
	bool log_paused;
	bool log_s;
	bool tracker_display;
};

struct gz_window_gaze_panel {
	struct gaze_panel panel;
	int64_t drawn_ns;
	char note[TEXT_SIZE], latency[TEXT_SIZE];
};

/* ---- the panel ---- */

static const char *const source_names[GZ_WINDOW_SOURCE_COUNT] = {
	[GZ_WINDOW_DAEMON] = "daemon: the tracker of gazed on this machine",
	[GZ_WINDOW_MOUSE] = "mouse",
	[GZ_WINDOW_POINTER] = "pointer: the mouse, through gazed --driver pointer",
	[GZ_WINDOW_ENDPOINT] = "endpoint: a daemon elsewhere",
	[GZ_WINDOW_LOG] = "log: a recording",
	[GZ_WINDOW_FIXED] = "fixed point",
};

/* Whether a source can be chosen. */
static bool is_source_possible(const struct gaze_panel *panel, int source)
{
	if (source == GZ_WINDOW_ENDPOINT)
		return panel->endpoint[0] != '\0';
	if (source == GZ_WINDOW_LOG)
		return panel->log[0] != '\0';
	return source != GZ_WINDOW_POINTER || !panel->pointer_refused;
}

static const char *why_not_possible(int source)
{
	if (source == GZ_WINDOW_ENDPOINT)
		return "type its latest channel below, such as tcp://192.168.0.7:5556";
	if (source == GZ_WINDOW_LOG)
		return "type the name of a .gzl file below";
	return "the daemon reads another tracker";
}

static bool draw_source_rows(struct gaze_panel *panel)
{
	bool chosen = false;
	for (int i = 0; i < GZ_WINDOW_SOURCE_COUNT; i++) {
		const bool possible = is_source_possible(panel, i);
		gz_widgets_disable(!possible);
		if (gz_widget_row(source_names[i], panel->source == i, NULL)) {
			panel->source = i;
			chosen = true;
		}
		if (!possible)
			gz_widget_tooltip(why_not_possible(i));
		gz_widgets_enable();
	}
	return chosen;
}

static void draw_gaze_label(const char *text)
{
	gz_widget_label(gz_paint_plain, text);
	gz_widgets_same_line(LABEL_SHARE);
	gz_widgets_next_width(0);
}

/* A typed source is asked for at once. */
static bool draw_source_fields(struct gaze_panel *panel)
{
	const struct gz_number_range range = {
		.least = POINT_LEAST,
		.greatest = POINT_GREATEST,
		.speed = 0.002,
		.format = "%.3f",
	};
	int source = -1;
	draw_gaze_label("endpoint");
	if (gz_widget_text_field("##endpoint", panel->endpoint, sizeof panel->endpoint, true))
		source = GZ_WINDOW_ENDPOINT;
	draw_gaze_label("log");
	if (gz_widget_text_field("##log", panel->log, sizeof panel->log, true))
		source = GZ_WINDOW_LOG;
	draw_gaze_label("fixed point");
	if (gz_widget_doubles("##point", panel->point, 2, &range))
		source = GZ_WINDOW_FIXED;
	if (source < 0 || !is_source_possible(panel, source))
		return false;
	panel->source = source;
	return true;
}

static void draw_log_fields(struct gaze_panel *panel, struct gaze_panel_answer *answer)
{
	const struct gz_number_range range = {
		.least = 0,
		.greatest = panel->log_length_s,
		.slider = true,
		.format = "%.1f s",
	};
	draw_gaze_label("position");
	gz_widgets_disable(panel->log_length_s <= 0);
	answer->log_s = gz_widget_doubles("##place", &panel->log_s, 1, &range);
	gz_widgets_enable();
	answer->log_paused = gz_widget_checkbox("paused", &panel->log_paused);
}

static bool draw_display_choice(struct gaze_panel *panel)
{
	/* The names are borrowed for this frame only. */
	char numbered[GZ_MONITORS_MAX][GZ_NAME_SIZE + 32];
	const char *names[GZ_MONITORS_MAX + 2] = { "automatic" };
	const struct gz_monitor_list *list = panel->monitors;
	for (int i = 0; i < list->count; i++) {
		snprintf(numbered[i], sizeof numbered[i], "%d  %s  %dx%d", i + 1,
			 list->monitors[i].name, list->monitors[i].rect_px[2],
			 list->monitors[i].rect_px[3]);
		names[i + 1] = numbered[i];
	}
	draw_gaze_label("display");
	const bool changed = gz_widget_choice("##display", &panel->tracker_display, names);
	gz_widget_tooltip("the monitor that the tracker is on");
	gz_widget_text(gz_paint_plain, panel->tracker_display_note);
	return changed;
}

static void draw_gaze_switches(struct gaze_panel *panel)
{
	gz_widget_checkbox("cross at the gaze (C)", &panel->cursor);
	gz_widget_checkbox("trail of the last second (T)", &panel->trail);
	gz_widget_checkbox("freeze the sharp region (Space)", &panel->frozen);
	gz_widget_checkbox("V-sync (S)", &panel->vsync);
}

static struct gaze_panel_answer draw_gaze_panel(struct gaze_panel *panel)
{
	struct gaze_panel_answer answer = { 0 };
	const struct gz_panel_place place = {
		.at = panel->right ? GZ_PANEL_BOTTOM_RIGHT : GZ_PANEL_TOP_LEFT,
		.width = WIDTH,
		.margin_top = panel->margin_top,
		.margin_bottom = panel->margin_bottom,
	};
	if (gz_panel_begin("Gaze", &place, &panel->open)) {
		answer.source = draw_source_rows(panel);
		gz_widget_separator();
		answer.source |= draw_source_fields(panel);
		if (panel->has_log)
			draw_log_fields(panel, &answer);
		gz_widget_separator();
		answer.tracker_display = draw_display_choice(panel);
		gz_widget_separator();
		draw_gaze_switches(panel);
		if (panel->latency[0]) {
			gz_widget_separator();
			gz_widget_text(gz_paint_plain, panel->latency);
		}
	}
	gz_panel_end();
	return answer;
}

/* ---- its content ---- */

static void print_display_note(const struct gz_window *window, char *text, size_t size)
{
	static const char *const reasons[] = {
		[GZ_TRACKER_DISPLAY_ALONE] = "the only one",
		[GZ_TRACKER_DISPLAY_NAMED] = "as chosen",
		[GZ_TRACKER_DISPLAY_DESCRIBED] = "as the daemon describes it",
		[GZ_TRACKER_DISPLAY_WINDOW] = "the one the window is on",
	};
	const struct gz_tracker_display choice = gz_window_tracker_display(window);
	const struct gz_monitor *monitor = gz_window_tracker_monitor(window);
	if (!monitor)
		snprintf(text, size, "no monitor is known");
	else
		snprintf(text, size, "%s%s, %s", monitor->name,
			 choice.named_is_absent ? ", as the named one is missing" : "",
			 window->options->gaze_fills_window
				 ? "but --gaze-fills-window uses the window instead"
				 : reasons[choice.reason]);
}

static void print_latency_lines(const struct gz_window *window, char *text, size_t size)
{
	struct gz_latency latency;
	char age[64] = "", scanout[64] = "";
	text[0] = '\0';
	if (!gz_window_latency(window, &latency))
		return;
	if (latency.age_known)
		snprintf(age, sizeof age, "\n%6.1f  age of the sample", latency.age_ms);
	if (latency.scanout_ms > 0)
		snprintf(scanout, sizeof scanout, "\n%6.1f  scan-out, estimated as half a refresh",
			 latency.scanout_ms);
	snprintf(text, size,
		 "Latency, ms, medians of %d frame%s:%s\n%6.1f  frame, until the swap\n%6.1f  swap "
		 "until finished%s\n%6.1f  total, without the display's own",
		 latency.frames, latency.frames == 1 ? "" : "s", age, latency.frame_ms,
		 latency.present_ms, scanout, latency.total_ms);
}

/* Typed texts stay in their fields. */
static void show_source_texts(const struct gz_window *window, struct gaze_panel *panel)
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

static void show_log_position(const struct gz_window *window, struct gaze_panel *panel)
{
	struct gz_gaze_log_place place;
	panel->has_log = window->source && gz_gaze_source_log_place(window->source, &place);
	if (!panel->has_log)
		return;
	panel->log_paused = window->sources->log.paused;
	panel->log_s = gz_ns_to_s(place.at_ns);
	panel->log_length_s = place.length_ns > 0 ? gz_ns_to_s(place.length_ns) : 0;
}

static void fill_gaze_panel(struct gz_window *window, struct gz_window_gaze_panel *self)
{
	struct gaze_panel *panel = &self->panel;
	const struct gz_view_settings *view = &window->settings.view;
	panel->margin_top = window->panels_top;
	panel->margin_bottom = window->panels_bottom;
	panel->right = window->settings.view.frame_times;
	panel->source = (int)gz_window_source_now(window);
	panel->pointer_refused = window->sources->tracker_seen[0] &&
				 strcmp(window->sources->tracker_seen, "pointer") != 0;
	show_source_texts(window, panel);
	show_log_position(window, panel);
	panel->monitors = gz_window_monitors(window);
	panel->tracker_display =
		view->tracker_display[0]
			? gz_monitor_named(panel->monitors, view->tracker_display) + 1
			: 0;
	print_display_note(window, self->note, sizeof self->note);
	print_latency_lines(window, self->latency, sizeof self->latency);
	panel->tracker_display_note = self->note;
	panel->latency = self->latency;
	panel->cursor = view->gaze_cursor;
	panel->trail = view->trail;
	panel->vsync = view->vsync;
	panel->frozen = window->gaze_frozen;
}

/* The source follows the setting in the next turn: other parts use the present one in this frame.
 */
static void ask_for_panel_source(struct gz_window *window, const struct gaze_panel *panel)
{
	const struct gz_window_sources *sources = window->sources;
	const int at = panel->source;
	char text[GZ_PATH_SIZE] = "";
	if (at == GZ_WINDOW_FIXED)
		snprintf(text, sizeof text, "%.4g,%.4g", panel->point[0], panel->point[1]);
	else
		snprintf(text, sizeof text, "%s",
			 at == GZ_WINDOW_ENDPOINT ? panel->endpoint
			 : at == GZ_WINDOW_LOG    ? panel->log
						  : sources->named[at]);
	if (strcmp(text, sources->text) == 0)
		gz_window_seek_log(window, 0); /* the same log again: from its start */
	memcpy(window->settings.view.gaze, text, sizeof text);
}

/* By name, as numbers change when monitors are plugged in. */
static void choose_tracker_display(struct gz_window *window, const struct gaze_panel *panel)
{
	char *named = window->settings.view.tracker_display;
	const int at = panel->tracker_display - 1;
	named[0] = '\0';
	if (at >= 0 && at < panel->monitors->count)
		snprintf(named, sizeof window->settings.view.tracker_display, "%s",
			 panel->monitors->monitors[at].name);
}

static void apply_gaze_panel(struct gz_window *window, const struct gaze_panel *panel,
			     const struct gaze_panel_answer *answer)
{
	struct gz_view_settings *view = &window->settings.view;
	if (answer->source)
		ask_for_panel_source(window, panel);
	if (answer->log_paused)
		gz_window_pause_log(window, panel->log_paused);
	if (answer->log_s)
		gz_window_seek_log(window, (int64_t)(panel->log_s * (double)GZ_NS_PER_S));
	if (answer->tracker_display)
		choose_tracker_display(window, panel);
	view->gaze_cursor = panel->cursor;
	view->trail = panel->trail;
	view->vsync = panel->vsync;
	window->gaze_frozen = panel->frozen;
}

static void draw_gaze(struct gz_window *window, const struct gz_window_gaze *gaze)
{
	struct gz_window_gaze_panel *self = window->gaze_panel;
	(void)gaze;
	if (!self->panel.open || !window->maker)
		return;
	self->drawn_ns = gz_clock_now_ns();
	fill_gaze_panel(window, self);
	const struct gaze_panel_answer answer = draw_gaze_panel(&self->panel);
	apply_gaze_panel(window, &self->panel, &answer);
}

/* The slider of a log moves. */
static bool log_slider_follows(struct gz_window *window, const struct gz_window_gaze *gaze)
{
	const struct gz_window_gaze_panel *self = window->gaze_panel;
	(void)gaze;
	return self->panel.open && self->panel.has_log && !window->sources->log.paused &&
	       gz_clock_now_ns() - self->drawn_ns > PLACE_INTERVAL_NS;
}

static void toggle_gaze_panel(struct gz_window *window, int number)
{
	(void)number;
	window->gaze_panel->panel.open = !window->gaze_panel->panel.open;
	gz_window_wake_panels(window);
}

static bool is_gaze_panel_on(const struct gz_window *window, int number)
{
	(void)number;
	return window->gaze_panel->panel.open;
}

static const struct gz_window_action gaze_panel_actions[] = {
	{ .key = GLFW_KEY_ESCAPE, .applies = gz_window_gaze_panel_open, .run = toggle_gaze_panel },
	{ .letter = 'g',
	  .keys = "G",
	  .help = "gaze: source, log, display, latency",
	  .name = "Source, display, latency",
	  .menu = GZ_MENU_GAZE,
	  .section = 2,
	  .words = "tracker eye panel",
	  .is_on = is_gaze_panel_on,
	  .run = toggle_gaze_panel },
};

bool gz_window_gaze_panel_open(const struct gz_window *window)
{
	return window->gaze_panel->panel.open;
}

const struct gz_window_part gz_window_gaze_panel_part = {
	.name = "gaze settings",
	.title = "gaze",
	GZ_PART_ACTIONS(gaze_panel_actions),
	GZ_PART_STATE(gaze_panel),
	.follows = log_slider_follows,
	.panels = draw_gaze,
};
