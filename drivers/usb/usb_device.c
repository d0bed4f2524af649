#include "drivers/usb/usb_device.h"
#include "base/utf8.h"

#include <dirent.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* Most ports on the way to a USB device (USB 3.2, section 4.1.4: five hubs, and the root). */
enum { PORTS_MAX = 7 };

/* The name of a device in sysfs, "1-2.3", by which people also find the plug. */
static void print_usb_ports(libusb_device *device, char *text, size_t size)
{
	uint8_t ports[PORTS_MAX];
	int count = libusb_get_port_numbers(device, ports, PORTS_MAX);
	int used = snprintf(text, size, "%d", libusb_get_bus_number(device));
	for (int i = 0; i < count && (size_t)used < size; i++)
		used += snprintf(text + used, size - (size_t)used, "%c%d", i == 0 ? '-' : '.',
				 ports[i]);
}

/* Read one line of an attribute. Control characters, which could change the state of a terminal,
 * become question marks. Empty if there is no such attribute. */
static void read_sysfs_attribute(const char *directory, const char *attribute, char *text,
				 size_t size)
{
	char path[PATH_MAX + 32];
	text[0] = '\0';
	snprintf(path, sizeof path, "%s/%s", directory, attribute);
	FILE *file = fopen(path, "re");
	if (!file)
		return;
	if (!fgets(text, (int)size, file))
		text[0] = '\0';
	fclose(file);
	text[strcspn(text, "\n")] = '\0';
	gz_utf8_clean(text);
}

void gz_usb_describe(libusb_device *device, struct gz_usb_device *out_device)
{
	struct libusb_device_descriptor descriptor = { 0 };
	char ports[40], directory[80];
	/* Cannot fail since libusb 1.0.16, which caches the descriptor. */
	libusb_get_device_descriptor(device, &descriptor);
	print_usb_ports(device, ports, sizeof ports);
	*out_device = (struct gz_usb_device) { .vendor = descriptor.idVendor,
					       .product = descriptor.idProduct };
	snprintf(out_device->place, sizeof out_device->place, "usb %s", ports);
	snprintf(out_device->node, sizeof out_device->node, "/dev/bus/usb/%03d/%03d",
		 libusb_get_bus_number(device), libusb_get_device_address(device));
	snprintf(directory, sizeof directory, GZ_SYSFS "/bus/usb/devices/%s", ports);
	read_sysfs_attribute(directory, "product", out_device->name, sizeof out_device->name);
	read_sysfs_attribute(directory, "serial", out_device->serial, sizeof out_device->serial);
}

/* Whether a program uses the interface through usbfs, which sysfs then shows as its driver. */
static bool is_usb_interface_used(const struct gz_usb_device *device, int interface_number)
{
	char path[256], target[256];
	snprintf(path, sizeof path, "/sys/bus/usb/devices/%s:1.%d/driver",
		 device->place + strlen("usb "), interface_number);
	ssize_t length = readlink(path, target, sizeof target - 1);
	if (length < 0)
		return false;
	target[length] = '\0';
	const char *slash = strrchr(target, '/');
	return strcmp(slash ? slash + 1 : target, "usbfs") == 0;
}

void gz_usb_list_entry(const struct gz_usb_device *device, int interface_number,
		       struct gz_device_entry *out_entry)
{
	*out_entry = (struct gz_device_entry) { .usable = true };
	memcpy(out_entry->name, device->name, sizeof out_entry->name);
	memcpy(out_entry->serial, device->serial, sizeof out_entry->serial);
	memcpy(out_entry->place, device->place, sizeof out_entry->place);
	if (access(device->node, R_OK | W_OK) != 0) {
		out_entry->usable = false;
		snprintf(out_entry->reason, sizeof out_entry->reason, "no permission for %s; %s",
			 device->node, GZ_DEVICE_PERMISSION_REMEDY);
	} else if (is_usb_interface_used(device, interface_number)) {
		out_entry->usable = false;
		snprintf(out_entry->reason, sizeof out_entry->reason,
			 "in use by another program (perhaps gazed); close that program");
	}
}

/* The list that is being filled. */
struct refused_list {
	struct gz_device_entry *entries;
	size_t count, room;
};

static bool has_kernel_driver(const char *directory)
{
	char path[PATH_MAX + 32];
	snprintf(path, sizeof path, "%s/driver", directory);
	return access(path, F_OK) == 0;
}

