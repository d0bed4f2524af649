#include "drivers/template/template_protocol.h"

#include <string.h>

#include "drivers/device/little_endian.h"

enum {
	FLAG_RIGHT = 1,
	FLAG_LEFT = 2,
	VERSION = 1,
	AT_FLAGS = 2,
	AT_VERSION = 3,
	AT_COUNTER = 4,
	AT_CLOCK = 8,
	AT_POINTS = 12,
	AT_SUM = 28,
	POINT_SIZE = 8,
};

static uint32_t sum_of_report(const unsigned char *bytes)
{
	uint32_t sum = 0;
	for (int i = 0; i < AT_SUM; i++)
		sum += bytes[i];
	return sum;
}

enum gz_result gz_template_parse(const unsigned char *bytes, size_t size,
				 struct gz_template_report *out_report)
{
	if (size < GZ_TEMPLATE_REPORT_SIZE || memcmp(bytes, "GT", 2) != 0 ||
	    bytes[AT_VERSION] != VERSION || gz_read_u32le(bytes + AT_SUM) != sum_of_report(bytes))
		return GZ_ERR_PROTOCOL;
	struct gz_template_report report = {
		.counter = gz_read_u32le(bytes + AT_COUNTER),
		.clock_us = gz_read_u32le(bytes + AT_CLOCK),
		.found = { [GZ_EYE_RIGHT] = bytes[AT_FLAGS] & FLAG_RIGHT,
			   [GZ_EYE_LEFT] = bytes[AT_FLAGS] & FLAG_LEFT },
	};
	for (int eye = 0; eye < GZ_EYE_COUNT; eye++) {
		const unsigned char *at = bytes + AT_POINTS + POINT_SIZE * eye;
		report.point[eye] = (struct gz_point) { gz_read_f32le(at), gz_read_f32le(at + 4) };
	}
	*out_report = report;
	return GZ_OK;
}
