#include "view/target/target_window.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>

#include <GL/glew.h>

#include <GLFW/glfw3.h>

#include "base/clock.h"
#include "render/opengl/gl_program.h"
#include "view/options/target_options.h"
#include "view/panels/marks.h"
#include "view/window/glfw.h"

#define GZ_LOG_MODULE "targets"

/* Scale at which a target appears, and the time it takes to shrink to 1. Chosen: it has shrunk
 * before samples are evaluated. */
#define FIRST_SCALE 3.0
#define SHRINK_S    0.6

/* Smallest radius of the dot, px. Chosen: still visible. */
#define DOT_MIN_PX 1.5

/* Time of a frame with V-sync off, s (chosen). */
#define FRAME_S (1.0 / 120)

/* The longest wait while nothing changes, s. Chosen: a lost context is noticed soon enough. */
#define REST_S 0.1

/* Generated from shaders/ by the build. */
extern const char gz_glsl_quad_vert[];
extern const char gz_glsl_target_frag[];

/* All that a frame shows. */
struct target_frame {
	int width, height; /* of the framebuffer, px */
	bool started;      /* without instructions */
	bool there;        /* with a target */
	struct gz_point at;
	double deg; /* px in a degree of the target at its present scale */
};

struct target_window {
	const struct gz_view_options *options;
	const struct gz_log *log;
	GLFWwindow *glfw;
	struct gz_display_loss loss;
	bool has_widgets;
	GLuint program, vertices;
	struct gz_targets targets;
	size_t index;              /* of the current or next target */
	bool started;              /* the instructions were confirmed */
	int64_t shown_ns;          /* time the target appeared; 0: not yet */
	struct target_frame frame; /* the last one drawn */
	bool damaged;              /* it has to be drawn again */
	bool space;                /* Space or a button was pressed since the last frame */
	bool cancelled;
};

static const char *instructions_of(const struct gz_target_options *options)
{
	if (options->advance == GZ_TARGET_ADVANCE_SPACE)
		return "Look at the centre of each target.\n"
		       "Press Space, or click, while you look at it to go to the next.\n"
		       "Keep your head still.\n\n"
		       "Press Space or click to start, Escape to leave.";
	return "Look at the centre of each target until the next one appears.\n"
	       "Keep your head still. The best time to blink\n"
	       "is when a target has just appeared.\n\n"
	       "Press Space or click to start, Escape to leave.";
}

static void on_target_key(GLFWwindow *glfw, int key, int scancode, int action, int mods)
{
	(void)scancode;
	(void)mods;
	struct target_window *window = glfwGetWindowUserPointer(glfw);
	if (action != GLFW_PRESS)
		return;
	if (key == GLFW_KEY_ESCAPE)
		window->cancelled = true;
	if (key == GLFW_KEY_SPACE)
		window->space = true;
}

static void on_target_button(GLFWwindow *glfw, int button, int action, int mods)
{
	(void)button;
	(void)mods;
	struct target_window *window = glfwGetWindowUserPointer(glfw);
	if (action == GLFW_PRESS)
		window->space = true;
}

static void on_target_damage(GLFWwindow *glfw)
{
	struct target_window *window = glfwGetWindowUserPointer(glfw);
	window->damaged = true;
}

/* The monitor with the tracker's display size in px, otherwise the primary one. */
static GLFWmonitor *find_monitor(const struct target_window *window)
{
	int count;
	const int *px = window->options->display_px;
	GLFWmonitor **monitors = glfwGetMonitors(&count);
	for (int i = 0; i < count && px[0] > 0; i++) {
		const GLFWvidmode *mode = glfwGetVideoMode(monitors[i]);
		if (mode && mode->width == px[0] && mode->height == px[1])
			return monitors[i];
	}
	if (px[0] > 0 && !window->options->target.windowed)
		gz_warn(window->log,
			"no monitor has the %dx%d px of the tracker's display: the targets are "
			"shown on the primary one; correct display.px in gazed.conf",
			px[0], px[1]);
	return glfwGetPrimaryMonitor();
}

