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
#include <unistd.h>

#include "base/clock.h"
#include "drivers/device/device.h"

/* Wait for a connection that is being established. @return 0, or an errno */
static int finish_connecting(int fd)
{
	int error = 0;
	socklen_t size = sizeof error;
	int64_t deadline_ns = gz_clock_now_ns() + GZ_GAZEPOINT_CONNECT_MS * GZ_NS_PER_MS;
	if (gz_device_poll(fd, POLLOUT, deadline_ns) != GZ_OK)
		return ETIMEDOUT;
	if (getsockopt(fd, SOL_SOCKET, SO_ERROR, &error, &size) != 0)
		return errno;
	return error;
}

/* Connect to one address. @return 0 and the socket, or an errno */
static int connect_to_address(const struct addrinfo *address, int *out_fd)
{
	int one = 1, error = 0;
	int fd = socket(address->ai_family, address->ai_socktype | SOCK_NONBLOCK | SOCK_CLOEXEC,
			address->ai_protocol);
	if (fd < 0)
		return errno;
	if (connect(fd, address->ai_addr, address->ai_addrlen) != 0)
		error = errno == EINPROGRESS ? finish_connecting(fd) : errno;
	if (error != 0) {
		close(fd);
		return error;
	}
	setsockopt(fd, IPPROTO_TCP, TCP_NODELAY, &one, sizeof one);
	*out_fd = fd;
	return 0;
}

/* Without a name server, the system tries for tens of seconds to look up a name. Limit this thread
 * to one try of a second for each server. */
static void limit_name_lookup(void)
{
#ifdef __GLIBC__
	if (res_init() != 0)
		return;
	_res.retrans = 1;
	_res.retry = 1;
#endif
}

enum gz_result gz_gazepoint_link_open(const char *host, int port, int *out_fd, char *out_reason)
{
	const struct addrinfo hints = { .ai_socktype = SOCK_STREAM };
	struct addrinfo *addresses;
	char service[16];
	limit_name_lookup();
	snprintf(service, sizeof service, "%d", port);
	int failure = getaddrinfo(host, service, &hints, &addresses);
	if (failure != 0) {
		snprintf(out_reason, GZ_GAZEPOINT_LINK_REASON_SIZE, "%s", gai_strerror(failure));
		return GZ_ERR_NO_DEVICE;
	}
	int error = EADDRNOTAVAIL;
	for (const struct addrinfo *a = addresses; a && error != 0; a = a->ai_next)
		error = connect_to_address(a, out_fd);
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
