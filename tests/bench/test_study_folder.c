/* The folder of a study: what is written is read, and what cuts it short costs a unit at most. */
#include "suite.h"

#include <fcntl.h>
#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/text.h"
#include "bench/study/columns.h"
#include "bench/study/study_folder.h"
#include "study_example.h"

static char root[] = "/tmp/gz_study_XXXXXX";
static char folder[64];
static char message[2048]; /* the last error */

static void keep_message(void *user, enum gz_log_level level, const char *module, const char *text)
{
	(void)user;
	(void)module;
	if (level == GZ_LOG_ERROR)
		snprintf(message, sizeof message, "%s", text);
}

static struct gz_log log_of_test;

static int make_root(void **state)
{
	(void)state;
	gz_log_init(&log_of_test, keep_message, NULL, NULL);
	return mkdtemp(root) ? 0 : -1;
}

static int remove_root(void **state)
{
	(void)state;
	char command[64];
	snprintf(command, sizeof command, "rm -rf %s", root);
	return system(command);
}

static int name_folder(void **state)
{
	static int number;
	(void)state;
	snprintf(folder, sizeof folder, "%s/%d", root, number++);
	message[0] = '\0';
	return 0;
}

static char *file_path(const char *name)
{
	static char path[128];
	snprintf(path, sizeof path, "%s/%s", folder, name);
	return path;
}

static char *read_text(const char *name)
{
	FILE *file = fopen(file_path(name), "r");
	assert_non_null(file);
	char *text = calloc(1, 1 << 20);
	const size_t size = fread(text, 1, (1 << 20) - 1, file);
	assert_true(size > 0);
	fclose(file);
	return text;
}

static void write_text(const char *name, const char *text, size_t size)
{
	FILE *file = fopen(file_path(name), "w");
	assert_non_null(file);
	assert_int_equal(fwrite(text, 1, size, file), size);
	fclose(file);
}

/* Put @p with in the place of the first @p what of a file. */
static void replace(const char *name, const char *what, const char *with)
{
	char *text = read_text(name), *at = strstr(text, what);
	assert_non_null(at);
	char *changed = calloc(1, strlen(text) + strlen(with) + 1);
	sprintf(changed, "%.*s%s%s", (int)(at - text), text, with, at + strlen(what));
	write_text(name, changed, strlen(changed));
	free(changed);
	free(text);
}

static void same(double a, double b)
{
	if (!((isnan(a) && isnan(b)) || a == b || fabs(a - b) <= 1e-8 * fabs(a)))
		fail_msg("%.12g is not %.12g", a, b);
}

static void same_row(const struct gz_study_row *a, const struct gz_study_row *b)
{
	assert_int_equal(a->scene, b->scene);
	assert_int_equal(a->size, b->size);
	assert_int_equal(a->backend, b->backend);
	assert_int_equal(a->variant, b->variant);
	assert_int_equal(a->point, b->point);
	assert_int_equal(a->frame, b->frame);
	assert_memory_equal(&a->gaze, &b->gaze, sizeof a->gaze);
	for (int id = 0; id < GZ_STUDY_COLUMNS; id++)
		same(gz_study_column_value(id, a), gz_study_column_value(id, b));
}

static void same_study(const struct gz_study *a, const struct gz_study *b)
{
	char what[1024];
	if (gz_study_differs(a, b, what, sizeof what))
		fail_msg("%s", what);
	assert_string_equal(a->scenes[1].path, b->scenes[1].path);
	assert_memory_equal(a->scenes[1].dims, b->scenes[1].dims, sizeof a->scenes[1].dims);
	assert_string_equal(a->variants[2].method, b->variants[2].method);
	assert_string_equal(a->machine.host_cpu, b->machine.host_cpu);
	assert_string_equal(a->machine.backends[1], b->machine.backends[1]);
	assert_true(a->machine.copy_ms[0] == b->machine.copy_ms[0]);
	assert_memory_equal(a->points, b->points, a->point_count * sizeof *a->points);
	assert_memory_equal(a->bound_rays, b->bound_rays, 8 * sizeof *a->bound_rays);
	assert_int_equal(a->shard, b->shard);
	assert_int_equal(a->shard_count, b->shard_count);
	assert_int_equal(a->complete, b->complete);
	assert_int_equal(a->row_count, b->row_count);
	for (size_t i = 0; i < a->row_count; i++)
		same_row(&a->rows[i], &b->rows[i]);
}

