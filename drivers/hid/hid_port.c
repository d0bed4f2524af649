#include "drivers/hid/hid_port.h"

#include <errno.h>
#include <fcntl.h>
#include <hidapi.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* A port is hidapi's device under another name. */
static hid_device *hidapi_device_of(struct gz_hid_port *port)
{
	return (hid_device *)port;
}

static const char *node_name(const char *path)
{
	const char *slash = strrchr(path, '/');
	return slash ? slash + 1 : path;
}

/* Put a character of a name, which comes from the device. Characters other than printable ASCII,
 * which may not fit a log or a terminal, become question marks. */
static void put_name_character(char name[GZ_NAME_SIZE], size_t at, char c)
{
	name[at] = c >= ' ' && c <= '~' ? c : '?';
}

/* End a name, without trailing blanks. */
static void end_name(char name[GZ_NAME_SIZE], size_t n)
{
	while (n > 0 && name[n - 1] == ' ')
		n--;
	name[n] = '\0';
}

/* Copy a name from hidapi, which has none if the locale cannot represent it. */
static void copy_hidapi_name(const wchar_t *wide, char name[GZ_NAME_SIZE])
{
	size_t n = 0;
	for (; wide && wide[n] && n < GZ_NAME_SIZE - 1; n++)
		put_name_character(name, n, wide[n] > 0 && wide[n] < 0x80 ? (char)wide[n] : '?');
	end_name(name, n);
}

/* Copy a name from the kernel: "HID_NAME=...", maker and product. */
static void copy_kernel_name(const char *path, char name[GZ_NAME_SIZE])
{
	static const char key[] = "HID_NAME=";
	char file[128], text[1024] = "";
	size_t n = 0;
	snprintf(file, sizeof file, "/sys/class/hidraw/%s/device/uevent", node_name(path));
	int fd = open(file, O_RDONLY | O_CLOEXEC);
	ssize_t size = fd >= 0 ? read(fd, text, sizeof text - 1) : 0;
	if (fd >= 0)
		close(fd);
	text[size > 0 ? size : 0] = '\0';
	const char *line = strstr(text, key);
	if (!line)
		return;
	const char *value = line + sizeof key - 1;
	size_t length = strcspn(value, "\n");
	for (; n < length && n < GZ_NAME_SIZE - 1; n++)
		put_name_character(name, n, value[n]);
	end_name(name, n);
}

static bool is_port_listed(const struct gz_hid_port_entry *entries, size_t count, const char *path)
{
	for (size_t i = 0; i < count; i++) {
		if (strcmp(entries[i].path, path) == 0)
			return true;
	}
	return false;
}

size_t gz_hid_port_list(struct gz_hid_port_entry *out_entries)
{
	size_t count = 0;
	struct hid_device_info *all = hid_enumerate(0, 0);
	for (const struct hid_device_info *info = all; info; info = info->next) {
		/* hidapi lists an interface once for each of its applications. */
		if (count == GZ_HID_PORT_ENTRIES_MAX || !info->path ||
		    strlen(info->path) >= GZ_NAME_SIZE ||
		    is_port_listed(out_entries, count, info->path))
			continue;
		struct gz_hid_port_entry *entry = &out_entries[count++];
		*entry = (struct gz_hid_port_entry) {
			.vendor = info->vendor_id,
			.product = info->product_id,
		};
		snprintf(entry->path, sizeof entry->path, "%s", info->path);
		copy_hidapi_name(info->product_string, entry->name);
		copy_hidapi_name(info->serial_number, entry->serial);
		if (!entry->name[0])
			copy_kernel_name(info->path, entry->name);
		if (!entry->name[0])
			snprintf(entry->name, sizeof entry->name, "%04x:%04x", info->vendor_id,
				 info->product_id);
	}
	hid_free_enumeration(all);
	return count;
}

enum gz_result gz_hid_port_descriptor(const char *path, unsigned char *out_bytes, size_t *out_size)
{
	char file[128];
	snprintf(file, sizeof file, "/sys/class/hidraw/%s/device/report_descriptor",
		 node_name(path));
	int fd = open(file, O_RDONLY | O_CLOEXEC);
	if (fd < 0)
		return GZ_ERR_NO_DEVICE;
	size_t size = 0;
	ssize_t n = 1;
	while (n > 0 && size < GZ_HID_DESCRIPTOR_SIZE) {
		n = read(fd, out_bytes + size, GZ_HID_DESCRIPTOR_SIZE - size);
		size += n > 0 ? (size_t)n : 0;
	}
	close(fd);
	if (n < 0)
		return GZ_ERR_NO_DEVICE;
	*out_size = size;
	return GZ_OK;
}

enum gz_result gz_hid_port_may_open(const char *path)
{
	if (access(path, R_OK | W_OK) == 0)
		return GZ_OK;
	return errno == EACCES || errno == EPERM ? GZ_ERR_ACCESS : GZ_ERR_NO_DEVICE;
}

enum gz_result gz_hid_port_open(const char *path, struct gz_hid_port **out_port)
{
	enum gz_result result = gz_hid_port_may_open(path);
	if (result != GZ_OK)
		return result;
	hid_device *device = hid_open_path(path);
	if (!device)
		return GZ_ERR_NO_DEVICE;
	*out_port = (struct gz_hid_port *)device;
	return GZ_OK;
}

enum gz_result gz_hid_port_read(struct gz_hid_port *port, unsigned char *out_bytes, size_t size,
				int timeout_ms, size_t *out_size)
{
	errno = 0;
	int n = hid_read_timeout(hidapi_device_of(port), out_bytes, size, timeout_ms);
	if (n > 0) {
		*out_size = (size_t)n;
		return GZ_OK;
	}
	return n == 0 || errno == EINTR ? GZ_ERR_TIMEOUT : GZ_ERR_NO_DEVICE;
}

enum gz_result gz_hid_port_get_feature(struct gz_hid_port *port, uint8_t id,
				       unsigned char *out_bytes, size_t size, size_t *out_size)
{
	memset(out_bytes, 0, size);
	out_bytes[0] = id;
	int n = hid_get_feature_report(hidapi_device_of(port), out_bytes, size);
	if (n < 1 || (size_t)n > size)
		return GZ_ERR_IO;
	*out_size = (size_t)n;
	return GZ_OK;
}

enum gz_result gz_hid_port_set_feature(struct gz_hid_port *port, const unsigned char *bytes,
				       size_t size)
{
	return hid_send_feature_report(hidapi_device_of(port), bytes, size) < 0 ? GZ_ERR_IO : GZ_OK;
}

void gz_hid_port_close(struct gz_hid_port **port)
{
	if (!port || !*port)
		return;
	hid_close(hidapi_device_of(*port));
	*port = NULL;
}
