#include "render/attention/attention.h"

#include <math.h>

#include "base/clock.h"

#define AT(field) offsetof(struct gz_attention_params, field)

const struct gz_option gz_attention_options[] = {
	{ "attention.dead_band_deg", GZ_OPTION_DOUBLE, AT(dead_band_deg), 0, 10, .preset = "0.5",
	  .help = "how far a tracker's gaze may move before the plan follows, degrees" },
	{ "attention.dead_band_noise", GZ_OPTION_DOUBLE, AT(dead_band_noise), 0, 10, .preset = "2",
	  .help = "the same limit as a multiple of the tracker's noise, up to 1.5 degrees; the "
		  "larger "
		  "one counts" },
	{ "attention.saccade_scale", GZ_OPTION_DOUBLE, AT(saccade_scale), 1, GZ_BUDGET_SCALE_MAX,
	  .preset = "2", .help = "factor on spacings outside the fovea in a saccade; 1 = none" },
	{ "attention.landing_deg", GZ_OPTION_DOUBLE, AT(landing_deg), 0, 180, .preset = "6",
	  .help = "in a saccade of at least this predicted size the plan moves to where it will "
		  "land, degrees; 0 = never" },
	{ "attention.blink_ms", GZ_OPTION_DOUBLE, AT(blink_ms), 0, 10000, .preset = "500",
	  .help = "longest blink, and greatest age of a gaze that is used, ms" },
	{ "attention.hold_ms", GZ_OPTION_DOUBLE, AT(hold_ms), 0, 1e6, .preset = "150",
	  .help = "how long the plan keeps its place after the gaze is lost, ms" },
	{ "attention.widen_ms", GZ_OPTION_DOUBLE, AT(widen_ms), 0, 1e6, .preset = "500",
	  .help = "how long the plan then takes to become uniform, ms; 0 = it stays" },
	{ "attention.budget_ms", GZ_OPTION_DOUBLE, AT(budget_ms), 0, 10000, .preset = "0",
	  .help = "time that 95 of 100 frames may take, ms; the plan gets as coarse as needed; "
		  "0 = no limit" },
	{ "attention.importance", GZ_OPTION_DOUBLE, AT(importance), 0, 1, .preset = "0",
	  .help = "how far the object or the values that are looked at are raised in importance, 0 "
		  "(not) to 1" },
	{ "attention.importance_dwell_ms", GZ_OPTION_DOUBLE, AT(importance_dwell_ms), 0, 10000,
	  .preset = "200", .help = "how long an object is looked at before it is raised, ms" },
	{ "attention.importance_fade_ms", GZ_OPTION_DOUBLE, AT(importance_fade_ms), 1, 10000,
	  .preset = "200",
	  .help = "how long it fades in, and out once something else is looked at, ms" },
};
const size_t gz_attention_option_count =
	sizeof gz_attention_options / sizeof gz_attention_options[0];

struct gz_attention_params gz_attention_default(void)
{
	struct gz_attention_params params = { 0 };
	const struct gz_option_binding binding = {
		.options = gz_attention_options,
		.count = gz_attention_option_count,
		.target = &params,
	};
	gz_options_preset(&binding);
	return params;
}

/* Upper limit of the dead band, degrees. Chosen: tremor, drift and microsaccades stay under 1
 * degree (Bauer 2018, section 2.2), so more is a movement even with a noisy tracker. */
#define DEAD_BAND_MAX_DEG 1.5

/* Dead band of a gaze without a tracker and its noise, such as the mouse's, degrees. Chosen: a
 * pixel or two, so that rounding changes no picture. */
#define EXACT_BAND_DEG 0.05

/* Longest saccade; a longer one is a wrong label. A saccade of 90 degrees takes 2.2 * 90 + 21 ms
 * (Carpenter, "Movements of the Eyes", 1988). */
#define SACCADE_MAX_MS 219

/* After a landing the plan follows every sample for this long, while the tracker settles on the
 * exact place. Nobody notices an update 5 to 60 ms after the movement (Bauer 2018, section 2.2). */
