#include "view/window/notices.h"

#include <math.h>
#include <stdlib.h>

#include <GLFW/glfw3.h>

#include "base/clock.h"
#include "view/panels/notices.h"
#include "view/window/window_state.h"

/* How long messages are shown (chosen: two lines are read in three seconds; who warns wants to be
 * seen by somebody who looked elsewhere), and how long an error at least before a key takes it
 * away: that key was meant for something else. */
#define INFO_SHOWN_NS  (4 * GZ_NS_PER_S)
#define WARN_SHOWN_NS  (10 * GZ_NS_PER_S)
#define ERROR_LEAST_NS (GZ_NS_PER_S)

/* In the corner at once (chosen: more would hide the picture). */
enum { SHOWN_MAX = 4 };

struct gz_window_notices_state {
	uint64_t version; /* of the copy below */
	size_t count;
	struct gz_notice notices[GZ_NOTICES_MAX]; /* the newest first */
	int64_t seen_ns[GZ_NOTICES_MAX];          /* when the one of each number, modulo, was drawn
						     first since it was said last; 0: not yet */
	int64_t clicked_ns[GZ_NOTICES_MAX];       /* that one's, by its number too */
	struct gz_notice shown[SHOWN_MAX];
	size_t shown_count;
	bool list;
};

static enum gz_result open_state(struct gz_window *window)
{
	window->notices_state = calloc(1, sizeof *window->notices_state);
	return window->notices_state ? GZ_OK : GZ_ERR_NO_MEM;
}

/* Messages come from any thread, while the loop waits for events. */
static enum gz_result begin_to_wake(struct gz_window *window)
{
	gz_notices_wake_by(window->notices, glfwPostEmptyEvent);
	return GZ_OK;
}

static void end_to_wake(struct gz_window *window)
{
	gz_notices_wake_by(window->notices, NULL);
}

static size_t slot_of(const struct gz_notice *notice)
{
	return (size_t)(notice->number % GZ_NOTICES_MAX);
}

/* When it is shown no more, by the clock alone. */
static int64_t end_of(const struct gz_notice *notice)
{
	if (notice->level >= GZ_LOG_ERROR)
		return INT64_MAX;
	return notice->last_ns + (notice->level == GZ_LOG_WARN ? WARN_SHOWN_NS : INFO_SHOWN_NS);
}

/* An error goes at the first key after it was there to be read. */
static bool sent_away(const struct gz_window *window, const struct gz_notice *notice)
{
	const struct gz_window_notices_state *state = window->notices_state;
	const size_t slot = slot_of(notice);
	const int64_t seen_ns = state->seen_ns[slot];
	const bool by_key = notice->level >= GZ_LOG_ERROR && seen_ns >= notice->last_ns &&
			    window->key_ns > seen_ns + ERROR_LEAST_NS;
	return by_key || state->clicked_ns[slot] >= notice->last_ns;
}

/* What belongs into the corner now. @return whether that is something else than before */
static bool choose_shown(struct gz_window *window, int64_t now_ns)
{
	struct gz_window_notices_state *state = window->notices_state;
	bool changed = false;
	size_t count = 0;
	for (size_t i = 0; i < state->count && count < SHOWN_MAX; i++) {
		const struct gz_notice *notice = &state->notices[i];
		if (end_of(notice) <= now_ns || sent_away(window, notice))
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

static void turn(struct gz_window *window)
{
	struct gz_window_notices_state *state = window->notices_state;
	const uint64_t version = gz_notices_version(window->notices);
	if (version != state->version) {
		state->version = version;
		state->count = gz_notices_copy(window->notices, state->notices, GZ_NOTICES_MAX);
	}
	if (choose_shown(window, gz_clock_now_ns()))
		gz_window_wake_panels(window);
}

static void draw_panels(struct gz_window *window, const struct gz_window_gaze *gaze)
{
	struct gz_window_notices_state *state = window->notices_state;
	const int64_t now_ns = gz_clock_now_ns();
	(void)gaze;
	for (size_t i = 0; i < state->shown_count; i++) {
		int64_t *seen_ns = &state->seen_ns[slot_of(&state->shown[i])];
		if (*seen_ns < state->shown[i].last_ns)
			*seen_ns = now_ns;
	}
	const size_t clicked = gz_notices_panel_draw(state->shown, state->shown_count);
	if (clicked < state->shown_count)
		state->clicked_ns[slot_of(&state->shown[clicked])] = now_ns;
	if (state->list)
		gz_notices_list_draw(state->notices, state->count, now_ns, &state->list);
}

static double patience_s(const struct gz_window *window)
{
	const struct gz_window_notices_state *state = window->notices_state;
	int64_t next_ns = INT64_MAX;
	for (size_t i = 0; i < state->shown_count; i++) {
		const int64_t end_ns = end_of(&state->shown[i]);
		next_ns = end_ns < next_ns ? end_ns : next_ns;
	}
	return next_ns == INT64_MAX ? INFINITY : gz_ns_to_s(next_ns - gz_clock_now_ns());
}

static void toggle_list(struct gz_window *window, int number)
{
	(void)number;
	window->notices_state->list = !window->notices_state->list;
	gz_window_wake_panels(window);
}

static void close_state(struct gz_window *window)
{
	free(window->notices_state);
	window->notices_state = NULL;
}

static bool is_open(const struct gz_window *window)
{
	return window->notices_state && window->notices_state->list;
}

static const struct gz_window_action actions[] = {
	{ .key = GLFW_KEY_ESCAPE, .applies = is_open, .run = toggle_list },
	{ .letter = 'n', .keys = "N", .help = "all messages so far", .run = toggle_list },
};

const struct gz_window_part gz_window_notices = {
	.name = "notices",
	.title = "window",
	.actions = actions,
	.action_count = sizeof actions / sizeof actions[0],
	.open = open_state,
	.gl_open = begin_to_wake,
	.turn = turn,
	.panels = draw_panels,
	.patience_s = patience_s,
	.gl_close = end_to_wake,
	.close = close_state,
};
