/**
 * @file
 * Integers of 32 bits, which are kept as floats: exactly, where an offset makes that possible.
 *
 * A float holds integers up to 2^24. While a file is read, its numbers are kept as words in the
 * room of the floats that they become; when their range is known, they are stored.
 */
#ifndef GZ_RENDER_DATA_WHOLE_NUMBERS_H
#define GZ_RENDER_DATA_WHOLE_NUMBERS_H

#include <stdbool.h>
#include <stddef.h>

#include "render/data/volume.h"
#include "render/data/voxel_place.h"

/** How numbers of @p type become words; the conversion's offset is that of words: number = word +
 *  offset. NULL if the type is not GZ_RAW_INT32 or GZ_RAW_UINT32. */
const struct gz_voxel_conversion *gz_whole_number_words(enum gz_raw_type type);

/** Widen a range of numbers by those of @p count words. */
void gz_whole_numbers_widen(const void *words, size_t count, double offset, double range[2]);

/** What to subtract from numbers of this range so that floats hold them exactly; 0 if nothing need
 *  be subtracted, or nothing helps. */
double gz_whole_numbers_shift(const double range[2]);

/** How words become floats, and what that costs. */
struct gz_whole_storing {
	double offset;  /**< number = word + offset */
	double shift;   /**< float = number - shift */
	size_t rounded; /**< result: how many floats are not exact */
	double worst;   /**< result: the most that one differs */
};

/** Turn @p count words into floats in place. */
void gz_whole_numbers_store(void *words, size_t count, struct gz_whole_storing *storing);

#endif
