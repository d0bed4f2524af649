#include "suite.h"

#include <string.h>

#include "drivers/hid/hid_descriptor.h"
#include "hid_made.h"

static struct gz_hid_descriptor descriptor;

static void parse_bytes(const unsigned char *bytes, size_t size)
{
	struct gz_hid_fault fault = { 0 };
	memset(&descriptor, 0x5a, sizeof descriptor);
	if (gz_hid_descriptor_parse(bytes, size, &descriptor, &fault) != GZ_OK)
		fail_msg("refused at byte %zu: %s", fault.at, fault.text);
}

static void parse(const struct hid_made *made)
{
	parse_bytes(made->bytes, made->size);
}

static void expect_fault_bytes(const unsigned char *bytes, size_t size, const char *text)
{
	struct gz_hid_fault fault = { 0, "" };
	enum gz_result result = gz_hid_descriptor_parse(bytes, size, &descriptor, &fault);
	if (result != GZ_ERR_FORMAT || !strstr(fault.text, text) || fault.at > size)
		fail_msg("%s, \"%s\" at %zu of %zu; expected \"%s\"", gz_result_text(result),
			 fault.text, fault.at, size, text);
	assert_int_equal(gz_hid_descriptor_parse(bytes, size, &descriptor, NULL), GZ_ERR_FORMAT);
}

static void expect_fault(const struct hid_made *made, const char *text)
{
	expect_fault_bytes(made->bytes, made->size, text);
}

/* An open application with fields of one byte. */
static struct hid_made begun(void)
{
	struct hid_made made = { 0 };
	HID_ITEMS(&made, HID_PAGE, 0x12, HID_USAGE, 1, HID_COLLECTION, 1, HID_SIZE, 8, HID_COUNT, 1,
		  HID_LOGICAL_MIN, 0, HID_LOGICAL_MAX, 100);
	return made;
}

/* Where a field stands in its report. */
struct field_place {
	uint8_t report_id;
	enum gz_hid_report_type type;
	uint32_t bit_offset, bit_size, count;
};

static void expect_field(size_t index, struct field_place place, uint32_t usage)
{
	const struct gz_hid_field *field = &descriptor.fields[index];
	assert_true(index < descriptor.field_count);
	if (field->report_id != place.report_id || field->type != place.type ||
	    field->bit_offset != place.bit_offset || field->bit_size != place.bit_size ||
	    field->count != place.count || field->usage != usage)
		fail_msg("field %zu: report %u type %d, %u x %u bits at %u, usage %x", index,
			 field->report_id, field->type, field->count, field->bit_size,
			 field->bit_offset, field->usage);
}

static void descriptor_of_a_whole_tracker_becomes_a_table_of_fields(void **state)
{
	(void)state;
	struct hid_made made = { 0 };
	hid_made_tracker(&made, HID_LAYOUT_REFERENCE);
	parse(&made);
	assert_true(descriptor.numbered);
	expect_field(0, (struct field_place) { 0x10, GZ_HID_INPUT, 0, 8, 8 }, GZ_HID_TIMESTAMP);
	assert_int_equal(descriptor.fields[0].unit, 0x1001);
	assert_int_equal(descriptor.fields[0].unit_exponent, -6);
	assert_int_equal(descriptor.fields[0].logical_max, 255);
	expect_field(1, (struct field_place) { 0x10, GZ_HID_INPUT, 64, 32, 1 }, GZ_HID_POSITION_X);
	expect_field(2, (struct field_place) { 0x10, GZ_HID_INPUT, 96, 32, 1 }, GZ_HID_POSITION_Y);
	assert_int_equal(descriptor.fields[1].logical_min, -2000000);
	assert_int_equal(descriptor.fields[1].logical_max, 2000000);
	assert_int_equal(descriptor.fields[1].physical_min, -2000000);
	assert_int_equal(descriptor.fields[1].unit, 0x11);
	assert_int_equal(descriptor.fields[1].unit_exponent, -4);
	assert_true(descriptor.fields[1].flags & GZ_HID_FLAG_CONSTANT);
	assert_true(gz_hid_within(&descriptor, descriptor.fields[1].collection, GZ_HID_GAZE_POINT));
	assert_true(
		gz_hid_within(&descriptor, descriptor.fields[1].collection, GZ_HID_EYE_TRACKER));
	assert_false(gz_hid_within(&descriptor, descriptor.fields[1].collection,
				   GZ_HID_LEFT_EYE_POSITION));
	/* The length of the reports of the reference driver. */
	const struct gz_hid_report *report = &descriptor.reports[0];
	assert_int_equal(report->id, 0x10);
	assert_int_equal(gz_hid_report_bytes(&descriptor, report), 65);
	assert_int_equal(gz_hid_longest_report(&descriptor, GZ_HID_INPUT), 65);
	assert_int_equal(gz_hid_longest_report(&descriptor, GZ_HID_OUTPUT), 0);
}

