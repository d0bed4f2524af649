#include "sim/viewer.h"

#include <math.h>
#include <string.h>

#include "base/clock.h"
#include "base/portable.h"
#include "sim/sphere.h"

#define DEG_PER_RAD 57.295779513082320877
#define TWO_PI      6.28318530717958647693

/* Fixations last 100 ms to 1.5 s (Bauer 2018, section 2.2). The shape of the gamma distribution is
 * chosen: it gives the skew of published histograms. */
static const double FIXATION_MIN_S = 0.1;
static const double FIXATION_MAX_S = 1.5;
static const int DURATION_SHAPE = 2;

/* Saccades without targets have at least 1 degree: smaller ones are microsaccades. */
static const double SACCADE_MIN_DEG = 1.0;

/* Duration of blinks. Stern, Walrath and Goldstein 1984 give 100 to 400 ms. */
static const double BLINK_MIN_S = 0.08;
static const double BLINK_MAX_S = 0.4;

/* Least distance from the edge of a place that the viewer chooses freely, display sides; chosen. */
static const float EDGE = 0.05f;

/* Microsaccades have less than 1 degree (Bauer 2018). Chosen: their amplitudes, how far they lead
 * from the place of the fixation, and their distance in time from a saccade. */
static const double MICRO_MIN_DEG = 0.1;
static const double MICRO_MAX_DEG = 0.8;
static const double MICRO_REACH_DEG = 0.5;
static const double MICRO_AFTER_S = 0.05;
static const double MICRO_BEFORE_S = 0.02;

/* The drift is a leaky random walk of the velocity on a grid of 10 ms. The frequencies of the
 * tremor are within the 70 to 100 Hz of physiological tremor. */
static const double DRIFT_GRID_S = 0.01;
static const double DRIFT_KEEP = 0.9;
static const double DRIFT_LEAK = 0.01;
static const double TREMOR_HZ[2] = { 80, 87 };

/* Shortest pursuit; chosen. */
static const double PURSUIT_MIN_S = 0.4;

/* Landing error of a saccade to a target. Chosen after the usual 5 to 10 % of the amplitude. */
static const double LANDING_DEG = 0.2;
static const double LANDING_FRACTION = 0.05;

/* Fraction of a target's inhibition of return that remains after another fixation; chosen. */
static const double INHIBITION_KEEP = 0.75;

/* Following a place: how soon the eye leaves for a new place (saccadic latency, 200 ms; Carpenter
 * 1988); how far from the place it may rest; how long it rests before it checks again.
 * Saccades up to FOLLOW_REACH_DEG have no landing error. All but the first chosen. */
static const double FOLLOW_LATENCY_S = 0.2;
static const double FOLLOW_REST_DEG = 0.1;
static const double FOLLOW_REST_S = 0.5;
static const double FOLLOW_REACH_DEG = 2;

/* Most attempts to draw a random movement that stays within bounds; chosen. */
enum { TRIES = 40 };

double gz_main_sequence_peak_deg_s(double amplitude_deg)
{
	return 900 * (1 - gz_portable_exp(-amplitude_deg / 11));
}

double gz_main_sequence_duration_ms(double amplitude_deg)
{
	return 2.2 * amplitude_deg + 21;
}

/* The share of the velocity profile 630 t^4 (1 - t)^4 (peak 630/256 of the mean) that is mixed into
 * 6 t (1 - t) (peak 3/2 of the mean), so that duration and peak velocity follow the main sequence.
 */
static double profile_share(double amplitude_deg)
{
	if (amplitude_deg <= 0)
		return 0;
	double ratio = gz_main_sequence_peak_deg_s(amplitude_deg) *
		       gz_main_sequence_duration_ms(amplitude_deg) * 1e-3 / amplitude_deg;
	double share = (ratio - 1.5) / (630.0 / 256.0 - 1.5);
	return share < 0 ? 0 : share > 1 ? 1 : share;
}

/* Fraction of the way that is done after the fraction @p t of the duration. */
static double profile_place(double share, double t)
{
	double soft = t * t * (3 - 2 * t);
	double t4 = t * t * t * t;
	double sharp = t4 * t * (126 + t * (-420 + t * (540 + t * (-315 + t * 70))));
	return soft + share * (sharp - soft);
}

