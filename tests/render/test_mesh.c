/* Meshes: their limits, and what is measured of them. */
#include "suite.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "render/mesh/mesh.h"
#include "render/mesh/mesh_measure.h"

static struct gz_mesh mesh_of(size_t vertices, const float (*positions)[3], size_t triangles,
			      const uint32_t (*corners)[3])
{
	struct gz_mesh mesh;
	assert_int_equal(gz_mesh_allocate(vertices, triangles, &mesh), GZ_OK);
	memcpy(mesh.positions, positions, vertices * sizeof *positions);
	memset(mesh.normals, 0, vertices * sizeof *mesh.normals);
	memcpy(mesh.triangles, corners, triangles * sizeof *corners);
	return mesh;
}

static struct gz_mesh_measures measures_of(const struct gz_mesh *mesh)
{
	struct gz_mesh_measures measures;
	assert_int_equal(gz_mesh_measure(mesh, &measures), GZ_OK);
	return measures;
}

static const float tetrahedron[5][3] = {
	{ 5, 5, 5 }, { 7, 5, 5 }, { 5, 8, 5 }, { 5, 5, 9 }, { 100, 100, 100 }
};
static const uint32_t faces[4][3] = { { 0, 2, 1 }, { 0, 1, 3 }, { 0, 3, 2 }, { 1, 2, 3 } };

static void tetrahedron_has_the_measures_of_a_tetrahedron(void **state)
{
	(void)state;
	/* the fifth vertex belongs to no triangle */
	struct gz_mesh mesh = mesh_of(5, tetrahedron, 4, faces);
	const struct gz_mesh_measures measures = measures_of(&mesh);
	assert_float_equal(measures.volume, 2 * 3 * 4 / 6.0, 1e-12);
	assert_float_equal(measures.area, 3 + 4 + 6 + 0.5 * sqrt(36 + 64 + 144), 1e-12);
	assert_int_equal(measures.edges, 6);
	assert_int_equal(measures.euler, 2);
	assert_true(gz_mesh_closed(&measures));
	gz_mesh_free(&mesh);
	assert_null(mesh.positions);
}

static void missing_triangle_leaves_a_border(void **state)
{
	(void)state;
	struct gz_mesh mesh = mesh_of(5, tetrahedron, 3, faces);
	const struct gz_mesh_measures measures = measures_of(&mesh);
	assert_int_equal(measures.edges, 6);
	assert_int_equal(measures.border_edges, 3);
	assert_int_equal(measures.euler, 1);
	assert_false(gz_mesh_closed(&measures));
	gz_mesh_free(&mesh);
}

static void turned_triangle_turns_its_edges(void **state)
{
	(void)state;
	struct gz_mesh mesh = mesh_of(5, tetrahedron, 4, faces);
	mesh.triangles[2][0] = 3;
	mesh.triangles[2][1] = 0;
	const struct gz_mesh_measures measures = measures_of(&mesh);
	assert_int_equal(measures.turned_edges, 3);
	assert_int_equal(measures.border_edges + measures.crowded_edges, 0);
	assert_false(gz_mesh_closed(&measures));
	gz_mesh_free(&mesh);
}

static void two_bodies_that_share_an_edge_crowd_it(void **state)
{
	(void)state;
	const uint32_t both[8][3] = { { 0, 2, 1 }, { 0, 1, 3 }, { 0, 3, 2 }, { 1, 2, 3 },
				      { 0, 1, 4 }, { 0, 5, 1 }, { 0, 4, 5 }, { 1, 5, 4 } };
	float corners[6][3] = { { 0 } };
	memcpy(corners, tetrahedron, sizeof tetrahedron);
	struct gz_mesh mesh = mesh_of(6, (const float(*)[3])corners, 8, both);
	const struct gz_mesh_measures measures = measures_of(&mesh);
	assert_int_equal(measures.edges, 11);
	assert_int_equal(measures.crowded_edges, 1);
	assert_int_equal(measures.border_edges, 0);
	gz_mesh_free(&mesh);
}

static void fan_of_many_triangles_is_measured(void **state)
{
	(void)state;
	/* The list of edges at its hub is long. */
	enum { SPOKES = 5000 };
	struct gz_mesh mesh;
	assert_int_equal(gz_mesh_allocate(SPOKES + 1, SPOKES, &mesh), GZ_OK);
	for (int i = 0; i < SPOKES; i++) {
		const uint32_t from = 1 + (uint32_t)(i * 7 % SPOKES);
		const double angle = 2 * 3.14159265358979 * (from - 1) / SPOKES;
		mesh.positions[from][0] = (float)cos(angle);
		mesh.positions[from][1] = (float)sin(angle);
		mesh.positions[from][2] = 0;
		mesh.triangles[i][0] = 0;
		mesh.triangles[i][1] = from;
		mesh.triangles[i][2] = from % SPOKES + 1;
	}
	memset(mesh.positions[0], 0, sizeof mesh.positions[0]);
	const struct gz_mesh_measures measures = measures_of(&mesh);
	assert_int_equal(measures.edges, 2 * SPOKES);
	assert_int_equal(measures.border_edges, SPOKES);
	assert_int_equal(measures.crowded_edges + measures.turned_edges, 0);
	assert_int_equal(measures.euler, 1);
	assert_float_equal(measures.area, 3.14159265358979, 1e-5);
	gz_mesh_free(&mesh);
}

static void mesh_of_more_elements_than_can_be_numbered_is_refused(void **state)
{
	(void)state;
	const uint64_t many = (uint64_t)GZ_MESH_COUNT_MAX + 1;
	struct gz_mesh mesh = { .vertex_count = 99 };
	assert_int_equal(gz_mesh_allocate(many, 1, &mesh), GZ_ERR_FULL);
	assert_int_equal(gz_mesh_allocate(1, many, &mesh), GZ_ERR_FULL);
	assert_int_equal(gz_mesh_allocate(UINT64_MAX, UINT64_MAX, &mesh), GZ_ERR_FULL);
	assert_int_equal(mesh.vertex_count, 99);
	assert_true(gz_mesh_count_limit(0) == GZ_MESH_COUNT_MAX);
	assert_true(gz_mesh_count_limit(UINT64_MAX) == GZ_MESH_COUNT_MAX);
	assert_true(gz_mesh_count_limit(1000) == 1000);
}

static void empty_mesh_has_no_measures_and_can_be_freed(void **state)
{
	(void)state;
	struct gz_mesh mesh;
	assert_int_equal(gz_mesh_allocate(0, 0, &mesh), GZ_OK);
	const struct gz_mesh_measures measures = measures_of(&mesh);
	assert_int_equal(measures.edges, 0);
	assert_true(gz_mesh_closed(&measures));
	gz_mesh_free(&mesh);
	gz_mesh_free(&mesh);
}

TEST_SUITE(mesh)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(tetrahedron_has_the_measures_of_a_tetrahedron),
		cmocka_unit_test(missing_triangle_leaves_a_border),
		cmocka_unit_test(turned_triangle_turns_its_edges),
		cmocka_unit_test(two_bodies_that_share_an_edge_crowd_it),
		cmocka_unit_test(fan_of_many_triangles_is_measured),
		cmocka_unit_test(mesh_of_more_elements_than_can_be_numbered_is_refused),
		cmocka_unit_test(empty_mesh_has_no_measures_and_can_be_freed),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
