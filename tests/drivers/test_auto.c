/* The driver that takes what is there: a server of Gazepoint's, and headsets on a played bus, whose
 * device nodes nobody may open, because there are none. */
#include "check.h"

#include <stdio.h>
#include <string.h>

#include "drivers/driver.h"
#include "drivers/psvr2/psvr2_link.h"
#include "fake_libusb.h"
#include "gazepoint_server.h"

enum { DRIVERS_MAX = 16 };

static _Alignas(max_align_t) unsigned char bytes[DRIVERS_MAX][GZ_DRIVER_SETTINGS_SIZE];
static const void *settings[DRIVERS_MAX];
static char logged[4096];
static struct gz_log log_to_here;

static void remember(void *user, enum gz_log_level level, const char *module, const char *message)
{
	(void)user;
	(void)level;
	(void)module;
	size_t used = strlen(logged);
	snprintf(logged + used, sizeof logged - used, "%s\n", message);
}

static int set_up(void **state)
{
	(void)state;
	fake_usb_reset();
	logged[0] = '\0';
	gz_log_init(&log_to_here, remember, NULL, "*:info");
	for (size_t i = 0; gz_drivers[i]; i++) {
		struct gz_option_binding binding = { gz_drivers[i]->options,
						     *gz_drivers[i]->option_count, bytes[i], NULL };
		if (i >= DRIVERS_MAX || gz_options_preset(&binding) != GZ_OK)
			return -1;
		settings[i] = bytes[i];
	}
	return 0;
}

/* Where the Gazepoint driver looks. */
static void set_port(int port)
{
	char text[16];
	size_t i = 0;
	while (strcmp(gz_drivers[i]->name, "gazepoint") != 0)
		i++;
	struct gz_option_binding binding = { gz_drivers[i]->options, *gz_drivers[i]->option_count,
					     bytes[i], NULL };
	snprintf(text, sizeof text, "%d", port);
	assert_int_equal(gz_option_parse(gz_options_find(&binding, 1, "gazepoint.port", NULL), text,
					 bytes[i], NULL, 0),
			 GZ_OK);
}

static enum gz_result create(const char *choice, struct gz_device **device)
{
	struct gz_driver_host host = { .log = &log_to_here,
				       .choice = choice,
				       .settings = settings };
	*device = NULL;
	return gz_driver_find("auto")->create(NULL, &host, device);
}

static void assert_logged(const char *part)
{
	if (!strstr(logged, part))
		fail_msg("\"%s\" is not in:\n%s", part, logged);
}

static void auto_opens_the_tracker_that_can_be_used(void **state)
{
	(void)state;
	struct gz_device *device;
	struct gazepoint_server server;
	gazepoint_server_start(&server, &(struct gazepoint_play) { .stream = true }, 0);
	set_port(server.port);
	/* One is plugged in, too, but not ours to open. */
	fake_usb_plug(GZ_PSVR2_VENDOR, GZ_PSVR2_PRODUCT);
	assert_int_equal(create(NULL, &device), GZ_OK);
	assert_non_null(device);
	assert_logged("by driver gazepoint");
	assert_logged("70-gazecast.rules");
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
	/* That nobody listens at Gazepoint's address is nobody's fault. */
	assert_null(strstr(logged, "refused"));
	assert_int_equal(create("tracker seven", &device), GZ_ERR_NO_DEVICE);
	assert_logged("no tracker is called tracker seven");
}

static void auto_names_the_rule_where_a_tracker_may_not_be_opened(void **state)
{
	(void)state;
	struct gz_device *device;
	set_port(1);
	fake_usb_plug(GZ_PSVR2_VENDOR, GZ_PSVR2_PRODUCT);
	assert_int_equal(create(NULL, &device), GZ_ERR_ACCESS);
	assert_null(device);
	assert_logged("PlayStation VR2 at usb 250-3.1: no permission");
	assert_logged("70-gazecast.rules");
	/* Another one is wanted. */
	assert_int_equal(create("tracker seven", &device), GZ_ERR_NO_DEVICE);
}

static void auto_needs_the_settings_of_the_others(void **state)
{
	(void)state;
	struct gz_device *device = NULL;
	struct gz_driver_host host = { .log = &log_to_here };
	assert_int_equal(gz_driver_find("auto")->create(NULL, &host, &device), GZ_ERR_INVAL);
	assert_null(device);
}

int main(void)
{
#define TEST(name) cmocka_unit_test_setup(name, set_up)
	const struct CMUnitTest tests[] = {
		TEST(auto_opens_the_tracker_that_can_be_used),
		TEST(auto_without_a_tracker_says_what_to_do),
		TEST(auto_names_the_rule_where_a_tracker_may_not_be_opened),
		TEST(auto_needs_the_settings_of_the_others),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
