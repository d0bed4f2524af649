/* The PS VR2 driver from USB to samples, with a fake libusb and a fake clock. */
#include "suite.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/clock.h"
#include "driver_stage.h"
#include "drivers/psvr2/psvr2_link.h"
#include "drivers/usb/usb_stream.h"
#include "fake_libusb.h"
#include "psvr2_made.h"

static struct driver_stage stage;

static int set_up(void **state)
{
	(void)state;
	fake_usb_reset();
	stage_reset(&stage, "psvr2");
	return 0;
}

static enum gz_result create(const char *choice, struct gz_device **device)
{
	return stage_create(&stage, choice, device);
}

static struct gz_device *start_device(void)
{
	fake_usb_plug(GZ_PSVR2_VENDOR, GZ_PSVR2_PRODUCT);
	return stage_start(&stage);
}

/* Destroy the device and check that it has released everything. */
static void finish(struct gz_device **device)
{
	gz_device_destroy(device);
	assert_int_equal(fake_usb.transfers, 0);
	assert_int_equal(fake_usb.in_flight, 0);
	assert_int_equal(fake_usb.claims, 0);
	assert_int_equal(fake_usb.handles, 0);
	assert_int_equal(fake_usb.contexts, 0);
}

static struct gz_psvr2_packet packet_of(uint32_t frame)
{
	struct gz_psvr2_packet packet = { .device_ns = frame * 8 * GZ_NS_PER_MS, .frame = frame };
	for (int i = 0; i < GZ_EYE_COUNT; i++) {
		packet.eye[i] = (struct gz_psvr2_eye) {
			.ray = { true, true, { i ? -30 : 30, 0, 0 }, { 0, 0, 1 } },
			.has_pupil = true,
			.pupil_mm = 3 + (float)i,
		};
	}
	packet.combined = (struct gz_psvr2_ray) { true, true, { 0, 0, 0 }, { 0, 0, 1 } };
	return packet;
}

static void deliver(const struct gz_psvr2_packet *packet)
{
	unsigned char bytes[GZ_PSVR2_PACKET_SIZE];
	psvr2_made_packet(packet, bytes);
	fake_usb_deliver(bytes, sizeof bytes);
}

static void deliver_frame(uint32_t frame)
{
	struct gz_psvr2_packet packet = packet_of(frame);
	deliver(&packet);
}

static void psvr2_packets_become_samples_with_the_devices_time(void **state)
{
	(void)state;
	struct gz_device *device = start_device();
	struct gz_sample sample;
	for (uint32_t i = 0; i < 20; i++) {
		deliver_frame(100 + i);
		assert_int_equal(gz_device_read(device, 10, &sample), GZ_OK);
		assert_int_equal(sample.seq, i);
		assert_int_equal(sample.device_ns, (100 + i) * 8 * GZ_NS_PER_MS);
		assert_true(sample.host_ns <= gz_clock_now_ns());
		assert_int_equal(sample.lost_before, 0);
	}
	assert_true(sample.valid && sample.eye[0].valid && sample.eye[1].valid);
	assert_float_equal(sample.point.x, 0.5f, 1e-6);
	/* The right eye looks straight ahead from 30 mm beside the centre. */
	assert_float_equal(sample.eye[GZ_EYE_RIGHT].point.x, 0.5 + 30 / 564.677, 1e-5);
	assert_float_equal(sample.eye[GZ_EYE_LEFT].point.x, 0.5 - 30 / 564.677, 1e-5);
	assert_float_equal(sample.eye[GZ_EYE_LEFT].pupil_mm, 4, 1e-6);
	assert_float_equal(sample.eye[GZ_EYE_RIGHT].origin_mm[0], 30, 1e-6);
	assert_float_equal(sample.eye[GZ_EYE_RIGHT].direction[2], 1, 1e-6);
	assert_int_equal(fake_usb.most_in_flight, GZ_PSVR2_TRANSFERS);
	assert_int_equal(fake_usb.in_flight, GZ_PSVR2_TRANSFERS);
	finish(&device);
	assert_int_equal(fake_usb.switched_off, 1);
}

