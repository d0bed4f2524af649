#include "suite.h"

#include "protocol/wire.h"

#include <float.h>

#include "near.h"
#include "protocol/sample_messages.h"
#include "protocol/unpacked.h"

static const char GAZE_KEYS[] =
	"topic norm_pos confidence timestamp gaze_point_3d base_data point raw event event_final "
	"velocity_deg_s landing seq device_ns host_ns eye0 eye1 combined publish_ns";
static const char GAZE_KEYS_LEAST[] =
	"topic norm_pos confidence timestamp gaze_point_3d base_data point raw event "
	"velocity_deg_s seq device_ns host_ns eye0 eye1 combined publish_ns";
static const char PUPIL_KEYS[] = "topic id norm_pos diameter diameter_3d phi theta sphere "
				 "confidence timestamp method";

static void encode_gaze(const struct gz_gaze *gaze, struct gz_wire_message *message)
{
	struct gz_display display = sample_display();
	assert_int_equal(gz_wire_encode_gaze(gaze, &display, message), GZ_OK);
}

static void gaze_has_the_documented_keys_and_no_other(void **state)
{
	(void)state;
	struct gz_gaze gaze = sample_gaze();
	struct gz_wire_message message;
	msgpack_unpacked unpacked;
	encode_gaze(&gaze, &message);
	const msgpack_object *map = unpack_map(&message, &unpacked);
	assert_keys(map, GAZE_KEYS);
	assert_keys(value_of(map, "event_final"), "seq event first");
	const msgpack_object *landing = value_of(map, "landing");
	assert_keys(landing, "point timestamp sigma_deg");
	assert_numbers(value_of(landing, "point"), (double[]) { 0.8f, 0.2f }, 2);
	assert_near(value_of(landing, "timestamp")->via.f64, 123456.809012345, 1e-9);
	assert_number(value_of(landing, "sigma_deg"), 1.5);
	assert_keys(value_of(map, "eye0"), "point pupil_mm valid");
	assert_keys(value_of(map, "eye1"), "point pupil_mm valid");
	const msgpack_object *pupils = value_of(map, "base_data");
	assert_int_equal(pupils->via.array.size, 2);
	for (uint32_t i = 0; i < 2; i++) {
		const msgpack_object *pupil = &pupils->via.array.ptr[i];
		assert_keys(pupil, PUPIL_KEYS);
		assert_keys(value_of(pupil, "sphere"), "center radius confidence");
	}
	msgpack_unpacked_destroy(&unpacked);

	gaze.final_known = false;
	gaze.landing.known = false;
	encode_gaze(&gaze, &message);
	assert_keys(unpack_map(&message, &unpacked), GAZE_KEYS_LEAST);
	msgpack_unpacked_destroy(&unpacked);
}

static void gaze_values_are_those_of_the_message(void **state)
{
	(void)state;
	struct gz_gaze gaze = sample_gaze();
	struct gz_wire_message message;
	msgpack_unpacked unpacked;
	encode_gaze(&gaze, &message);
	const msgpack_object *map = unpack_map(&message, &unpacked);
	assert_text(value_of(map, "topic"), "gaze.3d.01.");
	assert_numbers(value_of(map, "norm_pos"), (double[]) { 0.75, 0.75 }, 2);
	assert_numbers(value_of(map, "point"), (double[]) { 0.75, 0.25 }, 2);
	assert_numbers(value_of(map, "raw"), (double[]) { 0.7501f, -0.2501f }, 2);
	assert_numbers(value_of(map, "gaze_point_3d"), (double[]) { 150, -75, 500 }, 3);
	assert_number(value_of(map, "confidence"), 0.875);
	assert_near(value_of(map, "timestamp")->via.f64, 123456.789012345, 1e-9);
	assert_text(value_of(map, "event"), "saccade");
	assert_number(value_of(value_of(map, "event_final"), "seq"), 1099511627700);
	assert_text(value_of(value_of(map, "event_final"), "event"), "pursuit");
	assert_number(value_of(value_of(map, "event_final"), "first"), 1099511627697);
	assert_number(value_of(map, "velocity_deg_s"), 123.4f);
	assert_number(value_of(map, "seq"), 1099511627776);
	assert_number(value_of(map, "device_ns"), -77);
	assert_number(value_of(map, "host_ns"), 123456789012345);
	assert_number(value_of(map, "publish_ns"), 123456789112345);
	assert_int_equal(value_of(map, "combined")->type, MSGPACK_OBJECT_BOOLEAN);
	assert_false(value_of(map, "combined")->via.boolean);
	const msgpack_object *left = value_of(map, "eye1");
	assert_numbers(value_of(left, "point"), (double[]) { 0.76f, 0.26f }, 2);
	assert_number(value_of(left, "pupil_mm"), 3.25);
	assert_true(value_of(left, "valid")->via.boolean);
	msgpack_unpacked_destroy(&unpacked);
}

