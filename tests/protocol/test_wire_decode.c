#include "suite.h"

#include "protocol/wire.h"

#include <msgpack.h>
#include <stdlib.h>
#include <string.h>

#include "protocol/sample_messages.h"

/* Fail if two floats differ; NaN equals NaN. */
#define assert_float_same(actual, expected)                                                        \
	do {                                                                                       \
		float same_a = (actual), same_b = (expected);                                      \
		if (!(same_a == same_b || (isnan(same_a) && isnan(same_b))))                       \
			fail_msg("%s is %.9g, not %.9g", #actual, (double)same_a, (double)same_b); \
	} while (0)

static void assert_same_gaze(const struct gz_gaze *a, const struct gz_gaze *b)
{
	assert_true(a->seq == b->seq);
	assert_true(a->device_ns == b->device_ns);
	assert_true(a->host_ns == b->host_ns);
	assert_true(a->publish_ns == b->publish_ns);
	assert_float_same(a->point.x, b->point.x);
	assert_float_same(a->point.y, b->point.y);
	assert_float_same(a->raw.x, b->raw.x);
	assert_float_same(a->raw.y, b->raw.y);
	assert_float_same(a->confidence, b->confidence);
	assert_int_equal(a->event, b->event);
	assert_int_equal(a->final_known, b->final_known);
	assert_true(a->final_seq == b->final_seq);
	assert_true(a->final_span == b->final_span);
	assert_int_equal(a->final_event, b->final_event);
	assert_float_same(a->velocity_deg_s, b->velocity_deg_s);
	assert_int_equal(a->landing.known, b->landing.known);
	assert_float_same(a->landing.point.x, b->landing.point.x);
	assert_float_same(a->landing.point.y, b->landing.point.y);
	assert_true(a->landing.time_ns == b->landing.time_ns);
	assert_float_same(a->landing.sigma_deg, b->landing.sigma_deg);
	assert_int_equal(a->combined, b->combined);
	for (int i = 0; i < GZ_EYE_COUNT; i++) {
		assert_float_same(a->eye[i].point.x, b->eye[i].point.x);
		assert_float_same(a->eye[i].point.y, b->eye[i].point.y);
		assert_float_same(a->eye[i].pupil_mm, b->eye[i].pupil_mm);
		assert_int_equal(a->eye[i].valid, b->eye[i].valid);
		assert_float_same(a->eye[i].confidence, b->eye[i].confidence);
		for (int k = 0; k < 3; k++) {
			assert_float_same(a->eye[i].origin_mm[k], b->eye[i].origin_mm[k]);
			assert_true(isnan(a->eye[i].direction[k]));
		}
	}
}

static void gaze_comes_back_as_it_was_sent(void **state)
{
	(void)state;
	struct gz_display display = sample_display();
	struct gz_gaze gaze = sample_gaze(), back;
	struct gz_wire_message message;
	assert_int_equal(gz_wire_encode_gaze(&gaze, &display, &message), GZ_OK);
	assert_int_equal(gz_wire_decode_gaze(message.bytes, message.size, &back), GZ_OK);
	assert_same_gaze(&back, &gaze);
}

static void gaze_of_each_event_comes_back(void **state)
{
	(void)state;
	struct gz_display display = sample_display();
	struct gz_wire_message message;
	for (int event = 0; event < GZ_EVENT_COUNT; event++) {
		struct gz_gaze gaze = sample_gaze(), back;
		gaze.event = (enum gz_event)event;
		gaze.final_known = false;
		gaze.final_seq = gaze.final_span = 0;
		gaze.final_event = GZ_EVENT_FIXATION;
		gaze.combined = event % 2;
		assert_int_equal(gz_wire_encode_gaze(&gaze, &display, &message), GZ_OK);
		assert_int_equal(gz_wire_decode_gaze(message.bytes, message.size, &back), GZ_OK);
		assert_same_gaze(&back, &gaze);
	}
}

static void gaze_unmeasured_comes_back_as_nan(void **state)
{
	(void)state;
	struct gz_display display = sample_display();
	struct gz_gaze gaze = sample_gaze(), back;
	struct gz_wire_message message;
	struct gz_gaze_eye *eye = &gaze.eye[GZ_EYE_RIGHT];
	gaze.device_ns = GZ_NO_DEVICE_TIME;
	gaze.raw.x = NAN;
	eye->valid = false;
	eye->point.x = eye->point.y = eye->pupil_mm = NAN;
	eye->origin_mm[0] = eye->origin_mm[1] = eye->origin_mm[2] = NAN;
	assert_int_equal(gz_wire_encode_gaze(&gaze, &display, &message), GZ_OK);
	assert_int_equal(gz_wire_decode_gaze(message.bytes, message.size, &back), GZ_OK);
	gaze.raw.y = NAN;      /* a point needs both coordinates */
	eye->confidence = NAN; /* nothing is sent about an eye that was not used */
	assert_same_gaze(&back, &gaze);
}

static void fixation_comes_back_as_it_was_sent(void **state)
{
	(void)state;
	struct gz_fixation fixation = sample_fixation(), back;
	struct gz_wire_message message;
	assert_int_equal(gz_wire_encode_fixation(&fixation, &message), GZ_OK);
	assert_int_equal(gz_wire_decode_fixation(message.bytes, message.size, &back), GZ_OK);
	assert_true(back.id == fixation.id);
	assert_int_equal(back.onset_ns, fixation.onset_ns);
	assert_int_equal(back.duration_ns, fixation.duration_ns);
	assert_float_same(back.dispersion_deg, fixation.dispersion_deg);
	assert_float_same(back.point.x, fixation.point.x);
	assert_float_same(back.point.y, fixation.point.y);
	assert_float_same(back.confidence, fixation.confidence);
	assert_int_equal(back.final, fixation.final);
}

static void blink_comes_back_as_it_was_sent(void **state)
{
	(void)state;
	for (int onset = 0; onset < 2; onset++) {
		struct gz_blink blink = sample_blink(), back;
		struct gz_wire_message message;
		blink.onset = onset;
		assert_int_equal(gz_wire_encode_blink(&blink, &message), GZ_OK);
		assert_int_equal(gz_wire_decode_blink(message.bytes, message.size, &back), GZ_OK);
		assert_int_equal(back.onset, onset);
		assert_int_equal(back.time_ns, blink.time_ns);
		assert_float_same(back.confidence, blink.confidence);
	}
}

static void saccade_comes_back_as_it_was_sent(void **state)
{
	(void)state;
	struct gz_saccade saccade = sample_saccade(), back;
	struct gz_wire_message message;
	assert_int_equal(gz_wire_encode_saccade(&saccade, &message), GZ_OK);
	assert_int_equal(gz_wire_decode_saccade(message.bytes, message.size, &back), GZ_OK);
	assert_int_equal(back.start_ns, saccade.start_ns);
	assert_int_equal(back.duration_ns, saccade.duration_ns);
	assert_float_same(back.amplitude_deg, saccade.amplitude_deg);
	assert_float_same(back.peak_velocity_deg_s, saccade.peak_velocity_deg_s);
	assert_float_same(back.start.y, saccade.start.y);
	assert_float_same(back.end.x, saccade.end.x);
}

static void status_comes_back_as_it_was_sent(void **state)
{
	(void)state;
	struct gz_status status = sample_status(), back;
	struct gz_wire_message message;
	assert_int_equal(gz_wire_encode_status(&status, &message), GZ_OK);
	assert_int_equal(gz_wire_decode_status(message.bytes, message.size, &back), GZ_OK);
	assert_string_equal(back.tracker.name, status.tracker.name);
	assert_string_equal(back.tracker.serial, status.tracker.serial);
	assert_string_equal(back.tracker.reason, status.tracker.reason);
	assert_int_equal(back.tracker.state, status.tracker.state);
	assert_true(back.rate_hz_nominal == status.rate_hz_nominal);
	assert_true(back.rate_hz_measured == status.rate_hz_measured);
	assert_true(back.samples == status.samples && back.lost == status.lost);
	assert_memory_equal(back.rejected, status.rejected, sizeof back.rejected);
	assert_memory_equal(back.malformed, status.malformed, sizeof back.malformed);
	assert_memory_equal(back.refused, status.refused, sizeof back.refused);
	assert_true(back.clock.offset_ns == status.clock.offset_ns);
	assert_true(back.clock.skew_ppm == status.clock.skew_ppm);
	assert_true(back.clock.sigma_ns == status.clock.sigma_ns);
	assert_int_equal(back.clock.tick, status.clock.tick);
	assert_true(back.noise_deg == status.noise_deg);
	assert_true(back.still_scene == status.still_scene);
	assert_memory_equal(&back.display, &status.display, sizeof back.display);
	assert_memory_equal(&back.correction, &status.correction, sizeof back.correction);
	assert_string_equal(back.validation.measured, status.validation.measured);
	assert_true(back.validation.accuracy_deg == status.validation.accuracy_deg);
	assert_string_equal(back.validation.changed, status.validation.changed);
	assert_int_equal(back.recording.state, status.recording.state);
	assert_string_equal(back.recording.file, status.recording.file);
	assert_string_equal(back.recording.error, status.recording.error);
	assert_true(back.recording.samples == status.recording.samples);
	assert_int_equal(back.subscribers, status.subscribers);
	assert_string_equal(back.version, status.version);
}

static void status_of_each_state_comes_back(void **state)
{
	(void)state;
	for (int i = 0; i < GZ_TRACKER_STATE_COUNT; i++) {
		struct gz_status status = sample_status(), back;
		struct gz_wire_message message;
		status.tracker.state = (enum gz_tracker_state)i;
		status.recording.state = (enum gz_recording_state)(i % GZ_RECORDING_STATE_COUNT);
		status.clock.tick = (enum gz_clock_tick)(i % GZ_CLOCK_TICK_COUNT);
		status.noise_deg = NAN;
		assert_int_equal(gz_wire_encode_status(&status, &message), GZ_OK);
		assert_int_equal(gz_wire_decode_status(message.bytes, message.size, &back), GZ_OK);
		assert_int_equal(back.tracker.state, i);
		assert_int_equal(back.recording.state, i % GZ_RECORDING_STATE_COUNT);
		assert_int_equal(back.clock.tick, i % GZ_CLOCK_TICK_COUNT);
		assert_true(isnan(back.noise_deg));
	}
}

/* A map being built by hand. */
struct built {
	msgpack_sbuffer buffer;
	msgpack_packer packer;
};

static void build(struct built *built, size_t pairs)
{
	msgpack_sbuffer_init(&built->buffer);
	msgpack_packer_init(&built->packer, &built->buffer, msgpack_sbuffer_write);
	msgpack_pack_map(&built->packer, pairs);
}

static msgpack_packer *key(struct built *built, const char *name)
{
	msgpack_pack_str_with_body(&built->packer, name, strlen(name));
	return &built->packer;
}

static void text(struct built *built, const char *name, const char *value)
{
	msgpack_pack_str_with_body(key(built, name), value, strlen(value));
}

static void number(struct built *built, const char *name, double value)
{
	msgpack_pack_double(key(built, name), value);
}

static void numbers(struct built *built, const char *name, size_t count, const double *values)
{
	msgpack_pack_array(key(built, name), count);
	for (size_t i = 0; i < count; i++)
		msgpack_pack_double(&built->packer, values[i]);
}

/* A vector for each eye. The key is its number: as text, or as an integer if @p old. */
static void vectors(struct built *built, const char *name, bool old, const double right[3],
		    const double left[3])
{
	msgpack_pack_map(key(built, name), 2);
	for (int eye = 0; eye < 2; eye++) {
		const double *vector = eye == 0 ? right : left;
		if (old)
			msgpack_pack_int(&built->packer, eye);
		else
			msgpack_pack_str_with_body(&built->packer, eye == 0 ? "0" : "1", 1);
		msgpack_pack_array(&built->packer, 3);
		for (int i = 0; i < 3; i++)
			msgpack_pack_double(&built->packer, vector[i]);
	}
}

/* A binocular gaze map with the keys of Pupil Capture 3, or of a version before 2.0. */
static void build_pupil_capture_gaze(struct built *built, bool old)
{
	build(built, 8);
	vectors(built, "eye_centers_3d", old, (double[]) { 20, 1, -2 }, (double[]) { -20, 1, -2 });
	vectors(built, "gaze_normals_3d", old, (double[]) { 0, 0, 1 }, (double[]) { 0.6, 0, 0.8 });
	numbers(built, "gaze_point_3d", 3, (double[]) { 10, -20, 600 });
	numbers(built, "norm_pos", 2, (double[]) { 0.375, 0.875 });
	text(built, "topic", "gaze.3d.01.");
	number(built, "confidence", 0.625);
	number(built, "timestamp", 4321.5);
	msgpack_pack_array(key(built, "base_data"), 2);
	for (int id = 0; id < 2; id++) {
		msgpack_pack_map(&built->packer, 11);
		text(built, "topic", id == 0 ? "pupil.0.3d" : "pupil.1.3d");
		msgpack_pack_int(key(built, "id"), id);
		text(built, "method", "pye3d 0.3.0 real-time");
		numbers(built, "norm_pos", 2, (double[]) { 0.9, 0.9 }); /* in the eye's image */
		number(built, "diameter", 41.5);
		number(built, "diameter_3d", id == 0 ? 3.5 : 4.5);
		number(built, "phi", -1.5);
		number(built, "theta", 1.5);
		number(built, "confidence", id == 0 ? 0.75 : 0.5);
		number(built, "timestamp", 4321.49);
		msgpack_pack_map(key(built, "sphere"), 2);
		numbers(built, "center", 3, (double[]) { 1, 2, 40 });
		number(built, "radius", 10.39);
	}
}

static void check_pupil_capture_gaze(bool old)
{
	struct built built;
	struct gz_gaze gaze;
	build_pupil_capture_gaze(&built, old);
	assert_int_equal(gz_wire_decode_gaze(built.buffer.data, built.buffer.size, &gaze), GZ_OK);
	assert_float_same(gaze.point.x, 0.375f);
	assert_float_same(gaze.point.y, 0.125f);
	assert_float_same(gaze.raw.x, NAN);
	assert_float_same(gaze.confidence, 0.625f);
	assert_int_equal(gaze.host_ns, 4321500000000);
	assert_true(gaze.device_ns == GZ_NO_DEVICE_TIME);
	assert_int_equal(gaze.publish_ns, 0);
	assert_int_equal(gaze.seq, 0);
	assert_int_equal(gaze.event, GZ_EVENT_FIXATION);
	assert_false(gaze.final_known);
	assert_false(gaze.combined);
	assert_float_same(gaze.velocity_deg_s, NAN);
	for (int i = 0; i < GZ_EYE_COUNT; i++) {
		assert_true(gaze.eye[i].valid);
		assert_float_same(gaze.eye[i].point.x, NAN); /* not on the display */
		assert_float_same(gaze.eye[i].origin_mm[2], -2);
	}
	assert_float_same(gaze.eye[GZ_EYE_RIGHT].origin_mm[0], 20);
	assert_float_same(gaze.eye[GZ_EYE_LEFT].origin_mm[0], -20);
	assert_float_same(gaze.eye[GZ_EYE_RIGHT].direction[2], 1);
	assert_float_same(gaze.eye[GZ_EYE_LEFT].direction[0], 0.6f);
	assert_float_same(gaze.eye[GZ_EYE_RIGHT].pupil_mm, 3.5f);
	assert_float_same(gaze.eye[GZ_EYE_LEFT].pupil_mm, 4.5f);
	assert_float_same(gaze.eye[GZ_EYE_RIGHT].confidence, 0.75f);
	assert_float_same(gaze.eye[GZ_EYE_LEFT].confidence, 0.5f);
	msgpack_sbuffer_destroy(&built.buffer);
}

static void gaze_of_pupil_capture_decodes(void **state)
{
	(void)state;
	check_pupil_capture_gaze(false);
	check_pupil_capture_gaze(true);
}

static void surface_entries_decode(void **state)
{
	(void)state;
	struct gz_gaze gaze = sample_gaze();
	struct gz_wire_message message;
	struct gz_surface_gaze entries[2];
	size_t count = 77;
	assert_int_equal(gz_wire_encode_surface(&gaze, NULL, 0, "screen", &message), GZ_OK);
	assert_int_equal(gz_wire_decode_surface(message.bytes, message.size, entries, 0, &count),
			 GZ_ERR_FULL);
	assert_int_equal(count, 77);
	assert_int_equal(gz_wire_decode_surface(message.bytes, message.size, entries, 2, &count),
			 GZ_OK);
	assert_int_equal(count, 1);
	assert_float_same(entries[0].point.x, gaze.point.x);
	assert_float_same(entries[0].point.y, gaze.point.y);
	assert_float_same(entries[0].confidence, gaze.confidence);
	assert_true(entries[0].on_surface);
	assert_true(llabs(entries[0].time_ns - gaze.host_ns) < 1000);
	for (size_t size = 0; size < message.size; size++)
		assert_int_equal(gz_wire_decode_surface(message.bytes, size, entries, 2, &count),
				 GZ_ERR_PROTOCOL);
	/* No list, a list of numbers, an entry without a time. */
	assert_int_equal(gz_wire_decode_surface("\x80", 1, entries, 2, &count), GZ_ERR_PROTOCOL);
	static const char of_numbers[] = "\x81\xb0gaze_on_surfaces\x91\x01";
	assert_int_equal(
		gz_wire_decode_surface(of_numbers, sizeof of_numbers - 1, entries, 2, &count),
		GZ_ERR_PROTOCOL);
	static const char timeless[] = "\x81\xb0gaze_on_surfaces\x91\x81\xa8norm_pos\x92\x00\x00";
	assert_int_equal(gz_wire_decode_surface(timeless, sizeof timeless - 1, entries, 2, &count),
			 GZ_ERR_PROTOCOL);
}

static void gaze_with_the_least_keys_decodes(void **state)
{
	(void)state;
	struct built built;
	struct gz_gaze gaze;
	build(&built, 3);
	msgpack_pack_array(key(&built, "norm_pos"), 2); /* integers will do */
	msgpack_pack_int(&built.packer, 0);
	msgpack_pack_int(&built.packer, 1);
	msgpack_pack_int(key(&built, "timestamp"), -2);
	msgpack_pack_nil(key(&built, "confidence"));
	assert_int_equal(gz_wire_decode_gaze(built.buffer.data, built.buffer.size, &gaze), GZ_OK);
	assert_float_same(gaze.point.x, 0);
	assert_float_same(gaze.point.y, 0);
	assert_int_equal(gaze.host_ns, -2000000000);
	assert_float_same(gaze.confidence, NAN);
	assert_false(gaze.eye[0].valid || gaze.eye[1].valid);
	msgpack_sbuffer_destroy(&built.buffer);
}

/* Each adds one pair to a valid gaze map. */
typedef void add_pair(struct built *built);

static void no_pair(struct built *b)
{
	number(b, "unknown key", 1);
}
static void point_of_three(struct built *b)
{
	numbers(b, "point", 3, (double[]) { 0, 0, 0 });
}
static void point_of_text(struct built *b)
{
	text(b, "point", "here");
}
static void point_infinite(struct built *b)
{
	numbers(b, "point", 2, (double[]) { INFINITY, 0 });
}
static void point_too_far_for_a_float(struct built *b)
{
	numbers(b, "point", 2, (double[]) { 1e39, 0 });
}
static void confidence_above_one(struct built *b)
{
	number(b, "confidence", 1.0001);
}
static void confidence_below_zero(struct built *b)
{
	number(b, "confidence", -0.0001);
}
static void event_unheard_of(struct built *b)
{
	text(b, "event", "asleep");
}
static void event_a_number(struct built *b)
{
	number(b, "event", 1);
}
static void event_final_without_seq(struct built *b)
{
	msgpack_pack_map(key(b, "event_final"), 1);
	text(b, "event", "blink");
}
static void event_final_without_event(struct built *b)
{
	msgpack_pack_map(key(b, "event_final"), 1);
	msgpack_pack_int(key(b, "seq"), 1);
}
static void event_final_first_after_last(struct built *b)
{
	msgpack_pack_map(key(b, "event_final"), 3);
	msgpack_pack_int(key(b, "seq"), 1);
	text(b, "event", "blink");
	msgpack_pack_int(key(b, "first"), 2);
}
static void landing_without_a_time(struct built *b)
{
	msgpack_pack_map(key(b, "landing"), 2);
	msgpack_pack_array(key(b, "point"), 2);
	msgpack_pack_double(&b->packer, 0.5);
	msgpack_pack_double(&b->packer, 0.5);
	number(b, "sigma_deg", 1);
}
static void landing_without_a_place(struct built *b)
{
	msgpack_pack_map(key(b, "landing"), 2);
	number(b, "timestamp", 1);
	number(b, "sigma_deg", 1);
}
static void velocity_negative(struct built *b)
{
	number(b, "velocity_deg_s", -1);
}
static void velocity_infinite(struct built *b)
{
	number(b, "velocity_deg_s", INFINITY);
}
static void seq_negative(struct built *b)
{
	msgpack_pack_int(key(b, "seq"), -1);
}
static void seq_real(struct built *b)
{
	number(b, "seq", 1);
}
static void host_ns_beyond_int64(struct built *b)
{
	msgpack_pack_uint64(key(b, "host_ns"), UINT64_C(1) << 63);
}
static void combined_an_integer(struct built *b)
{
	msgpack_pack_int(key(b, "combined"), 1);
}
static void eye_a_list(struct built *b)
{
	msgpack_pack_array(key(b, "eye0"), 0);
}
static void base_data_a_text(struct built *b)
{
	text(b, "base_data", "none");
}

static enum gz_result decode_with(add_pair *add, struct gz_gaze *gaze)
{
	struct built built;
	build(&built, 3);
	numbers(&built, "norm_pos", 2, (double[]) { 0.5, 0.5 });
	number(&built, "timestamp", 1);
	add(&built);
	enum gz_result result = gz_wire_decode_gaze(built.buffer.data, built.buffer.size, gaze);
	msgpack_sbuffer_destroy(&built.buffer);
	return result;
}

static void gaze_with_a_wrong_value_is_refused_and_nothing_written(void **state)
{
	(void)state;
	static add_pair *const wrong[] = {
		point_of_three,
		point_of_text,
		point_infinite,
		point_too_far_for_a_float,
		confidence_above_one,
		confidence_below_zero,
		event_unheard_of,
		event_a_number,
		event_final_without_seq,
		event_final_without_event,
		event_final_first_after_last,
		landing_without_a_time,
		landing_without_a_place,
		velocity_negative,
		velocity_infinite,
		seq_negative,
		seq_real,
		host_ns_beyond_int64,
		combined_an_integer,
		eye_a_list,
		base_data_a_text,
	};
	struct gz_gaze gaze, before;
	memset(&gaze, 0x5a, sizeof gaze);
	memcpy(&before, &gaze, sizeof gaze);
	for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
		enum gz_result result = decode_with(wrong[i], &gaze);
		if (result != GZ_ERR_PROTOCOL)
			fail_msg("wrong value %zu gave %d", i, result);
		assert_memory_equal(&gaze, &before, sizeof gaze);
	}
	assert_int_equal(decode_with(no_pair, &gaze), GZ_OK);
}

