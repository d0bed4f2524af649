/* What the window itself costs a frame, without casting. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include <GL/glew.h>

#include <GLFW/glfw3.h>

#include "base/clock.h"
#include "render/picture/image.h"
#include "view/window/gaze.h"
#include "view/window/latency.h"
#include "view/window/window_state.h"

#define GZ_LOG_MODULE "window"

enum measured_way { BARE, CLOSED, OPEN, WAYS };

struct measurement {
	struct gz_window *window;
	struct gz_image image;
	int width, height;
	double *ms[WAYS];
	struct gz_window_gaze gaze;
};

/* Each frame differs, so that the driver cannot skip an upload. */
static void change_image(struct gz_image *image, int number)
{
	const size_t size = 4 * (size_t)image->width * (size_t)image->height;
	for (size_t i = 0; i < size; i++)
		image->pixels[i] = (uint8_t)(i * 7 + (size_t)number * 13);
}

static void show_bare(struct measurement *self)
{
	gz_quad_draw(&self->window->quad, self->width, self->height);
	glfwSwapBuffers(self->window->glfw);
}

static void show_window(struct measurement *self, bool panels)
{
	struct gz_window *window = self->window;
	window->settings.view.frame_times = panels;
	window->settings_open = panels;
	window->frame_new = true;
	gz_window_present(window, &self->gaze, self->width, self->height);
}

static double show_once(struct measurement *self, enum measured_way way)
{
	glFinish();
	const int64_t start_ns = gz_clock_now_ns();
	gz_quad_upload(&self->window->quad, &self->image);
	if (way == BARE)
		show_bare(self);
	else
		show_window(self, way == OPEN);
	glFinish();
	return gz_ns_to_ms(gz_clock_now_ns() - start_ns);
}

static enum gz_result begin_measurement(struct measurement *self, int count)
{
	glfwGetFramebufferSize(self->window->glfw, &self->width, &self->height);
	if (self->width < 1 || self->height < 1)
		return GZ_ERR_NO_DEVICE;
	gz_window_gaze_now(self->window, self->width, self->height, &self->gaze);
	enum gz_result r = gz_image_resize(&self->image, self->width, self->height);
	for (int way = 0; way < WAYS && r == GZ_OK; way++) {
		self->ms[way] = calloc((size_t)count, sizeof *self->ms[way]);
		r = self->ms[way] ? GZ_OK : GZ_ERR_NO_MEM;
	}
	return r;
}

static void end_measurement(struct measurement *self)
{
	for (int way = 0; way < WAYS; way++)
		free(self->ms[way]);
	gz_image_free(&self->image);
}

/* The first frames are not counted: they make textures, fonts and the panels' places. */
static void show_all_ways(struct measurement *self, int count)
{
	enum { FIRST = 10 };
	glfwSwapInterval(0);
	for (int i = -FIRST; i < count; i++)
		for (int way = 0; way < WAYS; way++) {
			change_image(&self->image, WAYS * (i + FIRST) + way);
			const double ms = show_once(self, (enum measured_way)way);
			if (i >= 0)
				self->ms[way][i] = ms;
			glfwPollEvents();
		}
}

static void print_measurement(struct measurement *self, int count)
{
	const double bare = gz_latency_median_ms(self->ms[BARE], count);
	const double closed = gz_latency_median_ms(self->ms[CLOSED], count);
	const double open = gz_latency_median_ms(self->ms[OPEN], count);
	printf("%dx%d bare %.2f ms window %.2f ms %.2f times with panels %.2f ms %.2f times "
	       "frames %d\n",
	       self->width, self->height, bare, closed, closed / bare, open, open / bare, count);
}

enum gz_result gz_window_measure(struct gz_window *window)
{
	const int count = window->options->measure_window;
	struct measurement self = { .window = window };
	const enum gz_result r = begin_measurement(&self, count);
	if (r == GZ_OK) {
		show_all_ways(&self, count);
		print_measurement(&self, count);
	} else if (r == GZ_ERR_NO_MEM) {
		gz_err(window->log, "no memory for --measure-window; ask for fewer frames");
	}
	end_measurement(&self);
	return r;
}
