#include "suite.h"

#include "log_text.h"
#include "program.h"
#include "publisher.h"

#include <math.h>
#include <pthread.h>
#include <signal.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>
#include <zmq.h>

#include "base/clock.h"

/* A daemon that the test plays: sends a status and a gaze each 5 ms, answers R and r. */
struct daemon {
	struct publisher publisher;
	void *control;
	struct gz_status status;
	bool refuses;
	uint64_t seq;
	atomic_bool stopping;
	pthread_t thread;
};

static void answer(struct daemon *daemon)
{
	char request[64];
	int size = zmq_recv(daemon->control, request, sizeof request - 1, ZMQ_DONTWAIT);
	if (size < 0)
		return;
	request[size] = '\0';
	const char *reply = "unknown command";
	if (daemon->refuses) {
		reply = "no: the disk is \x1b[31mfull";
	} else if (strcmp(request, "R my-name") == 0) {
		reply = "OK";
		daemon->status.recording.state = GZ_RECORDING_ON;
		strcpy(daemon->status.recording.file, "/somewhere/my-name.gzl");
	} else if (strcmp(request, "r") == 0) {
		reply = "OK";
		daemon->status.recording.state = GZ_RECORDING_OFF;
		daemon->status.recording.file[0] = '\0';
	}
	zmq_send(daemon->control, reply, strlen(reply), 0);
}

static void *daemon_main(void *user)
{
	struct daemon *daemon = user;
	while (!atomic_load(&daemon->stopping)) {
		struct gz_gaze gaze = gaze_at(daemon->seq++, 0.25f, 0.75f);
		publisher_send_gaze(&daemon->publisher, &gaze);
		publisher_send_status(&daemon->publisher, &daemon->status);
		answer(daemon);
		gz_clock_sleep_until_ns(gaze.host_ns + 5 * GZ_NS_PER_MS);
	}
	return NULL;
}

static struct gz_status some_status(void)
{
	struct gz_status status = {
		.tracker = { .name = "fake", .serial = "s\t7", .state = GZ_TRACKER_RUNNING },
		.rate_hz_nominal = 200,
		.rate_hz_measured = 199.5,
		.samples = 1234,
		.lost = 5,
		.clock = { .tick = GZ_CLOCK_DECLARED, .skew_ppm = 1.5 },
		.noise_deg = 0.125,
		.still_scene = true,
		.display = gz_display_default(1920, 1080),
		.validation = { "2026-01-31T12:00:00Z", 0.75, "500 mm away, was \t600 mm" },
		.subscribers = 2,
		.version = "0.1.0",
	};
	status.rejected[GZ_REJECT_VELOCITY] = 3;
	status.malformed[GZ_MALFORMED_SHORT] = 2;
	status.refused[GZ_REFUSAL_OVERFLOW] = 9;
	return status;
}

static void daemon_start(struct daemon *daemon)
{
	char endpoint[GZ_ENDPOINT_SIZE];
	*daemon = (struct daemon) { .status = some_status() };
	publisher_open(&daemon->publisher, "stream");
	daemon->control = zmq_socket(daemon->publisher.context, ZMQ_REP);
	assert_int_equal(gz_endpoint_ipc(getenv("GAZECAST_RUNTIME_DIR"), "control", endpoint,
					 sizeof endpoint),
			 GZ_OK);
	const int none = 0;
	zmq_setsockopt(daemon->control, ZMQ_LINGER, &none, sizeof none);
	assert_int_equal(zmq_bind(daemon->control, endpoint), 0);
}

static void daemon_run(struct daemon *daemon)
{
	assert_int_equal(pthread_create(&daemon->thread, NULL, daemon_main, daemon), 0);
}

static void daemon_stop(struct daemon *daemon)
{
	atomic_store(&daemon->stopping, true);
	assert_int_equal(pthread_join(daemon->thread, NULL), 0);
	zmq_close(daemon->control);
	publisher_close(&daemon->publisher);
}

static struct program program; /* large: not for the stack */

#define RUN(...) program_run(&program, (const char *const[]) { GAZECTL, __VA_ARGS__, NULL })

static void assert_contains(const char *text, const char *part)
{
	if (!strstr(text, part))
		fail_msg("\"%s\" is not in:\n%s", part, text);
}

/* The program exited with @p status, printed one line with @p part on stderr, and nothing on
 * stdout. */
