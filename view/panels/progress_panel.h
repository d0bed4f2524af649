/**
 * @file
 * The panel that tells how far long work is, with a way to stop it. Inside a frame of
 * panels/widgets.h.
 */
#ifndef GZ_VIEW_PROGRESS_PANEL_H
#define GZ_VIEW_PROGRESS_PANEL_H

#include <stdbool.h>

/** Draw it in the middle. @param title what is done @param what to which file or thing @param share
 *  0 to 1; below 0: nobody knows @param spent_s since it began @return whether it is to be
 *  cancelled */
bool gz_progress_panel_draw(const char *title, const char *what, double share, double spent_s);

/** "40 %, 3 s left"; the time is told once there is a share to tell it by. */
void gz_progress_text(double share, double spent_s, char *text, unsigned long size);

#endif
