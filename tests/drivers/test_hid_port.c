/* The hidapi and sysfs code of the HID driver with a device of umockdev: run with its library
 * preloaded, which redirects accesses to /dev and /sys. */
#include "suite.h"

#include <dlfcn.h>
#include <errno.h>
#include <linux/hidraw.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <umockdev.h>
#include <unistd.h>

#include "drivers/hid/hid_port.h"

#define HID_DEVICE "/devices/pci0/usb1/1-1/1-1:1.0/0003:1209:E1E1.0001"
#define DESCRIPTOR 0x05, 0x12, 0x09, 0x01, 0xa1, 0x01, 0xc0

static const char node[] = "/dev/hidraw0";
static const unsigned char descriptor[] = { DESCRIPTOR };

static const char devices[] = "P: /devices/pci0/usb1/1-1\n"
			      "E: SUBSYSTEM=usb\nE: DEVTYPE=usb_device\n"
			      "A: product=Made \xc2\xb5 Eyes \\n\nA: manufacturer=Lab\\n\n"
			      "A: serial=A12\\n\nA: bcdDevice=0100\\n\n"
			      "A: idVendor=1209\\n\nA: idProduct=e1e1\\n\n\n"
			      "P: /devices/pci0/usb1/1-1/1-1:1.0\n"
			      "E: SUBSYSTEM=usb\nE: DEVTYPE=usb_interface\n"
			      "A: bInterfaceNumber=00\\n\n\n"
			      "P: " HID_DEVICE "\n"
			      "E: SUBSYSTEM=hid\nE: HID_ID=0003:00001209:0000E1E1\n"
			      "E: HID_NAME=Lab Made \xc2\xb5 Eyes\nE: HID_PHYS=usb-1/input0\n"
			      "E: HID_UNIQ=A12\nH: report_descriptor=05120901A101C0\n\n"
			      "P: " HID_DEVICE "/hidraw/hidraw0\n"
			      "N: hidraw0\nE: SUBSYSTEM=hidraw\nE: DEVNAME=/dev/hidraw0\n"
			      "L: device=../../../0003:1209:E1E1.0001\n\n";

/* The device. umockdev calls its handlers on a thread of its own while the driver waits for the
 * answer. */
static struct {
	UMockdevTestbed *testbed;
	UMockdevIoctlBase *handler;
	unsigned char taken[16]; /* the newest feature report that was set */
	size_t taken_size;
	bool gone;
} lab;

/* Numbers of HIDIOCSFEATURE and HIDIOCGFEATURE, whose requests include a size. */
enum { SET_FEATURE = 0x06, GET_FEATURE = 0x07 };

static gboolean answer_ioctl(UMockdevIoctlBase *base, UMockdevIoctlClient *client, void *user)
{
	unsigned long request = umockdev_ioctl_client_get_request(client);
	UMockdevIoctlData *argument = umockdev_ioctl_client_get_arg(client);
	UMockdevIoctlData *data =
		umockdev_ioctl_data_resolve(argument, 0, _IOC_SIZE(request), NULL);
	unsigned char size[] = { sizeof descriptor, 0, 0, 0 };
	unsigned char whole[] = { sizeof descriptor, 0, 0, 0, DESCRIPTOR };
	unsigned char feature[] = { 0x12, 0xaa, 0xbb };
	guint8 *bytes;
	gint count;
	(void)base;
	(void)user;
	if (!data)
		return FALSE;
	umockdev_ioctl_data_retrieve(data, &bytes, &count);
	long result = 0;
	if (request == HIDIOCGRDESCSIZE) {
		umockdev_ioctl_data_update(data, 0, size, sizeof size);
	} else if (request == HIDIOCGRDESC) {
		umockdev_ioctl_data_update(data, 0, whole, sizeof whole);
	} else if (_IOC_NR(request) == GET_FEATURE && bytes[0] == feature[0]) {
		umockdev_ioctl_data_update(data, 0, feature, sizeof feature);
		result = sizeof feature;
	} else if (_IOC_NR(request) == SET_FEATURE && count <= (gint)sizeof lab.taken) {
		memcpy(lab.taken, bytes, (size_t)count);
		lab.taken_size = (size_t)count;
		result = count;
	} else {
		result = -1;
	}
	umockdev_ioctl_client_complete(client, result, result < 0 ? EPIPE : 0);
	g_free(bytes);
	umockdev_ioctl_data_unref(data);
	return TRUE;
}

static gboolean answer_read(UMockdevIoctlBase *base, UMockdevIoctlClient *client, void *user)
{
	unsigned char report[] = { 0x10, 1, 2, 3 };
	UMockdevIoctlData *data = umockdev_ioctl_client_get_arg(client);
	(void)base;
	(void)user;
	if (!lab.gone)
		umockdev_ioctl_data_update(data, 0, report, sizeof report);
	umockdev_ioctl_client_complete(client, lab.gone ? -1 : (long)sizeof report,
				       lab.gone ? EIO : 0);
	return TRUE;
}

static int set_up(void **state)
{
	(void)state;
	lab.testbed = umockdev_testbed_new();
	lab.handler = umockdev_ioctl_base_new();
	lab.gone = false;
	g_signal_connect(lab.handler, "handle-ioctl", G_CALLBACK(answer_ioctl), NULL);
	g_signal_connect(lab.handler, "handle-read", G_CALLBACK(answer_read), NULL);
	return umockdev_testbed_add_from_string(lab.testbed, devices, NULL) &&
			       umockdev_testbed_attach_ioctl(lab.testbed, node, lab.handler, NULL)
		       ? 0
		       : -1;
}

