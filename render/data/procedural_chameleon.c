/* A row of the volume is drawn tube by tube: each lowers the distance to its kind of tissue where
 * its box lies, and distances become densities at the end. So a voxel costs what lies near it. Only
 * + - * / and sqrt are used, for the same bits on every machine. x is across the animal, y up, z
 * towards the head; all shapes and numbers are chosen by eye. */
#include "render/data/procedural.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum tissue { BODY, SKULL, BONE, TISSUES };

enum { TUBES_MAX = 2048, ROW_MAX = 1024, SPINE_SEGMENTS = 10, TAIL_SEGMENTS = 96 };

/* Beyond the surface to which distances are wanted: skin is bumpy, edges are soft. */
static const double margin = 0.02;
static const double far_away = 1;

/* From a to b, thickness changing evenly. Across the animal it is `flat` times as thin. */
struct tube {
	double a[3], along[3], per_length2;
	double radius, radius_change;
	double flat;
	double least[3], greatest[3];
	enum tissue tissue;
};

struct gz_chameleon {
	double edge; /* over which a surface goes from nothing to full density */
	int count;
	struct tube tubes[TUBES_MAX];
};

/* Where the middle of the body goes from nose to root of the tail: z, y, radius, flatness. */
static const double spine[][4] = {
	{ 0.885, 0.100, 0.030, 1.3 },   { 0.835, 0.115, 0.058, 1.3 },
	{ 0.770, 0.145, 0.088, 1.3 },   { 0.700, 0.175, 0.112, 1.35 },
	{ 0.620, 0.205, 0.130, 1.45 },  { 0.540, 0.220, 0.122, 1.5 },
	{ 0.470, 0.180, 0.112, 1.4 },   { 0.390, 0.150, 0.130, 1.4 },
	{ 0.270, 0.145, 0.185, 1.5 },   { 0.110, 0.155, 0.235, 1.6 },
	{ -0.060, 0.145, 0.245, 1.6 },  { -0.210, 0.095, 0.200, 1.55 },
	{ -0.330, 0.035, 0.135, 1.4 },  { -0.430, -0.020, 0.088, 1.2 },
	{ -0.500, -0.060, 0.068, 1.1 },
};
enum { SPINE_POINTS = sizeof spine / sizeof *spine };

/* A tube from a to b that is to be added. */
struct new_tube {
	const double *a, *b;
	double radius_a, radius_b;
	double flat; /* how many times thinner it is across the animal */
};

static void add_flat_tube(struct gz_chameleon *c, enum tissue tissue, const struct new_tube *tube)
{
	if (c->count == TUBES_MAX)
		return; /* the tests count them */
	const double *a = tube->a, *b = tube->b, flat = tube->flat;
	const double radius_a = tube->radius_a, radius_b = tube->radius_b;
	struct tube *t = &c->tubes[c->count++];
	double length2 = 0;
	for (int i = 0; i < 3; i++) {
		double wide = (radius_a > radius_b ? radius_a : radius_b) + margin;
		t->a[i] = a[i];
		t->along[i] = b[i] - a[i];
		t->least[i] = (a[i] < b[i] ? a[i] : b[i]) - wide;
		t->greatest[i] = (a[i] > b[i] ? a[i] : b[i]) + wide;
		double along = i == 0 ? t->along[0] * flat : t->along[i];
		length2 += along * along;
	}
	t->per_length2 = length2 > 0 ? 1 / length2 : 0;
	t->radius = radius_a;
	t->radius_change = radius_b - radius_a;
	t->flat = flat;
	t->tissue = tissue;
}

static void add_tube(struct gz_chameleon *c, enum tissue tissue, const double a[3],
		     const double b[3], double radius_a, double radius_b)
{
	add_flat_tube(c, tissue, &(struct new_tube) { a, b, radius_a, radius_b, 1 });
}

