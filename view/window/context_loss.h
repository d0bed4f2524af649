/**
 * @file
 * A window's OpenGL context that the graphics driver loses, as it does when the device hangs and is
 * reset: whoever asks for it is told, and makes another. Needs the context current but for the
 * hints.
 */
#ifndef GZ_VIEW_WINDOW_CONTEXT_LOSS_H
#define GZ_VIEW_WINDOW_CONTEXT_LOSS_H

#include <stdbool.h>

/** Ask GLFW, before a window is made, for a context that is lost when the device is reset and says
 *  so (GLX_ARB_create_context_robustness and its likes). Drivers without it leave it out. */
void gz_context_loss_hint(void);

/** Whether the current context is lost. False where the driver does not tell. */
bool gz_context_is_lost(void);

/** Wait, 2 s at most (chosen: a device that needs longer is not coming back), until the device has
 *  been reset and a new context may be made. */
void gz_context_await_reset(void);

#endif
