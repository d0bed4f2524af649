/* gazectl and the client library against the real gazed with its simulator. */
#include "suite.h"

#include "client/client.h"
#include "client/stream.h"
#include "program.h"
#include "publisher.h"

#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#include <zmq.h>

#include "base/clock.h"

static struct program daemon_program, program; /* large: not for the stack */

/* With its sockets in the runtime directory and, if @p control is not NULL, on TCP. */
static void daemon_start_with_tcp(const char *rate_hz, const char *control)
{
	const char *directory = getenv("GAZECAST_RUNTIME_DIR");
	program_start(&daemon_program,
		      (const char *const[]) {
			      GAZED, "--tcp", control ? "loopback" : "off", "--control",
			      control ? control : GZ_CONTROL_TCP_ENDPOINT, "--recording.directory",
			      directory, "--sim.rate_hz", rate_hz, NULL });
	program_wait_for(&daemon_program, "sim delivers samples");
}

static void daemon_start(const char *rate_hz)
{
	daemon_start_with_tcp(rate_hz, NULL);
}

static void daemon_end(int signal_number, int expected_status)
{
	assert_int_equal(kill(daemon_program.process, signal_number), 0);
	program_finish(&daemon_program);
	if (daemon_program.status != expected_status)
		fail_msg("gazed left with %d, not %d: %s", daemon_program.status, expected_status,
			 daemon_program.err_text);
}

#define RUN(...) program_run(&program, (const char *const[]) { GAZECTL, __VA_ARGS__, NULL })

/* The daemon of a test that failed must not disturb the next one. */
static int kill_programs(void **state)
{
	(void)state;
	program_kill(&program);
	program_kill(&daemon_program);
	return 0;
}

static void assert_contains(const char *text, const char *part)
{
	if (!strstr(text, part))
		fail_msg("\"%s\" is not in:\n%s", part, text);
}

static void assert_done(void)
{
	if (program.status != 0)
		fail_msg("exit status %d: %s", program.status, program.err_text);
}

static void status_tells_of_the_simulator(void **state)
{
	(void)state;
	daemon_start("500");
	RUN("status");
	daemon_end(SIGTERM, 0);
	assert_done();
	assert_contains(program.out_text, "tracker      sim, running\n");
	assert_contains(program.out_text, "500 Hz nominal\n");
	assert_contains(program.out_text, "recording    off\n");
}

static void recording_is_whole_and_holds_what_was_sent(void **state)
{
	(void)state;
	char path[256], file[300];
	snprintf(path, sizeof path, "%s/take-1.gzl", getenv("GAZECAST_RUNTIME_DIR"));
	snprintf(file, sizeof file, "%s\n", path);
	daemon_start("1000");
	RUN("record", "take-1");
	assert_done();
	assert_string_equal(program.out_text, file);
	RUN("record", "take-2");
	assert_int_equal(program.status, 1);
	assert_contains(program.err_text, "a recording is running");
	RUN("watch", "gaze", "--count", "1000");
	assert_done();
	assert_contains(program.err_text, "1000 messages, 0 lost");
	RUN("stop");
	assert_done();
	assert_string_equal(program.out_text, file);
	RUN("stop");
	assert_int_equal(program.status, 1);
	assert_contains(program.err_text, "no recording is running");
	daemon_end(SIGINT, 0);
	RUN("inspect", path);
	assert_done();
	assert_contains(program.out_text, "file         whole");
	assert_contains(program.out_text, "rate         1000.0");
	const char *samples = strstr(program.out_text, "samples      ");
	assert_non_null(samples);
	/* Nearly all messages: the simulator loses one in a thousand. */
	assert_in_range(strtoull(samples + strlen("samples      "), NULL, 10), 950, 1000000);
	assert_contains(program.out_text, "tracker      sim\n");
}

static void recording_name_outside_the_rules_is_refused(void **state)
{
	(void)state;
	daemon_start("200");
	RUN("record", "../elsewhere");
	daemon_end(SIGTERM, 0);
	assert_int_equal(program.status, 1);
	assert_contains(program.err_text, "the daemon refuses: ");
	assert_string_equal(program.out_text, "");
}

static void watch_survives_a_killed_daemon(void **state)
{
	(void)state;
	daemon_start("500");
	program_start(&program, (const char *const[]) { GAZECTL, "watch", "gaze", NULL });
	program_wait_for(&program, " gaze ");
	daemon_end(SIGKILL, -1);
	program_wait_for(&program, "waiting for it to return");
	daemon_start("500");
	program_wait_for(&program, "connected again");
	program.out_size = 0;
	program.out_text[0] = '\0';
	program_wait_for(&program, " gaze ");
	kill(program.process, SIGINT);
	program_finish(&program);
	daemon_end(SIGTERM, 0);
	assert_done();
}

