/* Meshes with faults: turned triangles, missing normals, flat triangles, holes; and normals
 * smoothed to levels. */
#include "suite.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "mesh_fields.h"
#include "mesh_shapes.h"
#include "render/mesh/mesh_curvature.h"
#include "render/mesh/mesh_measure.h"
#include "render/mesh/mesh_mend.h"
#include "render/mesh/mesh_smooth.h"

static struct gz_mesh_mending mend(struct gz_mesh *mesh)
{
	struct gz_mesh_mending mending;
	assert_int_equal(gz_mesh_mend(mesh, &mending), GZ_OK);
	return mending;
}

static double dot_normals(const float a[3], const float b[3])
{
	return (double)a[0] * (double)b[0] + (double)a[1] * (double)b[1] +
	       (double)a[2] * (double)b[2];
}

static void good_mesh_stays_as_it_is(void **state)
{
	(void)state;
	struct gz_mesh mesh = mesh_ball(10, 3), before = mesh_ball(10, 3);
	const struct gz_mesh_mending mending = mend(&mesh);
	assert_int_equal(mending.turned_triangles, 0);
	assert_int_equal(mending.new_normals, 0);
	assert_int_equal(mending.flat_triangles, 0);
	assert_memory_equal(mesh.triangles, before.triangles,
			    mesh.triangle_count * sizeof *mesh.triangles);
	assert_memory_equal(mesh.normals, before.normals, mesh.vertex_count * sizeof *mesh.normals);
	gz_mesh_free(&mesh);
	gz_mesh_free(&before);
}

/* Random triangles of a ball are turned; nearly as many as are right. */
static void turned_triangles_face_outwards_again(void **state)
{
	(void)state;
	struct gz_mesh mesh = mesh_ball(10, 4);
	struct gz_mesh_measures measures;
	uint32_t seed = 5;
	size_t turned = 0;
	for (size_t t = 0; t < mesh.triangle_count; t++)
		if (field_random(&seed) < 0.45) {
			mesh_turn(&mesh, t);
			turned++;
		}
	assert_int_equal(mend(&mesh).turned_triangles, turned);
	assert_int_equal(gz_mesh_measure(&mesh, &measures), GZ_OK);
	assert_int_equal(measures.turned_edges, 0);
	assert_true(gz_mesh_closed(&measures) && measures.volume > 4000);
	gz_mesh_free(&mesh);
}

/* All triangles of a ball face inwards, and there is no normal: its volume decides. */
static void without_normals_the_volume_decides(void **state)
{
	(void)state;
	struct gz_mesh mesh = mesh_ball(10, 4), right = mesh_ball(10, 4);
	for (size_t t = 0; t < mesh.triangle_count; t++)
		mesh_turn(&mesh, t);
	memset(mesh.normals, 0, mesh.vertex_count * sizeof *mesh.normals);
	const struct gz_mesh_mending mending = mend(&mesh);
	assert_int_equal(mending.turned_triangles, mesh.triangle_count);
	assert_int_equal(mending.new_normals, mesh.vertex_count);
	for (size_t i = 0; i < 3 * mesh.triangle_count; i++) {
		const uint32_t v = mesh.triangles[i / 3][i % 3];
		assert_true(dot_normals(mesh.normals[v], right.normals[v]) >
			    0.95); /* of one side only at the rim */
	}
	gz_mesh_free(&mesh);
	gz_mesh_free(&right);
}

/* Each part of a mesh is decided for itself. */
static void parts_are_turned_each_by_its_normals(void **state)
{
	(void)state;
	struct gz_mesh ball = mesh_ball(10, 2), pair;
	const size_t vertices = ball.vertex_count, triangles = ball.triangle_count;
	assert_int_equal(gz_mesh_allocate(2 * vertices, 2 * triangles, &pair), GZ_OK);
	for (size_t i = 0; i < 2 * vertices; i++)
		for (int axis = 0; axis < 3; axis++) {
			pair.positions[i][axis] =
				ball.positions[i % vertices][axis] + (i < vertices ? 0.0F : 50.0F);
			pair.normals[i][axis] = ball.normals[i % vertices][axis];
		}
	for (size_t i = 0; i < 6 * triangles; i++)
		pair.triangles[i / 3][i % 3] = ball.triangles[i / 3 % triangles][i % 3] +
					       (uint32_t)(i < 3 * triangles ? 0 : vertices);
	for (size_t t = 0; t < triangles; t++)
		mesh_turn(&pair, t);
	assert_int_equal(mend(&pair).turned_triangles, triangles);
	gz_mesh_free(&ball);
	gz_mesh_free(&pair);
}

