#include "view/panels/gaze_panel.h"

#include <stdio.h>

#include "view/panels/widgets.h"

/* Unscaled (chosen: a path can be read beside its name). */
#define WIDTH       360.0f
#define LABEL_SHARE 0.32f

/* A fixed point may lie beside the picture, too. */
#define POINT_LEAST    -1.0
#define POINT_GREATEST 2.0

static const char *const source_names[GZ_GAZE_PANEL_SOURCE_COUNT] = {
	[GZ_GAZE_PANEL_DAEMON] = "daemon: a tracker, by gazed on this machine",
	[GZ_GAZE_PANEL_MOUSE] = "mouse",
	[GZ_GAZE_PANEL_POINTER] = "pointer: the mouse, by gazed --driver pointer",
	[GZ_GAZE_PANEL_ENDPOINT] = "endpoint: a daemon elsewhere",
	[GZ_GAZE_PANEL_LOG] = "log: a recording",
	[GZ_GAZE_PANEL_FIXED] = "fixed point",
};

/* Whether a row says where it comes from. */
static bool can_be_chosen(const struct gz_gaze_panel *panel, int source)
{
	if (source == GZ_GAZE_PANEL_ENDPOINT)
		return panel->endpoint[0] != '\0';
	if (source == GZ_GAZE_PANEL_LOG)
		return panel->log[0] != '\0';
	return source != GZ_GAZE_PANEL_POINTER || !panel->pointer_refused;
}

static const char *reason_against(int source)
{
	if (source == GZ_GAZE_PANEL_ENDPOINT)
		return "type its latest channel below, as in tcp://192.168.0.7:5556";
	if (source == GZ_GAZE_PANEL_LOG)
		return "type the name of a .gzl file below";
	return "the daemon reads another tracker";
}

static bool draw_sources(struct gz_gaze_panel *panel)
{
	bool chosen = false;
	for (int i = 0; i < GZ_GAZE_PANEL_SOURCE_COUNT; i++) {
		const bool possible = can_be_chosen(panel, i);
		gz_widgets_disable(!possible);
		if (gz_widget_row(source_names[i], panel->source == i, NULL)) {
			panel->source = i;
			chosen = true;
		}
		if (!possible)
			gz_widget_tooltip(reason_against(i));
		gz_widgets_enable();
	}
	return chosen;
}

static void label(const char *text)
{
	gz_widget_label(text);
	gz_widgets_same_line(LABEL_SHARE);
	gz_widgets_next_width(0);
}

/* What is typed is asked for at once. */
static bool draw_texts(struct gz_gaze_panel *panel)
{
	const struct gz_number_range range = {
		.least = POINT_LEAST,
		.greatest = POINT_GREATEST,
		.speed = 0.002,
		.format = "%.3f",
	};
	int source = -1;
	label("endpoint");
	if (gz_widget_text_field("##endpoint", panel->endpoint, sizeof panel->endpoint, true))
		source = GZ_GAZE_PANEL_ENDPOINT;
	label("log");
	if (gz_widget_text_field("##log", panel->log, sizeof panel->log, true))
		source = GZ_GAZE_PANEL_LOG;
	label("fixed point");
	if (gz_widget_doubles("##point", panel->point, 2, &range))
		source = GZ_GAZE_PANEL_FIXED;
	if (source < 0 || !can_be_chosen(panel, source))
		return false;
	panel->source = source;
	return true;
}

static void draw_log(struct gz_gaze_panel *panel, struct gz_gaze_panel_answer *answer)
{
	const struct gz_number_range range = {
		.least = 0,
		.greatest = panel->log_length_s,
		.slider = true,
		.format = "%.1f s",
	};
	label("place in it");
	gz_widgets_disable(panel->log_length_s <= 0);
	answer->log_s = gz_widget_doubles("##place", &panel->log_s, 1, &range);
	gz_widgets_enable();
	answer->log_paused = gz_widget_checkbox("its time stands still", &panel->log_paused);
}

static bool draw_displays(struct gz_gaze_panel *panel)
{
	/* The list of names is borrowed for this frame only. */
	char numbered[GZ_MONITORS_MAX][GZ_NAME_SIZE + 32];
	const char *names[GZ_MONITORS_MAX + 2] = { "found out" };
	const struct gz_monitor_list *list = panel->monitors;
	for (int i = 0; i < list->count; i++) {
		snprintf(numbered[i], sizeof numbered[i], "%d  %s  %dx%d", i + 1,
			 list->monitors[i].name, list->monitors[i].rect_px[2],
			 list->monitors[i].rect_px[3]);
		names[i + 1] = numbered[i];
	}
	label("display");
	const bool changed = gz_widget_choice("##display", &panel->tracker_display, names);
	gz_widget_tooltip("the monitor that a tracker's gaze is on");
	gz_widget_text(gz_paint_plain, panel->tracker_display_note);
	return changed;
}

static void draw_switches(struct gz_gaze_panel *panel)
{
	gz_widget_checkbox("cross at the gaze (C)", &panel->cursor);
	gz_widget_checkbox("trail of the last second (T)", &panel->trail);
	gz_widget_checkbox("freeze what is sharp (Space)", &panel->frozen);
	gz_widget_checkbox("wait for the display's refresh (S)", &panel->vsync);
}

struct gz_gaze_panel_answer gz_gaze_panel_draw(struct gz_gaze_panel *panel)
{
	struct gz_gaze_panel_answer answer = { 0 };
	const struct gz_panel_place place = {
		.at = panel->right ? GZ_PANEL_BOTTOM_RIGHT : GZ_PANEL_TOP_LEFT,
		.width = WIDTH,
		.margin_top = panel->margin_top,
		.margin_bottom = panel->margin_bottom,
	};
	if (gz_panel_begin("Gaze", &place, &panel->open)) {
		answer.source = draw_sources(panel);
		gz_widget_separator();
		answer.source |= draw_texts(panel);
		if (panel->has_log)
			draw_log(panel, &answer);
		gz_widget_separator();
		answer.tracker_display = draw_displays(panel);
		gz_widget_separator();
		draw_switches(panel);
		if (panel->latency[0]) {
			gz_widget_separator();
			gz_widget_text(gz_paint_plain, panel->latency);
		}
	}
	gz_panel_end();
	return answer;
}
