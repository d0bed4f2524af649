/* What shading knows of each vertex, computed or read from a file. */
#include "suite.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "kept_files.h"
#include "mesh_shapes.h"
#include "render/illustration/shading_vertices.h"

static const struct gz_mesh_cache_place place = { NULL, "shading" };

static int make_folder(void **state)
{
	(void)state;
	(void)kept_files_open();
	return 0;
}

static int remove_folder(void **state)
{
	(void)state;
	kept_files_close();
	return 0;
}

static struct gz_shading_vertices make_vertices(const struct gz_mesh *mesh,
						const struct gz_mesh_cache_place *kept_at)
{
	struct gz_shading_vertices vertices;
	assert_int_equal(gz_shading_vertices_make(mesh, kept_at, NULL, NULL, &vertices), GZ_OK);
	return vertices;
}

static void broken_ball_is_shaded_like_a_whole_one(void **state)
{
	(void)state;
	struct gz_mesh mesh = mesh_ball(10, 4), right = mesh_ball(10, 4);
	for (size_t t = 0; t < mesh.triangle_count; t += 3)
		mesh_turn(&mesh, t);
	memset(mesh.normals, 0, 100 * sizeof *mesh.normals);
	struct gz_shading_vertices vertices = make_vertices(&mesh, NULL);
	assert_float_equal(vertices.curvature_scale, 0.1, 0.005);
	for (size_t i = 0; i < 3 * mesh.triangle_count; i++) {
		const uint32_t v = mesh.triangles[i / 3][i % 3];
		for (int level = 0; level < GZ_SHADING_LEVELS; level++) {
			const float *normal = gz_shading_vertices_level(&vertices, level)[v];
			double along = 0;
			for (int axis = 0; axis < 3; axis++)
				along += (double)normal[axis] * (double)right.normals[v][axis];
			assert_true(along > 0.99);
		}
	}
	gz_shading_vertices_free(&vertices);
	gz_mesh_free(&mesh);
	gz_mesh_free(&right);
}

/* The second time the numbers come from the file; a mesh that is changed gets its own. */
static void file_gives_the_same_numbers_and_only_of_this_mesh(void **state)
{
	(void)state;
	struct gz_mesh mesh = mesh_ball(10, 3);
	struct gz_shading_vertices first = make_vertices(&mesh, &place);
	assert_int_equal(kept_files_count(), 1);
	struct gz_shading_vertices second = make_vertices(&mesh, &place);
	assert_memory_equal(first.normals, second.normals,
			    GZ_SHADING_LEVELS * mesh.vertex_count * sizeof *first.normals);
	assert_memory_equal(first.along, second.along, mesh.vertex_count * sizeof *first.along);
	assert_true(first.curvature_scale == second.curvature_scale);
	gz_shading_vertices_free(&second);
	for (size_t v = 0; v < mesh.vertex_count; v++)
		mesh.positions[v][2] *= 1.25F;
	second = make_vertices(&mesh, &place);
	assert_memory_not_equal(first.greatest, second.greatest,
				mesh.vertex_count * sizeof *first.greatest);
	gz_shading_vertices_free(&first);
	gz_shading_vertices_free(&second);
	gz_mesh_free(&mesh);
}

/* What is kept is what is read: a file with other numbers, of the right key, shows up. */
static void file_is_really_read(void **state)
{
	(void)state;
	struct gz_mesh mesh = mesh_ball(10, 1);
	struct gz_mesh_key key;
	const size_t count = mesh.vertex_count;
	float *numbers = calloc(23 * count, sizeof *numbers);
	assert_non_null(numbers);
	for (size_t i = 0; i < 23 * count; i++)
		numbers[i] = 0.5F;
	const struct gz_mesh_cache_array array = { numbers, 23 * count };
	assert_int_equal(gz_mesh_key_make(&mesh, "shading vertices 1, 6 levels", &key), GZ_OK);
	assert_int_equal(gz_mesh_cache_store(&place, &key, &array, 1, NULL), GZ_OK);
	struct gz_shading_vertices vertices = make_vertices(&mesh, &place);
	assert_true(vertices.greatest[0] == 0.5F && vertices.curvature_scale == 0.5F);
	gz_shading_vertices_free(&vertices);
	free(numbers);
	gz_mesh_free(&mesh);
}

static void empty_and_flat_meshes_have_a_scale(void **state)
{
	(void)state;
	struct gz_mesh nothing = { 0 }, sheet = mesh_sheet(5);
	struct gz_shading_vertices vertices = make_vertices(&nothing, NULL);
	assert_true(vertices.count == 0 && vertices.curvature_scale == 1);
	gz_shading_vertices_free(&vertices);
	vertices = make_vertices(&sheet, NULL);
	assert_true(vertices.curvature_scale == 1);
	gz_shading_vertices_free(&vertices);
	gz_mesh_free(&sheet);
}

TEST_SUITE(shading_vertices)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(broken_ball_is_shaded_like_a_whole_one),
		cmocka_unit_test(file_gives_the_same_numbers_and_only_of_this_mesh),
		cmocka_unit_test(file_is_really_read),
		cmocka_unit_test(empty_and_flat_meshes_have_a_scale),
	};
	return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