static void psvr2_blink_and_unknown_fields_are_not_valid(void **state)
{
	(void)state;
	struct gz_device *device = start_device();
	struct gz_sample sample;
	struct gz_psvr2_packet packet = packet_of(1);
	packet.eye[GZ_EYE_LEFT].blink = true;
	packet.eye[GZ_EYE_RIGHT].ray.has_direction = false;
	packet.eye[GZ_EYE_RIGHT].has_pupil = false;
	packet.combined.has_origin = false;
	deliver(&packet);
	assert_int_equal(gz_device_read(device, 10, &sample), GZ_OK);
	assert_false(sample.valid || sample.eye[0].valid || sample.eye[1].valid);
	assert_true(isnan(sample.point.x));
	assert_true(isnan(sample.eye[GZ_EYE_RIGHT].point.x));
	assert_true(isnan(sample.eye[GZ_EYE_RIGHT].direction[0]));
	assert_true(isnan(sample.eye[GZ_EYE_RIGHT].pupil_mm));
	packet = packet_of(2);
	packet.eye[0].blink = packet.eye[1].blink = true;
	deliver(&packet);
	assert_int_equal(gz_device_read(device, 10, &sample), GZ_OK);
	assert_false(sample.valid || sample.eye[0].valid || sample.eye[1].valid);
	finish(&device);
}

static void psvr2_bad_packets_are_counted_by_reason_and_the_stream_continues(void **state)
{
	(void)state;
	struct gz_device *device = start_device();
	struct gz_sample sample;
	struct gz_device_counters counters;
	unsigned char bytes[1024] = "GS";
	deliver_frame(5);
	fake_usb_deliver(bytes, 100);  /* short */
	fake_usb_deliver(bytes, 1024); /* long */
	fake_usb_fail(LIBUSB_TRANSFER_OVERFLOW);
	bytes[0] = 'X';
	fake_usb_deliver(bytes, GZ_PSVR2_PACKET_SIZE);
	fake_usb_deliver(bytes, 0); /* follows a packet that fills its last USB packet */
	bytes[0] = 'G';
	memset(bytes + 0x50, 0x7f, 8);
	fake_usb_deliver(bytes, GZ_PSVR2_PACKET_SIZE);
	deliver_frame(5); /* a repeated frame */
	deliver_frame(4); /* an earlier frame */
	deliver_frame(6);
	assert_int_equal(gz_device_read(device, 10, &sample), GZ_OK);
	assert_int_equal(gz_device_read(device, 10, &sample), GZ_OK);
	assert_int_equal(sample.seq, 1);
	assert_int_equal(sample.device_ns, 6 * 8 * GZ_NS_PER_MS);
	gz_device_get_counters(device, &counters);
	static const uint64_t expected[GZ_MALFORMED_COUNT] = {
		[GZ_MALFORMED_SHORT] = 1,  [GZ_MALFORMED_LONG] = 2,  [GZ_MALFORMED_STALE] = 2,
		[GZ_MALFORMED_SYNTAX] = 1, [GZ_MALFORMED_VALUE] = 1,
	};
	for (int i = 0; i < GZ_MALFORMED_COUNT; i++)
		if (counters.malformed[i] != expected[i])
			fail_msg("%s: %llu, expected %llu", gz_malformed_name(i),
				 (unsigned long long)counters.malformed[i],
				 (unsigned long long)expected[i]);
	assert_int_equal(counters.lost, 0);
	assert_int_equal(counters.clock.tick, GZ_CLOCK_DECLARED);
	finish(&device);
}

