#include "drivers/hid/hid_descriptor.h"

#include <string.h>

/* Item prefixes without their size bits (6.2.2.2, 6.2.2.4, 6.2.2.7, 6.2.2.8). */
enum {
	LONG_ITEM = 0xfe,
	SIZE_BITS = 0x03,
	TYPE_BITS = 0x0c,
	TYPE_MAIN = 0x00,
	TYPE_GLOBAL = 0x04,
	TYPE_LOCAL = 0x08,

	MAIN_INPUT = 0x80,
	MAIN_OUTPUT = 0x90,
	MAIN_COLLECTION = 0xa0,
	MAIN_FEATURE = 0xb0,
	MAIN_END = 0xc0,

	GLOBAL_USAGE_PAGE = 0x04,
	GLOBAL_LOGICAL_MIN = 0x14,
	GLOBAL_LOGICAL_MAX = 0x24,
	GLOBAL_PHYSICAL_MIN = 0x34,
	GLOBAL_PHYSICAL_MAX = 0x44,
	GLOBAL_UNIT_EXPONENT = 0x54,
	GLOBAL_UNIT = 0x64,
	GLOBAL_REPORT_SIZE = 0x74,
	GLOBAL_REPORT_ID = 0x84,
	GLOBAL_REPORT_COUNT = 0x94,
	GLOBAL_PUSH = 0xa4,
	GLOBAL_POP = 0xb4,

	LOCAL_USAGE = 0x08,
	LOCAL_USAGE_MIN = 0x18,
	LOCAL_USAGE_MAX = 0x28,
	LOCAL_DELIMITER = 0xa8,
};

/* One item. */
struct item {
	size_t at;
	unsigned prefix; /* without size bits */
	unsigned size;   /* bytes of data: 0, 1, 2 or 4 */
	uint32_t data;
};

/* A limit as sent. Whether it is signed depends on the other limit. */
struct limit {
	uint32_t data;
	unsigned size;
};

/* The globals of the item state table. */
struct globals {
	uint32_t usage_page;
	struct limit logical_min, logical_max, physical_min, physical_max;
	uint32_t unit;
	int unit_exponent;
	uint32_t report_size, report_count;
	uint8_t report_id;
};

/* A usage, or a range of usages. Its page may become known only at the main item. */
struct usages {
	uint32_t first, last;
	bool extended; /* it includes the page */
};

struct locals {
	size_t count;
	struct usages usages[GZ_HID_USAGES_MAX];
	bool has_min, has_max;
	struct item min, max;
	bool in_set;      /* between delimiters */
	bool set_started; /* the first usage of the set has been read */
};

struct parser {
	struct gz_hid_descriptor *out;
	struct gz_hid_fault fault;
	struct globals globals;
	struct globals pushed[GZ_HID_PUSH_MAX];
	size_t push_count;
	struct locals locals;
	int collection; /* innermost open collection */
	size_t depth;
	bool unnumbered; /* a report without an ID was declared */
};

static bool refuse_descriptor(struct parser *parser, size_t at, const char *text)
{
	parser->fault = (struct gz_hid_fault) { at, text };
	return false;
}

static int64_t sign_extend_item(uint32_t data, unsigned size)
{
	switch (size) {
	case 1:
		return (int8_t)data;
	case 2:
		return (int16_t)data;
	default:
		return (int32_t)data;
	}
}

/* Limits are signed if the minimum is negative; otherwise both are unsigned (5.8: a range of 0 to
 * 255 may be written with one byte each). */
static void resolve_limits(struct limit min, struct limit max, int64_t *out_min, int64_t *out_max)
{
	*out_min = min.size ? sign_extend_item(min.data, min.size) : 0;
	if (*out_min < 0)
		*out_max = max.size ? sign_extend_item(max.data, max.size) : 0;
	else
		*out_max = max.data;
}

/* The exponent is a signed nibble (6.2.2.7); some devices send a signed byte. */
static bool take_unit_exponent(struct parser *parser, const struct item *item)
{
	int64_t exponent = sign_extend_item(item->data, item->size);
	if (item->data <= 0xf)
		exponent = item->data < 8 ? (int64_t)item->data : (int64_t)item->data - 16;
	if (exponent < INT8_MIN || exponent > INT8_MAX)
		return refuse_descriptor(parser, item->at, "a unit exponent outside -128 to 127");
	parser->globals.unit_exponent = (int)exponent;
	return true;
}

