/**
 * @file
 * Reports of the template's device for tests, laid out by the description in template_protocol.h.
 */
#ifndef GZ_TESTS_DRIVERS_TEMPLATE_MADE_H
#define GZ_TESTS_DRIVERS_TEMPLATE_MADE_H

#include "drivers/template/template_protocol.h"
#include "frame_bytes.h"

/** Lay out a report with a correct sum. */
static inline void template_made_report(const struct gz_template_report *report,
					unsigned char bytes[GZ_TEMPLATE_REPORT_SIZE])
{
	uint32_t sum = 0;
	unsigned flags =
		(report->found[GZ_EYE_RIGHT] ? 1u : 0u) | (report->found[GZ_EYE_LEFT] ? 2u : 0u);
	memcpy(bytes, "GT", 2);
	bytes[2] = (unsigned char)flags;
	bytes[3] = 1;
	frame_put(bytes + 4, 4, report->counter);
	frame_put(bytes + 8, 4, report->clock_us);
	for (size_t eye = 0; eye < GZ_EYE_COUNT; eye++) {
		frame_put_f32(bytes + 12 + 8 * eye, report->point[eye].x);
		frame_put_f32(bytes + 16 + 8 * eye, report->point[eye].y);
	}
	for (size_t i = 0; i < 28; i++)
		sum += bytes[i];
	frame_put(bytes + 28, 4, sum);
}

#endif
