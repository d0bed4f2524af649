/* Meshes of PLY, OBJ and STL files, and what is refused. */
#include "suite.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/captured_log.h"
#include "mesh_fields.h"
#include "render/mesh/isosurface.h"
#include "render/mesh/mesh_file.h"
#include "render/mesh/mesh_read.h"
#include "volume_files.h"

static enum gz_result parse(const char *text, struct gz_mesh *out_mesh)
{
	return gz_mesh_parse_ply("a.ply", text, strlen(text), NULL, out_mesh);
}

static void written_mesh_is_read_back(void **state)
{
	(void)state;
	static const int dims[3] = { 50, 50, 50 };
	static const double spacing[3] = { 1, 0.9, 1.2 };
	struct gz_volume volume = field_volume(field_ball, dims, spacing, GZ_VOXEL_U16);
	const struct gz_isosurface_request request = { .volume = &volume, .isovalue = 0.3 };
	const char *path = files_path("ball.ply");
	struct gz_mesh mesh, read;
	assert_int_equal(gz_isosurface_make(&request, NULL, NULL, &mesh), GZ_OK);
	assert_int_equal(gz_mesh_write(&mesh, path, NULL), GZ_OK);
	assert_int_equal(gz_mesh_read(path, NULL, &read), GZ_OK);
	assert_int_equal(read.vertex_count, mesh.vertex_count);
	assert_int_equal(read.triangle_count, mesh.triangle_count);
	assert_memory_equal(read.positions, mesh.positions,
			    mesh.vertex_count * sizeof mesh.positions[0]);
	assert_memory_equal(read.triangles, mesh.triangles,
			    mesh.triangle_count * sizeof mesh.triangles[0]);
	for (size_t i = 0; i < 3 * mesh.vertex_count; i++)
		assert_float_equal(read.normals[i / 3][i % 3], mesh.normals[i / 3][i % 3], 1e-6);
	gz_mesh_free(&read);
	gz_mesh_free(&mesh);
	gz_volume_free(&volume);
}

/* A square in the plane z = 2 and a vertex of no face, with more than is needed. */
static const char square[] = "ply\r\n"
			     "format ascii 1.0\r\n"
			     "comment made by hand\n"
			     "element material 1\n"
			     "property list uchar float shine\n"
			     "element vertex 5\n"
			     "property uchar red\n"
			     "property double x\n"
			     "property float32 y\n"
			     "property short z\n"
			     "element face 3\n"
			     "property uchar flags\n"
			     "property list uint8 int vertex_index\n"
			     "element edge 1\n"
			     "property int vertex1\n"
			     "end_header\n"
			     "2 0.5 1\n"
			     "255 0 0 2\n9 1 0 2\n9 1 1 2\n9 0 1 2\n9 7 -8.5e0 9\n"
			     "0 4 0 1 2 3\n1 2 0 1\n0 0\n"
			     "4\n";

static void assert_square(const struct gz_mesh *mesh)
{
	static const uint32_t triangles[2][3] = { { 0, 1, 2 }, { 0, 2, 3 } };
	static const float corners[5][3] = {
		{ 0, 0, 2 }, { 1, 0, 2 }, { 1, 1, 2 }, { 0, 1, 2 }, { 7, -8.5F, 9 }
	};
	assert_int_equal(mesh->vertex_count, 5);
	assert_int_equal(mesh->triangle_count, 2);
	assert_memory_equal(mesh->triangles, triangles, sizeof triangles);
	assert_memory_equal(mesh->positions, corners, sizeof corners);
	for (int v = 0; v < 5; v++)
		assert_true(mesh->normals[v][0] == 0 && mesh->normals[v][1] == 0 &&
			    mesh->normals[v][2] == 1);
}

static void text_with_polygons_and_other_elements_is_read(void **state)
{
	(void)state;
	struct gz_mesh mesh;
	assert_int_equal(parse(square, &mesh), GZ_OK);
	assert_square(&mesh);
	gz_mesh_free(&mesh);
}