static void pupil_values_are_those_of_the_eye(void **state)
{
	(void)state;
	struct gz_gaze gaze = sample_gaze();
	gaze.eye[GZ_EYE_LEFT].point = (struct gz_point) { 0.5f, 0.75f };
	struct gz_wire_message message;
	msgpack_unpacked unpacked;
	encode_gaze(&gaze, &message);
	const msgpack_object *map = unpack_map(&message, &unpacked);
	const msgpack_object *pupil = &value_of(map, "base_data")->via.array.ptr[GZ_EYE_LEFT];
	assert_text(value_of(pupil, "topic"), "pupil.1.3d");
	assert_number(value_of(pupil, "id"), 1);
	assert_numbers(value_of(pupil, "norm_pos"), (double[]) { 0.5, 0.25 }, 2);
	assert_number(value_of(pupil, "diameter"), 32.5);
	assert_number(value_of(pupil, "diameter_3d"), 3.25);
	/* 75 mm below the eye, 500 mm away; straight ahead both angles are pi/2. */
	assert_near(value_of(pupil, "phi")->via.f64, 1.57079632679, 1e-9);
	assert_near(value_of(pupil, "theta")->via.f64, 1.57079632679 - atan(75.0 / 500), 1e-9);
	assert_number(value_of(pupil, "confidence"), 0.8f);
	assert_text(value_of(pupil, "method"), "gazecast");
	const msgpack_object *sphere = value_of(pupil, "sphere");
	assert_numbers(value_of(sphere, "center"), (double[]) { -31, -2, 481 }, 3);
	assert_number(value_of(sphere, "confidence"), 0.8f);
	msgpack_unpacked_destroy(&unpacked);
}

static void pupil_without_position_has_the_distance_and_no_confidence_in_it(void **state)
{
	(void)state;
	struct gz_gaze gaze = sample_gaze();
	gaze.eye[GZ_EYE_RIGHT].origin_mm[1] = NAN;
	struct gz_wire_message message;
	msgpack_unpacked unpacked;
	encode_gaze(&gaze, &message);
	const msgpack_object *map = unpack_map(&message, &unpacked);
	const msgpack_object *sphere =
		value_of(&value_of(map, "base_data")->via.array.ptr[0], "sphere");
	assert_numbers(value_of(sphere, "center"), (double[]) { 0, 0, 500 }, 3);
	assert_number(value_of(sphere, "confidence"), 0);
	msgpack_unpacked_destroy(&unpacked);
}

static void gaze_topic_tells_which_eyes_took_part(void **state)
{
	(void)state;
	static const struct {
		bool right, left, combined;
		const char *topic;
		size_t pupils;
		int first_id;
	} cases[] = {
		{ true, true, false, "gaze.3d.01.", 2, 0 },
		{ true, false, false, "gaze.3d.0.", 1, 0 },
		{ false, true, false, "gaze.3d.1.", 1, 1 },
		{ false, false, false, "gaze.3d.01.", 2, 0 },
		{ false, false, true, "gaze.3d.01.", 2, 0 },
		{ true, false, true, "gaze.3d.01.", 2, 0 },
	};
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		struct gz_gaze gaze = sample_gaze();
		gaze.eye[GZ_EYE_RIGHT].valid = cases[i].right;
		gaze.eye[GZ_EYE_LEFT].valid = cases[i].left;
		gaze.combined = cases[i].combined;
		assert_string_equal(gz_wire_gaze_topic(&gaze), cases[i].topic);
		struct gz_wire_message message;
		msgpack_unpacked unpacked;
		encode_gaze(&gaze, &message);
		const msgpack_object *map = unpack_map(&message, &unpacked);
		assert_text(value_of(map, "topic"), cases[i].topic);
		const msgpack_object *pupils = value_of(map, "base_data");
		assert_int_equal(pupils->via.array.size, cases[i].pupils);
		assert_number(value_of(&pupils->via.array.ptr[0], "id"), cases[i].first_id);
		msgpack_unpacked_destroy(&unpacked);
	}
}