static void assert_refused(int status, const char *part)
{
	if (program.status != status)
		fail_msg("exit status %d, not %d: %s", program.status, status, program.err_text);
	assert_contains(program.err_text, part);
	char *end = strchr(program.err_text, '\n');
	assert_non_null(end);
	assert_string_equal(end, "\n");
	assert_string_equal(program.out_text, "");
}

static void assert_done(void)
{
	if (program.status != 0)
		fail_msg("exit status %d: %s", program.status, program.err_text);
}

static void help_and_version_are_printed(void **state)
{
	(void)state;
	RUN("--help");
	assert_done();
	const char *commands[] = { "devices", "status", "watch", "record", "stop", "inspect" };
	for (size_t i = 0; i < sizeof commands / sizeof commands[0]; i++) {
		char usage[64];
		RUN("--help");
		assert_contains(program.out_text, commands[i]);
		RUN(commands[i], "-h");
		assert_done();
		assert_contains(program.out_text, "usage: gazectl");
		RUN(commands[i], "--help");
		assert_done();
		snprintf(usage, sizeof usage, "usage: gazectl %s [OPTION]", commands[i]);
		assert_contains(program.out_text, usage);
		assert_contains(program.out_text, "--help");
		assert_string_equal(program.err_text, "");
	}
	RUN("--version");
	assert_done();
	assert_contains(program.out_text, "gazectl ");
}

static void command_lines_not_understood_are_refused(void **state)
{
	(void)state;
	RUN("dance");
	assert_refused(2, "dance: unknown command");
	RUN("status", "--jsom");
	assert_refused(2, "--json");
	RUN("status", "more");
	assert_refused(2, "more: unexpected argument");
	RUN("record", "a", "b");
	assert_refused(2, "b: unexpected argument");
	RUN("inspect");
	assert_refused(2, "no file given");
	RUN("watch", "--count", "x");
	assert_refused(2, "count");
	RUN("stop", "--endpoint", "nonsense");
	assert_refused(2, "an endpoint looks like");
}

static void without_a_daemon_the_remedy_is_told(void **state)
{
	(void)state;
	char expected[256];
	snprintf(expected, sizeof expected,
		 "no daemon answers at ipc://%s/control: start gazed, or give its endpoint with "
		 "--endpoint",
		 getenv("GAZECAST_RUNTIME_DIR"));
	RUN("status");
	assert_refused(3, expected);
	RUN("watch");
	assert_refused(3, expected);
	RUN("record");
	assert_refused(3, expected);
	RUN("stop");
	assert_refused(3, expected);
	RUN("status", "--endpoint", "tcp://127.0.0.1:1");
	assert_refused(3, "no daemon answers at tcp://127.0.0.1:1:");
}

static void status_is_a_table(void **state)
{
	(void)state;
	struct daemon daemon;
	daemon_start(&daemon);
	daemon_run(&daemon);
	RUN("status");
	daemon_stop(&daemon);
	assert_done();
	static const char *const rows[] = {
		"tracker      fake s?7, running\n",
		"rate         199.5 Hz measured, 200 Hz nominal\n",
		"samples      1234\n",
		"lost         5\n",
		"rejected     3 (velocity 3)\n",
		"malformed    2 (short 2)\n",
		"refused      9 (overflow 9)\n",
		"clock        declared tick",
		"noise        0.125 deg",
		"scene        still: no pursuit\n",
		"display      1920x1080 px",
		"validated    2026-01-31T12:00:00Z, 0.75 deg\n             the display has changed "
		"since: "
		"500 mm away, was ?600 mm; run gazectl validate again\n",
		"recording    off\n",
		"subscribers  2\n",
		"version      0.1.0\n",
	};
	for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++)
		assert_contains(program.out_text, rows[i]);
}

static void status_is_json_on_demand(void **state)
{
	(void)state;
	struct daemon daemon;
	daemon_start(&daemon);
	daemon.status.noise_deg = NAN;
	daemon_run(&daemon);
	RUN("status", "--json");
	daemon_stop(&daemon);
	assert_done();
	assert_int_equal(program.out_text[0], '{');
	assert_contains(program.out_text, "\"state\": \"running\"");
	assert_contains(program.out_text, "\"measured\": 199.5");
	assert_contains(program.out_text, "\"velocity\": 3");
	assert_contains(program.out_text, "\"overflow\": 9");
	assert_contains(program.out_text, "\"noise_deg\": null");
	assert_contains(program.out_text, "\"still_scene\": true");
}

static void status_of_what_is_no_daemon_is_refused(void **state)
{
	(void)state;
	struct daemon daemon;
	daemon_start(&daemon); /* and say nothing */
	daemon.stopping = true;
	daemon_run(&daemon);
	RUN("status");
	daemon_stop(&daemon);
	assert_refused(1, "sends no status");
}

