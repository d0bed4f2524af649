/* Running a study on a small scene: what is measured is there, the same each time, however it is
 * cut up or interrupted. */
#include "suite.h"

#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/captured_log.h"
#include "base/command.h"
#include "bench/study/merge.h"
#include "bench/study/run.h"
#include "bench/study/study.h"
#include "bench/study/study_folder.h"
#include "drivers/made_log.h"

static const struct gz_study_listener nobody = { NULL, NULL };

static char root[] = "/tmp/gz_run_XXXXXX";
static char scene_file[64], second_file[64], cache[64];
static struct captured_log captured;
static int folders;

static void write_text(const char *path, const char *text)
{
	FILE *file = fopen(path, "w");
	assert_non_null(file);
	fputs(text, file);
	assert_int_equal(fclose(file), 0);
}

static void write_scene(char path[64], const char *name, const char *more)
{
	char text[512];
	snprintf(path, 64, "%s/%s.scene", root, name);
	snprintf(text, sizeof text,
		 "[volume]\nprocedural = shells\ndims = 24 20 28\n[transfer]\nfile = a.tf\n%s"
		 "[camera]\neye = 0.9 -1.2 1.1\nfov_deg = 32\n",
		 more);
	write_text(path, text);
}

static int make_files(void **state)
{
	char path[64];
	(void)state;
	if (!mkdtemp(root))
		return -1;
	snprintf(path, sizeof path, "%s/a.tf", root);
	write_text(path, "0 0 0 0 0\n0.3 1 0 0 0.1\n1 1 1 1 0.9\n");
	snprintf(path, sizeof path, "%s/b.tf", root);
	write_text(path, "0 0 0 0 0\n0.5 0 1 0 0.5\n1 1 1 1 0.1\n");
	write_scene(scene_file, "one", "");
	write_scene(second_file, "two", "also = b.tf\n");
	snprintf(cache, sizeof cache, "%s/cache/references", root);
	return 0;
}

static int remove_files(void **state)
{
	char command[64];
	(void)state;
	snprintf(command, sizeof command, "rm -rf %s", root);
	return system(command);
}

static int begin(void **state)
{
	(void)state;
	captured_log_init(&captured, "*:error");
	return 0;
}

static const char *const one_scene[] = { scene_file };

static struct gz_study_request request_of(const char *path)
{
	return (struct gz_study_request) {
		.scenes = one_scene,
		.scene_count = 1,
		.methods = "acuity,mdc:mdc_square_px=10",
		.sizes = "48x32",
		.backends = "cpu:threads=2",
		.path = path,
		.seed = 3,
		.frames = 2,
		.warm_up = 1,
		.shard_count = 1,
		.accuracy = GZ_STUDY_ACCURACY_ALL,
		.program = "gazebench 0",
		.commit = "0123abc",
	};
}

static const char *new_folder(void)
{
	static char names[64][64];
	char *name = names[folders % 64];
	snprintf(name, sizeof names[0], "%s/%d", root, folders++);
	return name;
}

/* Run, and read what was made. */
static struct gz_study run(const struct gz_study_request *request, const char *folder)
{
	struct gz_study_outcome outcome;
	struct gz_study study = { 0 };
	if (gz_study_run(request, folder, cache, nobody, &captured.log, &outcome) != GZ_OK)
		fail_msg("%s", captured.last);
	assert_int_equal(outcome.done, outcome.units);
	assert_true(outcome.complete);
	if (gz_study_read(folder, &captured.log, &study) != GZ_OK)
		fail_msg("%s", captured.last);
	assert_int_equal(study.row_count, outcome.rows);
	assert_true(study.complete);
	return study;
}

static void refused(const struct gz_study_request *request, enum gz_result expected,
		    const char *part)
{
	struct gz_study_outcome outcome;
	const char *folder = new_folder();
	const enum gz_result result =
		gz_study_run(request, folder, cache, nobody, &captured.log, &outcome);
	if (result != expected || !strstr(captured.last, part))
		fail_msg("%d, not %d, with '%s', not '%s'", result, expected, captured.last, part);
	assert_int_equal(access(folder, F_OK), -1);
}