static struct gz_gaze nothing_but_a_point(void)
{
	static const struct gz_gaze_eye eye = { .point = { NAN, NAN },
						.pupil_mm = NAN,
						.confidence = NAN,
						.origin_mm = { NAN, NAN, NAN },
						.direction = { NAN, NAN, NAN } };
	return (struct gz_gaze) {
		.device_ns = GZ_NO_DEVICE_TIME,
		.point = { 0.25f, 0.5f },
		.raw = { NAN, NAN },
		.event = GZ_EVENT_LOST,
		.velocity_deg_s = INFINITY,
		.eye = { eye, eye },
	};
}

static void gaze_unmeasured_is_nil_and_never_nan(void **state)
{
	(void)state;
	struct gz_gaze gaze = nothing_but_a_point();
	struct gz_wire_message message;
	msgpack_unpacked unpacked;
	encode_gaze(&gaze, &message);
	const msgpack_object *map = unpack_map(&message, &unpacked);
	assert_all_finite(map);
	assert_nil(value_of(map, "raw"));
	assert_nil(value_of(map, "device_ns"));
	assert_nil(value_of(map, "velocity_deg_s"));
	assert_nil(value_of(value_of(map, "eye0"), "point"));
	assert_nil(value_of(value_of(map, "eye0"), "pupil_mm"));
	const msgpack_object *pupil = &value_of(map, "base_data")->via.array.ptr[0];
	assert_nil(value_of(pupil, "diameter"));
	assert_nil(value_of(pupil, "diameter_3d"));
	/* Pupil's readers do not check these values, so they must be numbers. */
	assert_numbers(value_of(pupil, "norm_pos"), (double[]) { 0.25, 0.5 }, 2);
	assert_number(value_of(pupil, "confidence"), 0);
	msgpack_unpacked_destroy(&unpacked);
}

static void gaze_ends_in_publish_time_of_fixed_width(void **state)
{
	(void)state;
	static const int64_t times[] = { 0, 1, -1, 300, INT64_MAX, INT64_MIN };
	struct gz_gaze gaze = sample_gaze();
	struct gz_wire_message first, message;
	encode_gaze(&gaze, &first);
	size_t same = first.size - GZ_WIRE_PUBLISH_SIZE;
	assert_memory_equal(first.bytes + same, "\xaapublish_ns\xd3", 12);
	for (size_t i = 0; i < sizeof times / sizeof *times; i++) {
		gaze.publish_ns = times[i];
		encode_gaze(&gaze, &message);
		assert_int_equal(message.size, first.size);
		assert_memory_equal(message.bytes, first.bytes, same);
		assert_memory_not_equal(message.bytes, first.bytes, first.size);
	}
	gaze.publish_ns = sample_gaze().publish_ns;
	gaze.raw.x += 1e-6f;
	encode_gaze(&gaze, &message);
	assert_memory_not_equal(message.bytes, first.bytes, same);
}

static void gaze_shows_where_its_pupil_maps_stand(void **state)
{
	(void)state;
	struct gz_gaze gaze = sample_gaze();
	struct gz_wire_message message, pupil = { 0 };
	msgpack_unpacked unpacked;
	encode_gaze(&gaze, &message);
	for (int eye = 0; eye < GZ_EYE_COUNT; eye++) {
		pupil.size = message.pupil[eye].size;
		assert_in_range(pupil.size, 1, message.size - message.pupil[eye].at);
		memcpy(pupil.bytes, message.bytes + message.pupil[eye].at, pupil.size);
		const msgpack_object *map = unpack_map(&pupil, &unpacked);
		assert_text(value_of(map, "topic"),
			    eye == GZ_EYE_RIGHT ? "pupil.0.3d" : "pupil.1.3d");
		assert_int_equal(value_of(map, "id")->via.u64, eye);
		msgpack_unpacked_destroy(&unpacked);
	}
	gaze.eye[GZ_EYE_RIGHT].valid = false;
	encode_gaze(&gaze, &message);
	assert_int_equal(message.pupil[GZ_EYE_RIGHT].size, 0);
	assert_true(message.pupil[GZ_EYE_LEFT].size > 0);
}

