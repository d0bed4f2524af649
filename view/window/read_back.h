/**
 * @file
 * What is drawn, read back from the framebuffer. Internal to view/.
 */
#ifndef GZ_VIEW_WINDOW_READ_BACK_H
#define GZ_VIEW_WINDOW_READ_BACK_H

#include "base/result.h"
#include "render/picture/image.h"

/**
 * Read the window's framebuffer, before it is swapped. Waits for what is being drawn.
 *
 * @param[in,out] image  resized
 * @retval GZ_ERR_INVAL, GZ_ERR_NO_MEM  as gz_image_resize()
 */
enum gz_result gz_window_read_back(int width, int height, struct gz_image *image);

#endif
