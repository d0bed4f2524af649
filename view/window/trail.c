/* The part that shows the last second of the gaze: a line that fades, and fixations as discs that
 * grow as they last. */
#include <math.h>

#include "base/clock.h"
#include "view/gaze/gaze_trail.h"
#include "view/panels/widgets.h"
#include "view/window/sections.h"
#include "view/window/window_state.h"

/* Least time between frames for fading alone (chosen: smooth enough). */
#define FADE_INTERVAL_NS (GZ_NS_PER_S / 30)

/* Unscaled lengths (chosen: visible beside the cross). The disc's area grows with the fixation, up
 * to DISC_RADIUS + DISC_GROWTH after a second. */
#define LINE_THICKNESS 2.0f
#define DISC_RADIUS    3.0f
#define DISC_GROWTH    12.0f

struct gz_window_trail {
	struct gz_gaze_trail trail;
	bool changed; /* since it was drawn */
	int64_t drawn_ns;
};

static void toggle_trail(struct gz_window *window, int number)
{
	(void)number;
	window->settings.view.trail = !window->settings.view.trail;
	window->trail->trail.count = 0;
	window->present_needed = true;
}

static bool trail_follows(struct gz_window *window, const struct gz_window_gaze *gaze)
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

static struct gz_paint trail_paint(float strength, float opacity)
{
	return (struct gz_paint) { 90, 220, 255, (uint8_t)lroundf(255 * strength * opacity) };
}

static void draw_trail_stay(const struct gz_gaze_stay *stay, struct gz_place at, float strength)
{
	const float lasted = fminf(1, (float)gz_ns_to_s(stay->to_ns - stay->from_ns));
	const float radius = DISC_RADIUS + DISC_GROWTH * sqrtf(lasted);
	gz_draw_disc(GZ_LAYER_PICTURE, at, radius, trail_paint(strength, 0.35f));
	gz_draw_circle(GZ_LAYER_PICTURE, at, radius, trail_paint(strength, 0.9f), 1);
}

static void draw_trail(struct gz_window *window, const struct gz_window_gaze *gaze)
{
	const struct gz_gaze_trail *trail = &window->trail->trail;
	const int64_t now_ns = gz_clock_now_ns();
	(void)gaze;
	if (!window->settings.view.trail)
		return;
	window->trail->drawn_ns = now_ns;
	window->trail->changed = false;
	for (int i = 0; i < trail->count; i++) {
		const struct gz_gaze_stay *stay = &trail->stays[i];
		const float strength = gz_gaze_trail_strength(stay, now_ns);
		const struct gz_place at = gz_window_place_of(window, stay->point);
		if (i > 0)
			gz_draw_line(GZ_LAYER_PICTURE, gz_window_place_of(window, stay[-1].point),
				     at,
				     trail_paint(gz_gaze_trail_strength(&stay[-1], now_ns), 0.8f),
				     LINE_THICKNESS);
		if (stay->fixation)
			draw_trail_stay(stay, at, strength);
	}
}

static bool is_trail_on(const struct gz_window *window, int number)
{
	(void)number;
	return window->settings.view.trail;
}

static const struct gz_window_action trail_actions[] = {
	{ .letter = 't',
	  .keys = "T",
	  .help = "trail: the last second of the gaze",
	  .name = "Trail of the gaze",
	  .menu = GZ_MENU_GAZE,
	  .section = 1,
	  .words = "path history",
	  .is_on = is_trail_on,
	  .run = toggle_trail },
};

/* A fading trail is drawn even if nothing else changes. */
static double trail_patience_s(const struct gz_window *window)
{
	return window->settings.view.trail &&
			       (window->trail->trail.count > 1 || window->trail->changed)
		       ? gz_ns_to_s(FADE_INTERVAL_NS)
		       : INFINITY;
}

const struct gz_window_part gz_window_trail_part = {
	.name = "trail",
	.title = "gaze",
	GZ_PART_ACTIONS(trail_actions),
	GZ_PART_STATE(trail),
	.follows = trail_follows,
	.panels = draw_trail,
	.patience_s = trail_patience_s,
};
