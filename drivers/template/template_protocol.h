/**
 * @file
 * Reports of the template's device: from bytes to numbers, without I/O. A real driver says here
 * where its layout is described, with page and version; this layout was invented for the template.
 *
 * A report has 32 bytes, little-endian:
 *
 *     0   u8[2]   "GT"
 *     2   u8      flags: 1 right eye found, 2 left eye found
 *     3   u8      version, 1
 *     4   u32     counter of reports, including those lost on the way; wraps
 *     8   u32     device clock, us; wraps after 71 minutes
 *     12  f32[2]  point of the right eye, normalised, origin top left
 *     20  f32[2]  point of the left eye
 *     28  u32     sum of bytes 0 to 27
 */
#ifndef GZ_DRIVERS_TEMPLATE_PROTOCOL_H
#define GZ_DRIVERS_TEMPLATE_PROTOCOL_H

#include <stddef.h>
#include <stdint.h>

#include "base/result.h"
#include "protocol/gaze.h"

/** Bytes of a report. */
#define GZ_TEMPLATE_REPORT_SIZE 32

/** Numbers of a report. */
struct gz_template_report {
	uint32_t counter;
	uint32_t clock_us;
	bool found[GZ_EYE_COUNT];
	struct gz_point point[GZ_EYE_COUNT]; /**< any float, as sent */
};

/**
 * Parse one report.
 *
 * @param bytes, size  as received, untrusted
 * @param[out] out_report  written on success only
 * @retval GZ_ERR_PROTOCOL  too short, or wrong magic bytes, version or sum
 */
enum gz_result gz_template_parse(const unsigned char *bytes, size_t size,
				 struct gz_template_report *out_report);

#endif