static void same_number(double a, double b)
{
	if (!(a == b || (isnan(a) && isnan(b))))
		fail_msg("%.9g is not %.9g", a, b);
}

static void same_errors(const struct gz_study_errors *a, const struct gz_study_errors *b)
{
	const double *x = &a->psnr_db, *y = &b->psnr_db;
	assert_int_equal(sizeof *a, 9 * sizeof *x);
	for (int i = 0; i < 9; i++)
		same_number(x[i], y[i]);
}

/* All but times. */
static void same_rows(const struct gz_study *a, const struct gz_study *b)
{
	assert_int_equal(a->row_count, b->row_count);
	for (size_t i = 0; i < a->row_count; i++) {
		const struct gz_study_row *x = &a->rows[i], *y = &b->rows[i];
		assert_int_equal(x->scene, y->scene);
		assert_int_equal(x->size, y->size);
		assert_int_equal(x->backend, y->backend);
		assert_int_equal(x->variant, y->variant);
		assert_int_equal(x->point, y->point);
		assert_int_equal(x->frame, y->frame);
		assert_true(x->rays == y->rays && x->samples == y->samples);
		same_errors(&x->converged, &y->converged);
		same_errors(&x->standard, &y->standard);
		same_number(x->flicker, y->flicker);
		same_number(x->turning_error, y->turning_error);
		same_number(x->camera_path_error, y->camera_path_error);
		same_number(x->reference_db, y->reference_db);
	}
}

static void run_measures_each_frame_of_each_variant_at_each_point(void **state)
{
	(void)state;
	const struct gz_study_request request = request_of("grid:2x2");
	struct gz_study study = run(&request, new_folder());
	assert_int_equal(study.row_count, 4 * 3 * 2);
	assert_string_equal(study.variants[0].text, "standard");
	assert_string_equal(study.variants[2].method, "mdc");
	assert_int_equal(strlen(study.scenes[0].hash), 64);
	assert_non_null(strstr(study.machine.backends[0], "2 threads"));
	for (size_t i = 0; i < study.row_count; i++) {
		const struct gz_study_row *row = &study.rows[i];
		assert_true(row->rays > 0 && row->samples > 0);
		assert_true(row->cast_ms > 0 && row->frame_ms >= row->plan_ms + row->cast_ms +
									 row->reconstruct_ms -
									 1e-6);
		assert_true(isnan(row->gpu_ms));
		assert_true(row->converged.flip >= 0 && row->converged.flip <= 1);
		assert_true(row->reference_db > 40);
		if (row->variant == 0) {
			assert_int_equal(row->rays, 48 * 32);
			assert_true(isinf(row->standard.psnr_db));
			same_number(row->standard.ssim, 1);
			same_number(row->standard.foveal_flip, 0);
			same_number(row->flicker, 0);
			same_number(row->turning_error, 0);
			assert_true(isnan(row->camera_path_error));
			assert_true(row->converged.psnr_db > 25 && !isinf(row->converged.psnr_db));
		} else if (row->variant == 2) {
			assert_true(row->rays < 48 * 32);
			assert_true(row->standard.flip > 0);
			assert_true(row->turning_error > 0 && row->turning_error < 255);
		}
	}
	assert_true(study.bound_rays[0] > 0 && study.bound_rays[0] <= 1);
	gz_study_free(&study);
}

static void run_again_gives_the_same_but_for_times(void **state)
{
	(void)state;
	const struct gz_study_request request = request_of("random:3");
	struct gz_study one = run(&request, new_folder()), again = run(&request, new_folder());
	same_rows(&one, &again);
	gz_study_free(&one);
	gz_study_free(&again);
}

