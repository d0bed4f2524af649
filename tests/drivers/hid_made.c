#include "hid_made.h"

#include <math.h>
#include <string.h>

#include "frame_bytes.h"

void hid_made_sized(struct hid_made *made, enum hid_item item, unsigned size, uint32_t data)
{
	made->bytes[made->size++] = (unsigned char)((unsigned)item | (size == 4 ? 3 : size));
	frame_put(made->bytes + made->size, size, data);
	made->size += size;
}

void hid_made_item(struct hid_made *made, enum hid_item item, uint32_t data)
{
	bool bare = item == HID_END || item == HID_PUSH || item == HID_POP;
	hid_made_sized(made, item, bare ? 0 : data <= 0xff ? 1 : data <= 0xffff ? 2 : 4, data);
}

void hid_made_items(struct hid_made *made, const int64_t *pairs)
{
	for (; pairs[0] >= 0; pairs += 2)
		hid_made_item(made, (enum hid_item)pairs[0], (uint32_t)pairs[1]);
}

enum {
	/* Types of collections and flags of fields (HID 1.11, sections 6.2.2.5 and 6.2.2.6). */
	PHYSICAL = 0,
	APPLICATION = 1,
	LOGICAL = 2,
	VARIABLE = 2,
	CONSTANT = 3,

	/* Units (HID 1.11, section 6.2.2.7). */
	NO_UNIT = 0,
	CENTIMETRE = 0x11,
	INCH = 0x13,
	SECOND = 0x1001,
	HERTZ = 0xf001,

	/* Usages of page 0x12 (HUTRR74). */
	PAGE = 0x12,
	EYE_TRACKER = 0x01,
	TRACKING_DATA = 0x10,
	CAPABILITIES = 0x11,
	CONFIGURATION = 0x12,
	STATUS = 0x13,
	CONTROL = 0x14,
	TIMESTAMP = 0x20,
	POSITION_X = 0x21,
	GAZE_POINT = 0x24,
	LEFT_EYE = 0x25,
	RIGHT_EYE = 0x26,
	QUALITY = 0x100,
	DISTANCE_MINIMUM = 0x101,
	BOX_HEIGHT = 0x105,
	MANUFACTURER_ID = 0x200,
	PRODUCT_ID = 0x201,
	MODEL_YEAR = 0x202,
	SURFACE_ID = 0x203,
	SCREEN_WIDTH = 0x204,
	SCREEN_HEIGHT = 0x205,
	SAMPLING_FREQUENCY = 0x300,
	CONFIGURATION_STATUS = 0x301,
	DEVICE_MODE = 0x400,
};

/* How a tracker numbers its reports. */
enum ids {
	IDS_OF_USAGES,
	IDS_SHIFTED,
	ID_42,
	NO_IDS,
};

/* What a layout consists of. Exponents are signed nibbles. */
struct layout {
	enum ids ids;
	int padding; /* bytes before the time */

	int time_fields, time_bits; /* 0 fields: no time */
	int time_exponent;
	bool time_last;
	double tick_us;

	int length_bits;
	uint32_t length_unit;
	int length_exponent;
	int32_t length_max; /* the minimum is its negative */
	double length_um;   /* of one unit */
	int flags;          /* of positions */

	bool eyes;
	int tail; /* bytes of padding at the end */
	bool features;
};

#define MICROMETRES                                                            \
	.length_bits = 32, .length_unit = CENTIMETRE, .length_exponent = 0x0c, \
	.length_max = 2000000, .length_um = 1
#define TENTHS_OF_MM                                                           \
	.length_bits = 16, .length_unit = CENTIMETRE, .length_exponent = 0x0e, \
	.length_max = 30000, .length_um = 100
#define MICROSECONDS .time_exponent = 0x0a, .tick_us = 1
#define TENTHS_OF_US .time_exponent = 0x09, .tick_us = 0.1
#define MILLISECONDS .time_exponent = 0x0d, .tick_us = 1000

