/* INI files: items in order, and single keys changed. */
#include "suite.h"

#include <stdio.h>
#include <string.h>

#include "base/captured_log.h"
#include "base/ini.h"

static struct captured_log captured;

/* The items of a text, one per line. */
struct items_read {
	char text[1024];
	const char *refuse; /* a name that the callback refuses */
};

static enum gz_result note_item(void *user, const struct gz_ini_item *item)
{
	struct items_read *items = user;
	size_t used = strlen(items->text);
	if (!item->name)
		snprintf(items->text + used, sizeof items->text - used, "%d [%s]\n", item->line,
			 item->section);
	else
		snprintf(items->text + used, sizeof items->text - used, "%d [%s] %s=%s\n",
			 item->line, item->section, item->name, item->value);
	bool refused = items->refuse && item->name && strcmp(item->name, items->refuse) == 0;
	return refused ? GZ_ERR_UNSUPPORTED : GZ_OK;
}

static enum gz_result read_text(const char *text, struct items_read *items)
{
	captured_log_init(&captured, "*:debug");
	return gz_ini_read_text("list.ini", text, strlen(text), note_item, items, &captured.log);
}

static void sections_and_values_come_in_order_with_their_lines(void **state)
{
	(void)state;
	struct items_read items = { .refuse = NULL };
	assert_int_equal(read_text("; a list\n[trial b]\n\n  x = 1 ; one\n[trial a] ; again\ny=\n"
				   "[trial b]\nx = 2\n",
				   &items),
			 GZ_OK);
	assert_string_equal(items.text,
			    "2 [trial b]\n4 [trial b] x=1\n5 [trial a]\n6 [trial a] y=\n"
			    "7 [trial b]\n8 [trial b] x=2\n");
	assert_int_equal(captured.messages, 0);
}

static void section_without_values_is_an_item_too(void **state)
{
	(void)state;
	struct items_read items = { .refuse = NULL };
	assert_int_equal(read_text("[one]\n[two]", &items), GZ_OK);
	assert_string_equal(items.text, "1 [one]\n2 [two]\n");
}

static void refused_item_ends_the_reading_with_the_callbacks_result(void **state)
{
	(void)state;
	struct items_read items = { .refuse = "x" };
	assert_int_equal(read_text("[one]\nx = 1\ny = 2\n[two]\n", &items), GZ_ERR_UNSUPPORTED);
	assert_string_equal(items.text, "1 [one]\n2 [one] x=1\n");
	assert_int_equal(captured.messages, 0);
}

static void damaged_lines_are_refused_with_their_number(void **state)
{
	(void)state;
	static const struct {
		const char *text, *message;
	} cases[] = {
		{ "x = 1\n",
		  "list.ini:1: value before the first section; write [section] above it" },
		{ "[a]\n[b\n", "list.ini:2: section without ']'; write [name]" },
		{ "[a] b\n", "list.ini:1: text after ']'; put it on a line of its own" },
		{ "[a]\nword\n[b]\n",
		  "list.ini:2: expected \"name = value\"; a comment begins with ;" },
	};
	for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
		struct items_read items = { .refuse = NULL };
		assert_int_equal(read_text(cases[i].text, &items), GZ_ERR_FORMAT);
		assert_int_equal(captured.messages, 1);
		assert_string_equal(captured.last, cases[i].message);
	}
}

static void missing_file_is_not_found(void **state)
{
	(void)state;
	struct items_read items = { .refuse = NULL };
	captured_log_init(&captured, "*:debug");
	assert_int_equal(gz_ini_read_file("/nowhere/list.ini", note_item, &items, &captured.log),
			 GZ_ERR_NOT_FOUND);
	assert_string_equal(captured.last, "/nowhere/list.ini: no such file; check the path");
}

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

TEST_SUITE(ini)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(sections_and_values_come_in_order_with_their_lines),
		cmocka_unit_test(section_without_values_is_an_item_too),
		cmocka_unit_test(refused_item_ends_the_reading_with_the_callbacks_result),
		cmocka_unit_test(damaged_lines_are_refused_with_their_number),
		cmocka_unit_test(missing_file_is_not_found),
		cmocka_unit_test(value_is_replaced_where_it_is_and_its_comment_stays),
		cmocka_unit_test(value_is_added_behind_the_last_of_its_section),
		cmocka_unit_test(section_is_added_where_there_is_none),
		cmocka_unit_test(same_name_in_a_comment_or_another_section_is_left_alone),
		cmocka_unit_test(removed_key_takes_its_line_and_no_other),
		cmocka_unit_test(nothing_is_found_in_an_empty_text),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