static void bad_normals_are_made_of_triangles(void **state)
{
	(void)state;
	struct gz_mesh mesh = mesh_sheet(4);
	const float bad[4][3] = {
		{ 0, 0, 0 },
		{ NAN, 0, 1 },
		{ 0, 0, -1 },
		{ 0, 0, 40 },
	};
	memcpy(mesh.normals[6], bad, sizeof bad);
	assert_int_equal(mend(&mesh).new_normals, 4);
	for (size_t v = 0; v < mesh.vertex_count; v++)
		assert_true(mesh.normals[v][0] == 0 && mesh.normals[v][1] == 0 &&
			    mesh.normals[v][2] == 1);
	gz_mesh_free(&mesh);
}

static void flat_and_lonely_elements_do_no_harm(void **state)
{
	(void)state;
	float places[5][3] = { { 0, 0, 0 }, { 1, 0, 0 }, { 2, 0, 0 }, { 0, 1, 0 }, { 7, 7, 7 } };
	float normals[5][3] = { { 0 } };
	uint32_t triangles[4][3] = { { 0, 1, 2 }, { 0, 1, 3 }, { 3, 3, 0 }, { 2, 2, 2 } };
	struct gz_mesh mesh = { 5, 4, places, normals, triangles, 0 };
	const struct gz_mesh_mending mending = mend(&mesh);
	assert_int_equal(mending.flat_triangles, 3);
	assert_int_equal(mending.new_normals, 5);
	float smooth[2 * 5][3];
	assert_int_equal(gz_mesh_smooth_normals(&mesh, 2, NULL, smooth), GZ_OK);
	for (int v = 0; v < 10; v++)
		assert_true(fabs(dot_normals(smooth[v], smooth[v]) - 1) < 1e-5);
	struct gz_mesh nothing = { 0 };
	assert_int_equal(mend(&nothing).turned_triangles, 0);
	assert_int_equal(gz_mesh_smooth_normals(&nothing, 1, NULL, smooth), GZ_OK);
	assert_int_equal(gz_mesh_smooth_normals(&mesh, 0, NULL, smooth), GZ_ERR_INVAL);
	assert_int_equal(gz_mesh_smooth_normals(&mesh, GZ_MESH_SMOOTH_LEVELS_MAX + 1, NULL, smooth),
			 GZ_ERR_INVAL);
}

/* A Moebius strip has one side only: whatever is done, it ends, and numbers stay finite. */
static void strip_with_one_side_is_survived(void **state)
{
	(void)state;
	enum { ROUND = 24 };
	float places[2 * ROUND][3], normals[2 * ROUND][3] = { { 0 } };
	uint32_t triangles[2 * ROUND][3];
	for (uint32_t i = 0; i < ROUND; i++) {
		const double angle = 6.283185307179586 * i / ROUND;
		for (uint32_t k = 0; k < 2; k++) {
			const double out = (k ? 2 : -2) * cos(angle / 2), up = k ? 2 : -2;
			places[2 * i + k][0] = (float)((10 + out) * cos(angle));
			places[2 * i + k][1] = (float)((10 + out) * sin(angle));
			places[2 * i + k][2] = (float)(up * sin(angle / 2));
		}
		/* The last cell joins crosswise. */
		const uint32_t a = 2 * i, b = a + 1, last = i + 1 == ROUND;
		const uint32_t c = last ? 1 : a + 2, d = last ? 0 : a + 3;
		const uint32_t both[6] = { a, c, b, b, c, d };
		memcpy(triangles[2 * i], both, sizeof both);
	}
	struct gz_mesh mesh = { 2 * ROUND, 2 * ROUND, places, normals, triangles, 0 };
	struct gz_mesh_measures measures;
	mend(&mesh);
	assert_int_equal(gz_mesh_measure(&mesh, &measures), GZ_OK);
	assert_true(measures.turned_edges > 0);
	for (int v = 0; v < 2 * ROUND; v++)
		assert_true(fabs(dot_normals(normals[v], normals[v]) - 1) < 1e-5);
}

/* ---- smoothing ---- */

