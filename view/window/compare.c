/* The part that shows the standard picture beside the method's, or the difference between them. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include <GLFW/glfw3.h>

#include "view/draw/quad.h"
#include "view/panels/widgets.h"
#include "view/settings/scene_keys.h"
#include "view/window/displays.h"
#include "view/window/sections.h"
#include "view/window/standard.h"
#include "view/window/window_state.h"

#define GZ_LOG_MODULE "window"

/* Interval of looking at a picture in the making, and change of its progress that is shown (chosen:
 * visible, and cheap). */
#define PROGRESS_S     0.1
#define PROGRESS_SHARE 0.05
/* Step of the divider by a key, share of the width (chosen: fifty presses from side to side). */
#define SPLIT_STEP 0.02
/* Distance from which the mouse grabs the divider, unscaled (chosen: easy to hit; elsewhere the
 * mouse turns the camera). */
#define GRAB_NEAR 6.0
/* Unscaled. */
#define LABEL_MARGIN  8.0f
#define CORNER_WIDTH  300.0f
#define CORNER_HEIGHT 56.0f
/* Of the circle at the gaze, unscaled (chosen: it covers nothing that is looked at). */
#define GAZE_RADIUS 18.0F

static const struct gz_paint gaze_paint = { 255, 64, 64, 255 };

struct gz_window_compare {
	struct gz_compare drawing;
	struct gz_reference_worker *worker;
	int technique;         /* render.technique of the worker */
	const char *backend;   /* of the worker */
	struct gz_image image; /* the last standard picture */
	bool any;              /* it is in the texture */
	bool busy;
	double share, share_shown;
	struct gz_point gaze_drawn; /* where its circle is */
};

static bool is_compare_wanted(const struct gz_window *window)
{
	/* An experiment gets the whole processor. */
	return window->settings.view.compare != GZ_COMPARE_NONE && window->maker && !window->alone;
}

/* Whether surfaces under a plain lamp are beside the picture. */
static bool is_with_plain(const struct gz_window *window)
{
	return window->settings.view.compare_with == GZ_COMPARE_WITH_PLAIN &&
	       gz_setting_applies(&window->settings, "view.compare_with");
}

static void choose_next_compare(struct gz_window *window, int number)
{
	(void)number;
	int *compare = &window->settings.view.compare;
	*compare = (*compare + 1) % GZ_COMPARE_COUNT;
	window->present_needed = true;
}

/* Show it, or hide it if it is shown. */
static void switch_compare(struct gz_window *window, int kind)
{
	int *compare = &window->settings.view.compare;
	*compare = *compare == kind ? GZ_COMPARE_NONE : kind;
	window->present_needed = true;
}

static bool is_compared(const struct gz_window *window, int kind)
{
	return window->settings.view.compare == kind;
}

static bool is_plain_compared(const struct gz_window *window, int number)
{
	(void)number;
	return is_compared(window, GZ_COMPARE_SPLIT) && is_with_plain(window);
}

/* Put surfaces under a plain lamp beside an illustration, or take them away. */
static void switch_plain(struct gz_window *window, int number)
{
	struct gz_view_settings *view = &window->settings.view;
	const bool shown = is_plain_compared(window, number);
	if (!gz_setting_applies(&window->settings, "illustration.show")) {
		gz_info(window->log, "the picture is no illustration: it is its own plain view");
		return;
	}
	view->compare_with = shown ? GZ_COMPARE_WITH_STANDARD : GZ_COMPARE_WITH_PLAIN;
	view->compare = shown ? GZ_COMPARE_NONE : GZ_COMPARE_SPLIT;
	window->present_needed = true;
}

static void move_split(struct gz_window *window, int direction)
{
	double *split = &window->settings.view.split;
	*split = fmin(1, fmax(0, *split + direction * SPLIT_STEP));
	window->present_needed = true;
}

static void change_gain(struct gz_window *window, int direction)
{
	double *gain = &window->settings.view.difference_gain;
	*gain = fmin(GZ_DIFFERENCE_GAIN_MAX, fmax(1, direction > 0 ? *gain * 2 : *gain / 2));
	window->present_needed = true;
}

