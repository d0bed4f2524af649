/* The window and its OpenGL context: opened, filled, read, and replaced after a loss. */
#include <math.h>
#include <string.h>

#include <GL/glew.h>

#include <GLFW/glfw3.h>

#include "base/clock.h"
#include "view/panels/widgets.h"
#include "view/window/displays.h"
#include "view/window/glfw.h"
#include "view/window/window_state.h"

#define GZ_LOG_MODULE "window"

/* Pixels of the window along an edge of one of a small picture of it, at most (chosen: enough for a
 * mean). */
#define SHRINK_SAMPLES 2

static enum gz_result make_window_current(struct gz_gl_context *base)
{
	struct gz_window_context *context = (struct gz_window_context *)base;
	if (context->display_lost)
		return GZ_ERR_NO_DEVICE;
	if (glfwGetCurrentContext() != context->glfw)
		glfwMakeContextCurrent(context->glfw);
	return GZ_OK;
}

/* The window draws next. */
static void keep_window_current(struct gz_gl_context *base)
{
	(void)base;
}

static const struct gz_gl_context_ops context_ops = {
	.make_current = make_window_current,
	.release = keep_window_current,
};

static void create_glfw_window(struct gz_window *window, int major, int minor)
{
	gz_glfw_hint_context(major, minor);
	window->glfw =
		glfwCreateWindow(window->size_px[0], window->size_px[1], "gazeview", NULL, NULL);
}

enum gz_result gz_window_context_open(struct gz_window *window)
{
	window->glfw = NULL;
	if (strcmp(window->options->backend, "cpu") != 0)
		create_glfw_window(window, 4, 3);
	if (!window->glfw)
		create_glfw_window(window, 3, 3);
	const char *missing = window->glfw ? NULL : gz_glfw_reason();
	if (window->glfw) {
		window->context = (struct gz_window_context) {
			.base = { .ops = &context_ops },
			.glfw = window->glfw,
		};
		missing = gz_glfw_load_opengl(window->glfw);
	}
	if (missing) {
		gz_err(window->log,
		       "no window with OpenGL 3.3: %s; update the graphics driver, or use "
		       "--headless",
		       missing);
		return GZ_ERR_UNSUPPORTED;
	}
	glfwSwapInterval(window->options->vsync ? 1 : 0);
	return GZ_OK;
}

enum gz_result gz_window_drawing_open(struct gz_window *window)
{
	enum gz_result r = gz_quad_init(&window->quad, window->log);
	if (r != GZ_OK)
		return r;
	gz_window_input_attach(window);
	if (!gz_widgets_init(window->glfw, window->options->interface_scale)) {
		gz_err(window->log,
		       "Dear ImGui cannot use this OpenGL; update the graphics driver, or use "
		       "--headless");
		return GZ_ERR_UNSUPPORTED;
	}
	GZ_FOR_EACH_PART (part)
		if (r == GZ_OK && (*part)->gl_open)
			r = (*part)->gl_open(window);
	return r;
}

void gz_window_drawing_close(struct gz_window *window)
{
	if (!window->glfw)
		return;
	GZ_FOR_EACH_PART (part)
		if ((*part)->gl_close)
			(*part)->gl_close(window);
	gz_widgets_free();
	gz_quad_free(&window->quad);
	glfwDestroyWindow(window->glfw);
	window->glfw = NULL;
}

void gz_window_fill_monitor(struct gz_window *window, GLFWmonitor *monitor)
{
	int *place = window->windowed_place;
	const bool fills = glfwGetWindowMonitor(window->glfw) != NULL;
	const GLFWvidmode *mode = monitor ? glfwGetVideoMode(monitor) : NULL;
	if (!monitor && fills)
		glfwSetWindowMonitor(window->glfw, NULL, place[0], place[1], place[2], place[3],
				     GLFW_DONT_CARE);
	if (!mode)
		return;
	if (!fills) {
		glfwGetWindowPos(window->glfw, &place[0], &place[1]);
		glfwGetWindowSize(window->glfw, &place[2], &place[3]);
	}
	glfwSetWindowMonitor(window->glfw, monitor, 0, 0, mode->width, mode->height,
			     mode->refreshRate);
}

void gz_window_toggle_fullscreen(struct gz_window *window)
{
	const bool fills = glfwGetWindowMonitor(window->glfw) != NULL;
	gz_window_fill_monitor(window, fills ? NULL : gz_glfw_monitor_of(window->glfw));
}

/* ---- reading back ---- */