/* The vertex in the middle of a sheet gets a normal of its own: each level spreads it wider. */
static void levels_spread_a_dent_wider_and_wider(void **state)
{
	(void)state;
	enum { SIDE = 32, LEVELS = 5, MIDDLE = SIDE / 2 * (SIDE + 1) + SIDE / 2 };
	struct gz_mesh mesh = mesh_sheet(SIDE);
	float(*smooth)[3] = calloc(LEVELS * mesh.vertex_count, sizeof *smooth);
	assert_non_null(smooth);
	mesh.normals[MIDDLE][0] = 0.8F;
	mesh.normals[MIDDLE][2] = 0.6F;
	assert_int_equal(gz_mesh_smooth_normals(&mesh, LEVELS, NULL, smooth), GZ_OK);
	double middle = 0.8, variance = 0;
	for (size_t level = 0; level < LEVELS; level++) {
		float(*normals)[3] = smooth + level * mesh.vertex_count;
		double sum = 0, spread = 0;
		for (size_t v = 0; v < mesh.vertex_count; v++) {
			const double x = (double)mesh.positions[v][0] - SIDE / 2;
			sum += (double)normals[v][0];
			spread += (double)normals[v][0] * x * x;
		}
		print_message("level %zu: middle %.4f, variance %.2f mm2\n", level,
			      (double)normals[MIDDLE][0], spread / sum);
		assert_true((double)normals[MIDDLE][0] < 0.75 * middle);
		assert_true(spread / sum > 1.8 * variance);
		middle = (double)normals[MIDDLE][0];
		variance = spread / sum;
	}
	free(smooth);
	gz_mesh_free(&mesh);
}

/* A ball's normals are their own means, also beside a hole. */
static void balls_stay_round_even_with_a_hole(void **state)
{
	(void)state;
	struct gz_mesh mesh = mesh_ball(10, 4);
	mesh.triangle_count -= 40; /* a hole in the last face */
	float(*smooth)[3] = calloc(3 * mesh.vertex_count, sizeof *smooth);
	struct gz_curvature *curvatures = calloc(mesh.vertex_count, sizeof *curvatures);
	assert_non_null(smooth);
	assert_non_null(curvatures);
	assert_int_equal(gz_mesh_smooth_normals(&mesh, 3, NULL, smooth), GZ_OK);
	assert_int_equal(gz_mesh_curvatures(&mesh, curvatures), GZ_OK);
	for (size_t i = 0; i < 3 * mesh.triangle_count; i++) {
		const uint32_t v = mesh.triangles[i / 3][i % 3];
		assert_true(dot_normals(smooth[v], mesh.normals[v]) > 0.995);
		assert_true(dot_normals(smooth[2 * mesh.vertex_count + v], mesh.normals[v]) >
			    0.95); /* of one side only at the rim */
		assert_float_equal(curvatures[v].greatest, 0.1, 0.005);
	}
	free(smooth);
	free(curvatures);
	gz_mesh_free(&mesh);
}

static void any_number_of_threads_gives_the_same_bits(void **state)
{
	(void)state;
	struct gz_mesh mesh = mesh_sheet(90); /* several parts */
	struct gz_workers *workers = NULL;
	const size_t count = 4 * mesh.vertex_count;
	float(*alone)[3] = calloc(count, sizeof *alone),
	(*shared)[3] = calloc(count, sizeof *shared);
	uint32_t seed = 9;
	assert_non_null(alone);
	assert_non_null(shared);
	for (size_t v = 0; v < mesh.vertex_count; v++)
		mesh.positions[v][2] = (float)field_random(&seed);
	memset(mesh.normals, 0, mesh.vertex_count * sizeof *mesh.normals);
	mend(&mesh);
	assert_int_equal(gz_workers_create(3, &workers), GZ_OK);
	assert_int_equal(gz_mesh_smooth_normals(&mesh, 4, NULL, alone), GZ_OK);
	assert_int_equal(gz_mesh_smooth_normals(&mesh, 4, workers, shared), GZ_OK);
	assert_memory_equal(alone, shared, count * sizeof *alone);
	gz_workers_destroy(&workers);
	free(alone);
	free(shared);
	gz_mesh_free(&mesh);
}

TEST_SUITE(mesh_mend)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(good_mesh_stays_as_it_is),
		cmocka_unit_test(turned_triangles_face_outwards_again),
		cmocka_unit_test(without_normals_the_volume_decides),
		cmocka_unit_test(parts_are_turned_each_by_its_normals),
		cmocka_unit_test(bad_normals_are_made_of_triangles),
		cmocka_unit_test(flat_and_lonely_elements_do_no_harm),
		cmocka_unit_test(strip_with_one_side_is_survived),
		cmocka_unit_test(levels_spread_a_dent_wider_and_wider),
		cmocka_unit_test(balls_stay_round_even_with_a_hole),
		cmocka_unit_test(any_number_of_threads_gives_the_same_bits),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
