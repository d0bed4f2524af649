/* gazectl convert and the picture of gazectl inspect, on files. */
#include "suite.h"

#include "filter/check.h"
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
	static char paths[16][128];
	static int next;
	char *path = paths[next++ % 16];
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
	assert_string_equal(events, "host_s,kind,text,duration_s,keys\n"
				    "11.000000000,mark,\"half \"\"way\"\"\",,\n");
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
	assert_non_null(strstr(program.out_text, "/sub-1_recording-eye*_physio.tsv.gz: 2000"));
	char *left = contents(in_directory("sub-1_recording-eye1_physio.tsv.gz"));
	char *about = contents(in_directory("sub-1_recording-eye1_physio.json"));
	char *events = contents(in_directory("sub-1_recording-eye2_physioevents.tsv.gz"));
	assert_int_equal(count(left, "\n"), 2000);
	assert_int_equal(strncmp(left, "10000000000\t", 12), 0);
	assert_non_null(strstr(about, "\"RecordedEye\": \"left\""));
	assert_non_null(strstr(about, "\"SamplingFrequency\": 1000"));
	assert_string_equal(events, "11000000000\tn/a\tmark\thalf \"way\"\tn/a\n");
	assert_int_equal(access(in_directory("sub-1_recording-eye3_physio.json"), F_OK), 0);
	assert_int_equal(access(in_directory("sub-1_recording-eye3_physio.tsv.gz.part"), F_OK), -1);
	free(left);
	free(about);
	free(events);
}

static void labels_are_in_tables_and_bids_files_if_asked_for(void **state)
{
	(void)state;
	const char *from = in_directory("a.gzl"), *to = in_directory("l.csv");
	write_log(from);
	struct program program = GAZECTL_RUN("convert", "--labels", from, to);
	assert_done(&program);
	char *samples = contents(to);
	assert_non_null(strstr(samples, ",eye1_dir_z,label\n"));
	assert_int_equal(count(samples, ",fixation\n") + count(samples, ",saccade\n") +
				 count(samples, ",oscillation\n"),
			 2000);
	CHECK_BETWEEN((double)count(samples, ",saccade\n"), 20, 60);
	free(samples);
	program = GAZECTL_RUN("convert", "--labels", from, in_directory("l_physio.tsv.gz"));
	assert_done(&program);
	char *events = contents(in_directory("l_recording-eye1_physioevents.tsv.gz"));
	assert_int_equal(strncmp(events, "10000000000\t", 12), 0);
	assert_int_equal(count(events, "\tsaccade\tn/a\tn/a\n"), 1);
	assert_int_equal(count(events, "\tmark\thalf \"way\"\tn/a\n"), 1);
	free(events);
	program = GAZECTL_RUN("convert", "--labels", from, in_directory("l.gzl"));
	assert_int_equal(program.status, 2);
	assert_non_null(strstr(program.err_text, "gzl has no labels"));
	assert_int_not_equal(access(in_directory("l.gzl"), F_OK), 0);
}

static void gazectl_label_lists_what_the_eye_did(void **state)
{
	(void)state;
	const char *from = in_directory("a.gzl"), *to = in_directory("labels.csv");
	write_log(from);
	struct program program = GAZECTL_RUN("label", from);
	assert_done(&program);
	const char *saccade = strstr(program.out_text, ",saccade,");
	assert_int_equal(count(program.out_text, ",saccade,"), 1);
	assert_int_equal(count(program.out_text, ",fixation,"), 2);
	assert_int_equal(strncmp(strstr(program.out_text, "\n"), "\n10.000000000,", 14), 0);
	double amplitude_deg = 0, peak_deg_s = 0;
	for (int commas = 0; *saccade && commas < 8; saccade++) /* label, samples, three points */
		commas += *saccade == ',';
	(void)sscanf(saccade, "%*f,%lf,%lf", &amplitude_deg, &peak_deg_s);
	CHECK_BETWEEN(amplitude_deg, 15, 21.4); /* the whole way is 21.3 deg */
	CHECK_BETWEEN(peak_deg_s, 450, 600);
	program = GAZECTL_RUN("label", "--out", to, from);
	assert_done(&program);
	program = GAZECTL_RUN("label", "--out", to, from);
	assert_int_equal(program.status, 1); /* it is there */
	program = GAZECTL_RUN("label", in_directory("nothing.gzl"));
	assert_int_equal(program.status, 1);
	program = GAZECTL_RUN("label");
	assert_int_equal(program.status, 2);
}

static void a_cut_log_is_labelled_to_its_end(void **state)
{
	(void)state;
	struct log_text text;
	log_text_begin(&text);
	log_text_look_right(&text, 0); /* and no end line */
	FILE *file = fopen(in_directory("cut.gzl"), "we");
	assert_non_null(file);
	assert_int_equal(fwrite(text.bytes, 1, text.size, file), text.size);
	assert_int_equal(fclose(file), 0);
	log_text_free(&text);
	struct program program = GAZECTL_RUN("label", in_directory("cut.gzl"));
	assert_int_equal(program.status, 4);
	assert_int_equal(count(program.out_text, ",saccade,"), 1);
}