#define LANDING_MS 60

/* A shorter pursuit is ignored. Chosen: noise makes such labels of the end of a saccade. */
#define PURSUIT_MIN_MS 100

/* A gaze farther away than so many dead bands did not get there by pursuit. Chosen: the distance
 * that a pursuing eye covers in the longest frames. */
#define PURSUIT_MAX_BANDS 4

/* Steps in which a plan widens. Chosen: each is a small change, and between two of them nothing
 * needs to be drawn. */
#define WIDEN_STEPS 16

static const char *const state_names[] = { "fixation", "saccade", "pursuit",
					   "blink",    "hold",    "widen" };
_Static_assert(sizeof state_names / sizeof state_names[0] == GZ_ATTENTION_STATE_COUNT,
	       "a name for each state");

const char *gz_attention_state_name(enum gz_attention_state state)
{
	return state_names[state];
}

static bool same_number(double a, double b)
{
	return a == b || (isnan(a) && isnan(b));
}

bool gz_focus_same(const struct gz_focus *a, const struct gz_focus *b)
{
	return same_number((double)a->point.x, (double)b->point.x) &&
	       same_number((double)a->point.y, (double)b->point.y) &&
	       same_number(a->scale, b->scale) && same_number(a->widen, b->widen) &&
	       same_number(a->finer, b->finer);
}

void gz_attention_init(struct gz_attention *attention, const struct gz_attention_params *params)
{
	*attention = (struct gz_attention) {
		.params = *params,
		.focus = { .point = { NAN, NAN }, .scale = 1, .widen = 0 },
		.left = { NAN, NAN },
		.state = GZ_ATTENTION_HOLD,
	};
	gz_budget_init(&attention->budget, params->budget_ms);
}

void gz_attention_set_params(struct gz_attention *attention,
			     const struct gz_attention_params *params)
{
	if (params->budget_ms != attention->params.budget_ms)
		gz_budget_init(&attention->budget, params->budget_ms);
	attention->params = *params;
}

double gz_attention_dead_band_deg(const struct gz_attention_params *params, double noise_deg)
{
	double by_noise = params->dead_band_noise * noise_deg;
	if (!(by_noise > params->dead_band_deg)) /* also if the noise is NaN */
		return params->dead_band_deg;
	return fmin(by_noise, fmax(params->dead_band_deg, DEAD_BAND_MAX_DEG));
}

static bool finite_point(struct gz_point point)
{
	return isfinite(point.x) && isfinite(point.y);
}

/* The state by this gaze alone, without history. */
static enum gz_attention_state state_by_gaze(const struct gz_attention_params *params,
					     const struct gz_attention_gaze *gaze)
{
	bool silent = gaze->has_age && gz_ns_to_ms(gaze->age_ns) > params->blink_ms;
	if (!gaze->known || silent)
		return GZ_ATTENTION_HOLD;
	/* The point does not count while the lids are closed. */
	if (gaze->has_event && gaze->event == GZ_EVENT_BLINK)
		return GZ_ATTENTION_BLINK;
	if (!finite_point(gaze->point) || (gaze->has_event && gaze->event == GZ_EVENT_LOST))
		return GZ_ATTENTION_HOLD;
	if (gaze->has_event && gaze->event == GZ_EVENT_SACCADE)
		return GZ_ATTENTION_SACCADE;
	if (gaze->has_event && gaze->event == GZ_EVENT_PURSUIT)
		return GZ_ATTENTION_PURSUIT;
	return GZ_ATTENTION_FIXATION;
}

/* Angle from the gaze to where the plan is sharp; infinite if the plan is sharp nowhere. */
static double distance_deg(const struct gz_attention *attention,
			   const struct gz_attention_gaze *gaze, const struct gz_display *display)
{
	const struct gz_focus *focus = &attention->focus;
	double deg = gz_display_angle_deg(display, gaze->point, focus->point);
	return focus->widen > 0 || isnan(deg) ? INFINITY : deg;
}