static void raw_with_nan(struct built *b)
{
	numbers(b, "raw", 2, (double[]) { NAN, 0.5 });
}

static void nan_from_another_sender_is_not_measured(void **state)
{
	(void)state;
	struct gz_gaze gaze;
	assert_int_equal(decode_with(raw_with_nan, &gaze), GZ_OK);
	assert_float_same(gaze.raw.x, NAN);
	assert_float_same(gaze.raw.y, NAN);
}

static void event_final_of_a_later_version(struct built *b)
{
	msgpack_pack_map(key(b, "event_final"), 2);
	msgpack_pack_int(key(b, "seq"), 1);
	text(b, "event", "microsaccade");
}

static void certain_label_of_a_later_version_is_left_out(void **state)
{
	(void)state;
	struct gz_gaze gaze;
	assert_int_equal(decode_with(event_final_of_a_later_version, &gaze), GZ_OK);
	assert_false(gaze.final_known);
}

static void gaze_without_place_or_time_is_refused(void **state)
{
	(void)state;
	struct gz_gaze gaze;
	for (int timed = 0; timed < 2; timed++) {
		struct built built;
		build(&built, 1);
		if (timed)
			number(&built, "timestamp", 1);
		else
			numbers(&built, "norm_pos", 2, (double[]) { 0.5, 0.5 });
		assert_int_equal(gz_wire_decode_gaze(built.buffer.data, built.buffer.size, &gaze),
				 GZ_ERR_PROTOCOL);
		msgpack_sbuffer_destroy(&built.buffer);
	}
}

