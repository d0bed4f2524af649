#include "suite.h"

#include "protocol/gaze.h"

#include <math.h>
#include <string.h>

/* Check that @p count names exist, differ, and are not the name for unknown values. */
static void check_names(const char *(*name_of)(int), int count)
{
	for (int i = 0; i < count; i++) {
		assert_string_not_equal(name_of(i), "unknown");
		for (int k = 0; k < i; k++)
			assert_string_not_equal(name_of(i), name_of(k));
	}
	assert_string_equal(name_of(count), "unknown");
	assert_string_equal(name_of(-1), "unknown");
}

static const char *event(int i)
{
	return gz_event_name((enum gz_event)i);
}

static const char *rejection(int i)
{
	return gz_rejection_name((enum gz_rejection)i);
}

static const char *tracker_state(int i)
{
	return gz_tracker_state_name((enum gz_tracker_state)i);
}

static const char *recording_state(int i)
{
	return gz_recording_state_name((enum gz_recording_state)i);
}

static const char *clock_tick(int i)
{
	return gz_clock_tick_name((enum gz_clock_tick)i);
}

static void gaze_every_value_has_a_name_of_its_own(void **state)
{
	(void)state;
	check_names(event, GZ_EVENT_COUNT);
	check_names(rejection, GZ_REJECT_COUNT);
	check_names(tracker_state, GZ_TRACKER_STATE_COUNT);
	check_names(recording_state, GZ_RECORDING_STATE_COUNT);
	check_names(clock_tick, GZ_CLOCK_TICK_COUNT);
}

static void sample_unmeasured_holds_no_number(void **state)
{
	(void)state;
	struct gz_sample sample = gz_sample_unmeasured();
	assert_true(isnan(sample.point.x) && isnan(sample.point.y));
	assert_false(sample.valid);
	assert_true(sample.device_ns == GZ_NO_DEVICE_TIME);
	assert_int_equal(sample.host_ns, 0);
	assert_int_equal(sample.seq, 0);
	assert_int_equal(sample.lost_before, 0);
	for (int i = 0; i < GZ_EYE_COUNT; i++) {
		const struct gz_eye_sample *eye = &sample.eye[i];
		assert_false(eye->valid);
		assert_true(isnan(eye->point.x) && isnan(eye->point.y) && isnan(eye->confidence) &&
			    isnan(eye->pupil_mm));
		for (int k = 0; k < 3; k++)
			assert_true(isnan(eye->origin_mm[k]) && isnan(eye->direction[k]));
	}
}

static void sample_with_a_common_point_alone_is_combined_only(void **state)
{
	(void)state;
	struct gz_sample sample = gz_sample_unmeasured();
	assert_false(gz_sample_combined_only(&sample));
	sample.point = (struct gz_point) { 0.5f, 0.5f };
	assert_true(gz_sample_combined_only(&sample));
}

static void sample_with_anything_of_an_eye_is_not_combined_only(void **state)
{
	(void)state;
	for (int i = 0; i < GZ_EYE_COUNT; i++) {
		for (int field = 0; field < 5; field++) {
			struct gz_sample sample = gz_sample_unmeasured();
			struct gz_eye_sample *eye = &sample.eye[i];
			sample.point = (struct gz_point) { 0.5f, 0.5f };
			switch (field) {
			case 0:
				eye->point.x = 0.5f;
				break;
			case 1:
				eye->valid = true;
				break;
			case 2:
				eye->pupil_mm = 3;
				break;
			case 3:
				eye->origin_mm[0] = 0;
				break;
			default:
				eye->direction[0] = 1;
			}
			assert_false(gz_sample_combined_only(&sample));
		}
	}
}

TEST_SUITE(gaze)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(gaze_every_value_has_a_name_of_its_own),
		cmocka_unit_test(sample_unmeasured_holds_no_number),
		cmocka_unit_test(sample_with_a_common_point_alone_is_combined_only),
		cmocka_unit_test(sample_with_anything_of_an_eye_is_not_combined_only),
	};
	return cmocka_run_group_tests_name("gaze", tests, NULL, NULL);
}