static bool push_globals(struct parser *parser, const struct item *item)
{
	if (parser->push_count == GZ_HID_PUSH_MAX)
		return refuse_descriptor(parser, item->at, "too many pushed states");
	parser->pushed[parser->push_count++] = parser->globals;
	return true;
}

static bool pop_globals(struct parser *parser, const struct item *item)
{
	if (parser->push_count == 0)
		return refuse_descriptor(parser, item->at, "a pop without a push");
	parser->globals = parser->pushed[--parser->push_count];
	return true;
}

static bool take_report_id(struct parser *parser, const struct item *item)
{
	if (item->data == 0 || item->data > UINT8_MAX)
		return refuse_descriptor(parser, item->at, "a report ID outside 1 to 255");
	parser->globals.report_id = (uint8_t)item->data;
	return true;
}

static bool take_usage_page(struct parser *parser, const struct item *item)
{
	if (item->data > UINT16_MAX)
		return refuse_descriptor(parser, item->at, "a usage page above 65535");
	parser->globals.usage_page = item->data;
	return true;
}

static bool take_global(struct parser *parser, const struct item *item)
{
	struct globals *globals = &parser->globals;
	struct limit limit = { item->data, item->size };
	switch (item->prefix) {
	case GLOBAL_USAGE_PAGE:
		return take_usage_page(parser, item);
	case GLOBAL_LOGICAL_MIN:
		globals->logical_min = limit;
		return true;
	case GLOBAL_LOGICAL_MAX:
		globals->logical_max = limit;
		return true;
	case GLOBAL_PHYSICAL_MIN:
		globals->physical_min = limit;
		return true;
	case GLOBAL_PHYSICAL_MAX:
		globals->physical_max = limit;
		return true;
	case GLOBAL_UNIT_EXPONENT:
		return take_unit_exponent(parser, item);
	case GLOBAL_UNIT:
		globals->unit = item->data;
		return true;
	case GLOBAL_REPORT_SIZE:
		globals->report_size = item->data;
		return true;
	case GLOBAL_REPORT_COUNT:
		globals->report_count = item->data;
		return true;
	case GLOBAL_REPORT_ID:
		return take_report_id(parser, item);
	case GLOBAL_PUSH:
		return push_globals(parser, item);
	case GLOBAL_POP:
		return pop_globals(parser, item);
	default: /* reserved */
		return true;
	}
}

static bool is_tracker_usage(const struct parser *parser, const struct usages *usages)
{
	uint32_t page = usages->extended ? usages->first >> 16 : parser->globals.usage_page;
	return page == GZ_HID_PAGE_TRACKERS;
}

static bool add_usages(struct parser *parser, size_t at, struct usages usages)
{
	struct locals *locals = &parser->locals;
	if (locals->in_set && locals->set_started) {
		/* An alternative: a usage of our page is preferred, whatever the device prefers. */
		struct usages *first = &locals->usages[locals->count - 1];
		if (is_tracker_usage(parser, &usages) && !is_tracker_usage(parser, first))
			*first = usages;
		return true;
	}
	if (locals->count == GZ_HID_USAGES_MAX)
		return refuse_descriptor(parser, at, "too many usages for one item");
	locals->usages[locals->count++] = usages;
	locals->set_started = true;
	return true;
}

/* A range is complete when both its ends are given, in any order. */
static bool take_range_end(struct parser *parser, const struct item *item)
{
	struct locals *locals = &parser->locals;
	if (item->prefix == LOCAL_USAGE_MIN) {
		locals->min = *item;
		locals->has_min = true;
	} else {
		locals->max = *item;
		locals->has_max = true;
	}
	if (!locals->has_min || !locals->has_max)
		return true;
	locals->has_min = locals->has_max = false;
	struct usages range = { locals->min.data, locals->max.data, locals->min.size == 4 };
	/* An extended minimum gives its page to a maximum without one. */
	if (range.extended && locals->max.size < 4)
		range.last |= range.first & 0xffff0000u;
	else if (!range.extended && locals->max.size == 4)
		return refuse_descriptor(parser, item->at,
					 "a range of usages with a page at one end only");
	if (range.first > range.last)
		return refuse_descriptor(parser, item->at,
					 "a range of usages that ends before it begins");
	if (range.first >> 16 != range.last >> 16)
		return refuse_descriptor(parser, item->at, "a range of usages across pages");
	return add_usages(parser, item->at, range);
}

