/**
 * @file
 * The part of the window that shows what foveation does to someone who has only a mouse. Internal
 * to view/; main thread only.
 */
#ifndef GZ_VIEW_WINDOW_EFFECT_H
#define GZ_VIEW_WINDOW_EFFECT_H

struct gz_window;

/** Show a coarse foveated picture beside one with a ray for each pixel, and let the gaze follow the
 *  mouse. Without a scene a shipped one is opened first. */
void gz_window_show_effect(struct gz_window *window);

#endif