static void put_bits(char **at, uint64_t bits, int size, bool big)
{
	for (int i = 0; i < size; i++)
		*(*at)++ = (char)(bits >> 8 * (big ? size - 1 - i : i));
}

static uint64_t double_bits(double value)
{
	uint64_t bits;
	memcpy(&bits, &value, sizeof bits);
	return bits;
}

static uint64_t float_bits(float value)
{
	uint32_t bits;
	memcpy(&bits, &value, sizeof bits);
	return bits;
}

static void both_byte_orders_are_read(void **state)
{
	(void)state;
	static const double corners[5][3] = {
		{ 0, 0, 2 }, { 1, 0, 2 }, { 1, 1, 2 }, { 0, 1, 2 }, { 7, -8.5, 9 }
	};
	static const int faces[3][5] = { { 4, 0, 1, 2, 3 }, { 2, 0, 1 }, { 0 } };
	for (int big = 0; big < 2; big++) {
		char bytes[1024];
		struct gz_mesh mesh;
		char *at = bytes + snprintf(bytes, sizeof bytes,
					    "ply\nformat binary_%s_endian 1.0\n"
					    "element vertex 5\nproperty uchar red\n"
					    "property double x\nproperty float y\n"
					    "property short z\n"
					    "element face 3\nproperty list uchar float weights\n"
					    "property list ushort uint vertex_indices\n"
					    "end_header\n",
					    big ? "big" : "little");
		for (int v = 0; v < 5; v++) {
			put_bits(&at, 9, 1, big);
			put_bits(&at, double_bits(corners[v][0]), 8, big);
			put_bits(&at, float_bits((float)corners[v][1]), 4, big);
			put_bits(&at, (uint64_t)corners[v][2], 2, big);
		}
		for (int f = 0; f < 3; f++) {
			put_bits(&at, 1, 1, big);
			put_bits(&at, float_bits(0.5F), 4, big);
			put_bits(&at, (uint64_t)faces[f][0], 2, big);
			for (int i = 1; i <= faces[f][0]; i++)
				put_bits(&at, (uint64_t)faces[f][i], 4, big);
		}
		const size_t size = (size_t)(at - bytes);
		assert_int_equal(gz_mesh_parse_ply("a.ply", bytes, size, NULL, &mesh), GZ_OK);
		assert_square(&mesh);
		gz_mesh_free(&mesh);
		for (size_t cut = 0; cut < size; cut++) /* every shorter file is refused */
			assert_int_equal(gz_mesh_parse_ply("a.ply", bytes, cut, NULL, &mesh),
					 GZ_ERR_FORMAT);
	}
}

#define VERTEX "property float x\nproperty float y\nproperty float z\n"
#define FACE   "property list uchar int vertex_indices\n"

static void normals_of_the_file_are_scaled_and_missing_ones_made(void **state)
{
	(void)state;
	struct gz_mesh mesh;
	assert_int_equal(parse("ply\nformat ascii 1.0\nelement vertex 3\n" VERTEX
			       "property float nx\nproperty float ny\nproperty float nz\n"
			       "element face 1\n" FACE "end_header\n"
			       "0 0 0  3 0 4\n1 0 0  0 0 0\n0 1 0  0 -2 0\n3 0 1 2\n",
			       &mesh),
			 GZ_OK);
	assert_float_equal(mesh.normals[0][0], 0.6, 1e-6);
	assert_float_equal(mesh.normals[0][2], 0.8, 1e-6);
	assert_float_equal(mesh.normals[1][2], 1, 1e-6);
	assert_float_equal(mesh.normals[2][1], -1, 1e-6);
	gz_mesh_free(&mesh);
}