/* On both sides of the animal. */
static void add_tube_pair(struct gz_chameleon *c, enum tissue tissue, const double a[3],
			  const double b[3], double radius_a, double radius_b)
{
	const double mirrored_a[3] = { -a[0], a[1], a[2] }, mirrored_b[3] = { -b[0], b[1], b[2] };
	add_tube(c, tissue, a, b, radius_a, radius_b);
	add_tube(c, tissue, mirrored_a, mirrored_b, radius_a, radius_b);
}

/* Catmull and Rom's curve through the points of the spine, at t between point i and the next. */
static void spine_at(int i, double t, double out[4])
{
	int before = i > 0 ? i - 1 : 0, after = i + 2 < SPINE_POINTS ? i + 2 : SPINE_POINTS - 1;
	for (int k = 0; k < 4; k++) {
		double p = spine[before][k], q = spine[i][k], r = spine[i + 1][k],
		       s = spine[after][k];
		out[k] = q + 0.5 * t *
				     (r - p +
				      t * (2 * p - 5 * q + 4 * r - s + t * (3 * (q - r) + s - p)));
	}
}

static void add_vertebra(struct gz_chameleon *c, double y, double z, double radius, double spike)
{
	const double middle[3] = { 0, y, z }, tip[3] = { 0, y + spike, z - 0.4 * spike };
	const double side[3] = { 0.8 * spike, y + 0.2 * spike, z - 0.2 * spike };
	add_tube(c, BONE, middle, middle, radius, radius);
	add_tube(c, BONE, middle, tip, 0.35 * radius, 0.0014);
	add_tube_pair(c, BONE, middle, side, 0.3 * radius, 0.0014);
}

/* One pair of ribs: half an ellipse within the skin, hanging from the spine and swept back. */
static void add_ribs(struct gz_chameleon *c, const double at[4])
{
	enum { PIECES = 14 };
	const double turn_cos = 0.98078528040323043, turn_sin = 0.19509032201612825; /* 11.25° */
	const double tall = 0.80 * at[2], wide = 0.84 * at[2] / at[3];
	double cosine = 1, sine = 0, from[3] = { 0, at[1] + tall, at[0] };
	for (int i = 1; i <= PIECES; i++) {
		double turned = cosine * turn_cos - sine * turn_sin;
		sine = sine * turn_cos + cosine * turn_sin;
		cosine = turned;
		double to[3] = { wide * sine, at[1] + tall * cosine, at[0] - 0.05 * (1 - cosine) };
		add_tube_pair(c, BONE, from, to, 0.0076 - 0.0004 * (i - 1), 0.0076 - 0.0004 * i);
		memcpy(from, to, sizeof from);
	}
}

/* Spikes along the back, thinner than a voxel at their tips. */
static void add_crest(struct gz_chameleon *c, const double at[4], double side, double length)
{
	const double root[3] = { 0, at[1] + side * (at[2] - 0.006), at[0] };
	const double tip[3] = { 0, at[1] + side * (at[2] + length), at[0] - 0.3 * length };
	add_tube(c, BODY, root, tip, 0.011, 0.0012);
}

static void add_body(struct gz_chameleon *c)
{
	double from[4], to[4];
	spine_at(0, 0, from);
	for (int i = 0; i < SPINE_POINTS - 1; i++)
		for (int k = 1; k <= SPINE_SEGMENTS; k++) {
			spine_at(i, (double)k / SPINE_SEGMENTS, to);
			const double a[3] = { 0, from[1], from[0] }, b[3] = { 0, to[1], to[0] };
			const double flat = 0.5 * (from[3] + to[3]);
			add_flat_tube(c, BODY, &(struct new_tube) { a, b, from[2], to[2], flat });
			if (i < 5)
				add_flat_tube(c, SKULL,
					      &(struct new_tube) { a, b, 0.80 * from[2],
								   0.80 * to[2], flat });
			if (i >= 5 && k % 3 == 1)
				add_vertebra(c, to[1] + 0.80 * to[2] - 0.012, to[0],
					     0.011 + 0.03 * to[2], 0.045);
			if (i >= 7 && i < 12 && k % 3 == 1)
				add_ribs(c, to);
			if (i >= 5 && k % 3 == 0)
				add_crest(c, to, 1, 0.024);
			if (i < 7 && i > 0 && k % 5 == 0)
				add_crest(c, to, -1, 0.018);
			memcpy(from, to, sizeof from);
		}
}

