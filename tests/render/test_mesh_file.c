/* Files of meshes say what the mesh says, and failed ones leave nothing behind. */
#include "suite.h"

#include <errno.h>
#include <locale.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/captured_log.h"
#include "mesh_fields.h"
#include "render/mesh/isosurface.h"
#include "render/mesh/mesh_file.h"
#include "render/mesh/mesh_read.h"
#include "volume_files.h"

static struct gz_mesh ball_mesh(void)
{
	static const int dims[3] = { 50, 50, 50 };
	static const double spacing[3] = { 1, 0.9, 1.2 };
	struct gz_volume volume = field_volume(field_ball, dims, spacing, GZ_VOXEL_U16);
	const struct gz_isosurface_request request = { .volume = &volume, .isovalue = 0.3 };
	struct gz_mesh mesh;
	assert_int_equal(gz_isosurface_make(&request, NULL, NULL, &mesh), GZ_OK);
	gz_volume_free(&volume);
	return mesh;
}

static char *read_all(const char *path, size_t *out_size)
{
	FILE *file = fopen(path, "rb");
	assert_non_null(file);
	assert_int_equal(fseek(file, 0, SEEK_END), 0);
	const long size = ftell(file);
	rewind(file);
	char *bytes = malloc((size_t)size + 1);
	assert_non_null(bytes);
	assert_int_equal(fread(bytes, 1, (size_t)size, file), (size_t)size);
	bytes[size] = '\0';
	fclose(file);
	*out_size = (size_t)size;
	return bytes;
}

static uint32_t u32_at(const char *at)
{
	const uint8_t *bytes = (const uint8_t *)at;
	return bytes[0] | (uint32_t)bytes[1] << 8 | (uint32_t)bytes[2] << 16 |
	       (uint32_t)bytes[3] << 24;
}

static float float_at(const char *at)
{
	const uint32_t bits = u32_at(at);
	float value;
	memcpy(&value, &bits, sizeof value);
	return value;
}

static void ply_holds_all_floats_and_numbers(void **state)
{
	(void)state;
	struct gz_mesh mesh = ball_mesh();
	const char *path = files_path("ball.ply");
	size_t size;
	assert_int_equal(gz_mesh_write(&mesh, path, NULL), GZ_OK);
	char *bytes = read_all(path, &size), line[64];
	assert_int_equal(strncmp(bytes, "ply\nformat binary_little_endian 1.0\n", 36), 0);
	snprintf(line, sizeof line, "element vertex %zu\n", mesh.vertex_count);
	assert_non_null(strstr(bytes, line));
	snprintf(line, sizeof line, "element face %zu\n", mesh.triangle_count);
	assert_non_null(strstr(bytes, line));
	const char *at = strstr(bytes, "end_header\n") + 11;
	assert_int_equal(bytes + size - at, 24 * mesh.vertex_count + 13 * mesh.triangle_count);
	for (size_t v = 0; v < mesh.vertex_count; v++)
		for (int i = 0; i < 6; i++, at += 4)
			assert_true(float_at(at) ==
				    (i < 3 ? mesh.positions[v][i] : mesh.normals[v][i - 3]));
	for (size_t t = 0; t < mesh.triangle_count; t++, at += 13) {
		assert_int_equal(*at, 3);
		for (int c = 0; c < 3; c++)
			assert_int_equal(u32_at(at + 1 + 4 * c), mesh.triangles[t][c]);
	}
	free(bytes);
	gz_mesh_free(&mesh);
}

/* Whatever decimal point the locale has. */
static void obj_reads_back_as_the_same_floats(void **state)
{
	(void)state;
	setlocale(LC_ALL, "de_DE.UTF-8");
	struct gz_mesh mesh = ball_mesh();
	const char *path = files_path("ball.OBJ");
	size_t size;
	const enum gz_result result = gz_mesh_write(&mesh, path, NULL);
	setlocale(LC_ALL, "C");
	assert_int_equal(result, GZ_OK);
	char *bytes = read_all(path, &size);
	size_t vertices = 0, normals = 0, triangles = 0;
	for (char *line = strtok(bytes, "\n"); line; line = strtok(NULL, "\n")) {
		float p[3];
		unsigned c[6];
		if (sscanf(line, "v %f %f %f", &p[0], &p[1], &p[2]) == 3) {
			assert_memory_equal(p, mesh.positions[vertices], sizeof p);
			vertices++;
		} else if (sscanf(line, "vn %f %f %f", &p[0], &p[1], &p[2]) == 3) {
			for (int i = 0; i < 3; i++) /* -0 is 0 */
				assert_true(p[i] == mesh.normals[normals][i]);
			normals++;
		} else if (sscanf(line, "f %u//%u %u//%u %u//%u", &c[0], &c[1], &c[2], &c[3], &c[4],
				  &c[5]) == 6) {
			for (int i = 0; i < 6; i++)
				assert_int_equal(c[i], mesh.triangles[triangles][i / 2] + 1);
			triangles++;
		} else {
			assert_int_equal(line[0], '#');
		}
	}
	assert_int_equal(vertices, mesh.vertex_count);
	assert_int_equal(normals, mesh.vertex_count);
	assert_int_equal(triangles, mesh.triangle_count);
	free(bytes);
	gz_mesh_free(&mesh);
}