static void descriptor_padding_takes_bits_but_is_not_a_field(void **state)
{
	(void)state;
	struct hid_made made = { 0 };
	hid_made_tracker(&made, HID_LAYOUT_PADDED);
	parse(&made);
	expect_field(0, (struct field_place) { 0x10, GZ_HID_INPUT, 56, 8, 8 }, GZ_HID_TIMESTAMP);
	expect_field(1, (struct field_place) { 0x10, GZ_HID_INPUT, 120, 32, 1 }, GZ_HID_POSITION_X);
}

static void descriptor_globals_are_pushed_and_popped(void **state)
{
	(void)state;
	struct hid_made made = begun();
	HID_ITEMS(&made, HID_PUSH, 0, HID_SIZE, 16, HID_PAGE, 0x20, HID_USAGE, 5, HID_INPUT, 2,
		  HID_POP, 0, HID_USAGE, 6, HID_INPUT, 2, HID_END, 0);
	parse(&made);
	expect_field(0, (struct field_place) { 0, GZ_HID_INPUT, 0, 16, 1 }, 0x200005);
	expect_field(1, (struct field_place) { 0, GZ_HID_INPUT, 16, 8, 1 }, 0x120006);
	assert_false(descriptor.numbered);
}

static void descriptor_last_usage_names_all_remaining_elements(void **state)
{
	(void)state;
	struct hid_made made = begun();
	HID_ITEMS(&made, HID_COUNT, 5, HID_USAGE, 7, HID_USAGE, 8, HID_INPUT, 2, HID_USAGE, 9,
		  HID_COUNT, 1, HID_USAGE, 10, HID_INPUT, 2, HID_END, 0);
	parse(&made);
	expect_field(0, (struct field_place) { 0, GZ_HID_INPUT, 0, 8, 1 }, 0x120007);
	expect_field(1, (struct field_place) { 0, GZ_HID_INPUT, 8, 8, 4 }, 0x120008);
	/* More usages than elements: the surplus names nothing. */
	expect_field(2, (struct field_place) { 0, GZ_HID_INPUT, 40, 8, 1 }, 0x120009);
	assert_int_equal(descriptor.field_count, 3);
}

static void descriptor_usage_ranges_count_up_and_extended_usages_include_their_page(void **state)
{
	(void)state;
	struct hid_made made = begun();
	HID_ITEMS(&made, HID_COUNT, 5, HID_USAGE_MIN, 0x21, HID_USAGE_MAX, 0x22);
	hid_made_sized(&made, HID_USAGE, 4, 0x00200001);
	hid_made_sized(&made, HID_USAGE_MAX, 2, 8); /* the maximum first, without a page */
	hid_made_sized(&made, HID_USAGE_MIN, 4, 0x00300007);
	HID_ITEMS(&made, HID_INPUT, 2, HID_END, 0);
	parse(&made);
	expect_field(0, (struct field_place) { 0, GZ_HID_INPUT, 0, 8, 2 }, 0x120021);
	assert_int_equal(descriptor.fields[0].usage_last, 0x120022);
	expect_field(1, (struct field_place) { 0, GZ_HID_INPUT, 16, 8, 1 }, 0x200001);
	expect_field(2, (struct field_place) { 0, GZ_HID_INPUT, 24, 8, 2 }, 0x300007);
	assert_int_equal(descriptor.fields[2].usage_last, 0x300008);
}