static void timestamp_no_ns_can_hold_is_refused(void **state)
{
	(void)state;
	static const double times[] = { 1e10, -1e10, 1e300, INFINITY };
	for (size_t i = 0; i < sizeof times / sizeof *times; i++) {
		struct built built;
		struct gz_blink blink;
		build(&built, 2);
		text(&built, "type", "onset");
		number(&built, "timestamp", times[i]);
		assert_int_equal(gz_wire_decode_blink(built.buffer.data, built.buffer.size, &blink),
				 GZ_ERR_PROTOCOL);
		msgpack_sbuffer_destroy(&built.buffer);
	}
}

static void duration_negative_is_refused(void **state)
{
	(void)state;
	struct built built;
	struct gz_fixation fixation;
	struct gz_saccade saccade;
	build(&built, 2);
	number(&built, "timestamp", 1);
	number(&built, "duration", -0.5);
	assert_int_equal(gz_wire_decode_fixation(built.buffer.data, built.buffer.size, &fixation),
			 GZ_ERR_PROTOCOL);
	assert_int_equal(gz_wire_decode_saccade(built.buffer.data, built.buffer.size, &saccade),
			 GZ_ERR_PROTOCOL);
	msgpack_sbuffer_destroy(&built.buffer);
}

static void status_text_too_long_for_its_field_is_refused(void **state)
{
	(void)state;
	for (size_t longer = 0; longer < 2; longer++) {
		char name[GZ_NAME_SIZE + 1] = "";
		memset(name, 'n', GZ_NAME_SIZE - 1 + longer);
		struct built built;
		struct gz_status status;
		build(&built, 1);
		text(&built, "version", name);
		assert_int_equal(
			gz_wire_decode_status(built.buffer.data, built.buffer.size, &status),
			longer ? GZ_ERR_PROTOCOL : GZ_OK);
		msgpack_sbuffer_destroy(&built.buffer);
	}
}

