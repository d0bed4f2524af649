#include "suite.h"

#include "base/option.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "option_sample.h"

static void preset_sets_all_that_have_one(void **state)
{
	(void)state;
	struct settings s = { .name = "kept" };
	const struct gz_option_binding binding = sample_binding(&s, NULL);
	assert_int_equal(gz_options_preset(&binding), GZ_OK);
	assert_true(s.smoothing_hz == 1.5);
	assert_true(s.eye[0] == 0 && s.eye[1] == 0 && s.eye[2] == 1);
	assert_int_equal(s.port, 5570);
	assert_int_equal(s.size[0], 1920);
	assert_int_equal(s.size[1], 1080);
	assert_int_equal(s.method, 0);
	assert_false(s.cross);
	assert_string_equal(s.name, "kept");
}

static void preset_that_does_not_parse_is_reported(void **state)
{
	(void)state;
	int value = 7;
	const struct gz_option wrong = {
		.key = "a.b", .type = GZ_OPTION_INT, .max = 3, .preset = "4", .help = ""
	};
	const struct gz_option_binding binding = { .options = &wrong,
						   .count = 1,
						   .target = &value };
	assert_int_equal(gz_options_preset(&binding), GZ_ERR_INVAL);
	assert_int_equal(value, 7);
}

struct refusal {
	int option;
	const char *text, *message;
};

static const struct refusal refusals[] = {
	{ SMOOTHING, "", "1 number expected, 0 given" },
	{ SMOOTHING, "nan", "nan is not a number; allowed: 0.1 to 100" },
	{ SMOOTHING, "inf", "inf is not a number; allowed: 0.1 to 100" },
	{ SMOOTHING, "-INFINITY", "-INFINITY is not a number; allowed: 0.1 to 100" },
	{ SMOOTHING, "1e999", "1e999 is not a number; allowed: 0.1 to 100" },
	{ SMOOTHING, "0x10", "0x10 is not a number; allowed: 0.1 to 100" },
	{ SMOOTHING, "12abc", "12abc is not a number; allowed: 0.1 to 100" },
	{ SMOOTHING, "1,5", "1,5 is not a number; allowed: 0.1 to 100" },
	{ SMOOTHING, "500", "500 is outside 0.1 to 100" },
	{ SMOOTHING, "0.09999", "0.09999 is outside 0.1 to 100" },
	{ SMOOTHING, "1 2", "unexpected \"2\" after 1 number" },
	{ EYE, "1 2", "3 numbers expected, 2 given; separate them by blanks" },
	{ EYE, "1 2 3 4", "unexpected \"4\" after 3 numbers" },
	{ EYE, "1 nan 3", "nan is not a number; allowed: -10 to 10" },
	{ PORT, "80", "80 is outside 1024 to 65535" },
	{ PORT, "2000.5", "2000.5 is not a whole number; allowed: 1024 to 65535" },
	{ PORT, "2e3", "2e3 is not a whole number; allowed: 1024 to 65535" },
	{ PORT, "99999999999999999999", "99999999999999999999 is outside 1024 to 65535" },
	{ PORT, "4294968320", "4294968320 is outside 1024 to 65535" }, /* 1024 modulo 2^32 */
	{ SIZE, "1920", "1920 is not a size; write WIDTHxHEIGHT, as in 1920x1080" },
	{ SIZE, "x1080", "x1080 is not a size; write WIDTHxHEIGHT, as in 1920x1080" },
	{ SIZE, "1920x", "1920x is not a size; write WIDTHxHEIGHT, as in 1920x1080" },
	{ SIZE, "1920 x 1080", "1920  is not a whole number; allowed: 1 to 16384 for each side" },
	{ SIZE, "0x1080", "0 is outside 1 to 16384 for each side" },
	{ SIZE, "1920x1080x3", "1080x3 is not a whole number; allowed: 1 to 16384 for each side" },
	{ SIZE, "-1x1", "-1 is outside 1 to 16384 for each side" },
	{ METHOD, "Acuity", "Acuity is not standard, mdc, ddc or acuity" },
	{ METHOD, "", "an empty value is not standard, mdc, ddc or acuity" },
	{ CROSS, "maybe", "maybe is not true or false" },
	{ CROSS, "", "an empty value is not true or false" },
	{ NAME, "0123456789abcdef", "too long: 16 bytes, at most 15 are allowed" },
	{ NAME, "two\nlines", "the value contains a line break; remove it" },
};