static void record_prints_the_file_and_stop_too(void **state)
{
	(void)state;
	struct daemon daemon;
	daemon_start(&daemon);
	daemon_run(&daemon);
	RUN("record", "my-name");
	assert_done();
	assert_string_equal(program.out_text, "/somewhere/my-name.gzl\n");
	RUN("stop");
	assert_done();
	assert_string_equal(program.out_text, "/somewhere/my-name.gzl\n");
	daemon_stop(&daemon);
}

static void refusal_is_passed_on(void **state)
{
	(void)state;
	struct daemon daemon;
	daemon_start(&daemon);
	daemon.refuses = true;
	daemon_run(&daemon);
	RUN("record", "my-name");
	assert_refused(1, "the daemon refuses: no: the disk is ?[31mfull");
	RUN("stop");
	assert_refused(1, "the daemon refuses: no");
	daemon_stop(&daemon);
}

static int count_lines(const char *text)
{
	int lines = 0;
	for (; *text; text++)
		lines += *text == '\n';
	return lines;
}

static void watch_prints_a_line_a_message(void **state)
{
	(void)state;
	struct daemon daemon;
	daemon_start(&daemon);
	daemon_run(&daemon);
	RUN("watch", "--count", "10");
	assert_done();
	assert_int_equal(count_lines(program.out_text), 10);
	assert_contains(program.out_text, " at 0.2500 0.7500 fixation ");
	assert_null(strstr(program.out_text, "status"));
	assert_contains(program.err_text, "10 messages, 0 lost");
	RUN("watch", "status", "--count", "2");
	assert_done();
	assert_int_equal(count_lines(program.out_text), 2);
	assert_contains(program.out_text, "status running 199.5 Hz samples 1234 lost 5");
	daemon_stop(&daemon);
}

static void watch_shows_what_was_lost(void **state)
{
	(void)state;
	struct daemon daemon;
	daemon_start(&daemon);
	program_start(&program, (const char *const[]) { GAZECTL, "watch", "gaze", NULL });
	/* The number of each gaze is ten above that of the one before. */
	const int64_t start_ns = gz_clock_now_ns();
	while (!strstr(program.out_text, " lost 9\n") &&
	       gz_clock_now_ns() - start_ns < GZ_TEST_PATIENCE_S * GZ_NS_PER_S) {
		struct gz_gaze gaze = gaze_at(daemon.seq += 10, 0.5f, 0.5f);
		publisher_send_gaze(&daemon.publisher, &gaze);
		assert_true(program_collect(&program, 1));
	}
	kill(program.process, SIGINT);
	program_finish(&program);
	assert_done();
	assert_contains(program.out_text, " lost 9\n");
	zmq_close(daemon.control);
	publisher_close(&daemon.publisher);
}

static void watch_goes_on_when_the_daemon_dies_and_returns(void **state)
{
	(void)state;
	pid_t process = publisher_process_start("stream", 1000);
	program_start(&program, (const char *const[]) { GAZECTL, "watch", NULL });
	program_wait_for(&program, " gaze 1");
	publisher_process_kill(process);
	program_wait_for(&program, "waiting for it to return");
	process = publisher_process_start("stream", 7000000);
	program_wait_for(&program, "connected again");
	program.out_size = 0;
	program.out_text[0] = '\0';
	program_wait_for(&program, " gaze 7");
	kill(program.process, SIGTERM);
	program_finish(&program);
	publisher_process_kill(process);
	assert_done();
	assert_contains(program.err_text, " 0 lost\n");
}

static void write_file(const char *name, const void *bytes, size_t size, char path[256])
{
	snprintf(path, 256, "%s/%s", getenv("GAZECAST_RUNTIME_DIR"), name);
	FILE *file = fopen(path, "wb");
	assert_non_null(file);
	assert_int_equal(fwrite(bytes, 1, size, file), size);
	assert_int_equal(fclose(file), 0);
}

