/* Points spread over meshes: how even every beginning is, and that threads do not matter. */
#include "suite.h"

#include <math.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "base/workers.h"
#include "mesh_fields.h"
#include "mesh_shapes.h"
#include "render/mesh/isosurface.h"
#include "render/mesh/mesh_points.h"

enum { POINTS = 6000 };

static struct gz_mesh surface_of(field_formula *formula)
{
	const int dims[3] = { 48, 48, 48 };
	const double spacing[3] = { 1.1, 1.1, 1.1 };
	struct gz_volume volume = field_volume(formula, dims, spacing, GZ_VOXEL_F32);
	const struct gz_isosurface_request request = { .volume = &volume, .isovalue = 0 };
	struct gz_mesh mesh;
	assert_int_equal(gz_isosurface_make(&request, NULL, NULL, &mesh), GZ_OK);
	gz_volume_free(&volume);
	return mesh;
}

/* Two triangles that are a square of 1 mm at a height, seen from above or below. */
static void add_square(struct gz_mesh *mesh, size_t number, float z, float up)
{
	const float corners[4][2] = { { 0, 0 }, { 1, 0 }, { 1, 1 }, { 0, 1 } };
	const uint32_t first = (uint32_t)(4 * number);
	for (uint32_t i = 0; i < 4; i++) {
		float *place = mesh->positions[first + i], *normal = mesh->normals[first + i];
		place[0] = corners[i][0];
		place[1] = corners[i][1];
		place[2] = z;
		normal[0] = normal[1] = 0;
		normal[2] = up;
	}
	const uint32_t both[2][3] = { { first, first + 1, first + 2 },
				      { first, first + 2, first + 3 } };
	memcpy(mesh->triangles[2 * number], both, sizeof both);
}

static struct gz_mesh squares(size_t count)
{
	struct gz_mesh mesh;
	assert_int_equal(gz_mesh_allocate(4 * count, 2 * count, &mesh), GZ_OK);
	for (size_t i = 0; i < count; i++)
		add_square(&mesh, i, 0.001F * (float)i, i % 2 ? -1 : 1);
	return mesh;
}

static struct gz_mesh_points points_of(const struct gz_mesh *mesh, size_t count)
{
	struct gz_mesh_points points;
	assert_int_equal(gz_mesh_points_make(mesh, count, NULL, NULL, &points), GZ_OK);
	assert_int_equal(points.count, count);
	return points;
}

static float (*places_of(const struct gz_mesh *mesh, const struct gz_mesh_points *points))[3]
{
	float(*places)[3] = malloc(points->count * sizeof *places);
	assert_non_null(places);
	for (size_t i = 0; i < points->count; i++)
		gz_mesh_point_place(mesh, &points->points[i], places[i]);
	return places;
}

static double square_distance(const float a[3], const float b[3])
{
	double sum = 0;
	for (int axis = 0; axis < 3; axis++)
		sum += ((double)a[axis] - (double)b[axis]) * ((double)a[axis] - (double)b[axis]);
	return sum;
}

/* Every beginning of the points keeps apart. */
static void check_apart(field_formula *formula)
{
	struct gz_mesh mesh = surface_of(formula);
	struct gz_mesh_points points = points_of(&mesh, POINTS);
	float(*places)[3] = places_of(&mesh, &points);
	double least = INFINITY;
	for (size_t n = 1; n < POINTS; n++) {
		for (size_t i = 0; i < n; i++)
			least = fmin(least, square_distance(places[i], places[n]));
		const double apart = sqrt(least) / sqrt(points.area_mm2 / (double)(n + 1));
		if (n >= 100 && apart < GZ_MESH_POINTS_APART)
			fail_msg("the first %zu points are %.3f apart", n + 1, apart);
	}
	free(places);
	gz_mesh_points_free(&points);
	gz_mesh_free(&mesh);
}

static void points_of_a_ball_keep_apart(void **state)
{
	(void)state;
	check_apart(field_ball);
}

