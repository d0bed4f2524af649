/**
 * @file
 * A session shown again: each frame is made of what it was made of, whatever the gaze, the machine
 * and the budget are now. Headless and window share it.
 */
#ifndef GZ_VIEW_REPLAY_H
#define GZ_VIEW_REPLAY_H

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
 * Make the options those of the session that options->replay names: its scene, the size of its
 * first frame, and, unless another is asked for, cpu where that cast it.
 *
 * @return as gz_session_open(), and GZ_ERR_FORMAT where there is not one frame; logged
 */
enum gz_result gz_replay_adopt(struct gz_view_options *options, const struct gz_log *log);

/**
 * Begin to replay it with the session's scene, loaded.
 *
 * @param options  as gz_replay_adopt() left them; their scene keys come before what was recorded.
 *                 They and @p maker, which has been started, are borrowed and outlive the replay
 * @param[out] out_replay  owned by the caller: gz_replay_close()
 * @retval GZ_ERR_FORMAT  the volume is another than was recorded; logged
 * @return else as gz_session_open()
 */
enum gz_result gz_replay_open(const struct gz_view_options *options, struct gz_frame_maker *maker,
			      const struct gz_log *log, struct gz_replay **out_replay);

/**
 * Read the next frame, which is not made yet.
 *
 * @retval GZ_ERR_END  the one before was the last
 * @return else as gz_session_read(), or why a table of spacings cannot be read; logged
 */
enum gz_result gz_replay_next(struct gz_replay *replay);

/** The frame that gz_replay_next() has read. */
const struct gz_session_frame *gz_replay_frame(const struct gz_replay *replay);

/** The settings that it is made with. */
const struct gz_scene_settings *gz_replay_settings(const struct gz_replay *replay);

/**
 * Ready the maker for it: transfer function, focus, and what earlier frames saw. Call
 * gz_frame_make() next, once.
 *
 * @return as gz_frame_set_transfer(); logged
 */
enum gz_result gz_replay_ready(struct gz_replay *replay);

/** Say what differs from the recording, where the frame just made was cast otherwise: once. */
void gz_replay_compare(struct gz_replay *replay, const struct gz_frame_record *record);

/** Frames read so far. */
uint64_t gz_replay_frames(const struct gz_replay *replay);

/** Close and set to NULL. Accepts a pointer to NULL. */
void gz_replay_close(struct gz_replay **replay);

#endif
