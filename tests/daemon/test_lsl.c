/* The outlet to the Lab Streaming Layer, with a fake liblsl. */
#include "suite.h"

#include <dlfcn.h>
#include <math.h>
#include <sched.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/captured_log.h"
#include "base/clock.h"
#include "daemon/lsl/lsl_outlet.h"
#include "drivers/allocations.h"
#include "lsl_stand_in.h"

static struct lsl_stand_in *lsl;
static struct captured_log captured;
static struct gz_lsl_outlet *outlet;

static const struct gz_lsl_device desk = {
	.tracker = "Tracker <X>",
	.serial = "S-1",
	.rate_hz = 500,
	.display = { { 1920, 1080 }, { 520, 290 }, 600 },
};

/* @return the controls of a stand-in, or NULL */
static struct lsl_stand_in *load_stand_in(const char *path)
{
	void *handle = dlopen(path, RTLD_NOW | RTLD_LOCAL);
	void *address = handle ? dlsym(handle, LSL_STAND_IN_CONTROL) : NULL;
	if (!address)
		return NULL;
	lsl_stand_in_control_function *get_control;
	memcpy(&get_control, &address, sizeof get_control);
	return get_control();
}

static int set_up_suite(void **state)
{
	(void)state;
	lsl = load_stand_in(LSL_STAND_IN);
	return lsl ? 0 : -1;
}

static int set_up(void **state)
{
	(void)state;
	lsl->clock_s = 1000;
	lsl->refuse = false;
	lsl->outlet_count = 0;
	atomic_store(&lsl->busy, false);
	atomic_store(&lsl->refuse_push, false);
	atomic_store(&lsl->consumers, 0);
	captured_log_init(&captured, NULL);
	return 0;
}

/* Check that every stream and every description was given back. */
static int tear_down(void **state)
{
	(void)state;
	atomic_store(&lsl->busy, false);
	gz_lsl_outlet_destroy(&outlet);
	gz_lsl_outlet_destroy(&outlet);
	int left = atomic_load(&lsl->descriptions);
	for (int i = 0; i < LSL_STAND_IN_OUTLETS; i++)
		left += lsl->outlets[i].open;
	if (left > 0)
		print_error("%d streams and descriptions are left\n", left);
	return left;
}

static void open_outlet(void)
{
	assert_int_equal(gz_lsl_outlet_create(LSL_STAND_IN, "Desk", &captured.log, &outlet), GZ_OK);
}

static int count_outlets(void)
{
	pthread_mutex_lock(&lsl->mutex);
	int count = lsl->outlet_count;
	pthread_mutex_unlock(&lsl->mutex);
	return count;
}

static int count_pushes(int index)
{
	pthread_mutex_lock(&lsl->mutex);
	int pushes = index < lsl->outlet_count ? lsl->outlets[index].pushes : 0;
	pthread_mutex_unlock(&lsl->mutex);
	return pushes;
}

/* The streams in the order in which they open. */
enum { EVENTS = 0, GAZE = 1 };

static void wait_pushes(int index, int wanted)
{
	const int64_t deadline_ns = gz_clock_now_ns() + PATIENCE_NS;
	while (count_pushes(index) < wanted) {
		if (gz_clock_now_ns() > deadline_ns)
			fail_msg("stream %d has %d samples, waited for %d", index,
				 count_pushes(index), wanted);
		sched_yield();
	}
}

static void wait_lost(uint64_t wanted)
{
	const int64_t deadline_ns = gz_clock_now_ns() + PATIENCE_NS;
	while (gz_lsl_outlet_lost(outlet) < wanted) {
		if (gz_clock_now_ns() > deadline_ns)
			fail_msg("%d are lost, waited for %d", (int)gz_lsl_outlet_lost(outlet),
				 (int)wanted);
		sched_yield();
	}
}

static void wait_outlets(int wanted)
{
	const int64_t deadline_ns = gz_clock_now_ns() + PATIENCE_NS;
	while (count_outlets() < wanted) {
		if (gz_clock_now_ns() > deadline_ns)
			fail_msg("%d streams, waited for %d", count_outlets(), wanted);
		sched_yield();
	}
}

