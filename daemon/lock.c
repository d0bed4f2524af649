#include "daemon/lock.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <string.h>
#include <sys/file.h>
#include <unistd.h>

#include "protocol/gaze.h"

#define GZ_LOG_MODULE "lock"

/* "4711", as the holder left it; "?" where it has not yet. */
static void read_holder(int fd, char *text, size_t size)
{
	ssize_t n = pread(fd, text, size - 1, 0);
	text[n > 0 ? n : 0] = '\0';
	text[strspn(text, "0123456789")] = '\0';
	if (!text[0])
		snprintf(text, size, "?");
}

static void write_holder(int fd)
{
	char text[32];
	int length = snprintf(text, sizeof text, "%ld\n", (long)getpid());
	if (ftruncate(fd, 0) != 0 || pwrite(fd, text, (size_t)length, 0) != length)
		return; /* only the message to a second daemon is poorer */
}

enum gz_result gz_lock_take(const char *directory, const struct gz_log *log, int *out_fd)
{
	char path[GZ_PATH_SIZE], holder[16];
	snprintf(path, sizeof path, "%s/lock", directory);
	int fd = open(path, O_RDWR | O_CREAT | O_NOFOLLOW | O_CLOEXEC, 0600);
	if (fd < 0) {
		gz_err(log, "cannot make %s: %s; name another directory in GAZECAST_RUNTIME_DIR",
		       path, strerror(errno));
		return GZ_ERR_IO;
	}
	if (flock(fd, LOCK_EX | LOCK_NB) != 0) {
		read_holder(fd, holder, sizeof holder);
		gz_err(log,
		       "a gazed (process %s) already serves %s; stop it, or give this one a "
		       "directory of its own in GAZECAST_RUNTIME_DIR",
		       holder, directory);
		close(fd);
		return GZ_ERR_BUSY;
	}
	write_holder(fd);
	*out_fd = fd;
	return GZ_OK;
}
