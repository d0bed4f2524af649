/* Curvature against the formulas of ball, cylinder, ring and saddle. */
#include "suite.h"

#include <math.h>
#include <stdlib.h>

#include "render/mesh/mesh_curvature.h"

#define PI 3.14159265358979323846

/* A surface over two parameters: its place and normal, the curvatures along both, and whether the
 * first parameter's direction is that of the greater one. */
struct sheet_point {
	double place[3], normal[3];
	double curvatures[2]; /* greatest, least */
	double along[3];      /* of the greatest; 0 0 0: any direction */
};

typedef struct sheet_point sheet_formula(double s, double t);

enum { COLUMNS = 180, ROWS = 60 };

/* A ball of radius 20 without its poles; edges of 2 degrees. */
static struct sheet_point ball(double s, double t)
{
	const double polar = (0.5 + (t - 0.5) * ROWS / 90.0) * PI, round = 2 * PI * s;
	struct sheet_point at = {
		.normal = { sin(polar) * cos(round), sin(polar) * sin(round), -cos(polar) },
		.curvatures = { 1 / 20.0, 1 / 20.0 },
	};
	for (int i = 0; i < 3; i++)
		at.place[i] = 20 * at.normal[i];
	return at;
}

static struct sheet_point cylinder(double s, double t)
{
	const double round = 2 * PI * s;
	return (struct sheet_point) {
		.place = { 5 * cos(round), 5 * sin(round), 10 * t },
		.normal = { cos(round), sin(round), 0 },
		.curvatures = { 1 / 5.0, 0 },
		.along = { -sin(round), cos(round), 0 },
	};
}

/* Radii 18 and 7; the part of the tube that faces outwards, to both sides of which it turns in. */
static struct sheet_point ring(double s, double t)
{
	const double round = 2 * PI * s, tube = (t - 0.5) * ROWS * 2 * PI / 180;
	const double reach = 18 + 7 * cos(tube);
	return (struct sheet_point) {
		.place = { reach * cos(round), reach * sin(round), 7 * sin(tube) },
		.normal = { cos(tube) * cos(round), cos(tube) * sin(round), sin(tube) },
		.curvatures = { 1 / 7.0, cos(tube) / reach },
		.along = { -sin(tube) * cos(round), -sin(tube) * sin(round), cos(tube) },
	};
}

/* z = x y / 10, seen from above: at its centre both curvatures are 1/10, of opposite signs. */
static struct sheet_point saddle(double s, double t)
{
	const double x = (s - 0.5) * 6, y = (t - 0.5) * 2, length = sqrt(1 + (x * x + y * y) / 100);
	/* Of a graph: Gauss -fxy²/l⁴, mean -fx fy fxy/l³ (do Carmo 1976, 3.3), bent upwards < 0. */
	const double gauss = -0.01 / pow(length, 4), mean = x * y / 1000 / pow(length, 3);
	const double spread = sqrt(mean * mean - gauss);
	return (struct sheet_point) {
		.place = { x, y, x * y / 10 },
		.normal = { -y / 10 / length, -x / 10 / length, 1 / length },
		.curvatures = { mean + spread, mean - spread },
	};
}

/* Triangles over a grid of both parameters. */
static struct gz_mesh make_sheet(sheet_formula *formula)
{
	struct gz_mesh mesh;
	assert_int_equal(gz_mesh_allocate((COLUMNS + 1) * (ROWS + 1), 2 * COLUMNS * ROWS, &mesh),
			 GZ_OK);
	size_t count = 0;
	for (int row = 0; row <= ROWS; row++)
		for (int column = 0; column <= COLUMNS; column++) {
			const size_t v = (size_t)(row * (COLUMNS + 1) + column);
			const struct sheet_point at =
				formula((double)column / COLUMNS, (double)row / ROWS);
			for (int axis = 0; axis < 3; axis++) {
				mesh.positions[v][axis] = (float)at.place[axis];
				mesh.normals[v][axis] = (float)at.normal[axis];
			}
			if (row == ROWS || column == COLUMNS)
				continue;
			const uint32_t a = (uint32_t)v, b = a + 1, c = a + COLUMNS + 1, d = c + 1;
			const uint32_t both[2][3] = { { a, b, d }, { a, d, c } };
			for (int k = 0; k < 2; k++, count++)
				for (int i = 0; i < 3; i++)
					mesh.triangles[count][i] = both[k][i];
		}
	return mesh;
}

/* Compare all vertices that are not on the rim, relative to the greater curvature. */
static void check_sheet(const char *name, sheet_formula *formula)
{
	struct gz_mesh mesh = make_sheet(formula);
	struct gz_curvature *found = calloc(mesh.vertex_count, sizeof *found);
	assert_non_null(found);
	assert_int_equal(gz_mesh_curvatures(&mesh, found), GZ_OK);
	double worst = 0, turned = 0;
	for (int row = 1; row < ROWS; row++)
		for (int column = 1; column < COLUMNS; column++) {
			const struct gz_curvature *at = &found[row * (COLUMNS + 1) + column];
			const struct sheet_point right =
				formula((double)column / COLUMNS, (double)row / ROWS);
			const double scale =
				fmax(fabs(right.curvatures[0]), fabs(right.curvatures[1]));
			double along = 0, known = 0;
			worst = fmax(worst,
				     fabs((double)at->greatest - right.curvatures[0]) / scale);
			worst = fmax(worst, fabs((double)at->least - right.curvatures[1]) / scale);
			for (int axis = 0; axis < 3; axis++) {
				along += (double)at->along[axis] * right.along[axis];
				known += right.along[axis] * right.along[axis];
			}
			if (known > 0)
				turned = fmax(turned, acos(fmin(fabs(along), 1)) * 180 / PI);
		}
	print_message("%s: worst error %.2f %%, direction %.2f degrees\n", name, 100 * worst,
		      turned);
	assert_true(worst < 0.02 && turned < 2);
	free(found);
	gz_mesh_free(&mesh);
}

