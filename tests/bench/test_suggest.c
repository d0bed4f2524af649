/* gazebench report and suggest, as people call them. */
#include "suite.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <jansson.h>

#include "bench/study/study_folder.h"
#include "called.h"
#include "made_study.h"

static const double flips[] = { 0.001, 0.012, 0.02, 0.04 };
static const double times[] = { 100, 20, 10, 5 };

static void measure(const struct gz_study *study, struct gz_study_row *row)
{
	(void)study;
	row->frame_ms = row->cast_ms = times[row->variant];
	row->rays = row->samples = (uint64_t)(100 * times[row->variant]);
	row->converged.perceived_flip = flips[row->variant] * (1 + row->scene);
	row->converged.psnr_db = 50 - row->variant;
}

static void write_study(const struct place *place, bool rows)
{
	const struct made_study made = {
		.scenes = { "head", "hand" },
		.variants = { "standard", "acuity", "acuity:acuity_slope=0.033", "mdc" },
		.backends = { "cpu" },
		.sizes = { { 100, 100 } },
		.size_count = 1,
		.points = 3,
		.frames = 1,
	};
	char folder[96];
	struct gz_study study;
	make_study(&made, &study);
	make_rows(&study, measure);
	if (!rows)
		study.row_count = 0;
	study.complete = rows;
	snprintf(folder, sizeof folder, "%s/study", place->path);
	assert_int_equal(gz_study_write(folder, &study, NULL), GZ_OK);
	gz_study_free(&study);
}

static int set_up(void **state)
{
	static struct place place;
	char path[96];
	if (place_make(&place) != 0)
		return 1;
	snprintf(path, sizeof path, "%s/head.scene", place.path);
	FILE *file = fopen(path, "w");
	if (!file)
		return 1;
	fputs("; the head\n[volume]\nprocedural = shells\n[transfer]\nfile = "
	      "a.tf\n[foveation]\nmethod = mdc ; for now\n",
	      file);
	fclose(file);
	*state = &place;
	return 0;
}

static void suggestion_holds_at_every_point_and_is_written_into_a_copy(void **state)
{
	struct place *place = *state;
	struct gz_text scene = { 0 };
	char path[96];
	write_study(place, true);
	place_run(place, (const char *[]) { "suggest", "study", "--scene", "head.scene", "--out",
					    "fast.scene", NULL });
	assert_said(place, 0, "acuity, slope 0.033 takes 10 ms");
	snprintf(path, sizeof path, "%s/fast.scene", place->path);
	assert_int_equal(gz_text_add_file(&scene, path), GZ_OK);
	assert_string_equal(
		scene.bytes,
		"; the head\n[volume]\nprocedural = shells\n[transfer]\nfile = a.tf\n[foveation]\n"
		"method = acuity ; for now\nacuity_slope = 0.033\n");
	gz_text_free(&scene);
	place_run(place, (const char *[]) { "suggest", "study", "--scene", "head.scene", "--out",
					    "fast.scene", NULL });
	assert_said(place, 1, "fast.scene already exists");
}

static void suggestion_for_the_harder_scene_costs_more(void **state)
{
	struct place *place = *state;
	write_study(place, true);
	place_run(place,
		  (const char *[]) { "suggest", "study", "--scene", "hand", "--json", NULL });
	assert_int_equal(place->status, 0);
	json_t *json = json_loads(place->said.bytes, 0, NULL);
	assert_non_null(json);
	assert_string_equal(json_string_value(json_object_get(json, "variant")), "acuity");
	assert_true(json_is_true(json_object_get(json, "holds")));
	const json_t *group = json_array_get(json_object_get(json, "measured"), 0);
	assert_float_equal(json_number_value(json_object_get(group, "ratio")), 5, 1e-6);
	assert_float_equal(json_number_value(json_object_get(group, "worst")), 0.024, 1e-6);
	json_decref(json);
}

static void suggestion_where_nothing_qualifies_is_standard_and_says_so(void **state)
{
	struct place *place = *state;
	write_study(place, true);
	place_run(place, (const char *[]) { "suggest", "study", "--scene", "head", "--bound",
					    "0.0005", NULL });
	assert_said(place, 0, "standard remains");
	place_run(place, (const char *[]) { "suggest", "study", "--scene", "head", "--bound",
					    "0.0005", "--json", NULL });
	assert_said(place, 0, "\"holds\": false");
	assert_said(place, 0, "\"variant\": \"standard\"");
}