static void status_text_with_a_nul_is_refused(void **state)
{
	(void)state;
	static const char bytes[] = "\x81\xa7version\xa3"
				    "1\0"
				    "2";
	struct gz_status status;
	assert_int_equal(gz_wire_decode_status(bytes, sizeof bytes - 1, &status), GZ_ERR_PROTOCOL);
}

static void message_that_is_no_map_is_refused(void **state)
{
	(void)state;
	static const char *const others[] = { "\x90", "\xc0", "\x01", "\xa4gaze" };
	for (size_t i = 0; i < sizeof others / sizeof *others; i++) {
		size_t size = strlen(others[i]);
		struct gz_gaze gaze;
		struct gz_fixation fixation;
		struct gz_blink blink;
		struct gz_saccade saccade;
		struct gz_status status;
		assert_int_equal(gz_wire_decode_gaze(others[i], size, &gaze), GZ_ERR_PROTOCOL);
		assert_int_equal(gz_wire_decode_fixation(others[i], size, &fixation),
				 GZ_ERR_PROTOCOL);
		assert_int_equal(gz_wire_decode_blink(others[i], size, &blink), GZ_ERR_PROTOCOL);
		assert_int_equal(gz_wire_decode_saccade(others[i], size, &saccade),
				 GZ_ERR_PROTOCOL);
		assert_int_equal(gz_wire_decode_status(others[i], size, &status), GZ_ERR_PROTOCOL);
	}
}