/* A step without events: nothing measured but both eyes' common point. */
static struct gz_pipeline_output step_of(uint64_t seq, int64_t host_ns)
{
	struct gz_pipeline_output step = { 0 };
	struct gz_gaze *gaze = &step.gaze;
	gaze->seq = seq;
	gaze->host_ns = host_ns;
	gaze->point = (struct gz_point) { 0.5f, 0.25f };
	gaze->raw = (struct gz_point) { NAN, NAN };
	gaze->confidence = 0.75f;
	for (int eye = 0; eye < GZ_EYE_COUNT; eye++) {
		gaze->eye[eye] = (struct gz_gaze_eye) { .pupil_mm = NAN };
		for (int i = 0; i < 3; i++)
			gaze->eye[eye].origin_mm[i] = gaze->eye[eye].direction[i] = NAN;
	}
	return step;
}

static void lsl_library_that_cannot_be_used_is_refused_with_a_remedy(void **state)
{
	(void)state;
	assert_int_equal(gz_lsl_outlet_create("/nonexistent.so", "Desk", &captured.log, &outlet),
			 GZ_ERR_NOT_FOUND);
	assert_non_null(strstr(captured.last, "/nonexistent.so"));
	assert_non_null(strstr(captured.last, "install liblsl and set lsl.library"));
	assert_int_equal(gz_lsl_outlet_create("libm.so.6", "Desk", &captured.log, &outlet),
			 GZ_ERR_FORMAT);
	assert_non_null(strstr(captured.last, "libm.so.6 has no function lsl_create_streaminfo"));
	assert_int_equal(captured.messages, 2);
	assert_null(outlet);
}

static void assert_described(const char *description, const char *element)
{
	if (!strstr(description, element))
		fail_msg("%s is not in %s", element, description);
}

static void lsl_gaze_stream_has_the_metadata_of_xdf(void **state)
{
	(void)state;
	open_outlet();
	gz_lsl_outlet_set_device(outlet, &desk);
	wait_outlets(2);
	const struct lsl_stand_in_info *info = &lsl->outlets[GAZE].info;
	assert_string_equal(info->name, "Desk");
	assert_string_equal(info->type, "Gaze");
	assert_int_equal(info->channels, GZ_LSL_CHANNELS);
	assert_int_equal(info->format, 2); /* cft_double64 */
	assert_true(info->rate_hz == 500);
	assert_non_null(strstr(info->source, "Tracker <X>"));
	assert_non_null(strstr(info->source, "S-1"));
	int channels = 0;
	for (const char *c = info->description; (c = strstr(c, "<channel>")); c++)
		channels++;
	assert_int_equal(channels, GZ_LSL_CHANNELS);
	assert_described(info->description,
			 "<channels><channel><label>seq</label><eye>both</eye><type>FrameNumber"
			 "</type><unit>count</unit></channel><channel><label>gaze_x</label>"
			 "<eye>both</eye><type>ScreenX</type><unit>pixels</unit>"
			 "<coordinate_system>image-space</coordinate_system></channel>");
	assert_described(info->description,
			 "<label>right_pupil_diameter</label><eye>right</eye><type>Diameter</type>"
			 "<unit>mm</unit></channel>");
	assert_described(info->description,
			 "<label>left_position_z</label><eye>left</eye><type>PositionZ</type>"
			 "<unit>mm</unit><coordinate_system>object-space</coordinate_system>");
	assert_described(info->description,
			 "</channels><acquisition><model>Tracker <X></model>"
			 "<serial_number>S-1</serial_number></acquisition>"
			 "<setup><display><width_px>1920</width_px><height_px>1080</height_px>"
			 "<width_mm>520</width_mm><height_mm>290</height_mm>"
			 "<distance_mm>600</distance_mm></display></setup>");
	const struct lsl_stand_in_info *events = &lsl->outlets[EVENTS].info;
	assert_string_equal(events->name, "Desk events");
	assert_string_equal(events->type, "Markers");
	assert_int_equal(events->channels, 1);
	assert_int_equal(events->format, 3); /* cft_string */
	assert_true(events->rate_hz == 0);
	assert_string_not_equal(events->source, info->source);
}

static void assert_close(double value, double wanted, double tolerance)
{
	if (!(fabs(value - wanted) <= tolerance))
		fail_msg("%.9f is not %.9f", value, wanted);
}

