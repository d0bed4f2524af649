#include "daemon/accept.h"

#include <arpa/inet.h>
#include <dlfcn.h>
#include <errno.h>
#include <netinet/in.h>
#include <pthread.h>
#include <stdatomic.h>
#include <string.h>
#include <sys/syscall.h>
#include <unistd.h>

#include "base/clock.h"

/* Ports at which connections come through the door. */
enum { PORTS_MAX = 4 };

/* libzmq calls without a context of ours, so there is one door for the program. */
static pthread_mutex_t door_mutex = PTHREAD_MUTEX_INITIALIZER;
static _Atomic(struct gz_door *) the_door;
static uint16_t door_ports[PORTS_MAX];
static size_t door_port_count;

/* Which connections may be the door's. No part of the door, which may end while libzmq reads. */
static _Atomic bool at_door[GZ_QUOTA_DESCRIPTORS];

static void note_at_door(int fd, bool is_there)
{
	if (fd >= 0 && fd < GZ_QUOTA_DESCRIPTORS)
		atomic_store_explicit(&at_door[fd], is_there, memory_order_relaxed);
}

static bool is_at_door(int fd)
{
	return fd >= 0 && fd < GZ_QUOTA_DESCRIPTORS &&
	       atomic_load_explicit(&at_door[fd], memory_order_relaxed);
}

void gz_accept_through(struct gz_door *door, uint16_t port)
{
	pthread_mutex_lock(&door_mutex);
	if (door != atomic_load(&the_door))
		door_port_count = 0;
	if (door && door_port_count < PORTS_MAX)
		door_ports[door_port_count++] = port;
	atomic_store(&the_door, door);
	pthread_mutex_unlock(&door_mutex);
}

static uint16_t local_tcp_port(int fd)
{
	union {
		struct sockaddr any;
		struct sockaddr_in v4;
		struct sockaddr_in6 v6;
		struct sockaddr_storage room;
	} address = { 0 };
	socklen_t size = sizeof address;
	if (getsockname(fd, &address.any, &size) != 0)
		return 0;
	if (address.any.sa_family == AF_INET)
		return ntohs(address.v4.sin_port);
	return address.any.sa_family == AF_INET6 ? ntohs(address.v6.sin6_port) : 0;
}

static bool is_door_port(uint16_t port)
{
	for (size_t i = 0; i < door_port_count; i++) {
		if (door_ports[i] == port)
			return true;
	}
	return false;
}

/* Whether the connection may stay. */
static bool ask_to_enter(int fd)
{
	bool welcome = true;
	uint16_t port = local_tcp_port(fd);
	pthread_mutex_lock(&door_mutex);
	struct gz_door *door = atomic_load(&the_door);
	note_at_door(fd, door && is_door_port(port));
	/* The number may be that of a connection that ended unnoticed. */
	if (door && !is_door_port(port))
		gz_door_leave(door, fd, gz_clock_now_ns());
	else if (door)
		welcome = gz_door_enter(door, fd, gz_connection_identity(fd), gz_clock_now_ns());
	pthread_mutex_unlock(&door_mutex);
	return welcome;
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
	if (!atomic_load(&the_door) || ask_to_enter(accepted))
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
	struct gz_door *door = atomic_load(&the_door);
	bool is_end = received == 0 || (received < 0 && error != EAGAIN && error != EINTR);
	if (is_end)
		note_at_door(fd, false);
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
	if (size == 0 || flags & MSG_PEEK || !is_at_door(fd))
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
