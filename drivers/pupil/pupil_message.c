#include "drivers/pupil/pupil_message.h"

#include <math.h>
#include <string.h>

#include "base/clock.h"

/* Two times that differ by less are the same, ns: a surface entry has its time in seconds, the gaze
 * of another gazed also in nanoseconds. */
static const int64_t SAME_TIME_NS = 1000;

/* Steps after which a long step counts as a loss. Chosen: half a second of a slow tracker. */
static const uint64_t STEPS_TO_LEARN = 64;

/* A step of more than this many periods is a loss. One longer than a pause is not: the stream was
 * stopped. */
static const double LOSS_PERIODS = 1.75;
static const double PAUSE_NS = 2e9;

/* The period rises nine times as fast as it falls, so that nine in ten steps are not longer. */
static const double PERIOD_RISE = 9.0 / 256, PERIOD_FALL = 1.0 / 256;

static bool is_point_measured(struct gz_point point)
{
	return isfinite(point.x) && isfinite(point.y);
}

/* NaN means that the sender gives no confidence, which is no reason for doubt. */
static bool is_confident(float confidence, double least)
{
	return isnan(confidence) || (double)confidence >= least;
}

/* Copy an eye that took part in @p gaze. */
static void copy_pupil_eye(const struct gz_gaze *gaze, const struct gz_gaze_eye *from,
			   double confidence, struct gz_eye_sample *to)
{
	to->point = is_point_measured(from->point) ? from->point : gaze->point;
	to->confidence = isnan(from->confidence) ? gaze->confidence : from->confidence;
	to->valid = is_confident(to->confidence, confidence);
	/* Pupil sends 0 for a pupil that was not found. */
	to->pupil_mm = from->pupil_mm > 0 ? from->pupil_mm : NAN;
	memcpy(to->origin_mm, from->origin_mm, sizeof to->origin_mm);
	memcpy(to->direction, from->direction, sizeof to->direction);
}

enum gz_result gz_pupil_read_gaze(const void *bytes, size_t size, double confidence,
				  struct gz_pupil_gaze *out_gaze, enum gz_malformed *out_reason)
{
	struct gz_gaze gaze;
	if (gz_wire_decode_gaze(bytes, size, &gaze) != GZ_OK) {
		*out_reason = gz_wire_check(bytes, size) == GZ_OK ? GZ_MALFORMED_VALUE
								  : GZ_MALFORMED_SYNTAX;
		return GZ_ERR_PROTOCOL;
	}
	struct gz_pupil_gaze read = { .sample = gz_sample_unmeasured(), .number = gaze.seq };
	read.sample.device_ns = gaze.host_ns;
	/* Another gazed has smoothed its point; use the measured one. */
	read.sample.point = is_point_measured(gaze.raw) ? gaze.raw : gaze.point;
	read.sample.valid = is_confident(gaze.confidence, confidence);
	for (int i = 0; i < GZ_EYE_COUNT; i++) {
		if (gaze.eye[i].valid && !gaze.combined)
			copy_pupil_eye(&gaze, &gaze.eye[i], confidence, &read.sample.eye[i]);
		read.own_points |= is_point_measured(gaze.eye[i].point);
	}
	*out_gaze = read;
	return GZ_OK;
}

void gz_pupil_remember(struct gz_pupil_memory *memory, const struct gz_pupil_gaze *gaze)
{
	memory->gaze[memory->count++ % GZ_PUPIL_MEMORY] = *gaze;
}

/* The kept gaze message of @p time_ns, or NULL. */
static const struct gz_pupil_gaze *find_remembered_gaze(const struct gz_pupil_memory *memory,
							int64_t time_ns)
{
	for (size_t age = 1; age <= GZ_PUPIL_MEMORY && age <= memory->count; age++) {
		const struct gz_pupil_gaze *gaze =
			&memory->gaze[(memory->count - age) % GZ_PUPIL_MEMORY];
		int64_t apart_ns;
		if (!__builtin_sub_overflow(gaze->sample.device_ns, time_ns, &apart_ns) &&
		    apart_ns <= SAME_TIME_NS && apart_ns >= -SAME_TIME_NS)
			return gaze;
	}
	return NULL;
}

