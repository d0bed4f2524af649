/* The Tobii driver against a library that plays the SDK. */
#include "check.h"

#include <dlfcn.h>
#include <math.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/clock.h"
#include "drivers/tobii/tobii_driver.h"
#include "drivers/tobii/tobii_ring.h"
#include "drivers/tobii/tobii_sample.h"
#include "tobii_stand_in.h"

enum { PATIENCE_MS = 5000 };

static struct tobii_stand_in *sdk;
static union {
	unsigned char bytes[GZ_DRIVER_SETTINGS_SIZE];
	max_align_t align;
} settings;

static void set_option(const char *key, const char *text)
{
	struct gz_option_binding binding = { gz_driver_tobii.options, *gz_driver_tobii.option_count,
					     &settings, NULL };
	char message[256];
	if (gz_option_parse(gz_options_find(&binding, 1, key, NULL), text, &settings, message,
			    sizeof message) != GZ_OK)
		fail_msg("%s", message);
}

/* Each test begins with one tracker at 500 Hz that has clocks of its own. */
static int reset(void **state)
{
	(void)state;
	struct gz_option_binding binding = { gz_driver_tobii.options, *gz_driver_tobii.option_count,
					     &settings, NULL };
	memset(sdk, 0, sizeof *sdk);
	sdk->trackers = 1;
	sdk->rate_hz = 500;
	sdk->system_zero_us = 123456789;
	sdk->device_zero_us = -987654321;
	sdk->display_mm[0] = 520;
	sdk->display_mm[1] = 290;
	if (gz_options_preset(&binding) != GZ_OK)
		return -1;
	set_option("tobii.library", TOBII_STAND_IN);
	return 0;
}

/* Nothing of the SDK's is kept. */
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

static enum gz_result try_create(const char *choice, struct gz_device **out_device)
{
	const struct gz_driver_host host = { .choice = choice };
	return gz_driver_tobii.create(&settings, &host, out_device);
}

static struct gz_device *open_device(const char *choice)
{
	struct gz_device *device = NULL;
	enum gz_result result = try_create(choice, &device);
	if (result != GZ_OK)
		fail_msg("create: %s", gz_result_text(result));
	return device;
}

static struct gz_device *begin(void)
{
	struct gz_device *device = open_device(NULL);
	assert_int_equal(gz_device_start(device), GZ_OK);
	return device;
}

static struct gz_sample read_one(struct gz_device *device)
{
	struct gz_sample sample;
	enum gz_result result = gz_device_read(device, PATIENCE_MS, &sample);
	if (result != GZ_OK)
		fail_msg("no sample: %s", gz_result_text(result));
	return sample;
}

/* Read until something else than a sample comes. */
static enum gz_result read_to_the_end(struct gz_device *device)
{
	struct gz_sample sample;
	enum gz_result result;
	int64_t deadline_ns = gz_clock_now_ns() + PATIENCE_MS * GZ_NS_PER_MS;
	do
		result = gz_device_read(device, 100, &sample);
	while ((result == GZ_OK || result == GZ_ERR_TIMEOUT) && gz_clock_now_ns() < deadline_ns);
	return result;
}

static void tracker_tells_who_it_is_and_how_large_its_screen_is(void **state)
{
	(void)state;
	struct gz_device_info info;
	struct gz_device *device = open_device(NULL);
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
	struct gz_device *device = begin();
	struct gz_sample first = read_one(device), second = read_one(device);
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
	assert_false(second.valid); /* the SDK tells no common point */
	gz_device_destroy(&device);
}

static void sample_time_is_when_it_was_taken_whatever_the_librarys_clock(void **state)
{
	(void)state;
	struct gz_device_counters counters;
	struct gz_device *device = begin();
	int64_t begin_ns = gz_clock_now_ns(), last_ns = 0;
	for (int i = 0; i < 100; i++) {
		struct gz_sample sample = read_one(device);
		int64_t now_ns = gz_clock_now_ns();
		assert_true(sample.host_ns >= last_ns && sample.host_ns <= now_ns);
		/* The stand-in says half a millisecond before it delivers. */
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

static void without_the_librarys_clock_the_arrival_counts(void **state)
{
	(void)state;
	sdk->fails = "get_system_time_stamp";
	struct gz_device *device = begin();
	for (int i = 0; i < 50; i++) {
		struct gz_sample sample = read_one(device);
		int64_t age_ns = gz_clock_now_ns() - sample.host_ns;
		if (age_ns < 0 || age_ns > GZ_NS_PER_S)
			fail_msg("%lld ns old", (long long)age_ns);
	}
	gz_device_destroy(&device);
}

static void clock_of_the_tracker_may_leap(void **state)
{
	(void)state;
	struct gz_device *device = begin();
	int64_t last_ns = read_one(device).host_ns;
	atomic_store(&sdk->step_clock_s, -3600);
	for (int i = 0; i < 50; i++) {
		struct gz_sample sample = read_one(device);
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
		device = open_device(choices[i][0]);
		gz_device_get_info(device, &info);
		assert_string_equal(info.serial, choices[i][1]);
		gz_device_destroy(&device);
	}
	device = NULL;
	assert_int_equal(try_create("TPFC2", &device), GZ_ERR_NO_DEVICE);
	sdk->trackers = 1;
	assert_int_equal(try_create("TPFC2-02", &device), GZ_ERR_NO_DEVICE);
	sdk->trackers = 0;
	assert_int_equal(try_create("", &device), GZ_ERR_NO_DEVICE);
	assert_null(device);
}

static void list_names_them_all(void **state)
{
	(void)state;
	struct gz_device_entry entries[GZ_DEVICE_ENTRIES_MAX];
	const struct gz_driver_host host = { 0 };
	sdk->trackers = 2;
	assert_int_equal(gz_driver_tobii.list(&settings, &host, entries), 2);
	assert_string_equal(entries[1].name, "Tobii Pro Fusion");
	assert_string_equal(entries[1].serial, "TPFC2-02");
	assert_string_equal(entries[1].place, "tobii-prp://TPFC2-02");
	assert_true(entries[0].usable && entries[1].usable);
	sdk->trackers = 0;
	assert_int_equal(gz_driver_tobii.list(&settings, &host, entries), 0);
	set_option("tobii.library", "/nonexistent.so");
	assert_int_equal(gz_driver_tobii.list(&settings, &host, entries), 0);
}

static void rate_is_set_where_it_is_asked_for(void **state)
{
	(void)state;
	struct gz_device_info info;
	struct gz_device *device = open_device(NULL);
	assert_true(sdk->frequency_set_hz == 0);
	gz_device_destroy(&device);
	set_option("tobii.rate_hz", "250");
	device = open_device(NULL);
	assert_true(sdk->frequency_set_hz == 250);
	gz_device_get_info(device, &info);
	assert_true(info.rate_hz == 250);
	gz_device_destroy(&device);
	sdk->fails = "set_gaze_output_frequency";
	assert_int_equal(try_create(NULL, &device), GZ_ERR_INVAL);
	assert_null(device);
}

static void functions_that_fail_cost_what_they_tell_and_no_more(void **state)
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
		struct gz_device *device = begin();
		gz_device_get_info(device, &info);
		assert_true(info.name[0] != '\0');
		assert_int_equal(info.has_display, strcmp(needless[i], "get_display_area") != 0);
		read_one(device);
		gz_device_destroy(&device);
	}
	struct gz_device *device = NULL;
	sdk->fails = "find_all_eyetrackers";
	assert_int_equal(try_create(NULL, &device), GZ_ERR_NO_DEVICE);
	assert_null(device);
	sdk->fails = "subscribe_to_gaze_data";
	device = open_device(NULL);
	assert_int_equal(gz_device_start(device), GZ_ERR_NO_DEVICE);
	gz_device_destroy(&device);
}

