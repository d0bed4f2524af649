/* Particles as volumes: the octree and both ways to grid, against brute force and known fields. */
#include "suite.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/captured_log.h"
#include "render/particles/octree.h"
#include "render/particles/particle_grid.h"
#include "render/particles/particle_series.h"
#include "volume_files.h"

/* Marsaglia, "Xorshift RNGs", 2003. */
static double random_share(uint64_t *state)
{
	*state ^= *state << 13;
	*state ^= *state >> 7;
	*state ^= *state << 17;
	return (double)(*state >> 11) / 9007199254740992.0;
}

enum { POINTS = 700 };

/* Even, in clusters, in a plane with many equal ones. */
static void make_points(int kind, float points[POINTS][3])
{
	uint64_t state = 7 + (uint64_t)kind;
	for (int i = 0; i < POINTS; i++)
		for (int axis = 0; axis < 3; axis++) {
			const double share = random_share(&state);
			points[i][axis] = kind == 0 ? (float)share
					  : kind == 1
						  ? (float)(0.01 * share + 0.3 * (i % 4))
						  : (float)(axis == 1 ? 1 : floor(8 * share) / 8);
		}
}

static bool point_in_box(const float point[3], const float least[3], const float greatest[3])
{
	bool inside = true;
	for (int axis = 0; axis < 3; axis++)
		inside = inside && point[axis] >= least[axis] && point[axis] <= greatest[axis];
	return inside;
}

static void check_walk(const struct gz_octree *tree, const float points[POINTS][3], uint64_t *state)
{
	float least[3], greatest[3];
	int seen[POINTS] = { 0 };
	struct gz_octree_walk walk;
	uint32_t first, count, last = 0;
	for (int axis = 0; axis < 3; axis++) {
		least[axis] = (float)(1.2 * random_share(state) - 0.1);
		greatest[axis] = least[axis] + (float)(0.5 * random_share(state));
	}
	gz_octree_walk_begin(&walk, tree, least, greatest);
	while (gz_octree_walk_next(&walk, &first, &count)) {
		assert_true(first >= last && count >= 1);
		last = first + count;
		for (uint32_t i = first; i < first + count; i++)
			seen[tree->order[i]]++;
	}
	for (int i = 0; i < POINTS; i++) {
		assert_true(seen[i] <= 1);
		assert_true(seen[i] == 1 || !point_in_box(points[i], least, greatest));
	}
}

static void check_nearest(const struct gz_octree *tree, const float points[POINTS][3])
{
	for (uint32_t i = 0; i < POINTS; i++) {
		float best = INFINITY;
		for (int k = 0; k < POINTS; k++) {
			const float *a = points[k], *b = points[tree->order[i]];
			const float dx = a[0] - b[0], dy = a[1] - b[1], dz = a[2] - b[2];
			const float squared = dx * dx + dy * dy + dz * dz;
			if ((uint32_t)k != tree->order[i] && squared < best)
				best = squared;
		}
		assert_true(gz_octree_nearest_other(tree, i) == best);
	}
}

static void the_octree_finds_what_is_in_a_box(void **state)
{
	static float points[POINTS][3];
	uint64_t random = 99;
	(void)state;
	for (int kind = 0; kind < 3; kind++)
		for (double edge = 1; edge > 1e-9; edge /= 40) {
			struct gz_octree tree;
			int seen[POINTS] = { 0 };
			make_points(kind, points);
			assert_int_equal(
				gz_octree_build((const float(*)[3])points, POINTS, edge, &tree),
				GZ_OK);
			for (uint32_t i = 0; i < POINTS; i++) {
				seen[tree.order[i]]++;
				for (int axis = 0; axis < 3; axis++)
					assert_true(tree.at[axis][i] ==
						    points[tree.order[i]][axis]);
			}
			for (int i = 0; i < POINTS; i++)
				assert_int_equal(seen[i], 1);
			for (int i = 0; i < 50; i++)
				check_walk(&tree, (const float(*)[3])points, &random);
			check_nearest(&tree, (const float(*)[3])points);
			gz_octree_free(&tree);
		}
	struct gz_octree tree;
	assert_int_equal(gz_octree_build((const float(*)[3])points, 0, 1, &tree), GZ_ERR_INVAL);
}