static void points_of_a_ring_keep_apart(void **state)
{
	(void)state;
	check_apart(field_ring);
}

static void any_beginning_covers_the_surface(void **state)
{
	(void)state;
	/* Measured: 1.17 distances of rows. Points at random places leave gaps of 1.6. */
	struct gz_mesh mesh = squares(1);
	struct gz_mesh_points points = points_of(&mesh, POINTS);
	float(*places)[3] = places_of(&mesh, &points);
	for (size_t n = 100; n <= POINTS; n = 3 * n / 2) {
		double farthest = 0;
		for (int y = 0; y < 30; y++)
			for (int x = 0; x < 30; x++) {
				const float at[3] = { (float)x / 29, (float)y / 29, 0 };
				double nearest = INFINITY;
				for (size_t i = 0; i < n; i++)
					nearest = fmin(nearest, square_distance(at, places[i]));
				farthest = fmax(farthest, nearest);
			}
		if (sqrt(farthest * (double)n) > 1.3)
			fail_msg("the first %zu points leave a gap of radius %.2f", n,
				 sqrt(farthest * (double)n));
	}
	free(places);
	gz_mesh_points_free(&points);
	gz_mesh_free(&mesh);
}

/* Power at a frequency (u, v) as a share of that of points at random places. */
static double power_at(const float (*places)[3], size_t count, double u, double v)
{
	double real = 0, imaginary = 0;
	for (size_t i = 0; i < count; i++) {
		const double angle = 2 * 3.14159265358979323846 *
				     (u * (double)places[i][0] + v * (double)places[i][1]);
		real += cos(angle);
		imaginary += sin(angle);
	}
	return (real * real + imaginary * imaginary) / (double)count;
}

/* Mean power at whole frequencies from least to most, in cycles an edge of the square. */
static double mean_power(const float (*places)[3], size_t count, double least, double most)
{
	double sum = 0;
	int terms = 0;
	for (int v = 0; v <= (int)most; v++)
		for (int u = 1; u <= (int)most; u++) {
			const double radius = hypot(u, v);
			if (radius < least || radius > most)
				continue;
			sum += power_at(places, count, u, v);
			terms++;
		}
	return sum / terms;
}

static void spectrum_of_any_beginning_has_the_gap_of_blue_noise(void **state)
{
	(void)state;
	struct gz_mesh mesh = squares(1);
	struct gz_mesh_points points = points_of(&mesh, 1500);
	float(*places)[3] = places_of(&mesh, &points);
	const size_t counts[4] = { 400, 523, 741, 1500 };
	for (size_t i = 0; i < 4; i++) {
		const double peak = sqrt((double)counts[i]); /* frequency of the points' distance */
		const float(*some)[3] = (const float(*)[3])places;
		const double low = mean_power(some, counts[i], 2, 0.5 * peak);
		const double ring = mean_power(some, counts[i], 0.9 * peak, 1.3 * peak);
		if (low > 0.15 || ring < 1.0)
			fail_msg("%zu points: power %.3f below half the peak, %.3f around it",
				 counts[i], low, ring);
	}
	free(places);
	gz_mesh_points_free(&points);
	gz_mesh_free(&mesh);
}

/* Directions of the first points of a ball around the origin. */
static void find_directions(const struct gz_mesh *mesh, const struct gz_mesh_points *points,
			    size_t count, double (*directions)[3])
{
	for (size_t i = 0; i < count; i++) {
		float place[3];
		double square = 0;
		gz_mesh_point_place(mesh, &points->points[i], place);
		for (int axis = 0; axis < 3; axis++)
			square += (double)place[axis] * (double)place[axis];
		for (int axis = 0; axis < 3; axis++)
			directions[i][axis] = (double)place[axis] / sqrt(square);
	}
}

/* The spectrum on the sphere: the mean square of the points' spherical harmonics of each degree, by
 * the addition theorem sum over i, j of P_l(cos between i and j) / count. That of random points is
 * 1 for every degree. */
