/**
 * @file
 * What an experiment shows that is no picture: texts, the cross, a bar while pictures are loaded.
 * Inside a frame of panels/widgets.h.
 */
#ifndef GZ_VIEW_EXPERIMENT_SCREEN_H
#define GZ_VIEW_EXPERIMENT_SCREEN_H

#include "view/panels/widgets.h"

/** How it looks. */
struct gz_experiment_look {
	double ground[3]; /**< red, green, blue behind it, 0 to 1: the texts stand out from it */
	double text_size; /**< of a line, share of the window's height */
};

/** Draw lines in the middle of the window, each centred, wrapped where they are wider than four
 *  fifths of it. */
void gz_experiment_screen_text(const struct gz_experiment_look *look, const char *text);

/** Draw a small line at the window's lower edge. */
void gz_experiment_screen_note(const struct gz_experiment_look *look, const char *text);

/** Draw a cross in the middle, @p across screen coordinates wide. */
void gz_experiment_screen_cross(const struct gz_experiment_look *look, float across);

/** Draw a bar near the lower edge, @p share of it full, 0 to 1. */
void gz_experiment_screen_bar(const struct gz_experiment_look *look, double share);

#endif