static void surface_refers_to_its_gaze_by_topic_and_time(void **state)
{
	(void)state;
	struct gz_gaze gaze = sample_gaze();
	struct gz_wire_message message, gaze_message;
	msgpack_unpacked unpacked, gaze_unpacked;
	gaze.eye[GZ_EYE_RIGHT].valid = false;
	encode_gaze(&gaze, &gaze_message);
	assert_int_equal(gz_wire_encode_surface(&gaze, NULL, 0, "screen", &message), GZ_OK);
	const msgpack_object *gaze_map = unpack_map(&gaze_message, &gaze_unpacked);
	const msgpack_object *map = unpack_map(&message, &unpacked);
	double time_s = value_of(gaze_map, "timestamp")->via.f64;
	assert_keys(map, "topic name timestamp gaze_on_surfaces fixations_on_surfaces");
	assert_int_equal(value_of(map, "fixations_on_surfaces")->via.array.size, 0);
	assert_text(value_of(map, "topic"), "surfaces.screen");
	assert_text(value_of(map, "name"), "screen");
	assert_number(value_of(map, "timestamp"), time_s);
	assert_int_equal(value_of(map, "gaze_on_surfaces")->via.array.size, 1);
	const msgpack_object *on = &value_of(map, "gaze_on_surfaces")->via.array.ptr[0];
	assert_keys(on, "topic norm_pos confidence on_surf base_data timestamp");
	assert_text(value_of(on, "topic"), "gaze.3d.1._on_surface");
	assert_numbers(value_of(on, "norm_pos"), (double[]) { 0.75, 0.75 }, 2);
	assert_number(value_of(on, "timestamp"), time_s);
	const msgpack_object *base = value_of(on, "base_data");
	assert_int_equal(base->via.array.size, 2);
	assert_text(&base->via.array.ptr[0], "gaze.3d.1.");
	assert_number(&base->via.array.ptr[1], time_s);
	msgpack_unpacked_destroy(&unpacked);
	msgpack_unpacked_destroy(&gaze_unpacked);
}

static void event_final_has_the_documented_keys(void **state)
{
	(void)state;
	struct gz_gaze gaze = sample_gaze();
	struct gz_wire_message message;
	msgpack_unpacked unpacked;
	assert_int_equal(gz_wire_encode_event_final(&gaze, &message), GZ_OK);
	const msgpack_object *map = unpack_map(&message, &unpacked);
	assert_keys(map, "topic timestamp event_final");
	assert_text(value_of(map, "topic"), "event_final");
	assert_near(value_of(map, "timestamp")->via.f64, 123456.789012345, 1e-9);
	assert_keys(value_of(map, "event_final"), "seq event first");
	assert_number(value_of(value_of(map, "event_final"), "first"), 1099511627697);
	assert_text(value_of(value_of(map, "event_final"), "event"), "pursuit");
	msgpack_unpacked_destroy(&unpacked);
	gaze.final_span = 0;
	assert_int_equal(gz_wire_encode_event_final(&gaze, &message), GZ_OK);
	assert_keys(value_of(unpack_map(&message, &unpacked), "event_final"), "seq event");
	msgpack_unpacked_destroy(&unpacked);
}

