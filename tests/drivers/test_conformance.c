/* What every driver of gz_drivers[] must do. */
#include "suite.h"

#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <pthread.h>
#include <signal.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "allocations.h"
#include "base/clock.h"
#include "driver_stage.h"
#include "drivers/pointer/pointer_driver.h"
#include "drivers/psvr2/psvr2_link.h"
#include "fake_libusb.h"
#include "gazepoint_server.h"
#include "hid_made.h"
#include "hid_played.h"
#include "made_log.h"
#include "psvr2_made.h"
#include "pupil_capture.h"
#include "template_made.h"
#include "tobii5_made.h"
#include "tobii_stand_in.h"

/* Samples read from each driver. */
enum { SAMPLES = 200 };

static char directory[64];

/* A driver and what it needs to find a device: options, and a thread that plays the device. */
struct played {
	struct driver_stage stage;
	char path[128];
	pthread_t player;
	bool has_player;
	atomic_bool quit;
	struct gazepoint_server server;
	bool has_server;
	int number; /* of the fake HID device */
	bool plays_hid;
	struct pupil_capture capture;
};

/* Play the device of the template at 500 Hz. Every 50th report is lost, every 70th is damaged. */
static void *play_template(void *user)
{
	struct played *played = user;
	int fd = open(played->path, O_WRONLY | O_CLOEXEC);
	int64_t begin_ns = gz_clock_now_ns();
	for (uint32_t i = 0; fd >= 0 && !atomic_load(&played->quit); i++) {
		struct gz_template_report report = {
			.counter = i,
			.clock_us = UINT32_MAX - 100000 + 2000 * i, /* wraps during the test */
			.found = { true, i % 3 != 0 },
			.point = { { 0.4f, 0.5f }, { 0.6f, 0.5f } },
		};
		unsigned char bytes[GZ_TEMPLATE_REPORT_SIZE];
		template_made_report(&report, bytes);
		if (i % 70 == 69)
			bytes[5] ^= 0xff;
		gz_clock_sleep_until_ns(begin_ns + (int64_t)i * 2 * GZ_NS_PER_MS);
		if (i % 50 != 49 && write(fd, bytes, sizeof bytes) < 0)
			break;
	}
	if (fd >= 0)
		close(fd);
	return NULL;
}

static void prepare_replay(struct played *played)
{
	struct made_log made;
	snprintf(played->path, sizeof played->path, "%s/made.gzl", directory);
	assert_true(made_log_begin(&made, played->path));
	for (uint64_t i = 0; i < 10 * SAMPLES; i++)
		made_log_sample(&made, i, (int64_t)i * 2 * GZ_NS_PER_MS);
	made_log_end(&made);
	stage_set(&played->stage, "replay.file", played->path);
}

static void prepare_template(struct played *played)
{
	snprintf(played->path, sizeof played->path, "%s/fifo", directory);
	unlink(played->path);
	assert_int_equal(mkfifo(played->path, 0600), 0);
	stage_set(&played->stage, "template.path", played->path);
	atomic_store(&played->quit, false);
	assert_int_equal(pthread_create(&played->player, NULL, play_template, played), 0);
	played->has_player = true;
}

static void prepare_gazepoint(struct played *played)
{
	char port[16];
	gazepoint_server_start(&played->server, &(struct gazepoint_play) { .stream = true }, 0);
	snprintf(port, sizeof port, "%d", played->server.port);
	stage_set(&played->stage, "gazepoint.port", port);
	played->has_server = true;
}

/* Sends good and bad messages, each twice. */
static void prepare_pupil(struct played *played)
{
	atomic_store(&played->capture.garbage, true);
	atomic_store(&played->capture.twice, true);
	pupil_capture_start(&played->capture);
	stage_set(&played->stage, "pupil.address", played->capture.address);
}

/* Play a headset at 500 Hz. Every 50th packet is lost, every 70th is damaged. */
static size_t play_psvr2(void *user, unsigned char *bytes, size_t room)
{
	uint32_t *frame = user;
	struct gz_psvr2_packet packet = {
		.device_ns = *frame * 2 * GZ_NS_PER_MS,
		.frame = *frame,
		.combined = { true, true, { 0 }, { 0, 0, 1 } },
	};
	assert_true(room >= GZ_PSVR2_PACKET_SIZE);
	psvr2_made_packet(&packet, bytes);
	if (*frame % 70 == 69)
		bytes[0] ^= 0xff;
	return (*frame)++ % 50 == 49 ? 0 : GZ_PSVR2_PACKET_SIZE;
}