static void descriptor_page_given_after_the_usage_still_counts(void **state)
{
	(void)state;
	struct hid_made made = begun();
	HID_ITEMS(&made, HID_PAGE, 1, HID_USAGE, 0x20, HID_PAGE, 0x12, HID_INPUT, 2, HID_END, 0);
	parse(&made);
	expect_field(0, (struct field_place) { 0, GZ_HID_INPUT, 0, 8, 1 }, GZ_HID_TIMESTAMP);
}

static void descriptor_alternative_of_our_page_is_preferred(void **state)
{
	(void)state;
	struct hid_made made = begun();
	HID_ITEMS(&made, HID_DELIMITER, 1);
	hid_made_sized(&made, HID_USAGE, 4, 0xff000001);
	hid_made_sized(&made, HID_USAGE, 4, GZ_HID_TIMESTAMP);
	hid_made_sized(&made, HID_USAGE, 4, 0xff000002);
	HID_ITEMS(&made, HID_DELIMITER, 0, HID_INPUT, 2, HID_DELIMITER, 1, HID_PAGE, 9, HID_USAGE,
		  3, HID_USAGE, 4, HID_DELIMITER, 0, HID_USAGE, 5, HID_COUNT, 2, HID_INPUT, 2,
		  HID_END, 0);
	parse(&made);
	expect_field(0, (struct field_place) { 0, GZ_HID_INPUT, 0, 8, 1 }, GZ_HID_TIMESTAMP);
	expect_field(1, (struct field_place) { 0, GZ_HID_INPUT, 8, 8, 1 }, 0x090003);
	expect_field(2, (struct field_place) { 0, GZ_HID_INPUT, 16, 8, 1 }, 0x090005);
}

static void descriptor_limits_are_signed_if_the_minimum_is_negative(void **state)
{
	(void)state;
	static const struct {
		unsigned min_size;
		uint32_t min;
		unsigned max_size;
		uint32_t max;
		int64_t low, high;
	} cases[] = {
		{ 1, 0, 1, 0xff, 0, 255 },
		{ 1, 0x81, 1, 0x7f, -127, 127 },
		{ 1, 0xff, 1, 0xff, -1, -1 },
		{ 0, 0, 2, 0xffff, 0, 65535 },
		{ 2, 0x8000, 2, 0x7fff, -32768, 32767 },
		{ 1, 0, 4, 0xffffffff, 0, 4294967295 },
		{ 4, 0x80000000, 4, 0x7fffffff, INT32_MIN, INT32_MAX },
		{ 1, 0xff, 2, 0x00ff, -1, 255 },
	};
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		struct hid_made made = begun();
		hid_made_sized(&made, HID_LOGICAL_MIN, cases[i].min_size, cases[i].min);
		hid_made_sized(&made, HID_LOGICAL_MAX, cases[i].max_size, cases[i].max);
		hid_made_sized(&made, HID_PHYSICAL_MIN, cases[i].min_size, cases[i].min);
		hid_made_sized(&made, HID_PHYSICAL_MAX, cases[i].max_size, cases[i].max);
		HID_ITEMS(&made, HID_USAGE, 1, HID_INPUT, 2, HID_END, 0);
		parse(&made);
		const struct gz_hid_field *field = &descriptor.fields[0];
		if (field->logical_min != cases[i].low || field->logical_max != cases[i].high ||
		    field->physical_min != cases[i].low || field->physical_max != cases[i].high)
			fail_msg("case %zu: %lld to %lld", i, (long long)field->logical_min,
				 (long long)field->logical_max);
	}
}

