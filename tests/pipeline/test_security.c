/* Who can read the gaze: keys, refusals and what is logged about them, with real sockets. */
#include "suite.h"

#include <arpa/inet.h>
#include <errno.h>
#include <netinet/in.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>
#include <zmq.h>

#include "base/captured_log.h"
#include "base/clock.h"
#include "client/gazecast.h"
#include "client/program.h"
#include "gazed_process.h"
#include "protocol/key.h"

enum { ATTEMPTS = 8 };

static struct gazed_place place;
static char server_directory[80], client_directory[80]; /* of keys */
static char control[64];                                /* the endpoint */
static struct captured_log captured;
static struct program program;

static void remove_directory(const char *path)
{
	static const char *const names[] = { GZ_SERVER_KEY_FILE,        GZ_CLIENT_KEY_FILE,
					     GZ_SERVER_KEY_FILE ".pub", GZ_CLIENT_KEY_FILE ".pub",
					     GZ_AUTHORIZED_KEYS_FILE,   GZ_KNOWN_SERVERS_FILE };
	char file[128];
	for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
		snprintf(file, sizeof file, "%s/%s", path, names[i]);
		unlink(file);
	}
	rmdir(path);
}

static void write_file(const char *directory, const char *name, const char *text)
{
	char path[128];
	snprintf(path, sizeof path, "%s/%s", directory, name);
	FILE *file = fopen(path, "w");
	assert_non_null(file);
	fputs(text, file);
	assert_int_equal(fclose(file), 0);
}

static const char *read_key(const char *directory, const char *name)
{
	static char key[2][GZ_KEY_TEXT_SIZE];
	static int turn;
	char path[128], *out = key[turn = !turn];
	snprintf(path, sizeof path, "%s/%s.pub", directory, name);
	FILE *file = fopen(path, "r");
	assert_non_null(file);
	assert_non_null(fgets(out, GZ_KEY_TEXT_SIZE, file));
	fclose(file);
	return out;
}

#define GAZECTL_RUN(...) program_run(&program, (const char *const[]) { GAZECTL, __VA_ARGS__, NULL })

/* A port that was free a moment ago, below those that the system gives to whoever asks for any
 * (ip(7), ip_local_port_range): other tests connect while this one waits. */
static int free_port(void)
{
	static unsigned turn;
	for (int i = 0; i < 1000; i++) {
		struct sockaddr_in address = { .sin_family = AF_INET };
		const int port = 10240 + (int)(((unsigned)getpid() * 31 + 97 * turn++) % 20000);
		address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
		address.sin_port = htons((uint16_t)port);
		int fd = socket(AF_INET, SOCK_STREAM, 0);
		const bool is_free = bind(fd, (struct sockaddr *)&address, sizeof address) == 0;
		close(fd);
		if (is_free)
			return port;
	}
	fail_msg("no port is free");
	return 0;
}

static int set_up(void **state)
{
	(void)state;
	gazed_place_make(&place);
	captured_log_init(&captured, NULL);
	snprintf(server_directory, sizeof server_directory, "%s/server", place.directory);
	snprintf(client_directory, sizeof client_directory, "%s/gazecast", place.directory);
	snprintf(control, sizeof control, "tcp://127.0.0.1:%d", free_port());
	/* Where the client library looks for keys. */
	setenv("XDG_CONFIG_HOME", place.directory, 1);
	GAZECTL_RUN("keygen", "--server", "--keys", server_directory);
	assert_int_equal(program.status, 0);
	GAZECTL_RUN("keygen", "--client", "anna@desk");
	assert_int_equal(program.status, 0);
	return 0;
}

static int tear_down(void **state)
{
	(void)state;
	gazed_kill_all();
	remove_directory(server_directory);
	remove_directory(client_directory);
	gazed_place_remove(&place);
	return 0;
}

static void authorize(const char *key)
{
	char line[128];
	snprintf(line, sizeof line, "# who may come\n%s anna@desk\n", key);
	write_file(server_directory, GZ_AUTHORIZED_KEYS_FILE, line);
}

static void know_server(const char *key)
{
	char line[128];
	snprintf(line, sizeof line, "localhost,127.0.0.1 %s\n", key);
	write_file(client_directory, GZ_KNOWN_SERVERS_FILE, line);
}