/* The tail leaves the body downwards and rolls up: a point turns 9° a piece round a centre and
 * comes nearer to it. */
static void add_tail(struct gz_chameleon *c)
{
	const double turn_cos = 0.98768834059513777, turn_sin = 0.15643446504023087;
	const double centre[2] = { -0.400, -0.440 };
	double z = -0.30, y = 0.95, from[3] = { 0, -0.060, -0.500 }, thick = 0.068;
	for (int i = 0; i < TAIL_SEGMENTS; i++) {
		double share = (double)i / TAIL_SEGMENTS, radius = 0.385 * (1 - share) + 0.030;
		double thinner = 0.068 * (1 - share) + 0.012;
		double size = sqrt(z * z + y * y);
		double to[3] = { 0, centre[1] + radius * y / size, centre[0] + radius * z / size };
		add_tube(c, BODY, from, to, thick, thinner);
		add_tube(c, BONE, from, to, 0.10 * thick + 0.001, 0.10 * thinner + 0.001);
		if (i % 2 == 0)
			add_vertebra(c, to[1], to[2], 0.26 * thinner, 0.55 * thinner);
		double turned = z * turn_cos - y * turn_sin;
		y = y * turn_cos + z * turn_sin;
		z = turned;
		thick = thinner;
		memcpy(from, to, sizeof from);
	}
}

static void add_limb(struct gz_chameleon *c, const double a[3], const double b[3], double radius_a,
		     double radius_b)
{
	const double bone = 0.24 * radius_b;
	add_tube_pair(c, BODY, a, b, radius_a, radius_b);
	add_tube_pair(c, BONE, a, b, bone, 0.9 * bone);
	add_tube_pair(c, BONE, a, a, 1.7 * bone, 1.7 * bone);
	add_tube_pair(c, BONE, b, b, 1.6 * bone, 1.6 * bone);
}

/* Two bundles of toes that hold against each other, on a foot at `ankle`. */
static void add_toes(struct gz_chameleon *c, const double ankle[3])
{
	static const double ways[5][3] = { { -0.035, -0.055, 0.060 },
					   { 0.000, -0.060, 0.066 },
					   { 0.034, -0.056, 0.058 },
					   { -0.020, -0.058, -0.056 },
					   { 0.022, -0.060, -0.054 } };
	for (int i = 0; i < 5; i++) {
		const double *way = ways[i];
		double knuckle[3], tip[3], claw[3];
		for (int k = 0; k < 3; k++) {
			knuckle[k] = ankle[k] + 0.6 * way[k];
			tip[k] = ankle[k] + way[k] - (k == 1 ? 0.012 : 0);
			claw[k] = tip[k] + (k == 1 ? -0.024 : 0.1 * way[k]);
		}
		add_tube_pair(c, BODY, ankle, knuckle, 0.024, 0.017);
		add_tube_pair(c, BODY, knuckle, tip, 0.017, 0.012);
		add_tube_pair(c, BODY, tip, claw, 0.008, 0.0012);
		add_tube_pair(c, BONE, ankle, knuckle, 0.004, 0.0035);
		add_tube_pair(c, BONE, knuckle, tip, 0.0035, 0.0025);
		add_tube_pair(c, BONE, knuckle, knuckle, 0.0055, 0.0055);
	}
}

static void add_legs(struct gz_chameleon *c)
{
	static const double legs[2][4][3] = {
		{ { 0.085, 0.060, 0.310 },
		  { 0.190, -0.105, 0.215 },
		  { 0.165, -0.300, 0.350 },
		  { 0.160, -0.345, 0.370 } },
		{ { 0.060, -0.010, -0.360 },
		  { 0.195, -0.120, -0.175 },
		  { 0.160, -0.310, -0.225 },
		  { 0.155, -0.350, -0.200 } },
	};
	for (int i = 0; i < 2; i++) {
		add_limb(c, legs[i][0], legs[i][1], 0.066, 0.044);
		add_limb(c, legs[i][1], legs[i][2], 0.044, 0.028);
		add_limb(c, legs[i][2], legs[i][3], 0.028, 0.026);
		add_toes(c, legs[i][3]);
	}
}

