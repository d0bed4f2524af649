#include "view/window/overlay.h"

#include <stdlib.h>

#include "view/draw/overlay.h"
#include "view/panels/marks.h"
#include "view/window/window_state.h"

#define GZ_LOG_MODULE "window"

static void choose_next(struct gz_window *window, int number)
{
	(void)number;
	int *overlay = &window->settings.view.overlay;
	*overlay = (*overlay + 1) % GZ_OVERLAY_COUNT;
	window->present_needed = true;
}

static const struct gz_window_action actions[] = {
	{ .letter = 'i',
	  .keys = "I",
	  .help = "tint by spacing of rays, by their steps, not",
	  .run = choose_next },
};

static enum gz_result open_part(struct gz_window *window)
{
	window->overlay = calloc(1, sizeof *window->overlay);
	return window->overlay ? GZ_OK : GZ_ERR_NO_MEM;
}

static enum gz_result open_drawing(struct gz_window *window)
{
	return gz_overlay_init(window->overlay, window->log);
}

/* Another scene's plans count from the beginning. */
static void begin_scene(struct gz_window *window)
{
	window->overlay->serial = 0;
}

static bool is_shown(const struct gz_window *window)
{
	return window->settings.view.overlay != GZ_OVERLAY_NONE && window->maker &&
	       window->any_shown;
}

static void paint(struct gz_window *window, int width, int height)
{
	const enum gz_view_overlay kind = (enum gz_view_overlay)window->settings.view.overlay;
	if (!is_shown(window))
		return;
	/* Beside the divider is another plan's picture. */
	const bool beside = window->settings.view.compare == GZ_COMPARE_SPLIT;
	const double share = beside ? window->settings.view.split : 1;
	if (gz_overlay_draw(window->overlay, gz_frame_plan(window->maker), kind, share, width,
			    height) == GZ_OK)
		return;
	gz_err(window->log, "no memory for view.overlay; it is switched off");
	window->settings.view.overlay = GZ_OVERLAY_NONE;
}

static void draw_panels(struct gz_window *window, const struct gz_window_gaze *gaze)
{
	(void)gaze;
	const struct gz_plan_cells *cells = &window->overlay->cells;
	if (is_shown(window))
		window->panels_top = gz_marks_draw_legend(window->panels_top,
						    (enum gz_view_overlay)window->overlay->shown,
						    cells, window->shown.image_sampling_rate);
}

static void close_drawing(struct gz_window *window)
{
	if (window->overlay)
		gz_overlay_free(window->overlay);
}

static void close_part(struct gz_window *window)
{
	free(window->overlay);
	window->overlay = NULL;
}

const struct gz_window_part gz_window_overlay_part = {
	.name = "overlay",
	.title = "picture",
	.actions = actions,
	.action_count = sizeof actions / sizeof actions[0],
	.open = open_part,
	.gl_open = open_drawing,
	.scene_shown = begin_scene,
	.paint = paint,
	.panels = draw_panels,
	.gl_close = close_drawing,
	.close = close_part,
};
