#include "suite.h"

#include "gadget.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define CONFIGFS "/sys/kernel/config/usb_gadget"

static void make_folder(const char *path)
{
	if (mkdir(path, 0755) != 0)
		fail_msg("mkdir %s: %s", path, strerror(errno));
}

void gadget_write(const char *folder, const char *name, const void *bytes, size_t size)
{
	char path[160];
	snprintf(path, sizeof path, "%s/%s", folder, name);
	int fd = open(path, O_WRONLY | O_CLOEXEC);
	ssize_t written = fd >= 0 ? write(fd, bytes, size) : -1;
	int error = errno;
	if (fd >= 0)
		close(fd);
	if (written != (ssize_t)size)
		fail_msg("writing %s: %s", path, strerror(error));
}

void gadget_print(const char *folder, const char *name, const char *format, ...)
{
	char text[128];
	va_list arguments;
	va_start(arguments, format);
	int length = vsnprintf(text, sizeof text, format, arguments);
	va_end(arguments);
	gadget_write(folder, name, text, (size_t)length);
}

void gadget_make(struct gadget *gadget, int controller, const struct gadget_identity *identity)
{
	char folder[128];
	*gadget = (struct gadget) { .controller = controller };
	snprintf(gadget->path, sizeof gadget->path, CONFIGFS "/g%d", controller);
	make_folder(gadget->path);
	gadget_print(gadget->path, "idVendor", "0x%04x", identity->vendor);
	gadget_print(gadget->path, "idProduct", "0x%04x", identity->product);
	snprintf(folder, sizeof folder, "%s/strings/0x409", gadget->path);
	make_folder(folder);
	gadget_print(folder, "manufacturer", "%s", identity->manufacturer);
	gadget_print(folder, "product", "%s", identity->name);
	gadget_print(folder, "serialnumber", "%s", identity->serial);
	snprintf(folder, sizeof folder, "%s/configs/c.1", gadget->path);
	make_folder(folder);
}

void gadget_add_function(struct gadget *gadget, const char *kind, const char *name, char *path,
			 size_t size)
{
	snprintf(path, size, "%s/functions/%s.%s", gadget->path, kind, name);
	make_folder(path);
}

void gadget_link_function(struct gadget *gadget, const char *kind, const char *name)
{
	char from[128], to[128];
	snprintf(from, sizeof from, "%s/functions/%s.%s", gadget->path, kind, name);
	snprintf(to, sizeof to, "%s/configs/c.1/%s.%s", gadget->path, kind, name);
	if (symlink(from, to) != 0)
		fail_msg("linking %s: %s", to, strerror(errno));
}

void gadget_plug(struct gadget *gadget)
{
	gadget_print(gadget->path, "UDC", "dummy_udc.%d", gadget->controller);
}

void gadget_unplug(struct gadget *gadget)
{
	gadget_write(gadget->path, "UDC", "\n", 1);
}

/* Remove the contents of @p folder of the gadget: links, then folders. */
static void empty_folder(const struct gadget *gadget, const char *folder)
{
	char path[512];
	struct dirent *entry;
	snprintf(path, sizeof path, "%s/%s", gadget->path, folder);
	DIR *handle = opendir(path);
	while (handle && (entry = readdir(handle))) {
		snprintf(path, sizeof path, "%s/%s/%s", gadget->path, folder, entry->d_name);
		if (entry->d_name[0] != '.' && unlink(path) != 0)
			rmdir(path);
	}
	if (handle)
		closedir(handle);
}

void gadget_remove(struct gadget *gadget)
{
	char path[96];
	if (!gadget->path[0])
		return;
	snprintf(path, sizeof path, "%s/UDC", gadget->path);
	int fd = open(path, O_WRONLY | O_CLOEXEC);
	if (fd >= 0) {
		/* Refused if it is not plugged in. */
		ssize_t ignored = write(fd, "\n", 1);
		(void)ignored;
		close(fd);
	}
	empty_folder(gadget, "configs/c.1");
	empty_folder(gadget, "configs");
	empty_folder(gadget, "functions");
	empty_folder(gadget, "strings");
	rmdir(gadget->path);
	gadget->path[0] = '\0';
}

void gadget_stall(int endpoint)
{
	uint8_t byte;
	/* Reading from an endpoint that sends stalls it and returns this error. */
	assert_int_equal(read(endpoint, &byte, 1), -1);
	assert_int_equal(errno, EBADMSG);
}
