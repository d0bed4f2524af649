/**
 * @file
 * One message of each kind, with a different value in every field.
 */
#ifndef GZ_TESTS_PROTOCOL_SAMPLE_MESSAGES_H
#define GZ_TESTS_PROTOCOL_SAMPLE_MESSAGES_H

#include <math.h>
#include <string.h>

#include "protocol/gaze.h"

static inline struct gz_display sample_display(void)
{
	return (struct gz_display) { .px = { 1920, 1080 }, .mm = { 600, 300 }, .distance_mm = 500 };
}

static inline struct gz_gaze sample_gaze(void)
{
	return (struct gz_gaze) {
		.seq = 1ull << 40,
		.device_ns = -77,
		.host_ns = 123456789012345,
		.publish_ns = 123456789112345,
		.point = { 0.75f, 0.25f },
		.raw = { 0.7501f, -0.2501f },
		.confidence = 0.875f,
		.event = GZ_EVENT_SACCADE,
		.final_known = true,
		.final_seq = 1099511627700,
		.final_span = 3,
		.final_event = GZ_EVENT_PURSUIT,
		.velocity_deg_s = 123.4f,
		.landing = { true, { 0.8f, 0.2f }, 123456809012345, 1.5f },
		.eye = { { { 0.74f, 0.24f }, 3.5f, true, 0.9f, { 31, -2, 480 }, { NAN, NAN, NAN } },
			 { { 0.76f, 0.26f },
			   3.25f,
			   true,
			   0.8f,
			   { -31, -2, 481 },
			   { NAN, NAN, NAN } } },
	};
}

static inline struct gz_fixation sample_fixation(void)
{
	return (struct gz_fixation) {
		.id = 4711,
		.onset_ns = 123456789012345,
		.duration_ns = 250833333,
		.dispersion_deg = 0.4f,
		.point = { 0.125f, 0.25f },
		.confidence = 0.5f,
		.final = true,
	};
}

static inline struct gz_blink sample_blink(void)
{
	return (struct gz_blink) { .onset = true, .time_ns = 123456789012345, .confidence = 0.5f };
}

static inline struct gz_saccade sample_saccade(void)
{
	return (struct gz_saccade) {
		.start_ns = 123456789012345,
		.duration_ns = 41666667,
		.amplitude_deg = 8.5f,
		.peak_velocity_deg_s = 340,
		.start = { 0.1f, 0.2f },
		.end = { 0.3f, 0.4f },
	};
}

static inline struct gz_status sample_status(void)
{
	return (struct gz_status) {
		.tracker = { "sim", "serial 1", GZ_TRACKER_LOST, "unplugged" },
		.rate_hz_nominal = 1200,
		.rate_hz_measured = 1199.9,
		.samples = 1000000,
		.lost = 3,
		.rejected = { 0, 1, 2, 3, 4, 5, 6, 7 },
		.malformed = { 11, 12, 13, 14, 15 },
		.refused = { 21, 22, 23, 24 },
		.clock = { -123456789, 12.5, 800.25, GZ_CLOCK_ESTIMATED },
		.noise_deg = 0.05,
		.still_scene = true,
		.display = sample_display(),
		.correction = { { 0.01, 1.02, -0.003 }, { 0.004, 0.005, 0.98 } },
		.validation = { "2026-01-31T12:00:00Z", 0.75, "500 mm away, was 600 mm" },
		.recording = { GZ_RECORDING_FAILED, "/data/a.gzl", 999, "disk full" },
		.subscribers = 2,
		.version = "0.1.0",
	};
}

#endif