/* 6.2.2.8: 1 opens a set of alternatives, 0 closes it. */
static bool take_delimiter(struct parser *parser, const struct item *item)
{
	struct locals *locals = &parser->locals;
	bool open = item->data == 1;
	if (item->data > 1 || open == locals->in_set)
		return refuse_descriptor(parser, item->at, "unpaired delimiters");
	locals->in_set = open;
	locals->set_started = false;
	return true;
}

static bool take_local(struct parser *parser, const struct item *item)
{
	switch (item->prefix) {
	case LOCAL_USAGE:
		return add_usages(parser, item->at,
				  (struct usages) { item->data, item->data, item->size == 4 });
	case LOCAL_USAGE_MIN:
	case LOCAL_USAGE_MAX:
		return take_range_end(parser, item);
	case LOCAL_DELIMITER:
		return take_delimiter(parser, item);
	default: /* designators, strings, reserved */
		return true;
	}
}

/* A usage without a page takes the last page given before the main item (6.2.2.8). */
static uint32_t usage_with_page(const struct parser *parser, const struct usages *usages,
				uint32_t usage)
{
	return usages->extended ? usage : parser->globals.usage_page << 16 | (usage & 0xffff);
}

static bool open_collection(struct parser *parser, const struct item *item)
{
	struct gz_hid_descriptor *out = parser->out;
	const struct locals *locals = &parser->locals;
	if (parser->depth == GZ_HID_DEPTH_MAX)
		return refuse_descriptor(parser, item->at, "collections nested too deeply");
	if (out->collection_count == GZ_HID_COLLECTIONS_MAX)
		return refuse_descriptor(parser, item->at, "too many collections");
	if (item->data > UINT8_MAX)
		return refuse_descriptor(parser, item->at, "a collection type above 255");
	out->collections[out->collection_count] = (struct gz_hid_collection) {
		.usage = locals->count
				 ? usage_with_page(parser, locals->usages, locals->usages[0].first)
				 : 0,
		.type = (uint8_t)item->data,
		.parent = parser->collection,
	};
	parser->collection = (int)out->collection_count++;
	parser->depth++;
	return true;
}

static bool close_collection(struct parser *parser, const struct item *item)
{
	if (parser->depth == 0)
		return refuse_descriptor(parser, item->at,
					 "the end of a collection that was never opened");
	parser->collection = parser->out->collections[parser->collection].parent;
	parser->depth--;
	return true;
}

static struct gz_hid_report *find_hid_report(struct gz_hid_descriptor *descriptor,
					     enum gz_hid_report_type type, uint8_t id)
{
	for (size_t i = 0; i < descriptor->report_count; i++) {
		struct gz_hid_report *report = &descriptor->reports[i];
		if (report->type == type && report->id == id)
			return report;
	}
	return NULL;
}

static struct gz_hid_report *find_or_add_report(struct parser *parser, enum gz_hid_report_type type)
{
	struct gz_hid_descriptor *out = parser->out;
	uint8_t id = parser->globals.report_id;
	struct gz_hid_report *report = find_hid_report(out, type, id);
	if (report || out->report_count == GZ_HID_REPORTS_MAX)
		return report;
	report = &out->reports[out->report_count++];
	*report = (struct gz_hid_report) { .type = type, .id = id };
	return report;
}

/* Elements that the i-th of the usages names. The last one names all that are left (6.2.2.8), and
 * each usage of an array names all. */
static uint32_t elements_of_usage(const struct locals *locals, size_t i, uint32_t left)
{
	const struct usages *usages = &locals->usages[i];
	uint32_t named = usages->last - usages->first + 1;
	return i + 1 == locals->count || named > left ? left : named;
}

static bool add_hid_field(struct parser *parser, const struct item *item,
			  const struct gz_hid_field *field)
{
	struct gz_hid_descriptor *out = parser->out;
	if (field->logical_min > field->logical_max)
		return refuse_descriptor(parser, item->at, "a logical minimum above its maximum");
	if (field->physical_min > field->physical_max)
		return refuse_descriptor(parser, item->at, "a physical minimum above its maximum");
	if (out->field_count == GZ_HID_FIELDS_MAX)
		return refuse_descriptor(parser, item->at, "too many fields");
	out->fields[out->field_count++] = *field;
	return true;
}