static struct gazed_process spawn(const char *const *arguments)
{
	struct gazed_process process;
	gazed_spawn(&(struct gazed_start) { .place = &place, .arguments = arguments }, &process);
	return process;
}

static struct gazed_process start_curve(void)
{
	struct gazed_process gazed = spawn((const char *const[]) {
		"--tcp=curve", "--control", control, "--network.keys", server_directory, NULL });
	gazed_wait_ready(&place, &gazed);
	return gazed;
}

/* How often the daemon has logged @p text. */
static int count_said(const struct gazed_process *gazed, const char *text)
{
	int count = 0;
	for (const char *at = gazed_said(gazed); (at = strstr(at, text)); at++)
		count++;
	return count;
}

static void wait_said(const struct gazed_process *gazed, const char *text)
{
	int64_t deadline_ns = gz_clock_now_ns() + PATIENCE_NS;
	while (count_said(gazed, text) == 0) {
		if (gz_clock_now_ns() > deadline_ns)
			fail_msg("gazed does not say \"%s\" but: %s", text, gazed_said(gazed));
		gz_clock_sleep_until_ns(gz_clock_now_ns() + GZ_NS_PER_MS);
	}
}

static enum gz_result ask(const struct gz_keys *keys, int timeout_ms)
{
	struct gz_control *asked;
	char reply[GZ_CONTROL_REPLY_SIZE];
	assert_int_equal(gz_control_open_with_keys(control, keys, &captured.log, &asked), GZ_OK);
	enum gz_result result = gz_control_request(asked, "v", timeout_ms, reply);
	gz_control_close(&asked);
	return result;
}

static struct gz_keys own_keys(void)
{
	struct gz_keys keys;
	assert_int_equal(gz_keys_find(control, NULL, read_key(server_directory, GZ_SERVER_KEY_FILE),
				      &captured.log, &keys),
			 GZ_OK);
	return keys;
}

static void must_be_let_in(const struct gz_keys *keys)
{
	enum gz_result result = ask(keys, PATIENCE_MS);
	if (result != GZ_OK)
		fail_msg("%s: %s", gz_result_text(result), captured.last);
}

static void must_be_refused(const struct gz_keys *keys, const char *why)
{
	enum gz_result result = ask(keys, PATIENCE_MS);
	if (result != GZ_ERR_ACCESS || !strstr(captured.last, why))
		fail_msg("%s: %s, not %s", gz_result_text(result), captured.last, why);
}

/* Be refused until the daemon has logged @p text with our address. If a connection has closed
 * before the daemon reads its address, it logs "an unknown address" instead. */
static void be_refused_until_said(const struct gz_keys *keys, const char *why,
				  const struct gazed_process *gazed, const char *text)
{
	int64_t deadline_ns = gz_clock_now_ns() + PATIENCE_NS;
	while (count_said(gazed, text) == 0) {
		if (gz_clock_now_ns() > deadline_ns)
			fail_msg("gazed does not say \"%s\" but: %s", text, gazed_said(gazed));
		must_be_refused(keys, why);
	}
}

/* A TCP port of the daemon, asked for over its local socket. */
static int port_by(const char *request)
{
	int port = atoi(gazed_request(&place, request, NULL));
	assert_true(port > 0);
	return port;
}

static void receive_latest(struct gz_client *client)
{
	struct gz_gaze gaze;
	int64_t deadline_ns = gz_clock_now_ns() + PATIENCE_NS;
	while (gz_client_latest(client, &gaze, NULL) != GZ_OK) {
		if (gz_clock_now_ns() > deadline_ns)
			fail_msg("no gaze: %s", captured.last);
		gz_clock_sleep_until_ns(gz_clock_now_ns() + GZ_NS_PER_MS);
	}
}