static void parse_refusal_says_why_and_changes_nothing(void **state)
{
	(void)state;
	for (size_t i = 0; i < sizeof refusals / sizeof *refusals; i++) {
		const struct refusal *r = &refusals[i];
		struct settings s, before;
		char message[256] = "";
		memset(&s, 0x5a, sizeof s);
		before = s;
		assert_int_equal(gz_option_parse(&sample_options[r->option], r->text, &s, message,
						 sizeof message),
				 GZ_ERR_INVAL);
		assert_string_equal(message, r->message);
		assert_memory_equal(&s, &before, sizeof s);
	}
}

static void parse_refusal_without_a_message_buffer_is_safe(void **state)
{
	(void)state;
	for (size_t i = 0; i < sizeof refusals / sizeof *refusals; i++) {
		struct settings s = { 0 };
		char tiny[4] = "";
		const struct gz_option *option = &sample_options[refusals[i].option];
		assert_int_equal(gz_option_parse(option, refusals[i].text, &s, NULL, 0),
				 GZ_ERR_INVAL);
		assert_int_equal(gz_option_parse(option, refusals[i].text, &s, tiny, sizeof tiny),
				 GZ_ERR_INVAL);
		assert_int_equal(strlen(tiny), 3);
	}
}

static void parse_number_too_long_for_one_is_refused(void **state)
{
	(void)state;
	struct settings s = { .port = 1 };
	char zeros[200];
	memset(zeros, '0', sizeof zeros);
	memcpy(zeros + sizeof zeros - 5, "2000", 5);
	assert_int_equal(gz_option_parse(&sample_options[PORT], zeros, &s, NULL, 0), GZ_ERR_INVAL);
	assert_int_equal(s.port, 1);
}

static void parse_takes_the_ends_of_the_range(void **state)
{
	(void)state;
	struct settings s = { 0 };
	assert_int_equal(gz_option_parse(&sample_options[SMOOTHING], "0.1", &s, NULL, 0), GZ_OK);
	assert_true(s.smoothing_hz == 0.1);
	assert_int_equal(gz_option_parse(&sample_options[SMOOTHING], "1e2", &s, NULL, 0), GZ_OK);
	assert_true(s.smoothing_hz == 100);
	assert_int_equal(gz_option_parse(&sample_options[PORT], "65535", &s, NULL, 0), GZ_OK);
	assert_int_equal(s.port, 65535);
	assert_int_equal(gz_option_parse(&sample_options[SIZE], "16384x1", &s, NULL, 0), GZ_OK);
	assert_int_equal(s.size[0], 16384);
	assert_int_equal(s.size[1], 1);
	assert_int_equal(gz_option_parse(&sample_options[EYE], "\t-10  +2.5 10 ", &s, NULL, 0),
			 GZ_OK);
	assert_true(s.eye[0] == -10 && s.eye[1] == 2.5 && s.eye[2] == 10);
	assert_int_equal(gz_option_parse(&sample_options[NAME], "123456789abcdef", &s, NULL, 0),
			 GZ_OK);
	assert_string_equal(s.name, "123456789abcdef");
	assert_int_equal(gz_option_parse(&sample_options[NAME], "", &s, NULL, 0), GZ_OK);
	assert_string_equal(s.name, "");
}

static void parse_bool_reads_every_word(void **state)
{
	(void)state;
	const char *const words[] = { "true", "false", "yes", "no", "on", "off", "1", "0" };
	for (size_t i = 0; i < sizeof words / sizeof *words; i++) {
		struct settings s = { .cross = i % 2 == 1 };
		assert_int_equal(gz_option_parse(&sample_options[CROSS], words[i], &s, NULL, 0),
				 GZ_OK);
		assert_int_equal(s.cross, i % 2 == 0);
	}
}