static void prepare_psvr2(void)
{
	static uint32_t frame;
	frame = UINT32_MAX - 100; /* wraps during the test */
	fake_usb_plug(GZ_PSVR2_VENDOR, GZ_PSVR2_PRODUCT);
	fake_usb.packet = play_psvr2;
	fake_usb.user = &frame;
	fake_usb.period_ns = 2 * GZ_NS_PER_MS;
	fake_usb.due_ns = gz_clock_now_ns();
}

/* Play a HID tracker at 500 Hz whose clock wraps. Every 70th report is cut. */
static void *play_hid(void *user)
{
	struct played *played = user;
	int64_t begin_ns = gz_clock_now_ns();
	for (uint32_t i = 0; !atomic_load(&played->quit); i++) {
		struct hid_made_sample sample = {
			.time_us = UINT32_MAX - 100000 + 2000 * (uint64_t)i,
			.gaze = { 100000 + (int32_t)i, 50000 },
			.left = { 70000, 60000, 600000 },
			.right = { 130000, 60000, 600000 },
		};
		unsigned char bytes[128];
		size_t size = hid_made_report(HID_LAYOUT_REFERENCE, &sample, bytes);
		gz_clock_sleep_until_ns(begin_ns + (int64_t)i * 2 * GZ_NS_PER_MS);
		hid_played_send(played->number, bytes, i % 70 == 69 ? 9 : size);
	}
	return NULL;
}

static void prepare_hid(struct played *played)
{
	struct hid_made made = { 0 };
	unsigned char bytes[64];
	hid_made_tracker(&made, HID_LAYOUT_REFERENCE);
	played->number = hid_played_plug("Made", "1", made.bytes, made.size);
	hid_played_set_feature(played->number, 0x12, bytes,
			       hid_made_configuration(HID_LAYOUT_REFERENCE, 500000, 300000, bytes));
	hid_played_set_feature(played->number, 0x13, bytes,
			       hid_made_status(HID_LAYOUT_REFERENCE, 1, 500, bytes));
	atomic_store(&played->quit, false);
	assert_int_equal(pthread_create(&played->player, NULL, play_hid, played), 0);
	played->plays_hid = true;
}

/* Play a tracker at 500 Hz. Every 50th sample is lost, every 70th is damaged. */
static size_t play_tobii5(void *user, unsigned char *bytes, size_t room)
{
	static unsigned char frame[TOBII5_MADE_MAX];
	uint32_t *number = user;
	struct tobii5_made_gaze gaze = tobii5_made_looking(*number, 0.5, 0.5);
	gaze.time_us = 2000 * (int64_t)*number;
	size_t size = tobii5_made_gaze(&gaze, frame);
	assert_true(room >= size);
	memcpy(bytes, frame, size);
	if (*number % 70 == 69)
		bytes[0] ^= 0xff;
	return (*number)++ % 50 == 49 ? 0 : size;
}

static size_t answer_tobii5(void *user, const unsigned char *bytes, size_t size,
			    unsigned char *reply, size_t room)
{
	assert_true(room >= TOBII5_MADE_MAX);
	return tobii5_played_answer(user, bytes, size, reply);
}

static void prepare_tobii5(void)
{
	static struct tobii5_played tracker;
	static uint32_t number;
	number = 0;
	tracker = (struct tobii5_played) { 0 };
	tobii5_played_set_screen(&tracker);
	fake_usb_plug(0x2104, 0x0313);
	fake_usb.has_sessions = true;
	fake_usb.request = answer_tobii5;
	fake_usb.request_user = &tracker;
	fake_usb.packet = play_tobii5;
	fake_usb.user = &number;
	fake_usb.period_ns = 2 * GZ_NS_PER_MS;
	fake_usb.due_ns = gz_clock_now_ns();
}

