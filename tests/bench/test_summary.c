#include "suite.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "bench/report/summary.h"
#include "bench/report/summary_json.h"
#include "made_study.h"

static void assert_near(double value, double expected, const char *what)
{
	if (fabs(value - expected) > 1e-9 * fmax(1, fabs(expected)))
		fail_msg("%s is %.12g, not %.12g", what, value, expected);
}

static void distribution_of_known_values_has_their_moments_and_quantiles(void **state)
{
	(void)state;
	double values[] = { 4, NAN, 1, 3, 2 };
	const struct gz_distribution all = gz_distribution_of(values, 5);
	assert_int_equal(all.count, 4);
	assert_near(all.mean, 2.5, "mean");
	assert_near(all.variance, 1.25, "variance");
	assert_near(all.median, 2.5, "median");
	assert_near(all.p90, 3.7, "p90");
	assert_near(all.p99, 3.97, "p99");
	assert_near(all.sum, 10, "sum");
	assert_near(all.perceived, 30. / 10, "time-weighted mean");
	assert_near(all.least, 1, "least");
	assert_near(all.greatest, 4, "greatest");
}

static void empty_distribution_is_nan(void **state)
{
	(void)state;
	double values[] = { NAN };
	const struct gz_distribution none = gz_distribution_of(values, 1);
	assert_int_equal(none.count, 0);
	assert_true(isnan(none.mean) && isnan(none.median) && isnan(none.perceived));
}

/* Two points of three frames; the third of each was disturbed. */
static void disturbed(const struct gz_study *study, struct gz_study_row *row)
{
	(void)study;
	const double standard[2][3] = { { 100, 102, 900 }, { 50, 52, 800 } };
	const double acuity[2][3] = { { 10, 12, 700 }, { 4, 6, 600 } };
	row->frame_ms = row->variant == 0 ? standard[row->point][row->frame]
					  : acuity[row->point][row->frame];
	row->cast_ms = row->frame_ms - 3;
	row->plan_ms = 1;
	row->reconstruct_ms = 2;
	row->rays = row->variant == 0 ? 10000 : 800;
	row->samples = row->rays * 10;
}

static void ratios_of_disturbed_frames_come_from_medians(void **state)
{
	(void)state;
	const struct made_study made = { .scenes = { "head" },
					 .variants = { "standard", "acuity" },
					 .backends = { "cpu" },
					 .sizes = { { 100, 100 } },
					 .size_count = 1,
					 .points = 2,
					 .frames = 3 };
	struct gz_study study;
	struct gz_summary summary;
	make_study(&made, &study);
	make_rows(&study, disturbed);
	study.machine.copy_ms[0] = 0.5;
	assert_int_equal(gz_summary_make(&study, &summary), GZ_OK);
	assert_int_equal(summary.group_count, 1);
	const struct gz_group *group = &summary.groups[0];
	assert_int_equal(group->standard, 0);
	const struct gz_series *acuity = &group->series[1];
	assert_near(acuity->typical_ms, (12 + 6) / 2., "typical time");
	assert_near(acuity->ratio_of_means, (102. + 52) / (12 + 6), "ratio of means");
	assert_near(acuity->mean_ratio, (102. / 12 + 52. / 6) / 2, "mean of ratios");
	assert_near(acuity->least_ratio, 102. / 12, "least ratio");
	assert_near(group->series[0].ratio_of_means, 1, "standard over itself");
	assert_near(acuity->columns[GZ_COLUMN_CAST].mean, 1332. / 6 - 3, "mean cast time");
	assert_near(acuity->overhead_ms.mean, 3, "mean overhead");
	assert_near(acuity->columns[GZ_COLUMN_FRAME].sum, 1332, "sum of frame times");
	assert_near(acuity->columns[GZ_COLUMN_FRAME].perceived,
		    (100. + 144 + 490000 + 16 + 36 + 360000) / 1332, "perceived frame time");
	assert_near(acuity->bound_share, 800 / (0.04 * 10000), "rays over the bound's");
	assert_near(group->bound_ms, (102. + 52) / 2 * 0.04, "time of the bound's rays");
	assert_near(acuity->efficiency, (0.5 + group->bound_ms) / acuity->typical_ms,
		    "what nobody could save, over the time of a frame");
	gz_summary_free(&summary);
	gz_study_free(&study);
}

/* Points with mean squared errors of 0.01, 0.03 and, where pictures are equal, 0. */
static void errors_to_average(const struct gz_study *study, struct gz_study_row *row)
{
	(void)study;
	row->frame_ms = row->variant == 0 ? 10 : 1;
	row->cast_ms = row->frame_ms;
	row->rays = row->samples = 1;
	if (row->variant == 1) {
		const double db[3] = { 20, -10 * log10(0.03), INFINITY };
		const double ssim[3] = { 0.9, 0.8, 1 }, flip[3] = { 0.1, 0.2, 0 };
		row->converged.psnr_db = db[row->point];
		row->converged.ssim = ssim[row->point];
		row->converged.flip = flip[row->point];
		row->flicker = 0.25 * row->point;
		row->turning_error = 0.5 * row->point;
		row->camera_path_error = 0.75 * row->point;
		row->reference_db = 60 - (double)row->point;
	} else {
		row->converged.psnr_db = INFINITY;
	}
}