static double profile_speed(double share, double t)
{
	double parabola = t * (1 - t);
	double square = parabola * parabola;
	return (1 - share) * 6 * parabola + share * 630 * square * square;
}

/* Fraction of a saccade's way that is done at @p now_s, and its speed. */
static double saccade_progress(const struct gz_viewer_saccade *saccade, double now_s,
			       double *out_deg_s)
{
	double amplitude_deg = saccade->amplitude_rad * DEG_PER_RAD;
	double t = (now_s - saccade->begin_s) / saccade->duration_s;
	t = t < 0 ? 0 : t > 1 ? 1 : t;
	double share = profile_share(amplitude_deg);
	*out_deg_s = amplitude_deg / saccade->duration_s * profile_speed(share, t);
	return profile_place(share, t);
}

static bool is_inside_display(const struct gz_display *display, const double direction[3])
{
	if (direction[2] < 0.05) /* beyond 87 degrees */
		return false;
	struct gz_point p = gz_sphere_to_point(display, direction);
	return p.x >= EDGE && p.x <= 1 - EDGE && p.y >= EDGE && p.y <= 1 - EDGE;
}

static void random_tangent(struct gz_random *random, const double direction[3], double out[3])
{
	double right[3], down[3];
	gz_sphere_tangents(direction, right, down);
	double angle = gz_random_between(random, 0, TWO_PI);
	double c = gz_portable_cos(angle), s = gz_portable_sin(angle);
	for (int i = 0; i < 3; i++)
		out[i] = c * right[i] + s * down[i];
}

/* Find a place on the display that is @p amplitude_rad from @p from. @return whether one was found
 */
static bool random_landing(struct gz_viewer *viewer, const double from[3], double amplitude_rad,
			   double out_tangent[3], double out_landing[3])
{
	for (int i = 0; i < TRIES; i++) {
		random_tangent(&viewer->random, from, out_tangent);
		gz_sphere_turn(from, out_tangent, amplitude_rad, out_landing);
		if (is_inside_display(&viewer->display, out_landing))
			return true;
	}
	return false;
}

static void free_landing(struct gz_viewer *viewer, const double from[3], double out_landing[3])
{
	double tangent[3];
	for (int i = 0; i < TRIES; i++) {
		double deg = SACCADE_MIN_DEG + (viewer->params.saccade_deg - SACCADE_MIN_DEG) *
						       gz_random_gamma(&viewer->random, 2);
		if (random_landing(viewer, from, deg / DEG_PER_RAD, tangent, out_landing))
			return;
	}
	double x = gz_random_between(&viewer->random, 0.4, 0.6);
	double y = gz_random_between(&viewer->random, 0.4, 0.6);
	gz_sphere_from_point(&viewer->display, x, y, out_landing);
}

/* Draw the index of the next target at random, by weight and inhibition. */
static size_t draw_next_target(struct gz_viewer *viewer)
{
	const struct gz_targets *targets = viewer->targets;
	double total = 0;
	for (size_t i = 0; i < targets->count; i++)
		total += targets->target[i].weight * (1 - viewer->inhibition[i]);
	double draw = gz_random_between(&viewer->random, 0, total);
	size_t chosen = 0;
	for (size_t i = 0; i < targets->count; i++) {
		double share = targets->target[i].weight * (1 - viewer->inhibition[i]);
		if (share > 0)
			chosen = i;
		if (share > draw)
			break;
		draw -= share;
	}
	return chosen;
}

static void inhibit_target(struct gz_viewer *viewer, size_t chosen)
{
	for (size_t i = 0; i < viewer->targets->count; i++)
		viewer->inhibition[i] *= INHIBITION_KEEP;
	viewer->inhibition[chosen] = 1;
}

/* Where a saccade to @p aim lands. */
static void land_near(struct gz_viewer *viewer, const double from[3], const double aim[3],
		      double out_landing[3])
{
	double error_deg =
		LANDING_DEG + LANDING_FRACTION * DEG_PER_RAD * gz_sphere_angle(from, aim);
	double offset[2] = { error_deg * gz_random_normal(&viewer->random),
			     error_deg * gz_random_normal(&viewer->random) };
	gz_sphere_offset(aim, offset, out_landing);
}

