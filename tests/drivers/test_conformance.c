/* What every driver must do, asked of every entry of gz_drivers[]. */
#include "check.h"

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
#include "drivers/driver.h"
#include "drivers/pointer/pointer_feed.h"
#include "drivers/psvr2/psvr2_link.h"
#include "drivers/psvr2/psvr2_packet.h"
#include "drivers/template/template_protocol.h"
#include "fake_libusb.h"
#include "gazepoint_server.h"
#include "hid_made.h"
#include "hid_played.h"
#include "made_log.h"
#include "pupil_capture.h"
#include "tobii_stand_in.h"

/* Samples read of each driver. */
enum { SAMPLES = 200 };

/* Patience for one sample, ms; a device that is there never needs it. */
enum { PATIENCE_MS = 5000 };

static char directory[64];

/* What a driver needs so that a device is there: options, and someone who plays the device. */
struct stage {
	const struct gz_driver *driver;
	_Alignas(max_align_t) unsigned char settings[GZ_DRIVER_SETTINGS_SIZE];
	char path[128];
	pthread_t player;
	bool has_player;
	atomic_bool quit;
	struct gazepoint_server server;
	bool has_server;
	int number; /* of the played HID device */
	bool plays_hid;
	struct pupil_capture capture;
	struct gz_driver_host host;
};

static void set_option(struct stage *stage, const char *key, const char *text)
{
	struct gz_option_binding binding = { stage->driver->options, *stage->driver->option_count,
					     stage->settings, NULL };
	const struct gz_option *option = gz_options_find(&binding, 1, key, NULL);
	char message[256] = "";
	assert_non_null(option);
	if (gz_option_parse(option, text, stage->settings, message, sizeof message) != GZ_OK)
		fail_msg("%s: %s", key, message);
}

