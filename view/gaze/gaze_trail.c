#include "view/gaze/gaze_trail.h"

#include <math.h>
#include <string.h>

#include "base/clock.h"

#define SHORTEST_FIXATION_NS (GZ_NS_PER_S / 10)

static void forget_stays(struct gz_gaze_trail *trail, int stays)
{
	trail->count -= stays;
	memmove(trail->stays, trail->stays + stays, (size_t)trail->count * sizeof trail->stays[0]);
}

/* The newest stay is never dropped, however long it lasts. */
static bool forget_old(struct gz_gaze_trail *trail, int64_t now_ns)
{
	int old = 0;
	while (old < trail->count - 1 && now_ns - trail->stays[old].to_ns >= GZ_GAZE_TRAIL_NS)
		old++;
	forget_stays(trail, old);
	return old > 0;
}

static bool is_seen(const struct gz_gaze_reading *reading)
{
	const bool closed = reading->has_event &&
			    (reading->event == GZ_EVENT_BLINK || reading->event == GZ_EVENT_LOST);
	return reading->known && !closed && isfinite(reading->point.x) &&
	       isfinite(reading->point.y);
}

static bool are_near(struct gz_point a, struct gz_point b, float apart)
{
	return fabsf(a.x - b.x) <= apart && fabsf(a.y - b.y) <= apart;
}

/* Extend a fixation: its point becomes the mean, weighted by time. @return whether it moved */
static bool lengthen(struct gz_gaze_stay *stay, struct gz_point point, int64_t now_ns)
{
	const int64_t before_ns = stay->to_ns - stay->from_ns, all_ns = now_ns - stay->from_ns;
	const float share = all_ns > 0 ? (float)before_ns / (float)all_ns : 1;
	const struct gz_point was = stay->point;
	stay->point.x = share * was.x + (1 - share) * point.x;
	stay->point.y = share * was.y + (1 - share) * point.y;
	stay->to_ns = now_ns;
	return stay->point.x != was.x || stay->point.y != was.y;
}

static void begin_stay(struct gz_gaze_trail *trail, const struct gz_gaze_reading *reading,
		       int64_t now_ns)
{
	if (trail->count == GZ_GAZE_TRAIL_ROOM)
		forget_stays(trail, 1);
	trail->stays[trail->count++] = (struct gz_gaze_stay) {
		.point = reading->point,
		.from_ns = now_ns,
		.to_ns = now_ns,
		.fixation = reading->has_event && reading->event == GZ_EVENT_FIXATION,
	};
}

/* @return whether the drawn trail changes */
static bool add_gaze(struct gz_gaze_trail *trail, const struct gz_gaze_reading *reading,
		     float apart, int64_t now_ns)
{
	struct gz_gaze_stay *newest = trail->count > 0 ? &trail->stays[trail->count - 1] : NULL;
	const bool fixates = reading->has_event && reading->event == GZ_EVENT_FIXATION;
	if (!is_seen(reading))
		return false;
	if (newest && reading->has_event && fixates && newest->fixation) {
		lengthen(newest, reading->point, now_ns);
		/* Its disc grows at first. */
		return now_ns - newest->from_ns < GZ_GAZE_TRAIL_NS;
	}
	if (newest && !reading->has_event && are_near(newest->point, reading->point, apart)) {
		const bool was = newest->fixation;
		newest->to_ns = now_ns;
		newest->fixation = now_ns - newest->from_ns >= SHORTEST_FIXATION_NS;
		return newest->fixation && (!was || now_ns - newest->from_ns < GZ_GAZE_TRAIL_NS);
	}
	if (newest)
		newest->to_ns = now_ns;
	begin_stay(trail, reading, now_ns);
	return true;
}

bool gz_gaze_trail_step(struct gz_gaze_trail *trail, const struct gz_gaze_reading *reading,
			float apart, int64_t now_ns)
{
	const bool forgotten = forget_old(trail, now_ns);
	const bool taken = add_gaze(trail, reading, apart, now_ns);
	const bool lost = trail->count == 1 && !is_seen(reading) &&
			  now_ns - trail->stays[0].to_ns >= GZ_GAZE_TRAIL_NS;
	if (lost)
		trail->count = 0;
	/* Stays other than the newest fade. */
	return forgotten || taken || lost || trail->count > 1;
}

float gz_gaze_trail_strength(const struct gz_gaze_stay *stay, int64_t now_ns)
{
	const float age = (float)(now_ns - stay->to_ns) / (float)GZ_GAZE_TRAIL_NS;
	return age <= 0 ? 1 : age >= 1 ? 0 : 1 - age;
}
