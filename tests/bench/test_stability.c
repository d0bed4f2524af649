/* Where methods fail, by the functions that gazebench runs on a user's scene: every method with
 * every step rule. GZ_TEST_BACKEND names the backend. What rays must show is asked of the oracle,
 * which shares nothing with render/; rows that compare whole pictures take the converged picture of
 * the portable kernel, which tests/render/test_cast.c holds against the same oracle. */
#include "suite.h"

#include <stdio.h>
#include <string.h>

#include "bench/stability/stability.h"
#include "render/oracle.h"
#include "render/plan/method.h"
#include "render/raycast/shared/raycaster.h"
#include "render/small_scene.h"

static enum gz_result ask_oracle(void *user, const struct gz_stability_scene *scene, int width,
				 int height, struct gz_image *image)
{
	(void)user;
	const enum gz_result result = gz_image_resize(image, width, height);
	for (int i = 0; i < width * height && result == GZ_OK; i++) {
		double rgb[3];
		oracle_pixel(scene->volume, scene->transfer, &scene->camera, &scene->rays, width,
			     height, i % width, i / width, rgb);
		for (int c = 0; c < 3; c++)
			image->pixels[4 * i + c] = (uint8_t)(255 * rgb[c] + 0.5);
		image->pixels[4 * i + 3] = 255;
	}
	return result;
}

/* What the tests of one picture size share. */
struct fixture {
	struct small_scene scene;
	struct gz_stability_bench *bench;
};

/* Spacings up to 16 px on a picture of a few hundred, and regions in proportion. */
static struct gz_foveation foveation_of(int method)
{
	struct gz_foveation foveation = small_scene_foveation();
	foveation.method = method;
	foveation.acuity_slope = 0.1;
	foveation.mdc_square_px = 90;
	foveation.mdc_spacing = 4;
	foveation.mdc3_square_px = 170;
	foveation.mdc3_spacing = 8;
	memcpy(foveation.ddc_inner_px, (double[2]) { 50, 40 }, sizeof foveation.ddc_inner_px);
	memcpy(foveation.ddc_middle_px, (double[2]) { 110, 90 }, sizeof foveation.ddc_middle_px);
	return foveation;
}

/* Plans and what is made of them are the same on gl, where a picture takes several times as long.
 */
static int churn_frames(void)
{
	return strcmp(small_scene_backend(), "cpu") == 0 ? 10000 : 3000;
}

static void make_fixture(struct fixture *fixture, int width, int height,
			 gz_stability_wanted *wanted)
{
	fixture->scene = small_scene_waves(48, 48, 48, GZ_VOXEL_U8);
	const struct gz_stability_settings settings = {
		.scene = { .volume = &fixture->scene.volume,
			   .transfer = &fixture->scene.transfer,
			   .camera = fixture->scene.camera,
			   .rays = fixture->scene.rays },
		.display = gz_display_default(width, height),
		.width = width,
		.height = height,
		.threads = 2,
		.churn_frames = churn_frames(),
		.wanted = wanted,
	};
	assert_int_equal(gz_stability_create(&settings, &fixture->bench), GZ_OK);
	assert_int_equal(gz_stability_use_backend(fixture->bench, small_scene_backend()), GZ_OK);
}

static void free_fixture(struct fixture *fixture)
{
	gz_stability_destroy(&fixture->bench);
	small_scene_free(&fixture->scene);
}

static const struct gz_stability_row *row_named(const char *name)
{
	const struct gz_stability_row *row = gz_stability_rows;
	while (row->name && strcmp(row->name, name) != 0)
		row++;
	assert_non_null(row->name);
	return row;
}