/* Add the device of the interface at @p directory, ".../1-2/1-2:1.0". */
static void add_refused_device(struct refused_list *list, const char *directory)
{
	char device[PATH_MAX];
	if (list->count == list->room)
		return;
	struct gz_device_entry *entry = &list->entries[list->count];
	snprintf(device, sizeof device, "%s", directory);
	char *slash = strrchr(device, '/');
	if (!slash || slash == device)
		return;
	*slash = '\0';
	*entry = (struct gz_device_entry) { 0 };
	slash = strrchr(device, '/');
	snprintf(entry->place, sizeof entry->place, "usb %.50s", slash ? slash + 1 : device);
	read_sysfs_attribute(device, "product", entry->name, sizeof entry->name);
	read_sysfs_attribute(device, "serial", entry->serial, sizeof entry->serial);
	if (!entry->name[0])
		snprintf(entry->name, sizeof entry->name, "HID device without a name");
	snprintf(entry->reason, sizeof entry->reason,
		 "the kernel refused this HID device (dmesg says why); if it is an eye tracker, "
		 "its report descriptor is malformed: ask its maker");
	list->count++;
}

/* Call @p visit for each device of a bus, with its resolved path. */
static void for_each_on_bus(const char *sysfs, const char *bus, struct refused_list *list,
			    void (*visit)(struct refused_list *list, const char *name,
					  const char *directory))
{
	char path[PATH_MAX], found[PATH_MAX + NAME_MAX + 2], directory[PATH_MAX];
	snprintf(path, sizeof path, "%s/bus/%s/devices", sysfs, bus);
	DIR *devices = opendir(path);
	if (!devices)
		return;
	const struct dirent *item;
	while ((item = readdir(devices))) {
		snprintf(found, sizeof found, "%s/%s", path, item->d_name);
		if (item->d_name[0] != '.' && realpath(found, directory))
			visit(list, item->d_name, directory);
	}
	closedir(devices);
}

/* usbhid refused the interface: it could not read the descriptor. */
static void visit_usb_interface(struct refused_list *list, const char *name, const char *directory)
{
	char class[8];
	if (!strchr(name, ':'))
		return;
	read_sysfs_attribute(directory, "bInterfaceClass", class, sizeof class);
	if (strcmp(class, "03") == 0 && !has_kernel_driver(directory))
		add_refused_device(list, directory);
}

/* usbhid accepted the interface, but no HID driver understands the descriptor. The names of HID
 * devices begin with the bus: 3 is USB. */
static void visit_hid_device(struct refused_list *list, const char *name, const char *directory)
{
	char interface[PATH_MAX];
	if (strncmp(name, "0003:", 5) != 0 || has_kernel_driver(directory))
		return;
	snprintf(interface, sizeof interface, "%s", directory);
	char *slash = strrchr(interface, '/');
	if (!slash)
		return;
	*slash = '\0';
	add_refused_device(list, interface);
}

/* A driver that is not loaded refuses nothing. */
static bool is_kernel_driver_loaded(const char *sysfs, const char *driver)
{
	char path[PATH_MAX];
	snprintf(path, sizeof path, "%s/bus/%s", sysfs, driver);
	return access(path, F_OK) == 0;
}

size_t gz_usb_list_refused(const char *sysfs, struct gz_device_entry *out_entries, size_t room)
{
	struct refused_list list = { out_entries, 0, room };
	if (is_kernel_driver_loaded(sysfs, "usb/drivers/usbhid"))
		for_each_on_bus(sysfs, "usb", &list, visit_usb_interface);
	if (is_kernel_driver_loaded(sysfs, "hid/drivers/hid-generic"))
		for_each_on_bus(sysfs, "hid", &list, visit_hid_device);
	return list.count;
}

enum gz_result gz_usb_result(int libusb_error)
{
	switch (libusb_error) {
	case LIBUSB_ERROR_NO_DEVICE:
	case LIBUSB_ERROR_NOT_FOUND:
		return GZ_ERR_NO_DEVICE;
	case LIBUSB_ERROR_ACCESS:
		return GZ_ERR_ACCESS;
	case LIBUSB_ERROR_BUSY:
		return GZ_ERR_BUSY;
	case LIBUSB_ERROR_NO_MEM:
		return GZ_ERR_NO_MEM;
	case LIBUSB_ERROR_TIMEOUT:
		return GZ_ERR_TIMEOUT;
	default:
		return libusb_error < 0 ? GZ_ERR_IO : GZ_OK;
	}
}
