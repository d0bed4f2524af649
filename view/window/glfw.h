/**
 * @file
 * What every window of gazeview needs of GLFW and X11: hints, OpenGL's functions, the monitor of a
 * window, and the loss of a context or of the display. Internal to view/.
 */
#ifndef GZ_VIEW_WINDOW_GLFW_H
#define GZ_VIEW_WINDOW_GLFW_H

#include <pthread.h>
#include <stdbool.h>

struct GLFWmonitor;
struct GLFWwindow;

/** The reason of GLFW's last failure, for a message. Valid until the next call of GLFW. */
const char *gz_glfw_reason(void);

/** Ask for a core context of OpenGL @p major.@p minor for the next window, without depth and
 * stencil buffer. The context is lost when the graphics device is reset
 *  (GLX_ARB_create_context_robustness and the like), where the driver can tell of that. */
void gz_glfw_hint_context(int major, int minor);

/** Make the context of @p glfw current and load OpenGL's functions. @return NULL; else why there is
 * no OpenGL 3.3 */
const char *gz_glfw_load_opengl(struct GLFWwindow *glfw);

/** The monitor that holds the middle of the window, else the primary one; NULL: there is none. */
struct GLFWmonitor *gz_glfw_monitor_of(struct GLFWwindow *glfw);

/** The scale of the desktop on a monitor, to GZ_MONITOR_SCALE_MAX; 0: unknown. */
double gz_glfw_monitor_scale(struct GLFWmonitor *monitor);

/** Whether the driver has lost the current context, as it does when the device hangs and is reset.
 *  False if the driver does not tell. */
bool gz_glfw_context_lost(void);

/** Wait until the device of the lost context, which is current, has been reset and a new context
 * can be made; at most 2 s (chosen: a device that needs longer does not come back). */
void gz_glfw_await_reset(void);

/** What to do when the display is lost. The caller keeps it until GLFW is terminated. */
struct gz_display_loss {
	void (*lost)(void *user); /**< must not use GLFW, OpenGL or Xlib */
	void *user;
	pthread_t thread; /**< set by gz_glfw_watch_display() */
};

/**
 * Call loss->lost when the X server ends or goes out of reach, and then end the process with
 * EXIT_FAILURE. Xlib allows nothing else inside GLFW, which would wait for events for ever.
 *
 * Call after glfwInit(), on the thread that uses GLFW. If another thread meets the loss, the
 * process ends without the call, with a line on stderr. Does nothing without X11.
 */
void gz_glfw_watch_display(struct gz_display_loss *loss);

#endif
