#include "suite.h"

#include <math.h>
#include <string.h>

#include "frame_bytes.h"
#include "psvr2_made.h"

static const struct gz_psvr2_packet made = {
	.device_ns = INT64_C(0x123489abcdef) * 1000,
	.frame = 77,
	.eye = {
		[GZ_EYE_LEFT] = { .ray = { true, true, { -31, -2, -5 }, { 0, -0.6f, 0.8f } },
				  .has_pupil = true, .pupil_mm = 3.5f },
		[GZ_EYE_RIGHT] = { .ray = { .has_origin = true, .origin_mm = { 32, 0, 0 } }, .blink = true },
	},
	.combined = { true, true, { 0, 0, 0 }, { 0, 0, 2 } }, /* not of unit length */
	.has_convergence = true,
	.convergence_mm = 900,
};

static void make_packet(unsigned char bytes[GZ_PSVR2_PACKET_SIZE])
{
	psvr2_made_packet(&made, bytes);
}

/* Some fields at their described offsets, in device axes: x to the left, y up. */
static void psvr2_made_packet_has_the_described_layout(void **state)
{
	(void)state;
	unsigned char bytes[GZ_PSVR2_PACKET_SIZE], expected[4];
	make_packet(bytes);
	assert_memory_equal(bytes, "GS", 2);
	frame_put_f32(expected, 31);
	assert_memory_equal(bytes + 0x60, expected, 4);
	frame_put_f32(expected, 0.6f);
	assert_memory_equal(bytes + 0x74, expected, 4);
	frame_put_f32(expected, 900);
	assert_memory_equal(bytes + 0x144, expected, 4);
}

static void psvr2_packet_is_read_at_the_described_offsets(void **state)
{
	(void)state;
	unsigned char bytes[GZ_PSVR2_PACKET_SIZE];
	struct gz_psvr2_packet packet;
	enum gz_malformed malformed;
	make_packet(bytes);
	assert_int_equal(gz_psvr2_parse(bytes, sizeof bytes, &packet, &malformed), GZ_OK);
	assert_int_equal(packet.device_ns, INT64_C(0x123489abcdef) * 1000);
	assert_int_equal(packet.frame, 77);
	const struct gz_psvr2_eye *left = &packet.eye[GZ_EYE_LEFT];
	const struct gz_psvr2_eye *right = &packet.eye[GZ_EYE_RIGHT];
	assert_true(left->ray.has_origin && left->ray.has_direction && left->has_pupil);
	/* +x right, +y down. */
	assert_float_equal(left->ray.origin_mm[0], -31, 1e-6);
	assert_float_equal(left->ray.origin_mm[1], -2, 1e-6);
	assert_float_equal(left->ray.origin_mm[2], -5, 1e-6);
	assert_float_equal(left->ray.direction[1], -0.6f, 1e-6);
	assert_float_equal(left->ray.direction[2], 0.8f, 1e-6);
	assert_float_equal(left->pupil_mm, 3.5f, 1e-6);
	assert_false(left->blink);
	assert_float_equal(right->ray.origin_mm[0], 32, 1e-6);
	assert_false(right->ray.has_direction || right->has_pupil);
	assert_true(right->blink);
	assert_float_equal(packet.combined.direction[2], 1, 1e-6);
	assert_true(packet.has_convergence);
	assert_float_equal(packet.convergence_mm, 900, 1e-6);
}

static void psvr2_short_form_lacks_only_the_convergence(void **state)
{
	(void)state;
	unsigned char bytes[GZ_PSVR2_PACKET_SIZE];
	struct gz_psvr2_packet packet;
	enum gz_malformed malformed;
	make_packet(bytes);
	assert_int_equal(gz_psvr2_parse(bytes, GZ_PSVR2_PACKET_SIZE_SHORT, &packet, &malformed),
			 GZ_OK);
	assert_int_equal(packet.frame, 77);
	assert_false(packet.has_convergence);
}

static void psvr2_packet_of_any_other_length_is_refused_by_reason(void **state)
{
	(void)state;
	unsigned char bytes[1024] = { 0 };
	make_packet(bytes);
	for (size_t size = 0; size <= sizeof bytes; size++) {
		struct gz_psvr2_packet packet = { .frame = 5 };
		enum gz_malformed malformed = GZ_MALFORMED_COUNT;
		if (size == GZ_PSVR2_PACKET_SIZE || size == GZ_PSVR2_PACKET_SIZE_SHORT)
			continue;
		assert_int_equal(gz_psvr2_parse(bytes, size, &packet, &malformed), GZ_ERR_PROTOCOL);
		assert_int_equal(malformed, size < GZ_PSVR2_PACKET_SIZE ? GZ_MALFORMED_SHORT
									: GZ_MALFORMED_LONG);
		assert_int_equal(packet.frame, 5);
	}
}

