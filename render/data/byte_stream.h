/**
 * @file
 * The bytes of a file, decompressed if need be, from front to back in a small fixed memory.
 */
#ifndef GZ_RENDER_DATA_BYTE_STREAM_H
#define GZ_RENDER_DATA_BYTE_STREAM_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/log.h"
#include "base/result.h"

/**
 * Open a regular file for reading.
 *
 * @param[out] out_fd    closed on exec; owned by the caller
 * @param[out] out_size  bytes
 * @retval GZ_ERR_NOT_FOUND  no such file; logged
 * @retval GZ_ERR_IO         it cannot be opened; logged
 * @retval GZ_ERR_FORMAT     a folder, device or pipe; logged
 */
enum gz_result gz_file_open(const char *path, const struct gz_log *log, int *out_fd,
			    uint64_t *out_size);

/** How bytes are compressed. */
enum gz_coding {
	GZ_CODING_PLAIN,
	GZ_CODING_ZLIB,  /**< a zlib stream, or gzip members one after the other */
	GZ_CODING_ZSTD,  /**< zstd frames one after the other */
	GZ_CODING_BZIP2, /**< bzip2 streams one after the other */
};

struct gz_byte_stream;

/** A function that gives bytes. Contract as gz_byte_stream_read(); it logs its own errors. */
typedef enum gz_result gz_byte_source(void *user, void *buffer, size_t size, size_t *out_got);

/**
 * Open a file as a stream that begins at @p offset.
 *
 * @param path      a regular file: folders, devices and pipes are refused
 * @param coding    of the bytes from @p offset on
 * @param offset    bytes of the file to skip first
 * @param[out] out_stream  owned by the caller: gz_byte_stream_close()
 * @retval GZ_ERR_NOT_FOUND  no such file; logged
 * @retval GZ_ERR_IO         it cannot be opened; logged
 * @retval GZ_ERR_FORMAT     not a regular file, or shorter than @p offset; logged
 * @retval GZ_ERR_NO_MEM     logged
 *
 * Threads: one at a time for each stream. @p path and @p log are borrowed until it is closed.
 */
enum gz_result gz_byte_stream_open(const char *path, enum gz_coding coding, uint64_t offset,
				   const struct gz_log *log, struct gz_byte_stream **out_stream);

/**
 * Make a stream of the bytes that a function gives.
 *
 * @param user   passed to @p source
 * @param bound  the most bytes that it can give
 * @param path   for messages; borrowed until the stream is closed, like @p log
 * @param[out] out_stream  owned by the caller: gz_byte_stream_close()
 * @retval GZ_ERR_NO_MEM  logged
 */
enum gz_result gz_byte_stream_from(gz_byte_source *source, void *user, uint64_t bound,
				   const char *path, const struct gz_log *log,
				   struct gz_byte_stream **out_stream);

/** A function that passes over bytes. Contract as gz_byte_stream_skip(); it logs its own errors. */
typedef enum gz_result gz_byte_skipper(void *user, uint64_t count);

/** Let gz_byte_stream_skip() of a stream of a function call @p skip with that function's user,
 *  where passing over bytes takes less than reading them. */
void gz_byte_stream_skip_by(struct gz_byte_stream *stream, gz_byte_skipper *skip);

/**
 * The most bytes that the whole stream can give: exact for GZ_CODING_PLAIN, otherwise the
 * compressed size times the best ratio of the coding. With it a claimed size can be refused before
 * memory is allocated for it.
 */
uint64_t gz_byte_stream_bound(const struct gz_byte_stream *stream);

/**
 * Read @p size bytes, or fewer if the stream ends.
 *
 * @param[out] out_got  less than @p size only at the end
 * @retval GZ_ERR_IO      the file cannot be read; logged
 * @retval GZ_ERR_FORMAT  the compressed data are damaged or cut off; logged
 */
enum gz_result gz_byte_stream_read(struct gz_byte_stream *stream, void *buffer, size_t size,
				   size_t *out_got);

/**
 * Let a thread decode the next @p bytes of a compressed stream ahead of the reader, and no more.
 * The result is the same, only sooner. Does nothing if the stream is not compressed, or for few
 * bytes. Uses 1 MiB until those bytes are read. The decoder then logs from that thread.
 */
void gz_byte_stream_read_ahead(struct gz_byte_stream *stream, uint64_t bytes);

/** Skip @p count bytes. Results as gz_byte_stream_read(); GZ_ERR_FORMAT also if fewer are left;
 *  logged. */
enum gz_result gz_byte_stream_skip(struct gz_byte_stream *stream, uint64_t count);

/** Close and set to NULL. Accepts a pointer to NULL. */
void gz_byte_stream_close(struct gz_byte_stream **stream);

/** Bytes that a thread of its own reads ahead of their reader, into a ring of fixed size. */
struct gz_byte_ahead;

/**
 * Start a thread that reads @p bytes from @p source, and no more. It is up to 1 MiB ahead.
 *
 * @param source  called only on that thread, until gz_byte_ahead_end()
 * @param user    passed to @p source
 * @param[out] out_ahead  owned by the caller: gz_byte_ahead_end()
 * @retval GZ_ERR_NO_MEM  out of memory or threads; not logged, because the caller can read directly
 */
enum gz_result gz_byte_ahead_start(gz_byte_source *source, void *user, uint64_t bytes,
				   struct gz_byte_ahead **out_ahead);

/**
 * Read @p size bytes, or fewer if the thread has read all it was asked for or the source has ended.
 *
 * @param[out] out_got  less than @p size if no more bytes will come
 * @return the result of @p source if it failed, once all bytes before the failure are read
 *
 * Threads: one at a time.
 */
enum gz_result gz_byte_ahead_read(struct gz_byte_ahead *ahead, void *buffer, size_t size,
				  size_t *out_got);

/** Stop the thread, free everything and set to NULL. Accepts a pointer to NULL. */
void gz_byte_ahead_end(struct gz_byte_ahead **ahead);

#endif
