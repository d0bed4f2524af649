#include "suite.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/captured_log.h"
#include "daemon/config.h"

static struct gz_config config;
static struct captured_log captured;

/* Arguments up to the NULL; what follows it is the test's own. Reads "gazed" and @p arguments,
 * NULL-terminated, without any file of the user's. */
static enum gz_result read_arguments(const char *const *arguments)
{
	char *argv[16] = { (char *)"gazed" };
	int argc = 1;
	for (; arguments[argc - 1]; argc++)
		argv[argc] = (char *)arguments[argc - 1];
	captured_log_init(&captured, NULL);
	setenv("XDG_CONFIG_HOME", "/nonexistent", 1);
	return gz_config_read(argc, argv, &captured.log, &config);
}

#define READ(...) read_arguments((const char *const[]) { __VA_ARGS__, NULL })

static void config_presets_are_what_the_options_say(void **state)
{
	(void)state;
	const void *settings;
	assert_int_equal(READ("--config", "/dev/null"), GZ_OK);
	assert_string_equal(gz_config_driver(&config, &settings)->name, "sim");
	assert_int_equal(config.tcp, GZ_TCP_LOOPBACK);
	assert_string_equal(config.control_endpoint, "tcp://127.0.0.1:50020");
	assert_int_equal(config.surface_count, 2);
	assert_string_equal(config.surface[0], "screen");
	assert_string_equal(config.surface[1], "psychopy_iohub_surface");
	struct gz_pipeline_params params = gz_pipeline_default_params();
	assert_memory_equal(&config.pipeline, &params, sizeof params);
	assert_int_equal(captured.messages, 0);
}

static void config_command_line_has_the_last_word_over_the_file(void **state)
{
	(void)state;
	char path[] = "/tmp/gz_config_XXXXXX";
	static const char text[] = "[tracker]\ndriver = replay\n[network]\ntcp = off\n"
				   "[sim]\nrate_hz = 250\n[pipeline]\nmargin = 1\n";
	int fd = mkstemp(path);
	assert_int_equal(write(fd, text, sizeof text - 1), sizeof text - 1);
	close(fd);
	enum gz_result result = READ("--config", path, "--driver", "sim", "--pipeline.margin=2");
	unlink(path);
	assert_int_equal(result, GZ_OK);
	assert_string_equal(config.driver, "sim");
	assert_int_equal(config.tcp, GZ_TCP_OFF);
	assert_true(config.pipeline.validate.margin == 2);
}

static void config_refusals_say_what_and_what_to_do(void **state)
{
	(void)state;
	static const char *const refusals[][4] = {
		{ "--bogus", "1", NULL, "--bogus: unknown option" },
		{ "--driver", "eyes", NULL, "no driver eyes; allowed: sim, replay, " },
		{ "--driver=sim", "--tracker.driver=sim", NULL, "--tracker.driver: given twice" },
		{ "--control", "tcp://0.0.0.0:50020", NULL, "not a loopback address" },
		{ "--control", "tcp://192.168.1.2:50020", NULL, "not a loopback address" },
		{ "--tcp", "all", NULL, "off, loopback or curve" },
		{ "--network.address=*", NULL, NULL, "--network.address: * is not a loopback" },
		{ "--network.address=127.0.0.1.example", NULL, NULL, "not a loopback address" },
		{ "--network.address", "", NULL, "--network.address: empty" },
		{ "--control", "ipc:///tmp/control", NULL, "is not tcp://ADDRESS:PORT" },
		{ "--network.stream_port=4000", "--network.inlet_port=4000", NULL,
		  "--network.inlet_port: 4000 is also the port of network.stream_port" },
		{ "--network.latest_port=50020", NULL, NULL, "also the port of network.control" },
		{ "--stream.surfaces", "a b a", NULL, "a is given twice" },
		{ "--display.px=0x1080", NULL, NULL, "0x1080 has one side only" },
		{ "--display.mm=500 0", NULL, NULL, "500 0 has one side only" },
		{ "--replay.speed=2", NULL, NULL, "--replay.speed: belongs to driver replay" },
		{ "--stream.surfaces", "a/b", NULL, "a/b is not a valid name" },
		{ "--stream.surfaces", "1 2 3 4 5 6 7 8 9", NULL, "more than 8 names" },
		{ "--config", "/nonexistent.conf", NULL, "/nonexistent.conf: no such file" },
		{ "--sim.rate_hz", "5000", NULL, "5000 is outside 30 to 2000" },
		{ "--display.mm", "nan 1", NULL, "display.mm" },
		{ "--driver=pupil", NULL, NULL,
		  "pupil.address: tcp://127.0.0.1:50020 is this daemon" },
		{ "--driver=pupil", "--pupil.address=tcp://localhost:7",
		  "--control=tcp://127.0.0.1:7", "--pupil.address: tcp://localhost:7 is this" },
		{ "--lsl.outlet", "--lsl.name=", NULL, "--lsl.name: empty" },
		{ "--lsl.outlet", "--lsl.library=", NULL, "--lsl.library: empty" },
		{ "file.gzl", NULL, NULL, "file.gzl" },
	};
	for (size_t i = 0; i < sizeof refusals / sizeof *refusals; i++) {
		enum gz_result result = read_arguments(refusals[i]);
		if (result == GZ_OK || captured.messages != 1 ||
		    !strstr(captured.last, refusals[i][3]))
			fail_msg("%s: %s, %d messages: %s", refusals[i][0], gz_result_text(result),
				 captured.messages, captured.last);
	}
}