static enum gz_result create_target_window(struct target_window *window)
{
	int width = window->options->size_px[0], height = window->options->size_px[1];
	GLFWmonitor *monitor = find_monitor(window);
	const GLFWvidmode *mode = monitor ? glfwGetVideoMode(monitor) : NULL;
	bool whole = mode && !window->options->target.windowed;
	if (whole) {
		width = mode->width;
		height = mode->height;
		glfwWindowHint(GLFW_REFRESH_RATE, mode->refreshRate);
	}
	gz_glfw_hint_context(3, 3);
	glfwWindowHint(GLFW_AUTO_ICONIFY, GLFW_FALSE); /* keep showing targets without the focus */
	window->glfw =
		glfwCreateWindow(width, height, "gazeview targets", whole ? monitor : NULL, NULL);
	return window->glfw ? GZ_OK : GZ_ERR_UNSUPPORTED;
}

static enum gz_result open_target_drawing(struct target_window *window)
{
	const struct gz_gl_shader shaders[2] = {
		{ .stage = GZ_GL_VERTEX, .name = "quad.vert", .parts = { gz_glsl_quad_vert } },
		{ .stage = GZ_GL_FRAGMENT,
		  .name = "target.frag",
		  .parts = { gz_glsl_target_frag } },
	};
	window->program = gz_gl_program(shaders, 2, "use --headless", window->log);
	if (!window->program)
		return GZ_ERR_UNSUPPORTED;
	glGenVertexArrays(1, &window->vertices);
	glfwSetWindowUserPointer(window->glfw, window);
	glfwSetKeyCallback(window->glfw, on_target_key);
	glfwSetMouseButtonCallback(window->glfw, on_target_button);
	glfwSetWindowRefreshCallback(window->glfw, on_target_damage);
	glfwSetInputMode(window->glfw, GLFW_CURSOR, GLFW_CURSOR_HIDDEN);
	window->has_widgets = gz_widgets_init(window->glfw, window->options->interface_scale);
	return window->has_widgets ? GZ_OK : GZ_ERR_UNSUPPORTED;
}

static enum gz_result open_window(struct target_window *window)
{
	if (!glfwInit()) {
		gz_err(window->log,
		       "no window: %s; set DISPLAY to the X server of the tracker's display",
		       gz_glfw_reason());
		return GZ_ERR_NO_DEVICE;
	}
	gz_glfw_watch_display(&window->loss);
	enum gz_result r = create_target_window(window);
	const char *missing = r == GZ_OK ? gz_glfw_load_opengl(window->glfw) : gz_glfw_reason();
	if (missing) {
		gz_err(window->log, "no window with OpenGL 3.3: %s; update the graphics driver",
		       missing);
		return GZ_ERR_UNSUPPORTED;
	}
	glfwSwapInterval(window->options->vsync ? 1 : 0);
	r = open_target_drawing(window);
	if (r != GZ_OK)
		gz_err(window->log, "the targets cannot be drawn; update the graphics driver");
	return r;
}

/* The window's content as a part of its monitor: corner and size, as fractions of its sides. */
struct share {
	double corner[2], size[2];
};

static struct share share_of_monitor(GLFWwindow *glfw, const GLFWvidmode *mode)
{
	int x, y, left, top, width, height;
	GLFWmonitor *monitor = gz_glfw_monitor_of(glfw);
	glfwGetWindowSize(glfw, &width, &height);
	if (!mode || !monitor || glfwGetWindowMonitor(glfw) || mode->width < 1 || mode->height < 1)
		return (struct share) { { 0, 0 }, { 1, 1 } };
	glfwGetWindowPos(glfw, &x, &y);
	glfwGetMonitorPos(monitor, &left, &top);
	return (struct share) {
		.corner = { (double)(x - left) / mode->width, (double)(y - top) / mode->height },
		.size = { (double)width / mode->width, (double)height / mode->height },
	};
}

