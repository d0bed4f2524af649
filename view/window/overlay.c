/* The part that tints the picture to show its plan. */
#include "view/draw/overlay.h"
#include "view/panels/marks.h"
#include "view/window/window_state.h"

#define GZ_LOG_MODULE "window"

static void choose_next_tint(struct gz_window *window, int number)
{
	(void)number;
	int *overlay = &window->settings.view.overlay;
	*overlay = (*overlay + 1) % GZ_OVERLAY_COUNT;
	window->present_needed = true;
}

/* Show it, or hide it if it is shown. */
static void switch_tint(struct gz_window *window, int kind)
{
	int *overlay = &window->settings.view.overlay;
	*overlay = *overlay == kind ? GZ_OVERLAY_NONE : kind;
	window->present_needed = true;
}

static bool is_tint_on(const struct gz_window *window, int kind)
{
	return window->settings.view.overlay == kind;
}

static const struct gz_window_action overlay_actions[] = {
	{ .letter = 'i',
	  .keys = "I",
	  .help = "tint: ray spacing, step length, off",
	  .name = "Next tint",
	  .menu = GZ_MENU_PICTURE,
	  .section = 1,
	  .submenu = "Tint",
	  .words = "heat map overlay plan",
	  .run = choose_next_tint },
	{ .number = GZ_OVERLAY_SPACING,
	  .help = "tint by the distance between rays",
	  .name = "Ray spacing",
	  .menu = GZ_MENU_PICTURE,
	  .section = 1,
	  .submenu = "Tint",
	  .on_picture = true,
	  .is_on = is_tint_on,
	  .run = switch_tint },
	{ .number = GZ_OVERLAY_STEP,
	  .help = "tint by the length of steps along rays",
	  .name = "Step length",
	  .menu = GZ_MENU_PICTURE,
	  .section = 1,
	  .submenu = "Tint",
	  .on_picture = true,
	  .is_on = is_tint_on,
	  .run = switch_tint },
};

static enum gz_result open_tint(struct gz_window *window)
{
	return gz_overlay_init(window->overlay, window->log);
}

/* Serial numbers of plans begin again with each scene. */
static void forget_plan(struct gz_window *window)
{
	window->overlay->serial = 0;
}

static bool is_tint_shown(const struct gz_window *window)
{
	return window->settings.view.overlay != GZ_OVERLAY_NONE && window->maker &&
	       window->any_shown;
}

static void paint_tint(struct gz_window *window, int width, int height)
{
	const enum gz_view_overlay kind = (enum gz_view_overlay)window->settings.view.overlay;
	if (!is_tint_shown(window))
		return;
	/* The other side of the divider shows the standard picture. */
	const bool beside = window->settings.view.compare == GZ_COMPARE_SPLIT;
	const double share = beside ? window->settings.view.split : 1;
	if (gz_overlay_draw(window->overlay, gz_frame_plan(window->maker), kind, share, width,
			    height) == GZ_OK)
		return;
	gz_err(window->log, "no memory for view.overlay, which is switched off");
	window->settings.view.overlay = GZ_OVERLAY_NONE;
}

static void draw_tint_legend(struct gz_window *window, const struct gz_window_gaze *gaze)
{
	(void)gaze;
	const struct gz_plan_cells *cells = &window->overlay->cells;
	const enum gz_view_overlay kind = (enum gz_view_overlay)window->settings.view.overlay;
	/* Without memory it is switched off when it is painted. */
	if (is_tint_shown(window) &&
	    gz_overlay_follow(window->overlay, gz_frame_plan(window->maker), kind) == GZ_OK)
		window->panels_top = gz_marks_draw_legend(
			window->panels_top, (enum gz_view_overlay)window->overlay->shown, cells,
			window->shown.image_sampling_rate);
}

static void close_tint(struct gz_window *window)
{
	gz_overlay_free(window->overlay);
}

const struct gz_window_part gz_window_overlay_part = {
	.name = "overlay",
	.title = "picture",
	GZ_PART_ACTIONS(overlay_actions),
	GZ_PART_STATE(overlay),
	.gl_open = open_tint,
	.scene_shown = forget_plan,
	.paint = paint_tint,
	.panels = draw_tint_legend,
	.gl_close = close_tint,
};