static void lsl_sample_has_pixels_and_its_own_time_on_lsl_clock(void **state)
{
	(void)state;
	const int64_t taken_ns = gz_clock_now_ns() - 20 * GZ_NS_PER_MS;
	struct gz_pipeline_output step = step_of(77, taken_ns);
	step.gaze.eye[GZ_EYE_LEFT] = (struct gz_gaze_eye) {
		.point = { 1.0f, 0.5f },
		.valid = true,
		.confidence = 1,
		.pupil_mm = 3.5f,
		.origin_mm = { -30, 0, 600 },
		.direction = { 0, 0, -1 },
	};
	step.gaze.eye[GZ_EYE_RIGHT].point = (struct gz_point) { 0.1f, 0.1f }; /* not valid */
	open_outlet();
	gz_lsl_outlet_step(outlet, &step); /* no tracker is known yet: there is no stream */
	gz_lsl_outlet_set_device(outlet, &desk);
	gz_lsl_outlet_step(outlet, &step);
	wait_pushes(GAZE, 1);
	const struct lsl_stand_in_push *push = &lsl->outlets[GAZE].kept[0];
	/* As exact as the clocks can be compared on a machine that does other things. */
	assert_close(push->time_s, gz_ns_to_s(taken_ns) + 1000, 0.005);
	assert_int_equal(push->pushthrough, 1);
	const double *values = push->values;
	const double both[] = { 77, 960, 270 };
	for (int i = 0; i < 3; i++)
		assert_close(values[i], both[i], 1e-4);
	assert_true(isnan(values[3]) && isnan(values[4])); /* raw: the sample was rejected */
	assert_close(values[5], 0.75, 1e-6);
	const double *right = values + 6, *left = values + 16;
	assert_true(isnan(right[0]) && isnan(right[1]) && isnan(right[3]) && isnan(right[4]));
	assert_true(right[2] == 0);
	const double of_left[] = { 1920, 540, 1, 3.5, -30, 0, 600, 0, 0, -1 };
	for (int i = 0; i < 10; i++)
		assert_close(left[i], of_left[i], 1e-4);
	assert_int_equal(gz_lsl_outlet_lost(outlet), 0);
}

static void lsl_events_come_once_with_their_own_times(void **state)
{
	(void)state;
	static const struct {
		double time_s;
		const char *text;
	} wanted[] = {
		{ 1.000, "fixation_onset" },  { 2.5, "trial 7" },
		{ 1.300, "fixation_offset" }, { 1.300, "saccade_onset" },
		{ 1.340, "saccade_offset" },  { 1.340, "fixation_onset" },
		{ 1.500, "blink_onset" },     { 1.500, "fixation_offset" },
		{ 1.700, "blink_offset" },
	};
	const int count = sizeof wanted / sizeof *wanted;
	lsl->clock_s = 0; /* one clock: stamps are exact */
	open_outlet();
	struct gz_pipeline_output step = step_of(1, 1080 * GZ_NS_PER_MS);
	struct gz_fixation *fixation = &step.fixations[0];
	step.fixation_count = 1;
	*fixation = (struct gz_fixation) { .id = 5,
					   .onset_ns = 1000 * GZ_NS_PER_MS,
					   .duration_ns = 80 * GZ_NS_PER_MS };
	gz_lsl_outlet_step(outlet, &step);
	fixation->duration_ns = 120 * GZ_NS_PER_MS; /* it lasts */
	gz_lsl_outlet_step(outlet, &step);
	gz_lsl_outlet_annotate(outlet, 2500 * GZ_NS_PER_MS, "trial 7");
	gz_lsl_outlet_annotate(outlet, 2500 * GZ_NS_PER_MS, "");
	fixation->duration_ns = 300 * GZ_NS_PER_MS;
	fixation->final = true;
	step.saccade_count = 1;
	step.saccades[0] = (struct gz_saccade) { .start_ns = 1300 * GZ_NS_PER_MS,
						 .duration_ns = 40 * GZ_NS_PER_MS };
	gz_lsl_outlet_step(outlet, &step);
	/* A whole fixation in one step, and the beginning of a blink, which is told first. */
	*fixation = (struct gz_fixation) { .id = 9,
					   .onset_ns = 1340 * GZ_NS_PER_MS,
					   .duration_ns = 160 * GZ_NS_PER_MS };
	step.saccade_count = 0;
	gz_lsl_outlet_step(outlet, &step);
	step.fixation_count = 0;
	step.blink_count = 1;
	step.blinks[0] = (struct gz_blink) { .onset = true, .time_ns = 1500 * GZ_NS_PER_MS };
	gz_lsl_outlet_step(outlet, &step);
	fixation->final = true;
	step.fixation_count = 1;
	step.blinks[0] = (struct gz_blink) { .time_ns = 1700 * GZ_NS_PER_MS };
	gz_lsl_outlet_step(outlet, &step);
	wait_pushes(EVENTS, count);
	gz_lsl_outlet_destroy(&outlet);
	assert_int_equal(count_pushes(EVENTS), count);
	for (int i = 0; i < count; i++) {
		const struct lsl_stand_in_push *push = &lsl->outlets[EVENTS].kept[i];
		if (strcmp(push->text, wanted[i].text) != 0 ||
		    fabs(push->time_s - wanted[i].time_s) > 1e-9)
			fail_msg("event %d is %s at %.9f", i, push->text, push->time_s);
	}
}