static void gaze_cut_anywhere_is_refused(void **state)
{
	(void)state;
	struct gz_display display = sample_display();
	struct gz_gaze gaze = sample_gaze(), back;
	struct gz_wire_message message;
	assert_int_equal(gz_wire_encode_gaze(&gaze, &display, &message), GZ_OK);
	for (size_t size = 0; size < message.size; size++)
		assert_int_equal(gz_wire_decode_gaze(message.bytes, size, &back), GZ_ERR_PROTOCOL);
}

/* What the other keys of an annotation become; @p pairs are @p count pairs after the label. */
static void check_annotation_keys(int count, const char *pairs, size_t size, const char *expected)
{
	static const char label[] = "\xa5label\xa1x";
	unsigned char bytes[2048];
	struct gz_annotation back;
	size_t used = 0;
	bytes[used++] = (unsigned char)(0x80 + count + 1);
	memcpy(bytes + used, label, sizeof label - 1);
	used += sizeof label - 1;
	memcpy(bytes + used, pairs, size);
	used += size;
	assert_int_equal(gz_wire_decode_annotation(bytes, used, &back), GZ_OK);
	assert_string_equal(back.label, "x");
	assert_string_equal(back.keys, expected);
}

#define KEYS(count, pairs, expected) \
	check_annotation_keys((count), (pairs), sizeof(pairs) - 1, (expected))

