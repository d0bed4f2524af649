/* gazectl convert and the picture of gazectl inspect, on files. */
#include "suite.h"

#include "log_text.h"
#include "program.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#include <zlib.h>

static char directory[64];

static int set_up(void **state)
{
	(void)state;
	snprintf(directory, sizeof directory, "/tmp/gz_convert_XXXXXX");
	return mkdtemp(directory) ? 0 : -1;
}

static int tear_down(void **state)
{
	(void)state;
	char command[128];
	snprintf(command, sizeof command, "rm -r '%s'", directory);
	return system(command);
}

static const char *in_directory(const char *name)
{
	static char paths[4][128];
	static int next;
	char *path = paths[next++ % 4];
	snprintf(path, sizeof paths[0], "%s/%s", directory, name);
	return path;
}

/* The whole content of a file, decompressed if it is compressed; freed by the caller. */
static char *contents(const char *path)
{
	gzFile file = gzopen(path, "rb");
	if (!file)
		fail_msg("%s is not there", path);
	size_t size = 0, room = 1 << 16;
	char *text = malloc(room + 1);
	int got;
	assert_non_null(text);
	while ((got = gzread(file, text + size, (unsigned)(room - size))) > 0) {
		size += (size_t)got;
		if (size == room) {
			room *= 2;
			text = realloc(text, room + 1);
			assert_non_null(text);
		}
	}
	assert_int_equal(got, 0);
	gzclose(file);
	text[size] = '\0';
	return text;
}

static void write_log(const char *path)
{
	struct log_text text;
	log_text_begin(&text);
	log_text_look_right(&text, 0);
	log_text_mark(&text, 11000000000, "half \"way\"");
	log_text_end(&text);
	FILE *file = fopen(path, "we");
	assert_non_null(file);
	assert_int_equal(fwrite(text.bytes, 1, text.size, file), text.size);
	assert_int_equal(fclose(file), 0);
	log_text_free(&text);
}

static struct program run(const char *const *arguments)
{
	struct program program;
	program_run(&program, arguments);
	return program;
}

#define GAZECTL_RUN(...) run((const char *const[]) { GAZECTL, __VA_ARGS__, NULL })

static void assert_done(const struct program *program)
{
	if (program->status != 0)
		fail_msg("exit %d: %s", program->status, program->err_text);
}

static size_t count(const char *text, const char *word)
{
	size_t n = 0;
	for (; (text = strstr(text, word)) != NULL; text++)
		n++;
	return n;
}

static void log_converted_to_a_log_is_the_same_log(void **state)
{
	(void)state;
	const char *from = in_directory("a.gzl"), *to = in_directory("b.gzl");
	write_log(from);
	struct program program = GAZECTL_RUN("convert", from, to);
	assert_done(&program);
	char *before = contents(from), *after = contents(to);
	assert_string_equal(before, after);
	free(before);
	free(after);
}

static void log_becomes_tables_with_every_sample_and_mark(void **state)
{
	(void)state;
	const char *from = in_directory("a.gzl"), *to = in_directory("a.csv");
	write_log(from);
	struct program program = GAZECTL_RUN("convert", from, to);
	assert_done(&program);
	char *samples = contents(to), *events = contents(in_directory("a_events.csv"));
	assert_int_equal(count(samples, "\n"), 1 + 2000);
	assert_non_null(strstr(samples, "\n0,10.000000000,"));
	assert_string_equal(events, "host_s,kind,text\n11.000000000,mark,\"half \"\"way\"\"\"\n");
	free(samples);
	free(events);
}

static void log_becomes_bids_files_of_the_eyes_that_were_measured(void **state)
{
	(void)state;
	const char *from = in_directory("a.gzl"), *to = in_directory("sub-1_physio.tsv.gz");
	write_log(from);
	struct program program = GAZECTL_RUN("convert", from, to);
	assert_done(&program);
	char *left = contents(in_directory("sub-1_recording-eye1_physio.tsv.gz"));
	char *about = contents(in_directory("sub-1_recording-eye1_physio.json"));
	char *events = contents(in_directory("sub-1_recording-eye2_physioevents.tsv.gz"));
	assert_int_equal(count(left, "\n"), 2000);
	assert_int_equal(strncmp(left, "10000000000\t", 12), 0);
	assert_non_null(strstr(about, "\"RecordedEye\": \"left\""));
	assert_non_null(strstr(about, "\"SamplingFrequency\": 1000"));
	assert_string_equal(events, "11000000000\tn/a\tmark\thalf \"way\"\n");
	assert_int_equal(access(in_directory("sub-1_recording-eye3_physio.json"), F_OK), 0);
	assert_int_equal(access(in_directory("sub-1_recording-eye3_physio.tsv.gz.part"), F_OK), -1);
	free(left);
	free(about);
	free(events);
}

