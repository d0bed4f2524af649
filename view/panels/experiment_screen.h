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

/** Draw lines in the middle of the window, each centred, wrapped to four fifths of its width.
 *  Long texts move up to leave room for buttons. */
void gz_experiment_screen_text(const struct gz_experiment_look *look, const char *text);

/** A button. */
struct gz_experiment_button {
	const char *name, *key;           /**< what it does, and the key that does the same */
	struct gz_place corner, opposite; /**< out: its area */
};

/** Draw buttons side by side below the texts, and set their areas. Underscores in names are shown
 *  as blanks. @param mouse  the button below it is brighter; NULL: none */
void gz_experiment_screen_buttons(const struct gz_experiment_look *look,
				  struct gz_experiment_button *buttons, size_t count,
				  const struct gz_place *mouse);

/** The button at a place, or -1. */
int gz_experiment_button_at(const struct gz_experiment_button *buttons, size_t count,
			    struct gz_place place);

/** Draw a small line at the window's lower edge. */
void gz_experiment_screen_note(const struct gz_experiment_look *look, const char *text);

/** Draw a cross in the middle, @p across wide, in screen coordinates. */
void gz_experiment_screen_cross(const struct gz_experiment_look *look, float across);

/** Draw a bar near the lower edge, filled up to @p share, 0 to 1. */
void gz_experiment_screen_bar(const struct gz_experiment_look *look, double share);

#endif