static enum gz_result read_text(const char *text, char *path)
{
	int fd = mkstemp(path);
	assert_int_equal(write(fd, text, strlen(text)), strlen(text));
	close(fd);
	enum gz_result result = READ("--config", path);
	unlink(path);
	return result;
}

/* Each value by itself is valid. */
static void config_contradictions_in_a_file_are_told_with_file_and_line(void **state)
{
	(void)state;
	static const char *const refusals[][2] = {
		{ "[network]\n; all\naddress = *\n", ":3: network.address: * is not a loopback" },
		{ "[network]\ncontrol = tcp://10.0.0.1:50020\n", ":2: network.control: tcp://10" },
		{ "[network]\nstream_port = 9\nlatest_port = 9\n",
		  ":3: network.latest_port: 9 is also" },
		{ "[display]\nmm = 0 300\n", ":2: display.mm: 0 300 has one side only" },
		{ "[display]\npx = 1920x1080\nmm = 300 530\n", ":3: display.mm: 300 x 530 mm" },
		{ "[stream]\nsurfaces = x x\n", ":2: stream.surfaces: x is given twice" },
		{ "[pipeline]\ncorrection.y = 0 1 0\n", ":2: pipeline.correction: x and y" },
		{ "[tracker]\ndriver = eyes\n", ":2: tracker.driver: there is no driver eyes" },
	};
	for (size_t i = 0; i < sizeof refusals / sizeof *refusals; i++) {
		char path[] = "/tmp/gz_config_XXXXXX", wanted[160];
		enum gz_result result = read_text(refusals[i][0], path);
		snprintf(wanted, sizeof wanted, "%s%s", path, refusals[i][1]);
		if (result == GZ_OK || captured.messages != 1 || !strstr(captured.last, wanted))
			fail_msg("%s: %s, %d messages: %s, not %s", refusals[i][0],
				 gz_result_text(result), captured.messages, captured.last, wanted);
	}
}

static void config_pupil_may_be_anywhere_but_at_the_daemons_own_socket(void **state)
{
	(void)state;
	assert_int_equal(READ("--driver=pupil", "--control=tcp://127.0.0.1:50021"), GZ_OK);
	assert_int_equal(READ("--driver=pupil", "--tcp=off"), GZ_OK);
	assert_int_equal(READ("--driver=pupil", "--pupil.address=tcp://10.0.0.1:50020"), GZ_OK);
}

static void config_settings_of_other_drivers_may_stay_in_a_file(void **state)
{
	(void)state;
	char path[] = "/tmp/gz_config_XXXXXX";
	assert_int_equal(read_text("[replay]\nspeed = 2\n", path), GZ_OK);
}

static void config_of_auto_takes_the_settings_of_any_driver(void **state)
{
	(void)state;
	const void *all[GZ_CONFIG_DRIVERS_MAX], *settings;
	size_t i = 0;
	assert_int_equal(
		READ("--driver=auto", "--gazepoint.port=4243", "--psvr2.screen_mm=500 300"), GZ_OK);
	assert_string_equal(gz_config_driver(&config, &settings)->name, "auto");
	gz_config_all_settings(&config, all);
	while (strcmp(gz_drivers[i]->name, "psvr2") != 0)
		i++;
	const struct gz_option_binding binding = { gz_drivers[i]->options,
						   *gz_drivers[i]->option_count, (void *)all[i],
						   NULL };
	char text[64];
	assert_int_equal(gz_option_format(gz_options_find(&binding, 1, "psvr2.screen_mm", NULL),
					  all[i], text, sizeof text),
			 GZ_OK);
	assert_string_equal(text, "500 300");
}