static void target_landing(struct gz_viewer *viewer, const double from[3], double out_landing[3])
{
	size_t chosen = draw_next_target(viewer);
	inhibit_target(viewer, chosen);
	struct gz_point point = viewer->targets->target[chosen].point;
	double aim[3];
	gz_sphere_from_point(&viewer->display, point.x, point.y, aim);
	land_near(viewer, from, aim, out_landing);
}

static double angle_to_aim_deg(const struct gz_viewer *viewer)
{
	return gz_sphere_angle(viewer->place, viewer->aim) * DEG_PER_RAD;
}

static void aim_landing(struct gz_viewer *viewer, const double from[3], double out_landing[3])
{
	if (angle_to_aim_deg(viewer) > FOLLOW_REACH_DEG)
		land_near(viewer, from, viewer->aim, out_landing);
	else
		memcpy(out_landing, viewer->aim, sizeof viewer->aim);
}

static bool has_targets(const struct gz_viewer *viewer)
{
	return viewer->targets && viewer->targets->count > 0;
}

static struct gz_viewer_saccade make_saccade(const double start[3], const double end[3],
					     double begin_s)
{
	struct gz_viewer_saccade saccade = { .begin_s = begin_s };
	memcpy(saccade.start, start, sizeof saccade.start);
	memcpy(saccade.end, end, sizeof saccade.end);
	saccade.amplitude_rad = gz_sphere_angle(start, end);
	saccade.duration_s =
		gz_main_sequence_duration_ms(saccade.amplitude_rad * DEG_PER_RAD) * 1e-3;
	return saccade;
}

static void begin_viewer_phase(struct gz_viewer *viewer, enum gz_event phase, double duration_s)
{
	viewer->phase = phase;
	viewer->begin_s = viewer->end_s;
	viewer->end_s = viewer->begin_s + duration_s;
}

static void plan_microsaccade(struct gz_viewer *viewer, double not_before_s)
{
	viewer->micro.next_s = INFINITY;
	if (viewer->params.microsaccades_per_s > 0)
		viewer->micro.next_s = not_before_s + gz_random_exponential(&viewer->random) /
							      viewer->params.microsaccades_per_s;
}

static void begin_fixation(struct gz_viewer *viewer)
{
	double mean_s = viewer->params.fixation_ms * 1e-3 - FIXATION_MIN_S;
	double duration_s;
	do {
		duration_s =
			FIXATION_MIN_S + mean_s * gz_random_gamma(&viewer->random, DURATION_SHAPE);
	} while (duration_s > FIXATION_MAX_S);
	if (viewer->follows && angle_to_aim_deg(viewer) > FOLLOW_REST_DEG)
		duration_s = FOLLOW_LATENCY_S; /* it missed the aim and looks again */
	begin_viewer_phase(viewer, GZ_EVENT_FIXATION, duration_s);
	viewer->fixation_count++;
	plan_microsaccade(viewer, viewer->begin_s + MICRO_AFTER_S);
}

/* Add the finished microsaccades to the place and forget them. */
static void settle_microsaccades(struct gz_viewer *viewer)
{
	gz_sphere_offset(viewer->place, viewer->micro.to_deg, viewer->place);
	viewer->micro = (struct gz_viewer_microsaccade) { .next_s = INFINITY };
}

static void begin_planned_saccade(struct gz_viewer *viewer)
{
	double landing[3];
	if (viewer->follows)
		aim_landing(viewer, viewer->place, landing);
	else if (has_targets(viewer))
		target_landing(viewer, viewer->place, landing);
	else
		free_landing(viewer, viewer->place, landing);
	viewer->saccade = make_saccade(viewer->place, landing, viewer->end_s);
	begin_viewer_phase(viewer, GZ_EVENT_SACCADE, viewer->saccade.duration_s);
}

static double draw_next_time(struct gz_random *random, double now_s, double per_min)
{
	return per_min > 0 ? now_s + gz_random_exponential(random) * 60 / per_min : INFINITY;
}

static void begin_blink(struct gz_viewer *viewer)
{
	double mean_s = viewer->params.blink_ms * 1e-3 - BLINK_MIN_S;
	double duration_s;
	do {
		duration_s = BLINK_MIN_S + mean_s * gz_random_gamma(&viewer->random, 4);
	} while (duration_s > BLINK_MAX_S);
	begin_viewer_phase(viewer, GZ_EVENT_BLINK, duration_s);
	viewer->next_blink_s =
		draw_next_time(&viewer->random, viewer->end_s, viewer->params.blinks_per_min);
}