static const struct gz_window_action compare_actions[] = {
	{ .letter = 'v',
	  .keys = "V",
	  .help = "compare with standard: split, difference, off",
	  .name = "Next comparison",
	  .menu = GZ_MENU_PICTURE,
	  .section = 1,
	  .submenu = "Compare with standard",
	  .words = "split side by side reference quality",
	  .run = choose_next_compare },
	{ .number = GZ_COMPARE_SPLIT,
	  .help = "standard on the right of a divider",
	  .name = "Side by side",
	  .menu = GZ_MENU_PICTURE,
	  .section = 1,
	  .submenu = "Compare with standard",
	  .on_picture = true,
	  .words = "split",
	  .is_on = is_compared,
	  .run = switch_compare },
	{ .number = GZ_COMPARE_DIFFERENCE,
	  .help = "difference from standard, amplified",
	  .name = "Difference",
	  .menu = GZ_MENU_PICTURE,
	  .section = 1,
	  .submenu = "Compare with standard",
	  .on_picture = true,
	  .is_on = is_compared,
	  .run = switch_compare },
	{ .help = "beside an illustration: its surfaces under a plain lamp",
	  .name = "Plain surfaces",
	  .menu = GZ_MENU_PICTURE,
	  .section = 1,
	  .submenu = "Compare with standard",
	  .words = "illustration lamp side by side",
	  .is_on = is_plain_compared,
	  .run = switch_plain },
	{ .key = GLFW_KEY_LEFT,
	  .modifiers = GZ_KEY_CONTROL,
	  .repeats = true,
	  .number = -1,
	  .keys = "Ctrl+Left Right",
	  .help = "move the divider; or drag it",
	  .run = move_split },
	{ .key = GLFW_KEY_RIGHT,
	  .modifiers = GZ_KEY_CONTROL,
	  .repeats = true,
	  .number = 1,
	  .run = move_split },
	{ .key = GLFW_KEY_UP,
	  .modifiers = GZ_KEY_CONTROL,
	  .number = 1,
	  .keys = "Ctrl+Up Down",
	  .help = "show the difference brighter or darker",
	  .run = change_gain },
	{ .key = GLFW_KEY_DOWN, .modifiers = GZ_KEY_CONTROL, .number = -1, .run = change_gain },
};

static enum gz_result open_compare_drawing(struct gz_window *window)
{
	struct gz_window_compare *self = window->compare;
	const enum gz_result r = gz_compare_init(&self->drawing, window->log);
	if (r == GZ_OK && self->any)
		gz_compare_upload(&self->drawing, &self->image);
	return r;
}

static void drop_standard(struct gz_window_compare *self)
{
	gz_reference_worker_stop(&self->worker);
	gz_image_free(&self->image);
	self->any = self->busy = false;
}

/* render.technique of the picture on the screen. */
static int shown_technique(const struct gz_window *window)
{
	return gz_frame_maker_scene(window->maker)->settings.technique;
}

static void start_standard_worker(struct gz_window *window)
{
	window->compare->technique = shown_technique(window);
	window->compare->backend = gz_frame_standard_backend(window->maker);
	const enum gz_result r = gz_window_start_standard(window, false, &window->compare->worker);
	if (r == GZ_OK)
		return;
	gz_err(window->log, "no standard picture to compare with: %s",
	       r == GZ_ERR_UNSUPPORTED ? "volumes of bricks are read for one picture only"
				       : gz_result_text(r));
	window->settings.view.compare = GZ_COMPARE_NONE;
}

/* The standard picture of what is on the screen. */
static void ask_for_standard(struct gz_window *window)
{
	if (!window->compare->worker || !window->any_shown)
		return;
	struct gz_ray_params rays = *gz_frame_rays(window->maker);
	if (is_with_plain(window))
		gz_illustration_look_show_plain(&rays.illustration);
	gz_window_ask_for_standard(window, window->compare->worker, &rays, window->record.width,
				   window->record.height);
}

