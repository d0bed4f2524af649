#include "view/window/trail.h"

#include <math.h>
#include <stdlib.h>

#include "base/clock.h"
#include "view/gaze/gaze_trail.h"
#include "view/panels/widgets.h"
#include "view/window/window_state.h"

/* Drawn anew no more often than this for its fading alone (chosen: smooth enough for a mark). */
#define FADE_INTERVAL_NS (GZ_NS_PER_S / 30)

/* Unscaled lengths, chosen: seen beside the cross. A fixation of a second has a disc of the first
 * and this radius more, its area growing as it lasts. */
#define LINE_THICKNESS 2.0f
#define DISC_RADIUS    3.0f
#define DISC_GROWTH    12.0f

struct gz_window_trail {
	struct gz_gaze_trail trail;
	bool changed; /* since it was drawn */
	int64_t drawn_ns;
};

static void toggle(struct gz_window *window, int number)
{
	(void)number;
	window->settings.view.trail = !window->settings.view.trail;
	window->trail->trail.count = 0;
	window->present_needed = true;
}

static bool follows(struct gz_window *window, const struct gz_window_gaze *gaze)
{
	struct gz_window_trail *trail = window->trail;
	const int64_t now_ns = gz_clock_now_ns();
	if (!window->settings.view.trail) {
		trail->trail.count = 0;
		return false;
	}
	const float apart = 0.5f / (float)(gaze->display.px[0] > 0 ? gaze->display.px[0] : 1);
	if (gz_gaze_trail_step(&trail->trail, &gaze->reading, apart, now_ns))
		trail->changed = true;
	return trail->changed && now_ns - trail->drawn_ns >= FADE_INTERVAL_NS;
}

static struct gz_place place_of(struct gz_point point, struct gz_place room)
{
	return (struct gz_place) { point.x * room.x, point.y * room.y };
}

static struct gz_paint paint_of(float strength, float opacity)
{
	return (struct gz_paint) { 90, 220, 255, (uint8_t)lroundf(255 * strength * opacity) };
}

static void draw_stay(const struct gz_gaze_stay *stay, struct gz_place at, float strength)
{
	const float lasted = fminf(1, (float)gz_ns_to_s(stay->to_ns - stay->from_ns));
	const float radius = DISC_RADIUS + DISC_GROWTH * sqrtf(lasted);
	gz_draw_disc(GZ_LAYER_PICTURE, at, radius, paint_of(strength, 0.35f));
	gz_draw_circle(GZ_LAYER_PICTURE, at, radius, paint_of(strength, 0.9f), 1);
}

static void draw(struct gz_window *window, const struct gz_window_gaze *gaze)
{
	const struct gz_gaze_trail *trail = &window->trail->trail;
	const struct gz_place room = gz_widgets_room();
	const int64_t now_ns = gz_clock_now_ns();
	(void)gaze;
	if (!window->settings.view.trail)
		return;
	window->trail->drawn_ns = now_ns;
	window->trail->changed = false;
	for (int i = 0; i < trail->count; i++) {
		const struct gz_gaze_stay *stay = &trail->stays[i];
		const float strength = gz_gaze_trail_strength(stay, now_ns);
		const struct gz_place at = place_of(stay->point, room);
		if (i > 0)
			gz_draw_line(GZ_LAYER_PICTURE, place_of(stay[-1].point, room), at,
				     paint_of(gz_gaze_trail_strength(&stay[-1], now_ns), 0.8f),
				     LINE_THICKNESS);
		if (stay->fixation)
			draw_stay(stay, at, strength);
	}
}

static const struct gz_window_action actions[] = {
	{ .letter = 't', .keys = "T", .help = "trail of the gaze", .run = toggle },
};

/* What fades is drawn although nothing moves. */
static double patience_s(const struct gz_window *window)
{
	return window->settings.view.trail &&
			       (window->trail->trail.count > 1 || window->trail->changed)
		       ? gz_ns_to_s(FADE_INTERVAL_NS)
		       : INFINITY;
}

static enum gz_result open_part(struct gz_window *window)
{
	window->trail = calloc(1, sizeof *window->trail);
	return window->trail ? GZ_OK : GZ_ERR_NO_MEM;
}

static void close_part(struct gz_window *window)
{
	free(window->trail);
	window->trail = NULL;
}

const struct gz_window_part gz_window_trail_part = {
	.name = "trail",
	.title = "gaze",
	.actions = actions,
	.action_count = sizeof actions / sizeof actions[0],
	.open = open_part,
	.follows = follows,
	.panels = draw,
	.patience_s = patience_s,
	.close = close_part,
};