static void leaves_have_one_point_or_are_small(void **state)
{
	static float points[POINTS][3];
	struct gz_octree tree;
	(void)state;
	make_points(1, points);
	assert_int_equal(gz_octree_build((const float(*)[3])points, POINTS, 1.0 / 64, &tree),
			 GZ_OK);
	uint32_t in_leaves = 0, shared = 0;
	for (uint32_t i = 0; i < tree.node_count; i++) {
		const struct gz_octree_node *node = &tree.nodes[i];
		if (node->children > 0)
			continue;
		in_leaves += node->count;
		shared += node->count > 1;
		for (int axis = 0; axis < 3 && node->count > 1; axis++)
			assert_true(node->greatest[axis] - node->least[axis] <= 1.0F / 64);
	}
	assert_int_equal(in_leaves, POINTS);
	assert_true(shared > 0);
	gz_octree_free(&tree);
}

enum { LIQUID = 400 };

/* A cloud that is denser on one side, far from the origin, with values. */
static void make_liquid_cloud(double positions[LIQUID][3], float values[LIQUID],
			      struct gz_particles *out)
{
	uint64_t state = 12345;
	for (int i = 0; i < LIQUID; i++) {
		for (int axis = 0; axis < 3; axis++)
			positions[i][axis] =
				500 + (3 - axis) * random_share(&state) * random_share(&state);
		values[i] = (float)(1 + 10 * random_share(&state));
	}
	*out = (struct gz_particles) { .count = LIQUID,
				       .positions = positions,
				       .values = values,
				       .time_points = 1,
				       .value_range = { 1, 11 } };
}

/* The middle of the particles' box, which is that of the volume. */
static void find_middle(const struct gz_particles *particles, double out_middle[3])
{
	for (int axis = 0; axis < 3; axis++) {
		double least = INFINITY, greatest = -INFINITY;
		for (size_t i = 0; i < particles->count; i++) {
			least = fmin(least, particles->positions[i][axis]);
			greatest = fmax(greatest, particles->positions[i][axis]);
		}
		out_middle[axis] = (least + greatest) / 2;
	}
}

static void place_voxel(const struct gz_volume *volume, const double middle[3], const int at[3],
			double out_place[3])
{
	for (int axis = 0; axis < 3; axis++)
		out_place[axis] = middle[axis] + (at[axis] - (volume->dims[axis] - 1) / 2.0) *
							 volume->spacing[axis];
}

static double distance_between(const double a[3], const double b[3])
{
	return sqrt((a[0] - b[0]) * (a[0] - b[0]) + (a[1] - b[1]) * (a[1] - b[1]) +
		    (a[2] - b[2]) * (a[2] - b[2]));
}

/* The cubic spline as splashsurf writes it, with its constant. */
static double cubic_spline(double distance, double support)
{
	const double pi = 3.14159265358979323846, q = distance / support;
	const double sigma = 8 / (pi * support * support * support);
	if (q > 1)
		return 0;
	return q <= 0.5 ? sigma * (6 * (q * q * q - q * q) + 1)
			: sigma * 2 * (1 - q) * (1 - q) * (1 - q);
}

static float voxel_at(const struct gz_volume *volume, const int at[3])
{
	return ((const float *)
			volume->voxels)[((size_t)at[2] * (size_t)volume->dims[1] + (size_t)at[1]) *
						(size_t)volume->dims[0] +
					(size_t)at[0]];
}

typedef double oracle_function(const struct gz_particles *particles, const double place[3],
			       const void *user, double got);