/* An endpoint on a port that was free a moment ago. */
static void find_free_endpoint(char endpoint[GZ_ENDPOINT_SIZE])
{
	void *context = zmq_ctx_new();
	void *socket = zmq_socket(context, ZMQ_REP);
	size_t size = GZ_ENDPOINT_SIZE;
	assert_int_equal(zmq_bind(socket, "tcp://127.0.0.1:*"), 0);
	assert_int_equal(zmq_getsockopt(socket, ZMQ_LAST_ENDPOINT, endpoint, &size), 0);
	zmq_close(socket);
	zmq_ctx_term(context);
}

static void watch_over_tcp_follows_the_stream_to_another_port(void **state)
{
	(void)state;
	char endpoint[GZ_ENDPOINT_SIZE];
	find_free_endpoint(endpoint);
	daemon_start_with_tcp("500", endpoint);
	program_start(&program, (const char *const[]) { GAZECTL, "watch", "gaze", "--endpoint",
							endpoint, NULL });
	program_wait_for(&program, " gaze ");
	daemon_end(SIGKILL, -1);
	program_wait_for(&program, "waiting for it to return");
	daemon_start_with_tcp("500", endpoint);
	/* The system chooses the port: nearly always another one. */
	program.out_size = 0;
	program.out_text[0] = '\0';
	program_wait_for(&program, " gaze ");
	kill(program.process, SIGINT);
	program_finish(&program);
	daemon_end(SIGTERM, 0);
	assert_done();
}

static void latest_is_young_at_any_pace_of_the_reader(void **state)
{
	(void)state;
	struct gz_client *client = NULL;
	assert_int_equal(gz_client_open(NULL, NULL, &client), GZ_OK);
	daemon_start("1000");
	struct gz_gaze gaze;
	int64_t deadline_ns = gz_clock_now_ns() + PATIENCE_NS, age_ns, best_ns = INT64_MAX;
	while (gz_client_latest(client, &gaze, NULL) != GZ_OK)
		assert_true(gz_clock_now_ns() < deadline_ns);
	/* 50 a second of 1000; the simulated tracker itself takes 4 ms. */
	for (int i = 0; i < 20; i++) {
		gz_clock_sleep_until_ns(gz_clock_now_ns() + 20 * GZ_NS_PER_MS);
		assert_int_equal(gz_client_latest(client, &gaze, &age_ns), GZ_OK);
		best_ns = age_ns < best_ns ? age_ns : best_ns;
	}
	struct gz_client_counters counters;
	gz_client_get_counters(client, &counters);
	daemon_end(SIGTERM, 0);
	gz_client_close(&client);
	print_message("youngest %.2f ms, %llu of 400 skipped\n", gz_ns_to_ms(best_ns),
		      (unsigned long long)counters.skipped);
	assert_in_range(best_ns, 0, 20 * SLOWNESS * GZ_NS_PER_MS);
	assert_true(counters.skipped > 100);
}

static void python_reader_prints_the_gaze(void **state)
{
	(void)state;
	if (system("/usr/bin/python3 -c 'import msgpack, zmq' 2>/dev/null") != 0)
		skip();
	daemon_start("200");
	char endpoint[256];
	snprintf(endpoint, sizeof endpoint, "ipc://%s/latest", getenv("GAZECAST_RUNTIME_DIR"));
	program_run(&program, (const char *const[]) { "/usr/bin/python3", PYTHON_READER, endpoint,
						      "5", NULL });
	daemon_end(SIGTERM, 0);
	assert_done();
	assert_contains(program.out_text, " s  x 0.");
	assert_contains(program.out_text, "  y 0.");
}

#define TEST(function) cmocka_unit_test_teardown(function, kill_programs)

TEST_SUITE(gazed)
{
	const struct CMUnitTest tests[] = {
		TEST(status_tells_of_the_simulator),
		TEST(recording_is_whole_and_holds_what_was_sent),
		TEST(recording_name_outside_the_rules_is_refused),
		TEST(watch_survives_a_killed_daemon),
		TEST(watch_over_tcp_follows_the_stream_to_another_port),
		TEST(latest_is_young_at_any_pace_of_the_reader),
		TEST(python_reader_prints_the_gaze),
	};
	return cmocka_run_group_tests(tests, runtime_directory_make, runtime_directory_remove);
}