/* Every method; how many the row is not about. */
static void check_row(const char *name, int width, int height, gz_stability_wanted *wanted,
		      int apart)
{
	const struct gz_stability_row *row = row_named(name);
	struct fixture fixture;
	make_fixture(&fixture, width, height, wanted);
	struct gz_stability_outcome outcome = { 0 };
	int left_out = 0, failed = 0;
	for (int method = 0; method < (row->every_method ? 1 : GZ_METHOD_COUNT); method++) {
		const struct gz_foveation foveation = foveation_of(method);
		gz_stability_use_method(fixture.bench, &foveation, NULL, true);
		assert_int_equal(gz_stability_run(fixture.bench, row, &outcome), GZ_OK);
		left_out += outcome.verdict == GZ_STABILITY_APART;
		failed += outcome.verdict != GZ_STABILITY_APART &&
			  outcome.verdict != GZ_STABILITY_HOLDS;
		print_message("%s, %s: %s", name, gz_method_names[method],
			      gz_stability_verdict_text(outcome.verdict));
		for (int i = 0; i < outcome.number_count; i++)
			print_message("; %.4g %s (at most %g; %s)", outcome.numbers[i].value,
				      outcome.numbers[i].what, outcome.numbers[i].bound,
				      outcome.numbers[i].where);
		print_message("; %s; at %d %d got %d, wanted %d\n", outcome.note, outcome.worst.x,
			      outcome.worst.y, outcome.worst.got[0], outcome.worst.wanted[0]);
	}
	gz_stability_outcome_free(&outcome);
	free_fixture(&fixture);
	assert_int_equal(failed, 0);
	assert_int_equal(left_out, apart);
}

/* The Voronoi method of Bruder et al. (2019) has a periphery that is too transparent, because its
 * opacity ignores the step. */
static void box_of_constant_density_is_as_bright_at_any_step_and_spacing(void **state)
{
	(void)state;
	check_row("brightness", 64, 48, ask_oracle, 0);
}

/* Bauer 2018 saw slightly perforated branches at a quarter of the sampling rate, and clear
 * artefacts at a fifth. */
static void wires_and_shells_one_voxel_thick_are_not_lost_in_the_fovea(void **state)
{
	(void)state;
	check_row("thin", 64, 48, NULL, 0);
}

static void what_standard_shows_in_the_fovea_is_not_lost(void **state)
{
	(void)state;
	check_row("lost", 320, 240, NULL, 0);
}

/* Where samples are placed round the gaze (Levoy and Whitaker 1990; the Voronoi method), all of
 * them move when it trembles. */
static void trembling_gaze_changes_nothing_in_the_fovea_and_little_elsewhere(void **state)
{
	(void)state;
	check_row("tremble", 320, 240, NULL, 0);
}

/* Bauer 2018: the eye is drawn to what changes at the borders of mdc and ddc. */
static void border_sweeps_over_the_picture_without_a_step_of_error(void **state)
{
	(void)state;
	check_row("border", 320, 240, NULL, 2);
}

/* Bauer 2018 saw artefacts of varying steps while the eyes moved, none in fixation. */
static void moving_gaze_changes_nothing_in_the_fovea_and_little_elsewhere(void **state)
{
	(void)state;
	check_row("pursuit", 320, 240, NULL, 0);
}

/* Aliasing crawls while the picture moves, where the periphery sees best. */
static void turning_camera_shows_little_that_comes_and_goes(void **state)
{
	(void)state;
	check_row("turn", 320, 240, NULL, 0);
}

/* Without a depth for each ray, earlier frames cost 4 to 7 dB (docs/results.md). */
static void earlier_frames_make_no_frame_worse(void **state)
{
	(void)state;
	check_row("kept", 320, 240, NULL, 0);
}

/* People look past the edge of a display, and trackers lose them: no peer says what it does then.
 */
static void gaze_anywhere_or_nowhere_writes_every_pixel_and_is_sharp_where_it_is(void **state)
{
	(void)state;
	check_row("gaze", 320, 240, NULL, 0);
}

/* A fovea that is still blurred more than 60 ms after the eye has landed is seen (Loschky and
 * Wolverton 2007); trackers, filters and displays take most of that. */
static void first_frame_after_a_saccade_is_sharp_in_the_fovea(void **state)
{
	(void)state;
	check_row("saccade", 320, 240, NULL, 1);
}

/* Where a neighbour is missing, loaders and fetches have their edge cases. */
static void odd_volumes_equal_the_oracle_wherever_a_ray_was_cast(void **state)
{
	(void)state;
	check_row("volumes", 64, 48, ask_oracle, 0);
}

/* Where rays begin on rasterised front faces (Krueger and Westermann 2003), an eye within the box
 * sees none of them. */
