#include "view/capture/video.h"

#include <pthread.h>
#include <stdlib.h>
#include <string.h>

#include "view/capture/ffmpeg.h"
#include "view/capture/fit.h"
#include "view/capture/video_clock.h"

#define GZ_LOG_MODULE "video"

/* A picture that waits, and how often it stands in the video. */
struct entry {
	struct gz_image image;
	uint64_t repeats;
};

struct gz_video {
	struct gz_ffmpeg *ffmpeg; /* the thread's, once that runs */
	pthread_t thread;
	double fps;
	bool wait;

	/* the caller's alone */
	struct gz_video_clock clock;
	struct gz_image_fit fit;
	struct gz_image shown; /* since the newest gz_video_show() */
	bool any_shown;
	bool handed; /* shown is the queue's newest, or was before that ran empty */
	bool missed; /* there was no room for it when its time came */

	/* shared */
	pthread_mutex_t mutex;
	pthread_cond_t changed;
	struct entry queue[GZ_VIDEO_QUEUE];
	size_t first, count; /* the first is being written while the thread is busy */
	bool ending;
	enum gz_result result;
	struct gz_video_status status;
};

/* Up to the whole of an entry, without the lock; more repeats may be added to it meanwhile. */
static enum gz_result write_entry(struct gz_video *video, const struct entry *entry)
{
	enum gz_result r = GZ_OK;
	while (r == GZ_OK && entry->repeats > 0) {
		const struct gz_image *image = &entry->image;
		pthread_mutex_unlock(&video->mutex);
		r = gz_ffmpeg_write(video->ffmpeg, image);
		pthread_mutex_lock(&video->mutex);
		video->queue[video->first].repeats--;
		video->status.written += r == GZ_OK;
	}
	return r;
}

static void *write_queue(void *argument)
{
	struct gz_video *video = argument;
	enum gz_result r = GZ_OK;
	pthread_mutex_lock(&video->mutex);
	for (;;) {
		while (r == GZ_OK && video->count == 0 && !video->ending)
			pthread_cond_wait(&video->changed, &video->mutex);
		if (video->count == 0 || r != GZ_OK)
			break;
		r = write_entry(video, &video->queue[video->first]);
		video->first = (video->first + 1) % GZ_VIDEO_QUEUE;
		video->count--;
		video->status.failed = r != GZ_OK;
		pthread_cond_broadcast(&video->changed);
	}
	pthread_mutex_unlock(&video->mutex);
	r = gz_ffmpeg_end(&video->ffmpeg);
	pthread_mutex_lock(&video->mutex);
	video->result = r;
	video->status.failed = r != GZ_OK;
	video->status.over = true;
	pthread_cond_broadcast(&video->changed);
	pthread_mutex_unlock(&video->mutex);
	return NULL;
}

static void release(struct gz_video *video)
{
	for (size_t i = 0; i < GZ_VIDEO_QUEUE; i++)
		gz_image_free(&video->queue[i].image);
	gz_image_free(&video->shown);
	gz_image_fit_free(&video->fit);
	pthread_cond_destroy(&video->changed);
	pthread_mutex_destroy(&video->mutex);
	free(video);
}

static enum gz_result start(struct gz_video *video, const struct gz_video_params *params,
			    const struct gz_log *log)
{
	const struct gz_ffmpeg_params ffmpeg = {
		.path = params->path,
		.width = params->width,
		.height = params->height,
		.fps = params->fps,
	};
	enum gz_result r = gz_image_resize(&video->shown, params->width, params->height);
	for (size_t i = 0; i < GZ_VIDEO_QUEUE && r == GZ_OK; i++)
		r = gz_image_resize(&video->queue[i].image, params->width, params->height);
	if (r == GZ_OK)
		r = gz_ffmpeg_start(&ffmpeg, log, &video->ffmpeg);
	if (r == GZ_OK && pthread_create(&video->thread, NULL, write_queue, video) != 0) {
		gz_ffmpeg_end(&video->ffmpeg);
		r = GZ_ERR_NO_MEM;
	}
	return r;
}

