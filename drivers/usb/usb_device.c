#include "drivers/usb/usb_device.h"

#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* USB allows no more ports on the way to a device (USB 3.2, section 4.1.4: five hubs, and the
 * root).
 */
enum { PORTS_MAX = 7 };

/* sysfs' name of a device, "1-2.3", which is also how people find the plug. */
static void print_ports(libusb_device *device, char *text, size_t size)
{
	uint8_t ports[PORTS_MAX];
	int count = libusb_get_port_numbers(device, ports, PORTS_MAX);
	int used = snprintf(text, size, "%d", libusb_get_bus_number(device));
	for (int i = 0; i < count && (size_t)used < size; i++)
		used += snprintf(text + used, size - (size_t)used, "%c%d", i == 0 ? '-' : '.',
				 ports[i]);
}

/* One line of an attribute, with nothing in it that could steer a terminal. */
static void read_attribute(const char *ports, const char *attribute, char text[GZ_NAME_SIZE])
{
	char path[256];
	text[0] = '\0';
	snprintf(path, sizeof path, "/sys/bus/usb/devices/%s/%s", ports, attribute);
	FILE *file = fopen(path, "re");
	if (!file)
		return;
	if (!fgets(text, GZ_NAME_SIZE, file))
		text[0] = '\0';
	fclose(file);
	text[strcspn(text, "\n")] = '\0';
	for (char *c = text; *c; c++)
		if (iscntrl((unsigned char)*c))
			*c = '?';
}

void gz_usb_describe(libusb_device *device, struct gz_usb_device *out_device)
{
	struct libusb_device_descriptor descriptor = { 0 };
	char ports[40];
	/* Cannot fail since libusb 1.0.16: the descriptor is cached. */
	libusb_get_device_descriptor(device, &descriptor);
	print_ports(device, ports, sizeof ports);
	*out_device = (struct gz_usb_device) { .vendor = descriptor.idVendor,
					       .product = descriptor.idProduct };
	snprintf(out_device->place, sizeof out_device->place, "usb %s", ports);
	snprintf(out_device->node, sizeof out_device->node, "/dev/bus/usb/%03d/%03d",
		 libusb_get_bus_number(device), libusb_get_device_address(device));
	read_attribute(ports, "product", out_device->name);
	read_attribute(ports, "serial", out_device->serial);
}

bool gz_usb_is_chosen(const struct gz_usb_device *device, const char *choice)
{
	if (!choice || !choice[0])
		return true;
	return strcmp(choice, device->serial) == 0 || strcmp(choice, device->name) == 0;
}

/* A program that uses an interface through usbfs is shown as its driver. */
static bool is_held(const struct gz_usb_device *device, int interface_number)
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
			 device->node, GZ_USB_PERMISSION_REMEDY);
	} else if (is_held(device, interface_number)) {
		out_entry->usable = false;
		snprintf(out_entry->reason, sizeof out_entry->reason,
			 "held by another program (perhaps gazed); end that one");
	}
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
