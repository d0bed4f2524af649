#include "hid_layout.h"

#include <math.h>
#include <string.h>

/* Items of a report descriptor (HID 1.11, section 6.2.2), as bytes. */
#define USAGE_PAGE_EYE   0x05, 0x12
#define USAGE(u)         0x09, (u)
#define USAGE16(u)       0x0A, (u)&0xFF, (u) >> 8
#define COLLECTION(kind) 0xA1, (kind)
#define END              0xC0
#define REPORT_ID(id)    0x85, (id)
#define FIELDS(bits, n)  0x75, (bits), 0x95, (n)
#define MINIMUM8(v)      0x15, (v)
#define MAXIMUM8(v)      0x25, (v)
#define MAXIMUM16(v)     0x26, (v)&0xFF, (v) >> 8
#define BYTES32(v)       (v) & 0xFF, ((v) >> 8) & 0xFF, ((v) >> 16) & 0xFF, ((uint32_t)(v) >> 24) & 0xFF
#define MINIMUM32(v)     0x17, BYTES32(v)
#define MAXIMUM32(v)     0x27, BYTES32(v)
#define UNIT(u)          0x66, (u)&0xFF, (u) >> 8
#define EXPONENT(nibble) 0x55, (nibble)
#define INPUT(flags)     0x81, (flags)
#define FEATURE(flags)   0xB1, (flags)

enum {
	PHYSICAL = 0,
	APPLICATION = 1,
	LOGICAL = 2,

	CONSTANT = 1,
	VARIABLE = 2,

	/* Units (HID 1.11, section 6.2.2.7). */
	NO_UNIT = 0,
	CENTIMETRE = 0x11,
	INCH = 0x13,
	SECOND = 0x1001,
	HERTZ = 0xF001,

	EYE_TRACKER = 0x01,
	TRACKING_DATA = 0x10,
	CAPABILITIES = 0x11,
	CONFIGURATION = 0x12,
	STATUS = 0x13,
	CONTROL = 0x14,
	TIMESTAMP = 0x20,
	POSITION_X = 0x21,
	POSITION_Y = 0x22,
	POSITION_Z = 0x23,
	GAZE_POINT = 0x24,
	LEFT_EYE = 0x25,
	RIGHT_EYE = 0x26,
	HEAD = 0x27,
};

#define XY  USAGE(POSITION_X), USAGE(POSITION_Y)
#define XYZ XY, USAGE(POSITION_Z)

/* Micrometres: centimetres times 10 to the -4, from -2 m to 2 m. */
#define MICROMETRES UNIT(CENTIMETRE), EXPONENT(0x0C), MINIMUM32(-2000000), MAXIMUM32(2000000)

static void put(uint8_t *bytes, int size, int64_t value)
{
	for (int i = 0; i < size; i++)
		bytes[i] = (uint8_t)((uint64_t)value >> (8 * i));
}

static const double left_eye_mm[3] = HID_LEFT_EYE_MM;
static const double right_eye_mm[3] = HID_RIGHT_EYE_MM;

static void put_um(uint8_t *bytes, double mm)
{
	put(bytes, 4, lround(mm * 1000));
}

/* A gaze point and both eyes, micrometres. */
static void put_positions(uint8_t *bytes, const struct made_sample *sample)
{
	put_um(bytes, sample->x * MADE_WIDTH_MM);
	put_um(bytes + 4, sample->y * MADE_HEIGHT_MM);
	for (size_t i = 0; i < 3; i++) {
		put_um(bytes + 8 + 4 * i, left_eye_mm[i]);
		put_um(bytes + 20 + 4 * i, right_eye_mm[i]);
	}
}

