/**
 * @file
 * The gaze log, .gzl version 1: UTF-8 text, tab-separated (docs/protocol.md gives the layout).
 * Writing is a set of pure formatters over a buffer, so that the recorder decides about files,
 * threads and syncing; the reader works on a file or on memory.
 */
#ifndef GZ_PROTOCOL_GAZE_LOG_H
#define GZ_PROTOCOL_GAZE_LOG_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/log.h"
#include "base/result.h"
#include "protocol/gaze.h"

#define GZ_GAZE_LOG_SETTINGS_MAX 128 /**< settings a header can hold */
#define GZ_GAZE_LOG_VALUE_SIZE   128 /**< bytes of a setting's value with its NUL */
#define GZ_GAZE_LOG_LINE_SIZE                                                                    \
	2048                      /**< longest line with its newline, bytes; longer is malformed \
				   */
#define GZ_GAZE_LOG_TEXT_SIZE 512 /**< bytes of a mark's or gap's text, unescaped, with its NUL */

/** Room that any header fits in, with its NUL, bytes. */
#define GZ_GAZE_LOG_HEADER_SIZE 49152

/** One "#pipeline.<key> <value>" line: key is given without "pipeline.". */
struct gz_gaze_log_setting {
	char key[GZ_NAME_SIZE];
	char value[GZ_GAZE_LOG_VALUE_SIZE];
};

/** The lines that begin with '#'. */
struct gz_gaze_log_header {
	char tracker[GZ_NAME_SIZE];
	char serial[GZ_NAME_SIZE];
	double rate_hz; /**< nominal; 0 if unknown */
	bool has_display;
	struct gz_display display;
	char started[GZ_NAME_SIZE];  /**< UTC, ISO 8601 */
	char software[GZ_NAME_SIZE]; /**< "gazed 0.1.0" */
	size_t setting_count;
	struct gz_gaze_log_setting settings[GZ_GAZE_LOG_SETTINGS_MAX];
};

enum gz_gaze_log_kind {
	GZ_GAZE_LOG_SAMPLE,
	GZ_GAZE_LOG_GAP,
	GZ_GAZE_LOG_MARK,
	GZ_GAZE_LOG_WINDOW,
};

/** One record. Which of the fields below the kind hold something follows from it. */
struct gz_gaze_log_record {
	enum gz_gaze_log_kind kind;
	struct gz_sample sample; /**< SAMPLE; its lost_before is 0, a GAP record stands before it */
	int64_t host_ns;         /**< GAP, MARK, WINDOW */
	uint64_t missing;        /**< GAP: samples */
	char text[GZ_GAZE_LOG_TEXT_SIZE]; /**< GAP: reason; MARK: label; unescaped */
	int window_px[4];                 /**< WINDOW: x y w h on the display */
};

/**
 * Print the header's lines into @p text, with the version line first.
 *
 * A key is followed by one blank, several numbers are parted by tabs; a line "#columns" names the
 * columns. Texts are escaped as marks are. Doubles keep their bits.
 *
 * @param[out] out_length  bytes written, without the NUL that follows
 * @retval GZ_ERR_FULL  @p size is too small
 */
enum gz_result gz_gaze_log_print_header(const struct gz_gaze_log_header *header, char *text,
					size_t size, size_t *out_length);

/**
 * Print one record as its line with the newline. GZ_GAZE_LOG_LINE_SIZE bytes always suffice. A
 * SAMPLE whose lost_before is not 0 does not print its gap: that is a record of its own. An
 * infinite number is "inf" or "-inf"; NaN is an empty field. Whatever locale is set, the decimal
 * point is a point. Does not allocate.
 *
 * @retval GZ_ERR_FULL  @p size is too small
 */
enum gz_result gz_gaze_log_print_record(const struct gz_gaze_log_record *record, char *text,
					size_t size, size_t *out_length);

/** Print the "#end" line for @p samples samples and the CRC-32 (zlib) of all bytes before it. */
enum gz_result gz_gaze_log_print_end(uint64_t samples, uint32_t crc, char *text, size_t size,
				     size_t *out_length);

/** A log being read. */
struct gz_gaze_log_reader;

/** How a log ended. */
enum gz_gaze_log_ending {
	GZ_GAZE_LOG_UNREAD,    /**< not at its end yet */
	GZ_GAZE_LOG_WHOLE,     /**< "#end" found, count and CRC right */
	GZ_GAZE_LOG_CUT,       /**< no "#end": read to the last whole line */
	GZ_GAZE_LOG_CORRUPTED, /**< "#end" found, but count or CRC wrong */
};

/**
 * Open a log and read its header.
 *
 * @param[out] out_reader  owned by the caller; gz_gaze_log_close()
 * @retval GZ_ERR_NOT_FOUND, GZ_ERR_IO, GZ_ERR_NO_MEM  logged
 * @retval GZ_ERR_FORMAT  not a gaze log of version 1, or a malformed header; logged with file:line
 */
enum gz_result gz_gaze_log_open(const char *path, const struct gz_log *log,
				struct gz_gaze_log_reader **out_reader);

/** As gz_gaze_log_open() over memory, which must stay until the reader is closed. */
enum gz_result gz_gaze_log_open_memory(const char *name, const void *bytes, size_t size,
				       const struct gz_log *log,
				       struct gz_gaze_log_reader **out_reader);

/** The header. Valid until the reader is closed. */
const struct gz_gaze_log_header *gz_gaze_log_header(const struct gz_gaze_log_reader *reader);

/**
 * Read the next record.
 *
 * @retval GZ_OK          *out_record is filled
 * @retval GZ_ERR_END     the log is over, whole or cut; gz_gaze_log_ending() tells; a cut or
 * corrupted one was logged once, as a warning with the number of samples found
 * @retval GZ_ERR_FORMAT  a malformed line in the middle; logged with file:line (the first ten of a
 * log); the line is skipped and the next call goes on behind it
 * @retval GZ_ERR_IO      reading failed; logged
 */
enum gz_result gz_gaze_log_read(struct gz_gaze_log_reader *reader,
				struct gz_gaze_log_record *out_record);

/** How the log ended; certain once gz_gaze_log_read() has returned GZ_ERR_END. */
enum gz_gaze_log_ending gz_gaze_log_ending(const struct gz_gaze_log_reader *reader);

/**
 * When the last sample was, found from the file's end without reading it all. What stands before it
 * is not checked.
 *
 * @retval GZ_ERR_NOT_FOUND, GZ_ERR_IO, GZ_ERR_NO_MEM  it cannot be read; not logged
 * @retval GZ_ERR_FORMAT  no sample stands in its last 64 KiB; not logged
 */
enum gz_result gz_gaze_log_find_last(const char *path, int64_t *out_host_ns);

/** Close and set to NULL. Accepts a pointer to NULL. */
void gz_gaze_log_close(struct gz_gaze_log_reader **reader);

#endif
