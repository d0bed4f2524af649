/**
 * @file
 * A session being recorded. Each frame is in the file when the call returns, so that who is killed
 * leaves all whole lines behind. One thread.
 */
#ifndef GZ_VIEW_SESSION_WRITER_H
#define GZ_VIEW_SESSION_WRITER_H

#include "view/frame/frame.h"
#include "view/session/session_writer.h"
#include <stdbool.h>
#include <stdint.h>

#include "base/log.h"
#include "base/result.h"
#include "render/scene/scene.h"
#include "view/session/session.h"

/** A session in the making. */
struct gz_session_writer;

/** What is shown when it begins; borrowed until gz_session_writer_begin() returns. */
struct gz_session_start {
	const char *path;  /**< of the folder to be, with GZ_SESSION_ENDING by custom */
	const char *scene; /**< path beside which the files that the settings name are found */
	const struct gz_scene_settings *settings;
	bool has_display; /**< settings->display is the scene's */
	const struct gz_transfer *transfer;
	const struct gz_volume *volume;
	const struct gz_display *display; /**< of the picture */
	const char *software;             /**< "gazeview 1.0" */
	const char *backend;              /**< that casts: "cpu", "gl" */
	const char *source;               /**< where the gaze comes from: "daemon", "mouse", … */
	double rate_hz;                   /**< of the frames, about; 0 if unknown */
	int64_t now_ns;                   /**< on the host's clock: time 0 */
};

/**
 * Make the folder, and in it what does not change. Gaze is about a person: nobody else may read it.
 *
 * @param log  borrowed, outlives the writer
 * @param[out] out_writer  owned by the caller: gz_session_writer_end()
 * @retval GZ_ERR_BUSY    there is something of that name; logged
 * @retval GZ_ERR_IO, GZ_ERR_FULL, GZ_ERR_INVAL, GZ_ERR_NO_MEM  it cannot be made; logged, and what
 * was made of it is removed
 */
enum gz_result gz_session_writer_begin(const struct gz_session_start *start,
				       const struct gz_log *log,
				       struct gz_session_writer **out_writer);

/**
 * Add a frame, and before it what has changed since the one before.
 *
 * @param settings  that it was made with
 * @param transfer  that it was made with
 * @retval GZ_ERR_IO      the disk is full or failing; logged once; what was recorded before is
 * whole, and nothing further is added
 * @retval GZ_ERR_NO_MEM  as GZ_ERR_IO
 */
enum gz_result gz_session_writer_add(struct gz_session_writer *writer,
				     const struct gz_scene_settings *settings,
				     const struct gz_transfer *transfer,
				     const struct gz_session_frame *frame);

/**
 * Add what was known of the gaze to the gaze log, where its sample is newer than the one before.
 *
 * @param reading  its point is on the picture; nothing happens where it is not known
 * @param now_ns   when it was read, on the host's clock
 * @return as gz_session_writer_add()
 */
enum gz_result gz_session_writer_gaze(struct gz_session_writer *writer,
				      const struct gz_gaze_reading *reading, int64_t now_ns);

/** Frames added so far. */
uint64_t gz_session_writer_frames(const struct gz_session_writer *writer);

/** Path of the folder. */
const char *gz_session_writer_path(const struct gz_session_writer *writer);

/**
 * End it, free and set to NULL. Accepts a pointer to NULL: GZ_OK.
 *
 * @retval GZ_ERR_IO  the last lines could not be written; logged
 */
enum gz_result gz_session_writer_end(struct gz_session_writer **writer);

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