static void prepare_pointer(struct played *played)
{
	stage_set(&played->stage, "pointer.rate_hz", "500");
	assert_int_equal(gz_pointer_feed_create(&played->stage.host.pointer), GZ_OK);
	const struct gz_pointer_report report = { .host_ns = gz_clock_now_ns(),
						  .known = true,
						  .point = { 0.5f, 0.5f } };
	assert_true(gz_pointer_feed_put(played->stage.host.pointer, &report));
}

static void prepare_tobii(struct played *played)
{
	/* dlopen() of the same file in the driver returns the same library. */
	void *library = dlopen(TOBII_STAND_IN, RTLD_NOW | RTLD_LOCAL | RTLD_NODELETE);
	void *address = library ? dlsym(library, TOBII_STAND_IN_CONTROL) : NULL;
	tobii_stand_in_control_function *control;
	assert_non_null(address);
	memcpy(&control, &address, sizeof control);
	control()->trackers = 1;
	control()->rate_hz = 500;
	control()->system_zero_us = 1000000;
	control()->device_zero_us = -1000000;
	stage_set(&played->stage, "tobii.library", TOBII_STAND_IN);
	dlclose(library);
}

/* Set the presets, and what the driver needs beyond them. */
static void set_up(struct played *played, const struct gz_driver *driver)
{
	memset(played, 0, sizeof *played);
	fake_usb_reset();
	hid_played_reset();
	stage_reset(&played->stage, driver->name);
	if (strcmp(driver->name, "replay") == 0)
		prepare_replay(played);
	else if (strcmp(driver->name, "template") == 0)
		prepare_template(played);
	else if (strcmp(driver->name, "gazepoint") == 0)
		prepare_gazepoint(played);
	else if (strcmp(driver->name, "pointer") == 0)
		prepare_pointer(played);
	else if (strcmp(driver->name, "tobii") == 0)
		prepare_tobii(played);
	else if (strcmp(driver->name, "tobii5") == 0)
		prepare_tobii5();
	else if (strcmp(driver->name, "psvr2") == 0)
		prepare_psvr2();
	else if (strcmp(driver->name, "hid") == 0)
		prepare_hid(played);
	else if (strcmp(driver->name, "pupil") == 0)
		prepare_pupil(played);
}

static void tear_down(struct played *played)
{
	gz_pointer_feed_destroy(&played->stage.host.pointer);
	if (played->has_server)
		gazepoint_server_stop(&played->server);
	if (played->plays_hid) {
		atomic_store(&played->quit, true);
		pthread_join(played->player, NULL);
	}
	pupil_capture_stop(&played->capture);
	if (!played->has_player)
		return;
	atomic_store(&played->quit, true);
	/* The player may still wait for a reader of the FIFO. */
	int fd = open(played->path, O_RDONLY | O_NONBLOCK | O_CLOEXEC);
	pthread_join(played->player, NULL);
	if (fd >= 0)
		close(fd);
}

static struct gz_device *create(struct played *played)
{
	struct gz_device *device;
	enum gz_result result;
	int64_t deadline_ns = gz_clock_now_ns() + 20 * GZ_NS_PER_S;
	/* A device on the network may answer late on a busy machine. */
	do
		result = stage_create(&played->stage, NULL, &device);
	while (result == GZ_ERR_NO_DEVICE && played->capture.context &&
	       gz_clock_now_ns() < deadline_ns);
	if (result != GZ_OK)
		fail_msg("%s: %s", played->stage.driver->name, gz_result_text(result));
	assert_non_null(device);
	return device;
}

typedef void check_function(struct played *played);

static void for_every_driver(check_function *check)
{
	static struct played played;
	for (size_t i = 0; gz_drivers[i]; i++) {
		/* It opens devices of other drivers: see test_auto.c. */
		if (strcmp(gz_drivers[i]->name, "auto") == 0)
			continue;
		set_up(&played, gz_drivers[i]);
		print_message("           %s\n", gz_drivers[i]->name);
		check(&played);
		tear_down(&played);
	}
}

