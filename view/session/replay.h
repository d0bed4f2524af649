/**
 * @file
 * Replays a session: renders each frame from its recorded inputs, independent of the current gaze,
 * machine and budget. Shared by the window and headless rendering.
 */
#ifndef GZ_VIEW_SESSION_REPLAY_H
#define GZ_VIEW_SESSION_REPLAY_H

#include <stdbool.h>
#include <stdint.h>

#include "base/log.h"
#include "base/result.h"
#include "view/frame/frame.h"
#include "view/options/options.h"
#include "view/session/session.h"

/** A session being replayed. */
struct gz_replay;

/**
 * Set the scene and size in @p options to those of the session that options->replay names. If the
 * session was recorded with cpu and the backend is "auto", it becomes cpu.
 *
 * @retval GZ_ERR_FORMAT  the session has no frame; logged
 * @return otherwise the results of gz_session_open() and gz_session_read()
 */
enum gz_result gz_replay_adopt(struct gz_view_options *options, const struct gz_log *log);

/**
 * Begin a replay.
 *
 * @param options  from gz_replay_adopt(); their scene keys replace the recorded settings. Borrowed,
 *                 outlive the replay
 * @param maker    has loaded the session's scene and was started; borrowed, outlives the replay
 * @param[out] out_replay  the caller closes it with gz_replay_close()
 * @retval GZ_ERR_FORMAT  the volume differs from the recorded one; logged
 * @return otherwise the results of gz_session_open()
 */
enum gz_result gz_replay_open(const struct gz_view_options *options, struct gz_frame_maker *maker,
			      const struct gz_log *log, struct gz_replay **out_replay);

/**
 * Read the next frame without rendering it.
 *
 * @retval GZ_ERR_END  no further frame
 * @return otherwise the results of gz_session_read(), gz_scene_load_table() and
 *         gz_scene_settings_check(); logged
 */
enum gz_result gz_replay_next(struct gz_replay *replay);

/** The frame that gz_replay_next() has read. */
const struct gz_session_frame *gz_replay_frame(const struct gz_replay *replay);

/** The settings to render that frame with. */
const struct gz_scene_settings *gz_replay_settings(const struct gz_replay *replay);

/**
 * Prepare the maker for the frame: transfer function, focus, accumulation. Call gz_frame_make()
 * next, once.
 *
 * @return the results of gz_frame_set_transfer(); logged
 */
enum gz_result gz_replay_ready(struct gz_replay *replay);

/** Warn once if the frame just made used another backend than the recording. */
void gz_replay_compare(struct gz_replay *replay, const struct gz_frame_record *record);

/** Number of frames read so far. */
uint64_t gz_replay_frames(const struct gz_replay *replay);

/** Close the replay and set the pointer to NULL. Accepts a pointer to NULL. */
void gz_replay_close(struct gz_replay **replay);

#endif