static void questions_without_an_answer_are_refused(void **state)
{
	struct place *place = *state;
	write_study(place, true);
	place_run(place, (const char *[]) { "suggest", "study", NULL });
	assert_said(place, 1, "several scenes were measured; say which with --scene");
	place_run(place, (const char *[]) { "suggest", "study", "--scene", "foot", NULL });
	assert_said(place, 1, "nothing was measured of this scene");
	place_run(place, (const char *[]) { "suggest", "study", "--scene", "head", "--metric",
					    "psnr_db", NULL });
	assert_said(place, 2, "give --bound");
	place_run(place, (const char *[]) { "suggest", "study", "--scene", "head", "--metric",
					    "foveal_flip", NULL });
	assert_said(place, 1, "foveal FLIP against converged was not measured");
	place_run(place, (const char *[]) { "suggest", "study", "--scene", "head", "--against",
					    "standard", NULL });
	assert_said(place, 1, "against standard was not measured");
	place_run(place, (const char *[]) { "suggest", "study", "--bound", "nan", NULL });
	assert_int_equal(place->status, 2);
	place_run(place, (const char *[]) { "suggest", NULL });
	assert_said(place, 2, "give one folder");
}

static void bound_on_ssim_or_psnr_is_a_minimum(void **state)
{
	struct place *place = *state;
	write_study(place, true);
	place_run(place, (const char *[]) { "suggest", "study", "--scene", "head",
					    "--metric=psnr_db", "--bound=48.5", NULL });
	assert_said(place, 0, "acuity takes 20 ms");
	assert_said(place, 0, "stays above the bound of 48.5");
}

static void report_of_no_rows_or_of_no_study_is_refused(void **state)
{
	struct place *place = *state;
	write_study(place, false);
	place_run(place, (const char *[]) { "report", "study", NULL });
	assert_said(place, 1, "no frame was measured yet");
	place_run(place, (const char *[]) { "suggest", "study", NULL });
	assert_said(place, 1, "no frame was measured yet");
	place_run(place, (const char *[]) { "report", "nowhere", NULL });
	assert_int_equal(place->status, 1);
	place_run(place, (const char *[]) { "report", NULL });
	assert_said(place, 2, "give one folder");
}

static void report_without_gnuplot_has_all_but_charts_and_says_so(void **state)
{
	struct place *place = *state;
	char path[96];
	write_study(place, true);
	const char *before = getenv("PATH");
	char kept[4096];
	snprintf(kept, sizeof kept, "%s", before ? before : "");
	setenv("PATH", "/nonexistent", 1);
	place_run(place, (const char *[]) { "report", "study", NULL });
	setenv("PATH", kept, 1);
	assert_said(place, 0, "gnuplot is not installed: there are no charts");
	assert_said(place, 0, "study/report.html");
	static const char *const files[] = { "report.html", "summary.json" };
	for (size_t i = 0; i < sizeof files / sizeof files[0]; i++) {
		snprintf(path, sizeof path, "%s/study/%s", place->path, files[i]);
		assert_int_equal(access(path, R_OK), 0);
	}
	place_run(place, (const char *[]) { "suggest", "study", "--scene", "head", "--metric",
					    "flip", NULL });
	assert_int_equal(place->status, 1);
}

TEST_SUITE(suggest)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test_setup_teardown(
			suggestion_holds_at_every_point_and_is_written_into_a_copy, set_up,
			place_remove),
		cmocka_unit_test_setup_teardown(suggestion_for_the_harder_scene_costs_more, set_up,
						place_remove),
		cmocka_unit_test_setup_teardown(
			suggestion_where_nothing_qualifies_is_standard_and_says_so, set_up,
			place_remove),
		cmocka_unit_test_setup_teardown(questions_without_an_answer_are_refused, set_up,
						place_remove),
		cmocka_unit_test_setup_teardown(bound_on_ssim_or_psnr_is_a_minimum, set_up,
						place_remove),
		cmocka_unit_test_setup_teardown(report_of_no_rows_or_of_no_study_is_refused, set_up,
						place_remove),
		cmocka_unit_test_setup_teardown(
			report_without_gnuplot_has_all_but_charts_and_says_so, set_up,
			place_remove),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