static void psvr2_packet_without_magic_or_with_an_impossible_time_is_refused(void **state)
{
	(void)state;
	unsigned char bytes[GZ_PSVR2_PACKET_SIZE];
	struct gz_psvr2_packet packet;
	enum gz_malformed malformed;
	make_packet(bytes);
	bytes[1] = 'T';
	assert_int_equal(gz_psvr2_parse(bytes, sizeof bytes, &packet, &malformed), GZ_ERR_PROTOCOL);
	assert_int_equal(malformed, GZ_MALFORMED_SYNTAX);
	static const uint32_t tops[] = { 0x7fffffff, 0x80000000, 0x00218def, 0xffd00000 };
	for (size_t i = 0; i < sizeof tops / sizeof *tops; i++) {
		make_packet(bytes);
		frame_put(bytes + PSVR2_AT_TIME + 4, 4, tops[i]);
		assert_int_equal(gz_psvr2_parse(bytes, sizeof bytes, &packet, &malformed),
				 GZ_ERR_PROTOCOL);
		assert_int_equal(malformed, GZ_MALFORMED_VALUE);
	}
}

static void psvr2_field_that_is_not_a_number_counts_as_unknown(void **state)
{
	(void)state;
	unsigned char bytes[GZ_PSVR2_PACKET_SIZE];
	struct gz_psvr2_packet packet;
	enum gz_malformed malformed;
	make_packet(bytes);
	frame_put_f32(bytes + PSVR2_AT_LEFT + 8, NAN);
	memset(bytes + PSVR2_AT_LEFT + PSVR2_AT_DIRECTION + 4, 0, 12);
	frame_put_f32(bytes + PSVR2_AT_LEFT + PSVR2_AT_PUPIL + 4, -1);
	frame_put_f32(bytes + PSVR2_AT_COMBINED + PSVR2_AT_DIRECTION + 12, INFINITY);
	frame_put_f32(bytes + PSVR2_AT_CONVERGENCE, NAN);
	assert_int_equal(gz_psvr2_parse(bytes, sizeof bytes, &packet, &malformed), GZ_OK);
	const struct gz_psvr2_eye *left = &packet.eye[GZ_EYE_LEFT];
	assert_false(left->ray.has_origin || left->ray.has_direction || left->has_pupil);
	assert_true(left->ray.origin_mm[0] == 0 && left->ray.direction[2] == 0);
	assert_true(packet.combined.has_origin);
	assert_false(packet.combined.has_direction || packet.has_convergence);
}

static void psvr2_packet_survives_a_round_trip(void **state)
{
	(void)state;
	unsigned char bytes[GZ_PSVR2_PACKET_SIZE], again[GZ_PSVR2_PACKET_SIZE];
	struct gz_psvr2_packet packet, read;
	enum gz_malformed malformed;
	make_packet(bytes);
	assert_int_equal(gz_psvr2_parse(bytes, sizeof bytes, &packet, &malformed), GZ_OK);
	psvr2_made_packet(&packet, again);
	assert_int_equal(gz_psvr2_parse(again, sizeof again, &read, &malformed), GZ_OK);
	assert_int_equal(read.device_ns, packet.device_ns);
	assert_int_equal(read.frame, packet.frame);
	assert_memory_equal(read.eye[0].ray.origin_mm, packet.eye[0].ray.origin_mm, 12);
	assert_memory_equal(read.eye[1].ray.direction, packet.eye[1].ray.direction, 12);
	assert_true(read.eye[GZ_EYE_RIGHT].blink && !read.eye[GZ_EYE_LEFT].blink);
}

static void psvr2_request_has_the_described_layout(void **state)
{
	(void)state;
	static const unsigned char on[] = { 0x0c, 0, 1, 0, 0, 0, 0, 0 };
	static const unsigned char off[] = { 0x0c, 0, 2, 0, 0, 0, 0, 0 };
	unsigned char bytes[GZ_PSVR2_REQUEST_SIZE];
	gz_psvr2_print_request(true, bytes);
	assert_memory_equal(bytes, on, sizeof on);
	gz_psvr2_print_request(false, bytes);
	assert_memory_equal(bytes, off, sizeof off);
}

TEST_SUITE(psvr2_packet)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(psvr2_made_packet_has_the_described_layout),
		cmocka_unit_test(psvr2_packet_is_read_at_the_described_offsets),
		cmocka_unit_test(psvr2_short_form_lacks_only_the_convergence),
		cmocka_unit_test(psvr2_packet_of_any_other_length_is_refused_by_reason),
		cmocka_unit_test(psvr2_packet_without_magic_or_with_an_impossible_time_is_refused),
		cmocka_unit_test(psvr2_field_that_is_not_a_number_counts_as_unknown),
		cmocka_unit_test(psvr2_packet_survives_a_round_trip),
		cmocka_unit_test(psvr2_request_has_the_described_layout),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
