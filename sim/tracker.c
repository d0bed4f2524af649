#include "sim/tracker.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/clock.h"
#include "base/portable.h"
#include "sim/sphere.h"

#define GZ_LOG_MODULE "sim"

#define TWO_PI 6.28318530717958647693

/* Distance of an eye from the middle of the head: half the mean pupil distance of adults, 63 mm
 * (Dodgson 2004). */
static const double EYE_SIDE_MM = 31.5;

/* Diameter of the pupil: mean, amplitude and frequency of a slow swing, measurement noise. Chosen
 * within the usual 2 to 8 mm. */
static const double PUPIL_MM = 3.5;
static const double PUPIL_SWING_MM = 0.3;
static const double PUPIL_SWING_HZ = 0.1;
static const double PUPIL_NOISE_MM = 0.01;

/* What a lid does to the measurement of a pupil, as in the recordings of Andersson et al. 2017. The
 * lid is at the top of the pupil when it has come down by the first share of its way, and at the
 * bottom at the second. A pupil of which less than the least part of its height is left is not
 * found. The middle of what is left lies lower, which the tracker takes for a movement down: by so
 * much if all is covered. */
static const double LID_TOP = 0.2;
static const double LID_BOTTOM = 0.65;
static const double LID_LEAST_PART = 0.35;
static const double LID_SHIFT_DEG = 25;

/* Mean time that an eye stays lost; chosen. */
static const double EYE_LOSS_S = 0.05;

/* Size of a spike; chosen. */
static const double SPIKE_MIN_DEG = 2;
static const double SPIKE_MAX_DEG = 8;

#define AT(field)     offsetof(struct gz_sim_params, field)
#define VIEWER(field) offsetof(struct gz_sim_params, viewer.field)

/* Sources of the presets.
 *
 * Viewer: Bauer 2018, section 2.2, and the sources given there: fixations of 250 ms on average, 2
 * to 3 saccades per second, 7 degrees apart; drift, tremor and microsaccades below 1 degree. With
 * pursuit for a quarter of the time and with blinks, fixations of 250 ms give 2.5 saccades per
 * second. Drift and tremor: Martinez-Conde, Macknik and Hubel 2004. Blinks: Stern, Walrath and
 * Goldstein 1984. Rates of pursuits and microsaccades: chosen.
 *
 * Display: 50.4 degrees wide at 600 mm, as gz_display_default() has it. */