/* Set what the globals define for every field. */
static struct gz_hid_field field_from_globals(const struct parser *parser)
{
	const struct globals *globals = &parser->globals;
	struct gz_hid_field field = {
		.report_id = globals->report_id,
		.bit_size = globals->report_size,
		.collection = parser->collection,
		.unit = globals->unit,
		.unit_exponent = globals->unit_exponent,
	};
	resolve_limits(globals->logical_min, globals->logical_max, &field.logical_min,
		       &field.logical_max);
	resolve_limits(globals->physical_min, globals->physical_max, &field.physical_min,
		       &field.physical_max);
	/* 6.2.2.7: while both are undefined or 0, the physical limits are the logical ones. */
	if (field.physical_min == 0 && field.physical_max == 0) {
		field.physical_min = field.logical_min;
		field.physical_max = field.logical_max;
	}
	return field;
}

static bool add_hid_fields(struct parser *parser, const struct item *item,
			   enum gz_hid_report_type type, uint32_t bit_offset)
{
	const struct locals *locals = &parser->locals;
	struct gz_hid_field field = field_from_globals(parser);
	uint32_t left = parser->globals.report_count;
	bool array = !(item->data & GZ_HID_FLAG_VARIABLE);
	field.type = type;
	field.flags = item->data;
	field.bit_offset = bit_offset;
	for (size_t i = 0; i < locals->count && left > 0; i++) {
		const struct usages *usages = &locals->usages[i];
		field.usage = usage_with_page(parser, usages, usages->first);
		field.usage_last = usage_with_page(parser, usages, usages->last);
		field.count = array ? left : elements_of_usage(locals, i, left);
		if (!add_hid_field(parser, item, &field))
			return false;
		/* All usages of an array describe the same elements. */
		if (array)
			continue;
		field.bit_offset += field.count * field.bit_size;
		left -= field.count;
	}
	return true;
}

static bool take_data_item(struct parser *parser, const struct item *item,
			   enum gz_hid_report_type type)
{
	const struct globals *globals = &parser->globals;
	if (parser->depth == 0)
		return refuse_descriptor(parser, item->at, "a report outside any collection");
	if (globals->report_count == 0)
		return true;
	if (globals->report_size == 0)
		return refuse_descriptor(parser, item->at, "fields of size 0");
	uint64_t bits = (uint64_t)globals->report_size * globals->report_count;
	if (globals->report_id != 0 && parser->unnumbered)
		return refuse_descriptor(parser, item->at, "a report with an ID after one without");
	parser->unnumbered = globals->report_id == 0;
	if (parser->unnumbered && parser->out->numbered)
		return refuse_descriptor(parser, item->at,
					 "a report without an ID after one with an ID");
	parser->out->numbered = globals->report_id != 0;
	struct gz_hid_report *report = find_or_add_report(parser, type);
	if (!report)
		return refuse_descriptor(parser, item->at, "too many reports");
	if (bits > GZ_HID_REPORT_BITS_MAX - report->bits)
		return refuse_descriptor(parser, item->at, "a report longer than 16 KiB");
	if (!add_hid_fields(parser, item, type, report->bits))
		return false;
	report->bits += (uint32_t)bits;
	return true;
}

static bool take_main_item(struct parser *parser, const struct item *item)
{
	const struct locals *locals = &parser->locals;
	if (locals->in_set)
		return refuse_descriptor(parser, item->at,
					 "a set of alternatives that is not closed");
	if (locals->has_min || locals->has_max)
		return refuse_descriptor(parser, item->at, "a range of usages with one end");
	switch (item->prefix) {
	case MAIN_INPUT:
		return take_data_item(parser, item, GZ_HID_INPUT);
	case MAIN_OUTPUT:
		return take_data_item(parser, item, GZ_HID_OUTPUT);
	case MAIN_FEATURE:
		return take_data_item(parser, item, GZ_HID_FEATURE);
	case MAIN_COLLECTION:
		return open_collection(parser, item);
	case MAIN_END:
		return close_collection(parser, item);
	default: /* reserved */
		return true;
	}
}

static bool take_main(struct parser *parser, const struct item *item)
{
	bool taken = take_main_item(parser, item);
	parser->locals = (struct locals) { 0 };
	return taken;
}