static void odd_cameras_equal_the_oracle_and_leave_no_seams(void **state)
{
	(void)state;
	check_row("camera", 64, 48, ask_oracle, 0);
}

/* Opacity correction takes the logarithm of 1 - opacity, which opaque matter has none of. */
static void transparent_and_opaque_matter_equal_the_oracle(void **state)
{
	(void)state;
	check_row("transfer", 64, 48, ask_oracle, 0);
}

/* Samples miss it (Engel, Kraus and Ertl 2001). */
static void spike_one_entry_wide_matches_the_formula(void **state)
{
	(void)state;
	check_row("spike", 64, 48, NULL, 0);
}

/* Lattices whose last column has no right neighbour leave the rim unwritten. */
static void pictures_of_every_size_are_written_whole(void **state)
{
	(void)state;
	check_row("sizes", 64, 48, NULL, 0);
}

/* A renderer that keeps what it took for a frame grows without end. */
static void memory_stays_constant_while_method_and_size_change(void **state)
{
	(void)state;
	check_row("churn", 64, 48, NULL, 0);
}

static enum gz_result ask_oracle_but_for_a_pixel(void *user, const struct gz_stability_scene *scene,
						 int width, int height, struct gz_image *image)
{
	const enum gz_result result = ask_oracle(user, scene, width, height, image);
	if (result == GZ_OK) /* one pixel that a ray of every method is cast for */
		image->pixels[4 * (width * 16 + 32)] ^= 128;
	return result;
}

/* A row that cannot fail checks nothing. */
static void one_wrong_pixel_fails_its_row_and_is_named_and_shown(void **state)
{
	(void)state;
	const struct gz_stability_row *row = row_named("camera");
	struct fixture fixture;
	make_fixture(&fixture, 64, 48, ask_oracle_but_for_a_pixel);
	struct gz_stability_outcome outcome = { 0 };
	struct gz_image picture = { 0 };
	const struct gz_foveation foveation = foveation_of(GZ_METHOD_MDC);
	gz_stability_use_method(fixture.bench, &foveation, NULL, false);
	assert_int_equal(gz_stability_write_picture(&outcome, "none.png", NULL), GZ_ERR_INVAL);
	assert_int_equal(gz_stability_run(fixture.bench, row, &outcome), GZ_OK);
	assert_int_equal(outcome.verdict, GZ_STABILITY_FAILS);
	assert_int_equal(outcome.worst.x, 32);
	assert_int_equal(outcome.worst.y, 16);
	assert_true(outcome.numbers[0].value >= 100);
	assert_int_equal(gz_stability_write_picture(&outcome, "stability_test.png", NULL), GZ_OK);
	assert_int_equal(gz_image_read_png("stability_test.png", NULL, &picture), GZ_OK);
	assert_true(picture.width > 3 * GZ_STABILITY_CROP_PX);
	remove("stability_test.png");
	gz_image_free(&picture);
	gz_stability_outcome_free(&outcome);
	free_fixture(&fixture);
}

/* A table that is coarse at the gaze itself is not sharp there, whatever the frame. */
static void fovea_that_is_not_sharp_fails_saccade_and_gaze(void **state)
{
	(void)state;
	static const char *const names[] = { "saccade", "gaze" };
	struct fixture fixture;
	make_fixture(&fixture, 320, 240, NULL);
	struct gz_stability_outcome outcome = { 0 };
	struct gz_foveation foveation = foveation_of(GZ_METHOD_TABLE);
	foveation.table = (struct gz_spacing_table) { .count = 1, .rows = { { 0, 4, 1 } } };
	gz_stability_use_method(fixture.bench, &foveation, NULL, false);
	for (int i = 0; i < 2; i++) {
		assert_int_equal(gz_stability_run(fixture.bench, row_named(names[i]), &outcome),
				 GZ_OK);
		assert_int_equal(outcome.verdict, GZ_STABILITY_FAILS);
		assert_non_null(outcome.worst.got_crop.pixels);
	}
	gz_stability_outcome_free(&outcome);
	free_fixture(&fixture);
}

