/**
 * @file
 * Directions of gaze as unit vectors in the eye's frame (+x right, +y down, +z towards the
 * display), with portable arithmetic only (sim/random.h).
 */
#ifndef GZ_SIM_SPHERE_H
#define GZ_SIM_SPHERE_H

#include "protocol/display.h"

/** Unit vector from the eye to a point of the display. */
void gz_sphere_from_point(const struct gz_display *display, double x, double y,
			  double out_direction[3]);

/** Where a direction meets the display's plane; direction[2] must be above 0. */
struct gz_point gz_sphere_to_point(const struct gz_display *display, const double direction[3]);

/** Angle between two unit vectors, radians. */
double gz_sphere_angle(const double a[3], const double b[3]);

/** Two unit vectors across @p direction: the first to the right, the second down. */
void gz_sphere_tangents(const double direction[3], double out_right[3], double out_down[3]);

/** Go from @p direction by @p angle radians along the unit tangent @p tangent. */
void gz_sphere_turn(const double direction[3], const double tangent[3], double angle,
		    double out_direction[3]);

/** Unit tangent at @p from that points to @p to; to the right where they are the same. */
void gz_sphere_towards(const double from[3], const double to[3], double out_tangent[3]);

/** Move @p direction by small angles to the right and down, degrees. */
void gz_sphere_offset(const double direction[3], const double offset_deg[2],
		      double out_direction[3]);

#endif