static void swap_rows(uint8_t *a, uint8_t *b, size_t size)
{
	uint8_t row[1024];
	for (size_t at = 0; at < size; at += sizeof row) {
		const size_t part = size - at < sizeof row ? size - at : sizeof row;
		memcpy(row, a + at, part);
		memcpy(a + at, b + at, part);
		memcpy(b + at, row, part);
	}
}

/* OpenGL's first row is the lowest; the opacity of a framebuffer is arbitrary. */
static void put_upright(struct gz_image *image)
{
	const size_t row = (size_t)image->width * 4;
	for (int y = 0; y < image->height / 2; y++)
		swap_rows(image->pixels + (size_t)y * row,
			  image->pixels + (size_t)(image->height - 1 - y) * row, row);
	for (size_t i = 3; i < row * (size_t)image->height; i += 4)
		image->pixels[i] = 255;
}

enum gz_result gz_window_read_back(int width, int height, struct gz_image *image)
{
	const enum gz_result r = gz_image_resize(image, width, height);
	if (r != GZ_OK)
		return r;
	glBindBuffer(GL_PIXEL_PACK_BUFFER, 0);
	glPixelStorei(GL_PACK_ALIGNMENT, 4);
	glReadPixels(0, 0, width, height, GL_RGBA, GL_UNSIGNED_BYTE, image->pixels);
	put_upright(image);
	return GZ_OK;
}

enum gz_result gz_window_shrink_shown(struct gz_window *window, int width, int height,
				      struct gz_image *image)
{
	struct gz_image shown = { 0 };
	int size_px[2];
	gz_window_framebuffer(window, &size_px[0], &size_px[1]);
	if (size_px[0] < 1 || size_px[1] < 1)
		return GZ_ERR_INVAL;
	const double scale = fmin((double)width / size_px[0], (double)height / size_px[1]);
	/* Reading back takes time for each pixel. */
	const double drawn = fmin(1, SHRINK_SAMPLES * scale);
	const int drawn_px[2] = { (int)fmax(1, size_px[0] * drawn),
				  (int)fmax(1, size_px[1] * drawn) };
	gz_quad_draw(&window->quad, drawn_px[0], drawn_px[1]);
	enum gz_result r = gz_window_read_back(drawn_px[0], drawn_px[1], &shown);
	if (r == GZ_OK)
		r = gz_image_resize(image, (int)fmax(1, size_px[0] * scale),
				    (int)fmax(1, size_px[1] * scale));
	if (r == GZ_OK)
		gz_image_resample(&shown, image);
	gz_image_free(&shown);
	return r;
}

/* ---- loss of the context ---- */

/* Losses within this time are in quick succession: the driver cannot do what it is asked for.
 * Chosen: longer than a hang and its reset, which take some seconds. */
#define SOON_S 30

/* Losses in quick succession after which the program gives up. */
enum { LOSSES_TO_END = 3 };

/* The next window gets the size of this one, or the size to which full screen returns. @return
 * whether it is in full screen */
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

static void restore_place(struct gz_window *window, bool fullscreen)
{
	glfwSetWindowPos(window->glfw, window->windowed_place[0], window->windowed_place[1]);
	if (fullscreen)
		gz_window_toggle_fullscreen(window);
}

static void count_context_loss(struct gz_window *window)
{
	const int64_t now_ns = gz_clock_now_ns();
	const bool soon = window->losses > 0 && now_ns - window->lost_ns < SOON_S * GZ_NS_PER_S;
	window->losses = soon ? window->losses + 1 : 1;
	window->lost_ns = now_ns;
}

/* Window, drawing and renderer. */
static enum gz_result open_again(struct gz_window *window)
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
	count_context_loss(window);
	if (window->losses == LOSSES_TO_END) {
		gz_err(window->log,
		       "the graphics driver has lost the window's context %d times in quick "
		       "succession; update it, or use --headless",
		       window->losses);
		return GZ_ERR_NO_DEVICE;
	}
	gz_warn(window->log, "the graphics driver has lost the window's context%s",
		window->losses < GZ_WINDOW_LOSSES_TO_CPU
			? ": the window is opened again"
			: " again: it is opened again, and the cpu backend "
			  "casts the rays from now on");
	const bool fullscreen = remember_place(window);
	gz_glfw_await_reset();
	if (window->maker)
		gz_frame_maker_stop(window->maker);
	gz_window_drawing_close(window);
	const enum gz_result r = open_again(window);
	if (r != GZ_OK)
		return r;
	restore_place(window, fullscreen);
	window->grabber = NULL;
	window->cast_needed = true;
	gz_window_wake_panels(window);
	return GZ_OK;
}
