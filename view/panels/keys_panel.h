/**
 * @file
 * The list of keys and what they do, and the search over them and all else that can be done or set.
 * Inside a frame of panels/widgets.h.
 */
#ifndef GZ_VIEW_PANELS_KEYS_PANEL_H
#define GZ_VIEW_PANELS_KEYS_PANEL_H

#include <stdbool.h>
#include <stddef.h>

enum { GZ_KEYS_FILTER_SIZE = 64 };

/** A row of the list; texts are borrowed. */
struct gz_keys_row {
	const char *group; /**< rows of a group follow each other */
	const char *keys;  /**< "Ctrl+O"; NULL: only the search shows the row */
	const char *help;
	const char *name;  /**< in menus, by which it is found as well; NULL: none */
	const char *words; /**< other words that find it, separated by blanks; NULL: none */
};

/** State of the list. */
struct gz_keys_panel {
	bool open;
	bool search;     /**< the field gets the keyboard in the next frame */
	bool activating; /**< and has it in the one after that */
	char filter[GZ_KEYS_FILTER_SIZE];
	int selected; /**< of the rows found, the one that Enter runs */
};

/** Draw the list in as many columns as the window has room for; while something is searched for,
 *  what is found, the best first. @return index of the row to run, chosen by Enter or a click;
 *  @p count: none */
size_t gz_keys_panel_draw(struct gz_keys_panel *panel, const struct gz_keys_row *rows,
			  size_t count);

/**
 * How well a row fits a filter whose words, in any order and case, are all to be found in its keys,
 * help, group or other words.
 *
 * @return 0: not at all; larger for whole words and beginnings of words, and for rows with a key
 */
int gz_keys_row_fits(const struct gz_keys_row *row, const char *filter);

#endif
