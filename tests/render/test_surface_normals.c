/* The corners' normals that rays read are those of the mesh, as far as 16 bits keep them. */
#include "suite.h"

#include <math.h>
#include <stdlib.h>

#include "render/mesh/mesh.h"
#include "render/raycast/cpu/simd_portable.h"

#include "render/surface/cpu/surface_packet.h"

/* What packing may take, radians: half a step along both edges of the square is 6.5e-5 at most. */
#define ANGLE 7e-5

static double angle_between(const float a[3], const float b[3])
{
	double dot = 0, across = 0;
	for (int axis = 0; axis < 3; axis++) {
		const int next = (axis + 1) % 3, last = (axis + 2) % 3;
		const double part =
			(double)a[next] * (double)b[last] - (double)a[last] * (double)b[next];
		dot += (double)a[axis] * (double)b[axis];
		across += part * part;
	}
	return atan2(sqrt(across), dot);
}

/* Unpack as the kernels do. */
static void unpack(uint32_t word, float out[3])
{
	vf lanes[3];
	unpack_normals(vi_set((int32_t)word), lanes);
	for (int axis = 0; axis < 3; axis++) {
		float all[SIMD_LANES];
		vf_store(all, lanes[axis]);
		out[axis] = all[SIMD_LANES - 1];
	}
}

static void assert_kept(const float normal[3])
{
	float found[3];
	double length2 = 0;
	unpack(gz_normal_pack(normal), found);
	for (int axis = 0; axis < 3; axis++)
		length2 += (double)found[axis] * (double)found[axis];
	assert_true(fabs(length2 - 1) < 1e-6);
	assert_true(angle_between(normal, found) < ANGLE);
}

static void normals_all_around_are_kept(void **state)
{
	(void)state;
	const int count = 20000;
	for (int i = 0; i < count; i++) { /* a spiral from pole to pole */
		const double z = 1 - (2 * i + 1.0) / count;
		const double turn = i * 2.39996322972865332, radius = sqrt(1 - z * z);
		const float normal[3] = { (float)(radius * cos(turn)), (float)(radius * sin(turn)),
					  (float)z };
		assert_kept(normal);
	}
}

/* Axes, diagonals and the folds of the square, where signs decide; 0 has both. */
static void normals_on_the_folds_are_kept(void **state)
{
	(void)state;
	static const float steps[] = { -1, -1e-6F, -0.0F, 0.0F, 1e-6F, 1 };
	enum { STEPS = sizeof steps / sizeof steps[0] };
	for (int i = 0; i < STEPS * STEPS * STEPS; i++) {
		const float normal[3] = { steps[i % STEPS], steps[i / STEPS % STEPS],
					  steps[i / STEPS / STEPS] };
		if (fabsf(normal[0]) + fabsf(normal[1]) + fabsf(normal[2]) > 0.5F)
			assert_kept(normal);
	}
}

static void what_has_no_direction_points_up(void **state)
{
	(void)state;
	static const float vectors[][3] = { { 0, 0, 0 },
					    { -0.0F, -0.0F, -0.0F },
					    { NAN, 0, 1 },
					    { 0, -INFINITY, 0 },
					    { 3e38F, 3e38F, 3e38F } };
	for (size_t i = 0; i < sizeof vectors / sizeof vectors[0]; i++) {
		float found[3];
		unpack(gz_normal_pack(vectors[i]), found);
		assert_true(found[0] == 0 && found[1] == 0 && found[2] == 1);
	}
}

/* Meshes, the second one empty, whose triangles name the corners in any order. */
static void triangles_of_meshes_follow_each_other(void **state)
{
	(void)state;
	enum { VERTICES = 5, TRIANGLES = 40000 }; /* several parts of the work */
	struct gz_mesh meshes[3] = { { 0 }, { 0 }, { 0 } };
	struct gz_workers *workers = NULL;
	struct gz_corner_normals *normals = NULL;
	assert_int_equal(gz_workers_create(2, &workers), GZ_OK);
	for (int i = 0; i < 3; i += 2) {
		assert_int_equal(gz_mesh_allocate(VERTICES, TRIANGLES + (uint64_t)i, &meshes[i]),
				 GZ_OK);
		for (uint32_t k = 0; k < VERTICES; k++)
			for (int axis = 0; axis < 3; axis++)
				meshes[i].normals[k][axis] = sinf((float)(3 * k + 1) + (float)axis);
		for (size_t k = 0; k < meshes[i].triangle_count; k++)
			for (size_t corner = 0; corner < 3; corner++)
				meshes[i].triangles[k][corner] =
					(uint32_t)((k * (corner + 1) + (size_t)i) % VERTICES);
	}
	assert_int_equal(gz_corner_normals_make(meshes, 3, workers, &normals), GZ_OK);
	const struct gz_corner_normals *next = normals;
	for (int i = 0; i < 3; i++)
		for (size_t k = 0; k < meshes[i].triangle_count; k++, next++)
			for (int corner = 0; corner < 3; corner++) {
				const uint32_t vertex = meshes[i].triangles[k][corner];
				assert_int_equal(next->corner[corner],
						 gz_normal_pack(meshes[i].normals[vertex]));
			}
	free(normals);
	assert_int_equal(gz_corner_normals_make(&meshes[1], 1, workers, &normals), GZ_OK);
	assert_null(normals);
	for (int i = 0; i < 3; i++)
		gz_mesh_free(&meshes[i]);
	gz_workers_destroy(&workers);
}

TEST_SUITE(surface_normals)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(normals_all_around_are_kept),
		cmocka_unit_test(normals_on_the_folds_are_kept),
		cmocka_unit_test(what_has_no_direction_points_up),
		cmocka_unit_test(triangles_of_meshes_follow_each_other),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
