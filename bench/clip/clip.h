/**
 * @file
 * A clip: what someone sees while the camera moves, as pictures of a reference and of methods frame
 * by frame, for metrics of moving pictures that others have published.
 */
#ifndef GZ_BENCH_CLIP_CLIP_H
#define GZ_BENCH_CLIP_CLIP_H

#include <stdbool.h>

#include "base/log.h"
#include "base/result.h"
#include "bench/study/ask.h"

/** Most frames of a clip. Chosen: their number has four digits. */
#define GZ_CLIP_FRAMES_MAX 9999

/** What a clip shows. */
struct gz_clip_request {
	/** One scene, which is shown with its first transfer function; one size and one backend.
	 *  Point i of the path is where the gaze is in frame i; after the last point it rests. */
	struct gz_study_request study;
	int frames;      /**< 1 to GZ_CLIP_FRAMES_MAX; 0: as many as the camera path has, or 24 */
	double fps;      /**< frames a second, above 0 */
	double turn_deg; /**< that the camera turns a frame, without a camera path */
	const char *camera_path; /**< file (camera_path.h); NULL: the camera turns */
	bool converged; /**< the reference is the converged picture (errors.h), not `standard` */
};

/** What was written. */
struct gz_clip_outcome {
	int frames;
	size_t tests;                        /**< sequences beside the reference */
	char first_test[GZ_STUDY_TEXT_SIZE]; /**< folder of the first of them, in the clip's */
	double px_per_deg;                   /**< in the middle of the display */
};

/**
 * Write a clip.
 *
 * The folder then has a folder of PNG files for each sequence: "reference", and for each method
 * "N-METHOD". clip.json, written last, lists them, with size, frames a second, display, and the
 * gaze and the camera of each frame (docs/gazebench.md).
 *
 * @param folder  made if missing; must be empty
 * @param[out] out_outcome  written on success
 * @retval GZ_ERR_INVAL      something in the request is wrong; logged
 * @retval GZ_ERR_UNSUPPORTED  the scene is a file of bricks, which changes while it is shown
 * @retval GZ_ERR_IO         something cannot be written, or the folder is not empty; logged
 * @retval GZ_ERR_CANCELLED  SIGINT or SIGTERM has arrived (gz_command_catch_signals()); not logged
 * @return else what gz_study_ask(), gz_camera_path_read() and gz_picture_make() return; logged
 */
enum gz_result gz_clip_write(const struct gz_clip_request *request, const char *folder,
			     const struct gz_log *log, struct gz_clip_outcome *out_outcome);

#endif
