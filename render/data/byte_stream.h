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

/** How the bytes are stored. */
enum gz_coding {
	GZ_CODING_PLAIN,
	GZ_CODING_ZLIB, /**< a zlib stream, or gzip members one after the other */
	GZ_CODING_ZSTD, /**< zstd frames one after the other */
};

struct gz_byte_stream;

/** Bytes from elsewhere: as gz_byte_stream_read(), and it logs. */
typedef enum gz_result gz_byte_source(void *user, void *buffer, size_t size, size_t *out_got);

/**
 * Open a file for reading from @p offset on.
 *
 * @param path      a regular file: folders, devices and pipes are refused
 * @param coding    of what follows @p offset
 * @param offset    bytes of the file to pass over first
 * @param[out] out_stream  owned by the caller: gz_byte_stream_close()
 * @retval GZ_ERR_NOT_FOUND  no such file; logged
 * @retval GZ_ERR_IO         it cannot be opened; logged
 * @retval GZ_ERR_FORMAT     no regular file, or it ends before @p offset; logged
 * @retval GZ_ERR_NO_MEM     no room for the decoder; logged
 *
 * Threads: one at a time per stream. @p path and @p log are borrowed until it is closed.
 */
enum gz_result gz_byte_stream_open(const char *path, enum gz_coding coding, uint64_t offset,
				   const struct gz_log *log, struct gz_byte_stream **out_stream);

/**
 * A stream over bytes that a function gives.
 *
 * @param user   handed to @p source
 * @param bound  the most bytes that can come
 * @param path   what the bytes are of, for messages; borrowed until it is closed, as @p log
 * @param[out] out_stream  owned by the caller: gz_byte_stream_close()
 * @retval GZ_ERR_NO_MEM  logged
 */
enum gz_result gz_byte_stream_from(gz_byte_source *source, void *user, uint64_t bound,
				   const char *path, const struct gz_log *log,
				   struct gz_byte_stream **out_stream);

/**
 * The most bytes that can come out of the whole stream: exact for GZ_CODING_PLAIN, else what the
 * compressed bytes could hold at the best ratio of their coding. Lets a claimed size be refused
 * before memory is taken for it.
 */
uint64_t gz_byte_stream_bound(const struct gz_byte_stream *stream);

/**
 * Read until @p size bytes are there or the stream ends.
 *
 * @param[out] out_got  less than @p size only at the end
 * @retval GZ_ERR_IO      the file cannot be read; logged
 * @retval GZ_ERR_FORMAT  the compressed data are damaged or cut off; logged
 */
enum gz_result gz_byte_stream_read(struct gz_byte_stream *stream, void *buffer, size_t size,
				   size_t *out_got);

/**
 * Let a thread decode the next @p bytes of a compressed stream while they are read; what is behind
 * them is not looked at. Makes no difference but in time, and none where there is nothing to decode
 * or little of it. Takes 1 MiB until those bytes are read. Messages of the decoder come from that
 * thread.
 */
void gz_byte_stream_read_ahead(struct gz_byte_stream *stream, uint64_t bytes);

/** Pass over @p count bytes. GZ_ERR_FORMAT also where fewer are left; logged. */
enum gz_result gz_byte_stream_skip(struct gz_byte_stream *stream, uint64_t count);

/** Close and set to NULL. Accepts a pointer to NULL. */
void gz_byte_stream_close(struct gz_byte_stream **stream);

struct gz_byte_ahead;

/**
 * Start a thread that reads @p bytes from @p source, no more. It is up to 1 MiB ahead.
 *
 * @param source  called on that thread alone until gz_byte_ahead_end()
 * @param user    handed to @p source
 * @param[out] out_ahead  owned by the caller: gz_byte_ahead_end()
 * @retval GZ_ERR_NO_MEM  no room, or no thread to be had; not logged, as one can do without
 */
enum gz_result gz_byte_ahead_start(gz_byte_source *source, void *user, uint64_t bytes,
				   struct gz_byte_ahead **out_ahead);

/**
 * Read until @p size bytes are there, all that were asked for have come, or the source ends.
 *
 * @param[out] out_got  less than @p size where no more will come
 * @return what @p source returned where it failed, behind all bytes before
 *
 * Threads: one at a time.
 */
enum gz_result gz_byte_ahead_read(struct gz_byte_ahead *ahead, void *buffer, size_t size,
				  size_t *out_got);

/** End the thread, wherever it is, free, set to NULL. Accepts a pointer to NULL. */
void gz_byte_ahead_end(struct gz_byte_ahead **ahead);

#endif
