#include "view/window/latency.h"

#include <math.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include <GL/glew.h>

#include <GLFW/glfw3.h>

#include "base/clock.h"
#include "base/order.h"
#include "view/window/displays.h"
#include "view/window/window_state.h"

#define GZ_LOG_MODULE "window"

/* Most frames that are swapped and not finished (chosen: more than any driver queues). */
enum { PENDING_MAX = 8 };

/* Interval of polling a fence (chosen: as exact as what is shown). */
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

struct gz_window_latency {
	int64_t gaze_ns; /* when the gaze of this turn was taken */
	bool age_known;
	double age_ms;
	struct pending_frame pending[PENDING_MAX];
	int pending_count;
	struct frame_times kept[GZ_LATENCY_FRAMES];
	int kept_count, next;
	bool vsync, vsync_known; /* as set last */
};

double gz_latency_median_ms(double *values_ms, int count)
{
	qsort(values_ms, (size_t)count, sizeof values_ms[0], gz_compare_doubles);
	return (values_ms[(count - 1) / 2] + values_ms[count / 2]) / 2;
}

/* Median of the doubles at @p offset in the frames kept. */
static double median_of_field(const struct gz_window_latency *timing, size_t offset)
{
	double values[GZ_LATENCY_FRAMES] = { 0 };
	for (int i = 0; i < timing->kept_count; i++)
		memcpy(&values[i], (const char *)&timing->kept[i] + offset, sizeof values[i]);
	return gz_latency_median_ms(values, timing->kept_count);
}

bool gz_window_latency(const struct gz_window *window, struct gz_latency *out_latency)
{
	const struct gz_window_latency *timing = window->latency;
	const struct gz_monitor *monitor = gz_window_own_monitor(window);
	if (timing->kept_count == 0)
		return false;
	const int last = (timing->next + GZ_LATENCY_FRAMES - 1) % GZ_LATENCY_FRAMES;
	struct gz_latency latency = {
		.frames = timing->kept_count,
		.age_known = timing->kept[last].age_known,
		.age_ms = median_of_field(timing, offsetof(struct frame_times, age_ms)),
		.frame_ms = median_of_field(timing, offsetof(struct frame_times, frame_ms)),
		.present_ms = median_of_field(timing, offsetof(struct frame_times, present_ms)),
	};
	if (monitor && monitor->refresh_hz > 0)
		latency.scanout_ms = 0.5 * 1000 / monitor->refresh_hz;
	latency.total_ms =
		latency.age_ms + latency.frame_ms + latency.present_ms + latency.scanout_ms;
	*out_latency = latency;
	return true;
}

static void keep_frame_times(struct gz_window_latency *timing, const struct frame_times *times)
{
	const int last = (timing->next + GZ_LATENCY_FRAMES - 1) % GZ_LATENCY_FRAMES;
	/* The frames before are of another source. */
	if (timing->kept_count > 0 && timing->kept[last].age_known != times->age_known)
		timing->kept_count = timing->next = 0;
	timing->kept[timing->next] = *times;
	timing->next = (timing->next + 1) % GZ_LATENCY_FRAMES;
	timing->kept_count += timing->kept_count < GZ_LATENCY_FRAMES;
}

/* Forget the oldest frame. */
static void drop_first_fence(struct gz_window_latency *timing)
{
	glDeleteSync(timing->pending[0].fence);
	timing->pending_count--;
	memmove(timing->pending, timing->pending + 1,
		(size_t)timing->pending_count * sizeof timing->pending[0]);
}

/* The device passes fences in their order. */
static void look_at_fences(struct gz_window_latency *timing)
{
	while (timing->pending_count > 0) {
		struct pending_frame *first = &timing->pending[0];
		const GLenum state = glClientWaitSync(first->fence, GL_SYNC_FLUSH_COMMANDS_BIT, 0);
		if (state == GL_TIMEOUT_EXPIRED)
			return;
		first->times.present_ms = gz_ns_to_ms(gz_clock_now_ns() - first->swap_ns);
		if (first->counts && state != GL_WAIT_FAILED)
			keep_frame_times(timing, &first->times);
		drop_first_fence(timing);
	}
}

static void follow_vsync(struct gz_window *window)
{
	struct gz_window_latency *timing = window->latency;
	const bool wanted = window->maker ? window->settings.view.vsync : window->options->vsync;
	if (timing->vsync_known && timing->vsync == wanted)
		return;
	glfwSwapInterval(wanted ? 1 : 0);
	timing->vsync = wanted;
	timing->vsync_known = true;
	timing->kept_count = timing->next = 0;
}

static void turn_latency(struct gz_window *window)
{
	follow_vsync(window);
	look_at_fences(window->latency);
}

static void note_gaze_age(struct gz_window *window, struct gz_window_gaze *gaze)
{
	struct gz_window_latency *timing = window->latency;
	timing->gaze_ns = gz_clock_now_ns();
	timing->age_known = gaze->reading.known && gaze->reading.has_age;
	timing->age_ms = timing->age_known ? gz_ns_to_ms(gaze->reading.age_ns) : 0;
}

static void fence_frame(struct gz_window *window)
{
	struct gz_window_latency *timing = window->latency;
	if (timing->pending_count == PENDING_MAX)
		drop_first_fence(timing);
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

static double fence_patience_s(const struct gz_window *window)
{
	return window->latency->pending_count > 0 ? FENCE_PATIENCE_S : INFINITY;
}

static void toggle_vsync(struct gz_window *window, int number)
{
	(void)number;
	window->settings.view.vsync = !window->settings.view.vsync;
	gz_info(window->log, "V-sync %s", window->settings.view.vsync ? "on" : "off");
	gz_window_wake_panels(window);
}

static bool is_vsync_on(const struct gz_window *window, int number)
{
	(void)number;
	return window->settings.view.vsync;
}

static const struct gz_window_action latency_actions[] = {
	{ .letter = 's',
	  .keys = "S",
	  .help = "V-sync on or off",
	  .name = "V-sync",
	  .menu = GZ_MENU_VIEW,
	  .section = 3,
	  .words = "refresh tearing",
	  .is_on = is_vsync_on,
	  .run = toggle_vsync },
};

static void drop_all_fences(struct gz_window *window)
{
	struct gz_window_latency *timing = window->latency;
	while (timing->pending_count > 0)
		drop_first_fence(timing);
	timing->vsync_known = false;
}

const struct gz_window_part gz_window_latency_part = {
	.name = "latency",
	.title = "window",
	GZ_PART_ACTIONS(latency_actions),
	GZ_PART_STATE(latency),
	.turn = turn_latency,
	.gaze = note_gaze_age,
	.presented = fence_frame,
	.patience_s = fence_patience_s,
	.gl_close = drop_all_fences,
};