static void find_spherical_spectrum(const double (*directions)[3], size_t count, int degrees,
				    double *out_power)
{
	for (int l = 0; l < degrees; l++)
		out_power[l] = 1; /* of each point with itself */
	for (size_t i = 0; i < count; i++)
		for (size_t k = 0; k < i; k++) {
			const double x = directions[i][0] * directions[k][0] +
					 directions[i][1] * directions[k][1] +
					 directions[i][2] * directions[k][2];
			double before = 1, now = x;
			for (int l = 1; l < degrees; l++) {
				out_power[l] += 2 * now / (double)count;
				const double next = ((2 * l + 1) * x * now - l * before) / (l + 1);
				before = now;
				now = next;
			}
		}
}

static double mean_of_degrees(const double *power, double from, double to)
{
	double sum = 0;
	int count = 0;
	for (int l = (int)ceil(from); l < (int)to; l++, count++)
		sum += power[l];
	return sum / count;
}

/* On a surface that is bent all over there is the gap, too. */
static void spectrum_on_a_ball_has_the_gap_of_blue_noise(void **state)
{
	(void)state;
	enum { DEGREES = 120 };
	static double directions[2000][3], power[DEGREES];
	const size_t counts[] = { 300, 700, 2000 };
	struct gz_mesh mesh = surface_of(field_ball);
	struct gz_mesh_points points = points_of(&mesh, 2000);
	for (size_t i = 0; i < 3; i++) {
		/* the degree whose wave is as long as the points' distance in a square lattice */
		const double ring = sqrt(3.14159265 * (double)counts[i]);
		find_directions(&mesh, &points, counts[i], directions);
		find_spherical_spectrum((const double(*)[3])directions, counts[i], DEGREES, power);
		const double gap = mean_of_degrees(power, 0.1 * ring, 0.6 * ring);
		const double peak = mean_of_degrees(power, 0.9 * ring, 1.2 * ring);
		print_message("%zu points: gap %.3f, peak %.3f\n", counts[i], gap, peak);
		assert_true(gap < 0.15);
		assert_true(peak > 1.1);
	}
	gz_mesh_points_free(&points);
	gz_mesh_free(&mesh);
}

static void two_sides_of_a_thin_sheet_have_points_each(void **state)
{
	(void)state;
	struct gz_mesh mesh = squares(2); /* 0.001 mm apart, turned away from each other */
	struct gz_mesh_points points = points_of(&mesh, 1000);
	size_t upper = 0;
	for (size_t i = 0; i < points.count; i++)
		upper += points.points[i].triangle < 2;
	assert_in_range(upper, 450, 550);
	gz_mesh_points_free(&points);
	gz_mesh_free(&mesh);
}

static void points_lie_within_their_triangles(void **state)
{
	(void)state;
	struct gz_mesh mesh = surface_of(field_ring);
	struct gz_mesh_points points = points_of(&mesh, 1000);
	for (size_t i = 0; i < points.count; i++) {
		const float *across = points.points[i].across;
		assert_true(points.points[i].triangle < mesh.triangle_count);
		assert_true(across[0] >= 0 && across[1] >= 0 && across[0] + across[1] <= 1);
	}
	gz_mesh_points_free(&points);
	gz_mesh_free(&mesh);
}

static void points_are_the_same_for_any_number_of_threads(void **state)
{
	(void)state;
	struct gz_mesh mesh = surface_of(field_ball);
	struct gz_mesh_points alone = points_of(&mesh, POINTS), shared;
	struct gz_workers *workers;
	assert_int_equal(gz_workers_create(3, &workers), GZ_OK);
	assert_int_equal(gz_mesh_points_make(&mesh, POINTS, workers, NULL, &shared), GZ_OK);
	assert_int_equal(shared.count, alone.count);
	assert_memory_equal(shared.points, alone.points, POINTS * sizeof *alone.points);
	gz_workers_destroy(&workers);
	gz_mesh_points_free(&shared);
	gz_mesh_points_free(&alone);
	gz_mesh_free(&mesh);
}

