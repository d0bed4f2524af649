#include "suite.h"

#include <stdlib.h>
#include <string.h>

#include "drivers/tobii5/tobii5_frame.h"
#include "frame_bytes.h"
#include "tobii5_made.h"

/* The longest calibration that was reported for this tracker, and that of a related one. */
enum { CALIBRATION_SIZE = 414844, SHORT_CALIBRATION_SIZE = 1480, CALIBRATION = 0x44c };

/* Bytes of a transfer of the link. */
enum { TRANSFER_SIZE = 16384 };

static struct gz_tobii5_reader reader;

static int set_up(void **state)
{
	(void)state;
	reader = (struct gz_tobii5_reader) { 0 };
	return 0;
}

static void take(const unsigned char *bytes, size_t size)
{
	gz_tobii5_reader_take(&reader, bytes, size);
}

static void expect_end(void)
{
	struct gz_tobii5_frame frame;
	enum gz_malformed malformed;
	assert_int_equal(gz_tobii5_reader_next(&reader, &frame, &malformed), GZ_ERR_END);
}

static struct gz_tobii5_frame expect_frame(void)
{
	struct gz_tobii5_frame frame;
	enum gz_malformed malformed;
	assert_int_equal(gz_tobii5_reader_next(&reader, &frame, &malformed), GZ_OK);
	return frame;
}

static void expect_malformed(enum gz_malformed expected)
{
	struct gz_tobii5_frame frame;
	enum gz_malformed malformed = GZ_MALFORMED_COUNT;
	assert_int_equal(gz_tobii5_reader_next(&reader, &frame, &malformed), GZ_ERR_PROTOCOL);
	assert_string_equal(gz_malformed_name(malformed), gz_malformed_name(expected));
}

/* The gaze of sample 7 comes, whole. */
static void expect_gaze_next(void)
{
	unsigned char bytes[TOBII5_MADE_MAX];
	const struct tobii5_made_gaze gaze = tobii5_made_looking(7, 0.5, 0.5);
	size_t size = tobii5_made_gaze(&gaze, bytes);
	take(bytes, size);
	struct gz_tobii5_frame frame = expect_frame();
	assert_int_equal(frame.kind, GZ_TOBII5_NOTIFICATION);
	assert_int_equal(frame.operation, 0x500);
	assert_int_equal(frame.size, size - TOBII5_MADE_OVERHEAD);
	assert_memory_equal(frame.payload, bytes + TOBII5_MADE_OVERHEAD, frame.size);
	expect_end();
}

static void tobii5_frame_is_read_as_described(void **state)
{
	(void)state;
	static const unsigned char bytes[] = {
		1,    0,    0,    0,    36, 0, 0, 0,              /* envelope */
		0,    0,    0,    0x52, 0,  0, 0, 42, 0, 0, 0, 0, /* response 42 */
		0,    0,    3,    0xe8, 0,  0, 0, 0,  0, 0, 0, 4, /* greeting, 4 bytes */
		0xde, 0xad, 0xbe, 0xef,
	};
	take(bytes, sizeof bytes);
	struct gz_tobii5_frame frame = expect_frame();
	assert_int_equal(frame.kind, GZ_TOBII5_RESPONSE);
	assert_int_equal(frame.number, 42);
	assert_int_equal(frame.operation, 0x3e8);
	assert_int_equal(frame.size, 4);
	assert_memory_equal(frame.payload, bytes + 32, 4);
	expect_end();
	take(bytes, 0);
	expect_end();
}

static void tobii5_frames_may_share_a_transfer(void **state)
{
	(void)state;
	unsigned char bytes[3 * TOBII5_MADE_OVERHEAD + 3];
	static const unsigned char payload[] = { 0x22, 0x23 };
	size_t size = tobii5_made_frame(0x52, 1, 0x100, payload, 1, bytes);
	size += tobii5_made_frame(0x53, 2, 0x500, payload, 2, bytes + size);
	size += tobii5_made_frame(0x52, 3, 0x596, NULL, 0, bytes + size);
	take(bytes, size);
	assert_int_equal(expect_frame().size, 1);
	struct gz_tobii5_frame frame = expect_frame();
	assert_int_equal(frame.operation, 0x500);
	assert_memory_equal(frame.payload, payload, 2);
	assert_int_equal(expect_frame().number, 3);
	expect_end();
}