/* As map_gaze_and_fixation_events() of Pupil's surface_tracker/surface.py makes them. */
static void surface_has_the_fixations_too(void **state)
{
	(void)state;
	struct gz_gaze gaze = sample_gaze();
	struct gz_fixation fixations[2] = { sample_fixation(), sample_fixation() };
	struct gz_wire_message message;
	msgpack_unpacked unpacked;
	fixations[1].id = 4712;
	fixations[1].point = (struct gz_point) { 0.5f, 1.5f };
	assert_int_equal(gz_wire_encode_surface(&gaze, fixations, 2, "screen", &message), GZ_OK);
	const msgpack_object *map = unpack_map(&message, &unpacked);
	const msgpack_object *on = value_of(map, "fixations_on_surfaces");
	assert_int_equal(on->via.array.size, 2);
	on = &on->via.array.ptr[0];
	assert_keys(on, "topic norm_pos confidence on_surf base_data timestamp id duration "
			"dispersion");
	assert_text(value_of(on, "topic"), "fixations_on_surface");
	assert_numbers(value_of(on, "norm_pos"), (double[]) { 0.125, 0.75 }, 2);
	assert_number(value_of(on, "confidence"), 0.5);
	assert_true(value_of(on, "on_surf")->via.boolean);
	assert_text(&value_of(on, "base_data")->via.array.ptr[0], "fixations");
	assert_near(value_of(on, "base_data")->via.array.ptr[1].via.f64, 123456.789012345, 1e-9);
	assert_near(value_of(on, "timestamp")->via.f64, 123456.789012345, 1e-9);
	assert_number(value_of(on, "id"), 4711);
	assert_near(value_of(on, "duration")->via.f64, 250.833333, 1e-9); /* ms */
	assert_number(value_of(on, "dispersion"), 0.4f);
	on = &value_of(map, "fixations_on_surfaces")->via.array.ptr[1];
	assert_number(value_of(on, "id"), 4712);
	assert_false(value_of(on, "on_surf")->via.boolean);
	msgpack_unpacked_destroy(&unpacked);
}

static void gaze_has_the_lines_of_sight_that_were_measured(void **state)
{
	(void)state;
	struct gz_gaze gaze = sample_gaze();
	struct gz_wire_message message;
	msgpack_unpacked unpacked;
	const float right[3] = { 0.25f, 0, -0.5f }, left[3] = { 0.125f, 0, -0.75f };
	memcpy(gaze.eye[GZ_EYE_RIGHT].direction, right, sizeof right);
	encode_gaze(&gaze, &message); /* only one eye's */
	assert_false(has_key(unpack_map(&message, &unpacked), "eye_centers_3d"));
	msgpack_unpacked_destroy(&unpacked);

	memcpy(gaze.eye[GZ_EYE_LEFT].direction, left, sizeof left);
	encode_gaze(&gaze, &message);
	const msgpack_object *map = unpack_map(&message, &unpacked);
	const msgpack_object *centres = value_of(map, "eye_centers_3d");
	const msgpack_object *normals = value_of(map, "gaze_normals_3d");
	assert_keys(centres, "0 1");
	assert_keys(normals, "0 1");
	assert_numbers(value_of(centres, "0"), (double[]) { 31, -2, 480 }, 3);
	assert_numbers(value_of(centres, "1"), (double[]) { -31, -2, 481 }, 3);
	assert_numbers(value_of(normals, "0"), (double[]) { 0.25, 0, -0.5 }, 3);
	assert_numbers(value_of(normals, "1"), (double[]) { 0.125, 0, -0.75 }, 3);
	assert_false(has_key(map, "eye_center_3d"));
	msgpack_unpacked_destroy(&unpacked);

	gaze.eye[GZ_EYE_RIGHT].valid = false;
	encode_gaze(&gaze, &message);
	map = unpack_map(&message, &unpacked);
	assert_numbers(value_of(map, "eye_center_3d"), (double[]) { -31, -2, 481 }, 3);
	assert_numbers(value_of(map, "gaze_normal_3d"), (double[]) { 0.125, 0, -0.75 }, 3);
	assert_false(has_key(map, "eye_centers_3d"));
	msgpack_unpacked_destroy(&unpacked);
}

