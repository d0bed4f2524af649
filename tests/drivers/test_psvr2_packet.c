#include "check.h"

#include <math.h>
#include <string.h>

#include "drivers/psvr2/psvr2_packet.h"

static void put_u32(unsigned char *bytes, uint32_t value)
{
	for (int i = 0; i < 4; i++)
		bytes[i] = (unsigned char)(value >> (8 * i));
}

static void put_f32(unsigned char *bytes, float value)
{
	uint32_t bits;
	memcpy(&bits, &value, sizeof bits);
	put_u32(bytes, bits);
}

static void put_vector(unsigned char *bytes, float x, float y, float z)
{
	put_u32(bytes, 1);
	put_f32(bytes + 4, x);
	put_f32(bytes + 8, y);
	put_f32(bytes + 12, z);
}

/* Written by the described offsets, not by the code under test. */
static void make_packet(unsigned char bytes[GZ_PSVR2_PACKET_SIZE])
{
	memset(bytes, 0, GZ_PSVR2_PACKET_SIZE);
	memcpy(bytes, "GS", 2);
	put_u32(bytes + 0x50, 0x89abcdef);
	put_u32(bytes + 0x54, 0x00001234);
	put_u32(bytes + 0x58, 77);
	put_vector(bytes + 0x5c, 31, 2, -5); /* left eye: x grows to the left */
	put_vector(bytes + 0x6c, 0, 0.6f, 0.8f);
	put_u32(bytes + 0x7c, 1);
	put_f32(bytes + 0x80, 3.5f);
	put_vector(bytes + 0xa4, -32, 0, 0); /* right eye, without direction and pupil */
	put_u32(bytes + 0xa4 + 0x40, 1);
	put_u32(bytes + 0xa4 + 0x44, 1);
	put_vector(bytes + 0xec, 0, 0, 0);
	put_vector(bytes + 0xfc, 0, 0, 2); /* not of unit length */
	put_f32(bytes + 0x144, 900);
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
		put_u32(bytes + 0x54, tops[i]);
		assert_int_equal(gz_psvr2_parse(bytes, sizeof bytes, &packet, &malformed),
				 GZ_ERR_PROTOCOL);
		assert_int_equal(malformed, GZ_MALFORMED_VALUE);
	}
}

static void psvr2_field_that_is_no_number_counts_as_unknown(void **state)
{
	(void)state;
	unsigned char bytes[GZ_PSVR2_PACKET_SIZE];
	struct gz_psvr2_packet packet;
	enum gz_malformed malformed;
	make_packet(bytes);
	put_f32(bytes + 0x5c + 8, NAN);
	put_vector(bytes + 0x6c, 0, 0, 0);
	put_f32(bytes + 0x80, -1);
	put_f32(bytes + 0xfc + 12, INFINITY);
	put_f32(bytes + 0x144, NAN);
	assert_int_equal(gz_psvr2_parse(bytes, sizeof bytes, &packet, &malformed), GZ_OK);
	const struct gz_psvr2_eye *left = &packet.eye[GZ_EYE_LEFT];
	assert_false(left->ray.has_origin || left->ray.has_direction || left->has_pupil);
	assert_true(left->ray.origin_mm[0] == 0 && left->ray.direction[2] == 0);
	assert_true(packet.combined.has_origin);
	assert_false(packet.combined.has_direction || packet.has_convergence);
}

static void psvr2_packet_survives_bytes(void **state)
{
	(void)state;
	unsigned char bytes[GZ_PSVR2_PACKET_SIZE], again[GZ_PSVR2_PACKET_SIZE];
	struct gz_psvr2_packet packet, read;
	enum gz_malformed malformed;
	make_packet(bytes);
	assert_int_equal(gz_psvr2_parse(bytes, sizeof bytes, &packet, &malformed), GZ_OK);
	gz_psvr2_print(&packet, again);
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

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(psvr2_packet_is_read_at_the_described_offsets),
		cmocka_unit_test(psvr2_short_form_lacks_only_the_convergence),
		cmocka_unit_test(psvr2_packet_of_any_other_length_is_refused_by_reason),
		cmocka_unit_test(psvr2_packet_without_magic_or_with_an_impossible_time_is_refused),
		cmocka_unit_test(psvr2_field_that_is_no_number_counts_as_unknown),
		cmocka_unit_test(psvr2_packet_survives_bytes),
		cmocka_unit_test(psvr2_request_has_the_described_layout),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