static void annotation_keeps_its_other_keys_as_json(void **state)
{
	(void)state;
	KEYS(0, "", "");
	KEYS(1,
	     "\xa5topic\xaa"
	     "annotation",
	     "");
	KEYS(3,
	     "\xa1"
	     "a\x07\xa1"
	     "b\xd0\xfe\xa1"
	     "c\xcb\x3f\xb9\x99\x99\x99\x99\x99\x9a",
	     "{\"a\":7,\"b\":-2,\"c\":0.1}");
	KEYS(3,
	     "\xa1"
	     "a\xc3\xa1"
	     "b\xc0\xa1"
	     "c\xc4\x01x",
	     "{\"a\":true,\"b\":null,\"c\":null}");
	KEYS(1,
	     "\xa1"
	     "a\xcb\x7f\xf0\x00\x00\x00\x00\x00\x00",
	     "{\"a\":null}");
	KEYS(1,
	     "\xa1"
	     "a\x92\x01\x81\xa1"
	     "b\x90",
	     "{\"a\":[1,{\"b\":[]}]}");
	KEYS(1,
	     "\xa3"
	     "q\"\\\xa4"
	     "\t\x7f\xc3\xa9",
	     "{\"q\\\"\\\\\":\"\\u0009\x7f\xc3\xa9\"}");
	KEYS(1,
	     "\xa1"
	     "a\xa5\xff\xc3(\xe2\x82",
	     "{\"a\":\"?\?(?\?\"}");
	KEYS(2,
	     "\x01\x02\xa1"
	     "a\x03",
	     "{\"a\":3}"); /* a key that is no text */
}

