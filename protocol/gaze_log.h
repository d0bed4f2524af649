/**
 * @file
 * The gaze log, .gzl version 1: UTF-8 text, tab-separated. docs/protocol.md describes the format.
 *
 * The printing functions fill a buffer and do no I/O. The writer gathers lines, keeps their
 * checksum and handles a full disk. The reader reads a file or memory.
 */
#ifndef GZ_PROTOCOL_GAZE_LOG_H
#define GZ_PROTOCOL_GAZE_LOG_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/log.h"
#include "base/result.h"
#include "protocol/gaze.h"

#define GZ_GAZE_LOG_SETTINGS_MAX 128 /**< most settings in a header */
#define GZ_GAZE_LOG_VALUE_SIZE   128 /**< a setting's value with its NUL, bytes */
#define GZ_GAZE_LOG_LINE_SIZE                                                                    \
	2048                      /**< longest line with its newline, bytes; longer is malformed \
				   */
#define GZ_GAZE_LOG_TEXT_SIZE 512 /**< a mark's or gap's text, unescaped, with its NUL, bytes */

/** What the header line "#coordinates" says if it is there. */
#define GZ_GAZE_LOG_SCENE_CAMERA "scene camera"

/** Further keys of a mark, as JSON, unescaped, with their NUL, bytes. Chosen: with the text they
 * fit into GZ_GAZE_LOG_LINE_SIZE, however many of their bytes are escaped. */
#define GZ_GAZE_LOG_KEYS_SIZE 448

/** Size of a buffer for any header, with its NUL, bytes. */
#define GZ_GAZE_LOG_HEADER_SIZE 49152

/** One line "#pipeline.<key> <value>". */
struct gz_gaze_log_setting {
	char key[GZ_NAME_SIZE]; /**< without "pipeline." */
	char value[GZ_GAZE_LOG_VALUE_SIZE];
};

/** The header: the lines that begin with '#'. */
struct gz_gaze_log_header {
	char tracker[GZ_NAME_SIZE];
	char serial[GZ_NAME_SIZE];
	double rate_hz; /**< nominal; 0 if unknown */
	bool has_display;
	struct gz_display display;   /**< set if has_display */
	char started[GZ_NAME_SIZE];  /**< UTC, ISO 8601 */
	char software[GZ_NAME_SIZE]; /**< "gazed 0.1.0" */
	/** The unit of every pupil_mm in the log if it is not mm, as "arbitrary (EyeLink area)";
	 * empty: mm. */
	char pupil_unit[GZ_NAME_SIZE];
	/** The points are in the picture of a scene camera, not on a display; (0, 0) is its upper
	 * left corner, (1, 1) its lower right one. */
	bool scene_camera;
	size_t setting_count;
	struct gz_gaze_log_setting settings[GZ_GAZE_LOG_SETTINGS_MAX];
};

/** Kinds of record. */
enum gz_gaze_log_kind {
	GZ_GAZE_LOG_SAMPLE,
	GZ_GAZE_LOG_GAP,    /**< samples are missing */
	GZ_GAZE_LOG_MARK,   /**< a label for a moment or a stretch of time */
	GZ_GAZE_LOG_WINDOW, /**< the position of the renderer's window */
	GZ_GAZE_LOG_SCENE,  /**< from the next sample on, the scene is still or moves */
};

/** One record. Its kind determines which of the other fields are set. */
struct gz_gaze_log_record {
	enum gz_gaze_log_kind kind;
	/** SAMPLE; its lost_before is 0: a GAP record precedes it instead. A reader sets
	 * still_scene from the SCENE records; a writer adds these records. */
	struct gz_sample sample;
	int64_t host_ns;  /**< GAP, MARK, WINDOW, SCENE: of the sample that comes next */
	uint64_t missing; /**< GAP: how many samples */
	char text[GZ_GAZE_LOG_TEXT_SIZE]; /**< GAP: reason; MARK: label; unescaped */
	int64_t duration_ns;              /**< MARK: 0 for a moment */
	char keys[GZ_GAZE_LOG_KEYS_SIZE]; /**< MARK: further keys as a JSON object; empty: none */
	int window_px[4];                 /**< WINDOW: x, y, width and height on the display, px */
	bool still_scene;                 /**< SCENE: nothing moves */
};

/**
 * Print the lines of a header, the version line first.
 *
 * A blank follows each key; a tab separates several numbers. The line "#columns" names the columns.
 * Texts are escaped as in marks. Doubles are printed so that they read back exactly.
 *
 * @param[out] text        at most @p size bytes, with a NUL
 * @param[out] out_length  bytes of the text without the NUL
 * @retval GZ_ERR_FULL  @p size is too small; GZ_GAZE_LOG_HEADER_SIZE always suffices
 */
enum gz_result gz_gaze_log_print_header(const struct gz_gaze_log_header *header, char *text,
					size_t size, size_t *out_length);

/**
 * Print one record as a line with its newline. A SAMPLE whose lost_before is not 0 does not print
 * its gap, which is a record of its own, and no SAMPLE prints its still_scene. An infinite number
 * is printed as "inf" or "-inf", a NaN as an empty field. The decimal point is a full stop in every
 * locale. Does not allocate.
 *
 * @param[out] out_length  bytes of the line without the NUL
 * @retval GZ_ERR_FULL  @p size is too small; GZ_GAZE_LOG_LINE_SIZE always suffices
 */
enum gz_result gz_gaze_log_print_record(const struct gz_gaze_log_record *record, char *text,
					size_t size, size_t *out_length);

