#include "suite.h"

#include "pupil_capture.h"

#include <msgpack.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <zmq.h>

#include "base/clock.h"

static void text(msgpack_packer *packer, const char *key, const char *value)
{
	msgpack_pack_str_with_body(packer, key, strlen(key));
	if (value)
		msgpack_pack_str_with_body(packer, value, strlen(value));
}

static void numbers(msgpack_packer *packer, const char *key, const double *values, size_t count)
{
	text(packer, key, NULL);
	msgpack_pack_array(packer, count);
	for (size_t i = 0; i < count; i++)
		msgpack_pack_double(packer, values[i]);
}

static void number(msgpack_packer *packer, const char *key, double value)
{
	text(packer, key, NULL);
	msgpack_pack_double(packer, value);
}

int64_t pupil_capture_time_ns(const struct pupil_capture *capture, int64_t host_ns)
{
	double elapsed = (double)(host_ns - capture->begin_ns);
	return capture->begin_ns + atomic_load(&capture->ahead_ns) +
	       (int64_t)(elapsed * (1 + capture->skew));
}

void pupil_capture_point(uint64_t sample, double out_xy[2])
{
	out_xy[0] = 0.25 + (double)(sample % 64) / 128;
	out_xy[1] = 0.75 - (double)(sample % 32) / 128;
}

/* The pupil of an eye, with the keys of Pupil's 3D detector. */
static void pupil(msgpack_packer *packer, int id, double time_s)
{
	static const double nowhere[3] = { 0, 0, 0 };
	msgpack_pack_map(packer, 10);
	text(packer, "topic", id == 0 ? "pupil.0.3d" : "pupil.1.3d");
	text(packer, "id", NULL);
	msgpack_pack_int(packer, id);
	text(packer, "method", "pye3d 0.3.0 real-time");
	numbers(packer, "norm_pos", (double[]) { 0.5, 0.5 }, 2);
	number(packer, "diameter", 40);
	number(packer, "diameter_3d", 3.5 + id);
	number(packer, "confidence", 0.9);
	number(packer, "timestamp", time_s);
	text(packer, "sphere", NULL);
	msgpack_pack_map(packer, 2);
	numbers(packer, "center", nowhere, 3);
	number(packer, "radius", 10.4);
	text(packer, "circle_3d", NULL);
	msgpack_pack_map(packer, 1);
	numbers(packer, "normal", nowhere, 3);
}

static void vectors(msgpack_packer *packer, const char *key, const char *alone, bool monocular,
		    const double *right, const double *left)
{
	if (monocular) {
		numbers(packer, alone, right, 3);
		return;
	}
	text(packer, key, NULL);
	msgpack_pack_map(packer, 2);
	numbers(packer, "0", right, 3);
	numbers(packer, "1", left, 3);
}

static void gaze(msgpack_packer *packer, const char *topic, uint64_t sample, double time_s,
		 bool monocular)
{
	double point[2];
	pupil_capture_point(sample, point);
	msgpack_pack_map(packer, 8);
	text(packer, "topic", topic);
	numbers(packer, "norm_pos", (double[]) { point[0], 1 - point[1] }, 2);
	number(packer, "confidence", 0.875);
	number(packer, "timestamp", time_s);
	numbers(packer, "gaze_point_3d", (double[]) { 1, 2, 600 }, 3);
	vectors(packer, "eye_centers_3d", "eye_center_3d", monocular, (double[]) { 30, 15, -20 },
		(double[]) { -30, 15, -20 });
	vectors(packer, "gaze_normals_3d", "gaze_normal_3d", monocular, (double[]) { 0, 0, 2 },
		(double[]) { 0, 1, 0 });
	text(packer, "base_data", NULL);
	msgpack_pack_array(packer, monocular ? 1 : 2);
	pupil(packer, 0, time_s);
	if (!monocular)
		pupil(packer, 1, time_s);
}

/* The newest samples on a surface, at half their coordinates, so that tests can tell the two kinds
 * apart. */
