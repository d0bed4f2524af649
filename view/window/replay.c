/* The part that shows a session again: --replay. */
#include <math.h>

#include "view/panels/marks.h"
#include "view/session/replay.h"
#include "view/window/window_state.h"

#define GZ_LOG_MODULE "replay"

/* Delay from which the clock of a replay is set back, so that each frame is shown. Chosen: shorter
 * delays are caught up unnoticed. */
#define LATE_NS (100 * GZ_NS_PER_MS)

struct gz_window_replay {
	bool begun; /* with the first scene, which is that of the session */
	struct gz_replay *replay;
	bool pending;                  /* the frame read last is still to be shown */
	bool over;                     /* there are no more frames */
	bool any;                      /* the next two fields are valid */
	bool fresh;                    /* a frame is shown first in this turn */
	struct gz_session_frame frame; /* shown */
	int64_t start_ns;              /* time 0 on the host's clock */
};

static void open_replay(struct gz_window *window)
{
	struct gz_window_replay *self = window->replay;
	if (self->begun || !window->options->replay[0])
		return;
	self->begun = true;
	/* Failures are logged; the scene is shown without the session. */
	if (gz_replay_open(window->options, window->maker, window->log, &self->replay) != GZ_OK)
		self->over = true;
}

static void close_replay(struct gz_window *window)
{
	gz_replay_close(&window->replay->replay);
}

static bool leave_replayed_data(struct gz_window *window)
{
	return !window->replay->replay;
}

static void read_next_frame(struct gz_window *window)
{
	struct gz_window_replay *self = window->replay;
	const enum gz_result r = gz_replay_next(self->replay);
	self->pending = r == GZ_OK;
	self->over = r != GZ_OK;
	if (r == GZ_ERR_END)
		gz_info(window->log, "%s: all %llu frames have been shown; the last one stays",
			window->options->replay,
			(unsigned long long)gz_replay_frames(self->replay));
	window->present_needed = window->present_needed || self->over;
}

static void turn_replay(struct gz_window *window)
{
	struct gz_window_replay *self = window->replay;
	if (self->replay && !self->pending && !self->over)
		read_next_frame(window);
}

/* Show the next frame, if it is due. */
static void show_due_frame(struct gz_window *window)
{
	struct gz_window_replay *self = window->replay;
	const int64_t now_ns = gz_clock_now_ns();
	const int64_t time_ns = gz_replay_frame(self->replay)->time_ns;
	if (!self->any)
		self->start_ns = now_ns - time_ns;
	if (now_ns - self->start_ns < time_ns || gz_replay_ready(self->replay) != GZ_OK)
		return;
	if (now_ns - self->start_ns - time_ns > LATE_NS)
		self->start_ns = now_ns - time_ns;
	self->frame = *gz_replay_frame(self->replay);
	window->settings = *gz_replay_settings(self->replay);
	self->pending = false;
	self->any = self->fresh = true;
	window->cast_needed = true;
}

static void replay_gaze(struct gz_window *window, struct gz_window_gaze *gaze)
{
	struct gz_window_replay *self = window->replay;
	self->fresh = false;
	if (!self->replay)
		return;
	if (self->pending)
		show_due_frame(window);
	if (!self->any)
		return;
	const struct gz_display here = gaze->display;
	gaze->reading = self->frame.reading;
	gaze->display = self->frame.display;
	/* A window of another size is another part of the same display. */
	for (int i = 0; i < 2; i++) {
		gaze->display.mm[i] *= (double)here.px[i] / gaze->display.px[i];
		gaze->display.px[i] = here.px[i];
	}
	gaze->source = "replay";
	gaze->missing = false;
	gaze->status = NULL;
	gaze->focus = &self->frame.focus;
	gaze->focus_new = self->fresh;
}

static void compare_frame(struct gz_window *window)
{
	if (window->replay->fresh && window->replay->replay)
		gz_replay_compare(window->replay->replay, &window->record);
}

static void draw_replay_mark(struct gz_window *window, const struct gz_window_gaze *gaze)
{
	(void)gaze;
	const struct gz_window_replay *self = window->replay;
	if (self->replay)
		gz_marks_draw_running(2, self->over ? "replay: the end" : "replay", false,
				      self->frame.time_ns / GZ_NS_PER_S);
}

static double replay_patience_s(const struct gz_window *window)
{
	const struct gz_window_replay *self = window->replay;
	if (!self->replay || self->over)
		return INFINITY;
	if (!self->pending || !self->any)
		return 0;
	const int64_t due_ns = self->start_ns + gz_replay_frame(self->replay)->time_ns;
	return fmax(0, gz_ns_to_s(due_ns - gz_clock_now_ns()));
}

const struct gz_window_part gz_window_replay_part = {
	.name = "replay",
	GZ_PART_STATE(replay),
	.scene_shown = open_replay,
	.scene_leaving = close_replay,
	.data_leaving = leave_replayed_data,
	.turn = turn_replay,
	.gaze = replay_gaze,
	.frame_made = compare_frame,
	.panels = draw_replay_mark,
	.patience_s = replay_patience_s,
	.close = close_replay,
};
