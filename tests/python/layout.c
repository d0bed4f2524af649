/* Prints the layout of each struct that the Python module mirrors: "STRUCT FIELD OFFSET SIZE" a
 * line. */
#include <stdio.h>

#include "client/gazecast.h"

#define SHOW(type, field)                                                      \
	printf("%s %s %zu %zu\n", #type, #field, offsetof(struct type, field), \
	       sizeof(((struct type *)NULL)->field))
#define SHOW_SIZE(type) printf("%s - 0 %zu\n", #type, sizeof(struct type))

static void show_gaze(void)
{
	SHOW_SIZE(gz_gaze_eye);
	SHOW(gz_gaze_eye, point);
	SHOW(gz_gaze_eye, pupil_mm);
	SHOW(gz_gaze_eye, valid);
	SHOW(gz_gaze_eye, confidence);
	SHOW(gz_gaze_eye, origin_mm);
	SHOW(gz_gaze_eye, direction);
	SHOW_SIZE(gz_landing);
	SHOW(gz_landing, known);
	SHOW(gz_landing, point);
	SHOW(gz_landing, time_ns);
	SHOW(gz_landing, sigma_deg);
	SHOW_SIZE(gz_gaze);
	SHOW(gz_gaze, seq);
	SHOW(gz_gaze, device_ns);
	SHOW(gz_gaze, host_ns);
	SHOW(gz_gaze, publish_ns);
	SHOW(gz_gaze, point);
	SHOW(gz_gaze, raw);
	SHOW(gz_gaze, confidence);
	SHOW(gz_gaze, event);
	SHOW(gz_gaze, final_known);
	SHOW(gz_gaze, final_seq);
	SHOW(gz_gaze, final_span);
	SHOW(gz_gaze, final_event);
	SHOW(gz_gaze, velocity_deg_s);
	SHOW(gz_gaze, landing);
	SHOW(gz_gaze, combined);
	SHOW(gz_gaze, eye);
}

static void show_events(void)
{
	SHOW_SIZE(gz_fixation);
	SHOW(gz_fixation, id);
	SHOW(gz_fixation, onset_ns);
	SHOW(gz_fixation, duration_ns);
	SHOW(gz_fixation, dispersion_deg);
	SHOW(gz_fixation, point);
	SHOW(gz_fixation, confidence);
	SHOW(gz_fixation, final);
	SHOW_SIZE(gz_blink);
	SHOW(gz_blink, onset);
	SHOW(gz_blink, time_ns);
	SHOW(gz_blink, confidence);
	SHOW_SIZE(gz_saccade);
	SHOW(gz_saccade, start_ns);
	SHOW(gz_saccade, duration_ns);
	SHOW(gz_saccade, amplitude_deg);
	SHOW(gz_saccade, peak_velocity_deg_s);
	SHOW(gz_saccade, start);
	SHOW(gz_saccade, end);
}

static void show_status(void)
{
	SHOW_SIZE(gz_clock_status);
	SHOW(gz_clock_status, tick);
	SHOW_SIZE(gz_display);
	SHOW(gz_display, mm);
	SHOW(gz_display, distance_mm);
	SHOW_SIZE(gz_status);
	SHOW(gz_status, tracker);
	SHOW(gz_status, rate_hz_nominal);
	SHOW(gz_status, rate_hz_measured);
	SHOW(gz_status, samples);
	SHOW(gz_status, lost);
	SHOW(gz_status, rejected);
	SHOW(gz_status, malformed);
	SHOW(gz_status, refused);
	SHOW(gz_status, clock);
	SHOW(gz_status, noise_deg);
	SHOW(gz_status, still_scene);
	SHOW(gz_status, display);
	SHOW(gz_status, correction);
	SHOW(gz_status, validation);
	SHOW(gz_status, recording);
	SHOW(gz_status, subscribers);
	SHOW(gz_status, version);
}

int main(void)
{
	show_gaze();
	show_events();
	show_status();
	SHOW_SIZE(gz_message);
	SHOW(gz_message, kind);
	SHOW(gz_message, topic);
	SHOW(gz_message, received_ns);
	SHOW(gz_message, lost);
	SHOW(gz_message, gaze);
	SHOW(gz_message, bytes);
	SHOW(gz_message, size);
	SHOW_SIZE(gz_log);
	SHOW(gz_log, sink);
	SHOW(gz_log, user);
	SHOW(gz_log, rules);
	return 0;
}
