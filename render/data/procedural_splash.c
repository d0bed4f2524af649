/* A drop that has fallen into a puddle: the crown of a splash, as a volume that is 1 inside the
 * liquid. Distances to simple bodies are joined smoothly (smooth minimum by a polynomial: Quilez,
 * "Smooth minimum"). Only + - * / and sqrt are used, as procedural.c says why. Shapes and numbers
 * are chosen by eye. */
#include <math.h>

#include "render/data/procedural.h"

/* Half the width of the rim over which values fall from 1 to 0: a few voxels of small volumes. */
#define RIM 0.03

#define PUDDLE_RADIUS 0.82
#define PUDDLE_LEVEL  (-0.465)
#define CROWN_FOOT    (-0.46)
#define CROWN_HEIGHT  0.52

/* Of a turn from one finger of the crown to the next. */
#define TURN_COSINE 0.9135454576426009 /* of 2 pi / 15 */
#define TURN_SINE   0.40673664307580015

static double clamp01(double x)
{
	return x < 0 ? 0 : x > 1 ? 1 : x;
}

static double mix(double a, double b, double t)
{
	return a + t * (b - a);
}

static double smooth_least(double a, double b, double width)
{
	const double t = clamp01(0.5 + 0.5 * (b - a) / width);
	return mix(b, a, t) - width * t * (1 - t);
}

static double smooth_greatest(double a, double b, double width)
{
	return -smooth_least(-a, -b, width);
}

/* Between -1 and 1 with a period of 1, of two parabolas. */
static double wave(double t)
{
	const double u = t - floor(t);
	const double v = u < 0.5 ? 4 * u - 1 : 4 * u - 3;
	return u < 0.5 ? 1 - v * v : v * v - 1;
}

/* Radius of the crown's wall at a share of its height. */
static double wall_radius(double share)
{
	return 0.27 + share * (0.10 + 0.17 * share);
}

static void set_point(double out[3], double x, double y, double z)
{
	out[0] = x;
	out[1] = y;
	out[2] = z;
}

static void add_blob(struct gz_splash *splash, const double from[3], const double to[3],
		     double from_radius, double to_radius)
{
	struct gz_blob *blob = &splash->blobs[splash->count++];
	double squared = 0;
	for (int i = 0; i < 3; i++) {
		blob->from[i] = from[i];
		blob->axis[i] = to[i] - from[i];
		squared += blob->axis[i] * blob->axis[i];
	}
	blob->squared_length = squared;
	blob->radius[0] = from_radius;
	blob->radius[1] = to_radius;
}

static void add_drop(struct gz_splash *splash, const double at[3], double radius)
{
	add_blob(splash, at, at, radius, radius);
}

/* A value of 0 to 1 that belongs to a number. */
static double chance(int number, int which)
{
	const double p[3] = { 1.37 * number + 0.31, 2.71 * which + 0.77, 0.43 };
	return clamp01(0.5 + 0.9 * gz_noise(p));
}

/* A finger on the rim, with a bead at its end and drops that have left it. */
static void add_finger(struct gz_splash *splash, int number, double cosine, double sine)
{
	const double length = 0.05 + 0.26 * chance(number, 0),
		     lean = 0.35 + 0.35 * chance(number, 1);
	const double rim = wall_radius(1), foot = CROWN_FOOT + CROWN_HEIGHT;
	const double bead = 0.030 + 0.018 * chance(number, 2), up = 1 - 0.4 * lean;
	double from[3], to[3], drop[3];
	set_point(from, rim * cosine, rim * sine, foot - 0.03);
	const double out = rim + lean * length, top = foot + up * length;
	set_point(to, out * cosine, out * sine, top);
	add_blob(splash, from, to, 0.036, 0.6 * bead);
	add_drop(splash, to, bead);
	double gone = 0;
	for (int i = 0; i < 2; i++) {
		if (chance(number, 3 + i) < 0.45 + 0.1 * i)
			break;
		gone += 2.2 * bead + 0.09 * chance(number, 5 + i);
		set_point(drop, (out + 1.1 * lean * gone) * cosine,
			  (out + 1.1 * lean * gone) * sine, top + (up - 1.2 * gone) * gone);
		add_drop(splash, drop, (0.75 - 0.2 * i) * bead);
	}
}

