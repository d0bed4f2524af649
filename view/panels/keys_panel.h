/**
 * @file
 * The list of keys and what they do; rows can be searched and run. Inside a frame of
 * panels/widgets.h.
 */
#ifndef GZ_VIEW_PANELS_KEYS_PANEL_H
#define GZ_VIEW_PANELS_KEYS_PANEL_H

#include <stdbool.h>
#include <stddef.h>

enum { GZ_KEYS_FILTER_SIZE = 64 };

/** A row of the list; texts are borrowed. */
struct gz_keys_row {
	const char *group; /**< rows of a group follow each other */
	const char *keys;  /**< "Ctrl+O" */
	const char *help;
};

/** State of the list. */
struct gz_keys_panel {
	bool open;
	bool search; /**< the field gets the keyboard in the next frame */
	char filter[GZ_KEYS_FILTER_SIZE];
};

/** Draw the list in as many columns as the window has room for. @return index of the row to run,
 *  chosen by Enter or a click; @p count: none */
size_t gz_keys_panel_draw(struct gz_keys_panel *panel, const struct gz_keys_row *rows,
			  size_t count);

/** Whether keys, help and group of a row contain every word of a filter, in any order and case. */
bool gz_keys_row_matches(const struct gz_keys_row *row, const char *filter);

#endif
