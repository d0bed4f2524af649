/**
 * @file
 * Records a video: takes pictures at any times and writes them at an even rate, through ffmpeg on a
 * thread of its own.
 */
#ifndef GZ_VIEW_CAPTURE_VIDEO_H
#define GZ_VIEW_CAPTURE_VIDEO_H

#include <stdbool.h>
#include <stdint.h>

#include "base/log.h"
#include "base/result.h"
#include "render/picture/image.h"

/** Largest number of pictures waiting for ffmpeg. Chosen: a third of a second at 24 a second, 64
 * MiB at 1920x1080. */
#define GZ_VIDEO_QUEUE 8

/** A video being recorded. Its functions are for one thread. */
struct gz_video;

/** What to record. */
struct gz_video_params {
	const char *path;  /**< the ending chooses the format: gz_ffmpeg_start() */
	int width, height; /**< px; other pictures are scaled: gz_image_fit() */
	double fps;        /**< above 0 */
	bool wait;         /**< if the queue is full, wait; otherwise drop the picture */
};

/** State of a video. */
struct gz_video_status {
	uint64_t written; /**< pictures that ffmpeg has read */
	uint64_t dropped; /**< pictures shown but not written; the previous one was repeated */
	bool failed;      /**< ffmpeg has failed; logged when the video ends at the latest */
	bool over;        /**< the thread has ended: gz_video_close() does not block */
};

/**
 * Start ffmpeg and the thread.
 *
 * @param log  borrowed, outlives the video; also used from the video's thread
 * @param[out] out_video  the caller closes it with gz_video_close()
 * @retval GZ_ERR_NOT_FOUND, GZ_ERR_IO  from gz_ffmpeg_start(); logged
 * @retval GZ_ERR_NO_MEM  out of memory, or no thread
 */
enum gz_result gz_video_open(const struct gz_video_params *params, const struct gz_log *log,
			     struct gz_video **out_video);

/**
 * Show a picture from @p time_ns on. The first call starts the video; later ones fill it up to
 * @p time_ns with the previous picture. Of several pictures within one frame of the video the last
 * is written.
 *
 * @param image    copied
 * @param time_ns  from any origin; an earlier time than the previous one counts as that
 * @retval GZ_ERR_IO      the video has failed
 * @retval GZ_ERR_NO_MEM  out of memory
 */
enum gz_result gz_video_show(struct gz_video *video, const struct gz_image *image, int64_t time_ns);

/** Fill the video up to @p time_ns with the current picture, so that a picture shown for long is
 * written bit by bit. Results as for gz_video_show(). */
enum gz_result gz_video_pass(struct gz_video *video, int64_t time_ns);

/** Fill the video up to @p time_ns and end it; it has at least one picture. The thread completes
 * the file in the background: gz_video_status() tells when. */
void gz_video_finish(struct gz_video *video, int64_t time_ns);

/** The state of the video. */
struct gz_video_status gz_video_status(struct gz_video *video);

/**
 * End the video, wait until the file is complete, free and set the pointer to NULL. Accepts a
 * pointer to NULL: GZ_OK.
 *
 * @retval GZ_ERR_IO  the video has failed; logged
 */
enum gz_result gz_video_close(struct gz_video **video);

/** Converts uneven times of pictures shown to even ones of the video. Picture k of the video shows
 * what was shown at start_ns + k / fps. Pure. */
struct gz_video_clock {
	double fps; /**< above 0 */
	int64_t start_ns;
	uint64_t passed; /**< pictures counted by gz_video_clock_pass() so far */
};

/** Start the clock at @p start_ns. */
void gz_video_clock_start(struct gz_video_clock *clock, double fps, int64_t start_ns);

/** The number of pictures of the video before @p time_ns that were not counted yet: they show the
 * current picture. */
uint64_t gz_video_clock_pass(struct gz_video_clock *clock, int64_t time_ns);

/** Memory of gz_image_fit(), reused from call to call. Zero-initialised: empty. */
struct gz_image_fit {
	struct gz_image scaled;
};

/**
 * Copy @p source into @p target, whose size stays. A source of another size is scaled to fit, with
 * its aspect ratio kept, and centred on black.
 *
 * @retval GZ_ERR_NO_MEM  out of memory
 */
enum gz_result gz_image_fit(struct gz_image_fit *fit, const struct gz_image *source,
			    struct gz_image *target);

/** Free the memory and zero @p fit. */
void gz_image_fit_free(struct gz_image_fit *fit);

#endif
