/**
 * @file
 * A correction of a tracker's gaze as it is stored: which tracker and which display it was measured
 * with, and the affine map. An INI file for each pair of tracker and display, in a directory of
 * their own; gazectl validate writes it, gazed reads it.
 *
 *     [correction]
 *     tracker = sim              name and serial number, other than A-Z a-z 0-9 . - as "_"
 *     serial =
 *     display_px = 1920x1080
 *     display_mm = 564.677 317.631
 *     distance_mm = 600
 *     x = 0.01 1.02 0            a b c of x' = a + b x + c y, display sides
 *     y = 0 0 0.98
 *     measured = 2026-01-31T12:00:00Z
 *     before_deg = 1.2           mean error of the targets without and with it, the latter by
 *     after_deg = 0.4            leave-one-out cross-validation
 */
#ifndef GZ_PROTOCOL_CORRECTION_FILE_H
#define GZ_PROTOCOL_CORRECTION_FILE_H

#include <stdbool.h>
#include <stddef.h>

#include "base/log.h"
#include "base/result.h"
#include "protocol/display.h"
#include "protocol/gaze.h"

/** A stored correction. */
struct gz_correction_file {
	char tracker[GZ_NAME_SIZE], serial[GZ_NAME_SIZE]; /**< as gz_correction_name() makes them */
	int display_px[2];
	double display_mm[2];
	double distance_mm;
	double x[3], y[3];
	char measured[GZ_NAME_SIZE]; /**< UTC, ISO 8601 */
	double before_deg, after_deg;
};

/** Make what may stand in a file's name of a tracker's name: other characters become "_", as does a
 *  leading dot. */
void gz_correction_name(const char *name, char out_name[GZ_NAME_SIZE]);

/**
 * The user's directory of corrections: gazecast/corrections in $XDG_CONFIG_HOME, else in ~/.config.
 *
 * @retval GZ_ERR_NOT_FOUND  neither XDG_CONFIG_HOME nor HOME is an absolute path
 * @retval GZ_ERR_FULL       @p size is too small
 */
enum gz_result gz_correction_directory(char *text, size_t size);

/**
 * The file's name for a tracker and a display: "sim-1920x1080-565x318mm-600mm.ini", with
 * "-SERIAL" behind the name where there is one.
 *
 * @retval GZ_ERR_FULL  @p size is too small
 */
enum gz_result gz_correction_path(const char *directory, const char *tracker, const char *serial,
				  const struct gz_display *display, char *text, size_t size);

/**
 * Read a file. Untrusted: every key must be there and in its range.
 *
 * @param[out] out_file  written on success only
 * @retval GZ_ERR_NOT_FOUND  there is none; not logged, since most trackers have none
 * @retval GZ_ERR_IO, GZ_ERR_FORMAT, GZ_ERR_NO_MEM  logged
 */
enum gz_result gz_correction_read(const char *path, const struct gz_log *log,
				  struct gz_correction_file *out_file);

/** As gz_correction_read() over @p size bytes at @p text; @p name stands for the file in messages.
 */
enum gz_result gz_correction_parse(const char *name, const char *text, size_t size,
				   const struct gz_log *log, struct gz_correction_file *out_file);

/** Whether a correction was measured with this tracker and this display, sizes to a millionth. */
bool gz_correction_fits(const struct gz_correction_file *file, const char *tracker,
			const char *serial, const struct gz_display *display);

/**
 * Write a file, with the directories that it needs (0700, root's 0755): the old one stays until the
 * new one is on the disk.
 *
 * @retval GZ_ERR_ACCESS  not allowed; logged
 * @retval GZ_ERR_IO      anything else; logged
 */
enum gz_result gz_correction_write(const char *path, const struct gz_correction_file *file,
				   const struct gz_log *log);

#endif