/* Begin a pursuit that stays on the display. @return whether there is one */
static bool begin_pursuit(struct gz_viewer *viewer)
{
	const struct gz_viewer_params *p = &viewer->params;
	double speed_deg_s = p->pursuit_deg_s * gz_random_between(&viewer->random, 0.5, 1.5);
	double duration_s =
		PURSUIT_MIN_S + (p->pursuit_ms * 1e-3 - PURSUIT_MIN_S) *
					gz_random_gamma(&viewer->random, DURATION_SHAPE);
	double landing[3];
	for (int i = 0; duration_s >= PURSUIT_MIN_S; i++, duration_s *= 0.7) {
		if (!random_landing(viewer, viewer->place, speed_deg_s * duration_s / DEG_PER_RAD,
				    viewer->direction, landing))
			continue;
		viewer->pursuit_rad_s = speed_deg_s / DEG_PER_RAD;
		begin_viewer_phase(viewer, GZ_EVENT_PURSUIT, duration_s);
		viewer->next_pursuit_s =
			draw_next_time(&viewer->random, viewer->end_s, p->pursuits_per_min);
		return true;
	}
	return false;
}

/* Prolong the fixation. */
static void prolong_fixation(struct gz_viewer *viewer)
{
	plan_microsaccade(viewer, viewer->end_s + MICRO_AFTER_S);
	viewer->end_s += FOLLOW_REST_S;
}

static void end_viewer_fixation(struct gz_viewer *viewer)
{
	settle_microsaccades(viewer);
	if (viewer->end_s >= viewer->next_blink_s)
		begin_blink(viewer);
	else if (viewer->follows && angle_to_aim_deg(viewer) <= FOLLOW_REST_DEG)
		prolong_fixation(viewer);
	else if (viewer->follows || viewer->end_s < viewer->next_pursuit_s ||
		 !begin_pursuit(viewer))
		begin_planned_saccade(viewer);
}

static void end_phase(struct gz_viewer *viewer)
{
	double duration_s = viewer->end_s - viewer->begin_s;
	switch (viewer->phase) {
	case GZ_EVENT_FIXATION:
		end_viewer_fixation(viewer);
		return;
	case GZ_EVENT_SACCADE:
		memcpy(viewer->place, viewer->saccade.end, sizeof viewer->place);
		break;
	case GZ_EVENT_PURSUIT: {
		double end[3];
		gz_sphere_turn(viewer->place, viewer->direction, viewer->pursuit_rad_s * duration_s,
			       end);
		memcpy(viewer->place, end, sizeof end);
		begin_planned_saccade(viewer); /* a saccade to something else follows a pursuit */
		return;
	}
	default: /* a blink */
		break;
	}
	begin_fixation(viewer);
}

/* Begin the microsaccade that is due, if it ends within the fixation. */
static void begin_microsaccade(struct gz_viewer *viewer)
{
	struct gz_viewer_microsaccade *micro = &viewer->micro;
	memcpy(micro->from_deg, micro->to_deg, sizeof micro->from_deg);
	for (int i = 0; i < TRIES; i++) {
		double length = gz_random_between(&viewer->random, MICRO_MIN_DEG, MICRO_MAX_DEG);
		double angle = gz_random_between(&viewer->random, 0, TWO_PI);
		double x = micro->from_deg[0] + length * gz_portable_cos(angle);
		double y = micro->from_deg[1] + length * gz_portable_sin(angle);
		if (x * x + y * y > MICRO_REACH_DEG * MICRO_REACH_DEG)
			continue;
		micro->to_deg[0] = x;
		micro->to_deg[1] = y;
		micro->amplitude_deg = length;
		break;
	}
	micro->begin_s = micro->next_s;
	micro->end_s = micro->begin_s + gz_main_sequence_duration_ms(micro->amplitude_deg) * 1e-3;
	plan_microsaccade(viewer, micro->end_s + MICRO_AFTER_S);
	if (micro->end_s > viewer->end_s - MICRO_BEFORE_S) {
		memcpy(micro->to_deg, micro->from_deg, sizeof micro->to_deg);
		micro->end_s = micro->begin_s;
		micro->next_s = INFINITY;
	}
}

