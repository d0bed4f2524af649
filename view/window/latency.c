#include "view/window/latency.h"

#include <math.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include <GL/glew.h>

#include <GLFW/glfw3.h>

#include "base/clock.h"
#include "view/window/displays.h"
#include "view/window/window_state.h"

#define GZ_LOG_MODULE "window"

/* Frames handed over that the device has not finished: more than any driver queues (chosen). */
enum { PENDING_MAX = 8 };

/* How often a fence is looked at (chosen: as exact as what is shown). */
#define FENCE_PATIENCE_S 0.001

/* One frame. Times are in ms. */
struct frame_times {
	bool age_known;
	double age_ms, frame_ms, present_ms;
};

struct pending_frame {
	GLsync fence;
	int64_t swap_ns;
	bool counts; /* its picture is new */
	struct frame_times times;
};

struct gz_window_timing {
	int64_t gaze_ns; /* when the gaze of this turn was taken */
	bool age_known;
	double age_ms;
	struct pending_frame pending[PENDING_MAX];
	int pending_count;
	struct frame_times kept[GZ_LATENCY_FRAMES];
	int kept_count, next;
	bool vsync, vsync_known; /* as the driver was told */
};

static int compare(const void *a, const void *b)
{
	const double x = *(const double *)a, y = *(const double *)b;
	return (x > y) - (x < y);
}

/* Of the doubles at @p offset in each of the frames kept. */
static double median_of(const struct gz_window_timing *timing, size_t offset)
{
	double values[GZ_LATENCY_FRAMES] = { 0 };
	const int count = timing->kept_count;
	for (int i = 0; i < count; i++)
		memcpy(&values[i], (const char *)&timing->kept[i] + offset, sizeof values[i]);
	qsort(values, (size_t)count, sizeof values[0], compare);
	return (values[(count - 1) / 2] + values[count / 2]) / 2;
}

bool gz_window_latency(const struct gz_window *window, struct gz_latency *out_latency)
{
	const struct gz_window_timing *timing = window->timing;
	const struct gz_monitor *monitor = gz_window_own_monitor(window);
	if (!timing || timing->kept_count == 0)
		return false;
	const int last = (timing->next + GZ_LATENCY_FRAMES - 1) % GZ_LATENCY_FRAMES;
	struct gz_latency latency = {
		.frames = timing->kept_count,
		.age_known = timing->kept[last].age_known,
		.age_ms = median_of(timing, offsetof(struct frame_times, age_ms)),
		.frame_ms = median_of(timing, offsetof(struct frame_times, frame_ms)),
		.present_ms = median_of(timing, offsetof(struct frame_times, present_ms)),
	};
	if (monitor && monitor->refresh_hz > 0)
		latency.scanout_ms = 0.5 * 1000 / monitor->refresh_hz;
	latency.total_ms =
		latency.age_ms + latency.frame_ms + latency.present_ms + latency.scanout_ms;
	*out_latency = latency;
	return true;
}

static void keep(struct gz_window_timing *timing, const struct frame_times *times)
{
	const int last = (timing->next + GZ_LATENCY_FRAMES - 1) % GZ_LATENCY_FRAMES;
	/* Of another source. */
	if (timing->kept_count > 0 && timing->kept[last].age_known != times->age_known)
		timing->kept_count = timing->next = 0;
	timing->kept[timing->next] = *times;
	timing->next = (timing->next + 1) % GZ_LATENCY_FRAMES;
	timing->kept_count += timing->kept_count < GZ_LATENCY_FRAMES;
}

/* The oldest is done with. */
static void drop_first(struct gz_window_timing *timing)
{
	glDeleteSync(timing->pending[0].fence);
	timing->pending_count--;
	memmove(timing->pending, timing->pending + 1,
		(size_t)timing->pending_count * sizeof timing->pending[0]);
}

/* Fences are passed in their order. */
static void look_at_fences(struct gz_window_timing *timing)
{
	while (timing->pending_count > 0) {
		struct pending_frame *first = &timing->pending[0];
		const GLenum state = glClientWaitSync(first->fence, GL_SYNC_FLUSH_COMMANDS_BIT, 0);
		if (state == GL_TIMEOUT_EXPIRED)
			return;
		first->times.present_ms = gz_ns_to_ms(gz_clock_now_ns() - first->swap_ns);
		if (first->counts && state != GL_WAIT_FAILED)
			keep(timing, &first->times);
		drop_first(timing);
	}
}

static void follow_vsync(struct gz_window *window)
{
	struct gz_window_timing *timing = window->timing;
	const bool wanted = window->maker ? window->settings.view.vsync : window->options->vsync;
	if (timing->vsync_known && timing->vsync == wanted)
		return;
	glfwSwapInterval(wanted ? 1 : 0);
	timing->vsync = wanted;
	timing->vsync_known = true;
	timing->kept_count = timing->next = 0;
}

static void turn(struct gz_window *window)
{
	follow_vsync(window);
	look_at_fences(window->timing);
}

static void take_gaze(struct gz_window *window, struct gz_window_gaze *gaze)
{
	struct gz_window_timing *timing = window->timing;
	timing->gaze_ns = gz_clock_now_ns();
	timing->age_known = gaze->reading.known && gaze->reading.has_age;
	timing->age_ms = timing->age_known ? gz_ns_to_ms(gaze->reading.age_ns) : 0;
}

static void presented(struct gz_window *window)
{
	struct gz_window_timing *timing = window->timing;
	if (timing->pending_count == PENDING_MAX)
		drop_first(timing);
	struct pending_frame frame = {
		.fence = glFenceSync(GL_SYNC_GPU_COMMANDS_COMPLETE, 0),
		.swap_ns = window->swap_ns,
		.counts = window->frame_new,
		.times = {
			.age_known = timing->age_known,
			.age_ms = timing->age_ms,
			.frame_ms = gz_ns_to_ms(window->swap_ns - timing->gaze_ns),
		},
	};
	if (frame.fence)
		timing->pending[timing->pending_count++] = frame;
	look_at_fences(timing);
}

static double patience_s(const struct gz_window *window)
{
	return window->timing->pending_count > 0 ? FENCE_PATIENCE_S : INFINITY;
}

static void toggle_vsync(struct gz_window *window, int number)
{
	(void)number;
	window->settings.view.vsync = !window->settings.view.vsync;
	gz_info(window->log, "the display's refresh is %s",
		window->settings.view.vsync ? "waited for" : "not waited for");
	gz_window_wake_panels(window);
}

static const struct gz_window_action actions[] = {
	{ .letter = 's',
	  .keys = "S",
	  .help = "wait for the display's refresh, or not",
	  .run = toggle_vsync },
};

static enum gz_result open_part(struct gz_window *window)
{
	window->timing = calloc(1, sizeof *window->timing);
	return window->timing ? GZ_OK : GZ_ERR_NO_MEM;
}

static void gl_close(struct gz_window *window)
{
	struct gz_window_timing *timing = window->timing;
	while (timing && timing->pending_count > 0)
		drop_first(timing);
	if (timing)
		timing->vsync_known = false;
}

static void close_part(struct gz_window *window)
{
	free(window->timing);
	window->timing = NULL;
}

const struct gz_window_part gz_window_latency_part = {
	.name = "latency",
	.title = "window",
	.actions = actions,
	.action_count = sizeof actions / sizeof actions[0],
	.open = open_part,
	.turn = turn,
	.gaze = take_gaze,
	.presented = presented,
	.patience_s = patience_s,
	.gl_close = gl_close,
	.close = close_part,
};
