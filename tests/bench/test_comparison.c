/* gazebench techniques: what is compared, summed up and printed beside it. */
#include "suite.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "bench/comparison/comparison.h"
#include "bench/report/comparison_report.h"
#include "bench/report/published_times.h"
#include "called.h"
#include "render/raycast/shared/ray_params.h"
#include "render/scene/techniques.h"

/* Lit shells, with a surface that no isovalue names. */
static const char scene_text[] = "[volume]\nprocedural = shells\ndims = 32 32 32\n"
				 "[transfer]\nfile = a.tf\n"
				 "[render]\nshading = gradient\n";
static const char transfer_text[] = "0 0 0 0 0\n0.5 1 0.8 0.6 0\n0.6 1 0.8 0.6 0.4\n";

static void write_file(const struct place *place, const char *name, const char *text)
{
	char path[128];
	snprintf(path, sizeof path, "%s/%s", place->path, name);
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

static bool some_technique_has_key(const char *key)
{
	for (size_t i = 0; gz_techniques[i]; i++)
		if (gz_technique_has_key(gz_techniques[i], key))
			return true;
	return false;
}

static void every_setting_of_an_effect_is_a_key_of_some_technique(void **state)
{
	(void)state;
	for (int i = 0; i < GZ_EFFECT_COUNT; i++)
		for (int k = 0; gz_effects[i].settings[k].key; k++)
			if (!some_technique_has_key(gz_effects[i].settings[k].key))
				fail_msg("%s: no technique has %s", gz_effects[i].name,
					 gz_effects[i].settings[k].key);
}

static void effect_sets_what_the_technique_has_and_none_turns_it_off(void **state)
{
	(void)state;
	for (size_t i = 0; gz_techniques[i]; i++) {
		struct gz_ray_params rays = gz_ray_params_default();
		assert_int_equal(gz_effect_apply(&gz_effects[3], gz_techniques[i], &rays), GZ_OK);
		assert_int_equal(rays.light.shadow_steps > 0,
				 gz_technique_has_key(gz_techniques[i], "light.shadow_steps"));
		assert_int_equal(rays.light.reflection > 0,
				 gz_technique_has_key(gz_techniques[i], "light.reflection"));
		assert_int_equal(gz_effect_apply(&gz_effects[4], gz_techniques[i], &rays), GZ_OK);
		assert_int_equal(rays.surface.material == GZ_MATERIAL_GLASS,
				 gz_technique_has_key(gz_techniques[i], "isosurface.material"));
		assert_int_equal(gz_effect_apply(&gz_effects[0], gz_techniques[i], &rays), GZ_OK);
		const struct gz_ray_params preset = gz_ray_params_default();
		assert_true(gz_ray_params_same(&rays, &preset));
	}
}

static void isovalue_is_the_scenes_or_where_half_of_the_opacity_begins(void **state)
{
	(void)state;
	const double range[2] = { -100, 300 };
	struct gz_transfer transfer = { .count = 3 };
	for (int i = 0; i < 3; i++)
		transfer.points[i] =
			(struct gz_transfer_point) { .value = 0.5 * i, .opacity = 0.4 * i };
	assert_float_equal(gz_comparison_isovalue(70, range, &transfer), 70, 0);
	/* Half of .8 is reached in the middle of the range. */
	assert_float_equal(gz_comparison_isovalue(500, range, &transfer), 100, 0.1);
	assert_float_equal(gz_comparison_isovalue(-100, range, &transfer), 100, 0.1);
	transfer.has_range = true;
	transfer.range[0] = 0;
	transfer.range[1] = 40;
	assert_float_equal(gz_comparison_isovalue(300, range, &transfer), 20, 0.1);
	for (int i = 0; i < 3; i++)
		transfer.points[i].opacity = 0;
	assert_float_equal(gz_comparison_isovalue(300, range, &transfer), 100, 0);
}

static void long_frames_count_more_in_the_weighted_mean(void **state)
{
	(void)state;
	struct gz_comparison_frame frames[2][2] = { { { .frame_ms = 8 }, { .frame_ms = 8 } },
						    { { .frame_ms = 1 }, { .frame_ms = 3 } } };
	const struct gz_comparison comparison = { .frames = 2 };
	const struct gz_comparison_row rows[2] = { { .method = 0, .frames = frames[0] },
						   { .method = 1, .frames = frames[1] } };
	const struct gz_comparison_summary sum = gz_comparison_sum(&comparison, &rows[1]);
	assert_float_equal(sum.frame_ms.mean, 2, 1e-12);
	assert_float_equal(sum.frame_ms.perceived, 2.5, 1e-12); /* (1 + 9) / (1 + 3) */
	assert_float_equal(sum.fps, 500, 1e-9);
	assert_float_equal(sum.weighted_fps, 400, 1e-9);
	assert_float_equal(sum.ratio, 4, 1e-12);
}

/* Frame rates that the Dutch comparison prints beside its times. */
static void printed_times_are_those_of_the_papers(void **state)
{
	(void)state;
	static const double slicer_fps[5] = { 873.7775503, 296.7239205, 670.2255923, 504.0267353,
					      216.3011778 };
	json_t *sources = gz_published_times();
	const json_t *thesis = json_array_get(sources, 0), *dutch = json_array_get(sources, 1);
	assert_non_null(dutch);
	assert_float_equal(gz_published_ms(thesis, 1, "raycast", "none", 0), 0.007859, 1e-9);
	assert_float_equal(gz_published_ms(thesis, 0, "slices", "reflection", 512), 0.075668, 1e-9);
	assert_true(isnan(gz_published_ms(thesis, 0, "slices", "shadow", 512)));
	assert_true(isnan(gz_published_ms(thesis, 2, "raycast", "none", 0)));
	for (size_t i = 0; i < 5; i++)
		assert_float_equal(1000 / gz_published_ms(dutch, i, "slices", "none", 0),
				   slicer_fps[i], 0.001 * slicer_fps[i]);
	json_decref(sources);
}

static const struct gz_comparison_row *find_row(const struct gz_comparison *comparison,
						const char *technique, const char *effect,
						size_t method)
{
	for (size_t i = 0; i < comparison->row_count; i++) {
		const struct gz_comparison_row *row = &comparison->rows[i];
		if (strcmp(row->technique->name, technique) == 0 &&
		    strcmp(row->effect->name, effect) == 0 && row->method == method)
			return row;
	}
	return NULL;
}

static void check_rows(const struct gz_comparison *comparison)
{
	const struct gz_comparison_row *rays = find_row(comparison, "raycast", "none", 1);
	const struct gz_comparison_row *surface = find_row(comparison, "isosurface", "none", 0);
	assert_non_null(rays);
	assert_int_equal(rays->reference, GZ_REFERENCE_VOLUME);
	assert_true(rays->converged.psnr_db > 25);
	assert_true(rays->frames[1].frame_ms > 0 && rays->frames[1].samples > 0);
	assert_null(find_row(comparison, "slices", "none", 0)); /* no backend cpu */
	if (!surface)
		return; /* built without Embree */
	assert_int_equal(surface->reference, GZ_REFERENCE_SURFACE);
	/* A mesh and a ray cast of the same surface: two ways to one picture. */
	if (!(surface->converged.psnr_db > 24)) /* silhouettes, one ray a pixel */
		fail_msg("%g dB", surface->converged.psnr_db);
	assert_true(surface->prepare_ms > 0);
	assert_null(find_row(comparison, "raycast", "glass", 0)); /* it only has the sky */
	const struct gz_comparison_row *glass = find_row(comparison, "isosurface", "glass", 1);
	assert_non_null(glass);
	assert_int_equal(glass->reference, GZ_REFERENCE_VOXELS);
	const struct gz_comparison_row *hard = find_row(comparison, "isosurface", "shadow", 0);
	assert_non_null(hard);
	assert_int_equal(hard->reference, GZ_REFERENCE_VOXELS);
	if (!(hard->converged.psnr_db > 24))
		fail_msg("%g dB", hard->converged.psnr_db);
	const struct gz_comparison_row *drawing = find_row(comparison, "illustrate", "none", 1);
	assert_non_null(drawing);
	assert_int_equal(drawing->reference, GZ_REFERENCE_NONE);
	assert_true(isnan(drawing->converged.psnr_db) && drawing->standard.psnr_db > 10);
}

static void comparison_measures_each_technique_and_writes_its_folder(void **state)
{
	struct place *place = *state;
	char scene[128], path[256];
	static const char *const files[] = { "frames.csv", "techniques.json", "report.html",
					     "a-raycast-cpu-none.png", "a-raycast-cpu-shadow.png" };
	snprintf(scene, sizeof scene, "%s/a.scene", place->path);
	const char *const scenes[] = { scene };
	const struct gz_comparison_request request = {
		.scenes = scenes,
		.scene_count = 1,
		.methods = "uniform",
		.backends = "cpu",
		.techniques = "",
		.effects = "",
		.width = 48,
		.height = 40,
		.frames = 2,
		.warm_up = 1,
		.turn_deg = 10,
		.isovalue = NAN,
		.errors = true,
		.pictures = place->path,
		.program = "test",
		.commit = "unknown",
	};
	struct gz_comparison comparison;
	assert_int_equal(gz_comparison_run(&request, NULL, &comparison), GZ_OK);
	check_rows(&comparison);
	for (size_t i = 0; i < comparison.row_count; i++) {
		const struct gz_comparison_row *row = &comparison.rows[i];
		assert_int_equal(row->standard.flip == 0, row->method == 0);
	}
	assert_int_equal(gz_comparison_write(&comparison, place->path, NULL), GZ_OK);
	for (size_t i = 0; i < sizeof files / sizeof files[0]; i++) {
		snprintf(path, sizeof path, "%s/%s", place->path, files[i]);
		assert_int_equal(access(path, R_OK), 0);
	}
	struct gz_text page = { 0 };
	snprintf(path, sizeof path, "%s/report.html", place->path);
	assert_int_equal(gz_text_add_file(&page, path), GZ_OK);
	assert_non_null(strstr(page.bytes, "Schlemminger 2017"));
	assert_non_null(strstr(page.bytes, "raycast cpu, shadow"));
	assert_null(strstr(page.bytes, "{{"));
	gz_text_free(&page);
	gz_comparison_free(&comparison);
}

static void part_of_the_comparison_has_the_same_references(void **state)
{
	struct place *place = *state;
	char scene[128];
	snprintf(scene, sizeof scene, "%s/a.scene", place->path);
	const char *const scenes[] = { scene };
	const struct gz_comparison_request request = {
		.scenes = scenes,
		.scene_count = 1,
		.methods = "",
		.backends = "cpu",
		.techniques = "slices,raycast",
		.effects = "both,shadow",
		.width = 24,
		.height = 24,
		.frames = 1,
		.isovalue = NAN,
		.errors = true,
		.program = "test",
		.commit = "unknown",
	};
	struct gz_comparison comparison;
	assert_int_equal(gz_comparison_run(&request, NULL, &comparison), GZ_OK);
	assert_non_null(find_row(&comparison, "raycast", "shadow", 0));
	for (size_t i = 0; i < comparison.row_count; i++) {
		const struct gz_comparison_row *row = &comparison.rows[i];
		assert_int_equal(row->reference, GZ_REFERENCE_VOLUME);
		assert_true(row->effect == &gz_effects[2] || row->effect == &gz_effects[3]);
		assert_string_not_equal(row->technique->name, "isosurface");
	}
	gz_comparison_free(&comparison);
}

/* Of a path that stands still and of one that leaves the volume: what is seen costs rays' samples,
 * and only places of the path are seen. */
static void camera_path_gives_each_frame_its_camera(void **state)
{
	struct place *place = *state;
	char scene[128], path[128];
	snprintf(scene, sizeof scene, "%s/a.scene", place->path);
	snprintf(path, sizeof path, "%s/flight.txt", place->path);
	write_file(place, "flight.txt",
		   "0 -2 0 0 0 0\n0 -9 0 0 -10 0 # away from it\n0 -2 0 0 0 0\n");
	const char *const scenes[] = { scene };
	const struct gz_comparison_request request = {
		.scenes = scenes,
		.scene_count = 1,
		.methods = "",
		.backends = "cpu",
		.techniques = "raycast",
		.effects = "none",
		.width = 24,
		.height = 24,
		.warm_up = 2,
		.turn_deg = 10,
		.camera_path = path,
		.isovalue = NAN,
		.program = "test",
		.commit = "unknown",
	};
	struct gz_comparison comparison;
	assert_int_equal(gz_comparison_run(&request, NULL, &comparison), GZ_OK);
	assert_int_equal(comparison.frames, 3);
	const struct gz_comparison_row *row = find_row(&comparison, "raycast", "none", 0);
	assert_non_null(row);
	assert_true(row->frames[0].samples > 0);
	assert_int_equal(row->frames[1].samples, 0);
	assert_int_equal(row->frames[2].samples, row->frames[0].samples);
	assert_int_equal(gz_comparison_write(&comparison, place->path, NULL), GZ_OK);
	struct gz_text page = { 0 };
	snprintf(path, sizeof path, "%s/report.html", place->path);
	assert_int_equal(gz_text_add_file(&page, path), GZ_OK);
	assert_non_null(strstr(page.bytes, "flight.txt"));
	assert_null(strstr(page.bytes, "turns by"));
	gz_text_free(&page);
	gz_comparison_free(&comparison);
}

static void camera_path_that_is_too_short_or_missing_is_refused(void **state)
{
	struct place *place = *state;
	write_file(place, "flight.txt", "0 -2 0 0 0 0\n");
	place_run(place, (const char *[]) { "techniques", "a.scene", "--out", "s", "--frames=2",
					    "--camera-path=flight.txt", NULL });
	assert_said(place, 1, "flight.txt has 1 cameras, fewer than the 2 frames asked for");
	place_run(place, (const char *[]) { "techniques", "a.scene", "--out", "s",
					    "--camera-path=none.txt", NULL });
	assert_said(place, 1, "none.txt");
}

static void calls_that_are_not_understood_are_refused(void **state)
{
	struct place *place = *state;
	static const char *const calls[][6] = {
		{ "techniques", NULL },
		{ "techniques", "a.scene", NULL },
		{ "techniques", "a.scene", "--out", "s", "--backend=quantum", NULL },
		{ "techniques", "a.scene", "--out", "s", "--techniques=quantum", NULL },
		{ "techniques", "a.scene", "--out", "s", "--effects=none,fog", NULL },
		{ "techniques", "a.scene", "--out", "s", "--isovalue=nan", NULL },
		{ "techniques", "a.scene", "--out", "s", "--methods=fast", NULL },
		{ "techniques", "a.scene", "--out", "s", "--methods=table", NULL },
	};
	static const char *const said[] = {
		"no scene",
		"--out",
		"no technique has this backend",
		"there are raycast, isosurface",
		"'fog': no effect",
		"not a number",
		"mdc",
		"use gazebench run",
	};
	for (size_t i = 0; i < sizeof calls / sizeof calls[0]; i++) {
		place_run(place, calls[i]);
		assert_said(place, 2, said[i]);
	}
	place_run(place, (const char *[]) { "techniques", "b.scene", "--out", "s", NULL });
	assert_said(place, 1, "b.scene");
}

static void scene_with_meshes_is_refused(void **state)
{
	struct place *place = *state;
	write_file(place, "m.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
	write_file(place, "m.scene", "[object m]\nmesh = m.obj\ntechnique = isosurface\n");
	place_run(place, (const char *[]) { "techniques", "m.scene", "--out", "s", NULL });
	assert_said(place, 1, "a scene with meshes cannot be compared");
}

TEST_SUITE(comparison)
{
#define IN_A_PLACE(test) cmocka_unit_test_setup_teardown(test, set_up, place_remove)
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(every_setting_of_an_effect_is_a_key_of_some_technique),
		cmocka_unit_test(effect_sets_what_the_technique_has_and_none_turns_it_off),
		cmocka_unit_test(isovalue_is_the_scenes_or_where_half_of_the_opacity_begins),
		cmocka_unit_test(long_frames_count_more_in_the_weighted_mean),
		cmocka_unit_test(printed_times_are_those_of_the_papers),
		IN_A_PLACE(comparison_measures_each_technique_and_writes_its_folder),
		IN_A_PLACE(part_of_the_comparison_has_the_same_references),
		IN_A_PLACE(camera_path_gives_each_frame_its_camera),
		IN_A_PLACE(camera_path_that_is_too_short_or_missing_is_refused),
		IN_A_PLACE(calls_that_are_not_understood_are_refused),
		IN_A_PLACE(scene_with_meshes_is_refused),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