static void curve_authorised_client_reads_stream_latest_and_control(void **state)
{
	(void)state;
	char endpoint[64];
	struct gz_control *asked;
	struct gz_stream *stream;
	struct gz_client *client;
	struct gz_message message;
	authorize(read_key(client_directory, GZ_CLIENT_KEY_FILE));
	know_server(read_key(server_directory, GZ_SERVER_KEY_FILE));
	struct gazed_process gazed = start_curve();

	/* With the usual files, without naming keys. */
	assert_int_equal(gz_control_open(control, &captured.log, &asked), GZ_OK);
	assert_non_null(gz_control_keys(asked));
	assert_int_equal(gz_control_stream_endpoint(asked, PATIENCE_MS, endpoint, sizeof endpoint),
			 GZ_OK);
	assert_int_equal(gz_stream_open(endpoint, NULL, &captured.log, &stream), GZ_OK);
	assert_int_equal(gz_stream_read(stream, PATIENCE_MS, &message), GZ_OK);
	snprintf(endpoint, sizeof endpoint, "tcp://127.0.0.1:%d", port_by("LATEST_PORT"));
	assert_int_equal(gz_client_open(endpoint, &captured.log, &client), GZ_OK);
	receive_latest(client);
	gz_client_close(&client);
	gz_stream_close(&stream);
	gz_control_close(&asked);
	assert_int_equal(count_said(&gazed, "is let in with the key of \"anna@desk\""), 1);
	assert_int_equal(count_said(&gazed, "refused"), 0);

	GAZECTL_RUN("status", "--endpoint", control);
	if (program.status != 0)
		fail_msg("gazectl: %s", program.err_text);
	assert_int_equal(gazed_stop(&gazed, SIGTERM), 0);
}

static void curve_serves_ipv6_as_well(void **state)
{
	(void)state;
	char endpoint[64];
	const struct sockaddr_in6 loopback = { .sin6_family = AF_INET6,
					       .sin6_addr = IN6ADDR_LOOPBACK_INIT };
	int fd = socket(AF_INET6, SOCK_STREAM, 0);
	bool there = fd >= 0 && bind(fd, (const struct sockaddr *)&loopback, sizeof loopback) == 0;
	if (fd >= 0)
		close(fd);
	if (!there)
		skip(); /* this machine has no IPv6 */
	authorize(read_key(client_directory, GZ_CLIENT_KEY_FILE));
	snprintf(endpoint, sizeof endpoint, "tcp://[::1]:%d", free_port());
	snprintf(control, sizeof control, "%s", endpoint);
	struct gz_keys keys = own_keys();
	struct gazed_process gazed =
		spawn((const char *const[]) { "--tcp=curve", "--control", control, "--network.keys",
					      server_directory, "--network.address=[::1]", NULL });
	gazed_wait_ready(&place, &gazed);
	must_be_let_in(&keys);
	assert_int_equal(count_said(&gazed, "::1 is let in with the key"), 1);
	struct gz_client *client;
	snprintf(endpoint, sizeof endpoint, "tcp://[::1]:%d", port_by("LATEST_PORT"));
	assert_int_equal(gz_client_open_with_keys(endpoint, &keys, &captured.log, &client), GZ_OK);
	receive_latest(client);
	gz_client_close(&client);
	assert_int_equal(gazed_stop(&gazed, SIGTERM), 0);
}

static void curve_unknown_key_is_refused_each_time_and_logged_once(void **state)
{
	(void)state;
	struct gz_keys keys = own_keys();
	authorize(read_key(server_directory, GZ_SERVER_KEY_FILE)); /* of another client */
	struct gazed_process gazed = start_curve();
	for (int i = 0; i < ATTEMPTS; i++) {
		must_be_refused(&keys, "refuses our key; add this line to authorized_keys");
		assert_non_null(strstr(captured.last, keys.public_key));
	}
	if (count_said(&gazed, "127.0.0.1 is refused: its key is not in") != 1)
		fail_msg("not once: %s", gazed_said(&gazed));
	assert_int_equal(count_said(&gazed, keys.public_key), 1);
	assert_int_equal(gazed_stop(&gazed, SIGTERM), 0);
}

static void curve_unknown_key_hears_nothing_of_the_stream(void **state)
{
	(void)state;
	char endpoint[64];
	struct gz_keys keys = own_keys();
	struct gz_stream *stream;
	struct gz_stream_counters counters;
	struct gz_message message;
	struct gazed_process gazed = start_curve();
	snprintf(endpoint, sizeof endpoint, "tcp://127.0.0.1:%d", port_by("SUB_PORT"));
	assert_int_equal(gz_stream_open_with_keys(endpoint, NULL, &keys, &captured.log, &stream),
			 GZ_OK);
	int64_t deadline_ns = gz_clock_now_ns() + PATIENCE_NS;
	while (!strstr(captured.last, "refuses our key") && gz_clock_now_ns() < deadline_ns)
		assert_int_equal(gz_stream_read(stream, 20, &message), GZ_ERR_TIMEOUT);
	assert_non_null(strstr(captured.last, "refuses our key"));
	gz_stream_get_counters(stream, &counters);
	assert_int_equal(counters.connections, 0);
	gz_stream_close(&stream);
	assert_int_equal(gazed_stop(&gazed, SIGTERM), 0);
}

