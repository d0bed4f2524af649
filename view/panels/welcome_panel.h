/**
 * @file
 * What a window without a scene says. Inside a frame of panels/widgets.h.
 */
#ifndef GZ_VIEW_WELCOME_PANEL_H
#define GZ_VIEW_WELCOME_PANEL_H

/** Draw it in the middle. */
void gz_welcome_panel_draw(void);

#endif
