#include "daemon/quota.h"

#include <dirent.h>
#include <fcntl.h>
#include <linux/sockios.h>
#include <linux/tcp.h>
#include <netinet/in.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <sys/epoll.h>
#include <sys/ioctl.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/clock.h"
#include "protocol/gaze.h"

#define GZ_LOG_MODULE "security"

/* Most readers that are looked at in one check. */
enum { CHECKED_AT_ONCE = 64 };

/* A message about one reason is logged once a minute. */
#define COMPLAINT_NS (60 * GZ_NS_PER_S)

struct held {
	uint64_t identity;  /* 0: no connection */
	const void *socket; /* at which it came */
	int64_t arrived_ns;
	uint32_t spent; /* bytes that count against the limits */
	bool is_tcp;
	bool is_reader;
	bool ended; /* by us; libzmq has not closed it yet */
};

struct gz_quota {
	const struct gz_log *log;
	int epoll_fd;
	uint32_t limit;
	uint32_t tcp_limit;
	uint32_t count;
	uint32_t tcp_count;
	int end;           /* no connection has had a descriptor from here on */
	uint64_t spent;    /* by all */
	int64_t all_ns;    /* when all readers are looked at next */
	struct held *held; /* by descriptor; GZ_QUOTA_DESCRIPTORS */
	_Atomic uint64_t ended[GZ_QUOTA_REASON_COUNT];
	struct gz_ratelimit complaints[GZ_QUOTA_REASON_COUNT];
};

/* By statx(), not fstat(), which ThreadSanitizer watches: it does not see that libzmq closes
 * connections, and would take it for a race that another thread then has a file of that number. */
uint64_t gz_connection_identity(int fd)
{
	struct statx status;
	if (fd < 0 || statx(fd, "", AT_EMPTY_PATH, STATX_TYPE | STATX_INO, &status) != 0 ||
	    !S_ISSOCK(status.stx_mode))
		return 0;
	return status.stx_ino;
}

/* shutdown() leaves what has arrived, and libzmq would still read that. recv() is not called,
 * because it asks the door (accept.h), which may be the caller. */
static void discard_received(int fd)
{
	static const int rounds_max = 256; /* 16 MiB, more than a socket holds */
	char bytes[65536];
	for (int i = 0;
	     i < rounds_max && recvfrom(fd, bytes, sizeof bytes, MSG_DONTWAIT, NULL, NULL) > 0; i++)
		;
}

void gz_connection_end(int fd, uint64_t identity)
{
	/* The copy stays the same file, whatever libzmq does meanwhile. */
	int copy = fcntl(fd, F_DUPFD_CLOEXEC, 0);
	if (copy < 0) { /* no descriptor is left, so the number itself must do */
		if (gz_connection_identity(fd) == identity)
			shutdown(fd, SHUT_RDWR);
		return;
	}
	if (gz_connection_identity(copy) == identity) {
		shutdown(copy, SHUT_RDWR);
		discard_received(copy);
	}
	close(copy);
}

static uint32_t count_open_files(uint32_t otherwise)
{
	uint32_t count = 0;
	DIR *directory = opendir("/proc/self/fd");
	if (!directory)
		return otherwise;
	while (readdir(directory))
		count++;
	closedir(directory);
	return count;
}

uint32_t gz_quota_connections_possible(void)
{
	static const uint32_t least = 4, files_otherwise = 64;
	struct rlimit limit;
	if (getrlimit(RLIMIT_NOFILE, &limit) != 0)
		return least;
	uint32_t used = count_open_files(files_otherwise) + GZ_QUOTA_FILES_RESERVED;
	if (limit.rlim_cur >= (rlim_t)used + GZ_QUOTA_CONNECTIONS)
		return GZ_QUOTA_CONNECTIONS;
	return limit.rlim_cur > used + least ? (uint32_t)limit.rlim_cur - used : least;
}