/* The example's folder, complete. */
static struct gz_study written(int shard, int shard_count)
{
	struct gz_study study = study_example(shard, shard_count);
	assert_int_equal(gz_study_write(folder, &study, &log_of_test), GZ_OK);
	return study;
}

static void refused(enum gz_result expected, const char *part_of_message)
{
	struct gz_study study;
	assert_int_equal(gz_study_read(folder, &log_of_test, &study), expected);
	if (!strstr(message, part_of_message))
		fail_msg("'%s' is not in '%s'", part_of_message, message);
}

static void study_written_is_read(void **state)
{
	(void)state;
	struct gz_study study = written(0, 1), read;
	assert_int_equal(study.row_count, 2 * 2 * 4 * 3 * 2);
	assert_int_equal(gz_study_read(folder, &log_of_test, &read), GZ_OK);
	same_study(&read, &study);
	gz_study_free(&read);
	gz_study_free(&study);
}

static void numbers_are_written_as_short_as_they_can_be(void **state)
{
	(void)state;
	struct gz_study study = written(0, 1);
	char *json = read_text("study.json"), *rows = read_text("frames.csv");
	/* 0.8 and 0.1F, whose nearest doubles are 0.80000000000000004 and 0.100000001490116. */
	assert_non_null(strstr(json, "\"min_move_px\": 0.8,"));
	assert_non_null(strstr(json, "   0.1,\n   0.33333334,"));
	assert_non_null(strstr(json, "     0.3333333333333333\n"));
	assert_non_null(strstr(json, "\"fov_deg\": 40.0,"));
	assert_non_null(strstr(json, "\"name\": \"head, \\\"old\\\"\""));
	assert_null(strstr(json, "00000"));
	assert_non_null(strstr(rows, ",1,1,0,0.1,0.33333334,"));
	free(json);
	free(rows);
	gz_study_free(&study);
}

static void study_of_a_version_without_camera_paths_is_read(void **state)
{
	(void)state;
	struct gz_study study = written(0, 1), read;
	replace("study.json", "\"camera_path\": \"walk.session/frames.tsv\",", "");
	replace("study.json", "\"camera_path_hash\"", "\"other_hash\"");
	assert_int_equal(gz_study_read(folder, &log_of_test, &read), GZ_OK);
	assert_true(read.camera_path[0] == '\0' && read.camera_path_hash[0] == '\0');
	gz_study_free(&read);
	gz_study_free(&study);
}

static void study_without_min_move_and_per_cell_is_read(void **state)
{
	(void)state;
	struct gz_study study = written(0, 1), read;
	replace("study.json", "\"min_move_px\": 0.8,", "");
	replace("study.json", "\"per_cell\": true,", "");
	assert_int_equal(gz_study_read(folder, &log_of_test, &read), GZ_OK);
	assert_true(read.min_move_px == 0 && !read.per_cell);
	gz_study_free(&read);
	gz_study_free(&study);
}

/* Root and scene move together, and the path as given leads nowhere then. */
static void scene_of_a_study_is_found_from_any_folder(void **state)
{
	(void)state;
	char scene[96], moved[96];
	struct gz_study study = study_example(0, 1), read;
	snprintf(scene, sizeof scene, "%s/a.scene", root);
	snprintf(moved, sizeof moved, "%s/b.scene", root);
	fclose(fopen(scene, "w"));
	snprintf(study.scenes[0].path, sizeof study.scenes[0].path, "%s", scene);
	assert_int_equal(gz_study_write(folder, &study, &log_of_test), GZ_OK);
	assert_int_equal(gz_study_read(folder, &log_of_test, &read), GZ_OK);
	assert_string_equal(read.scenes[0].path, scene);
	gz_study_free(&read);
	replace("study.json", "../a.scene", "../b.scene");
	assert_int_equal(rename(scene, moved), 0);
	assert_int_equal(gz_study_read(folder, &log_of_test, &read), GZ_OK);
	assert_int_equal(access(read.scenes[0].path, F_OK), 0);
	assert_string_equal(strrchr(read.scenes[0].path, '/'), "/b.scene");
	gz_study_free(&read);
	unlink(moved);
	assert_int_equal(gz_study_read(folder, &log_of_test, &read), GZ_OK);
	assert_string_equal(read.scenes[0].path, scene);
	gz_study_free(&read);
	gz_study_free(&study);
}

