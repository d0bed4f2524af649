/**
 * @file
 * Files: endings of names, names relative to another file, and files that take their name only when
 * they are complete.
 */
#ifndef GZ_BASE_FILE_H
#define GZ_BASE_FILE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/log.h"
#include "base/result.h"
#include "base/sizes.h"

/** Whether @p path ends in @p ending, ignoring case. */
bool gz_path_ends(const char *path, const char *ending);

/**
 * The path of @p name relative to the folder of @p file. An absolute name stays as it is.
 *
 * @param[out] out_path  a buffer of @p size bytes
 * @retval GZ_ERR_FULL   the path does not fit; @p out_path is an empty string
 */
enum gz_result gz_path_beside(const char *file, const char *name, char *out_path, size_t size);

/**
 * The path of a file as seen from a folder: "../scenes/a.scene". Both exist; symbolic links are
 * followed.
 *
 * @param[out] out_path  a buffer of @p size bytes
 * @retval GZ_ERR_NOT_FOUND  one of them does not exist; @p out_path is an empty string
 * @retval GZ_ERR_FULL       the path does not fit; @p out_path is an empty string
 */
enum gz_result gz_path_from(const char *folder, const char *file, char *out_path, size_t size);

/**
 * Write all bytes to a file descriptor, continuing after signals and partial writes.
 *
 * @return the number of bytes written; less than @p size only after an error, with its cause in
 *         errno
 */
size_t gz_write_all(int fd, const void *bytes, size_t size);

/** What a file's name ends in while the file is being written. */
#define GZ_PART_ENDING ".part"

/** A file that is being written, under its name and GZ_PART_ENDING. */
struct gz_part_file {
	const char *path; /**< of the complete file; borrowed */
	const struct gz_log *log;
	char part[GZ_PATH_SIZE + sizeof GZ_PART_ENDING]; /**< where it is written */
	int fd;                                          /**< -1: none is open */
};

/**
 * Begin to write the file that will be @p path.
 *
 * @param path  borrowed until gz_part_file_close()
 * @retval GZ_ERR_IO    the file cannot be created; logged, and nothing is open
 * @retval GZ_ERR_FULL  no space is left; logged, and nothing is open
 */
enum gz_result gz_part_file_open(struct gz_part_file *file, const char *path,
				 const struct gz_log *log);

/**
 * Write bytes at @p offset.
 *
 * @retval GZ_ERR_FULL  no space is left; logged
 * @retval GZ_ERR_IO    the file cannot be written; logged
 */
enum gz_result gz_part_file_write(const struct gz_part_file *file, const void *bytes, size_t size,
				  uint64_t offset);

/** Set the file's size, bytes. Errors as for gz_part_file_write(). */
enum gz_result gz_part_file_resize(const struct gz_part_file *file, uint64_t size);

/**
 * Close the file. If @p result is GZ_OK the file takes its name, otherwise it is removed. Does
 * nothing if none is open.
 *
 * @return @p result, or the error in closing or renaming: GZ_ERR_FULL or GZ_ERR_IO; logged
 */
enum gz_result gz_part_file_close(struct gz_part_file *file, enum gz_result result);

#endif
