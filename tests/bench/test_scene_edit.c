#include "suite.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "bench/report/advice.h"

static void variant_sets_each_option_in_its_section(void **state)
{
	(void)state;
	struct gz_text text = { 0 };
	const struct gz_study_variant variant = {
		.text = "acuity:acuity_slope=0.033:levels=yes",
		.method = "acuity",
	};
	gz_text_add(&text, "[render]\nlevels = no ; slow\n");
	assert_int_equal(gz_scene_text_set_variant(&text, &variant, NULL), GZ_OK);
	assert_string_equal(text.bytes, "[render]\nlevels = yes ; slow\n[foveation]\n"
					"method = acuity\nacuity_slope = 0.033\n");
	gz_text_free(&text);
}

static void variant_with_an_option_of_no_scene_is_refused(void **state)
{
	(void)state;
	struct gz_text text = { 0 };
	const struct gz_study_variant unknown = { .text = "acuity:no_such=1", .method = "acuity" };
	const struct gz_study_variant bare = { .text = "acuity:levels", .method = "acuity" };
	assert_int_equal(gz_scene_text_set_variant(&text, &unknown, NULL), GZ_ERR_INVAL);
	assert_int_equal(gz_scene_text_set_variant(&text, &bare, NULL), GZ_ERR_INVAL);
	gz_text_free(&text);
}

struct folder {
	char path[64], scene[96], copy[96], far_copy[96], transfer[96], far[96];
};

static void write_text(const char *path, const char *text)
{
	FILE *file = fopen(path, "w");
	assert_non_null(file);
	fputs(text, file);
	fclose(file);
}

static int make_folder(void **state)
{
	static struct folder folder;
	snprintf(folder.path, sizeof folder.path, "/tmp/gazebench-test-XXXXXX");
	if (!mkdtemp(folder.path))
		return 1;
	snprintf(folder.scene, sizeof folder.scene, "%s/a.scene", folder.path);
	snprintf(folder.copy, sizeof folder.copy, "%s/b.scene", folder.path);
	snprintf(folder.transfer, sizeof folder.transfer, "%s/a.tf", folder.path);
	snprintf(folder.far, sizeof folder.far, "%s/far.scene", folder.path);
	snprintf(folder.far_copy, sizeof folder.far_copy, "/tmp/gazebench-test-%d.scene",
		 (int)getpid());
	write_text(folder.transfer, "0 0 0 0 0\n1 1 1 1 1\n");
	write_text(folder.scene, "[volume]\nprocedural = shells\n[transfer]\nfile = a.tf\n");
	*state = &folder;
	return 0;
}

static int remove_files(void **state)
{
	const struct folder *folder = *state;
	unlink(folder->scene);
	unlink(folder->copy);
	unlink(folder->transfer);
	unlink(folder->far_copy);
	return rmdir(folder->path);
}

static const struct gz_study_variant acuity = { .text = "acuity", .method = "acuity" };

static void copy_has_the_settings_and_the_scene_stays(void **state)
{
	const struct folder *folder = *state;
	struct gz_text text = { 0 };
	assert_int_equal(gz_scene_copy_with(folder->scene, folder->copy, &acuity, NULL), GZ_OK);
	assert_int_equal(gz_text_add_file(&text, folder->copy), GZ_OK);
	assert_string_equal(text.bytes, "[volume]\nprocedural = shells\n[transfer]\nfile = a.tf\n"
					"[foveation]\nmethod = acuity\n");
	gz_text_free(&text);
	assert_int_equal(gz_text_add_file(&text, folder->scene), GZ_OK);
	assert_null(strstr(text.bytes, "foveation"));
	gz_text_free(&text);
}

static void copy_over_a_file_is_refused(void **state)
{
	const struct folder *folder = *state;
	assert_int_equal(gz_scene_copy_with(folder->scene, folder->scene, &acuity, NULL),
			 GZ_ERR_BUSY);
}

static void copy_elsewhere_finds_the_files_of_the_scene(void **state)
{
	const struct folder *folder = *state;
	struct gz_text text = { 0 };
	char expected[512];
	const char *transfer = folder->transfer + strlen("/tmp/"); /* below the copy's folder */
	write_text(folder->scene,
		   "; of a study\n[volume]\nprocedural = shells\n\n[transfer]\n"
		   "file = a.tf   ; beside\n[object b]\ntechnique = isosurface\nmesh = no.ply\n"
		   "[object c]\n"
		   "technique = isosurface\nmesh = a.tf\n");
	assert_int_equal(gz_scene_copy_with(folder->scene, folder->far_copy, &acuity, NULL), GZ_OK);
	assert_int_equal(gz_text_add_file(&text, folder->far_copy), GZ_OK);
	snprintf(expected, sizeof expected,
		 "; of a study\n[volume]\nprocedural = shells\n\n[transfer]\n"
		 "file = %s   ; beside\n[object b]\ntechnique = isosurface\nmesh = no.ply\n"
		 "[object c]\n"
		 "technique = isosurface\nmesh = %s\n[foveation]\nmethod = acuity\n",
		 transfer, transfer);
	assert_string_equal(text.bytes, expected);
	gz_text_free(&text);
}

static void copy_of_no_scene_or_a_bad_one_is_refused(void **state)
{
	const struct folder *folder = *state;
	const struct gz_study_variant bad = { .text = "acuity:acuity_slope=nan",
					      .method = "acuity" };
	assert_int_equal(gz_scene_copy_with("/no/such.scene", folder->copy, &acuity, NULL),
			 GZ_ERR_NOT_FOUND);
	assert_int_equal(gz_scene_copy_with(folder->scene, folder->copy, &bad, NULL),
			 GZ_ERR_FORMAT);
	assert_int_not_equal(access(folder->copy, F_OK), 0);
}

TEST_SUITE(scene_edit)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(variant_sets_each_option_in_its_section),
		cmocka_unit_test(variant_with_an_option_of_no_scene_is_refused),
		cmocka_unit_test_setup_teardown(copy_has_the_settings_and_the_scene_stays,
						make_folder, remove_files),
		cmocka_unit_test_setup_teardown(copy_over_a_file_is_refused, make_folder,
						remove_files),
		cmocka_unit_test_setup_teardown(copy_elsewhere_finds_the_files_of_the_scene,
						make_folder, remove_files),
		cmocka_unit_test_setup_teardown(copy_of_no_scene_or_a_bad_one_is_refused,
						make_folder, remove_files),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
