/**
 * @file
 * Small pictures for panels, as textures. Every call needs a current OpenGL 3.3 context.
 */
#ifndef GZ_VIEW_DRAW_ICON_H
#define GZ_VIEW_DRAW_ICON_H

#include <stdint.h>

/** Make a texture of a grey picture of @p edge times @p edge pixels, the topmost row first, which
 * is smoothed when it is scaled. @return its name of OpenGL; 0: no memory */
unsigned gz_icon_make(const uint8_t *grey, int edge);

/** Make a texture of RGBA pixels, the topmost row first. @return as gz_icon_make() */
unsigned gz_icon_make_colour(const uint8_t *rgba, int width, int height);

/** Delete it and set it to 0. Accepts a pointer to 0. */
void gz_icon_free(unsigned *icon);

#endif
