/**
 * @file
 * What commands write: files that appear under their name only when they are complete, and JSON.
 */
#ifndef GZ_CLIENT_GAZECTL_OUTPUT_H
#define GZ_CLIENT_GAZECTL_OUTPUT_H

#include <jansson.h>
#include <stdbool.h>
#include <stdio.h>
#include <zlib.h>

#include "base/log.h"
#include "base/result.h"
#include "protocol/display.h"
#include "protocol/gaze.h"

/** A file being written, under another name until it is complete. Zero-initialised: none. */
struct gz_output_file {
	int fd;
	FILE *text;  /**< of GZ_OUTPUT_TEXT */
	gzFile gzip; /**< of GZ_OUTPUT_GZIP */
	bool open;
	char path[GZ_PATH_SIZE];
	char partial[GZ_PATH_SIZE + 8]; /**< its name until it is complete */
};

/** How a file is written. */
enum gz_output_kind {
	GZ_OUTPUT_RAW,  /**< through its descriptor */
	GZ_OUTPUT_TEXT, /**< through stdio */
	GZ_OUTPUT_GZIP, /**< through zlib */
};

/**
 * Begin to write a file.
 *
 * @param[out] file  filled
 * @param overwrite  whether an existing file may be replaced
 * @retval GZ_ERR_BUSY    the file exists and may not be replaced; logged with the remedy
 * @retval GZ_ERR_INVAL   @p path is too long; logged
 * @retval GZ_ERR_IO      the file cannot be created; logged
 * @retval GZ_ERR_NO_MEM  no memory
 */
enum gz_result gz_output_begin(struct gz_output_file *file, const char *path, bool overwrite,
			       enum gz_output_kind kind, const struct gz_log *log);

/**
 * Check the name of a picture, which is SVG: it must end in ".svg", or be empty for no picture.
 *
 * @retval GZ_ERR_INVAL  it ends otherwise; logged with the remedy
 */
enum gz_result gz_output_check_svg(const char *path, const struct gz_log *log);

/**
 * End writing: give the file its name if it is @p complete, otherwise remove it. Ignores a file
 * that is not open.
 *
 * @retval GZ_ERR_IO  the file could not be written completely, and was removed; logged
 */
enum gz_result gz_output_end(struct gz_output_file *file, bool complete, const struct gz_log *log);

/*
 * JSON values for jansson's json_pack(), which refuses NULL: each function returns a new reference,
 * or NULL without memory.
 */

/** Text; bytes that are not UTF-8 become U+FFFD. */
json_t *gz_output_json_text(const char *text);

/** A number; null if it is not finite, which JSON cannot express. A whole number has no fraction.
 */
json_t *gz_output_json_number(double value);

/** A whole number from 0. */
json_t *gz_output_json_count(uint64_t value);

/** A list of @p count numbers. */
json_t *gz_output_json_numbers(const double *values, size_t count);

/** The name and serial number of a tracker. */
json_t *gz_output_json_tracker(const char *name, const char *serial);

/** A nominal and a measured rate, Hz. */
json_t *gz_output_json_rate(double nominal_hz, double measured_hz);

/** A display's geometry: px, mm and distance_mm. */
json_t *gz_output_json_display(const struct gz_display *display);

/**
 * Print a value, indented by two blanks a level, numbers with up to 12 digits, and a newline. The
 * caller checks ferror(@p out).
 *
 * @param json  its reference is released; NULL: there was no memory to make it
 * @retval GZ_ERR_NO_MEM  no memory; logged
 */
enum gz_result gz_output_json_print(json_t *json, FILE *out, const struct gz_log *log);

#endif
