/* The window, its OpenGL context and what draws on it. */
#include <string.h>

#include <GL/glew.h>

#include <GLFW/glfw3.h>

#include "view/panels/widgets.h"
#include "view/window/context_loss.h"
#include "view/window/part.h"
#include "view/window/window_state.h"

#define GZ_LOG_MODULE "window"

static enum gz_result make_current(struct gz_gl_context *base)
{
	struct gz_window_context *context = (struct gz_window_context *)base;
	if (context->display_lost)
		return GZ_ERR_NO_DEVICE;
	if (glfwGetCurrentContext() != context->glfw)
		glfwMakeContextCurrent(context->glfw);
	return GZ_OK;
}

/* It stays current: the window draws next. */
static void release(struct gz_gl_context *base)
{
	(void)base;
}

static const struct gz_gl_context_ops context_ops = {
	.make_current = make_current,
	.release = release,
};

const char *gz_window_glfw_reason(void)
{
	const char *reason = NULL;
	glfwGetError(&reason);
	return reason ? reason : "no reason given";
}

static void create_window(struct gz_window *window, int major, int minor)
{
	glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, major);
	glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, minor);
	glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
	glfwWindowHint(GLFW_OPENGL_FORWARD_COMPAT, GLFW_TRUE);
	glfwWindowHint(GLFW_DEPTH_BITS, 0);
	glfwWindowHint(GLFW_STENCIL_BITS, 0);
	gz_context_loss_hint();
	window->glfw =
		glfwCreateWindow(window->size_px[0], window->size_px[1], "gazeview", NULL, NULL);
}

enum gz_result gz_window_context_open(struct gz_window *window)
{
	window->glfw = NULL;
	if (strcmp(window->options->backend, "cpu") != 0)
		create_window(window, 4, 3);
	if (!window->glfw)
		create_window(window, 3, 3);
	if (!window->glfw) {
		gz_err(window->log,
		       "no window with OpenGL 3.3: %s; update the graphics driver, or use "
		       "--headless",
		       gz_window_glfw_reason());
		return GZ_ERR_UNSUPPORTED;
	}
	window->context = (struct gz_window_context) {
		.base = { .ops = &context_ops },
		.glfw = window->glfw,
	};
	glfwMakeContextCurrent(window->glfw);
	glewExperimental = GL_TRUE; /* core profiles hide the old extension list */
	GLenum failure = glewInit();
	if (failure != GLEW_OK || !GLEW_VERSION_3_3) {
		gz_err(window->log,
		       "no window with OpenGL 3.3: %s; update the graphics driver, or use "
		       "--headless",
		       failure != GLEW_OK ? (const char *)glewGetErrorString(failure)
					  : "the driver has less");
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
	for (const struct gz_window_part *const *part = gz_window_parts; *part; part++)
		if (r == GZ_OK && (*part)->gl_open)
			r = (*part)->gl_open(window);
	return r;
}

void gz_window_drawing_close(struct gz_window *window)
{
	if (!window->glfw)
		return;
	for (const struct gz_window_part *const *part = gz_window_parts; *part; part++)
		if ((*part)->gl_close)
			(*part)->gl_close(window);
	gz_widgets_free();
	gz_quad_free(&window->quad);
	glfwDestroyWindow(window->glfw);
	window->glfw = NULL;
}
