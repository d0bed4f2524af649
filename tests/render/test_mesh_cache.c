/* Files of what was computed of a mesh: they survive another version, being cut short and lies
 * about their length, and are found where the input's folder cannot be written. */
#include "suite.h"

#include <fcntl.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/sizes.h"
#include "mesh_shapes.h"
#include "render/mesh/cache/mesh_cache.h"

enum { FLOATS = 12, FILE_SIZE = 88 + 4 * FLOATS };

static char folder[64];
static int log_lines;
static char last_line[2048];

static void count_line(void *user, enum gz_log_level level, const char *module, const char *message)
{
	(void)user;
	(void)level;
	(void)module;
	log_lines++;
	snprintf(last_line, sizeof last_line, "%s", message);
}

static struct gz_log make_log(void)
{
	struct gz_log log;
	gz_log_init(&log, count_line, NULL, "*:debug");
	log_lines = 0;
	return log;
}

static int make_folder(void **state)
{
	(void)state;
	strcpy(folder, "/tmp/gazecast-mesh-cache-XXXXXX");
	return mkdtemp(folder) && setenv("XDG_CACHE_HOME", folder, 1) == 0 ? 0 : -1;
}

static int remove_folder(void **state)
{
	char command[128];
	(void)state;
	snprintf(command, sizeof command, "rm -rf '%s'", folder);
	return system(
		command); /* NOLINT(bugprone-command-processor,cert-env33-c): a name of ours */
}

static void name_file(const char *name, char path[GZ_PATH_SIZE])
{
	snprintf(path, GZ_PATH_SIZE, "%s/%s", folder, name);
}

/* Two arrays of numbers, and their key. */
struct sample {
	float first[5], second[7];
	struct gz_mesh_cache_array arrays[2];
	struct gz_mesh_key key;
};

static void fill_sample(struct sample *sample)
{
	struct gz_mesh mesh = mesh_ball(10, 1);
	for (int i = 0; i < 5; i++)
		sample->first[i] = (float)i / 3;
	for (int i = 0; i < 7; i++)
		sample->second[i] = -1e20F * (float)i;
	sample->arrays[0] = (struct gz_mesh_cache_array) { sample->first, 5 };
	sample->arrays[1] = (struct gz_mesh_cache_array) { sample->second, 7 };
	assert_int_equal(gz_mesh_key_make(&mesh, "sample", &sample->key), GZ_OK);
	gz_mesh_free(&mesh);
}

static void check_sample(const struct sample *sample)
{
	for (int i = 0; i < 5; i++)
		assert_true(sample->first[i] == (float)i / 3);
	for (int i = 0; i < 7; i++)
		assert_true(sample->second[i] == -1e20F * (float)i);
}

static enum gz_result load_into(const char *input, struct sample *sample, const struct gz_log *log)
{
	const struct gz_mesh_cache_place place = { input, "sample" };
	memset(sample->first, 0, sizeof sample->first);
	memset(sample->second, 0, sizeof sample->second);
	return gz_mesh_cache_load(&place, &sample->key, sample->arrays, 2, log);
}

/* Store a sample beside "ball.ply" and read the file's bytes. */
static void store_bytes(struct sample *sample, unsigned char bytes[FILE_SIZE])
{
	char input[GZ_PATH_SIZE], path[GZ_PATH_SIZE];
	fill_sample(sample);
	name_file("ball.ply", input);
	name_file("ball.ply.sample", path);
	const struct gz_mesh_cache_place place = { input, "sample" };
	assert_int_equal(gz_mesh_cache_store(&place, &sample->key, sample->arrays, 2, NULL), GZ_OK);
	FILE *file = fopen(path, "rb");
	assert_non_null(file);
	assert_int_equal(fread(bytes, 1, FILE_SIZE, file), FILE_SIZE);
	assert_int_equal(fgetc(file), EOF);
	fclose(file);
}

static void put_bytes(const unsigned char *bytes, size_t size)
{
	char path[GZ_PATH_SIZE];
	name_file("ball.ply.sample", path);
	FILE *file = fopen(path, "wb");
	assert_non_null(file);
	assert_int_equal(fwrite(bytes, 1, size, file), size);
	assert_int_equal(fclose(file), 0);
}

static void what_is_stored_is_loaded(void **state)
{
	(void)state;
	struct sample sample;
	unsigned char bytes[FILE_SIZE];
	char input[GZ_PATH_SIZE];
	const struct gz_log log = make_log();
	name_file("ball.ply", input);
	store_bytes(&sample, bytes);
	assert_int_equal(load_into(input, &sample, &log), GZ_OK);
	check_sample(&sample);
	assert_int_equal(log_lines, 0);
}

static void keys_tell_meshes_and_purposes_apart(void **state)
{
	(void)state;
	struct gz_mesh mesh = mesh_ball(10, 1);
	struct gz_mesh_key keys[4];
	assert_int_equal(gz_mesh_key_make(&mesh, "a", &keys[0]), GZ_OK);
	assert_int_equal(gz_mesh_key_make(&mesh, "b", &keys[1]), GZ_OK);
	mesh.positions[3][1] = nextafterf(mesh.positions[3][1], 9);
	assert_int_equal(gz_mesh_key_make(&mesh, "a", &keys[2]), GZ_OK);
	mesh_turn(&mesh, 5);
	assert_int_equal(gz_mesh_key_make(&mesh, "a", &keys[3]), GZ_OK);
	for (int i = 0; i < 4; i++)
		for (int k = 0; k < i; k++)
			assert_memory_not_equal(&keys[i], &keys[k], sizeof keys[0]);
	gz_mesh_free(&mesh);
}

