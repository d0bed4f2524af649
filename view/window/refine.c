/* The part that refines the picture at rest: when neither camera nor gaze have moved for a while,
 * the picture by method standard is made beside the frames and shown in place of the last one. */
#include "view/window/refine.h"

#include <math.h>
#include <string.h>

#include "base/clock.h"
#include "render/plan/method.h"
#include "view/draw/quad.h"
#include "view/window/gaze.h"
#include "view/window/standard.h"
#include "view/window/window_state.h"

#define GZ_LOG_MODULE "window"

/* How long the picture rests before it is refined (chosen: longer than a fixation, and shorter than
 * anyone waits). */
#define REST_NS (GZ_NS_PER_S / 2)

struct gz_window_refine {
	struct gz_compare drawing;
	struct gz_reference_worker *worker;
	struct gz_image image;
	int64_t frame_ns; /* when the last frame was made */
	bool asked;       /* since then */
	bool any;         /* the picture of that frame is in the texture */
	bool refused;     /* this scene cannot be refined */
};

/* Not where someone wants to see what foveation does, nor what a frame showed. */
static bool is_refining_wanted(const struct gz_window *window)
{
	const struct gz_scene_settings *settings = &window->settings;
	return settings->view.refine && window->maker && window->any_shown && !window->alone &&
	       !window->picture_hidden && !window->gaze_frozen && !window->refine->refused &&
	       settings->view.compare == GZ_COMPARE_NONE &&
	       settings->view.overlay == GZ_OVERLAY_NONE && !settings->temporal.accumulate &&
	       gz_foveation_follows_gaze(&settings->foveation) &&
	       gz_window_source_now(window) != GZ_WINDOW_FIXED &&
	       window->options->measure_window == 0 && window->options->turn_deg == 0 &&
	       !window->options->replay[0];
}

bool gz_window_is_refined(const struct gz_window *window)
{
	return window->refine->any;
}

static enum gz_result open_refined(struct gz_window *window)
{
	window->refine->any = false;
	return gz_compare_init(&window->refine->drawing, window->log);
}

static void drop_refined(struct gz_window_refine *self)
{
	gz_reference_worker_stop(&self->worker);
	gz_image_free(&self->image);
	self->any = self->asked = false;
}

/* A frame has been made: what was refined shows another one. */
static void begin_rest(struct gz_window *window)
{
	struct gz_window_refine *self = window->refine;
	self->frame_ns = gz_clock_now_ns();
	self->any = false;
	if (self->asked)
		gz_reference_worker_cancel(self->worker);
	self->asked = false;
}

/* Only a backend that needs no data of its own. */
static void start_refining(struct gz_window *window)
{
	struct gz_window_refine *self = window->refine;
	self->asked = true;
	if (!self->worker && (strcmp(gz_frame_standard_backend(window->maker), "cpu") != 0 ||
			      gz_window_start_standard(window, false, &self->worker) != GZ_OK)) {
		self->refused = true;
		self->asked = false;
		return;
	}
	gz_window_ask_for_standard(window, self->worker, gz_frame_rays(window->maker),
				   window->record.width, window->record.height);
}

static void turn_refining(struct gz_window *window)
{
	struct gz_window_refine *self = window->refine;
	if (!is_refining_wanted(window)) {
		window->present_needed = window->present_needed || self->any;
		drop_refined(self);
		return;
	}
	if (!self->asked && gz_clock_now_ns() - self->frame_ns >= REST_NS)
		start_refining(window);
	if (self->asked && gz_reference_worker_take(self->worker, &self->image)) {
		gz_compare_upload(&self->drawing, &self->image);
		self->any = true;
		window->present_needed = true;
	}
}

static void paint_refined(struct gz_window *window, int width, int height)
{
	if (window->refine->any)
		gz_compare_draw_beside(&window->refine->drawing, 0, width, height);
}

static double refining_patience_s(const struct gz_window *window)
{
	const struct gz_window_refine *self = window->refine;
	if (self->asked || !is_refining_wanted(window))
		return INFINITY;
	return fmax(0, gz_ns_to_s(self->frame_ns + REST_NS - gz_clock_now_ns()));
}

static void leave_refined_scene(struct gz_window *window)
{
	drop_refined(window->refine);
	window->refine->refused = false;
}

static bool leave_refined_data(struct gz_window *window)
{
	drop_refined(window->refine);
	return true;
}

static void close_refined_drawing(struct gz_window *window)
{
	drop_refined(window->refine);
	gz_compare_free(&window->refine->drawing);
}

static void close_refined(struct gz_window *window)
{
	drop_refined(window->refine);
}

static void toggle_refining(struct gz_window *window, int number)
{
	(void)number;
	window->settings.view.refine = !window->settings.view.refine;
	window->present_needed = true;
}

static bool is_refining_on(const struct gz_window *window, int number)
{
	(void)number;
	return window->settings.view.refine;
}

static const struct gz_window_action refine_actions[] = {
	{ .help = "full quality everywhere while all rests",
	  .name = "Refine at rest",
	  .menu = GZ_MENU_PICTURE,
	  .section = 1,
	  .words = "sharp quality still",
	  .is_on = is_refining_on,
	  .run = toggle_refining },
};

const struct gz_window_part gz_window_refine_part = {
	.name = "refine",
	.title = "picture",
	GZ_PART_ACTIONS(refine_actions),
	GZ_PART_STATE(refine),
	.gl_open = open_refined,
	.scene_leaving = leave_refined_scene,
	.data_leaving = leave_refined_data,
	.turn = turn_refining,
	.frame_made = begin_rest,
	.paint = paint_refined,
	.patience_s = refining_patience_s,
	.gl_close = close_refined_drawing,
	.close = close_refined,
};