static bool take_item(struct parser *parser, const struct item *item)
{
	switch (item->prefix & TYPE_BITS) {
	case TYPE_MAIN:
		return take_main(parser, item);
	case TYPE_GLOBAL:
		return take_global(parser, item);
	case TYPE_LOCAL:
		return take_local(parser, item);
	default: /* reserved */
		return true;
	}
}

/* Read the item at @p at. @return where the next one begins; 0 if this one is incomplete */
static size_t read_descriptor_item(const unsigned char *bytes, size_t size, size_t at,
				   struct item *out_item)
{
	static const unsigned char sizes[] = { 0, 1, 2, 4 };
	*out_item = (struct item) { .at = at };
	if (bytes[at] == LONG_ITEM) { /* 6.2.2.3: no long item is defined */
		out_item->prefix = LONG_ITEM;
		if (size - at < 3 || size - at - 3 < bytes[at + 1])
			return 0;
		return at + 3 + bytes[at + 1];
	}
	out_item->prefix = bytes[at] & ~(unsigned)SIZE_BITS;
	out_item->size = sizes[bytes[at] & SIZE_BITS];
	if (size - at - 1 < out_item->size)
		return 0;
	for (unsigned i = 0; i < out_item->size; i++)
		out_item->data |= (uint32_t)bytes[at + 1 + i] << (8 * i);
	return at + 1 + out_item->size;
}

static bool parse_descriptor(struct parser *parser, const unsigned char *bytes, size_t size)
{
	if (size == 0)
		return refuse_descriptor(parser, 0, "it is empty");
	if (size > GZ_HID_DESCRIPTOR_SIZE)
		return refuse_descriptor(parser, 0, "it is longer than 4096 bytes");
	for (size_t at = 0; at < size;) {
		struct item item;
		size_t next = read_descriptor_item(bytes, size, at, &item);
		if (next == 0)
			return refuse_descriptor(parser, at, "it ends within an item");
		if (item.prefix != LONG_ITEM && !take_item(parser, &item))
			return false;
		at = next;
	}
	if (parser->depth > 0)
		return refuse_descriptor(parser, size, "a collection is not closed");
	return true;
}

enum gz_result gz_hid_descriptor_parse(const unsigned char *bytes, size_t size,
				       struct gz_hid_descriptor *out_descriptor,
				       struct gz_hid_fault *out_fault)
{
	struct parser parser = { .out = out_descriptor, .collection = GZ_HID_NO_COLLECTION };
	out_descriptor->numbered = false;
	out_descriptor->field_count = 0;
	out_descriptor->collection_count = 0;
	out_descriptor->report_count = 0;
	if (parse_descriptor(&parser, bytes, size))
		return GZ_OK;
	if (out_fault)
		*out_fault = parser.fault;
	return GZ_ERR_FORMAT;
}

bool gz_hid_descriptor_mentions(const unsigned char *bytes, size_t size, uint32_t page)
{
	for (size_t at = 0; at < size;) {
		struct item item;
		size_t next = read_descriptor_item(bytes, size, at, &item);
		if (next == 0)
			return false;
		if ((item.prefix == GLOBAL_USAGE_PAGE && item.data == page) ||
		    (item.prefix == LOCAL_USAGE && item.size == 4 && item.data >> 16 == page))
			return true;
		at = next;
	}
	return false;
}

size_t gz_hid_report_bytes(const struct gz_hid_descriptor *descriptor,
			   const struct gz_hid_report *report)
{
	return (report->bits + 7) / 8 + descriptor->numbered;
}

size_t gz_hid_longest_report(const struct gz_hid_descriptor *descriptor,
			     enum gz_hid_report_type type)
{
	size_t longest = 0;
	for (size_t i = 0; i < descriptor->report_count; i++) {
		const struct gz_hid_report *report = &descriptor->reports[i];
		size_t bytes = gz_hid_report_bytes(descriptor, report);
		if (report->type == type && bytes > longest)
			longest = bytes;
	}
	return longest;
}

bool gz_hid_within(const struct gz_hid_descriptor *descriptor, int collection, uint32_t usage)
{
	while (collection != GZ_HID_NO_COLLECTION) {
		if (descriptor->collections[collection].usage == usage)
			return true;
		collection = descriptor->collections[collection].parent;
	}
	return false;
}
