#include "view/window/replay_part.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "view/panels/marks.h"
#include "view/session/replay.h"
#include "view/window/window_state.h"

#define GZ_LOG_MODULE "replay"

/* A replay that is so late runs on from where it is: each frame is shown, in its turn. Chosen:
 * shorter delays are made up for unseen. */
#define LATE_NS (100 * GZ_NS_PER_MS)

struct gz_window_replay_state {
	bool begun; /* with the first scene shown; others are not the session's */
	struct gz_replay *replay;
	bool pending;                  /* its frame is still to be shown */
	bool over;                     /* there is none further */
	bool any;                      /* the next ones hold something */
	bool fresh;                    /* the frame of this turn */
	struct gz_session_frame frame; /* shown */
	int64_t start_ns;              /* time 0 on the host's clock */
};

static enum gz_result open_part(struct gz_window *window)
{
	window->replay = calloc(1, sizeof *window->replay);
	return window->replay ? GZ_OK : GZ_ERR_NO_MEM;
}

static void scene_shown(struct gz_window *window)
{
	struct gz_window_replay_state *self = window->replay;
	if (self->begun || !window->options->replay[0])
		return;
	self->begun = true;
	/* Why not has been logged; the scene is there to be looked at. */
	if (gz_replay_open(window->options, window->maker, window->log, &self->replay) != GZ_OK)
		self->over = true;
}

static void scene_leaving(struct gz_window *window)
{
	gz_replay_close(&window->replay->replay);
}

static void read_next(struct gz_window *window)
{
	struct gz_window_replay_state *self = window->replay;
	const enum gz_result r = gz_replay_next(self->replay);
	self->pending = r == GZ_OK;
	self->over = r != GZ_OK;
	if (r == GZ_ERR_END)
		gz_info(window->log, "%s: all %llu frames were shown; the last one stays",
			window->options->replay,
			(unsigned long long)gz_replay_frames(self->replay));
	window->present_needed = window->present_needed || self->over;
}

static void turn(struct gz_window *window)
{
	struct gz_window_replay_state *self = window->replay;
	if (self->replay && !self->pending && !self->over)
		read_next(window);
}

/* The frame that is due, if one is. */
static void take_frame(struct gz_window *window)
{
	struct gz_window_replay_state *self = window->replay;
	const int64_t now_ns = gz_clock_now_ns();
	const int64_t time_ns = gz_replay_frame(self->replay)->time_ns;
	if (!self->any)
		self->start_ns = now_ns - time_ns;
	if (now_ns - self->start_ns < time_ns || gz_replay_ready(self->replay) != GZ_OK)
		return;
	if (now_ns - self->start_ns - time_ns > LATE_NS)
		self->start_ns = now_ns - time_ns;
	self->frame = *gz_replay_frame(self->replay);
	memcpy(&window->settings, gz_replay_settings(self->replay), sizeof window->settings);
	self->pending = false;
	self->any = self->fresh = true;
	window->cast_needed = true;
}

static void take_gaze(struct gz_window *window, struct gz_window_gaze *gaze)
{
	struct gz_window_replay_state *self = window->replay;
	self->fresh = false;
	if (!self->replay)
		return;
	if (self->pending)
		take_frame(window);
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

static void frame_made(struct gz_window *window)
{
	if (window->replay->fresh && window->replay->replay)
		gz_replay_compare(window->replay->replay, &window->record);
}

static void panels(struct gz_window *window, const struct gz_window_gaze *gaze)
{
	(void)gaze;
	const struct gz_window_replay_state *self = window->replay;
	if (self->replay)
		gz_marks_draw_running(2, self->over ? "replay: the end" : "replay", false,
				      self->frame.time_ns / GZ_NS_PER_S);
}

static double patience_s(const struct gz_window *window)
{
	const struct gz_window_replay_state *self = window->replay;
	if (!self->replay || self->over)
		return INFINITY;
	if (!self->pending || !self->any)
		return 0;
	const int64_t due_ns = self->start_ns + gz_replay_frame(self->replay)->time_ns;
	return fmax(0, gz_ns_to_s(due_ns - gz_clock_now_ns()));
}

static void close_part(struct gz_window *window)
{
	if (window->replay)
		gz_replay_close(&window->replay->replay);
	free(window->replay);
	window->replay = NULL;
}

const struct gz_window_part gz_window_replay = {
	.name = "replay",
	.open = open_part,
	.scene_shown = scene_shown,
	.scene_leaving = scene_leaving,
	.turn = turn,
	.gaze = take_gaze,
	.frame_made = frame_made,
	.panels = panels,
	.patience_s = patience_s,
	.close = close_part,
};