static void lost_connection_is_no_device_and_may_return(void **state)
{
	(void)state;
	struct gz_sample sample;
	struct gz_device *device = begin();
	read_one(device);
	atomic_store(&sdk->lose_connection, 1);
	assert_int_equal(read_to_the_end(device), GZ_ERR_NO_DEVICE);
	assert_int_equal(gz_device_read(device, 10, &sample), GZ_ERR_NO_DEVICE);
	gz_device_destroy(&device);
	device = begin();
	assert_int_equal(read_one(device).seq, 0);
	gz_device_destroy(&device);
}

static void other_display_area_opens_it_anew_and_the_same_does_not(void **state)
{
	(void)state;
	struct gz_device *device = begin();
	atomic_store(&sdk->repeat_display, 1);
	while (atomic_load(&sdk->repeat_display))
		read_one(device);
	for (int i = 0; i < 10; i++)
		read_one(device);
	atomic_store(&sdk->change_display, 1);
	assert_int_equal(read_to_the_end(device), GZ_ERR_NO_DEVICE);
	gz_device_destroy(&device);
}

static void what_finds_no_room_is_counted_as_lost(void **state)
{
	(void)state;
	struct gz_device_counters counters;
	sdk->burst = GZ_TOBII_RING_SIZE + 100;
	struct gz_device *device = begin();
	/* The burst is over when the display is looked at. */
	atomic_store(&sdk->repeat_display, 1);
	while (atomic_load(&sdk->repeat_display))
		gz_clock_sleep_until_ns(gz_clock_now_ns() + GZ_NS_PER_MS);
	uint64_t lost = 0;
	for (int i = 0; i < GZ_TOBII_RING_SIZE; i++)
		lost += read_one(device).lost_before;
	assert_int_equal(lost, 0);
	lost = read_one(device).lost_before;
	gz_device_get_counters(device, &counters);
	if (lost < 100 || lost > 100 + 5000)
		fail_msg("%llu lost, 100 and some expected", (unsigned long long)lost);
	assert_int_equal(counters.lost, lost);
	gz_device_destroy(&device);
}

static void library_that_is_missing_or_another_is_refused(void **state)
{
	(void)state;
	struct gz_device *device = NULL;
	set_option("tobii.library", "/nonexistent.so");
	assert_int_equal(try_create(NULL, &device), GZ_ERR_NOT_FOUND);
	set_option("tobii.library", "libm.so.6");
	assert_int_equal(try_create(NULL, &device), GZ_ERR_FORMAT);
	assert_null(device);
}

static void times_that_cannot_be_are_the_arrival(void **state)
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
	/* The driver's own dlopen() of the same file gives the same library. */
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

int main(void)
{
	const struct CMUnitTest tests[] = {
		TEST(tracker_tells_who_it_is_and_how_large_its_screen_is),
		TEST(gaze_data_become_samples),
		TEST(sample_time_is_when_it_was_taken_whatever_the_librarys_clock),
		TEST(without_the_librarys_clock_the_arrival_counts),
		TEST(clock_of_the_tracker_may_leap),
		TEST(one_of_two_is_chosen_by_any_of_its_names),
		TEST(list_names_them_all),
		TEST(rate_is_set_where_it_is_asked_for),
		TEST(functions_that_fail_cost_what_they_tell_and_no_more),
		TEST(lost_connection_is_no_device_and_may_return),
		TEST(other_display_area_opens_it_anew_and_the_same_does_not),
		TEST(what_finds_no_room_is_counted_as_lost),
		TEST(library_that_is_missing_or_another_is_refused),
		cmocka_unit_test(times_that_cannot_be_are_the_arrival),
	};
	return cmocka_run_group_tests(tests, load_library, NULL);
}
