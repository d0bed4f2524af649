/* Preloaded into a program with a GLFW window: the one screen of the X server becomes two monitors,
 * its left half and its right one. Where a file that UNPLUG_MONITOR names appears, the right one
 * goes. Xvfb has but one monitor by itself. */
#include <dlfcn.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <GLFW/glfw3.h>

/* Of the screen that tests have. */
enum { WIDTH = 450, HEIGHT = 700, MONITORS = 2 };

struct monitor {
	const char *name;
	int x;
};

static struct monitor monitors[MONITORS] = { { "LEFT", 0 }, { "RIGHT", WIDTH } };
static int plugged = MONITORS;
static GLFWmonitorfun callback;
static GLFWmonitor *filled; /* by the window */

static struct monitor *of(GLFWmonitor *handle)
{
	return (struct monitor *)handle;
}

GLFWmonitor **glfwGetMonitors(int *count)
{
	static GLFWmonitor *handles[MONITORS];
	for (int i = 0; i < MONITORS; i++)
		handles[i] = (GLFWmonitor *)&monitors[i];
	*count = plugged;
	return handles;
}

GLFWmonitor *glfwGetPrimaryMonitor(void)
{
	return (GLFWmonitor *)&monitors[0];
}

void glfwGetMonitorPos(GLFWmonitor *handle, int *x, int *y)
{
	*x = of(handle)->x;
	*y = 0;
}

void glfwGetMonitorPhysicalSize(GLFWmonitor *handle, int *width, int *height)
{
	(void)handle;
	*width = 450;
	*height = 700;
}

const char *glfwGetMonitorName(GLFWmonitor *handle)
{
	return of(handle)->name;
}

const GLFWvidmode *glfwGetVideoMode(GLFWmonitor *handle)
{
	static const GLFWvidmode mode = { WIDTH, HEIGHT, 8, 8, 8, 60 };
	(void)handle;
	return &mode;
}

GLFWmonitorfun glfwSetMonitorCallback(GLFWmonitorfun told)
{
	GLFWmonitorfun before = callback;
	callback = told;
	return before;
}

typedef void set_window_monitor(GLFWwindow *, GLFWmonitor *, int, int, int, int, int);

void glfwSetWindowMonitor(GLFWwindow *window, GLFWmonitor *handle, int x, int y, int width,
			  int height, int refresh)
{
	set_window_monitor *next = (set_window_monitor *)dlsym(RTLD_NEXT, "glfwSetWindowMonitor");
	filled = handle;
	if (handle)
		next(window, NULL, of(handle)->x, 0, WIDTH, HEIGHT, refresh);
	else
		next(window, NULL, x, y, width, height, refresh);
}

GLFWmonitor *glfwGetWindowMonitor(GLFWwindow *window)
{
	(void)window;
	return filled;
}

void glfwWaitEventsTimeout(double timeout)
{
	void (*next)(double) = (void (*)(double))dlsym(RTLD_NEXT, "glfwWaitEventsTimeout");
	const char *path = getenv("UNPLUG_MONITOR");
	if (path && plugged == MONITORS && unlink(path) == 0) {
		plugged = 1;
		filled = NULL;
		if (callback)
			callback((GLFWmonitor *)&monitors[1], GLFW_DISCONNECTED);
	}
	next(timeout);
}
