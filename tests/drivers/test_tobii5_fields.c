#include "suite.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/clock.h"
#include "drivers/tobii5/tobii5_fields.h"
#include "tobii5_made.h"

/* Where fields begin in the payload of tobii5_made_gaze(): a prefix, the tag of the row, then
 * columns, of which the first is the time. */
enum { AT_ROW = 2, AT_TIME_COLUMN = 11, AT_TIME_NUMBER = 20, AT_TIME = 29, TIME_SIZE = 13 };

static unsigned char frame[TOBII5_MADE_MAX];
static unsigned char *const payload = frame + TOBII5_MADE_OVERHEAD;

/* @return bytes of the payload */
static size_t make(const struct tobii5_made_gaze *made)
{
	return tobii5_made_gaze(made, frame) - TOBII5_MADE_OVERHEAD;
}

static void expect_malformed(size_t size, enum gz_malformed expected)
{
	struct gz_tobii5_gaze gaze, untouched;
	enum gz_malformed malformed = GZ_MALFORMED_COUNT;
	memset(&gaze, 0x5a, sizeof gaze);
	untouched = gaze;
	/* An exact allocation, so that a sanitizer sees a byte read past the end. */
	unsigned char *bytes = malloc(size ? size : 1);
	memcpy(bytes, payload, size);
	assert_int_equal(gz_tobii5_parse_gaze(bytes, size, &gaze, &malformed), GZ_ERR_PROTOCOL);
	free(bytes);
	assert_string_equal(gz_malformed_name(malformed), gz_malformed_name(expected));
	assert_memory_equal(&gaze, &untouched, sizeof gaze);
}

static struct gz_tobii5_gaze parse(size_t size)
{
	struct gz_tobii5_gaze gaze;
	enum gz_malformed malformed;
	assert_int_equal(gz_tobii5_parse_gaze(payload, size, &gaze, &malformed), GZ_OK);
	return gaze;
}

static void tobii5_gaze_is_read_from_its_columns(void **state)
{
	(void)state;
	struct tobii5_made_gaze made = tobii5_made_looking(2, 0.5, 0.25);
	made.eye[GZ_EYE_LEFT].point[0] = 0.375;
	assert_int_equal(make(&made) + TOBII5_MADE_OVERHEAD, TOBII5_MADE_GAZE_SIZE);
	struct gz_tobii5_gaze gaze = parse(make(&made));
	assert_int_equal(gaze.device_ns, (5000000 + 2 * 30270) * GZ_NS_PER_US);
	assert_true(gaze.has_counter);
	assert_int_equal(gaze.counter, 1008);
	assert_int_equal(gaze.strange, 0);
	/* Not the point that the tracker has smoothed. */
	assert_true(gaze.valid && gaze.point.x == 0.5f && gaze.point.y == 0.25f);
	const struct gz_eye_sample *left = &gaze.eye[GZ_EYE_LEFT];
	const struct gz_eye_sample *right = &gaze.eye[GZ_EYE_RIGHT];
	assert_true(left->valid && left->point.x == 0.375f && left->point.y == 0.25f);
	assert_true(right->valid && right->point.x == 0.5f);
	assert_true(left->pupil_mm == 3.25f && right->pupil_mm == 3.5f);
	assert_true(left->origin_mm[0] == -32 && right->origin_mm[0] == 32);
	assert_true(right->origin_mm[1] == 150 && right->origin_mm[2] == 600);
	/* From (32, 150, 600) to (0, 225, 0). */
	double length = sqrt(32 * 32 + 75 * 75 + 600 * 600);
	assert_float_equal(right->direction[0], -32 / length, 1e-6);
	assert_float_equal(right->direction[1], 75 / length, 1e-6);
	assert_float_equal(right->direction[2], -600 / length, 1e-6);
	assert_true(isnan(left->confidence));
}