static void check_table(struct played *played)
{
	const struct gz_driver *driver = played->stage.driver;
	char prefix[64];
	assert_ptr_equal(gz_driver_find(driver->name), driver);
	assert_non_null(driver->help);
	snprintf(prefix, sizeof prefix, "%s.", driver->name);
	for (size_t i = 0; driver->options && i < *driver->option_count; i++) {
		if (strncmp(driver->options[i].key, prefix, strlen(prefix)) != 0)
			fail_msg("%s does not begin with %s", driver->options[i].key, prefix);
		assert_non_null(driver->options[i].preset);
		assert_non_null(driver->options[i].help);
	}
	struct gz_device *device = create(played);
	assert_non_null(device->ops->start);
	assert_non_null(device->ops->read);
	assert_non_null(device->ops->info);
	assert_non_null(device->ops->counters);
	assert_non_null(device->ops->destroy);
	gz_device_destroy(&device);
}

static void driver_table_is_complete(void **state)
{
	(void)state;
	for_every_driver(check_table);
}

static void check_info(const struct played *played, const struct gz_device *device)
{
	struct gz_device_info info;
	gz_device_get_info(device, &info);
	assert_true(info.name[0] != '\0');
	assert_non_null(memchr(info.name, '\0', sizeof info.name));
	assert_non_null(memchr(info.serial, '\0', sizeof info.serial));
	assert_true(info.rate_hz >= 0 && info.rate_hz < 1e5);
	if (info.has_display)
		assert_true(gz_display_valid(&info.display));
	assert_int_equal(info.recorded != NULL, strcmp(played->stage.driver->name, "replay") == 0);
}

static void check_samples(struct played *played)
{
	struct gz_device *device = create(played);
	struct gz_sample sample, last = { 0 };
	struct gz_device_counters counters, before = { 0 };
	uint64_t lost = 0;
	check_info(played, device);
	assert_int_equal(gz_device_start(device), GZ_OK);
	for (uint64_t i = 0; i < SAMPLES; i++) {
		sample = device_read_sample(device);
		if (sample.seq != i || (i > 0 && sample.host_ns < last.host_ns))
			fail_msg("%s: sample %llu at %lld after %lld", played->stage.driver->name,
				 (unsigned long long)sample.seq, (long long)sample.host_ns,
				 (long long)last.host_ns);
		lost += sample.lost_before;
		gz_device_get_counters(device, &counters);
		assert_true(counters.lost >= before.lost);
		for (int reason = 0; reason < GZ_MALFORMED_COUNT; reason++)
			assert_true(counters.malformed[reason] >= before.malformed[reason]);
		assert_true(counters.clock.tick < GZ_CLOCK_TICK_COUNT);
		assert_int_equal(counters.lost, lost);
		last = sample;
		before = counters;
	}
	check_info(played, device);
	gz_device_destroy(&device);
	assert_null(device);
}

static void driver_delivers_samples_in_order_and_counts_what_is_lost(void **state)
{
	(void)state;
	for_every_driver(check_samples);
}

static void check_host_time(struct played *played)
{
	/* A replay keeps the recorded times. */
	if (strcmp(played->stage.driver->name, "replay") == 0)
		return;
	struct gz_device *device = create(played);
	struct gz_sample sample;
	int64_t begin_ns = gz_clock_now_ns();
	assert_int_equal(gz_device_start(device), GZ_OK);
	for (int i = 0; i < SAMPLES / 4; i++) {
		sample = device_read_sample(device);
		int64_t now_ns = gz_clock_now_ns();
		if (sample.host_ns > now_ns || sample.host_ns < begin_ns - GZ_NS_PER_S)
			fail_msg("%s: host time %lld, now is %lld", played->stage.driver->name,
				 (long long)sample.host_ns, (long long)now_ns);
	}
	gz_device_destroy(&device);
}

static void driver_host_time_is_the_monotonic_clock_and_not_ahead_of_it(void **state)
{
	(void)state;
	for_every_driver(check_host_time);
}

