#include "drivers/usb/usb_refused.h"

#include <ctype.h>
#include <dirent.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* What is being filled. */
struct list {
	struct gz_device_entry *entries;
	size_t count, room;
};

/* One line of an attribute, with nothing in it that could steer a terminal; empty if there is none.
 */
static void read_line(const char *directory, const char *attribute, char *text, size_t size)
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
	for (char *c = text; *c; c++)
		if (iscntrl((unsigned char)*c))
			*c = '?';
}

static bool has_driver(const char *directory)
{
	char path[PATH_MAX + 32];
	snprintf(path, sizeof path, "%s/driver", directory);
	return access(path, F_OK) == 0;
}

/* Add the device that the interface at @p directory, ".../1-2/1-2:1.0", belongs to. */
static void add(struct list *list, const char *directory)
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
	read_line(device, "product", entry->name, sizeof entry->name);
	read_line(device, "serial", entry->serial, sizeof entry->serial);
	if (!entry->name[0])
		snprintf(entry->name, sizeof entry->name, "HID device without a name");
	snprintf(entry->reason, sizeof entry->reason,
		 "the kernel did not take this HID device (dmesg says why); if it is an eye "
		 "tracker, "
		 "its report descriptor is at fault: ask its maker");
	list->count++;
}

/* Call @p visit for each device of a bus, by its true place. */
static void for_each(const char *sysfs, const char *bus, struct list *list,
		     void (*visit)(struct list *list, const char *name, const char *directory))
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

/* usbhid did not take the interface: it could not even read the descriptor. */
static void visit_interface(struct list *list, const char *name, const char *directory)
{
	char class[8];
	if (!strchr(name, ':'))
		return;
	read_line(directory, "bInterfaceClass", class, sizeof class);
	if (strcmp(class, "03") == 0 && !has_driver(directory))
		add(list, directory);
}

/* usbhid took it, but no HID driver understands the descriptor. Names begin with the bus: 3 is USB.
 */
static void visit_hid(struct list *list, const char *name, const char *directory)
{
	char interface[PATH_MAX];
	if (strncmp(name, "0003:", 5) != 0 || has_driver(directory))
		return;
	snprintf(interface, sizeof interface, "%s", directory);
	char *slash = strrchr(interface, '/');
	if (!slash)
		return;
	*slash = '\0';
	add(list, interface);
}

/* Where it is not loaded it refuses nobody. */
static bool is_loaded(const char *sysfs, const char *driver)
{
	char path[PATH_MAX];
	snprintf(path, sizeof path, "%s/bus/%s", sysfs, driver);
	return access(path, F_OK) == 0;
}

size_t gz_usb_list_refused(const char *sysfs, struct gz_device_entry *out_entries, size_t room)
{
	struct list list = { out_entries, 0, room };
	if (is_loaded(sysfs, "usb/drivers/usbhid"))
		for_each(sysfs, "usb", &list, visit_interface);
	if (is_loaded(sysfs, "hid/drivers/hid-generic"))
		for_each(sysfs, "hid", &list, visit_hid);
	return list.count;
}