static void inspect_tells_of_a_whole_log(void **state)
{
	(void)state;
	struct log_text text;
	char path[256];
	log_text_begin(&text);
	log_text_look_right(&text, 0);
	log_text_mark(&text, 11 * GZ_NS_PER_S, "trial \x1b[31m1");
	log_text_end(&text);
	write_file("whole.gzl", text.bytes, text.size, path);
	log_text_free(&text);
	RUN("inspect", path);
	assert_done();
	static const char *const rows[] = {
		"tracker      fake s1\n",
		"file         whole",
		"duration     1.999 s\n",
		"samples      2000\n",
		"rate         1000.00 Hz (1000 Hz nominal)\n",
		"gaps         0, with 0 samples missing",
		"valid        100.00 %, right eye 100.00 %, left eye 100.00 %\n",
		" 1 saccades, 0 blinks\n",
		"intervals    1.000 ms median",
		"     1999 ########################################\n",
		"marks        1\n",
		"1.000 s trial ?[31m1\n",
	};
	for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++)
		assert_contains(program.out_text, rows[i]);
	RUN("inspect", "--json", path);
	assert_done();
	assert_contains(program.out_text, "\"ending\": \"whole\"");
	assert_contains(program.out_text, "\"text\": \"trial \\u001B[31m1\"");
}

static void inspect_tells_of_a_damaged_log_by_its_exit_status(void **state)
{
	(void)state;
	struct log_text text;
	char path[256];
	log_text_begin(&text);
	log_text_look_right(&text, 0);
	size_t cut = text.size - 5;
	log_text_end(&text);
	write_file("cut.gzl", text.bytes, cut, path);
	RUN("inspect", path);
	assert_int_equal(program.status, 4);
	assert_contains(program.out_text, "file         cut");
	assert_contains(program.out_text, "samples      1999\n");
	char *place = memmem(text.bytes, text.size, "0.300000012", 11);
	assert_non_null(place);
	place[2] = '2';
	write_file("changed.gzl", text.bytes, text.size, path);
	log_text_free(&text);
	RUN("inspect", "--json", path);
	assert_int_equal(program.status, 4);
	assert_contains(program.out_text, "\"ending\": \"corrupted\"");
}

static void inspect_of_a_log_without_samples_shows_no_numbers_of_them(void **state)
{
	(void)state;
	static const char text[] = "#gazecast-log 1\n\033[31m = x\n";
	char path[256];
	write_file("headless.gzl", text, sizeof text - 1, path);
	RUN("inspect", path);
	assert_int_equal(program.status, 4);
	assert_contains(program.out_text, "tracker      unknown\n");
	assert_contains(program.out_text, "samples      0\n");
	assert_null(strstr(program.out_text, "nan"));
	assert_null(strstr(program.out_text, "rate"));
	assert_null(strstr(program.out_text, "recorded"));
}

static void inspect_of_what_is_no_log_is_refused(void **state)
{
	(void)state;
	char path[256];
	RUN("inspect", "/nowhere/at-all.gzl");
	assert_refused(1, "/nowhere/at-all.gzl");
	write_file("picture.gzl", "\x89PNG\r\n\x1a\n", 8, path);
	RUN("inspect", path);
	assert_refused(1, "picture.gzl");
	write_file("empty.gzl", "", 0, path);
	RUN("inspect", path);
	assert_refused(1, "empty.gzl");
}

static void full_disk_under_the_output_is_told(void **state)
{
	(void)state;
	if (access("/dev/full", W_OK) != 0)
		skip();
	program_run(&program,
		    (const char *const[]) { "/bin/sh", "-c", GAZECTL " --help >/dev/full", NULL });
	assert_refused(1, "cannot write to standard output");
}

TEST_SUITE(gazectl)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(help_and_version_are_printed),
		cmocka_unit_test(command_lines_not_understood_are_refused),
		cmocka_unit_test(without_a_daemon_the_remedy_is_told),
		cmocka_unit_test(status_is_a_table),
		cmocka_unit_test(status_is_json_on_demand),
		cmocka_unit_test(status_of_what_is_no_daemon_is_refused),
		cmocka_unit_test(record_prints_the_file_and_stop_too),
		cmocka_unit_test(refusal_is_passed_on),
		cmocka_unit_test(watch_prints_a_line_a_message),
		cmocka_unit_test(watch_shows_what_was_lost),
		cmocka_unit_test(watch_goes_on_when_the_daemon_dies_and_returns),
		cmocka_unit_test(inspect_tells_of_a_whole_log),
		cmocka_unit_test(inspect_tells_of_a_damaged_log_by_its_exit_status),
		cmocka_unit_test(inspect_of_a_log_without_samples_shows_no_numbers_of_them),
		cmocka_unit_test(inspect_of_what_is_no_log_is_refused),
		cmocka_unit_test(full_disk_under_the_output_is_told),
	};
	return cmocka_run_group_tests(tests, runtime_directory_make, runtime_directory_remove);
}
