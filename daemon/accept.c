#include "daemon/accept.h"

#include <arpa/inet.h>
#include <dlfcn.h>
#include <errno.h>
#include <netinet/in.h>
#include <pthread.h>
#include <stdatomic.h>
#include <string.h>
#include <sys/syscall.h>
#include <sys/un.h>
#include <unistd.h>

#include "base/clock.h"

/* Ports and local sockets at which connections come through doors. */
enum { OPENINGS_MAX = 8 };

_Static_assert(OPENINGS_MAX < GZ_DOOR_CHANNELS, "each opening is a channel");

/* libzmq calls without a context of ours, so these are the doors of the program. */
static pthread_mutex_t door_mutex = PTHREAD_MUTEX_INITIALIZER;
static struct opening {
	struct gz_door *door;
	uint16_t port; /* 0: a local socket */
	char path[sizeof((struct sockaddr_un *)0)->sun_path];
} openings[OPENINGS_MAX];
static _Atomic int opening_count;

/* At which opening the connections are, from 1 on; 0: none. No part of a door, which may end while
 * libzmq reads. */
static _Atomic uint8_t opening_of[GZ_QUOTA_DESCRIPTORS];

static void note_opening(int fd, int number)
{
	if (fd >= 0 && fd < GZ_QUOTA_DESCRIPTORS)
		atomic_store_explicit(&opening_of[fd], (uint8_t)number, memory_order_relaxed);
}

static int noted_opening(int fd)
{
	return fd >= 0 && fd < GZ_QUOTA_DESCRIPTORS
		       ? atomic_load_explicit(&opening_of[fd], memory_order_relaxed)
		       : 0;
}

int gz_accept_channel(int fd)
{
	return noted_opening(fd);
}

static int add_opening(const struct opening *opening)
{
	int number = 0;
	pthread_mutex_lock(&door_mutex);
	int count = atomic_load(&opening_count);
	if (count < OPENINGS_MAX) {
		openings[count] = *opening;
		number = count + 1;
		atomic_store(&opening_count, number);
	}
	pthread_mutex_unlock(&door_mutex);
	return number;
}

int gz_accept_through(struct gz_door *door, uint16_t port)
{
	const struct opening opening = { .door = door, .port = port };
	return add_opening(&opening);
}

int gz_accept_through_path(struct gz_door *door, const char *path)
{
	struct opening opening = { .door = door };
	if (strlen(path) >= sizeof opening.path)
		return 0;
	memcpy(opening.path, path, strlen(path) + 1);
	return add_opening(&opening);
}

void gz_accept_freely(void)
{
	pthread_mutex_lock(&door_mutex);
	atomic_store(&opening_count, 0);
	pthread_mutex_unlock(&door_mutex);
}

/* An address of this machine. */
union local_address {
	struct sockaddr any;
	struct sockaddr_in v4;
	struct sockaddr_in6 v6;
	struct sockaddr_un local;
	struct sockaddr_storage room;
};

static bool is_address_of(const struct opening *opening, const union local_address *address)
{
	switch (address->any.sa_family) {
	case AF_INET:
		return opening->port > 0 && opening->port == ntohs(address->v4.sin_port);
	case AF_INET6:
		return opening->port > 0 && opening->port == ntohs(address->v6.sin6_port);
	case AF_UNIX:
		return opening->port == 0 &&
		       strncmp(opening->path, address->local.sun_path, sizeof opening->path) == 0;
	default:
		return false;
	}
}

/* @return the number of the opening at which the connection has come, from 1 on; 0: none */
static int find_opening(int fd)
{
	union local_address address = { .room = { .ss_family = AF_UNSPEC } };
	socklen_t size = sizeof address;
	int count = atomic_load(&opening_count);
	if (getsockname(fd, &address.any, &size) != 0)
		return 0;
	for (int i = 0; i < count; i++) {
		if (is_address_of(&openings[i], &address))
			return i + 1;
	}
	return 0;
}

/* Whether the connection may stay. */
static bool ask_to_enter(int fd)
{
	bool welcome = true;
	int64_t now_ns = gz_clock_now_ns();
	pthread_mutex_lock(&door_mutex);
	int number = find_opening(fd);
	note_opening(fd, number);
	/* The number may be that of a connection that ended unnoticed. */
	for (int i = 0; i < atomic_load(&opening_count); i++)
		gz_door_leave(openings[i].door, fd, now_ns);
	if (number > 0)
		welcome = gz_door_enter(openings[number - 1].door, fd, gz_connection_identity(fd),
					number, now_ns);
	pthread_mutex_unlock(&door_mutex);
	return welcome;
}

void gz_accept_ended(int fd)
{
	int64_t now_ns = gz_clock_now_ns();
	pthread_mutex_lock(&door_mutex);
	for (int i = 0; i < atomic_load(&opening_count); i++)
		gz_door_look(openings[i].door, fd, now_ns);
	pthread_mutex_unlock(&door_mutex);
}

/* Close at once and leave nothing in the kernel. */
static void turn_away(int fd)
{
	const struct linger at_once = { .l_onoff = 1, .l_linger = 0 };
	setsockopt(fd, SOL_SOCKET, SO_LINGER, &at_once, sizeof at_once);
	close(fd);
}

int gz_accept4(int fd, struct sockaddr *address, socklen_t *size, int flags)
{
	int accepted = (int)syscall(SYS_accept4, fd, address, size, flags);
	if (accepted < 0) {
		if (errno == EMFILE || errno == ENFILE || errno == ENOBUFS || errno == ENOMEM)
			errno = EAGAIN;
		return accepted;
	}
	if (atomic_load(&opening_count) == 0 || ask_to_enter(accepted))
		return accepted;
	turn_away(accepted);
	errno = EAGAIN;
	return -1;
}

int gz_accept(int fd, struct sockaddr *address, socklen_t *size)
{
	return gz_accept4(fd, address, size, 0);
}

/* @param received  the result of recv(), with errno. @return the result for the caller */
static ssize_t ask_to_pass(int fd, const void *bytes, ssize_t received)
{
	const int error = errno;
	pthread_mutex_lock(&door_mutex);
	int number = noted_opening(fd);
	bool is_open = number > 0 && number <= atomic_load(&opening_count);
	struct gz_door *door = is_open ? openings[number - 1].door : NULL;
	bool is_end = received == 0 || (received < 0 && error != EAGAIN && error != EINTR);
	if (is_end)
		note_opening(fd, 0);
	if (door && is_end)
		gz_door_leave(door, fd, gz_clock_now_ns());
	else if (door && received > 0 &&
		 !gz_door_pass(door, fd, gz_connection_identity(fd), bytes, (size_t)received,
			       gz_clock_now_ns()))
		received = 0;
	pthread_mutex_unlock(&door_mutex);
	errno = error;
	return received;
}

ssize_t gz_recv(int fd, void *bytes, size_t size, int flags)
{
	ssize_t received = syscall(SYS_recvfrom, fd, bytes, size, flags, NULL, NULL);
	if (size == 0 || flags & MSG_PEEK || gz_accept_channel(fd) == 0)
		return received;
	return ask_to_pass(fd, bytes, received);
}

static bool is_found_as(const char *name, void (*ours)(void))
{
	const void *found = dlsym(RTLD_DEFAULT, name);
	return memcmp(&found, &ours, sizeof found) == 0;
}

bool gz_accept_is_found(void)
{
	return is_found_as("accept4", (void (*)(void))gz_accept4) &&
	       is_found_as("recv", (void (*)(void))gz_recv);
}
