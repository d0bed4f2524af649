/* Our packing gives the bytes of msgpack-c, which packs the same values by its own code. */
#include "suite.h"

#include <float.h>
#include <math.h>
#include <msgpack.h>
#include <stdlib.h>
#include <string.h>

#include "protocol/wire_values.h"

static struct gz_wire_message message;
static struct gz_pack ours;
static msgpack_sbuffer buffer;
static msgpack_packer theirs;

static int set_up(void **state)
{
	(void)state;
	gz_pack_begin(&ours, &message);
	msgpack_sbuffer_init(&buffer);
	msgpack_packer_init(&theirs, &buffer, msgpack_sbuffer_write);
	return 0;
}

static int tear_down(void **state)
{
	(void)state;
	msgpack_sbuffer_destroy(&buffer);
	return 0;
}

static void assert_same_bytes(void)
{
	assert_int_equal(gz_pack_end(&ours), GZ_OK);
	assert_int_equal(message.size, buffer.size);
	assert_memory_equal(message.bytes, buffer.data, buffer.size);
}

static void packed_integers_have_the_shortest_form(void **state)
{
	(void)state;
	for (int bit = 0; bit < 63; bit++) {
		for (int64_t step = -1; step <= 1; step++) {
			int64_t value = (INT64_C(1) << bit) + step;
			gz_pack_int(&ours, NULL, value);
			gz_pack_int(&ours, NULL, -value);
			gz_pack_uint(&ours, NULL, (uint64_t)value);
			msgpack_pack_int64(&theirs, value);
			msgpack_pack_int64(&theirs, -value);
			msgpack_pack_uint64(&theirs, (uint64_t)value);
		}
	}
	gz_pack_int(&ours, NULL, INT64_MIN);
	gz_pack_int(&ours, NULL, -33);
	gz_pack_uint(&ours, NULL, UINT64_MAX);
	msgpack_pack_int64(&theirs, INT64_MIN);
	msgpack_pack_int64(&theirs, -33);
	msgpack_pack_uint64(&theirs, UINT64_MAX);
	assert_same_bytes();
}

static void packed_reals_keep_their_type(void **state)
{
	(void)state;
	static const double values[] = { 0, -0.0, 1, -2.5, 1e-3, 1e30, FLT_MIN, DBL_EPSILON };
	for (size_t i = 0; i < sizeof values / sizeof *values; i++) {
		gz_pack_double(&ours, NULL, values[i]);
		gz_pack_float(&ours, NULL, (float)values[i]);
		msgpack_pack_double(&theirs, values[i]);
		msgpack_pack_float(&theirs, (float)values[i]);
	}
	gz_pack_double(&ours, NULL, (double)NAN);
	gz_pack_float(&ours, NULL, -INFINITY);
	gz_pack_bool(&ours, NULL, true);
	gz_pack_bool(&ours, NULL, false);
	msgpack_pack_nil(&theirs);
	msgpack_pack_nil(&theirs);
	msgpack_pack_true(&theirs);
	msgpack_pack_false(&theirs);
	assert_same_bytes();
}

static void packed_texts_and_containers_have_the_shortest_head(void **state)
{
	(void)state;
	static const size_t sizes[] = { 0, 1, 15, 16, 31, 32, 255, 256, 300, 65535, 65536 };
	char text[301];
	for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++) {
		gz_pack_map(&ours, "map", sizes[i]);
		gz_pack_array(&ours, NULL, sizes[i]);
		msgpack_pack_str_with_body(&theirs, "map", 3);
		msgpack_pack_map(&theirs, sizes[i]);
		msgpack_pack_array(&theirs, sizes[i]);
		if (sizes[i] >= sizeof text)
			continue;
		memset(text, 'x', sizes[i]);
		text[sizes[i]] = '\0';
		gz_pack_text(&ours, "text", text);
		msgpack_pack_str_with_body(&theirs, "text", 4);
		msgpack_pack_str_with_body(&theirs, text, sizes[i]);
	}
	assert_same_bytes();
}

/* Whatever comes last in a full message, nothing is written behind its end. */
static void packed_message_that_is_full_is_refused(void **state)
{
	(void)state;
	char text[GZ_WIRE_MESSAGE_SIZE];
	for (size_t free = 0; free <= 16; free++) {
		size_t size = GZ_WIRE_MESSAGE_SIZE - 3 - free;
		memset(text, 'x', size);
		text[size] = '\0';
		gz_pack_begin(&ours, &message);
		gz_pack_text(&ours, NULL, text);
		assert_int_equal(message.size, GZ_WIRE_MESSAGE_SIZE - free);
		gz_pack_double(&ours, "key", 1);
		assert_int_equal(gz_pack_end(&ours), free < 4 + 9 ? GZ_ERR_FULL : GZ_OK);
		assert_int_equal(message.size,
				 free < 4 + 9 ? 0 : GZ_WIRE_MESSAGE_SIZE - free + 4 + 9);
	}
}

#define TEST(function) cmocka_unit_test_setup_teardown(function, set_up, tear_down)

TEST_SUITE(wire_pack)
{
	const struct CMUnitTest tests[] = {
		TEST(packed_integers_have_the_shortest_form),
		TEST(packed_reals_keep_their_type),
		TEST(packed_texts_and_containers_have_the_shortest_head),
		TEST(packed_message_that_is_full_is_refused),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
