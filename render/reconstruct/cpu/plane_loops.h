/*
 * Filters of planes of values and of object ids, compiled once for each instruction set with the
 * same bits. INFINITY marks a point without a value. If a filter reads such a point, it takes the
 * mean of the nearer points instead, and failing that the nearest point. Object ids never mix.
 */
#ifndef GZ_RENDER_RECONSTRUCT_CPU_PLANE_LOOPS_H
#define GZ_RENDER_RECONSTRUCT_CPU_PLANE_LOOPS_H

#include <float.h>
#include <math.h>

#include "render/reconstruct/cpu/reconstruct.h"

/* Points of a row that are doubled at once. Chosen: they stay in the first-level cache. */
enum { CUBIC_BLOCK = 64 };

/* Between two points. */
static float value_mean_of_2(float a, float b)
{
	const float mean = 0.5F * (a + b);
	return isfinite(mean) ? mean : a;
}

/* Between four points. */
static float value_mean_of_4(float a, float b, float c, float d)
{
	const float mean = 0.25F * (a + b + c + d);
	return isfinite(mean) ? mean : a;
}

/* Whether a number is finite; a comparison becomes SIMD. */
static bool value_is_finite(float value)
{
	return fabsf(value) <= FLT_MAX;
}

/* Catmull-Rom, clamped to [b, c]. All choices are made, none is nested: that becomes SIMD. */
static float value_cubic(float a, float b, float c, float d)
{
	const float value = (9 * (b + c) - (a + d)) / 16, mean = 0.5F * (b + c);
	const float least = b < c ? b : c, greatest = b < c ? c : b;
	const float above = value > least ? value : least;
	const float within = above < greatest ? above : greatest;
	const float nearer = value_is_finite(mean) ? mean : b;
	return value_is_finite(value) ? within : nearer;
}

/* b with a share, and a. */
static float value_mix(float a, float b, float share)
{
	const float mixed = a + (b - a) * share;
	if (isfinite(mixed))
		return mixed;
	return share < 0.5F ? a : b;
}

#define POINT       float
#define PLANE(name) value_##name
#include "render/reconstruct/cpu/plane_rows.h"

/* Of two objects the nearer. */
static uint32_t id_mean_of_2(uint32_t a, uint32_t b)
{
	(void)b;
	return a;
}

/* Of four objects the first. */
static uint32_t id_mean_of_4(uint32_t a, uint32_t b, uint32_t c, uint32_t d)
{
	(void)b, (void)c, (void)d;
	return a;
}

/* Of four objects the one before the point. */
static uint32_t id_cubic(uint32_t a, uint32_t b, uint32_t c, uint32_t d)
{
	(void)a, (void)c, (void)d;
	return b;
}

/* The object of the greater share. */
static uint32_t id_mix(uint32_t a, uint32_t b, float share)
{
	return share < 0.5F ? a : b;
}

#define POINT       uint32_t
#define PLANE(name) id_##name
#include "render/reconstruct/cpu/plane_rows.h"

#endif