static void tobii5_eye_that_is_not_seen_is_not_measured(void **state)
{
	(void)state;
	struct tobii5_made_gaze made = tobii5_made_looking(2, 0.5, 0.25);
	made.eye[GZ_EYE_LEFT].seen = false;
	struct gz_tobii5_gaze gaze = parse(make(&made));
	const struct gz_eye_sample *left = &gaze.eye[GZ_EYE_LEFT];
	assert_true(gaze.valid && gaze.eye[GZ_EYE_RIGHT].valid && !left->valid);
	assert_true(isnan(left->point.x) && isnan(left->pupil_mm) && isnan(left->origin_mm[2]) &&
		    isnan(left->direction[0]));
	made.eye[GZ_EYE_RIGHT].seen = made.known = false;
	gaze = parse(make(&made));
	assert_false(gaze.valid || gaze.eye[GZ_EYE_RIGHT].valid);
	assert_true(isnan(gaze.point.x));
}

/* As it may be of a 4C: then the flags of the points say which eye is seen. */
static void tobii5_eye_without_the_column_that_says_so_is_seen_if_its_point_is_known(void **state)
{
	(void)state;
	struct tobii5_made_gaze made = tobii5_made_looking(2, 0.5, 0.25);
	made.lacks_seen = true;
	made.eye[GZ_EYE_LEFT].seen = false;
	struct gz_tobii5_gaze gaze = parse(make(&made));
	const struct gz_eye_sample *left = &gaze.eye[GZ_EYE_LEFT];
	assert_int_equal(gaze.strange, 0);
	assert_true(gaze.eye[GZ_EYE_RIGHT].valid && gaze.eye[GZ_EYE_RIGHT].origin_mm[0] == 32);
	assert_true(!left->valid && isnan(left->point.x) && isnan(left->origin_mm[2]));
}

static void tobii5_eye_at_the_sensors_is_not_seen(void **state)
{
	(void)state;
	struct tobii5_made_gaze made = tobii5_made_looking(2, 0.5, 0.25);
	memset(made.eye[GZ_EYE_LEFT].origin_mm, 0, sizeof made.eye[GZ_EYE_LEFT].origin_mm);
	struct gz_tobii5_gaze gaze = parse(make(&made));
	assert_true(gaze.eye[GZ_EYE_RIGHT].valid && !gaze.eye[GZ_EYE_LEFT].valid);
	assert_true(isnan(gaze.eye[GZ_EYE_LEFT].pupil_mm));
}

static void tobii5_gaze_that_is_cut_off_is_refused(void **state)
{
	(void)state;
	const struct tobii5_made_gaze made = tobii5_made_looking(2, 0.5, 0.25);
	size_t size = make(&made);
	for (size_t cut = 0; cut < size; cut++)
		expect_malformed(cut, GZ_MALFORMED_SHORT);
}

static void tobii5_gaze_that_is_no_row_of_columns_is_refused(void **state)
{
	(void)state;
	const struct tobii5_made_gaze made = tobii5_made_looking(2, 0.5, 0.25);
	static const struct {
		size_t at;
		unsigned char value;
		enum gz_malformed reason;
	} damages[] = {
		{ AT_ROW, 2, GZ_MALFORMED_SYNTAX },               /* not a tag */
		{ AT_ROW + 4, 8, GZ_MALFORMED_SYNTAX },           /* a tag of eight bytes */
		{ AT_ROW + 8, 0xb9, GZ_MALFORMED_SYNTAX },        /* not a row */
		{ AT_ROW + 6, 41, GZ_MALFORMED_SHORT },           /* a column too many */
		{ AT_TIME_COLUMN, 2, GZ_MALFORMED_SYNTAX },       /* not a column */
		{ AT_TIME_COLUMN + 8, 0, GZ_MALFORMED_SYNTAX },   /* nor this */
		{ AT_TIME_NUMBER, 3, GZ_MALFORMED_SYNTAX },       /* without a number */
		{ AT_TIME + 1, 0x80, GZ_MALFORMED_SHORT },        /* a time of 2 GiB */
		{ AT_TIME + 5, 0x7f, GZ_MALFORMED_VALUE },        /* later than 292 years */
		{ AT_TIME + 5, 0x80, GZ_MALFORMED_VALUE },        /* earlier */
		{ AT_TIME_NUMBER + 8, 0x0f, GZ_MALFORMED_VALUE }, /* no time at all */
	};
	for (size_t i = 0; i < sizeof damages / sizeof *damages; i++) {
		size_t size = make(&made);
		payload[damages[i].at] = damages[i].value;
		expect_malformed(size, damages[i].reason);
	}
	memset(payload, 0xff, 64);
	expect_malformed(64, GZ_MALFORMED_SHORT);
}

