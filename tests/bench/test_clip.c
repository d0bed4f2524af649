/* gazebench clip: what is written, and camera paths. */
#include "suite.h"

#include <jansson.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "bench/study/camera_path.h"
#include "called.h"
#include "render/picture/image.h"

static const char scene_text[] = "[volume]\nprocedural = shells\ndims = 24 24 24\n"
				 "[transfer]\nfile = a.tf\n";
static const char transfer_text[] = "0 0 0 0 0\n0.3 1 0 0 0.1\n1 1 1 1 0.9\n";

static void file_in(const struct place *place, const char *name, char out[160])
{
	snprintf(out, 160, "%s/%s", place->path, name);
}

static void write_file(const struct place *place, const char *name, const char *text)
{
	char path[160];
	file_in(place, name, path);
	FILE *file = fopen(path, "w");
	assert_non_null(file);
	fputs(text, file);
	assert_int_equal(fclose(file), 0);
}

static int set_up(void **state)
{
	static struct place place;
	if (place_make(&place) != 0)
		return 1;
	write_file(&place, "a.scene", scene_text);
	write_file(&place, "a.tf", transfer_text);
	*state = &place;
	return 0;
}

/* ---- camera paths ---- */

static const struct gz_camera first = {
	.eye = { 0, -2, 0 },
	.look_at = { 0, 0, 0 },
	.up = { 0, 0, 1 },
	.fov_deg = 40,
	.height = 1.5,
};

static enum gz_result read_path(const struct place *place, const char *text,
				struct gz_camera_path *out_path)
{
	char path[160];
	write_file(place, "cameras.csv", text);
	file_in(place, "cameras.csv", path);
	return gz_camera_path_read(path, &first, NULL, out_path);
}

static void table_of_cameras_is_read_line_by_line(void **state)
{
	struct gz_camera_path path = { 0 };
	assert_int_equal(read_path(*state,
				   "eye,,,look_at,,,up\n"
				   "1,2,3, 4,5,6 # comment\n"
				   "\n"
				   "1 2 3 4 5 6 0 1 0\n"
				   "1;2;3;4;5;6;0;1;0;25\n",
				   &path),
			 GZ_OK);
	assert_int_equal(path.count, 3);
	assert_true(path.cameras[0].eye[2] == 3 && path.cameras[0].look_at[0] == 4);
	assert_true(path.cameras[0].up[2] == 1 && path.cameras[0].fov_deg == 40);
	assert_true(path.cameras[1].up[1] == 1 && path.cameras[1].fov_deg == 40);
	assert_true(path.cameras[2].fov_deg == 25);
	gz_camera_path_free(&path);
}

static void session_has_a_camera_a_frame(void **state)
{
	struct gz_camera_path path = { 0 };
	assert_int_equal(read_path(*state,
				   "#gazecast-session 1\n"
				   "#columns time_ns\twidth_px\n"
				   "0\t320\n"
				   "!set\tcamera.eye\t1 -1 0.5\n"
				   "!set\tfoveation.method\tacuity\n"
				   "!set\tcamera.fov_deg\t25\n"
				   "16\t320\n"
				   "33\t320\n"
				   "#end 3\tb7fbb2e7\n",
				   &path),
			 GZ_OK);
	assert_int_equal(path.count, 3);
	assert_true(gz_camera_same(&path.cameras[0], &first));
	assert_true(path.cameras[1].eye[2] == 0.5 && path.cameras[1].fov_deg == 25);
	assert_true(gz_camera_same(&path.cameras[1], &path.cameras[2]));
	gz_camera_path_free(&path);
}

static void what_is_no_camera_is_refused(void **state)
{
	static const char *const wrong[] = {
		"",
		"words alone\n",
		"1 2 3 4 5 6 7\n",
		"1 2 3 4 5\n",
		"1 2 3 4 5 6\n1 2 x 4 5 6\n",
		"1 2 3 1 2 3\n",
		"1 2 3 4 5 6 0 1 0 190\n",
		"1 2 3 4 5 6 0 1 0 40 1\n",
		"#gazecast-session 1\n!set\tcamera.eye\t1 2\n0\t320\n",
		"#gazecast-session 1\n!set\tcamera.eye\n0\t320\n",
	};
	for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
		struct gz_camera_path path = { 0 };
		if (read_path(*state, wrong[i], &path) != GZ_ERR_FORMAT || path.cameras)
			fail_msg("taken: %s", wrong[i]);
	}
}