static void errors_are_averaged_as_costs_and_never_as_decibels(void **state)
{
	(void)state;
	const struct made_study made = { .scenes = { "head" },
					 .variants = { "standard", "acuity" },
					 .backends = { "cpu" },
					 .sizes = { { 8, 8 } },
					 .size_count = 1,
					 .points = 3,
					 .frames = 2 };
	struct gz_study study;
	struct gz_summary summary;
	make_study(&made, &study);
	make_rows(&study, errors_to_average);
	assert_int_equal(gz_summary_make(&study, &summary), GZ_OK);
	const struct gz_series *acuity = &summary.groups[0].series[1];
	const struct gz_error_summary *psnr = &acuity->errors[GZ_AGAINST_CONVERGED][GZ_WHOLE_PSNR];
	assert_int_equal(psnr->count, 3);
	assert_near(psnr->mean, -10 * log10(0.04 / 3), "mean PSNR");
	assert_near(psnr->worst, -10 * log10(0.03), "worst PSNR");
	assert_near(acuity->errors[GZ_AGAINST_CONVERGED][GZ_WHOLE_SSIM].mean, 0.9, "mean SSIM");
	assert_near(acuity->errors[GZ_AGAINST_CONVERGED][GZ_WHOLE_SSIM].worst, 0.8, "worst SSIM");
	assert_near(acuity->errors[GZ_AGAINST_CONVERGED][GZ_WHOLE_FLIP].p95, 0.19, "FLIP, p95");
	assert_near(acuity->flicker.mean, 0.25, "flicker");
	assert_near(acuity->turning_error.mean, 0.5, "turning");
	assert_near(acuity->camera_path_error.mean, 0.75, "along the camera path");
	assert_near(summary.groups[0].reference_db, 58, "worst PSNR of the reference");
	const struct gz_error_summary *equal =
		&summary.groups[0].series[0].errors[GZ_AGAINST_CONVERGED][GZ_WHOLE_PSNR];
	assert_true(isinf(equal->mean) && equal->mean > 0);
	assert_int_equal(acuity->errors[GZ_AGAINST_STANDARD][GZ_WHOLE_PSNR].count, 0);
	assert_true(isnan(acuity->errors[GZ_AGAINST_STANDARD][GZ_WHOLE_PSNR].mean));
	gz_summary_free(&summary);
	gz_study_free(&study);
}

/* Times and foveal FLIP of each variant of the curve tests. */
static void curve(const struct gz_study *study, struct gz_study_row *row)
{
	(void)study;
	const double ms[] = { 100, 40, 20, 10, 30 }, flip[] = { 0, 0.01, 0.03, 0.05, 0.04 };
	const uint64_t samples[] = { 1000, 400, 200, 100, 300 };
	row->frame_ms = row->cast_ms = ms[row->variant];
	row->samples = row->rays = samples[row->variant];
	row->converged.foveal_flip = flip[row->variant];
}

static const struct made_study curve_study = {
	.scenes = { "head" },
	.variants = { "standard", "acuity:acuity_slope=0.01", "acuity:acuity_slope=0.04", "acuity",
		      "mdc" },
	.backends = { "cpu" },
	.sizes = { { 8, 8 } },
	.size_count = 1,
	.points = 2,
	.frames = 1,
};

static void front_holds_what_nothing_beats_in_time_and_error(void **state)
{
	(void)state;
	struct gz_study study;
	struct gz_summary summary;
	make_study(&curve_study, &study);
	make_rows(&study, curve);
	assert_int_equal(gz_summary_make(&study, &summary), GZ_OK);
	const bool expected[] = { true, true, true, true, false };
	for (size_t i = 0; i < 5; i++)
		if (summary.groups[0].series[i].front[GZ_AGAINST_CONVERGED][GZ_FOVEAL_FLIP] !=
		    expected[i])
			fail_msg("%s: on the front is not %d", study.variants[i].text, expected[i]);
	assert_false(summary.groups[0].series[0].front[GZ_AGAINST_STANDARD][GZ_FOVEAL_FLIP]);
	gz_summary_free(&summary);
	gz_study_free(&study);
}