static void descriptor_exponent_is_a_signed_nibble_or_byte(void **state)
{
	(void)state;
	static const struct {
		uint32_t data;
		int exponent;
	} cases[] = { { 0, 0 }, { 7, 7 }, { 8, -8 }, { 0xc, -4 }, { 0xf, -1 }, { 0xfc, -4 } };
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		struct hid_made made = begun();
		HID_ITEMS(&made, HID_EXPONENT, cases[i].data, HID_USAGE, 1, HID_INPUT, 2, HID_END,
			  0);
		parse(&made);
		assert_int_equal(descriptor.fields[0].unit_exponent, cases[i].exponent);
	}
}

static void descriptor_reports_of_each_type_and_id_are_separate(void **state)
{
	(void)state;
	struct hid_made made = begun();
	HID_ITEMS(&made, HID_ID, 1, HID_USAGE, 1, HID_INPUT, 2, HID_ID, 2, HID_USAGE, 2, HID_INPUT,
		  2, HID_USAGE, 3, HID_FEATURE, 2, HID_USAGE, 4, HID_OUTPUT, 2, HID_ID, 1,
		  HID_USAGE, 5, HID_INPUT, 2, HID_END, 0);
	parse(&made);
	expect_field(0, (struct field_place) { 1, GZ_HID_INPUT, 0, 8, 1 }, 0x120001);
	expect_field(1, (struct field_place) { 2, GZ_HID_INPUT, 0, 8, 1 }, 0x120002);
	expect_field(2, (struct field_place) { 2, GZ_HID_FEATURE, 0, 8, 1 }, 0x120003);
	expect_field(3, (struct field_place) { 2, GZ_HID_OUTPUT, 0, 8, 1 }, 0x120004);
	expect_field(4, (struct field_place) { 1, GZ_HID_INPUT, 8, 8, 1 }, 0x120005);
	assert_int_equal(descriptor.report_count, 4);
	assert_int_equal(gz_hid_longest_report(&descriptor, GZ_HID_INPUT), 3);
}

static void descriptor_locals_end_with_their_item_and_arrays_are_one_field(void **state)
{
	(void)state;
	struct hid_made made = begun();
	HID_ITEMS(&made, HID_USAGE, 0x20, HID_COLLECTION, 2, HID_INPUT, 2, HID_USAGE_MIN, 1,
		  HID_USAGE_MAX, 100, HID_COUNT, 3, HID_INPUT, 0, HID_END, 0, HID_END, 0);
	parse(&made);
	/* The usage of the collection does not name the byte in it. */
	assert_int_equal(descriptor.field_count, 1);
	expect_field(0, (struct field_place) { 0, GZ_HID_INPUT, 8, 8, 3 }, 0x120001);
	assert_false(descriptor.fields[0].flags & GZ_HID_FLAG_VARIABLE);
	assert_int_equal(descriptor.collections[1].usage, GZ_HID_TIMESTAMP);
	assert_int_equal(descriptor.collections[1].parent, 0);
	assert_int_equal(descriptor.collections[0].parent, GZ_HID_NO_COLLECTION);
}

static void descriptor_long_and_reserved_items_are_ignored(void **state)
{
	(void)state;
	struct hid_made made = begun();
	static const unsigned char long_item[] = { 0xfe, 3, 0x42, 1, 2, 3 };
	memcpy(made.bytes + made.size, long_item, sizeof long_item);
	made.size += sizeof long_item;
	made.bytes[made.size++] = 0xf5; /* global, reserved, one byte */
	made.bytes[made.size++] = 0x00;
	made.bytes[made.size++] = 0xb8; /* local, reserved, none */
	made.bytes[made.size++] = 0x0c; /* an item of the reserved type */
	HID_ITEMS(&made, HID_USAGE, 1, HID_INPUT, 2, HID_COUNT, 0, HID_INPUT, 2, HID_END, 0);
	parse(&made);
	assert_int_equal(descriptor.field_count, 1);
	assert_int_equal(descriptor.reports[0].bits, 8);
}

