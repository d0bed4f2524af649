#include "client/gazectl/output_file.h"

#include <errno.h>
#include <fcntl.h>
#include <string.h>
#include <unistd.h>

#define GZ_LOG_MODULE "output"

enum gz_result gz_output_begin(struct gz_output_file *file, const char *path, bool overwrite,
			       enum gz_output_kind kind, const struct gz_log *log)
{
	*file = (struct gz_output_file) { .fd = -1 };
	int length = snprintf(file->path, sizeof file->path, "%s", path);
	if (length < 0 || (size_t)length >= sizeof file->path) {
		gz_err(log, "%s: the name is too long", path);
		return GZ_ERR_INVAL;
	}
	if (!overwrite && access(path, F_OK) == 0) {
		gz_err(log, "%s is there already; name another, or give --force to replace it",
		       path);
		return GZ_ERR_BUSY;
	}
	snprintf(file->partial, sizeof file->partial, "%s.part", path);
	file->fd = open(file->partial, O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
	if (file->fd < 0) {
		gz_err(log, "cannot write %s: %s", file->partial, strerror(errno));
		return GZ_ERR_IO;
	}
	file->open = true;
	if (kind == GZ_OUTPUT_TEXT)
		file->text = fdopen(file->fd, "w");
	else if (kind == GZ_OUTPUT_GZIP)
		file->gzip = gzdopen(file->fd, "wb");
	if (kind != GZ_OUTPUT_RAW && !file->text && !file->gzip) {
		gz_output_end(file, false, log);
		return GZ_ERR_NO_MEM;
	}
	return GZ_OK;
}

enum gz_result gz_output_check_svg(const char *path, const struct gz_log *log)
{
	size_t length = strlen(path);
	if (length == 0 || (length > 4 && strcmp(path + length - 4, ".svg") == 0))
		return GZ_OK;
	gz_err(log, "--picture: pictures are SVG; end %s in .svg", path);
	return GZ_ERR_INVAL;
}

/* Whether all of it has reached the file. */
static bool finish(struct gz_output_file *file)
{
	if (file->text) {
		bool failed = ferror(file->text) != 0;
		return fclose(file->text) == 0 && !failed;
	}
	if (file->gzip)
		return gzclose(file->gzip) == Z_OK;
	return close(file->fd) == 0;
}

enum gz_result gz_output_end(struct gz_output_file *file, bool complete, const struct gz_log *log)
{
	if (!file->open)
		return GZ_OK;
	errno = 0;
	bool written = finish(file);
	if (written && complete && rename(file->partial, file->path) != 0)
		written = false;
	if (!written)
		gz_err(log, "cannot write %s: %s", file->path,
		       errno ? strerror(errno) : "is its disk full?");
	if (!written || !complete)
		unlink(file->partial);
	*file = (struct gz_output_file) { .fd = -1 };
	return written ? GZ_OK : GZ_ERR_IO;
}