static int tear_down(void **state)
{
	(void)state;
	umockdev_testbed_detach_ioctl(lab.testbed, node, NULL);
	g_object_unref(lab.handler);
	g_object_unref(lab.testbed);
	return 0;
}

static struct gz_hid_port *open_port(void)
{
	struct gz_hid_port *port = NULL;
	assert_int_equal(gz_hid_port_open(node, &port), GZ_OK);
	assert_non_null(port);
	return port;
}

static void port_lists_a_device_by_its_printable_name_with_its_descriptor(void **state)
{
	(void)state;
	static struct gz_hid_port_entry entries[GZ_HID_PORT_ENTRIES_MAX];
	unsigned char bytes[GZ_HID_DESCRIPTOR_SIZE];
	size_t size = 0;
	assert_int_equal(gz_hid_port_list(entries), 1);
	assert_string_equal(entries[0].path, node);
	assert_string_equal(entries[0].serial, "A12");
	assert_int_equal(entries[0].vendor, 0x1209);
	assert_int_equal(entries[0].product, 0xe1e1);
	/* hidapi returns no name that the locale cannot represent; then the name from the kernel is
	 * used. */
	assert_string_equal(entries[0].name, "Lab Made ?? Eyes");
	assert_int_equal(gz_hid_port_descriptor(node, bytes, &size), GZ_OK);
	assert_int_equal(size, sizeof descriptor);
	assert_memory_equal(bytes, descriptor, sizeof descriptor);
}

static void missing_port_is_not_opened(void **state)
{
	(void)state;
	struct gz_hid_port *port = NULL;
	unsigned char bytes[GZ_HID_DESCRIPTOR_SIZE];
	size_t size;
	assert_int_equal(gz_hid_port_open("/dev/hidraw9", &port), GZ_ERR_NO_DEVICE);
	assert_int_equal(gz_hid_port_may_open("/dev/hidraw9"), GZ_ERR_NO_DEVICE);
	assert_int_equal(gz_hid_port_descriptor("/dev/hidraw9", bytes, &size), GZ_ERR_NO_DEVICE);
	assert_null(port);
	gz_hid_port_close(&port);
	gz_hid_port_close(NULL);
}

static void port_feature_reports_go_both_ways_with_their_id_first(void **state)
{
	(void)state;
	struct gz_hid_port *port = open_port();
	unsigned char bytes[16];
	const unsigned char mode[] = { 0x14, 3 };
	size_t size = 0;
	assert_int_equal(gz_hid_port_get_feature(port, 0x12, bytes, sizeof bytes, &size), GZ_OK);
	assert_int_equal(size, 3);
	assert_memory_equal(bytes, ((unsigned char[]) { 0x12, 0xaa, 0xbb }), 3);
	assert_int_equal(gz_hid_port_get_feature(port, 0x13, bytes, sizeof bytes, &size),
			 GZ_ERR_IO);
	assert_int_equal(gz_hid_port_set_feature(port, mode, sizeof mode), GZ_OK);
	assert_int_equal(lab.taken_size, sizeof mode);
	assert_memory_equal(lab.taken, mode, sizeof mode);
	gz_hid_port_close(&port);
	assert_null(port);
}

static void port_read_returns_a_report_or_a_timeout_or_that_it_is_gone(void **state)
{
	(void)state;
	struct gz_hid_port *port = open_port();
	unsigned char bytes[64];
	size_t size = 0;
	int fd = umockdev_testbed_get_dev_fd(lab.testbed, node);
	assert_int_equal(gz_hid_port_read(port, bytes, sizeof bytes, 0, &size), GZ_ERR_TIMEOUT);
	/* Make the descriptor readable; what is then read comes from answer_read(). */
	assert_int_equal(write(fd, "\n", 1), 1);
	assert_int_equal(gz_hid_port_read(port, bytes, sizeof bytes, 5000, &size), GZ_OK);
	assert_int_equal(size, 4);
	assert_memory_equal(bytes, ((unsigned char[]) { 0x10, 1, 2, 3 }), 4);
	lab.gone = true;
	assert_int_equal(gz_hid_port_read(port, bytes, sizeof bytes, 5000, &size),
			 GZ_ERR_NO_DEVICE);
	gz_hid_port_close(&port);
}

TEST_SUITE(hid_port)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test_setup_teardown(
			port_lists_a_device_by_its_printable_name_with_its_descriptor, set_up,
			tear_down),
		cmocka_unit_test_setup_teardown(missing_port_is_not_opened, set_up, tear_down),
		cmocka_unit_test_setup_teardown(
			port_feature_reports_go_both_ways_with_their_id_first, set_up, tear_down),
		cmocka_unit_test_setup_teardown(
			port_read_returns_a_report_or_a_timeout_or_that_it_is_gone, set_up,
			tear_down),
	};
	if (!dlopen("libumockdev-preload.so.0", RTLD_NOW | RTLD_NOLOAD)) {
		const char *preload = getenv("LD_PRELOAD");
		print_error("umockdev's library is not loaded (LD_PRELOAD is \"%s\"): "
			    "install the package umockdev and run this by ctest\n",
			    preload ? preload : "");
		return 1;
	}
	return cmocka_run_group_tests(tests, NULL, NULL);
}