const struct gz_option gz_sim_options[] = {
	{ "sim.seed", GZ_OPTION_INT, AT(seed), 0, 2147483647, .preset = "1",
	  .help = "random seed; the same seed gives the same samples" },
	{ "sim.rate_hz", GZ_OPTION_DOUBLE, AT(rate_hz), 30, 2000, .preset = "120",
	  .help = "samples per second, Hz" },
	{ "sim.noise_deg", GZ_OPTION_DOUBLE, AT(noise_deg), 0, 5, .preset = "0.1",
	  .help = "standard deviation of each eye's point on each axis, degrees" },
	{ "sim.offset_deg", GZ_OPTION_DOUBLE, AT(offset_deg), 0, 5, .preset = "0.3",
	  .help = "standard deviation of each eye's constant error, degrees" },
	{ "sim.calibration_x", GZ_OPTION_DOUBLE, AT(calibration_x), -10, 10, .count = 3,
	  .preset = "0 1 0",
	  .help = "a b c of x' = a + b x + c y, the reported point; display sides" },
	{ "sim.calibration_y", GZ_OPTION_DOUBLE, AT(calibration_y), -10, 10, .count = 3,
	  .preset = "0 0 1",
	  .help = "a b c of y' = a + b x + c y, the reported point; display sides" },
	{ "sim.loss", GZ_OPTION_DOUBLE, AT(loss), 0, 0.95, .preset = "0.001",
	  .help = "fraction of samples that are lost" },
	{ "sim.eye_loss", GZ_OPTION_DOUBLE, AT(eye_loss), 0, 0.5, .preset = "0.01",
	  .help = "fraction of samples in which an eye is not found" },
	{ "sim.spikes", GZ_OPTION_DOUBLE, AT(spikes), 0, 0.5, .preset = "0.0005",
	  .help = "fraction of samples that jump away for one sample" },
	{ "sim.latency_ms", GZ_OPTION_DOUBLE, AT(latency_ms), 0, 500, .preset = "4",
	  .help = "time from exposure to delivery, ms" },
	{ "sim.latency_jitter_ms", GZ_OPTION_DOUBLE, AT(latency_jitter_ms), 0, 100, .preset = "0.2",
	  .help = "mean of the random time added to the latency, ms" },
	{ "sim.clock_offset_ms", GZ_OPTION_DOUBLE, AT(clock_offset_ms), -1e12, 1e12,
	  .preset = "1000", .help = "device clock at the start, ms" },
	{ "sim.clock_skew_ppm", GZ_OPTION_DOUBLE, AT(clock_skew_ppm), -10000, 10000, .preset = "20",
	  .help = "how much faster the device clock runs than the host's, parts per million" },
	{ "sim.lids", GZ_OPTION_BOOL, AT(lids), .preset = "false",
	  .help = "measure pupils that a lid covers in part; no: a blink is a loss from its "
		  "beginning" },
	{ "sim.combined_only", GZ_OPTION_BOOL, AT(combined_only), .preset = "false",
	  .help = "deliver one point for both eyes" },
	{ "sim.realtime", GZ_OPTION_BOOL, AT(realtime), .preset = "true",
	  .help = "deliver samples in real time; no: as fast as they are read" },
	{ "sim.display_px", GZ_OPTION_SIZE, AT(display_px), 1, 32768, .preset = "1920x1080",
	  .help = "size of the simulated display, px" },
	{ "sim.display_mm", GZ_OPTION_DOUBLE, AT(display_mm), 10, 10000, .count = 2,
	  .preset = "564.677 317.631", .help = "width and height of the simulated display, mm" },
	{ "sim.distance_mm", GZ_OPTION_DOUBLE, AT(distance_mm), 50, 20000, .preset = "600",
	  .help = "distance from the eyes to the centre of the simulated display, mm" },
	{ "sim.targets", GZ_OPTION_STRING, AT(targets), .max = GZ_PATH_SIZE, .preset = "",
	  .help = "file with lines \"x y [weight]\": the places that attract the gaze" },
	{ "sim.picture", GZ_OPTION_STRING, AT(picture), .max = GZ_PATH_SIZE, .preset = "",
	  .help = "PNG file whose salient points attract the gaze; read again if it changes" },
	{ "sim.fixation_ms", GZ_OPTION_DOUBLE, VIEWER(fixation_ms), 120, 600, .preset = "250",
	  .help = "mean duration of a fixation, ms" },
	{ "sim.saccade_deg", GZ_OPTION_DOUBLE, VIEWER(saccade_deg), 1, 30, .preset = "7",
	  .help = "mean amplitude of a saccade if there are no targets, degrees" },
	{ "sim.drift_deg_s", GZ_OPTION_DOUBLE, VIEWER(drift_deg_s), 0, 5, .preset = "0.5",
	  .help = "speed of the drift in fixations, degrees per second" },
	{ "sim.tremor_deg", GZ_OPTION_DOUBLE, VIEWER(tremor_deg), 0, 0.1, .preset = "0.004",
	  .help = "amplitude of the tremor, degrees" },
	{ "sim.microsaccades_per_s", GZ_OPTION_DOUBLE, VIEWER(microsaccades_per_s), 0, 5,
	  .preset = "1", .help = "microsaccades in fixations, per second" },
	{ "sim.pursuits_per_min", GZ_OPTION_DOUBLE, VIEWER(pursuits_per_min), 0, 60, .preset = "12",
	  .help = "episodes of smooth pursuit, per minute between them" },
	{ "sim.pursuit_ms", GZ_OPTION_DOUBLE, VIEWER(pursuit_ms), 500, 5000, .preset = "1500",
	  .help = "mean duration of a pursuit, ms" },
	{ "sim.pursuit_deg_s", GZ_OPTION_DOUBLE, VIEWER(pursuit_deg_s), 1, 60, .preset = "10",
	  .help = "mean speed of a pursuit, degrees per second" },
	{ "sim.blinks_per_min", GZ_OPTION_DOUBLE, VIEWER(blinks_per_min), 0, 60, .preset = "15",
	  .help = "blinks, per minute between them" },
	{ "sim.blink_ms", GZ_OPTION_DOUBLE, VIEWER(blink_ms), 100, 300, .preset = "150",
	  .help = "mean duration of a blink, ms" },
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
	(void)gz_options_preset(&binding); /* a test checks that every preset parses */
	return params;
}

