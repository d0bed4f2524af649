/**
 * @file
 * The panel of settings: a widget for each row of the option tables, under a heading for each
 * section. Internal to view/; inside a frame of Dear ImGui.
 */
#ifndef GZ_VIEW_PANEL_SETTINGS_H
#define GZ_VIEW_PANEL_SETTINGS_H

#include "view/panel.h"

/**
 * Draw it at the right of the window.
 *
 * @param top      where it begins, in the window's screen coordinates
 * @param content  the targets of its settings are changed, each value within its row's range; a
 *                 text when Enter ends it. Rows of foveation methods other than the one chosen are
 *                 left out
 * @return whether anything has been changed
 */
bool gz_panel_draw_settings(float top, const struct gz_panel_content &content);

#endif
