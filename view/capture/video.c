#include "view/capture/video.h"

#include <math.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>

#include "base/clock.h"
#include "view/capture/ffmpeg.h"

#define GZ_LOG_MODULE "video"

void gz_video_clock_start(struct gz_video_clock *clock, double fps, int64_t start_ns)
{
	*clock = (struct gz_video_clock) { .fps = fps, .start_ns = start_ns };
}

uint64_t gz_video_clock_pass(struct gz_video_clock *clock, int64_t time_ns)
{
	if (time_ns <= clock->start_ns)
		return 0;
	/* Dividing last keeps whole results exact: the time of picture k, rounded down to ns, does
	 * not exceed k. */
	const double elapsed_ns = (double)(time_ns - clock->start_ns);
	const double reached = ceil(elapsed_ns * clock->fps / (double)GZ_NS_PER_S);
	/* Chosen: beyond what a double counts exactly, the time is invalid. */
	if (!(reached < 0x1p53))
		return 0;
	const uint64_t count = (uint64_t)reached;
	const uint64_t due = count > clock->passed ? count - clock->passed : 0;
	clock->passed += due;
	return due;
}

static size_t row_bytes(const struct gz_image *image)
{
	return (size_t)image->width * 4;
}

static int scaled_side(int side, double scale)
{
	const int scaled = (int)lround(side * scale);
	return scaled > 0 ? scaled : 1;
}

static void blacken(struct gz_image *image)
{
	static const uint8_t black[4] = { 0, 0, 0, 255 };
	const size_t count = (size_t)image->width * (size_t)image->height;
	for (size_t i = 0; i < count; i++)
		memcpy(image->pixels + 4 * i, black, sizeof black);
}

/* The source is not larger than the target. */
static void place_in_middle(const struct gz_image *source, struct gz_image *target)
{
	const size_t left = (size_t)(target->width - source->width) / 2 * 4;
	const int top = (target->height - source->height) / 2;
	for (int y = 0; y < source->height; y++)
		memcpy(target->pixels + (size_t)(top + y) * row_bytes(target) + left,
		       source->pixels + (size_t)y * row_bytes(source), row_bytes(source));
}

enum gz_result gz_image_fit(struct gz_image_fit *fit, const struct gz_image *source,
			    struct gz_image *target)
{
	if (source->width == target->width && source->height == target->height) {
		memcpy(target->pixels, source->pixels, row_bytes(source) * (size_t)source->height);
		return GZ_OK;
	}
	const double scale = fmin((double)target->width / source->width,
				  (double)target->height / source->height);
	const int width = scaled_side(source->width, scale);
	const int height = scaled_side(source->height, scale);
	const enum gz_result r = gz_image_resize(&fit->scaled, width, height);
	if (r != GZ_OK)
		return r;
	gz_image_resample(source, &fit->scaled);
	blacken(target);
	place_in_middle(&fit->scaled, target);
	return GZ_OK;
}

void gz_image_fit_free(struct gz_image_fit *fit)
{
	gz_image_free(&fit->scaled);
}

/* A picture in the queue, and how often to write it. */
struct entry {
	struct gz_image image;
	uint64_t repeats;
};

struct gz_video {
	struct gz_ffmpeg *ffmpeg; /* used by the thread once it runs */
	pthread_t thread;
	double fps;
	bool wait;

	/* used by the caller only */
	struct gz_video_clock clock;
	struct gz_image_fit fit;
	struct gz_image shown; /* the last gz_video_show() */
	bool any_shown;
	bool handed; /* shown was put into the queue */
	bool missed; /* the queue was full when it was due */

	/* shared, protected by the mutex */
	pthread_mutex_t mutex;
	pthread_cond_t changed;
	struct entry queue[GZ_VIDEO_QUEUE];
	size_t first, count; /* the thread may be writing the first */
	bool ending;
	enum gz_result result;
	struct gz_video_status status;
};

/* Write an entry without holding the lock; the caller may add repeats meanwhile. */
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

static void release_video(struct gz_video *video)
{
	for (size_t i = 0; i < GZ_VIDEO_QUEUE; i++)
		gz_image_free(&video->queue[i].image);
	gz_image_free(&video->shown);
	gz_image_fit_free(&video->fit);
	pthread_cond_destroy(&video->changed);
	pthread_mutex_destroy(&video->mutex);
	free(video);
}

static enum gz_result start_video(struct gz_video *video, const struct gz_video_params *params,
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
	const enum gz_result r = start_video(video, params, log);
	if (r != GZ_OK) {
		release_video(video);
		return r;
	}
	*out_video = video;
	return GZ_OK;
}

/* If the queue is full, repeat the previous picture. The caller holds the lock. */
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

static enum gz_result queue_repeats(struct gz_video *video, uint64_t repeats)
{
	pthread_mutex_lock(&video->mutex);
	if (repeats > 0)
		queue_shown(video, repeats);
	const bool failed = video->status.failed;
	pthread_mutex_unlock(&video->mutex);
	return failed ? GZ_ERR_IO : GZ_OK;
}

/* Another picture follows: count the last one if it was never written. */
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
	return queue_repeats(video, gz_video_clock_pass(&video->clock, time_ns));
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
	(void)queue_repeats(video, repeats);
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
	release_video(self);
	return r;
}
