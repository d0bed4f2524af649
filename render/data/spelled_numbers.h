/**
 * @file
 * Numbers that a file spells in characters: decimal text, and hexadecimal digits of bytes.
 */
#ifndef GZ_RENDER_DATA_SPELLED_NUMBERS_H
#define GZ_RENDER_DATA_SPELLED_NUMBERS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "render/data/byte_stream.h"
#include "render/data/volume.h"

/** Most characters of a decimal number. Chosen: a double needs 25. */
#define GZ_SPELLED_WORD_MAX 63

/** What is being read. The first four members are set by the caller, the others zero. */
struct gz_spelled_numbers {
	struct gz_byte_stream *bytes; /**< of the characters; borrowed */
	const char *path;             /**< for messages; borrowed */
	const struct gz_log *log;
	enum gz_raw_type type; /**< of the numbers that text spells */

	char characters[4096]; /**< read and not used yet: [at, size) */
	size_t at, size;
	uint64_t count; /**< of the numbers read */
};

/**
 * A gz_byte_source of decimal numbers, as binary numbers of the type in the host's byte order.
 * Blanks, ends of lines and commas separate them. Floats may be nan and inf.
 *
 * @param user  struct gz_spelled_numbers
 * @param size  a multiple of the size of the type
 * @retval GZ_ERR_FORMAT  a word that is no number of the type; logged
 */
enum gz_result gz_spelled_text_read(void *user, void *buffer, size_t size, size_t *out_got);

/** A gz_byte_source of bytes of two hexadecimal digits each. Blanks and ends of lines are skipped.
 * Arguments and results as gz_spelled_text_read(), for any @p size. */
enum gz_result gz_spelled_hex_read(void *user, void *buffer, size_t size, size_t *out_got);

#endif
