#include "protocol/gaze_log_writer.h"

#include <errno.h>
#include <string.h>
#include <unistd.h>
#include <zlib.h>

/* The longest "#end" line: two numbers. */
enum { END_LINE_SIZE = 64 };

/* Write all of @p bytes; the number written, which is less than @p size only after an error, which
 * errno holds. */
static size_t write_all(int fd, const unsigned char *bytes, size_t size)
{
	size_t done = 0;
	while (done < size) {
		ssize_t n = write(fd, bytes + done, size - done);
		if (n > 0) {
			done += (size_t)n;
		} else if (n == 0) {
			errno = ENOSPC;
			break;
		} else if (errno != EINTR) {
			break;
		}
	}
	return done;
}

static uint64_t count_samples(const unsigned char *lines, size_t size)
{
	uint64_t samples = 0;
	const unsigned char *end = lines + size;
	while (lines < end) {
		samples += *lines != '#' && *lines != '!';
		const unsigned char *newline = memchr(lines, '\n', (size_t)(end - lines));
		lines = newline ? newline + 1 : end;
	}
	return samples;
}

/* Count the first @p size bytes of the buffer, whole lines, as written. */
static void account(struct gz_gaze_log_writer *writer, size_t size)
{
	writer->crc = (uint32_t)crc32(writer->crc, writer->buffer, (uInt)size);
	writer->samples += count_samples(writer->buffer, size);
	writer->size += size;
}

static enum gz_result write_end(struct gz_gaze_log_writer *writer)
{
	char line[END_LINE_SIZE];
	size_t length = 0;
	enum gz_result result =
		gz_gaze_log_print_end(writer->samples, writer->crc, line, sizeof line, &length);
	if (result != GZ_OK)
		return result;
	size_t done = write_all(writer->fd, (const unsigned char *)line, length);
	return done == length ? GZ_OK : GZ_ERR_IO;
}

/* The disk took only @p done bytes of the buffer: cut the file behind the last whole line. The
 * bytes thereby freed usually hold the line that ends it. */
static void salvage(struct gz_gaze_log_writer *writer, size_t done)
{
	const unsigned char *newline = done ? memrchr(writer->buffer, '\n', done) : NULL;
	size_t whole = newline ? (size_t)(newline + 1 - writer->buffer) : 0;
	account(writer, whole);
	off_t size = (off_t)writer->size;
	bool cut = ftruncate(writer->fd, size) == 0 && lseek(writer->fd, size, SEEK_SET) == size;
	if (cut && write_end(writer) != GZ_OK && ftruncate(writer->fd, size) != 0)
		return; /* a line without its end is left, which readers drop */
}

enum gz_result gz_gaze_log_writer_begin(struct gz_gaze_log_writer *writer, int fd,
					const struct gz_gaze_log_header *header)
{
	writer->fd = fd;
	writer->crc = (uint32_t)crc32(0, NULL, 0);
	writer->size = 0;
	writer->samples = 0;
	writer->used = 0;
	return gz_gaze_log_print_header(header, (char *)writer->buffer, sizeof writer->buffer,
					&writer->used);
}

enum gz_result gz_gaze_log_writer_flush(struct gz_gaze_log_writer *writer)
{
	if (writer->used == 0)
		return GZ_OK;
	size_t done = write_all(writer->fd, writer->buffer, writer->used);
	if (done < writer->used) {
		int error = errno;
		salvage(writer, done);
		writer->used = 0;
		errno = error;
		return GZ_ERR_IO;
	}
	account(writer, writer->used);
	writer->used = 0;
	return GZ_OK;
}

enum gz_result gz_gaze_log_writer_add(struct gz_gaze_log_writer *writer,
				      const struct gz_gaze_log_record *record)
{
	if (sizeof writer->buffer - writer->used < GZ_GAZE_LOG_LINE_SIZE) {
		enum gz_result result = gz_gaze_log_writer_flush(writer);
		if (result != GZ_OK)
			return result;
	}
	size_t length = 0;
	enum gz_result result =
		gz_gaze_log_print_record(record, (char *)writer->buffer + writer->used,
					 sizeof writer->buffer - writer->used, &length);
	if (result == GZ_OK)
		writer->used += length;
	return result;
}

enum gz_result gz_gaze_log_writer_end(struct gz_gaze_log_writer *writer)
{
	enum gz_result result = gz_gaze_log_writer_flush(writer);
	if (result != GZ_OK)
		return result;
	result = write_end(writer);
	if (result != GZ_OK) {
		int error = errno;
		salvage(writer, 0);
		errno = error;
	}
	return result;
}
