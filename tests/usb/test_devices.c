/* Which trackers can be used: the chosen ones, with valid descriptors, that the user may open. */
#include "suite.h"

#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/clock.h"
#include "guest.h"
#include "lab.h"

/* The lines of `gazectl devices` about the device with this name, in a static buffer. */
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

static void chosen_tracker_of_two_is_used(void **state)
{
	(void)state;
	lab_plug_tracker(HID_LAYOUT_REFERENCE);
	lab_plug_second();
	guest_wait_for_file("/dev/hidraw1", true);
	expect_listed("GazeLab 200", "    usable", false);
	expect_listed("EyeWorks Fine", "    usable", false);
	LAB_START("--driver", "hid", "--tracker", "EW-42", LAB_SCREEN);
	lab_compare(&lab.second.stream, 50);
	lab_wait_state(GZ_TRACKER_RUNNING);
	assert_string_equal(lab.reader.status.tracker.name, "EyeWorks Fine");
	lab_stop();
	lab_close();

	lab_open();
	LAB_START("--driver", "hid", "--tracker", "GazeLab 200", LAB_SCREEN);
	lab_compare(&lab.tracker.stream, 50);
	lab_wait_state(GZ_TRACKER_RUNNING);
	assert_string_equal(lab.reader.status.tracker.serial, "GL-7");
	lab_stop();
}

static void chosen_tracker_is_waited_for_and_no_other_one_is_used(void **state)
{
	(void)state;
	lab_plug_tracker(HID_LAYOUT_REFERENCE);
	guest_wait_for_file("/dev/hidraw0", true);
	LAB_START("--driver", "hid", "--tracker", "EW-42", LAB_SCREEN);
	lab_wait_state(GZ_TRACKER_ABSENT);
	lab_expect_said("EW-42");
	lab_plug_second();
	lab_compare(&lab.second.stream, 50);
	gadget_unplug(&lab.second.gadget);
	lab_wait_state(GZ_TRACKER_LOST);
	gadget_plug(&lab.second.gadget);
	lab_compare(&lab.second.stream, 50);
	lab_stop();
}

static void tracker_with_a_malformed_descriptor_is_listed_and_disturbs_nothing(void **state)
{
	(void)state;
	lab.function = (struct hid_function) { .broken_descriptor = true };
	hid_function_plug(&lab.function, 0, "Brokeneye 9", "BE-9");
	guest_wait_for_count(&lab.function.descriptor_reads, 1);
	LAB_START("--driver", "hid", LAB_SCREEN);
	lab_wait_state(GZ_TRACKER_ABSENT);
	expect_listed("Brokeneye 9", "    not usable", false);
	lab_plug_second();
	lab_compare(&lab.second.stream, 50);
	expect_listed("Brokeneye 9", "    not usable", false);
	expect_listed("EyeWorks Fine", "    usable", false);
	lab_stop();
}

static void ordinary_user_is_told_about_the_udev_rule_and_can_use_the_tracker_with_it(void **state)
{
	(void)state;
	const char *const arguments[] = { "--driver", "hid", LAB_SCREEN, NULL };
	lab_plug_tracker(HID_LAYOUT_REFERENCE);
	guest_wait_for_file("/dev/hidraw0", true);
	lab_start(true, arguments);
	lab_wait_state(GZ_TRACKER_ABSENT);
	print_message("           without the rule: %s\n", lab.reader.status.tracker.reason);
	lab_expect_said("71-gazecast.rules");
	expect_listed("GazeLab 200", "71-gazecast.rules", true);
	gadget_unplug(&lab.tracker.gadget);
	guest_wait_for_file("/dev/hidraw0", false);
	guest_install_udev_rules();
	gadget_plug(&lab.tracker.gadget);
	lab_compare(&lab.tracker.stream, 50);
	expect_listed("GazeLab 200", "    usable", true);
	lab_stop();
}

static void ordinary_user_uses_a_headset_with_the_udev_rule(void **state)
{
	(void)state;
	const char *const arguments[] = { "--driver", "psvr2", LAB_PSVR2_SCREEN, NULL };
	lab_plug_headset();
	lab_start(true, arguments);
	lab_wait_state(GZ_TRACKER_ABSENT);
	print_message("           without the rule: %s\n", lab.reader.status.tracker.reason);
	expect_listed("PlayStation VR2", "71-gazecast.rules", true);
	lab_expect_said("71-gazecast.rules");
	psvr2_gadget_unplug(&lab.headset);
	guest_install_udev_rules();
	lab_plug_headset();
	lab_compare(&lab.headset.stream, 50);
	expect_listed("PlayStation VR2", "VR-123", true);
	lab_stop();
}

static void auto_uses_any_tracker_that_is_plugged_in(void **state)
{
	(void)state;
	LAB_START("--driver", "auto", LAB_PSVR2_SCREEN, LAB_SCREEN);
	lab_wait_state(GZ_TRACKER_ABSENT);
	lab_expect_said("plug one in");
	lab_plug_headset();
	lab_compare(&lab.headset.stream, 50);
	psvr2_gadget_unplug(&lab.headset);
	lab_wait_state(GZ_TRACKER_LOST);
	assert_string_equal(lab.reader.status.tracker.reason, "unplugged");
	lab_plug_tracker(HID_LAYOUT_REFERENCE);
	lab_compare(&lab.tracker.stream, 50);
	lab_wait_state(GZ_TRACKER_RUNNING);
	assert_string_equal(lab.reader.status.tracker.name, "GazeLab 200");
	lab_stop();
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		LAB_TEST(chosen_tracker_of_two_is_used),
		LAB_TEST(chosen_tracker_is_waited_for_and_no_other_one_is_used),
		LAB_TEST(auto_uses_any_tracker_that_is_plugged_in),
		LAB_TEST(tracker_with_a_malformed_descriptor_is_listed_and_disturbs_nothing),
		LAB_TEST(ordinary_user_is_told_about_the_udev_rule_and_can_use_the_tracker_with_it),
		LAB_TEST(ordinary_user_uses_a_headset_with_the_udev_rule),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
