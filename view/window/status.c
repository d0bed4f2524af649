#include "view/window/status.h"

#include <stdio.h>
#include <string.h>

#include "base/clock.h"
#include "view/panels/marks.h"
#include "view/window/window_state.h"

/* A running age is drawn anew no more often than this (chosen: readable, and cheap). */
#define LINE_INTERVAL_NS (GZ_NS_PER_S / 2)

static void print_gaze(const struct gz_window *window, const struct gz_window_gaze *gaze,
		       char *text, size_t size)
{
	const struct gz_gaze_reading *reading = &gaze->reading;
	if (gaze->missing)
		snprintf(text, size, "no daemon (start gazed): mouse");
	else if (window->mouse_chosen || !reading->has_age)
		snprintf(text, size, "%s", gaze->source);
	else if (reading->age_ns > GZ_WINDOW_SILENT_NS)
		snprintf(text, size, "%s, silent", gaze->source);
	else
		snprintf(text, size, "%s %.0f ms %s", gaze->source, gz_ns_to_ms(reading->age_ns),
			 reading->has_event ? gz_event_name(reading->event) : "");
}

/* " of 20, 1.4 times coarser", as much of it as there is. */
static void print_budget(const struct gz_frame_record *record, char *text, size_t size)
{
	text[0] = '\0';
	if (record->budget_ms > 0 && record->focus.scale > 1)
		snprintf(text, size, " of %g, %.1f times coarser", record->budget_ms,
			 record->focus.scale);
	else if (record->budget_ms > 0)
		snprintf(text, size, " of %g", record->budget_ms);
}

/* The line that belongs to the frame on the screen; whether it says something new. */
static bool update_line(struct gz_window *window, const struct gz_window_gaze *gaze)
{
	char state[96], budget[48], line[GZ_WINDOW_LINE_SIZE];
	const struct gz_frame_record *record = &window->record;
	print_gaze(window, gaze, state, sizeof state);
	print_budget(record, budget, sizeof budget);
	snprintf(line, sizeof line, "%s  %dx%d  %.1f ms%s  %llu rays  |  gaze: %s  |  H: keys",
		 record->method, record->width, record->height, record->total_ms, budget,
		 (unsigned long long)record->rays, state);
	const bool changed = strcmp(line, window->line) != 0;
	memcpy(window->line, line, sizeof line);
	window->line_missing = gaze->missing;
	return changed;
}

static bool follows(struct gz_window *window, const struct gz_window_gaze *gaze)
{
	const int64_t now_ns = gz_clock_now_ns();
	const bool age_runs = gaze->reading.has_age && gaze->reading.age_ns <= GZ_WINDOW_SILENT_NS;
	if (!window->record.method ||
	    (age_runs && !window->frame_new && now_ns < window->line_due_ns))
		return false;
	return update_line(window, gaze);
}

static void draw_panels(struct gz_window *window, const struct gz_window_gaze *gaze)
{
	const bool warn = gaze->missing ||
			  (gaze->reading.has_age && gaze->reading.age_ns > GZ_WINDOW_SILENT_NS);
	window->line_due_ns = gz_clock_now_ns() + LINE_INTERVAL_NS;
	if (window->line[0])
		window->panels_top = gz_marks_draw_caption(
			0, warn ? gz_paint_amber : gz_paint_plain, window->line);
}

const struct gz_window_part gz_window_status = {
	.name = "status",
	.follows = follows,
	.panels = draw_panels,
};
