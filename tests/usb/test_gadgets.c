/* The trackers of the other tests, read without any code of the project: what arrives is what they
 * sent. */
#include "suite.h"

#include <errno.h>
#include <fcntl.h>
#include <libusb.h>
#include <linux/hidraw.h>
#include <poll.h>
#include <stdio.h>
#include <string.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include "base/clock.h"
#include "guest.h"
#include "hid_function.h"
#include "hid_gadget.h"
#include "psvr2_gadget.h"

static struct hid_gadget tracker;
static struct hid_function function;
static struct psvr2_gadget headset;

static int remove_all(void **state)
{
	(void)state;
	hid_gadget_remove(&tracker);
	hid_function_remove(&function);
	psvr2_gadget_remove(&headset);
	return 0;
}

static int open_hidraw(void)
{
	guest_wait_for_file("/dev/hidraw0", true);
	int fd = open("/dev/hidraw0", O_RDWR | O_CLOEXEC);
	if (fd < 0)
		fail_msg("/dev/hidraw0: %s", strerror(errno));
	return fd;
}

static void read_report(int fd, uint8_t *report, size_t size)
{
	struct pollfd ready = { .fd = fd, .events = POLLIN };
	assert_int_equal(poll(&ready, 1, 5000), 1);
	assert_int_equal(read(fd, report, size), size);
}

static void hid_reports_arrive_as_they_were_sent(void **state)
{
	(void)state;
	for (int layout = 0; layout < HID_LAYOUT_COUNT; layout++) {
		struct hid_made made = { 0 };
		uint8_t sent[HID_REPORT_MAX], received[HID_REPORT_MAX];
		struct made_sample sample = made_gaze((uint64_t)layout);
		size_t report_size = hid_gadget_report(layout, &sample, sent);
		hid_made_tracker(&made, layout);
		hid_gadget_plug(&tracker, 0, layout, "tracker", "one");
		int fd = open_hidraw();
		struct hidraw_report_descriptor descriptor = { 0 };
		int size = 0;
		assert_int_equal(ioctl(fd, HIDIOCGRDESCSIZE, &size), 0);
		assert_int_equal(size, made.size);
		descriptor.size = (uint32_t)size;
		assert_int_equal(ioctl(fd, HIDIOCGRDESC, &descriptor), 0);
		assert_memory_equal(descriptor.value, made.bytes, size);
		hid_gadget_send(&tracker, sent, report_size);
		read_report(fd, received, report_size);
		assert_memory_equal(received, sent, report_size);
		close(fd);
		hid_gadget_remove(&tracker);
		guest_wait_for_file("/dev/hidraw0", false);
	}
}

static void a_hid_function_answers_feature_requests_and_sends_reports(void **state)
{
	(void)state;
	uint8_t configuration[19] = { 0x12 }, mode[2] = { 0x14, 3 };
	uint8_t sent[HID_REPORT_MAX], received[65];
	function = (struct hid_function) { .screen_um = { 500000, 300000 } };
	hid_function_plug(&function, 1, "tracker", "two");
	int fd = open_hidraw();
	assert_int_equal(ioctl(fd, HIDIOCGFEATURE(sizeof configuration), configuration),
			 sizeof configuration);
	assert_int_equal(configuration[0], 0x12);
	assert_int_equal(configuration[11] | configuration[12] << 8 | configuration[13] << 16,
			 500000);
	assert_int_equal(ioctl(fd, HIDIOCSFEATURE(sizeof mode), mode), sizeof mode);
	guest_wait_for_count(&function.mode_requests, 1);
	assert_int_equal(function.mode, 3);
	struct made_sample sample = made_gaze(9);
	assert_int_equal(hid_gadget_report(HID_LAYOUT_REFERENCE, &sample, sent), sizeof received);
	assert_true(functionfs_send(&function.function, sent, sizeof received));
	read_report(fd, received, sizeof received);
	assert_memory_equal(received, sent, sizeof received);
	close(fd);
	hid_function_remove(&function);
	guest_wait_for_file("/dev/hidraw0", false);
}

static void switch_stream(libusb_device_handle *handle, uint8_t subcommand)
{
	uint8_t bytes[8] = { 0x0C, 0, subcommand };
	assert_int_equal(libusb_control_transfer(handle, 0x42, 0x09, 0x0C, 0, bytes, 8, 1000), 8);
}

static libusb_device_handle *open_headset(libusb_context *context)
{
	int64_t deadline_ns = gz_clock_now_ns() + 10 * GZ_NS_PER_S;
	libusb_device_handle *handle;
	while (!(handle = libusb_open_device_with_vid_pid(context, 0x054C, 0x0CDE))) {
		if (gz_clock_now_ns() > deadline_ns)
			fail_msg("no headset, errno of the gadget %d", headset.error);
		usleep(10000);
	}
	return handle;
}

static void a_headset_streams_once_it_is_switched_on(void **state)
{
	(void)state;
	uint8_t received[512], sent[GZ_PSVR2_PACKET_SIZE];
	int size = 0;
	libusb_context *context;
	assert_int_equal(libusb_init(&context), 0);
	psvr2_gadget_plug(&headset, "three");
	libusb_device_handle *handle = open_headset(context);
	assert_int_equal(libusb_claim_interface(handle, 5), 0);
	made_stream_start(&headset.stream);
	assert_int_equal(libusb_bulk_transfer(handle, 0x85, received, sizeof received, &size, 100),
			 LIBUSB_ERROR_TIMEOUT);
	switch_stream(handle, 1);
	assert_int_equal(libusb_bulk_transfer(handle, 0x85, received, sizeof received, &size, 1000),
			 0);
	assert_int_equal(size, sizeof sent);
	uint64_t number = received[0x58] | received[0x59] << 8;
	struct made_sample sample = made_gaze(number);
	psvr2_gadget_encode(&headset, &sample, sent);
	assert_memory_equal(received, sent, sizeof sent);
	made_stream_stop(&headset.stream);
	psvr2_gadget_stall(&headset);
	assert_int_equal(libusb_bulk_transfer(handle, 0x85, received, sizeof received, &size, 1000),
			 LIBUSB_ERROR_PIPE);
	assert_int_equal(libusb_clear_halt(handle, 0x85), 0);
	switch_stream(handle, 2);
	guest_wait_for_count(&headset.on, 1);
	guest_wait_for_count(&headset.off, 1);
	assert_int_equal(headset.unknown, 0);
	libusb_close(handle);
	libusb_exit(context);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test_teardown(hid_reports_arrive_as_they_were_sent, remove_all),
		cmocka_unit_test_teardown(a_hid_function_answers_feature_requests_and_sends_reports,
					  remove_all),
		cmocka_unit_test_teardown(a_headset_streams_once_it_is_switched_on, remove_all),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
