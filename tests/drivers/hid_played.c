#include "hid_played.h"

#include <errno.h>
#include <poll.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

#include "drivers/hid/hid_port.h"

struct feature {
	size_t size;
	unsigned char bytes[HID_PLAYED_FEATURE_SIZE];
};

struct played {
	bool there;
	char name[GZ_NAME_SIZE], serial[GZ_NAME_SIZE];
	unsigned char descriptor[GZ_HID_DESCRIPTOR_SIZE];
	size_t descriptor_size;
	enum gz_result access;
	struct feature features[256];
	int times_set;
	int fd; /* end of the device; -1 while it is not open */
};

struct gz_hid_port {
	int number;
	int fd;
};

static pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER;
static struct played devices[HID_PLAYED_MAX];

static struct played *device_at(const char *path)
{
	int number = -1;
	if (sscanf(path, "/played/%d", &number) != 1 || number < 0 || number >= HID_PLAYED_MAX ||
	    !devices[number].there)
		return NULL;
	return &devices[number];
}

int hid_played_plug(const char *name, const char *serial, const unsigned char *descriptor,
		    size_t size)
{
	int number = 0;
	pthread_mutex_lock(&lock);
	while (number < HID_PLAYED_MAX - 1 && devices[number].there)
		number++;
	struct played *device = &devices[number];
	device->there = true;
	device->fd = -1;
	device->access = GZ_OK;
	snprintf(device->name, sizeof device->name, "%s", name);
	snprintf(device->serial, sizeof device->serial, "%s", serial);
	memcpy(device->descriptor, descriptor, size);
	device->descriptor_size = size;
	pthread_mutex_unlock(&lock);
	return number;
}

void hid_played_unplug(int number)
{
	pthread_mutex_lock(&lock);
	if (devices[number].there && devices[number].fd >= 0)
		close(devices[number].fd);
	devices[number].fd = -1;
	devices[number].there = false;
	pthread_mutex_unlock(&lock);
}

void hid_played_reset(void)
{
	for (int i = 0; i < HID_PLAYED_MAX; i++) {
		hid_played_unplug(i);
		memset(&devices[i], 0, sizeof devices[i]);
		devices[i].fd = -1;
	}
}

void hid_played_set_access(int number, enum gz_result result)
{
	devices[number].access = result;
}

void hid_played_set_feature(int number, uint8_t id, const unsigned char *bytes, size_t size)
{
	pthread_mutex_lock(&lock);
	devices[number].features[id].size = size;
	memcpy(devices[number].features[id].bytes, bytes, size);
	pthread_mutex_unlock(&lock);
}

size_t hid_played_get_feature(int number, uint8_t id, unsigned char *out_bytes)
{
	pthread_mutex_lock(&lock);
	size_t size = devices[number].features[id].size;
	memcpy(out_bytes, devices[number].features[id].bytes, size);
	pthread_mutex_unlock(&lock);
	return size;
}

int hid_played_times_set(int number)
{
	pthread_mutex_lock(&lock);
	int times = devices[number].times_set;
	pthread_mutex_unlock(&lock);
	return times;
}

bool hid_played_send(int number, const unsigned char *bytes, size_t size)
{
	pthread_mutex_lock(&lock);
	int fd = devices[number].fd;
	bool sent = fd >= 0 && send(fd, bytes, size, MSG_NOSIGNAL | MSG_DONTWAIT) == (ssize_t)size;
	pthread_mutex_unlock(&lock);
	return sent;
}

size_t gz_hid_port_list(struct gz_hid_port_entry *out_entries)
{
	size_t count = 0;
	pthread_mutex_lock(&lock);
	for (int i = 0; i < HID_PLAYED_MAX; i++) {
		if (!devices[i].there)
			continue;
		struct gz_hid_port_entry *entry = &out_entries[count++];
		*entry = (struct gz_hid_port_entry) { .vendor = 1, .product = (uint16_t)i };
		snprintf(entry->path, sizeof entry->path, "/played/%d", i);
		memcpy(entry->name, devices[i].name, sizeof entry->name);
		memcpy(entry->serial, devices[i].serial, sizeof entry->serial);
	}
	pthread_mutex_unlock(&lock);
	return count;
}

enum gz_result gz_hid_port_descriptor(const char *path, unsigned char *out_bytes, size_t *out_size)
{
	const struct played *device = device_at(path);
	if (!device)
		return GZ_ERR_NO_DEVICE;
	memcpy(out_bytes, device->descriptor, device->descriptor_size);
	*out_size = device->descriptor_size;
	return GZ_OK;
}

enum gz_result gz_hid_port_may_open(const char *path)
{
	const struct played *device = device_at(path);
	return device ? device->access : GZ_ERR_NO_DEVICE;
}

enum gz_result gz_hid_port_open(const char *path, struct gz_hid_port **out_port)
{
	int ends[2];
	struct played *device = device_at(path);
	if (!device || device->access != GZ_OK)
		return device ? device->access : GZ_ERR_NO_DEVICE;
	struct gz_hid_port *port = malloc(sizeof *port);
	/* Keeps report boundaries, as the device node does. */
	if (!port || socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends) != 0) {
		free(port);
		return GZ_ERR_NO_MEM;
	}
	*port = (struct gz_hid_port) { (int)(device - devices), ends[0] };
	pthread_mutex_lock(&lock);
	if (device->fd >= 0)
		close(device->fd);
	device->fd = ends[1];
	pthread_mutex_unlock(&lock);
	*out_port = port;
	return GZ_OK;
}

enum gz_result gz_hid_port_read(struct gz_hid_port *port, unsigned char *out_bytes, size_t size,
				int timeout_ms, size_t *out_size)
{
	struct pollfd wait = { .fd = port->fd, .events = POLLIN };
	int ready = poll(&wait, 1, timeout_ms);
	if (ready == 0 || (ready < 0 && errno == EINTR))
		return GZ_ERR_TIMEOUT;
	ssize_t n = recv(port->fd, out_bytes, size, MSG_DONTWAIT);
	if (n <= 0)
		return GZ_ERR_NO_DEVICE;
	*out_size = (size_t)n;
	return GZ_OK;
}

enum gz_result gz_hid_port_get_feature(struct gz_hid_port *port, uint8_t id,
				       unsigned char *out_bytes, size_t size, size_t *out_size)
{
	unsigned char bytes[HID_PLAYED_FEATURE_SIZE];
	size_t n = hid_played_get_feature(port->number, id, bytes);
	if (n == 0)
		return GZ_ERR_IO;
	*out_size = n < size ? n : size;
	memcpy(out_bytes, bytes, *out_size);
	return GZ_OK;
}

enum gz_result gz_hid_port_set_feature(struct gz_hid_port *port, const unsigned char *bytes,
				       size_t size)
{
	if (size > HID_PLAYED_FEATURE_SIZE || devices[port->number].features[bytes[0]].size == 0)
		return GZ_ERR_IO;
	hid_played_set_feature(port->number, bytes[0], bytes, size);
	pthread_mutex_lock(&lock);
	devices[port->number].times_set++;
	pthread_mutex_unlock(&lock);
	return GZ_OK;
}

void gz_hid_port_close(struct gz_hid_port **port)
{
	if (!port || !*port)
		return;
	pthread_mutex_lock(&lock);
	struct played *device = &devices[(*port)->number];
	if (device->fd >= 0)
		close(device->fd);
	device->fd = -1;
	pthread_mutex_unlock(&lock);
	close((*port)->fd);
	free(*port);
	*port = NULL;
}