static const struct layout layouts[HID_LAYOUT_COUNT] = {
	[HID_LAYOUT_REFERENCE] = { .time_fields = 8,
				   .time_bits = 8,
				   MICROSECONDS,
				   MICROMETRES,
				   .flags = CONSTANT,
				   .eyes = true,
				   .tail = 24,
				   .features = true },
	[HID_LAYOUT_PADDED] = { .padding = 7,
				.time_fields = 8,
				.time_bits = 8,
				MICROSECONDS,
				MICROMETRES,
				.flags = VARIABLE,
				.eyes = true,
				.features = true },
	[HID_LAYOUT_TIME64] = { .ids = IDS_SHIFTED,
				.time_fields = 1,
				.time_bits = 64,
				TENTHS_OF_US,
				.time_last = true,
				TENTHS_OF_MM,
				.flags = VARIABLE,
				.eyes = true,
				.features = true },
	[HID_LAYOUT_GAZE_ONLY] = { .ids = NO_IDS,
				   .time_fields = 1,
				   .time_bits = 32,
				   MICROSECONDS,
				   MICROMETRES,
				   .flags = VARIABLE },
	[HID_LAYOUT_WIDE] = { .time_fields = 1,
			      .time_bits = 64,
			      TENTHS_OF_US,
			      MICROMETRES,
			      .flags = VARIABLE,
			      .eyes = true },
	[HID_LAYOUT_COARSE] = { .ids = ID_42,
				.time_fields = 1,
				.time_bits = 32,
				MILLISECONDS,
				.time_last = true,
				TENTHS_OF_MM,
				.flags = VARIABLE,
				.eyes = true },
	[HID_LAYOUT_POINT] = { .ids = NO_IDS,
			       .length_bits = 32,
			       .length_unit = INCH,
			       .length_exponent = 0x0d,
			       .length_max = 100000,
			       .length_um = 25.4,
			       .flags = VARIABLE },
};

double hid_layout_tick_us(enum hid_layout layout)
{
	return layouts[layout].tick_us;
}

bool hid_layout_has_eyes(enum hid_layout layout)
{
	return layouts[layout].eyes;
}

static uint8_t id_of(const struct layout *layout, int usage)
{
	switch (layout->ids) {
	case IDS_OF_USAGES:
		return (uint8_t)usage;
	case IDS_SHIFTED:
		return (uint8_t)(usage - TRACKING_DATA + 3);
	case ID_42:
		return 0x42;
	default:
		return 0;
	}
}

static void open_report(struct hid_made *made, const struct layout *layout, int usage)
{
	HID_ITEMS(made, HID_USAGE, usage, HID_COLLECTION, LOGICAL);
	if (id_of(layout, usage))
		hid_made_item(made, HID_ID, id_of(layout, usage));
}

static void add_position(struct hid_made *made, const struct layout *layout, int usage, int axes)
{
	HID_ITEMS(made, HID_USAGE, usage, HID_COLLECTION, PHYSICAL, HID_COUNT, axes);
	for (int axis = 0; axis < axes; axis++)
		hid_made_item(made, HID_USAGE, POSITION_X + (uint32_t)axis);
	HID_ITEMS(made, HID_INPUT, layout->flags, HID_END, 0);
}

static void add_positions(struct hid_made *made, const struct layout *layout)
{
	unsigned bytes = (unsigned)layout->length_bits / 8;
	HID_ITEMS(made, HID_SIZE, layout->length_bits, HID_UNIT, layout->length_unit, HID_EXPONENT,
		  layout->length_exponent);
	hid_made_sized(made, HID_LOGICAL_MIN, bytes, (uint32_t)-layout->length_max);
	hid_made_sized(made, HID_LOGICAL_MAX, bytes, (uint32_t)layout->length_max);
	add_position(made, layout, GAZE_POINT, 2);
	if (layout->eyes) {
		add_position(made, layout, LEFT_EYE, 3);
		add_position(made, layout, RIGHT_EYE, 3);
	}
}

static void add_padding(struct hid_made *made, int bytes)
{
	HID_ITEMS(made, HID_SIZE, 8, HID_COUNT, bytes, HID_INPUT, CONSTANT);
}

static void add_time(struct hid_made *made, const struct layout *layout)
{
	if (layout->time_fields == 0)
		return;
	HID_ITEMS(made, HID_LOGICAL_MIN, 0, HID_LOGICAL_MAX, 255, HID_USAGE, TIMESTAMP, HID_UNIT,
		  SECOND, HID_EXPONENT, layout->time_exponent, HID_SIZE, layout->time_bits,
		  HID_COUNT, layout->time_fields, HID_INPUT, VARIABLE);
}

