#include "suite.h"

#include <string.h>

#include "base/clock.h"
#include "daemon/inlet.h"

/* {"label": "go", "timestamp": 12.5} */
static const char annotation[] =
	"\x82\xa5label\xa2go\xa9timestamp\xcb\x40\x29\x00\x00\x00\x00\x00\x00";
/* {"label": "go", "duration": 2} */
static const char lasting[] = "\x82\xa5label\xa2go\xa8"
			      "duration\x02";
/* {"label": "go", "trial": 7} */
static const char with_keys[] = "\x82\xa5label\xa2go\xa5trial\x07";
/* {"subject": "x"} */
static const char notification[] = "\x81\xa7subject\xa1x";

static struct gz_inlet_message message;

static enum gz_result judge(const char *topic, const void *body, size_t size)
{
	return gz_inlet_judge(topic, strlen(topic), body, size, 77, &message);
}

static void inlet_annotation_becomes_a_mark(void **state)
{
	(void)state;
	assert_int_equal(judge("annotation", annotation, sizeof annotation - 1), GZ_OK);
	assert_true(message.is_mark);
	assert_int_equal(message.mark_ns, 12 * GZ_NS_PER_S + GZ_NS_PER_S / 2);
	assert_string_equal(message.mark, "go");
	assert_string_equal(message.topic, "annotation");
	assert_int_equal(message.size, sizeof annotation - 1);
	assert_memory_equal(message.body, annotation, message.size);
	assert_int_equal(judge("annotation.player", lasting, sizeof lasting - 1), GZ_OK);
	assert_int_equal(message.mark_ns, 77);
	assert_string_equal(message.mark, "go");
	assert_true(message.mark_duration_ns == 2 * GZ_NS_PER_S);
	assert_string_equal(message.mark_keys, "");
	assert_int_equal(judge("annotation", with_keys, sizeof with_keys - 1), GZ_OK);
	assert_string_equal(message.mark, "go");
	assert_true(message.mark_duration_ns == 0);
	assert_string_equal(message.mark_keys, "{\"trial\":7}");
}

static void inlet_notification_passes_and_is_no_mark(void **state)
{
	(void)state;
	assert_int_equal(judge("notify.x", notification, sizeof notification - 1), GZ_OK);
	assert_false(message.is_mark);
	assert_string_equal(message.topic, "notify.x");
	assert_true(message.is_notification);
	assert_string_equal(message.notification.subject, "x");
	assert_int_equal(judge("custom", notification, sizeof notification - 1), GZ_OK);
	assert_false(message.is_notification);
}

/* Readers subscribe to all notifications and then look at the subject. */
static void inlet_subjects_of_the_daemon_are_refused(void **state)
{
	(void)state;
	static const char successful[] = "\x81\xa7subject\xb6"
					 "calibration.successful";
	static const char stopped[] = "\x81\xa7subject\xb1"
				      "recording.stopped";
	assert_int_equal(judge("notify.x", successful, sizeof successful - 1), GZ_ERR_ACCESS);
	assert_int_equal(judge("notify.x", stopped, sizeof stopped - 1), GZ_ERR_ACCESS);
	assert_int_equal(judge("x", successful, sizeof successful - 1), GZ_OK);
}

static void inlet_topics_that_only_resemble_the_daemons_pass(void **state)
{
	(void)state;
	static const char *const topics[] = { "gaz",
					      "my.gaze",
					      "notify.gaze",
					      "notify.calibration.should_start",
					      "notify.calibration.add_ref_data",
					      "notify.recording.should_stop",
					      "notify.record" };
	for (size_t i = 0; i < sizeof topics / sizeof *topics; i++)
		assert_int_equal(judge(topics[i], notification, sizeof notification - 1), GZ_OK);
}

static void inlet_topics_of_the_daemon_are_refused(void **state)
{
	(void)state;
	static const char *const topics[] = {
		"gaze.3d.01.",
		"gaze.",
		"gaze",
		"gazeX",
		"surfaces.screen",
		"surfaces",
		"surface",
		"fixations",
		"fixation",
		"blinks",
		"saccades",
		"event_final",
		"status",
		"statusX",
		"pupil.0.3d",
		"pupil",
		"notify.calibration.successful",
		"notify.calibration.failed",
		"notify.calibration.stopped.x",
		"notify.calibration.result.v2",
		"notify.recording.started",
		"notify.recording.stopped",
	};
	for (size_t i = 0; i < sizeof topics / sizeof *topics; i++)
		assert_int_equal(judge(topics[i], notification, sizeof notification - 1),
				 GZ_ERR_ACCESS);
}