static void shards_join_to_what_one_run_gives(void **state)
{
	(void)state;
	struct gz_study_request request = request_of("random:3");
	const char *const scenes[] = { scene_file, second_file };
	const char *parts[3];
	request.scenes = scenes;
	request.scene_count = 2;
	request.sizes = "48x32,20x30";
	request.frames = 1;
	request.cameras = 2;
	struct gz_study whole = run(&request, new_folder()), joined = { 0 };
	assert_int_equal(whole.scene_count, 3); /* the second has two transfer functions */
	assert_string_equal(whole.scenes[2].transfer, "b");
	assert_int_equal(whole.row_count, 3 * 2 * 3 * 3);
	request.shard_count = 3;
	for (request.shard = 2; request.shard >= 0; request.shard--) {
		parts[request.shard] = new_folder();
		struct gz_study part = run(&request, parts[request.shard]);
		gz_study_free(&part);
	}
	if (gz_study_merge(parts, 3, &captured.log, &joined) != GZ_OK)
		fail_msg("%s", captured.last);
	same_rows(&joined, &whole);
	assert_int_equal(joined.shard_count, 1);
	assert_true(joined.complete);
	gz_study_free(&joined);
	gz_study_free(&whole);
}

static void merge_refused(const char *const *parts, size_t count, const char *message)
{
	struct gz_study joined;
	assert_int_equal(gz_study_merge(parts, count, &captured.log, &joined), GZ_ERR_INVAL);
	if (!strstr(captured.last, message))
		fail_msg("'%s', not '%s'", captured.last, message);
}

static void shards_that_do_not_belong_together_are_refused(void **state)
{
	(void)state;
	struct gz_study_request request = request_of("grid:4x1");
	struct gz_study part;
	const char *parts[4];
	request.accuracy = GZ_STUDY_ACCURACY_NONE;
	request.shard_count = 2;
	for (int i = 0; i < 4; i++) {
		request.shard = i % 2;
		request.commit = i == 2 ? "fedcba9" : "0123abc";
		request.scenes = i == 3 ? (const char *const[]) { second_file } : one_scene;
		parts[i] = new_folder();
		part = run(&request, parts[i]);
		gz_study_free(&part);
	}
	const char *const same[] = { parts[0], parts[1], parts[0] };
	const char *const commits[] = { parts[1], parts[2] };
	const char *const scenes[] = { parts[0], parts[3] };
	merge_refused(parts, 1, "shard 2 of 2 is missing");
	merge_refused(same, 3, "are both shard 1");
	merge_refused(commits, 2, "the commit is fedcba9, and was 0123abc");
	merge_refused(scenes, 2, "scene");
}

static void scene_changed_between_shards_is_refused(void **state)
{
	(void)state;
	struct gz_study_request request = request_of("grid:2x1");
	char third_file[64];
	const char *const third[] = { third_file };
	const char *parts[2];
	request.scenes = third;
	request.shard_count = 2;
	request.accuracy = GZ_STUDY_ACCURACY_NONE;
	for (int i = 0; i < 2; i++) {
		write_scene(third_file, "three",
			    i ? "[render]\nray_sampling_rate = 1\n" : "[render]\n");
		request.shard = i;
		parts[i] = new_folder();
		struct gz_study part = run(&request, parts[i]);
		gz_study_free(&part);
	}
	merge_refused(parts, 2, "is not the same scene");
}

static void write_table(const char *rows)
{
	char path[64];
	snprintf(path, sizeof path, "%s/own.table", root);
	write_text(path, rows);
}

static void table_of_a_variant_belongs_to_the_study(void **state)
{
	(void)state;
	struct gz_study_request request = request_of("centre");
	struct gz_study_outcome outcome;
	const char *folder = new_folder();
	request.accuracy = GZ_STUDY_ACCURACY_NONE;
	request.methods = "table:table=own.table";
	refused(&request, GZ_ERR_NOT_FOUND, "own.table");
	request.methods = "table";
	refused(&request, GZ_ERR_FORMAT, "the method is table");
	request.methods = "table:table=own.table";
	write_table("0 1 1\n5 4 2\n");
	struct gz_study study = run(&request, folder);
	assert_true(study.rows[2].rays < study.rows[0].rays);
	gz_study_free(&study);
	write_table("0 1 1\n5 5 2\n");
	assert_int_equal(gz_study_run(&request, folder, cache, nobody, &captured.log, &outcome),
			 GZ_ERR_INVAL);
	assert_non_null(strstr(captured.last, "is not the same scene"));
}

