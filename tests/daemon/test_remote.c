#include "suite.h"

#include <string.h>

#include "daemon/remote.h"

static enum gz_remote_kind parse(const char *text, char *name)
{
	struct gz_remote_request request;
	gz_remote_parse(text, strlen(text), &request);
	strcpy(name, request.name);
	return request.kind;
}

static void remote_letters_are_understood(void **state)
{
	(void)state;
	static const struct {
		const char *text;
		enum gz_remote_kind kind;
		const char *name;
	} requests[] = {
		{ "R", GZ_REMOTE_RECORD, "" },
		{ "R session-1", GZ_REMOTE_RECORD, "session-1" },
		{ "R ../x y", GZ_REMOTE_RECORD, "../x y" },
		{ "r", GZ_REMOTE_STOP, "" },
		{ "t", GZ_REMOTE_TIME, "" },
		{ "T 12.5", GZ_REMOTE_SET_TIME, "" },
		{ "T", GZ_REMOTE_SET_TIME, "" },
		{ "v", GZ_REMOTE_VERSION, "" },
		{ "SUB_PORT", GZ_REMOTE_STREAM_PORT, "" },
		{ "PUB_PORT", GZ_REMOTE_INLET_PORT, "" },
		{ "LATEST_PORT", GZ_REMOTE_LATEST_PORT, "" },
		{ "C", GZ_REMOTE_CALIBRATE, "" },
		{ "c", GZ_REMOTE_CALIBRATION_STOP, "" },
	};
	for (size_t i = 0; i < sizeof requests / sizeof *requests; i++) {
		char name[GZ_REMOTE_REQUEST_SIZE];
		assert_int_equal(parse(requests[i].text, name), requests[i].kind);
		assert_string_equal(name, requests[i].name);
	}
}

static void remote_anything_else_is_unknown(void **state)
{
	(void)state;
	static const char *const texts[] = { "",   " ",   "x",         "RR",       "r now",  "t ",
					     "rR", "v\n", "SUB_PORT ", "sub_port", "R\tname" };
	char name[GZ_REMOTE_REQUEST_SIZE], long_text[2 * GZ_REMOTE_REQUEST_SIZE];
	struct gz_remote_request request;
	for (size_t i = 0; i < sizeof texts / sizeof *texts; i++) {
		if (parse(texts[i], name) != GZ_REMOTE_UNKNOWN)
			fail_msg("\"%s\" was understood", texts[i]);
	}
	gz_remote_parse("r\0r", 3, &request);
	assert_int_equal(request.kind, GZ_REMOTE_UNKNOWN);
	memset(long_text, 'R', sizeof long_text);
	long_text[1] = ' ';
	for (size_t size = 3; size < sizeof long_text; size++) {
		gz_remote_parse(long_text, size, &request);
		assert_int_equal(request.kind, size < GZ_REMOTE_REQUEST_SIZE ? GZ_REMOTE_RECORD
									     : GZ_REMOTE_UNKNOWN);
	}
}

static void remote_notifications_for_the_daemon_are_told_from_others(void **state)
{
	(void)state;
	assert_int_equal(gz_remote_notice("recording.should_start"), GZ_REMOTE_NOTICE_RECORD);
	assert_int_equal(gz_remote_notice("recording.should_stop"), GZ_REMOTE_NOTICE_STOP);
	assert_int_equal(gz_remote_notice("calibration.should_start"), GZ_REMOTE_NOTICE_CALIBRATE);
	assert_int_equal(gz_remote_notice("meta.should_doc"), GZ_REMOTE_NOTICE_DOC);
	static const char *const others[] = { "",
					      "recording",
					      "recording.started",
					      "recording.should_start.1",
					      "eye_process.should_start.0",
					      "set_detection_mapping_mode",
					      "service_process.should_stop" };
	for (size_t i = 0; i < sizeof others / sizeof *others; i++)
		assert_int_equal(gz_remote_notice(others[i]), GZ_REMOTE_NOTICE_OTHER);
}

static void remote_doc_names_what_is_obeyed(void **state)
{
	(void)state;
	static const char *const words[] = { "SUB_PORT",
					     "PUB_PORT",
					     "recording.should_start",
					     "recording.should_stop",
					     "calibration.should_start",
					     "meta.should_doc" };
	for (size_t i = 0; i < sizeof words / sizeof *words; i++)
		assert_non_null(strstr(gz_remote_doc(), words[i]));
}

TEST_SUITE(remote)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(remote_letters_are_understood),
		cmocka_unit_test(remote_anything_else_is_unknown),
		cmocka_unit_test(remote_notifications_for_the_daemon_are_told_from_others),
		cmocka_unit_test(remote_doc_names_what_is_obeyed),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
