/* gazectl devices, with one tracker that is sure to be found: the test plays it. */
#include "suite.h"

#include "../drivers/gazepoint_server.h"
#include "program.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static char directory[64], file[160];
static struct program program; /* large: not for the stack */

#define RUN(...) \
	program_run(&program, (const char *const[]) { GAZECTL, "devices", __VA_ARGS__, NULL })

static int make_directory(void **state)
{
	char path[128];
	(void)state;
	snprintf(directory, sizeof directory, "/tmp/gz_devices_XXXXXX");
	if (!mkdtemp(directory))
		return -1;
	snprintf(path, sizeof path, "%s/gazecast", directory);
	snprintf(file, sizeof file, "%s/gazed.conf", path);
	return mkdir(path, 0700) == 0 && setenv("XDG_CONFIG_HOME", directory, 1) == 0 ? 0 : -1;
}

static int remove_directory(void **state)
{
	char path[128];
	(void)state;
	unlink(file);
	snprintf(path, sizeof path, "%s/gazecast", directory);
	rmdir(path);
	return rmdir(directory);
}

static void configure(const char *text)
{
	FILE *out = fopen(file, "we");
	assert_non_null(out);
	fputs(text, out);
	fclose(out);
}

static void assert_contains(const char *text, const char *part)
{
	if (!strstr(text, part))
		fail_msg("\"%s\" is not in:\n%s", part, text);
}

static void devices_that_can_be_used_are_listed_with_how_to_choose_them(void **state)
{
	(void)state;
	char text[128];
	struct gazepoint_server server;
	gazepoint_server_start(&server, &(struct gazepoint_play) { .stream = true }, 0);
	snprintf(text, sizeof text, "[gazepoint]\nport = %d\n", server.port);
	configure(text);
	RUN("--json");
	gazepoint_server_stop(&server);
	if (program.status != 0)
		fail_msg("exit status %d: %s", program.status, program.err_text);
	assert_contains(program.out_text, "\"driver\": \"gazepoint\"");
	snprintf(text, sizeof text, "port %d\"", server.port);
	assert_contains(program.out_text, text);
	assert_contains(program.out_text, "\"usable\": true");
	assert_contains(program.out_text, "\"command\": \"gazed --driver gazepoint");
}

static void devices_that_cannot_be_used_are_listed_with_the_reason(void **state)
{
	(void)state;
	configure("[gazepoint]\nport = 1\n");
	RUN("--json");
	assert_contains(program.out_text, "port 1\"");
	RUN(NULL);
	assert_contains(program.out_text, "port 1, driver gazepoint\n    not usable: ");
	/* Another tracker may be connected to this machine. */
	if (!strstr(program.out_text, "    usable: ")) {
		assert_int_equal(program.status, 1);
		assert_contains(program.err_text, "no tracker can be used");
	}
}

static void devices_are_asked_with_presets_where_the_configuration_is_refused(void **state)
{
	(void)state;
	configure("[gazepoint]\nhost = 127.0.0.2\nport = everywhere\n");
	RUN("--json");
	assert_contains(program.err_text, "gazed.conf:3: gazepoint.port");
	assert_contains(program.err_text, "default settings");
	assert_contains(program.out_text, "\"devices\"");
	if (strstr(program.out_text, "127.0.0.2"))
		fail_msg("half of a refused configuration counts:\n%s", program.out_text);
}

TEST_SUITE(gazectl_devices)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(devices_that_can_be_used_are_listed_with_how_to_choose_them),
		cmocka_unit_test(devices_that_cannot_be_used_are_listed_with_the_reason),
		cmocka_unit_test(devices_are_asked_with_presets_where_the_configuration_is_refused),
	};
	return cmocka_run_group_tests(tests, make_directory, remove_directory);
}