static void shard_written_is_read(void **state)
{
	(void)state;
	struct gz_study study = written(2, 3), read;
	assert_int_equal(gz_study_shard_unit_count(&study), 5); /* 2, 5, 8, 11, 14 of 16 */
	assert_int_equal(gz_study_read(folder, &log_of_test, &read), GZ_OK);
	same_study(&read, &study);
	gz_study_free(&read);
	gz_study_free(&study);
}

/* Cut anywhere within the last unit, the units before it remain. */
static void interrupted_study_is_read_up_to_its_last_whole_unit(void **state)
{
	(void)state;
	struct gz_study study = written(0, 1), read;
	replace("study.json", "\"complete\": true", "\"complete\": false");
	char *text = read_text("frames.csv");
	size_t size = strlen(text);
	for (int cut = 1; cut < 400; cut += 57) {
		write_text("frames.csv", text, size - (size_t)cut);
		assert_int_equal(gz_study_read(folder, &log_of_test, &read), GZ_OK);
		assert_int_equal(read.row_count, study.row_count - 6);
		assert_false(read.complete);
		same_row(&read.rows[read.row_count - 1], &study.rows[read.row_count - 1]);
		gz_study_free(&read);
	}
	write_text("frames.csv", text, 10); /* within the names of the columns */
	assert_int_equal(gz_study_read(folder, &log_of_test, &read), GZ_OK);
	assert_int_equal(read.row_count, 0);
	gz_study_free(&read);
	free(text);
	gz_study_free(&study);
}

static void complete_study_without_all_rows_is_refused(void **state)
{
	(void)state;
	struct gz_study study = written(0, 1);
	char *text = read_text("frames.csv");
	write_text("frames.csv", text, strlen(text) - 1);
	refused(GZ_ERR_FORMAT, "says that it is complete, but has 90 of 96 rows");
	free(text);
	gz_study_free(&study);
}

static void damaged_rows_are_refused_with_their_line(void **state)
{
	(void)state;
	static const struct {
		const char *what, *with, *message;
	} damages[] = {
		{ "mdc,0,0,1,", "mdc,0,0,2,", "frames.csv:5: frame is '2' where '1' follows" },
		{ ",0.125,", ",-0.125,", "frames.csv:2: plan_ms is '-0.125'" },
		{ ",0.125,", ",1 2,", "frames.csv:2: plan_ms is '1 2'" },
		{ ",70,0,0,0\n", ",70,0,0\n", "frames.csv:2: camera_path_error is ''" },
		{ ",70,0,0,0\n", ",70,0,0,0,1\n",
		  "frames.csv:2: there is more than camera_path_error" },
		{ "\"head, \"\"old\"\"\",hard", "\"head,hard", "frames.csv:50: scene" },
		{ "scene,transfer", "scene,transfers", "frames.csv:1: does not name the columns" },
		{ ",plan_ms,", ",", "frames.csv:1: does not name the columns" },
		{ ",plan_ms,", ",plan_ms,plan_ms,", "frames.csv:1: does not name the columns" },
		{ ",plan_ms,", ",plan_s,", "frames.csv:1: does not name the columns" },
	};
	for (size_t i = 0; i < sizeof damages / sizeof damages[0]; i++) {
		name_folder(NULL);
		struct gz_study study = written(0, 1);
		replace("frames.csv", damages[i].what, damages[i].with);
		refused(GZ_ERR_FORMAT, damages[i].message);
		gz_study_free(&study);
	}
}

