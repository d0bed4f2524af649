/**
 * @file
 * What a tracker was last validated on: the display, and the monitor that showed the targets. If
 * either has changed since, neither the accuracy that was measured nor the calibration can be
 * relied on. There is an INI file for each tracker, in the directory of the corrections. gazectl
 * validate writes it, gazed reads it.
 *
 *     [validated]
 *     tracker = sim              name, and serial number; all but A-Z a-z 0-9 . - becomes "_"
 *     serial =
 *     display_px = 1920x1080     as the daemon knew it
 *     display_mm = 564.677 317.631
 *     distance_mm = 600
 *     monitor_at = 1920 0        upper left corner on the desktop, px; as the viewer saw it
 *     monitor_px = 1920 1080     0 0: unknown, and so is what is above and below
 *     monitor_scale = 1.5        of the desktop; 0: unknown
 *     measured = 2026-01-31T12:00:00Z
 *     accuracy_deg = 0.6
 */
#ifndef GZ_PROTOCOL_VALIDATED_FILE_H
#define GZ_PROTOCOL_VALIDATED_FILE_H

#include <stdbool.h>
#include <stddef.h>

#include "base/log.h"
#include "base/result.h"
#include "protocol/display.h"
#include "protocol/gaze.h"

/** What a tracker was validated on. */
struct gz_validated {
	char tracker[GZ_NAME_SIZE], serial[GZ_NAME_SIZE]; /**< as gz_correction_name() gives them */
	struct gz_display display;                        /**< as the daemon knew it */
	struct gz_monitor_place monitor;                  /**< that showed the targets */
	char measured[GZ_NAME_SIZE];                      /**< UTC, ISO 8601 */
	double accuracy_deg; /**< mean distance between target and gaze, degrees */
};

/**
 * The path of a tracker's file: "validated-sim.ini" in @p directory. If the tracker has a serial
 * number, "-SERIAL" follows its name.
 *
 * @retval GZ_ERR_FULL  @p size is too small
 */
enum gz_result gz_validated_path(const char *directory, const char *tracker, const char *serial,
				 char *text, size_t size);

/** Read a file, which is untrusted; like gz_correction_read(). */
enum gz_result gz_validated_read(const char *path, const struct gz_log *log,
				 struct gz_validated *out_validated);

/** Parse the content of a file; like gz_correction_parse(). */
enum gz_result gz_validated_parse(const char *name, const char *text, size_t size,
				  const struct gz_log *log, struct gz_validated *out_validated);

/** Write a file; like gz_correction_write(). */
enum gz_result gz_validated_write(const char *path, const struct gz_validated *validated,
				  const struct gz_log *log);

/** Whether it is of this tracker. */
bool gz_validated_fits(const struct gz_validated *validated, const char *tracker,
		       const char *serial);

/**
 * Say what has changed since: size in pixels and mm, distance; pixels, place and scale of the
 * monitor. The first difference counts. Sizes in mm may differ by a millionth, scales by a
 * thousandth. Pure.
 *
 * @param display   that the daemon knows now
 * @param monitor   that a viewer reports now; what is unknown, here or there, has not changed
 * @param[out] out  "1920x1080 px, was 2560x1440 px"; empty if nothing has changed
 * @return whether something has changed
 */
bool gz_validated_changed(const struct gz_validated *validated, const struct gz_display *display,
			  const struct gz_monitor_place *monitor, char out[GZ_REASON_SIZE]);

#endif
