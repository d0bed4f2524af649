/* Records of Gazepoint Control: framing and numbers. */
#include "suite.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "drivers/gazepoint/gazepoint_protocol.h"

static struct gz_gazepoint_xml *xml;
static struct gz_gazepoint_record record;
static enum gz_malformed malformed;

static enum gz_result parse(const char *text)
{
	return gz_gazepoint_parse(xml, text, strlen(text), &record, &malformed);
}

static void check_parses(const char *text, enum gz_gazepoint_kind kind)
{
	if (parse(text) != GZ_OK)
		fail_msg("refused as %s: %s", gz_malformed_name(malformed), text);
	if (record.kind != kind)
		fail_msg("kind %d, expected %d: %s", record.kind, kind, text);
}

static void check_refused(const char *text, enum gz_malformed reason)
{
	struct gz_gazepoint_record before;
	memset(&record, 0x5a, sizeof record);
	before = record;
	if (parse(text) != GZ_ERR_PROTOCOL)
		fail_msg("not refused: %s", text);
	if (malformed != reason)
		fail_msg("refused as %s, expected %s: %s", gz_malformed_name(malformed),
			 gz_malformed_name(reason), text);
	assert_memory_equal(&record, &before, sizeof record);
}

static void check_near(double value, double expected)
{
	if (!(fabs(value - expected) < 1e-9))
		fail_msg("%.12g, expected %.12g", value, expected);
}

static void record_of_the_api_becomes_numbers(void **state)
{
	(void)state;
	check_parses("<REC CNT=\"1484\" TIME=\"4.99716\" TIME_TICK=\"2096547271623\" "
		     "LPOGX=\"0.26\" LPOGY=\"-0.49\" LPOGV=\"1\" RPOGX=\"1.25\" RPOGY=\"0.48\" "
		     "RPOGV=\"0\" BPOGX=\"0.255\" BPOGY=\"0.485\" BPOGV=\"1\" LEYEX=\"-0.04796\" "
		     "LEYEY=\"0.00305\" LEYEZ=\"0.69235\" LPUPILD=\"0.00210\" LPUPILV=\"1\" "
		     "LPMM=\"2.10\" LPMMV=\"1\" />",
		     GZ_GAZEPOINT_DATA);
	assert_true(record.has_counter && record.has_tick && record.has_best);
	assert_int_equal(record.counter, 1484);
	assert_true(record.tick == 2096547271623);
	check_near(record.time_s, 4.99716);
	check_near(record.eye[GZ_EYE_LEFT].point[0], 0.26);
	check_near(record.eye[GZ_EYE_LEFT].point[1], -0.49);
	assert_true(record.eye[GZ_EYE_LEFT].valid);
	check_near(record.eye[GZ_EYE_RIGHT].point[0], 1.25);
	assert_false(record.eye[GZ_EYE_RIGHT].valid);
	check_near(record.best[1], 0.485);
	assert_true(record.best_valid);
	check_near(record.eye[GZ_EYE_LEFT].origin_m[2], 0.69235);
	check_near(record.eye[GZ_EYE_LEFT].pupil_m, 0.0021);
	check_near(record.eye[GZ_EYE_LEFT].pupil_mm, 2.1);
	assert_true(isnan(record.eye[GZ_EYE_RIGHT].pupil_mm));
}

static void record_may_have_attributes_in_any_order_and_unknown_ones(void **state)
{
	(void)state;
	check_parses("<REC  BPOGV='1'\tUSER=\"a&lt;&quot;&#x3e;\" BPOGY=\"5e-1\"\n KB=\" \" "
		     "BPOGX=\"+.25\"></REC>",
		     GZ_GAZEPOINT_DATA);
	check_near(record.best[0], 0.25);
	check_near(record.best[1], 0.5);
	assert_true(record.best_valid && !record.has_counter && !record.has_tick);
	assert_false(record.has_eye[GZ_EYE_LEFT] || record.has_eye[GZ_EYE_RIGHT]);
}

static void answers_name_their_request(void **state)
{
	(void)state;
	check_parses("<ACK ID=\"PRODUCT_ID\" VALUE=\"A&amp;B\" BUS=\"USB2\" RATE=\"60\" />",
		     GZ_GAZEPOINT_ACK);
	assert_string_equal(record.id, "PRODUCT_ID");
	assert_string_equal(record.value, "A&B");
	check_near(record.rate_hz, 60);
	check_parses("<ACK ID=\"SCREEN_SIZE\" X=\"0\" Y=\"0\" WIDTH=\"1920\" HEIGHT=\"1080\"/>",
		     GZ_GAZEPOINT_ACK);
	check_near(record.width, 1920);
	check_near(record.height, 1080);
	check_parses("<NACK ID=\"ENABLE_SEND_DATA\"/>", GZ_GAZEPOINT_NACK);
	/* As in the API document: not closed. */
	check_parses("<UPDATE ACTIVE_ID=\"1\" MAX_ID=\"2\" X=\"0\" Y=\"0\" WIDTH=\"1280\" >",
		     GZ_GAZEPOINT_UPDATE);
	check_near(record.width, 1280);
	assert_true(isnan(record.height));
	check_parses("<CAL ID=\"CALIB_START_PT\" PT=\"x\" />", GZ_GAZEPOINT_OTHER);
}