static void parse_choice_gives_its_index(void **state)
{
	(void)state;
	for (int i = 0; sample_methods[i]; i++) {
		struct settings s = { .method = -1 };
		assert_int_equal(
			gz_option_parse(&sample_options[METHOD], sample_methods[i], &s, NULL, 0),
			GZ_OK);
		assert_int_equal(s.method, i);
	}
}

static void format_reads_back_to_the_same_value(void **state)
{
	(void)state;
	const double values[] = { 0.1, 1.0 / 3, 99.99999999999999, 12.5, nextafter(1, 2), 100 };
	for (size_t i = 0; i < sizeof values / sizeof *values; i++) {
		const struct settings s = { .smoothing_hz = values[i],
					    .eye = { -values[i] / 10, 0, values[i] / 10 },
					    .port = 1024 + (int)i,
					    .size = { 1 + (int)i, 16384 },
					    .method = (int)i % 4,
					    .cross = i % 2,
					    .name = "a b = c" };
		struct settings back = { 0 };
		for (size_t o = 0; o < SAMPLE_COUNT; o++) {
			char text[128];
			assert_int_equal(
				gz_option_format(&sample_options[o], &s, text, sizeof text), GZ_OK);
			assert_int_equal(gz_option_parse(&sample_options[o], text, &back, NULL, 0),
					 GZ_OK);
		}
		assert_true(back.smoothing_hz == s.smoothing_hz);
		assert_memory_equal(back.eye, s.eye, sizeof s.eye);
		assert_int_equal(back.port, s.port);
		assert_memory_equal(back.size, s.size, sizeof s.size);
		assert_int_equal(back.method, s.method);
		assert_int_equal(back.cross, s.cross);
		assert_string_equal(back.name, s.name);
	}
}

static void format_is_as_short_as_it_can_be(void **state)
{
	(void)state;
	const struct settings s = { .smoothing_hz = 0.1, .size = { 640, 480 } };
	char text[32];
	assert_int_equal(gz_option_format(&sample_options[SMOOTHING], &s, text, sizeof text),
			 GZ_OK);
	assert_string_equal(text, "0.1");
	assert_int_equal(gz_option_format(&sample_options[SIZE], &s, text, sizeof text), GZ_OK);
	assert_string_equal(text, "640x480");
}

static void format_into_too_little_room_is_full_and_empty(void **state)
{
	(void)state;
	const struct settings s = { .port = 65535 };
	char text[6] = "xxxxx";
	assert_int_equal(gz_option_format(&sample_options[PORT], &s, text, 5), GZ_ERR_FULL);
	assert_string_equal(text, "");
	assert_int_equal(gz_option_format(&sample_options[PORT], &s, text, 6), GZ_OK);
	assert_string_equal(text, "65535");
	assert_int_equal(gz_option_format(&sample_options[PORT], &s, text, 0), GZ_ERR_FULL);
}

static void find_names_option_and_binding(void **state)
{
	(void)state;
	struct settings s = { 0 };
	const struct gz_option other = { .key = "other.key", .type = GZ_OPTION_BOOL, .help = "" };
	const struct gz_option_binding bindings[] = {
		{ .options = &other, .count = 1, .target = &s },
		sample_binding(&s, NULL),
	};
	size_t at = 9;
	assert_ptr_equal(gz_options_find(bindings, 2, "publish.port", &at), &sample_options[PORT]);
	assert_int_equal(at, 1);
	assert_ptr_equal(gz_options_find(bindings, 2, "other.key", NULL), &other);
	at = 9;
	assert_null(gz_options_find(bindings, 2, "publish", &at));
	assert_int_equal(at, 9);
}

static char *printed(void print(const struct gz_option_binding *, size_t, FILE *),
		     const struct gz_option_binding *binding)
{
	char *text = NULL;
	size_t size = 0;
	FILE *out = open_memstream(&text, &size);
	assert_non_null(out);
	print(binding, 1, out);
	fclose(out);
	return text;
}

