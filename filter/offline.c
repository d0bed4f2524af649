#include "filter/offline.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>

#include "base/clock.h"
#include "filter/angle.h"
#include "filter/classifier/whole.h"

/* Room for samples at first; it is doubled when it is full. */
enum { SAMPLES_FIRST = 4096, INTERVALS_FIRST = 256 };

struct gz_offline {
	struct gz_pipeline_params params;
	struct gz_display display;
	struct gz_validate_state validate;
	struct gz_combine_state combine;
	size_t count, room;
	bool *stale;                     /* whether a sample is not newer than the one before */
	size_t newer;                    /* samples that are */
	struct gz_movement_input *input; /* these samples */
	bool *still_scene;               /* whether nothing moves in the scene, of each of them */
};

const char *gz_offline_label_name(enum gz_offline_label label)
{
	static const char *const names[GZ_OFFLINE_LABELS] = { "fixation", "saccade", "oscillation",
							      "pursuit",  "blink",   "lost" };
	return names[label];
}

enum gz_result gz_offline_create(const struct gz_pipeline_params *params,
				 const struct gz_display *display, struct gz_offline **out_offline)
{
	struct gz_offline *offline = calloc(1, sizeof *offline);
	if (!offline)
		return GZ_ERR_NO_MEM;
	offline->params = params ? *params : gz_pipeline_default_params();
	offline->display = *display;
	*out_offline = offline;
	return GZ_OK;
}

void gz_offline_destroy(struct gz_offline **offline)
{
	if (!*offline)
		return;
	free((*offline)->stale);
	free((*offline)->input);
	free((*offline)->still_scene);
	free(*offline);
	*offline = NULL;
}

static enum gz_result make_offline_room(struct gz_offline *offline)
{
	if (offline->count < offline->room)
		return GZ_OK;
	const size_t room = offline->room ? 2 * offline->room : SAMPLES_FIRST;
	bool *stale = realloc(offline->stale, room * sizeof *stale);
	if (stale)
		offline->stale = stale;
	struct gz_movement_input *input = realloc(offline->input, room * sizeof *input);
	if (input)
		offline->input = input;
	bool *still_scene = realloc(offline->still_scene, room * sizeof *still_scene);
	if (still_scene)
		offline->still_scene = still_scene;
	if (!stale || !input || !still_scene)
		return GZ_ERR_NO_MEM;
	offline->room = room;
	return GZ_OK;
}

enum gz_result gz_offline_add(struct gz_offline *offline, const struct gz_sample *sample)
{
	const struct gz_pipeline_params *params = &offline->params;
	const struct gz_display *display = &offline->display;
	enum gz_result result = make_offline_room(offline);
	if (result != GZ_OK)
		return result;
	const struct gz_validate_output valid =
		gz_validate_step(&offline->validate, &params->validate, display, sample);
	struct gz_sample corrected = *sample;
	gz_correct_step(&params->correct, &corrected);
	offline->stale[offline->count++] = valid.rejection == GZ_REJECT_TIME;
	if (valid.rejection == GZ_REJECT_TIME)
		return GZ_OK;
	offline->still_scene[offline->newer] = params->classify.still_scene || sample->still_scene;
	struct gz_movement_input *input = &offline->input[offline->newer++];
	*input = (struct gz_movement_input) { .time_ns = sample->host_ns,
					      .valid = valid.rejection == GZ_REJECT_NONE };
	if (input->valid)
		input->point = gz_combine_step(&offline->combine, &params->combine, display,
					       &corrected, &valid)
				       .point;
	return GZ_OK;
}

/*
 * Intervals.
 */

/* The intervals so far. */
struct intervals {
	const struct gz_offline *offline;
	struct gz_offline_interval *interval;
	size_t count, room;
	int class;             /* of the last one */
	bool missing;          /* whether something was not measured in the last one */
	double sum[2], points; /* of the last one's measured points */
};

/* Finish the last interval. */
static void close_interval(struct intervals *intervals, int64_t end_ns)
{
	static const enum gz_offline_label labels[GZ_FOREST_CLASSES] = {
		[GZ_FOREST_FIXATION] = GZ_OFFLINE_FIXATION,
		[GZ_FOREST_SACCADE] = GZ_OFFLINE_SACCADE,
		[GZ_FOREST_PURSUIT] = GZ_OFFLINE_PURSUIT,
		[GZ_FOREST_NOISE] = GZ_OFFLINE_LOST,
		[GZ_FOREST_RINGING] = GZ_OFFLINE_OSCILLATION,
	};
	if (intervals->count == 0)
		return;
	struct gz_offline_interval *last = &intervals->interval[intervals->count - 1];
	last->end_ns = end_ns;
	last->label = labels[intervals->class];
	if (intervals->class == GZ_FOREST_NOISE && intervals->missing &&
	    gz_ns_to_ms(end_ns - last->start_ns) <=
		    intervals->offline->params.classify.blink_max_ms)
		last->label = GZ_OFFLINE_BLINK;
	if (!(intervals->points > 0))
		return;
	last->mean = (struct gz_point) { (float)(intervals->sum[0] / intervals->points),
					 (float)(intervals->sum[1] / intervals->points) };
	last->amplitude_deg = gz_chord_deg(&intervals->offline->display, last->start, last->end);
}

