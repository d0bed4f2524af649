/* Distances of points from a mesh, against a search of all triangles. */
#include "suite.h"

#include <math.h>
#include <stdlib.h>

#include "mesh_fields.h"
#include "mesh_shapes.h"
#include "render/mesh/distance/mesh_distance.h"

/* Squared distance of a point from a triangle, by another way than the function's: the nearest
 * point by regions of the triangle's plane (Ericson, Real-Time Collision Detection, 5.1.5). */
static double plain_distance2(const double p[3], const double a[3], const double b[3],
			      const double c[3])
{
	double ab[3], ac[3], ap[3], bp[3], cp[3], near[3];
	double d1 = 0, d2 = 0, d3 = 0, d4 = 0, d5 = 0, d6 = 0, s = 0, t = 0;
	for (int i = 0; i < 3; i++) {
		ab[i] = b[i] - a[i];
		ac[i] = c[i] - a[i];
		ap[i] = p[i] - a[i];
		bp[i] = p[i] - b[i];
		cp[i] = p[i] - c[i];
		d1 += ab[i] * ap[i];
		d2 += ac[i] * ap[i];
		d3 += ab[i] * bp[i];
		d4 += ac[i] * bp[i];
		d5 += ab[i] * cp[i];
		d6 += ac[i] * cp[i];
	}
	const double va = d3 * d6 - d5 * d4, vb = d5 * d2 - d1 * d6, vc = d1 * d4 - d3 * d2;
	if (d1 <= 0 && d2 <= 0) {
		s = t = 0;
	} else if (d3 >= 0 && d4 <= d3) {
		s = 1;
	} else if (vc <= 0 && d1 >= 0 && d3 <= 0) {
		s = d1 / (d1 - d3);
	} else if (d6 >= 0 && d5 <= d6) {
		t = 1;
	} else if (vb <= 0 && d2 >= 0 && d6 <= 0) {
		t = d2 / (d2 - d6);
	} else if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) {
		t = (d4 - d3) / (d4 - d3 + d5 - d6);
		s = 1 - t;
	} else {
		s = vb / (va + vb + vc);
		t = vc / (va + vb + vc);
	}
	double sum = 0;
	for (int i = 0; i < 3; i++) {
		near[i] = a[i] + s * ab[i] + t * ac[i];
		sum += (p[i] - near[i]) * (p[i] - near[i]);
	}
	return sum;
}

static double search_all(const struct gz_mesh *mesh, const float place[3])
{
	double least = INFINITY;
	for (size_t t = 0; t < mesh->triangle_count; t++) {
		double corners[3][3], p[3];
		for (int i = 0; i < 9; i++)
			corners[i / 3][i % 3] =
				(double)mesh->positions[mesh->triangles[t][i / 3]][i % 3];
		for (int i = 0; i < 3; i++)
			p[i] = (double)place[i];
		least = fmin(least, plain_distance2(p, corners[0], corners[1], corners[2]));
	}
	return sqrt(least);
}

/* Points around, on and within; triangles of random corners, large and small. */
static void distances_are_those_of_a_search_of_all_triangles(void **state)
{
	(void)state;
	enum { POINTS = 600, TRIANGLES = 300 };
	struct gz_mesh mesh;
	struct gz_workers *workers = NULL;
	float places[POINTS][3], alone[POINTS], shared[POINTS];
	uint32_t seed = 3;
	double worst = 0;
	assert_int_equal(gz_mesh_allocate(3 * TRIANGLES, TRIANGLES, &mesh), GZ_OK);
	for (uint32_t v = 0; v < 3 * TRIANGLES; v++) {
		mesh.triangles[v / 3][v % 3] = v;
		for (int axis = 0; axis < 3; axis++) {
			const double spread = v % 3 == 0 ? 100 : v / 3 % 7;
			const float *near = mesh.positions[v - v % 3];
			mesh.positions[v][axis] = (v % 3 == 0 ? 0 : near[axis]) +
						  (float)(spread * field_random(&seed));
		}
	}
	for (int i = 0; i < POINTS; i++)
		for (int axis = 0; axis < 3; axis++)
			places[i][axis] = i < 100 ? mesh.positions[i][axis]
						  : (float)(160 * field_random(&seed) - 30);
	assert_int_equal(gz_workers_create(3, &workers), GZ_OK);
	assert_int_equal(gz_mesh_distances(&mesh, places, POINTS, NULL, NULL, alone), GZ_OK);
	assert_int_equal(gz_mesh_distances(&mesh, places, POINTS, workers, NULL, shared), GZ_OK);
	for (int i = 0; i < POINTS; i++) {
		worst = fmax(worst, fabs((double)alone[i] - search_all(&mesh, places[i])));
		assert_true(i >= 100 || alone[i] == 0);
	}
	print_message("worst difference %.2e mm\n", worst);
	assert_true(worst < 1e-5);
	assert_memory_equal(alone, shared, sizeof alone);
	gz_workers_destroy(&workers);
	gz_mesh_free(&mesh);
}

static void distance_from_a_ball_is_that_of_its_formula(void **state)
{
	(void)state;
	struct gz_mesh mesh = mesh_ball(10, 5);
	const float places[3][3] = { { 0, 0, 0 }, { 30, 0, 0 }, { 0, -8, 6 } };
	float found[3];
	assert_int_equal(gz_mesh_distances(&mesh, places, 3, NULL, NULL, found), GZ_OK);
	assert_float_equal(found[0], 10, 0.02);
	assert_float_equal(found[1], 20, 0.02);
	assert_float_equal(found[2], 0, 0.02);
	gz_mesh_free(&mesh);
}

/* Triangles that are a line or a point, and none at all. */
static void flat_triangles_are_lines_and_points(void **state)
{
	(void)state;
	float padded[3 * 3 + 4] = { 0, 0, 0, 10, 0, 0, 4, 0, 0 };
	uint32_t corners[2 * 3 + 4] = { 0, 1, 2, 0, 0, 0 };
	struct gz_mesh mesh = { .vertex_count = 3,
				.triangle_count = 1,
				.positions = (float(*)[3])padded,
				.triangles = (uint32_t(*)[3])corners };
	const float places[2][3] = { { 5, 3, 4 }, { -3, 4, 0 } };
	float found[2];
	assert_int_equal(gz_mesh_distances(&mesh, places, 2, NULL, NULL, found), GZ_OK);
	assert_float_equal(found[0], 5, 1e-6);
	assert_float_equal(found[1], 5, 1e-6);
	mesh.triangles += 1; /* the point */
	assert_int_equal(gz_mesh_distances(&mesh, places, 1, NULL, NULL, found), GZ_OK);
	assert_float_equal(found[0], sqrt(50), 1e-5);
	mesh.triangle_count = 0;
	assert_int_equal(gz_mesh_distances(&mesh, places, 2, NULL, NULL, found), GZ_OK);
	assert_true(isinf(found[0]) && isinf(found[1]) && found[0] > 0);
}

TEST_SUITE(mesh_distance)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(distances_are_those_of_a_search_of_all_triangles),
		cmocka_unit_test(distance_from_a_ball_is_that_of_its_formula),
		cmocka_unit_test(flat_triangles_are_lines_and_points),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
