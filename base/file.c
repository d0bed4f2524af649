#include "base/file.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <unistd.h>

#include "base/text.h"

#define GZ_LOG_MODULE "file"

bool gz_path_ends(const char *path, const char *ending)
{
	size_t length = strlen(path), tail = strlen(ending);
	return length >= tail && strcasecmp(path + length - tail, ending) == 0;
}

enum gz_result gz_path_beside(const char *file, const char *name, char *out_path, size_t size)
{
	const char *slash = strrchr(file, '/');
	int folder = slash && name[0] != '/' ? (int)(slash + 1 - file) : 0;
	return gz_text_print(out_path, size, "%.*s%s", folder, file, name);
}

/* Length of the part that two absolute paths have in common, up to a "/" or the end of @p folder.
 */
static size_t common_length(const char *folder, const char *file)
{
	size_t common = 0, i = 0;
	for (; folder[i] && folder[i] == file[i]; i++)
		if (folder[i] == '/')
			common = i;
	return !folder[i] && file[i] == '/' ? i : common;
}

/* Both absolute, without links. */
static enum gz_result path_from_real(const char *folder, const char *file, char *out_path,
				     size_t size)
{
	const size_t root = strcmp(folder, "/") == 0; /* which ends in its "/" */
	const size_t common = common_length(folder + root, file);
	struct gz_text path = { 0 };
	for (const char *at = folder + root + common; *at; at++)
		if (*at == '/')
			gz_text_add(&path, "../");
	gz_text_add(&path, "%s", file + common + 1);
	const enum gz_result result =
		path.failed ? GZ_ERR_FULL : gz_text_print(out_path, size, "%s", path.bytes);
	gz_text_free(&path);
	return result;
}

enum gz_result gz_path_from(const char *folder, const char *file, char *out_path, size_t size)
{
	char *real_folder = realpath(folder, NULL), *real_file = realpath(file, NULL);
	enum gz_result result = GZ_ERR_NOT_FOUND;
	out_path[0] = '\0';
	if (real_folder && real_file)
		result = path_from_real(real_folder, real_file, out_path, size);
	free(real_folder);
	free(real_file);
	return result;
}

size_t gz_write_all(int fd, const void *bytes, size_t size)
{
	const char *from = bytes;
	size_t done = 0;
	while (done < size) {
		const ssize_t n = write(fd, from + done, size - done);
		if (n > 0)
			done += (size_t)n;
		else if (n == 0)
			errno = ENOSPC;
		if (n == 0 || (n < 0 && errno != EINTR))
			break;
	}
	return done;
}

/* Log why the file cannot be written, from errno's value @p error. */
static enum gz_result refuse_writing(const struct gz_part_file *file, int error)
{
	gz_err(file->log, "%s: cannot be written: %s; free some space or choose another folder",
	       file->path, strerror(error));
	return error == ENOSPC || error == EDQUOT || error == EFBIG ? GZ_ERR_FULL : GZ_ERR_IO;
}

enum gz_result gz_part_file_open(struct gz_part_file *file, const char *path,
				 const struct gz_log *log)
{
	*file = (struct gz_part_file) { .path = path, .log = log, .fd = -1 };
	if (gz_text_print(file->part, sizeof file->part, "%s" GZ_PART_ENDING, path) != GZ_OK)
		return refuse_writing(file, ENAMETOOLONG);
	file->fd = open(file->part, O_CREAT | O_TRUNC | O_RDWR | O_CLOEXEC,
			S_IRUSR | S_IWUSR | S_IRGRP | S_IROTH);
	return file->fd < 0 ? refuse_writing(file, errno) : GZ_OK;
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
			return refuse_writing(file, n < 0 ? errno : ENOSPC);
		from += n;
		offset += (uint64_t)n;
		size -= (size_t)n;
	}
	return GZ_OK;
}

enum gz_result gz_part_file_resize(const struct gz_part_file *file, uint64_t size)
{
	return ftruncate(file->fd, (off_t)size) == 0 ? GZ_OK : refuse_writing(file, errno);
}

enum gz_result gz_part_file_close(struct gz_part_file *file, enum gz_result result)
{
	if (file->fd < 0)
		return result;
	if (close(file->fd) != 0 && result == GZ_OK)
		result = refuse_writing(file, errno);
	if (result == GZ_OK && rename(file->part, file->path) != 0)
		result = refuse_writing(file, errno);
	if (result != GZ_OK)
		unlink(file->part);
	file->fd = -1;
	return result;
}
