/* What a viewer reports about itself. */
#include "suite.h"

#include <string.h>

#include "base/clock.h"
#include "protocol/wire.h"

static struct gz_wire_message message;

static void pointer_comes_back_as_it_was_sent(void **state)
{
	(void)state;
	const struct gz_viewer_pointer sent = { .known = true,
						.point = { -0.25f, 1.5f },
						.has_time = true,
						.time_ns = 5 * GZ_NS_PER_S };
	struct gz_viewer_pointer back;
	assert_int_equal(gz_wire_encode_pointer(&sent, &message), GZ_OK);
	assert_int_equal(gz_wire_decode_pointer(message.bytes, message.size, &back), GZ_OK);
	assert_true(back.known && back.has_time && back.time_ns == sent.time_ns);
	assert_true(back.point.x == sent.point.x && back.point.y == sent.point.y);
}

static void pointer_that_is_nowhere_says_so(void **state)
{
	(void)state;
	struct gz_viewer_pointer pointer = { .known = false }, back = { .known = true };
	assert_int_equal(gz_wire_encode_pointer(&pointer, &message), GZ_OK);
	assert_int_equal(gz_wire_decode_pointer(message.bytes, message.size, &back), GZ_OK);
	assert_false(back.known || back.has_time);
	/* {} */
	assert_int_equal(gz_wire_decode_pointer("\x80", 1, &back), GZ_OK);
	assert_false(back.known);
}

static void window_comes_back_as_it_was_sent(void **state)
{
	(void)state;
	const struct gz_viewer_window sent = { .known = true,
					       .rect_px = { -1920, 5, 1280, 720 },
					       .has_time = true,
					       .time_ns = 7 * GZ_NS_PER_MS };
	struct gz_viewer_window closed = { .known = false }, back;
	assert_int_equal(gz_wire_encode_window(&sent, &message), GZ_OK);
	assert_int_equal(gz_wire_decode_window(message.bytes, message.size, &back), GZ_OK);
	assert_true(back.known && back.has_time && back.time_ns == sent.time_ns);
	assert_memory_equal(back.rect_px, sent.rect_px, sizeof sent.rect_px);
	assert_int_equal(back.monitor.px[0], 0);
	const struct gz_viewer_window placed = {
		.known = true,
		.rect_px = { 0, 0, 1280, 720 },
		.monitor = { .at = { -1920, 40 }, .px = { 1920, 1080 }, .scale = 1.25 },
	};
	assert_int_equal(gz_wire_encode_window(&placed, &message), GZ_OK);
	assert_int_equal(gz_wire_decode_window(message.bytes, message.size, &back), GZ_OK);
	assert_memory_equal(&back.monitor, &placed.monitor, sizeof placed.monitor);
	assert_false(back.has_still);
	struct gz_viewer_window looked_at = placed;
	looked_at.has_still = true;
	for (int i = 0; i < 2; i++) {
		looked_at.still_scene = i;
		assert_int_equal(gz_wire_encode_window(&looked_at, &message), GZ_OK);
		assert_int_equal(gz_wire_decode_window(message.bytes, message.size, &back), GZ_OK);
		assert_true(back.has_still && back.still_scene == i && back.monitor.scale == 1.25);
	}
	assert_int_equal(gz_wire_encode_window(&closed, &message), GZ_OK);
	assert_int_equal(gz_wire_decode_window(message.bytes, message.size, &back), GZ_OK);
	assert_false(back.known);
}

#define POINT(bytes)     "\x81\xa5point" bytes
#define RECT(a, b, c, d) "\x81\xa4rect\x94" a b c d
/* A window of 1 1 1 1 on a monitor at 0 0; its size and perhaps its scale follow. */
#define MONITOR(map, rest) map "\xa4rect\x94\x01\x01\x01\x01\xa7monitor\x94\x00\x00" rest

static void impossible_values_are_refused_and_nothing_is_written(void **state)
{
	(void)state;
	static const struct {
		const char *bytes;
		size_t size;
	} points[] = {
		{ "", 0 },
		{ "\x91\x01", 2 },                 /* no map */
		{ POINT("\x91\x01"), 9 },          /* one number */
		{ POINT("\x93\x01\x01\x01"), 11 }, /* three */
		{ POINT("\x92\x01\xa1x"), 11 },    /* a text */
		{ "\x81\xa9timestamp\xa1x", 13 },
	};
	static const struct {
		const char *bytes;
		size_t size;
	} rects[] = {
		{ RECT("\x01", "\x01", "\x00", "\x01"), 11 },                 /* empty */
		{ RECT("\x01", "\x01", "\x01", "\xff"), 11 },                 /* less than that */
		{ RECT("\x01", "\x01", "\x01", "\xca\x3f\x00\x00\x00"), 15 }, /* half a pixel */
		{ RECT("\x01", "\x01", "\x01", "\xce\xff\xff\xff\xff"), 15 }, /* too far */
		{ "\x81\xa4rect\x93\x01\x01\x01", 10 },
		{ MONITOR("\x82", "\x01\x00"), 24 },              /* no height */
		{ MONITOR("\x82", "\xcd\x80\x01\x01"), 26 },      /* too wide */
		{ MONITOR("\x83", "\x01\x01\xa5scale\x65"), 31 }, /* 101 times */
		{ "\x82\xa4rect\x94\x01\x01\x01\x01\xa5still\x01", 18 },
	};
	struct gz_viewer_pointer pointer = { .time_ns = 77 };
	struct gz_viewer_window window = { .time_ns = 77 };
	for (size_t i = 0; i < sizeof points / sizeof *points; i++)
		assert_int_equal(gz_wire_decode_pointer(points[i].bytes, points[i].size, &pointer),
				 GZ_ERR_PROTOCOL);
	for (size_t i = 0; i < sizeof rects / sizeof *rects; i++)
		if (gz_wire_decode_window(rects[i].bytes, rects[i].size, &window) !=
		    GZ_ERR_PROTOCOL)
			fail_msg("rectangle %zu is not refused", i);
	assert_true(pointer.time_ns == 77 && window.time_ns == 77);
	assert_int_equal(gz_wire_decode_window(RECT("\x01", "\x01", "\x01", "\x01"), 11, &window),
			 GZ_OK);
	assert_int_equal(gz_wire_decode_window(MONITOR("\x82", "\x01\x02"), 24, &window), GZ_OK);
	assert_true(window.monitor.px[1] == 2 && window.monitor.scale == 0);
	assert_int_equal(
		gz_wire_decode_window(MONITOR("\x83", "\x01\x02\xa5scale\x64"), 31, &window),
		GZ_OK);
	assert_true(window.monitor.scale == 100);
}

TEST_SUITE(wire_viewer)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(pointer_comes_back_as_it_was_sent),
		cmocka_unit_test(pointer_that_is_nowhere_says_so),
		cmocka_unit_test(window_comes_back_as_it_was_sent),
		cmocka_unit_test(impossible_values_are_refused_and_nothing_is_written),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