static void lsl_stream_begins_anew_when_the_tracker_or_its_display_changes(void **state)
{
	(void)state;
	struct gz_pipeline_output step = step_of(1, GZ_NS_PER_S);
	struct gz_lsl_device device = desk;
	open_outlet();
	gz_lsl_outlet_set_device(outlet, &device);
	gz_lsl_outlet_set_device(outlet, &device); /* it came back */
	gz_lsl_outlet_step(outlet, &step);
	wait_pushes(GAZE, 1);
	assert_int_equal(count_outlets(), 2);
	device.display.px[0] = 960;
	gz_lsl_outlet_set_device(outlet, &device);
	gz_lsl_outlet_step(outlet, &step);
	wait_pushes(2, 1);
	assert_false(lsl->outlets[GAZE].open);
	assert_int_equal(count_pushes(GAZE), 1);
	assert_close(lsl->outlets[2].kept[0].values[1], 480, 1e-4);
	snprintf(device.serial, sizeof device.serial, "S-2");
	gz_lsl_outlet_set_device(outlet, &device);
	wait_outlets(4);
	assert_string_not_equal(lsl->outlets[3].info.source, lsl->outlets[2].info.source);
}

static void wait_until_a_push_hangs(void)
{
	const int64_t deadline_ns = gz_clock_now_ns() + PATIENCE_NS;
	while (atomic_load(&lsl->pushing) == 0) {
		assert_true(gz_clock_now_ns() < deadline_ns);
		sched_yield();
	}
}

static void lsl_library_that_hangs_delays_no_sample_and_losses_are_counted(void **state)
{
	(void)state;
	enum { EXTRA = 100 };
	struct gz_lsl_device device = desk;
	open_outlet();
	gz_lsl_outlet_set_device(outlet, &device);
	struct gz_pipeline_output step = step_of(0, GZ_NS_PER_S);
	atomic_store(&lsl->busy, true);
	gz_lsl_outlet_step(outlet, &step);
	wait_until_a_push_hangs();
	long before = allocations_of_this_thread();
	for (uint64_t seq = 1; seq < GZ_LSL_QUEUE + EXTRA; seq++) {
		step.gaze.seq = seq;
		gz_lsl_outlet_step(outlet, &step);
	}
	/* The first one is in the library, and still in the queue. */
	assert_int_equal(gz_lsl_outlet_lost(outlet), EXTRA);
	gz_lsl_outlet_annotate(outlet, 0, "lost");
	device.display.px[0] = 960;
	gz_lsl_outlet_set_device(outlet, &device);
	gz_lsl_outlet_step(outlet, &step); /* nothing passes the device, which waits */
	assert_int_equal(gz_lsl_outlet_lost(outlet), EXTRA + 2);
	assert_int_equal(allocations_of_this_thread() - before, 0);
	atomic_store(&lsl->busy, false);
	wait_pushes(GAZE, GZ_LSL_QUEUE);
	for (int i = 0; i < GZ_LSL_QUEUE; i++)
		assert_true(lsl->outlets[GAZE].kept[i].values[0] == i);
	step.gaze.seq = 99999;
	gz_lsl_outlet_step(outlet, &step);
	wait_pushes(2, 1);
	assert_true(lsl->outlets[2].kept[0].values[0] == 99999);
	assert_int_equal(count_pushes(EVENTS), 0);
}

