#include "suite.h"

#include <pthread.h>
#include <sched.h>
#include <string.h>

#include "daemon/recorder.h"

static struct gz_gaze_log_record sample(uint64_t seq)
{
	struct gz_gaze_log_record record = { .kind = GZ_GAZE_LOG_SAMPLE };
	record.sample = gz_sample_unmeasured();
	record.sample.seq = seq;
	return record;
}

static void ring_gives_records_in_order_and_refuses_when_full(void **state)
{
	(void)state;
	struct gz_ring *ring = NULL;
	struct gz_gaze_log_record mark = { .kind = GZ_GAZE_LOG_MARK, .text = "here" };
	assert_int_equal(gz_ring_create(4, &ring), GZ_OK);
	assert_null(gz_ring_front(ring));
	for (int round = 0; round < 5; round++) {
		for (uint64_t i = 0; i < 3; i++) {
			struct gz_gaze_log_record record = sample(i);
			assert_int_equal(gz_ring_room(ring), 4 - i);
			assert_true(gz_ring_push(ring, (uint32_t)round, &record));
		}
		assert_true(gz_ring_push(ring, 9, &mark));
		assert_int_equal(gz_ring_room(ring), 0);
		assert_false(gz_ring_push(ring, 9, &mark));
		for (uint64_t i = 0; i < 3; i++) {
			assert_int_equal(gz_ring_front(ring)->session, round);
			assert_int_equal(gz_ring_front(ring)->record.sample.seq, i);
			gz_ring_pop(ring);
		}
		assert_string_equal(gz_ring_front(ring)->record.text, "here");
		gz_ring_pop(ring);
		assert_null(gz_ring_front(ring));
	}
	gz_ring_destroy(&ring);
	assert_null(ring);
	gz_ring_destroy(&ring);
}

static void ring_of_no_power_of_two_is_refused(void **state)
{
	(void)state;
	struct gz_ring *ring = NULL;
	const size_t sizes[] = { 0, 1, 3, 12 };
	for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++)
		assert_int_equal(gz_ring_create(sizes[i], &ring), GZ_ERR_INVAL);
	assert_null(ring);
}

enum { PASSED = 100000 };

static void *push_all(void *user)
{
	struct gz_ring *ring = user;
	for (uint64_t i = 0; i < PASSED; i++) {
		struct gz_gaze_log_record record = sample(i);
		record.sample.host_ns = (int64_t)(3 * i);
		while (!gz_ring_push(ring, (uint32_t)i, &record))
			sched_yield();
	}
	return NULL;
}

static void ring_between_two_threads_loses_and_changes_nothing(void **state)
{
	(void)state;
	struct gz_ring *ring = NULL;
	pthread_t thread;
	assert_int_equal(gz_ring_create(64, &ring), GZ_OK);
	assert_int_equal(pthread_create(&thread, NULL, push_all, ring), 0);
	for (uint64_t i = 0; i < PASSED; i++) {
		const struct gz_ring_slot *slot;
		while (!(slot = gz_ring_front(ring)))
			sched_yield();
		assert_int_equal(slot->session, (uint32_t)i);
		assert_int_equal(slot->record.sample.seq, i);
		assert_int_equal(slot->record.sample.host_ns, 3 * i);
		gz_ring_pop(ring);
	}
	pthread_join(thread, NULL);
	gz_ring_destroy(&ring);
}

TEST_SUITE(ring)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(ring_gives_records_in_order_and_refuses_when_full),
		cmocka_unit_test(ring_of_no_power_of_two_is_refused),
		cmocka_unit_test(ring_between_two_threads_loses_and_changes_nothing),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