static void curve_wrong_server_key_is_logged_once_on_both_sides(void **state)
{
	(void)state;
	struct gz_keys keys = own_keys(), wrong = keys;
	memcpy(wrong.server_key, wrong.public_key, sizeof wrong.server_key);
	authorize(keys.public_key);
	struct gazed_process gazed = start_curve();
	must_be_refused(&wrong, "most likely its server key is not the one");
	assert_int_equal(captured.messages, 1);
	for (int i = 0; i < ATTEMPTS; i++)
		must_be_refused(&wrong, "most likely its server key is not the one");
	be_refused_until_said(
		&wrong, "most likely its server key is not the one", &gazed,
		"127.0.0.1 at socket control is refused: it has the key of another server");
	must_be_let_in(&keys);
	/* There is at most one more line, for connections that had closed before their address was
	 * read. */
	if (count_said(&gazed, "127.0.0.1 at socket control is refused") != 1 ||
	    count_said(&gazed, "it has the key of another server") > 2)
		fail_msg("not once: %s", gazed_said(&gazed));
	assert_int_equal(gazed_stop(&gazed, SIGTERM), 0);
}

static void curve_client_without_keys_is_told_what_it_needs(void **state)
{
	(void)state;
	authorize(read_key(client_directory, GZ_CLIENT_KEY_FILE));
	struct gz_keys keys = own_keys();
	struct gazed_process gazed = start_curve();
	for (int i = 0; i < ATTEMPTS; i++)
		must_be_refused(NULL, "requires keys: run gazectl keygen --client");
	be_refused_until_said(NULL, "requires keys: run gazectl keygen --client", &gazed,
			      "127.0.0.1 at socket control is refused: it has no keys");
	must_be_let_in(&keys);
	if (count_said(&gazed, "127.0.0.1 at socket control is refused") != 1)
		fail_msg("not once: %s", gazed_said(&gazed));
	assert_int_equal(gazed_stop(&gazed, SIGTERM), 0);
}

/* Connect to the control socket and close at once. */
static void leave_in_the_handshake(int family, const struct sockaddr *address, socklen_t size)
{
	int fd = socket(family, SOCK_STREAM | SOCK_CLOEXEC, 0);
	assert_true(fd >= 0);
	assert_return_code(connect(fd, address, size), errno);
	close(fd);
}

static void curve_client_that_leaves_in_the_handshake_is_logged_unless_it_is_local(void **state)
{
	(void)state;
	static const char text[] = "at socket control does not finish the handshake";
	char endpoint[64];
	struct gz_client *client;
	struct gz_keys keys = own_keys();
	authorize(keys.public_key);
	struct gazed_process gazed = start_curve();
	struct sockaddr_un local = { .sun_family = AF_UNIX };
	struct sockaddr_in remote = { .sin_family = AF_INET };
	snprintf(local.sun_path, sizeof local.sun_path, "%s/control", place.directory);
	remote.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
	remote.sin_port = htons((uint16_t)atoi(strrchr(control, ':') + 1));
	for (int i = 0; i < ATTEMPTS; i++)
		leave_in_the_handshake(AF_UNIX, (struct sockaddr *)&local, sizeof local);
	snprintf(endpoint, sizeof endpoint, "tcp://127.0.0.1:%d", port_by("LATEST_PORT"));
	assert_int_equal(gz_client_open_with_keys(endpoint, &keys, &captured.log, &client), GZ_OK);
	receive_latest(client); /* the daemon has heard of the local connections before this one */
	gz_client_close(&client);
	if (count_said(&gazed, text) != 0)
		fail_msg("%s", gazed_said(&gazed));
	for (int i = 0; i < ATTEMPTS; i++)
		leave_in_the_handshake(AF_INET, (struct sockaddr *)&remote, sizeof remote);
	wait_said(&gazed, text);
	assert_int_equal(gazed_stop(&gazed, SIGTERM), 0);
	/* Once with the address and once without. */
	assert_in_range(count_said(&gazed, text), 1, 2);
}

