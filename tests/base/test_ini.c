/* INI files as lists of sections. */
#include "check.h"

#include <stdio.h>
#include <string.h>

#include "base/captured_log.h"
#include "base/ini.h"

static struct captured_log captured;

/* The items of a text, one a line. */
struct told {
	char text[1024];
	const char *refuse; /* a name that is not taken */
};

static enum gz_result take(void *user, const struct gz_ini_item *item)
{
	struct told *told = user;
	size_t used = strlen(told->text);
	if (!item->name)
		snprintf(told->text + used, sizeof told->text - used, "%d [%s]\n", item->line,
			 item->section);
	else
		snprintf(told->text + used, sizeof told->text - used, "%d [%s] %s=%s\n", item->line,
			 item->section, item->name, item->value);
	bool refused = told->refuse && item->name && strcmp(item->name, told->refuse) == 0;
	return refused ? GZ_ERR_UNSUPPORTED : GZ_OK;
}

static enum gz_result read_text(const char *text, struct told *told)
{
	captured_log_init(&captured, "*:debug");
	return gz_ini_read_text("list.ini", text, strlen(text), take, told, &captured.log);
}

static void sections_and_values_come_in_order_with_their_lines(void **state)
{
	(void)state;
	struct told told = { .refuse = NULL };
	assert_int_equal(read_text("; a list\n[trial b]\n\n  x = 1 ; one\n[trial a] ; again\ny=\n"
				   "[trial b]\nx = 2\n",
				   &told),
			 GZ_OK);
	assert_string_equal(told.text, "2 [trial b]\n4 [trial b] x=1\n5 [trial a]\n6 [trial a] y=\n"
				       "7 [trial b]\n8 [trial b] x=2\n");
	assert_int_equal(captured.messages, 0);
}

static void section_without_values_is_told_too(void **state)
{
	(void)state;
	struct told told = { .refuse = NULL };
	assert_int_equal(read_text("[one]\n[two]", &told), GZ_OK);
	assert_string_equal(told.text, "1 [one]\n2 [two]\n");
}

static void refused_item_ends_the_reading_with_the_takers_word(void **state)
{
	(void)state;
	struct told told = { .refuse = "x" };
	assert_int_equal(read_text("[one]\nx = 1\ny = 2\n[two]\n", &told), GZ_ERR_UNSUPPORTED);
	assert_string_equal(told.text, "1 [one]\n2 [one] x=1\n");
	assert_int_equal(captured.messages, 0);
}

static void damaged_lines_are_refused_with_their_number(void **state)
{
	(void)state;
	static const struct {
		const char *text, *message;
	} cases[] = {
		{ "x = 1\n", "list.ini:1: a value before the first section; begin with [section]" },
		{ "[a]\n[b\n", "list.ini:2: section without ']'; write [name]" },
		{ "[a] b\n", "list.ini:1: text after ']'; put it on a line of its own" },
		{ "[a]\nword\n[b]\n",
		  "list.ini:2: no \"name = value\" here; write one, or begin a comment with ;" },
	};
	for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
		struct told told = { .refuse = NULL };
		assert_int_equal(read_text(cases[i].text, &told), GZ_ERR_FORMAT);
		assert_int_equal(captured.messages, 1);
		assert_string_equal(captured.last, cases[i].message);
	}
}

static void missing_file_is_not_found(void **state)
{
	(void)state;
	struct told told = { .refuse = NULL };
	captured_log_init(&captured, "*:debug");
	assert_int_equal(gz_ini_read_file("/nowhere/list.ini", take, &told, &captured.log),
			 GZ_ERR_NOT_FOUND);
	assert_string_equal(captured.last, "/nowhere/list.ini: no such file; check the path");
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(sections_and_values_come_in_order_with_their_lines),
		cmocka_unit_test(section_without_values_is_told_too),
		cmocka_unit_test(refused_item_ends_the_reading_with_the_takers_word),
		cmocka_unit_test(damaged_lines_are_refused_with_their_number),
		cmocka_unit_test(missing_file_is_not_found),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