/* Cut the last column off every line of frames.csv. */
static void drop_last_column(void)
{
	char *text = read_text("frames.csv"), *to = text;
	for (char *line = text, *end; (end = strchr(line, '\n')); line = end + 1) {
		const char *comma = memrchr(line, ',', (size_t)(end - line));
		memmove(to, line, (size_t)(comma - line));
		to += comma - line;
		*to++ = '\n';
	}
	write_text("frames.csv", text, (size_t)(to - text));
	free(text);
}

static void older_study_without_later_columns_is_read_and_not_resumed(void **state)
{
	(void)state;
	struct gz_study study = written(0, 1), read;
	struct gz_study_writer *writer;
	size_t done;
	drop_last_column();
	drop_last_column();
	drop_last_column();
	assert_int_equal(gz_study_read(folder, &log_of_test, &read), GZ_OK);
	for (size_t i = 0; i < study.row_count; i++) {
		assert_true(isnan(read.rows[i].prepare_ms));
		assert_true(isnan(read.rows[i].turning_error));
		assert_true(isnan(read.rows[i].camera_path_error));
		study.rows[i].prepare_ms = study.rows[i].turning_error = NAN;
		study.rows[i].camera_path_error = NAN;
	}
	same_study(&read, &study);
	gz_study_free(&read);
	study.complete = false;
	assert_int_equal(gz_study_writer_open(folder, &study, &log_of_test, &writer, &done),
			 GZ_ERR_FORMAT);
	gz_study_free(&study);
}

static void columns_stand_in_the_documentation_as_in_the_table(void **state)
{
	(void)state;
	struct gz_text text = { 0 };
	assert_int_equal(gz_text_add_file(&text, GZ_SOURCE_DIR "/docs/gazebench.md"), GZ_OK);
	for (int id = 0; id < GZ_STUDY_COLUMNS; id++) {
		const struct gz_study_column *column = &gz_study_columns[id];
		char line[512];
		snprintf(line, sizeof line, "| `%s` | %s | %s |\n", column->name, column->unit,
			 column->meaning);
		if (!strstr(text.bytes, line))
			fail_msg("docs/gazebench.md lacks the line %s", line);
	}
	gz_text_free(&text);
}

static void rows_beyond_the_last_are_refused(void **state)
{
	(void)state;
	struct gz_study study = written(0, 1);
	FILE *file = fopen(file_path("frames.csv"), "a");
	fputs("more\n", file);
	fclose(file);
	refused(GZ_ERR_FORMAT, "frames.csv:98: there are more lines");
	gz_study_free(&study);
}

static void damaged_json_is_refused(void **state)
{
	(void)state;
	static const struct {
		const char *what, *with, *message;
	} damages[] = {
		{ "\"version\": 1", "\"version\": 2",
		  "version 2 and this program reads version 1" },
		{ "gazecast study", "gazecast scene", "is not a study" },
		{ "\"frames\": 2", "\"frames\": 0", "frames is not a whole number from 1 to 1000" },
		{ "\"frames\": 2", "\"frame\": 2", "frames is not a whole number from 1 to 1000" },
		{ "\"variants\": [", "\"variants\": [], \"other\": [", "variants is not a list" },
		{ "\"distance_mm\": 6", "\"distance_mm\": -6", "the display of head" },
		{ "{", "{,", "study.json:1: " },
	};
	for (size_t i = 0; i < sizeof damages / sizeof damages[0]; i++) {
		name_folder(NULL);
		struct gz_study study = written(0, 1);
		replace("study.json", damages[i].what, damages[i].with);
		refused(GZ_ERR_FORMAT, damages[i].message);
		gz_study_free(&study);
	}
}

static void folder_without_a_study_is_not_found(void **state)
{
	(void)state;
	refused(GZ_ERR_NOT_FOUND, "no such file");
	assert_int_equal(mkdir(folder, 0777), 0);
	refused(GZ_ERR_NOT_FOUND, "no such file");
}

