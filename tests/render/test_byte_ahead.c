/* Bytes that a thread makes ahead of their reader. */
#include "suite.h"

#include <stdlib.h>
#include <string.h>

#include "render/data/byte_stream.h"

#define MIB ((uint64_t)1 << 20)

/* A source of bytes that tell their number; it fails or ends where it is told to. */
struct numbers {
	uint64_t given, end;
	enum gz_result at_end;
};

static uint8_t byte_of(uint64_t number)
{
	return (uint8_t)(number * 2654435761u >> 16);
}

static enum gz_result give(void *user, void *buffer, size_t size, size_t *out_got)
{
	struct numbers *numbers = user;
	uint8_t *out = buffer;
	size_t got = 0;
	for (; got < size && numbers->given < numbers->end; got++)
		out[got] = byte_of(numbers->given++);
	if (got < size && numbers->at_end != GZ_OK)
		return numbers->at_end;
	*out_got = got;
	return GZ_OK;
}

static struct gz_byte_ahead *start(struct numbers *numbers, uint64_t bytes)
{
	struct gz_byte_ahead *ahead = NULL;
	assert_int_equal(gz_byte_ahead_start(give, numbers, bytes, &ahead), GZ_OK);
	return ahead;
}

/* Reads in pieces of odd sizes until less comes; how many there were. */
static uint64_t read_all(struct gz_byte_ahead *ahead)
{
	static uint8_t buffer[100003];
	uint64_t total = 0;
	size_t size = 0, got = 0;
	while (got == size) {
		size = (size * 7 + 1) % sizeof buffer + 1;
		assert_int_equal(gz_byte_ahead_read(ahead, buffer, size, &got), GZ_OK);
		for (size_t i = 0; i < got; i++)
			if (buffer[i] != byte_of(total + i))
				fail_msg("byte %llu is %d, not %d", (unsigned long long)(total + i),
					 buffer[i], byte_of(total + i));
		total += got;
	}
	return total;
}

static void all_bytes_asked_for_come_in_order_and_no_more_is_taken(void **state)
{
	(void)state;
	struct numbers numbers = { .end = 100 * MIB };
	struct gz_byte_ahead *ahead = start(&numbers, 5 * MIB + 17);
	assert_int_equal(read_all(ahead), 5 * MIB + 17);
	gz_byte_ahead_end(&ahead);
	assert_null(ahead);
	assert_int_equal(numbers.given, 5 * MIB + 17);
}

static void source_that_ends_early_ends_the_reading(void **state)
{
	(void)state;
	struct numbers numbers = { .end = 2 * MIB - 3 };
	struct gz_byte_ahead *ahead = start(&numbers, 5 * MIB);
	assert_int_equal(read_all(ahead), 2 * MIB - 3);
	gz_byte_ahead_end(&ahead);
}

static void failure_comes_behind_the_bytes_before_it_and_stays(void **state)
{
	(void)state;
	struct numbers numbers = { .end = 3 * MIB, .at_end = GZ_ERR_FORMAT };
	struct gz_byte_ahead *ahead = start(&numbers, 5 * MIB);
	uint8_t *buffer = malloc(3 * MIB);
	size_t got = 0;
	assert_non_null(buffer);
	assert_int_equal(gz_byte_ahead_read(ahead, buffer, 3 * MIB, &got), GZ_OK);
	assert_int_equal(got, 3 * MIB);
	for (int i = 0; i < 2; i++)
		assert_int_equal(gz_byte_ahead_read(ahead, buffer, 1, &got), GZ_ERR_FORMAT);
	gz_byte_ahead_end(&ahead);
	free(buffer);
}

static void end_in_the_middle_stops_the_thread_within_its_ring(void **state)
{
	(void)state;
	uint8_t byte;
	size_t got = 0;
	struct numbers numbers = { .end = UINT64_MAX };
	struct gz_byte_ahead *ahead = start(&numbers, UINT64_MAX);
	assert_int_equal(gz_byte_ahead_read(ahead, &byte, 1, &got), GZ_OK);
	gz_byte_ahead_end(&ahead);
	assert_in_range(numbers.given, 1, MIB);
	gz_byte_ahead_end(&ahead);
}

TEST_SUITE(byte_ahead)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(all_bytes_asked_for_come_in_order_and_no_more_is_taken),
		cmocka_unit_test(source_that_ends_early_ends_the_reading),
		cmocka_unit_test(failure_comes_behind_the_bytes_before_it_and_stays),
		cmocka_unit_test(end_in_the_middle_stops_the_thread_within_its_ring),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
