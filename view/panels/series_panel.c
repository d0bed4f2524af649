#include "view/panels/series_panel.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "view/draw/icon.h"
#include "view/panels/widgets.h"

/* Unscaled: width of the dialog, height of a row, edge of its picture, and gaps (chosen: three
 * lines of text beside a picture). */
#define PANEL_WIDTH  620.0f
#define ROW_HEIGHT   56.0f
#define ICON_EDGE    52.0f
#define GAP          8.0f
#define LINE_HEIGHT  17.0f
#define AROUND_LIST  110.0f /* height of what is above and below the list */
#define LIST_PADDING 3      /* lines of text */

enum { ROWS_LEAST = 2, ROWS_MOST = 9, LINE_SIZE = 512 };

static const struct gz_paint grey_paint = { 150, 150, 150, 255 };

static bool can_be_shown(const struct gz_series_panel_row *row)
{
	return row->row.series.reason[0] == '\0';
}

/* ---- rows ---- */

static bool make_rows(struct gz_series_panel *panel, size_t count)
{
	if (count == panel->count)
		return true;
	struct gz_series_panel_row *rows = realloc(panel->rows, count * sizeof *rows);
	if (!rows)
		return false;
	memset(rows + panel->count, 0, (count - panel->count) * sizeof *rows);
	if (panel->chosen >= panel->count)
		panel->chosen = count; /* none yet */
	panel->rows = rows;
	panel->count = count;
	return true;
}

/* Enter takes the first series that can be shown, unless another row was chosen. */
static void choose_some_row(struct gz_series_panel *panel)
{
	if (panel->chosen < panel->count && can_be_shown(&panel->rows[panel->chosen]))
		return;
	for (panel->chosen = 0; panel->chosen < panel->count; panel->chosen++)
		if (can_be_shown(&panel->rows[panel->chosen]))
			return;
}

enum gz_result gz_series_panel_follow(struct gz_series_panel *panel, struct gz_series_list *list,
				      bool *out_changed)
{
	const uint64_t version = gz_series_list_version(list);
	const bool changed = version != panel->version;
	if (changed && !make_rows(panel, gz_series_list_count(list)))
		return GZ_ERR_NO_MEM;
	for (size_t i = 0; changed && i < panel->count; i++)
		(void)gz_series_list_update(list, i, &panel->rows[i].row);
	if (changed)
		choose_some_row(panel);
	panel->version = version;
	*out_changed = changed;
	return GZ_OK;
}

void gz_series_panel_drop_icons(struct gz_series_panel *panel)
{
	for (size_t i = 0; i < panel->count; i++)
		gz_icon_free(&panel->rows[i].icon);
}

void gz_series_panel_clear(struct gz_series_panel *panel)
{
	free(panel->rows);
	*panel = (struct gz_series_panel) { 0 };
}

/* ---- drawing ---- */

static void draw_row_picture(struct gz_series_panel_row *row, struct gz_place corner)
{
	const float edge = ICON_EDGE * gz_widgets_scale();
	const struct gz_place opposite = { corner.x + edge, corner.y + edge };
	const struct gz_paint dark = { 0, 0, 0, 255 };
	if (!row->icon && row->row.has_picture)
		row->icon = gz_icon_make(row->row.picture, GZ_DECODE_PICTURE_EDGE);
	if (row->icon)
		gz_draw_icon(GZ_LAYER_PANEL, corner, opposite, row->icon);
	else
		gz_draw_rectangle(GZ_LAYER_PANEL, corner, opposite, dark, 0);
}

static void draw_row_line(struct gz_place corner, int line, struct gz_paint paint, const char *text)
{
	const float scale = gz_widgets_scale();
	const struct gz_place at = { corner.x + (ICON_EDGE + GAP) * scale,
				     corner.y + (float)line * LINE_HEIGHT * scale };
	gz_draw_text(GZ_LAYER_PANEL, at, 1, paint, text);
}