static void tobii5_column_that_is_not_described_is_skipped_with_all_its_members(void **state)
{
	(void)state;
	/* A column 0x7f: a struct of a struct of two numbers, and a list of three bytes. */
	static const unsigned char column[] = {
		5, 0, 0, 0, 4,    0,    2, 0x0b, 0xb9, 2, 0, 0, 0,  4, 0, 0, 0, 0x7f, 5, 0, 0,
		0, 4, 0, 2, 0x77, 0x01, 5, 0,    0,    0, 4, 0, 2,  0, 1, 2, 0, 0,    0, 4, 0,
		0, 0, 1, 3, 0,    0,    0, 4,    0,    1, 0, 0, 23, 0, 0, 0, 3, 1,    2, 3,
	};
	const struct tobii5_made_gaze made = tobii5_made_looking(2, 0.5, 0.25);
	size_t size = make(&made);
	memmove(payload + AT_TIME_COLUMN + sizeof column, payload + AT_TIME_COLUMN,
		size - AT_TIME_COLUMN);
	memcpy(payload + AT_TIME_COLUMN, column, sizeof column);
	payload[AT_ROW + 6] = 41;
	struct gz_tobii5_gaze gaze = parse(size + sizeof column);
	assert_int_equal(gaze.strange, 0x7f);
	assert_true(gaze.valid && gaze.point.x == 0.5f);
	/* The same with a number in place of a point. */
	size = make(&made);
	payload[AT_TIME_NUMBER + 8] = 0x14;
	payload[AT_TIME] = 7;
	expect_malformed(size, GZ_MALFORMED_VALUE);
}

static void tobii5_struct_of_structs_without_end_is_cut_off(void **state)
{
	(void)state;
	for (size_t at = AT_TIME; at + 9 <= sizeof frame - TOBII5_MADE_OVERHEAD; at += 9)
		memcpy(payload + at, (const unsigned char[]) { 5, 0, 0, 0, 4, 0x0f, 0xff, 0, 1 },
		       9);
	expect_malformed(AT_TIME + 9 * 200, GZ_MALFORMED_SHORT);
}

static void tobii5_requests_have_the_described_bytes(void **state)
{
	(void)state;
	static const unsigned char hello[] = {
		0, 0, 0, 0,    71, 0, 0, 0, 0, 0, 0, 0x51, 0, 0, 0,    1, 0, 0, 0,    0,
		0, 0, 3, 0xe8, 0,  0, 0, 0, 0, 0, 0, 47,   0, 0, 0x17, 0, 0, 0, 0x28, 0,
		0, 0, 9, 0,    1,  0, 0, 0, 1, 0, 1, 0,    1, 0, 2,    0, 1, 0, 3,    0,
		1, 0, 4, 0,    1,  0, 5, 0, 1, 0, 6, 0,    1, 0, 7,    0, 1, 0, 8,
	};
	static const unsigned char subscribe[] = {
		0, 0, 0, 0, 44, 0,    0, 0,    0, 0, 0, 0x51, 0, 0,  1, 2, 0, 0,
		0, 0, 0, 0, 4,  0xc4, 0, 0,    0, 0, 0, 0,    0, 20, 0, 0, 2, 0,
		0, 0, 4, 0, 0,  5,    0, 0x17, 0, 0, 0, 4,    0, 0,  0, 0,
	};
	static const unsigned char get_area[] = {
		0, 0, 0, 0, 24, 0, 0, 0,    0, 0, 0, 0x51, 0, 0, 0, 3,
		0, 0, 0, 0, 0,  0, 5, 0x96, 0, 0, 0, 0,    0, 0, 0, 0,
	};
	unsigned char bytes[GZ_TOBII5_REQUEST_MAX];
	assert_int_equal(gz_tobii5_print_request(GZ_TOBII5_HELLO, 1, NULL, bytes), sizeof hello);
	assert_memory_equal(bytes, hello, sizeof hello);
	assert_int_equal(gz_tobii5_print_request(GZ_TOBII5_SUBSCRIBE, 0x102, NULL, bytes),
			 sizeof subscribe);
	assert_memory_equal(bytes, subscribe, sizeof subscribe);
	assert_int_equal(gz_tobii5_print_request(GZ_TOBII5_GET_AREA, 3, NULL, bytes),
			 sizeof get_area);
	assert_memory_equal(bytes, get_area, sizeof get_area);
}