/* Go on with the last interval if it is of this class; otherwise begin one. */
static enum gz_result continue_interval(struct intervals *intervals, int class, int64_t time_ns)
{
	const struct gz_point nowhere = { NAN, NAN };
	if (intervals->count > 0 && intervals->class == class)
		return GZ_OK;
	close_interval(intervals, time_ns);
	if (intervals->count == intervals->room) {
		const size_t room = intervals->room ? 2 * intervals->room : INTERVALS_FIRST;
		struct gz_offline_interval *larger =
			realloc(intervals->interval, room * sizeof *larger);
		if (!larger)
			return GZ_ERR_NO_MEM;
		intervals->interval = larger;
		intervals->room = room;
	}
	intervals->interval[intervals->count++] = (struct gz_offline_interval) {
		.start_ns = time_ns,
		.end_ns = time_ns,
		.start = nowhere,
		.end = nowhere,
		.mean = nowhere,
		.amplitude_deg = NAN,
		.peak_deg_s = NAN,
	};
	intervals->class = class;
	intervals->missing = false;
	intervals->sum[0] = intervals->sum[1] = intervals->points = 0;
	return GZ_OK;
}

static void add_to_interval(struct intervals *intervals, const struct gz_movement_input *input)
{
	struct gz_offline_interval *last = &intervals->interval[intervals->count - 1];
	last->samples++;
	intervals->missing = intervals->missing || !input->valid;
	if (!input->valid)
		return;
	if (!(intervals->points > 0))
		last->start = input->point;
	last->end = input->point;
	intervals->sum[0] += input->point.x;
	intervals->sum[1] += input->point.y;
	intervals->points++;
}

/* In a still scene there is nothing to follow. */
static void allow_classes(const struct gz_offline *offline, uint8_t *class)
{
	for (size_t i = 0; i < offline->newer; i++)
		if (offline->still_scene[i] && class[i] == GZ_FOREST_PURSUIT)
			class[i] = GZ_FOREST_FIXATION;
}

static enum gz_result make_intervals(struct intervals *intervals, const uint8_t *class)
{
	const struct gz_movement_input *input = intervals->offline->input;
	const size_t count = intervals->offline->newer;
	int64_t gap_ns;
	enum gz_result result = gz_whole_gap_ns(input, count, &gap_ns);
	for (size_t i = 0; i < count && result == GZ_OK; i++) {
		if (i > 0 && input[i].time_ns - input[i - 1].time_ns > gap_ns) {
			result =
				continue_interval(intervals, GZ_FOREST_NOISE, input[i - 1].time_ns);
			intervals->missing = true;
		}
		if (result == GZ_OK)
			result = continue_interval(intervals, class[i], input[i].time_ns);
		if (result == GZ_OK)
			add_to_interval(intervals, &input[i]);
	}
	if (result == GZ_OK && count > 0)
		close_interval(intervals, input[count - 1].time_ns);
	return result;
}

/* Measure the peak speed of each interval. */
static void measure_peaks(struct intervals *intervals)
{
	const struct gz_offline *offline = intervals->offline;
	size_t first = 0;
	for (size_t k = 0; k < intervals->count; k++) {
		struct gz_offline_interval *interval = &intervals->interval[k];
		const size_t end = first + interval->samples;
		for (size_t i = first, later = first; i < end; i++) {
			const struct gz_movement_input *from = &offline->input[i];
			while (later < end &&
			       offline->input[later].time_ns - from->time_ns < GZ_OFFLINE_SPEED_NS)
				later++;
			if (later == end)
				break;
			const struct gz_movement_input *to = &offline->input[later];
			if (!from->valid || !to->valid)
				continue;
			interval->peak_deg_s =
				fmax(interval->peak_deg_s,
				     gz_chord_deg(&offline->display, from->point, to->point) /
					     gz_ns_to_s(to->time_ns - from->time_ns));
		}
		first = end;
	}
}

/* The label of each sample is that of its interval. */
static void label_samples(const struct gz_offline *offline, struct gz_offline_labels *labels)
{
	size_t k = 0;
	uint64_t left = labels->interval_count > 0 ? labels->interval[0].samples : 0;
	for (size_t i = 0; i < offline->count; i++) {
		if (labels->interval_count == 0) { /* no sample has a time that counts */
			labels->label[i] = GZ_OFFLINE_LOST;
			continue;
		}
		while (!offline->stale[i] && left == 0)
			left = labels->interval[++k].samples;
		left -= !offline->stale[i];
		labels->label[i] = (uint8_t)labels->interval[k].label;
	}
}

enum gz_result gz_offline_finish(const struct gz_offline *offline,
				 struct gz_offline_labels *out_labels)
{
	struct intervals intervals = { .offline = offline };
	struct gz_offline_labels labels = { .count = offline->count };
	uint8_t *class = malloc(offline->newer + 1);
	labels.label = malloc(offline->count + 1);
	enum gz_result result = class && labels.label ? GZ_OK : GZ_ERR_NO_MEM;
	if (result == GZ_OK)
		result = gz_whole_label(&offline->display, offline->input, offline->newer, class);
	if (result == GZ_OK) {
		allow_classes(offline, class);
		result = make_intervals(&intervals, class);
	}
	free(class);
	labels.interval = intervals.interval;
	labels.interval_count = intervals.count;
	if (result != GZ_OK) {
		gz_offline_labels_free(&labels);
		return result;
	}
	measure_peaks(&intervals);
	label_samples(offline, &labels);
	*out_labels = labels;
	return GZ_OK;
}

void gz_offline_labels_free(struct gz_offline_labels *labels)
{
	free(labels->label);
	free(labels->interval);
	*labels = (struct gz_offline_labels) { .count = 0 };
}
