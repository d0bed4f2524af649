/**
 * @file
 * What the part that writes pictures and videos offers the others. Internal to view/; main thread
 * only.
 */
#ifndef GZ_VIEW_WINDOW_CAPTURE_H
#define GZ_VIEW_WINDOW_CAPTURE_H

#include <stdbool.h>

#include "render/picture/image.h"
#include "render/scene/scene.h"

struct gz_window;

/** Write a picture of the scene shown into the folder for pictures, on a thread, with the scene in
 *  it. What goes wrong is logged. @param[in,out] image  its pixels are taken @param settings  of
 * the picture; copied */
void gz_window_write_picture(struct gz_window *window, struct gz_image *image,
			     const struct gz_scene_settings *settings);

/** Write what the window shows without panels, with the next frame drawn. */
void gz_window_write_shown(struct gz_window *window);

/** Whether what is painted next is read from the framebuffer before panels are drawn: nothing of it
 *  may be left out. */
bool gz_window_reads_picture(const struct gz_window *window);

#endif
