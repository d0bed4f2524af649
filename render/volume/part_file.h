/**
 * @file
 * A file in writing: under another name until it is whole.
 */
#ifndef GZ_RENDER_PART_FILE_H
#define GZ_RENDER_PART_FILE_H

#include <stddef.h>
#include <stdint.h>

#include "base/log.h"
#include "base/result.h"
#include "protocol/gaze.h"

#define GZ_PART_ENDING ".part"

/** A file in writing. */
struct gz_part_file {
	const char *path; /**< borrowed */
	const struct gz_log *log;
	char part[GZ_PATH_SIZE + sizeof GZ_PART_ENDING];
	int fd;
};

/** Begin to write what will be @p path. GZ_ERR_IO: it cannot be made; logged, and nothing is open.
 */
enum gz_result gz_part_file_open(struct gz_part_file *file, const char *path,
				 const struct gz_log *log);

/** Write bytes at a place. GZ_ERR_FULL where the disk is, GZ_ERR_IO; logged. */
enum gz_result gz_part_file_write(const struct gz_part_file *file, const void *bytes, size_t size,
				  uint64_t offset);

/** Make the file @p size bytes long. Errors as gz_part_file_write(). */
enum gz_result gz_part_file_resize(const struct gz_part_file *file, uint64_t size);

/** Close it: under its own name if @p result is GZ_OK, else it is removed.
 * @return @p result, or what went wrong in closing; logged */
enum gz_result gz_part_file_close(struct gz_part_file *file, enum gz_result result);

#endif
