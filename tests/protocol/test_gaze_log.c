#include "suite.h"

#include "protocol/gaze_log.h"

#include <limits.h>
#include <locale.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/captured_log.h"
#include "base/text.h"
#include "protocol/gaze_log_lines.h"
#include "protocol/sample_log.h"

static void log_round_trip_keeps_header_and_records(void **state)
{
	(void)state;
	struct sample_log log;
	struct captured_log captured;
	captured_log_init(&captured, "*:debug");
	sample_log_make(&log);

	struct gz_gaze_log_reader *reader = NULL;
	assert_int_equal(
		gz_gaze_log_open_memory("memory", log.text, log.size, &captured.log, &reader),
		GZ_OK);
	const struct gz_gaze_log_header *header = gz_gaze_log_header(reader);
	assert_memory_equal(header, &log.header, sizeof *header);
	assert_int_equal(gz_gaze_log_ending(reader), GZ_GAZE_LOG_UNREAD);

	struct gz_gaze_log_record record;
	for (int i = 0; i < SAMPLE_LOG_RECORDS; i++) {
		assert_int_equal(gz_gaze_log_read(reader, &record), GZ_OK);
		assert_same_record(&record, &log.records[i]);
	}
	for (int times = 0; times < 2; times++)
		assert_int_equal(gz_gaze_log_read(reader, &record), GZ_ERR_END);
	assert_int_equal(gz_gaze_log_ending(reader), GZ_GAZE_LOG_WHOLE);
	assert_int_equal(captured.messages, 0);
	gz_gaze_log_close(&reader);
	assert_null(reader);
	gz_gaze_log_close(&reader);
}

static void log_lines_are_as_documented(void **state)
{
	(void)state;
	struct sample_log log;
	sample_log_make(&log);
	static const char header[] =
		"#gazecast-log 1\n"
		"#tracker Tab\\there \\\\ and there\n"
		"#serial \n"
		"#rate_hz 1200.1\n"
		"#display_px 1920\t1080\n"
		"#display_mm 564.7\t0.33333333333333331\n"
		"#distance_mm 600\n"
		"#started 2031-05-06T07:08:09Z\n"
		"#software gazed 0.1.0\n"
		"#pipeline.fixation_deg_s 30 20\n"
		"#pipeline.smoothing \n"
		"#columns seq\tdevice_ns\thost_ns\tgaze_x\tgaze_y\tgaze_valid\t";
	assert_memory_equal(log.text, header, sizeof header - 1);
	static const char records[] =
		"7\t-5\t1000000007\t0.100000001\t-0\t1"
		"\t0.25\t1.5\t1\t1\t3.29999995\t-30.5\t2\t600\t0.100000001\t0.200000003\t0."
		"899999976"
		"\t3.40282347e+38\t-1.17549435e-38\t0\t0\t1.40129846e-45"
		"\t9.99999968e-21\t-1.00000002e+20\t7\tinf\t-inf\t0\n"
		"!gap\t2\t3\tdevice lost them\n"
		"18446744073709551615\t\t0\t\t\t0\t\t\t0\t\t\t\t\t\t\t\t\t\t\t0\t\t\t\t\t\t\t\t\n"
		"!mark\t-9223372036854775808\ta\\tb\\nc\\rd\\\\e \xc3\xa4\n"
		"!window\t5\t-10\t0\t1920\t1080\n"
		"!scene\t1000000009\tstill\n9\t-5\t";
	assert_memory_equal(log.text + log.header_size, records, sizeof records - 1);
	const char *end = strstr(log.text, "\n#end 3 ");
	assert_non_null(end);
	assert_int_equal(strlen(end), strlen("\n#end 3 01234567\n"));
}

static void log_columns_are_as_many_as_fields(void **state)
{
	(void)state;
	struct sample_log log;
	sample_log_make(&log);
	const char *columns = strstr(log.text, "#columns ");
	size_t tabs[2] = { 0 };
	for (const char *c = columns; *c != '\n'; c++)
		tabs[0] += *c == '\t';
	for (const char *c = log.text + log.header_size; *c != '\n'; c++)
		tabs[1] += *c == '\t';
	assert_int_equal(tabs[0], 27);
	assert_int_equal(tabs[1], 27);
}

