#include "sim/sphere.h"

#include <math.h>
#include <string.h>

#include "base/portable.h"

#define RAD_PER_DEG 0.017453292519943295769

static double dot_product(const double a[3], const double b[3])
{
	return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void normalise_direction(double v[3])
{
	double length = sqrt(dot_product(v, v));
	for (int i = 0; i < 3; i++)
		v[i] /= length;
}

static void cross_product(const double a[3], const double b[3], double out[3])
{
	out[0] = a[1] * b[2] - a[2] * b[1];
	out[1] = a[2] * b[0] - a[0] * b[2];
	out[2] = a[0] * b[1] - a[1] * b[0];
}

void gz_sphere_from_point(const struct gz_display *display, double x, double y,
			  double out_direction[3])
{
	out_direction[0] = (x - 0.5) * display->mm[0];
	out_direction[1] = (y - 0.5) * display->mm[1];
	out_direction[2] = display->distance_mm;
	normalise_direction(out_direction);
}

struct gz_point gz_sphere_to_point(const struct gz_display *display, const double direction[3])
{
	double scale = display->distance_mm / direction[2];
	return (struct gz_point) {
		.x = (float)(0.5 + direction[0] * scale / display->mm[0]),
		.y = (float)(0.5 + direction[1] * scale / display->mm[1]),
	};
}

double gz_sphere_angle(const double a[3], const double b[3])
{
	double normal[3];
	cross_product(a, b, normal);
	return gz_portable_atan2(sqrt(dot_product(normal, normal)), dot_product(a, b));
}

void gz_sphere_tangents(const double direction[3], double out_right[3], double out_down[3])
{
	static const double down[3] = { 0, 1, 0 };
	cross_product(down, direction, out_right);
	normalise_direction(out_right);
	cross_product(direction, out_right, out_down);
}

void gz_sphere_turn(const double direction[3], const double tangent[3], double angle,
		    double out_direction[3])
{
	double c = gz_portable_cos(angle), s = gz_portable_sin(angle);
	for (int i = 0; i < 3; i++)
		out_direction[i] = c * direction[i] + s * tangent[i];
	normalise_direction(out_direction);
}

void gz_sphere_towards(const double from[3], const double to[3], double out_tangent[3])
{
	double along = dot_product(from, to);
	for (int i = 0; i < 3; i++)
		out_tangent[i] = to[i] - along * from[i];
	if (dot_product(out_tangent, out_tangent) > 1e-24) {
		normalise_direction(out_tangent);
		return;
	}
	double down[3];
	gz_sphere_tangents(from, out_tangent, down);
}

void gz_sphere_offset(const double direction[3], const double offset_deg[2],
		      double out_direction[3])
{
	double right[3], down[3], moved[3];
	gz_sphere_tangents(direction, right, down);
	for (int i = 0; i < 3; i++)
		moved[i] = direction[i] +
			   RAD_PER_DEG * (offset_deg[0] * right[i] + offset_deg[1] * down[i]);
	normalise_direction(moved);
	memcpy(out_direction, moved, sizeof moved);
}
