/*
 * The loops of tone_curve.h over pixels, compiled once for each instruction set (plane_kernels.h).
 */
#ifndef GZ_RENDER_ILLUSTRATION_TONE_LOOPS_H
#define GZ_RENDER_ILLUSTRATION_TONE_LOOPS_H

#include <stddef.h>
#include <string.h>

#include "render/illustration/tone_curve.h"

/* The bin of a brightness. Choices that are not nested become SIMD. */
static inline int tone_bin(float value)
{
	const float at = value * GZ_TONE_BINS;
	const float low = at < 1 ? 0 : at; /* NaN stays */
	return low < GZ_TONE_BINS ? (int)low : GZ_TONE_BINS - 1;
}

/* Pixels whose bins are found at once. */
enum { TONES_AT_ONCE = 64 };

/* Count the pixels of objects of a block. */
static inline void count_block(const char *map, const uint32_t *ids, int count, int step,
			       uint32_t *counts)
{
	uint32_t any = 0;
	for (int i = 0; i < count; i++)
		any |= ids[i];
	for (int i = 0; i < count && any != 0; i += step) {
		float value;
		memcpy(&value, map + (size_t)i * sizeof value, sizeof value);
		if (ids[i] != 0)
			counts[tone_bin(value)]++;
	}
}

/* gz_tone_count() */
static inline void count_tones(const void *map, const uint32_t *ids, size_t count, size_t step,
			       struct gz_tone_histogram *histogram)
{
	const size_t block = TONES_AT_ONCE * step;
	for (size_t from = 0; from < count; from += block) {
		const size_t rest = count - from;
		count_block((const char *)map + from * sizeof(float), ids + from,
			    (int)(rest < block ? rest : block), (int)step, histogram->counts);
	}
}

/* gz_tone_apply() */
static inline void tone_apply_loop(const struct gz_tone_curve *curve, const uint32_t *ids,
				   size_t count, float *restrict map)
{
	for (size_t i = 0; i < count; i++) {
		const float toned = curve->values[tone_bin(map[i])];
		map[i] = ids[i] != 0 ? toned : map[i];
	}
}

#endif