static float round_trip(float value, locale_t c_locale)
{
	char bytes[64];
	struct gz_gaze_log_text text;
	size_t length;
	float back = 12345;
	gz_gaze_log_text_begin(&text, bytes, sizeof bytes);
	gz_gaze_log_text_print(&text, "%s", "");
	gz_gaze_log_text_print_float(&text, value);
	assert_int_equal(gz_gaze_log_text_end(&text, &length), GZ_OK);
	assert_int_equal(length, strlen(bytes));
	assert_true(gz_field_float(bytes, c_locale, &back));
	return back;
}

static void float_of_any_exponent_comes_back_bit_for_bit(void **state)
{
	(void)state;
	locale_t c_locale = newlocale(LC_ALL_MASK, "C", (locale_t)0);
	static const uint32_t mantissas[] = { 0,        1,        2,        0x7fffff, 0x7ffffe,
					      0x400000, 0x555555, 0x2aaaaa, 0x3504f3 };
	for (uint32_t high = 0; high < 512; high++) { /* sign and exponent */
		for (size_t i = 0; i < sizeof mantissas / sizeof *mantissas; i++) {
			uint32_t bits = high << 23 | mantissas[i];
			float value;
			memcpy(&value, &bits, sizeof value);
			assert_same_float(round_trip(value, c_locale), value);
		}
	}
	freelocale(c_locale);
}

static void double_of_a_header_comes_back_bit_for_bit(void **state)
{
	(void)state;
	locale_t c_locale = newlocale(LC_ALL_MASK, "C", (locale_t)0);
	static const double values[] = { 0,       -0.0,    0.1,    1.0 / 3,  564.6893,
					 DBL_MIN, DBL_MAX, 5e-324, 1e15 / 7, 0x1.fffffffffffffp0 };
	for (size_t i = 0; i < sizeof values / sizeof *values; i++) {
		char bytes[64];
		struct gz_gaze_log_text text;
		double back;
		gz_gaze_log_text_begin(&text, bytes, sizeof bytes);
		gz_gaze_log_text_print_double(&text, values[i]);
		assert_true(gz_field_double(bytes, c_locale, &back));
		assert_memory_equal(&back, &values[i], sizeof back);
	}
	freelocale(c_locale);
}

static void number_with_another_decimal_point_gets_a_point(void **state)
{
	(void)state;
	static const char *const cases[][2] = {
		{ "-0,5e-07", "-0.5e-07" },
		{ "1\xd9\xab"
		  "25",
		  "1.25" },
		{ "3.5", "3.5" },
		{ "-17", "-17" },
		{ "1e+20", "1e+20" },
	};
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		char number[32];
		snprintf(number, sizeof number, "%s", cases[i][0]);
		gz_number_normalise_point(number);
		assert_string_equal(number, cases[i][1]);
	}
}

/* Needs a locale with a decimal comma, which a minimal system may lack. */
static void log_under_a_comma_locale_is_the_same(void **state)
{
	(void)state;
	static const char *const commas[] = { "de_DE.UTF-8", "de_DE.utf8", "fr_FR.UTF-8", "de_DE" };
	struct sample_log plain, comma;
	sample_log_make(&plain);
	const char *set = NULL;
	for (size_t i = 0; !set && i < sizeof commas / sizeof *commas; i++)
		set = setlocale(LC_NUMERIC, commas[i]);
	if (!set)
		skip();
	assert_string_equal(localeconv()->decimal_point, ",");
	sample_log_make(&comma);
	struct gz_gaze_log_reader *reader = NULL;
	struct gz_gaze_log_record record;
	assert_int_equal(gz_gaze_log_open_memory("comma", plain.text, plain.size, NULL, &reader),
			 GZ_OK);
	assert_int_equal(gz_gaze_log_read(reader, &record), GZ_OK);
	gz_gaze_log_close(&reader);
	setlocale(LC_NUMERIC, "C");
	assert_int_equal(comma.size, plain.size);
	assert_memory_equal(comma.text, plain.text, plain.size);
	assert_same_record(&record, &plain.records[0]);
}