static void config_control_is_at_pupils_port_of_the_address(void **state)
{
	(void)state;
	assert_int_equal(READ("--config=/dev/null", "--tcp=curve", "--network.address=*"), GZ_OK);
	assert_string_equal(config.control_endpoint, "tcp://*:50020");
	assert_int_equal(READ("--config=/dev/null", "--network.address=[::1]"), GZ_OK);
	assert_string_equal(config.control_endpoint, "tcp://[::1]:50020");
	assert_int_equal(READ("--config=/dev/null", "--tcp=curve", "--control=tcp://eth0:7"),
			 GZ_OK);
	assert_string_equal(config.control_endpoint, "tcp://eth0:7");
}

static void config_surfaces_may_be_none(void **state)
{
	(void)state;
	assert_int_equal(READ("--config", "/dev/null", "--stream.surfaces", ""), GZ_OK);
	assert_int_equal(config.surface_count, 0);
}

static void config_control_endpoint_does_not_matter_without_tcp(void **state)
{
	(void)state;
	assert_int_equal(READ("--config=/dev/null", "--tcp=off", "--control=tcp://0.0.0.0:1"),
			 GZ_OK);
}

static void config_display_is_the_best_known(void **state)
{
	(void)state;
	const struct gz_gaze_log_header header = { 0 };
	struct gz_device_info info = { .has_display = true,
				       .display = gz_display_default(800, 600) };
	struct gz_display display;
	info.display.distance_mm = 700;

	assert_int_equal(READ("--config", "/dev/null"), GZ_OK);
	display = gz_config_display(&config, &info);
	assert_memory_equal(&display, &info.display, sizeof display);
	display = gz_config_display(&config, &(struct gz_device_info) { 0 });
	struct gz_display usual = gz_display_default(1920, 1080);
	assert_memory_equal(&display, &usual, sizeof display);

	assert_int_equal(READ("--config", "/dev/null", "--display.distance_mm", "500"), GZ_OK);
	display = gz_config_display(&config, &info);
	assert_true(display.px[0] == 800 && display.distance_mm == 500);
	info.recorded = &header; /* a recording: the command line still has the last word */
	display = gz_config_display(&config, &info);
	assert_true(display.px[0] == 800 && display.distance_mm == 500);
	config.display_given[2] = false; /* as if the file had said so */
	display = gz_config_display(&config, &info);
	assert_true(display.distance_mm == 700);
}

static void config_pipeline_of_a_recording_comes_from_its_header(void **state)
{
	(void)state;
	static struct gz_gaze_log_header header;
	struct gz_pipeline_params params;
	header.setting_count = 3;
	header.settings[0] = (struct gz_gaze_log_setting) { "margin", "0.5" };
	header.settings[1] = (struct gz_gaze_log_setting) { "min_confidence", "0.125" };
	header.settings[2] = (struct gz_gaze_log_setting) { "of_another_version", "1" };
	assert_int_equal(READ("--config", "/dev/null", "--pipeline.min_confidence", "0.25"), GZ_OK);
	assert_int_equal(gz_config_pipeline(&config, &header, &captured.log, &params), GZ_OK);
	assert_true(params.validate.margin == 0.5);
	assert_true(params.validate.min_confidence == 0.25);
	assert_non_null(strstr(captured.last, "pipeline.of_another_version"));
	assert_int_equal(captured.level, GZ_LOG_WARN);

	header.settings[0] = (struct gz_gaze_log_setting) { "margin", "wide" };
	assert_int_equal(gz_config_pipeline(&config, &header, &captured.log, &params),
			 GZ_ERR_FORMAT);
	assert_non_null(
		strstr(captured.last, "pipeline.margin of the recording: wide is not a number"));
}

static void config_pipeline_described_in_a_header_reads_back_the_same(void **state)
{
	(void)state;
	static struct gz_gaze_log_header header;
	struct gz_pipeline_params params;
	assert_int_equal(READ("--config", "/dev/null", "--pipeline.margin", "0.1",
			      "--pipeline.noise_memory_s", "1.7"),
			 GZ_OK);
	gz_config_describe_pipeline(&config.pipeline, &header);
	assert_int_equal(header.setting_count, gz_pipeline_option_count + 1); /* and the forests */
	struct gz_pipeline_params wanted = config.pipeline;
	assert_int_equal(READ("--config", "/dev/null"), GZ_OK);
	captured.last[0] = 0;
	assert_int_equal(gz_config_pipeline(&config, &header, &captured.log, &params), GZ_OK);
	assert_memory_equal(&params, &wanted, sizeof params);
	assert_string_equal(captured.last, ""); /* no warning of other forests */
}

