#include "drivers/template/template_protocol.h"

#include <string.h>

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

static uint32_t read_u32le(const unsigned char *bytes)
{
	return (uint32_t)bytes[0] | (uint32_t)bytes[1] << 8 | (uint32_t)bytes[2] << 16 |
	       (uint32_t)bytes[3] << 24;
}

static void write_u32le(unsigned char *bytes, uint32_t value)
{
	for (int i = 0; i < 4; i++)
		bytes[i] = (unsigned char)(value >> (8 * i));
}

static float read_f32le(const unsigned char *bytes)
{
	uint32_t bits = read_u32le(bytes);
	float value;
	memcpy(&value, &bits, sizeof value);
	return value;
}

static void write_f32le(unsigned char *bytes, float value)
{
	uint32_t bits;
	memcpy(&bits, &value, sizeof bits);
	write_u32le(bytes, bits);
}

static uint32_t sum(const unsigned char *bytes)
{
	uint32_t total = 0;
	for (int i = 0; i < AT_SUM; i++)
		total += bytes[i];
	return total;
}

enum gz_result gz_template_parse(const unsigned char *bytes, size_t size,
				 struct gz_template_report *out_report)
{
	if (size < GZ_TEMPLATE_REPORT_SIZE || memcmp(bytes, "GT", 2) != 0 ||
	    bytes[AT_VERSION] != VERSION || read_u32le(bytes + AT_SUM) != sum(bytes))
		return GZ_ERR_PROTOCOL;
	struct gz_template_report report = {
		.counter = read_u32le(bytes + AT_COUNTER),
		.clock_us = read_u32le(bytes + AT_CLOCK),
		.found = { [GZ_EYE_RIGHT] = bytes[AT_FLAGS] & FLAG_RIGHT,
			   [GZ_EYE_LEFT] = bytes[AT_FLAGS] & FLAG_LEFT },
	};
	for (int eye = 0; eye < GZ_EYE_COUNT; eye++) {
		const unsigned char *at = bytes + AT_POINTS + POINT_SIZE * eye;
		report.point[eye] = (struct gz_point) { read_f32le(at), read_f32le(at + 4) };
	}
	*out_report = report;
	return GZ_OK;
}

void gz_template_print(const struct gz_template_report *report,
		       unsigned char bytes[GZ_TEMPLATE_REPORT_SIZE])
{
	memcpy(bytes, "GT", 2);
	bytes[AT_FLAGS] = (unsigned char)((report->found[GZ_EYE_RIGHT] ? FLAG_RIGHT : 0) |
					  (report->found[GZ_EYE_LEFT] ? FLAG_LEFT : 0));
	bytes[AT_VERSION] = VERSION;
	write_u32le(bytes + AT_COUNTER, report->counter);
	write_u32le(bytes + AT_CLOCK, report->clock_us);
	for (int eye = 0; eye < GZ_EYE_COUNT; eye++) {
		unsigned char *at = bytes + AT_POINTS + POINT_SIZE * eye;
		write_f32le(at, report->point[eye].x);
		write_f32le(at + 4, report->point[eye].y);
	}
	write_u32le(bytes + AT_SUM, sum(bytes));
}