enum gz_result gz_quota_create(uint32_t connections, const struct gz_log *log,
			       struct gz_quota **out_quota)
{
	struct gz_quota *quota = calloc(1, sizeof *quota);
	if (!quota)
		return GZ_ERR_NO_MEM;
	quota->log = log;
	quota->limit = connections;
	quota->tcp_limit = connections - connections / 4;
	quota->held = calloc(GZ_QUOTA_DESCRIPTORS, sizeof *quota->held);
	quota->epoll_fd = epoll_create1(EPOLL_CLOEXEC);
	if (!quota->held || quota->epoll_fd < 0) {
		gz_quota_destroy(&quota);
		return GZ_ERR_NO_MEM;
	}
	*out_quota = quota;
	return GZ_OK;
}

static bool is_over_tcp(int fd)
{
	int domain = 0;
	socklen_t size = sizeof domain;
	return getsockopt(fd, SOL_SOCKET, SO_DOMAIN, &domain, &size) == 0 && domain != AF_UNIX;
}

/* A connection that was ended no longer counts, although libzmq may take a moment to close it:
 * otherwise a burst over TCP would keep local connections out. */
static void release_quota_slot(struct gz_quota *quota, struct held *held)
{
	if (held->ended)
		return;
	quota->count--;
	quota->tcp_count -= held->is_tcp;
	quota->spent -= held->spent;
	held->spent = 0;
}

static void forget_connection(struct gz_quota *quota, struct held *held)
{
	release_quota_slot(quota, held);
	*held = (struct held) { 0 };
}

static void end_connection(struct gz_quota *quota, int fd, enum gz_quota_reason reason)
{
	static const char *const texts[GZ_QUOTA_REASON_COUNT] = {
		[GZ_QUOTA_TOO_MANY] = "a connection is closed, because there are too many; is a "
				      "client opening connections without closing them?",
		[GZ_QUOTA_TOO_LARGE] = "client bug: the connection of a reader is closed, because "
				       "it sends too many subscriptions",
	};
	struct held *held = &quota->held[fd];
	uint64_t more;
	release_quota_slot(quota, held);
	held->ended = true;
	gz_connection_end(fd, held->identity);
	atomic_fetch_add_explicit(&quota->ended[reason], 1, memory_order_relaxed);
	if (gz_ratelimit_pass(&quota->complaints[reason], gz_clock_now_ns(), COMPLAINT_NS, &more))
		gz_warn(quota->log, "%s (%u are open; %llu more since the last message)",
			texts[reason], quota->count, (unsigned long long)more);
}

/* Through a copy, which stays the same file: libzmq may close the connection at any time, and
 * another thread may then have a file of that number. The kernel watches until libzmq has closed it
 * (epoll(7), question 6). A reader without a copy is only looked at when all are. */
static void watch_reader(struct gz_quota *quota, int fd, uint64_t identity)
{
	struct epoll_event wanted = { .events = EPOLLIN | EPOLLET, .data.fd = fd };
	int copy = fcntl(fd, F_DUPFD_CLOEXEC, 0);
	if (copy < 0)
		return;
	if (gz_connection_identity(copy) == identity)
		epoll_ctl(quota->epoll_fd, EPOLL_CTL_ADD, copy, &wanted);
	close(copy);
}

void gz_quota_arrived(struct gz_quota *quota, int fd, const void *socket, bool is_reader,
		      int64_t now_ns)
{
	uint64_t identity = gz_connection_identity(fd);
	if (identity == 0) /* it has left already */
		return;
	if (fd >= GZ_QUOTA_DESCRIPTORS) {
		gz_connection_end(fd, identity);
		return;
	}
	struct held *held = &quota->held[fd];
	/* Each socket reports the end of its own connections, perhaps later than this. */
	if (held->identity)
		forget_connection(quota, held);
	*held = (struct held) { .identity = identity,
				.socket = socket,
				.arrived_ns = now_ns,
				.is_tcp = is_over_tcp(fd),
				.is_reader = is_reader };
	if (fd >= quota->end)
		quota->end = fd + 1;
	quota->count++;
	quota->tcp_count += held->is_tcp;
	if (quota->count > quota->limit || (held->is_tcp && quota->tcp_count > quota->tcp_limit)) {
		end_connection(quota, fd, GZ_QUOTA_TOO_MANY);
		return;
	}
	if (is_reader)
		watch_reader(quota, fd, identity);
}

