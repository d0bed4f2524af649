#include "suite.h"

#include "publisher.h"

#include <dirent.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>
#include <zmq.h>

#include "base/clock.h"
#include "protocol/wire.h"

int runtime_directory_make(void **state)
{
	(void)state;
	char path[] = "/tmp/gazecast-test-XXXXXX";
	return mkdtemp(path) && setenv("GAZECAST_RUNTIME_DIR", path, 1) == 0 ? 0 : -1;
}

int runtime_directory_remove(void **state)
{
	(void)state;
	const char *path = getenv("GAZECAST_RUNTIME_DIR");
	DIR *directory = opendir(path);
	if (!directory)
		return -1;
	for (struct dirent *entry; (entry = readdir(directory));)
		unlinkat(dirfd(directory), entry->d_name, 0);
	closedir(directory);
	return rmdir(path);
}

void publisher_open(struct publisher *publisher, const char *channel)
{
	char endpoint[GZ_ENDPOINT_SIZE];
	assert_int_equal(
		gz_endpoint_ipc(getenv("GAZECAST_RUNTIME_DIR"), channel, endpoint, sizeof endpoint),
		GZ_OK);
	publisher_open_at(publisher, endpoint);
}

void publisher_open_at(struct publisher *publisher, const char *endpoint)
{
	publisher->context = zmq_ctx_new();
	publisher->socket = zmq_socket(publisher->context, ZMQ_PUB);
	assert_non_null(publisher->socket);
	const int none = 0;
	zmq_setsockopt(publisher->socket, ZMQ_LINGER, &none, sizeof none);
	zmq_setsockopt(publisher->socket, ZMQ_SNDHWM, &none, sizeof none);
	assert_int_equal(zmq_bind(publisher->socket, endpoint), 0);
}

void publisher_send_frame(struct publisher *publisher, const void *bytes, size_t size)
{
	assert_int_equal(zmq_send(publisher->socket, bytes, size, 0), (int)size);
}

void publisher_send(struct publisher *publisher, const char *topic, const void *bytes, size_t size)
{
	assert_true(zmq_send(publisher->socket, topic, strlen(topic), ZMQ_SNDMORE) >= 0);
	publisher_send_frame(publisher, bytes, size);
}

static struct gz_wire_message encoded(const struct gz_gaze *gaze)
{
	struct gz_display display = gz_display_default(1920, 1080);
	struct gz_wire_message message;
	assert_int_equal(gz_wire_encode_gaze(gaze, &display, &message), GZ_OK);
	return message;
}

void publisher_send_latest(struct publisher *publisher, const struct gz_gaze *gaze)
{
	struct gz_wire_message message = encoded(gaze);
	publisher_send_frame(publisher, message.bytes, message.size);
}

void publisher_send_gaze(struct publisher *publisher, const struct gz_gaze *gaze)
{
	struct gz_wire_message message = encoded(gaze);
	publisher_send(publisher, gz_wire_gaze_topic(gaze), message.bytes, message.size);
}

void publisher_send_status(struct publisher *publisher, const struct gz_status *status)
{
	struct gz_wire_message message;
	assert_int_equal(gz_wire_encode_status(status, &message), GZ_OK);
	publisher_send(publisher, GZ_TOPIC_STATUS, message.bytes, message.size);
}

void publisher_close(struct publisher *publisher)
{
	if (publisher->socket)
		zmq_close(publisher->socket);
	if (publisher->context)
		zmq_ctx_term(publisher->context);
	*publisher = (struct publisher) { 0 };
}

struct gz_gaze gaze_at(uint64_t seq, float x, float y)
{
	struct gz_gaze gaze = {
		.seq = seq,
		.device_ns = GZ_NO_DEVICE_TIME,
		.host_ns = gz_clock_now_ns(),
		.point = { x, y },
		.raw = { x, y },
		.confidence = 1,
		.event = GZ_EVENT_FIXATION,
	};
	gaze.publish_ns = gaze.host_ns;
	for (int i = 0; i < GZ_EYE_COUNT; i++)
		gaze.eye[i] = (struct gz_gaze_eye) {
			.point = { x, y },
			.pupil_mm = 3,
			.valid = true,
			.confidence = 1,
			.origin_mm = { i ? -32.f : 32.f, 0, 0 },
			.direction = { 0, 0, 1 },
		};
	return gaze;
}

pid_t publisher_process_start(const char *channel, uint64_t first_seq)
{
	char endpoint[GZ_ENDPOINT_SIZE], seq[32], byte;
	int bound[2];
	assert_int_equal(
		gz_endpoint_ipc(getenv("GAZECAST_RUNTIME_DIR"), channel, endpoint, sizeof endpoint),
		GZ_OK);
	snprintf(seq, sizeof seq, "%llu", (unsigned long long)first_seq);
	assert_int_equal(pipe(bound), 0);
	pid_t process = fork();
	assert_true(process >= 0);
	if (process == 0) {
		prctl(PR_SET_PDEATHSIG, SIGKILL); /* the child ends if an assertion fails */
		dup2(bound[1], STDOUT_FILENO);
		execl(PUBLISH, PUBLISH, endpoint, channel, seq, (char *)NULL);
		_exit(127);
	}
	close(bound[1]);
	assert_int_equal(read(bound[0], &byte, 1), 1);
	close(bound[0]);
	return process;
}

void publisher_process_kill(pid_t process)
{
	assert_int_equal(kill(process, SIGKILL), 0);
	assert_int_equal(waitpid(process, NULL, 0), process);
}
