/* The part that records sessions: F9 and --record. */
#include <math.h>
#include <stdio.h>

#include <GLFW/glfw3.h>

#include "view/capture/output.h"
#include "view/panels/marks.h"
#include "view/session/session_writer.h"
#include "view/window/loading.h"
#include "view/window/window_state.h"

#define GZ_LOG_MODULE "session"

/* Interval of updating the time in the mark, s. */
#define MARK_PATIENCE_S 0.5

struct gz_window_session {
	bool wanted; /* begins before the next picture */
	bool named;  /* --record asks for a session that has not begun */
	struct gz_session_writer *writer;
	int64_t start_ns;
	int64_t drawn_s; /* time in the mark, as last drawn */
};

static enum gz_result open_session(struct gz_window *window)
{
	window->session->named = window->options->record[0] != '\0';
	return gz_recording_check(window->options->record, window->log);
}

static void end_session(struct gz_window *window)
{
	struct gz_window_session *self = window->session;
	if (!self->writer)
		return;
	char path[GZ_PATH_SIZE];
	const uint64_t frames = gz_session_writer_frames(self->writer);
	snprintf(path, sizeof path, "%s", gz_session_writer_path(self->writer));
	if (gz_session_writer_end(&self->writer) == GZ_OK)
		gz_info(window->log, "%s recorded, %llu frame%s; gazeview --replay shows it again",
			path, (unsigned long long)frames, frames == 1 ? "" : "s");
	window->present_needed = true;
}

static void begin_recording(struct gz_window *window, const struct gz_window_gaze *gaze)
{
	struct gz_window_session *self = window->session;
	char path[GZ_PATH_SIZE];
	if (self->named)
		snprintf(path, sizeof path, "%s", window->options->record);
	else if (gz_capture_name(window->options->pictures, GZ_SESSION_ENDING, path) != GZ_OK) {
		gz_err(window->log, "no session: no name is free; see --pictures");
		return;
	}
	self->start_ns = gz_clock_now_ns();
	const struct gz_recording_start start = {
		.path = path,
		.scene = gz_window_scene_path(window),
		.maker = window->maker,
		.settings = &window->settings,
		.display = &gaze->display,
		.source = gaze->source,
		.rate_hz = window->options->fps,
		.now_ns = self->start_ns,
	};
	if (gz_recording_begin(&start, window->log, &self->writer) == GZ_OK)
		window->cast_needed = window->present_needed = true;
}

static void toggle_session(struct gz_window *window, int number)
{
	(void)number;
	struct gz_window_session *self = window->session;
	if (self->writer)
		end_session(window);
	else if (window->maker)
		self->wanted = true;
	else
		gz_warn(window->log, "no scene is shown; open one to record a session");
}

/* A session has one scene. */
static void leave_recorded_scene(struct gz_window *window)
{
	end_session(window);
}

/* And one time point. */
static bool leave_recorded_data(struct gz_window *window)
{
	return !window->session->writer;
}

static void record_first_scene(struct gz_window *window)
{
	window->session->wanted = window->session->wanted || window->session->named;
}

static void record_gaze(struct gz_window *window, struct gz_window_gaze *gaze)
{
	struct gz_window_session *self = window->session;
	if (self->wanted)
		begin_recording(window, gaze);
	if (self->wanted)
		self->named = false;
	self->wanted = false;
	if (self->writer &&
	    gz_session_writer_gaze(self->writer, &gaze->reading, gz_clock_now_ns()) != GZ_OK)
		end_session(window);
}

static void record_frame(struct gz_window *window)
{
	struct gz_window_session *self = window->session;
	const struct gz_frame_request request = {
		.settings = &window->made,
		.display = &window->shown_display,
		.width = window->record.width,
		.height = window->record.height,
	};
	if (self->writer && gz_recording_add(self->writer, window->maker, &request, &window->record,
					     gz_clock_now_ns() - self->start_ns) != GZ_OK)
		end_session(window);
}

static void turn_session(struct gz_window *window)
{
	const struct gz_window_session *self = window->session;
	const int64_t now_s = (gz_clock_now_ns() - self->start_ns) / GZ_NS_PER_S;
	if (self->writer && now_s != self->drawn_s)
		window->present_needed = true;
}

static void draw_session_mark(struct gz_window *window, const struct gz_window_gaze *gaze)
{
	(void)gaze;
	struct gz_window_session *self = window->session;
	if (!self->writer)
		return;
	self->drawn_s = (gz_clock_now_ns() - self->start_ns) / GZ_NS_PER_S;
	gz_marks_draw_running(1, "session", true, self->drawn_s);
}

static double session_patience_s(const struct gz_window *window)
{
	return window->session->writer ? MARK_PATIENCE_S : INFINITY;
}

static void close_session(struct gz_window *window)
{
	end_session(window);
}

static bool is_session_on(const struct gz_window *window, int number)
{
	(void)number;
	return window->session->writer != NULL;
}

static const struct gz_window_action session_actions[] = {
	{ .key = GLFW_KEY_F9,
	  .keys = "F9",
	  .help = "start or stop a session, for --replay",
	  .name = "Record a session",
	  .menu = GZ_MENU_STUDY,
	  .words = "log replay",
	  .is_on = is_session_on,
	  .run = toggle_session },
};

const struct gz_window_part gz_window_session_part = {
	.name = "session",
	.title = "record",
	GZ_PART_ACTIONS(session_actions),
	GZ_PART_STATE(session),
	.open = open_session,
	.scene_shown = record_first_scene,
	.scene_leaving = leave_recorded_scene,
	.data_leaving = leave_recorded_data,
	.turn = turn_session,
	.gaze = record_gaze,
	.frame_made = record_frame,
	.panels = draw_session_mark,
	.patience_s = session_patience_s,
	.close = close_session,
};
