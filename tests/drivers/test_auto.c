/* The driver that opens any tracker: with a Gazepoint server, and with headsets on a fake bus,
 * whose device nodes nobody may open because they do not exist. */
#include "suite.h"

#include <stdio.h>
#include <string.h>

#include "driver_stage.h"
#include "drivers/psvr2/psvr2_link.h"
#include "fake_libusb.h"
#include "gazepoint_server.h"

enum { DRIVERS_MAX = 16 };

/* The driver auto, and all drivers for their settings. */
static struct driver_stage stage, others[DRIVERS_MAX];
static const void *settings[DRIVERS_MAX];

static int set_up(void **state)
{
	(void)state;
	fake_usb_reset();
	stage_reset(&stage, "auto");
	for (size_t i = 0; gz_drivers[i]; i++) {
		assert_true(i < DRIVERS_MAX);
		stage_reset(&others[i], gz_drivers[i]->name);
		settings[i] = others[i].settings;
	}
	stage.host.settings = settings;
	return 0;
}

/* Set where the Gazepoint driver looks. */
static void set_port(int port)
{
	char text[16];
	size_t i = 0;
	while (gz_drivers[i] != &gz_driver_gazepoint)
		i++;
	snprintf(text, sizeof text, "%d", port);
	stage_set(&others[i], "gazepoint.port", text);
}

static enum gz_result create(const char *choice, struct gz_device **device)
{
	return stage_create(&stage, choice, device);
}

static void assert_logged(const char *part)
{
	stage_expect_logged(&stage, part);
}

static void auto_opens_the_usable_tracker(void **state)
{
	(void)state;
	struct gz_device *device;
	struct gazepoint_server server;
	gazepoint_server_start(&server, &(struct gazepoint_play) { .stream = true }, 0);
	set_port(server.port);
	/* A headset is plugged in, too, but may not be opened. */
	fake_usb_plug(GZ_PSVR2_VENDOR, GZ_PSVR2_PRODUCT);
	assert_int_equal(create(NULL, &device), GZ_OK);
	assert_non_null(device);
	assert_logged("driver gazepoint");
	assert_logged("71-gazecast.rules");
	gz_device_destroy(&device);
	gazepoint_server_stop(&server);
}

static void auto_without_a_tracker_says_what_to_do(void **state)
{
	(void)state;
	struct gz_device *device;
	set_port(1);
	assert_int_equal(create(NULL, &device), GZ_ERR_NO_DEVICE);
	assert_null(device);
	assert_logged("no tracker found; plug one in");
	/* That no server answers at the default address of Gazepoint is not an error. */
	assert_null(strstr(stage.logged, "refused"));
	assert_int_equal(create("tracker seven", &device), GZ_ERR_NO_DEVICE);
	assert_logged("no tracker is called tracker seven");
}

static void auto_names_the_udev_rule_if_a_tracker_may_not_be_opened(void **state)
{
	(void)state;
	struct gz_device *device;
	set_port(1);
	fake_usb_plug(GZ_PSVR2_VENDOR, GZ_PSVR2_PRODUCT);
	assert_int_equal(create(NULL, &device), GZ_ERR_ACCESS);
	assert_null(device);
	assert_logged("PlayStation VR2 at usb 250-3.1: no permission");
	assert_logged("71-gazecast.rules");
	/* Another tracker is wanted. */
	assert_int_equal(create("tracker seven", &device), GZ_ERR_NO_DEVICE);
}

static void auto_needs_the_settings_of_the_others(void **state)
{
	(void)state;
	struct gz_device *device;
	stage.host.settings = NULL;
	assert_int_equal(create(NULL, &device), GZ_ERR_INVAL);
	assert_null(device);
}

TEST_SUITE(auto)
{
#define TEST(name) cmocka_unit_test_setup(name, set_up)
	const struct CMUnitTest tests[] = {
		TEST(auto_opens_the_usable_tracker),
		TEST(auto_without_a_tracker_says_what_to_do),
		TEST(auto_names_the_udev_rule_if_a_tracker_may_not_be_opened),
		TEST(auto_needs_the_settings_of_the_others),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
