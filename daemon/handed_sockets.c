#include "daemon/handed_sockets.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

#include "base/text.h"

#define GZ_LOG_MODULE "gazed"

/* The first descriptor that is handed over (SD_LISTEN_FDS_START). */
enum { FIRST_DESCRIPTOR = 3 };

/* How many descriptors are meant for this process. */
static int count_handed_descriptors(void)
{
	const char *pid = getenv("LISTEN_PID"), *count = getenv("LISTEN_FDS");
	long long whose, number;
	if (!pid || !count || !gz_number_parse_whole(pid, &whose) || whose != getpid() ||
	    !gz_number_parse_whole(count, &number) || number < 0 || number > INT16_MAX)
		return 0;
	return (int)number;
}

static int integer_option(int fd, int option)
{
	int value = 0;
	socklen_t size = sizeof value;
	return getsockopt(fd, SOL_SOCKET, option, &value, &size) == 0 ? value : -1;
}

/* Describe a descriptor, if it is a listening local socket with a path. */
static bool read_listening_socket(int fd, struct gz_handed_socket *out_socket)
{
	struct sockaddr_un address = { .sun_family = AF_UNSPEC };
	socklen_t size = sizeof address;
	if (getsockname(fd, (struct sockaddr *)&address, &size) != 0 ||
	    address.sun_family != AF_UNIX || address.sun_path[0] != '/' ||
	    integer_option(fd, SO_ACCEPTCONN) != 1 ||
	    !memchr(address.sun_path, '\0', sizeof address.sun_path))
		return false;
	out_socket->fd = fd;
	out_socket->type = integer_option(fd, SO_TYPE);
	memcpy(out_socket->path, address.sun_path, sizeof out_socket->path);
	return true;
}

static bool make_private(int fd)
{
	int flags = fcntl(fd, F_GETFL);
	return flags >= 0 && fcntl(fd, F_SETFL, flags | O_NONBLOCK) == 0 &&
	       fcntl(fd, F_SETFD, FD_CLOEXEC) == 0;
}

void gz_handed_sockets_take_over(struct gz_handed_sockets *out_sockets, const struct gz_log *log)
{
	const int count = count_handed_descriptors();
	out_sockets->count = 0;
	for (int fd = FIRST_DESCRIPTOR; fd < FIRST_DESCRIPTOR + count; fd++) {
		struct gz_handed_socket *next = &out_sockets->items[out_sockets->count];
		if (out_sockets->count < GZ_HANDED_SOCKETS_MAX && make_private(fd) &&
		    read_listening_socket(fd, next)) {
			out_sockets->count++;
			continue;
		}
		gz_warn(log,
			"descriptor %d of the service manager is not a listening local socket, or "
			"one "
			"too many; it is closed",
			fd);
		close(fd);
	}
	unsetenv("LISTEN_PID");
	unsetenv("LISTEN_FDS");
	unsetenv("LISTEN_FDNAMES");
}

int gz_handed_sockets_take(struct gz_handed_sockets *sockets, const char *path, int type)
{
	for (size_t i = 0; sockets && i < sockets->count; i++) {
		struct gz_handed_socket *item = &sockets->items[i];
		if (item->fd < 0 || item->type != type || strcmp(item->path, path) != 0)
			continue;
		int fd = item->fd;
		item->fd = -1;
		return fd;
	}
	return -1;
}

void gz_handed_sockets_close(struct gz_handed_sockets *sockets, const struct gz_log *log)
{
	for (size_t i = 0; i < sockets->count; i++) {
		if (sockets->items[i].fd < 0)
			continue;
		gz_warn(log, "%s of the service manager is not one of the daemon's sockets",
			sockets->items[i].path);
		close(sockets->items[i].fd);
	}
	sockets->count = 0;
}

/* A line of /proc/PID/net/unix, proc(5): "Num: RefCount Protocol Flags Type St Inode Path". Flag
 * 0x10000 is __SO_ACCEPTCON. */
static bool line_listens_at(const char *line, const char *path)
{
	unsigned flags = 0;
	int begin = 0;
	if (sscanf(line, "%*s %*s %*s %x %*s %*s %*s %n", &flags, &begin) != 1 || begin == 0)
		return false;
	const size_t length = strlen(path);
	return (flags & 0x10000) && strncmp(line + begin, path, length) == 0 &&
	       line[begin + (int)length] == '\n';
}

bool gz_socket_is_listened_at(const char *path)
{
	char line[512];
	bool found = false;
	FILE *file = fopen("/proc/self/net/unix", "re");
	while (file && !found && fgets(line, sizeof line, file))
		found = line_listens_at(line, path);
	if (file)
		fclose(file);
	return found;
}
