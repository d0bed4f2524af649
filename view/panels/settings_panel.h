/**
 * @file
 * The settings panel: a widget for each row of the option tables, under a heading for each
 * section. Inside a frame of panels/widgets.h.
 */
#ifndef GZ_VIEW_PANELS_SETTINGS_PANEL_H
#define GZ_VIEW_PANELS_SETTINGS_PANEL_H

#include <stdbool.h>
#include <stddef.h>

#include "base/option.h"

/** What the panel shows and changes. */
struct gz_settings_panel {
	const struct gz_option_binding *bindings;
	size_t count;
	/** Whether the option with @p key has an effect at present; others are grey. NULL: all. */
	bool (*applies)(const void *user, const char *key);
	const void *user;
	/** The same tables bound to the values that a reset returns to; NULL: there is no reset. */
	const struct gz_option_binding *given;
	float margin_top;   /**< kept free above it, screen coordinates */
	bool open;          /**< false once its cross was clicked */
	const char *marked; /**< key of a row that is marked; NULL: none */
	bool reveal;        /**< unfold its section and scroll to it */
};

/**
 * Draw the rows whose keys begin with one of @p prefixes, without headings, into the panel that is
 * open.
 *
 * @param prefixes  NULL-terminated
 * @return what gz_settings_panel_draw() returns
 */
bool gz_settings_rows_draw(const struct gz_settings_panel *panel, const char *const prefixes[]);

/**
 * Draw the panel at the right of the window. Rows of foveation methods other than the chosen one
 * are left out.
 *
 * @return whether a target of the bindings was changed. Numbers keep to the range of their row; a
 *         text changes when Enter is pressed
 */
bool gz_settings_panel_draw(struct gz_settings_panel *panel);

#endif