static void take_standard(struct gz_window *window)
{
	struct gz_window_compare *self = window->compare;
	const bool was_busy = self->busy;
	self->busy = gz_reference_worker_busy(self->worker, &self->share);
	if (gz_reference_worker_take(self->worker, &self->image)) {
		gz_compare_upload(&self->drawing, &self->image);
		self->any = true;
		window->present_needed = true;
	}
	if (self->busy != was_busy || fabs(self->share - self->share_shown) >= PROGRESS_SHARE)
		window->present_needed = true;
}

static void turn_compare(struct gz_window *window)
{
	struct gz_window_compare *self = window->compare;
	if (!is_compare_wanted(window)) {
		drop_standard(self);
		return;
	}
	if (self->worker && (self->technique != shown_technique(window) ||
			     strcmp(self->backend, gz_frame_standard_backend(window->maker)) != 0))
		drop_standard(self);
	if (!self->worker)
		start_standard_worker(window);
	if (!self->worker)
		return;
	ask_for_standard(window);
	take_standard(window);
}

static void leave_compared_scene(struct gz_window *window)
{
	drop_standard(window->compare);
}

static bool leave_compared_data(struct gz_window *window)
{
	drop_standard(window->compare);
	return true;
}

static void paint_compare(struct gz_window *window, int width, int height)
{
	const struct gz_window_compare *self = window->compare;
	const struct gz_view_settings *view = &window->settings.view;
	if (!self->any)
		return;
	if (view->compare == GZ_COMPARE_SPLIT)
		gz_compare_draw_beside(&self->drawing, view->split, width, height);
	else if (view->compare == GZ_COMPARE_DIFFERENCE && !self->busy)
		gz_compare_draw_difference(&self->drawing, window->quad.shown,
					   view->difference_gain, width, height);
}

static void print_standard(const struct gz_window *window, char *text, size_t size)
{
	const struct gz_window_compare *self = window->compare;
	const char *name =
		gz_view_compare_with_names[is_with_plain(window) ? GZ_COMPARE_WITH_PLAIN
								 : GZ_COMPARE_WITH_STANDARD];
	if (self->busy)
		snprintf(text, size, "%s: coming, %.0f %%", name, 100 * self->share);
	else
		snprintf(text, size, "%s%s", name, self->any ? "" : ": none");
}

static void draw_compare_label(struct gz_window *window, const char *text, float x, bool leftwards)
{
	const float unit = gz_widgets_scale();
	const float width = gz_text_room(1, text).x + 10 * unit; /* with the caption's rim */
	const struct gz_place low = gz_window_place_of(window, (struct gz_point) { 1, 1 });
	const float at = leftwards ? x - width - LABEL_MARGIN * unit : x + LABEL_MARGIN * unit;
	const float left = fmaxf(0, fminf(at, low.x - width));
	/* The lower left corner has the caption of the gaze. */
	const float below = left < CORNER_WIDTH * unit ? CORNER_HEIGHT * unit : 0;
	const struct gz_place corner = {
		left,
		low.y - gz_widgets_line_height() - 10 * unit - LABEL_MARGIN * unit - below,
	};
	gz_draw_caption(GZ_LAYER_PICTURE, corner,
			window->compare->busy && !leftwards ? gz_paint_amber : gz_paint_plain,
			text);
}

static void draw_divider(struct gz_window *window, const char *standard)
{
	const float split = (float)window->settings.view.split;
	struct gz_place top = gz_window_place_of(window, (struct gz_point) { split, 0 });
	struct gz_place bottom = gz_window_place_of(window, (struct gz_point) { split, 1 });
	const float x = roundf(top.x);
	top.x = bottom.x = x;
	gz_draw_line(GZ_LAYER_PICTURE, top, bottom, gz_paint_ground, 3);
	gz_draw_line(GZ_LAYER_PICTURE, top, bottom, gz_paint_plain, 1);
	draw_compare_label(window, window->record.method, x, true);
	draw_compare_label(window, standard, x, false);
}