static void check_timeouts(struct played *played)
{
	struct gz_device *device = create(played);
	struct gz_sample sample, untouched;
	memset(&untouched, 0x5a, sizeof untouched);
	sample = untouched;
	assert_int_equal(gz_device_start(device), GZ_OK);
	assert_int_equal(gz_device_read(device, -1, &sample), GZ_ERR_INVAL);
	assert_memory_equal(&sample, &untouched, sizeof sample);
	int timeouts = 0;
	for (int i = 0; i < 400; i++) {
		sample = untouched;
		int64_t begin_ns = gz_clock_now_ns();
		enum gz_result result = gz_device_read(device, i % 2, &sample);
		int64_t took_ns = gz_clock_now_ns() - begin_ns;
		assert_true(result == GZ_OK || result == GZ_ERR_TIMEOUT);
		if (took_ns > GZ_NS_PER_S)
			fail_msg("%s: a wait of %d ms took %g ms", played->stage.driver->name,
				 i % 2, gz_ns_to_ms(took_ns));
		if (result == GZ_ERR_TIMEOUT) {
			timeouts++;
			assert_memory_equal(&sample, &untouched, sizeof sample);
			if (i % 2 == 1 && took_ns < GZ_NS_PER_MS / 2)
				fail_msg("%s: gave up after %lld ns", played->stage.driver->name,
					 (long long)took_ns);
		}
	}
	assert_true(timeouts > 0);
	gz_device_destroy(&device);
}

static void driver_keeps_to_the_timeout_and_writes_nothing_without_a_sample(void **state)
{
	(void)state;
	for_every_driver(check_timeouts);
}

static void check_allocations(struct played *played)
{
	/* Its messages are received and unpacked by libraries that allocate for each one. */
	if (strcmp(played->stage.driver->name, "pupil") == 0)
		return;
	struct gz_device *device = create(played);
	assert_int_equal(gz_device_start(device), GZ_OK);
	/* Let the driver do first what it does only once. */
	for (int i = 0; i < SAMPLES / 10; i++)
		device_read_sample(device);
	long before = allocations_of_this_thread();
	for (int i = 0; i < SAMPLES / 2; i++)
		device_read_sample(device);
	long after = allocations_of_this_thread();
	if (after != before)
		fail_msg("%s: %ld allocations for %d samples", played->stage.driver->name,
			 after - before, SAMPLES / 2);
	gz_device_destroy(&device);
}

static void driver_reads_without_allocating(void **state)
{
	(void)state;
	for_every_driver(check_allocations);
}

static void check_destroy(struct played *played)
{
	struct gz_device *device = create(played);
	struct gz_sample sample;
	gz_device_destroy(&device); /* before start */
	assert_null(device);
	gz_device_destroy(&device); /* again */
	gz_device_destroy(NULL);
	device = create(played);
	assert_int_equal(gz_device_start(device), GZ_OK);
	gz_device_destroy(&device); /* before the first sample */
	/* A device may be opened again. The FIFO of the template has lost its writer by then. */
	if (played->has_player)
		return;
	device = create(played);
	assert_int_equal(gz_device_start(device), GZ_OK);
	sample = device_read_sample(device);
	assert_int_equal(sample.seq, 0);
	gz_device_destroy(&device);
}

static void driver_is_destroyed_at_any_stage(void **state)
{
	(void)state;
	for_every_driver(check_destroy);
}

