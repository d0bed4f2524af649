#include "suite.h"

#include "base/option.h"

#include <string.h>

#include "captured_log.h"
#include "option_sample.h"

enum { MOST_ARGUMENTS = 8 };

struct run {
	struct settings settings;
	bool given[SAMPLE_COUNT];
	struct gz_operands operands;
	struct captured_log captured;
};

/* Read @p arguments, which are NULL-terminated and lack argv[0]. */
static enum gz_result read_into(struct run *run, bool takes_operands, const char *const *arguments)
{
	char copies[MOST_ARGUMENTS][64];
	char *argv[MOST_ARGUMENTS + 1] = { (char[]) { "program" } };
	int argc = 1;
	*run = (struct run) { .operands = { .count = -1 } };
	captured_log_init(&run->captured, "*:debug");
	for (; arguments[argc - 1]; argc++) {
		assert_true(argc < MOST_ARGUMENTS);
		snprintf(copies[argc], sizeof copies[argc], "%s", arguments[argc - 1]);
		argv[argc] = copies[argc];
	}
	const struct gz_option_binding binding = sample_binding(&run->settings, run->given);
	enum gz_result result = gz_options_read_arguments(&binding, 1, argc, argv,
							  takes_operands ? &run->operands : NULL,
							  &run->captured.log);
	for (int i = 0; i < run->operands.count; i++) {
		for (int a = 1; a < argc; a++) {
			if (run->operands.items[i] ==
			    argv[a]) /* the copies of this call do not outlive it */
				run->operands.items[i] = arguments[a - 1];
		}
	}
	return result;
}

static void arguments_set_values_in_both_spellings(void **state)
{
	(void)state;
	struct run run;
	const char *const arguments[] = {
		"--publish.port", "2000", "--size=640x480", "--show-cross", "--camera.eye",
		"-1 -2 3",        NULL
	};
	assert_int_equal(read_into(&run, false, arguments), GZ_OK);
	assert_int_equal(run.settings.port, 2000);
	assert_int_equal(run.settings.size[0], 640);
	assert_int_equal(run.settings.size[1], 480);
	assert_true(run.settings.cross);
	assert_true(run.settings.eye[0] == -1 && run.settings.eye[2] == 3);
	for (int i = 0; i < SAMPLE_COUNT; i++)
		assert_int_equal(run.given[i], i == PORT || i == SIZE || i == CROSS || i == EYE);
}

static void arguments_bool_takes_a_value_only_by_equals(void **state)
{
	(void)state;
	struct run run;
	const char *const off[] = { "--show_cross=no", NULL };
	const char *const loose[] = { "--show_cross", "no", NULL };
	assert_int_equal(read_into(&run, false, off), GZ_OK);
	assert_false(run.settings.cross);
	assert_true(run.given[CROSS]);
	assert_int_equal(read_into(&run, true, loose), GZ_OK);
	assert_true(run.settings.cross);
	assert_int_equal(run.operands.count, 1);
	assert_string_equal(run.operands.items[0], "no");
}

static void arguments_positional_come_in_order(void **state)
{
	(void)state;
	struct run run;
	const char *const arguments[] = { "watch", "--publish.port", "2000", "-",
					  "--",    "--size",         NULL };
	assert_int_equal(read_into(&run, true, arguments), GZ_OK);
	assert_int_equal(run.operands.count, 3);
	assert_string_equal(run.operands.items[0], "watch");
	assert_string_equal(run.operands.items[1], "-");
	assert_string_equal(run.operands.items[2], "--size");
}

static void arguments_none_is_fine(void **state)
{
	(void)state;
	struct run run;
	const char *const arguments[] = { NULL };
	assert_int_equal(read_into(&run, true, arguments), GZ_OK);
	assert_int_equal(run.operands.count, 0);
}

static void arguments_take_the_letter_h_for_help(void **state)
{
	(void)state;
	static const struct gz_option options[] = { { "help", GZ_OPTION_BOOL, 0, .preset = "false",
						      .help = "print this" } };
	bool help = false;
	struct captured_log captured;
	char *const argv[] = { (char[]) { "program" }, (char[]) { "-h" } };
	const struct gz_option_binding binding = { .options = options,
						   .count = 1,
						   .target = &help };
	captured_log_init(&captured, NULL);
	assert_int_equal(gz_options_read_arguments(&binding, 1, 2, argv, NULL, &captured.log),
			 GZ_OK);
	assert_true(help);
}

static void arguments_refusals_name_option_and_remedy(void **state)
{
	(void)state;
	static const struct {
		const char *arguments[5], *message;
	} refusals[] = {
		{ { "--publish.port", "80" }, "--publish.port: 80 is outside 1024 to 65535" },
		{ { "--publish.port" }, "--publish.port: needs a value: TCP port (1024 to 65535)" },
		{ { "--publish.port", "--size" },
		  "--publish.port: needs a value: TCP port (1024 to 65535)" },
		{ { "--publish.port=" }, "--publish.port: 1 number expected, 0 given" },
		{ { "--publish.prt", "2000" },
		  "--publish.prt: unknown option; did you mean --publish.port?" },
		{ { "--port", "2000" }, "--port: unknown option; did you mean --publish.port?" },
		{ { "--velocity" }, "--velocity: unknown option; --help lists all options" },
		{ { "--sie" }, "--sie: unknown option; did you mean --size?" },
		{ { "--siv" }, "--siv: unknown option; --help lists all options" },
		{ { "--size", "1x1", "--size=2x2" }, "--size: given twice; keep one of the two" },
		{ { "--show-cross", "--show_cross" },
		  "--show_cross: given twice; keep one of the two" },
		{ { "-h" }, "-h: options begin with two dashes; --help lists all options" },
		{ { "-x" }, "-x: options begin with two dashes; --help lists all options" },
		{ { "file" }, "file: unexpected argument; --help lists all options" },
		{ { "--=5" }, "--: unknown option; --help lists all options" },
	};
	for (size_t i = 0; i < sizeof refusals / sizeof *refusals; i++) {
		struct run run;
		assert_int_equal(read_into(&run, false, refusals[i].arguments), GZ_ERR_INVAL);
		assert_string_equal(run.captured.last, refusals[i].message);
		assert_int_equal(run.captured.messages, 1);
	}
}

static void arguments_key_too_long_for_any_is_refused(void **state)
{
	(void)state;
	struct run run = { 0 };
	char key[300] = "--";
	char program[] = "program";
	char *argv[] = { program, key, NULL };
	memset(key + 2, 'k', sizeof key - 3);
	captured_log_init(&run.captured, "*:debug");
	const struct gz_option_binding binding = sample_binding(&run.settings, NULL);
	assert_int_equal(gz_options_read_arguments(&binding, 1, 2, argv, NULL, &run.captured.log),
			 GZ_ERR_INVAL);
	assert_int_equal(run.captured.messages, 1);
}

TEST_SUITE(option_arguments)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(arguments_set_values_in_both_spellings),
		cmocka_unit_test(arguments_bool_takes_a_value_only_by_equals),
		cmocka_unit_test(arguments_positional_come_in_order),
		cmocka_unit_test(arguments_none_is_fine),
		cmocka_unit_test(arguments_take_the_letter_h_for_help),
		cmocka_unit_test(arguments_refusals_name_option_and_remedy),
		cmocka_unit_test(arguments_key_too_long_for_any_is_refused),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
