/*
 * Where the plan is sharp when a saccade lands, with and without the prediction of its landing
 * (attention.landing_deg).
 *
 * usage: gaze_plan LOG.gzl...
 *
 * Each log is played to the pipeline and to the attention, frame by frame. What the eye did is
 * labelled with the whole recording in view (filter/offline.h). A saccade counts if all of it was
 * measured and the eye rested for 20 ms after it and its ringing: the mean over that time is where
 * it landed. For each size of saccades a line for each setting of attention.landing_deg: distance
 * from the landing to where the plan is sharp, of the last frame before the landing and of the last
 * one that is on the display by then, and time from the landing until a frame is on the display
 * from which on the plan is right for 60 ms.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/clock.h"
#include "base/order.h"
#include "bench/filter/track.h"
#include "filter/angle.h"
#include "filter/pipeline.h"
#include "render/attention/attention.h"

enum { FRAME_HZ = 120, SETTINGS = 8, GROUPS = 5, FRAMES_MAX = 64 };

/* A frame knows samples that are older than this: a tracker's usual latency. Chosen. */
static const int64_t LATENCY_NS = 5 * GZ_NS_PER_MS;

/* From the plan to the display. Chosen: two frames. */
static const int64_t DISPLAY_NS = 2 * GZ_NS_PER_S / FRAME_HZ;

/* The eye lands within this time; the plan is then right if it is so near, and for so long. */
static const double REST_MS = 20, RIGHT_DEG = 2, RIGHT_MS = 60;

/* Smaller and larger saccades are noise and lids. */
static const double GROUP_DEG[GROUPS + 1] = { 0.5, 2, 5, 10, 20, 35 };

/* Values of attention.landing_deg that are compared; 0: the plan goes with the gaze. */
static const double LANDING_DEG[SETTINGS] = { 0, 1, 2, 3, 4, 6, 8, 12 };

struct saccade {
	int64_t landed_ns;
	struct gz_point landing;
	int group;
};

/* What became of the plan in one saccade, with one setting. */
struct outcome {
	double planned_deg, shown_deg, late_ms;
};

struct outcomes {
	size_t count, room;
	struct outcome *outcome;
};

/* Where one frame was sharp. */
struct frame {
	int64_t time_ns;
	struct gz_point sharp;
};

struct watched {
	struct gz_attention attention;
	size_t count;
	struct frame *frame;
};

static void *must(void *memory)
{
	if (!memory) {
		fprintf(stderr, "gaze_plan: out of memory\n");
		exit(1);
	}
	return memory;
}

/* ---- saccades ---- */

static bool mean_point(const struct gz_gaze_track *track, size_t from, struct gz_point *out)
{
	double x = 0, y = 0, count = 0;
	for (size_t i = from; i < track->count; i++) {
		if (gz_ns_to_ms(track->sample[i].host_ns - track->sample[from].host_ns) > REST_MS)
			break;
		if (!isfinite(track->raw[i].x) || track->label[i] == GZ_EVENT_SACCADE)
			return false;
		x += (double)track->raw[i].x;
		y += (double)track->raw[i].y;
		count++;
	}
	*out = (struct gz_point) { (float)(x / count), (float)(y / count) };
	return count > 1;
}

/* The saccade of samples @p from to @p to - 1. */
static bool take_saccade(const struct gz_gaze_track *track, size_t from, size_t to,
			 struct saccade *out)
{
	size_t rest = to;
	while (rest < track->count && track->label[rest] == GZ_EVENT_LOST &&
	       isfinite(track->raw[rest].x))
		rest++; /* ringing */
	for (size_t i = from; i < to; i++)
		if (!isfinite(track->raw[i].x))
			return false;
	if (from == 0 || rest == track->count || !isfinite(track->raw[from - 1].x) ||
	    !mean_point(track, rest, &out->landing))
		return false;
	double size_deg = gz_display_angle_deg(&track->display, track->raw[from - 1], out->landing);
	out->landed_ns = track->sample[to].host_ns;
	out->group = -1;
	for (int g = 0; g < GROUPS; g++)
		if (size_deg >= GROUP_DEG[g] && size_deg < GROUP_DEG[g + 1])
			out->group = g;
	return out->group >= 0;
}

/* ---- plans ---- */

static void run_frames(const struct gz_gaze_track *track, const struct gz_attention_params *params,
		       struct watched watched[SETTINGS])
{
	static struct gz_pipeline pipeline;
	static struct gz_pipeline_output out;
	const int64_t first_ns = track->sample[0].host_ns;
	const int64_t last_ns = track->sample[track->count - 1].host_ns;
	const size_t room = (size_t)((last_ns - first_ns) / (GZ_NS_PER_S / FRAME_HZ)) + 2;
	gz_pipeline_init(&pipeline, NULL, &track->display);
	for (int s = 0; s < SETTINGS; s++) {
		struct gz_attention_params with = *params;
		with.landing_deg = LANDING_DEG[s];
		gz_attention_init(&watched[s].attention, &with);
		watched[s].frame = must(calloc(room, sizeof *watched[s].frame));
		watched[s].count = 0;
	}
	size_t next = 0;
	for (int64_t now_ns = first_ns + LATENCY_NS; now_ns < last_ns;
	     now_ns += GZ_NS_PER_S / FRAME_HZ) {
		while (next < track->count && track->sample[next].host_ns + LATENCY_NS <= now_ns)
			gz_pipeline_step(&pipeline, &track->sample[next++], &out);
		const struct gz_attention_gaze gaze = {
			.known = true,
			.point = out.gaze.point,
			.has_age = true,
			.age_ns = now_ns - out.gaze.host_ns,
			.has_event = true,
			.event = out.gaze.event,
			.landing = out.gaze.landing,
			.noise_deg = gz_pipeline_noise_deg(&pipeline),
		};
		for (int s = 0; s < SETTINGS; s++)
			watched[s].frame[watched[s].count++] =
				(struct frame) { now_ns,
						 gz_attention_step(&watched[s].attention, &gaze,
								   &track->display, now_ns)
							 .point };
	}
}