static const GLFWvidmode *mode_of(GLFWwindow *glfw)
{
	GLFWmonitor *monitor = gz_glfw_monitor_of(glfw);
	return monitor ? glfwGetVideoMode(monitor) : NULL;
}

/* Framebuffer pixels per degree at the centre of the display. */
static double target_px_per_deg(const struct target_window *window, int width, int height)
{
	struct share share = share_of_monitor(window->glfw, mode_of(window->glfw));
	struct gz_display display = gz_view_display(window->options, NULL, width, height);
	display.px[0] = width;
	display.px[1] = height;
	if (window->options->display_mm[0] > 0)
		display.mm[0] *= share.size[0];
	return gz_display_px_per_deg(&display);
}

static double target_scale(const struct target_window *window, int64_t now_ns)
{
	double left = window->shown_ns ? 1 - gz_ns_to_s(now_ns - window->shown_ns) / SHRINK_S : 1;
	return 1 + (FIRST_SCALE - 1) * fmax(0, left);
}

static void set_number(const struct target_window *window, const char *name, double value)
{
	glUniform1f(glGetUniformLocation(window->program, name), (float)value);
}

static struct target_frame present_frame(const struct target_window *window)
{
	struct target_frame frame = { .started = window->started, .at = { 0.5f, 0.5f } };
	glfwGetFramebufferSize(window->glfw, &frame.width, &frame.height);
	frame.there = window->started && window->index < window->targets.count;
	if (frame.there)
		frame.at = window->targets.target[window->index].point;
	frame.deg = target_px_per_deg(window, frame.width, frame.height) *
		    target_scale(window, gz_clock_now_ns());
	return frame;
}

static bool frames_equal(const struct target_frame *a, const struct target_frame *b)
{
	return a->width == b->width && a->height == b->height && a->started == b->started &&
	       a->there == b->there && a->at.x == b->at.x && a->at.y == b->at.y && a->deg == b->deg;
}

/* Draw the background and the current target, if any. */
static void draw_target_frame(const struct target_window *window, const struct target_frame *frame)
{
	const float width = (float)frame->width, height = (float)frame->height;
	const double dot = fmax(DOT_MIN_PX, frame->deg * GZ_TARGET_DOT_DEG / 2);
	const double disc = fmax(3 * dot, frame->deg * GZ_TARGET_DISC_DEG / 2);
	glViewport(0, 0, frame->width, frame->height);
	glDisable(GL_BLEND);
	glUseProgram(window->program);
	glUniform2f(glGetUniformLocation(window->program, "size"), width, height);
	glUniform2f(glGetUniformLocation(window->program, "centre"), frame->at.x * width,
		    frame->at.y * height);
	set_number(window, "radius", frame->there ? disc : 0);
	set_number(window, "dot_radius", dot);
	set_number(window, "arm", dot);
	glBindVertexArray(window->vertices);
	glDrawArrays(GL_TRIANGLES, 0, 3);
	if (frame->started)
		return;
	gz_widgets_begin();
	gz_marks_draw_message(instructions_of(&window->options->target));
	gz_widgets_end();
	gz_widgets_draw();
}

static void tell_shown(const struct target_window *window)
{
	struct share share = share_of_monitor(window->glfw, mode_of(window->glfw));
	struct gz_point at = window->targets.target[window->index].point;
	printf("shown %zu %zu %.9g %.9g %" PRId64 "\n", window->index, window->targets.count,
	       share.corner[0] + at.x * share.size[0], share.corner[1] + at.y * share.size[1],
	       window->shown_ns);
	fflush(stdout);
}

static void tell_time(const char *what)
{
	printf("%s %" PRId64 "\n", what, gz_clock_now_ns());
	fflush(stdout);
}

/* Show what there is now, unless it is on the screen and no instructions are. @return whether it
 * has changed */
