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

/* Most rows that a search shows (chosen: seen at a glance). */
enum { COLUMNS_MAX = 3, FOUND_MAX = 12 };

/* Points for a word of the filter: found whole, at the beginning of a word, and within one; and for
 * a row with a key, which is used more than a setting. */
enum { WHOLE = 6, BEGINNING = 4, WITHIN = 1, HAS_KEY = 3 };

static size_t same_letters(const char *text, const char *word, size_t length)
{
	size_t same = 0;
	while (same < length && text[same] &&
	       tolower((unsigned char)text[same]) == tolower((unsigned char)word[same]))
		same++;
	return same;
}

/* Points for where a text has a word; 0: nowhere. */
static int points_of_word(const char *text, const char *word, size_t length)
{
	int most = 0;
	for (const char *at = text; at && *at; at++) {
		if (same_letters(at, word, length) < length)
			continue;
		const bool begins = at == text || !isalnum((unsigned char)at[-1]);
		const bool ends = !isalnum((unsigned char)at[length]);
		const int points = begins && ends ? WHOLE : begins ? BEGINNING : WITHIN;
		most = points > most ? points : most;
	}
	return most;
}

static int points_of_row(const struct gz_keys_row *row, const char *word, size_t length)
{
	const char *const texts[] = { row->help, row->keys, row->group, row->name, row->words };
	int most = 0;
	for (size_t i = 0; i < sizeof texts / sizeof texts[0]; i++) {
		const int points = points_of_word(texts[i], word, length);
		most = points > most ? points : most;
	}
	return most;
}

int gz_keys_row_fits(const struct gz_keys_row *row, const char *filter)
{
	int sum = 1 + (row->keys ? HAS_KEY : 0);
	for (const char *at = filter + strspn(filter, " "); *at; at += strspn(at, " ")) {
		const size_t length = strcspn(at, " ");
		const int points = points_of_row(row, at, length);
		if (points == 0)
			return 0;
		sum += points;
		at += length;
	}
	return sum;
}

static size_t count_keys_lines(const struct gz_keys_row *rows, size_t count)
{
	size_t lines = 0;
	for (size_t i = 0; i < count; i++) {
		const bool begins = i == 0 || strcmp(rows[i].group, rows[i - 1].group) != 0;
		if (rows[i].keys)
			lines += begins ? 2 : 1;
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
static size_t draw_keys_rows(const struct gz_keys_row *rows, size_t count, int columns)
{
	const size_t share = count_keys_lines(rows, count) / (size_t)columns + 1;
	const char *group = NULL;
	size_t lines = 0, chosen = count;
	int column = 1;
	for (size_t i = 0; i < count; i++) {
		char id[32];
		if (!rows[i].keys)
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
		if (gz_widget_pair_row(id, KEYS_WIDTH, rows[i].keys, rows[i].help, false))
			chosen = i;
		lines++;
	}
	return chosen;
}

/* ---- search ---- */

struct found_row {
	size_t index;
	int points;
};

/* Insert a row behind those that fit as well; the worst falls off. @return the new count */
static size_t keep_best(struct found_row *found, size_t kept, struct found_row row)
{
	size_t at = kept < FOUND_MAX ? kept : FOUND_MAX - 1;
	if (kept == FOUND_MAX && found[at].points >= row.points)
		return kept;
	for (; at > 0 && found[at - 1].points < row.points; at--)
		found[at] = found[at - 1];
	found[at] = row;
	return kept < FOUND_MAX ? kept + 1 : kept;
}

static size_t find_rows(const char *filter, const struct gz_keys_row *rows, size_t count,
			struct found_row found[FOUND_MAX])
{
	size_t kept = 0;
	for (size_t i = 0; i < count; i++) {
		const struct found_row row = { i, gz_keys_row_fits(&rows[i], filter) };
		if (row.points > 0)
			kept = keep_best(found, kept, row);
	}
	return kept;
}

/* Arrows choose what Enter runs. */
static void step_selection(struct gz_keys_panel *panel, size_t found)
{
	panel->selected += gz_widgets_arrow_steps();
	if (panel->selected >= (int)found)
		panel->selected = (int)found - 1;
	if (panel->selected < 0)
		panel->selected = 0;
}

static size_t draw_found_rows(struct gz_keys_panel *panel, const struct gz_keys_row *rows,
			      size_t count, bool entered)
{
	struct found_row found[FOUND_MAX];
	const size_t kept = find_rows(panel->filter, rows, count, found);
	size_t chosen = count;
	step_selection(panel, kept);
	if (gz_widget_list_begin("##found", FOUND_MAX + 1)) {
		if (kept == 0)
			gz_widget_text(gz_paint_amber, "Nothing found. Another word may find it; H "
						       "lists all keys.");
		for (size_t i = 0; i < kept; i++) {
			const struct gz_keys_row *row = &rows[found[i].index];
			char id[32];
			snprintf(id, sizeof id, "##%zu", i);
			if (gz_widget_pair_row(id, KEYS_WIDTH, row->keys ? row->keys : row->group,
					       row->help, (int)i == panel->selected))
				chosen = found[i].index;
		}
	}
	gz_widget_list_end();
	return entered && kept > 0 ? found[panel->selected].index : chosen;
}

/* ---- the panel ---- */

/* @return whether Enter was pressed in the field */
static bool draw_keys_filter(struct gz_keys_panel *panel)
{
	gz_widget_label(gz_paint_plain, "Find");
	gz_widgets_same_line(0);
	gz_widgets_next_width(0);
	if (panel->search)
		gz_widgets_focus_next();
	panel->activating = panel->search;
	panel->search = false;
	if (gz_widget_text_field("##find", panel->filter, sizeof panel->filter, false))
		panel->selected = 0;
	return gz_widget_entered();
}

size_t gz_keys_panel_draw(struct gz_keys_panel *panel, const struct gz_keys_row *rows, size_t count)
{
	const float room = gz_widgets_room().x / gz_widgets_scale() - SIDES;
	const float fit = floorf(room / COLUMN_WIDTH);
	const int columns = fit < 1 ? 1 : fit > COLUMNS_MAX ? COLUMNS_MAX : (int)fit;
	const bool searching = panel->filter[strspn(panel->filter, " ")] != '\0';
	const struct gz_panel_place place = {
		.at = GZ_PANEL_MIDDLE,
		.width = (float)columns * COLUMN_WIDTH,
	};
	size_t chosen = count;
	if (gz_panel_begin("Keys", &place, &panel->open)) {
		const bool entered = draw_keys_filter(panel);
		if (searching) {
			chosen = draw_found_rows(panel, rows, count, entered);
		} else {
			gz_widget_columns_begin("##columns", columns);
			chosen = draw_keys_rows(rows, count, columns);
			gz_widget_columns_end();
		}
	}
	gz_panel_end();
	return chosen;
}
