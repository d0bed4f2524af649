/* The messages that a viewer sends to the daemon's inlet, and when. */
#include "suite.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#include <zmq.h>

#include "base/clock.h"
#include "client/viewer_link.h"

static char directory[64], latest[96], inlet[96];
static void *context, *listener;
static struct gz_viewer_link *viewer;
static char topic[32];
static unsigned char bytes[256];
static int size;

static bool receive(int timeout_ms)
{
	zmq_setsockopt(listener, ZMQ_RCVTIMEO, &timeout_ms, sizeof timeout_ms);
	int length = zmq_recv(listener, topic, sizeof topic - 1, 0);
	if (length < 0)
		return false;
	topic[length] = '\0';
	size = zmq_recv(listener, bytes, sizeof bytes, 0);
	assert_true(size > 0 && size <= (int)sizeof bytes);
	return true;
}

/* The caller gives the times: nothing here waits for a clock. */
static const int64_t begin_ns = 1000 * GZ_NS_PER_S;

/* A link whose first message has arrived. */
static int set_up(void **state)
{
	(void)state;
	static const int rect_px[4] = { 0, 0, 1, 1 };
	snprintf(directory, sizeof directory, "/tmp/gz_viewer_link_XXXXXX");
	if (!mkdtemp(directory))
		return -1;
	snprintf(latest, sizeof latest, "ipc://%s/latest", directory);
	snprintf(inlet, sizeof inlet, "ipc://%s/inlet", directory);
	context = zmq_ctx_new();
	listener = zmq_socket(context, ZMQ_SUB);
	if (zmq_setsockopt(listener, ZMQ_SUBSCRIBE, "", 0) != 0 || zmq_bind(listener, inlet) != 0 ||
	    gz_viewer_link_open(latest, NULL, &viewer) != GZ_OK)
		return -1;
	/* Messages are dropped until the subscription has arrived. */
	for (int i = 0; i < 1000; i++) {
		gz_viewer_link_window(viewer, rect_px, i * 2 * GZ_VIEWER_LINK_WINDOW_NS);
		if (receive(20))
			break;
	}
	while (receive(50))
		;
	return 0;
}

static int tear_down(void **state)
{
	(void)state;
	char path[96];
	gz_viewer_link_close(&viewer);
	zmq_close(listener);
	zmq_ctx_term(context);
	snprintf(path, sizeof path, "%s/inlet", directory);
	unlink(path);
	return rmdir(directory);
}

static void expect_pointer(const struct gz_point *point, int64_t time_ns)
{
	struct gz_viewer_pointer pointer;
	assert_true(receive(PATIENCE_MS));
	assert_string_equal(topic, GZ_TOPIC_POINTER);
	assert_int_equal(gz_wire_decode_pointer(bytes, (size_t)size, &pointer), GZ_OK);
	assert_int_equal(pointer.known, point != NULL);
	if (point)
		assert_true(pointer.point.x == point->x && pointer.point.y == point->y);
	assert_true(pointer.has_time && pointer.time_ns == time_ns);
}

static void pointer_is_sent_when_it_moves_and_now_and_then_at_rest(void **state)
{
	(void)state;
	const struct gz_point here = { 0.25f, 0.5f }, there = { 0.75f, 0.5f };
	const int64_t step_ns = GZ_NS_PER_MS;
	gz_viewer_link_pointer(viewer, &here, begin_ns);
	gz_viewer_link_pointer(viewer, &here, begin_ns + step_ns);
	gz_viewer_link_pointer(viewer, &there, begin_ns + 2 * step_ns);
	gz_viewer_link_pointer(viewer, &there,
			       begin_ns + 2 * step_ns + GZ_VIEWER_LINK_POINTER_NS - 1);
	gz_viewer_link_pointer(viewer, &there, begin_ns + 2 * step_ns + GZ_VIEWER_LINK_POINTER_NS);
	gz_viewer_link_pointer(viewer, NULL, begin_ns + GZ_NS_PER_S);
	gz_viewer_link_pointer(viewer, NULL, begin_ns + 100 * GZ_NS_PER_S);
	gz_viewer_link_pointer(viewer, &there, begin_ns + 101 * GZ_NS_PER_S);
	expect_pointer(&here, begin_ns);
	expect_pointer(&there, begin_ns + 2 * step_ns);
	expect_pointer(&there, begin_ns + 2 * step_ns + GZ_VIEWER_LINK_POINTER_NS);
	expect_pointer(NULL, begin_ns + GZ_NS_PER_S);
	expect_pointer(&there, begin_ns + 101 * GZ_NS_PER_S);
	assert_false(receive(50));
}

static void expect_window(const int *rect_px)
{
	struct gz_viewer_window window;
	assert_true(receive(PATIENCE_MS));
	assert_string_equal(topic, GZ_TOPIC_WINDOW);
	assert_int_equal(gz_wire_decode_window(bytes, (size_t)size, &window), GZ_OK);
	assert_int_equal(window.known, rect_px != NULL);
	if (rect_px)
		assert_memory_equal(window.rect_px, rect_px, sizeof window.rect_px);
}

