/* The last second of a gaze. */
#include "suite.h"

#include <math.h>

#include "view/gaze/gaze_trail.h"

#define MS    INT64_C(1000000)
#define APART 0.001f

static struct gz_gaze_reading at(float x, float y)
{
	return (struct gz_gaze_reading) { .known = true, .point = { x, y }, .connected = true };
}

static struct gz_gaze_reading with_event(float x, enum gz_event event)
{
	struct gz_gaze_reading reading = at(x, 0.5f);
	reading.has_event = true;
	reading.event = event;
	return reading;
}

static bool step(struct gz_gaze_trail *trail, struct gz_gaze_reading reading, int64_t now_ns)
{
	return gz_gaze_trail_step(trail, &reading, APART, now_ns);
}

static void resting_mouse_becomes_a_disc_that_stops_growing(void **state)
{
	(void)state;
	struct gz_gaze_trail trail = { 0 };
	assert_true(step(&trail, at(0.5f, 0.5f), 0));
	assert_false(step(&trail, at(0.5f, 0.5f), 50 * MS));
	assert_false(trail.stays[0].fixation);
	assert_true(step(&trail, at(0.5f, 0.5f), 100 * MS));
	assert_true(trail.stays[0].fixation);
	assert_true(step(&trail, at(0.5f, 0.5f), 500 * MS));
	/* Nothing changes: no drawing. */
	assert_false(step(&trail, at(0.5f, 0.5f), 1000 * MS));
	assert_false(step(&trail, at(0.5f, 0.5f), 60000 * MS));
	assert_int_equal(trail.count, 1);
}

static void line_fades_for_a_second_and_is_dropped(void **state)
{
	(void)state;
	struct gz_gaze_trail trail = { 0 };
	for (int i = 0; i < 10; i++)
		assert_true(step(&trail, at(0.1f * (float)i, 0.5f), i * 10 * MS));
	assert_int_equal(trail.count, 10);
	/* It rests at the last one: the others fade. */
	assert_true(step(&trail, at(0.9f, 0.5f), 500 * MS));
	assert_int_equal(trail.count, 10);
	const float strength = gz_gaze_trail_strength(&trail.stays[0], 510 * MS);
	if (fabsf(strength - 0.5f) > 1e-3f)
		fail_msg("strength %g, not 0.5", (double)strength);
	assert_true(step(&trail, at(0.9f, 0.5f), 1095 * MS));
	assert_int_equal(trail.count, 1);
	assert_false(step(&trail, at(0.9f, 0.5f), 3000 * MS));
}

static void fixation_of_a_tracker_is_one_stay_at_its_mean(void **state)
{
	(void)state;
	struct gz_gaze_trail trail = { 0 };
	for (int i = 0; i <= 40; i++)
		step(&trail, with_event(0.5f + (i % 2 ? 0.01f : -0.01f), GZ_EVENT_FIXATION),
		     i * 4 * MS);
	assert_int_equal(trail.count, 1);
	assert_true(trail.stays[0].fixation);
	if (fabsf(trail.stays[0].point.x - 0.5f) > 0.002f)
		fail_msg("mean %g, not 0.5", (double)trail.stays[0].point.x);
	step(&trail, with_event(0.6f, GZ_EVENT_SACCADE), 164 * MS);
	step(&trail, with_event(0.7f, GZ_EVENT_SACCADE), 168 * MS);
	step(&trail, with_event(0.8f, GZ_EVENT_FIXATION), 172 * MS);
	assert_int_equal(trail.count, 4);
	assert_false(trail.stays[1].fixation);
	assert_true(trail.stays[3].fixation);
}

static void closed_and_lost_eyes_leave_no_trail(void **state)
{
	(void)state;
	struct gz_gaze_trail trail = { 0 };
	const struct gz_gaze_reading unknown = { .known = false };
	assert_false(step(&trail, with_event(0.5f, GZ_EVENT_BLINK), 0));
	assert_false(step(&trail, with_event(0.5f, GZ_EVENT_LOST), 10 * MS));
	assert_false(step(&trail, unknown, 20 * MS));
	assert_false(step(&trail, at(NAN, 0.5f), 30 * MS));
	assert_int_equal(trail.count, 0);
	step(&trail, with_event(0.5f, GZ_EVENT_FIXATION), 40 * MS);
	assert_true(step(&trail, with_event(0.5f, GZ_EVENT_LOST), 1100 * MS));
	assert_int_equal(trail.count, 0);
	assert_false(step(&trail, with_event(0.5f, GZ_EVENT_LOST), 1200 * MS));
}

static void full_trail_drops_the_oldest(void **state)
{
	(void)state;
	struct gz_gaze_trail trail = { 0 };
	for (int i = 0; i < 3 * GZ_GAZE_TRAIL_ROOM; i++)
		step(&trail, at(0.002f * (float)i, 0.5f), i * MS / 2);
	assert_int_equal(trail.count, GZ_GAZE_TRAIL_ROOM);
	const float newest = trail.stays[GZ_GAZE_TRAIL_ROOM - 1].point.x;
	if (fabsf(newest - 0.002f * (3 * GZ_GAZE_TRAIL_ROOM - 1)) > 1e-4f)
		fail_msg("newest is %g", (double)newest);
}

TEST_SUITE(gaze_trail)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(resting_mouse_becomes_a_disc_that_stops_growing),
		cmocka_unit_test(line_fades_for_a_second_and_is_dropped),
		cmocka_unit_test(fixation_of_a_tracker_is_one_stay_at_its_mean),
		cmocka_unit_test(closed_and_lost_eyes_leave_no_trail),
		cmocka_unit_test(full_trail_drops_the_oldest),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