static void surface_is_left_past_any_edge(void **state)
{
	(void)state;
	static const struct {
		struct gz_point point;
		bool on;
	} cases[] = {
		{ { 0, 0 }, true },       { { 1, 1 }, true },         { { 0.5f, 0.5f }, true },
		{ { -1e-6f, 0 }, false }, { { 0, 1.00001f }, false }, { { 1.00001f, 0 }, false },
		{ { 0, -1e-6f }, false },
	};
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		struct gz_gaze gaze = sample_gaze();
		struct gz_wire_message message;
		msgpack_unpacked unpacked;
		gaze.point = cases[i].point;
		assert_int_equal(gz_wire_encode_surface(&gaze, NULL, 0, "s", &message), GZ_OK);
		const msgpack_object *map = unpack_map(&message, &unpacked);
		const msgpack_object *on = &value_of(map, "gaze_on_surfaces")->via.array.ptr[0];
		assert_int_equal(value_of(on, "on_surf")->type, MSGPACK_OBJECT_BOOLEAN);
		assert_int_equal(value_of(on, "on_surf")->via.boolean, cases[i].on);
		msgpack_unpacked_destroy(&unpacked);
	}
}

static void fixation_has_the_documented_keys_and_units(void **state)
{
	(void)state;
	struct gz_fixation fixation = sample_fixation();
	struct gz_wire_message message;
	msgpack_unpacked unpacked;
	assert_int_equal(gz_wire_encode_fixation(&fixation, &message), GZ_OK);
	const msgpack_object *map = unpack_map(&message, &unpacked);
	assert_keys(map, "topic id timestamp duration dispersion norm_pos confidence method "
			 "base_data point final");
	assert_text(value_of(map, "topic"), "fixations");
	assert_number(value_of(map, "id"), 4711);
	assert_near(value_of(map, "timestamp")->via.f64, 123456.789012345, 1e-9);
	assert_near(value_of(map, "duration")->via.f64, 250.833333, 1e-9); /* ms */
	assert_number(value_of(map, "dispersion"), 0.4f);
	assert_numbers(value_of(map, "norm_pos"), (double[]) { 0.125, 0.75 }, 2);
	assert_numbers(value_of(map, "point"), (double[]) { 0.125, 0.25 }, 2);
	assert_text(value_of(map, "method"), "gazecast");
	assert_int_equal(value_of(map, "base_data")->type, MSGPACK_OBJECT_ARRAY);
	assert_int_equal(value_of(map, "base_data")->via.array.size, 0);
	assert_true(value_of(map, "final")->via.boolean);
	msgpack_unpacked_destroy(&unpacked);
}

static void blink_has_the_documented_keys(void **state)
{
	(void)state;
	struct gz_blink blink = sample_blink();
	struct gz_wire_message message;
	msgpack_unpacked unpacked;
	for (int onset = 0; onset < 2; onset++) {
		blink.onset = onset;
		assert_int_equal(gz_wire_encode_blink(&blink, &message), GZ_OK);
		const msgpack_object *map = unpack_map(&message, &unpacked);
		assert_keys(map, "topic base_data type timestamp confidence");
		assert_text(value_of(map, "type"), onset ? "onset" : "offset");
		msgpack_unpacked_destroy(&unpacked);
	}
}

static void saccade_has_the_documented_keys(void **state)
{
	(void)state;
	struct gz_saccade saccade = sample_saccade();
	struct gz_wire_message message;
	msgpack_unpacked unpacked;
	assert_int_equal(gz_wire_encode_saccade(&saccade, &message), GZ_OK);
	const msgpack_object *map = unpack_map(&message, &unpacked);
	assert_keys(map, "timestamp duration amplitude_deg peak_velocity_deg_s start end");
	assert_near(value_of(map, "duration")->via.f64, 41.666667, 1e-9);     /* ms */
	assert_numbers(value_of(map, "start"), (double[]) { 0.1f, 0.2f }, 2); /* origin top left */
	msgpack_unpacked_destroy(&unpacked);
}