static void lsl_loss_is_logged(void **state)
{
	(void)state;
	captured_log_init(&captured, "warn");
	open_outlet();
	gz_lsl_outlet_set_device(outlet, &desk);
	struct gz_pipeline_output step = step_of(0, GZ_NS_PER_S);
	atomic_store(&lsl->busy, true);
	for (int i = 0; i < GZ_LSL_QUEUE + 10; i++)
		gz_lsl_outlet_step(outlet, &step);
	unsigned long long lost = gz_lsl_outlet_lost(outlet);
	assert_true(lost >= 9);
	atomic_store(&lsl->busy, false);
	gz_lsl_outlet_destroy(&outlet);
	char wanted[64];
	snprintf(wanted, sizeof wanted, "refused them: %llu samples and events", lost);
	assert_int_equal(captured.messages, 1);
	assert_non_null(strstr(captured.last, wanted));
}

static void lsl_stream_that_the_library_refuses_is_left_out(void **state)
{
	(void)state;
	captured_log_init(&captured, "warn");
	lsl->refuse = true;
	open_outlet();
	gz_lsl_outlet_set_device(outlet, &desk);
	struct gz_pipeline_output step = step_of(0, GZ_NS_PER_S);
	gz_lsl_outlet_step(outlet, &step);
	gz_lsl_outlet_annotate(outlet, GZ_NS_PER_S, "trial");
	gz_lsl_outlet_destroy(&outlet);
	assert_int_equal(captured.messages, 2);
	assert_non_null(strstr(captured.last, "the stream of gaze: the stand-in refuses"));
	assert_int_equal(count_outlets(), 0);
}

static void lsl_push_that_the_library_refuses_is_counted(void **state)
{
	(void)state;
	captured_log_init(&captured, "warn");
	atomic_store(&lsl->refuse_push, true);
	open_outlet();
	gz_lsl_outlet_set_device(outlet, &desk);
	struct gz_pipeline_output step = step_of(0, GZ_NS_PER_S);
	gz_lsl_outlet_step(outlet, &step);
	gz_lsl_outlet_annotate(outlet, GZ_NS_PER_S, "trial");
	wait_lost(2);
	atomic_store(&lsl->refuse_push, false);
	gz_lsl_outlet_step(outlet, &step);
	wait_pushes(GAZE, 1);
	gz_lsl_outlet_destroy(&outlet);
	assert_int_equal(count_pushes(EVENTS), 0);
	assert_int_equal(captured.messages, 1);
	assert_non_null(strstr(captured.last, "samples and events did not reach its readers"));
}

static void lsl_sample_before_an_event_or_a_new_tracker_reaches_its_reader_at_once(void **state)
{
	(void)state;
	struct gz_lsl_device device = desk;
	struct gz_pipeline_output step = step_of(0, GZ_NS_PER_S);
	open_outlet();
	gz_lsl_outlet_set_device(outlet, &device);
	/* All that follows waits in the queue behind a sample that the library holds. */
	atomic_store(&lsl->busy, true);
	gz_lsl_outlet_step(outlet, &step);
	wait_until_a_push_hangs();
	gz_lsl_outlet_step(outlet, &step);
	gz_lsl_outlet_step(outlet, &step);
	gz_lsl_outlet_annotate(outlet, GZ_NS_PER_S, "trial");
	gz_lsl_outlet_step(outlet, &step);
	device.rate_hz = 60;
	gz_lsl_outlet_set_device(outlet, &device);
	gz_lsl_outlet_step(outlet, &step);
	atomic_store(&lsl->busy, false);
	wait_pushes(2, 1);
	static const int32_t through[] = { 1, 0, 1, 1 };
	assert_int_equal(count_pushes(GAZE), 4);
	for (int i = 0; i < 4; i++)
		assert_int_equal(lsl->outlets[GAZE].kept[i].pushthrough, through[i]);
	assert_int_equal(lsl->outlets[2].kept[0].pushthrough, 1);
}