static void surface(msgpack_packer *packer, const char *name, const char *topic, uint64_t newest,
		    const double *times_s)
{
	msgpack_pack_map(packer, 3);
	text(packer, "name", name);
	number(packer, "timestamp", times_s[PUPIL_CAPTURE_ENTRIES - 1]);
	text(packer, "gaze_on_surfaces", NULL);
	msgpack_pack_array(packer, PUPIL_CAPTURE_ENTRIES);
	for (uint64_t i = 0; i < PUPIL_CAPTURE_ENTRIES; i++) {
		double point[2];
		pupil_capture_point(newest + 1 + i - PUPIL_CAPTURE_ENTRIES, point);
		msgpack_pack_map(packer, 6);
		text(packer, "topic", "gaze.3d.01._on_surface");
		numbers(packer, "norm_pos", (double[]) { point[0] / 2, 1 - point[1] / 2 }, 2);
		number(packer, "confidence", 0.875);
		text(packer, "on_surf", NULL);
		msgpack_pack_true(packer);
		text(packer, "base_data", NULL);
		msgpack_pack_array(packer, 2);
		text(packer, topic, NULL);
		msgpack_pack_double(packer, times_s[i]);
		number(packer, "timestamp", times_s[i]);
	}
}

static void publish(struct pupil_capture *capture, const char *topic, const void *body, size_t size)
{
	for (int i = 0; i < (atomic_load(&capture->twice) ? 2 : 1); i++) {
		zmq_send(capture->stream, topic, strlen(topic), ZMQ_SNDMORE | ZMQ_DONTWAIT);
		zmq_send(capture->stream, body, size, ZMQ_DONTWAIT);
	}
}

/* One message of each bad kind: empty, cut, not MessagePack, a claimed length, no gaze, a text
 * instead of a number, too many frames, a single frame. */
static void send_garbage(struct pupil_capture *capture, const char *good, size_t size)
{
	publish(capture, "gaze.3d.01.", "", 0);
	publish(capture, "gaze.3d.01.", good, size - 1);
	publish(capture, "gaze.3d.01.", "\xc1", 1);
	publish(capture, "gaze.3d.01.", "\xdd\xff\xff\xff\xff", 5);
	publish(capture, "gaze.3d.01.", "\x80", 1);
	publish(capture, "gaze.3d.01.", "\x81\xa9timestamp\xa1x", 13);
	publish(capture, "surfaces.screen", "\x80", 1);
	publish(capture, "surfaces.screen", "\x81\xb0gaze_on_surfaces\xdd\xff\xff\xff\xff", 23);
	zmq_send(capture->stream, "gaze.x", 6, ZMQ_SNDMORE | ZMQ_DONTWAIT);
	zmq_send(capture->stream, "\x80", 1, ZMQ_SNDMORE | ZMQ_DONTWAIT);
	zmq_send(capture->stream, "\x80", 1, ZMQ_DONTWAIT);
	zmq_send(capture->stream, "gaze.alone", 10, ZMQ_DONTWAIT);
}

static void send_sample(struct pupil_capture *capture, int64_t exposed_ns,
			double times_s[PUPIL_CAPTURE_ENTRIES])
{
	bool monocular = atomic_load(&capture->monocular);
	const char *topic = monocular ? "gaze.3d.0." : "gaze.3d.01.";
	uint64_t sample = capture->number++;
	msgpack_sbuffer buffer;
	msgpack_packer packer;
	msgpack_sbuffer_init(&buffer);
	msgpack_packer_init(&packer, &buffer, msgpack_sbuffer_write);
	memmove(times_s, times_s + 1, sizeof *times_s * (PUPIL_CAPTURE_ENTRIES - 1));
	times_s[PUPIL_CAPTURE_ENTRIES - 1] =
		(double)pupil_capture_time_ns(capture, exposed_ns) * 1e-9;
	gaze(&packer, topic, sample, times_s[PUPIL_CAPTURE_ENTRIES - 1], monocular);
	if (atomic_load(&capture->garbage))
		send_garbage(capture, buffer.data, buffer.size);
	publish(capture, topic, buffer.data, buffer.size);
	if (sample % PUPIL_CAPTURE_ENTRIES == PUPIL_CAPTURE_ENTRIES - 1) {
		static const char *const names[] = { "screen2", "screen" };
		for (size_t i = 0; i < 2; i++) {
			char surface_topic[64];
			snprintf(surface_topic, sizeof surface_topic, "surfaces.%s", names[i]);
			msgpack_sbuffer_clear(&buffer);
			surface(&packer, names[i], topic, sample, times_s);
			publish(capture, surface_topic, buffer.data, buffer.size);
		}
	}
	msgpack_sbuffer_destroy(&buffer);
}