/* ---- camera paths ---- */

/* A file of cameras that begin where the scene's is and turn by an angle a frame. */
static const char *write_turn(const char *name, int cameras, double deg)
{
	static char path[64];
	char text[8192];
	int length = 0;
	struct gz_camera camera = {
		.eye = { 0.9, -1.2, 1.1 }, .up = { 0, 0, 1 }, .fov_deg = 32, .height = 1.5
	};
	for (int i = 0; i < cameras; i++) {
		for (int axis = 0; axis < 6; axis++)
			length += snprintf(text + length, sizeof text - (size_t)length, "%.17g ",
					   axis < 3 ? camera.eye[axis] : camera.look_at[axis - 3]);
		length += snprintf(text + length, sizeof text - (size_t)length, "\n");
		gz_camera_turn(&camera, deg);
	}
	snprintf(path, sizeof path, "%s/%s", root, name);
	write_text(path, text);
	return path;
}

static void camera_path_that_turns_is_seen_as_the_turning_camera_is(void **state)
{
	(void)state;
	struct gz_study_request request = request_of("grid:2x1");
	request.accuracy = GZ_STUDY_ACCURACY_STANDARD;
	request.camera_path = write_turn("turn.csv", 8, 0.25);
	struct gz_study study = run(&request, new_folder());
	assert_string_equal(study.camera_path, request.camera_path);
	assert_int_equal(strlen(study.camera_path_hash), 64);
	for (size_t i = 0; i < study.row_count; i++)
		same_number(study.rows[i].camera_path_error, study.rows[i].turning_error);
	assert_true(study.rows[4].variant == 2 && study.rows[4].camera_path_error > 0);
	gz_study_free(&study);
}

/* The mean of both halves; and what is left of a third counts for nothing. */
static void camera_path_is_followed_to_its_end(void **state)
{
	(void)state;
	struct gz_study_request request = request_of("centre");
	request.accuracy = GZ_STUDY_ACCURACY_STANDARD;
	request.frames = 1;
	request.camera_path = write_turn("long.csv", 20, 3);
	struct gz_study whole = run(&request, new_folder());
	double mean = 0;
	for (int half = 0; half < 2; half++) {
		char command[256];
		snprintf(command, sizeof command, "cd %s && tail -n +%d long.csv | head -8 >half%d",
			 root, 8 * half + 1, half);
		assert_int_equal(system(command), 0);
		char path[64];
		snprintf(path, sizeof path, "%s/half%d", root, half);
		request.camera_path = path;
		struct gz_study part = run(&request, new_folder());
		mean += part.rows[2].camera_path_error / 2;
		gz_study_free(&part);
	}
	assert_true(fabs(whole.rows[2].camera_path_error - mean) < 1e-6 * mean);
	gz_study_free(&whole);
}

static void changed_camera_path_is_another_study(void **state)
{
	(void)state;
	struct gz_study_request request = request_of("centre");
	struct gz_study_outcome outcome;
	const char *folder = new_folder();
	request.accuracy = GZ_STUDY_ACCURACY_STANDARD;
	request.camera_path = write_turn("walk.csv", 8, 1);
	struct gz_study study = run(&request, folder);
	gz_study_free(&study);
	write_turn("walk.csv", 8, 2);
	assert_int_equal(gz_study_run(&request, folder, cache, nobody, &captured.log, &outcome),
			 GZ_ERR_INVAL);
	assert_non_null(strstr(captured.last, "the camera path's hash is "));
	request.camera_path = NULL;
	assert_int_equal(gz_study_run(&request, folder, cache, nobody, &captured.log, &outcome),
			 GZ_ERR_INVAL);
	assert_non_null(strstr(captured.last, "--camera-path is none, and was "));
}