static void write_text(const char *path, const char *text)
{
	FILE *file = fopen(path, "w");
	assert_non_null(file);
	assert_true(fputs(text, file) >= 0);
	assert_int_equal(fclose(file), 0);
}

/* A unit that is not mm, and marks with a duration and keys, through a gaze log into every format.
 */
static void eyelink_pupils_and_events_survive_all_conversions(void **state)
{
	(void)state;
	const char *from = in_directory("e.asc"), *log = in_directory("e.gzl");
	write_text(from, "** CONVERTED FROM e.edf\n"
			 "MSG\t99 GAZE_COORDS 0.00 0.00 1023.00 767.00\n"
			 "START\t100 \tRIGHT\tSAMPLES\tEVENTS\n"
			 "PUPIL\tAREA\n"
			 "SAMPLES\tGAZE\tRIGHT\tRATE\t 500.00\tTRACKING\tCR\n"
			 "100\t  512.0\t  384.0\t 1037.0\t...\n"
			 "102\t  512.0\t  384.0\t 1038.0\t...\n"
			 "EFIX R   100\t102\t4\t  512.0\t  384.0\t   1037\n");
	struct program program = GAZECTL_RUN("convert", from, log);
	assert_done(&program);
	program = GAZECTL_RUN("convert", log, in_directory("e.csv"));
	assert_done(&program);
	program = GAZECTL_RUN("convert", log, in_directory("e_physio.tsv.gz"));
	assert_done(&program);
	char *text = contents(log), *table = contents(in_directory("e.csv"));
	char *table_events = contents(in_directory("e_events.csv"));
	char *about = contents(in_directory("e_recording-eye2_physio.json"));
	char *events = contents(in_directory("e_recording-eye2_physioevents.tsv.gz"));
	assert_non_null(strstr(text, "\n#pupil_unit arbitrary (EyeLink area)\n"));
	assert_non_null(strstr(text, "\n!mark\t100000000\tfixation\t4000000\t{\"source\":"));
	assert_non_null(strstr(table, "eye0_pupil_size"));
	assert_non_null(strstr(table, ",1037,"));
	assert_non_null(strstr(table_events, "mark,\"fixation\",0.004000000,\"{\"\"source\"\":"));
	assert_non_null(strstr(about, "unit: arbitrary (EyeLink area)"));
	assert_null(strstr(about, "\"mm\""));
	assert_non_null(strstr(events, "100000000\t0.004\tmark\tfixation\t{\"source\":"));
	free(text);
	free(table);
	free(table_events);
	free(about);
	free(events);
}

static void pupil_points_are_no_gaze_on_a_screen(void **state)
{
	(void)state;
	const char *from = in_directory("p.csv"), *log = in_directory("p.gzl");
	write_text(from, "gaze_timestamp,confidence,norm_pos_x,norm_pos_y,base_data\n"
			 "10,1,0.25,0.75,10-0\n10.1,1,0.25,0.75,10.1-0\n");
	struct program program = GAZECTL_RUN("convert", "--display.px", "1920x1080", "--display.mm",
					     "500 300", "--display.distance_mm", "600", from, log);
	assert_done(&program);
	program = GAZECTL_RUN("convert", log, in_directory("p_physio.tsv.gz"));
	assert_done(&program);
	char *text = contents(log), *about = contents(in_directory("p_recording-eye2_physio.json"));
	char *samples = contents(in_directory("p_recording-eye2_physio.tsv.gz"));
	assert_non_null(strstr(text, "\n#coordinates scene camera\n"));
	assert_non_null(strstr(about, "\"gaze-in-world\""));
	assert_null(strstr(about, "screen"));
	assert_null(strstr(about, "StimulusPresentation"));
	assert_non_null(strstr(samples, "10000000000\t0.25\t0.25\t"));
	free(text);
	free(about);
	free(samples);
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
	program = GAZECTL_RUN("convert", from, in_directory("nowhere/b.csv"));
	assert_int_equal(program.status, 1);
	assert_non_null(
		strstr(program.err_text, "nowhere/b.csv: No such file or directory; choose"));
	const char *empty = in_directory("empty.asc");
	fclose(fopen(empty, "wb"));
	program = GAZECTL_RUN("convert", empty, to);
	assert_int_equal(program.status, 1);
	assert_non_null(strstr(program.err_text, "the file is empty"));
	program = GAZECTL_RUN("convert", in_directory("."), to);
	assert_int_equal(program.status, 1);
	assert_non_null(strstr(program.err_text, "cannot be read"));
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
		TEST(labels_are_in_tables_and_bids_files_if_asked_for),
		TEST(gazectl_label_lists_what_the_eye_did),
		TEST(a_cut_log_is_labelled_to_its_end),
		TEST(eyelink_pupils_and_events_survive_all_conversions),
		TEST(pupil_points_are_no_gaze_on_a_screen),
		TEST(files_that_are_there_are_kept_unless_forced),
		TEST(what_cannot_be_converted_is_refused_and_leaves_nothing),
		TEST(picture_shows_each_fixation_and_the_path),
		TEST(picture_that_is_called_no_svg_is_refused_before_anything_is_written),
		TEST(recordings_of_real_trackers_are_converted_whole),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
