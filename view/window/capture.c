/* The part that writes pictures and videos: F12 and F10. */
#include <math.h>
#include <pthread.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <GLFW/glfw3.h>

#include "render/scene/scene_picture.h"
#include "view/capture/output.h"
#include "view/capture/video.h"
#include "view/panels/marks.h"
#include "view/window/capture.h"
#include "view/window/loading.h"
#include "view/window/window_state.h"

#define GZ_LOG_MODULE "capture"

/* Interval of updating a video while nothing changes, s (chosen: the time shown runs, and a long
 * rest is written in parts). */
#define VIDEO_PATIENCE_S 0.25

/* A picture alone, or with all that lies over it. */
enum picture_kind { NOTHING, PICTURE, WITH_PANELS };

/* Interval of asking whether a picture has been written, s (chosen: reported soon). */
#define WRITTEN_PATIENCE_S 0.1

/* A picture that is written on a thread, as compressing takes longer than a frame. */
struct picture_job {
	pthread_t thread;
	const struct gz_log *log;
	struct gz_image image;
	char path[GZ_PATH_SIZE];
	bool has_scene;
	char scene_path[GZ_PATH_SIZE];
	struct gz_scene_saved saved; /* points to the next ones */
	struct gz_scene_settings settings;
	struct gz_transfer transfer;
	const struct gz_volume *volume; /* of the scene, which outlives the job */
	enum gz_result result;
	atomic_bool over;
};

struct video_capture {
	bool wanted; /* begins with the next picture drawn */
	bool ending; /* it is being finished */
	struct gz_video *video;
	char path[GZ_PATH_SIZE];
	int64_t start_ns;
	int64_t drawn_s; /* time in the mark, as last drawn */
	struct gz_image image;
};

struct gz_window_capture {
	struct video_capture video;
	enum picture_kind picture_wanted;
	struct picture_job *picture; /* being written; NULL: none */
};

/* ---- videos ---- */

/* Finish the file; failures are logged. */
static void close_video(struct gz_window *window)
{
	struct video_capture *self = &window->capture->video;
	if (!self->video)
		return;
	if (!self->ending)
		gz_video_finish(self->video, gz_clock_now_ns());
	const struct gz_video_status status = gz_video_status(self->video);
	const enum gz_result r = gz_video_close(&self->video);
	if (r == GZ_OK && status.dropped > 0)
		gz_warn(window->log,
			"%s written; %llu frames were dropped, as ffmpeg was too slow; the "
			"previous "
			"frame was repeated",
			self->path, (unsigned long long)status.dropped);
	else if (r == GZ_OK)
		gz_info(window->log, "%s written", self->path);
	self->ending = false;
	window->present_needed = true;
}

