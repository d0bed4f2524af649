/* The part that asks which series is to be shown, if a folder holds several. */
#include "view/panels/series_panel.h"
#include "view/window/loading.h"
#include "view/window/window_state.h"

#define GZ_LOG_MODULE "window"

struct gz_window_series {
	struct gz_series_panel panel;
	const struct gz_series_list *list; /* the one in the panel; NULL: none */
};

/* The dialog is gone, or will show another list. */
static void clear_series_dialog(struct gz_window *window)
{
	struct gz_window_series *self = window->series;
	gz_series_panel_drop_icons(&self->panel);
	gz_series_panel_clear(&self->panel);
	self->list = NULL;
	gz_window_wake_panels(window);
}

static void turn_series(struct gz_window *window)
{
	struct gz_window_series *self = window->series;
	struct gz_series_list *list = gz_window_offered_series(window);
	bool changed = false;
	if (list != self->list && self->list)
		clear_series_dialog(window);
	self->list = list;
	if (!list)
		return;
	if (gz_series_panel_follow(&self->panel, list, &changed) != GZ_OK) {
		gz_err(window->log, "no memory to list the series; close other programs");
		gz_window_cancel_loading(window);
	}
	if (changed)
		gz_window_wake_panels(window);
}

static void draw_series_dialog(struct gz_window *window, const struct gz_window_gaze *gaze)
{
	struct gz_series_panel *panel = &window->series->panel;
	(void)gaze;
	if (!window->series->list || panel->count == 0)
		return;
	switch (gz_series_panel_draw(panel, gz_window_offering_path(window))) {
	case GZ_SERIES_WISH_SHOW:
		/* Why it fails has been logged; the list stays then. */
		(void)gz_window_choose_series(window, panel->rows[panel->chosen].row.series.uid);
		break;
	case GZ_SERIES_WISH_CANCEL:
		gz_window_cancel_loading(window);
		break;
	case GZ_SERIES_WISH_NONE:
		break;
	}
}

static void drop_series_icons(struct gz_window *window)
{
	if (window->series)
		gz_series_panel_drop_icons(&window->series->panel);
}

static void close_series(struct gz_window *window)
{
	gz_series_panel_clear(&window->series->panel);
}

const struct gz_window_part gz_window_series_part = {
	.name = "series",
	GZ_PART_STATE(series),
	.turn = turn_series,
	.panels = draw_series_dialog,
	.gl_close = drop_series_icons,
	.close = close_series,
};
