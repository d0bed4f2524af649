/* usage: publish ENDPOINT [latest|stream [FIRST]]
 * Sends a gaze at (0.25, 0.75) each millisecond, as that channel does, numbered from FIRST, until
 * it is killed. Prints a line when it has bound. */
#include <signal.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <zmq.h>

#include "base/clock.h"
#include "protocol/wire.h"

static struct gz_gaze gaze_now(uint64_t seq)
{
	struct gz_gaze gaze = {
		.seq = seq,
		.host_ns = gz_clock_now_ns(),
		.point = { 0.25f, 0.75f },
		.raw = { 0.25f, 0.75f },
		.confidence = 1,
		.combined = true,
	};
	gaze.publish_ns = gaze.host_ns;
	return gaze;
}

static void send_gaze(void *socket, bool with_topic, uint64_t seq)
{
	struct gz_display display = gz_display_default(1920, 1080);
	struct gz_gaze gaze = gaze_now(seq);
	struct gz_wire_message message;
	if (gz_wire_encode_gaze(&gaze, &display, &message) != GZ_OK)
		abort();
	const char *topic = gz_wire_gaze_topic(&gaze);
	if (with_topic)
		zmq_send(socket, topic, strlen(topic), ZMQ_SNDMORE);
	zmq_send(socket, message.bytes, message.size, 0);
}

int main(int argc, char **argv)
{
	if (argc < 2)
		return 2;
	bool stream = argc > 2 && strcmp(argv[2], "stream") == 0;
	uint64_t seq = argc > 3 ? strtoull(argv[3], NULL, 10) : 0;
	prctl(PR_SET_PDEATHSIG, SIGKILL);
	void *context = zmq_ctx_new();
	void *socket = zmq_socket(context, ZMQ_PUB);
	if (zmq_bind(socket, argv[1]) != 0) {
		fprintf(stderr, "%s: %s\n", argv[1], zmq_strerror(zmq_errno()));
		return 1;
	}
	puts("bound");
	fclose(stdout);
	for (;; seq++) {
		send_gaze(socket, stream, seq);
		gz_clock_sleep_until_ns(gz_clock_now_ns() + GZ_NS_PER_MS);
	}
}