static void tobii5_frame_may_be_split_anywhere(void **state)
{
	(void)state;
	unsigned char bytes[TOBII5_MADE_MAX];
	const struct tobii5_made_gaze gaze = tobii5_made_looking(3, 0.25, 0.75);
	size_t size = tobii5_made_gaze(&gaze, bytes);
	for (size_t split = 1; split < size; split++) {
		/* Exact allocations, so that a sanitizer sees a byte read past the end. */
		unsigned char *first = malloc(split), *second = malloc(size - split);
		memcpy(first, bytes, split);
		memcpy(second, bytes + split, size - split);
		take(first, split);
		expect_end();
		take(second, size - split);
		struct gz_tobii5_frame frame = expect_frame();
		assert_int_equal(frame.size, size - TOBII5_MADE_OVERHEAD);
		assert_memory_equal(frame.payload, bytes + TOBII5_MADE_OVERHEAD, frame.size);
		expect_end();
		free(first);
		free(second);
	}
}

/* As the description has it: 11 bytes with the head, 92 in an envelope of their own, 97 bare. */
static void tobii5_frame_may_continue_with_and_without_an_envelope(void **state)
{
	(void)state;
	unsigned char payload[200], bytes[TOBII5_MADE_OVERHEAD + sizeof payload], second[100];
	for (size_t i = 0; i < sizeof payload; i++)
		payload[i] = (unsigned char)i;
	tobii5_made_frame(0x52, 99, CALIBRATION, payload, sizeof payload, bytes);
	frame_put(bytes + 4, 4, 43);
	take(bytes, 43);
	expect_end();
	frame_put(frame_put(second, 4, 1), 4, sizeof second);
	memcpy(second + 8, payload + 11, 92);
	take(second, sizeof second);
	expect_end();
	take(payload + 103, 97);
	struct gz_tobii5_frame frame = expect_frame();
	assert_int_equal(frame.number, 99);
	assert_int_equal(frame.size, sizeof payload);
	assert_memory_equal(frame.payload, payload, sizeof payload);
	expect_end();
	expect_gaze_next();
}

/* Send a calibration in transfers. Each may have its own envelope, and the first one may announce
 * the whole frame. */
static void send_calibration(uint32_t size, bool own_envelopes, bool announced)
{
	unsigned char *bytes = malloc(TOBII5_MADE_OVERHEAD + size);
	unsigned char *payload = malloc(size);
	unsigned char transfer[TRANSFER_SIZE];
	memset(payload, 0x5a, size);
	size_t total = tobii5_made_frame(0x52, 5, CALIBRATION, payload, size, bytes);
	size_t sent = total < TRANSFER_SIZE ? total : TRANSFER_SIZE;
	if (!announced)
		frame_put(bytes + 4, 4, sent);
	take(bytes, sent);
	while (sent < total) {
		expect_end();
		size_t head = own_envelopes ? 8 : 0, count = TRANSFER_SIZE - head;
		if (count > total - sent)
			count = total - sent;
		frame_put(frame_put(transfer, 4, 1), 4, count + 8);
		memcpy(transfer + head, bytes + sent, count);
		take(transfer, head + count);
		sent += count;
	}
	struct gz_tobii5_frame frame = expect_frame();
	assert_int_equal(frame.operation, CALIBRATION);
	assert_int_equal(frame.size, size);
	size_t kept = size < GZ_TOBII5_PAYLOAD_MAX ? size : GZ_TOBII5_PAYLOAD_MAX;
	assert_memory_equal(frame.payload, payload, kept);
	expect_end();
	free(bytes);
	free(payload);
}

