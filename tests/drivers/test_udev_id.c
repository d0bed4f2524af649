/* The program that udev runs, with descriptors in files. */
#include "suite.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include "hid_made.h"

static char path[64];

/* Run it with @p size bytes. @return its exit status */
static int ask(const unsigned char *bytes, size_t size, char printed[256])
{
	char command[1024];
	FILE *file = fopen(path, "we");
	assert_non_null(file);
	assert_int_equal(fwrite(bytes, 1, size, file), size);
	fclose(file);
	snprintf(command, sizeof command, "%s %s", UDEV_ID, path);
	FILE *pipe = popen(command, "re");
	assert_non_null(pipe);
	printed[fread(printed, 1, 255, pipe)] = '\0';
	int status = pclose(pipe);
	return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

static void eye_trackers_are_recognised_whatever_their_layout(void **state)
{
	(void)state;
	char printed[256];
	for (int layout = 0; layout < HID_LAYOUT_COUNT; layout++) {
		struct hid_made made = { 0 };
		hid_made_tracker(&made, layout);
		assert_int_equal(ask(made.bytes, made.size, printed), 0);
		assert_string_equal(printed, "GAZECAST_EYE_TRACKER=1\n");
	}
}

static void other_devices_and_garbage_are_not_recognised(void **state)
{
	(void)state;
	char printed[256];
	struct hid_made made = { 0 };
	/* A mouse with one button. */
	HID_ITEMS(&made, HID_PAGE, 0x01, HID_USAGE, 0x02, HID_COLLECTION, 1, HID_PAGE, 0x09,
		  HID_USAGE, 0x01, HID_LOGICAL_MIN, 0, HID_LOGICAL_MAX, 1, HID_SIZE, 1, HID_COUNT,
		  1, HID_INPUT, 2, HID_SIZE, 7, HID_INPUT, 3, HID_END, 0);
	assert_int_equal(ask(made.bytes, made.size, printed), 0);
	assert_string_equal(printed, "");
	made.size = 0;
	hid_made_tracker(&made, HID_LAYOUT_REFERENCE);
	assert_int_equal(ask(made.bytes, made.size / 2, printed), 0);
	assert_string_equal(printed, "");
	assert_int_equal(ask(made.bytes, 0, printed), 0);
	assert_string_equal(printed, "");
	memset(made.bytes, 0, sizeof made.bytes);
	assert_int_equal(ask(made.bytes, sizeof made.bytes, printed), 0);
	assert_string_equal(printed, "");
}

static void missing_file_and_wrong_usage_fail(void **state)
{
	(void)state;
	assert_int_equal(WEXITSTATUS(system(UDEV_ID " /nonexistent 2>/dev/null")), 1);
	assert_int_equal(WEXITSTATUS(system(UDEV_ID " 2>/dev/null")), 2);
}

static int make_file(void **state)
{
	(void)state;
	strcpy(path, "/tmp/gz_udev_id_XXXXXX");
	int fd = mkstemp(path);
	return fd < 0 ? -1 : close(fd);
}

static int remove_file(void **state)
{
	(void)state;
	return unlink(path);
}

TEST_SUITE(udev_id)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(eye_trackers_are_recognised_whatever_their_layout),
		cmocka_unit_test(other_devices_and_garbage_are_not_recognised),
		cmocka_unit_test(missing_file_and_wrong_usage_fail),
	};
	return cmocka_run_group_tests(tests, make_file, remove_file);
}
