/**
 * @file
 * The decoder's side of the conversation with the program that started it.
 */
#ifndef GZ_RENDER_DECODE_CHILD_H
#define GZ_RENDER_DECODE_CHILD_H

#include <stdint.h>

#include "base/log.h"
#include "base/result.h"
#include "render/data/volume.h"

/** What it says, and the hooks for a loader. Prepared by gz_decoder_init(). */
struct gz_decoder {
	struct gz_log log;         /**< its lines become messages; thread-safe */
	struct gz_loading loading; /**< reports steps, and gets the voxels' memory */
	int32_t steps;             /**< reports so far */
	int64_t sent_ns;           /**< when a step was sent last */
};

/** Prepare @p decoder, which must not be moved afterwards. */
void gz_decoder_init(struct gz_decoder *decoder);

/** Say how it ended, and end the process without running anything else of its libraries.
 *  @param volume  what was decoded; not used unless @p result is GZ_OK */
_Noreturn void gz_decoder_end(enum gz_result result, const struct gz_volume *volume);

#endif