static void psvr2_frames_that_did_not_arrive_are_lost(void **state)
{
	(void)state;
	struct gz_device *device = start_device();
	struct gz_sample sample;
	struct gz_device_counters counters;
	static const struct {
		uint32_t frame, lost_before;
	} steps[] = { { UINT32_MAX - 2, 0 }, { UINT32_MAX, 1 }, { 3, 3 }, { 4, 0 } };
	for (size_t i = 0; i < sizeof steps / sizeof *steps; i++) {
		struct gz_psvr2_packet packet = packet_of(steps[i].frame);
		packet.device_ns = (int64_t)i * GZ_NS_PER_MS;
		deliver(&packet);
		assert_int_equal(gz_device_read(device, 10, &sample), GZ_OK);
		assert_int_equal(sample.lost_before, steps[i].lost_before);
	}
	/* The number of one frame is garbage. */
	struct gz_psvr2_packet leap = packet_of(0x40000000), back = packet_of(6);
	leap.device_ns = 4 * GZ_NS_PER_MS;
	back.device_ns = 5 * GZ_NS_PER_MS;
	deliver(&leap);
	deliver(&back);
	for (int i = 0; i < 2; i++) {
		assert_int_equal(gz_device_read(device, 10, &sample), GZ_OK);
		assert_int_equal(sample.lost_before, 0);
	}
	/* A headset that has restarted, and its clock with it. */
	struct gz_psvr2_packet anew = packet_of(1);
	anew.device_ns = -10 * GZ_NS_PER_S;
	deliver(&anew);
	assert_int_equal(gz_device_read(device, 10, &sample), GZ_OK);
	assert_int_equal(sample.lost_before, 0);
	gz_device_get_counters(device, &counters);
	assert_int_equal(counters.lost, 4);
	finish(&device);
}

static void psvr2_late_reader_loses_the_oldest_packets_and_knows_how_many(void **state)
{
	(void)state;
	struct gz_device *device = start_device();
	struct gz_sample sample;
	uint64_t samples = 1, lost = 0;
	deliver_frame(0);
	assert_int_equal(gz_device_read(device, 10, &sample), GZ_OK);
	fake_usb.at_once = 3 * GZ_PSVR2_QUEUE;
	for (uint32_t i = 1; i < 120; i++)
		deliver_frame(i);
	while (gz_device_read(device, 0, &sample) == GZ_OK) {
		samples++;
		lost += sample.lost_before;
	}
	assert_int_equal(samples + lost, 120);
	assert_int_equal(lost, 2 * GZ_PSVR2_QUEUE);
	assert_int_equal(sample.device_ns, 119 * 8 * GZ_NS_PER_MS);
	finish(&device);
}

static void psvr2_stream_is_requested_about_once_a_second(void **state)
{
	(void)state;
	struct gz_device *device = start_device();
	struct gz_sample sample;
	assert_int_equal(fake_usb.switched_on, 1);
	int64_t begin_ns = gz_clock_now_ns();
	for (int i = 0; i < 1000; i++)
		assert_int_equal(gz_device_read(device, 10, &sample), GZ_ERR_TIMEOUT);
	assert_in_range(gz_clock_now_ns() - begin_ns, 10 * GZ_NS_PER_S, 11 * GZ_NS_PER_S);
	assert_in_range(fake_usb.switched_on, 10, 11);
	finish(&device);
}

static void psvr2_wait_ends_at_its_time_and_0_polls(void **state)
{
	(void)state;
	struct gz_device *device = start_device();
	struct gz_sample sample;
	int64_t begin_ns = gz_clock_now_ns();
	assert_int_equal(gz_device_read(device, 0, &sample), GZ_ERR_TIMEOUT);
	assert_true(gz_clock_now_ns() - begin_ns < GZ_NS_PER_MS);
	assert_int_equal(gz_device_read(device, 7, &sample), GZ_ERR_TIMEOUT);
	assert_in_range(gz_clock_now_ns() - begin_ns, 7 * GZ_NS_PER_MS, 8 * GZ_NS_PER_MS);
	deliver_frame(1);
	assert_int_equal(gz_device_read(device, 0, &sample), GZ_OK);
	assert_int_equal(gz_device_read(device, -1, &sample), GZ_ERR_INVAL);
	finish(&device);
}

static void psvr2_stalled_endpoint_is_cleared_and_the_stream_continues(void **state)
{
	(void)state;
	struct gz_device *device = start_device();
	struct gz_sample sample;
	deliver_frame(1);
	fake_usb_fail(LIBUSB_TRANSFER_STALL);
	assert_int_equal(gz_device_read(device, 100, &sample), GZ_OK);
	assert_int_equal(fake_usb.halts_cleared, 0);
	int on_before = fake_usb.switched_on;
	assert_int_equal(gz_device_read(device, 100, &sample), GZ_ERR_TIMEOUT);
	assert_int_equal(fake_usb.halts_cleared, 1);
	assert_int_equal(fake_usb.in_flight, GZ_PSVR2_TRANSFERS);
	assert_int_equal(fake_usb.switched_on, on_before + 1);
	deliver_frame(2);
	assert_int_equal(gz_device_read(device, 100, &sample), GZ_OK);
	assert_int_equal(sample.seq, 1);
	stage_expect_logged(&stage, "stalled");
	finish(&device);
}