static void normal_that_is_no_number_is_made_again(void **state)
{
	(void)state;
	char bytes[512], *at;
	struct gz_mesh mesh;
	at = bytes + snprintf(bytes, sizeof bytes,
			      "ply\nformat binary_little_endian 1.0\nelement vertex 1\n" VERTEX
			      "property float nx\nproperty float ny\nproperty float nz\n"
			      "end_header\n");
	const float vertex[6] = { 1, 2, 3, 1, NAN, 0 };
	for (int i = 0; i < 6; i++)
		put_bits(&at, float_bits(vertex[i]), 4, false);
	assert_int_equal(gz_mesh_parse_ply("a.ply", bytes, (size_t)(at - bytes), NULL, &mesh),
			 GZ_OK);
	assert_true(mesh.normals[0][0] == 0 && mesh.normals[0][1] == 0 && mesh.normals[0][2] == 1);
	gz_mesh_free(&mesh);
}

static void points_without_faces_are_a_mesh_without_triangles(void **state)
{
	(void)state;
	struct gz_mesh mesh;
	assert_int_equal(parse("ply\nformat ascii 1.0\nelement vertex 1\n" VERTEX
			       "end_header\n1 2 3",
			       &mesh),
			 GZ_OK);
	assert_int_equal(mesh.vertex_count, 1);
	assert_int_equal(mesh.triangle_count, 0);
	gz_mesh_free(&mesh);
	assert_int_equal(parse("ply\nformat ascii 1.0\nelement vertex 0\n" VERTEX
			       "element face 0\n" FACE "end_header\n",
			       &mesh),
			 GZ_OK);
	assert_int_equal(mesh.vertex_count, 0);
	gz_mesh_free(&mesh);
}

static void each_fault_is_refused_with_its_place(void **state)
{
	(void)state;
#define HEAD "ply\nformat ascii 1.0\n"
	static const char *const cases[][2] = {
		{ "", "a.ply:1: the header is cut off" },
		{ "plyx\n", "a.ply:1: does not begin with ply" },
		{ "ply\nend_header\n", "a.ply:2: its PLY header has no format" },
		{ "ply\nformat ascii 2.0\n", "a.ply:2: the PLY format is not" },
		{ "ply\nformat zip 1.0\n", "a.ply:2: the PLY format is not" },
		{ HEAD "element vertex\n", "a.ply:3: a PLY element without" },
		{ HEAD "element vertex -1\n", "a.ply:3: a PLY element without" },
		{ HEAD "element vertex 99999999999999999999\n", "a.ply:3: a PLY element without" },
		{ HEAD "property float x\n", "a.ply:3: a PLY property in front" },
		{ HEAD "element face 1\n" FACE "end_header\n", "a.ply:5: faces come before" },
		{ HEAD "element vertex 1\n" VERTEX "element vertex 1\n" VERTEX "end_header\n",
		  "an element is there twice" },
		{ HEAD "element vertex 1\nproperty half x\n", "a.ply:4: a PLY property without" },
		{ HEAD "element vertex 1\nproperty list float int x\n",
		  "a.ply:4: a PLY property without" },
		{ HEAD "element vertex 1\nproperty float x\nproperty float x\nend_header\n",
		  "a property is there twice" },
		{ HEAD "element vertex 1\nproperty float x\nend_header\n1\n",
		  "there are no vertices with x, y and z" },
		{ HEAD "element vertex 1\n" VERTEX "element face 1\nproperty int a\nend_header\n",
		  "faces have no list" },
		{ HEAD "element vertex 1\n" VERTEX "element dust 5\nend_header\n1 2 3\n",
		  "an element has no properties" },
		{ HEAD "hello\n", "a.ply:3: not a line of a PLY header" },
		{ HEAD "element vertex 2000000000\n" VERTEX "end_header\n1 2 3\n",
		  "too short for the items that its header claims: 2000000000" },
		{ HEAD "element vertex 2\n" VERTEX "end_header\n1 2 3  4   5\n", "in vertex 1" },
		{ HEAD "element vertex 1\n" VERTEX "end_header\n1 two 3\n", "in vertex 0" },
		{ HEAD "element vertex 1\n" VERTEX "end_header\n1 nan 3\n", "in vertex 0" },
		{ HEAD "element vertex 1\n" VERTEX "end_header\n1 2e19 3\n",
		  "coordinates beyond 1e18 in vertex 0" },
		{ HEAD "element vertex 1\n" VERTEX "element face 1\n" FACE
		       "end_header\n1 2 3\n3 0 0 1\n",
		  "a corner that is not a vertex in face 0" },
		{ HEAD "element vertex 1\n" VERTEX "element face 1\n" FACE
		       "end_header\n1 2 3\n3 0 0 -1\n",
		  "a corner that is not a vertex in face 0" },
		{ HEAD "element vertex 1\n" VERTEX "element face 1\n" FACE
		       "end_header\n1 2 3\n3 0 0.5 0\n",
		  "a corner that is not a vertex in face 0" },
		{ HEAD "element vertex 1\n" VERTEX "element face 1\n" FACE
		       "end_header\n1 2 3\n-3 0 0 0\n",
		  "no number of corners, in face 0" },
	};
	for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
		struct captured_log captured;
		struct gz_mesh mesh;
		captured_log_init(&captured, "*:warn");
		const enum gz_result result = gz_mesh_parse_ply(
			"a.ply", cases[i][0], strlen(cases[i][0]), &captured.log, &mesh);
		if (result != GZ_ERR_FORMAT || captured.messages != 1 ||
		    !strstr(captured.last, cases[i][1]))
			fail_msg("%s: result %d, %d messages, \"%s\"", cases[i][0], (int)result,
				 captured.messages, captured.last);
	}
}