/* clang-format off */
static const uint8_t reference_descriptor[] = {
	USAGE_PAGE_EYE, USAGE(EYE_TRACKER), COLLECTION(APPLICATION),
	USAGE(TRACKING_DATA), COLLECTION(LOGICAL), REPORT_ID(0x10),
		USAGE(TIMESTAMP), MINIMUM8(0), MAXIMUM16(255), UNIT(SECOND), EXPONENT(0x0A),
		FIELDS(8, 8), INPUT(VARIABLE),
		USAGE(GAZE_POINT), COLLECTION(PHYSICAL), MICROMETRES, XY, FIELDS(32, 2),
			INPUT(CONSTANT | VARIABLE), END,
		USAGE(LEFT_EYE), COLLECTION(PHYSICAL), XYZ, FIELDS(32, 3),
			INPUT(CONSTANT | VARIABLE), END,
		USAGE(RIGHT_EYE), COLLECTION(PHYSICAL), XYZ, FIELDS(32, 3),
			INPUT(CONSTANT | VARIABLE), END,
		FIELDS(32, 6), INPUT(CONSTANT | VARIABLE),
	END,
	USAGE(CAPABILITIES), COLLECTION(LOGICAL), REPORT_ID(0x11),
		UNIT(NO_UNIT), EXPONENT(0), USAGE16(0x100), MINIMUM8(0), MAXIMUM8(1),
		FIELDS(8, 1), FEATURE(CONSTANT | VARIABLE),
		COLLECTION(PHYSICAL), MICROMETRES, USAGE16(0x101), USAGE16(0x102), USAGE16(0x103),
			USAGE16(0x104), USAGE16(0x105), FIELDS(32, 5), FEATURE(CONSTANT | VARIABLE), END,
	END,
	USAGE(CONFIGURATION), COLLECTION(LOGICAL), REPORT_ID(0x12),
		UNIT(NO_UNIT), EXPONENT(0), MINIMUM8(0), MAXIMUM32(0xFFFF),
		USAGE16(0x200), FIELDS(16, 1), FEATURE(CONSTANT | VARIABLE),
		USAGE16(0x201), FEATURE(CONSTANT | VARIABLE),
		MAXIMUM32(0x7FFFFFFF), USAGE16(0x202), FIELDS(32, 1), FEATURE(CONSTANT | VARIABLE),
		MAXIMUM32(0xFFFF), USAGE16(0x203), FIELDS(16, 1), FEATURE(CONSTANT | VARIABLE),
		COLLECTION(PHYSICAL), UNIT(CENTIMETRE), EXPONENT(0x0C), MAXIMUM32(0x7FFFFFFF),
			USAGE16(0x204), USAGE16(0x205), FIELDS(32, 2), FEATURE(CONSTANT | VARIABLE), END,
	END,
	USAGE(STATUS), COLLECTION(LOGICAL), REPORT_ID(0x13),
		UNIT(NO_UNIT), EXPONENT(0), MAXIMUM8(4), USAGE16(0x301), FIELDS(8, 1), FEATURE(VARIABLE),
		UNIT(HERTZ), MAXIMUM32(0xFFFF), USAGE16(0x300), FIELDS(16, 1), FEATURE(VARIABLE),
	END,
	USAGE(STATUS), COLLECTION(LOGICAL), REPORT_ID(0x13),
		UNIT(NO_UNIT), EXPONENT(0), MAXIMUM8(4), USAGE16(0x301), FIELDS(8, 1), INPUT(VARIABLE),
		UNIT(HERTZ), MAXIMUM32(0xFFFF), USAGE16(0x300), FIELDS(16, 1), INPUT(VARIABLE),
	END,
	USAGE(CONTROL), COLLECTION(LOGICAL), REPORT_ID(0x14),
		UNIT(NO_UNIT), EXPONENT(0), MAXIMUM8(7), USAGE16(0x400), FIELDS(8, 1), FEATURE(VARIABLE),
	END,
	END,
};

static const uint8_t padded_descriptor[] = {
	USAGE_PAGE_EYE, USAGE(EYE_TRACKER), COLLECTION(APPLICATION),
	USAGE(TRACKING_DATA), COLLECTION(LOGICAL), REPORT_ID(0x10),
		FIELDS(8, 7), INPUT(CONSTANT | VARIABLE),
		USAGE(TIMESTAMP), MINIMUM8(0), MAXIMUM16(255), UNIT(SECOND), EXPONENT(0x0A),
		FIELDS(8, 8), INPUT(VARIABLE),
		USAGE(GAZE_POINT), COLLECTION(PHYSICAL), MICROMETRES, XY, FIELDS(32, 2),
			INPUT(VARIABLE), END,
		USAGE(LEFT_EYE), COLLECTION(PHYSICAL), XYZ, FIELDS(32, 3), INPUT(VARIABLE), END,
		USAGE(RIGHT_EYE), COLLECTION(PHYSICAL), XYZ, FIELDS(32, 3), INPUT(VARIABLE), END,
	END,
	END,
};

static const uint8_t wide_descriptor[] = {
	USAGE_PAGE_EYE, USAGE(EYE_TRACKER), COLLECTION(APPLICATION),
	USAGE(TRACKING_DATA), COLLECTION(LOGICAL), REPORT_ID(0x10),
		USAGE(TIMESTAMP), MINIMUM8(0), MAXIMUM32(0x7FFFFFFF), UNIT(SECOND), EXPONENT(0x09),
		FIELDS(64, 1), INPUT(VARIABLE),
		USAGE(GAZE_POINT), COLLECTION(PHYSICAL), MICROMETRES, XY, FIELDS(32, 2),
			INPUT(VARIABLE), END,
		USAGE(LEFT_EYE), COLLECTION(PHYSICAL), XYZ, FIELDS(32, 3), INPUT(VARIABLE), END,
		USAGE(RIGHT_EYE), COLLECTION(PHYSICAL), XYZ, FIELDS(32, 3), INPUT(VARIABLE), END,
	END,
	END,
};

