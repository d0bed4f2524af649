/**
 * @file
 * A session of the frames that a frame maker makes: headless and window share it.
 */
#ifndef GZ_VIEW_RECORDING_H
#define GZ_VIEW_RECORDING_H

#include <stdint.h>

#include "base/log.h"
#include "base/result.h"
#include "view/frame/frame.h"
#include "view/session/session_writer.h"

/** What is shown as a recording begins. */
struct gz_recording_start {
	const char *path;  /**< of the folder to be */
	const char *scene; /**< path beside which the scene's files are found */
	struct gz_frame_maker *maker;
	const struct gz_scene_settings *settings; /**< of the next frame */
	const struct gz_display *display;         /**< of the picture */
	const char *source;                       /**< where the gaze comes from */
	double rate_hz;                           /**< of the frames, about */
	int64_t now_ns;                           /**< time 0, from any origin */
};

/** Whether a session could be made at @p path: nothing is there yet. GZ_ERR_BUSY: logged. */
enum gz_result gz_recording_check(const char *path, const struct gz_log *log);

/**
 * Begin. What earlier frames saw is forgotten, so that a replay begins as this does. Pictures that
 * a replay cannot make again, because they show what has been fetched of a file of bricks so far,
 * are warned of.
 *
 * @param[out] out_writer  owned by the caller: gz_session_writer_end()
 * @return as gz_session_writer_begin()
 */
enum gz_result gz_recording_begin(const struct gz_recording_start *start, const struct gz_log *log,
				  struct gz_session_writer **out_writer);

/**
 * Add the frame that the maker has just made.
 *
 * @param request  that it was made by
 * @param record   that it was given back with
 * @param time_ns  since the recording began
 * @return as gz_session_writer_add()
 */
enum gz_result gz_recording_add(struct gz_session_writer *writer,
				const struct gz_frame_maker *maker,
				const struct gz_frame_request *request,
				const struct gz_frame_record *record, int64_t time_ns);

#endif