/* ---- clips ---- */

static void read_picture(const struct place *place, const char *name, struct gz_image *image)
{
	char path[160];
	file_in(place, name, path);
	assert_int_equal(gz_image_read_png(path, NULL, image), GZ_OK);
}

static bool same_pictures(const struct place *place, const char *a, const char *b)
{
	struct gz_image one = { 0 }, other = { 0 };
	read_picture(place, a, &one);
	read_picture(place, b, &other);
	assert_int_equal(one.width, 48);
	assert_int_equal(one.height, 32);
	const bool same = memcmp(one.pixels, other.pixels, (size_t)4 * 48 * 32) == 0;
	gz_image_free(&one);
	gz_image_free(&other);
	return same;
}

static json_t *read_description(const struct place *place, const char *name)
{
	char path[160];
	file_in(place, name, path);
	json_t *json = json_load_file(path, 0, NULL);
	assert_non_null(json);
	return json;
}

static double number_at(const json_t *list, size_t i, size_t k)
{
	return json_number_value(json_array_get(json_array_get(list, i), k));
}

static void every_sequence_shows_the_same_cameras(void **state)
{
	const struct place *place = *state;
	place_run(*state,
		  (const char *[]) {
			  "clip", "a.scene", "--out=c", "--size=48x32", "--frames=2", "--turn=5",
			  "--methods=uniform:uniform_spacing=1,mdc:mdc_square_px=8", NULL });
	assert_said(place, 0, "--metric FovVideoVDP c\n");
	assert_said(place, 0,
		    "cvvdp --test 'c/1-uniform-uniform_spacing-1/frame-%04d.png' --ref "
		    "'c/reference/frame-%04d.png' --display standard_fhd --pix-per-deg ");
	assert_said(place, 0, " --fps 60\n");
	assert_true(same_pictures(place, "c/reference/frame-0000.png",
				  "c/1-uniform-uniform_spacing-1/frame-0000.png"));
	assert_true(same_pictures(place, "c/reference/frame-0001.png",
				  "c/1-uniform-uniform_spacing-1/frame-0001.png"));
	assert_false(
		same_pictures(place, "c/reference/frame-0000.png", "c/reference/frame-0001.png"));
	assert_false(same_pictures(place, "c/reference/frame-0001.png",
				   "c/2-mdc-mdc_square_px-8/frame-0001.png"));
	json_t *clip = read_description(place, "c/clip.json");
	const json_t *tests = json_object_get(clip, "tests");
	assert_int_equal(json_array_size(tests), 2);
	assert_string_equal(json_string_value(json_object_get(json_array_get(tests, 1), "folder")),
			    "2-mdc-mdc_square_px-8");
	assert_true(number_at(json_object_get(clip, "gaze_px"), 1, 0) == 24);
	assert_int_equal(json_array_size(json_object_get(clip, "cameras")), 2);
	json_decref(clip);
}

static void gaze_and_camera_follow_their_paths(void **state)
{
	const struct place *place = *state;
	write_file(place, "gaze.csv", "0.25 0.5\n0.5 0.25\n");
	write_file(place, "cameras.csv", "0 -2 0 0 0 0\n1 -2 0 0 0 0\n0 -2 0 0 0 0\n");
	place_run(*state, (const char *[]) { "clip", "a.scene", "--out=c", "--size=48x32",
					     "--path=gaze.csv", "--camera-path=cameras.csv",
					     "--reference=converged",
					     "--methods=mdc:mdc_square_px=8", NULL });
	assert_said(place, 0, "3 frames of a reference and 1 more");
	assert_true(
		same_pictures(place, "c/reference/frame-0000.png", "c/reference/frame-0002.png"));
	assert_false(same_pictures(place, "c/1-mdc-mdc_square_px-8/frame-0000.png",
				   "c/1-mdc-mdc_square_px-8/frame-0002.png"));
	json_t *clip = read_description(place, "c/clip.json");
	const json_t *gaze = json_object_get(clip, "gaze_px");
	assert_true(number_at(gaze, 0, 0) == 12 && number_at(gaze, 0, 1) == 16);
	assert_true(number_at(gaze, 1, 0) == 24 && number_at(gaze, 1, 1) == 8);
	assert_true(number_at(gaze, 2, 0) == 24); /* rests at the last point */
	assert_string_equal(
		json_string_value(json_object_get(json_object_get(clip, "reference"), "variant")),
		"converged");
	json_decref(clip);
}

