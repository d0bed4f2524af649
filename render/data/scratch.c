#include "render/data/scratch.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <unistd.h>

/* A file without a name, or, if the file system does not support that, one whose name is removed at
 * once. */
static int open_nameless(const char *folder)
{
	char path[4096];
	int fd = open(folder, O_TMPFILE | O_RDWR | O_CLOEXEC, S_IRUSR | S_IWUSR);
	if (fd >= 0 || errno == ENOENT)
		return fd;
	const int length = snprintf(path, sizeof path, "%s/gazecast-XXXXXX", folder);
	if (length < 0 || (size_t)length >= sizeof path)
		return -1;
	fd = mkostemp(path, O_CLOEXEC);
	if (fd >= 0)
		unlink(path);
	return fd;
}

enum gz_result gz_scratch_open(const char *folder, int *out_fd)
{
	const int fd = open_nameless(folder);
	if (fd < 0)
		return errno == ENOENT ? GZ_ERR_NOT_FOUND : GZ_ERR_IO;
	*out_fd = fd;
	return GZ_OK;
}

enum gz_result gz_scratch_reserve(int fd, size_t bytes)
{
	const int reserved = posix_fallocate(fd, 0, (off_t)bytes);
	if (reserved == 0)
		return GZ_OK;
	return reserved == ENOSPC || reserved == EFBIG ? GZ_ERR_FULL : GZ_ERR_IO;
}