struct gz_sim_tracker {
	struct gz_sim_params params;
	struct gz_display display;
	struct gz_targets targets;
	struct gz_viewer viewer;
	struct gz_random noise; /* of the measurement */
	struct gz_random fate;  /* of loss and latency */
	double offset_deg[GZ_EYE_COUNT][2];
	bool eye_lost[GZ_EYE_COUNT];
	int64_t start_ns;
	int64_t newest_ns;  /* exposure of the newest sample */
	int64_t arrival_ns; /* of the newest sample */
	uint64_t exposures; /* so far, including the lost ones */
	uint64_t delivered;
};

static bool happens_at_random(struct gz_random *random, double probability)
{
	return gz_random_uniform(random) < probability;
}

static enum gz_result check_sim_params(const struct gz_sim_params *params, const struct gz_log *log)
{
	/* Print and parse each value, so that this refuses what the table refuses in a file. */
	for (size_t i = 0; i < gz_sim_option_count; i++) {
		const struct gz_option *option = &gz_sim_options[i];
		struct gz_sim_params scratch;
		char text[GZ_PATH_SIZE + 64], message[256] = "the value cannot be printed";
		enum gz_result r = gz_option_format(option, params, text, sizeof text);
		if (r == GZ_OK)
			r = gz_option_parse(option, text, &scratch, message, sizeof message);
		if (r != GZ_OK) {
			gz_err(log, "%s: %s", option->key, message);
			return GZ_ERR_INVAL;
		}
	}
	if (params->targets[0] != '\0' && params->picture[0] != '\0') {
		gz_err(log, "sim.targets and sim.picture are both given; remove one of them");
		return GZ_ERR_INVAL;
	}
	return GZ_OK;
}

static enum gz_result load_sim_targets(const struct gz_sim_params *params, const struct gz_log *log,
				       struct gz_targets *out_targets)
{
	if (params->targets[0] != '\0')
		return gz_targets_load(params->targets, log, out_targets);
	if (params->picture[0] != '\0')
		return gz_targets_from_png(params->picture, log, out_targets);
	out_targets->count = 0;
	return GZ_OK;
}

enum gz_result gz_sim_tracker_create(const struct gz_sim_params *params, int64_t start_ns,
				     const struct gz_log *log, struct gz_sim_tracker **out_tracker)
{
	enum gz_result r = check_sim_params(params, log);
	if (r != GZ_OK)
		return r;
	struct gz_sim_tracker *tracker = calloc(1, sizeof *tracker);
	if (!tracker)
		return GZ_ERR_NO_MEM;
	r = load_sim_targets(params, log, &tracker->targets);
	if (r != GZ_OK) {
		gz_sim_tracker_destroy(&tracker);
		return r;
	}
	uint64_t seed = (uint64_t)params->seed;
	tracker->params = *params;
	tracker->display = (struct gz_display) {
		.px = { params->display_px[0], params->display_px[1] },
		.mm = { params->display_mm[0], params->display_mm[1] },
		.distance_mm = params->distance_mm,
	};
	tracker->noise = gz_random_seeded(seed, 3);
	tracker->fate = gz_random_seeded(seed, 4);
	tracker->start_ns = tracker->newest_ns = start_ns;
	tracker->arrival_ns = start_ns;
	for (int eye = 0; eye < GZ_EYE_COUNT; eye++)
		for (int axis = 0; axis < 2; axis++)
			tracker->offset_deg[eye][axis] =
				params->offset_deg * gz_random_normal(&tracker->noise);
	gz_viewer_init(&tracker->viewer, &params->viewer, &tracker->display, &tracker->targets,
		       seed, start_ns);
	*out_tracker = tracker;
	return GZ_OK;
}

/* Time of exposure of the next sample that arrives. */
static int64_t next_exposure(struct gz_sim_tracker *tracker, uint32_t *out_lost)
{
	*out_lost = 0;
	for (;;) {
		double since_ns = (double)tracker->exposures++ * 1e9 / tracker->params.rate_hz;
		if (!happens_at_random(&tracker->fate, tracker->params.loss))
			return tracker->start_ns + (int64_t)floor(since_ns + 0.5);
		*out_lost += 1;
	}
}

/* Update which eyes are lost: a Markov chain of two states with the wanted fraction of lost time.
 */
