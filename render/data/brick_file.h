/**
 * @file
 * A file of bricks, opened and checked: its index in memory, its voxels read a brick at a time.
 */
#ifndef GZ_RENDER_DATA_BRICK_FILE_H
#define GZ_RENDER_DATA_BRICK_FILE_H

#include "base/log.h"
#include "base/result.h"
#include "protocol/gaze.h"
#include "render/data/brick_layout.h"

/** An open file. Read-only once open: bricks may be read by several threads at once. */
struct gz_brick_file {
	char path[GZ_PATH_SIZE];
	const struct gz_log *log;
	int fd;
	struct gz_brick_header header;
	struct gz_brick_layout layout;
	struct gz_brick_entry *entries; /**< by a brick's number */
	void *cells; /**< voxels: least and greatest of each cell of each brick of level 0 */
};

/**
 * Open a file and check all that it says of itself: every offset lies within it, every range is
 * one.
 *
 * @param log            borrowed until it is closed
 * @param[out] out_file  owned by the caller: gz_brick_file_close()
 * @retval GZ_ERR_NOT_FOUND  no such file; logged
 * @retval GZ_ERR_IO         it cannot be read; logged
 * @retval GZ_ERR_FORMAT     it is none, truncated or damaged; logged
 * @retval GZ_ERR_NO_MEM     no room for the index, which is a part of the file; logged
 */
enum gz_result gz_brick_file_open(const char *path, const struct gz_log *log,
				  struct gz_brick_file **out_file);

/**
 * Read the voxels of a brick, GZ_BRICK_VOXELS of them, in this machine's byte order.
 *
 * @retval GZ_ERR_IO      it cannot be read, or the file has become shorter
 * @retval GZ_ERR_FORMAT  its checksum is wrong, or a voxel is not finite
 *
 * Nothing is logged: gz_brick_file_complain() does. Threads: any, at the same time.
 */
enum gz_result gz_brick_file_read(const struct gz_brick_file *file, size_t brick, void *out_voxels);

/** The range of a cell of a brick of level 0; cells count x fastest. */
void gz_brick_file_cell(const struct gz_brick_file *file, size_t brick, int cell, float *out_least,
			float *out_greatest);

/** Log why a brick could not be read, and what is shown instead. */
void gz_brick_file_complain(const struct gz_brick_file *file, size_t brick, enum gz_result why);

/** Close, free, set to NULL. Accepts a pointer to NULL. */
void gz_brick_file_close(struct gz_brick_file **file);

#endif
