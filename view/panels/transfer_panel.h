/**
 * @file
 * The panel in which a transfer function is edited, over its histogram. Inside a frame of
 * panels/widgets.h.
 */
#ifndef GZ_VIEW_TRANSFER_PANEL_H
#define GZ_VIEW_TRANSFER_PANEL_H

#include <stdbool.h>
#include <stddef.h>

#include "protocol/gaze.h"
#include "render/data/volume.h"
#include "render/transfer/histogram.h"
#include "view/panels/transfer_edit.h"
#include "view/panels/transfer_plot.h"

/** What it asks for that is not its own to do. */
enum gz_transfer_wish {
	GZ_TRANSFER_WISH_NONE,
	GZ_TRANSFER_WISH_LOAD, /**< the file that file names */
	GZ_TRANSFER_WISH_SAVE, /**< to it */
};

/** What it shows and changes, and how. Zero-initialised but for what is set before each drawing. */
struct gz_transfer_panel {
	/* set before each drawing */
	struct gz_transfer_edit *edit;
	const struct gz_histogram *histogram; /**< of volume; NULL while it is counted */
	const struct gz_volume *volume;
	float margin_top, margin_bottom; /**< kept free above and below it, screen coordinates */

	bool focus; /**< the curve has the keyboard from now on; false afterwards */

	bool open; /**< false once its cross was clicked */
	char file[GZ_PATH_SIZE];

	/* the panel's own */
	struct gz_transfer_plot plot;
	size_t selected;
	bool whole_lost; /**< the axis shows what the user chose, not all values */
	bool opacity_linear, counts_linear;
	bool dragged;                    /**< the point selected, by the mouse */
	struct gz_place grip;            /**< from the mouse to the point, when the drag began */
	struct gz_place grip_at;         /**< the mouse then */
	double grip_value, grip_opacity; /**< the point then */
};

/** Draw it at the lower left, and change what is edited as the user says. All that is done with one
 *  press of a button or key is one step. */
enum gz_transfer_wish gz_transfer_panel_draw(struct gz_transfer_panel *panel);

#endif
