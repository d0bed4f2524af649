/**
 * @file
 * Records a session. Each frame is in the file when the call returns: if the process is killed,
 * complete lines survive. One thread.
 */
#ifndef GZ_VIEW_SESSION_SESSION_WRITER_H
#define GZ_VIEW_SESSION_SESSION_WRITER_H

#include <stdbool.h>
#include <stdint.h>

#include "base/log.h"
#include "base/result.h"
#include "render/scene/scene.h"
#include "view/frame/frame.h"
#include "view/session/session.h"

/** A session being recorded. */
struct gz_session_writer;

/** What is shown at the start. Borrowed until gz_session_writer_begin() returns. */
struct gz_session_start {
	const char *path;  /**< of the new folder, usually ending in GZ_SESSION_ENDING */
	const char *scene; /**< path of the scene; files in the settings are relative to it */
	const struct gz_scene_settings *settings;
	bool has_display; /**< settings->display comes from the scene */
	const struct gz_transfer *transfer;
	const struct gz_volume *volume;
	const struct gz_display *display; /**< the picture fills it */
	const char *software;             /**< "gazeview 1.0" */
	const char *backend;              /**< "cpu", "gl" */
	const char *source;               /**< source of the gaze: "daemon", "mouse", … */
	double rate_hz;                   /**< approximate frame rate; 0: unknown */
	int64_t now_ns;                   /**< time 0, on the host's clock */
};

/**
 * Create the folder and write the scene and the headers. Only the user can read the folder, as gaze
 * is personal data.
 *
 * @param log  borrowed, outlives the writer
 * @param[out] out_writer  the caller ends it with gz_session_writer_end()
 * @retval GZ_ERR_BUSY    the path exists; logged
 * @retval GZ_ERR_IO, GZ_ERR_FULL, GZ_ERR_INVAL, GZ_ERR_NO_MEM  the session cannot be created;
 *         logged, and what was created is removed
 */
enum gz_result gz_session_writer_begin(const struct gz_session_start *start,
				       const struct gz_log *log,
				       struct gz_session_writer **out_writer);

/**
 * Add a frame, and before it what changed since the previous one.
 *
 * @param settings, transfer  the frame was made with
 * @retval GZ_ERR_IO      the disk is full or fails; logged once. Frames written before are
 * complete, and nothing more is written
 * @retval GZ_ERR_NO_MEM  like GZ_ERR_IO
 */
enum gz_result gz_session_writer_add(struct gz_session_writer *writer,
				     const struct gz_scene_settings *settings,
				     const struct gz_transfer *transfer,
				     const struct gz_session_frame *frame);

/**
 * Add a reading to the gaze log if it is known and its sample is newer than the previous one.
 *
 * @param reading  its point is on the picture
 * @param now_ns   time of the reading, on the host's clock
 * @return the results of gz_session_writer_add()
 */
enum gz_result gz_session_writer_gaze(struct gz_session_writer *writer,
				      const struct gz_gaze_reading *reading, int64_t now_ns);

/** Number of frames added so far. */
uint64_t gz_session_writer_frames(const struct gz_session_writer *writer);

/** Path of the folder. */
const char *gz_session_writer_path(const struct gz_session_writer *writer);

/**
 * End the session, free and set the pointer to NULL. Accepts a pointer to NULL: GZ_OK.
 *
 * @retval GZ_ERR_IO  the last lines could not be written; logged
 */
enum gz_result gz_session_writer_end(struct gz_session_writer **writer);

/** What is shown when a frame maker's frames begin to be recorded. */
struct gz_recording_start {
	const char *path;  /**< of the new folder */
	const char *scene; /**< path of the scene */
	struct gz_frame_maker *maker;
	const struct gz_scene_settings *settings; /**< of the next frame */
	const struct gz_display *display;         /**< the picture fills it */
	const char *source;                       /**< source of the gaze */
	double rate_hz;                           /**< approximate frame rate */
	int64_t now_ns;                           /**< time 0, from any origin */
};

/** Check that nothing exists at @p path yet. GZ_ERR_BUSY: something does; logged. */
enum gz_result gz_recording_check(const char *path, const struct gz_log *log);

/**
 * Begin to record the frames of a frame maker. Drops what earlier frames accumulated, so that a
 * replay begins alike. Warns if the volume is stored in bricks: a replay shows all bricks, not
 * those loaded at the time.
 *
 * @param[out] out_writer  the caller ends it with gz_session_writer_end()
 * @return the results of gz_session_writer_begin()
 */
enum gz_result gz_recording_begin(const struct gz_recording_start *start, const struct gz_log *log,
				  struct gz_session_writer **out_writer);

/**
 * Add the frame that the maker has just made.
 *
 * @param request  the request of that frame
 * @param record   the record of that frame
 * @param time_ns  since the recording began
 * @return the results of gz_session_writer_add()
 */
enum gz_result gz_recording_add(struct gz_session_writer *writer,
				const struct gz_frame_maker *maker,
				const struct gz_frame_request *request,
				const struct gz_frame_record *record, int64_t time_ns);

#endif
