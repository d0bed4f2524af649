/* The Tobii driver with a fake SDK library. */
#include "suite.h"

#include <dlfcn.h>
#include <math.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/clock.h"
#include "driver_stage.h"
#include "drivers/tobii/tobii_gaze.h"
#include "tobii_stand_in.h"

static struct tobii_stand_in *sdk;
static struct driver_stage stage;

/* Each test begins with one 500 Hz tracker with clocks of its own. */
static int reset(void **state)
{
	(void)state;
	memset(sdk, 0, sizeof *sdk);
	sdk->trackers = 1;
	sdk->rate_hz = 500;
	sdk->system_zero_us = 123456789;
	sdk->device_zero_us = -987654321;
	sdk->display_mm[0] = 520;
	sdk->display_mm[1] = 290;
	stage_reset(&stage, "tobii");
	stage_set(&stage, "tobii.library", TOBII_STAND_IN);
	return 0;
}

/* Check that the driver has released everything of the SDK. */
static int check_nothing_left(void **state)
{
	(void)state;
	int left = atomic_load(&sdk->subscriptions) + atomic_load(&sdk->strings) +
		   atomic_load(&sdk->lists);
	if (left != 0)
		print_error("left: %d subscriptions, %d strings, %d lists\n",
			    atomic_load(&sdk->subscriptions), atomic_load(&sdk->strings),
			    atomic_load(&sdk->lists));
	return left;
}

/* Read until something other than a sample comes. */
static enum gz_result read_to_the_end(struct gz_device *device)
{
	struct gz_sample sample;
	enum gz_result result;
	int64_t deadline_ns = gz_clock_now_ns() + 20 * GZ_NS_PER_S;
	do
		result = gz_device_read(device, 100, &sample);
	while ((result == GZ_OK || result == GZ_ERR_TIMEOUT) && gz_clock_now_ns() < deadline_ns);
	return result;
}

static void tracker_is_identified_with_the_size_of_its_screen(void **state)
{
	(void)state;
	struct gz_device_info info;
	struct gz_device *device = stage_open(&stage, NULL);
	gz_device_get_info(device, &info);
	assert_string_equal(info.name, "Tobii Pro Spectrum");
	assert_string_equal(info.serial, "TPSP1-01");
	assert_true(info.rate_hz == 500);
	assert_true(info.has_display && gz_display_valid(&info.display));
	assert_true(info.display.mm[0] == 520 && info.display.mm[1] == 290);
	gz_device_destroy(&device);
}

static void gaze_data_become_samples(void **state)
{
	(void)state;
	struct gz_device *device = stage_start(&stage);
	struct gz_sample first = device_read_sample(device), second = device_read_sample(device);
	assert_int_equal(first.seq, 0);
	assert_int_equal(second.seq, 1);
	assert_false(first.eye[GZ_EYE_RIGHT].valid);
	assert_true(isnan(first.eye[GZ_EYE_RIGHT].pupil_mm));
	assert_true(isnan(first.eye[GZ_EYE_RIGHT].direction[0]));
	const struct gz_eye_sample *left = &second.eye[GZ_EYE_LEFT];
	const struct gz_eye_sample *right = &second.eye[GZ_EYE_RIGHT];
	assert_true(left->valid && left->point.x == 0.49f && left->point.y == 0.5f);
	assert_true(right->valid && right->point.x == 0.51f);
	assert_true(left->pupil_mm == 3.25f && right->pupil_mm == 3.5f);
	assert_true(left->origin_mm[0] == -100 && left->origin_mm[2] == 630);
	assert_true(left->direction[0] == 0 && left->direction[2] == -1);
	float length =
		hypotf(hypotf(right->direction[0], right->direction[1]), right->direction[2]);
	assert_true(fabsf(length - 1) < 1e-5f && right->direction[0] > 0);
	assert_false(second.valid); /* the SDK has no common point */
	gz_device_destroy(&device);
}