static void config_replay_of_a_recording_tells_of_other_forests(void **state)
{
	(void)state;
	static struct gz_gaze_log_header header;
	struct gz_pipeline_params params;
	assert_int_equal(READ("--config", "/dev/null"), GZ_OK);
	header.setting_count = 2;
	header.settings[0] = (struct gz_gaze_log_setting) { "labels", "learned" };
	header.settings[1] = (struct gz_gaze_log_setting) { "forests", "0123456789abcdef" };
	assert_int_equal(gz_config_pipeline(&config, &header, &captured.log, &params), GZ_OK);
	assert_int_equal(captured.level, GZ_LOG_WARN);
	assert_non_null(strstr(captured.last, "forests 0123456789abcdef"));
	header.setting_count = 1;
	assert_int_equal(gz_config_pipeline(&config, &header, &captured.log, &params), GZ_OK);
	assert_non_null(strstr(captured.last, "forests of an earlier version"));
	captured.last[0] = 0;
	header.settings[0] = (struct gz_gaze_log_setting) { "labels", "rules" };
	assert_int_equal(gz_config_pipeline(&config, &header, &captured.log, &params), GZ_OK);
	assert_string_equal(captured.last, "");
}

static void config_recordings_older_than_the_forests_are_labelled_by_rules(void **state)
{
	(void)state;
	static struct gz_gaze_log_header header;
	struct gz_pipeline_params params;
	assert_int_equal(READ("--config", "/dev/null"), GZ_OK);
	assert_int_equal(gz_config_pipeline(&config, &header, &captured.log, &params), GZ_OK);
	assert_int_equal(params.classify.source, GZ_CLASSIFY_LEARNED);
	header.setting_count = 1;
	header.settings[0] = (struct gz_gaze_log_setting) { "margin", "0.5" };
	assert_int_equal(gz_config_pipeline(&config, &header, &captured.log, &params), GZ_OK);
	assert_int_equal(params.classify.source, GZ_CLASSIFY_RULES);
	assert_int_equal(READ("--config", "/dev/null", "--pipeline.labels", "learned"), GZ_OK);
	assert_int_equal(gz_config_pipeline(&config, &header, &captured.log, &params), GZ_OK);
	assert_int_equal(params.classify.source, GZ_CLASSIFY_LEARNED);
}

static void config_correction_without_area_is_refused(void **state)
{
	(void)state;
	static struct gz_gaze_log_header header;
	struct gz_pipeline_params params;
	assert_int_equal(READ("--config", "/dev/null", "--pipeline.correction.x", "0.5 0 0"),
			 GZ_ERR_INVAL);
	assert_non_null(strstr(captured.last, "pipeline.correction"));
	assert_int_equal(READ("--config", "/dev/null", "--pipeline.correction.x", "0.5 1 inf"),
			 GZ_ERR_INVAL);
	header.setting_count = 1;
	header.settings[0] = (struct gz_gaze_log_setting) { "correction.y", "0 1 0" };
	assert_int_equal(READ("--config", "/dev/null"), GZ_OK);
	assert_int_equal(gz_config_pipeline(&config, &header, &captured.log, &params),
			 GZ_ERR_INVAL);
	header.settings[0] = (struct gz_gaze_log_setting) { "correction.y", "0.25 0 0.5" };
	assert_int_equal(gz_config_pipeline(&config, &header, &captured.log, &params), GZ_OK);
	assert_true(params.correct.y[0] == 0.25 && params.correct.y[2] == 0.5);
}

/* The printed file, without a path. */
static size_t print_file(char *text, size_t size)
{
	FILE *out = fmemopen(text, size, "w");
	assert_non_null(out);
	gz_config_print_file(&config, out);
	size_t length = (size_t)ftell(out);
	fclose(out);
	return length;
}

