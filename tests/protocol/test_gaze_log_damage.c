#include "suite.h"

#include "protocol/gaze_log.h"

#include <stdlib.h>

#include "base/captured_log.h"
#include "protocol/sample_log.h"

/* Bytes in an allocation of exactly their size, so that a sanitizer detects a read past them. */
static void *exact_copy(const void *bytes, size_t size)
{
	void *copy = malloc(size ? size : 1);
	assert_non_null(copy);
	memcpy(copy, bytes, size);
	return copy;
}

/* Read to the end and count the results. */
struct tally {
	size_t records, malformed;
	enum gz_gaze_log_ending ending;
};

static struct tally read_all(struct gz_gaze_log_reader *reader)
{
	struct tally tally = { 0 };
	struct gz_gaze_log_record record;
	enum gz_result result;
	while ((result = gz_gaze_log_read(reader, &record)) != GZ_ERR_END) {
		tally.records += result == GZ_OK;
		tally.malformed += result == GZ_ERR_FORMAT;
		if (result != GZ_OK && result != GZ_ERR_FORMAT)
			fail_msg("reading gave %d", result);
	}
	tally.ending = gz_gaze_log_ending(reader);
	return tally;
}

static size_t whole_records_before(const struct sample_log *log, size_t cut)
{
	size_t records = 0;
	while (records < SAMPLE_LOG_RECORDS && log->record_end[records] <= cut)
		records++;
	return records;
}

static void check_cut(const struct sample_log *log, size_t cut)
{
	char *bytes = exact_copy(log->text, cut);
	struct captured_log captured;
	struct gz_gaze_log_reader *reader = NULL;
	captured_log_init(&captured, "*:debug");
	enum gz_result opened =
		gz_gaze_log_open_memory("cut.gzl", bytes, cut, &captured.log, &reader);
	if (cut < strlen("#gazecast-log 1\n")) {
		assert_int_equal(opened, GZ_ERR_FORMAT);
		assert_null(reader);
	} else {
		assert_int_equal(opened, GZ_OK);
		size_t expected = whole_records_before(log, cut);
		for (size_t i = 0; i < expected; i++) {
			struct gz_gaze_log_record record;
			assert_int_equal(gz_gaze_log_read(reader, &record), GZ_OK);
			assert_same_record(&record, &log->records[i]);
		}
		struct tally rest = read_all(reader);
		assert_int_equal(rest.records, 0);
		assert_int_equal(rest.malformed, 0);
		assert_int_equal(rest.ending, GZ_GAZE_LOG_CUT);
		gz_gaze_log_close(&reader);
	}
	assert_int_equal(captured.messages, 1);
	assert_non_null(strstr(captured.last, "cut.gzl"));
	free(bytes);
}

static void log_cut_anywhere_gives_every_whole_line_before(void **state)
{
	(void)state;
	struct sample_log log;
	sample_log_make(&log);
	for (size_t cut = 0; cut < log.size; cut++)
		check_cut(&log, cut);
}

static void log_cut_tells_how_many_samples_it_holds(void **state)
{
	(void)state;
	struct sample_log log;
	struct captured_log captured;
	struct gz_gaze_log_reader *reader = NULL;
	captured_log_init(&captured, "*:debug");
	sample_log_make(&log);
	assert_int_equal(gz_gaze_log_open_memory("cut.gzl", log.text, log.record_end[2] + 1,
						 &captured.log, &reader),
			 GZ_OK);
	read_all(reader);
	gz_gaze_log_close(&reader);
	assert_int_equal(captured.level, GZ_LOG_WARN);
	assert_non_null(strstr(captured.last, "2 samples found"));
}

static void log_with_any_byte_changed_is_not_whole(void **state)
{
	(void)state;
	static const unsigned char masks[] = { 0x01, 0x20, 0x80, 0xff, 0x03, 0x29 };
	struct sample_log log;
	sample_log_make(&log);
	char *bytes = exact_copy(log.text, log.size);
	for (size_t at = 0; at < log.size; at++) {
		for (size_t i = 0; i < sizeof masks; i++) {
			struct gz_gaze_log_reader *reader = NULL;
			bytes[at] = (char)((unsigned char)log.text[at] ^ masks[i]);
			/* The blanks in the line "#end" may be tabs. */
			bool equal =
				at > log.record_end[SAMPLE_LOG_RECORDS - 1] && bytes[at] == '\t';
			if (gz_gaze_log_open_memory("flip", bytes, log.size, NULL, &reader) ==
			    GZ_OK) {
				struct tally tally = read_all(reader);
				if (tally.ending == GZ_GAZE_LOG_WHOLE && !equal)
					fail_msg("byte %zu ^ %02x passes as whole", at, masks[i]);
			}
			gz_gaze_log_close(&reader);
		}
		bytes[at] = log.text[at];
	}
	free(bytes);
}