static void curvatures_are_those_of_the_formulas(void **state)
{
	(void)state;
	check_sheet("ball", ball);
	check_sheet("cylinder", cylinder);
	check_sheet("ring", ring);
	check_sheet("saddle", saddle);
}

/* A hollow ball, seen from inside, bends the other way. */
static void hollow_places_have_negative_curvature(void **state)
{
	(void)state;
	struct gz_mesh mesh = make_sheet(ball);
	struct gz_curvature *found = calloc(mesh.vertex_count, sizeof *found);
	assert_non_null(found);
	for (size_t v = 0; v < mesh.vertex_count; v++)
		for (int axis = 0; axis < 3; axis++)
			mesh.normals[v][axis] = -mesh.normals[v][axis];
	for (size_t t = 0; t < mesh.triangle_count; t++) {
		const uint32_t swap = mesh.triangles[t][0];
		mesh.triangles[t][0] = mesh.triangles[t][1];
		mesh.triangles[t][1] = swap;
	}
	assert_int_equal(gz_mesh_curvatures(&mesh, found), GZ_OK);
	const struct gz_curvature *middle = &found[ROWS / 2 * (COLUMNS + 1) + 7];
	assert_true(fabs((double)middle->greatest * 20 + 1) < 0.02);
	assert_true(fabs((double)middle->least * 20 + 1) < 0.02);
	free(found);
	gz_mesh_free(&mesh);
}

/* Triangles that are listed the wrong way round change nothing where the normals are right. */
static void winding_does_not_matter(void **state)
{
	(void)state;
	struct gz_mesh mesh = make_sheet(ring);
	struct gz_curvature *right = calloc(mesh.vertex_count, sizeof *right);
	struct gz_curvature *turned = calloc(mesh.vertex_count, sizeof *turned);
	assert_non_null(right);
	assert_non_null(turned);
	assert_int_equal(gz_mesh_curvatures(&mesh, right), GZ_OK);
	for (size_t t = 0; t < mesh.triangle_count; t += 3) {
		const uint32_t swap = mesh.triangles[t][1];
		mesh.triangles[t][1] = mesh.triangles[t][2];
		mesh.triangles[t][2] = swap;
	}
	assert_int_equal(gz_mesh_curvatures(&mesh, turned), GZ_OK);
	for (size_t v = 0; v < mesh.vertex_count; v++) {
		double along = 0;
		for (int axis = 0; axis < 3; axis++)
			along += (double)right[v].along[axis] * (double)turned[v].along[axis];
		assert_float_equal(right[v].greatest, turned[v].greatest, 1e-5);
		assert_float_equal(right[v].least, turned[v].least, 1e-5);
		assert_true(fabs(along) > 0.9999);
	}
	free(right);
	free(turned);
	gz_mesh_free(&mesh);
}

/* Whatever the triangles are, numbers stay finite: no area, one corner twice, normals of 0 or to
 * the other side, a vertex of no triangle. */
static void broken_triangles_give_finite_numbers(void **state)
{
	(void)state;
	float places[6][3] = { { 0, 0, 0 }, { 1, 0, 0 }, { 0, 1, 0 },
			       { 2, 0, 0 }, { 0, 0, 1 }, { 9, 9, 9 } };
	float normals[6][3] = { { 0, 0, 1 }, { 0, 0, -1 }, { 0, 0, 0 },
				{ 0, 0, 1 }, { 1, 0, 0 },  { 0, 0, 1 } };
	uint32_t triangles[5][3] = {
		{ 0, 1, 3 }, { 0, 1, 2 }, { 0, 2, 1 }, { 4, 4, 0 }, { 0, 4, 1 }
	};
	const struct gz_mesh mesh = { 6, 5, places, normals, triangles, 0 };
	struct gz_curvature found[6];
	assert_int_equal(gz_mesh_curvatures(&mesh, found), GZ_OK);
	for (int v = 0; v < 6; v++) {
		assert_true(isfinite(found[v].greatest) && isfinite(found[v].least));
		for (int axis = 0; axis < 3; axis++)
			assert_true(isfinite(found[v].along[axis]));
	}
	assert_true(found[5].greatest == 0 && found[5].least == 0);
	assert_int_equal(gz_mesh_curvatures(&(struct gz_mesh) { 0 }, found), GZ_OK);
}

TEST_SUITE(mesh_curvature)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(curvatures_are_those_of_the_formulas),
		cmocka_unit_test(hollow_places_have_negative_curvature),
		cmocka_unit_test(winding_does_not_matter),
		cmocka_unit_test(broken_triangles_give_finite_numbers),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
