#include "drivers/gazepoint/gazepoint_link.h"

#include <errno.h>
#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <resolv.h>
#include <stdio.h>
#include <string.h>
#include <sys/socket.h>
#include <time.h>
#include <unistd.h>

#include "base/clock.h"

static struct timespec left_until(int64_t deadline_ns)
{
	int64_t left_ns = deadline_ns - gz_clock_now_ns();
	if (left_ns < 0)
		left_ns = 0;
	return (struct timespec) { .tv_sec = (time_t)(left_ns / GZ_NS_PER_S),
				   .tv_nsec = (long)(left_ns % GZ_NS_PER_S) };
}

static enum gz_result wait_for(int fd, short events, int64_t deadline_ns)
{
	struct pollfd poll_fd = { .fd = fd, .events = events };
	for (;;) {
		struct timespec timeout = left_until(deadline_ns);
		int ready = ppoll(&poll_fd, 1, &timeout, NULL);
		if (ready > 0)
			return GZ_OK;
		if (ready == 0)
			return GZ_ERR_TIMEOUT;
		if (errno != EINTR)
			return GZ_ERR_NO_DEVICE;
	}
}

/* @return 0, or an errno */
static int finish_connecting(int fd, int timeout_ms)
{
	int error = 0;
	socklen_t size = sizeof error;
	if (wait_for(fd, POLLOUT, gz_clock_now_ns() + timeout_ms * GZ_NS_PER_MS) != GZ_OK)
		return ETIMEDOUT;
	if (getsockopt(fd, SOL_SOCKET, SO_ERROR, &error, &size) != 0)
		return errno;
	return error;
}

/* @return 0 and the socket, or an errno */
static int try_address(const struct addrinfo *address, int timeout_ms, int *out_fd)
{
	int one = 1, error = 0;
	int fd = socket(address->ai_family, address->ai_socktype | SOCK_NONBLOCK | SOCK_CLOEXEC,
			address->ai_protocol);
	if (fd < 0)
		return errno;
	if (connect(fd, address->ai_addr, address->ai_addrlen) != 0)
		error = errno == EINPROGRESS ? finish_connecting(fd, timeout_ms) : errno;
	if (error != 0) {
		close(fd);
		return error;
	}
	setsockopt(fd, IPPROTO_TCP, TCP_NODELAY, &one, sizeof one);
	*out_fd = fd;
	return 0;
}

/* The system's own limits for the look-up of a name are tens of seconds where no name server
 * answers; here, for this thread, it is a second for each. */
static void limit_lookup(void)
{
#ifdef __GLIBC__
	if (res_init() != 0)
		return;
	_res.retrans = 1;
	_res.retry = 1;
#endif
}

enum gz_result gz_gazepoint_link_open(const char *host, int port, int timeout_ms, int *out_fd,
				      char *out_reason)
{
	const struct addrinfo hints = { .ai_socktype = SOCK_STREAM };
	struct addrinfo *addresses;
	char service[16];
	limit_lookup();
	snprintf(service, sizeof service, "%d", port);
	int failure = getaddrinfo(host, service, &hints, &addresses);
	if (failure != 0) {
		snprintf(out_reason, GZ_GAZEPOINT_LINK_REASON_SIZE, "%s", gai_strerror(failure));
		return GZ_ERR_NO_DEVICE;
	}
	int error = EADDRNOTAVAIL;
	for (const struct addrinfo *a = addresses; a && error != 0; a = a->ai_next)
		error = try_address(a, timeout_ms, out_fd);
	freeaddrinfo(addresses);
	if (error == 0)
		return GZ_OK;
	snprintf(out_reason, GZ_GAZEPOINT_LINK_REASON_SIZE, "%s", strerror(error));
	return GZ_ERR_NO_DEVICE;
}

enum gz_result gz_gazepoint_link_send(int fd, const char *bytes, size_t size)
{
	ssize_t sent;
	do
		sent = send(fd, bytes, size, MSG_NOSIGNAL);
	while (sent < 0 && errno == EINTR);
	return sent == (ssize_t)size ? GZ_OK : GZ_ERR_NO_DEVICE;
}

enum gz_result gz_gazepoint_link_wait(int fd, int64_t deadline_ns)
{
	return wait_for(fd, POLLIN, deadline_ns);
}

enum gz_result gz_gazepoint_link_receive(int fd, void *bytes, size_t size, size_t *out_size)
{
	ssize_t n = recv(fd, bytes, size, 0);
	if (n > 0) {
		*out_size = (size_t)n;
		return GZ_OK;
	}
	if (n < 0 && (errno == EAGAIN || errno == EINTR))
		return GZ_ERR_TIMEOUT;
	if (n == 0)
		errno = 0;
	return GZ_ERR_NO_DEVICE;
}