static enum gz_result parse_obj(const char *text, const struct gz_log *log,
				struct gz_mesh *out_mesh)
{
	return gz_mesh_parse_obj("a.obj", text, strlen(text), log, out_mesh);
}

static void obj_is_read_with_polygons_and_numbers_from_the_end(void **state)
{
	(void)state;
	static const char text[] = "# made by hand\r\n"
				   "v 0 0 2\r\n"
				   "v 1 0 2 0.5 0.5 0.5\r\n" /* a colour */
				   "vn 0 0 7\n"
				   "v 1 1 \\\n  2\n"
				   "f -3//1 2/9/1 3//-1 4//1\n"
				   "v\t0 1 2\n"
				   "usemtl shine\n"
				   "f 1 2\n"
				   "v 5 5 5";
	struct gz_mesh mesh;
	assert_int_equal(parse_obj(text, NULL, &mesh), GZ_OK);
	assert_int_equal(mesh.vertex_count, 5);
	assert_int_equal(mesh.triangle_count, 2);
	assert_memory_equal(mesh.triangles, ((uint32_t[2][3]) { { 0, 1, 2 }, { 0, 2, 3 } }),
			    sizeof(uint32_t[2][3]));
	assert_memory_equal(mesh.positions[2], ((float[3]) { 1, 1, 2 }), sizeof(float[3]));
	for (int v = 0; v < 5; v++)
		assert_memory_equal(mesh.normals[v], ((float[3]) { 0, 0, 1 }), sizeof(float[3]));
	gz_mesh_free(&mesh);
}

static void each_fault_of_an_obj_is_refused_with_its_line(void **state)
{
	(void)state;
	static const struct {
		const char *text, *words;
	} faults[] = {
		{ "", ": no line begins with v" },
		{ "v 0 0\n", "a.obj:1: no three numbers" },
		{ "v 0 0 nan\n", "a.obj:1: no three numbers" },
		{ "\nv 0 0 2e18\n", "a.obj:2: no three numbers up to 1e18" },
		{ "v 0 0 0\nf 1 1 2\n", "a.obj:2: a corner that is not a vertex" },
		{ "v 0 0 0\nf 1 1 0\n", "a corner that is not a vertex" },
		{ "v 0 0 0\nf 1 1 -2\n", "a corner that is not a vertex" },
		{ "f 1 1 -1\nv 0 0 0\n", "a.obj:1: a corner that is not a vertex" },
		{ "v 0 0 0\nf 1 1 -9223372036854775808\n", "a corner that is not a vertex" },
		{ "v 0 0 0\nf 1 1 x\n", "a corner that is not a vertex" },
		{ "v 0 0 0\nvn 0 0 1\nf 1//1 1//2 1//1\n", "a corner whose normal is not there" },
		{ "v 0 0 0\nvn 0 0 1\nf 1//1 1// 1//1\n", "a corner whose normal is not there" },
	};
	for (size_t i = 0; i < sizeof faults / sizeof faults[0]; i++) {
		struct captured_log log;
		struct gz_mesh mesh = { .vertex_count = 77 };
		captured_log_init(&log, NULL);
		if (parse_obj(faults[i].text, &log.log, &mesh) != GZ_ERR_FORMAT ||
		    !strstr(log.last, faults[i].words) || log.messages != 1)
			fail_msg("%s: '%s' lacks '%s'", faults[i].text, log.last, faults[i].words);
		assert_int_equal(mesh.vertex_count, 77);
	}
}