static void numbers_that_were_not_measured_are_nan(void **state)
{
	(void)state;
	static const char *const words[] = { "nan",       "-nan(ind)", "NaN",      "inf",
					     "-1.#IND00", "1.#QNAN0",  "-Infinity" };
	for (size_t i = 0; i < sizeof words / sizeof *words; i++) {
		char text[128];
		snprintf(text, sizeof text, "<REC BPOGX=\"%s\" BPOGY=\"0.5\" BPOGV=\"0\"/>",
			 words[i]);
		check_parses(text, GZ_GAZEPOINT_DATA);
		if (!isnan(record.best[0]))
			fail_msg("%s: %g", words[i], record.best[0]);
	}
}

static void invalid_fields_are_refused(void **state)
{
	(void)state;
	check_refused("<REC BPOGX=\"0,5\"/>", GZ_MALFORMED_VALUE);
	check_refused("<REC BPOGX=\"\"/>", GZ_MALFORMED_VALUE);
	check_refused("<REC BPOGX=\"0x10\"/>", GZ_MALFORMED_VALUE);
	check_refused("<REC BPOGX=\"1e999\"/>", GZ_MALFORMED_VALUE);
	check_refused("<REC CNT=\"1.5\"/>", GZ_MALFORMED_VALUE);
	check_refused("<REC TIME_TICK=\"99999999999999999999\"/>", GZ_MALFORMED_VALUE);
	check_refused("<REC LPOGV=\"yes\"/>", GZ_MALFORMED_VALUE);
	check_refused("<ACK/>", GZ_MALFORMED_VALUE);
	check_refused("<ACK ID=\"a name that is longer than any that was asked for\"/>",
		      GZ_MALFORMED_VALUE);
}

static void anything_but_one_element_is_refused(void **state)
{
	(void)state;
	static const char *const texts[] = {
		"REC",
		"<REC",
		"<REC CNT=\"1\"",
		"<REC CNT=1/>",
		"<REC CNT=\"1\" CNT=\"2\"/>",
		"<REC CNT=\"1\"/><REC CNT=\"2\"/>",
		"<REC><REC/></REC>",
		"<REC CNT=\"&nobody;\"/>",
		"<!DOCTYPE a><REC/>",
		"<!DOCTYPE a [<!ENTITY b \"c\">]><REC CNT=\"&b;\"/>",
		"<REC CNT=\"\xff\"/>",
		"</REC>",
		"<!-- nothing -->",
		"\xff\xfe<\0R\0",
	};
	for (size_t i = 0; i < sizeof texts / sizeof *texts; i++)
		check_refused(texts[i], GZ_MALFORMED_SYNTAX);
}

static void one_bad_record_does_not_harm_the_next(void **state)
{
	(void)state;
	for (int i = 0; i < 100; i++) {
		check_refused("<REC CNT=\"1\"><REC", GZ_MALFORMED_SYNTAX);
		check_parses("<REC CNT=\"7\"/>", GZ_GAZEPOINT_DATA);
		assert_int_equal(record.counter, 7);
	}
}