static void psvr2_endpoint_that_stays_stalled_counts_as_gone(void **state)
{
	(void)state;
	struct gz_device *device = start_device();
	struct gz_sample sample;
	for (int i = 0; i < 20; i++)
		fake_usb_fail(LIBUSB_TRANSFER_STALL);
	int64_t begin_ns = gz_clock_now_ns();
	assert_int_equal(gz_device_read(device, 5000, &sample), GZ_ERR_NO_DEVICE);
	assert_int_equal(fake_usb.halts_cleared, GZ_USB_STREAM_RECOVERIES);
	assert_in_range(gz_clock_now_ns() - begin_ns, 630 * GZ_NS_PER_MS, GZ_NS_PER_S);
	assert_int_equal(gz_device_read(device, 10, &sample), GZ_ERR_NO_DEVICE);
	finish(&device);
}

static void psvr2_unplugged_is_reported_after_the_packets_sent_before(void **state)
{
	(void)state;
	struct gz_device *device = start_device();
	struct gz_sample sample;
	deliver_frame(1);
	deliver_frame(2);
	assert_int_equal(gz_device_read(device, 10, &sample), GZ_OK);
	fake_usb.unplugged = true;
	assert_int_equal(gz_device_read(device, 10, &sample), GZ_OK);
	assert_int_equal(gz_device_read(device, 1000, &sample), GZ_ERR_NO_DEVICE);
	assert_int_equal(gz_device_read(device, 0, &sample), GZ_ERR_NO_DEVICE);
	finish(&device);
	assert_int_equal(fake_usb.switched_off, 0);
}

static void psvr2_unplugged_during_a_reset_is_reported(void **state)
{
	(void)state;
	struct gz_device *device = start_device();
	struct gz_sample sample;
	fake_usb_fail(LIBUSB_TRANSFER_ERROR);
	assert_int_equal(gz_device_read(device, 1, &sample), GZ_ERR_TIMEOUT);
	fake_usb.unplugged = true;
	assert_int_equal(gz_device_read(device, 1000, &sample), GZ_ERR_NO_DEVICE);
	finish(&device);
}

static void psvr2_that_cannot_be_opened_is_refused_with_the_remedy(void **state)
{
	(void)state;
	struct gz_device *device;
	assert_int_equal(create(NULL, &device), GZ_ERR_NO_DEVICE);
	stage_expect_logged(&stage, "plug one in");
	fake_usb_plug(0x1234, 0x5678);
	assert_int_equal(create(NULL, &device), GZ_ERR_NO_DEVICE);
	struct fake_usb_device *headset = fake_usb_plug(GZ_PSVR2_VENDOR, GZ_PSVR2_PRODUCT);
	headset->open_error = LIBUSB_ERROR_ACCESS;
	assert_int_equal(create(NULL, &device), GZ_ERR_ACCESS);
	stage_expect_logged(&stage, "71-gazecast.rules");
	headset->open_error = 0;
	headset->claim_error = LIBUSB_ERROR_BUSY;
	assert_int_equal(create(NULL, &device), GZ_ERR_BUSY);
	stage_expect_logged(&stage, "another program");
	headset->claim_error = 0;
	assert_int_equal(create("somebody else's", &device), GZ_ERR_NO_DEVICE);
	stage_expect_logged(&stage, "is called somebody");
	assert_null(device);
	fake_usb.init_error = LIBUSB_ERROR_OTHER;
	assert_int_equal(create(NULL, &device), GZ_ERR_IO);
	assert_int_equal(fake_usb.handles + fake_usb.contexts + fake_usb.claims, 0);
}

static void psvr2_second_headset_is_opened_if_the_first_is_in_use(void **state)
{
	(void)state;
	struct gz_device *device;
	fake_usb_plug(GZ_PSVR2_VENDOR, GZ_PSVR2_PRODUCT)->claim_error = LIBUSB_ERROR_BUSY;
	fake_usb_plug(GZ_PSVR2_VENDOR, GZ_PSVR2_PRODUCT);
	fake_usb_plug(GZ_PSVR2_VENDOR, GZ_PSVR2_PRODUCT);
	assert_int_equal(create("PlayStation VR2", &device), GZ_OK);
	stage_expect_logged(&stage, "not used: PlayStation VR2  at usb 250-3.3");
	struct gz_device_info info;
	gz_device_get_info(device, &info);
	assert_string_equal(info.name, "PlayStation VR2");
	assert_true(info.has_display && gz_display_valid(&info.display));
	finish(&device);
}