static void config_installed_file_is_the_printed_one_and_parses_to_the_presets(void **state)
{
	(void)state;
	static char printed[65536], installed[65536], again[65536];
	assert_int_equal(READ("--config", "/dev/null"), GZ_OK);
	size_t length = print_file(printed, sizeof printed);
	FILE *file = fopen(GAZED_CONF, "r");
	assert_non_null(file);
	size_t read = fread(installed, 1, sizeof installed, file);
	fclose(file);
	if (read != length || memcmp(installed, printed, length) != 0)
		fail_msg("%s differs; make it anew: gazed --config /dev/null --print-config",
			 GAZED_CONF);
	assert_int_equal(READ("--config", GAZED_CONF), GZ_OK);
	assert_int_equal(print_file(again, sizeof again), length);
	assert_memory_equal(again, printed, length);
}

static void config_help_names_every_option(void **state)
{
	(void)state;
	static char text[65536];
	assert_int_equal(READ("--help"), GZ_OK);
	assert_true(config.help);
	FILE *out = fmemopen(text, sizeof text, "w");
	gz_config_print_help(&config, out);
	fclose(out);
	for (size_t i = 0; i < gz_pipeline_option_count; i++)
		assert_non_null(strstr(text, gz_pipeline_options[i].key));
	for (size_t d = 0; gz_drivers[d]; d++) {
		for (size_t i = 0; i < *gz_drivers[d]->option_count; i++)
			assert_non_null(strstr(text, gz_drivers[d]->options[i].key));
	}
	assert_non_null(strstr(text, "--recording.directory"));
}

static void config_recording_directory_is_made_in_the_users_data(void **state)
{
	(void)state;
	char home[] = "/tmp/gz_data_XXXXXX", expected[128], text[GZ_PATH_SIZE];
	assert_non_null(mkdtemp(home));
	snprintf(expected, sizeof expected, "%s/share/gazecast", home);
	char data[64];
	snprintf(data, sizeof data, "%s/share", home);
	setenv("XDG_DATA_HOME", data, 1);
	assert_int_equal(READ("--config", "/dev/null"), GZ_OK);
	assert_int_equal(gz_config_recording_directory(&config, NULL, text, sizeof text), GZ_OK);
	assert_string_equal(text, expected);
	assert_int_equal(rmdir(expected), 0);
	assert_int_equal(rmdir(data), 0);
	assert_int_equal(rmdir(home), 0);
	/* gazectl, in another folder, prints the whole path. */
	char here[GZ_PATH_SIZE];
	assert_non_null(getcwd(here, sizeof here));
	assert_int_equal(READ("--config", "/dev/null", "--recording.directory", "."), GZ_OK);
	assert_int_equal(gz_config_recording_directory(&config, NULL, text, sizeof text), GZ_OK);
	assert_string_equal(text, here);
	assert_int_equal(READ("--config", "/dev/null", "--recording.directory", "/nonexistent"),
			 GZ_OK);
	assert_int_equal(gz_config_recording_directory(&config, &captured.log, text, sizeof text),
			 GZ_ERR_NOT_FOUND);
	assert_non_null(strstr(captured.last, "/nonexistent is not a directory; create it"));
}

TEST_SUITE(config)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(config_presets_are_what_the_options_say),
		cmocka_unit_test(config_command_line_has_the_last_word_over_the_file),
		cmocka_unit_test(config_refusals_say_what_and_what_to_do),
		cmocka_unit_test(config_contradictions_in_a_file_are_told_with_file_and_line),
		cmocka_unit_test(config_pupil_may_be_anywhere_but_at_the_daemons_own_socket),
		cmocka_unit_test(config_settings_of_other_drivers_may_stay_in_a_file),
		cmocka_unit_test(config_of_auto_takes_the_settings_of_any_driver),
		cmocka_unit_test(config_control_is_at_pupils_port_of_the_address),
		cmocka_unit_test(config_surfaces_may_be_none),
		cmocka_unit_test(config_control_endpoint_does_not_matter_without_tcp),
		cmocka_unit_test(config_display_is_the_best_known),
		cmocka_unit_test(config_pipeline_of_a_recording_comes_from_its_header),
		cmocka_unit_test(config_correction_without_area_is_refused),
		cmocka_unit_test(config_pipeline_described_in_a_header_reads_back_the_same),
		cmocka_unit_test(config_replay_of_a_recording_tells_of_other_forests),
		cmocka_unit_test(config_recordings_older_than_the_forests_are_labelled_by_rules),
		cmocka_unit_test(
			config_installed_file_is_the_printed_one_and_parses_to_the_presets),
		cmocka_unit_test(config_help_names_every_option),
		cmocka_unit_test(config_recording_directory_is_made_in_the_users_data),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
