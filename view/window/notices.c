/* The part that shows messages: the latest in a corner, and all of them in a list. */
#include <math.h>

#include <GLFW/glfw3.h>

#include "base/clock.h"
#include "view/panels/notices.h"
#include "view/window/window_state.h"

/* How long messages are shown (chosen: two lines are read in three seconds; a warning should be
 * seen by someone who looked elsewhere). An error is shown this long at least before a key removes
 * it. */
#define INFO_SHOWN_NS  (4 * GZ_NS_PER_S)
#define WARN_SHOWN_NS  (10 * GZ_NS_PER_S)
#define ERROR_LEAST_NS (GZ_NS_PER_S)

/* Most messages in the corner (chosen: more would hide the picture). */
enum { SHOWN_MAX = 4 };

struct gz_window_notices {
	uint64_t version; /* of notices below */
	size_t count;
	struct gz_notice notices[GZ_NOTICES_MAX]; /* the newest first */
	/* By number, modulo: when a notice was first drawn since it was said last, 0: not yet; and
	 * when it was clicked. */
	int64_t seen_ns[GZ_NOTICES_MAX];
	int64_t clicked_ns[GZ_NOTICES_MAX];
	struct gz_notice shown[SHOWN_MAX];
	size_t shown_count;
	bool list;
};

/* Messages come from any thread while the loop waits for events. */
static enum gz_result wake_loop_by_notices(struct gz_window *window)
{
	gz_notices_wake_by(window->notices, glfwPostEmptyEvent);
	return GZ_OK;
}

static void stop_waking_loop(struct gz_window *window)
{
	gz_notices_wake_by(window->notices, NULL);
}

static size_t slot_of_notice(const struct gz_notice *notice)
{
	return (size_t)(notice->number % GZ_NOTICES_MAX);
}

/* Time after which a notice is not shown any more. */
static int64_t end_of_notice(const struct gz_notice *notice)
{
	if (notice->level >= GZ_LOG_ERROR)
		return INT64_MAX;
	return notice->last_ns + (notice->level == GZ_LOG_WARN ? WARN_SHOWN_NS : INFO_SHOWN_NS);
}

/* Whether a notice was clicked, or is an error that was there to be read before the last key. */
static bool is_dismissed(const struct gz_window *window, const struct gz_notice *notice)
{
	const struct gz_window_notices *state = window->notices_state;
	const size_t slot = slot_of_notice(notice);
	const int64_t seen_ns = state->seen_ns[slot];
	const bool by_key = notice->level >= GZ_LOG_ERROR && seen_ns >= notice->last_ns &&
			    window->key_ns > seen_ns + ERROR_LEAST_NS;
	return by_key || state->clicked_ns[slot] >= notice->last_ns;
}

/* Choose what the corner shows. @return whether it changes */
static bool choose_shown_notices(struct gz_window *window, int64_t now_ns)
{
	struct gz_window_notices *state = window->notices_state;
	bool changed = false;
	size_t count = 0;
	for (size_t i = 0; i < state->count && count < SHOWN_MAX; i++) {
		const struct gz_notice *notice = &state->notices[i];
		if (end_of_notice(notice) <= now_ns || is_dismissed(window, notice))
			continue;
		changed = changed || count >= state->shown_count ||
			  state->shown[count].number != notice->number ||
			  state->shown[count].count != notice->count;
		state->shown[count++] = *notice;
	}
	changed = changed || count != state->shown_count;
	state->shown_count = count;
	return changed;
}

static void turn_notices(struct gz_window *window)
{
	struct gz_window_notices *state = window->notices_state;
	const uint64_t version = gz_notices_version(window->notices);
	if (version != state->version) {
		state->version = version;
		state->count = gz_notices_copy(window->notices, state->notices, GZ_NOTICES_MAX);
	}
	if (choose_shown_notices(window, gz_clock_now_ns()))
		gz_window_wake_panels(window);
}

static void draw_notices(struct gz_window *window, const struct gz_window_gaze *gaze)
{
	struct gz_window_notices *state = window->notices_state;
	const int64_t now_ns = gz_clock_now_ns();
	(void)gaze;
	for (size_t i = 0; i < state->shown_count; i++) {
		int64_t *seen_ns = &state->seen_ns[slot_of_notice(&state->shown[i])];
		if (*seen_ns < state->shown[i].last_ns)
			*seen_ns = now_ns;
	}
	const size_t clicked = gz_notices_panel_draw(state->shown, state->shown_count);
	if (clicked < state->shown_count)
		state->clicked_ns[slot_of_notice(&state->shown[clicked])] = now_ns;
	if (state->list)
		gz_notices_list_draw(state->notices, state->count, now_ns, &state->list);
}

static double notices_patience_s(const struct gz_window *window)
{
	const struct gz_window_notices *state = window->notices_state;
	int64_t next_ns = INT64_MAX;
	for (size_t i = 0; i < state->shown_count; i++) {
		const int64_t end_ns = end_of_notice(&state->shown[i]);
		next_ns = end_ns < next_ns ? end_ns : next_ns;
	}
	return next_ns == INT64_MAX ? INFINITY : gz_ns_to_s(next_ns - gz_clock_now_ns());
}

static void toggle_notice_list(struct gz_window *window, int number)
{
	(void)number;
	window->notices_state->list = !window->notices_state->list;
	gz_window_wake_panels(window);
}

static bool is_list_open(const struct gz_window *window)
{
	return window->notices_state->list;
}

static bool is_list_on(const struct gz_window *window, int number)
{
	(void)number;
	return window->notices_state->list;
}

static const struct gz_window_action notices_actions[] = {
	{ .key = GLFW_KEY_ESCAPE, .applies = is_list_open, .run = toggle_notice_list },
	{ .letter = 'n',
	  .keys = "N",
	  .help = "all messages so far",
	  .name = "Messages",
	  .menu = GZ_MENU_HELP,
	  .words = "errors warnings log",
	  .is_on = is_list_on,
	  .run = toggle_notice_list },
};

const struct gz_window_part gz_window_notices_part = {
	.name = "notices",
	.title = "window",
	GZ_PART_ACTIONS(notices_actions),
	GZ_PART_STATE(notices_state),
	.gl_open = wake_loop_by_notices,
	.turn = turn_notices,
	.panels = draw_notices,
	.patience_s = notices_patience_s,
	.gl_close = stop_waking_loop,
};
