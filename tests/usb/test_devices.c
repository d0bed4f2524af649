/* Which trackers can be used: those that are meant, whose descriptors make sense, and that the user
 * may open. */
#include "check.h"

#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/clock.h"
#include "guest.h"
#include "hid_function.h"
#include "hid_gadget.h"
#include "lab.h"
#include "psvr2_gadget.h"

static struct lab lab;
static struct hid_gadget first, second;
static struct hid_function broken;
static struct psvr2_gadget headset;

static const struct lab_truth first_truth = {
	.stream = &first.stream,
	.has_clock = true,
	.tolerance = 1e-4,
};

static const struct lab_truth second_truth = {
	.stream = &second.stream,
	.has_clock = true,
	.tolerance = 4e-4,
};

static const struct lab_truth headset_truth = {
	.stream = &headset.stream,
	.has_clock = true,
	.tolerance = 1e-4,
};

static int set_up(void **state)
{
	(void)state;
	lab_open(&lab);
	return 0;
}

static int tear_down(void **state)
{
	(void)state;
	lab_close(&lab);
	guest_remove_udev_rules();
	hid_gadget_remove(&first);
	hid_gadget_remove(&second);
	hid_function_remove(&broken);
	psvr2_gadget_remove(&headset);
	return 0;
}

static void plug_first(void)
{
	hid_gadget_plug(&first, 0, &hid_layout_reference, "GazeLab 200", "GL-7");
	made_stream_start(&first.stream);
}

static void plug_second(void)
{
	hid_gadget_plug(&second, 1, &hid_layout_coarse, "EyeWorks Fine", "EW-42");
	made_stream_start(&second.stream);
}

/* The lines that `gazectl devices` prints of the device with this name, in a static buffer. */
static const char *listed(const char *text, const char *name)
{
	static char lines[1024];
	const char *begin = strstr(text, name);
	if (!begin)
		fail_msg("%s is not listed:\n%s", name, text);
	const char *end = strchr(begin, '\n');
	end = end ? strchr(end + 1, '\n') : NULL;
	size_t length = end ? (size_t)(end - begin) : strlen(begin);
	length = length < sizeof lines ? length : sizeof lines - 1;
	memcpy(lines, begin, length);
	lines[length] = '\0';
	return lines;
}

static void expect_listed(const char *name, const char *what, bool as_user)
{
	const char *lines = listed(lab_devices(as_user), name);
	if (!strstr(lines, what))
		fail_msg("\"%s\" is not said of %s:\n%s", what, name, lines);
}

static void of_two_trackers_the_one_is_used_that_is_named(void **state)
{
	(void)state;
	plug_first();
	plug_second();
	guest_wait_for_file("/dev/hidraw1", true);
	expect_listed("GazeLab 200", "    usable", false);
	expect_listed("EyeWorks Fine", "    usable", false);
	LAB_START(&lab, "--driver", "hid", "--tracker", "EW-42", LAB_SCREEN);
	lab_compare(&lab, &second_truth, 50);
	lab_wait_state(&lab, GZ_TRACKER_RUNNING);
	assert_string_equal(lab.reader.status.tracker.name, "EyeWorks Fine");
	lab_stop(&lab);
	lab_close(&lab);

	lab_open(&lab);
	LAB_START(&lab, "--driver", "hid", "--tracker", "GazeLab 200", LAB_SCREEN);
	lab_compare(&lab, &first_truth, 50);
	lab_wait_state(&lab, GZ_TRACKER_RUNNING);
	assert_string_equal(lab.reader.status.tracker.serial, "GL-7");
	lab_stop(&lab);
}

static void tracker_that_is_named_is_waited_for_and_no_other_taken(void **state)
{
	(void)state;
	plug_first();
	guest_wait_for_file("/dev/hidraw0", true);
	LAB_START(&lab, "--driver", "hid", "--tracker", "EW-42", LAB_SCREEN);
	lab_wait_state(&lab, GZ_TRACKER_ABSENT);
	lab_expect_said(&lab, "EW-42");
	plug_second();
	lab_compare(&lab, &second_truth, 50);
	gadget_unplug(&second.gadget);
	lab_wait_state(&lab, GZ_TRACKER_LOST);
	gadget_plug(&second.gadget);
	lab_compare(&lab, &second_truth, 50);
	lab_stop(&lab);
}

