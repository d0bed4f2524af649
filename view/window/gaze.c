/* Where the gaze is on the picture. */
#include "view/window/window_state.h"

#include "base/clock.h"
#include "view/window/displays.h"
#include "view/window/gaze_sources.h"

/* How often an absent daemon is looked for, and one that is not looked at is told of the window, s
 * (chosen: a returning one is seen at once, at no cost). */
#define ABSENT_PATIENCE_S 0.25
/* Without anything live: only events change the picture. */
#define STILL_PATIENCE_S 10.0

/* The geometry of the picture. A known display's window is a part of it; the default is made to
 * fit the picture. */
static struct gz_display picture_display(const struct gz_window *window,
					 const struct gz_window_share *share, int width, int height)
{
	const struct gz_scene *scene = gz_frame_maker_scene(window->maker);
	const struct gz_view_options *options = window->options;
	struct gz_display brought;
	const struct gz_display *known = NULL;
	if (scene->has_display)
		known = &scene->settings.display;
	else if (window->source && gz_gaze_source_display(window->source, &brought))
		known = &brought;
	struct gz_display display = gz_view_display(options, known, width, height);
	if (known || options->display_mm[0] > 0) {
		display.mm[0] *= share->width;
		display.mm[1] *= share->height;
	}
	display.px[0] = width;
	display.px[1] = height;
	return display;
}

/* The gaze that is asked for, where it is to be had. A tracker's is on its display, of which the
 * window is a part. */
static void take_asked(struct gz_window *window, const struct gz_window_share *share,
		       struct gz_window_gaze *gaze)
{
	gz_window_read_source(window, &gaze->asked);
	gaze->status = gz_gaze_source_status(window->source);
	gaze->missing = !gaze->asked.known || !gaze->asked.connected;
	if (gaze->missing)
		return;
	gaze->reading = gaze->asked;
	gaze->source = window->sources->choice.kind == GZ_GAZE_POINTER ? "pointer"
								       : window->source->ops->name;
	if (window->source->ops->live)
		gaze->reading.point = gz_window_share_point(share, gaze->asked.point);
}

void gz_window_gaze_now(struct gz_window *window, int width, int height,
			struct gz_window_gaze *out_gaze)
{
	struct gz_window_share share = gz_window_share(window);
	struct gz_window_gaze gaze = { .source = "mouse" };
	if (window->source)
		take_asked(window, &share, &gaze);
	if (!window->source || gaze.missing)
		gz_gaze_source_read(window->mouse, 0, &gaze.reading);
	if (!window->source)
		gaze.asked = gaze.reading;
	else if (!gaze.missing && !window->source->ops->live)
		share = (struct gz_window_share) { 0, 0, 1, 1 };
	window->source_missing = gaze.missing;
	gaze.display = picture_display(window, &share, width, height);
	*out_gaze = gaze;
}

/* Seconds until a source that is asked for may have something new. */
static double source_patience_s(const struct gz_window *window)
{
	const struct gz_window_log_clock *clock = &window->sources->log;
	const double frame_s = 1 / window->options->fps;
	struct gz_gaze_log_place place;
	if (!window->source)
		return STILL_PATIENCE_S;
	if (gz_gaze_source_log_place(window->source, &place)) {
		if (clock->seeking)
			return 0;
		return clock->paused || place.ended ? STILL_PATIENCE_S : frame_s;
	}
	if (!window->source->ops->live)
		return STILL_PATIENCE_S;
	return window->source_missing ? ABSENT_PATIENCE_S : frame_s;
}

double gz_window_gaze_patience_s(const struct gz_window *window)
{
	if (window->panel_frames > 0)
		return 0;
	if (!window->maker)
		return STILL_PATIENCE_S;
	const bool attends = !window->gaze_frozen && !gz_frame_settled(window->maker);
	if (window->options->turn_deg != 0 || attends || gz_frame_refinable(window->maker))
		return 1 / window->options->fps;
	const double patience_s = source_patience_s(window);
	/* A daemon that is not looked at is told of the window all the same. */
	return window->link && patience_s > ABSENT_PATIENCE_S ? ABSENT_PATIENCE_S : patience_s;
}
