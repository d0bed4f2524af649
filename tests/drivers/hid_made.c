#include "hid_made.h"

#include <string.h>

#include "drivers/hid/hid_usages.h"

void hid_made_sized(struct hid_made *made, enum hid_item item, unsigned size, uint32_t data)
{
	made->bytes[made->size++] = (unsigned char)((unsigned)item | (size == 4 ? 3 : size));
	for (unsigned i = 0; i < size; i++)
		made->bytes[made->size++] = (unsigned char)(data >> (8 * i));
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

/* Usages of the page, without it. */
#define ID(usage) ((usage)&0xffff)

enum { APPLICATION = 1, LOGICAL = 2, PHYSICAL = 0, CONSTANT = 3, VARIABLE = 2 };

/* SI length: cm; frequency: 1/s; time: s. */
enum { UNIT_CM = 0x11, UNIT_HZ = 0xf001, UNIT_S = 0x1001 };

static bool other_ids(enum hid_layout layout)
{
	return layout == HID_LAYOUT_TIME64;
}

/* Report IDs: those of the usages, or others. */
static uint8_t id_of(enum hid_layout layout, uint32_t usage)
{
	if (layout == HID_LAYOUT_GAZE_ONLY)
		return 0;
	return (uint8_t)(other_ids(layout) ? ID(usage) - 0x10 + 3 : ID(usage));
}

static void open_report(struct hid_made *made, enum hid_layout layout, uint32_t usage)
{
	HID_ITEMS(made, HID_USAGE, ID(usage), HID_COLLECTION, LOGICAL);
	if (id_of(layout, usage))
		hid_made_item(made, HID_ID, id_of(layout, usage));
}

static void add_position(struct hid_made *made, uint32_t usage, int axes, int flags)
{
	HID_ITEMS(made, HID_USAGE, ID(usage), HID_COLLECTION, PHYSICAL, HID_COUNT, axes);
	for (int axis = 0; axis < axes; axis++)
		hid_made_item(made, HID_USAGE, ID(GZ_HID_POSITION_X) + (uint32_t)axis);
	HID_ITEMS(made, HID_INPUT, flags, HID_END, 0);
}

static void add_lengths(struct hid_made *made, enum hid_layout layout)
{
	if (layout == HID_LAYOUT_TIME64) { /* 0.1 mm in 16 bits, +-3 m */
		HID_ITEMS(made, HID_SIZE, 16, HID_UNIT, UNIT_CM, HID_EXPONENT, 0x0e);
		hid_made_sized(made, HID_LOGICAL_MIN, 2, (uint32_t)-30000);
		hid_made_sized(made, HID_LOGICAL_MAX, 2, 30000);
		return;
	}
	HID_ITEMS(made, HID_SIZE, 32, HID_UNIT, UNIT_CM, HID_EXPONENT, 0x0c);
	hid_made_sized(made, HID_LOGICAL_MIN, 4, (uint32_t)-2000000);
	hid_made_sized(made, HID_LOGICAL_MAX, 4, 2000000);
}

static void add_time(struct hid_made *made, enum hid_layout layout)
{
	HID_ITEMS(made, HID_LOGICAL_MIN, 0, HID_LOGICAL_MAX, 255, HID_SIZE, 8);
	if (layout == HID_LAYOUT_PADDED)
		HID_ITEMS(made, HID_COUNT, 7, HID_INPUT, CONSTANT);
	HID_ITEMS(made, HID_USAGE, ID(GZ_HID_TIMESTAMP), HID_UNIT, UNIT_S);
	if (layout == HID_LAYOUT_TIME64)
		HID_ITEMS(made, HID_SIZE, 64, HID_COUNT, 1, HID_EXPONENT, 0x09); /* 1e-7 s */
	else if (layout == HID_LAYOUT_GAZE_ONLY)
		HID_ITEMS(made, HID_SIZE, 32, HID_COUNT, 1, HID_EXPONENT, 0x0a);
	else
		HID_ITEMS(made, HID_COUNT, 8, HID_EXPONENT, 0x0a);
	HID_ITEMS(made, HID_INPUT, VARIABLE);
}

static void add_tracking(struct hid_made *made, enum hid_layout layout)
{
	int flags = layout == HID_LAYOUT_BYTES || layout == HID_LAYOUT_PADDED ? CONSTANT : VARIABLE;
	open_report(made, layout, GZ_HID_TRACKING_DATA);
	if (layout != HID_LAYOUT_TIME64)
		add_time(made, layout);
	add_lengths(made, layout);
	add_position(made, GZ_HID_GAZE_POINT, 2, flags);
	if (layout != HID_LAYOUT_GAZE_ONLY) {
		add_position(made, GZ_HID_LEFT_EYE_POSITION, 3, flags);
		add_position(made, GZ_HID_RIGHT_EYE_POSITION, 3, flags);
	}
	if (layout == HID_LAYOUT_BYTES)
		HID_ITEMS(made, HID_COUNT, 6, HID_INPUT, CONSTANT);
	if (layout == HID_LAYOUT_TIME64)
		add_time(made, layout);
	hid_made_item(made, HID_END, 0);
}

static void add_capabilities(struct hid_made *made, enum hid_layout layout)
{
	open_report(made, layout, GZ_HID_CAPABILITIES);
	HID_ITEMS(made, HID_SIZE, 8, HID_COUNT, 1, HID_UNIT, 0, HID_EXPONENT, 0, HID_LOGICAL_MIN, 0,
		  HID_LOGICAL_MAX, 1, HID_USAGE, ID(GZ_HID_TRACKER_QUALITY), HID_FEATURE, CONSTANT);
	HID_ITEMS(made, HID_SIZE, 32, HID_COUNT, 3, HID_UNIT, UNIT_CM, HID_EXPONENT, 0x0c);
	hid_made_sized(made, HID_LOGICAL_MAX, 4, 2000000);
	HID_ITEMS(made, HID_USAGE, ID(GZ_HID_DISTANCE_MINIMUM), HID_USAGE,
		  ID(GZ_HID_DISTANCE_OPTIMUM), HID_USAGE, ID(GZ_HID_DISTANCE_MAXIMUM), HID_FEATURE,
		  CONSTANT, HID_END, 0);
}

static void add_configuration(struct hid_made *made, enum hid_layout layout)
{
	open_report(made, layout, GZ_HID_CONFIGURATION);
	/* Four numbers of the display that nobody needs: 12 bytes. */
	HID_ITEMS(made, HID_SIZE, 8, HID_COUNT, 12, HID_FEATURE, CONSTANT);
	HID_ITEMS(made, HID_SIZE, 32, HID_COUNT, 1, HID_UNIT, UNIT_CM, HID_EXPONENT, 0x0c,
		  HID_LOGICAL_MIN, 0);
	hid_made_sized(made, HID_LOGICAL_MAX, 4, 0x7fffffff);
	HID_ITEMS(made, HID_USAGE, ID(GZ_HID_SCREEN_WIDTH), HID_FEATURE, CONSTANT, HID_USAGE,
		  ID(GZ_HID_SCREEN_HEIGHT), HID_FEATURE, CONSTANT, HID_END, 0);
}

static void add_status(struct hid_made *made, enum hid_layout layout, enum hid_item type)
{
	open_report(made, layout, GZ_HID_STATUS);
	HID_ITEMS(made, HID_SIZE, 8, HID_COUNT, 1, HID_UNIT, 0, HID_EXPONENT, 0, HID_LOGICAL_MIN, 0,
		  HID_LOGICAL_MAX, 4, HID_USAGE, ID(GZ_HID_CONFIGURATION_STATUS), type, VARIABLE);
	HID_ITEMS(made, HID_SIZE, 16, HID_LOGICAL_MAX, 0xffff, HID_UNIT, UNIT_HZ, HID_USAGE,
		  ID(GZ_HID_SAMPLING_FREQUENCY), type, VARIABLE, HID_END, 0);
}

static void add_control(struct hid_made *made, enum hid_layout layout)
{
	open_report(made, layout, GZ_HID_CONTROL);
	HID_ITEMS(made, HID_SIZE, 8, HID_COUNT, 1, HID_UNIT, 0, HID_EXPONENT, 0, HID_LOGICAL_MIN, 0,
		  HID_LOGICAL_MAX, 7, HID_USAGE, ID(GZ_HID_DEVICE_MODE), HID_FEATURE, VARIABLE,
		  HID_END, 0);
}

void hid_made_tracker(struct hid_made *made, enum hid_layout layout)
{
	HID_ITEMS(made, HID_PAGE, GZ_HID_PAGE_TRACKERS, HID_USAGE, ID(GZ_HID_EYE_TRACKER),
		  HID_COLLECTION, APPLICATION);
	add_tracking(made, layout);
	if (layout != HID_LAYOUT_GAZE_ONLY) {
		add_capabilities(made, layout);
		add_configuration(made, layout);
		add_status(made, layout, HID_FEATURE);
		add_status(made, layout, HID_INPUT);
		add_control(made, layout);
	}
	hid_made_item(made, HID_END, 0);
}

static size_t put(unsigned char *bytes, size_t at, unsigned size, uint64_t value)
{
	for (unsigned i = 0; i < size; i++)
		bytes[at + i] = (unsigned char)(value >> (8 * i));
	return at + size;
}

static size_t put_lengths(enum hid_layout layout, unsigned char *bytes, size_t at,
			  const int32_t *um, int count)
{
	for (int i = 0; i < count; i++)
		at = layout == HID_LAYOUT_TIME64
			     ? put(bytes, at, 2, (uint64_t)(int64_t)(um[i] / 100))
			     : put(bytes, at, 4, (uint64_t)(int64_t)um[i]);
	return at;
}

size_t hid_made_report(enum hid_layout layout, const struct hid_made_sample *sample,
		       unsigned char *out_bytes)
{
	size_t at = 0;
	memset(out_bytes, 0, 128);
	if (layout != HID_LAYOUT_GAZE_ONLY)
		at = put(out_bytes, at, 1, id_of(layout, GZ_HID_TRACKING_DATA));
	if (layout == HID_LAYOUT_PADDED)
		at += 7;
	if (layout != HID_LAYOUT_TIME64)
		at = put(out_bytes, at, layout == HID_LAYOUT_GAZE_ONLY ? 4 : 8, sample->time_us);
	at = put_lengths(layout, out_bytes, at, sample->gaze, 2);
	if (layout != HID_LAYOUT_GAZE_ONLY) {
		at = put_lengths(layout, out_bytes, at, sample->left, 3);
		at = put_lengths(layout, out_bytes, at, sample->right, 3);
	}
	if (layout == HID_LAYOUT_BYTES)
		at += 24;
	if (layout == HID_LAYOUT_TIME64)
		at = put(out_bytes, at, 8, sample->time_us * 10);
	return at;
}

static size_t put_id(enum hid_layout layout, uint32_t usage, unsigned char *bytes)
{
	return put(bytes, 0, 1, id_of(layout, usage));
}

size_t hid_made_configuration(enum hid_layout layout, int32_t width, int32_t height,
			      unsigned char *out_bytes)
{
	if (layout == HID_LAYOUT_GAZE_ONLY)
		return 0;
	size_t at = put_id(layout, GZ_HID_CONFIGURATION, out_bytes);
	at = put(out_bytes, at, 8, 0);
	at = put(out_bytes, at, 4, 0);
	at = put(out_bytes, at, 4, (uint32_t)width);
	return put(out_bytes, at, 4, (uint32_t)height);
}

size_t hid_made_capabilities(enum hid_layout layout, int32_t nearest, int32_t optimum,
			     int32_t farthest, unsigned char *out_bytes)
{
	if (layout == HID_LAYOUT_GAZE_ONLY)
		return 0;
	size_t at = put_id(layout, GZ_HID_CAPABILITIES, out_bytes);
	at = put(out_bytes, at, 1, 1);
	at = put(out_bytes, at, 4, (uint32_t)nearest);
	at = put(out_bytes, at, 4, (uint32_t)optimum);
	return put(out_bytes, at, 4, (uint32_t)farthest);
}

size_t hid_made_status(enum hid_layout layout, unsigned state, unsigned rate_hz,
		       unsigned char *out_bytes)
{
	if (layout == HID_LAYOUT_GAZE_ONLY)
		return 0;
	size_t at = put_id(layout, GZ_HID_STATUS, out_bytes);
	at = put(out_bytes, at, 1, state);
	return put(out_bytes, at, 2, rate_hz);
}

size_t hid_made_control(enum hid_layout layout, unsigned mode, unsigned char *out_bytes)
{
	if (layout == HID_LAYOUT_GAZE_ONLY)
		return 0;
	return put(out_bytes, put_id(layout, GZ_HID_CONTROL, out_bytes), 1, mode);
}