static void sample_time_is_when_it_was_taken_whatever_the_librarys_clock(void **state)
{
	(void)state;
	struct gz_device_counters counters;
	/* The library sends as soon as it is started, whenever this thread goes on. */
	int64_t begin_ns = gz_clock_now_ns(), last_ns = 0;
	struct gz_device *device = stage_start(&stage);
	for (int i = 0; i < 100; i++) {
		struct gz_sample sample = device_read_sample(device);
		int64_t now_ns = gz_clock_now_ns();
		assert_true(sample.host_ns >= last_ns && sample.host_ns <= now_ns);
		/* The library stamps samples half a millisecond before it delivers them. */
		if (sample.host_ns > now_ns - 400 * GZ_NS_PER_US ||
		    sample.host_ns < begin_ns - 2 * GZ_NS_PER_MS)
			fail_msg("%lld ns before now", (long long)(now_ns - sample.host_ns));
		int64_t offset_ns = sample.host_ns - sample.device_ns;
		int64_t expected_ns = 987654321 * GZ_NS_PER_US;
		if (llabs(offset_ns - expected_ns) > 500 * GZ_NS_PER_US)
			fail_msg("device clock is off by %lld ns",
				 (long long)(offset_ns - expected_ns));
		last_ns = sample.host_ns;
	}
	gz_device_get_counters(device, &counters);
	assert_int_equal(counters.clock.tick, GZ_CLOCK_DECLARED);
	gz_device_destroy(&device);
}

static void without_the_librarys_clock_the_arrival_is_used(void **state)
{
	(void)state;
	sdk->fails = "get_system_time_stamp";
	struct gz_device *device = stage_start(&stage);
	for (int i = 0; i < 50; i++) {
		struct gz_sample sample = device_read_sample(device);
		int64_t age_ns = gz_clock_now_ns() - sample.host_ns;
		if (age_ns < 0 || age_ns > GZ_NS_PER_S)
			fail_msg("%lld ns old", (long long)age_ns);
	}
	gz_device_destroy(&device);
}

static void clock_of_the_tracker_may_jump(void **state)
{
	(void)state;
	struct gz_device *device = stage_start(&stage);
	int64_t last_ns = device_read_sample(device).host_ns;
	atomic_store(&sdk->step_clock_s, -3600);
	for (int i = 0; i < 50; i++) {
		struct gz_sample sample = device_read_sample(device);
		assert_true(sample.host_ns >= last_ns && sample.host_ns <= gz_clock_now_ns());
		last_ns = sample.host_ns;
	}
	gz_device_destroy(&device);
}

static void one_of_two_is_chosen_by_any_of_its_names(void **state)
{
	(void)state;
	static const char *const choices[][2] = {
		{ "", "TPSP1-01" },          { "TPSP1-01", "TPSP1-01" },
		{ "TPFC2-02", "TPFC2-02" },  { "Tobii Pro Fusion", "TPFC2-02" },
		{ "Left desk", "TPSP1-01" }, { "tobii-prp://TPFC2-02", "TPFC2-02" },
	};
	struct gz_device_info info;
	struct gz_device *device;
	sdk->trackers = 2;
	for (size_t i = 0; i < sizeof choices / sizeof *choices; i++) {
		device = stage_open(&stage, choices[i][0]);
		gz_device_get_info(device, &info);
		assert_string_equal(info.serial, choices[i][1]);
		gz_device_destroy(&device);
	}
	device = NULL;
	assert_int_equal(stage_create(&stage, "TPFC2", &device), GZ_ERR_NO_DEVICE);
	sdk->trackers = 1;
	assert_int_equal(stage_create(&stage, "TPFC2-02", &device), GZ_ERR_NO_DEVICE);
	sdk->trackers = 0;
	assert_int_equal(stage_create(&stage, "", &device), GZ_ERR_NO_DEVICE);
	assert_null(device);
}