/* Call the oracle at each voxel and return the largest difference from it. */
static double worst_voxel(const struct gz_volume *volume, const struct gz_particles *particles,
			  oracle_function *oracle, const void *user)
{
	double worst = 0, middle[3];
	int at[3];
	find_middle(particles, middle);
	const int rows_between = volume->dims[1] > 30 ? 5 : 1; /* of large volumes every fifth */
	for (at[2] = 0; at[2] < volume->dims[2]; at[2]++)
		for (at[1] = at[2] % rows_between; at[1] < volume->dims[1]; at[1] += rows_between)
			for (at[0] = 0; at[0] < volume->dims[0]; at[0]++) {
				double place[3];
				place_voxel(volume, middle, at, place);
				const double got = (double)voxel_at(volume, at);
				worst = fmax(worst,
					     fabs(got - oracle(particles, place, user, got)));
			}
	return worst;
}

struct brute_sum {
	double support;
	double volumes[LIQUID];
};

static double sum_by_force(const struct gz_particles *particles, const double place[3],
			   const void *user, double got)
{
	const struct brute_sum *brute = user;
	double sum = 0;
	(void)got;
	for (size_t i = 0; i < particles->count; i++)
		sum += (particles->values ? (double)particles->values[i] : 1) * brute->volumes[i] *
		       cubic_spline(distance_between(place, particles->positions[i]),
				    brute->support);
	return sum;
}

static void sums_are_those_of_brute_force(void **state)
{
	static double positions[LIQUID][3];
	static float values[LIQUID];
	struct gz_particles particles;
	struct gz_particle_grid grid = gz_particle_grid_preset();
	struct gz_volume volume;
	struct brute_sum brute;
	(void)state;
	make_liquid_cloud(positions, values, &particles);
	grid.radius = 0.08;
	grid.smoothing = 1.8;
	brute.support = 2 * grid.radius * grid.smoothing;
	for (size_t i = 0; i < LIQUID; i++) {
		double density = 0;
		for (size_t k = 0; k < LIQUID; k++)
			density += cubic_spline(distance_between(positions[i], positions[k]),
						brute.support);
		brute.volumes[i] = 1 / density;
	}
	/* Rows of few voxels, and of some hundred. */
	static const int cells[] = { 8, 13, 40, 100 };
	for (size_t i = 0; i < sizeof cells / sizeof cells[0]; i++) {
		grid.cells = cells[i];
		particles.values = i % 2 ? values : NULL;
		assert_int_equal(
			gz_particles_to_volume(&particles, &grid, "p", NULL, NULL, &volume), GZ_OK);
		assert_int_equal(volume.dims[0], cells[i]);
		const double worst = worst_voxel(&volume, &particles, sum_by_force, &brute);
		if (worst > 2e-4 || volume.stored_max < 0.5)
			fail_msg("%d cells: off by %g of %g", cells[i], worst, volume.stored_max);
		gz_volume_free(&volume);
	}
}

/* The nearest particle, or 0 beyond the limit. Two that are equally near but for rounding are both
 * right. */
static double nearest_by_force(const struct gz_particles *particles, const double place[3],
			       const void *user, double got)
{
	const double limit = *(const double *)user;
	double best = INFINITY, right = 0;
	for (size_t i = 0; i < particles->count; i++)
		best = fmin(best, distance_between(place, particles->positions[i]));
	for (size_t i = 0; i < particles->count; i++) {
		const double away = distance_between(place, particles->positions[i]);
		if (away > best + 2e-5 || away > limit + 2e-5)
			continue;
		right = (double)particles->values[i];
		if (right == got)
			break;
	}
	return fabs(best - limit) <= 2e-5 && got == 0 ? 0 : right;
}

static void nearest_particles_are_those_of_brute_force(void **state)
{
	static double positions[LIQUID][3];
	static float values[LIQUID];
	struct gz_particles particles;
	struct gz_volume volume;
	(void)state;
	make_liquid_cloud(positions, values, &particles);
	static const struct {
		int cells;
		double reach;
	} cases[] = { { 8, 1 }, { 40, 1.5 }, { 31, 6 }, { 100, 4 }, { 20, 40 } };
	for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
		struct gz_particle_grid grid = gz_particle_grid_preset();
		grid.gridding = GZ_GRIDDING_NEAREST;
		grid.cells = cases[i].cells;
		grid.reach = cases[i].reach;
		assert_int_equal(
			gz_particles_to_volume(&particles, &grid, "p", NULL, NULL, &volume), GZ_OK);
		const double limit = grid.reach * volume.spacing[0];
		const double worst = worst_voxel(&volume, &particles, nearest_by_force, &limit);
		if (worst != 0)
			fail_msg("%d cells, reach %g: off by %g", grid.cells, grid.reach, worst);
		gz_volume_free(&volume);
	}
}