/* Advance the plan to viewer->now_s. */
static void advance_plan(struct gz_viewer *viewer)
{
	for (;;) {
		bool micro_due = viewer->phase == GZ_EVENT_FIXATION &&
				 viewer->micro.next_s < viewer->end_s &&
				 viewer->micro.next_s <= viewer->now_s;
		if (micro_due)
			begin_microsaccade(viewer);
		else if (viewer->now_s >= viewer->end_s)
			end_phase(viewer);
		else
			return;
	}
}

static void advance_drift(struct gz_viewer *viewer)
{
	struct gz_viewer_jitter *jitter = &viewer->jitter;
	/* The stationary speed of the walk is drift_deg_s: 1 / sqrt 2 of it per axis. */
	double kick = viewer->params.drift_deg_s * sqrt((1 - DRIFT_KEEP * DRIFT_KEEP) / 2);
	for (; jitter->grid_s <= viewer->now_s; jitter->grid_s += DRIFT_GRID_S) {
		for (int axis = 0; axis < 2; axis++) {
			double *place = jitter->drift[axis];
			double velocity = DRIFT_KEEP * jitter->velocity[axis] +
					  kick * gz_random_normal(&viewer->jitter_random);
			jitter->velocity[axis] = velocity;
			place[0] = place[1];
			place[1] = (1 - DRIFT_LEAK) * place[1] + DRIFT_GRID_S * velocity;
		}
	}
}

/* Drift and tremor at viewer->now_s, degrees. @return the speed of the drift, degrees per second */
static double jitter_at(const struct gz_viewer *viewer, double out_deg[2])
{
	const struct gz_viewer_jitter *jitter = &viewer->jitter;
	double part = 1 - (jitter->grid_s - viewer->now_s) / DRIFT_GRID_S;
	double square = 0;
	for (int axis = 0; axis < 2; axis++) {
		const double *place = jitter->drift[axis];
		double turns = TREMOR_HZ[axis] * viewer->now_s + jitter->phase[axis];
		double tremor = gz_portable_sin(TWO_PI * (turns - floor(turns)));
		out_deg[axis] = place[0] + part * (place[1] - place[0]) +
				viewer->params.tremor_deg * tremor;
		double speed = (place[1] - place[0]) / DRIFT_GRID_S;
		square += speed * speed;
	}
	return sqrt(square);
}

/* Add the microsaccades to @p offset_deg. @return whether one is running */
static bool microsaccade_at(const struct gz_viewer *viewer, double offset_deg[2],
			    double *out_speed_deg_s)
{
	const struct gz_viewer_microsaccade *micro = &viewer->micro;
	if (viewer->now_s >= micro->end_s) {
		offset_deg[0] += micro->to_deg[0];
		offset_deg[1] += micro->to_deg[1];
		return false;
	}
	struct gz_viewer_saccade as_saccade = {
		.amplitude_rad = micro->amplitude_deg / DEG_PER_RAD,
		.begin_s = micro->begin_s,
		.duration_s = micro->end_s - micro->begin_s,
	};
	double part = saccade_progress(&as_saccade, viewer->now_s, out_speed_deg_s);
	for (int axis = 0; axis < 2; axis++)
		offset_deg[axis] += micro->from_deg[axis] +
				    part * (micro->to_deg[axis] - micro->from_deg[axis]);
	return true;
}

/* Where the eyes are according to the plan, without drift, tremor and microsaccades. */
static void planned_place(const struct gz_viewer *viewer, double out_place[3],
			  double *out_speed_deg_s)
{
	if (viewer->phase == GZ_EVENT_SACCADE) {
		const struct gz_viewer_saccade *saccade = &viewer->saccade;
		double tangent[3];
		double part = saccade_progress(saccade, viewer->now_s, out_speed_deg_s);
		gz_sphere_towards(saccade->start, saccade->end, tangent);
		gz_sphere_turn(saccade->start, tangent, part * saccade->amplitude_rad, out_place);
	} else if (viewer->phase == GZ_EVENT_PURSUIT) {
		*out_speed_deg_s = viewer->pursuit_rad_s * DEG_PER_RAD;
		gz_sphere_turn(viewer->place, viewer->direction,
			       viewer->pursuit_rad_s * (viewer->now_s - viewer->begin_s),
			       out_place);
	} else {
		memcpy(out_place, viewer->place, sizeof viewer->place);
	}
}

