#include "render/volume/part_file.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#define GZ_LOG_MODULE "volume"

static enum gz_result fail(const struct gz_part_file *file, int error)
{
	gz_err(file->log, "%s: cannot be written: %s; make room or choose another place",
	       file->path, strerror(error));
	return error == ENOSPC || error == EDQUOT || error == EFBIG ? GZ_ERR_FULL : GZ_ERR_IO;
}

enum gz_result gz_part_file_open(struct gz_part_file *file, const char *path,
				 const struct gz_log *log)
{
	*file = (struct gz_part_file) { .path = path, .log = log, .fd = -1 };
	const int length = snprintf(file->part, sizeof file->part, "%s" GZ_PART_ENDING, path);
	if (length < 0 || (size_t)length >= sizeof file->part)
		return fail(file, ENAMETOOLONG);
	file->fd = open(file->part, O_CREAT | O_TRUNC | O_RDWR | O_CLOEXEC,
			S_IRUSR | S_IWUSR | S_IRGRP | S_IROTH);
	return file->fd < 0 ? fail(file, errno) : GZ_OK;
}

enum gz_result gz_part_file_write(const struct gz_part_file *file, const void *bytes, size_t size,
				  uint64_t offset)
{
	const char *from = bytes;
	while (size > 0) {
		const ssize_t n = pwrite(file->fd, from, size, (off_t)offset);
		if (n < 0 && errno == EINTR)
			continue;
		if (n <= 0)
			return fail(file, n < 0 ? errno : ENOSPC);
		from += n;
		offset += (uint64_t)n;
		size -= (size_t)n;
	}
	return GZ_OK;
}

enum gz_result gz_part_file_resize(const struct gz_part_file *file, uint64_t size)
{
	return ftruncate(file->fd, (off_t)size) == 0 ? GZ_OK : fail(file, errno);
}

enum gz_result gz_part_file_close(struct gz_part_file *file, enum gz_result result)
{
	if (file->fd < 0)
		return result;
	if (close(file->fd) != 0 && result == GZ_OK)
		result = fail(file, errno);
	if (result == GZ_OK && rename(file->part, file->path) != 0)
		result = fail(file, errno);
	if (result != GZ_OK)
		unlink(file->part);
	file->fd = -1;
	return result;
}
