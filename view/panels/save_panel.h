/**
 * @file
 * The dialog that asks where a scene is saved. Inside a frame of panels/widgets.h.
 */
#ifndef GZ_VIEW_SAVE_PANEL_H
#define GZ_VIEW_SAVE_PANEL_H

#include <stdbool.h>

#include "protocol/gaze.h"
#include "view/panels/open_panel.h"

/** What it shows. Zero-initialised is closed. */
struct gz_save_panel {
	bool open;
	char path[GZ_PATH_SIZE];              /**< as typed */
	char asked[GZ_PATH_SIZE];             /**< the path that the question is about */
	char question[GZ_PANEL_MESSAGE_SIZE]; /**< asked before @p asked is saved; empty: none */
	char message[GZ_PANEL_MESSAGE_SIZE];  /**< what went wrong; empty: nothing */
	bool focus_wanted;
};

/** Open it with a path to begin with. */
void gz_save_panel_show(struct gz_save_panel *panel, const char *path);

/** Ask before the path that is typed is saved to: the next draw that returns true says yes, if the
 *  path is the same still. */
void gz_save_panel_ask(struct gz_save_panel *panel, const char *question);

/**
 * Draw it, if it is open.
 *
 * @param[out] out_sure  the question for this path has been answered by yes
 * @return whether panel->path is to be saved to; the caller closes it, asks, or says in
 *         panel->message why it cannot
 */
bool gz_save_panel_draw(struct gz_save_panel *panel, bool *out_sure);

#endif