static void equal_error_and_equal_time_are_interpolated_along_a_method(void **state)
{
	(void)state;
	struct gz_study study;
	struct gz_summary summary;
	size_t near;
	make_study(&curve_study, &study);
	make_rows(&study, curve);
	assert_int_equal(gz_summary_make(&study, &summary), GZ_OK);
	const struct gz_group *group = &summary.groups[0];
	assert_int_equal(group->curve_count, 3);
	const struct gz_curve *acuity = &group->curves[1], *mdc = &group->curves[2];
	assert_string_equal(acuity->method, "acuity");
	assert_int_equal(acuity->count, 3);
	assert_int_equal(acuity->series[0], 1);
	assert_int_equal(acuity->series[2], 3);
	assert_near(gz_curve_time_at_cost(group, acuity, GZ_AGAINST_CONVERGED, GZ_FOVEAL_FLIP, 0.02,
					  &near),
		    30, "time of acuity at foveal FLIP 0.02");
	assert_int_equal(near, 1);
	assert_true(isnan(gz_curve_time_at_cost(group, mdc, GZ_AGAINST_CONVERGED, GZ_FOVEAL_FLIP,
						0.02, &near)));
	assert_int_equal(near, GZ_SERIES_NONE);
	assert_near(gz_curve_cost_at_time(group, acuity, GZ_AGAINST_CONVERGED, GZ_FOVEAL_FLIP, 15,
					  &near),
		    0.04, "foveal FLIP of acuity within 15 ms");
	assert_true(isnan(gz_curve_cost_at_time(group, acuity, GZ_AGAINST_CONVERGED, GZ_FOVEAL_FLIP,
						5, &near)));
	gz_summary_free(&summary);
	gz_study_free(&study);
}

static void cheapest_within_a_bound_holds_it_at_every_point(void **state)
{
	(void)state;
	struct gz_study study;
	struct gz_summary summary;
	make_study(&curve_study, &study);
	make_rows(&study, curve);
	for (size_t i = 0; i < study.row_count; i++)
		if (study.rows[i].variant == 2 && study.rows[i].point == 1)
			study.rows[i].converged.foveal_flip = 0.06;
	assert_int_equal(gz_summary_make(&study, &summary), GZ_OK);
	const struct gz_group *group = &summary.groups[0];
	assert_int_equal(
		gz_group_cheapest_within(group, GZ_AGAINST_CONVERGED, GZ_FOVEAL_FLIP, 0.055), 3);
	assert_int_equal(
		gz_group_cheapest_within(group, GZ_AGAINST_CONVERGED, GZ_FOVEAL_FLIP, 0.045), 4);
	assert_int_equal(
		gz_group_cheapest_within(group, GZ_AGAINST_CONVERGED, GZ_FOVEAL_FLIP, 0.005), 0);
	assert_int_equal(gz_group_cheapest_within(group, GZ_AGAINST_STANDARD, GZ_FOVEAL_FLIP, 1),
			 GZ_SERIES_NONE);
	gz_summary_free(&summary);
	gz_study_free(&study);
}

/* 2 microseconds a pixel of voxels^(1/3), halved by two threads. */
static void growing(const struct gz_study *study, struct gz_study_row *row)
{
	const int *size = study->sizes[row->size];
	row->frame_ms = 0.002 * size[0] * size[1] * study->scenes[row->scene].dims[0];
	if (strstr(study->backends[row->backend], "threads=2"))
		row->frame_ms /= 2;
	row->cast_ms = row->frame_ms;
	row->rays = row->samples = 1;
}

static const struct gz_scaling *find_scaling(const struct gz_summary *summary,
					     enum gz_scaling_kind kind)
{
	for (size_t i = 0; i < summary->scaling_count; i++)
		if (summary->scalings[i].kind == kind)
			return &summary->scalings[i];
	fail_msg("no fit of kind %d among %zu", kind, summary->scaling_count);
	return NULL;
}

static void growth_is_fitted_over_pixels_voxels_and_threads(void **state)
{
	(void)state;
	const struct made_study made = { .scenes = { "small", "large" },
					 .variants = { "standard" },
					 .backends = { "cpu:threads=1", "cpu:threads=2" },
					 .sizes = { { 10, 10 }, { 20, 20 }, { 40, 30 } },
					 .size_count = 3,
					 .points = 1,
					 .frames = 1 };
	struct gz_study study;
	struct gz_summary summary;
	make_study(&made, &study);
	make_rows(&study, growing);
	assert_int_equal(gz_summary_make(&study, &summary), GZ_OK);
	/* 2 scenes x 2 backends, 3 sizes x 2 backends, 2 scenes x 3 sizes */
	assert_int_equal(summary.scaling_count, 4 + 6 + 6);
	const struct gz_scaling *pixels = find_scaling(&summary, GZ_SCALING_PIXELS);
	assert_int_equal(pixels->point_count, 3);
	assert_near(pixels->exponent, 1, "exponent over pixels");
	assert_near(pixels->factor, 0.128, "factor over pixels");
	assert_near(pixels->r2, 1, "r2 over pixels");
	assert_near(find_scaling(&summary, GZ_SCALING_VOXELS)->exponent, 1. / 3, "over voxels");
	assert_near(find_scaling(&summary, GZ_SCALING_THREADS)->exponent, -1, "over threads");
	gz_summary_free(&summary);
	gz_study_free(&study);
}

