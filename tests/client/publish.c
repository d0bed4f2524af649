/* usage: publish ENDPOINT: sends a gaze at (0.25, 0.75) each 5 ms, as a latest channel, until it is
 * killed. For tests of programs that are not written in C with cmocka. */
#include <signal.h>
#include <stdio.h>
#include <sys/prctl.h>
#include <zmq.h>

#include "base/clock.h"
#include "protocol/wire.h"

static struct gz_wire_message encode(uint64_t seq)
{
	struct gz_display display = gz_display_default(1920, 1080);
	struct gz_gaze gaze = {
		.seq = seq,
		.host_ns = gz_clock_now_ns(),
		.publish_ns = gz_clock_now_ns(),
		.point = { 0.25f, 0.75f },
		.raw = { 0.25f, 0.75f },
		.confidence = 1,
		.combined = true,
	};
	struct gz_wire_message message = { 0 };
	gz_wire_encode_gaze(&gaze, &display, &message);
	return message;
}

int main(int argc, char **argv)
{
	if (argc != 2)
		return 2;
	prctl(PR_SET_PDEATHSIG, SIGKILL);
	void *context = zmq_ctx_new();
	void *socket = zmq_socket(context, ZMQ_PUB);
	if (zmq_bind(socket, argv[1]) != 0) {
		fprintf(stderr, "%s: %s\n", argv[1], zmq_strerror(zmq_errno()));
		return 1;
	}
	for (uint64_t seq = 0;; seq++) {
		struct gz_wire_message message = encode(seq);
		zmq_send(socket, message.bytes, message.size, 0);
		gz_clock_sleep_until_ns(gz_clock_now_ns() + 5 * GZ_NS_PER_MS);
	}
}
