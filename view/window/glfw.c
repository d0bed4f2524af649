#include "view/window/glfw.h"

#include <stdlib.h>
#include <unistd.h>

#include <X11/Xlib.h>

#include <GL/glew.h>

#include <GLFW/glfw3.h>

#include "base/log.h"
#include "protocol/display.h"

/* Longest wait for a reset, and interval of asking, s. */
#define RESET_S    2.0
#define INTERVAL_S 0.05

/* Of GLFW/glfw3native.h, which needs the header of Xrandr for other functions. Weak, as a GLFW that
 * is made for Wayland has none. */
__attribute__((weak)) Display *glfwGetX11Display(void);

const char *gz_glfw_reason(void)
{
	const char *reason = NULL;
	glfwGetError(&reason);
	return reason ? reason : "no reason given";
}

void gz_glfw_hint_context(int major, int minor)
{
	glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, major);
	glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, minor);
	glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
	glfwWindowHint(GLFW_OPENGL_FORWARD_COMPAT, GLFW_TRUE);
	glfwWindowHint(GLFW_DEPTH_BITS, 0);
	glfwWindowHint(GLFW_STENCIL_BITS, 0);
	glfwWindowHint(GLFW_CONTEXT_ROBUSTNESS, GLFW_LOSE_CONTEXT_ON_RESET);
}

const char *gz_glfw_load_opengl(GLFWwindow *glfw)
{
	glfwMakeContextCurrent(glfw);
	glewExperimental = GL_TRUE; /* core profiles hide the old extension list */
	const GLenum failure = glewInit();
	if (failure != GLEW_OK)
		return (const char *)glewGetErrorString(failure);
	return GLEW_VERSION_3_3 ? NULL : "the driver has an older version";
}

GLFWmonitor *gz_glfw_monitor_of(GLFWwindow *glfw)
{
	int x, y, width, height, count;
	glfwGetWindowPos(glfw, &x, &y);
	glfwGetWindowSize(glfw, &width, &height);
	GLFWmonitor **monitors = glfwGetMonitors(&count);
	for (int i = 0; i < count; i++) {
		int left, top;
		const GLFWvidmode *mode = glfwGetVideoMode(monitors[i]);
		glfwGetMonitorPos(monitors[i], &left, &top);
		const int middle_x = x + width / 2 - left, middle_y = y + height / 2 - top;
		if (mode && middle_x >= 0 && middle_x < mode->width && middle_y >= 0 &&
		    middle_y < mode->height)
			return monitors[i];
	}
	return glfwGetPrimaryMonitor();
}

double gz_glfw_monitor_scale(GLFWmonitor *monitor)
{
	float across = 0, down = 0;
	glfwGetMonitorContentScale(monitor, &across, &down);
	return across > 0 && (double)across <= GZ_MONITOR_SCALE_MAX ? (double)across : 0;
}

bool gz_glfw_context_lost(void)
{
	if (!GLEW_ARB_robustness || !glGetGraphicsResetStatusARB)
		return false;
	/* Drivers may report the status once only; the error stays for ever. */
	return glGetGraphicsResetStatusARB() != GL_NO_ERROR || glGetError() == GL_CONTEXT_LOST;
}

void gz_glfw_await_reset(void)
{
	const double end = glfwGetTime() + RESET_S;
	if (!GLEW_ARB_robustness || !glGetGraphicsResetStatusARB)
		return;
	while (glGetGraphicsResetStatusARB() != GL_NO_ERROR && glfwGetTime() < end)
		glfwWaitEventsTimeout(INTERVAL_S);
}

/* Xlib's own handler would print a message. */
static int ignore_io_error(Display *display)
{
	(void)display;
	return 0;
}

/* Returning would lead back into GLFW, whose loops wait for events of the lost display. */
static void end_process(Display *display, void *user)
{
	const struct gz_display_loss *loss = user;
	(void)display;
	if (!pthread_equal(loss->thread, pthread_self())) {
		gz_log_to_stderr(NULL, GZ_LOG_ERROR, "window",
				 "the display is gone: its X server has ended");
		_exit(EXIT_FAILURE);
	}
	loss->lost(loss->user);
	exit(EXIT_FAILURE);
}

void gz_glfw_watch_display(struct gz_display_loss *loss)
{
	Display *display = glfwGetX11Display ? glfwGetX11Display() : NULL;
	glfwGetError(NULL); /* under Wayland the call fails */
	if (!display)
		return;
	loss->thread = pthread_self();
	XSetIOErrorHandler(ignore_io_error);
	XSetIOErrorExitHandler(display, end_process, loss);
}
