#include "render/data/scratch.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/mman.h>
#include <unistd.h>

/* A file without a name, or, where the file system knows none, one that loses its name at once. */
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

enum gz_result gz_scratch_map(const char *folder, size_t bytes, void **out_memory)
{
	int fd = open_nameless(folder);
	if (fd < 0)
		return errno == ENOENT ? GZ_ERR_NOT_FOUND : GZ_ERR_IO;
	const int reserved = posix_fallocate(fd, 0, (off_t)bytes);
	if (reserved != 0) {
		close(fd);
		return reserved == ENOSPC || reserved == EFBIG ? GZ_ERR_FULL : GZ_ERR_IO;
	}
	void *memory = mmap(NULL, bytes, PROT_READ | PROT_WRITE, MAP_SHARED, fd, 0);
	close(fd);
	if (memory == MAP_FAILED)
		return GZ_ERR_NO_MEM;
	*out_memory = memory;
	return GZ_OK;
}