void gz_splash_lay_out(struct gz_splash *splash)
{
	double cosine = 1, sine = 0;
	splash->count = 0;
	for (int i = 0; i < GZ_SPLASH_FINGERS; i++) {
		splash->fingers[i][0] = cosine;
		splash->fingers[i][1] = sine;
		add_finger(splash, i, cosine, sine);
		const double turned = cosine * TURN_COSINE - sine * TURN_SINE;
		sine = cosine * TURN_SINE + sine * TURN_COSINE;
		cosine = turned;
	}
	/* The jet that rises in the middle, and the drop that it has thrown. */
	add_blob(splash, (const double[3]) { 0, 0, -0.38 }, (const double[3]) { 0.005, 0, -0.13 },
		 0.105, 0.036);
	add_drop(splash, (const double[3]) { 0.006, 0, -0.11 }, 0.062);
	add_blob(splash, (const double[3]) { 0.012, 0.004, 0.13 },
		 (const double[3]) { 0.014, 0.005, 0.17 }, 0.074, 0.066);
}

/* Signed distance to a cone with round ends, about. */
static double distance_to_blob(const struct gz_blob *blob, const double p[3])
{
	double along = 0, away = 0, d[3];
	for (int i = 0; i < 3; i++) {
		d[i] = p[i] - blob->from[i];
		along += d[i] * blob->axis[i];
	}
	const double share = blob->squared_length > 0 ? clamp01(along / blob->squared_length) : 0;
	for (int i = 0; i < 3; i++) {
		const double off = d[i] - share * blob->axis[i];
		away += off * off;
	}
	return sqrt(away) - mix(blob->radius[0], blob->radius[1], share);
}

/* A flat round puddle with rings, whose shore is bent. */
static double distance_to_puddle(double radius, const double direction[2], double z)
{
	const double bend[3] = { 1.6 * direction[0], 1.6 * direction[1], 3.7 };
	const double shore = PUDDLE_RADIUS * (1 + 0.09 * gz_noise(bend));
	const double fade = clamp01((shore - radius) / 0.25) * clamp01(radius / 0.25);
	const double ring = 0.013 * fade * wave(radius / 0.145);
	const double side = radius - shore, height = fabs(z - PUDDLE_LEVEL) - 0.012;
	const double out_side = side > 0 ? side : 0, out_height = height > 0 ? height : 0;
	const double inner = side > height ? side : height;
	return sqrt(out_side * out_side + out_height * out_height) + (inner < 0 ? inner : 0) -
	       0.045 - (z > PUDDLE_LEVEL ? ring : 0);
}

/* A thin wall that opens upwards; its rim is higher at the fingers. */
static double distance_to_crown(const struct gz_splash *splash, double radius,
				const double direction[2], double z)
{
	const double share = clamp01((z - CROWN_FOOT) / CROWN_HEIGHT);
	const double slope = (0.10 + 0.34 * share) / CROWN_HEIGHT;
	double nearest = -1;
	for (int i = 0; i < GZ_SPLASH_FINGERS; i++) {
		const double cosine =
			splash->fingers[i][0] * direction[0] + splash->fingers[i][1] * direction[1];
		nearest = cosine > nearest ? cosine : nearest;
	}
	/* 0.0219: one minus the cosine of half a turn. */
	const double crest = 1 - clamp01((1 - nearest) / 0.0219);
	const double top = CROWN_FOOT + CROWN_HEIGHT - 0.09 + 0.09 * crest * crest;
	const double wall = fabs(radius - wall_radius(share)) / sqrt(1 + slope * slope) -
			    (0.034 - 0.014 * share);
	const double past = z - top > CROWN_FOOT - z ? z - top : CROWN_FOOT - z;
	return smooth_greatest(wall, past, 0.05);
}

double gz_splash_at(const struct gz_splash *splash, const double p[3])
{
	const double radius = sqrt(p[0] * p[0] + p[1] * p[1]);
	const double s = radius > 1e-9 ? 1 / radius : 0;
	const double direction[2] = { s * p[0], s * p[1] };
	double nearest = distance_to_puddle(radius, direction, p[2]);
	nearest = smooth_least(nearest, distance_to_crown(splash, radius, direction, p[2]), 0.09);
	for (int i = 0; i < splash->count; i++)
		nearest = smooth_least(nearest, distance_to_blob(&splash->blobs[i], p), 0.045);
	return clamp01(0.5 - nearest / (2 * RIM));
}