static void add_tracking(struct hid_made *made, const struct layout *layout)
{
	open_report(made, layout, TRACKING_DATA);
	if (layout->padding)
		add_padding(made, layout->padding);
	if (!layout->time_last)
		add_time(made, layout);
	add_positions(made, layout);
	if (layout->time_last)
		add_time(made, layout);
	if (layout->tail)
		add_padding(made, layout->tail);
	hid_made_item(made, HID_END, 0);
}

static void add_capabilities(struct hid_made *made, const struct layout *layout)
{
	open_report(made, layout, CAPABILITIES);
	HID_ITEMS(made, HID_UNIT, NO_UNIT, HID_EXPONENT, 0, HID_LOGICAL_MIN, 0, HID_LOGICAL_MAX, 1,
		  HID_SIZE, 8, HID_COUNT, 1, HID_USAGE, QUALITY, HID_FEATURE, CONSTANT);
	HID_ITEMS(made, HID_COLLECTION, PHYSICAL, HID_UNIT, CENTIMETRE, HID_EXPONENT, 0x0c,
		  HID_SIZE, 32, HID_COUNT, 5);
	hid_made_sized(made, HID_LOGICAL_MIN, 4, (uint32_t)-2000000);
	hid_made_sized(made, HID_LOGICAL_MAX, 4, 2000000);
	for (int usage = DISTANCE_MINIMUM; usage <= BOX_HEIGHT; usage++)
		hid_made_item(made, HID_USAGE, (uint32_t)usage);
	HID_ITEMS(made, HID_FEATURE, CONSTANT, HID_END, 0, HID_END, 0);
}

static void add_configuration(struct hid_made *made, const struct layout *layout)
{
	open_report(made, layout, CONFIGURATION);
	HID_ITEMS(made, HID_UNIT, NO_UNIT, HID_EXPONENT, 0, HID_LOGICAL_MIN, 0);
	hid_made_sized(made, HID_LOGICAL_MAX, 4, 0xffff);
	HID_ITEMS(made, HID_SIZE, 16, HID_COUNT, 1, HID_USAGE, MANUFACTURER_ID, HID_FEATURE,
		  CONSTANT, HID_USAGE, PRODUCT_ID, HID_FEATURE, CONSTANT);
	hid_made_sized(made, HID_LOGICAL_MAX, 4, 0x7fffffff);
	HID_ITEMS(made, HID_SIZE, 32, HID_USAGE, MODEL_YEAR, HID_FEATURE, CONSTANT);
	hid_made_sized(made, HID_LOGICAL_MAX, 4, 0xffff);
	HID_ITEMS(made, HID_SIZE, 16, HID_USAGE, SURFACE_ID, HID_FEATURE, CONSTANT);
	HID_ITEMS(made, HID_COLLECTION, PHYSICAL, HID_UNIT, CENTIMETRE, HID_EXPONENT, 0x0c,
		  HID_SIZE, 32, HID_COUNT, 2);
	hid_made_sized(made, HID_LOGICAL_MAX, 4, 0x7fffffff);
	HID_ITEMS(made, HID_USAGE, SCREEN_WIDTH, HID_USAGE, SCREEN_HEIGHT, HID_FEATURE, CONSTANT,
		  HID_END, 0, HID_END, 0);
}

static void add_status(struct hid_made *made, const struct layout *layout, enum hid_item type)
{
	open_report(made, layout, STATUS);
	HID_ITEMS(made, HID_UNIT, NO_UNIT, HID_EXPONENT, 0, HID_LOGICAL_MIN, 0, HID_LOGICAL_MAX, 4,
		  HID_SIZE, 8, HID_COUNT, 1, HID_USAGE, CONFIGURATION_STATUS, type, VARIABLE);
	hid_made_sized(made, HID_LOGICAL_MAX, 4, 0xffff);
	HID_ITEMS(made, HID_UNIT, HERTZ, HID_SIZE, 16, HID_USAGE, SAMPLING_FREQUENCY, type,
		  VARIABLE, HID_END, 0);
}

static void add_control(struct hid_made *made, const struct layout *layout)
{
	open_report(made, layout, CONTROL);
	HID_ITEMS(made, HID_UNIT, NO_UNIT, HID_EXPONENT, 0, HID_LOGICAL_MIN, 0, HID_LOGICAL_MAX, 7,
		  HID_SIZE, 8, HID_COUNT, 1, HID_USAGE, DEVICE_MODE, HID_FEATURE, VARIABLE, HID_END,
		  0);
}

