/**
 * @file
 * Angles between points of the display, for all steps. They use only + - * / and sqrt, which give
 * the same bits on every machine.
 */
#ifndef GZ_FILTER_ANGLE_H
#define GZ_FILTER_ANGLE_H

#include <math.h>

#include "base/vector.h"
#include "protocol/display.h"

#define GZ_DEG_PER_RAD 57.295779513082320877

/**
 * The unit vector from the eye to a point of the display, times 180 / pi. The distance between two
 * such vectors is the angle between them in degrees, measured as a chord: 0.03 % too short at 5
 * degrees, 1 % at 28.
 */
static inline void gz_direction_deg(const struct gz_display *display, struct gz_point point,
				    double out_deg[3])
{
	double mm[3];
	gz_display_to_mm(display, point, mm);
	double scale = GZ_DEG_PER_RAD / sqrt(mm[0] * mm[0] + mm[1] * mm[1] + mm[2] * mm[2]);
	for (int i = 0; i < 3; i++)
		out_deg[i] = scale * mm[i];
}

/** Angle between two points of the display, degrees, measured as a chord. */
static inline double gz_chord_deg(const struct gz_display *display, struct gz_point a,
				  struct gz_point b)
{
	double u[3], v[3];
	gz_direction_deg(display, a, u);
	gz_direction_deg(display, b, v);
	double d[3] = { u[0] - v[0], u[1] - v[1], u[2] - v[2] };
	return gz_length3(d);
}

#endif
