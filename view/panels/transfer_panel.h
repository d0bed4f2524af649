/**
 * @file
 * The panel in which a transfer function is edited, over its histogram. Inside a frame of
 * panels/widgets.h.
 */
#ifndef GZ_VIEW_PANELS_TRANSFER_PANEL_H
#define GZ_VIEW_PANELS_TRANSFER_PANEL_H

#include <stdbool.h>
#include <stddef.h>

#include "protocol/gaze.h"
#include "render/data/volume.h"
#include "render/transfer/histogram.h"
#include "view/panels/transfer_edit.h"
#include "view/panels/transfer_plot.h"

/** What the panel asks its caller to do. */
enum gz_transfer_wish {
	GZ_TRANSFER_WISH_NONE,
	GZ_TRANSFER_WISH_LOAD,     /**< load panel->file */
	GZ_TRANSFER_WISH_SAVE,     /**< save to panel->file */
	GZ_TRANSFER_WISH_LIGHT,    /**< light surfaces: the preset that was chosen shows some */
	GZ_TRANSFER_WISH_NO_LIGHT, /**< the preset that was chosen is for no lighting */
};

/** What the panel shows and changes. Zero-initialise it; set the first fields before each drawing.
 */
struct gz_transfer_panel {
	/* set before each drawing */
	struct gz_transfer_edit *edit;
	const struct gz_histogram *histogram; /**< of volume; NULL while it is being counted */
	int histogram_point; /**< time point of the volume that it counts, from 0 */
	const struct gz_volume *volume;
	float margin_top, margin_bottom; /**< kept free above and below it, screen coordinates */

	bool focus; /**< give the keyboard to the curve; set to false once done */

	bool open; /**< false once its cross was clicked */
	char file[GZ_PATH_SIZE];

	/* the panel's own */
	struct gz_transfer_plot plot;
	size_t selected;
	bool whole_lost; /**< the axis shows a part that the user chose */
	bool opacity_linear, counts_linear;
	bool dragged;                    /**< the mouse drags the selected point */
	struct gz_place grip;            /**< from the mouse to the point when the drag began */
	struct gz_place grip_at;         /**< the mouse then */
	double grip_value, grip_opacity; /**< the point then */
};

/** Draw the panel at the lower left, and apply the user's changes. Everything done during one press
 * of a button or key is one step of undo. */
enum gz_transfer_wish gz_transfer_panel_draw(struct gz_transfer_panel *panel);

#endif
