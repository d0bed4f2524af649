#include "view/window/status.h"

#include <stdio.h>
#include <string.h>

#include "view/panels/marks.h"
#include "view/window/window_state.h"

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
static bool update_line(struct gz_window *window)
{
	char budget[48], line[GZ_WINDOW_LINE_SIZE];
	const struct gz_frame_record *record = &window->record;
	print_budget(record, budget, sizeof budget);
	snprintf(line, sizeof line, "%s  %dx%d  %.1f ms%s  %llu rays  |  H: keys", record->method,
		 record->width, record->height, record->total_ms, budget,
		 (unsigned long long)record->rays);
	const bool changed = strcmp(line, window->line) != 0;
	memcpy(window->line, line, sizeof line);
	return changed;
}

static bool follows(struct gz_window *window, const struct gz_window_gaze *gaze)
{
	(void)gaze;
	return window->record.method && update_line(window);
}

static void draw_panels(struct gz_window *window, const struct gz_window_gaze *gaze)
{
	(void)gaze;
	if (window->line[0] && window->record.method)
		window->panels_top = gz_marks_draw_caption(0, gz_paint_plain, window->line);
}

const struct gz_window_part gz_window_status = {
	.name = "status",
	.follows = follows,
	.panels = draw_panels,
};