static void client_with_keys_is_told_that_the_daemon_has_none(void **state)
{
	(void)state;
	struct gz_keys keys = own_keys();
	struct gazed_process gazed =
		spawn((const char *const[]) { "--tcp=loopback", "--control", control, NULL });
	gazed_wait_ready(&place, &gazed);
	/* libzmq reports one or the other, depending on how the bytes arrive. */
	enum gz_result result = ask(&keys, PATIENCE_MS);
	assert_int_equal(result, GZ_ERR_ACCESS);
	if (!strstr(captured.last, "does not use keys") &&
	    !strstr(captured.last, "closes the connection"))
		fail_msg("%s", captured.last);
	assert_int_equal(gazed_stop(&gazed, SIGTERM), 0);
}

static void curve_authorized_keys_are_read_again_when_they_change(void **state)
{
	(void)state;
	struct gz_keys keys = own_keys();
	struct gazed_process gazed = start_curve(); /* without the file */
	assert_int_equal(count_said(&gazed, "does not exist, so no client is let in"), 1);
	must_be_refused(&keys, "refuses our key");
	authorize(keys.public_key);
	must_be_let_in(&keys);
	authorize(keys.server_key);
	must_be_refused(&keys, "refuses our key");
	write_file(server_directory, GZ_AUTHORIZED_KEYS_FILE, "no key at all\n");
	must_be_refused(&keys, "refuses our key");
	assert_int_equal(count_said(&gazed, "authorized_keys:1: no key of 40 characters"), 1);
	authorize(keys.public_key);
	must_be_let_in(&keys);
	char path[128];
	snprintf(path, sizeof path, "%s/" GZ_AUTHORIZED_KEYS_FILE, server_directory);
	assert_int_equal(chmod(path, 0666), 0);
	must_be_refused(&keys, "refuses our key");
	assert_int_equal(count_said(&gazed, "authorized_keys can be written by others"), 1);
	assert_int_equal(gazed_stop(&gazed, SIGTERM), 0);
}

/* Refused clients that connect again at once, each of them as long as the test lasts. */
static void curve_flood_of_refused_clients_takes_nothing_from_a_reader(void **state)
{
	(void)state;
	enum { CLIENTS = 32, SAMPLES = 1000 };
	char endpoint[64];
	struct gz_keys keys = own_keys();
	struct gazed_process gazed = spawn((const char *const[]) {
		"--tcp=curve", "--control", control, "--network.keys", server_directory,
		"--sim.rate_hz", "500", "--sim.loss", "0", NULL });
	gazed_wait_ready(&place, &gazed);
	snprintf(endpoint, sizeof endpoint, "tcp://127.0.0.1:%d", port_by("SUB_PORT"));
	void *context = zmq_ctx_new(), *flood[CLIENTS];
	const int linger = 0, again_ms = 1;
	for (int i = 0; i < CLIENTS; i++) {
		/* Half of them have an unknown key, with which libzmq gives up, half a wrong server
		 * key. */
		const char *server = i % 2 ? keys.public_key : keys.server_key;
		flood[i] = zmq_socket(context, ZMQ_SUB);
		zmq_setsockopt(flood[i], ZMQ_LINGER, &linger, sizeof linger);
		zmq_setsockopt(flood[i], ZMQ_RECONNECT_IVL, &again_ms, sizeof again_ms);
		zmq_setsockopt(flood[i], ZMQ_CURVE_SERVERKEY, server, GZ_KEY_TEXT_SIZE);
		zmq_setsockopt(flood[i], ZMQ_CURVE_PUBLICKEY, keys.public_key, GZ_KEY_TEXT_SIZE);
		zmq_setsockopt(flood[i], ZMQ_CURVE_SECRETKEY, keys.secret_key, GZ_KEY_TEXT_SIZE);
		assert_int_equal(zmq_connect(flood[i], endpoint), 0);
	}
	struct gz_stream *stream;
	struct gz_stream_counters counters = { 0 };
	struct gz_message message;
	assert_int_equal(gz_stream_open(NULL, NULL, &captured.log, &stream), GZ_OK);
	for (int samples = 0; samples < SAMPLES;) {
		assert_int_equal(gz_stream_read(stream, PATIENCE_MS, &message), GZ_OK);
		samples += message.kind == GZ_MESSAGE_GAZE;
	}
	gz_stream_get_counters(stream, &counters);
	assert_int_equal(counters.lost, 0);
	gz_stream_close(&stream);
	for (int i = 0; i < CLIENTS; i++)
		zmq_close(flood[i]);
	zmq_ctx_term(context);
	/* One line for each reason, and one for connections that had closed before their address
	 * was read. */
	if (count_said(&gazed, "is refused") > 3)
		fail_msg("%s", gazed_said(&gazed));
	assert_int_equal(count_said(&gazed, "127.0.0.1 is refused: its key is not in"), 1);
	assert_int_equal(gazed_stop(&gazed, SIGTERM), 0);
}