static void annotation_keys_without_room_are_left_out_and_said_so(void **state)
{
	(void)state;
	char pairs[1024], expected[GZ_ANNOTATION_KEYS_SIZE];
	/* "a": 400 letters has room, "b": 200 letters has not, "c": 1 has again. */
	size_t used;
	static const char a[] = "\xa1"
				"a\xda\x01\x90";
	static const char b[] = "\xa1"
				"b\xd9\xc8";
	used = 0;
	memcpy(pairs, a, sizeof a - 1);
	used += sizeof a - 1;
	memset(pairs + used, 'k', 400);
	used += 400;
	memcpy(pairs + used, b, sizeof b - 1);
	used += sizeof b - 1;
	memset(pairs + used, 'k', 200);
	used += 200;
	memcpy(pairs + used,
	       "\xa1"
	       "c\x01",
	       3);
	used += 3;
	char letters[401];
	memset(letters, 'k', 400);
	letters[400] = '\0';
	snprintf(expected, sizeof expected, "{\"a\":\"%s\",\"c\":1,\"truncated\":true}", letters);
	check_annotation_keys(3, pairs, used, expected);
}

static void annotation_comes_back_as_it_was_sent(void **state)
{
	(void)state;
	struct gz_annotation sent = { .label = "target 3 of 9", .duration_ns = 1500000000 }, back;
	struct gz_wire_message message;
	for (int i = 0; i < 2; i++) {
		sent.has_time = i == 1;
		sent.time_ns = i == 1 ? 123456789012345 : 0;
		memset(&back, 0, sizeof back);
		assert_int_equal(gz_wire_encode_annotation(&sent, &message), GZ_OK);
		assert_int_equal(gz_wire_decode_annotation(message.bytes, message.size, &back),
				 GZ_OK);
		assert_string_equal(back.label, sent.label);
		assert_int_equal(back.has_time, sent.has_time);
		assert_true(back.time_ns == sent.time_ns);
		assert_true(back.duration_ns == sent.duration_ns);
	}
}