/* A mesh written as OBJ and STL comes back, from STL with its vertices joined again. */
static void written_obj_and_stl_are_read_back(void **state)
{
	(void)state;
	static const char *const names[] = { "ball.obj", "ball.stl" };
	static const int dims[3] = { 50, 50, 50 };
	static const double spacing[3] = { 1, 0.9, 1.2 };
	struct gz_volume volume = field_volume(field_ball, dims, spacing, GZ_VOXEL_F32);
	const struct gz_isosurface_request request = { .volume = &volume, .isovalue = 0.3 };
	struct gz_mesh mesh, read;
	assert_int_equal(gz_isosurface_make(&request, NULL, NULL, &mesh), GZ_OK);
	for (int i = 0; i < 2; i++) {
		const char *path = files_path(names[i]);
		assert_int_equal(gz_mesh_write(&mesh, path, NULL), GZ_OK);
		assert_int_equal(gz_mesh_read(path, NULL, &read), GZ_OK);
		assert_int_equal(read.vertex_count, mesh.vertex_count);
		assert_int_equal(read.triangle_count, mesh.triangle_count);
		for (size_t t = 0; t < 3 * mesh.triangle_count; t++) {
			const uint32_t a = mesh.triangles[t / 3][t % 3];
			const uint32_t b = read.triangles[t / 3][t % 3];
			assert_memory_equal(mesh.positions[a], read.positions[b],
					    sizeof mesh.positions[0]);
			for (int axis = 0; axis < 3; axis++)
				assert_float_equal(mesh.normals[a][axis], read.normals[b][axis],
						   i == 0 ? 1e-6 : 0.1);
		}
		gz_mesh_free(&read);
	}
	gz_mesh_free(&mesh);
	gz_volume_free(&volume);
}

#define STL_FACET(a, b, c)                                                      \
	"facet normal 0 0 0\nouter loop\nvertex " a "\nvertex " b "\nvertex " c \
	"\nendloop\nendfacet\n"

static void text_stl_is_read_and_its_corners_joined(void **state)
{
	(void)state;
	static const char text[] = "solid a vertex of a name\n" STL_FACET("0 0 0", "1 0 0", "0 1 0")
		STL_FACET("1 0 0", "1 1 -0", "0 1 0") "endsolid\n";
	struct gz_mesh mesh;
	assert_int_equal(gz_mesh_parse_stl("a.stl", text, strlen(text), NULL, &mesh), GZ_OK);
	assert_int_equal(mesh.vertex_count, 4);
	assert_int_equal(mesh.triangle_count, 2);
	assert_memory_equal(mesh.triangles, ((uint32_t[2][3]) { { 0, 1, 2 }, { 1, 3, 2 } }),
			    sizeof(uint32_t[2][3]));
	for (int v = 0; v < 4; v++)
		assert_memory_equal(mesh.normals[v], ((float[3]) { 0, 0, 1 }), sizeof(float[3]));
	gz_mesh_free(&mesh);
}