void hid_made_tracker(struct hid_made *made, enum hid_layout number)
{
	const struct layout *layout = &layouts[number];
	HID_ITEMS(made, HID_PAGE, PAGE, HID_USAGE, EYE_TRACKER, HID_COLLECTION, APPLICATION);
	add_tracking(made, layout);
	if (layout->features) {
		add_capabilities(made, layout);
		add_configuration(made, layout);
		add_status(made, layout, HID_FEATURE);
		add_status(made, layout, HID_INPUT);
		add_control(made, layout);
	}
	hid_made_item(made, HID_END, 0);
}

static unsigned char *put_time(const struct layout *layout, unsigned char *bytes, uint64_t time_us)
{
	size_t size = (size_t)(layout->time_fields * layout->time_bits) / 8;
	uint64_t ticks =
		layout->tick_us < 1 ? time_us * 10 : time_us / (uint64_t)fmax(1, layout->tick_us);
	return frame_put(bytes, size, ticks);
}

static unsigned char *put_lengths(const struct layout *layout, unsigned char *bytes,
				  const int32_t *um, int count)
{
	for (int i = 0; i < count; i++)
		bytes = frame_put(bytes, (size_t)layout->length_bits / 8,
				  (uint64_t)lround(um[i] / layout->length_um));
	return bytes;
}

size_t hid_made_report(enum hid_layout number, const struct hid_made_sample *sample,
		       unsigned char *out_bytes)
{
	const struct layout *layout = &layouts[number];
	unsigned char *at = out_bytes;
	memset(out_bytes, 0, HID_REPORT_MAX);
	if (layout->ids != NO_IDS)
		at = frame_put(at, 1, id_of(layout, TRACKING_DATA));
	memset(at, 0xa5, (size_t)layout->padding); /* must be ignored */
	at += layout->padding;
	if (!layout->time_last)
		at = put_time(layout, at, sample->time_us);
	at = put_lengths(layout, at, sample->gaze, 2);
	if (layout->eyes) {
		at = put_lengths(layout, at, sample->left, 3);
		at = put_lengths(layout, at, sample->right, 3);
	}
	if (layout->time_last)
		at = put_time(layout, at, sample->time_us);
	return (size_t)(at - out_bytes) + (size_t)layout->tail;
}

size_t hid_made_configuration(enum hid_layout number, int32_t width, int32_t height,
			      unsigned char *out_bytes)
{
	const struct layout *layout = &layouts[number];
	if (!layout->features)
		return 0;
	unsigned char *at = frame_put(out_bytes, 1, id_of(layout, CONFIGURATION));
	at = frame_put(at, 8, 0); /* maker, product, model year */
	at = frame_put(at, 2, 0); /* surface */
	at = frame_put(at, 4, (uint32_t)width);
	return (size_t)(frame_put(at, 4, (uint32_t)height) - out_bytes);
}

size_t hid_made_capabilities(enum hid_layout number, int32_t nearest, int32_t optimum,
			     int32_t farthest, unsigned char *out_bytes)
{
	const struct layout *layout = &layouts[number];
	if (!layout->features)
		return 0;
	unsigned char *at = frame_put(out_bytes, 1, id_of(layout, CAPABILITIES));
	at = frame_put(at, 1, 1); /* fine gaze */
	at = frame_put(at, 4, (uint32_t)nearest);
	at = frame_put(at, 4, (uint32_t)optimum);
	at = frame_put(at, 4, (uint32_t)farthest);
	at = frame_put(at, 4, 600000); /* width and height of the box in which eyes are found */
	return (size_t)(frame_put(at, 4, 400000) - out_bytes);
}

size_t hid_made_status(enum hid_layout number, unsigned state, unsigned rate_hz,
		       unsigned char *out_bytes)
{
	const struct layout *layout = &layouts[number];
	if (!layout->features)
		return 0;
	unsigned char *at = frame_put(out_bytes, 1, id_of(layout, STATUS));
	at = frame_put(at, 1, state);
	return (size_t)(frame_put(at, 2, rate_hz) - out_bytes);
}

size_t hid_made_control(enum hid_layout number, unsigned mode, unsigned char *out_bytes)
{
	const struct layout *layout = &layouts[number];
	if (!layout->features)
		return 0;
	unsigned char *at = frame_put(out_bytes, 1, id_of(layout, CONTROL));
	return (size_t)(frame_put(at, 1, mode) - out_bytes);
}
