/**
 * @file
 * The part of the window that moves the camera: by mouse and keys, to axis views, and to views that
 * were saved. Internal to view/.
 */
#ifndef GZ_VIEW_WINDOW_CAMERA_H
#define GZ_VIEW_WINDOW_CAMERA_H

#include "view/window/part.h"

/** The part; its state is the window's settings. */
extern const struct gz_window_part gz_window_camera;

#endif