static void driver_refuses_missing_devices_and_bad_settings(void **state)
{
	(void)state;
	static const struct {
		const char *driver, *key, *text;
		enum gz_result result;
	} refusals[] = {
		{ "sim", "sim.targets", "/nonexistent", GZ_ERR_NOT_FOUND },
		{ "sim", "sim.picture", "/dev/null", GZ_ERR_FORMAT },
		{ "replay", "replay.file", "", GZ_ERR_INVAL },
		{ "replay", "replay.file", "/nonexistent", GZ_ERR_NOT_FOUND },
		{ "gazepoint", "gazepoint.host", "256.256.256.256", GZ_ERR_NO_DEVICE },
		{ "hid", "hid.eye_positions", "no", GZ_ERR_NO_DEVICE },
		{ "pupil", "pupil.address", "tcp://127.0.0.1", GZ_ERR_INVAL },
		{ "pupil", "pupil.address", "tcp://127.0.0.1:1", GZ_ERR_NO_DEVICE },
		{ "tobii", "tobii.library", "/nonexistent.so", GZ_ERR_NOT_FOUND },
		{ "tobii", "tobii.library", "libm.so.6", GZ_ERR_FORMAT },
		{ "template", "template.path", "", GZ_ERR_INVAL },
		{ "template", "template.path", "/nonexistent", GZ_ERR_NO_DEVICE },
		{ "psvr2", "psvr2.screen_distance_mm", "600", GZ_ERR_NO_DEVICE },
		{ "tobii5", "tobii5.screen_tilt_deg", "10", GZ_ERR_NO_DEVICE },
		{ "tobii5", "tobii5.screen_mm", "500 4", GZ_ERR_INVAL },
	};
	static struct driver_stage stage;
	fake_usb_reset();
	hid_played_reset();
	for (size_t i = 0; i < sizeof refusals / sizeof *refusals; i++) {
		struct gz_device *device;
		stage_reset(&stage, refusals[i].driver);
		stage_set(&stage, refusals[i].key, refusals[i].text);
		enum gz_result result = stage_create(&stage, NULL, &device);
		if (result != refusals[i].result)
			fail_msg("%s %s: %s, expected %s", refusals[i].key, refusals[i].text,
				 gz_result_text(result), gz_result_text(refusals[i].result));
		assert_null(device);
	}
	assert_null(gz_driver_find("none"));
}

static void template_that_is_unplugged_says_so(void **state)
{
	(void)state;
	static struct played played;
	struct gz_sample sample;
	set_up(&played, gz_driver_find("template"));
	struct gz_device *device = create(&played);
	assert_int_equal(gz_device_start(device), GZ_OK);
	sample = device_read_sample(device);
	atomic_store(&played.quit, true);
	enum gz_result result;
	do
		result = gz_device_read(device, 5000, &sample);
	while (result == GZ_OK);
	assert_int_equal(result, GZ_ERR_NO_DEVICE);
	assert_int_equal(gz_device_read(device, 10, &sample), GZ_ERR_NO_DEVICE);
	gz_device_destroy(&device);
	tear_down(&played);
}

static void template_with_endless_garbage_keeps_to_the_timeout(void **state)
{
	(void)state;
	static struct played played;
	struct gz_sample sample;
	struct gz_device_counters counters;
	stage_reset(&played.stage, "template");
	stage_set(&played.stage, "template.path", "/dev/zero");
	struct gz_device *device = create(&played);
	assert_int_equal(gz_device_start(device), GZ_OK);
	assert_int_equal(gz_device_read(device, 20, &sample), GZ_ERR_TIMEOUT);
	assert_int_equal(gz_device_read(device, 0, &sample), GZ_ERR_TIMEOUT);
	gz_device_get_counters(device, &counters);
	assert_true(counters.malformed[GZ_MALFORMED_SYNTAX] > 0);
	gz_device_destroy(&device);
}

static int make_directory(void **state)
{
	(void)state;
	snprintf(directory, sizeof directory, "/tmp/gz_conformance_XXXXXX");
	return mkdtemp(directory) ? 0 : -1;
}

static int remove_directory(void **state)
{
	(void)state;
	char path[128];
	snprintf(path, sizeof path, "%s/made.gzl", directory);
	unlink(path);
	snprintf(path, sizeof path, "%s/fifo", directory);
	unlink(path);
	return rmdir(directory);
}

TEST_SUITE(conformance)
{
	/* The writer of the FIFO may write after the driver has closed it: let that write fail. */
	signal(SIGPIPE, SIG_IGN);
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(driver_table_is_complete),
		cmocka_unit_test(driver_delivers_samples_in_order_and_counts_what_is_lost),
		cmocka_unit_test(driver_host_time_is_the_monotonic_clock_and_not_ahead_of_it),
		cmocka_unit_test(driver_keeps_to_the_timeout_and_writes_nothing_without_a_sample),
		cmocka_unit_test(driver_reads_without_allocating),
		cmocka_unit_test(driver_is_destroyed_at_any_stage),
		cmocka_unit_test(driver_refuses_missing_devices_and_bad_settings),
		cmocka_unit_test(template_that_is_unplugged_says_so),
		cmocka_unit_test(template_with_endless_garbage_keeps_to_the_timeout),
	};
	return cmocka_run_group_tests(tests, make_directory, remove_directory);
}