static void camera_path_that_cannot_be_measured_is_refused(void **state)
{
	(void)state;
	struct gz_study_request request = request_of("centre");
	request.camera_path = write_turn("short.csv", 7, 1);
	refused(&request, GZ_ERR_INVAL, "has 7 cameras; the camera path error needs 8 or more");
	request.camera_path = "/nowhere.csv";
	refused(&request, GZ_ERR_NOT_FOUND, "/nowhere.csv");
	request.accuracy = GZ_STUDY_ACCURACY_NONE;
	refused(&request, GZ_ERR_INVAL, "--errors none measures none");
}

/* ---- interruptions ---- */

/* Ends the process, or asks it to end, before the third unit. */
static void end_early(void *user, const struct gz_study_progress *progress)
{
	if (progress->done == 2)
		raise(*(const int *)user);
}

/* Run in a process of its own that a signal meets on its way; its wait status. */
static int run_into(const struct gz_study_request *request, const char *folder, int number)
{
	int status = 0;
	const pid_t child = fork();
	assert_true(child >= 0);
	if (child == 0) {
		struct gz_study_outcome outcome;
		gz_command_catch_signals();
		const enum gz_result result = gz_study_run(
			request, folder, cache, (struct gz_study_listener) { end_early, &number },
			NULL, &outcome);
		_exit(-(int)result);
	}
	assert_int_equal(waitpid(child, &status, 0), child);
	return status;
}

static void goes_on_to_the_same(const struct gz_study_request *request, const char *folder)
{
	struct gz_study whole = run(request, new_folder()), part = { 0 };
	if (gz_study_read(folder, &captured.log, &part) != GZ_OK)
		fail_msg("%s", captured.last);
	assert_int_equal(part.row_count, 2 * gz_study_unit_rows(&part));
	assert_false(part.complete);
	gz_study_free(&part);
	struct gz_study resumed = run(request, folder);
	same_rows(&resumed, &whole);
	gz_study_free(&resumed);
	gz_study_free(&whole);
}

static void killed_run_resumes_to_the_same_rows(void **state)
{
	(void)state;
	const struct gz_study_request request = request_of("random:4");
	const char *folder = new_folder();
	const int status = run_into(&request, folder, SIGKILL);
	assert_true(WIFSIGNALED(status) && WTERMSIG(status) == SIGKILL);
	goes_on_to_the_same(&request, folder);
}

static void interrupted_run_leaves_whole_units_and_resumes(void **state)
{
	(void)state;
	static const int numbers[] = { SIGINT, SIGTERM };
	const struct gz_study_request request = request_of("random:4");
	for (int i = 0; i < 2; i++) {
		const char *folder = new_folder();
		const int status = run_into(&request, folder, numbers[i]);
		assert_true(WIFEXITED(status));
		assert_int_equal(-WEXITSTATUS(status), GZ_ERR_CANCELLED);
		goes_on_to_the_same(&request, folder);
	}
}

static void different_run_into_the_same_folder_is_refused(void **state)
{
	(void)state;
	struct gz_study_request request = request_of("grid:2x1");
	struct gz_study_outcome outcome;
	const char *folder = new_folder();
	request.accuracy = GZ_STUDY_ACCURACY_NONE;
	struct gz_study study = run(&request, folder);
	gz_study_free(&study);
	request.methods = "acuity,ddc";
	assert_int_equal(gz_study_run(&request, folder, cache, nobody, &captured.log, &outcome),
			 GZ_ERR_INVAL);
	assert_non_null(strstr(captured.last, "a method is ddc, and was mdc:mdc_square_px=10"));
}

/* ---- refusals ---- */

