/**
 * @file
 * Vectors of three doubles: points, directions, colours.
 */
#ifndef GZ_BASE_VECTOR_H
#define GZ_BASE_VECTOR_H

#include <math.h>
#include <stdbool.h>

/** The dot product. */
static inline double gz_dot3(const double a[3], const double b[3])
{
	return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/** The right-handed cross product; @p out must be neither @p a nor @p b. */
static inline void gz_cross3(const double a[3], const double b[3], double out[3])
{
	out[0] = a[1] * b[2] - a[2] * b[1];
	out[1] = a[2] * b[0] - a[0] * b[2];
	out[2] = a[0] * b[1] - a[1] * b[0];
}

/** Length of a vector. Components beyond about 1e154 overflow. */
static inline double gz_length3(const double a[3])
{
	return sqrt(gz_dot3(a, a));
}

/** Scale a vector to length 1. Returns false and leaves it as it is if it is zero or not finite.
 *  Large and small vectors neither overflow nor underflow. */
static inline bool gz_normalise3(double v[3])
{
	const double scale = fmax(fabs(v[0]), fmax(fabs(v[1]), fabs(v[2])));
	/* fmax() passes over NaN */
	if (!(scale > 0) || !isfinite(v[0]) || !isfinite(v[1]) || !isfinite(v[2]))
		return false;
	for (int i = 0; i < 3; i++)
		v[i] /= scale;
	const double length = gz_length3(v);
	for (int i = 0; i < 3; i++)
		v[i] /= length;
	return true;
}

#endif