/* Turrets of the eyes with their lenses, jaws, and the bars that hold the casque. */
static void add_chameleon_head(struct gz_chameleon *c)
{
	static const double eye[3] = { 0.068, 0.172, 0.722 }, pupil[3] = { 0.108, 0.176, 0.732 };
	static const double jaw[4][3] = { { 0.046, 0.125, 0.560 },
					  { 0.048, 0.105, 0.660 },
					  { 0.034, 0.093, 0.770 },
					  { 0.006, 0.091, 0.862 } };
	static const double casque[3][3] = { { 0.050, 0.190, 0.620 },
					     { 0.030, 0.285, 0.560 },
					     { 0.000, 0.335, 0.500 } };
	add_tube_pair(c, BODY, eye, pupil, 0.056, 0.034);
	add_tube_pair(c, BONE, pupil, pupil, 0.011, 0.011);
	for (int i = 0; i < 3; i++)
		add_tube_pair(c, BONE, jaw[i], jaw[i + 1], 0.010 - 0.002 * i, 0.008 - 0.002 * i);
	for (int i = 0; i < 2; i++) {
		add_tube_pair(c, BONE, casque[i], casque[i + 1], 0.007, 0.006);
		add_tube_pair(c, BODY, casque[i], casque[i + 1], 0.068 - 0.018 * i,
			      0.050 - 0.014 * i);
	}
}

/* Lower the distance of each x of the row to the distance to the tube's surface. */
static void draw_tube(const struct tube *t, const struct gz_chameleon_row *row, double *distances)
{
	const double first = row->first, step = row->step;
	const int count = row->count;
	const double before = ceil((t->least[0] - first) / step),
		     after = floor((t->greatest[0] - first) / step);
	const int from = before > 0 ? (before < count ? (int)before : count) : 0;
	const int to = after < count - 1 ? (int)after : count - 1;
	const double dy = row->y - t->a[1], dz = row->z - t->a[2];
	for (int i = from; i <= to; i++) {
		double dx = t->flat * (first + step * i - t->a[0]);
		double across = t->flat * t->along[0];
		double share = (dx * across + dy * t->along[1] + dz * t->along[2]) * t->per_length2;
		share = share < 0 ? 0 : share > 1 ? 1 : share;
		double rx = dx - share * across, ry = dy - share * t->along[1],
		       rz = dz - share * t->along[2];
		double distance =
			sqrt(rx * rx + ry * ry + rz * rz) - t->radius - share * t->radius_change;
		distances[i] = distance < distances[i] ? distance : distances[i];
	}
}

/* 1 inside, 0 outside, even between. */
static double covered(double distance, double edge)
{
	double share = 0.5 - distance / edge;
	return share < 0 ? 0 : share > 1 ? 1 : share;
}

/* An ellipsoid with axes along x, y, z. */
struct ellipsoid {
	double centre[3], radius[3];
};

/* Above 0 inside. */
static double inside_ellipsoid(const double p[3], const struct ellipsoid *e)
{
	double u = (p[0] - e->centre[0]) / e->radius[0], v = (p[1] - e->centre[1]) / e->radius[1],
	       w = (p[2] - e->centre[2]) / e->radius[2];
	return 1 - (u * u + v * v + w * w);
}

/* Of soft tissue `depth` beneath the skin: skin, a layer of fat, muscles, and air in the lungs. */
static double soft_density(double depth, const double p[3])
{
	if (depth < 0.014)
		return 0.44;
	if (depth < 0.026)
		return 0.44 - 0.20 * (depth - 0.014) / 0.012;
	double side = p[0] < 0 ? -0.055 : 0.055;
	const struct ellipsoid lungs = { { side, 0.17, 0.16 }, { 0.05, 0.11, 0.15 } };
	double lung = inside_ellipsoid(p, &lungs);
	if (lung > 0)
		return 0.08 + 0.16 * (lung < 0.1 ? 1 - 10 * lung : 0);
	const double grain[3] = { 42 * p[0], 42 * p[1], 14 * p[2] };
	return 0.27 + 0.05 * gz_noise(grain);
}