static void tobii5_area_is_set_and_read_back(void **state)
{
	(void)state;
	const struct gz_tobii5_screen_params params = { .size_mm = { 500, 300 },
							.offset_mm = { 10, 20, -30 },
							.tilt_deg = 30 };
	const struct gz_tobii5_area area = gz_tobii5_area_make(&params);
	struct gz_tobii5_area read;
	struct tobii5_played played = { 0 };
	unsigned char bytes[GZ_TOBII5_REQUEST_MAX], reply[TOBII5_MADE_MAX];
	double size_mm[2];
	/* Its upper edge is further from the user. */
	assert_float_equal(area.corner_mm[GZ_TOBII5_TOP_LEFT][0], -240, 1e-9);
	assert_float_equal(area.corner_mm[GZ_TOBII5_TOP_RIGHT][0], 260, 1e-9);
	assert_float_equal(area.corner_mm[GZ_TOBII5_TOP_LEFT][1], 20 + 300 * cos(M_PI / 6), 1e-9);
	assert_float_equal(area.corner_mm[GZ_TOBII5_TOP_LEFT][2], -180, 1e-9);
	assert_float_equal(area.corner_mm[GZ_TOBII5_BOTTOM_LEFT][2], -30, 1e-9);
	size_t size = gz_tobii5_print_request(GZ_TOBII5_SET_AREA, 1, &area, bytes);
	assert_int_equal(size, GZ_TOBII5_REQUEST_MAX);
	assert_int_equal(tobii5_played_answer(&played, bytes, size, reply), 0);
	size = gz_tobii5_print_request(GZ_TOBII5_GET_AREA, 2, NULL, bytes);
	size = tobii5_played_answer(&played, bytes, size, reply) - TOBII5_MADE_OVERHEAD;
	assert_int_equal(size, 164);
	assert_int_equal(gz_tobii5_parse_area(reply + TOBII5_MADE_OVERHEAD, size, &read), GZ_OK);
	assert_true(gz_tobii5_area_is_near(&area, &read));
	gz_tobii5_area_size(&read, size_mm);
	assert_float_equal(size_mm[0], 500, 1e-6);
	assert_float_equal(size_mm[1], 300, 1e-6);
	assert_true(gz_tobii5_area_is_screen(&read));
	read.corner_mm[GZ_TOBII5_TOP_RIGHT][2] += 1.5;
	assert_false(gz_tobii5_area_is_near(&area, &read));
	for (size_t cut = 0; cut < 2 + 3 * 48; cut++)
		assert_int_equal(gz_tobii5_parse_area(reply + TOBII5_MADE_OVERHEAD, cut, &read),
				 GZ_ERR_PROTOCOL);
	/* What a tracker states after a loss of power. */
	const struct gz_tobii5_area lost = { { { -2, 2, 0 }, { 2, 2, 0 }, { -2, -2, 0 } } };
	assert_false(gz_tobii5_area_is_screen(&lost));
}

TEST_SUITE(tobii5_fields)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(tobii5_gaze_is_read_from_its_columns),
		cmocka_unit_test(tobii5_eye_that_is_not_seen_is_not_measured),
		cmocka_unit_test(
			tobii5_eye_without_the_column_that_says_so_is_seen_if_its_point_is_known),
		cmocka_unit_test(tobii5_eye_at_the_sensors_is_not_seen),
		cmocka_unit_test(tobii5_gaze_that_is_cut_off_is_refused),
		cmocka_unit_test(tobii5_gaze_that_is_no_row_of_columns_is_refused),
		cmocka_unit_test(
			tobii5_column_that_is_not_described_is_skipped_with_all_its_members),
		cmocka_unit_test(tobii5_struct_of_structs_without_end_is_cut_off),
		cmocka_unit_test(tobii5_requests_have_the_described_bytes),
		cmocka_unit_test(tobii5_area_is_set_and_read_back),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