static void help_tells_how_to_switch_off(void **state)
{
	(void)state;
	static const struct gz_option options[] = {
		{ "menu", GZ_OPTION_BOOL, 0, .preset = "yes", .help = "show a menu" },
		{ "vsync", GZ_OPTION_BOOL, 0, .preset = "true", .help = "wait" },
		{ "cross", GZ_OPTION_BOOL, 0, .preset = "no", .help = "draw a cross" },
	};
	bool target = false;
	const struct gz_option_binding binding = { options, 3, &target, NULL };
	char *help = printed(gz_options_print_help, &binding);
	assert_string_equal(help,
			    "  --menu   show a menu (default yes; --menu=no switches it off)\n"
			    "  --vsync  wait (default yes; --vsync=no switches it off)\n"
			    "  --cross  draw a cross\n");
	free(help);
}

static void help_has_one_aligned_line_per_option(void **state)
{
	(void)state;
	struct settings s = { 0 };
	const struct gz_option_binding binding = sample_binding(&s, NULL);
	char *help = printed(gz_options_print_help, &binding);
	assert_string_equal(help,
			    "  --filter.smoothing N  cutoff at rest, Hz (0.1 to 100; default "
			    "1.5)\n"
			    "  --camera.eye 'N N …'  where the camera stands (-10 to 10; "
			    "default 0 0 1)\n"
			    "  --publish.port N      TCP port (1024 to 65535; default 5570)\n"
			    "  --size WxH            picture, px (1 to 16384 for each side; "
			    "default 1920x1080)\n"
			    "  --render.method NAME  how rays are spent (standard, mdc, ddc or "
			    "acuity; default standard)\n"
			    "  --show_cross          draw a cross at the gaze\n"
			    "  --publish.name TEXT   name of the stream\n");
	free(help);
}

static void printed_file_reads_back_to_the_same_settings(void **state)
{
	(void)state;
	struct settings s = { .smoothing_hz = 3.25,
			      .eye = { 1, 2, 3 },
			      .port = 2000,
			      .size = { 1, 1 },
			      .method = 2,
			      .name = "a b" };
	struct settings back = { .size = { 1, 1 } };
	const struct gz_option_binding binding = sample_binding(&s, NULL);
	const struct gz_option_binding into = sample_binding(&back, NULL);
	char *file = printed(gz_options_print_file, &binding);
	assert_int_equal(gz_options_read_text(&into, 1, "printed", file, strlen(file), NULL),
			 GZ_OK);
	assert_memory_equal(&back, &s, sizeof s);
	free(file);
}

static void printed_file_never_holds_a_value_that_would_read_back_otherwise(void **state)
{
	(void)state;
	const char *const names[] = { " a", "a ", "a ;b", "a\t;b", ";a" };
	for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
		struct settings s = { .smoothing_hz = 1, .port = 2000, .size = { 1, 1 } };
		struct settings back = s;
		snprintf(s.name, sizeof s.name, "%s", names[i]);
		snprintf(back.name, sizeof back.name, "untouched");
		const struct gz_option_binding binding = sample_binding(&s, NULL);
		const struct gz_option_binding into = sample_binding(&back, NULL);
		char *file = printed(gz_options_print_file, &binding);
		assert_int_equal(
			gz_options_read_text(&into, 1, "printed", file, strlen(file), NULL), GZ_OK);
		assert_string_equal(back.name, "untouched");
		free(file);
	}
}

static struct settings presets(void)
{
	struct settings settings = { 0 };
	const struct gz_option_binding binding = {
		.options = sample_options,
		.count = sizeof sample_options / sizeof *sample_options,
		.target = &settings,
	};
	assert_int_equal(gz_options_preset(&binding), GZ_OK);
	return settings;
}

static void every_preset_holds(void **state)
{
	(void)state;
	const struct settings settings = presets();
	for (size_t i = 0; i < sizeof sample_options / sizeof *sample_options; i++)
		if (!gz_option_holds(&sample_options[i], &settings))
			fail_msg("%s does not hold", sample_options[i].key);
}

