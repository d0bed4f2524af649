#include "suite.h"

#include "protocol/wire.h"

#include "base/clock.h"
#include "unpacked.h"

/* {"subject": "recording.should_start", "session_name": "s1", "other": [1]} */
static const char start[] = "\x83\xa7subject\xb6recording.should_start"
			    "\xacsession_name\xa2s1\xa5other\x91\x01";

static void notification_is_read_with_its_session_name(void **state)
{
	(void)state;
	struct gz_notification notification;
	assert_int_equal(gz_wire_decode_notification(start, sizeof start - 1, &notification),
			 GZ_OK);
	assert_string_equal(notification.subject, "recording.should_start");
	assert_string_equal(notification.session_name, "s1");
	/* Without a name, and with nil as the name. */
	static const char stop[] = "\x82\xa7subject\xb5recording.should_stop\xacsession_name\xc0";
	assert_int_equal(gz_wire_decode_notification(stop, sizeof stop - 1, &notification), GZ_OK);
	assert_string_equal(notification.subject, "recording.should_stop");
	assert_string_equal(notification.session_name, "");
}

static void notification_without_a_subject_is_refused_and_nothing_written(void **state)
{
	(void)state;
	static const struct {
		const char *bytes;
		size_t size;
	} refused[] = {
		{ "\x80", 1 },                 /* no subject */
		{ "\x81\xa7subject\xa0", 10 }, /* an empty one */
		{ "\x81\xa7subject\x07", 10 }, /* a number */
		{ "\x81\xa7subject\xa3"
		  "a\0b",
		  13 },                                             /* a NUL in it */
		{ "\x82\xa7subject\xa1x\xacsession_name\x01", 25 }, /* a number for a name */
		{ "\x91\xa1x", 3 },                                 /* no map */
		{ "\xdf\xff\xff\xff\xff", 5 },                      /* a claim */
	};
	struct gz_notification notification = { .subject = "kept" };
	for (size_t i = 0; i < sizeof refused / sizeof *refused; i++)
		assert_int_equal(gz_wire_decode_notification(refused[i].bytes, refused[i].size,
							     &notification),
				 GZ_ERR_PROTOCOL);
	for (size_t size = 0; size < sizeof start - 1; size++)
		assert_int_equal(gz_wire_decode_notification(start, size, &notification),
				 GZ_ERR_PROTOCOL);
	assert_string_equal(notification.subject, "kept");
}

static void recording_notifications_have_the_keys_of_pupil_capture(void **state)
{
	(void)state;
	struct gz_wire_message message;
	msgpack_unpacked unpacked;
	assert_int_equal(gz_wire_encode_recording_started("/rec/s1.gzl", "s1", 5 * GZ_NS_PER_S / 2,
							  &message),
			 GZ_OK);
	const msgpack_object *map = unpack_map(&message, &unpacked);
	assert_keys(map, "topic subject rec_path session_name record_eye compression "
			 "start_time_synced");
	assert_text(value_of(map, "topic"), "notify.recording.started");
	assert_text(value_of(map, "subject"), "recording.started");
	assert_text(value_of(map, "rec_path"), "/rec/s1.gzl");
	assert_text(value_of(map, "session_name"), "s1");
	assert_number(value_of(map, "start_time_synced"), 2.5);
	msgpack_unpacked_destroy(&unpacked);
	assert_int_equal(gz_wire_encode_recording_stopped("/rec/s1.gzl", &message), GZ_OK);
	map = unpack_map(&message, &unpacked);
	assert_keys(map, "topic subject rec_path");
	assert_text(value_of(map, "subject"), "recording.stopped");
	msgpack_unpacked_destroy(&unpacked);
}

static void calibration_and_doc_notifications_say_why_and_who(void **state)
{
	(void)state;
	struct gz_wire_message message;
	msgpack_unpacked unpacked;
	assert_int_equal(gz_wire_encode_calibration_failed("because", GZ_NS_PER_S, &message),
			 GZ_OK);
	const msgpack_object *map = unpack_map(&message, &unpacked);
	assert_keys(map, "topic subject reason timestamp record");
	assert_text(value_of(map, "topic"), "notify.calibration.failed");
	assert_text(value_of(map, "reason"), "because");
	msgpack_unpacked_destroy(&unpacked);
	assert_int_equal(gz_wire_encode_doc("gazed", "text", &message), GZ_OK);
	map = unpack_map(&message, &unpacked);
	assert_keys(map, "topic subject actor doc");
	assert_text(value_of(map, "subject"), "meta.doc");
	assert_text(value_of(map, "actor"), "gazed");
	msgpack_unpacked_destroy(&unpacked);
}

TEST_SUITE(wire_notification)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(notification_is_read_with_its_session_name),
		cmocka_unit_test(notification_without_a_subject_is_refused_and_nothing_written),
		cmocka_unit_test(recording_notifications_have_the_keys_of_pupil_capture),
		cmocka_unit_test(calibration_and_doc_notifications_say_why_and_who),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
