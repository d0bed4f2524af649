#include "suite.h"

#include "protocol/wire.h"

#include <msgpack.h>
#include <stdlib.h>
#include <string.h>

/* Check bytes in an allocation of exactly their size, so that a sanitizer detects a read past them.
 */
static enum gz_result check(const void *bytes, size_t size)
{
	unsigned char *copy = malloc(size ? size : 1);
	assert_non_null(copy);
	memcpy(copy, bytes, size);
	enum gz_result result = gz_wire_check(copy, size);
	free(copy);
	return result;
}

struct value {
	const char *bytes;
	size_t size;
};

#define VALUE(text)                   \
	{                             \
		text, sizeof text - 1 \
	}

/* One value of each format, with the smallest content that distinguishes it. */
static const struct value each_format[] = {
	VALUE("\x00"),
	VALUE("\x7f"),
	VALUE("\xe0"),
	VALUE("\xff"),
	VALUE("\x80"),
	VALUE("\x81\xa1k\x01"),
	VALUE("\x90"),
	VALUE("\x93\x01\x02\x03"),
	VALUE("\xa0"),
	VALUE("\xa3xyz"),
	VALUE("\xc0"),
	VALUE("\xc2"),
	VALUE("\xc3"),
	VALUE("\xc4\x02xy"),
	VALUE("\xc5\x00\x02xy"),
	VALUE("\xc6\x00\x00\x00\x02xy"),
	VALUE("\xc7\x02\x05xy"),
	VALUE("\xc8\x00\x02\x05xy"),
	VALUE("\xc9\x00\x00\x00\x02\x05xy"),
	VALUE("\xca"
	      "1234"),
	VALUE("\xcb"
	      "12345678"),
	VALUE("\xcc"
	      "1"),
	VALUE("\xcd"
	      "12"),
	VALUE("\xce"
	      "1234"),
	VALUE("\xcf"
	      "12345678"),
	VALUE("\xd0"
	      "1"),
	VALUE("\xd1"
	      "12"),
	VALUE("\xd2"
	      "1234"),
	VALUE("\xd3"
	      "12345678"),
	VALUE("\xd4\x05x"),
	VALUE("\xd5\x05xy"),
	VALUE("\xd6\x05xyzw"),
	VALUE("\xd7\x05xyzwxyzw"),
	VALUE("\xd8\x05xyzwxyzwxyzwxyzw"),
	VALUE("\xd9\x02xy"),
	VALUE("\xda\x00\x02xy"),
	VALUE("\xdb\x00\x00\x00\x02xy"),
	VALUE("\xdc\x00\x02\x01\x02"),
	VALUE("\xdd\x00\x00\x00\x02\x01\x02"),
	VALUE("\xde\x00\x01\xa1k\x01"),
	VALUE("\xdf\x00\x00\x00\x01\xa1k\x01"),
};

static void value_of_each_format_passes_and_msgpack_agrees(void **state)
{
	(void)state;
	for (size_t i = 0; i < sizeof each_format / sizeof *each_format; i++) {
		const struct value *value = &each_format[i];
		if (check(value->bytes, value->size) != GZ_OK)
			fail_msg("format %02x is refused", (unsigned char)value->bytes[0]);
		size_t offset = 0;
		msgpack_unpacked unpacked;
		msgpack_unpacked_init(&unpacked);
		assert_int_equal(msgpack_unpack_next(&unpacked, value->bytes, value->size, &offset),
				 MSGPACK_UNPACK_SUCCESS);
		assert_int_equal(offset, value->size);
		msgpack_unpacked_destroy(&unpacked);
	}
}

static void value_cut_anywhere_is_refused(void **state)
{
	(void)state;
	for (size_t i = 0; i < sizeof each_format / sizeof *each_format; i++)
		for (size_t size = 0; size < each_format[i].size; size++)
			assert_int_equal(check(each_format[i].bytes, size), GZ_ERR_PROTOCOL);
}

static void value_with_a_byte_behind_it_is_refused(void **state)
{
	(void)state;
	for (size_t i = 0; i < sizeof each_format / sizeof *each_format; i++) {
		char bytes[32];
		memcpy(bytes, each_format[i].bytes, each_format[i].size);
		bytes[each_format[i].size] = 0;
		assert_int_equal(check(bytes, each_format[i].size + 1), GZ_ERR_PROTOCOL);
	}
}