static const uint8_t coarse_descriptor[] = {
	USAGE_PAGE_EYE, USAGE(EYE_TRACKER), COLLECTION(APPLICATION),
	USAGE(TRACKING_DATA), COLLECTION(LOGICAL), REPORT_ID(0x42),
		UNIT(CENTIMETRE), EXPONENT(0x0E), MINIMUM32(-20000), MAXIMUM16(20000),
		USAGE(GAZE_POINT), COLLECTION(PHYSICAL), XY, FIELDS(16, 2), INPUT(VARIABLE), END,
		USAGE(LEFT_EYE), COLLECTION(PHYSICAL), XYZ, FIELDS(16, 3), INPUT(VARIABLE), END,
		USAGE(RIGHT_EYE), COLLECTION(PHYSICAL), XYZ, FIELDS(16, 3), INPUT(VARIABLE), END,
		USAGE(TIMESTAMP), MINIMUM8(0), MAXIMUM32(0x7FFFFFFF), UNIT(SECOND), EXPONENT(0x0D),
		FIELDS(32, 1), INPUT(VARIABLE),
	END,
	END,
};

static const uint8_t point_descriptor[] = {
	USAGE_PAGE_EYE, USAGE(EYE_TRACKER), COLLECTION(APPLICATION),
	USAGE(TRACKING_DATA), COLLECTION(LOGICAL),
		USAGE(GAZE_POINT), COLLECTION(PHYSICAL),
			UNIT(INCH), EXPONENT(0x0D), MINIMUM32(-100000), MAXIMUM32(100000), XY,
			FIELDS(32, 2), INPUT(VARIABLE), END,
	END,
	END,
};
/* clang-format on */

static void encode_reference(const struct made_sample *sample, uint8_t *report)
{
	report[0] = 0x10;
	put(report + 1, 8, sample->device_us);
	put_positions(report + 9, sample);
}

static void encode_padded(const struct made_sample *sample, uint8_t *report)
{
	report[0] = 0x10;
	memset(report + 1, 0xA5, 7); /* padding is not looked at */
	put(report + 8, 8, sample->device_us);
	put_positions(report + 16, sample);
}

static void encode_wide(const struct made_sample *sample, uint8_t *report)
{
	report[0] = 0x10;
	put(report + 1, 8, sample->device_us * 10);
	put_positions(report + 9, sample);
}

static void encode_coarse(const struct made_sample *sample, uint8_t *report)
{
	report[0] = 0x42;
	put(report + 1, 2, lround(sample->x * MADE_WIDTH_MM * 10));
	put(report + 3, 2, lround(sample->y * MADE_HEIGHT_MM * 10));
	for (size_t i = 0; i < 3; i++) {
		put(report + 5 + 2 * i, 2, lround(left_eye_mm[i] * 10));
		put(report + 11 + 2 * i, 2, lround(right_eye_mm[i] * 10));
	}
	put(report + 17, 4, sample->device_us / 1000);
}

static void encode_point(const struct made_sample *sample, uint8_t *report)
{
	put(report, 4, lround(sample->x * MADE_WIDTH_MM / 25.4 * 1000));
	put(report + 4, 4, lround(sample->y * MADE_HEIGHT_MM / 25.4 * 1000));
}

#define DESCRIPTOR(bytes) .descriptor = (bytes), .descriptor_size = sizeof(bytes)

const struct hid_layout hid_layout_reference = {
	DESCRIPTOR(reference_descriptor), .report_size = 65, .device_tick_us = 1, .has_eyes = true,
	.encode = encode_reference,
};

const struct hid_layout hid_layout_padded = {
	DESCRIPTOR(padded_descriptor), .report_size = 48, .device_tick_us = 1, .has_eyes = true,
	.encode = encode_padded,
};

const struct hid_layout hid_layout_wide = {
	DESCRIPTOR(wide_descriptor), .report_size = 41, .device_tick_us = 0.1, .has_eyes = true,
	.encode = encode_wide,
};

const struct hid_layout hid_layout_coarse = {
	DESCRIPTOR(coarse_descriptor), .report_size = 21, .device_tick_us = 1000, .has_eyes = true,
	.encode = encode_coarse,
};

const struct hid_layout hid_layout_point = {
	DESCRIPTOR(point_descriptor),
	.report_size = 8,
	.encode = encode_point,
};

const struct hid_layout *const hid_layouts[] = {
	&hid_layout_reference, &hid_layout_padded, &hid_layout_wide,
	&hid_layout_coarse,    &hid_layout_point,  NULL,
};