/* A reader whose key is known, but who subscribes without an end. */
static void curve_flood_of_subscriptions_is_ended(void **state)
{
	(void)state;
	enum { TOPICS = 20000, SAMPLES = 200, MEMORY_KIB = 8192 };
	char endpoint[64], topic[200];
	struct gz_keys keys = own_keys();
	authorize(keys.public_key);
	struct gazed_process gazed = start_curve();
	snprintf(endpoint, sizeof endpoint, "tcp://127.0.0.1:%d", port_by("SUB_PORT"));
	/* All is ready before the reader opens, which would lose what comes while it does not read.
	 */
	void *context = zmq_ctx_new(), *flood = zmq_socket(context, ZMQ_SUB);
	const int zero = 0;
	zmq_setsockopt(flood, ZMQ_LINGER, &zero, sizeof zero);
	zmq_setsockopt(flood, ZMQ_SNDHWM, &zero, sizeof zero);
	zmq_setsockopt(flood, ZMQ_CURVE_SERVERKEY, keys.server_key, GZ_KEY_TEXT_SIZE);
	zmq_setsockopt(flood, ZMQ_CURVE_PUBLICKEY, keys.public_key, GZ_KEY_TEXT_SIZE);
	zmq_setsockopt(flood, ZMQ_CURVE_SECRETKEY, keys.secret_key, GZ_KEY_TEXT_SIZE);
	memset(topic, 'x', sizeof topic);
	for (int i = 0; i < TOPICS; i++) {
		snprintf(topic, 16, "%d", i);
		zmq_setsockopt(flood, ZMQ_SUBSCRIBE, topic, sizeof topic);
	}
	struct gz_stream *stream;
	struct gz_message message;
	assert_int_equal(gz_stream_open_with_keys(endpoint, NULL, &keys, &captured.log, &stream),
			 GZ_OK);
	assert_int_equal(gz_stream_read(stream, PATIENCE_MS, &message), GZ_OK);
	long before_kib = gazed_resident_kib(&gazed);
	assert_int_equal(zmq_connect(flood, endpoint), 0);
	/* Its connection is ended; the other reader misses nothing. */
	struct gz_status status = { .rate_hz_nominal = 0 };
	for (int samples = 0; samples < SAMPLES || status.refused[GZ_REFUSAL_SUBSCRIPTIONS] == 0;) {
		assert_int_equal(gz_stream_read(stream, PATIENCE_MS, &message), GZ_OK);
		samples += message.kind == GZ_MESSAGE_GAZE;
		if (message.kind == GZ_MESSAGE_STATUS)
			status = message.status;
	}
	struct gz_stream_counters counters = { 0 };
	gz_stream_get_counters(stream, &counters);
	assert_int_equal(counters.lost, 0);
	assert_int_equal(counters.connections, 1);
#if !defined __SANITIZE_ADDRESS__ && !defined __SANITIZE_THREAD__
	assert_in_range(gazed_resident_kib(&gazed), 0, before_kib + MEMORY_KIB);
#else
	(void)before_kib;
#endif
	gz_stream_close(&stream);
	zmq_close(flood);
	zmq_ctx_term(context);
	assert_int_equal(gazed_stop(&gazed, SIGTERM), 0);
	/* Either the door or the quota was first. */
	assert_true(count_said(&gazed, "too many subscriptions") > 0);
}

static void curve_local_sockets_need_no_key(void **state)
{
	(void)state;
	struct gazed_process gazed = start_curve();
	struct reader reader;
	reader_open(&reader, &place, "");
	reader_receive_gaze(&reader, 10);
	reader_close(&reader);
	struct stat status;
	char path[128];
	snprintf(path, sizeof path, "%s/stream", place.directory);
	assert_int_equal(stat(path, &status), 0);
	assert_int_equal(status.st_mode & 0777, 0600);
	assert_int_equal(gazed_stop(&gazed, SIGTERM), 0);
}