static void log_of_longest_texts_fits_the_promised_sizes(void **state)
{
	(void)state;
	static char text[GZ_GAZE_LOG_HEADER_SIZE];
	static struct gz_gaze_log_header header;
	size_t length;
	memset(header.tracker, '\t', sizeof header.tracker - 1);
	memset(header.serial, '\t', sizeof header.serial - 1);
	memset(header.started, '\t', sizeof header.started - 1);
	memset(header.software, '\t', sizeof header.software - 1);
	header.rate_hz = 1200.0 / 7;
	header.has_display = true;
	header.display = (struct gz_display) { { 32768, 32768 }, { DBL_MIN, DBL_MIN }, DBL_MIN };
	header.setting_count = GZ_GAZE_LOG_SETTINGS_MAX;
	for (size_t i = 0; i < header.setting_count; i++) {
		struct gz_gaze_log_setting *setting = &header.settings[i];
		memset(setting->value, '\n', sizeof setting->value - 1);
		memset(setting->key, 'k', sizeof setting->key - 1);
		setting->key[0] = (char)('A' + i / 16);
		setting->key[1] = (char)('A' + i % 16);
	}
	assert_int_equal(gz_gaze_log_print_header(&header, text, sizeof text, &length), GZ_OK);
	struct gz_gaze_log_reader *reader = NULL;
	assert_int_equal(gz_gaze_log_open_memory("longest", text, length, NULL, &reader), GZ_OK);
	assert_memory_equal(gz_gaze_log_header(reader), &header, sizeof header);
	gz_gaze_log_close(&reader);

	struct gz_gaze_log_record record = { .kind = GZ_GAZE_LOG_GAP,
					     .host_ns = INT64_MIN,
					     .missing = UINT64_MAX };
	memset(record.text, '\\', sizeof record.text - 1);
	assert_int_equal(gz_gaze_log_print_record(&record, text, GZ_GAZE_LOG_LINE_SIZE, &length),
			 GZ_OK);
}

static void print_into_too_little_room_is_refused(void **state)
{
	(void)state;
	struct sample_log log;
	sample_log_make(&log);
	size_t length, untouched = 4711;
	char text[2048];
	for (int i = 0; i < SAMPLE_LOG_RECORDS; i++) {
		const struct gz_gaze_log_record *record = &log.records[i];
		assert_int_equal(gz_gaze_log_print_record(record, text, sizeof text, &length),
				 GZ_OK);
		for (size_t size = 0; size <= length; size++)
			assert_int_equal(gz_gaze_log_print_record(record, text, size, &untouched),
					 GZ_ERR_FULL);
		assert_int_equal(gz_gaze_log_print_record(record, text, length + 1, &length),
				 GZ_OK);
	}
	assert_int_equal(gz_gaze_log_print_header(&log.header, text, 100, &untouched), GZ_ERR_FULL);
	assert_int_equal(gz_gaze_log_print_end(1, 2, text, 8, &untouched), GZ_ERR_FULL);
	assert_int_equal(untouched, 4711);
}

static void log_file_of_many_chunks_is_read_whole(void **state)
{
	(void)state;
	enum { RECORDS = 2000 }; /* about 300 kB, several times the size of a chunk */
	char path[] = "/tmp/gz-log-XXXXXX";
	FILE *file = fdopen(mkstemp(path), "w");
	struct gz_gaze_log_header header = sample_header();
	char text[GZ_GAZE_LOG_LINE_SIZE];
	size_t length;
	uint32_t crc = 0;
	assert_non_null(file);
	assert_int_equal(gz_gaze_log_print_header(&header, text, sizeof text, &length), GZ_OK);
	for (uint64_t i = 0; i <= RECORDS; i++) {
		crc = (uint32_t)crc32_z(crc, (unsigned char *)text, length);
		assert_int_equal(fwrite(text, 1, length, file), length);
		struct gz_gaze_log_record record = full_sample(i);
		assert_int_equal(gz_gaze_log_print_record(&record, text, sizeof text, &length),
				 GZ_OK);
	}
	assert_int_equal(gz_gaze_log_print_end(RECORDS, crc, text, sizeof text, &length), GZ_OK);
	assert_int_equal(fwrite(text, 1, length, file), length);
	fclose(file);

	struct gz_gaze_log_reader *reader = NULL;
	struct gz_gaze_log_record record;
	assert_int_equal(gz_gaze_log_open(path, NULL, &reader), GZ_OK);
	for (uint64_t i = 0; i < RECORDS; i++) {
		assert_int_equal(gz_gaze_log_read(reader, &record), GZ_OK);
		assert_int_equal(record.sample.seq, i);
	}
	assert_int_equal(gz_gaze_log_read(reader, &record), GZ_ERR_END);
	assert_int_equal(gz_gaze_log_ending(reader), GZ_GAZE_LOG_WHOLE);
	gz_gaze_log_close(&reader);
	unlink(path);
}