/* Only its own frames count: the other methods' come between. */
static void plan_grows_until_frames_are_the_reference(void **state)
{
	const struct place *place = *state;
	place_run(*state,
		  (const char *[]) { "clip", "a.scene", "--out=c", "--size=48x32", "--turn=0",
				     "--frames=20",
				     "--methods=acuity:acuity_slope=1:acuity_far_share=1,"
				     "acuity:acuity_slope=1:acuity_far_share=1:still_growth=2",
				     NULL });
	assert_said(place, 0, "20 frames of a reference and 2 more");
	static const char plain[] = "c/1-acuity-acuity_slope-1-acuity_far_share-1/frame-%04d.png";
	static const char grown[] =
		"c/2-acuity-acuity_slope-1-acuity_far_share-1-still_growth-2/frame-%04d.png";
	json_t *clip = read_description(place, "c/clip.json");
	const json_t *tests = json_object_get(clip, "tests");
	assert_true(
		json_is_false(json_object_get(json_object_get(clip, "reference"), "keeps_rays")));
	for (size_t i = 0; i < 2; i++)
		assert_true(json_boolean_value(json_object_get(json_array_get(tests, i),
							       "keeps_rays")) == (i == 1));
	json_decref(clip);
	for (int frame = 0; frame < 20; frame += 19) {
		char alone[100], growing[100], reference[100];
		snprintf(alone, sizeof alone, plain, frame);
		snprintf(growing, sizeof growing, grown, frame);
		snprintf(reference, sizeof reference, "c/reference/frame-%04d.png", frame);
		assert_false(same_pictures(place, alone, reference));
		assert_true(same_pictures(place, growing, frame == 0 ? alone : reference));
	}
}

static void wrong_requests_write_nothing(void **state)
{
	const struct place *place = *state;
	write_file(place, "cameras.csv", "0 -2 0 0 0 0\n");
	place_run(*state, (const char *[]) { "clip", "a.scene", NULL });
	assert_said(place, 2, "name one with --out");
	place_run(*state, (const char *[]) { "clip", "--out=c", NULL });
	assert_said(place, 2, "give one scene");
	place_run(*state, (const char *[]) { "clip", "a.scene", "--out=c", "--frames=2",
					     "--camera-path=cameras.csv", NULL });
	assert_said(place, 1, "fewer than the 2 frames");
	place_run(*state,
		  (const char *[]) { "clip", "a.scene", "--out=c", "--backend=cpu,gl", NULL });
	assert_said(place, 1, "by one backend");
	char path[160];
	file_in(place, "c", path);
	assert_int_equal(access(path, F_OK), -1);
	place_run(*state, (const char *[]) { "clip", "a.scene", "--out=.", NULL });
	assert_said(place, 1, "not empty");
}

TEST_SUITE(clip)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test_setup_teardown(table_of_cameras_is_read_line_by_line, set_up,
						place_remove),
		cmocka_unit_test_setup_teardown(session_has_a_camera_a_frame, set_up, place_remove),
		cmocka_unit_test_setup_teardown(what_is_no_camera_is_refused, set_up, place_remove),
		cmocka_unit_test_setup_teardown(every_sequence_shows_the_same_cameras, set_up,
						place_remove),
		cmocka_unit_test_setup_teardown(gaze_and_camera_follow_their_paths, set_up,
						place_remove),
		cmocka_unit_test_setup_teardown(plan_grows_until_frames_are_the_reference, set_up,
						place_remove),
		cmocka_unit_test_setup_teardown(wrong_requests_write_nothing, set_up, place_remove),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