/* The part that is sharp by its rule lies around the gaze: without the cross, a circle tells where.
 */
static void draw_compared_gaze(struct gz_window *window, const struct gz_window_gaze *gaze)
{
	const struct gz_point at = gaze->reading.point;
	const struct gz_place middle = gz_window_place_of(window, at);
	window->compare->gaze_drawn = at;
	if (!gaze->reading.known || window->settings.view.gaze_cursor ||
	    !window->settings.view.gaze_mark)
		return;
	gz_draw_circle(GZ_LAYER_PICTURE, middle, GAZE_RADIUS, gz_paint_ground, 3);
	gz_draw_circle(GZ_LAYER_PICTURE, middle, GAZE_RADIUS, gaze_paint, 1.5F);
}

/* The circle moves with the gaze. */
static bool compared_gaze_follows(struct gz_window *window, const struct gz_window_gaze *gaze)
{
	const struct gz_point at = gaze->reading.point, drawn = window->compare->gaze_drawn;
	return is_compare_wanted(window) && window->settings.view.gaze_mark &&
	       gaze->reading.known && (at.x != drawn.x || at.y != drawn.y);
}

static void draw_compare_marks(struct gz_window *window, const struct gz_window_gaze *gaze)
{
	struct gz_window_compare *self = window->compare;
	char standard[64], text[128];
	if (!is_compare_wanted(window) || !window->any_shown)
		return;
	draw_compared_gaze(window, gaze);
	self->share_shown = self->share;
	print_standard(window, standard, sizeof standard);
	if (window->settings.view.compare == GZ_COMPARE_SPLIT) {
		draw_divider(window, standard);
		return;
	}
	snprintf(text, sizeof text, "difference to %s, times %g", standard,
		 window->settings.view.difference_gain);
	draw_compare_label(window, text,
			   (gz_window_place_of(window, (struct gz_point) { 1, 1 }).x -
			    gz_text_room(1, text).x) /
				   2,
			   false);
}

/* Whether the mouse is near the divider. */
static bool grab_divider(struct gz_window *window, int button, int modifiers)
{
	const struct gz_place at = gz_window_place_of(
		window, (struct gz_point) { (float)window->settings.view.split, 0 });
	return button == GLFW_MOUSE_BUTTON_LEFT && modifiers == 0 && is_compare_wanted(window) &&
	       window->settings.view.compare == GZ_COMPARE_SPLIT &&
	       window->cursor[1] >= (double)at.y &&
	       fabs(window->cursor[0] - (double)at.x) <= GRAB_NEAR * (double)gz_widgets_scale();
}

static void drag_divider(struct gz_window *window, double right, double down)
{
	(void)right;
	(void)down;
	struct gz_point point;
	if (gz_window_mouse_point(window, &point))
		window->settings.view.split = fmin(1, fmax(0, (double)point.x));
	window->present_needed = true;
}

static double compare_patience_s(const struct gz_window *window)
{
	return window->compare->busy ? PROGRESS_S : INFINITY;
}

/* The worker must not draw while OpenGL is loaded for another window. */
static void close_compare_drawing(struct gz_window *window)
{
	gz_reference_worker_stop(&window->compare->worker);
	window->compare->busy = false;
	gz_compare_free(&window->compare->drawing);
}

static void close_compare(struct gz_window *window)
{
	drop_standard(window->compare);
}

const struct gz_window_part gz_window_compare_part = {
	.name = "compare",
	.title = "picture",
	GZ_PART_ACTIONS(compare_actions),
	GZ_PART_STATE(compare),
	.gl_open = open_compare_drawing,
	.scene_leaving = leave_compared_scene,
	.data_leaving = leave_compared_data,
	.turn = turn_compare,
	.frame_made = ask_for_standard,
	.follows = compared_gaze_follows,
	.paint = paint_compare,
	.panels = draw_compare_marks,
	.grab = grab_divider,
	.drag = drag_divider,
	.patience_s = compare_patience_s,
	.gl_close = close_compare_drawing,
	.close = close_compare,
};