static void psvr2_screen_without_a_size_is_the_configured_display(void **state)
{
	(void)state;
	struct gz_device_info info;
	struct gz_device *device;
	stage.host.display_mm[0] = 500;
	stage.host.display_mm[1] = 300;
	fake_usb_plug(GZ_PSVR2_VENDOR, GZ_PSVR2_PRODUCT);
	assert_int_equal(create(NULL, &device), GZ_OK);
	gz_device_get_info(device, &info);
	assert_true(info.display.mm[0] == 500 && info.display.mm[1] == 300);
	finish(&device);
	stage_reset(&stage, "psvr2");
	assert_int_equal(create(NULL, &device), GZ_OK);
	gz_device_get_info(device, &info);
	assert_float_equal(info.display.mm[0], 564.677, 1e-2);
	finish(&device);
}

static void psvr2_that_does_not_switch_on_fails_to_start(void **state)
{
	(void)state;
	struct gz_device *device;
	fake_usb_plug(GZ_PSVR2_VENDOR, GZ_PSVR2_PRODUCT);
	assert_int_equal(create(NULL, &device), GZ_OK);
	fake_usb.control_error = LIBUSB_ERROR_PIPE;
	assert_int_equal(gz_device_start(device), GZ_ERR_IO);
	stage_expect_logged(&stage, "LIBUSB_ERROR_PIPE");
	finish(&device);
	assert_int_equal(create(NULL, &device), GZ_OK);
	finish(&device); /* never started */
}

static void psvr2_list_shows_headsets_and_why_they_cannot_be_used(void **state)
{
	(void)state;
	struct gz_device_entry entries[GZ_DEVICE_ENTRIES_MAX];
	assert_int_equal(stage_list(&stage, entries), 0);
	fake_usb_plug(0x1234, 0x5678);
	fake_usb_plug(GZ_PSVR2_VENDOR, GZ_PSVR2_PRODUCT);
	assert_int_equal(stage_list(&stage, entries), 1);
	assert_string_equal(entries[0].place, "usb 250-3.2");
	/* This device node does not exist. */
	assert_false(entries[0].usable);
	assert_non_null(strstr(entries[0].reason, "/dev/bus/usb/250/002"));
	assert_non_null(strstr(entries[0].reason, "71-gazecast.rules"));
	assert_int_equal(fake_usb.contexts + fake_usb.handles, 0);
}

TEST_SUITE(psvr2)
{
#define TEST(name) cmocka_unit_test_setup(name, set_up)
	const struct CMUnitTest tests[] = {
		TEST(psvr2_packets_become_samples_with_the_devices_time),
		TEST(psvr2_blink_and_unknown_fields_are_not_valid),
		TEST(psvr2_bad_packets_are_counted_by_reason_and_the_stream_continues),
		TEST(psvr2_frames_that_did_not_arrive_are_lost),
		TEST(psvr2_late_reader_loses_the_oldest_packets_and_knows_how_many),
		TEST(psvr2_stream_is_requested_about_once_a_second),
		TEST(psvr2_wait_ends_at_its_time_and_0_polls),
		TEST(psvr2_stalled_endpoint_is_cleared_and_the_stream_continues),
		TEST(psvr2_endpoint_that_stays_stalled_counts_as_gone),
		TEST(psvr2_unplugged_is_reported_after_the_packets_sent_before),
		TEST(psvr2_unplugged_during_a_reset_is_reported),
		TEST(psvr2_that_cannot_be_opened_is_refused_with_the_remedy),
		TEST(psvr2_second_headset_is_opened_if_the_first_is_in_use),
		TEST(psvr2_screen_without_a_size_is_the_configured_display),
		TEST(psvr2_that_does_not_switch_on_fails_to_start),
		TEST(psvr2_list_shows_headsets_and_why_they_cannot_be_used),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
