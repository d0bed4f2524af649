/**
 * @file
 * A gaze log being written: lines gathered in a buffer, the sum over them, and what to do when the
 * disk is full. One thread.
 */
#ifndef GZ_PROTOCOL_GAZE_LOG_WRITER_H
#define GZ_PROTOCOL_GAZE_LOG_WRITER_H

#include <stddef.h>
#include <stdint.h>

#include "base/result.h"
#include "protocol/gaze_log.h"

/** Bytes gathered before they are written. Chosen: some hundred lines. */
#define GZ_GAZE_LOG_WRITER_BUFFER 65536

/** A log being written; zero-initialised is none. */
struct gz_gaze_log_writer {
	int fd;
	uint32_t crc;     /**< of all whole lines in the file */
	uint64_t size;    /**< bytes of them */
	uint64_t samples; /**< samples among them */
	size_t used;
	unsigned char buffer[GZ_GAZE_LOG_WRITER_BUFFER];
};

/**
 * Begin a log.
 *
 * @param fd  open for writing, empty, at its start; the caller closes it
 * @retval GZ_ERR_FULL  the header is larger than the buffer: a bug
 */
enum gz_result gz_gaze_log_writer_begin(struct gz_gaze_log_writer *writer, int fd,
					const struct gz_gaze_log_header *header);

/**
 * Add a record.
 *
 * @retval GZ_ERR_IO  the disk is full or failing, errno says which: the file was cut behind its
 * last whole line and ended there, if that was still possible
 */
enum gz_result gz_gaze_log_writer_add(struct gz_gaze_log_writer *writer,
				      const struct gz_gaze_log_record *record);

/** Write what is gathered. As gz_gaze_log_writer_add(). */
enum gz_result gz_gaze_log_writer_flush(struct gz_gaze_log_writer *writer);

/** Write what is gathered, and the line that ends the log. As gz_gaze_log_writer_add(). */
enum gz_result gz_gaze_log_writer_end(struct gz_gaze_log_writer *writer);

#endif