static void files_that_are_there_are_kept_unless_forced(void **state)
{
	(void)state;
	const char *from = in_directory("a.gzl"), *to = in_directory("b.csv");
	write_log(from);
	struct program program = GAZECTL_RUN("convert", from, to);
	assert_done(&program);
	program = GAZECTL_RUN("convert", from, to);
	assert_int_equal(program.status, 1);
	assert_non_null(strstr(program.err_text, "--force"));
	program = GAZECTL_RUN("convert", "--force", from, to);
	assert_done(&program);
}

static void what_cannot_be_converted_is_refused_and_leaves_nothing(void **state)
{
	(void)state;
	const char *from = in_directory("a.gzl"), *to = in_directory("b.csv");
	write_log(from);
	struct program program = GAZECTL_RUN("convert", from, in_directory("b.txt"));
	assert_int_equal(program.status, 2);
	assert_non_null(strstr(program.err_text, ".csv"));
	program = GAZECTL_RUN("convert", "--from", "pupil", from, to);
	assert_int_equal(program.status, 1);
	program = GAZECTL_RUN("convert", in_directory("nowhere.asc"), to);
	assert_int_equal(program.status, 1);
	assert_non_null(strstr(program.err_text, "not found"));
	program = GAZECTL_RUN("convert", from);
	assert_int_equal(program.status, 2);
	program = GAZECTL_RUN("convert", "--to", "xls", from, to);
	assert_int_equal(program.status, 2);
	assert_int_equal(access(to, F_OK), -1);
	assert_int_equal(access(in_directory("b.csv.part"), F_OK), -1);
}

static void picture_shows_each_fixation_and_the_path(void **state)
{
	(void)state;
	const char *from = in_directory("a.gzl"), *to = in_directory("a.svg");
	write_log(from);
	struct program program = GAZECTL_RUN("inspect", "--picture", to, from);
	assert_done(&program);
	char *picture = contents(to);
	assert_non_null(strstr(picture, ">a.gzl</text>"));
	assert_int_equal(count(picture, "<circle"), 1); /* the second one has not ended */
	assert_int_equal(count(picture, "</svg>"), 1);
	assert_null(strstr(picture, "nan"));
	free(picture);
	program = GAZECTL_RUN("inspect", "--picture", to, from);
	assert_int_equal(program.status, 1);
	assert_non_null(strstr(program.err_text, "--force"));
}

static void picture_that_is_called_no_svg_is_refused_before_anything_is_written(void **state)
{
	(void)state;
	const char *from = in_directory("a.gzl"), *to = in_directory("a.png");
	write_log(from);
	struct program program = GAZECTL_RUN("inspect", "--picture", to, from);
	assert_int_equal(program.status, 2);
	assert_non_null(strstr(program.err_text, ".svg"));
	assert_int_equal(access(to, F_OK), -1);
}

/* Lines of samples, counted in another way: they begin with a digit. */
static size_t sample_lines(const char *path)
{
	char *text = contents(path);
	size_t n = 0;
	for (const char *line = text; line; line = strchr(line, '\n')) {
		line += *line == '\n';
		n += *line >= '0' && *line <= '9';
	}
	free(text);
	return n;
}

static void recordings_of_real_trackers_are_converted_whole(void **state)
{
	(void)state;
	static const char *const recordings[] = {
		"gaze/eyelinker_asc/extdata/bino1000.asc.gz",
		"gaze/eyelinker_asc/extdata/mono2000.asc.gz",
		"gaze/eyelinker_asc/extdata/monoRemote250.asc.gz",
		"gaze/i2mc_tx300/example_data/participant1/1.tsv.gz",
		"gaze/pupil_tutorials/data/gaze_positions.csv.gz",
	};
	const char *data = getenv("GAZECAST_DATA");
	if (!data)
		skip();
	for (size_t i = 0; i < sizeof recordings / sizeof *recordings; i++) {
		char path[512], wanted[64];
		snprintf(path, sizeof path, "%s/%s", data, recordings[i]);
		struct program program =
			GAZECTL_RUN("convert", "--force", path, in_directory("c.gzl"));
		assert_done(&program);
		snprintf(wanted, sizeof wanted, ": %zu samples", sample_lines(path));
		if (!strstr(program.out_text, wanted))
			fail_msg("%s, wanted%s", program.out_text, wanted);
		program = GAZECTL_RUN("inspect", in_directory("c.gzl"));
		assert_done(&program);
	}
}

#define TEST(function) cmocka_unit_test_setup_teardown(function, set_up, tear_down)

TEST_SUITE(convert_files)
{
	const struct CMUnitTest tests[] = {
		TEST(log_converted_to_a_log_is_the_same_log),
		TEST(log_becomes_tables_with_every_sample_and_mark),
		TEST(log_becomes_bids_files_of_the_eyes_that_were_measured),
		TEST(files_that_are_there_are_kept_unless_forced),
		TEST(what_cannot_be_converted_is_refused_and_leaves_nothing),
		TEST(picture_shows_each_fixation_and_the_path),
		TEST(picture_that_is_called_no_svg_is_refused_before_anything_is_written),
		TEST(recordings_of_real_trackers_are_converted_whole),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
