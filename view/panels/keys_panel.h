/**
 * @file
 * The list of keys and what they do, to read, to search and to run. Inside a frame of
 * panels/widgets.h.
 */
#ifndef GZ_VIEW_KEYS_PANEL_H
#define GZ_VIEW_KEYS_PANEL_H

#include <stdbool.h>
#include <stddef.h>

enum { GZ_KEYS_FILTER_SIZE = 64 };

/** A row of it; texts are borrowed. */
struct gz_keys_row {
	const char *group; /**< rows of one stand together */
	const char *keys;  /**< "Ctrl+O" */
	const char *help;
};

/** Its state. */
struct gz_keys_panel {
	bool open;
	bool search; /**< the next frame gives the keyboard to the field */
	char filter[GZ_KEYS_FILTER_SIZE];
};

/** Draw it, as many columns as the window has room for. @return the row that is to be run, by Enter
 * or a click; @p count: none */
size_t gz_keys_panel_draw(struct gz_keys_panel *panel, const struct gz_keys_row *rows,
			  size_t count);

/** Whether a row has every word of a filter, in any order and case. */
bool gz_keys_row_matches(const struct gz_keys_row *row, const char *filter);

#endif