static void status_has_the_documented_keys(void **state)
{
	(void)state;
	struct gz_status status = sample_status();
	struct gz_wire_message message;
	msgpack_unpacked unpacked;
	assert_int_equal(gz_wire_encode_status(&status, &message), GZ_OK);
	const msgpack_object *map = unpack_map(&message, &unpacked);
	assert_keys(map, "tracker rate_hz samples lost rejected malformed refused clock noise_deg "
			 "still_scene display correction validation recording "
			 "subscribers version");
	assert_keys(value_of(map, "tracker"), "name serial state reason");
	assert_keys(value_of(map, "rate_hz"), "nominal measured");
	assert_keys(value_of(map, "rejected"),
		    "tracker not_finite off_screen velocity disparity time confidence");
	assert_keys(value_of(map, "clock"), "offset_ns skew_ppm sigma_ns tick");
	assert_keys(value_of(map, "display"), "px mm distance_mm");
	assert_keys(value_of(map, "validation"), "measured accuracy_deg changed");
	assert_keys(value_of(map, "recording"), "state file samples error");
	assert_text(value_of(value_of(map, "tracker"), "state"), "lost");
	assert_number(value_of(value_of(map, "rejected"), "tracker"), 1);
	assert_number(value_of(value_of(map, "rejected"), "confidence"), 7);
	assert_keys(value_of(map, "malformed"), "short long stale syntax value");
	assert_number(value_of(value_of(map, "malformed"), "short"), 11);
	assert_number(value_of(value_of(map, "malformed"), "value"), 15);
	assert_keys(value_of(map, "refused"), "connections subscriptions messages overflow lsl");
	assert_number(value_of(value_of(map, "refused"), "overflow"), 24);
	assert_numbers(value_of(value_of(map, "display"), "px"), (double[]) { 1920, 1080 }, 2);
	assert_text(value_of(value_of(map, "recording"), "file"), "/data/a.gzl");
	msgpack_unpacked_destroy(&unpacked);
}

static void status_before_the_first_fixation_has_nil_noise(void **state)
{
	(void)state;
	struct gz_status status = sample_status();
	struct gz_wire_message message;
	msgpack_unpacked unpacked;
	status.noise_deg = NAN;
	status.clock.sigma_ns = NAN;
	assert_int_equal(gz_wire_encode_status(&status, &message), GZ_OK);
	const msgpack_object *map = unpack_map(&message, &unpacked);
	assert_all_finite(map);
	assert_nil(value_of(map, "noise_deg"));
	msgpack_unpacked_destroy(&unpacked);
}

static void text_that_is_no_utf8_becomes_question_marks(void **state)
{
	(void)state;
	static const char *const cases[][2] = {
		{ "plain", "plain" },
		{ "\xc3\xa4 \xe2\x82\xac \xf0\x9f\x91\x81",
		  "\xc3\xa4 \xe2\x82\xac \xf0\x9f\x91\x81" },
		{ "\xc3", "?" }, /* cut off */
		{ "a\xff"
		  "b",
		  "a?b" },                      /* never occurs in UTF-8 */
		{ "\xc0\xaf", "??" },           /* overlong */
		{ "\xe0\x80\xaf", "???" },      /* overlong */
		{ "\xed\xa0\x80", "???" },      /* half a surrogate pair */
		{ "\xf4\x90\x80\x80", "????" }, /* beyond the last code point */
		{ "\xe2\x82", "??" },
		{ "\xf0\x9f\x91", "???" },
	};
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		struct gz_status status = sample_status();
		struct gz_wire_message message;
		msgpack_unpacked unpacked;
		snprintf(status.tracker.name, sizeof status.tracker.name, "%s", cases[i][0]);
		assert_int_equal(gz_wire_encode_status(&status, &message), GZ_OK);
		const msgpack_object *map = unpack_map(&message, &unpacked);
		assert_text(value_of(value_of(map, "tracker"), "name"), cases[i][1]);
		msgpack_unpacked_destroy(&unpacked);
	}
}

static void fill(char *text, size_t size)
{
	memset(text, 'w', size - 1);
	text[size - 1] = '\0';
}