static void stl_holds_each_triangle_with_the_normal_of_its_plane(void **state)
{
	(void)state;
	struct gz_mesh mesh = ball_mesh();
	const char *path = files_path("ball.stl");
	size_t size;
	assert_int_equal(gz_mesh_write(&mesh, path, NULL), GZ_OK);
	char *bytes = read_all(path, &size);
	assert_int_equal(size, 84 + 50 * mesh.triangle_count);
	assert_int_not_equal(strncmp(bytes, "solid", 5), 0);
	assert_int_equal(u32_at(bytes + 80), mesh.triangle_count);
	for (size_t t = 0; t < mesh.triangle_count; t++) {
		const char *at = bytes + 84 + 50 * t;
		float middle[3] = { 0 };
		for (int i = 0; i < 9; i++) {
			const float value = float_at(at + 12 + 4 * i);
			assert_true(value == mesh.positions[mesh.triangles[t][i / 3]][i % 3]);
			middle[i % 3] += value / 3;
		}
		float out = 0;
		for (int axis = 0; axis < 3; axis++)
			out += float_at(at + 4 * axis) * middle[axis];
		/* out of a ball of 19.7 mm; triangles without an area have no normal */
		assert_true(out > 19 || out == 0);
	}
	free(bytes);
	gz_mesh_free(&mesh);
}

static void empty_mesh_is_a_valid_file(void **state)
{
	(void)state;
	const struct gz_mesh mesh = { 0 };
	size_t size;
	const char *path = files_path("empty.stl");
	assert_int_equal(gz_mesh_write(&mesh, path, NULL), GZ_OK);
	free(read_all(path, &size));
	assert_int_equal(size, 84);
	path = files_path("empty.ply");
	assert_int_equal(gz_mesh_write(&mesh, path, NULL), GZ_OK);
	char *bytes = read_all(path, &size);
	assert_non_null(strstr(bytes, "element face 0\n"));
	free(bytes);
}

static int file_exists(const char *path)
{
	struct stat status;
	return lstat(path, &status) == 0;
}

static void full_disk_is_told_and_keeps_the_older_file(void **state)
{
	(void)state;
	struct gz_mesh mesh = ball_mesh();
	struct rlimit before;
	assert_int_equal(getrlimit(RLIMIT_FSIZE, &before), 0);
	const struct rlimit little = { 100000, before.rlim_max };
	signal(SIGXFSZ, SIG_IGN);
	for (int older = 0; older < 2; older++) {
		const char *path =
			older ? files_write("full.ply", "older", 5) : files_path("full.ply");
		char part[512];
		snprintf(part, sizeof part, "%s.part", path);
		struct captured_log log;
		captured_log_init(&log, "*:info");
		assert_int_equal(setrlimit(RLIMIT_FSIZE, &little), 0);
		const enum gz_result result = gz_mesh_write(&mesh, path, &log.log);
		assert_int_equal(setrlimit(RLIMIT_FSIZE, &before), 0);
		assert_int_equal(result, GZ_ERR_FULL);
		assert_int_equal(log.messages, 1);
		assert_non_null(strstr(log.last, path));
		assert_int_equal(file_exists(path), older);
		assert_false(file_exists(part));
	}
	gz_mesh_free(&mesh);
}

static void device_is_written_to_and_not_replaced(void **state)
{
	(void)state;
	struct gz_mesh mesh = ball_mesh();
	const char *full = files_path("device.ply"), *null = files_path("null.obj");
	struct stat status;
	struct captured_log log;
	captured_log_init(&log, "*:info");
	assert_int_equal(symlink("/dev/full", full), 0);
	assert_int_equal(symlink("/dev/null", null), 0);
	assert_int_equal(gz_mesh_write(&mesh, full, &log.log), GZ_ERR_FULL);
	assert_int_equal(log.messages, 1);
	assert_non_null(strstr(log.last, "No space left"));
	assert_int_equal(gz_mesh_write(&mesh, null, &log.log), GZ_OK);
	assert_int_equal(log.messages, 1);
	assert_int_equal(stat(full, &status), 0);
	assert_true(S_ISCHR(status.st_mode));
	assert_int_equal(lstat(full, &status), 0);
	assert_true(S_ISLNK(status.st_mode));
	unlink(full);
	unlink(null);
	gz_mesh_free(&mesh);
}

