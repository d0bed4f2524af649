#include "view/panels/notices_panel.h"

#include <stdio.h>

#include "base/clock.h"
#include "view/panels/widgets.h"

/* Unscaled (chosen: a path fits, and half of a small window stays free). */
#define CORNER_WIDTH 400.0f
#define LIST_WIDTH   620.0f

enum { LIST_LINES = 14, LINE_SIZE = GZ_NOTICE_SIZE + 64 };

static struct gz_paint paint_of(const struct gz_notice *notice)
{
	if (notice->level >= GZ_LOG_ERROR)
		return gz_paint_red;
	return notice->level == GZ_LOG_WARN ? gz_paint_amber : gz_paint_plain;
}

static void print_line(const struct gz_notice *notice, const char *when, char *line, size_t size)
{
	char times[32] = "";
	if (notice->count > 1)
		snprintf(times, sizeof times, " (%u times)", notice->count);
	snprintf(line, size, "%s%s%s", when, notice->text, times);
}

size_t gz_notices_panel_draw(const struct gz_notice *notices, size_t count)
{
	const struct gz_panel_place place = { .at = GZ_PANEL_BOTTOM_RIGHT, .width = CORNER_WIDTH };
	size_t clicked = count;
	if (count == 0)
		return clicked;
	if (gz_panel_begin("##notices", &place, NULL)) {
		for (size_t i = count; i-- > 0;) {
			char line[LINE_SIZE];
			print_line(&notices[i], "", line, sizeof line);
			gz_widget_text(paint_of(&notices[i]), line);
			if (gz_widget_clicked())
				clicked = i;
			if (i > 0)
				gz_widget_separator();
		}
	}
	gz_panel_end();
	return clicked;
}

static void print_age(int64_t age_ns, char *text, size_t size)
{
	const double s = gz_ns_to_s(age_ns);
	if (s < 60)
		snprintf(text, size, "%.0f s ago: ", s);
	else if (s < 3600)
		snprintf(text, size, "%.0f min ago: ", s / 60);
	else
		snprintf(text, size, "%.0f h ago: ", s / 3600);
}

void gz_notices_list_draw(const struct gz_notice *notices, size_t count, int64_t now_ns, bool *open)
{
	const struct gz_panel_place place = { .at = GZ_PANEL_MIDDLE, .width = LIST_WIDTH };
	if (gz_panel_begin("Messages", &place, open)) {
		gz_widget_list_begin("##all", LIST_LINES);
		if (count == 0)
			gz_widget_text(gz_paint_plain, "There are none.");
		for (size_t i = 0; i < count; i++) {
			char age[32], line[LINE_SIZE];
			print_age(now_ns - notices[i].last_ns, age, sizeof age);
			print_line(&notices[i], age, line, sizeof line);
			gz_widget_text(paint_of(&notices[i]), line);
		}
		gz_widget_list_end();
	}
	gz_panel_end();
}