static void byte_that_is_never_used_is_refused(void **state)
{
	(void)state;
	assert_int_equal(check("\xc1", 1), GZ_ERR_PROTOCOL);
	assert_int_equal(check("\x91\xc1", 2), GZ_ERR_PROTOCOL);
}

static void count_above_the_bytes_left_is_refused(void **state)
{
	(void)state;
	static const struct value claims[] = {
		VALUE("\xdf\xff\xff\xff\xff\x01\x01"), /* a map of 2^32 - 1 pairs */
		VALUE("\xdf\x80\x00\x00\x00\x01\x01"), /* twice which is 2^32 */
		VALUE("\xdd\xff\xff\xff\xff\x01\x01"),
		VALUE("\xde\xff\xff\x01\x01"),
		VALUE("\xdc\xff\xff\x01\x01"),
		VALUE("\xdb\xff\xff\xff\xff\x01\x01"),
		VALUE("\xc6\xff\xff\xff\xff\x01\x01"),
		VALUE("\xc9\xff\xff\xff\xff\x01\x01"),
		VALUE("\x82\x01\x01\x01"),
		VALUE("\x92\x01"),
		VALUE("\x92\x92\x01\x01"), /* the inner one takes the values that the outer one
					      needs */
	};
	for (size_t i = 0; i < sizeof claims / sizeof *claims; i++) {
		if (check(claims[i].bytes, claims[i].size) != GZ_ERR_PROTOCOL)
			fail_msg("claim %zu passes", i);
		struct gz_gaze gaze;
		struct gz_status status;
		assert_int_equal(gz_wire_decode_gaze(claims[i].bytes, claims[i].size, &gaze),
				 GZ_ERR_PROTOCOL);
		assert_int_equal(gz_wire_decode_status(claims[i].bytes, claims[i].size, &status),
				 GZ_ERR_PROTOCOL);
	}
}

static void nesting_of_eight_passes_and_of_nine_is_refused(void **state)
{
	(void)state;
	static const char eight_arrays[] = "\x91\x91\x91\x91\x91\x91\x91\x91\x01";
	static const char nine_arrays[] = "\x91\x91\x91\x91\x91\x91\x91\x91\x91\x01";
	static const char nine_with_empty[] = "\x91\x91\x91\x91\x91\x91\x91\x91\x90";
	static const char nine_maps[] = "\x81\x01\x81\x01\x81\x01\x81\x01\x81\x01\x81\x01\x81\x01"
					"\x81\x01\x81\x01\x01";
	assert_int_equal(check(eight_arrays, sizeof eight_arrays - 1), GZ_OK);
	assert_int_equal(check(nine_arrays, sizeof nine_arrays - 1), GZ_ERR_PROTOCOL);
	assert_int_equal(check(nine_with_empty, sizeof nine_with_empty - 1), GZ_ERR_PROTOCOL);
	assert_int_equal(check(nine_maps, sizeof nine_maps - 1), GZ_ERR_PROTOCOL);
	assert_int_equal(check(nine_maps + 2, sizeof nine_maps - 3), GZ_OK);
	/* Values side by side are not nested. */
	assert_int_equal(check("\x93\x91\x01\x91\x01\x91\x01", 7), GZ_OK);
}

static void values_of_a_million_in_a_row_pass(void **state)
{
	(void)state;
	enum { COUNT = 1000000 };
	unsigned char *bytes = calloc(COUNT + 5, 1);
	assert_non_null(bytes);
	bytes[0] = 0xdd;
	bytes[1] = COUNT >> 24;
	bytes[2] = (COUNT >> 16) & 0xff;
	bytes[3] = (COUNT >> 8) & 0xff;
	bytes[4] = COUNT & 0xff;
	assert_int_equal(gz_wire_check(bytes, COUNT + 5), GZ_OK);
	assert_int_equal(gz_wire_check(bytes, COUNT + 4), GZ_ERR_PROTOCOL);
	free(bytes);
}

TEST_SUITE(wire_check)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(value_of_each_format_passes_and_msgpack_agrees),
		cmocka_unit_test(value_cut_anywhere_is_refused),
		cmocka_unit_test(value_with_a_byte_behind_it_is_refused),
		cmocka_unit_test(byte_that_is_never_used_is_refused),
		cmocka_unit_test(count_above_the_bytes_left_is_refused),
		cmocka_unit_test(nesting_of_eight_passes_and_of_nine_is_refused),
		cmocka_unit_test(values_of_a_million_in_a_row_pass),
	};
	return cmocka_run_group_tests_name("wire_check", tests, NULL, NULL);
}