static void bench_without_backend_or_method_and_bad_settings_are_refused(void **state)
{
	(void)state;
	struct small_scene scene = small_scene_constant(8, 0.1);
	struct gz_stability_settings settings = { .scene = { .volume = &scene.volume,
							     .transfer = &scene.transfer,
							     .camera = scene.camera,
							     .rays = scene.rays },
						  .display = gz_display_default(16, 16),
						  .width = 16,
						  .height = 16,
						  .churn_frames = 1000 };
	struct gz_stability_bench *bench = NULL;
	struct gz_stability_outcome outcome = { 0 };
	settings.width = GZ_IMAGE_SIDE_MAX + 1;
	assert_int_equal(gz_stability_create(&settings, &bench), GZ_ERR_INVAL);
	settings.width = 16;
	settings.churn_frames = 10;
	assert_int_equal(gz_stability_create(&settings, &bench), GZ_ERR_INVAL);
	assert_null(bench);
	settings.churn_frames = 1000;
	assert_int_equal(gz_stability_create(&settings, &bench), GZ_OK);
	assert_int_equal(gz_stability_run(bench, gz_stability_rows, &outcome), GZ_ERR_INVAL);
	assert_int_equal(gz_stability_use_backend(bench, "quantum"), GZ_ERR_NOT_FOUND);
	assert_string_equal(gz_stability_describe(bench), "");
	assert_int_equal(gz_stability_run(bench, gz_stability_rows, &outcome), GZ_ERR_INVAL);
	gz_stability_destroy(&bench);
	gz_stability_destroy(&bench);
	small_scene_free(&scene);
}

TEST_SUITE(stability)
{
	static const struct CMUnitTest quick[] = {
		cmocka_unit_test(box_of_constant_density_is_as_bright_at_any_step_and_spacing),
		cmocka_unit_test(odd_volumes_equal_the_oracle_wherever_a_ray_was_cast),
		cmocka_unit_test(transparent_and_opaque_matter_equal_the_oracle),
		cmocka_unit_test(pictures_of_every_size_are_written_whole),
		cmocka_unit_test(one_wrong_pixel_fails_its_row_and_is_named_and_shown),
		cmocka_unit_test(fovea_that_is_not_sharp_fails_saccade_and_gaze),
		cmocka_unit_test(bench_without_backend_or_method_and_bad_settings_are_refused),
	};
	static const struct CMUnitTest longer[] = {
		cmocka_unit_test(wires_and_shells_one_voxel_thick_are_not_lost_in_the_fovea),
		cmocka_unit_test(what_standard_shows_in_the_fovea_is_not_lost),
		cmocka_unit_test(turning_camera_shows_little_that_comes_and_goes),
		cmocka_unit_test(earlier_frames_make_no_frame_worse),
		cmocka_unit_test(trembling_gaze_changes_nothing_in_the_fovea_and_little_elsewhere),
		cmocka_unit_test(border_sweeps_over_the_picture_without_a_step_of_error),
		cmocka_unit_test(
			gaze_anywhere_or_nowhere_writes_every_pixel_and_is_sharp_where_it_is),
		cmocka_unit_test(first_frame_after_a_saccade_is_sharp_in_the_fovea),
		cmocka_unit_test(odd_cameras_equal_the_oracle_and_leave_no_seams),
		cmocka_unit_test(memory_stays_constant_while_method_and_size_change),
	};
	/* Plans are the same on gl, and gl.preintegrated compares its integration with the cpu's.
	 */
	static const struct CMUnitTest longer_on_cpu[] = {
		cmocka_unit_test(moving_gaze_changes_nothing_in_the_fovea_and_little_elsewhere),
		cmocka_unit_test(spike_one_entry_wide_matches_the_formula),
	};
	if (!small_scene_backend_runs())
		return 77;
	if (argc > 1 && strcmp(argv[1], "longer") == 0) {
		const int failed = cmocka_run_group_tests(longer, NULL, NULL);
		return strcmp(small_scene_backend(), "cpu") != 0
			       ? failed
			       : failed + cmocka_run_group_tests(longer_on_cpu, NULL, NULL);
	}
	return cmocka_run_group_tests(quick, NULL, NULL);
}
