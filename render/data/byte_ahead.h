/**
 * @file
 * Bytes made ahead of their reader by a thread of their own, in a ring of fixed size.
 */
#ifndef GZ_RENDER_DATA_BYTE_AHEAD_H
#define GZ_RENDER_DATA_BYTE_AHEAD_H

#include <stddef.h>
#include <stdint.h>

#include "base/result.h"
#include "render/data/byte_stream.h"

struct gz_byte_ahead;

/**
 * Start a thread that reads @p bytes from @p source, no more. It is up to 1 MiB ahead.
 *
 * @param source  called on that thread alone until gz_byte_ahead_end()
 * @param user    handed to @p source
 * @param[out] out_ahead  owned by the caller: gz_byte_ahead_end()
 * @retval GZ_ERR_NO_MEM  no room, or no thread to be had; not logged, as one can do without
 */
enum gz_result gz_byte_ahead_start(gz_byte_source *source, void *user, uint64_t bytes,
				   struct gz_byte_ahead **out_ahead);

/**
 * Read until @p size bytes are there, all that were asked for have come, or the source ends.
 *
 * @param[out] out_got  less than @p size where no more will come
 * @return what @p source returned where it failed, behind all bytes before
 *
 * Threads: one at a time.
 */
enum gz_result gz_byte_ahead_read(struct gz_byte_ahead *ahead, void *buffer, size_t size,
				  size_t *out_got);

/** End the thread, wherever it is, free, set to NULL. Accepts a pointer to NULL. */
void gz_byte_ahead_end(struct gz_byte_ahead **ahead);

#endif
