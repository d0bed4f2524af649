/**
 * @file
 * The decoder's side of the conversation with the program that started it.
 */
#ifndef GZ_RENDER_DECODE_CHILD_H
#define GZ_RENDER_DECODE_CHILD_H

#include <stdbool.h>
#include <stdint.h>

#include "base/log.h"
#include "base/result.h"
#include "render/data/volume.h"
#include "render/decode/decode.h"

/** What it says, and the hooks for a loader. Prepared by gz_decoder_init(). */
struct gz_decoder {
	struct gz_log log;                  /**< its lines become messages; thread-safe */
	struct gz_loading loading;          /**< reports steps, and gets the voxels' memory */
	struct gz_decode_listener listener; /**< sends a list */
	double number_range[2];             /**< what the loading points to, if it is known */
	int32_t steps;                      /**< reports so far */
	int64_t sent_ns;                    /**< when a step was sent last */
};

/** Prepare @p decoder, which must not be moved afterwards. */
void gz_decoder_init(struct gz_decoder *decoder);

/**
 * Take the arguments that say what of a series is wanted (render/decode/decode_protocol.h).
 *
 * @param range  changed
 * @return false if they are not as the protocol says
 */
bool gz_decoder_take_series(struct gz_decoder *decoder, const char *time_point, char *range);

/** Say how it ended, and end the process without running anything else of its libraries.
 *  @param result  GZ_ERR_CHOICE: the listener was told of series, and that was all
 *  @param volume  what was decoded; not used unless @p result is GZ_OK */
_Noreturn void gz_decoder_end(enum gz_result result, const struct gz_volume *volume);

#endif
