/**
 * @file
 * The members of a tar file (POSIX.1-2017, pax, "ustar Interchange Format"), one after the other.
 */
#ifndef GZ_RENDER_DATA_TAR_MEMBER_H
#define GZ_RENDER_DATA_TAR_MEMBER_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/log.h"
#include "base/result.h"
#include "render/data/byte_stream.h"

/** A header is a block, and content is filled up to a multiple of it, bytes. */
#define GZ_TAR_BLOCK 512

/** The header of a member. */
struct gz_tar_member {
	char name[101]; /**< without the folders above it */
	bool is_file;   /**< a regular file; not a folder, a link or more of the next header */
	uint64_t size;  /**< of its content, bytes */
};

/** Decode a header. @return false if it is none: no magic word, or not the sum that it says */
bool gz_tar_header_decode(const uint8_t block[GZ_TAR_BLOCK], struct gz_tar_member *out_member);

/** Bytes of content and of what fills it up to a block. @p size is one of a decoded header. */
uint64_t gz_tar_padded_size(uint64_t size);

/**
 * Find a file by its name.
 *
 * @param stream  at a header, such as the first; then at the file's first byte
 * @param name    without folders
 * @param path    of the tar file, for messages
 * @param log     may be NULL
 * @param[out] out_size  bytes of the file, written on GZ_OK
 * @retval GZ_ERR_NOT_FOUND  no such file up to the end; not logged
 * @retval GZ_ERR_FORMAT     damaged or cut off; logged
 * @retval GZ_ERR_IO         logged
 */
enum gz_result gz_tar_find(struct gz_byte_stream *stream, const char *name, const char *path,
			   const struct gz_log *log, uint64_t *out_size);

#endif