static struct outcome outcome_of(const struct gz_gaze_track *track, const struct watched *watched,
				 const struct saccade *saccade)
{
	struct outcome outcome = { NAN, NAN, NAN };
	const int64_t landed_ns = saccade->landed_ns;
	size_t right = 0;
	const double least = RIGHT_MS * FRAME_HZ / 1000;
	for (size_t i = 0; i < watched->count; i++) {
		const struct frame *frame = &watched->frame[i];
		if (frame->time_ns < landed_ns - GZ_NS_PER_S / 2)
			continue;
		double deg = gz_display_angle_deg(&track->display, frame->sharp, saccade->landing);
		if (frame->time_ns <= landed_ns)
			outcome.planned_deg = deg;
		if (frame->time_ns + DISPLAY_NS <= landed_ns)
			outcome.shown_deg = deg;
		right = deg <= RIGHT_DEG ? right + 1 : 0;
		if ((double)right >= least && frame->time_ns > landed_ns) {
			/* Of the first right frame, on the display. */
			int64_t shown_ns = frame->time_ns + DISPLAY_NS -
					   (int64_t)(right - 1) * (GZ_NS_PER_S / FRAME_HZ);
			outcome.late_ms = fmax(0, gz_ns_to_ms(shown_ns - landed_ns));
			break;
		}
		if (frame->time_ns > landed_ns + GZ_NS_PER_S / 2)
			break;
	}
	return outcome;
}

static void keep_outcome(struct outcomes *outcomes, struct outcome outcome)
{
	if (outcomes->count == outcomes->room) {
		outcomes->room = outcomes->room ? 2 * outcomes->room : 1024;
		outcomes->outcome = must(
			realloc(outcomes->outcome, outcomes->room * sizeof *outcomes->outcome));
	}
	outcomes->outcome[outcomes->count++] = outcome;
}

static void measure_track(const struct gz_gaze_track *track,
			  const struct gz_attention_params *params,
			  struct outcomes outcomes[GROUPS][SETTINGS])
{
	struct watched watched[SETTINGS];
	run_frames(track, params, watched);
	for (size_t i = 1; i < track->count; i++) {
		struct saccade saccade;
		size_t to = i;
		while (to < track->count && track->label[to] == GZ_EVENT_SACCADE)
			to++;
		if (to > i && to < track->count && take_saccade(track, i, to, &saccade))
			for (int s = 0; s < SETTINGS; s++)
				keep_outcome(&outcomes[saccade.group][s],
					     outcome_of(track, &watched[s], &saccade));
		i = to;
	}
	for (int s = 0; s < SETTINGS; s++)
		free(watched[s].frame);
}

/* ---- the table ---- */

/* Print median, mean and 95 % of one number of all outcomes. */
static void print_spread(const struct outcomes *outcomes, size_t offset)
{
	double *value = must(calloc(outcomes->count + 1, sizeof *value)), sum = 0;
	size_t count = 0;
	for (size_t i = 0; i < outcomes->count; i++) {
		memcpy(&value[count], (const char *)&outcomes->outcome[i] + offset, sizeof *value);
		if (isnan(value[count]))
			continue;
		sum += value[count++];
	}
	qsort(value, count, sizeof *value, gz_compare_doubles);
	if (count > 0)
		printf(" | %.2f %.2f %.2f", value[count / 2], sum / (double)count,
		       value[count * 95 / 100]);
	free(value);
}

static void print_outcomes(struct outcomes outcomes[GROUPS][SETTINGS])
{
	puts("size, landing_deg, saccades | plan: median mean 95 % | shown | late ms");
	for (int g = 0; g < GROUPS; g++)
		for (int s = 0; s < SETTINGS; s++) {
			printf("%g-%g deg, %g, %zu", GROUP_DEG[g], GROUP_DEG[g + 1], LANDING_DEG[s],
			       outcomes[g][s].count);
			print_spread(&outcomes[g][s], offsetof(struct outcome, planned_deg));
			print_spread(&outcomes[g][s], offsetof(struct outcome, shown_deg));
			print_spread(&outcomes[g][s], offsetof(struct outcome, late_ms));
			puts("");
		}
}

int main(int argc, char **argv)
{
	static struct outcomes outcomes[GROUPS][SETTINGS];
	struct gz_log log;
	const struct gz_attention_params params = gz_attention_default();
	if (argc < 2) {
		fprintf(stderr, "usage: gaze_plan LOG.gzl...\n");
		return 2;
	}
	gz_log_init(&log, NULL, NULL, "*:warn");
	for (int i = 1; i < argc; i++) {
		struct gz_gaze_log_track read;
		if (gz_gaze_track_read_log(argv[i], &log, &read) != GZ_OK)
			return 1;
		if (read.track.count > 1)
			measure_track(&read.track, &params, outcomes);
		gz_gaze_track_free(&read.track);
	}
	print_outcomes(outcomes);
	for (int g = 0; g < GROUPS; g++)
		for (int s = 0; s < SETTINGS; s++)
			free(outcomes[g][s].outcome);
	return 0;
}
