#include "suite.h"

#include "client/control.h"
#include "publisher.h"

#include <pthread.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <zmq.h>

#include "base/clock.h"

/* A daemon's control socket that the test plays: one request at a time. */
struct server {
	void *context;
	void *socket;
	char endpoint[GZ_ENDPOINT_SIZE];
};

static void server_open(struct server *server, int type, const char *endpoint)
{
	server->context = zmq_ctx_new();
	server->socket = zmq_socket(server->context, type);
	const int none = 0, patience_ms = 10000;
	zmq_setsockopt(server->socket, ZMQ_LINGER, &none, sizeof none);
	zmq_setsockopt(server->socket, ZMQ_RCVTIMEO, &patience_ms, sizeof patience_ms);
	assert_int_equal(zmq_bind(server->socket, endpoint), 0);
	size_t size = sizeof server->endpoint;
	assert_int_equal(zmq_getsockopt(server->socket, ZMQ_LAST_ENDPOINT, server->endpoint, &size),
			 0);
}

static void server_open_local(struct server *server, int type)
{
	char endpoint[GZ_ENDPOINT_SIZE];
	assert_int_equal(gz_endpoint_ipc(getenv("GAZECAST_RUNTIME_DIR"), "control", endpoint,
					 sizeof endpoint),
			 GZ_OK);
	server_open(server, type, endpoint);
}

static void server_close(struct server *server)
{
	zmq_close(server->socket);
	zmq_ctx_term(server->context);
}

/* One request, sent on a thread of its own so that the test can play the daemon. */
struct question {
	struct gz_control *control;
	const char *request;
	int timeout_ms;
	enum gz_result result;
	char reply[GZ_CONTROL_REPLY_SIZE];
	pthread_t thread;
};

static void *ask(void *user)
{
	struct question *question = user;
	question->result = gz_control_request(question->control, question->request,
					      question->timeout_ms, question->reply);
	return NULL;
}

static void question_start(struct question *question)
{
	assert_int_equal(pthread_create(&question->thread, NULL, ask, question), 0);
}

static void question_finish(struct question *question)
{
	assert_int_equal(pthread_join(question->thread, NULL), 0);
}

static void server_expect(struct server *server, const char *request)
{
	char text[256];
	int size = zmq_recv(server->socket, text, sizeof text - 1, 0);
	assert_true(size >= 0);
	text[size] = '\0';
	assert_string_equal(text, request);
}

/* Ask @p request and answer with @p size bytes at @p reply. */
static struct question exchange(struct server *server, struct gz_control *control,
				const char *request, const void *reply, size_t size)
{
	struct question question = { .control = control, .request = request, .timeout_ms = 5000 };
	question_start(&question);
	server_expect(server, request);
	assert_true(zmq_send(server->socket, reply, size, 0) >= 0);
	question_finish(&question);
	return question;
}

static struct gz_control *open_control(const char *endpoint)
{
	struct gz_control *control = NULL;
	assert_int_equal(gz_control_open(endpoint, NULL, &control), GZ_OK);
	return control;
}

static void request_without_a_daemon_times_out_each_time(void **state)
{
	(void)state;
	struct gz_control *control = open_control(NULL);
	char reply[GZ_CONTROL_REPLY_SIZE] = "untouched";
	for (int i = 0; i < 3; i++) {
		int64_t start_ns = gz_clock_now_ns();
		assert_int_equal(gz_control_request(control, "v", 20, reply), GZ_ERR_TIMEOUT);
		assert_in_range(gz_clock_now_ns() - start_ns, 19 * GZ_NS_PER_MS, 2 * GZ_NS_PER_S);
	}
	assert_string_equal(reply, "untouched");
	assert_int_equal(gz_control_request(control, "v", 0, reply), GZ_ERR_INVAL);
	gz_control_close(&control);
	assert_null(control);
	gz_control_close(&control);
}

static void open_with_what_is_no_endpoint_is_refused(void **state)
{
	(void)state;
	const char *refused[] = { "", "nonsense", "tcp://127.0.0.1" };
	for (size_t i = 0; i < sizeof refused / sizeof refused[0]; i++) {
		struct gz_control *control = NULL;
		assert_int_equal(gz_control_open(refused[i], NULL, &control), GZ_ERR_INVAL);
		assert_null(control);
	}
}

static void request_is_answered(void **state)
{
	(void)state;
	struct server server;
	struct gz_control *control = open_control(NULL);
	server_open_local(&server, ZMQ_REP);
	struct question question = exchange(&server, control, "R my-name", "OK", 2);
	assert_int_equal(question.result, GZ_OK);
	assert_string_equal(question.reply, "OK");
	question = exchange(&server, control, "v", "", 0);
	assert_int_equal(question.result, GZ_OK);
	assert_string_equal(question.reply, "");
	gz_control_close(&control);
	server_close(&server);
}