static void log_with_bytes_behind_its_end_is_corrupted(void **state)
{
	(void)state;
	struct sample_log log;
	struct gz_gaze_log_reader *reader = NULL;
	sample_log_make(&log);
	log.text[log.size++] = '\n';
	assert_int_equal(gz_gaze_log_open_memory("more", log.text, log.size, NULL, &reader), GZ_OK);
	struct tally tally = read_all(reader);
	gz_gaze_log_close(&reader);
	assert_int_equal(tally.records, SAMPLE_LOG_RECORDS);
	assert_int_equal(tally.ending, GZ_GAZE_LOG_CORRUPTED);
}

static void log_with_wrong_count_is_corrupted(void **state)
{
	(void)state;
	struct sample_log log;
	struct gz_gaze_log_reader *reader = NULL;
	sample_log_make(&log);
	strstr(log.text, "#end 3")[5] = '4';
	assert_int_equal(gz_gaze_log_open_memory("count", log.text, log.size, NULL, &reader),
			 GZ_OK);
	assert_int_equal(read_all(reader).ending, GZ_GAZE_LOG_CORRUPTED);
	gz_gaze_log_close(&reader);
}

#define SAMPLE "1\t\t2\t0.5\t0.5\t1\t\t\t0\t\t\t\t\t\t\t\t\t\t\t0\t\t\t\t\t\t\t\t"

static void check_line(const char *line, bool good)
{
	char text[8192];
	struct captured_log captured;
	struct gz_gaze_log_reader *reader = NULL;
	captured_log_init(&captured, "*:debug");
	int size = snprintf(text, sizeof text,
			    "#gazecast-log 1\n#tracker t\n" SAMPLE "\n%s\n" SAMPLE "\n", line);
	assert_int_equal(
		gz_gaze_log_open_memory("a.gzl", text, (size_t)size, &captured.log, &reader),
		GZ_OK);
	struct gz_gaze_log_record record;
	assert_int_equal(gz_gaze_log_read(reader, &record), GZ_OK);
	enum gz_result result = gz_gaze_log_read(reader, &record);
	if ((result == GZ_OK) != good || (!good && result != GZ_ERR_FORMAT))
		fail_msg("\"%s\" gave %d", line, result);
	assert_int_equal(captured.messages, good ? 0 : 1);
	if (!good)
		assert_non_null(strstr(captured.last, "a.gzl:4: "));
	assert_int_equal(gz_gaze_log_read(reader, &record), GZ_OK);
	gz_gaze_log_close(&reader);
}

static void line_malformed_is_skipped_with_its_number(void **state)
{
	(void)state;
	static const char *const malformed[] = {
		"",
		"x",
		"\t",
		SAMPLE "\t",
		SAMPLE "x",
		"-1\t\t2\t0.5\t0.5\t1\t\t\t0\t\t\t\t\t\t\t\t\t\t\t0\t\t\t\t\t\t\t\t",
		"1\t\t\t0.5\t0.5\t1\t\t\t0\t\t\t\t\t\t\t\t\t\t\t0\t\t\t\t\t\t\t\t",
		"1\t\t2\t0,5\t0.5\t1\t\t\t0\t\t\t\t\t\t\t\t\t\t\t0\t\t\t\t\t\t\t\t",
		"1\t\t2\tnan\t0.5\t1\t\t\t0\t\t\t\t\t\t\t\t\t\t\t0\t\t\t\t\t\t\t\t",
		"1\t\t2\t0x1\t0.5\t1\t\t\t0\t\t\t\t\t\t\t\t\t\t\t0\t\t\t\t\t\t\t\t",
		"1\t\t2\t1e39\t0.5\t1\t\t\t0\t\t\t\t\t\t\t\t\t\t\t0\t\t\t\t\t\t\t\t",
		"1\t\t2\t 1\t0.5\t1\t\t\t0\t\t\t\t\t\t\t\t\t\t\t0\t\t\t\t\t\t\t\t",
		"1\t\t2\t1-\t0.5\t1\t\t\t0\t\t\t\t\t\t\t\t\t\t\t0\t\t\t\t\t\t\t\t",
		"1\t\t2\t0.5\t0.5\t2\t\t\t0\t\t\t\t\t\t\t\t\t\t\t0\t\t\t\t\t\t\t\t",
		"1\t9223372036854775808\t2\t0.5\t0.5\t1\t\t\t0\t\t\t\t\t\t\t\t\t\t\t0\t\t\t\t\t\t"
		"\t\t",
		"18446744073709551616\t\t2\t0.5\t0.5\t1\t\t\t0\t\t\t\t\t\t\t\t\t\t\t0\t\t\t\t\t\t"
		"\t\t",
		"!",
		"!gap",
		"!gap\t1\t2",
		"!gap\t1\t-2\tlost",
		"!gap\t1\t2\tlost\tmore",
		"!mark\t1",
		"!mark\tnow\ttext",
		"!mark\t1\ttext\tlong",
		"!mark\t1\ttext\t-1",
		"!mark\t1\ttext\t1\t",
		"!mark\t1\ttext\t1\t{}\tmore",
		"!mark\t1\tan unknown \\escape",
		"!mark\t1\tends in \\",
		"!mark \t1\ttext",
		"!window\t1\t2\t3\t4",
		"!window\t1\t2\t3\t4\t5\t6",
		"!window\t1\t2\t3\t4\t2147483648",
		"!unheard\t1",
		"#tracker again",
		"# a remark",
	};
	for (size_t i = 0; i < sizeof malformed / sizeof *malformed; i++)
		check_line(malformed[i], false);
	check_line(SAMPLE, true);
	check_line("!mark\t1\t", true);
	check_line("!mark\t1\ttext\t1500000000", true);
	check_line("!mark\t1\ttext\t0\t{\"trial\":7}", true);
	/* An empty field was not measured, whether something is valid included. */
	check_line("1\t\t2\t0.5\t0.5\t\t\t\t\t\t\t\t\t\t\t\t\t\t\t\t\t\t\t\t\t\t\t", true);
}

