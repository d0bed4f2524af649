#include "protocol/board/board_door.h"

#include <errno.h>
#include <stdalign.h>
#include <stdbool.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include "protocol/board/board.h"

/* Readers that wait to be let in. Chosen: more than are started at a time. */
enum { WAITING_MAX = 64 };

/* What is sent beside the descriptor: the beginning of the board. */
enum { GREETING_SIZE = sizeof GZ_BOARD_MAGIC - 1 };

static bool fill_address(const char *path, struct sockaddr_un *address)
{
	*address = (struct sockaddr_un) { .sun_family = AF_UNIX };
	if (strlen(path) >= sizeof address->sun_path)
		return false;
	memcpy(address->sun_path, path, strlen(path) + 1);
	return true;
}

static int open_local_socket(void)
{
	return socket(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
}

/* Close @p fd, keeping errno. */
static void drop_descriptor(int fd)
{
	int kept = errno;
	if (fd >= 0)
		close(fd);
	errno = kept;
}

enum gz_result gz_board_door_open(const char *path, int *out_fd)
{
	struct sockaddr_un address;
	if (!fill_address(path, &address))
		return GZ_ERR_FULL;
	int fd = open_local_socket();
	unlink(path);
	if (fd >= 0 && bind(fd, (struct sockaddr *)&address, sizeof address) == 0 &&
	    listen(fd, WAITING_MAX) == 0) {
		*out_fd = fd;
		return GZ_OK;
	}
	drop_descriptor(fd);
	return GZ_ERR_IO;
}

/* A message with a greeting and room for one descriptor. */
struct passed {
	char greeting[GREETING_SIZE];
	struct iovec part;
	struct msghdr message;
	alignas(struct cmsghdr) char control[CMSG_SPACE(sizeof(int))];
};

static void prepare_passed(struct passed *passed)
{
	memset(passed, 0, sizeof *passed);
	passed->part = (struct iovec) { passed->greeting, sizeof passed->greeting };
	passed->message.msg_iov = &passed->part;
	passed->message.msg_iovlen = 1;
	passed->message.msg_control = passed->control;
	/* CMSG_SPACE() would leave room for a second descriptor. */
	passed->message.msg_controllen = CMSG_LEN(sizeof(int));
}

static void pass_descriptor(int connection, int fd)
{
	struct passed passed;
	prepare_passed(&passed);
	memcpy(passed.greeting, GZ_BOARD_MAGIC, sizeof passed.greeting);
	struct cmsghdr *control = CMSG_FIRSTHDR(&passed.message);
	control->cmsg_level = SOL_SOCKET;
	control->cmsg_type = SCM_RIGHTS;
	control->cmsg_len = CMSG_LEN(sizeof fd);
	memcpy(CMSG_DATA(control), &fd, sizeof fd);
	/* A reader that has gone misses nothing. */
	ssize_t sent = sendmsg(connection, &passed.message, MSG_DONTWAIT | MSG_NOSIGNAL);
	(void)sent;
}

enum gz_result gz_board_door_serve(int door, int board_fd)
{
	int connection = accept4(door, NULL, NULL, SOCK_CLOEXEC);
	if (connection >= 0) {
		pass_descriptor(connection, board_fd);
		close(connection);
		return GZ_OK;
	}
	if (errno == ECONNABORTED || errno == EINTR)
		return GZ_OK;
	/* In the daemon, EAGAIN may also mean that no descriptor is left (daemon/accept.h). */
	return errno == EAGAIN ? GZ_ERR_TIMEOUT : GZ_ERR_FULL;
}

enum gz_result gz_board_door_ask(const char *path, int *out_fd)
{
	struct sockaddr_un address;
	if (!fill_address(path, &address))
		return GZ_ERR_FULL;
	int fd = open_local_socket();
	if (fd >= 0 && connect(fd, (struct sockaddr *)&address, sizeof address) == 0) {
		*out_fd = fd;
		return GZ_OK;
	}
	drop_descriptor(fd);
	return errno == EAGAIN || errno == EINTR || errno == EMFILE || errno == ENFILE ||
			       errno == ENOMEM
		       ? GZ_ERR_BUSY
		       : GZ_ERR_NOT_FOUND;
}

/* The descriptor that came with a message; -1: none, or more than one */
static int passed_descriptor(struct msghdr *message)
{
	int fd;
	struct cmsghdr *control = CMSG_FIRSTHDR(message);
	if (!control || control->cmsg_level != SOL_SOCKET || control->cmsg_type != SCM_RIGHTS ||
	    control->cmsg_len != CMSG_LEN(sizeof fd))
		return -1;
	memcpy(&fd, CMSG_DATA(control), sizeof fd);
	return fd;
}

enum gz_result gz_board_door_take(int fd, int *out_board_fd)
{
	struct passed passed;
	prepare_passed(&passed);
	ssize_t size = recvmsg(fd, &passed.message, MSG_DONTWAIT | MSG_CMSG_CLOEXEC);
	if (size < 0 && (errno == EAGAIN || errno == EINTR))
		return GZ_ERR_TIMEOUT;
	int board_fd = size < 0 ? -1 : passed_descriptor(&passed.message);
	bool greeted = size == GREETING_SIZE &&
		       memcmp(passed.greeting, GZ_BOARD_MAGIC, GREETING_SIZE) == 0;
	if (board_fd >= 0 && greeted) {
		*out_board_fd = board_fd;
		return GZ_OK;
	}
	if (board_fd >= 0)
		close(board_fd);
	return GZ_ERR_PROTOCOL;
}