static void folder_of_something_else_is_refused(void **state)
{
	(void)state;
	struct gz_study study = study_example(0, 1);
	assert_int_equal(mkdir(folder, 0777), 0);
	write_text("letter.txt", "dear", 4);
	assert_int_equal(gz_study_write(folder, &study, &log_of_test), GZ_ERR_BUSY);
	assert_non_null(strstr(message, "is not a study"));
	struct gz_study_writer *writer = NULL;
	size_t done;
	assert_int_equal(gz_study_writer_open(folder, &study, &log_of_test, &writer, &done),
			 GZ_ERR_BUSY);
	assert_null(writer);
	gz_study_free(&study);
}

static void folder_below_a_missing_one_is_refused_with_what_is_missing(void **state)
{
	(void)state;
	struct gz_study study = study_example(0, 1);
	struct gz_study_writer *writer = NULL;
	size_t done;
	strcat(folder, "/below");
	assert_int_equal(gz_study_writer_open(folder, &study, &log_of_test, &writer, &done),
			 GZ_ERR_IO);
	assert_null(writer);
	assert_non_null(strstr(message, "its parent folder does not exist"));
	gz_study_free(&study);
}

static void study_is_not_written_over_another(void **state)
{
	(void)state;
	struct gz_study study = written(0, 1);
	assert_int_equal(gz_study_write(folder, &study, &log_of_test), GZ_ERR_BUSY);
	gz_study_free(&study);
}

/* Units added one by one, the writer given up at any of them and opened again. */
static void interrupted_writer_resumes(void **state)
{
	(void)state;
	struct gz_study study = study_example(0, 1), read;
	study.complete = false;
	struct gz_study_writer *writer = NULL;
	size_t done = 99;
	for (size_t unit = 0; unit < 16; unit++) {
		assert_int_equal(gz_study_writer_open(folder, &study, &log_of_test, &writer, &done),
				 GZ_OK);
		assert_int_equal(done, unit);
		assert_int_equal(gz_study_writer_add(writer, study.rows + 6 * unit), GZ_OK);
		if (unit == 15)
			assert_int_equal(gz_study_writer_finish(writer), GZ_OK);
		gz_study_writer_destroy(&writer);
		if (unit == 15)
			break;
		FILE *file = fopen(file_path("frames.csv"), "a"); /* of a unit cut short */
		fputs("\"head, \"\"old\"\"\",so", file);
		fclose(file);
	}
	study.complete = true;
	assert_int_equal(gz_study_read(folder, &log_of_test, &read), GZ_OK);
	same_study(&read, &study);
	gz_study_free(&read);
	gz_study_free(&study);
}

static void writer_refuses_the_folder_of_another_study(void **state)
{
	(void)state;
	struct gz_study there = written(0, 2), study = study_example(0, 2);
	struct gz_study_writer *writer = NULL;
	size_t done;
	study.frames_per_point = 1;
	assert_int_equal(gz_study_writer_open(folder, &study, &log_of_test, &writer, &done),
			 GZ_ERR_INVAL);
	assert_non_null(strstr(message, "the number of frames is 1, and was 2"));
	study.frames_per_point = 2;
	strcpy(study.machine.commit, "fedcba9");
	assert_int_equal(gz_study_writer_open(folder, &study, &log_of_test, &writer, &done),
			 GZ_ERR_INVAL);
	assert_non_null(strstr(message, "the commit is fedcba9, and was 0123abc"));
	strcpy(study.machine.commit, "0123abc");
	study.shard = 1;
	assert_int_equal(gz_study_writer_open(folder, &study, &log_of_test, &writer, &done),
			 GZ_ERR_INVAL);
	assert_non_null(strstr(message, "holds shard 1/2, not 2/2"));
	gz_study_free(&there);
	gz_study_free(&study);
}

static void second_writer_is_refused_while_the_first_writes(void **state)
{
	(void)state;
	struct gz_study study = study_example(0, 1);
	struct gz_study_writer *first = NULL, *second = NULL;
	size_t done;
	assert_int_equal(gz_study_writer_open(folder, &study, &log_of_test, &first, &done), GZ_OK);
	assert_int_equal(gz_study_writer_open(folder, &study, &log_of_test, &second, &done),
			 GZ_ERR_BUSY);
	assert_non_null(strstr(message, "another gazebench is writing"));
	gz_study_writer_destroy(&first);
	gz_study_free(&study);
}

