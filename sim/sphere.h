/**
 * @file
 * Directions of gaze as unit vectors from the eye: +x right, +y down, +z towards the display. The
 * arithmetic is portable (sim/random.h).
 */
#ifndef GZ_SIM_SPHERE_H
#define GZ_SIM_SPHERE_H

#include "protocol/display.h"

/** Unit vector from the eye to a point of the display. */
void gz_sphere_from_point(const struct gz_display *display, double x, double y,
			  double out_direction[3]);

/** The point where a direction meets the plane of the display; direction[2] must be above 0. */
struct gz_point gz_sphere_to_point(const struct gz_display *display, const double direction[3]);

/** Angle between two unit vectors, radians. */
double gz_sphere_angle(const double a[3], const double b[3]);

/** Two unit vectors perpendicular to @p direction: the first points right, the second down. */
void gz_sphere_tangents(const double direction[3], double out_right[3], double out_down[3]);

/** The direction that is @p angle radians from @p direction along the unit tangent @p tangent. */
void gz_sphere_turn(const double direction[3], const double tangent[3], double angle,
		    double out_direction[3]);

/** Unit tangent at @p from that points to @p to. If they are equal it points right. */
void gz_sphere_towards(const double from[3], const double to[3], double out_tangent[3]);

/** Move @p direction by small angles to the right and down, degrees. The output may be the input.
 */
void gz_sphere_offset(const double direction[3], const double offset_deg[2],
		      double out_direction[3]);

#endif