static void mesh_without_area_has_no_points(void **state)
{
	(void)state;
	struct gz_mesh mesh = squares(1);
	struct gz_mesh_points points;
	for (size_t i = 0; i < 4; i++)
		mesh.positions[i][1] = 0; /* all on a line */
	assert_int_equal(gz_mesh_points_make(&mesh, 10, NULL, NULL, &points), GZ_OK);
	assert_int_equal(points.count, 0);
	assert_null(points.points);
	gz_mesh_free(&mesh);
	const struct gz_mesh empty = { 0 };
	assert_int_equal(gz_mesh_points_make(&empty, 10, NULL, NULL, &points), GZ_OK);
	assert_int_equal(points.count, 0);
}

static void triangles_without_area_get_no_points(void **state)
{
	(void)state;
	struct gz_mesh mesh = squares(3);
	for (size_t i = 4; i < 8; i++)
		mesh.positions[i][0] = 5;
	struct gz_mesh_points points = points_of(&mesh, 500);
	for (size_t i = 0; i < points.count; i++)
		assert_true(points.points[i].triangle / 2 != 1);
	assert_float_equal(points.area_mm2, 2, 1e-9);
	gz_mesh_points_free(&points);
	gz_mesh_free(&mesh);
}

static void more_points_than_allowed_are_refused(void **state)
{
	(void)state;
	struct gz_mesh mesh = squares(1);
	struct gz_mesh_points points;
	assert_int_equal(gz_mesh_points_make(&mesh, GZ_MESH_POINTS_MAX + 1, NULL, NULL, &points),
			 GZ_ERR_INVAL);
	gz_mesh_free(&mesh);
}

static void *stop_soon(void *user)
{
	const struct timespec soon = { .tv_nsec = 20 * 1000 * 1000 };
	(void)nanosleep(&soon, NULL);
	atomic_store((atomic_bool *)user, true);
	return NULL;
}

/* As many points as there can be take many seconds. */
static void long_work_ends_when_it_is_stopped(void **state)
{
	(void)state;
	struct gz_mesh mesh = mesh_ball(30, 4);
	struct gz_mesh_points points = { 0 };
	struct gz_workers *workers = NULL;
	pthread_t thread;
	atomic_bool stop = false;
	assert_int_equal(gz_workers_create(2, &workers), GZ_OK);
	assert_int_equal(pthread_create(&thread, NULL, stop_soon, &stop), 0);
	assert_int_equal(gz_mesh_points_make(&mesh, GZ_MESH_POINTS_MAX, workers, &stop, &points),
			 GZ_ERR_CANCELLED);
	(void)pthread_join(thread, NULL);
	assert_null(points.points);
	/* One that is stopped before it begins does nothing. */
	assert_int_equal(gz_mesh_points_make(&mesh, 10, NULL, &stop, &points), GZ_ERR_CANCELLED);
	atomic_store(&stop, false);
	assert_int_equal(gz_mesh_points_make(&mesh, 10, NULL, &stop, &points), GZ_OK);
	assert_int_equal(points.count, 10);
	gz_mesh_points_free(&points);
	gz_workers_destroy(&workers);
	gz_mesh_free(&mesh);
}

TEST_SUITE(mesh_points)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(points_of_a_ball_keep_apart),
		cmocka_unit_test(points_of_a_ring_keep_apart),
		cmocka_unit_test(any_beginning_covers_the_surface),
		cmocka_unit_test(spectrum_of_any_beginning_has_the_gap_of_blue_noise),
		cmocka_unit_test(spectrum_on_a_ball_has_the_gap_of_blue_noise),
		cmocka_unit_test(two_sides_of_a_thin_sheet_have_points_each),
		cmocka_unit_test(points_lie_within_their_triangles),
		cmocka_unit_test(points_are_the_same_for_any_number_of_threads),
		cmocka_unit_test(mesh_without_area_has_no_points),
		cmocka_unit_test(triangles_without_area_get_no_points),
		cmocka_unit_test(more_points_than_allowed_are_refused),
		cmocka_unit_test(long_work_ends_when_it_is_stopped),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
