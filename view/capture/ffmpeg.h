/**
 * @file
 * The system's ffmpeg as a child process that reads raw pictures from a pipe and writes a video.
 * One thread at a time.
 */
#ifndef GZ_VIEW_CAPTURE_FFMPEG_H
#define GZ_VIEW_CAPTURE_FFMPEG_H

#include "base/log.h"
#include "base/result.h"
#include "render/picture/image.h"

/** A running ffmpeg. */
struct gz_ffmpeg;

/** What ffmpeg writes. */
struct gz_ffmpeg_params {
	const char *path;  /**< of the video; the ending chooses the format: gz_ffmpeg_start() */
	int width, height; /**< of each picture, px */
	double fps;        /**< pictures per second, above 0 */
};

/**
 * Start ffmpeg. An existing file is replaced.
 *
 * .mp4, .m4v, .mov and .mkv become H.264 with 4:2:0 chroma, which all players support; .webm
 * becomes VP9; ffmpeg decides about other endings. 4:2:0 needs even sides: odd ones get a black
 * column or row. Colours are converted to BT.709 and marked as such.
 *
 * @param[out] out_ffmpeg  the caller ends it with gz_ffmpeg_end()
 * @retval GZ_ERR_NOT_FOUND  no ffmpeg on the PATH; logged with the remedy
 * @retval GZ_ERR_IO         ffmpeg cannot be started; logged
 * @retval GZ_ERR_NO_MEM     out of memory
 */
enum gz_result gz_ffmpeg_start(const struct gz_ffmpeg_params *params, const struct gz_log *log,
			       struct gz_ffmpeg **out_ffmpeg);

/**
 * Send a picture to ffmpeg. Blocks until ffmpeg has read it.
 *
 * @param image  of the size in the parameters
 * @retval GZ_ERR_INVAL  another size
 * @retval GZ_ERR_IO     ffmpeg has ended; gz_ffmpeg_end() logs the reason
 */
enum gz_result gz_ffmpeg_write(struct gz_ffmpeg *ffmpeg, const struct gz_image *image);

/**
 * Close the pipe, wait until ffmpeg has finished the file, free and set the pointer to NULL.
 * Accepts a pointer to NULL: GZ_OK.
 *
 * @retval GZ_ERR_IO  ffmpeg failed; logged with its last messages
 */
enum gz_result gz_ffmpeg_end(struct gz_ffmpeg **ffmpeg);

#endif