static void list_names_them_all(void **state)
{
	(void)state;
	struct gz_device_entry entries[GZ_DEVICE_ENTRIES_MAX];
	sdk->trackers = 2;
	assert_int_equal(stage_list(&stage, entries), 2);
	assert_string_equal(entries[1].name, "Tobii Pro Fusion");
	assert_string_equal(entries[1].serial, "TPFC2-02");
	assert_string_equal(entries[1].place, "tobii-prp://TPFC2-02");
	assert_true(entries[0].usable && entries[1].usable);
	sdk->trackers = 0;
	assert_int_equal(stage_list(&stage, entries), 0);
	stage_set(&stage, "tobii.library", "/nonexistent.so");
	assert_int_equal(stage_list(&stage, entries), 0);
}

static void rate_is_set_if_requested(void **state)
{
	(void)state;
	struct gz_device_info info;
	struct gz_device *device = stage_open(&stage, NULL);
	assert_true(sdk->frequency_set_hz == 0);
	gz_device_destroy(&device);
	stage_set(&stage, "tobii.rate_hz", "250");
	device = stage_open(&stage, NULL);
	assert_true(sdk->frequency_set_hz == 250);
	gz_device_get_info(device, &info);
	assert_true(info.rate_hz == 250);
	gz_device_destroy(&device);
	sdk->fails = "set_gaze_output_frequency";
	assert_int_equal(stage_create(&stage, NULL, &device), GZ_ERR_INVAL);
	assert_null(device);
}

static void failing_functions_cost_only_what_they_would_return(void **state)
{
	(void)state;
	static const char *const needless[] = { "get_address",
						"get_device_name",
						"get_serial_number",
						"get_model",
						"get_display_area",
						"get_gaze_output_frequency",
						"subscribe_to_notifications" };
	for (size_t i = 0; i < sizeof needless / sizeof *needless; i++) {
		struct gz_device_info info;
		sdk->fails = needless[i];
		struct gz_device *device = stage_start(&stage);
		gz_device_get_info(device, &info);
		assert_true(info.name[0] != '\0');
		assert_int_equal(info.has_display, strcmp(needless[i], "get_display_area") != 0);
		device_read_sample(device);
		gz_device_destroy(&device);
	}
	struct gz_device *device = NULL;
	sdk->fails = "find_all_eyetrackers";
	assert_int_equal(stage_create(&stage, NULL, &device), GZ_ERR_NO_DEVICE);
	assert_null(device);
	sdk->fails = "subscribe_to_gaze_data";
	device = stage_open(&stage, NULL);
	assert_int_equal(gz_device_start(device), GZ_ERR_NO_DEVICE);
	gz_device_destroy(&device);
}

static void lost_connection_is_a_gone_device_and_may_return(void **state)
{
	(void)state;
	struct gz_sample sample;
	struct gz_device *device = stage_start(&stage);
	device_read_sample(device);
	atomic_store(&sdk->lose_connection, 1);
	assert_int_equal(read_to_the_end(device), GZ_ERR_NO_DEVICE);
	assert_int_equal(gz_device_read(device, 10, &sample), GZ_ERR_NO_DEVICE);
	gz_device_destroy(&device);
	device = stage_start(&stage);
	assert_int_equal(device_read_sample(device).seq, 0);
	gz_device_destroy(&device);
}

static void another_display_area_reopens_the_tracker_and_the_same_one_does_not(void **state)
{
	(void)state;
	struct gz_device *device = stage_start(&stage);
	atomic_store(&sdk->repeat_display, 1);
	while (atomic_load(&sdk->repeat_display))
		device_read_sample(device);
	for (int i = 0; i < 10; i++)
		device_read_sample(device);
	atomic_store(&sdk->change_display, 1);
	assert_int_equal(read_to_the_end(device), GZ_ERR_NO_DEVICE);
	gz_device_destroy(&device);
}

