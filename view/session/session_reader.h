/**
 * @file
 * A session read back, frame by frame. Its files may be anybody's: each line is checked, and what
 * is wrong is refused with file:line. One thread.
 */
#ifndef GZ_VIEW_SESSION_READER_H
#define GZ_VIEW_SESSION_READER_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/log.h"
#include "base/result.h"
#include "render/scene/scene.h"
#include "view/session/session.h"

/** A session being read. */
struct gz_session_reader;

/** What the newest frame read was made with. */
struct gz_session_state {
	struct gz_scene_settings settings;
	struct gz_transfer transfer;
	bool transfer_changed; /**< since the frame before; set and cleared by each read */
	bool table_changed;    /**< settings.foveation.table_file has: whoever renders loads it by
				  gz_scene_load_table(), beside the session's scene */
};

/**
 * Open the frames of a session and read what is the same for all of them.
 *
 * @param path  of the session's folder
 * @param log   borrowed, outlives the reader
 * @param[out] out_reader  owned by the caller: gz_session_close()
 * @retval GZ_ERR_NOT_FOUND  there is no session; logged
 * @retval GZ_ERR_IO, GZ_ERR_NO_MEM  logged
 * @retval GZ_ERR_FORMAT  not a session's frames, or of a version that is not read; logged
 */
enum gz_result gz_session_open(const char *path, const struct gz_log *log,
			       struct gz_session_reader **out_reader);

/** As gz_session_open() over the text of the frames in memory, which must stay until the reader is
 * closed; @p name stands for the file in messages. */
enum gz_result gz_session_open_memory(const char *name, const char *text, size_t size,
				      const struct gz_log *log,
				      struct gz_session_reader **out_reader);

/** What is the same for all frames. Valid until the reader is closed. */
const struct gz_session_header *gz_session_header(const struct gz_session_reader *reader);

/**
 * Read the next frame, and what has changed before it: each value by itself is one that its setting
 * may have; whether they go together gz_scene_settings_check() tells.
 *
 * @param[in,out] state  before the first frame that of the session's scene; then as it was left
 * @retval GZ_OK         @p out_frame is filled
 * @retval GZ_ERR_END    there is no further frame; where the session was cut or damaged that has
 * been logged, as a warning, with the number of frames
 * @retval GZ_ERR_FORMAT  a line is refused; logged with file:line. Nothing can be read behind it
 * @retval GZ_ERR_IO      reading failed; logged
 */
enum gz_result gz_session_read(struct gz_session_reader *reader, struct gz_session_state *state,
			       struct gz_session_frame *out_frame);

/** "file:line" of the newest line read, for messages. Cut to @p size. */
void gz_session_print_place(const struct gz_session_reader *reader, char *text, size_t size);

/** Frames read so far. */
uint64_t gz_session_frames_read(const struct gz_session_reader *reader);

/** Close and set to NULL. Accepts a pointer to NULL. */
void gz_session_close(struct gz_session_reader **reader);

#endif