/* Of equally near particles the first one of the file counts. */
static void the_first_of_equal_particles_counts(void **state)
{
	double positions[3][3] = { { 1, 0, 0 }, { 1, 0, 0 }, { 0, 0, 0 } };
	float values[3] = { 5, 7, 3 };
	const struct gz_particles particles = {
		.count = 3, .positions = positions, .values = values, .time_points = 1
	};
	struct gz_particle_grid grid = gz_particle_grid_preset();
	struct gz_volume volume;
	(void)state;
	grid.gridding = GZ_GRIDDING_NEAREST;
	grid.cells = 9;
	grid.reach = 10;
	assert_int_equal(gz_particles_to_volume(&particles, &grid, "p", NULL, NULL, &volume),
			 GZ_OK);
	for (int x = 0; x < 9; x++) {
		const int at[3] = { x, volume.dims[1] / 2, volume.dims[2] / 2 };
		assert_true(voxel_at(&volume, at) == (x < 4 ? 3 : 5));
	}
	gz_volume_free(&volume);
}

enum { EDGE = 20 };

/* A cube of liquid at rest: particles at distances of 0.05, whose radius is 0.025. */
static struct gz_particles make_cube(double positions[EDGE * EDGE * EDGE][3])
{
	for (int i = 0; i < EDGE * EDGE * EDGE; i++) {
		positions[i][0] = 0.05 * (i % EDGE);
		positions[i][1] = 0.05 * (i / EDGE % EDGE);
		positions[i][2] = 0.05 * (i / EDGE / EDGE);
	}
	return (struct gz_particles) { .count = EDGE * EDGE * EDGE,
				       .positions = positions,
				       .time_points = 1,
				       .value_range = { 1, 1 } };
}

static void a_liquid_at_rest_is_1_inside_and_0_outside(void **state)
{
	static double positions[EDGE * EDGE * EDGE][3];
	const struct gz_particles cube = make_cube(positions);
	struct gz_volume volume;
	double radius = 0, middle[3];
	(void)state;
	find_middle(&cube, middle);
	assert_int_equal(gz_particles_find_radius(&cube, &radius), GZ_OK);
	assert_true(fabs(radius - 0.025) < 0.0005);
	for (int gridding = 0; gridding < GZ_GRIDDING_COUNT; gridding++) {
		struct gz_particle_grid grid = gz_particle_grid_preset();
		grid.gridding = (enum gz_particle_gridding)gridding;
		grid.cells = 96;
		assert_int_equal(gz_particles_to_volume(&cube, &grid, "p", NULL, NULL, &volume),
				 GZ_OK);
		int at[3], inside = 0;
		for (at[2] = 0; at[2] < 96; at[2]++)
			for (at[1] = 0; at[1] < 96; at[1]++)
				for (at[0] = 0; at[0] < 96; at[0]++) {
					double depth = INFINITY;
					double place[3];
					place_voxel(&volume, middle, at, place);
					for (int axis = 0; axis < 3; axis++)
						depth = fmin(depth,
							     fmin(place[axis], 0.95 - place[axis]));
					const double got = (double)voxel_at(&volume, at);
					if (depth > 0.1 && fabs(got - 1) > 0.01)
						fail_msg("%g inside", got);
					if (depth < -0.1001 && got != 0)
						fail_msg("%g outside", got);
					inside += depth > 0.1;
				}
		assert_true(inside > 90000);
		gz_volume_free(&volume);
	}
}