static void aim_focus(struct gz_attention *attention, struct gz_point point, double scale)
{
	attention->focus = (struct gz_focus) { .point = point, .scale = scale, .widen = 0 };
}

static bool is_lost_state(enum gz_attention_state state)
{
	return state == GZ_ATTENTION_HOLD || state == GZ_ATTENTION_WIDEN;
}

static double for_ms(const struct gz_attention *attention)
{
	return gz_ns_to_ms(attention->now_ns - attention->said_ns);
}

/* Where the plan goes in a saccade: with the gaze, or ahead of it to where a large one will land.
 * The predictions of small ones are no nearer than the gaze itself (docs/gaze-pipeline.md). */
static struct gz_point aim_of_saccade(const struct gz_attention *attention,
				      const struct gz_attention_gaze *gaze,
				      const struct gz_display *display)
{
	const struct gz_landing *landing = &gaze->landing;
	double least_deg = attention->params.landing_deg;
	if (least_deg <= 0 || !landing->known || !finite_point(landing->point) ||
	    for_ms(attention) > SACCADE_MAX_MS)
		return gaze->point;
	double size_deg = gz_display_angle_deg(display, attention->left, landing->point);
	return size_deg >= least_deg ? landing->point : gaze->point;
}

/* Vision is suppressed in a saccade, but the label may be wrong: nothing changes until the eye has
 * left the dead band, and a saccade that is too long gets full detail again. */
static void follow_saccade(struct gz_attention *attention, struct gz_point point, double distance,
			   double band)
{
	bool suppressed = for_ms(attention) <= SACCADE_MAX_MS;
	if (!attention->on_way && distance <= band)
		return;
	aim_focus(attention, point, suppressed ? attention->params.saccade_scale : 1);
	attention->on_way = true;
}

/* The eye is at rest in a new place, or soon will be. */
static void land_at(struct gz_attention *attention, struct gz_point point)
{
	aim_focus(attention, point, 1);
	attention->on_way = false;
	attention->landed = true;
	attention->landed_ns = attention->now_ns;
}

static bool just_landed(const struct gz_attention *attention)
{
	return attention->landed &&
	       gz_ns_to_ms(attention->now_ns - attention->landed_ns) <= LANDING_MS;
}

/* The plan follows one dead band behind the gaze, so it moves as smoothly as the gaze and noise
 * does not move it. */
static void follow_pursuit(struct gz_attention *attention, struct gz_point to, double distance,
			   double band)
{
	struct gz_point from = attention->focus.point;
	if (distance <= band)
		return;
	float share = (float)(1 - band / distance);
	aim_focus(attention,
		  (struct gz_point) { from.x + share * (to.x - from.x),
				      from.y + share * (to.y - from.y) },
		  1);
}

static void follow_seen_gaze(struct gz_attention *attention, const struct gz_attention_gaze *gaze,
			     const struct gz_display *display)
{
	double band = gaze->has_event
			      ? gz_attention_dead_band_deg(&attention->params, gaze->noise_deg)
			      : EXACT_BAND_DEG;
	double distance = distance_deg(attention, gaze, display);
	bool pursued = attention->state == GZ_ATTENTION_PURSUIT &&
		       for_ms(attention) >= PURSUIT_MIN_MS && distance < PURSUIT_MAX_BANDS * band;
	if (attention->state != GZ_ATTENTION_SACCADE)
		attention->left = gaze->point;
	if (attention->state == GZ_ATTENTION_SACCADE)
		follow_saccade(attention, aim_of_saccade(attention, gaze, display), distance, band);
	else if (!attention->on_way && just_landed(attention))
		aim_focus(attention, gaze->point, 1);
	else if (!attention->on_way && pursued)
		follow_pursuit(attention, gaze->point, distance, band);
	else if (attention->on_way || distance > band)
		land_at(attention, gaze->point);
}

/* A blink that is too long counts as lost from the end of the longest blink, any other gaze from
 * now. */
