/* Files of what was computed of a mesh: they survive another version, being cut short and lies
 * about their length, and are found where the user's folder cannot be written. */
#include "suite.h"

#include <fcntl.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/sizes.h"
#include "kept_files.h"
#include "mesh_shapes.h"
#include "render/mesh/cache/mesh_cache.h"

enum { FLOATS = 12, FILE_SIZE = 88 + 4 * FLOATS };

static const char *folder;
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
	folder = kept_files_open();
	return 0;
}

static int remove_folder(void **state)
{
	(void)state;
	kept_files_close();
	return 0;
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

/* The path of a sample's file in the user's cache folder. */
static void name_kept(const struct sample *sample, char path[GZ_PATH_SIZE])
{
	char hex[2 * GZ_MESH_KEY_SIZE + 1];
	for (int i = 0; i < GZ_MESH_KEY_SIZE; i++)
		snprintf(hex + 2 * i, 3, "%02x", sample->key.bytes[i]);
	snprintf(path, GZ_PATH_SIZE, "%s/gazecast/meshes/%s.sample", folder, hex);
}

/* Store a sample of "ball.ply" and read the file's bytes. */
static void store_bytes(struct sample *sample, unsigned char bytes[FILE_SIZE])
{
	char input[GZ_PATH_SIZE], path[GZ_PATH_SIZE];
	fill_sample(sample);
	name_file("ball.ply", input);
	name_kept(sample, path);
	const struct gz_mesh_cache_place place = { input, "sample" };
	assert_int_equal(gz_mesh_cache_store(&place, &sample->key, sample->arrays, 2, NULL), GZ_OK);
	FILE *file = fopen(path, "rb");
	assert_non_null(file);
	assert_int_equal(fread(bytes, 1, FILE_SIZE, file), FILE_SIZE);
	assert_int_equal(fgetc(file), EOF);
	fclose(file);
}

static void put_bytes(const struct sample *sample, const unsigned char *bytes, size_t size)
{
	char path[GZ_PATH_SIZE];
	name_kept(sample, path);
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
		{ "not such a file", 2, 1, 0 },
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
		put_bytes(&sample, changed, FILE_SIZE + (size_t)(ptrdiff_t)faults[i].longer);
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
/* A file of any length gives as much as it has, and is checked as one of a known length is. */
static void file_of_any_length_is_loaded_whole(void **state)
{
	(void)state;
	static const struct gz_mesh_cache_place place = { NULL, "sample" };
	struct sample sample;
	unsigned char bytes[FILE_SIZE];
	struct gz_mesh_cache_array whole = { 0 };
	store_bytes(&sample, bytes);
	assert_int_equal(gz_mesh_cache_load_whole(&place, &sample.key, FLOATS, NULL, &whole),
			 GZ_OK);
	assert_int_equal(whole.count, FLOATS);
	assert_memory_equal(whole.values, sample.first, sizeof sample.first);
	assert_memory_equal(whole.values + 5, sample.second, sizeof sample.second);
	free(whole.values);
	whole = (struct gz_mesh_cache_array) { 0 };
	struct gz_log log = make_log();
	assert_int_equal(gz_mesh_cache_load_whole(&place, &sample.key, FLOATS - 1, &log, &whole),
			 GZ_ERR_FORMAT);
	assert_int_equal(log_lines, 1);
	for (size_t size = 0; size < FILE_SIZE; size++) { /* cut short anywhere */
		log = make_log();
		put_bytes(&sample, bytes, size);
		assert_int_equal(
			gz_mesh_cache_load_whole(&place, &sample.key, FLOATS, &log, &whole),
			GZ_ERR_FORMAT);
		assert_int_equal(log_lines, 1);
	}
	bytes[FILE_SIZE - 1]++;
	put_bytes(&sample, bytes, FILE_SIZE);
	assert_int_equal(gz_mesh_cache_load_whole(&place, &sample.key, FLOATS, NULL, &whole),
			 GZ_ERR_FORMAT);
	assert_null(whole.values);
	sample.key.bytes[0]++;
	assert_int_equal(gz_mesh_cache_load_whole(&place, &sample.key, FLOATS, NULL, &whole),
			 GZ_ERR_NOT_FOUND);
}

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

/* Make a file of which no folder can be made, the user's. */
static void block_user_folder(void)
{
	char blocked[GZ_PATH_SIZE];
	name_file("a-file", blocked);
	close(open(blocked, O_CREAT | O_WRONLY, 0600));
	assert_int_equal(setenv("XDG_CACHE_HOME", blocked, 1), 0);
}

static void input_folder_serves_where_the_users_cannot(void **state)
{
	(void)state;
	struct sample sample;
	char input[GZ_PATH_SIZE], beside[GZ_PATH_SIZE];
	const struct gz_log log = make_log();
	fill_sample(&sample);
	sample.key.bytes[0] ^= 2;
	name_file("other.ply", input);
	name_file("other.ply.sample", beside);
	const struct gz_mesh_cache_place place = { input, "sample" };
	assert_int_equal(gz_mesh_cache_store(&place, &sample.key, sample.arrays, 2, &log), GZ_OK);
	assert_int_equal(access(beside, F_OK), -1); /* the input's folder stays as it is */
	sample.key.bytes[0] ^= 1;
	block_user_folder();
	assert_int_equal(gz_mesh_cache_store(&place, &sample.key, sample.arrays, 2, &log), GZ_OK);
	assert_int_equal(access(beside, R_OK), 0);
	assert_int_equal(load_into(input, &sample, &log), GZ_OK);
	check_sample(&sample);
	assert_int_equal(setenv("XDG_CACHE_HOME", folder, 1), 0);
	assert_int_equal(log_lines, 0);
}

static void without_any_folder_one_line_says_so(void **state)
{
	(void)state;
	struct sample sample;
	char input[GZ_PATH_SIZE];
	const char *inputs[] = { input, NULL };
	fill_sample(&sample);
	name_file("no-such-folder/ball.ply", input);
	block_user_folder();
	for (size_t i = 0; i < 2; i++) {
		const struct gz_log log = make_log();
		const struct gz_mesh_cache_place place = { inputs[i], "sample" };
		assert_int_equal(gz_mesh_cache_store(&place, &sample.key, sample.arrays, 2, &log),
				 GZ_ERR_IO);
		assert_int_equal(log_lines, 1);
	}
	assert_int_equal(setenv("XDG_CACHE_HOME", folder, 1), 0);
}

/* Write a file of 100 bytes that was used @p second seconds after the epoch. */
static void write_used(const char *name, time_t second)
{
	char path[GZ_PATH_SIZE];
	const struct timespec times[2] = { { .tv_sec = second }, { .tv_sec = second } };
	name_file(name, path);
	FILE *file = fopen(path, "wb");
	assert_non_null(file);
	for (int i = 0; i < 100; i++)
		fputc('x', file);
	assert_int_equal(fclose(file), 0);
	assert_int_equal(utimensat(AT_FDCWD, path, times, 0), 0);
}

static bool is_there(const char *name)
{
	char path[GZ_PATH_SIZE];
	name_file(name, path);
	return access(path, F_OK) == 0;
}

static void files_that_were_not_used_lately_go_first(void **state)
{
	(void)state;
	char trimmed[GZ_PATH_SIZE];
	name_file("trimmed", trimmed);
	assert_int_equal(mkdir(trimmed, 0700), 0);
	write_used("trimmed/b", 2000);
	write_used("trimmed/a", 3000);
	write_used("trimmed/d", 1000);
	write_used("trimmed/c", 4000);
	gz_mesh_cache_trim(trimmed, 400);
	assert_true(is_there("trimmed/d"));
	gz_mesh_cache_trim(trimmed, 250);
	assert_true(is_there("trimmed/a") && is_there("trimmed/c"));
	assert_true(!is_there("trimmed/b") && !is_there("trimmed/d"));
	gz_mesh_cache_trim(trimmed, 0);
	assert_true(!is_there("trimmed/a") && !is_there("trimmed/c"));
	gz_mesh_cache_trim("/nowhere", 0);
}

static void loading_counts_as_use(void **state)
{
	(void)state;
	struct sample sample;
	unsigned char bytes[FILE_SIZE];
	char input[GZ_PATH_SIZE], path[GZ_PATH_SIZE];
	const struct timespec old[2] = { { .tv_sec = 1000 }, { .tv_sec = 1000 } };
	struct stat status;
	name_file("ball.ply", input);
	store_bytes(&sample, bytes);
	name_kept(&sample, path);
	assert_int_equal(utimensat(AT_FDCWD, path, old, 0), 0);
	assert_int_equal(load_into(input, &sample, NULL), GZ_OK);
	assert_int_equal(stat(path, &status), 0);
	assert_true(status.st_mtim.tv_sec > 1000);
}

TEST_SUITE(mesh_cache)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(what_is_stored_is_loaded),
		cmocka_unit_test(keys_tell_meshes_and_purposes_apart),
		cmocka_unit_test(faulty_files_are_refused_with_one_line),
		cmocka_unit_test(file_of_any_length_is_loaded_whole),
		cmocka_unit_test(numbers_that_are_not_finite_are_refused),
		cmocka_unit_test(missing_file_is_not_found_and_not_logged),
		cmocka_unit_test(input_folder_serves_where_the_users_cannot),
		cmocka_unit_test(without_any_folder_one_line_says_so),
		cmocka_unit_test(files_that_were_not_used_lately_go_first),
		cmocka_unit_test(loading_counts_as_use),
	};
	return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