void gz_viewer_init(struct gz_viewer *viewer, const struct gz_viewer_params *params,
		    const struct gz_display *display, const struct gz_targets *targets,
		    uint64_t seed, int64_t start_ns)
{
	*viewer = (struct gz_viewer) {
		.params = *params,
		.display = *display,
		.targets = targets,
		.random = gz_random_seeded(seed, 1),
		.jitter_random = gz_random_seeded(seed, 2),
		.start_ns = start_ns,
		.micro = { .next_s = INFINITY },
	};
	struct gz_point first = { 0.5f, 0.5f };
	if (has_targets(viewer)) {
		first = targets->target[0].point;
		viewer->inhibition[0] = 1;
	}
	gz_sphere_from_point(display, first.x, first.y, viewer->place);
	for (int axis = 0; axis < 2; axis++)
		viewer->jitter.phase[axis] = gz_random_uniform(&viewer->jitter_random);
	viewer->next_blink_s = draw_next_time(&viewer->random, 0, params->blinks_per_min);
	viewer->next_pursuit_s = draw_next_time(&viewer->random, 0, params->pursuits_per_min);
	begin_fixation(viewer);
	viewer->fixation_count = 0; /* the number of the first is 0 */
}

void gz_viewer_follow(struct gz_viewer *viewer, const struct gz_point *point)
{
	double aim[3] = { 0, 0, 1 };
	if (point)
		gz_sphere_from_point(&viewer->display, point->x, point->y, aim);
	bool news = !viewer->follows || memcmp(aim, viewer->aim, sizeof aim) != 0;
	viewer->follows = point != NULL;
	memcpy(viewer->aim, aim, sizeof aim);
	double leave_s = viewer->now_s + FOLLOW_LATENCY_S;
	bool rests = viewer->phase == GZ_EVENT_FIXATION || viewer->phase == GZ_EVENT_PURSUIT;
	if (point && news && rests && viewer->end_s > leave_s && viewer->micro.end_s < leave_s)
		viewer->end_s = leave_s;
}

/* Share of a blink in which the lid closes; in the rest it opens. In people who are awake, the lid
 * closes in 63 of 202 ms (Caffier, Erdmann and Ullsperger, "Experimental evaluation of eye-blink
 * parameters as a drowsiness measure", European Journal of Applied Physiology 89, 2003). */
static const double CLOSING_SHARE = 0.31;

/* How far the lid has come down. It starts and stops without a jerk: its place is that of a
 * smoothstep in time, 3 t^2 - 2 t^3. */
static double lid_at(const struct gz_viewer *viewer)
{
	if (viewer->phase != GZ_EVENT_BLINK)
		return 0;
	double part = (viewer->now_s - viewer->begin_s) / (viewer->end_s - viewer->begin_s);
	double t = part < CLOSING_SHARE ? part / CLOSING_SHARE : (1 - part) / (1 - CLOSING_SHARE);
	t = fmax(0, fmin(1, t));
	return t * t * (3 - 2 * t);
}

struct gz_viewer_truth gz_viewer_advance(struct gz_viewer *viewer, int64_t time_ns)
{
	double now_s = gz_ns_to_s(time_ns - viewer->start_ns);
	if (now_s > viewer->now_s)
		viewer->now_s = now_s;
	advance_plan(viewer);
	advance_drift(viewer);

	double offset_deg[2], place[3], direction[3];
	double speed_deg_s = jitter_at(viewer, offset_deg);
	bool micro = microsaccade_at(viewer, offset_deg, &speed_deg_s);
	planned_place(viewer, place, &speed_deg_s);
	gz_sphere_offset(place, offset_deg, direction);
	return (struct gz_viewer_truth) {
		.time_ns = viewer->start_ns + (int64_t)floor(viewer->now_s * 1e9 + 0.5),
		.point = gz_sphere_to_point(&viewer->display, direction),
		.event = viewer->phase,
		.velocity_deg_s = speed_deg_s,
		.fixation = viewer->fixation_count,
		.microsaccade = micro,
		.lid = lid_at(viewer),
	};
}