void gz_quota_left(struct gz_quota *quota, int fd, const void *socket)
{
	if (fd < 0 || fd >= GZ_QUOTA_DESCRIPTORS)
		return;
	struct held *held = &quota->held[fd];
	if (held->identity && held->socket == socket)
		forget_connection(quota, held);
}

int gz_quota_fd(const struct gz_quota *quota)
{
	return quota->epoll_fd;
}

/* Bytes that the connection has sent; for a local one, which the kernel does not count, only those
 * that nobody has read. More than a reader may send at once does not lie there for a good reason.
 */
static uint64_t bytes_sent(int fd, const struct held *held)
{
	struct tcp_info info = { 0 };
	socklen_t size = sizeof info;
	int unread = 0;
	if (held->is_tcp && getsockopt(fd, IPPROTO_TCP, TCP_INFO, &info, &size) == 0)
		return info.tcpi_bytes_received;
	return ioctl(fd, SIOCINQ, &unread) == 0 && unread > 0 ? (uint64_t)unread : 0;
}

/* Count what the connection has sent and may not send without an end. */
static void count_bytes(struct gz_quota *quota, int fd, int64_t now_ns)
{
	struct held *held = &quota->held[fd];
	uint64_t free = GZ_QUOTA_HANDSHAKE + (uint64_t)((now_ns - held->arrived_ns) / GZ_NS_PER_S) *
						     GZ_QUOTA_READER_BYTES_PER_S;
	uint64_t sent = bytes_sent(fd, held);
	uint64_t spent = sent > free ? sent - free : 0;
	quota->spent -= held->spent;
	held->spent = spent < UINT32_MAX ? (uint32_t)spent : UINT32_MAX;
	quota->spent += held->spent;
}

static void check_reader(struct gz_quota *quota, int fd, int64_t now_ns)
{
	struct held *held = &quota->held[fd];
	if (!held->identity || !held->is_reader || held->ended ||
	    gz_connection_identity(fd) != held->identity)
		return;
	count_bytes(quota, fd, now_ns);
	if (held->spent > GZ_QUOTA_READER_BYTES || quota->spent > GZ_QUOTA_ALL_BYTES)
		end_connection(quota, fd, GZ_QUOTA_TOO_LARGE);
}

void gz_quota_check(struct gz_quota *quota, int64_t now_ns)
{
	struct epoll_event events[CHECKED_AT_ONCE];
	bool all = now_ns >= quota->all_ns;
	if (all)
		quota->all_ns = now_ns + GZ_QUOTA_CHECK_MS * GZ_NS_PER_MS;
	for (int fd = 0; all && fd < quota->end; fd++)
		check_reader(quota, fd, now_ns);
	int count = epoll_wait(quota->epoll_fd, events, CHECKED_AT_ONCE, 0);
	for (int i = 0; i < count; i++)
		check_reader(quota, events[i].data.fd, now_ns);
}

uint32_t gz_quota_count(const struct gz_quota *quota)
{
	return quota->count;
}

uint64_t gz_quota_ended(const struct gz_quota *quota, enum gz_quota_reason reason)
{
	return atomic_load_explicit(&quota->ended[reason], memory_order_relaxed);
}

void gz_quota_destroy(struct gz_quota **quota)
{
	if (!quota || !*quota)
		return;
	if ((*quota)->epoll_fd >= 0)
		close((*quota)->epoll_fd);
	free((*quota)->held);
	free(*quota);
	*quota = NULL;
}