static void threads_do_not_change_a_bit(void **state)
{
	static double positions[LIQUID][3];
	static float values[LIQUID];
	struct gz_particles particles;
	(void)state;
	make_liquid_cloud(positions, values, &particles);
	for (int gridding = 0; gridding < GZ_GRIDDING_COUNT; gridding++) {
		struct gz_volume one = { 0 };
		for (int threads = 1; threads <= 7; threads += 2) {
			struct gz_particle_grid grid = gz_particle_grid_preset();
			struct gz_volume volume;
			grid.gridding = (enum gz_particle_gridding)gridding;
			grid.cells = 90;
			grid.threads = threads;
			grid.portable = threads == 3; /* nor do the processor's instructions */
			assert_int_equal(
				gz_particles_to_volume(&particles, &grid, "p", NULL, NULL, &volume),
				GZ_OK);
			if (threads == 1) {
				one = volume;
				continue;
			}
			assert_memory_equal(one.voxels, volume.voxels, gz_volume_bytes(&one));
			gz_volume_free(&volume);
		}
		gz_volume_free(&one);
	}
}

static void one_particle_is_a_drop(void **state)
{
	double positions[2][3] = { { 1e6, -3, 0 }, { 1e6, -3, 0 } };
	struct gz_particles particles = {
		.count = 1, .positions = positions, .time_points = 1, .value_range = { 1, 1 }
	};
	struct gz_particle_grid grid = gz_particle_grid_preset();
	struct gz_volume volume;
	struct captured_log log;
	(void)state;
	grid.cells = 33;
	for (; particles.count <= 2; particles.count++)
		for (int gridding = 0; gridding < GZ_GRIDDING_COUNT; gridding++) {
			grid.gridding = (enum gz_particle_gridding)gridding;
			captured_log_init(&log, "*:info");
			assert_int_equal(gz_particles_to_volume(&particles, &grid, "p", NULL,
								&log.log, &volume),
					 GZ_OK);
			assert_int_equal(log.messages, 1);
			assert_non_null(strstr(log.last, "no two particles lie apart"));
			const int middle[3] = { 16, 16, 16 }, corner[3] = { 0, 0, 0 };
			assert_true(fabs((double)voxel_at(&volume, middle) - 1) < 1e-6);
			assert_true(voxel_at(&volume, corner) == 0);
			gz_volume_free(&volume);
		}
	particles.count = 0;
	assert_int_equal(gz_particles_to_volume(&particles, &grid, "p", NULL, NULL, &volume),
			 GZ_ERR_INVAL);
}

static void units_are_those_of_the_particles(void **state)
{
	double positions[2][3] = { { 100, 0, 0 }, { 300, 50, 0 } };
	const struct gz_particles particles = { .count = 2,
						.positions = positions,
						.time_points = 1 };
	struct gz_particle_grid grid = gz_particle_grid_preset();
	struct gz_volume volume;
	(void)state;
	grid.cells = 50;
	grid.radius = 10;
	/* 200 long, and 40 more at each end. */
	assert_int_equal(gz_particles_to_volume(&particles, &grid, "p", NULL, NULL, &volume),
			 GZ_OK);
	assert_int_equal(volume.dims[0], 50);
	assert_int_equal(volume.dims[1], 24);
	assert_int_equal(volume.dims[2], 15);
	for (int axis = 0; axis < 3; axis++)
		assert_true(fabs(volume.spacing[axis] - 280.0 / 50) < 1e-9);
	assert_true(volume.type == GZ_VOXEL_F32 && volume.slope == 1 && volume.intercept == 0);
	gz_volume_free(&volume);
}

/* One line, and the result. */
static void check_grid_refused(const struct gz_particles *particles,
			       const struct gz_particle_grid *grid, const char *words)
{
	struct captured_log log;
	struct gz_volume volume;
	captured_log_init(&log, "*:warn");
	const enum gz_result result =
		gz_particles_to_volume(particles, grid, "p", NULL, &log.log, &volume);
	if (result != GZ_ERR_FORMAT || log.messages != 1 || !strstr(log.last, words))
		fail_msg("result %d, %d messages: %s", (int)result, log.messages, log.last);
}

