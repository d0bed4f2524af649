/**
 * @file
 * The distribution's ffmpeg as a child process that takes raw pictures and writes a video. One
 * thread at a time.
 */
#ifndef GZ_VIEW_CAPTURE_FFMPEG_H
#define GZ_VIEW_CAPTURE_FFMPEG_H

#include "base/log.h"
#include "base/result.h"
#include "render/picture/image.h"

/** A running ffmpeg. */
struct gz_ffmpeg;

/** What it is to write. */
struct gz_ffmpeg_params {
	const char *path;  /**< of the video; its ending chooses the kind, see gz_ffmpeg_start() */
	int width, height; /**< of every picture, px */
	double fps;        /**< pictures a second, above 0 */
};

/**
 * Start it. A file of that name is written over.
 *
 * .mp4, .m4v, .mov and .mkv become H.264 with 4:2:0 chroma, which every player shows, .webm VP9;
 * any other ending is left to ffmpeg. Sides of an odd number of pixels, which 4:2:0 has not, get a
 * black column or row more. Colours are marked as BT.709, which they are converted by.
 *
 * @param[out] out_ffmpeg  owned by the caller: gz_ffmpeg_end()
 * @retval GZ_ERR_NOT_FOUND  there is no ffmpeg on the PATH; logged with the remedy
 * @retval GZ_ERR_IO         it cannot be started; logged
 * @retval GZ_ERR_NO_MEM     no room
 */
enum gz_result gz_ffmpeg_start(const struct gz_ffmpeg_params *params, const struct gz_log *log,
			       struct gz_ffmpeg **out_ffmpeg);

/**
 * Hand over a picture; waits until ffmpeg has taken it.
 *
 * @param image  of the size that was said
 * @retval GZ_ERR_INVAL  it is not
 * @retval GZ_ERR_IO     ffmpeg has ended; why, gz_ffmpeg_end() logs
 */
enum gz_result gz_ffmpeg_write(struct gz_ffmpeg *ffmpeg, const struct gz_image *image);

/**
 * Let it finish the file, wait for that, free and set to NULL. Accepts a pointer to NULL: GZ_OK.
 *
 * @retval GZ_ERR_IO  it failed; logged with its last words
 */
enum gz_result gz_ffmpeg_end(struct gz_ffmpeg **ffmpeg);

#endif