static void malformed_replies_are_refused(void **state)
{
	(void)state;
	struct server server;
	struct gz_control *control = open_control(NULL);
	server_open_local(&server, ZMQ_REP);
	struct question question = exchange(&server, control, "v", "a\0b", 3);
	assert_int_equal(question.result, GZ_ERR_PROTOCOL);
	char large[GZ_CONTROL_REPLY_SIZE];
	memset(large, 'a', sizeof large);
	question = exchange(&server, control, "v", large, sizeof large);
	assert_int_equal(question.result, GZ_ERR_PROTOCOL);
	question = exchange(&server, control, "v", large, sizeof large - 1);
	assert_int_equal(question.result, GZ_OK);
	assert_int_equal(strlen(question.reply), sizeof large - 1);
	gz_control_close(&control);
	server_close(&server);
}

/* Receive the frames of a request: the return address, an empty one and the text. */
struct envelope {
	char way_back[64];
	int way_back_size;
	char text[64];
};

static struct envelope receive_envelope(struct server *server)
{
	struct envelope envelope = { 0 };
	envelope.way_back_size = zmq_recv(server->socket, envelope.way_back, 64, 0);
	assert_in_range(envelope.way_back_size, 1, 64);
	assert_int_equal(zmq_recv(server->socket, envelope.text, 64, 0), 0);
	assert_true(zmq_recv(server->socket, envelope.text, 63, 0) >= 0);
	return envelope;
}

static void send_envelope(struct server *server, const struct envelope *envelope, const char *reply)
{
	zmq_send(server->socket, envelope->way_back, (size_t)envelope->way_back_size, ZMQ_SNDMORE);
	zmq_send(server->socket, "", 0, ZMQ_SNDMORE);
	zmq_send(server->socket, reply, strlen(reply), 0);
}

static void late_reply_is_never_taken_for_the_next(void **state)
{
	(void)state;
	struct server server;
	struct gz_control *control = open_control(NULL);
	server_open_local(&server, ZMQ_ROUTER);
	struct question hung = { .control = control, .request = "first", .timeout_ms = 200 };
	question_start(&hung);
	struct envelope first = receive_envelope(&server);
	question_finish(&hung);
	assert_int_equal(hung.result, GZ_ERR_TIMEOUT);

	struct question next = { .control = control, .request = "second", .timeout_ms = 5000 };
	question_start(&next);
	struct envelope second = receive_envelope(&server);
	assert_string_equal(second.text, "second");
	send_envelope(&server, &first, "to the first");
	send_envelope(&server, &second, "to the second");
	question_finish(&next);
	assert_int_equal(next.result, GZ_OK);
	assert_string_equal(next.reply, "to the second");
	gz_control_close(&control);
	server_close(&server);
}

static void stream_of_a_local_daemon_is_its_neighbour(void **state)
{
	(void)state;
	struct gz_control *control = open_control("ipc:///tmp/somewhere/control");
	char text[GZ_ENDPOINT_SIZE];
	assert_int_equal(gz_control_stream_endpoint(control, 10, text, sizeof text), GZ_OK);
	assert_string_equal(text, "ipc:///tmp/somewhere/stream");
	char small[8] = "kept";
	assert_int_equal(gz_control_stream_endpoint(control, 10, small, sizeof small), GZ_ERR_FULL);
	assert_string_equal(small, "kept");
	gz_control_close(&control);
}

struct stream_question {
	struct gz_control *control;
	enum gz_result result;
	char text[GZ_ENDPOINT_SIZE];
};

static void *ask_stream(void *user)
{
	struct stream_question *question = user;
	question->result = gz_control_stream_endpoint(question->control, 5000, question->text,
						      sizeof question->text);
	return NULL;
}

static struct stream_question exchange_stream(struct server *server, const char *reply)
{
	struct stream_question question = { .control = open_control(server->endpoint) };
	pthread_t thread;
	assert_int_equal(pthread_create(&thread, NULL, ask_stream, &question), 0);
	server_expect(server, "SUB_PORT");
	assert_true(zmq_send(server->socket, reply, strlen(reply), 0) >= 0);
	assert_int_equal(pthread_join(thread, NULL), 0);
	gz_control_close(&question.control);
	return question;
}

static void stream_of_a_tcp_daemon_has_the_port_it_tells(void **state)
{
	(void)state;
	struct server server;
	server_open(&server, ZMQ_REP, "tcp://127.0.0.1:*");
	struct stream_question question = exchange_stream(&server, "41231");
	assert_int_equal(question.result, GZ_OK);
	assert_string_equal(question.text, "tcp://127.0.0.1:41231");
	const char *refused[] = { "", "no tcp", "0", "65536", "-1", "12x" };
	for (size_t i = 0; i < sizeof refused / sizeof refused[0]; i++) {
		question = exchange_stream(&server, refused[i]);
		assert_int_equal(question.result, GZ_ERR_UNSUPPORTED);
	}
	server_close(&server);
}

TEST_SUITE(control)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(request_without_a_daemon_times_out_each_time),
		cmocka_unit_test(open_with_what_is_no_endpoint_is_refused),
		cmocka_unit_test(request_is_answered),
		cmocka_unit_test(malformed_replies_are_refused),
		cmocka_unit_test(late_reply_is_never_taken_for_the_next),
		cmocka_unit_test(stream_of_a_local_daemon_is_its_neighbour),
		cmocka_unit_test(stream_of_a_tcp_daemon_has_the_port_it_tells),
	};
	return cmocka_run_group_tests(tests, runtime_directory_make, runtime_directory_remove);
}