static void begin_video(struct gz_window *window)
{
	struct video_capture *self = &window->capture->video;
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

static void toggle_video(struct gz_window *window, int number)
{
	(void)number;
	struct video_capture *self = &window->capture->video;
	window->present_needed = true;
	if (self->ending) {
		gz_warn(window->log, "%s is still being written; wait a moment", self->path);
	} else if (self->video) {
		gz_video_finish(self->video, gz_clock_now_ns());
		self->ending = true;
	} else if (window->maker) {
		self->wanted = true;
	} else {
		gz_warn(window->log, "no scene is shown; open one to record a video");
	}
}

static void turn_video(struct gz_window *window)
{
	struct video_capture *self = &window->capture->video;
	if (!self->video)
		return;
	if (gz_video_status(self->video).over) {
		close_video(window);
	} else if (!self->ending) {
		(void)gz_video_pass(self->video, gz_clock_now_ns()); /* a failure ends it */
		const int64_t now_s = (gz_clock_now_ns() - self->start_ns) / GZ_NS_PER_S;
		window->present_needed = window->present_needed || now_s != self->drawn_s;
	}
}

static void paint_video(struct gz_window *window, int width, int height)
{
	struct video_capture *self = &window->capture->video;
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

static void draw_capture_mark(struct gz_window *window, const struct gz_window_gaze *gaze)
{
	(void)gaze;
	struct video_capture *self = &window->capture->video;
	if (!self->video)
		return;
	self->drawn_s = (gz_clock_now_ns() - self->start_ns) / GZ_NS_PER_S;
	gz_marks_draw_running(0, self->ending ? "writing video" : "video", true, self->drawn_s);
}

static double video_patience_s(const struct gz_window *window)
{
	const struct video_capture *self = &window->capture->video;
	return self->video ? VIDEO_PATIENCE_S : INFINITY;
}

/* ---- pictures ---- */

static void *write_captured_picture(void *argument)
{
	struct picture_job *job = argument;
	job->result = job->has_scene
			      ? gz_scene_picture_write(&job->image, &job->saved, &job->transfer,
						       job->volume, job->path, job->log)
			      : gz_image_write_png(&job->image, job->path, job->log);
	atomic_store(&job->over, true);
	return NULL;
}

/* Wait for the picture that is being written, and log its path. */
static void finish_picture(struct gz_window_capture *self)
{
	struct picture_job *job = self->picture;
	if (!job)
		return;
	pthread_join(job->thread, NULL);
	if (job->result == GZ_OK)
		gz_info(job->log, "%s written", job->path);
	gz_image_free(&job->image);
	free(job);
	self->picture = NULL;
}

static void add_captured_scene(const struct gz_window *window,
			       const struct gz_scene_settings *settings, struct picture_job *job)
{
	const struct gz_scene *scene = gz_frame_maker_scene(window->maker);
	job->has_scene = true;
	memcpy(&job->settings, settings, sizeof job->settings);
	gz_window_drop_run_settings(window, &job->settings.view);
	memcpy(&job->transfer, &scene->transfer, sizeof job->transfer);
	job->volume = &scene->volume;
	snprintf(job->scene_path, sizeof job->scene_path, "%s", gz_window_scene_path(window));
	job->saved = (struct gz_scene_saved) {
		.settings = &job->settings,
		.has_display = scene->has_display,
		.path = job->scene_path,
	};
}

static enum gz_result start_picture_job(struct gz_window *window, struct picture_job *job,
					const struct gz_scene_settings *settings)
{
	const enum gz_result r = gz_capture_name(window->options->pictures, ".png", job->path);
	if (r != GZ_OK)
		return r;
	if (settings)
		add_captured_scene(window, settings, job);
	return pthread_create(&job->thread, NULL, write_captured_picture, job) == 0 ? GZ_OK
										    : GZ_ERR_NO_MEM;
}

/* settings NULL: the picture has no scene. */
static void write_picture(struct gz_window *window, struct gz_image *image,
			  const struct gz_scene_settings *settings)
{
	struct gz_window_capture *self = window->capture;
	finish_picture(self);
	struct picture_job *job = calloc(1, sizeof *job);
	enum gz_result r = GZ_ERR_NO_MEM;
	if (job) {
		job->log = window->log;
		job->image = *image;
		*image = (struct gz_image) { 0 };
		r = start_picture_job(window, job, settings);
	}
	if (r == GZ_OK) {
		self->picture = job;
		return;
	}
	gz_err(window->log, "no picture: %s; see --pictures", gz_result_text(r));
	if (job)
		gz_image_free(&job->image);
	free(job);
}

void gz_window_write_picture(struct gz_window *window, struct gz_image *image,
			     const struct gz_scene_settings *settings)
{
	write_picture(window, image, settings);
}

static void take_picture(struct gz_window *window, int width, int height)
{
	struct gz_image image = { 0 };
	window->capture->picture_wanted = NOTHING;
	const enum gz_result r = gz_window_read_back(width, height, &image);
	if (r == GZ_OK)
		write_picture(window, &image,
			      window->maker && window->any_shown ? &window->made : NULL);
	else
		gz_err(window->log, "no picture: %s", gz_result_text(r));
	gz_image_free(&image);
}

static void paint_picture(struct gz_window *window, int width, int height)
{
	if (window->capture->picture_wanted == PICTURE)
		take_picture(window, width, height);
}

bool gz_window_reads_picture(const struct gz_window *window)
{
	const struct gz_window_capture *self = window->capture;
	return self->video.video || self->video.wanted || self->picture_wanted == PICTURE;
}

static void take_screen(struct gz_window *window, int width, int height)
{
	if (window->capture->picture_wanted == WITH_PANELS)
		take_picture(window, width, height);
}

static void want_picture(struct gz_window *window, int kind)
{
	window->capture->picture_wanted = (enum picture_kind)kind;
	window->present_needed = true;
}

void gz_window_write_shown(struct gz_window *window)
{
	want_picture(window, PICTURE);
}

static void turn_picture(struct gz_window *window)
{
	struct picture_job *job = window->capture->picture;
	if (job && atomic_load(&job->over))
		finish_picture(window->capture);
}

static double picture_patience_s(const struct gz_window *window)
{
	return window->capture->picture ? WRITTEN_PATIENCE_S : INFINITY;
}

static void leave_pictured_scene(struct gz_window *window)
{
	finish_picture(window->capture);
}

static bool leave_pictured_data(struct gz_window *window)
{
	finish_picture(window->capture);
	return true;
}

/* ---- the part ---- */

static void turn_capture(struct gz_window *window)
{
	turn_video(window);
	turn_picture(window);
}

static void paint_capture(struct gz_window *window, int width, int height)
{
	paint_video(window, width, height);
	paint_picture(window, width, height);
}

static double capture_patience_s(const struct gz_window *window)
{
	return fmin(video_patience_s(window), picture_patience_s(window));
}

static void close_capture(struct gz_window *window)
{
	close_video(window);
	gz_image_free(&window->capture->video.image);
	finish_picture(window->capture);
}

static bool is_video_on(const struct gz_window *window, int number)
{
	(void)number;
	return window->capture->video.video != NULL;
}

static const struct gz_window_action capture_actions[] = {
	{ .key = GLFW_KEY_F10,
	  .keys = "F10",
	  .help = "start or stop a video of the picture",
	  .name = "Video",
	  .menu = GZ_MENU_FILE,
	  .section = 2,
	  .words = "movie film record mp4 capture",
	  .is_on = is_video_on,
	  .run = toggle_video },
	{ .key = GLFW_KEY_F12,
	  .modifiers = GZ_KEY_CONTROL,
	  .number = PICTURE,
	  .keys = "Ctrl+F12",
	  .help = "save the picture as it is shown, with its scene",
	  .name = "Save picture as shown",
	  .menu = GZ_MENU_FILE,
	  .section = 2,
	  .words = "screenshot image png export capture foveated",
	  .run = want_picture },
	{ .key = GLFW_KEY_F12,
	  .modifiers = GZ_KEY_SHIFT,
	  .number = WITH_PANELS,
	  .keys = "Shift+F12",
	  .help = "save the whole window as a picture",
	  .name = "Save window as picture",
	  .menu = GZ_MENU_FILE,
	  .section = 2,
	  .words = "screenshot image png panels capture",
	  .run = want_picture },
};

const struct gz_window_part gz_window_capture_part = {
	.name = "capture",
	.title = "record",
	GZ_PART_ACTIONS(capture_actions),
	GZ_PART_STATE(capture),
	.scene_leaving = leave_pictured_scene,
	.data_leaving = leave_pictured_data,
	.turn = turn_capture,
	.paint = paint_capture,
	.panels = draw_capture_mark,
	.drawn = take_screen,
	.patience_s = capture_patience_s,
	.close = close_capture,
};