static int64_t lost_since_ns(const struct gz_attention *attention)
{
	if (attention->said != GZ_ATTENTION_BLINK)
		return attention->now_ns;
	return attention->said_ns + (int64_t)(attention->params.blink_ms * (double)GZ_NS_PER_MS);
}

static void hold_or_widen(struct gz_attention *attention, bool was_lost)
{
	const struct gz_attention_params *params = &attention->params;
	if (!was_lost)
		attention->lost_ns = lost_since_ns(attention);
	double past_ms = gz_ns_to_ms(attention->now_ns - attention->lost_ns) - params->hold_ms;
	attention->focus.scale = 1; /* the eye may be open */
	attention->on_way = attention->landed = false;
	attention->left = (struct gz_point) { NAN, NAN };
	if (params->widen_ms <= 0 || past_ms < 0)
		return;
	attention->state = GZ_ATTENTION_WIDEN;
	double share = fmin(past_ms / params->widen_ms, 1);
	/* Rounded up, so that widening begins at once when the hold time is over. */
	double widen = fmin(floor(share * WIDEN_STEPS) + 1, WIDEN_STEPS) / WIDEN_STEPS;
	attention->focus.widen = fmax(attention->focus.widen, widen);
}

static struct gz_focus with_budget(const struct gz_attention *attention)
{
	struct gz_focus focus = attention->focus;
	focus.scale = fmin(focus.scale * gz_budget_scale(&attention->budget), GZ_BUDGET_SCALE_MAX);
	return focus;
}

static void take_time(struct gz_attention *attention, enum gz_attention_state said, int64_t now_ns)
{
	if (!attention->started || now_ns > attention->now_ns)
		attention->now_ns = now_ns;
	if (!attention->started || said != attention->said)
		attention->said_ns = attention->now_ns;
	attention->started = true;
	attention->said = said;
}

struct gz_focus gz_attention_step(struct gz_attention *attention,
				  const struct gz_attention_gaze *gaze,
				  const struct gz_display *display, int64_t now_ns)
{
	bool was_lost = attention->started && is_lost_state(attention->state);
	take_time(attention, state_by_gaze(&attention->params, gaze), now_ns);
	attention->state = attention->said;
	if (attention->state == GZ_ATTENTION_BLINK &&
	    for_ms(attention) > attention->params.blink_ms)
		attention->state = GZ_ATTENTION_HOLD;
	if (is_lost_state(attention->state))
		hold_or_widen(attention, was_lost);
	else if (attention->state != GZ_ATTENTION_BLINK)
		follow_seen_gaze(attention, gaze, display);
	return with_budget(attention);
}

bool gz_attention_settled(const struct gz_attention *attention)
{
	switch (attention->state) {
	case GZ_ATTENTION_FIXATION:
	case GZ_ATTENTION_PURSUIT:
		return true;
	case GZ_ATTENTION_HOLD:
	case GZ_ATTENTION_WIDEN:
		return attention->params.widen_ms <= 0 || attention->focus.widen >= 1;
	case GZ_ATTENTION_SACCADE:
	case GZ_ATTENTION_BLINK:
	case GZ_ATTENTION_STATE_COUNT:
		break;
	}
	return false;
}

bool gz_attention_spent(struct gz_attention *attention, double frame_ms, bool kept)
{
	const double budget_ms = attention->params.budget_ms;
	/* A frame in a saccade is cheaper than the frames that follow and says nothing about them.
	 */
	const bool cheap = attention->focus.scale > 1 && frame_ms <= budget_ms;
	/* Neither does one that took rays of earlier frames. But it is one of those of which 95 in
	 * 100 have to be within the budget: it counts as one that just is, which leaves no room. */
	if (kept)
		frame_ms = fmax(frame_ms, budget_ms);
	return !cheap && gz_budget_step(&attention->budget, frame_ms);
}

void gz_attention_forget_spent(struct gz_attention *attention)
{
	gz_budget_init(&attention->budget, attention->params.budget_ms);
}