static void programs_with_changed_files_differ_within_one_commit(void **state)
{
	(void)state;
	char path[64], other[64];
	char text[GZ_STUDY_TEXT_SIZE], again[GZ_STUDY_TEXT_SIZE];
	snprintf(path, sizeof path, "%s/program", root);
	snprintf(other, sizeof other, "%s/other", root);
	write_text(path, "abc");
	write_text(other, "abd");
	gz_study_identify("0123abc", path, text);
	assert_string_equal(text, "0123abc");
	gz_study_identify("0123abc-dirty", path, text); /* FIPS 180-4's example */
	assert_string_equal(text, "0123abc-dirty-ba7816bf8f01");
	gz_study_identify("0123abc-dirty", other, again);
	assert_string_not_equal(text, again);
	gz_study_identify("unknown", path, text);
	assert_string_equal(text, "unknown-ba7816bf8f01");
	gz_study_identify("unknown", "/nonexistent", text);
	assert_string_equal(text, "unknown");
}

static void invalid_request_is_refused_before_a_folder_is_made(void **state)
{
	(void)state;
	struct gz_study_request request = request_of("centre");
	request.methods = "acuity,acuity";
	refused(&request, GZ_ERR_INVAL, "given twice");
	request.methods = "rubbish";
	refused(&request, GZ_ERR_INVAL, "rubbish is not standard, mdc");
	request.methods = "acuity:slope=3";
	refused(&request, GZ_ERR_INVAL, "no option slope");
	request.methods = "acuity:acuity_slope=-3";
	refused(&request, GZ_ERR_INVAL, "acuity_slope");
	request = request_of("centre");
	request.sizes = "48x32,48";
	refused(&request, GZ_ERR_INVAL, "WIDTHxHEIGHT");
	request.sizes = "48x32,48x32";
	refused(&request, GZ_ERR_INVAL, "each once");
	request = request_of("centre");
	request.backends = "cpu,vulkan";
	refused(&request, GZ_ERR_INVAL, "no such backend");
	request.backends = "gl:threads=2";
	refused(&request, GZ_ERR_INVAL, "no such backend");
	request = request_of("nowhere");
	refused(&request, GZ_ERR_INVAL, "no such path");
	request = request_of("centre");
	request.shard = 1;
	request.shard_count = 2;
	refused(&request, GZ_ERR_INVAL, "has nothing to measure");
	const char *const twice[] = { scene_file, scene_file };
	request = request_of("centre");
	request.scenes = twice;
	request.scene_count = 2;
	refused(&request, GZ_ERR_INVAL, "is in the study already");
	const char *const missing[] = { "/nowhere.scene" };
	request.scenes = missing;
	request.scene_count = 1;
	refused(&request, GZ_ERR_NOT_FOUND, "/nowhere.scene");
}

static void recording_of_another_display_is_refused(void **state)
{
	(void)state;
	char log_file[64];
	struct made_log made;
	snprintf(log_file, sizeof log_file, "%s/log.gzl", root);
	assert_true(made_log_begin(&made, log_file));
	for (int i = 0; i < 300; i++) {
		struct gz_gaze_log_record record = { .kind = GZ_GAZE_LOG_SAMPLE,
						     .sample = gz_sample_unmeasured() };
		record.sample.host_ns = INT64_C(1000000000) + i * INT64_C(2000000);
		record.sample.seq = (uint64_t)i;
		record.sample.valid = true;
		record.sample.point = (struct gz_point) { 0.25F, 0.5F };
		made_log_record(&made, &record);
	}
	made_log_end(&made);
	struct gz_study_request request = request_of(log_file);
	request.accuracy = GZ_STUDY_ACCURACY_NONE;
	struct gz_study study = run(&request, new_folder()); /* of no display but the log's */
	assert_true(study.scenes[0].display_known);
	assert_int_equal(study.scenes[0].display.px[0], 48);
	gz_study_free(&study);
	request.display_distance_mm = 500;
	refused(&request, GZ_ERR_INVAL, "recorded on another display");
}

/* ---- references ---- */

