/* The part that saves pictures of full quality, of any size up to 16 384 px a side: made by method
 * standard beside the frames, and written when they are ready. */
#include <math.h>
#include <stdio.h>

#include <GLFW/glfw3.h>

#include "base/clock.h"
#include "view/panels/marks.h"
#include "view/panels/widgets.h"
#include "view/window/capture.h"
#include "view/window/standard.h"
#include "view/window/window_state.h"

#define GZ_LOG_MODULE "capture"

/* Unscaled (chosen: two numbers and four buttons). */
#define WIDTH 300.0f

/* Interval of drawing the time that a picture takes, s. */
#define MARK_PATIENCE_S 0.5

/* Row of the mark in the lower right corner. */
enum { MARK_ROW = 2, SIDE_MAX = 16384 };

struct gz_window_full_picture {
	struct gz_reference_worker *worker; /* makes a picture; NULL: none is in the making */
	struct gz_scene_settings settings;  /* of that picture */
	int64_t start_ns;
	int64_t drawn_s; /* in the mark */
	bool open;       /* the panel is */
	int size_px[2];  /* as chosen; 0: the window's */
};

static int64_t mark_seconds(const struct gz_window_full_picture *self)
{
	return (gz_clock_now_ns() - self->start_ns) / GZ_NS_PER_S;
}

static void chosen_size(const struct gz_window *window, int size_px[2])
{
	const int *chosen = window->full_picture->size_px;
	size_px[0] = chosen[0] > 0 ? chosen[0] : window->record.width;
	size_px[1] = chosen[1] > 0 ? chosen[1] : window->record.height;
}

static void save_full_picture(struct gz_window *window, int number)
{
	struct gz_window_full_picture *self = window->full_picture;
	int size_px[2];
	(void)number;
	if (!window->maker || !window->any_shown) {
		gz_warn(window->log, "no picture to save: no scene is shown");
		return;
	}
	if (self->worker) {
		gz_warn(window->log, "a picture is still being made; wait a moment");
		return;
	}
	if (gz_window_start_standard(window, true, &self->worker) != GZ_OK) {
		gz_info(window->log, "this scene has no picture of full quality: it is saved as it "
				     "is shown");
		gz_window_write_shown(window);
		return;
	}
	chosen_size(window, size_px);
	self->settings = window->made;
	self->start_ns = gz_clock_now_ns();
	gz_window_ask_for_standard(window, self->worker, gz_frame_rays(window->maker), size_px[0],
				   size_px[1]);
	window->present_needed = true;
}

static void turn_full_picture(struct gz_window *window)
{
	struct gz_window_full_picture *self = window->full_picture;
	struct gz_image image = { 0 };
	double share;
	if (!self->worker)
		return;
	if (gz_reference_worker_take(self->worker, &image)) {
		gz_window_write_picture(window, &image, &self->settings);
	} else if (gz_reference_worker_busy(self->worker, &share)) {
		window->present_needed =
			window->present_needed || mark_seconds(self) != self->drawn_s;
		return;
	}
	gz_image_free(&image);
	gz_reference_worker_stop(&self->worker); /* a failure has been logged */
	window->present_needed = true;
}

static void stop_full_picture(struct gz_window *window)
{
	if (window->full_picture->worker)
		gz_warn(window->log, "the picture is not saved: its scene was left too soon");
	gz_reference_worker_stop(&window->full_picture->worker);
}

/* Other data wait for the picture. */
static bool keep_pictured_data(struct gz_window *window)
{
	return !window->full_picture->worker;
}

static void draw_size_buttons(const struct gz_window *window, int size_px[2])
{
	static const struct {
		const char *name;
		int times;
	} scales[] = { { "1x", 1 }, { "2x", 2 }, { "4x", 4 } };
	for (size_t i = 0; i < sizeof scales / sizeof scales[0]; i++) {
		if (gz_widget_button(scales[i].name)) {
			size_px[0] = (int)fmin(SIDE_MAX, window->record.width * scales[i].times);
			size_px[1] = (int)fmin(SIDE_MAX, window->record.height * scales[i].times);
		}
		gz_widget_tooltip("that many times the window's size");
		gz_widgets_same_line(0);
	}
}

static void draw_full_picture(struct gz_window *window, const struct gz_window_gaze *gaze)
{
	static const struct gz_number_range range = {
		.least = 1, .greatest = SIDE_MAX, .speed = 4, .format = "%d px"
	};
	struct gz_window_full_picture *self = window->full_picture;
	const struct gz_panel_place place = { .at = GZ_PANEL_TOP_RIGHT,
					      .margin_top = window->panels_top,
					      .width = WIDTH };
	int size_px[2];
	(void)gaze;
	if (self->worker)
		self->drawn_s = mark_seconds(self);
	if (self->worker)
		gz_marks_draw_running(MARK_ROW, "making a picture", false, self->drawn_s);
	if (!self->open || !window->maker || !window->any_shown)
		return;
	chosen_size(window, size_px);
	if (gz_panel_begin("Save picture", &place, &self->open)) {
		gz_widgets_next_width(0);
		if (gz_widget_ints("##size", size_px, 2, &range)) {
			self->size_px[0] = size_px[0];
			self->size_px[1] = size_px[1];
		}
		gz_widget_tooltip("width and height; Ctrl+click to type");
		draw_size_buttons(window, self->size_px);
		if (gz_widget_button("Save"))
			save_full_picture(window, 0);
		gz_widget_tooltip("each pixel gets its ray; F12 saves at this size too");
	}
	gz_panel_end();
}

static double full_picture_patience_s(const struct gz_window *window)
{
	return window->full_picture->worker ? MARK_PATIENCE_S : INFINITY;
}

static void toggle_full_picture(struct gz_window *window, int number)
{
	(void)number;
	window->full_picture->open = !window->full_picture->open;
	gz_window_wake_panels(window);
}

static bool is_full_picture_open(const struct gz_window *window)
{
	return window->full_picture->open;
}

static const struct gz_window_action full_picture_actions[] = {
	{ .key = GLFW_KEY_ESCAPE, .applies = is_full_picture_open, .run = toggle_full_picture },
	{ .key = GLFW_KEY_F12,
	  .keys = "F12",
	  .help = "save a picture of full quality, with its scene",
	  .name = "Save picture",
	  .menu = GZ_MENU_FILE,
	  .section = 2,
	  .on_picture = true,
	  .words = "screenshot image png export capture",
	  .run = save_full_picture },
	{ .help = "choose the size of saved pictures",
	  .name = "Size of saved pictures...",
	  .menu = GZ_MENU_FILE,
	  .section = 2,
	  .words = "screenshot scale resolution image",
	  .run = toggle_full_picture },
};

const struct gz_window_part gz_window_full_picture_part = {
	.name = "full picture",
	.title = "record",
	GZ_PART_ACTIONS(full_picture_actions),
	GZ_PART_STATE(full_picture),
	.scene_leaving = stop_full_picture,
	.data_leaving = keep_pictured_data,
	.turn = turn_full_picture,
	.panels = draw_full_picture,
	.patience_s = full_picture_patience_s,
	.gl_close = stop_full_picture,
	.close = stop_full_picture,
};
