#include "view/panels/keys_panel.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "view/panels/widgets.h"

/* Unscaled (chosen: the longest keys, and most of what they do). */
#define COLUMN_WIDTH 400.0f
#define KEYS_WIDTH   95.0f
#define SIDES        40.0f

enum { COLUMNS_MAX = 3 };

static bool has_word_anywhere(const char *text, const char *word, size_t length)
{
	for (; *text; text++) {
		size_t same = 0;
		while (same < length && text[same] &&
		       tolower((unsigned char)text[same]) == tolower((unsigned char)word[same]))
			same++;
		if (same == length)
			return true;
	}
	return false;
}

bool gz_keys_row_matches(const struct gz_keys_row *row, const char *filter)
{
	for (const char *at = filter + strspn(filter, " "); *at; at += strspn(at, " ")) {
		const size_t length = strcspn(at, " ");
		if (!has_word_anywhere(row->help, at, length) &&
		    !has_word_anywhere(row->keys, at, length) &&
		    !has_word_anywhere(row->group, at, length))
			return false;
		at += length;
	}
	return true;
}

static size_t count_keys_lines(const struct gz_keys_row *rows, size_t count, const char *filter)
{
	size_t lines = 0;
	for (size_t i = 0; i < count; i++) {
		const bool begins = i == 0 || strcmp(rows[i].group, rows[i - 1].group) != 0;
		lines += gz_keys_row_matches(&rows[i], filter) + (begins ? 1 : 0);
	}
	return lines;
}

static void draw_keys_heading(const char *group)
{
	char heading[64];
	snprintf(heading, sizeof heading, "%s", group);
	heading[0] = (char)toupper((unsigned char)heading[0]);
	gz_widget_text(gz_paint_amber, heading);
}

/* A new column begins with a group. @return what gz_keys_panel_draw() does */
static size_t draw_keys_rows(const struct gz_keys_panel *panel, const struct gz_keys_row *rows,
			     size_t count, int columns)
{
	const size_t share = count_keys_lines(rows, count, panel->filter) / (size_t)columns + 1;
	const char *group = NULL;
	size_t lines = 0, chosen = count;
	int column = 1;
	for (size_t i = 0; i < count; i++) {
		char id[32];
		if (!gz_keys_row_matches(&rows[i], panel->filter))
			continue;
		if (!group || strcmp(group, rows[i].group) != 0) {
			if (lines >= share && column < columns) {
				gz_widget_columns_next();
				lines = 0;
				column++;
			}
			group = rows[i].group;
			draw_keys_heading(group);
			lines++;
		}
		snprintf(id, sizeof id, "##%zu", i);
		if (gz_widget_pair_row(id, KEYS_WIDTH, rows[i].keys, rows[i].help))
			chosen = i;
		lines++;
	}
	return chosen;
}

static size_t first_matching_row(const struct gz_keys_panel *panel, const struct gz_keys_row *rows,
				 size_t count)
{
	for (size_t i = 0; i < count && panel->filter[0]; i++)
		if (gz_keys_row_matches(&rows[i], panel->filter))
			return i;
	return count;
}

/* The field, and Enter in it. */
static size_t draw_keys_filter(struct gz_keys_panel *panel, const struct gz_keys_row *rows,
			       size_t count)
{
	gz_widget_label("Find");
	gz_widgets_same_line(0);
	gz_widgets_next_width(0);
	if (panel->search)
		gz_widgets_focus_next();
	panel->search = false;
	gz_widget_text_field("##find", panel->filter, sizeof panel->filter, false);
	return gz_widget_entered() ? first_matching_row(panel, rows, count) : count;
}

size_t gz_keys_panel_draw(struct gz_keys_panel *panel, const struct gz_keys_row *rows, size_t count)
{
	const float room = gz_widgets_room().x / gz_widgets_scale() - SIDES;
	const float fit = floorf(room / COLUMN_WIDTH);
	const int columns = fit < 1 ? 1 : fit > COLUMNS_MAX ? COLUMNS_MAX : (int)fit;
	const struct gz_panel_place place = {
		.at = GZ_PANEL_MIDDLE,
		.width = (float)columns * COLUMN_WIDTH,
	};
	size_t chosen = count;
	if (gz_panel_begin("Keys", &place, &panel->open)) {
		chosen = draw_keys_filter(panel, rows, count);
		gz_widget_columns_begin("##columns", columns);
		const size_t clicked = draw_keys_rows(panel, rows, count, columns);
		gz_widget_columns_end();
		chosen = clicked < count ? clicked : chosen;
	}
	gz_panel_end();
	return chosen;
}