static void each_fault_of_an_stl_is_refused(void **state)
{
	(void)state;
	static const char claims[84] = { 's', 'o', 'l', 'i', 'd', [80] = 1 };
	static const char infinite[134] = { [80] = 1,
					    [84 + 12 + 2] = (char)0x80,
					    [84 + 12 + 3] = 0x7F };
	static const struct {
		const char *bytes;
		size_t size;
		const char *words;
	} faults[] = {
		{ "stl", 3, "neither begins with solid nor has the bytes of a head" },
		{ claims, sizeof claims, "cut off: its head claims triangles: 1" },
		{ infinite, sizeof infinite, "coordinates beyond 1e18 in triangle 0" },
		{ "solid\nvertex 0 0 0\nendfacet\n", 28,
		  "no three corners in the facet before line 3" },
		{ "solid\nvertex 0 0 0\n", 19, "cut off in line" },
		{ "solid\nvertex 0 0\n", 17, "no three numbers up to 1e18 in line 2" },
	};
	for (size_t i = 0; i < sizeof faults / sizeof faults[0]; i++) {
		struct captured_log log;
		struct gz_mesh mesh = { .vertex_count = 77 };
		captured_log_init(&log, NULL);
		if (gz_mesh_parse_stl("a.stl", faults[i].bytes, faults[i].size, &log.log, &mesh) !=
			    GZ_ERR_FORMAT ||
		    !strstr(log.last, faults[i].words) || log.messages != 1)
			fail_msg("'%s' lacks '%s'", log.last, faults[i].words);
		assert_int_equal(mesh.vertex_count, 77);
	}
}

static void missing_file_and_other_endings_are_refused(void **state)
{
	(void)state;
	struct captured_log captured;
	struct gz_mesh mesh;
	captured_log_init(&captured, "*:warn");
	assert_int_equal(gz_mesh_read(files_path("none.ply"), &captured.log, &mesh),
			 GZ_ERR_NOT_FOUND);
	assert_non_null(strstr(captured.last, "none.ply: cannot be read"));
	assert_int_equal(gz_mesh_read("a.vtk", &captured.log, &mesh), GZ_ERR_UNSUPPORTED);
	assert_non_null(strstr(captured.last, ".ply"));
}

static void mesh_is_moved_and_bounded(void **state)
{
	(void)state;
	double least[3] = { INFINITY, INFINITY, INFINITY };
	double greatest[3] = { -INFINITY, -INFINITY, -INFINITY };
	struct gz_mesh mesh;
	assert_int_equal(parse(square, &mesh), GZ_OK);
	gz_mesh_bound(&mesh, least, greatest);
	assert_true(least[0] == 0 && least[1] == -8.5 && least[2] == 2);
	assert_true(greatest[0] == 7 && greatest[1] == 1 && greatest[2] == 9);
	gz_mesh_move(&mesh, greatest);
	assert_true(mesh.positions[4][0] == 0 && mesh.positions[4][1] == -9.5F &&
		    mesh.positions[0][2] == -7);
	gz_mesh_free(&mesh);
}

TEST_SUITE(mesh_read)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(written_mesh_is_read_back),
		cmocka_unit_test(text_with_polygons_and_other_elements_is_read),
		cmocka_unit_test(both_byte_orders_are_read),
		cmocka_unit_test(normals_of_the_file_are_scaled_and_missing_ones_made),
		cmocka_unit_test(normal_that_is_no_number_is_made_again),
		cmocka_unit_test(points_without_faces_are_a_mesh_without_triangles),
		cmocka_unit_test(each_fault_is_refused_with_its_place),
		cmocka_unit_test(obj_is_read_with_polygons_and_numbers_from_the_end),
		cmocka_unit_test(each_fault_of_an_obj_is_refused_with_its_line),
		cmocka_unit_test(written_obj_and_stl_are_read_back),
		cmocka_unit_test(text_stl_is_read_and_its_corners_joined),
		cmocka_unit_test(each_fault_of_an_stl_is_refused),
		cmocka_unit_test(missing_file_and_other_endings_are_refused),
		cmocka_unit_test(mesh_is_moved_and_bounded),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