static void descriptor_that_contradicts_itself_is_refused_with_the_reason(void **state)
{
	(void)state;
	static const struct {
		const char *text;
		int64_t items[16];
	} cases[] = {
		{ "never opened", { HID_END, 0, HID_END, 0, -1 } },
		{ "not closed", { HID_USAGE, 1, -1 } },
		{ "without a push", { HID_POP, 0, -1 } },
		{ "ID outside", { HID_ID, 0, -1 } },
		{ "ID outside", { HID_ID, 256, -1 } },
		{ "unit exponent", { HID_EXPONENT, 256, -1 } },
		{ "page above", { HID_PAGE, 0x10000, -1 } },
		{ "size 0", { HID_SIZE, 0, HID_USAGE, 1, HID_INPUT, 2, -1 } },
		{ "after one without",
		  { HID_USAGE, 1, HID_INPUT, 2, HID_ID, 3, HID_USAGE, 1, HID_INPUT, 2, -1 } },
		{ "above its maximum",
		  { HID_LOGICAL_MIN, 101, HID_USAGE, 1, HID_INPUT, 2, HID_END, 0, -1 } },
		{ "physical minimum",
		  { HID_PHYSICAL_MIN, 3, HID_PHYSICAL_MAX, 2, HID_USAGE, 1, HID_INPUT, 2, -1 } },
		{ "ends before it begins", { HID_USAGE_MIN, 3, HID_USAGE_MAX, 2, -1 } },
		{ "one end", { HID_USAGE_MIN, 3, HID_INPUT, 2, -1 } },
		{ "one end", { HID_USAGE_MAX, 3, HID_COLLECTION, 2, -1 } },
		{ "a page at one end only", { HID_USAGE_MIN, 3, HID_USAGE_MAX, 0x120004, -1 } },
		{ "across pages", { HID_USAGE_MIN, 0x120001, HID_USAGE_MAX, 0x130001, -1 } },
		{ "unpaired", { HID_DELIMITER, 0, -1 } },
		{ "unpaired", { HID_DELIMITER, 1, HID_DELIMITER, 1, -1 } },
		{ "unpaired", { HID_DELIMITER, 2, -1 } },
		{ "not closed", { HID_DELIMITER, 1, HID_USAGE, 1, HID_INPUT, 2, -1 } },
		{ "collection type", { HID_COLLECTION, 256, -1 } },
		{ "16 KiB", { HID_COUNT, 16385, HID_INPUT, 3, -1 } },
		{ "16 KiB", { HID_COUNT, 0xffffffff, HID_SIZE, 0xffffffff, HID_INPUT, 3, -1 } },
		{ "16 KiB",
		  { HID_COUNT, 16384, HID_INPUT, 3, HID_COUNT, 1, HID_INPUT, 3, HID_END, 0, -1 } },
	};
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		struct hid_made made = begun();
		hid_made_items(&made, cases[i].items);
		expect_fault(&made, cases[i].text);
	}
	struct hid_made outside = { 0 };
	HID_ITEMS(&outside, HID_PAGE, 0x12, HID_SIZE, 8, HID_COUNT, 1, HID_INPUT, 2);
	expect_fault(&outside, "outside any collection");
	struct hid_made mixed = begun();
	HID_ITEMS(&mixed, HID_PUSH, 0, HID_ID, 3, HID_USAGE, 1, HID_INPUT, 2, HID_POP, 0, HID_USAGE,
		  1, HID_INPUT, 2, HID_END, 0);
	expect_fault(&mixed, "without an ID after");
}

