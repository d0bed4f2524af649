/* Refused devices, in a fake sysfs. */
#include "suite.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "drivers/usb/usb_device.h"

static char root[64];

static void path_of(char path[400], const char *name)
{
	snprintf(path, 400, "%s/%s", root, name);
}

static void make_directory(const char *name)
{
	char path[400];
	path_of(path, name);
	if (mkdir(path, 0700) != 0)
		fail_msg("cannot make %s", path);
}

static void make_file(const char *name, const char *text)
{
	char path[400];
	path_of(path, name);
	FILE *file = fopen(path, "we");
	assert_non_null(file);
	fputs(text, file);
	fclose(file);
}

static void make_link(const char *name, const char *target)
{
	char path[400];
	path_of(path, name);
	assert_int_equal(symlink(target, path), 0);
}

static void make_device(const char *ports, const char *product, const char *serial)
{
	char name[200], link[200], target[200];
	snprintf(name, sizeof name, "devices/%s", ports);
	make_directory(name);
	snprintf(name, sizeof name, "devices/%s/product", ports);
	make_file(name, product);
	snprintf(name, sizeof name, "devices/%s/serial", ports);
	make_file(name, serial);
	snprintf(name, sizeof name, "devices/%s/%s:1.0", ports, ports);
	make_directory(name);
	snprintf(link, sizeof link, "bus/usb/devices/%s", ports);
	snprintf(target, sizeof target, "../../../devices/%s", ports);
	make_link(link, target);
	snprintf(link, sizeof link, "bus/usb/devices/%s:1.0", ports);
	snprintf(target, sizeof target, "../../../devices/%s/%s:1.0", ports, ports);
	make_link(link, target);
}

static void make_hid(const char *ports, const char *hid)
{
	char name[200], link[200], target[200];
	snprintf(name, sizeof name, "devices/%s/%s:1.0/driver", ports, ports);
	make_directory(name);
	snprintf(name, sizeof name, "devices/%s/%s:1.0/%s", ports, ports, hid);
	make_directory(name);
	snprintf(link, sizeof link, "bus/hid/devices/%s", hid);
	snprintf(target, sizeof target, "../../../devices/%s/%s:1.0/%s", ports, ports, hid);
	make_link(link, target);
}

static int make_sysfs(void **state)
{
	(void)state;
	snprintf(root, sizeof root, "/tmp/gz_sysfs_XXXXXX");
	if (!mkdtemp(root))
		return -1;
	static const char *const directories[] = { "devices",         "bus",
						   "bus/usb",         "bus/usb/devices",
						   "bus/usb/drivers", "bus/hid",
						   "bus/hid/devices", "bus/hid/drivers" };
	for (size_t i = 0; i < sizeof directories / sizeof *directories; i++)
		make_directory(directories[i]);
	return 0;
}

static int remove_sysfs(void **state)
{
	char command[128];
	(void)state;
	snprintf(command, sizeof command, "rm -r %s", root);
	return system(command);
}

static const struct gz_device_entry *find(const struct gz_device_entry *entries, size_t count,
					  const char *place)
{
	for (size_t i = 0; i < count; i++)
		if (strcmp(entries[i].place, place) == 0)
			return &entries[i];
	fail_msg("%s is not listed", place);
	return NULL;
}

static void refused_devices_are_listed_and_others_are_not(void **state)
{
	(void)state;
	struct gz_device_entry entries[8];
	assert_int_equal(gz_usb_list_refused(root, entries, 8), 0);
	/* 1-1: descriptor not read. 1-2.3: read but not understood. 1-4: in use. 1-5: not HID. 1-6:
	 * without a name, not read. */
	make_device("1-1", "Tracker\033[31m\n", "one\n");
	make_file("devices/1-1/1-1:1.0/bInterfaceClass", "03\n");
	make_device("1-2.3", "Other tracker\n", "two\n");
	make_file("devices/1-2.3/1-2.3:1.0/bInterfaceClass", "03\n");
	make_hid("1-2.3", "0003:1209:0001.0001");
	make_device("1-4", "Mouse\n", "");
	make_file("devices/1-4/1-4:1.0/bInterfaceClass", "03\n");
	make_hid("1-4", "0003:1209:0002.0002");
	make_directory("devices/1-4/1-4:1.0/0003:1209:0002.0002/driver");
	make_device("1-5", "Disk\n", "");
	make_file("devices/1-5/1-5:1.0/bInterfaceClass", "08\n");
	make_device("1-6", "\n", "\n");
	make_file("devices/1-6/1-6:1.0/bInterfaceClass", "03\n");

	/* A kernel without HID drivers refuses nothing. */
	assert_int_equal(gz_usb_list_refused(root, entries, 8), 0);
	make_directory("bus/usb/drivers/usbhid");
	make_directory("bus/hid/drivers/hid-generic");
	size_t count = gz_usb_list_refused(root, entries, 8);
	assert_int_equal(count, 3);
	const struct gz_device_entry *entry = find(entries, count, "usb 1-1");
	assert_string_equal(entry->name, "Tracker?[31m");
	assert_string_equal(entry->serial, "one");
	assert_false(entry->usable);
	assert_non_null(strstr(entry->reason, "report descriptor"));
	assert_string_equal(find(entries, count, "usb 1-2.3")->serial, "two");
	assert_string_equal(find(entries, count, "usb 1-6")->name, "HID device without a name");
	assert_int_equal(gz_usb_list_refused(root, entries, 1), 1);
	assert_int_equal(gz_usb_list_refused("/nonexistent", entries, 8), 0);
}

TEST_SUITE(usb_refused)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(refused_devices_are_listed_and_others_are_not),
	};
	return cmocka_run_group_tests(tests, make_sysfs, remove_sysfs);
}