static bool show_frame(struct target_window *window)
{
	const struct target_frame frame = present_frame(window);
	const bool appears = frame.there && !window->shown_ns;
	const bool changes = appears || !frames_equal(&frame, &window->frame);
	if (!changes && !window->damaged && window->started)
		return false;
	draw_target_frame(window, &frame);
	window->frame = frame;
	window->damaged = false;
	glfwSwapBuffers(window->glfw);
	if (!appears)
		return changes;
	glFinish();
	window->shown_ns = gz_clock_now_ns();
	tell_shown(window);
	return true;
}

/* Whether the next target is due. */
static bool target_is_over(const struct target_window *window)
{
	const struct gz_target_options *options = &window->options->target;
	if (!window->shown_ns)
		return false;
	bool time = gz_ns_to_s(gz_clock_now_ns() - window->shown_ns) >= options->duration_s;
	return time && (options->advance == GZ_TARGET_ADVANCE_AUTO || window->space);
}

/* How long the screen may stay as it is if no event comes, s. */
static double rest_s(const struct target_window *window)
{
	if (!window->shown_ns)
		return REST_S;
	const double since_s = gz_ns_to_s(gz_clock_now_ns() - window->shown_ns);
	const double left_s = window->options->target.duration_s - since_s;
	return left_s > 0 ? fmin(left_s, REST_S) : REST_S;
}

/* Go to the next target if it is due. Space counts only while the window waits for it. */
static void advance_targets(struct target_window *window)
{
	if (!window->started) {
		window->started = window->space || !window->options->target.instructions;
	} else if (target_is_over(window)) {
		printf("hidden %zu %" PRId64 "\n", window->index, gz_clock_now_ns());
		fflush(stdout);
		window->index++;
		window->shown_ns = 0;
	}
	window->space = false;
}

static void tell_screen(const struct target_window *window)
{
	const GLFWvidmode *mode = mode_of(window->glfw);
	GLFWmonitor *monitor = gz_glfw_monitor_of(window->glfw);
	int left = 0, top = 0;
	if (monitor)
		glfwGetMonitorPos(monitor, &left, &top);
	printf("screen %d %d %d %d %.6g\n", mode ? mode->width : 0, mode ? mode->height : 0, left,
	       top, monitor ? gz_glfw_monitor_scale(monitor) : 0);
	fflush(stdout);
}

static enum gz_result show_targets(struct target_window *window)
{
	tell_screen(window);
	while (window->index < window->targets.count) {
		const bool changes = show_frame(window);
		glfwWaitEventsTimeout(changes ? FRAME_S : rest_s(window));
		if (gz_glfw_context_lost()) {
			gz_err(window->log, "the graphics driver lost the window's context: no "
					    "more targets are shown; start again");
			tell_time("cancelled");
			return GZ_ERR_NO_DEVICE;
		}
		if (window->cancelled || glfwWindowShouldClose(window->glfw)) {
			tell_time("cancelled");
			return GZ_ERR_END;
		}
		advance_targets(window);
	}
	show_frame(window);
	tell_time("finished");
	return GZ_OK;
}

static void close_target_window(struct target_window *window)
{
	if (window->glfw) {
		if (window->has_widgets)
			gz_widgets_free();
		if (window->program)
			glDeleteProgram(window->program);
		if (window->vertices)
			glDeleteVertexArrays(1, &window->vertices);
		glfwDestroyWindow(window->glfw);
	}
	glfwTerminate();
}

/* GLFW and OpenGL must not be used any more. */
static void tell_display_lost(void *user)
{
	const struct target_window *window = user;
	gz_err(window->log, "the display is gone: its X server has ended or is out of reach; no "
			    "more targets are shown");
	tell_time("cancelled");
}

enum gz_result gz_view_targets(const struct gz_view_options *options, const struct gz_log *log)
{
	struct target_window window = { .options = options, .log = log };
	window.loss = (struct gz_display_loss) { .lost = tell_display_lost, .user = &window };
	enum gz_result r = gz_target_places(&options->target, log, &window.targets);
	if (r != GZ_OK)
		return r;
	r = open_window(&window);
	if (r == GZ_OK)
		r = show_targets(&window);
	close_target_window(&window);
	return r;
}