static void names_that_cannot_be_written_are_refused(void **state)
{
	(void)state;
	struct gz_mesh mesh = ball_mesh();
	struct captured_log log;
	captured_log_init(&log, "*:info");
	assert_int_equal(gz_mesh_write(&mesh, files_path("ball.mesh"), &log.log),
			 GZ_ERR_UNSUPPORTED);
	assert_non_null(strstr(log.last, ".ply"));
	assert_int_equal(gz_mesh_write(&mesh, files_path("no/ball.ply"), &log.log), GZ_ERR_IO);
	assert_non_null(strstr(log.last, "no/ball.ply"));
	assert_int_equal(gz_mesh_write(&mesh, files_folder(), &log.log), GZ_ERR_UNSUPPORTED);
	assert_int_equal(log.messages, 3);
	assert_false(file_exists(files_path("ball.mesh")));
	assert_true(gz_mesh_file_named("a.PLY") && gz_mesh_file_named("b.stl"));
	assert_false(gz_mesh_file_named("ply"));
	gz_mesh_free(&mesh);
}

/* Where the line "end_header" of a PLY ends. */
static const char *after_head(const char *bytes)
{
	const char *end = strstr(bytes, "end_header\n");
	assert_non_null(end);
	return end + strlen("end_header\n");
}

static void parts_have_colours_labels_and_vertices_of_their_own(void **state)
{
	(void)state;
	struct gz_mesh ball = ball_mesh(), read;
	const struct gz_mesh_part parts[2] = { { &ball, 7, { 1, 0.5F, 0 } },
					       { &ball, -3, { 0, 0, 1 } } };
	size_t size;
	char path[128];
	snprintf(path, sizeof path, "%s", files_path("parts.ply"));
	assert_int_equal(gz_mesh_write_parts(parts, 2, path, NULL), GZ_OK);
	char *bytes = read_all(path, &size);
	const char *at = after_head(bytes), *faces = at + 54 * ball.vertex_count;
	assert_int_equal((size_t)(bytes + size - at),
			 2 * (27 * ball.vertex_count + 17 * ball.triangle_count));
	assert_memory_equal(at + 24, "\xFF\x80\x00", 3);
	assert_memory_equal(at + 27 * ball.vertex_count + 24, "\x00\x00\xFF", 3);
	const char *second = faces + 17 * ball.triangle_count;
	assert_int_equal(u32_at(faces + 13), 7);
	assert_int_equal((int32_t)u32_at(second + 13), -3);
	for (int c = 0; c < 3; c++)
		assert_int_equal(u32_at(second + 1 + 4 * c),
				 ball.triangles[0][c] + ball.vertex_count);
	free(bytes);
	static const char *const names[] = { "parts.ply", "parts.obj", "parts.stl" };
	for (int i = 0; i < 3; i++) {
		snprintf(path, sizeof path, "%s", files_path(names[i]));
		assert_int_equal(gz_mesh_write_parts(parts, 2, path, NULL), GZ_OK);
		assert_int_equal(gz_mesh_read(path, NULL, &read), GZ_OK);
		assert_int_equal(read.triangle_count, 2 * ball.triangle_count);
		gz_mesh_free(&read);
	}
	gz_mesh_free(&ball);
}

static void parts_too_many_for_a_file_are_refused_before_it_is_made(void **state)
{
	(void)state;
	const struct gz_mesh huge = { .vertex_count = GZ_MESH_COUNT_MAX };
	const struct gz_mesh_part parts[2] = { { .mesh = &huge }, { .mesh = &huge } };
	char path[128];
	snprintf(path, sizeof path, "%s", files_path("huge.ply"));
	assert_int_equal(gz_mesh_write_parts(parts, 2, path, NULL), GZ_ERR_FULL);
	assert_int_equal(access(path, F_OK), -1);
}

TEST_SUITE(mesh_file)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(ply_holds_all_floats_and_numbers),
		cmocka_unit_test(obj_reads_back_as_the_same_floats),
		cmocka_unit_test(stl_holds_each_triangle_with_the_normal_of_its_plane),
		cmocka_unit_test(empty_mesh_is_a_valid_file),
		cmocka_unit_test(full_disk_is_told_and_keeps_the_older_file),
		cmocka_unit_test(device_is_written_to_and_not_replaced),
		cmocka_unit_test(names_that_cannot_be_written_are_refused),
		cmocka_unit_test(parts_have_colours_labels_and_vertices_of_their_own),
		cmocka_unit_test(parts_too_many_for_a_file_are_refused_before_it_is_made),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
