#include "check.h"

#include "base/ini_text.h"

static void assert_set(const char *before, const char *section, const char *name, const char *value,
		       const char *expected)
{
	struct gz_text text = { 0 };
	gz_text_add(&text, "%s", before);
	gz_ini_text_set(&text, section, name, value);
	assert_false(text.failed);
	assert_string_equal(text.bytes, expected);
	gz_text_free(&text);
}

static void value_is_replaced_where_it_is_and_its_comment_stays(void **state)
{
	(void)state;
	assert_set("; a head\n[foveation]\n  method=mdc   ; for now\r\nblend_px = 4\n", "foveation",
		   "method", "acuity",
		   "; a head\n[foveation]\n  method=acuity   ; for now\r\nblend_px = 4\n");
	assert_set("[foveation]\nmethod : mdc", "foveation", "method", "ddc",
		   "[foveation]\nmethod : ddc");
	assert_set("[foveation]\ntable = a;b.txt\n", "foveation", "table", "c.txt",
		   "[foveation]\ntable = c.txt\n");
}

static void value_is_added_behind_the_last_of_its_section(void **state)
{
	(void)state;
	assert_set("[foveation]\nblend_px = 4\n\n# next\n[camera]\nfov_deg = 40\n", "foveation",
		   "method", "acuity",
		   "[foveation]\nblend_px = 4\nmethod = acuity\n\n# next\n[camera]\nfov_deg = "
		   "40\n");
	assert_set("[foveation]", "foveation", "method", "acuity",
		   "[foveation]\nmethod = acuity\n");
}

static void section_is_added_where_there_is_none(void **state)
{
	(void)state;
	assert_set("[camera]\nfov_deg = 40", "foveation", "method", "acuity",
		   "[camera]\nfov_deg = 40\n[foveation]\nmethod = acuity\n");
	assert_set("", "foveation", "method", "acuity", "[foveation]\nmethod = acuity\n");
}

static void same_name_in_a_comment_or_another_section_is_left_alone(void **state)
{
	(void)state;
	assert_set("[other]\nmethod = x\n[foveation]\n;method = mdc\n# method = ddc\n", "foveation",
		   "method", "acuity",
		   "[other]\nmethod = x\n[foveation]\nmethod = acuity\n;method = mdc\n# method = "
		   "ddc\n");
}

static void removed_key_takes_its_line_and_no_other(void **state)
{
	(void)state;
	struct gz_text text = { 0 };
	gz_text_add(&text, "[a]\nx = 1\ny = 2 ; gone\n[b]\ny = 3");
	assert_true(gz_ini_text_has(&text, "a", "y"));
	assert_true(gz_ini_text_remove(&text, "a", "y"));
	assert_string_equal(text.bytes, "[a]\nx = 1\n[b]\ny = 3");
	assert_false(gz_ini_text_has(&text, "a", "y"));
	assert_false(gz_ini_text_remove(&text, "a", "y"));
	assert_true(gz_ini_text_remove(&text, "b", "y"));
	assert_string_equal(text.bytes, "[a]\nx = 1\n[b]\n");
	gz_text_free(&text);
}

static void nothing_is_found_in_an_empty_text(void **state)
{
	(void)state;
	struct gz_text text = { 0 };
	assert_false(gz_ini_text_has(&text, "a", "x"));
	assert_false(gz_ini_text_remove(&text, "a", "x"));
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(value_is_replaced_where_it_is_and_its_comment_stays),
		cmocka_unit_test(value_is_added_behind_the_last_of_its_section),
		cmocka_unit_test(section_is_added_where_there_is_none),
		cmocka_unit_test(same_name_in_a_comment_or_another_section_is_left_alone),
		cmocka_unit_test(removed_key_takes_its_line_and_no_other),
		cmocka_unit_test(nothing_is_found_in_an_empty_text),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