static void lsl_stream_with_a_reader_ends_after_a_while(void **state)
{
	(void)state;
	atomic_store(&lsl->consumers, 1);
	open_outlet();
	wait_outlets(1);
	int64_t begin_ns = gz_clock_now_ns();
	gz_lsl_outlet_destroy(&outlet);
	assert_true(gz_clock_now_ns() - begin_ns >= 200 * GZ_NS_PER_MS);
}

static void lsl_library_of_version_1_13_is_used(void **state)
{
	(void)state;
	struct lsl_stand_in *old = load_stand_in(LSL_STAND_IN_113);
	assert_non_null(old);
	assert_ptr_not_equal(old, lsl);
	old->refuse = true; /* it has no function that tells why */
	assert_int_equal(gz_lsl_outlet_create(LSL_STAND_IN_113, "Desk", &captured.log, &outlet),
			 GZ_OK);
	gz_lsl_outlet_destroy(&outlet);
	assert_non_null(strstr(captured.last, "the stream of events: no reason given"));
	old->refuse = false;
	assert_int_equal(gz_lsl_outlet_create(LSL_STAND_IN_113, "Desk", &captured.log, &outlet),
			 GZ_OK);
	gz_lsl_outlet_annotate(outlet, GZ_NS_PER_S, "trial");
	gz_lsl_outlet_destroy(&outlet);
	assert_int_equal(old->outlets[EVENTS].pushes, 1);
	assert_int_equal(atomic_load(&old->descriptions), 0);
}

static void lsl_offset_is_kept_while_readings_agree_with_it(void **state)
{
	(void)state;
	const int64_t second_ns = GZ_NS_PER_S, us_ns = 1000;
	/* One clock: each reading lies between both of the host's. */
	assert_true(gz_lsl_offset_step(0, second_ns, 1.0000009, second_ns + us_ns) == 0);
	/* Another clock: its offset is measured, then kept. */
	double offset_s = gz_lsl_offset_step(0, second_ns, 501.0, second_ns + 2 * us_ns);
	assert_close(offset_s, 499.999999, 1e-12);
	assert_true(gz_lsl_offset_step(offset_s, 2 * second_ns, 502.0000005,
				       2 * second_ns + 2 * us_ns) == offset_s);
	/* It was set. */
	assert_close(gz_lsl_offset_step(offset_s, 3 * second_ns, 3.0, 3 * second_ns), 0, 1e-12);
}

static void lsl_outlet_that_is_off_does_nothing(void **state)
{
	(void)state;
	struct gz_pipeline_output step = step_of(0, 0);
	gz_lsl_outlet_set_device(NULL, &desk);
	gz_lsl_outlet_step(NULL, &step);
	gz_lsl_outlet_annotate(NULL, 0, "trial");
	assert_int_equal(gz_lsl_outlet_lost(NULL), 0);
	assert_int_equal(count_outlets(), 0);
}

#define TEST(function) cmocka_unit_test_setup_teardown(function, set_up, tear_down)

TEST_SUITE(lsl)
{
	const struct CMUnitTest tests[] = {
		TEST(lsl_library_that_cannot_be_used_is_refused_with_a_remedy),
		TEST(lsl_gaze_stream_has_the_metadata_of_xdf),
		TEST(lsl_sample_has_pixels_and_its_own_time_on_lsl_clock),
		TEST(lsl_events_come_once_with_their_own_times),
		TEST(lsl_stream_begins_anew_when_the_tracker_or_its_display_changes),
		TEST(lsl_library_that_hangs_delays_no_sample_and_losses_are_counted),
		TEST(lsl_loss_is_logged),
		TEST(lsl_stream_that_the_library_refuses_is_left_out),
		TEST(lsl_push_that_the_library_refuses_is_counted),
		TEST(lsl_sample_before_an_event_or_a_new_tracker_reaches_its_reader_at_once),
		TEST(lsl_stream_with_a_reader_ends_after_a_while),
		TEST(lsl_library_of_version_1_13_is_used),
		TEST(lsl_offset_is_kept_while_readings_agree_with_it),
		TEST(lsl_outlet_that_is_off_does_nothing),
	};
	return cmocka_run_group_tests(tests, set_up_suite, NULL);
}
