/**
 * @file
 * The stored correction of a tracker's gaze: the tracker and the display that it was measured with,
 * and the affine map. There is an INI file for each pair of tracker and display, in a directory of
 * their own. gazectl validate writes it, gazed reads it.
 *
 *     [correction]
 *     tracker = sim              name, and serial number; all but A-Z a-z 0-9 . - becomes "_"
 *     serial =
 *     display_px = 1920x1080
 *     display_mm = 564.677 317.631
 *     distance_mm = 600
 *     x = 0.01 1.02 0            a b c of x' = a + b x + c y, in display sides
 *     y = 0 0 0.98               a b c of y' = a + b x + c y
 *     measured = 2026-01-31T12:00:00Z
 *     before_deg = 1.2           mean error of the targets without the correction, and with it by
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
	char tracker[GZ_NAME_SIZE], serial[GZ_NAME_SIZE]; /**< as gz_correction_name() gives them */
	int display_px[2];
	double display_mm[2];
	double distance_mm;
	double x[3], y[3];
	char measured[GZ_NAME_SIZE]; /**< UTC, ISO 8601 */
	double before_deg, after_deg;
};

/**
 * Turn a tracker's name or serial number into one that a file's name can contain: characters other
 * than A-Z a-z 0-9 . - become "_", and so does a leading dot. Longer names are cut.
 */
void gz_correction_name(const char *name, char out_name[GZ_NAME_SIZE]);

/**
 * The user's directory of corrections: gazecast/corrections in $XDG_CONFIG_HOME, otherwise in
 * ~/.config.
 *
 * @retval GZ_ERR_NOT_FOUND  neither XDG_CONFIG_HOME nor HOME is an absolute path
 * @retval GZ_ERR_FULL       @p size is too small
 */
enum gz_result gz_correction_directory(char *text, size_t size);

/**
 * The path of the file for a tracker and a display: "sim-1920x1080-565x318mm-600mm.ini" in
 * @p directory. If the tracker has a serial number, "-SERIAL" follows its name.
 *
 * @retval GZ_ERR_FULL  @p size is too small
 */
enum gz_result gz_correction_path(const char *directory, const char *tracker, const char *serial,
				  const struct gz_display *display, char *text, size_t size);

/**
 * Read a file, which is untrusted. It must give every key, each within its range.
 *
 * @param[out] out_file  written on success only
 * @retval GZ_ERR_NOT_FOUND  no such file; not logged, because most trackers have none
 * @retval GZ_ERR_IO         the file cannot be read; logged
 * @retval GZ_ERR_FORMAT     a line is refused or a key is missing; logged
 * @retval GZ_ERR_NO_MEM     out of memory
 */
enum gz_result gz_correction_read(const char *path, const struct gz_log *log,
				  struct gz_correction_file *out_file);

/**
 * Parse the content of a file, @p size bytes at @p text, like gz_correction_read().
 *
 * @param name           the file's name in messages
 * @param[out] out_file  written on success only
 * @retval GZ_ERR_FORMAT  a line is refused or a key is missing; logged
 * @retval GZ_ERR_NO_MEM  out of memory
 */
enum gz_result gz_correction_parse(const char *name, const char *text, size_t size,
				   const struct gz_log *log, struct gz_correction_file *out_file);

/** Whether a correction was measured with this tracker and this display; sizes may differ by a
 *  millionth. */
bool gz_correction_fits(const struct gz_correction_file *file, const char *tracker,
			const char *serial, const struct gz_display *display);

/**
 * Write a file and make the directories that it needs (mode 0700; root's 0755). An existing file
 * stays until the new one is on the disk.
 *
 * @retval GZ_ERR_ACCESS  no permission; logged
 * @retval GZ_ERR_IO      any other error; logged
 */
enum gz_result gz_correction_write(const char *path, const struct gz_correction_file *file,
				   const struct gz_log *log);

#endif