/* Each fault is refused with one line that says why. */
static void faulty_files_are_refused_with_one_line(void **state)
{
	(void)state;
	static const struct {
		const char *says;
		size_t at; /* of the byte that is changed */
		unsigned char add;
		int longer; /* bytes that are added or taken away */
	} faults[] = {
		{ "no such file", 2, 1, 0 },
		{ "another version", 8, 1, 0 },
		{ "another version", 12, 1, 0 },
		{ "its length is not", 16, 1, 0 },
		{ "its length is not", 23, 255, 0 },
		{ "another mesh", 24, 1, 0 },
		{ "content has changed", 60, 1, 0 },
		{ "content has changed", FILE_SIZE - 1, 1, 0 },
		{ "cut short", 0, 0, -1 },
		{ "cut short", 0, 0, -FILE_SIZE },
		{ "cut short", 0, 0, 87 - FILE_SIZE },
		{ "bytes follow", 0, 0, 1 },
		{ "bytes follow", 0, 0, 5000 },
	};
	static unsigned char changed[FILE_SIZE + 5000];
	struct sample sample;
	unsigned char bytes[FILE_SIZE];
	char input[GZ_PATH_SIZE];
	name_file("ball.ply", input);
	store_bytes(&sample, bytes);
	for (size_t i = 0; i < sizeof faults / sizeof faults[0]; i++) {
		const struct gz_log log = make_log();
		memcpy(changed, bytes, FILE_SIZE);
		changed[faults[i].at] = (unsigned char)(changed[faults[i].at] + faults[i].add);
		put_bytes(changed, FILE_SIZE + (size_t)(ptrdiff_t)faults[i].longer);
		assert_int_equal(load_into(input, &sample, &log), GZ_ERR_FORMAT);
		if (log_lines != 1 || !strstr(last_line, faults[i].says))
			print_message("fault %zu: %d lines, %s\n", i, log_lines, last_line);
		assert_true(log_lines == 1 && strstr(last_line, faults[i].says));
	}
	/* Made again, it serves again. */
	store_bytes(&sample, bytes);
	assert_int_equal(load_into(input, &sample, NULL), GZ_OK);
	check_sample(&sample);
}

/* A file with a right hash is refused too if it has a number that would spread through a picture.
 */
static void numbers_that_are_not_finite_are_refused(void **state)
{
	(void)state;
	struct sample sample;
	char input[GZ_PATH_SIZE];
	const struct gz_log log = make_log();
	name_file("nan.ply", input);
	fill_sample(&sample);
	sample.second[6] = NAN;
	const struct gz_mesh_cache_place place = { input, "sample" };
	assert_int_equal(gz_mesh_cache_store(&place, &sample.key, sample.arrays, 2, &log), GZ_OK);
	assert_int_equal(load_into(input, &sample, &log), GZ_ERR_FORMAT);
	assert_int_equal(log_lines, 1);
}

static void missing_file_is_not_found_and_not_logged(void **state)
{
	(void)state;
	struct sample sample;
	char input[GZ_PATH_SIZE];
	const struct gz_log log = make_log();
	fill_sample(&sample);
	name_file("none.ply", input);
	sample.key.bytes[0] ^= 1;
	assert_int_equal(load_into(input, &sample, &log), GZ_ERR_NOT_FOUND);
	assert_int_equal(load_into(NULL, &sample, &log), GZ_ERR_NOT_FOUND);
	assert_int_equal(log_lines, 0);
}

/* Where nothing can be written beside the input, the user's folder serves. */
static void users_folder_serves_where_the_input_cannot(void **state)
{
	(void)state;
	struct sample sample;
	char input[GZ_PATH_SIZE];
	const struct gz_log log = make_log();
	fill_sample(&sample);
	name_file("no-such-folder/ball.ply", input);
	const struct gz_mesh_cache_place place = { input, "sample" };
	assert_int_equal(gz_mesh_cache_store(&place, &sample.key, sample.arrays, 2, &log), GZ_OK);
	assert_int_equal(load_into(input, &sample, &log), GZ_OK);
	check_sample(&sample);
	assert_int_equal(load_into(NULL, &sample, &log), GZ_OK);
	check_sample(&sample);
	assert_int_equal(log_lines, 0);
}

static void without_any_folder_one_line_says_so(void **state)
{
	(void)state;
	struct sample sample;
	char input[GZ_PATH_SIZE], blocked[GZ_PATH_SIZE];
	const struct gz_log log = make_log();
	fill_sample(&sample);
	name_file("no-such-folder/ball.ply", input);
	name_file("a-file", blocked);
	close(open(blocked, O_CREAT | O_WRONLY, 0600));
	assert_int_equal(setenv("XDG_CACHE_HOME", blocked, 1), 0);
	const struct gz_mesh_cache_place place = { input, "sample" };
	assert_int_equal(gz_mesh_cache_store(&place, &sample.key, sample.arrays, 2, &log),
			 GZ_ERR_IO);
	assert_int_equal(log_lines, 1);
	assert_int_equal(setenv("XDG_CACHE_HOME", folder, 1), 0);
}

TEST_SUITE(mesh_cache)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(what_is_stored_is_loaded),
		cmocka_unit_test(keys_tell_meshes_and_purposes_apart),
		cmocka_unit_test(faulty_files_are_refused_with_one_line),
		cmocka_unit_test(numbers_that_are_not_finite_are_refused),
		cmocka_unit_test(missing_file_is_not_found_and_not_logged),
		cmocka_unit_test(users_folder_serves_where_the_input_cannot),
		cmocka_unit_test(without_any_folder_one_line_says_so),
	};
	return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
