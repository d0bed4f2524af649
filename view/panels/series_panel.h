/**
 * @file
 * The dialog that asks which of several series is to be shown. Inside a frame of panels/widgets.h.
 */
#ifndef GZ_VIEW_PANELS_SERIES_PANEL_H
#define GZ_VIEW_PANELS_SERIES_PANEL_H

#include <stdbool.h>
#include <stddef.h>

#include "base/result.h"
#include "render/data/series_list.h"

/** A row of the dialog. */
struct gz_series_panel_row {
	struct gz_series_row row;
	unsigned icon; /**< of the picture, view/draw/icon.h; 0: not made yet */
};

/** State of the dialog. Zero-initialised: no rows. */
struct gz_series_panel {
	struct gz_series_panel_row *rows;
	size_t count;
	uint64_t version; /**< of the list that is shown */
	size_t chosen;    /**< row that Enter takes; at least count: none */
};

/** What the user wants. */
enum gz_series_wish {
	GZ_SERIES_WISH_NONE,
	GZ_SERIES_WISH_SHOW,   /**< the series in the row panel->chosen */
	GZ_SERIES_WISH_CANCEL, /**< none of them */
};

/**
 * Take over what has changed in a list: the same one as before, or any other after
 * gz_series_panel_clear().
 *
 * @param[out] out_changed  written on GZ_OK
 * @retval GZ_ERR_NO_MEM  not logged; the dialog stays as it was
 */
enum gz_result gz_series_panel_follow(struct gz_series_panel *panel, struct gz_series_list *list,
				      bool *out_changed);

/** Draw the dialog for what lies at @p path. */
enum gz_series_wish gz_series_panel_draw(struct gz_series_panel *panel, const char *path);

/** Delete the pictures' textures in the current OpenGL context; they are made again when they are
 *  drawn. */
void gz_series_panel_drop_icons(struct gz_series_panel *panel);

/** Free the rows and zero the struct. Textures must be gone, or their context. */
void gz_series_panel_clear(struct gz_series_panel *panel);

#endif