enum gz_result gz_pupil_read_surface(const void *bytes, size_t size,
				     struct gz_pupil_entries *entries,
				     enum gz_malformed *out_reason)
{
	entries->count = entries->next = 0;
	enum gz_result result = gz_wire_decode_surface(bytes, size, entries->entry,
						       GZ_PUPIL_ENTRIES_MAX, &entries->count);
	if (result == GZ_OK)
		return GZ_OK;
	*out_reason = result == GZ_ERR_FULL                 ? GZ_MALFORMED_LONG
		      : gz_wire_check(bytes, size) == GZ_OK ? GZ_MALFORMED_VALUE
							    : GZ_MALFORMED_SYNTAX;
	return GZ_ERR_PROTOCOL;
}

enum gz_result gz_pupil_next_entry(struct gz_pupil_entries *entries,
				   const struct gz_pupil_memory *memory, double confidence,
				   struct gz_pupil_gaze *out_gaze)
{
	if (entries->next == entries->count)
		return GZ_ERR_END;
	const struct gz_surface_gaze *entry = &entries->entry[entries->next++];
	const struct gz_pupil_gaze *base = find_remembered_gaze(memory, entry->time_ns);
	struct gz_pupil_gaze read = { .sample = gz_sample_unmeasured() };
	if (base)
		read = *base;
	read.sample.device_ns = base ? base->sample.device_ns : entry->time_ns;
	if (!read.own_points) {
		read.sample.point = entry->point;
		for (int i = 0; i < GZ_EYE_COUNT; i++)
			if (is_point_measured(read.sample.eye[i].point))
				read.sample.eye[i].point = entry->point;
	}
	if (!base || !read.own_points)
		read.sample.valid = is_confident(entry->confidence, confidence);
	*out_gaze = read;
	return GZ_OK;
}

/* Adjust the period to a step. */
static void learn_pupil_period(struct gz_pupil_order *order, double step_ns)
{
	if (order->steps++ == 0)
		order->period_ns = step_ns;
	else if (step_ns > order->period_ns)
		order->period_ns *= 1 + PERIOD_RISE;
	else
		order->period_ns *= 1 - PERIOD_FALL;
}

static uint32_t missing_by_pupil_time(struct gz_pupil_order *order, double step_ns)
{
	uint32_t missing = 0;
	if (step_ns >= PAUSE_NS)
		return 0;
	if (order->steps >= STEPS_TO_LEARN && step_ns > LOSS_PERIODS * order->period_ns)
		missing = (uint32_t)fmin(round(step_ns / order->period_ns) - 1, 1e6);
	learn_pupil_period(order, step_ns);
	return missing;
}

enum gz_result gz_pupil_order_step(struct gz_pupil_order *order, const struct gz_pupil_gaze *gaze,
				   uint32_t *out_missing)
{
	int64_t pupil_ns = gaze->sample.device_ns, step_ns = 0;
	uint64_t ahead = gaze->number - order->number;
	bool begun = order->begun, numbered = gaze->number > 0 && order->number > 0;
	if (begun && (pupil_ns <= order->pupil_ns ||
		      __builtin_sub_overflow(pupil_ns, order->pupil_ns, &step_ns)))
		return GZ_ERR_PROTOCOL;
	if (!begun)
		*out_missing = 0;
	else if (numbered) /* a jump of the numbers means that the daemon restarted */
		*out_missing = ahead >= 1 && ahead < 1000000 ? (uint32_t)ahead - 1 : 0;
	else
		*out_missing = missing_by_pupil_time(order, (double)step_ns);
	order->begun = true;
	order->pupil_ns = pupil_ns;
	order->number = gaze->number;
	return GZ_OK;
}

void gz_pupil_order_restart(struct gz_pupil_order *order)
{
	order->begun = false;
}