static void lose_eyes(struct gz_sim_tracker *tracker)
{
	double share =
		tracker->params.eye_loss / GZ_EYE_COUNT; /* each eye is lost for half of it */
	double period_s = 1 / tracker->params.rate_hz;
	double leave = period_s < EYE_LOSS_S ? period_s / EYE_LOSS_S : 1;
	double enter = leave * share / (1 - share);
	for (int eye = 0; eye < GZ_EYE_COUNT; eye++) {
		bool change =
			happens_at_random(&tracker->fate, tracker->eye_lost[eye] ? leave : enter);
		if (change)
			tracker->eye_lost[eye] = !tracker->eye_lost[eye];
	}
}

static void spike_offset(struct gz_sim_tracker *tracker, double out_deg[2])
{
	out_deg[0] = out_deg[1] = 0;
	if (!happens_at_random(&tracker->fate, tracker->params.spikes))
		return;
	double length = gz_random_between(&tracker->fate, SPIKE_MIN_DEG, SPIKE_MAX_DEG);
	double angle = gz_random_between(&tracker->fate, 0, TWO_PI);
	out_deg[0] = length * gz_portable_cos(angle);
	out_deg[1] = length * gz_portable_sin(angle);
}

static struct gz_point add_angular_offset(const struct gz_display *display, struct gz_point truth,
					  const double offset_deg[2])
{
	double direction[3];
	gz_sphere_from_point(display, truth.x, truth.y, direction);
	gz_sphere_offset(direction, offset_deg, direction);
	return gz_sphere_to_point(display, direction);
}

/* Where a tracker with this calibration reports the place. The presets change no bit. */
static struct gz_point apply_calibration(const struct gz_sim_params *params, struct gz_point point)
{
	const double *x = params->calibration_x, *y = params->calibration_y;
	return (struct gz_point) { (float)(x[0] + x[1] * point.x + x[2] * point.y),
				   (float)(y[0] + y[1] * point.x + y[2] * point.y) };
}

/* Set the position and direction of an eye. Coordinates: origin at the centre of the display, +x
 * right, +y up, +z towards the viewer. */
static void set_eye_geometry(const struct gz_display *display, int index, struct gz_eye_sample *eye)
{
	double origin[3] = { index == GZ_EYE_RIGHT ? EYE_SIDE_MM : -EYE_SIDE_MM, 0,
			     display->distance_mm };
	double to[3] = { (eye->point.x - 0.5) * display->mm[0] - origin[0],
			 -(eye->point.y - 0.5) * display->mm[1] - origin[1], -origin[2] };
	double length = sqrt(to[0] * to[0] + to[1] * to[1] + to[2] * to[2]);
	for (int i = 0; i < 3; i++) {
		eye->origin_mm[i] = (float)origin[i];
		eye->direction[i] = (float)(to[i] / length);
	}
}

/* The diameter of both pupils, without noise. */
static double pupil_at(double since_s)
{
	double turns = PUPIL_SWING_HZ * since_s;
	return PUPIL_MM + PUPIL_SWING_MM * gz_portable_sin(TWO_PI * (turns - floor(turns)));
}

/* The part of the pupil's height that the lid leaves. */
static double uncovered_part(double lid)
{
	double covered = (lid - LID_TOP) / (LID_BOTTOM - LID_TOP);
	return 1 - fmax(0, fmin(1, covered));
}

/* What both eyes have in common. */
struct eyes_truth {
	struct gz_point point;
	double spike_deg[2];
	double pupil_mm;
	double part; /* of the pupil's height that is not covered */
};

/* Measure one eye. If it is not @p seen, the same random numbers are drawn but nothing is measured.
 */
static void measure_eye(struct gz_sim_tracker *tracker, int index, const struct eyes_truth *truth,
			bool seen, struct gz_eye_sample *eye)
{
	double offset_deg[2];
	for (int axis = 0; axis < 2; axis++)
		offset_deg[axis] = tracker->offset_deg[index][axis] + truth->spike_deg[axis] +
				   tracker->params.noise_deg * gz_random_normal(&tracker->noise);
	double pupil_mm = truth->pupil_mm + PUPIL_NOISE_MM * gz_random_normal(&tracker->noise);
	if (!seen) {
		eye->confidence = 0;
		return;
	}
	eye->valid = true;
	eye->confidence = 1;
	offset_deg[1] += LID_SHIFT_DEG * (1 - truth->part);
	/* The mean of its width and its height. */
	eye->pupil_mm = (float)(pupil_mm * (1 + truth->part) / 2);
	eye->point = apply_calibration(
		&tracker->params, add_angular_offset(&tracker->display, truth->point, offset_deg));
	set_eye_geometry(&tracker->display, index, eye);
}

