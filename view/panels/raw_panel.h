/**
 * @file
 * The dialog that asks what a file without a header holds. Inside a frame of panels/widgets.h.
 */
#ifndef GZ_VIEW_RAW_PANEL_H
#define GZ_VIEW_RAW_PANEL_H

#include <stdbool.h>

#include "protocol/gaze.h"
#include "render/data/raw_guess.h"

/** What it shows. Zero-initialised is closed. */
struct gz_raw_panel {
	bool open;
	char path[GZ_PATH_SIZE];
	uint64_t bytes; /**< of voxels in the file; 0: not known */
	struct gz_raw_guess guesses[GZ_RAW_GUESSES_MAX];
	size_t count;
	struct gz_raw_layout layout; /**< as the fields say */
};

/** Open it for a file, with the best guess in the fields. */
void gz_raw_panel_show(struct gz_raw_panel *panel, const char *path);

/** Draw it, if it is open. @return whether panel->layout has been confirmed, and the panel closed:
 *  its bytes are the file's, unless those are not known */
bool gz_raw_panel_draw(struct gz_raw_panel *panel);

#endif