enum gz_result gz_video_open(const struct gz_video_params *params, const struct gz_log *log,
			     struct gz_video **out_video)
{
	struct gz_video *video = calloc(1, sizeof *video);
	if (!video)
		return GZ_ERR_NO_MEM;
	video->fps = params->fps;
	video->wait = params->wait;
	pthread_mutex_init(&video->mutex, NULL);
	pthread_cond_init(&video->changed, NULL);
	const enum gz_result r = start(video, params, log);
	if (r != GZ_OK) {
		release(video);
		return r;
	}
	*out_video = video;
	return GZ_OK;
}

/* Without room, the picture before stands for this one too. Under the lock. */
static void queue_shown(struct gz_video *video, uint64_t repeats)
{
	while (video->wait && !video->handed && video->count == GZ_VIDEO_QUEUE &&
	       !video->status.over)
		pthread_cond_wait(&video->changed, &video->mutex);
	if (video->status.failed || video->status.over)
		return;
	const size_t end = video->first + video->count;
	if (video->count == GZ_VIDEO_QUEUE || (video->count > 0 && video->handed)) {
		video->queue[(end - 1) % GZ_VIDEO_QUEUE].repeats += repeats;
		video->missed = !video->handed;
		return;
	}
	struct entry *entry = &video->queue[end % GZ_VIDEO_QUEUE];
	memcpy(entry->image.pixels, video->shown.pixels,
	       (size_t)video->shown.width * (size_t)video->shown.height * 4);
	entry->repeats = repeats;
	video->count++;
	video->handed = true;
	pthread_cond_broadcast(&video->changed);
}

static enum gz_result hand_over(struct gz_video *video, uint64_t repeats)
{
	pthread_mutex_lock(&video->mutex);
	if (repeats > 0)
		queue_shown(video, repeats);
	const bool failed = video->status.failed;
	pthread_mutex_unlock(&video->mutex);
	return failed ? GZ_ERR_IO : GZ_OK;
}

/* What was shown gives way to something else; whether it ever came into the video. */
static void count_dropped(struct gz_video *video)
{
	pthread_mutex_lock(&video->mutex);
	video->status.dropped += video->missed && !video->handed;
	pthread_mutex_unlock(&video->mutex);
	video->missed = video->handed = false;
}

enum gz_result gz_video_pass(struct gz_video *video, int64_t time_ns)
{
	if (!video->any_shown)
		return GZ_OK;
	return hand_over(video, gz_video_clock_pass(&video->clock, time_ns));
}

enum gz_result gz_video_show(struct gz_video *video, const struct gz_image *image, int64_t time_ns)
{
	if (!video->any_shown)
		gz_video_clock_start(&video->clock, video->fps, time_ns);
	enum gz_result r = gz_video_pass(video, time_ns);
	if (r == GZ_OK)
		r = gz_image_fit(&video->fit, image, &video->shown);
	if (r != GZ_OK)
		return r;
	count_dropped(video);
	video->any_shown = true;
	return GZ_OK;
}

void gz_video_finish(struct gz_video *video, int64_t time_ns)
{
	uint64_t repeats = video->any_shown ? gz_video_clock_pass(&video->clock, time_ns) : 0;
	if (video->any_shown && video->clock.passed == 0)
		repeats = 1;
	(void)hand_over(video, repeats);
	count_dropped(video);
	video->any_shown = false;
	pthread_mutex_lock(&video->mutex);
	video->ending = true;
	pthread_cond_broadcast(&video->changed);
	pthread_mutex_unlock(&video->mutex);
}

struct gz_video_status gz_video_status(struct gz_video *video)
{
	pthread_mutex_lock(&video->mutex);
	const struct gz_video_status status = video->status;
	pthread_mutex_unlock(&video->mutex);
	return status;
}

enum gz_result gz_video_close(struct gz_video **video)
{
	struct gz_video *self = *video;
	*video = NULL;
	if (!self)
		return GZ_OK;
	gz_video_finish(self, INT64_MIN);
	pthread_join(self->thread, NULL);
	const enum gz_result r = self->result;
	release(self);
	return r;
}