static void descriptor_limits_of_size_and_number_hold(void **state)
{
	(void)state;
	struct hid_made made = { 0 };
	expect_fault_bytes(made.bytes, 0, "empty");
	expect_fault_bytes(made.bytes, 4097, "longer than 4096");
	for (int i = 0; i < 17; i++)
		hid_made_item(&made, HID_COLLECTION, 2);
	expect_fault(&made, "too deep");
	made = begun();
	for (int i = 0; i < 128; i++)
		HID_ITEMS(&made, HID_COLLECTION, 2, HID_END, 0);
	expect_fault(&made, "too many collections");
	made = begun();
	for (int i = 0; i < 9; i++)
		hid_made_item(&made, HID_PUSH, 0);
	expect_fault(&made, "too many pushed");
	made = begun();
	for (int i = 0; i < 129; i++)
		hid_made_item(&made, HID_USAGE, 1);
	expect_fault(&made, "too many usages");
	made = begun();
	for (int i = 0; i < 65; i++)
		HID_ITEMS(&made, HID_ID, i + 1, HID_INPUT, 3);
	expect_fault(&made, "too many reports");
	made = begun();
	hid_made_item(&made, HID_COUNT, 128);
	for (int i = 0; i < 5; i++) {
		for (int k = 0; k < 128; k++)
			hid_made_item(&made, HID_USAGE, 1);
		hid_made_item(&made, HID_INPUT, 2);
	}
	expect_fault(&made, "too many fields");
}

static void descriptor_cut_anywhere_is_refused(void **state)
{
	(void)state;
	for (int layout = 0; layout < HID_LAYOUT_COUNT; layout++) {
		struct hid_made made = { 0 };
		hid_made_tracker(&made, layout);
		parse(&made);
		/* An incomplete descriptor before its first collection has no error. */
		for (size_t size = 5; size < made.size; size++)
			assert_int_equal(
				gz_hid_descriptor_parse(made.bytes, size, &descriptor, NULL),
				GZ_ERR_FORMAT);
	}
	expect_fault_bytes((const unsigned char[]) { 0xfe }, 1, "within an item");
	expect_fault_bytes((const unsigned char[]) { 0xfe, 2, 0, 1 }, 4, "within an item");
	expect_fault_bytes((const unsigned char[]) { 0x27, 1, 2, 3 }, 4, "within an item");
}

static void descriptor_mentions_a_page_even_if_it_is_malformed(void **state)
{
	(void)state;
	struct hid_made made = { 0 };
	hid_made_tracker(&made, HID_LAYOUT_REFERENCE);
	assert_true(gz_hid_descriptor_mentions(made.bytes, made.size, 0x12));
	assert_true(gz_hid_descriptor_mentions(made.bytes, 5, 0x12));
	assert_false(gz_hid_descriptor_mentions(made.bytes, 1, 0x12));
	assert_false(gz_hid_descriptor_mentions(made.bytes, made.size, 0x20));
	struct hid_made extended = { 0 };
	hid_made_sized(&extended, HID_USAGE, 4, GZ_HID_EYE_TRACKER);
	assert_true(gz_hid_descriptor_mentions(extended.bytes, extended.size, 0x12));
}

TEST_SUITE(hid_descriptor)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(descriptor_of_a_whole_tracker_becomes_a_table_of_fields),
		cmocka_unit_test(descriptor_padding_takes_bits_but_is_not_a_field),
		cmocka_unit_test(descriptor_globals_are_pushed_and_popped),
		cmocka_unit_test(descriptor_last_usage_names_all_remaining_elements),
		cmocka_unit_test(
			descriptor_usage_ranges_count_up_and_extended_usages_include_their_page),
		cmocka_unit_test(descriptor_page_given_after_the_usage_still_counts),
		cmocka_unit_test(descriptor_alternative_of_our_page_is_preferred),
		cmocka_unit_test(descriptor_limits_are_signed_if_the_minimum_is_negative),
		cmocka_unit_test(descriptor_exponent_is_a_signed_nibble_or_byte),
		cmocka_unit_test(descriptor_reports_of_each_type_and_id_are_separate),
		cmocka_unit_test(descriptor_locals_end_with_their_item_and_arrays_are_one_field),
		cmocka_unit_test(descriptor_long_and_reserved_items_are_ignored),
		cmocka_unit_test(descriptor_that_contradicts_itself_is_refused_with_the_reason),
		cmocka_unit_test(descriptor_limits_of_size_and_number_hold),
		cmocka_unit_test(descriptor_cut_anywhere_is_refused),
		cmocka_unit_test(descriptor_mentions_a_page_even_if_it_is_malformed),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
