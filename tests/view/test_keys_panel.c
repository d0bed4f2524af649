/* The list of keys is searched by words; progress is printed in a few. */
#include "suite.h"

#include "view/panels/file_dialogs.h"
#include "view/panels/keys_panel.h"

static const struct gz_keys_row row = { "files", "Ctrl+O", "open a scene or a volume", "Open...",
					"load import" };

static void row_is_found_by_words_of_help_keys_group_and_others(void **state)
{
	(void)state;
	assert_true(gz_keys_row_fits(&row, ""));
	assert_true(gz_keys_row_fits(&row, "  "));
	assert_true(gz_keys_row_fits(&row, "scene"));
	assert_true(gz_keys_row_fits(&row, "volume open"));
	assert_true(gz_keys_row_fits(&row, " SCE  ctrl FILE "));
	assert_true(gz_keys_row_fits(&row, "import"));
}

static void row_without_one_of_the_words_is_not_found(void **state)
{
	(void)state;
	assert_false(gz_keys_row_fits(&row, "save"));
	assert_false(gz_keys_row_fits(&row, "open save"));
	assert_false(gz_keys_row_fits(&row, "volumes"));
}

static void whole_words_fit_better_than_parts_and_keys_better_than_settings(void **state)
{
	(void)state;
	const struct gz_keys_row setting = { "Volume", NULL, "file: what is open", NULL, NULL };
	const struct gz_keys_row named = { "Files", NULL, "go back", "Remove the clip box", NULL };
	assert_true(gz_keys_row_fits(&row, "open") > gz_keys_row_fits(&row, "ope"));
	assert_true(gz_keys_row_fits(&row, "ope") > gz_keys_row_fits(&row, "pen"));
	assert_true(gz_keys_row_fits(&row, "open") > gz_keys_row_fits(&setting, "open"));
	assert_true(gz_keys_row_fits(&setting, "file") > 0);
	assert_true(gz_keys_row_fits(&named, "remove clip") > 0);
}

static void progress_text_has_the_time_left_once_it_can_be_told(void **state)
{
	(void)state;
	char text[64];
	gz_progress_text(0.25, 2, text, sizeof text);
	assert_string_equal(text, "25 %, 6 s left");
	gz_progress_text(0.01, 20, text, sizeof text);
	assert_string_equal(text, "1 %");
	gz_progress_text(0.5, 0.1, text, sizeof text);
	assert_string_equal(text, "50 %");
	gz_progress_text(-1, 20, text, sizeof text);
	assert_string_equal(text, "");
}

TEST_SUITE(keys_panel)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(row_is_found_by_words_of_help_keys_group_and_others),
		cmocka_unit_test(row_without_one_of_the_words_is_not_found),
		cmocka_unit_test(whole_words_fit_better_than_parts_and_keys_better_than_settings),
		cmocka_unit_test(progress_text_has_the_time_left_once_it_can_be_told),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
