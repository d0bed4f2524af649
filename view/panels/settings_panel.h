/**
 * @file
 * The panel of settings: a widget for each row of the option tables, under a heading for each
 * section. Inside a frame of panels/widgets.h.
 */
#ifndef GZ_VIEW_SETTINGS_PANEL_H
#define GZ_VIEW_SETTINGS_PANEL_H

#include <stdbool.h>
#include <stddef.h>

#include "base/option.h"

/** What it shows and changes. */
struct gz_settings_panel {
	const struct gz_option_binding *bindings;
	size_t count;
	/** Whether a row counts, by its key; others are shown grey. NULL: all do. */
	bool (*applies)(const void *user, const char *key);
	const void *user;
	float margin_top; /**< kept free above it, screen coordinates */
	bool open;        /**< false once its cross was clicked */
};

/**
 * Draw only the rows whose keys begin with one of @p prefixes, NULL-terminated, without headings,
 * in the panel that is open.
 *
 * @return as gz_settings_panel_draw()
 */
bool gz_settings_rows_draw(const struct gz_settings_panel *panel, const char *const prefixes[]);

/**
 * Draw it at the right of the window.
 *
 * @return whether a target of the bindings has been changed: within its row's range, a text when
 *         Enter ends it. Rows of foveation methods other than the one chosen are left out
 */
bool gz_settings_panel_draw(struct gz_settings_panel *panel);

#endif