static void deliveries_without_room_are_counted_as_lost(void **state)
{
	(void)state;
	struct gz_device_counters counters;
	sdk->burst = GZ_TOBII_RING_SIZE + 100;
	struct gz_device *device = stage_start(&stage);
	/* When this request is done, the burst is over. */
	atomic_store(&sdk->repeat_display, 1);
	while (atomic_load(&sdk->repeat_display))
		gz_clock_sleep_until_ns(gz_clock_now_ns() + GZ_NS_PER_MS);
	uint64_t lost = 0;
	for (int i = 0; i < GZ_TOBII_RING_SIZE; i++)
		lost += device_read_sample(device).lost_before;
	assert_int_equal(lost, 0);
	lost = device_read_sample(device).lost_before;
	gz_device_get_counters(device, &counters);
	if (lost < 100 || lost > 100 + 5000)
		fail_msg("%llu lost, 100 and some expected", (unsigned long long)lost);
	assert_int_equal(counters.lost, lost);
	gz_device_destroy(&device);
}

static void missing_or_wrong_library_is_refused(void **state)
{
	(void)state;
	struct gz_device *device = NULL;
	stage_set(&stage, "tobii.library", "/nonexistent.so");
	assert_int_equal(stage_create(&stage, NULL, &device), GZ_ERR_NOT_FOUND);
	stage_set(&stage, "tobii.library", "libm.so.6");
	assert_int_equal(stage_create(&stage, NULL, &device), GZ_ERR_FORMAT);
	assert_null(device);
}

static void impossible_times_are_replaced_by_the_arrival(void **state)
{
	(void)state;
	struct gz_tobii_time time = { 0 };
	const int64_t now_ns = 50 * GZ_NS_PER_S;
	assert_true(gz_tobii_time_of(&time, 1, now_ns) == now_ns);
	assert_false(gz_tobii_time_read(&time, now_ns, INT64_MAX, now_ns));
	assert_true(gz_tobii_time_read(&time, now_ns, 7000000, now_ns + 2000));
	assert_true(time.offset_ns == 43 * GZ_NS_PER_S + 1000);
	assert_true(gz_tobii_time_of(&time, 6999000, now_ns) == now_ns - 999000);
	assert_true(gz_tobii_time_of(&time, 7000500, now_ns) == now_ns);
	assert_true(gz_tobii_time_of(&time, 0, now_ns) == now_ns);
	assert_true(gz_tobii_time_of(&time, INT64_MIN, now_ns) == now_ns);
	assert_true(gz_tobii_time_of(&time, INT64_MAX, now_ns) == now_ns);
	assert_true(gz_tobii_device_ns(INT64_MAX) == GZ_NO_DEVICE_TIME);
	assert_true(gz_tobii_device_ns(-5) == -5000);
}

static int load_library(void **state)
{
	(void)state;
	/* dlopen() of the same file in the driver returns the same library. */
	void *handle = dlopen(TOBII_STAND_IN, RTLD_NOW | RTLD_LOCAL | RTLD_NODELETE);
	if (!handle)
		print_error("%s\n", dlerror());
	void *address = handle ? dlsym(handle, TOBII_STAND_IN_CONTROL) : NULL;
	tobii_stand_in_control_function *control;
	memcpy(&control, &address, sizeof control);
	sdk = address ? control() : NULL;
	return sdk ? 0 : -1;
}

#define TEST(name) cmocka_unit_test_setup_teardown(name, reset, check_nothing_left)

TEST_SUITE(tobii)
{
	const struct CMUnitTest tests[] = {
		TEST(tracker_is_identified_with_the_size_of_its_screen),
		TEST(gaze_data_become_samples),
		TEST(sample_time_is_when_it_was_taken_whatever_the_librarys_clock),
		TEST(without_the_librarys_clock_the_arrival_is_used),
		TEST(clock_of_the_tracker_may_jump),
		TEST(one_of_two_is_chosen_by_any_of_its_names),
		TEST(list_names_them_all),
		TEST(rate_is_set_if_requested),
		TEST(failing_functions_cost_only_what_they_would_return),
		TEST(lost_connection_is_a_gone_device_and_may_return),
		TEST(another_display_area_reopens_the_tracker_and_the_same_one_does_not),
		TEST(deliveries_without_room_are_counted_as_lost),
		TEST(missing_or_wrong_library_is_refused),
		cmocka_unit_test(impossible_times_are_replaced_by_the_arrival),
	};
	return cmocka_run_group_tests(tests, load_library, NULL);
}