static void radii_that_do_not_fit_are_told(void **state)
{
	enum { MANY = 300000 };
	double(*positions)[3] = calloc(MANY, sizeof *positions);
	struct gz_particles particles = { .count = 3, .positions = positions, .time_points = 1 };
	struct gz_particle_grid grid = gz_particle_grid_preset();
	struct captured_log log;
	struct gz_volume volume;
	(void)state;
	assert_non_null(positions);
	positions[1][0] = 1;
	positions[2][0] = 1e9;
	grid.cells = 16;
	grid.radius = 1;
	check_grid_refused(&particles, &grid, "less than a millionth of the box");
	grid.radius = 1e6;
	captured_log_init(&log, "*:warn");
	assert_int_equal(gz_particles_to_volume(&particles, &grid, "p", NULL, &log.log, &volume),
			 GZ_OK);
	assert_int_equal(log.messages, 1);
	assert_non_null(strstr(log.last, "particles reach only"));
	gz_volume_free(&volume);
	particles.count = MANY;
	grid.radius = 0.1;
	positions[2][0] = 1;
	check_grid_refused(&particles, &grid, "too many particles lie within reach");
	free(positions);
	grid.cells = 7;
	assert_int_equal(gz_particles_to_volume(&particles, &grid, "p", NULL, NULL, &volume),
			 GZ_ERR_INVAL);
}

static bool stop_halfway(void *user, double share, const char *what)
{
	(void)what;
	*(double *)user = share;
	return share < 0.5;
}

static void gridding_can_be_stopped(void **state)
{
	static double positions[EDGE * EDGE * EDGE][3];
	const struct gz_particles cube = make_cube(positions);
	struct gz_volume volume;
	(void)state;
	for (int gridding = 0; gridding < GZ_GRIDDING_COUNT; gridding++) {
		struct gz_particle_grid grid = gz_particle_grid_preset();
		double share = 0;
		const struct gz_loading loading = { .report = stop_halfway, .user = &share };
		grid.gridding = (enum gz_particle_gridding)gridding;
		grid.cells = 128;
		grid.threads = 1;
		assert_int_equal(gz_particles_to_volume(&cube, &grid, "p", &loading, NULL, &volume),
				 GZ_ERR_CANCELLED);
		assert_true(share >= 0.5 && share < 0.6);
	}
}

enum { STEP_PARTICLES = 60, STEPS = 3 };

/* A cloud that shrinks from step to step; densities grow. */
static const char *write_steps(void)
{
	static uint8_t bytes[8 + STEPS * STEP_PARTICLES * 44];
	const uint32_t head[2] = { STEPS, STEP_PARTICLES };
	memcpy(bytes, head, sizeof head); /* tests run on little-endian machines */
	for (int step = 0; step < STEPS; step++) {
		uint64_t state = 5;
		for (int i = 0; i < STEP_PARTICLES; i++) {
			float numbers[11] = { 0 };
			for (int axis = 0; axis < 3; axis++)
				numbers[axis] = (float)(random_share(&state) / (step + 1));
			numbers[9] = (float)(100 * (step + 1) + i);
			memcpy(bytes + 8 + 44 * (step * STEP_PARTICLES + i), numbers,
			       sizeof numbers);
		}
	}
	return files_write("steps.particles", bytes, sizeof bytes);
}

static void time_points_share_grid_and_range(void **state)
{
	const char *path = write_steps();
	(void)state;
	for (int way = 0; way < GZ_GRIDDING_COUNT * 2; way++) {
		struct gz_particle_grid grid = gz_particle_grid_preset();
		struct gz_volume first = { 0 }, volume;
		grid.cells = 24;
		grid.gridding = (enum gz_particle_gridding)(way / 2);
		grid.value = way % 2 ? GZ_PARTICLE_DENSITY : GZ_PARTICLE_FILL;
		for (int step = 0; step < STEPS; step++) {
			const struct gz_loading loading = {
				.time_point = step,
				.number_range = step == 2 ? first.number_range : NULL,
			};
			assert_int_equal(
				gz_particle_volume_load(path, &grid, NULL, &loading, NULL, &volume),
				GZ_OK);
			assert_int_equal(volume.time_points, STEPS);
			assert_int_equal(volume.time_point, step);
			if (step == 0) {
				first = volume;
				continue;
			}
			assert_memory_equal(volume.dims, first.dims, sizeof first.dims);
			assert_memory_equal(volume.spacing, first.spacing, sizeof first.spacing);
			assert_true(volume.stored_min == first.stored_min &&
				    volume.stored_max == first.stored_max);
			assert_true(memcmp(volume.voxels, first.voxels, gz_volume_bytes(&first)) !=
				    0);
			gz_volume_free(&volume);
		}
		const double greatest = way % 2 ? 300 + STEP_PARTICLES - 1 : 1;
		assert_true(first.stored_min == 0 &&
			    first.stored_max == (way / 2 ? 1 : 2) * greatest);
		gz_volume_free(&first);
	}
}