static void converged_picture_is_made_once_and_kept(void **state)
{
	(void)state;
	struct gz_study_request request = request_of("centre");
	char command[256];
	request.seed = 11; /* and so another camera than in other tests */
	request.cameras = 1;
	struct gz_study one = run(&request, new_folder());
	snprintf(command, sizeof command, "test \"$(ls %s/*.png | wc -l)\" -ge 2", cache);
	assert_int_equal(system(command), 0);
	/* Were they made again, they would not be white. */
	snprintf(command, sizeof command,
		 "cd %s && for f in *.png; do test \"$f\" = white.png || cp -p \"$f\" \"$f.kept\"; "
		 "done",
		 cache);
	assert_int_equal(system(command), 0);
	struct gz_image white = { 0 };
	assert_int_equal(gz_image_resize(&white, 48, 32), GZ_OK);
	memset(white.pixels, 255, 48 * 32 * 4);
	snprintf(command, sizeof command, "%s/white.png", cache);
	assert_int_equal(gz_image_write_png(&white, command, NULL), GZ_OK);
	gz_image_free(&white);
	snprintf(command, sizeof command,
		 "cd %s && for f in *.kept; do cp white.png \"${f%%.kept}\"; done", cache);
	assert_int_equal(system(command), 0);
	struct gz_study from_cache = run(&request, new_folder());
	assert_true(isinf(from_cache.rows[0].reference_db));
	assert_true(from_cache.rows[0].converged.psnr_db < one.rows[0].converged.psnr_db - 10);
	/* A damaged one is made again. */
	snprintf(command, sizeof command, "cd %s && for f in *.png; do echo x > \"$f\"; done",
		 cache);
	assert_int_equal(system(command), 0);
	struct gz_study again = run(&request, new_folder());
	same_rows(&again, &one);
	gz_study_free(&one);
	gz_study_free(&from_cache);
	gz_study_free(&again);
}

static void picture_smaller_than_a_window_has_no_ssim(void **state)
{
	(void)state;
	struct gz_study_request request = request_of("3,3"); /* and no pixel is in the fovea */
	request.sizes = "7x3";
	struct gz_study study = run(&request, new_folder());
	for (size_t i = 0; i < study.row_count; i++) {
		assert_true(isnan(study.rows[i].converged.ssim));
		assert_true(isnan(study.rows[i].converged.foveal_flip));
		assert_true(isnan(study.rows[i].standard.foveal_psnr_db));
		assert_false(isnan(study.rows[i].standard.flip));
	}
	gz_study_free(&study);
}

TEST_SUITE(study_run)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test_setup(run_measures_each_frame_of_each_variant_at_each_point,
				       begin),
		cmocka_unit_test_setup(run_again_gives_the_same_but_for_times, begin),
		cmocka_unit_test_setup(shards_join_to_what_one_run_gives, begin),
		cmocka_unit_test_setup(shards_that_do_not_belong_together_are_refused, begin),
		cmocka_unit_test_setup(scene_changed_between_shards_is_refused, begin),
		cmocka_unit_test_setup(table_of_a_variant_belongs_to_the_study, begin),
		cmocka_unit_test_setup(camera_path_that_turns_is_seen_as_the_turning_camera_is,
				       begin),
		cmocka_unit_test_setup(camera_path_is_followed_to_its_end, begin),
		cmocka_unit_test_setup(changed_camera_path_is_another_study, begin),
		cmocka_unit_test_setup(camera_path_that_cannot_be_measured_is_refused, begin),
		cmocka_unit_test_setup(killed_run_resumes_to_the_same_rows, begin),
		cmocka_unit_test_setup(interrupted_run_leaves_whole_units_and_resumes, begin),
		cmocka_unit_test_setup(different_run_into_the_same_folder_is_refused, begin),
		cmocka_unit_test_setup(programs_with_changed_files_differ_within_one_commit, begin),
		cmocka_unit_test_setup(invalid_request_is_refused_before_a_folder_is_made, begin),
		cmocka_unit_test_setup(recording_of_another_display_is_refused, begin),
		cmocka_unit_test_setup(converged_picture_is_made_once_and_kept, begin),
		cmocka_unit_test_setup(picture_smaller_than_a_window_has_no_ssim, begin),
	};
	return cmocka_run_group_tests(tests, make_files, remove_files);
}