TEST_SUITE(wire_decode)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(gaze_comes_back_as_it_was_sent),
		cmocka_unit_test(gaze_of_each_event_comes_back),
		cmocka_unit_test(annotation_comes_back_as_it_was_sent),
		cmocka_unit_test(annotation_keeps_its_other_keys_as_json),
		cmocka_unit_test(annotation_keys_without_room_are_left_out_and_said_so),
		cmocka_unit_test(gaze_unmeasured_comes_back_as_nan),
		cmocka_unit_test(fixation_comes_back_as_it_was_sent),
		cmocka_unit_test(blink_comes_back_as_it_was_sent),
		cmocka_unit_test(saccade_comes_back_as_it_was_sent),
		cmocka_unit_test(status_comes_back_as_it_was_sent),
		cmocka_unit_test(status_of_each_state_comes_back),
		cmocka_unit_test(gaze_of_pupil_capture_decodes),
		cmocka_unit_test(surface_entries_decode),
		cmocka_unit_test(gaze_with_the_least_keys_decodes),
		cmocka_unit_test(gaze_with_a_wrong_value_is_refused_and_nothing_written),
		cmocka_unit_test(nan_from_another_sender_is_not_measured),
		cmocka_unit_test(certain_label_of_a_later_version_is_left_out),
		cmocka_unit_test(gaze_without_place_or_time_is_refused),
		cmocka_unit_test(timestamp_no_ns_can_hold_is_refused),
		cmocka_unit_test(duration_negative_is_refused),
		cmocka_unit_test(status_text_too_long_for_its_field_is_refused),
		cmocka_unit_test(status_text_with_a_nul_is_refused),
		cmocka_unit_test(message_that_is_no_map_is_refused),
		cmocka_unit_test(gaze_cut_anywhere_is_refused),
	};
	return cmocka_run_group_tests_name("wire_decode", tests, NULL, NULL);
}
