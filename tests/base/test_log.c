#include "suite.h"

#include "base/log.h"

#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "captured_log.h"

#define GZ_LOG_MODULE "replay"

static void log_without_rules_passes_info_and_above(void **state)
{
	(void)state;
	struct captured_log captured;
	unsetenv("GZ_LOG");
	captured_log_init(&captured, NULL);
	assert_false(gz_log_wants(&captured.log, GZ_LOG_DEBUG, "any"));
	assert_true(gz_log_wants(&captured.log, GZ_LOG_INFO, "any"));
	assert_true(gz_log_wants(&captured.log, GZ_LOG_ERROR, "any"));
}

static void log_without_rules_takes_the_environment(void **state)
{
	(void)state;
	struct captured_log captured;
	setenv("GZ_LOG", "*:error", 1);
	captured_log_init(&captured, NULL);
	unsetenv("GZ_LOG");
	assert_false(gz_log_wants(&captured.log, GZ_LOG_WARN, "any"));
	assert_true(gz_log_wants(&captured.log, GZ_LOG_ERROR, "any"));
}

static void log_first_rule_that_fits_counts(void **state)
{
	(void)state;
	struct captured_log captured;
	captured_log_init(&captured, "replay:debug,*:warn,replay:error");
	assert_true(gz_log_wants(&captured.log, GZ_LOG_DEBUG, "replay"));
	assert_false(gz_log_wants(&captured.log, GZ_LOG_INFO, "sim"));
	assert_true(gz_log_wants(&captured.log, GZ_LOG_WARN, "sim"));
}

static void log_rule_names_match_whole(void **state)
{
	(void)state;
	struct captured_log captured;
	captured_log_init(&captured, "rep:debug,replayer:debug,*:error");
	assert_false(gz_log_wants(&captured.log, GZ_LOG_WARN, "replay"));
}

static void log_level_alone_is_for_all_modules(void **state)
{
	(void)state;
	struct captured_log captured;
	captured_log_init(&captured, "replay:error,debug");
	assert_true(gz_log_wants(&captured.log, GZ_LOG_DEBUG, "any"));
	assert_false(gz_log_wants(&captured.log, GZ_LOG_WARN, "replay"));
}

static void log_unreadable_rules_are_ignored(void **state)
{
	(void)state;
	struct captured_log captured;
	const char *const rules[] = { "", ",,,", "noise", "replay:", ":", "replay:loud", "*" };
	for (size_t i = 0; i < sizeof rules / sizeof *rules; i++) {
		captured_log_init(&captured, rules[i]);
		assert_false(gz_log_wants(&captured.log, GZ_LOG_DEBUG, "replay"));
		assert_true(gz_log_wants(&captured.log, GZ_LOG_INFO, "replay"));
	}
}

static void log_rules_longer_than_their_room_are_cut(void **state)
{
	(void)state;
	struct captured_log captured;
	char rules[2 * GZ_LOG_RULES_SIZE];
	memset(rules, 'x', sizeof rules);
	rules[sizeof rules - 1] = '\0';
	captured_log_init(&captured, rules);
	assert_int_equal(strlen(captured.log.rules), GZ_LOG_RULES_SIZE - 1);
	assert_true(gz_log_wants(&captured.log, GZ_LOG_INFO, "any"));
}

static void log_message_arrives_formatted_once(void **state)
{
	(void)state;
	struct captured_log captured;
	captured_log_init(&captured, "*:info");
	gz_warn(&captured.log, "short line: %d of %d fields", 3, 7);
	gz_debug(&captured.log, "not wanted");
	assert_int_equal(captured.messages, 1);
	assert_int_equal(captured.level, GZ_LOG_WARN);
	assert_string_equal(captured.module, "replay");
	assert_string_equal(captured.last, "short line: 3 of 7 fields");
}

static void log_refused_level_does_not_format(void **state)
{
	(void)state;
	struct captured_log captured;
	int evaluated = 0;
	captured_log_init(&captured, "*:error");
	gz_info(&captured.log, "%d", ++evaluated);
	assert_int_equal(evaluated, 0);
	gz_err(&captured.log, "%d", ++evaluated);
	assert_int_equal(evaluated, 1);
}

static void log_null_is_silent(void **state)
{
	(void)state;
	gz_err(NULL, "nobody hears %d", 1);
	gz_log_write(NULL, GZ_LOG_ERROR, "any", "nobody hears");
	assert_false(gz_log_wants(NULL, GZ_LOG_ERROR, "any"));
}

static void log_long_message_is_cut_not_overrun(void **state)
{
	(void)state;
	struct captured_log captured;
	char text[5000];
	memset(text, 'x', sizeof text);
	text[sizeof text - 1] = '\0';
	captured_log_init(&captured, "*:info");
	gz_err(&captured.log, "%s", text);
	assert_int_equal(captured.messages, 1);
	assert_in_range(strlen(captured.last), 512, sizeof captured.last - 1);
}

static void log_message_holds_no_commands_for_a_terminal(void **state)
{
	(void)state;
	struct captured_log captured;
	captured_log_init(&captured, "*:info");
	gz_err(&captured.log, "%s: unknown word", "\033[31mred\033]0;title\a\x89PNG\nforged");
	assert_string_equal(captured.last, "?[31mred?]0;title??PNG?forged: unknown word");
}

static void log_to_stderr_writes_one_line(void **state)
{
	(void)state;
	int ends[2];
	char line[256] = "";
	assert_int_equal(pipe(ends), 0);
	int saved = dup(STDERR_FILENO);
	dup2(ends[1], STDERR_FILENO);
	gz_log_to_stderr(NULL, GZ_LOG_ERROR, "replay", "no such file");
	dup2(saved, STDERR_FILENO);
	close(saved);
	close(ends[1]);
	ssize_t got = read(ends[0], line, sizeof line - 1);
	close(ends[0]);
	assert_true(got > 0);
	assert_string_equal(line, "gazecast: error: replay: no such file\n");
}

static void ratelimit_passes_the_first_and_counts_the_rest(void **state)
{
	(void)state;
	struct gz_ratelimit limit = { 0 };
	uint64_t dropped = 99;
	assert_true(gz_ratelimit_pass(&limit, 1000, 100, &dropped));
	assert_int_equal(dropped, 0);
	dropped = 99;
	for (int64_t t = 1000; t < 1100; t += 25)
		assert_false(gz_ratelimit_pass(&limit, t, 100, &dropped));
	assert_int_equal(dropped, 99);
	assert_true(gz_ratelimit_pass(&limit, 1100, 100, &dropped));
	assert_int_equal(dropped, 4);
}

TEST_SUITE(log)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(log_without_rules_passes_info_and_above),
		cmocka_unit_test(log_without_rules_takes_the_environment),
		cmocka_unit_test(log_first_rule_that_fits_counts),
		cmocka_unit_test(log_rule_names_match_whole),
		cmocka_unit_test(log_level_alone_is_for_all_modules),
		cmocka_unit_test(log_unreadable_rules_are_ignored),
		cmocka_unit_test(log_rules_longer_than_their_room_are_cut),
		cmocka_unit_test(log_message_arrives_formatted_once),
		cmocka_unit_test(log_refused_level_does_not_format),
		cmocka_unit_test(log_null_is_silent),
		cmocka_unit_test(log_long_message_is_cut_not_overrun),
		cmocka_unit_test(log_message_holds_no_commands_for_a_terminal),
		cmocka_unit_test(log_to_stderr_writes_one_line),
		cmocka_unit_test(ratelimit_passes_the_first_and_counts_the_rest),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