/* Two particles at x = 0 and x = number, whose density is the number. */
static void write_numbered(const char *name, int number, const char *cut)
{
	char text[512];
	const int length = snprintf(
		text, sizeof text,
		"ply\nformat ascii 1.0\nelement vertex %s\nproperty float x\nproperty float y\n"
		"property float z\nproperty float density\nend_header\n0 0 0 %d\n%d 0.5 0.25 %d\n",
		cut, number, number, number);
	files_write(name, text, (size_t)length);
}

/* Numbers with a gap, and with as many digits as they need; beside them other names, and other
 * content under a name of the series. */
static void write_numbered_files(void)
{
	write_numbered("wave_8.ply", 8, "2");
	write_numbered("wave_9.ply", 9, "2");
	write_numbered("wave_010.ply", 10, "2");
	write_numbered("wave_30.ply", 30, "2");
	write_numbered("wave_9b.ply", 99, "2");
	write_numbered("wave_.ply", 99, "2");
	write_numbered("a_wave_31.ply", 99, "2");
	files_write("wave_11.ply", "no particles", 12);
}

static void numbered_files_are_time_points_of_one_grid(void **state)
{
	static const double numbers[] = { 8, 9, 10, 30 };
	struct gz_particle_grid grid = gz_particle_grid_preset();
	struct gz_particle_frame frame = { 0 };
	struct gz_volume first = { 0 }, volume;
	char path[GZ_PATH_SIZE], pattern[GZ_PATH_SIZE];
	(void)state;
	write_numbered_files();
	snprintf(pattern, sizeof pattern, "%s", files_path("wave_%04d.ply"));
	assert_true(gz_particle_series_first(pattern, path));
	assert_string_equal(path, files_path("wave_8.ply"));
	assert_false(gz_particle_series_first(files_path("wave_8.ply"), pattern));
	assert_false(gz_particle_series_first(files_path("none_%d.ply"), pattern));
	grid.cells = 32;
	grid.value = GZ_PARTICLE_DENSITY;
	grid.gridding = GZ_GRIDDING_NEAREST;
	for (int point = 0; point < 4; point++) {
		const struct gz_loading loading = { .time_point = point };
		assert_int_equal(
			gz_particle_volume_load(path, &grid, &frame, &loading, NULL, &volume),
			GZ_OK);
		assert_int_equal(volume.time_points, 4);
		assert_int_equal(volume.time_point, point);
		const float *voxels = volume.voxels;
		double greatest = 0;
		for (size_t i = 0; i < gz_volume_voxel_count(&volume); i++)
			greatest = fmax(greatest, (double)voxels[i]);
		assert_true(greatest == numbers[point]);
		assert_true(volume.stored_min == 0 && volume.stored_max == 30);
		if (point == 0) {
			first = volume;
			continue;
		}
		assert_memory_equal(volume.dims, first.dims, sizeof first.dims);
		assert_memory_equal(volume.spacing, first.spacing, sizeof first.spacing);
		gz_volume_free(&volume);
	}
	assert_int_equal(frame.count, 4);
	assert_true(frame.least[0] == 0 && frame.greatest[0] == 30 && frame.greatest[1] == 0.5);
	const struct gz_loading beyond = { .time_point = 4 };
	assert_int_equal(gz_particle_volume_load(path, &grid, &frame, &beyond, NULL, &volume),
			 GZ_ERR_INVAL);
	gz_volume_free(&first);
}