static void value_that_no_text_could_set_does_not_hold(void **state)
{
	(void)state;
	struct settings settings = presets();
	settings.smoothing_hz = NAN;
	settings.eye[2] = 10.001;
	settings.port = 1023;
	settings.size[1] = 16385;
	settings.method = 4;
	memset(settings.name, 'x', sizeof settings.name);
	static const int bad[] = { SMOOTHING, EYE, PORT, SIZE, METHOD, NAME };
	for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
		if (gz_option_holds(&sample_options[bad[i]], &settings))
			fail_msg("%s holds", sample_options[bad[i]].key);
	settings.method = -1;
	assert_false(gz_option_holds(&sample_options[METHOD], &settings));
}

/* A value of each option that differs from the preset. */
static void change_option(const struct gz_option *option, struct settings *settings)
{
	char *field = (char *)settings + option->offset;
	switch (option->type) {
	case GZ_OPTION_BOOL:
		*(bool *)field = !*(bool *)field;
		break;
	case GZ_OPTION_DOUBLE:
		((double *)field)[option->count > 0 ? option->count - 1 : 0] += 0.5;
		break;
	case GZ_OPTION_STRING:
		field[0] = field[0] == 'x' ? 'y' : 'x';
		break;
	case GZ_OPTION_INT:
	case GZ_OPTION_SIZE:
	case GZ_OPTION_CHOICE:
		(*(int *)field)++;
		break;
	}
}

static void settings_are_the_same_until_any_option_changes(void **state)
{
	(void)state;
	const size_t count = sizeof sample_options / sizeof *sample_options;
	struct settings one, other;
	memset(&one, 0x55, sizeof one); /* padding differs */
	memset(&other, 0xAA, sizeof other);
	const struct gz_option_binding a = { sample_options, count, &one, NULL };
	const struct gz_option_binding b = { sample_options, count, &other, NULL };
	const struct settings presets_read = presets();
	for (size_t i = 0; i < count; i++) {
		const struct gz_option *option = &sample_options[i];
		char text[512];
		assert_int_equal(gz_option_format(option, &presets_read, text, sizeof text), GZ_OK);
		assert_int_equal(gz_option_parse(option, text, &one, NULL, 0), GZ_OK);
		assert_int_equal(gz_option_parse(option, text, &other, NULL, 0), GZ_OK);
	}
	assert_true(gz_options_same(a.options, count, a.target, b.target));
	for (size_t i = 0; i < count; i++) {
		struct settings changed = one;
		change_option(&sample_options[i], &changed);
		if (gz_options_same(sample_options, count, &one, &changed))
			fail_msg("%s: a change is not seen", sample_options[i].key);
	}
	one.smoothing_hz = other.smoothing_hz = NAN;
	assert_true(gz_options_same(sample_options, count, &one, &other));
	one.smoothing_hz = -0.0;
	other.smoothing_hz = 0;
	assert_true(gz_options_same(sample_options, count, &one, &other));
}

TEST_SUITE(option)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(preset_sets_all_that_have_one),
		cmocka_unit_test(preset_that_does_not_parse_is_reported),
		cmocka_unit_test(parse_refusal_says_why_and_changes_nothing),
		cmocka_unit_test(parse_refusal_without_a_message_buffer_is_safe),
		cmocka_unit_test(parse_number_too_long_for_one_is_refused),
		cmocka_unit_test(parse_takes_the_ends_of_the_range),
		cmocka_unit_test(parse_bool_reads_every_word),
		cmocka_unit_test(parse_choice_gives_its_index),
		cmocka_unit_test(format_reads_back_to_the_same_value),
		cmocka_unit_test(format_is_as_short_as_it_can_be),
		cmocka_unit_test(format_into_too_little_room_is_full_and_empty),
		cmocka_unit_test(find_names_option_and_binding),
		cmocka_unit_test(every_preset_holds),
		cmocka_unit_test(value_that_no_text_could_set_does_not_hold),
		cmocka_unit_test(settings_are_the_same_until_any_option_changes),
		cmocka_unit_test(help_tells_how_to_switch_off),
		cmocka_unit_test(help_has_one_aligned_line_per_option),
		cmocka_unit_test(printed_file_reads_back_to_the_same_settings),
		cmocka_unit_test(printed_file_never_holds_a_value_that_would_read_back_otherwise),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