/* The longest record that the framer accepts, with as many attributes as fit. */
static void memory_is_enough_for_the_longest_record(void **state)
{
	(void)state;
	static char text[GZ_GAZEPOINT_RECORD_MAX];
	static const char letters[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ";
	size_t size = (size_t)snprintf(text, sizeof text, "<REC CNT=\"5\"");
	for (int i = 0; size + 12 < sizeof text; i++)
		size += (size_t)snprintf(text + size, sizeof text - size, " %c%c=\"\"",
					 letters[i / 52], letters[i % 52]);
	snprintf(text + size, sizeof text - size, "/>");
	check_parses(text, GZ_GAZEPOINT_DATA);
	assert_int_equal(record.counter, 5);
}

static void frequency_may_be_the_bits_of_a_double(void **state)
{
	(void)state;
	assert_true(gz_gazepoint_frequency_hz(10000000) == 10000000);
	assert_true(gz_gazepoint_frequency_hz(4704405731611246592) == 3330093);
	assert_true(gz_gazepoint_frequency_hz(0) == 0);
	assert_true(gz_gazepoint_frequency_hz(-5) == 0);
	assert_true(gz_gazepoint_frequency_hz(999) == 0);
	assert_true(gz_gazepoint_frequency_hz(INT64_MAX) == 0);
}

/* Feed @p size bytes in pieces of @p piece. Each result is printed: a record in brackets, "!" for
 * an error. */
static void frame(const char *bytes, size_t size, size_t piece, char *out, size_t out_size)
{
	static struct gz_gazepoint_framer framer;
	memset(&framer, 0, sizeof framer);
	size_t written = 0;
	for (size_t fed = 0; fed < size;) {
		size_t room, count = piece < size - fed ? piece : size - fed;
		char *at = gz_gazepoint_framer_room(&framer, &room);
		assert_true(room >= GZ_GAZEPOINT_RECORD_MAX);
		count = count < room ? count : room;
		memcpy(at, bytes + fed, count);
		gz_gazepoint_framer_add(&framer, count);
		fed += count;
		const char *text;
		size_t length;
		enum gz_result result;
		while ((result = gz_gazepoint_framer_next(&framer, &text, &length)) !=
		       GZ_ERR_TIMEOUT) {
			int n = result == GZ_OK ? snprintf(out + written, out_size - written,
							   "[%.*s]", (int)length, text)
						: snprintf(out + written, out_size - written, "!");
			written += (size_t)n;
			assert_true(written < out_size);
		}
	}
}

static void records_are_framed_however_they_arrive(void **state)
{
	(void)state;
	static const char bytes[] = "<A/>\r\n\r\n<B/>\n\0<C/>\r\n  <D/>\r\n<E/>";
	char out[256];
	for (size_t piece = 1; piece <= sizeof bytes; piece++) {
		frame(bytes, sizeof bytes - 1, piece, out, sizeof out);
		assert_string_equal(out, "[<A/>][<B/>][<C/>][<D/>]");
	}
}

static void records_that_are_too_long_are_reported_once_and_skipped(void **state)
{
	(void)state;
	static char bytes[5 * GZ_GAZEPOINT_RECORD_MAX + 7];
	static char out[2 * GZ_GAZEPOINT_RECORD_MAX];
	memset(bytes, 'x', sizeof bytes);
	memcpy(bytes, "<A/>\r\n", 6);
	memcpy(bytes + 4 * GZ_GAZEPOINT_RECORD_MAX, "\n<B/>\n", 6);
	bytes[sizeof bytes - 1] = '\n';
	for (size_t piece = 1; piece < sizeof bytes; piece = piece * 3 + 1) {
		frame(bytes, sizeof bytes, piece, out, sizeof out);
		/* The last record is one byte too long. */
		assert_string_equal(out, "[<A/>]![<B/>]!");
	}
	/* One byte less is accepted. */
	memset(bytes, 'x', GZ_GAZEPOINT_RECORD_MAX);
	bytes[GZ_GAZEPOINT_RECORD_MAX - 1] = '\n';
	frame(bytes, GZ_GAZEPOINT_RECORD_MAX, 100, out, sizeof out);
	assert_int_equal(strlen(out), GZ_GAZEPOINT_RECORD_MAX - 1 + 2);
}

static int make_memory(void **state)
{
	(void)state;
	return gz_gazepoint_xml_create(&xml) == GZ_OK ? 0 : -1;
}

static int free_memory(void **state)
{
	(void)state;
	gz_gazepoint_xml_destroy(&xml);
	gz_gazepoint_xml_destroy(&xml);
	gz_gazepoint_xml_destroy(NULL);
	return xml ? -1 : 0;
}

TEST_SUITE(gazepoint_protocol)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(record_of_the_api_becomes_numbers),
		cmocka_unit_test(record_may_have_attributes_in_any_order_and_unknown_ones),
		cmocka_unit_test(answers_name_their_request),
		cmocka_unit_test(numbers_that_were_not_measured_are_nan),
		cmocka_unit_test(invalid_fields_are_refused),
		cmocka_unit_test(anything_but_one_element_is_refused),
		cmocka_unit_test(one_bad_record_does_not_harm_the_next),
		cmocka_unit_test(memory_is_enough_for_the_longest_record),
		cmocka_unit_test(frequency_may_be_the_bits_of_a_double),
		cmocka_unit_test(records_are_framed_however_they_arrive),
		cmocka_unit_test(records_that_are_too_long_are_reported_once_and_skipped),
	};
	return cmocka_run_group_tests(tests, make_memory, free_memory);
}