static void draw_row_texts(const struct gz_series_panel_row *row, struct gz_place corner)
{
	const struct gz_decode_series *series = &row->row.series;
	const bool shown = can_be_shown(row);
	const struct gz_paint paint = shown ? gz_paint_plain : grey_paint;
	char line[LINE_SIZE];
	snprintf(line, sizeof line, "%s%s%s", series->patient[0] ? series->patient : "no name",
		 series->date[0] ? ", " : "", series->date);
	draw_row_line(corner, 0, paint, line);
	snprintf(line, sizeof line, "%s%s%" PRId32 " %s%s%s", series->modality,
		 series->modality[0] ? ", " : "", series->slices,
		 series->slices == 1 ? "slice" : "slices", series->description[0] ? ": " : "",
		 series->description);
	draw_row_line(corner, 1, paint, line);
	draw_row_line(corner, 2, shown ? grey_paint : gz_paint_amber,
		      shown ? series->uid : series->reason);
}

/* @return whether the row was chosen. */
static bool draw_series_row(struct gz_series_panel *panel, size_t index)
{
	struct gz_series_panel_row *row = &panel->rows[index];
	const float gap = (ROW_HEIGHT - ICON_EDGE) / 2 * gz_widgets_scale();
	struct gz_tall_row tall = { .height = ROW_HEIGHT, .selected = index == panel->chosen };
	char id[32];
	snprintf(id, sizeof id, "##series %zu", index);
	const bool shown = can_be_shown(row);
	gz_widgets_disable(!shown);
	const bool taken = gz_widget_tall_row(id, &tall) && shown;
	gz_widgets_enable();
	gz_widget_tooltip(shown ? row->row.series.uid : row->row.series.reason);
	if (shown && (tall.focused || taken))
		panel->chosen = index;
	const struct gz_place corner = { tall.corner.x + gap, tall.corner.y + gap };
	draw_row_picture(row, corner);
	draw_row_texts(row, corner);
	return taken;
}

/* Height of the list in lines of text: as many rows as there are and the window has room for. */
static int series_list_lines(size_t count)
{
	const float room = gz_widgets_room().y / gz_widgets_scale() - AROUND_LIST;
	const int rows_fit = (int)(room / ROW_HEIGHT);
	int rows = count < ROWS_MOST ? (int)count : ROWS_MOST;
	rows = rows < rows_fit ? rows : rows_fit;
	rows = rows < ROWS_LEAST ? ROWS_LEAST : rows;
	return (int)((float)rows * ROW_HEIGHT / LINE_HEIGHT) + LIST_PADDING;
}

static bool draw_series_rows(struct gz_series_panel *panel)
{
	bool taken = false;
	if (gz_widget_list_begin("##series", series_list_lines(panel->count)))
		for (size_t i = 0; i < panel->count; i++)
			taken = draw_series_row(panel, i) || taken;
	gz_widget_list_end();
	return taken;
}

enum gz_series_wish gz_series_panel_draw(struct gz_series_panel *panel, const char *path)
{
	const struct gz_panel_place place = { .at = GZ_PANEL_MIDDLE,
					      .width = PANEL_WIDTH,
					      .takes_keyboard = true };
	bool open = true, taken = false;
	if (gz_panel_begin("Several series: which one?", &place, &open)) {
		gz_widget_text(gz_paint_plain, path);
		taken = draw_series_rows(panel);
		gz_widgets_disable(panel->chosen >= panel->count);
		taken = gz_widget_button("Show") || taken;
		gz_widgets_enable();
		taken = taken || gz_dialog_entered();
		gz_widgets_same_line(0);
		if (gz_widget_button("Cancel") || gz_dialog_escaped())
			open = false;
	}
	gz_panel_end();
	if (!open)
		return GZ_SERIES_WISH_CANCEL;
	return taken && panel->chosen < panel->count ? GZ_SERIES_WISH_SHOW : GZ_SERIES_WISH_NONE;
}
