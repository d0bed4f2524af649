#include "view/window/screenshots.h"

#include <math.h>
#include <pthread.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <GLFW/glfw3.h>

#include "render/scene/scene_picture.h"
#include "view/capture/output.h"
#include "view/window/loading.h"
#include "view/window/read_back.h"
#include "view/window/window_state.h"

#define GZ_LOG_MODULE "screenshot"

/* A picture is wanted as it is, or with what lies over it. */
enum what { NOTHING, PICTURE, WITH_PANELS };

/* How often the window looks whether one has been written, s (chosen: it is told soon, and nobody
 * waits for it). */
#define WRITTEN_PATIENCE_S 0.1

/* A picture being written, on a thread: compressing takes longer than a frame. */
struct job {
	pthread_t thread;
	const struct gz_log *log;
	struct gz_image image;
	char path[GZ_PATH_SIZE];
	bool has_scene;
	char scene_path[GZ_PATH_SIZE];
	struct gz_scene_saved saved; /* over the next ones */
	struct gz_scene_settings settings;
	struct gz_transfer transfer;
	const struct gz_volume *volume; /* the scene's: the job ends before that does */
	enum gz_result result;
	atomic_bool over;
};

struct gz_window_screenshots_state {
	enum what wanted;
	struct job *job; /* NULL: none */
};

static enum gz_result open_part(struct gz_window *window)
{
	window->screenshots = calloc(1, sizeof *window->screenshots);
	return window->screenshots ? GZ_OK : GZ_ERR_NO_MEM;
}

static void *write_picture(void *argument)
{
	struct job *job = argument;
	job->result = job->has_scene
			      ? gz_scene_picture_write(&job->image, &job->saved, &job->transfer,
						       job->volume, job->path, job->log)
			      : gz_image_write_png(&job->image, job->path, job->log);
	atomic_store(&job->over, true);
	return NULL;
}

/* Wait for the picture that is being written, and say where it is. */
static void finish(struct gz_window_screenshots_state *self)
{
	struct job *job = self->job;
	if (!job)
		return;
	pthread_join(job->thread, NULL);
	if (job->result == GZ_OK)
		gz_info(job->log, "%s written", job->path);
	gz_image_free(&job->image);
	free(job);
	self->job = NULL;
}

static void describe_scene(const struct gz_window *window, struct job *job)
{
	const struct gz_scene *scene = gz_frame_maker_scene(window->maker);
	job->has_scene = true;
	memcpy(&job->settings, &window->shown, sizeof job->settings);
	memcpy(&job->transfer, &scene->transfer, sizeof job->transfer);
	job->volume = &scene->volume;
	snprintf(job->scene_path, sizeof job->scene_path, "%s", gz_window_scene_path(window));
	job->saved = (struct gz_scene_saved) {
		.settings = &job->settings,
		.has_display = scene->has_display,
		.path = job->scene_path,
	};
}

static enum gz_result start_job(struct gz_window *window, struct job *job, int width, int height)
{
	enum gz_result r = gz_capture_name(window->options->pictures, ".png", job->path);
	if (r == GZ_OK)
		r = gz_window_read_back(width, height, &job->image);
	if (r != GZ_OK)
		return r;
	if (window->maker && window->any_shown)
		describe_scene(window, job);
	return pthread_create(&job->thread, NULL, write_picture, job) == 0 ? GZ_OK : GZ_ERR_NO_MEM;
}

static void take(struct gz_window *window, int width, int height)
{
	struct gz_window_screenshots_state *self = window->screenshots;
	self->wanted = NOTHING;
	finish(self);
	struct job *job = calloc(1, sizeof *job);
	enum gz_result r = GZ_ERR_NO_MEM;
	if (job) {
		job->log = window->log;
		r = start_job(window, job, width, height);
	}
	if (r == GZ_OK) {
		self->job = job;
		return;
	}
	gz_err(window->log, "no picture: %s; see --pictures", gz_result_text(r));
	if (job)
		gz_image_free(&job->image);
	free(job);
}

static void paint(struct gz_window *window, int width, int height)
{
	if (window->screenshots->wanted == PICTURE)
		take(window, width, height);
}

static void drawn(struct gz_window *window, int width, int height)
{
	if (window->screenshots->wanted == WITH_PANELS)
		take(window, width, height);
}

static void want(struct gz_window *window, int what)
{
	window->screenshots->wanted = (enum what)what;
	window->present_needed = true;
}

static void turn(struct gz_window *window)
{
	struct job *job = window->screenshots->job;
	if (job && atomic_load(&job->over))
		finish(window->screenshots);
}

static double patience_s(const struct gz_window *window)
{
	return window->screenshots->job ? WRITTEN_PATIENCE_S : INFINITY;
}

static void scene_leaving(struct gz_window *window)
{
	finish(window->screenshots);
}

static void close_part(struct gz_window *window)
{
	if (window->screenshots)
		finish(window->screenshots);
	free(window->screenshots);
	window->screenshots = NULL;
}

static const struct gz_window_action actions[] = {
	{ .key = GLFW_KEY_F12,
	  .number = PICTURE,
	  .keys = "F12",
	  .help = "write the picture, with its scene in it",
	  .run = want },
	{ .key = GLFW_KEY_F12,
	  .modifiers = GZ_KEY_SHIFT,
	  .number = WITH_PANELS,
	  .keys = "Shift+F12",
	  .help = "write what is on the screen",
	  .run = want },
};

const struct gz_window_part gz_window_screenshots = {
	.name = "screenshots",
	.title = "record",
	.actions = actions,
	.action_count = sizeof actions / sizeof actions[0],
	.open = open_part,
	.scene_leaving = scene_leaving,
	.turn = turn,
	.paint = paint,
	.drawn = drawn,
	.patience_s = patience_s,
	.close = close_part,
};
