/**
 * @file
 * Numbers that floats do not hold, as several floats: files of what was computed of a mesh hold
 * floats alone (render/mesh/cache/mesh_cache.h).
 */
#ifndef GZ_RENDER_ILLUSTRATION_KEPT_NUMBERS_H
#define GZ_RENDER_ILLUSTRATION_KEPT_NUMBERS_H

#include <stdbool.h>
#include <stddef.h>

/** Floats whose sum is a double, bit for bit. */
#define GZ_KEPT_DOUBLE_FLOATS 3

/** Whole numbers up to this are one float. */
#define GZ_KEPT_WHOLE_MAX ((size_t)1 << 24)

/** Write a double as floats. */
static inline void gz_keep_double(double value, float out_floats[GZ_KEPT_DOUBLE_FLOATS])
{
	for (int i = 0; i < GZ_KEPT_DOUBLE_FLOATS; i++) {
		out_floats[i] = (float)value;
		value -= (double)out_floats[i];
	}
}

/** Read what gz_keep_double() wrote. */
static inline double gz_kept_double(const float floats[GZ_KEPT_DOUBLE_FLOATS])
{
	double value = 0;
	for (int i = GZ_KEPT_DOUBLE_FLOATS - 1; i >= 0; i--)
		value += (double)floats[i];
	return value;
}

/** Read a whole number. @return false: it is none, or out of range */
static inline bool gz_kept_whole(float value, size_t least, size_t most, size_t *out_whole)
{
	const bool good =
		value >= (float)least && value <= (float)most && (float)(size_t)value == value;
	if (good)
		*out_whole = (size_t)value;
	return good;
}

#endif