/* Write samples of which some are in a still scene. @return the file, open at its start */
static int write_scenes(const bool *still, size_t count, const struct gz_gaze_log_record *first)
{
	char path[] = "/tmp/gz-log-XXXXXX";
	static struct gz_gaze_log_writer writer;
	const struct gz_gaze_log_header header = sample_header();
	int fd = mkstemp(path);
	assert_true(fd >= 0);
	unlink(path);
	assert_int_equal(gz_gaze_log_writer_begin(&writer, fd, &header), GZ_OK);
	if (first)
		assert_int_equal(gz_gaze_log_writer_add(&writer, first), GZ_OK);
	for (size_t i = 0; i < count; i++) {
		struct gz_gaze_log_record record = full_sample(i);
		record.sample.still_scene = still[i];
		assert_int_equal(gz_gaze_log_writer_add(&writer, &record), GZ_OK);
	}
	assert_int_equal(gz_gaze_log_writer_end(&writer), GZ_OK);
	return fd;
}

/* Check that each sample comes back as it was. @return how many scene records there are */
static size_t read_scenes(int fd, const bool *still, size_t count)
{
	char path[64];
	size_t scenes = 0, samples = 0;
	struct gz_gaze_log_reader *reader;
	struct gz_gaze_log_record record;
	snprintf(path, sizeof path, "/proc/self/fd/%d", fd);
	assert_int_equal(gz_gaze_log_open(path, NULL, &reader), GZ_OK);
	while (gz_gaze_log_read(reader, &record) == GZ_OK) {
		scenes += record.kind == GZ_GAZE_LOG_SCENE;
		if (record.kind == GZ_GAZE_LOG_SCENE)
			assert_int_equal(record.host_ns, 1000000000 + (int64_t)samples);
		if (record.kind != GZ_GAZE_LOG_SAMPLE)
			continue;
		bool expected = samples < count && still[samples];
		assert_int_equal(record.sample.seq, samples);
		assert_int_equal(record.sample.still_scene, expected);
		samples++;
	}
	assert_int_equal(samples, count);
	assert_int_equal(gz_gaze_log_ending(reader), GZ_GAZE_LOG_WHOLE);
	gz_gaze_log_close(&reader);
	close(fd);
	return scenes;
}

static void writer_notes_where_the_scene_becomes_still_or_moves(void **state)
{
	(void)state;
	static const bool changing[] = { false, false, true, true, false, true };
	static const bool moving[] = { false, false }, still[] = { true, true };
	const struct gz_gaze_log_record first = { .kind = GZ_GAZE_LOG_SCENE,
						  .host_ns = 1000000000,
						  .still_scene = true };
	assert_int_equal(read_scenes(write_scenes(changing, 6, NULL), changing, 6), 3);
	assert_int_equal(read_scenes(write_scenes(moving, 2, NULL), moving, 2), 0);
	assert_int_equal(read_scenes(write_scenes(still, 2, NULL), still, 2), 1);
	/* A record that was read from another log is not written twice. */
	assert_int_equal(read_scenes(write_scenes(still, 2, &first), still, 2), 1);
}

static void open_that_fails_logs_the_path(void **state)
{
	(void)state;
	struct captured_log captured;
	struct gz_gaze_log_reader *reader = NULL;
	captured_log_init(&captured, "*:debug");
	assert_int_equal(gz_gaze_log_open("/nowhere/a.gzl", &captured.log, &reader),
			 GZ_ERR_NOT_FOUND);
	assert_non_null(strstr(captured.last, "/nowhere/a.gzl"));
	assert_int_equal(gz_gaze_log_open("/tmp", &captured.log, &reader), GZ_ERR_IO);
	assert_non_null(strstr(captured.last, "/tmp"));
	assert_int_equal(captured.messages, 2);
	assert_null(reader);
}

TEST_SUITE(gaze_log)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(log_round_trip_keeps_header_and_records),
		cmocka_unit_test(log_lines_are_as_documented),
		cmocka_unit_test(log_columns_are_as_many_as_fields),
		cmocka_unit_test(float_of_any_exponent_comes_back_bit_for_bit),
		cmocka_unit_test(double_of_a_header_comes_back_bit_for_bit),
		cmocka_unit_test(number_with_another_decimal_point_gets_a_point),
		cmocka_unit_test(log_under_a_comma_locale_is_the_same),
		cmocka_unit_test(log_of_longest_texts_fits_the_promised_sizes),
		cmocka_unit_test(print_into_too_little_room_is_refused),
		cmocka_unit_test(log_file_of_many_chunks_is_read_whole),
		cmocka_unit_test(writer_notes_where_the_scene_becomes_still_or_moves),
		cmocka_unit_test(open_that_fails_logs_the_path),
	};
	return cmocka_run_group_tests_name("gaze_log", tests, NULL, NULL);
}