static void line_of_the_longest_length_is_read_and_one_longer_is_not(void **state)
{
	(void)state;
	/* A sample whose numbers have many digits. */
	char line[GZ_GAZE_LOG_LINE_SIZE + 8];
	static const char before[] = "1\t\t2\t0.";
	static const char after[] = "\t0.5\t1\t\t\t0\t\t\t\t\t\t\t\t\t\t\t0\t\t\t\t\t\t\t\t";
	for (size_t longer = 0; longer < 2; longer++) {
		size_t length = GZ_GAZE_LOG_LINE_SIZE - 1 + longer;
		memset(line, '5', sizeof line);
		memcpy(line, before, sizeof before - 1);
		memcpy(line + length - (sizeof after - 1), after, sizeof after);
		check_line(line, longer == 0);
	}
}

static void mark_longer_than_a_record_holds_is_malformed(void **state)
{
	(void)state;
	char line[64 + GZ_GAZE_LOG_TEXT_SIZE] = "!mark\t1\t";
	size_t start = strlen(line);
	memset(line + start, 'm', GZ_GAZE_LOG_TEXT_SIZE - 1);
	check_line(line, true);
	line[start + GZ_GAZE_LOG_TEXT_SIZE - 1] = 'm';
	check_line(line, false);
}

static void line_with_a_nul_is_malformed(void **state)
{
	(void)state;
	static const char text[] = "#gazecast-log 1\n!mark\t1\ta\0b\n!mark\t2\tc\n";
	struct gz_gaze_log_reader *reader = NULL;
	assert_int_equal(gz_gaze_log_open_memory("nul", text, sizeof text - 1, NULL, &reader),
			 GZ_OK);
	struct tally tally = read_all(reader);
	gz_gaze_log_close(&reader);
	assert_int_equal(tally.malformed, 1);
	assert_int_equal(tally.records, 1);
}

static void log_of_garbage_lines_does_not_flood_its_reader(void **state)
{
	(void)state;
	enum { LINES = 1000 };
	static char text[64 + 2 * LINES];
	int size = snprintf(text, sizeof text, "#gazecast-log 1\n");
	for (int i = 0; i < LINES; i++)
		size += snprintf(text + size, sizeof text - (size_t)size, "x\n");
	struct captured_log captured;
	struct gz_gaze_log_reader *reader = NULL;
	captured_log_init(&captured, "*:debug");
	assert_int_equal(gz_gaze_log_open_memory("x", text, (size_t)size, &captured.log, &reader),
			 GZ_OK);
	assert_int_equal(read_all(reader).malformed, LINES);
	gz_gaze_log_close(&reader);
	assert_int_equal(captured.messages, 10 + 1);
	assert_non_null(strstr(captured.last, "1000 malformed lines"));
}