/* A limit of the size of files stands for a disk without room: both end a write halfway. */
static void full_disk_leaves_whole_units_and_can_be_resumed(void **state)
{
	(void)state;
	struct gz_study study = study_example(0, 1), read;
	struct gz_study_writer *writer = NULL;
	struct rlimit before, small;
	size_t done;
	study.complete = false;
	assert_int_equal(gz_study_writer_open(folder, &study, &log_of_test, &writer, &done), GZ_OK);
	assert_int_equal(gz_study_writer_add(writer, study.rows), GZ_OK);
	struct stat file;
	assert_int_equal(stat(file_path("frames.csv"), &file), 0);
	signal(SIGXFSZ, SIG_IGN);
	getrlimit(RLIMIT_FSIZE, &before);
	small = before;
	small.rlim_cur = (rlim_t)file.st_size + 100;
	setrlimit(RLIMIT_FSIZE, &small);
	const enum gz_result result = gz_study_writer_add(writer, study.rows + 6);
	setrlimit(RLIMIT_FSIZE, &before);
	assert_int_equal(result, GZ_ERR_FULL);
	assert_non_null(strstr(message, "no room left"));
	struct stat after;
	assert_int_equal(stat(file_path("frames.csv"), &after), 0);
	assert_int_equal(after.st_size, file.st_size);
	assert_int_equal(gz_study_writer_add(writer, study.rows + 6), GZ_OK);
	gz_study_writer_destroy(&writer);
	assert_int_equal(gz_study_read(folder, &log_of_test, &read), GZ_OK);
	assert_int_equal(read.row_count, 12);
	assert_false(read.complete);
	gz_study_free(&read);
	gz_study_free(&study);
}

TEST_SUITE(study_folder)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test_setup(study_written_is_read, name_folder),
		cmocka_unit_test_setup(numbers_are_written_as_short_as_they_can_be, name_folder),
		cmocka_unit_test_setup(study_without_min_move_and_per_cell_is_read, name_folder),
		cmocka_unit_test_setup(study_of_a_version_without_camera_paths_is_read,
				       name_folder),
		cmocka_unit_test_setup(scene_of_a_study_is_found_from_any_folder, name_folder),
		cmocka_unit_test_setup(shard_written_is_read, name_folder),
		cmocka_unit_test_setup(interrupted_study_is_read_up_to_its_last_whole_unit,
				       name_folder),
		cmocka_unit_test_setup(complete_study_without_all_rows_is_refused, name_folder),
		cmocka_unit_test_setup(damaged_rows_are_refused_with_their_line, name_folder),
		cmocka_unit_test_setup(older_study_without_later_columns_is_read_and_not_resumed,
				       name_folder),
		cmocka_unit_test(columns_stand_in_the_documentation_as_in_the_table),
		cmocka_unit_test_setup(rows_beyond_the_last_are_refused, name_folder),
		cmocka_unit_test_setup(damaged_json_is_refused, name_folder),
		cmocka_unit_test_setup(folder_without_a_study_is_not_found, name_folder),
		cmocka_unit_test_setup(folder_of_something_else_is_refused, name_folder),
		cmocka_unit_test_setup(folder_below_a_missing_one_is_refused_with_what_is_missing,
				       name_folder),
		cmocka_unit_test_setup(study_is_not_written_over_another, name_folder),
		cmocka_unit_test_setup(interrupted_writer_resumes, name_folder),
		cmocka_unit_test_setup(writer_refuses_the_folder_of_another_study, name_folder),
		cmocka_unit_test_setup(second_writer_is_refused_while_the_first_writes,
				       name_folder),
		cmocka_unit_test_setup(full_disk_leaves_whole_units_and_can_be_resumed,
				       name_folder),
	};
	return cmocka_run_group_tests(tests, make_root, remove_root);
}