/* The skull is a shell, open at the eyes and at the nostrils. */
static double skull_covered(double distance, const double p[3], double edge)
{
	double shell = fabs(distance) - 0.006;
	if (shell > edge)
		return 0;
	double side = p[0] < 0 ? -1 : 1;
	const struct ellipsoid openings[] = {
		{ { side * 0.075, 0.172, 0.722 }, { 0.055, 0.062, 0.066 } },
		{ { side * 0.030, 0.135, 0.850 }, { 0.020, 0.016, 0.024 } },
		{ { side * 0.085, 0.215, 0.590 }, { 0.050, 0.046, 0.042 } },
	};
	for (int i = 0; i < 3; i++)
		if (inside_ellipsoid(p, &openings[i]) > 0)
			return 0;
	return covered(shell, edge);
}

static double density(const double distances[TISSUES], const double p[3], double edge)
{
	double body = distances[BODY], value = 0;
	if (body < margin && body > -margin) {
		const double scales[3] = { 55 * p[0], 55 * p[1], 55 * p[2] };
		body -= 0.0045 * gz_noise(scales);
	}
	double skin = covered(body, edge);
	if (skin > 0)
		value = skin * soft_density(-body, p);
	double bone = 0.86 * covered(distances[BONE], edge);
	double skull = 0.78 * skull_covered(distances[SKULL], p, edge);
	bone = bone > skull ? bone : skull;
	return value > bone ? value : bone;
}

enum gz_result gz_chameleon_create(double voxel_length, struct gz_chameleon **out_chameleon)
{
	struct gz_chameleon *c = calloc(1, sizeof *c);
	if (!c)
		return GZ_ERR_NO_MEM;
	c->edge = 1.6 * voxel_length;
	add_body(c);
	add_tail(c);
	add_legs(c);
	add_chameleon_head(c);
	*out_chameleon = c;
	return GZ_OK;
}

void gz_chameleon_destroy(struct gz_chameleon **chameleon)
{
	free(*chameleon);
	*chameleon = NULL;
}

/* At most ROW_MAX values. */
static void draw_part_of_row(const struct gz_chameleon *c, const struct gz_chameleon_row *row,
			     float *out_values)
{
	double rows[TISSUES][ROW_MAX];
	const double y = row->y, z = row->z;
	const int count = row->count;
	bool near = false;
	for (int k = 0; k < TISSUES; k++)
		for (int i = 0; i < count; i++)
			rows[k][i] = far_away;
	for (int i = 0; i < c->count; i++) {
		const struct tube *t = &c->tubes[i];
		if (y < t->least[1] || y > t->greatest[1] || z < t->least[2] || z > t->greatest[2])
			continue;
		near = true;
		draw_tube(t, row, rows[t->tissue]);
	}
	memset(out_values, 0, sizeof *out_values * (size_t)count);
	for (int i = 0; near && i < count; i++) {
		const double p[3] = { row->first + row->step * i, y, z };
		const double distances[TISSUES] = { rows[BODY][i], rows[SKULL][i], rows[BONE][i] };
		if (distances[BODY] < far_away || distances[BONE] < far_away)
			out_values[i] = (float)density(distances, p, c->edge);
	}
}

void gz_chameleon_draw_row(const struct gz_chameleon *chameleon, const struct gz_chameleon_row *row,
			   float *out_values)
{
	for (int i = 0; i < row->count; i += ROW_MAX) {
		struct gz_chameleon_row part = *row;
		part.count = row->count - i < ROW_MAX ? row->count - i : ROW_MAX;
		part.first = row->first + row->step * i;
		draw_part_of_row(chameleon, &part, out_values + i);
	}
}
