#include "view/window/capture.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include <GLFW/glfw3.h>

#include "view/capture/output.h"
#include "view/capture/video.h"
#include "view/panels/marks.h"
#include "view/window/read_back.h"
#include "view/window/window_state.h"

#define GZ_LOG_MODULE "video"

/* How often a video is brought up to date while nothing moves, s (chosen: the time shown runs, and
 * a long rest goes out in parts). */
#define VIDEO_PATIENCE_S 0.25

struct gz_window_capture_state {
	bool wanted; /* begins with the next picture drawn */
	bool ending; /* it is being finished */
	struct gz_video *video;
	char path[GZ_PATH_SIZE];
	int64_t start_ns;
	int64_t drawn_s; /* of the mark, as last drawn */
	struct gz_image image;
};

static enum gz_result open_part(struct gz_window *window)
{
	window->capture = calloc(1, sizeof *window->capture);
	return window->capture ? GZ_OK : GZ_ERR_NO_MEM;
}

/* The file is whole, or why it is not has been logged. */
static void close_video(struct gz_window *window)
{
	struct gz_window_capture_state *self = window->capture;
	if (!self->video)
		return;
	if (!self->ending)
		gz_video_finish(self->video, gz_clock_now_ns());
	const struct gz_video_status status = gz_video_status(self->video);
	const enum gz_result r = gz_video_close(&self->video);
	if (r == GZ_OK && status.dropped > 0)
		gz_warn(window->log,
			"%s written; %llu pictures came too quickly for ffmpeg, the ones before "
			"stand for them",
			self->path, (unsigned long long)status.dropped);
	else if (r == GZ_OK)
		gz_info(window->log, "%s written", self->path);
	self->ending = false;
	window->present_needed = true;
}

static void begin_video(struct gz_window *window)
{
	struct gz_window_capture_state *self = window->capture;
	enum gz_result r = gz_capture_name(window->options->pictures, ".mp4", self->path);
	const struct gz_video_params params = {
		.path = self->path,
		.width = self->image.width,
		.height = self->image.height,
		.fps = window->options->fps,
	};
	self->start_ns = gz_clock_now_ns();
	if (r == GZ_OK)
		r = gz_video_open(&params, window->log, &self->video);
	if (r == GZ_ERR_FULL || r == GZ_ERR_NO_MEM)
		gz_err(window->log, "no video: %s; see --pictures", gz_result_text(r));
}

static void toggle(struct gz_window *window, int number)
{
	(void)number;
	struct gz_window_capture_state *self = window->capture;
	window->present_needed = true;
	if (self->ending) {
		gz_warn(window->log, "%s is still being written; wait a moment", self->path);
	} else if (self->video) {
		gz_video_finish(self->video, gz_clock_now_ns());
		self->ending = true;
	} else if (window->maker) {
		self->wanted = true;
	} else {
		gz_warn(window->log, "no scene is shown to make a video of; open one");
	}
}

static void turn(struct gz_window *window)
{
	struct gz_window_capture_state *self = window->capture;
	if (!self->video)
		return;
	if (gz_video_status(self->video).over) {
		close_video(window);
	} else if (!self->ending) {
		(void)gz_video_pass(self->video, gz_clock_now_ns()); /* if it fails, it is over */
		const int64_t now_s = (gz_clock_now_ns() - self->start_ns) / GZ_NS_PER_S;
		window->present_needed = window->present_needed || now_s != self->drawn_s;
	}
}

static void paint(struct gz_window *window, int width, int height)
{
	struct gz_window_capture_state *self = window->capture;
	if (!self->wanted && (!self->video || self->ending))
		return;
	if (gz_window_read_back(width, height, &self->image) != GZ_OK)
		return;
	if (self->wanted)
		begin_video(window);
	self->wanted = false;
	if (self->video)
		(void)gz_video_show(self->video, &self->image, gz_clock_now_ns());
}

static void panels(struct gz_window *window, const struct gz_window_gaze *gaze)
{
	(void)gaze;
	struct gz_window_capture_state *self = window->capture;
	if (!self->video)
		return;
	self->drawn_s = (gz_clock_now_ns() - self->start_ns) / GZ_NS_PER_S;
	gz_marks_draw_running(0, self->ending ? "writing video" : "video", true, self->drawn_s);
}

static double patience_s(const struct gz_window *window)
{
	const struct gz_window_capture_state *self = window->capture;
	return self->video ? VIDEO_PATIENCE_S : INFINITY;
}

static void close_part(struct gz_window *window)
{
	if (window->capture) {
		close_video(window);
		gz_image_free(&window->capture->image);
	}
	free(window->capture);
	window->capture = NULL;
}

static const struct gz_window_action actions[] = {
	{ .key = GLFW_KEY_F10,
	  .keys = "F10",
	  .help = "begin or end a video of the picture",
	  .run = toggle },
};

const struct gz_window_part gz_window_capture = {
	.name = "capture",
	.title = "record",
	.actions = actions,
	.action_count = sizeof actions / sizeof actions[0],
	.open = open_part,
	.turn = turn,
	.paint = paint,
	.panels = panels,
	.patience_s = patience_s,
	.close = close_part,
};