/* Plays the template's device at 500 Hz. Every 50th report is lost, every 70th is damaged. */
static void *play_template(void *user)
{
	struct stage *stage = user;
	int fd = open(stage->path, O_WRONLY | O_CLOEXEC);
	int64_t begin_ns = gz_clock_now_ns();
	for (uint32_t i = 0; fd >= 0 && !atomic_load(&stage->quit); i++) {
		struct gz_template_report report = {
			.counter = i,
			.clock_us = UINT32_MAX - 100000 + 2000 * i, /* wraps on the way */
			.found = { true, i % 3 != 0 },
			.point = { { 0.4f, 0.5f }, { 0.6f, 0.5f } },
		};
		unsigned char bytes[GZ_TEMPLATE_REPORT_SIZE];
		gz_template_print(&report, bytes);
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

static void prepare_replay(struct stage *stage)
{
	struct made_log made;
	snprintf(stage->path, sizeof stage->path, "%s/made.gzl", directory);
	assert_true(made_log_begin(&made, stage->path));
	for (uint64_t i = 0; i < 10 * SAMPLES; i++)
		made_log_sample(&made, i, (int64_t)i * 2 * GZ_NS_PER_MS);
	made_log_end(&made);
	set_option(stage, "replay.file", stage->path);
}

static void prepare_template(struct stage *stage)
{
	snprintf(stage->path, sizeof stage->path, "%s/fifo", directory);
	unlink(stage->path);
	assert_int_equal(mkfifo(stage->path, 0600), 0);
	set_option(stage, "template.path", stage->path);
	atomic_store(&stage->quit, false);
	assert_int_equal(pthread_create(&stage->player, NULL, play_template, stage), 0);
	stage->has_player = true;
}

static void prepare_gazepoint(struct stage *stage)
{
	char port[16];
	gazepoint_server_start(&stage->server, &(struct gazepoint_play) { .stream = true }, 0);
	snprintf(port, sizeof port, "%d", stage->server.port);
	set_option(stage, "gazepoint.port", port);
	stage->has_server = true;
}

/* Sends good and bad messages, each twice. */
static void prepare_pupil(struct stage *stage)
{
	atomic_store(&stage->capture.garbage, true);
	atomic_store(&stage->capture.twice, true);
	pupil_capture_start(&stage->capture);
	set_option(stage, "pupil.address", stage->capture.address);
}

/* Plays a headset at 500 Hz. Every 50th packet is lost, every 70th is damaged. */
static size_t play_psvr2(void *user, unsigned char *bytes, size_t room)
{
	uint32_t *frame = user;
	struct gz_psvr2_packet packet = {
		.device_ns = *frame * 2 * GZ_NS_PER_MS,
		.frame = *frame,
		.combined = { true, true, { 0 }, { 0, 0, 1 } },
	};
	assert_true(room >= GZ_PSVR2_PACKET_SIZE);
	gz_psvr2_print(&packet, bytes);
	if (*frame % 70 == 69)
		bytes[0] ^= 0xff;
	return (*frame)++ % 50 == 49 ? 0 : GZ_PSVR2_PACKET_SIZE;
}

static void prepare_psvr2(void)
{
	static uint32_t frame;
	frame = UINT32_MAX - 100; /* wraps on the way */
	fake_usb_plug(GZ_PSVR2_VENDOR, GZ_PSVR2_PRODUCT);
	fake_usb.packet = play_psvr2;
	fake_usb.user = &frame;
	fake_usb.period_ns = 2 * GZ_NS_PER_MS;
	fake_usb.due_ns = gz_clock_now_ns();
}

/* Plays a tracker of the HID class at 500 Hz whose clock wraps. Every 70th report is cut. */
static void *play_hid(void *user)
{
	struct stage *stage = user;
	int64_t begin_ns = gz_clock_now_ns();
	for (uint32_t i = 0; !atomic_load(&stage->quit); i++) {
		struct hid_made_sample sample = {
			.time_us = UINT32_MAX - 100000 + 2000 * (uint64_t)i,
			.gaze = { 100000 + (int32_t)i, 50000 },
			.left = { 70000, 60000, 600000 },
			.right = { 130000, 60000, 600000 },
		};
		unsigned char bytes[128];
		size_t size = hid_made_report(HID_LAYOUT_BYTES, &sample, bytes);
		gz_clock_sleep_until_ns(begin_ns + (int64_t)i * 2 * GZ_NS_PER_MS);
		hid_played_send(stage->number, bytes, i % 70 == 69 ? 9 : size);
	}
	return NULL;
}

static void prepare_hid(struct stage *stage)
{
	struct hid_made made = { 0 };
	unsigned char bytes[64];
	hid_made_tracker(&made, HID_LAYOUT_BYTES);
	stage->number = hid_played_plug("Made", "1", made.bytes, made.size);
	hid_played_set_feature(stage->number, 0x12, bytes,
			       hid_made_configuration(HID_LAYOUT_BYTES, 500000, 300000, bytes));
	hid_played_set_feature(stage->number, 0x13, bytes,
			       hid_made_status(HID_LAYOUT_BYTES, 1, 500, bytes));
	atomic_store(&stage->quit, false);
	assert_int_equal(pthread_create(&stage->player, NULL, play_hid, stage), 0);
	stage->plays_hid = true;
}

static void prepare_pointer(struct stage *stage)
{
	set_option(stage, "pointer.rate_hz", "500");
	assert_int_equal(gz_pointer_feed_create(&stage->host.pointer), GZ_OK);
	const struct gz_pointer_report report = { .host_ns = gz_clock_now_ns(),
						  .known = true,
						  .point = { 0.5f, 0.5f } };
	assert_true(gz_pointer_feed_put(stage->host.pointer, &report));
}

static void prepare_tobii(struct stage *stage)
{
	/* The driver's own dlopen() of the same file gives the same library. */
	void *library = dlopen(TOBII_STAND_IN, RTLD_NOW | RTLD_LOCAL | RTLD_NODELETE);
	void *address = library ? dlsym(library, TOBII_STAND_IN_CONTROL) : NULL;
	tobii_stand_in_control_function *control;
	assert_non_null(address);
	memcpy(&control, &address, sizeof control);
	control()->trackers = 1;
	control()->rate_hz = 500;
	control()->system_zero_us = 1000000;
	control()->device_zero_us = -1000000;
	set_option(stage, "tobii.library", TOBII_STAND_IN);
	dlclose(library);
}

/* The driver's presets, and what it needs beyond. */
static void set_up(struct stage *stage, const struct gz_driver *driver)
{
	struct gz_option_binding binding = { driver->options, *driver->option_count,
					     stage->settings, NULL };
	memset(stage, 0, sizeof *stage);
	fake_usb_reset();
	hid_played_reset();
	stage->driver = driver;
	assert_true(driver->settings_size <= sizeof stage->settings);
	assert_int_equal(gz_options_preset(&binding), GZ_OK);
	if (strcmp(driver->name, "replay") == 0)
		prepare_replay(stage);
	else if (strcmp(driver->name, "template") == 0)
		prepare_template(stage);
	else if (strcmp(driver->name, "gazepoint") == 0)
		prepare_gazepoint(stage);
	else if (strcmp(driver->name, "pointer") == 0)
		prepare_pointer(stage);
	else if (strcmp(driver->name, "tobii") == 0)
		prepare_tobii(stage);
	else if (strcmp(driver->name, "psvr2") == 0)
		prepare_psvr2();
	else if (strcmp(driver->name, "hid") == 0)
		prepare_hid(stage);
	else if (strcmp(driver->name, "pupil") == 0)
		prepare_pupil(stage);
}

static void tear_down(struct stage *stage)
{
	gz_pointer_feed_destroy(&stage->host.pointer);
	if (stage->has_server)
		gazepoint_server_stop(&stage->server);
	if (stage->plays_hid) {
		atomic_store(&stage->quit, true);
		pthread_join(stage->player, NULL);
	}
	pupil_capture_stop(&stage->capture);
	if (!stage->has_player)
		return;
	atomic_store(&stage->quit, true);
	/* The player may still wait for a reader. */
	int fd = open(stage->path, O_RDONLY | O_NONBLOCK | O_CLOEXEC);
	pthread_join(stage->player, NULL);
	if (fd >= 0)
		close(fd);
}

static struct gz_device *create(struct stage *stage)
{
	struct gz_device *device = NULL;
	enum gz_result result;
	int64_t deadline_ns = gz_clock_now_ns() + PATIENCE_MS * GZ_NS_PER_MS;
	/* One that is asked over a network may answer late on a busy machine. */
	do
		result = stage->driver->create(stage->settings, &stage->host, &device);
	while (result == GZ_ERR_NO_DEVICE && stage->capture.context &&
	       gz_clock_now_ns() < deadline_ns);
	if (result != GZ_OK)
		fail_msg("%s: %s", stage->driver->name, gz_result_text(result));
	assert_non_null(device);
	return device;
}

typedef void check_function(struct stage *stage);

static void for_every_driver(check_function *check)
{
	static struct stage stage;
	for (size_t i = 0; gz_drivers[i]; i++) {
		/* It opens the devices of others: see test_auto.c. */
		if (strcmp(gz_drivers[i]->name, "auto") == 0)
			continue;
		set_up(&stage, gz_drivers[i]);
		print_message("           %s\n", gz_drivers[i]->name);
		check(&stage);
		tear_down(&stage);
	}
}

/* A sample, however many time-outs come before it. */
static void read_one(struct stage *stage, struct gz_device *device, struct gz_sample *out_sample)
{
	int64_t deadline_ns = gz_clock_now_ns() + PATIENCE_MS * GZ_NS_PER_MS;
	enum gz_result result;
	do
		result = gz_device_read(device, 20, out_sample);
	while (result == GZ_ERR_TIMEOUT && gz_clock_now_ns() < deadline_ns);
	if (result != GZ_OK)
		fail_msg("%s: no sample: %s", stage->driver->name, gz_result_text(result));
}

static void check_table(struct stage *stage)
{
	const struct gz_driver *driver = stage->driver;
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
	struct gz_device *device = create(stage);
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

static void check_info(const struct stage *stage, const struct gz_device *device)
{
	struct gz_device_info info;
	gz_device_get_info(device, &info);
	assert_true(info.name[0] != '\0');
	assert_non_null(memchr(info.name, '\0', sizeof info.name));
	assert_non_null(memchr(info.serial, '\0', sizeof info.serial));
	assert_true(info.rate_hz >= 0 && info.rate_hz < 1e5);
	if (info.has_display)
		assert_true(gz_display_valid(&info.display));
	assert_int_equal(info.recorded != NULL, strcmp(stage->driver->name, "replay") == 0);
}

static void check_samples(struct stage *stage)
{
	struct gz_device *device = create(stage);
	struct gz_sample sample, last = { 0 };
	struct gz_device_counters counters, before = { 0 };
	uint64_t lost = 0;
	check_info(stage, device);
	assert_int_equal(gz_device_start(device), GZ_OK);
	for (uint64_t i = 0; i < SAMPLES; i++) {
		read_one(stage, device, &sample);
		if (sample.seq != i || (i > 0 && sample.host_ns < last.host_ns))
			fail_msg("%s: sample %llu at %lld after %lld", stage->driver->name,
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
	check_info(stage, device);
	gz_device_destroy(&device);
	assert_null(device);
}

static void driver_delivers_samples_in_order_and_counts_what_is_lost(void **state)
{
	(void)state;
	for_every_driver(check_samples);
}

static void check_host_time(struct stage *stage)
{
	/* A recording keeps its own times. */
	if (strcmp(stage->driver->name, "replay") == 0)
		return;
	struct gz_device *device = create(stage);
	struct gz_sample sample;
	int64_t begin_ns = gz_clock_now_ns();
	assert_int_equal(gz_device_start(device), GZ_OK);
	for (int i = 0; i < SAMPLES / 4; i++) {
		read_one(stage, device, &sample);
		int64_t now_ns = gz_clock_now_ns();
		if (sample.host_ns > now_ns || sample.host_ns < begin_ns - GZ_NS_PER_S)
			fail_msg("%s: host time %lld, now is %lld", stage->driver->name,
				 (long long)sample.host_ns, (long long)now_ns);
	}
	gz_device_destroy(&device);
}

static void driver_host_time_is_the_monotonic_clock_and_not_ahead_of_it(void **state)
{
	(void)state;
	for_every_driver(check_host_time);
}

static void check_timeouts(struct stage *stage)
{
	struct gz_device *device = create(stage);
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
			fail_msg("%s: a wait of %d ms took %g ms", stage->driver->name, i % 2,
				 gz_ns_to_ms(took_ns));
		if (result == GZ_ERR_TIMEOUT) {
			timeouts++;
			assert_memory_equal(&sample, &untouched, sizeof sample);
			if (i % 2 == 1 && took_ns < GZ_NS_PER_MS / 2)
				fail_msg("%s: gave up after %lld ns", stage->driver->name,
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

static void check_allocations(struct stage *stage)
{
	/* Its messages are received and unpacked by libraries that allocate for each. */
	if (strcmp(stage->driver->name, "pupil") == 0)
		return;
	struct gz_device *device = create(stage);
	struct gz_sample sample;
	assert_int_equal(gz_device_start(device), GZ_OK);
	/* What is done once is done by then. */
	for (int i = 0; i < SAMPLES / 10; i++)
		read_one(stage, device, &sample);
	long before = allocations_of_this_thread();
	for (int i = 0; i < SAMPLES / 2; i++)
		read_one(stage, device, &sample);
	long after = allocations_of_this_thread();
	if (after != before)
		fail_msg("%s: %ld allocations for %d samples", stage->driver->name, after - before,
			 SAMPLES / 2);
	gz_device_destroy(&device);
}

static void driver_reads_without_allocating(void **state)
{
	(void)state;
	for_every_driver(check_allocations);
}

static void check_destroy(struct stage *stage)
{
	struct gz_device *device = create(stage);
	struct gz_sample sample;
	gz_device_destroy(&device); /* before start */
	assert_null(device);
	gz_device_destroy(&device); /* again */
	gz_device_destroy(NULL);
	device = create(stage);
	assert_int_equal(gz_device_start(device), GZ_OK);
	gz_device_destroy(&device); /* before the first sample */
	/* And one may be opened again. The template's FIFO has lost its player by then. */
	if (stage->has_player)
		return;
	device = create(stage);
	assert_int_equal(gz_device_start(device), GZ_OK);
	read_one(stage, device, &sample);
	assert_int_equal(sample.seq, 0);
	gz_device_destroy(&device);
}

static void driver_is_destroyed_at_any_stage(void **state)
{
	(void)state;
	for_every_driver(check_destroy);
}

static void driver_refuses_what_is_not_there(void **state)
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
	};
	static struct stage stage;
	fake_usb_reset();
	hid_played_reset();
	for (size_t i = 0; i < sizeof refusals / sizeof *refusals; i++) {
		struct gz_device *device = NULL;
		const struct gz_driver *driver = gz_driver_find(refusals[i].driver);
		struct gz_option_binding binding = { driver->options, *driver->option_count,
						     stage.settings, NULL };
		memset(&stage, 0, sizeof stage);
		stage.driver = driver;
		assert_int_equal(gz_options_preset(&binding), GZ_OK);
		set_option(&stage, refusals[i].key, refusals[i].text);
		enum gz_result result =
			driver->create(stage.settings, &(struct gz_driver_host) { 0 }, &device);
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
	static struct stage stage;
	struct gz_sample sample;
	set_up(&stage, gz_driver_find("template"));
	struct gz_device *device = create(&stage);
	assert_int_equal(gz_device_start(device), GZ_OK);
	read_one(&stage, device, &sample);
	atomic_store(&stage.quit, true);
	enum gz_result result;
	do
		result = gz_device_read(device, PATIENCE_MS, &sample);
	while (result == GZ_OK);
	assert_int_equal(result, GZ_ERR_NO_DEVICE);
	assert_int_equal(gz_device_read(device, 10, &sample), GZ_ERR_NO_DEVICE);
	gz_device_destroy(&device);
	tear_down(&stage);
}

static void template_of_nothing_but_garbage_keeps_to_the_timeout(void **state)
{
	(void)state;
	static struct stage stage;
	struct gz_sample sample;
	struct gz_device_counters counters;
	stage.driver = gz_driver_find("template");
	memset(stage.settings, 0, sizeof stage.settings);
	set_option(&stage, "template.path", "/dev/zero");
	struct gz_device *device = create(&stage);
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

int main(void)
{
	/* The player of a pipe may write once more after its driver has gone: then the write fails.
	 */
	signal(SIGPIPE, SIG_IGN);
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(driver_table_is_complete),
		cmocka_unit_test(driver_delivers_samples_in_order_and_counts_what_is_lost),
		cmocka_unit_test(driver_host_time_is_the_monotonic_clock_and_not_ahead_of_it),
		cmocka_unit_test(driver_keeps_to_the_timeout_and_writes_nothing_without_a_sample),
		cmocka_unit_test(driver_reads_without_allocating),
		cmocka_unit_test(driver_is_destroyed_at_any_stage),
		cmocka_unit_test(driver_refuses_what_is_not_there),
		cmocka_unit_test(template_that_is_unplugged_says_so),
		cmocka_unit_test(template_of_nothing_but_garbage_keeps_to_the_timeout),
	};
	return cmocka_run_group_tests(tests, make_directory, remove_directory);
}