static void other_files_than_the_first_are_shown_alone(void **state)
{
	struct gz_particle_grid grid = gz_particle_grid_preset();
	struct gz_particle_frame frame = { 0 };
	struct gz_volume volume;
	(void)state;
	write_numbered_files();
	grid.cells = 32;
	for (int i = 0; i < 2; i++) {
		const char *path = files_path(i ? "wave_9b.ply" : "wave_9.ply");
		assert_int_equal(gz_particle_volume_load(path, &grid, &frame, NULL, NULL, &volume),
				 GZ_OK);
		assert_true(volume.time_points <= 1);
		assert_int_equal(frame.count, 0);
		gz_volume_free(&volume);
	}
}

/* A simulation that still writes its last file. */
static void series_ends_before_a_damaged_file(void **state)
{
	struct gz_particle_grid grid = gz_particle_grid_preset();
	struct captured_log log;
	struct gz_volume volume;
	(void)state;
	captured_log_init(&log, NULL);
	write_numbered("rain.1.ply", 1, "2");
	write_numbered("rain.2.ply", 2, "2");
	write_numbered("rain.3.ply", 3, "2000");
	write_numbered("rain.4.ply", 4, "2");
	grid.cells = 32;
	assert_int_equal(gz_particle_volume_load(files_path("rain.1.ply"), &grid, NULL, NULL,
						 &log.log, &volume),
			 GZ_OK);
	assert_int_equal(volume.time_points, 2);
	assert_non_null(strstr(log.last, "rain.3.ply: the series ends before this file"));
	gz_volume_free(&volume);
}

/* The simulations had a radius of 0.025. */
static void real_liquids_have_their_radius(void **state)
{
	static const char *const names[] = { "double_dam_break_frame_01_4732_particles.vtk",
					     "double_dam_break_frame_26_4732_particles.vtk",
					     "dam_break_frame_23_24389_particles.bgeo",
					     "hilbert2_7954_particles.vtk" };
	const char *data = getenv("GAZECAST_DATA");
	(void)state;
	for (size_t i = 0; data && i < sizeof names / sizeof names[0]; i++) {
		struct gz_particles particles;
		double radius = 0;
		char path[2048];
		snprintf(path, sizeof path, "%s/particles/%s", data, names[i]);
		const struct gz_particle_request request = { .path = path };
		if (access(path, F_OK) != 0 || gz_particles_load(&request, &particles) != GZ_OK) {
			print_message("not there: %s\n", path);
			continue;
		}
		assert_int_equal(gz_particles_find_radius(&particles, &radius), GZ_OK);
		print_message("%s: radius %g\n", names[i], radius);
		if (radius < 0.02 || radius > 0.026)
			fail_msg("%s: radius %g", names[i], radius);
		gz_particles_free(&particles);
	}
}

TEST_SUITE(particle_grid)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(the_octree_finds_what_is_in_a_box),
		cmocka_unit_test(leaves_have_one_point_or_are_small),
		cmocka_unit_test(sums_are_those_of_brute_force),
		cmocka_unit_test(nearest_particles_are_those_of_brute_force),
		cmocka_unit_test(the_first_of_equal_particles_counts),
		cmocka_unit_test(a_liquid_at_rest_is_1_inside_and_0_outside),
		cmocka_unit_test(threads_do_not_change_a_bit),
		cmocka_unit_test(one_particle_is_a_drop),
		cmocka_unit_test(units_are_those_of_the_particles),
		cmocka_unit_test(radii_that_do_not_fit_are_told),
		cmocka_unit_test(gridding_can_be_stopped),
		cmocka_unit_test(time_points_share_grid_and_range),
		cmocka_unit_test(numbered_files_are_time_points_of_one_grid),
		cmocka_unit_test(other_files_than_the_first_are_shown_alone),
		cmocka_unit_test(series_ends_before_a_damaged_file),
		cmocka_unit_test(real_liquids_have_their_radius),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