static void answer(struct pupil_capture *capture)
{
	char request[64], reply[64] = "Unknown command.";
	int size = zmq_recv(capture->control, request, sizeof request - 1, ZMQ_DONTWAIT);
	if (size < 0)
		return;
	request[size < 63 ? size : 63] = '\0';
	if (atomic_load(&capture->deaf))
		return; /* a REP socket that has not answered accepts no further request */
	if (strcmp(request, "SUB_PORT") == 0 && capture->port_answer)
		snprintf(reply, sizeof reply, "%s", capture->port_answer);
	else if (strcmp(request, "SUB_PORT") == 0)
		snprintf(reply, sizeof reply, "%d", capture->stream_port);
	else if (strcmp(request, "LATEST_PORT") == 0 && capture->latest_answer)
		snprintf(reply, sizeof reply, "%s", capture->latest_answer);
	else if (strcmp(request, "t") == 0)
		snprintf(reply, sizeof reply, "%.9f",
			 (double)pupil_capture_time_ns(capture, gz_clock_now_ns()) * 1e-9);
	else if (strcmp(request, "v") == 0)
		snprintf(reply, sizeof reply, "3.5.1");
	zmq_send(capture->control, reply, strlen(reply), 0);
}

static void *play(void *user)
{
	struct pupil_capture *capture = user;
	double times_s[PUPIL_CAPTURE_ENTRIES] = { 0 };
	int64_t next_ns = gz_clock_now_ns();
	while (!atomic_load(&capture->quit)) {
		zmq_pollitem_t item = { .socket = capture->control, .events = ZMQ_POLLIN };
		int64_t left_ns = next_ns - gz_clock_now_ns();
		if (left_ns > 0) {
			/* Always poll, so that requests are answered at once. */
			zmq_poll(&item, 1, (long)(left_ns / GZ_NS_PER_MS) + 1);
			if (item.revents)
				answer(capture);
			continue;
		}
		int64_t exposed_ns = next_ns;
		next_ns += capture->period_ns;
		if (atomic_load(&capture->skip) > 0)
			atomic_fetch_sub(&capture->skip, 1);
		else if (!atomic_load(&capture->mute))
			send_sample(capture, exposed_ns, times_s);
	}
	return NULL;
}

static int bind_port(void *socket, int port)
{
	char endpoint[64];
	size_t size = sizeof endpoint;
	snprintf(endpoint, sizeof endpoint, port ? "tcp://127.0.0.1:%d" : "tcp://127.0.0.1:*",
		 port);
	assert_int_equal(zmq_bind(socket, endpoint), 0);
	assert_int_equal(zmq_getsockopt(socket, ZMQ_LAST_ENDPOINT, endpoint, &size), 0);
	return atoi(strrchr(endpoint, ':') + 1);
}

void pupil_capture_start(struct pupil_capture *capture)
{
	const int none = 0;
	capture->context = zmq_ctx_new();
	capture->control = zmq_socket(capture->context, ZMQ_REP);
	capture->stream = zmq_socket(capture->context, ZMQ_PUB);
	zmq_setsockopt(capture->control, ZMQ_LINGER, &none, sizeof none);
	zmq_setsockopt(capture->stream, ZMQ_LINGER, &none, sizeof none);
	capture->control_port = bind_port(capture->control, capture->control_port);
	capture->stream_port = bind_port(capture->stream, 0);
	snprintf(capture->address, sizeof capture->address, "tcp://127.0.0.1:%d",
		 capture->control_port);
	if (capture->begin_ns == 0)
		capture->begin_ns = gz_clock_now_ns();
	if (capture->period_ns == 0)
		capture->period_ns = 2 * GZ_NS_PER_MS;
	atomic_store(&capture->quit, false);
	assert_int_equal(pthread_create(&capture->thread, NULL, play, capture), 0);
}

void pupil_capture_stop(struct pupil_capture *capture)
{
	if (!capture->context)
		return;
	atomic_store(&capture->quit, true);
	pthread_join(capture->thread, NULL);
	zmq_close(capture->control);
	zmq_close(capture->stream);
	zmq_ctx_term(capture->context);
	capture->context = NULL;
}