/* Set the common point: the mean of the eyes that were found. */
static void average_eyes(struct gz_sample *sample)
{
	float x = 0, y = 0, count = 0;
	for (int i = 0; i < GZ_EYE_COUNT; i++) {
		if (!sample->eye[i].valid)
			continue;
		x += sample->eye[i].point.x;
		y += sample->eye[i].point.y;
		count++;
	}
	sample->valid = count > 0;
	if (sample->valid)
		sample->point = (struct gz_point) { x / count, y / count };
}

static void measure_sample(struct gz_sim_tracker *tracker, const struct gz_viewer_truth *truth,
			   struct gz_sample *sample)
{
	double part = tracker->params.lids ? uncovered_part(truth->lid) : 1;
	bool open = tracker->params.lids ? part >= LID_LEAST_PART : truth->event != GZ_EVENT_BLINK;
	struct eyes_truth eyes = {
		.point = truth->point,
		.pupil_mm = pupil_at(gz_ns_to_s(tracker->newest_ns - tracker->start_ns)),
		.part = part,
	};
	lose_eyes(tracker);
	spike_offset(tracker, eyes.spike_deg);
	for (int i = 0; i < GZ_EYE_COUNT; i++)
		measure_eye(tracker, i, &eyes, open && !tracker->eye_lost[i], &sample->eye[i]);
	average_eyes(sample);
	if (tracker->params.combined_only) {
		struct gz_sample empty = gz_sample_unmeasured();
		memcpy(sample->eye, empty.eye, sizeof sample->eye);
	}
}

static int64_t device_time_ns(const struct gz_sim_tracker *tracker, int64_t host_ns)
{
	int64_t since_ns = host_ns - tracker->start_ns;
	double gained_ns = (double)since_ns * tracker->params.clock_skew_ppm * 1e-6;
	int64_t offset_ns = (int64_t)floor(tracker->params.clock_offset_ms * 1e6 + 0.5);
	return since_ns + offset_ns + (int64_t)floor(gained_ns + 0.5);
}

void gz_sim_tracker_next(struct gz_sim_tracker *tracker, struct gz_sim_sample *out)
{
	const struct gz_sim_params *p = &tracker->params;
	struct gz_sample sample = gz_sample_unmeasured();
	sample.host_ns = tracker->newest_ns = next_exposure(tracker, &sample.lost_before);
	sample.device_ns = device_time_ns(tracker, sample.host_ns);
	sample.seq = tracker->delivered++;
	struct gz_viewer_truth truth = gz_viewer_advance(&tracker->viewer, sample.host_ns);
	measure_sample(tracker, &truth, &sample);

	double latency_ms =
		p->latency_ms + p->latency_jitter_ms * gz_random_exponential(&tracker->fate);
	int64_t arrival_ns = sample.host_ns + (int64_t)floor(latency_ms * 1e6 + 0.5);
	if (arrival_ns > tracker->arrival_ns)
		tracker->arrival_ns = arrival_ns;
	*out = (struct gz_sim_sample) {
		.sample = sample,
		.arrival_ns = tracker->arrival_ns,
		.truth = truth,
	};
}

void gz_sim_tracker_follow(struct gz_sim_tracker *tracker, const struct gz_point *point)
{
	gz_viewer_follow(&tracker->viewer, point);
}

void gz_sim_tracker_attract(struct gz_sim_tracker *tracker, const struct gz_targets *targets)
{
	tracker->targets = *targets; /* which the viewer borrows */
	memset(tracker->viewer.inhibition, 0, sizeof tracker->viewer.inhibition);
}

struct gz_display gz_sim_tracker_display(const struct gz_sim_tracker *tracker)
{
	return tracker->display;
}

struct gz_clock_status gz_sim_tracker_clock(const struct gz_sim_tracker *tracker)
{
	return (struct gz_clock_status) {
		.offset_ns = tracker->newest_ns - device_time_ns(tracker, tracker->newest_ns),
		.skew_ppm = tracker->params.clock_skew_ppm,
		.tick = GZ_CLOCK_DECLARED,
	};
}

void gz_sim_tracker_destroy(struct gz_sim_tracker **tracker)
{
	if (!tracker)
		return;
	free(*tracker);
	*tracker = NULL;
}