static void tobii5_calibration_of_any_length_passes_and_gaze_goes_on(void **state)
{
	(void)state;
	static const uint32_t sizes[] = { SHORT_CALIBRATION_SIZE, GZ_TOBII5_PAYLOAD_MAX,
					  GZ_TOBII5_PAYLOAD_MAX + 1, CALIBRATION_SIZE,
					  GZ_TOBII5_FRAME_MAX };
	for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++) {
		for (int form = 0; form < 4; form++) {
			send_calibration(sizes[i], form & 1, form & 2);
			expect_gaze_next();
		}
	}
}

static void tobii5_bytes_that_are_no_frame_are_refused_and_the_next_transfer_is_read(void **state)
{
	(void)state;
	static const struct {
		int at;
		unsigned char value;
		enum gz_malformed reason;
	} damages[] = {
		{ 0, 2, GZ_MALFORMED_SYNTAX },     /* direction */
		{ 3, 1, GZ_MALFORMED_SYNTAX },     /* what is 0 */
		{ 4, 7, GZ_MALFORMED_SYNTAX },     /* shorter than itself */
		{ 11, 0x54, GZ_MALFORMED_SYNTAX }, /* kind */
		{ 28, 0x80, GZ_MALFORMED_LONG },   /* 2 GiB */
		{ 29, 0x11, GZ_MALFORMED_LONG },   /* just too long */
	};
	for (size_t i = 0; i < sizeof damages / sizeof *damages; i++) {
		unsigned char bytes[TOBII5_MADE_OVERHEAD + 4];
		static const unsigned char payload[4];
		tobii5_made_frame(0x52, 1, 0x3e8, payload, sizeof payload, bytes);
		bytes[damages[i].at] = damages[i].value;
		take(bytes, sizeof bytes);
		expect_malformed(damages[i].reason);
		expect_end();
		expect_gaze_next();
	}
}

static void tobii5_frame_whose_end_is_lost_gives_way_to_the_next(void **state)
{
	(void)state;
	unsigned char bytes[TOBII5_MADE_MAX], next[TOBII5_MADE_MAX];
	const struct tobii5_made_gaze gaze = tobii5_made_looking(3, 0.25, 0.75);
	size_t size = tobii5_made_gaze(&gaze, bytes);
	static const size_t lengths[] = { 3, 20, 40, 1000 };
	for (size_t i = 0; i < sizeof lengths / sizeof *lengths; i++) {
		take(bytes, lengths[i]);
		expect_end();
		memcpy(next, bytes, size);
		take(next, size);
		expect_malformed(GZ_MALFORMED_SHORT);
		assert_int_equal(expect_frame().size, size - TOBII5_MADE_OVERHEAD);
		expect_end();
	}
}

static void tobii5_envelope_without_end_gives_way_to_the_next(void **state)
{
	(void)state;
	unsigned char bytes[TOBII5_MADE_OVERHEAD + 4];
	static const unsigned char payload[4];
	tobii5_made_frame(0x52, 1, 0x3e8, payload, sizeof payload, bytes);
	frame_put(bytes + 4, 4, UINT32_MAX);
	take(bytes, sizeof bytes);
	assert_int_equal(expect_frame().size, 4);
	expect_end();
	tobii5_made_frame(0x52, 2, 0x3e8, payload, sizeof payload, bytes);
	take(bytes, sizeof bytes);
	expect_malformed(GZ_MALFORMED_SHORT);
	assert_int_equal(expect_frame().number, 2);
	expect_end();
	expect_gaze_next();
}

TEST_SUITE(tobii5_frame)
{
#define TEST(name) cmocka_unit_test_setup(name, set_up)
	const struct CMUnitTest tests[] = {
		TEST(tobii5_frame_is_read_as_described),
		TEST(tobii5_frames_may_share_a_transfer),
		TEST(tobii5_frame_may_be_split_anywhere),
		TEST(tobii5_frame_may_continue_with_and_without_an_envelope),
		TEST(tobii5_calibration_of_any_length_passes_and_gaze_goes_on),
		TEST(tobii5_bytes_that_are_no_frame_are_refused_and_the_next_transfer_is_read),
		TEST(tobii5_envelope_without_end_gives_way_to_the_next),
		TEST(tobii5_frame_whose_end_is_lost_gives_way_to_the_next),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