/**
 * Print the line "#end".
 *
 * @param samples          number of samples in the log
 * @param crc              CRC-32 (zlib's) of all bytes before the line
 * @param[out] out_length  bytes of the line without the NUL
 * @retval GZ_ERR_FULL  @p size is too small
 */
enum gz_result gz_gaze_log_print_end(uint64_t samples, uint32_t crc, char *text, size_t size,
				     size_t *out_length);

/** Bytes that a writer gathers before it writes them. Chosen: several hundred lines. */
#define GZ_GAZE_LOG_WRITER_BUFFER 65536

/** A log being written. One thread at a time. */
struct gz_gaze_log_writer {
	int fd;
	uint32_t crc;     /**< of all whole lines in the file */
	uint64_t size;    /**< bytes of these lines */
	uint64_t samples; /**< samples in these lines */
	bool still_scene; /**< of the newest sample that was added */
	size_t used;      /**< bytes in the buffer */
	unsigned char buffer[GZ_GAZE_LOG_WRITER_BUFFER];
};

/**
 * Begin a log.
 *
 * @param fd  an empty file, open for writing at its start; the caller closes it
 * @retval GZ_ERR_FULL  the header is larger than the buffer: a bug
 */
enum gz_result gz_gaze_log_writer_begin(struct gz_gaze_log_writer *writer, int fd,
					const struct gz_gaze_log_header *header);

/**
 * Add a record. Before a sample whose still_scene differs from that of the sample before it (of the
 * first one: from false), a SCENE record is added, unless the caller has just added that.
 *
 * @retval GZ_ERR_IO  the disk is full or failing; errno has the cause. The file has been cut after
 *                    its last whole line and ended there, if that was still possible
 */
enum gz_result gz_gaze_log_writer_add(struct gz_gaze_log_writer *writer,
				      const struct gz_gaze_log_record *record);

/** Write the lines gathered so far. Errors as for gz_gaze_log_writer_add(). */
enum gz_result gz_gaze_log_writer_flush(struct gz_gaze_log_writer *writer);

/** Write the lines gathered so far and the line "#end". Errors as for gz_gaze_log_writer_add(). */
enum gz_result gz_gaze_log_writer_end(struct gz_gaze_log_writer *writer);

/** A log being read. One thread at a time. */
struct gz_gaze_log_reader;

/** How a log ended. */
enum gz_gaze_log_ending {
	GZ_GAZE_LOG_UNREAD,    /**< its end has not been reached */
	GZ_GAZE_LOG_WHOLE,     /**< "#end" found, count and CRC right */
	GZ_GAZE_LOG_CUT,       /**< no "#end": read up to the last whole line */
	GZ_GAZE_LOG_CORRUPTED, /**< "#end" found, but count or CRC is wrong */
};

/**
 * Open a log and read its header.
 *
 * @param[out] out_reader  owned by the caller; gz_gaze_log_close()
 * @retval GZ_ERR_NOT_FOUND  no such file; logged
 * @retval GZ_ERR_IO         the file cannot be read; logged
 * @retval GZ_ERR_NO_MEM     out of memory; logged
 * @retval GZ_ERR_FORMAT     not a gaze log of version 1, or a malformed header; logged with
 * file:line
 */
enum gz_result gz_gaze_log_open(const char *path, const struct gz_log *log,
				struct gz_gaze_log_reader **out_reader);

/**
 * Open a log that is in memory and read its header.
 *
 * @param name             the log's name in messages
 * @param bytes, size      must stay unchanged until the reader is closed
 * @param[out] out_reader  owned by the caller; gz_gaze_log_close()
 * @return as gz_gaze_log_open()
 */
enum gz_result gz_gaze_log_open_memory(const char *name, const void *bytes, size_t size,
				       const struct gz_log *log,
				       struct gz_gaze_log_reader **out_reader);

/** The header. Valid until the reader is closed. */
const struct gz_gaze_log_header *gz_gaze_log_header(const struct gz_gaze_log_reader *reader);

/**
 * Read the next record.
 *
 * @retval GZ_OK          *out_record is filled
 * @retval GZ_ERR_END     the log has ended; gz_gaze_log_ending() says how. A cut or corrupted log
 * is logged once, as a warning with the number of samples found
 * @retval GZ_ERR_FORMAT  a malformed line; the first ten of a log are logged with file:line. The
 *                        line is skipped, and the next call continues after it
 * @retval GZ_ERR_IO      reading failed; logged
 */
enum gz_result gz_gaze_log_read(struct gz_gaze_log_reader *reader,
				struct gz_gaze_log_record *out_record);

/** How the log ended. Certain once gz_gaze_log_read() has returned GZ_ERR_END. */
enum gz_gaze_log_ending gz_gaze_log_ending(const struct gz_gaze_log_reader *reader);

/**
 * Find the time of a log's last sample from the end of the file. The rest of the log is not read or
 * checked.
 *
 * @retval GZ_ERR_NOT_FOUND  no such file; not logged
 * @retval GZ_ERR_IO         the file cannot be read; not logged
 * @retval GZ_ERR_NO_MEM     out of memory; not logged
 * @retval GZ_ERR_FORMAT     its last 64 KiB contain no sample; not logged
 */
enum gz_result gz_gaze_log_find_last(const char *path, int64_t *out_host_ns);

/** Close the reader and set the pointer to NULL. Accepts a pointer to NULL. */
void gz_gaze_log_close(struct gz_gaze_log_reader **reader);

#endif