static void tracker_whose_descriptor_makes_no_sense_is_named_and_hurts_nobody(void **state)
{
	(void)state;
	broken = (struct hid_function) { .broken_descriptor = true };
	hid_function_plug(&broken, 0, "Brokeneye 9", "BE-9");
	guest_wait_for_count(&broken.descriptor_reads, 1);
	LAB_START(&lab, "--driver", "hid", LAB_SCREEN);
	lab_wait_state(&lab, GZ_TRACKER_ABSENT);
	expect_listed("Brokeneye 9", "    not usable", false);
	plug_second();
	lab_compare(&lab, &second_truth, 50);
	expect_listed("Brokeneye 9", "    not usable", false);
	expect_listed("EyeWorks Fine", "    usable", false);
	lab_stop(&lab);
}

static void ordinary_user_is_told_of_the_udev_rule_and_served_once_it_is_there(void **state)
{
	(void)state;
	const char *const arguments[] = { "--driver", "hid", LAB_SCREEN, NULL };
	plug_first();
	guest_wait_for_file("/dev/hidraw0", true);
	lab_start(&lab, true, arguments);
	lab_wait_state(&lab, GZ_TRACKER_ABSENT);
	print_message("           without the rule: %s\n", lab.reader.status.tracker.reason);
	lab_expect_said(&lab, "70-gazecast.rules");
	expect_listed("GazeLab 200", "70-gazecast.rules", true);
	gadget_unplug(&first.gadget);
	guest_wait_for_file("/dev/hidraw0", false);
	guest_install_udev_rules();
	gadget_plug(&first.gadget);
	lab_compare(&lab, &first_truth, 50);
	expect_listed("GazeLab 200", "    usable", true);
	lab_stop(&lab);
}

static void ordinary_user_uses_a_headset_with_the_udev_rule(void **state)
{
	(void)state;
	const char *const arguments[] = { "--driver", "psvr2", "--psvr2.screen_mm", "500 300",
					  NULL };
	psvr2_gadget_plug(&headset, "VR-123");
	made_stream_start(&headset.stream);
	lab_start(&lab, true, arguments);
	lab_wait_state(&lab, GZ_TRACKER_ABSENT);
	print_message("           without the rule: %s\n", lab.reader.status.tracker.reason);
	expect_listed("PlayStation VR2", "70-gazecast.rules", true);
	lab_expect_said(&lab, "70-gazecast.rules");
	psvr2_gadget_unplug(&headset);
	guest_install_udev_rules();
	psvr2_gadget_plug(&headset, "VR-123");
	made_stream_start(&headset.stream);
	lab_compare(&lab, &headset_truth, 50);
	expect_listed("PlayStation VR2", "VR-123", true);
	lab_stop(&lab);
}

static void auto_takes_what_is_plugged_in_whatever_it_is(void **state)
{
	(void)state;
	LAB_START(&lab, "--driver", "auto", "--psvr2.screen_mm", "500 300", LAB_SCREEN);
	lab_wait_state(&lab, GZ_TRACKER_ABSENT);
	lab_expect_said(&lab, "plug one in");
	psvr2_gadget_plug(&headset, "VR-123");
	made_stream_start(&headset.stream);
	lab_compare(&lab, &headset_truth, 50);
	psvr2_gadget_unplug(&headset);
	lab_wait_state(&lab, GZ_TRACKER_LOST);
	assert_string_equal(lab.reader.status.tracker.reason, "unplugged");
	plug_first();
	lab_compare(&lab, &first_truth, 50);
	lab_wait_state(&lab, GZ_TRACKER_RUNNING);
	assert_string_equal(lab.reader.status.tracker.name, "GazeLab 200");
	lab_stop(&lab);
}

#define TEST(function) cmocka_unit_test_setup_teardown(function, set_up, tear_down)

int main(void)
{
	const struct CMUnitTest tests[] = {
		TEST(of_two_trackers_the_one_is_used_that_is_named),
		TEST(tracker_that_is_named_is_waited_for_and_no_other_taken),
		TEST(auto_takes_what_is_plugged_in_whatever_it_is),
		TEST(tracker_whose_descriptor_makes_no_sense_is_named_and_hurts_nobody),
		TEST(ordinary_user_is_told_of_the_udev_rule_and_served_once_it_is_there),
		TEST(ordinary_user_uses_a_headset_with_the_udev_rule),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
