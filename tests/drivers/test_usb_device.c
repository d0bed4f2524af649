#include "suite.h"

#include <string.h>

#include "drivers/usb/usb_device.h"

static const struct gz_usb_device device = {
	.name = "Tracker 3",
	.serial = "0A1B",
	.place = "usb 250-1",
	.node = "/dev/null",
};

static void device_is_chosen_by_serial_or_name_and_by_nothing_else(void **state)
{
	(void)state;
	assert_true(gz_device_is_chosen(NULL, device.name, device.serial));
	assert_true(gz_device_is_chosen("", device.name, device.serial));
	assert_true(gz_device_is_chosen("0A1B", device.name, device.serial));
	assert_true(gz_device_is_chosen("Tracker 3", device.name, device.serial));
	assert_false(gz_device_is_chosen("0A1", device.name, device.serial));
	assert_false(gz_device_is_chosen("tracker 3", device.name, device.serial));
	assert_false(gz_device_is_chosen("usb 250-1", device.name, device.serial));
}

static void device_whose_node_may_be_opened_is_usable(void **state)
{
	(void)state;
	struct gz_device_entry entry;
	gz_usb_list_entry(&device, 5, &entry);
	assert_true(entry.usable);
	assert_string_equal(entry.reason, "");
	assert_string_equal(entry.name, "Tracker 3");
	assert_string_equal(entry.serial, "0A1B");
	assert_string_equal(entry.place, "usb 250-1");
}

static void device_whose_node_may_not_be_opened_names_the_rule(void **state)
{
	(void)state;
	struct gz_usb_device locked = device;
	struct gz_device_entry entry;
	strcpy(locked.node, "/nonexistent/250/001");
	gz_usb_list_entry(&locked, 5, &entry);
	assert_false(entry.usable);
	assert_non_null(strstr(entry.reason, "/nonexistent/250/001"));
	assert_non_null(strstr(entry.reason, "71-gazecast.rules"));
	assert_true(strlen(entry.reason) < sizeof entry.reason - 1); /* it is not cut */
}

static void errors_of_libusb_become_results(void **state)
{
	(void)state;
	static const struct {
		int error;
		enum gz_result result;
	} pairs[] = {
		{ LIBUSB_SUCCESS, GZ_OK },
		{ 8, GZ_OK }, /* a number of bytes sent */
		{ LIBUSB_ERROR_NO_DEVICE, GZ_ERR_NO_DEVICE },
		{ LIBUSB_ERROR_NOT_FOUND, GZ_ERR_NO_DEVICE },
		{ LIBUSB_ERROR_ACCESS, GZ_ERR_ACCESS },
		{ LIBUSB_ERROR_BUSY, GZ_ERR_BUSY },
		{ LIBUSB_ERROR_NO_MEM, GZ_ERR_NO_MEM },
		{ LIBUSB_ERROR_TIMEOUT, GZ_ERR_TIMEOUT },
		{ LIBUSB_ERROR_PIPE, GZ_ERR_IO },
		{ LIBUSB_ERROR_OTHER, GZ_ERR_IO },
	};
	for (size_t i = 0; i < sizeof pairs / sizeof *pairs; i++)
		if (gz_usb_result(pairs[i].error) != pairs[i].result)
			fail_msg("%d: %d, expected %d", pairs[i].error,
				 gz_usb_result(pairs[i].error), pairs[i].result);
}

TEST_SUITE(usb_device)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(device_is_chosen_by_serial_or_name_and_by_nothing_else),
		cmocka_unit_test(device_whose_node_may_be_opened_is_usable),
		cmocka_unit_test(device_whose_node_may_not_be_opened_names_the_rule),
		cmocka_unit_test(errors_of_libusb_become_results),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