/* Versions of ZMTP before 3 have no keys: RFC 13 and 15. */
static void curve_peer_of_an_older_protocol_hears_nothing(void **state)
{
	(void)state;
	static const unsigned char greetings[][16] = {
		{ 0xff, 0, 0, 0, 0, 0, 0, 0, 1, 0x7f, 1, 2, 0, 0, 1, 1 }, /* 2.0, and subscribe */
		{ 0x01, 0x00, 0x02, 0x00, 0x01 },                         /* 1.0, and subscribe */
	};
	struct gazed_process gazed = start_curve();
	struct sockaddr_in address = { .sin_family = AF_INET };
	address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
	address.sin_port = htons((uint16_t)port_by("SUB_PORT"));
	for (size_t i = 0; i < sizeof greetings / sizeof *greetings; i++) {
		char bytes[4096];
		size_t received = 0;
		ssize_t n;
		struct timeval patience = { .tv_sec = PATIENCE_S };
		int fd = socket(AF_INET, SOCK_STREAM, 0);
		setsockopt(fd, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
		assert_int_equal(connect(fd, (struct sockaddr *)&address, sizeof address), 0);
		assert_int_equal(send(fd, greetings[i], sizeof greetings[i], MSG_NOSIGNAL),
				 sizeof greetings[i]);
		while ((n = recv(fd, bytes, sizeof bytes, 0)) > 0)
			received += (size_t)n;
		/* The connection is closed without waiting for more, after a greeting at most. */
		if (n < 0 && errno == EAGAIN)
			fail_msg("greeting %zu: the connection stays, %zu bytes", i, received);
		if (received > 64)
			fail_msg("greeting %zu: %zu bytes came", i, received);
		close(fd);
	}
	assert_int_equal(gazed_stop(&gazed, SIGTERM), 0);
}

static void must_fail(const char *const *arguments, const char *why)
{
	struct gazed_process gazed = spawn(arguments);
	int status = gazed_wait_exit(&gazed);
	if (status != 1 || count_said(&gazed, why) != 1)
		fail_msg("exit status %d, not \"%s\": %s", status, why, gazed_said(&gazed));
}

#define MUST_FAIL(why, ...) must_fail((const char *const[]) { __VA_ARGS__, NULL }, why)

static void curve_without_a_safe_secret_key_is_refused_at_start(void **state)
{
	(void)state;
	char path[128];
	MUST_FAIL("server_key does not exist; run gazectl keygen --server", "--tcp=curve",
		  "--control", control);
	snprintf(path, sizeof path, "%s/server_key", server_directory);
	assert_int_equal(chmod(path, 0640), 0);
	MUST_FAIL("is a secret key that others can read: run chmod 600", "--tcp=curve", "--control",
		  control, "--network.keys", server_directory);
	assert_int_equal(chmod(path, 0600), 0);
	assert_int_equal(chmod(server_directory, 0777), 0);
	MUST_FAIL("can be written by others: run chmod 700", "--tcp=curve", "--control", control,
		  "--network.keys", server_directory);
	assert_int_equal(chmod(server_directory, 0700), 0);
	write_file(server_directory, GZ_SERVER_KEY_FILE, "not forty characters\n");
	MUST_FAIL("server_key:1: no key; keep one line", "--tcp=curve", "--control", control,
		  "--network.keys", server_directory);
}

static void other_machines_are_refused_without_keys(void **state)
{
	(void)state;
	MUST_FAIL("--network.address: 0.0.0.0 is not a loopback address", "--tcp=loopback",
		  "--control", control, "--network.address=0.0.0.0");
	MUST_FAIL("--network.control: tcp://0.0.0.0:1 is not a loopback", "--tcp=loopback",
		  "--control", "tcp://0.0.0.0:1");
}

static void keygen_writes_safe_files_and_keeps_what_is_there(void **state)
{
	(void)state;
	struct stat status;
	char path[128], before[GZ_KEY_TEXT_SIZE];
	memcpy(before, read_key(server_directory, GZ_SERVER_KEY_FILE), sizeof before);
	assert_int_equal(stat(server_directory, &status), 0);
	assert_int_equal(status.st_mode & 0777, 0700);
	snprintf(path, sizeof path, "%s/server_key", server_directory);
	assert_int_equal(stat(path, &status), 0);
	assert_int_equal(status.st_mode & 0777, 0600);
	GAZECTL_RUN("keygen", "--server", "--keys", server_directory);
	assert_int_equal(program.status, 1);
	assert_non_null(strstr(program.err_text, "server_key exists and is kept"));
	assert_string_equal(read_key(server_directory, GZ_SERVER_KEY_FILE), before);
	/* Half of a pair is also left alone, and not completed with the half of another pair. */
	assert_int_equal(unlink(path), 0);
	GAZECTL_RUN("keygen", "--server", "--keys", server_directory);
	assert_int_equal(program.status, 1);
	assert_non_null(strstr(program.err_text, "server_key.pub exists and is kept"));
	assert_int_not_equal(access(path, F_OK), 0);
	GAZECTL_RUN("keygen");
	assert_int_equal(program.status, 2);
	GAZECTL_RUN("keygen", "--server", "--client", "both");
	assert_int_equal(program.status, 2);
	GAZECTL_RUN("keygen", "--client", "no\nname", "--keys", server_directory);
	assert_int_equal(program.status, 2);
}

static void keygen_prints_the_lines_that_the_files_take(void **state)
{
	(void)state;
	struct gz_key_list list;
	char line[256];
	snprintf(line, sizeof line, "%s bob", read_key(client_directory, GZ_CLIENT_KEY_FILE));
	assert_int_equal(gz_key_list_parse("printed", line, strlen(line), GZ_KEY_LIST_AUTHORIZED,
					   NULL, &list),
			 GZ_OK);
	remove_directory(client_directory);
	GAZECTL_RUN("keygen", "--client", "bob the builder");
	assert_int_equal(program.status, 0);
	snprintf(line, sizeof line, "\n%s bob the builder\n",
		 read_key(client_directory, GZ_CLIENT_KEY_FILE));
	assert_non_null(strstr(program.out_text, line));
}

static void client_key_that_others_can_read_is_refused(void **state)
{
	(void)state;
	struct gz_control *asked;
	char path[128];
	know_server(read_key(server_directory, GZ_SERVER_KEY_FILE));
	snprintf(path, sizeof path, "%s/client_key", client_directory);
	assert_int_equal(chmod(path, 0604), 0);
	assert_int_equal(gz_control_open(control, &captured.log, &asked), GZ_ERR_ACCESS);
	assert_non_null(strstr(captured.last, "is a secret key that others can read: run chmod"));
	assert_int_equal(unlink(path), 0);
	assert_int_equal(gz_control_open(control, &captured.log, &asked), GZ_ERR_ACCESS);
	assert_non_null(strstr(captured.last, "run gazectl keygen --client"));
	/* No keys are needed for an endpoint of another host. */
	assert_int_equal(gz_control_open("tcp://127.0.0.2:9", &captured.log, &asked), GZ_OK);
	assert_null(gz_control_keys(asked));
	gz_control_close(&asked);
}

#define TEST(name) cmocka_unit_test_setup_teardown(name, set_up, tear_down)

TEST_SUITE(security)
{
	if (!zmq_has("curve"))
		return 77;
	const struct CMUnitTest tests[] = {
		TEST(curve_authorised_client_reads_stream_latest_and_control),
		TEST(curve_serves_ipv6_as_well),
		TEST(curve_unknown_key_is_refused_each_time_and_logged_once),
		TEST(curve_unknown_key_hears_nothing_of_the_stream),
		TEST(curve_wrong_server_key_is_logged_once_on_both_sides),
		TEST(curve_client_without_keys_is_told_what_it_needs),
		TEST(curve_client_that_leaves_in_the_handshake_is_logged_unless_it_is_local),
		TEST(client_with_keys_is_told_that_the_daemon_has_none),
		TEST(curve_authorized_keys_are_read_again_when_they_change),
		TEST(curve_flood_of_refused_clients_takes_nothing_from_a_reader),
		TEST(curve_flood_of_subscriptions_is_ended),
		TEST(curve_local_sockets_need_no_key),
		TEST(curve_peer_of_an_older_protocol_hears_nothing),
		TEST(curve_without_a_safe_secret_key_is_refused_at_start),
		TEST(other_machines_are_refused_without_keys),
		TEST(keygen_writes_safe_files_and_keeps_what_is_there),
		TEST(keygen_prints_the_lines_that_the_files_take),
		TEST(client_key_that_others_can_read_is_refused),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
