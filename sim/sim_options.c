/* Presets and their sources. */
#include "sim/tracker.h"

#define AT(field)     offsetof(struct gz_sim_params, field)
#define VIEWER(field) offsetof(struct gz_sim_params, viewer.field)

/* Viewer: Bauer 2018, section 2.2, and its sources: fixations of 250 ms on average, 2 to 3 saccades
 * a second, 7 degrees apart, drift, tremor and microsaccades below 1 degree. With pursuit for a
 * quarter of the time and blinks, fixations of 250 ms make 2.5 saccades a second. Drift and tremor:
 * Martinez-Conde, Macknik and Hubel 2004. Blinks: Stern, Walrath and Goldstein 1984. Pursuit and
 * microsaccade rates: chosen.
 *
 * Display: 50.4 degrees wide from 600 mm, as gz_display_default(). */
const struct gz_option gz_sim_options[] = {
	{ "sim.seed", GZ_OPTION_INT, AT(seed), 0, 2147483647, 0, NULL, "1",
	  "seed; the same seed gives the same samples" },
	{ "sim.rate_hz", GZ_OPTION_DOUBLE, AT(rate_hz), 30, 2000, 0, NULL, "120",
	  "samples a second, Hz" },
	{ "sim.noise_deg", GZ_OPTION_DOUBLE, AT(noise_deg), 0, 5, 0, NULL, "0.1",
	  "standard deviation of each eye's point along each axis, degrees" },
	{ "sim.offset_deg", GZ_OPTION_DOUBLE, AT(offset_deg), 0, 5, 0, NULL, "0.3",
	  "standard deviation of each eye's constant error, degrees" },
	{ "sim.calibration_x", GZ_OPTION_DOUBLE, AT(calibration_x), -10, 10, 3, NULL, "0 1 0",
	  "a b c of x' = a + b x + c y, the place that is told; display sides" },
	{ "sim.calibration_y", GZ_OPTION_DOUBLE, AT(calibration_y), -10, 10, 3, NULL, "0 0 1",
	  "a b c of y' = a + b x + c y, the place that is told; display sides" },
	{ "sim.loss", GZ_OPTION_DOUBLE, AT(loss), 0, 0.95, 0, NULL, "0.001",
	  "fraction of samples that never arrive" },
	{ "sim.eye_loss", GZ_OPTION_DOUBLE, AT(eye_loss), 0, 0.5, 0, NULL, "0.01",
	  "fraction of samples in which an eye is not found" },
	{ "sim.spikes", GZ_OPTION_DOUBLE, AT(spikes), 0, 0.5, 0, NULL, "0.0005",
	  "fraction of samples that jump for one sample" },
	{ "sim.latency_ms", GZ_OPTION_DOUBLE, AT(latency_ms), 0, 500, 0, NULL, "4",
	  "from exposure to delivery, ms" },
	{ "sim.latency_jitter_ms", GZ_OPTION_DOUBLE, AT(latency_jitter_ms), 0, 100, 0, NULL, "0.2",
	  "mean of what is added to the latency at random, ms" },
	{ "sim.clock_offset_ms", GZ_OPTION_DOUBLE, AT(clock_offset_ms), -1e12, 1e12, 0, NULL,
	  "1000", "device clock at the start, ms" },
	{ "sim.clock_skew_ppm", GZ_OPTION_DOUBLE, AT(clock_skew_ppm), -10000, 10000, 0, NULL, "20",
	  "how much faster the device clock runs than the host's, parts per million" },
	{ "sim.combined_only", GZ_OPTION_BOOL, AT(combined_only), 0, 0, 0, NULL, "false",
	  "deliver one point for both eyes" },
	{ "sim.realtime", GZ_OPTION_BOOL, AT(realtime), 0, 0, 0, NULL, "true",
	  "deliver samples as time passes; no: as fast as they are read" },
	{ "sim.display_px", GZ_OPTION_SIZE, AT(display_px), 1, 32768, 0, NULL, "1920x1080",
	  "the simulated display, pixels" },
	{ "sim.display_mm", GZ_OPTION_DOUBLE, AT(display_mm), 10, 10000, 2, NULL, "564.677 317.631",
	  "its width and height, mm" },
	{ "sim.distance_mm", GZ_OPTION_DOUBLE, AT(distance_mm), 50, 20000, 0, NULL, "600",
	  "from the eyes to its centre, mm" },
	{ "sim.targets", GZ_OPTION_STRING, AT(targets), 0, GZ_PATH_SIZE, 0, NULL, "",
	  "file with lines \"x y [weight]\" that steer the gaze" },
	{ "sim.picture", GZ_OPTION_STRING, AT(picture), 0, GZ_PATH_SIZE, 0, NULL, "",
	  "PNG file whose salient points steer the gaze" },
	{ "sim.fixation_ms", GZ_OPTION_DOUBLE, VIEWER(fixation_ms), 120, 600, 0, NULL, "250",
	  "mean duration of a fixation, ms" },
	{ "sim.saccade_deg", GZ_OPTION_DOUBLE, VIEWER(saccade_deg), 1, 30, 0, NULL, "7",
	  "mean amplitude of a saccade without targets, degrees" },
	{ "sim.drift_deg_s", GZ_OPTION_DOUBLE, VIEWER(drift_deg_s), 0, 5, 0, NULL, "0.5",
	  "speed of the drift within fixations, degrees a second" },
	{ "sim.tremor_deg", GZ_OPTION_DOUBLE, VIEWER(tremor_deg), 0, 0.1, 0, NULL, "0.004",
	  "amplitude of the tremor, degrees" },
	{ "sim.microsaccades_per_s", GZ_OPTION_DOUBLE, VIEWER(microsaccades_per_s), 0, 5, 0, NULL,
	  "1", "microsaccades within fixations, per second" },
	{ "sim.pursuits_per_min", GZ_OPTION_DOUBLE, VIEWER(pursuits_per_min), 0, 60, 0, NULL, "12",
	  "episodes of smooth pursuit, per minute between them" },
	{ "sim.pursuit_ms", GZ_OPTION_DOUBLE, VIEWER(pursuit_ms), 500, 5000, 0, NULL, "1500",
	  "mean duration of a pursuit, ms" },
	{ "sim.pursuit_deg_s", GZ_OPTION_DOUBLE, VIEWER(pursuit_deg_s), 1, 60, 0, NULL, "10",
	  "mean speed of a pursuit, degrees a second" },
	{ "sim.blinks_per_min", GZ_OPTION_DOUBLE, VIEWER(blinks_per_min), 0, 60, 0, NULL, "15",
	  "blinks, per minute between them" },
	{ "sim.blink_ms", GZ_OPTION_DOUBLE, VIEWER(blink_ms), 100, 300, 0, NULL, "150",
	  "mean duration of a blink, ms" },
};

const size_t gz_sim_option_count = sizeof gz_sim_options / sizeof gz_sim_options[0];

struct gz_sim_params gz_sim_default_params(void)
{
	struct gz_sim_params params = { .seed = 0 };
	struct gz_option_binding binding = {
		.options = gz_sim_options,
		.count = gz_sim_option_count,
		.target = &params,
	};
	(void)gz_options_preset(&binding); /* that every preset parses is a test's matter */
	return params;
}