static void longest_messages_fit(void **state)
{
	(void)state;
	struct gz_status status = sample_status();
	struct gz_wire_message message;
	fill(status.tracker.name, sizeof status.tracker.name);
	fill(status.tracker.serial, sizeof status.tracker.serial);
	fill(status.tracker.reason, sizeof status.tracker.reason);
	fill(status.validation.measured, sizeof status.validation.measured);
	fill(status.validation.changed, sizeof status.validation.changed);
	fill(status.recording.file, sizeof status.recording.file);
	fill(status.recording.error, sizeof status.recording.error);
	fill(status.version, sizeof status.version);
	for (int i = 0; i < GZ_REJECT_COUNT; i++)
		status.rejected[i] = UINT64_MAX;
	for (int i = 0; i < GZ_MALFORMED_COUNT; i++)
		status.malformed[i] = UINT64_MAX;
	for (int i = 0; i < GZ_REFUSAL_COUNT; i++)
		status.refused[i] = UINT64_MAX;
	status.samples = status.lost = status.recording.samples = UINT64_MAX;
	status.clock.offset_ns = INT64_MIN;
	status.subscribers = UINT32_MAX;
	assert_int_equal(gz_wire_encode_status(&status, &message), GZ_OK);

	struct gz_gaze gaze = sample_gaze();
	gaze.seq = gaze.final_seq = UINT64_MAX;
	gaze.event = gaze.final_event = GZ_EVENT_OSCILLATION;
	gaze.device_ns = gaze.host_ns = gaze.publish_ns = INT64_MIN + 1;
	for (int i = 0; i < GZ_EYE_COUNT; i++)
		memset(gaze.eye[i].direction, 0, sizeof gaze.eye[i].direction);
	encode_gaze(&gaze, &message);
	/* Far below the 8192 bytes that a connection sends at once. */
	assert_in_range(message.size, 1, 1280);
	char name[GZ_NAME_SIZE];
	fill(name, sizeof name);
	assert_int_equal(gz_wire_encode_surface(&gaze, NULL, 0, name, &message), GZ_OK);
}

static void surface_name_too_long_for_a_message_leaves_it_empty(void **state)
{
	(void)state;
	static char name[GZ_WIRE_MESSAGE_SIZE + 1];
	struct gz_gaze gaze = sample_gaze();
	struct gz_wire_message message;
	fill(name, sizeof name);
	assert_int_equal(gz_wire_encode_surface(&gaze, NULL, 0, name, &message), GZ_ERR_FULL);
	assert_int_equal(message.size, 0);
}

static void equal_messages_are_equal_bytes(void **state)
{
	(void)state;
	struct gz_gaze gaze = sample_gaze();
	struct gz_wire_message a, b;
	memset(&a, 0x11, sizeof a);
	memset(&b, 0xee, sizeof b);
	encode_gaze(&gaze, &a);
	encode_gaze(&gaze, &b);
	assert_int_equal(a.size, b.size);
	assert_memory_equal(a.bytes, b.bytes, a.size);
}

TEST_SUITE(wire_encode)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(gaze_has_the_documented_keys_and_no_other),
		cmocka_unit_test(gaze_values_are_those_of_the_message),
		cmocka_unit_test(pupil_values_are_those_of_the_eye),
		cmocka_unit_test(pupil_without_position_has_the_distance_and_no_confidence_in_it),
		cmocka_unit_test(gaze_topic_tells_which_eyes_took_part),
		cmocka_unit_test(gaze_unmeasured_is_nil_and_never_nan),
		cmocka_unit_test(gaze_ends_in_publish_time_of_fixed_width),
		cmocka_unit_test(gaze_shows_where_its_pupil_maps_stand),
		cmocka_unit_test(surface_refers_to_its_gaze_by_topic_and_time),
		cmocka_unit_test(event_final_has_the_documented_keys),
		cmocka_unit_test(surface_has_the_fixations_too),
		cmocka_unit_test(gaze_has_the_lines_of_sight_that_were_measured),
		cmocka_unit_test(surface_is_left_past_any_edge),
		cmocka_unit_test(fixation_has_the_documented_keys_and_units),
		cmocka_unit_test(blink_has_the_documented_keys),
		cmocka_unit_test(saccade_has_the_documented_keys),
		cmocka_unit_test(status_has_the_documented_keys),
		cmocka_unit_test(status_before_the_first_fixation_has_nil_noise),
		cmocka_unit_test(text_that_is_no_utf8_becomes_question_marks),
		cmocka_unit_test(longest_messages_fit),
		cmocka_unit_test(surface_name_too_long_for_a_message_leaves_it_empty),
		cmocka_unit_test(equal_messages_are_equal_bytes),
	};
	return cmocka_run_group_tests_name("wire_encode", tests, NULL, NULL);
}
