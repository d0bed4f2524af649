/**
 * @file
 * Reads a session frame by frame. Its files may come from anywhere: each line is checked, and
 * errors are logged with file:line. One thread.
 */
#ifndef GZ_VIEW_SESSION_SESSION_READER_H
#define GZ_VIEW_SESSION_SESSION_READER_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/log.h"
#include "base/result.h"
#include "render/scene/scene.h"
#include "view/session/session.h"

/** A session being read. */
struct gz_session_reader;

/** What the last frame read was made with. */
struct gz_session_state {
	struct gz_scene_settings settings;
	struct gz_transfer transfer;
	struct gz_raised raised; /**< in importance; zero-initialised, nothing is */
	double finer;            /**< gz_focus.finer; 0, as in a zero-initialised state: 1 */
	struct gz_illustration_change change; /**< of combined settings, by what was seen */
	bool transfer_changed; /**< since the previous frame; each read sets or clears it */
	bool table_changed;    /**< settings.foveation.table_file has changed: the renderer loads it
				  with gz_scene_load_table(), beside the session's scene */
	bool templates_changed; /**< likewise templates: gz_scene_find_templates() */
};

/**
 * Open a session and read its header.
 *
 * @param path  the session's folder
 * @param log   borrowed, outlives the reader
 * @param[out] out_reader  the caller closes it with gz_session_close()
 * @retval GZ_ERR_NOT_FOUND  no session there; logged
 * @retval GZ_ERR_FULL       the path is too long; logged
 * @retval GZ_ERR_IO         the file cannot be read; logged
 * @retval GZ_ERR_NO_MEM     out of memory
 * @retval GZ_ERR_FORMAT     not a session, or a version that cannot be read; logged
 */
enum gz_result gz_session_open(const char *path, const struct gz_log *log,
			       struct gz_session_reader **out_reader);

/** Like gz_session_open(), but reads the frames from memory, which must stay valid until the reader
 * is closed. @p name stands for the file in messages. */
enum gz_result gz_session_open_memory(const char *name, const char *text, size_t size,
				      const struct gz_log *log,
				      struct gz_session_reader **out_reader);

/** The header. Valid until the reader is closed. */
const struct gz_session_header *gz_session_header(const struct gz_session_reader *reader);

/**
 * Read the next frame and the changes before it. Each value is checked by itself; check the
 * settings together with gz_scene_settings_check().
 *
 * @param[in,out] state  before the first call the state of the session's scene; pass it on
 * unchanged
 * @retval GZ_OK          @p out_frame is filled
 * @retval GZ_ERR_END     no further frame; if the session was cut short or changed, a warning with
 *                        the number of frames is logged
 * @retval GZ_ERR_FORMAT  an invalid line; logged with file:line. All further reads fail
 * @retval GZ_ERR_IO      the file cannot be read; logged
 */
enum gz_result gz_session_read(struct gz_session_reader *reader, struct gz_session_state *state,
			       struct gz_session_frame *out_frame);

/** Print "file:line" of the last line read, for messages. Cut to @p size bytes. */
void gz_session_print_place(const struct gz_session_reader *reader, char *text, size_t size);

/** Number of frames read so far. */
uint64_t gz_session_frames_read(const struct gz_session_reader *reader);

/** Close the reader and set the pointer to NULL. Accepts a pointer to NULL. */
void gz_session_close(struct gz_session_reader **reader);

#endif
