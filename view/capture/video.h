/**
 * @file
 * A video being recorded: pictures with their times go in, a file with an even rate comes out, made
 * by ffmpeg on a thread of its own.
 */
#ifndef GZ_VIEW_CAPTURE_VIDEO_H
#define GZ_VIEW_CAPTURE_VIDEO_H

#include <stdbool.h>
#include <stdint.h>

#include "base/log.h"
#include "base/result.h"
#include "render/picture/image.h"

/** Pictures that wait for ffmpeg at most. Chosen: a third of a second at 24 a second, 64 MiB at
 * 1920x1080. */
#define GZ_VIDEO_QUEUE 8

/** A video. One thread, but for what stands beside a function. */
struct gz_video;

/** What it is to be. */
struct gz_video_params {
	const char *path;  /**< its ending chooses the kind: gz_ffmpeg_start() */
	int width, height; /**< px; pictures of another size are made to fit: gz_image_fit() */
	double fps;        /**< above 0 */
	bool wait;         /**< where there is no room for a picture, wait; else it is dropped */
};

/** How it goes. */
struct gz_video_status {
	uint64_t written; /**< pictures of the video that ffmpeg has taken */
	uint64_t dropped; /**< pictures shown that it had no time for; the one before stands longer
			   */
	bool failed; /**< ffmpeg has ended or will fail; why is logged, at the latest in the end */
	bool over;   /**< the thread has ended: gz_video_close() does not wait */
};

/**
 * Start ffmpeg.
 *
 * @param log  borrowed, outlives the video; told from the video's thread too
 * @param[out] out_video  owned by the caller: gz_video_close()
 * @retval GZ_ERR_NOT_FOUND, GZ_ERR_IO  as gz_ffmpeg_start(); logged
 * @retval GZ_ERR_NO_MEM  no room, or no thread
 */
enum gz_result gz_video_open(const struct gz_video_params *params, const struct gz_log *log,
			     struct gz_video **out_video);

/**
 * From @p time_ns on this picture is shown: the first begins the video, and what was shown before
 * fills it up to now. Of several within one picture of the video the last counts.
 *
 * @param image    copied
 * @param time_ns  from any origin; a time before the last one counts as the last
 * @retval GZ_ERR_IO      the video has failed
 * @retval GZ_ERR_NO_MEM  no room
 */
enum gz_result gz_video_show(struct gz_video *video, const struct gz_image *image, int64_t time_ns);

/** What is shown stays until @p time_ns: a picture that stands for long goes out bit by bit.
 * @return as gz_video_show() */
enum gz_result gz_video_pass(struct gz_video *video, int64_t time_ns);

/** As gz_video_pass(), and nothing follows: at least one picture is in the video. The file becomes
 * whole while the caller goes on; gz_video_status tells when. */
void gz_video_finish(struct gz_video *video, int64_t time_ns);

/** How it goes. */
struct gz_video_status gz_video_status(struct gz_video *video);

/**
 * Finish it, wait until the file is whole, free and set to NULL. Accepts a pointer to NULL: GZ_OK.
 *
 * @retval GZ_ERR_IO  it has failed; logged
 */
enum gz_result gz_video_close(struct gz_video **video);

/** Picture k of the video shows what was shown at start_ns + k / fps. */
struct gz_video_clock {
	double fps; /**< above 0 */
	int64_t start_ns;
	uint64_t passed; /**< pictures that gz_video_clock_pass() has counted so far */
};

/** Start at @p start_ns. */
void gz_video_clock_start(struct gz_video_clock *clock, double fps, int64_t start_ns);

/**
 * What was shown last has been shown until @p time_ns.
 *
 * @return how many pictures of the video show it: those before @p time_ns that none has shown yet
 */
uint64_t gz_video_clock_pass(struct gz_video_clock *clock, int64_t time_ns);

/** Room for gz_image_fit(), kept from picture to picture; zero-initialised is empty. */
struct gz_image_fit {
	struct gz_image scaled;
};

/**
 * Copy @p source into @p target, whose size stays: as it is where the sizes are the same, else
 * scaled as far as it fits, its shape kept, in the middle of black.
 *
 * @retval GZ_ERR_NO_MEM  no room
 */
enum gz_result gz_image_fit(struct gz_image_fit *fit, const struct gz_image *source,
			    struct gz_image *target);

/** Free what it holds and zero it. */
void gz_image_fit_free(struct gz_image_fit *fit);

#endif