static void inlet_viewer_tells_its_pointer_and_its_window(void **state)
{
	(void)state;
	/* {"point": [0, 1], "timestamp": 12.5} and {"rect": [1, 2, 3, 4]} */
	static const char pointer[] =
		"\x82\xa5point\x92\x00\x01\xa9timestamp\xcb\x40\x29\0\0\0\0\0";
	static const char window[] = "\x81\xa4rect\x94\x01\x02\x03\x04";
	assert_int_equal(judge("pointer", pointer, sizeof pointer), GZ_OK);
	assert_true(message.is_pointer && message.pointer.known && !message.is_window);
	assert_true(message.pointer.point.y == 1 &&
		    message.pointer.time_ns == 12500 * GZ_NS_PER_MS);
	assert_int_equal(judge("window", window, sizeof window - 1), GZ_OK);
	assert_true(message.is_window && message.window.known && !message.is_pointer);
	assert_int_equal(message.window.rect_px[3], 4);
	assert_int_equal(judge("notify.x", notification, sizeof notification - 1), GZ_OK);
	assert_false(message.is_window || message.is_pointer);
	/* Only these topics, and only valid content. */
	assert_int_equal(judge("windows", window, sizeof window - 1), GZ_OK);
	assert_false(message.is_window);
	assert_int_equal(judge("window", "\x81\xa4rect\x01", 7), GZ_ERR_PROTOCOL);
	assert_int_equal(judge("pointer", "\x81\xa5point\x01", 8), GZ_ERR_PROTOCOL);
}

static void inlet_anything_else_is_refused_and_writes_nothing(void **state)
{
	(void)state;
	static unsigned char large[GZ_INLET_SIZE_MAX + 1];
	char topic[GZ_INLET_TOPIC_SIZE + 1];
	memset(topic, 'x', sizeof topic);
	topic[GZ_INLET_TOPIC_SIZE] = '\0';
	strcpy(message.topic, "untouched");
	assert_int_equal(judge("", notification, sizeof notification - 1), GZ_ERR_PROTOCOL);
	assert_int_equal(judge(topic, notification, sizeof notification - 1), GZ_ERR_PROTOCOL);
	assert_int_equal(
		gz_inlet_judge("a\0b", 3, notification, sizeof notification - 1, 0, &message),
		GZ_ERR_PROTOCOL);
	assert_int_equal(judge("notify.x", "", 0), GZ_ERR_PROTOCOL);
	assert_int_equal(judge("notify.x", large, sizeof large), GZ_ERR_PROTOCOL);
	/* An array that claims four thousand million elements. */
	assert_int_equal(judge("notify.x", "\xdd\xff\xff\xff\xff", 5), GZ_ERR_PROTOCOL);
	for (size_t size = 0; size < sizeof annotation - 1; size++)
		assert_int_equal(judge("annotation", annotation, size), GZ_ERR_PROTOCOL);
	assert_int_equal(judge("annotation", notification, sizeof notification - 1),
			 GZ_ERR_PROTOCOL);
	assert_int_equal(judge("notify.x", annotation, sizeof annotation - 1), GZ_ERR_PROTOCOL);
	assert_string_equal(message.topic, "untouched");
}

TEST_SUITE(inlet)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(inlet_annotation_becomes_a_mark),
		cmocka_unit_test(inlet_notification_passes_and_is_no_mark),
		cmocka_unit_test(inlet_topics_of_the_daemon_are_refused),
		cmocka_unit_test(inlet_subjects_of_the_daemon_are_refused),
		cmocka_unit_test(inlet_topics_that_only_resemble_the_daemons_pass),
		cmocka_unit_test(inlet_viewer_tells_its_pointer_and_its_window),
		cmocka_unit_test(inlet_anything_else_is_refused_and_writes_nothing),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