static void fit_of_scattered_points_has_its_r2(void **state)
{
	(void)state;
	/* Logarithms to base 2: (0, 0), (1, 2), (2, 1): slope 1/2, r2 = 1/4. */
	const struct gz_scaling_point points[] = { { 1, 1 }, { 2, 4 }, { 4, 2 } };
	double exponent, factor, r2;
	assert_true(gz_scaling_fit(points, 3, &exponent, &factor, &r2));
	assert_near(exponent, 0.5, "exponent");
	assert_near(r2, 0.25, "r2");
	assert_near(factor, sqrt(2), "factor");
}

static void fit_of_one_size_is_refused(void **state)
{
	(void)state;
	const struct gz_scaling_point points[] = { { 4, 1 }, { 4, 2 } };
	const struct gz_scaling_point zero[] = { { 0, 1 }, { 4, 2 } };
	double exponent, factor, r2;
	assert_false(gz_scaling_fit(points, 2, &exponent, &factor, &r2));
	assert_false(gz_scaling_fit(points, 0, &exponent, &factor, &r2));
	assert_false(gz_scaling_fit(zero, 2, &exponent, &factor, &r2));
}

static void study_without_rows_is_refused(void **state)
{
	(void)state;
	struct gz_study study;
	struct gz_summary summary;
	make_study(&curve_study, &study);
	assert_int_equal(gz_summary_make(&study, &summary), GZ_ERR_END);
	gz_study_free(&study);
}

static void rows_outside_the_lists_or_out_of_order_are_refused(void **state)
{
	(void)state;
	struct gz_study study;
	struct gz_summary summary;
	make_study(&curve_study, &study);
	make_rows(&study, curve);
	study.rows[3].variant = 5;
	assert_int_equal(gz_summary_make(&study, &summary), GZ_ERR_INVAL);
	study.rows[3].variant = 2;
	assert_int_equal(gz_summary_make(&study, &summary), GZ_ERR_INVAL);
	gz_study_free(&study);
}

static void summary_as_json_holds_the_numbers_and_no_infinity(void **state)
{
	(void)state;
	const struct made_study made = { .scenes = { "head" },
					 .variants = { "standard", "acuity" },
					 .backends = { "cpu" },
					 .sizes = { { 8, 8 } },
					 .size_count = 1,
					 .points = 3,
					 .frames = 2 };
	struct gz_study study;
	struct gz_summary summary;
	make_study(&made, &study);
	make_rows(&study, errors_to_average);
	assert_int_equal(gz_summary_make(&study, &summary), GZ_OK);
	json_t *json = gz_summary_to_json(&summary);
	assert_non_null(json);
	char *text = json_dumps(json, 0);
	assert_non_null(text);
	json_t *variants =
		json_object_get(json_array_get(json_object_get(json, "groups"), 0), "variants");
	assert_int_equal(json_array_size(variants), 2);
	const json_t *errors = json_object_get(
		json_object_get(json_array_get(variants, 0), "errors"), "converged");
	assert_string_equal(
		json_string_value(json_object_get(json_object_get(errors, "psnr_db"), "mean")),
		"inf");
	assert_true(json_is_null(json_object_get(errors, "flip")));
	assert_near(json_real_value(json_object_get(json_array_get(variants, 1), "mean_ratio")), 10,
		    "mean_ratio");
	free(text);
	json_decref(json);
	gz_summary_free(&summary);
	gz_study_free(&study);
}

TEST_SUITE(summary)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(distribution_of_known_values_has_their_moments_and_quantiles),
		cmocka_unit_test(empty_distribution_is_nan),
		cmocka_unit_test(ratios_of_disturbed_frames_come_from_medians),
		cmocka_unit_test(errors_are_averaged_as_costs_and_never_as_decibels),
		cmocka_unit_test(front_holds_what_nothing_beats_in_time_and_error),
		cmocka_unit_test(equal_error_and_equal_time_are_interpolated_along_a_method),
		cmocka_unit_test(cheapest_within_a_bound_holds_it_at_every_point),
		cmocka_unit_test(growth_is_fitted_over_pixels_voxels_and_threads),
		cmocka_unit_test(fit_of_scattered_points_has_its_r2),
		cmocka_unit_test(fit_of_one_size_is_refused),
		cmocka_unit_test(study_without_rows_is_refused),
		cmocka_unit_test(rows_outside_the_lists_or_out_of_order_are_refused),
		cmocka_unit_test(summary_as_json_holds_the_numbers_and_no_infinity),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
