/**
 * @file
 * What an experiment shows besides pictures: texts, the fixation cross, a bar while scenes load.
 * Inside a frame of panels/widgets.h.
 */
#ifndef GZ_VIEW_PANELS_EXPERIMENT_SCREEN_H
#define GZ_VIEW_PANELS_EXPERIMENT_SCREEN_H

#include "view/panels/widgets.h"

/** How the screen looks. */
struct gz_experiment_look {
	double ground[3]; /**< red, green, blue of the background, 0 to 1 */
	double text_size; /**< height of a line, share of the window's */
};

/** Draw lines in the middle of the window, each centred, wrapped to four fifths of its width. */
void gz_experiment_screen_text(const struct gz_experiment_look *look, const char *text);

/** Draw a small line at the window's lower edge. */
void gz_experiment_screen_note(const struct gz_experiment_look *look, const char *text);

/** Draw a cross in the middle, @p across wide, in screen coordinates. */
void gz_experiment_screen_cross(const struct gz_experiment_look *look, float across);

/** Draw a bar near the lower edge, filled up to @p share, 0 to 1. */
void gz_experiment_screen_bar(const struct gz_experiment_look *look, double share);

#endif
