/* The window after its OpenGL context was lost: made anew where it was. */
#include <GLFW/glfw3.h>

#include "base/clock.h"
#include "view/window/context_loss.h"
#include "view/window/window_state.h"

#define GZ_LOG_MODULE "window"

/* A context lost so soon after the one before: the driver does not bear what it is asked for.
 * Chosen: longer than a hang and its reset take, some seconds. */
#define SOON_S 30

/* Losses so soon after each other after which not even a window can be had. */
enum { LOSSES_TO_END = 3 };

/* The next window is made as large as this one, or as that to which full screen returns. @return
 * whether it fills the screen */
static bool remember_place(struct gz_window *window)
{
	int *place = window->windowed_place;
	const bool fullscreen = glfwGetWindowMonitor(window->glfw) != NULL;
	if (!fullscreen) {
		glfwGetWindowPos(window->glfw, &place[0], &place[1]);
		glfwGetWindowSize(window->glfw, &place[2], &place[3]);
	}
	window->size_px[0] = place[2];
	window->size_px[1] = place[3];
	return fullscreen;
}

static void bring_back(struct gz_window *window, bool fullscreen)
{
	glfwSetWindowPos(window->glfw, window->windowed_place[0], window->windowed_place[1]);
	if (fullscreen)
		gz_window_toggle_fullscreen(window);
}

static void count_loss(struct gz_window *window)
{
	const int64_t now_ns = gz_clock_now_ns();
	const bool soon = window->losses > 0 && now_ns - window->lost_ns < SOON_S * GZ_NS_PER_S;
	window->losses = soon ? window->losses + 1 : 1;
	window->lost_ns = now_ns;
}

/* Window, drawing and renderer. */
static enum gz_result open_anew(struct gz_window *window)
{
	enum gz_result started = GZ_ERR_UNSUPPORTED;
	enum gz_result r = gz_window_context_open(window);
	if (r == GZ_OK && !window->maker)
		return gz_window_drawing_open(window);
	if (r == GZ_OK && window->losses < GZ_WINDOW_LOSSES_TO_CPU)
		started =
			gz_frame_maker_start(window->maker, window->options, &window->context.base);
	if (r == GZ_OK && started != GZ_OK)
		r = gz_frame_maker_start_cpu(window->maker, window->options);
	return r == GZ_OK ? gz_window_drawing_open(window) : r;
}

enum gz_result gz_window_rebuild(struct gz_window *window)
{
	count_loss(window);
	if (window->losses == LOSSES_TO_END) {
		gz_err(window->log,
		       "the graphics driver has lost the window's context %d times in short "
		       "order; update it, or use --headless",
		       window->losses);
		return GZ_ERR_NO_DEVICE;
	}
	gz_warn(window->log, "the graphics driver has lost the window's context%s",
		window->losses < GZ_WINDOW_LOSSES_TO_CPU
			? ": the window is made anew"
			: " again: it is made anew, and the cpu backend "
			  "casts the rays from now on");
	const bool fullscreen = remember_place(window);
	gz_context_await_reset();
	if (window->maker)
		gz_frame_maker_stop(window->maker);
	gz_window_drawing_close(window);
	const enum gz_result r = open_anew(window);
	if (r != GZ_OK)
		return r;
	bring_back(window, fullscreen);
	window->grabber = NULL;
	window->cast_needed = true;
	gz_window_wake_panels(window);
	return GZ_OK;
}