static void window_is_sent_when_it_changes_each_second_and_when_it_closes(void **state)
{
	(void)state;
	static const int here_px[4] = { -5, 10, 640, 480 }, there_px[4] = { -5, 10, 641, 480 };
	gz_viewer_link_window(viewer, here_px, begin_ns);
	gz_viewer_link_window(viewer, here_px, begin_ns + GZ_VIEWER_LINK_WINDOW_NS - 1);
	gz_viewer_link_window(viewer, here_px, begin_ns + GZ_VIEWER_LINK_WINDOW_NS);
	gz_viewer_link_window(viewer, there_px, begin_ns + GZ_VIEWER_LINK_WINDOW_NS + 1);
	gz_viewer_link_close(&viewer);
	assert_null(viewer);
	expect_window(here_px);
	expect_window(here_px);
	expect_window(there_px);
	expect_window(NULL);
	assert_false(receive(50));
}

static void monitor_is_sent_with_the_window_when_it_changes(void **state)
{
	(void)state;
	static const int rect_px[4] = { 0, 0, 640, 480 };
	const struct gz_monitor_place desk = { { 1920, 0 }, { 1920, 1080 }, 1.5 };
	struct gz_viewer_window window;
	gz_viewer_link_monitor(viewer, &desk);
	gz_viewer_link_window(viewer, rect_px, begin_ns);
	gz_viewer_link_window(viewer, rect_px, begin_ns + 1);
	gz_viewer_link_monitor(viewer, NULL);
	gz_viewer_link_window(viewer, rect_px, begin_ns + 2);
	assert_true(receive(PATIENCE_MS));
	assert_int_equal(gz_wire_decode_window(bytes, (size_t)size, &window), GZ_OK);
	assert_memory_equal(&window.monitor, &desk, sizeof desk);
	assert_true(receive(PATIENCE_MS));
	assert_int_equal(gz_wire_decode_window(bytes, (size_t)size, &window), GZ_OK);
	assert_true(window.known && window.monitor.px[0] == 0);
	assert_false(receive(50));
}

static void scene_is_sent_with_the_window_when_it_changes(void **state)
{
	(void)state;
	static const int rect_px[4] = { 0, 0, 640, 480 };
	struct gz_viewer_window window;
	gz_viewer_link_window(viewer, rect_px, begin_ns);
	for (int i = 1; i < 5; i++) {
		gz_viewer_link_scene(viewer, i < 3);
		gz_viewer_link_window(viewer, rect_px, begin_ns + i);
	}
	for (int i = 0; i < 3; i++) {
		assert_true(receive(PATIENCE_MS));
		assert_int_equal(gz_wire_decode_window(bytes, (size_t)size, &window), GZ_OK);
		assert_int_equal(window.has_still, i > 0);
		assert_int_equal(window.still_scene, i == 1);
	}
	assert_false(receive(50));
}

static void endpoints_whose_inlet_is_not_known_are_refused(void **state)
{
	(void)state;
	static const char *const endpoints[] = { "tcp://127.0.0.1:5000", "ipc:///tmp/x/stream",
						 "ipc://", "inproc://a/latest" };
	struct gz_viewer_link *none = NULL;
	for (size_t i = 0; i < sizeof endpoints / sizeof *endpoints; i++)
		assert_int_equal(gz_viewer_link_open(endpoints[i], NULL, &none),
				 GZ_ERR_UNSUPPORTED);
	assert_null(none);
	gz_viewer_link_close(&none);
	gz_viewer_link_close(NULL);
}

static void nobody_who_listens_costs_nothing(void **state)
{
	(void)state;
	static const int rect_px[4] = { 0, 0, 640, 480 };
	const struct gz_point point = { 0.5f, 0.5f };
	struct gz_viewer_link *alone;
	assert_int_equal(gz_viewer_link_open("ipc:///tmp/gz_nobody_there/latest", NULL, &alone),
			 GZ_OK);
	int64_t before_ns = gz_clock_now_ns();
	for (int i = 0; i < 1000; i++) {
		gz_viewer_link_pointer(alone, &point, i * GZ_NS_PER_S);
		gz_viewer_link_window(alone, rect_px, i * GZ_NS_PER_S);
	}
	gz_viewer_link_close(&alone);
	int64_t took_ns = gz_clock_now_ns() - before_ns;
	if (took_ns > 2 * GZ_NS_PER_S)
		fail_msg("took %g ms", gz_ns_to_ms(took_ns));
}

TEST_SUITE(viewer_link)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test_setup_teardown(
			pointer_is_sent_when_it_moves_and_now_and_then_at_rest, set_up, tear_down),
		cmocka_unit_test_setup_teardown(
			window_is_sent_when_it_changes_each_second_and_when_it_closes, set_up,
			tear_down),
		cmocka_unit_test_setup_teardown(monitor_is_sent_with_the_window_when_it_changes,
						set_up, tear_down),
		cmocka_unit_test_setup_teardown(scene_is_sent_with_the_window_when_it_changes,
						set_up, tear_down),
		cmocka_unit_test(endpoints_whose_inlet_is_not_known_are_refused),
		cmocka_unit_test(nobody_who_listens_costs_nothing),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