static void header_malformed_is_refused_with_line_and_reason(void **state)
{
	(void)state;
	static const char *const lines[] = {
		"#rate_hz x",
		"#rate_hz -1",
		"#rate_hz inf",
		"#rate_hz 60Hz",
		"#rate_hz",
		"#rate_hz 1\n#rate_hz 1",
		"#display_px 1920",
		"#display_px 0 1080",
		"#display_px 1920 32769",
		"#display_px 1920 1080 3",
		"#display_mm 1 nan",
		"#display_mm 0 1",
		"#distance_mm -600",
		"#tracker an unknown \\escape",
		"#tracker 0123456789012345678901234567890123456789012345678901234567890123",
		"#pipeline. 1",
		"#pipeline.a 1\n#pipeline.a 2",
	};
	for (size_t i = 0; i < sizeof lines / sizeof *lines; i++) {
		char text[512];
		struct captured_log captured;
		struct gz_gaze_log_reader *reader = NULL;
		captured_log_init(&captured, "*:debug");
		int size =
			snprintf(text, sizeof text, "#gazecast-log 1\n%s\n" SAMPLE "\n", lines[i]);
		if (gz_gaze_log_open_memory("a.gzl", text, (size_t)size, &captured.log, &reader) !=
		    GZ_ERR_FORMAT)
			fail_msg("\"%s\" was not refused", lines[i]);
		assert_null(reader);
		assert_int_equal(captured.messages, 1);
		assert_memory_equal(captured.last, "a.gzl:", 6);
	}
}

static void header_too_long_or_with_a_nul_is_refused(void **state)
{
	(void)state;
	char text[4096] = "#gazecast-log 1\n#";
	memset(text + strlen(text), 'x', 3000);
	strcat(text, "\n");
	struct gz_gaze_log_reader *reader = NULL;
	assert_int_equal(gz_gaze_log_open_memory("long", text, strlen(text), NULL, &reader),
			 GZ_ERR_FORMAT);
	static const char nul[] = "#gazecast-log 1\n#tracker a\0b\n";
	assert_int_equal(gz_gaze_log_open_memory("nul", nul, sizeof nul - 1, NULL, &reader),
			 GZ_ERR_FORMAT);
	assert_null(reader);
}

static void header_of_a_later_minor_writer_is_read(void **state)
{
	(void)state;
	static const char text[] = "#gazecast-log\t1\n#mood good\n#tracker\tpro1\n#rate_hz\t60\n"
				   "#display_px\t640 480\n" SAMPLE "\n";
	struct gz_gaze_log_reader *reader = NULL;
	assert_int_equal(gz_gaze_log_open_memory("later", text, sizeof text - 1, NULL, &reader),
			 GZ_OK);
	assert_string_equal(gz_gaze_log_header(reader)->tracker, "pro1");
	assert_true(gz_gaze_log_header(reader)->rate_hz == 60);
	assert_false(gz_gaze_log_header(reader)->has_display); /* its size in mm is missing */
	assert_int_equal(read_all(reader).records, 1);
	gz_gaze_log_close(&reader);
}

static void file_of_another_kind_is_refused(void **state)
{
	(void)state;
	static const char *const texts[] = { "",
					     "\n",
					     "gaze_timestamp,confidence\n",
					     "#gazecast-log 2\n",
					     "#gazecast-log 10\n",
					     "#gazecast-log\n",
					     "##gazecast-log 1\n" };
	for (size_t i = 0; i < sizeof texts / sizeof *texts; i++) {
		struct captured_log captured;
		struct gz_gaze_log_reader *reader = NULL;
		captured_log_init(&captured, "*:debug");
		assert_int_equal(gz_gaze_log_open_memory("b.csv", texts[i], strlen(texts[i]),
							 &captured.log, &reader),
				 GZ_ERR_FORMAT);
		assert_non_null(strstr(captured.last, "b.csv:1: not a gaze log"));
	}
}

TEST_SUITE(gaze_log_damage)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(log_cut_anywhere_gives_every_whole_line_before),
		cmocka_unit_test(log_cut_tells_how_many_samples_it_holds),
		cmocka_unit_test(log_with_any_byte_changed_is_not_whole),
		cmocka_unit_test(log_with_bytes_behind_its_end_is_corrupted),
		cmocka_unit_test(log_with_wrong_count_is_corrupted),
		cmocka_unit_test(line_malformed_is_skipped_with_its_number),
		cmocka_unit_test(line_of_the_longest_length_is_read_and_one_longer_is_not),
		cmocka_unit_test(mark_longer_than_a_record_holds_is_malformed),
		cmocka_unit_test(line_with_a_nul_is_malformed),
		cmocka_unit_test(log_of_garbage_lines_does_not_flood_its_reader),
		cmocka_unit_test(header_malformed_is_refused_with_line_and_reason),
		cmocka_unit_test(header_too_long_or_with_a_nul_is_refused),
		cmocka_unit_test(header_of_a_later_minor_writer_is_read),
		cmocka_unit_test(file_of_another_kind_is_refused),
	};
	return cmocka_run_group_tests_name("gaze_log_damage", tests, NULL, NULL);
}
