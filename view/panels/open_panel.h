/**
 * @file
 * The dialog that opens something: a folder's entries, what was shown lately, a path to be typed.
 * Inside a frame of panels/widgets.h.
 */
#ifndef GZ_VIEW_OPEN_PANEL_H
#define GZ_VIEW_OPEN_PANEL_H

#include <stdbool.h>

#include "view/files/folder.h"
#include "view/files/recent.h"

enum { GZ_PANEL_MESSAGE_SIZE = 256 };

/** What it shows. Zero-initialised is closed. */
struct gz_open_panel {
	bool open;
	struct gz_folder folder;
	struct gz_folder_filter filter;
	const struct gz_recent *recent;      /**< borrowed */
	char typed[GZ_PATH_SIZE];            /**< a path, or the beginning of a name in the list */
	char message[GZ_PANEL_MESSAGE_SIZE]; /**< what went wrong; empty: nothing */
	bool focus_wanted;                   /**< the field gets the keyboard in the next frame */
};

/** Open it on a folder; where that cannot be read, on the user's own or on "/". */
void gz_open_panel_show(struct gz_open_panel *panel, const char *folder,
			const struct gz_recent *recent);

/**
 * Draw it, if it is open.
 *
 * @param[out] out_path  absolute, of a file or a folder with volumes in it
 * @return whether something has been chosen: then the caller closes it, or says in panel->message
 *         why it cannot be opened
 */
bool gz_open_panel_draw(struct gz_open_panel *panel, char out_path[GZ_PATH_SIZE]);

/** Close it, and free the folder. */
void gz_open_panel_close(struct gz_open_panel *panel);

#endif
