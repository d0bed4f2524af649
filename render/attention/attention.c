#include "render/attention/attention.h"

#include <math.h>

#include "base/clock.h"

/* The dead band never grows past this, degrees. Chosen: tremor, drift and microsaccades stay under
 * 1 degree (Bauer 2018, section 2.2), so more is a movement whatever the tracker's noise. */
#define DEAD_BAND_MAX_DEG 1.5

/* Of a gaze that no tracker tells, such as the mouse's, which has no noise: degrees. Chosen: a
 * pixel or two, so that the last bits of a number change no picture. */
#define EXACT_BAND_DEG 0.05

/* A saccade that lasts longer is none, and is not worth being blind for. A saccade of 90 degrees
 * takes 2.2 * 90 + 21 ms (Carpenter, "Movements of the Eyes", 1988). */
#define SACCADE_MAX_MS 219

/* After a landing the plan goes on with the gaze for so long: the tracker has yet to find out where
 * exactly the eye has come to rest, and an update 5 to 60 ms after the movement goes unseen (Bauer
 * 2018, section 2.2). */
#define LANDING_MS 60

/* Until a pursuit has lasted so long it may be a label that does not last: chosen, what noise makes
 * of the end of a saccade. */
#define PURSUIT_MIN_MS 100

/* A gaze farther off than so many dead bands has not been pursued there: chosen, what an eye covers
 * in the longest pursued frames. */
#define PURSUIT_MAX_BANDS 4

/* Widening is done in so many steps. Chosen: each is a small change; while nothing changes nothing
 * need be drawn. */
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
	       same_number(a->scale, b->scale) && same_number(a->widen, b->widen);
}

void gz_attention_init(struct gz_attention *attention, const struct gz_attention_params *params)
{
	*attention = (struct gz_attention) {
		.params = *params,
		.focus = { .point = { NAN, NAN }, .scale = 1, .widen = 0 },
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
	if (!(by_noise > params->dead_band_deg)) /* also where the noise is not known */
		return params->dead_band_deg;
	return fmin(by_noise, fmax(params->dead_band_deg, DEAD_BAND_MAX_DEG));
}

static bool finite_point(struct gz_point point)
{
	return isfinite(point.x) && isfinite(point.y);
}

/* What the gaze says the eye does, before anything is remembered. */
static enum gz_attention_state state_of(const struct gz_attention_params *params,
					const struct gz_attention_gaze *gaze)
{
	bool silent = gaze->has_age && gz_ns_to_ms(gaze->age_ns) > params->blink_ms;
	if (!gaze->known || silent)
		return GZ_ATTENTION_HOLD;
	/* The point behind closed lids is nobody's matter. */
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

/* How far the gaze is from where the plan is sharp; endless where that is nowhere. */
static double distance_deg(const struct gz_attention *attention,
			   const struct gz_attention_gaze *gaze, const struct gz_display *display)
{
	const struct gz_focus *focus = &attention->focus;
	double deg = gz_display_angle_deg(display, gaze->point, focus->point);
	return focus->widen > 0 || isnan(deg) ? INFINITY : deg;
}

static void look(struct gz_attention *attention, struct gz_point point, double scale)
{
	attention->focus = (struct gz_focus) { .point = point, .scale = scale, .widen = 0 };
}

static bool is_lost(enum gz_attention_state state)
{
	return state == GZ_ATTENTION_HOLD || state == GZ_ATTENTION_WIDEN;
}

static double for_ms(const struct gz_attention *attention)
{
	return gz_ns_to_ms(attention->now_ns - attention->said_ns);
}

/* Vision is suppressed, but the label may be wrong: while the eye has gone nowhere nothing changes,
 * and no saccade lasts for ever. */
static void in_saccade(struct gz_attention *attention, struct gz_point point, double distance,
		       double band)
{
	bool suppressed = for_ms(attention) <= SACCADE_MAX_MS;
	if (!attention->on_way && distance <= band)
		return;
	look(attention, point, suppressed ? attention->params.saccade_scale : 1);
	attention->on_way = true;
}

/* At rest in a new place, or soon to be. */
static void land(struct gz_attention *attention, struct gz_point point)
{
	look(attention, point, 1);
	attention->on_way = false;
	attention->landed = true;
	attention->landed_ns = attention->now_ns;
}

static bool just_landed(const struct gz_attention *attention)
{
	return attention->landed &&
	       gz_ns_to_ms(attention->now_ns - attention->landed_ns) <= LANDING_MS;
}

/* The plan is drawn along, a dead band behind: it moves as smoothly as the gaze, and for noise not
 * at all. */
static void in_pursuit(struct gz_attention *attention, struct gz_point to, double distance,
		       double band)
{
	struct gz_point from = attention->focus.point;
	if (distance <= band)
		return;
	float share = (float)(1 - band / distance);
	look(attention,
	     (struct gz_point) { from.x + share * (to.x - from.x),
				 from.y + share * (to.y - from.y) },
	     1);
}

static void seen(struct gz_attention *attention, const struct gz_attention_gaze *gaze,
		 const struct gz_display *display)
{
	double band = gaze->has_event
			      ? gz_attention_dead_band_deg(&attention->params, gaze->noise_deg)
			      : EXACT_BAND_DEG;
	double distance = distance_deg(attention, gaze, display);
	bool pursued = attention->state == GZ_ATTENTION_PURSUIT &&
		       for_ms(attention) >= PURSUIT_MIN_MS && distance < PURSUIT_MAX_BANDS * band;
	if (attention->state == GZ_ATTENTION_SACCADE)
		in_saccade(attention, gaze->point, distance, band);
	else if (!attention->on_way && just_landed(attention))
		look(attention, gaze->point, 1);
	else if (!attention->on_way && pursued)
		in_pursuit(attention, gaze->point, distance, band);
	else if (attention->on_way || distance > band)
		land(attention, gaze->point);
}

/* A blink that is too long is lost from its longest on, anything else from now on. */
static int64_t lost_since_ns(const struct gz_attention *attention)
{
	if (attention->said != GZ_ATTENTION_BLINK)
		return attention->now_ns;
	return attention->said_ns + (int64_t)(attention->params.blink_ms * (double)GZ_NS_PER_MS);
}

static void unseen(struct gz_attention *attention, bool was_lost)
{
	const struct gz_attention_params *params = &attention->params;
	if (!was_lost)
		attention->lost_ns = lost_since_ns(attention);
	double past_ms = gz_ns_to_ms(attention->now_ns - attention->lost_ns) - params->hold_ms;
	attention->focus.scale = 1; /* the eye may be open */
	attention->on_way = attention->landed = false;
	if (params->widen_ms <= 0 || past_ms < 0)
		return;
	attention->state = GZ_ATTENTION_WIDEN;
	double share = fmin(past_ms / params->widen_ms, 1);
	/* Up to the next step at once, so that it begins when the time to hold is over. */
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
	bool was_lost = attention->started && is_lost(attention->state);
	take_time(attention, state_of(&attention->params, gaze), now_ns);
	attention->state = attention->said;
	if (attention->state == GZ_ATTENTION_BLINK &&
	    for_ms(attention) > attention->params.blink_ms)
		attention->state = GZ_ATTENTION_HOLD;
	if (is_lost(attention->state))
		unseen(attention, was_lost);
	else if (attention->state != GZ_ATTENTION_BLINK)
		seen(attention, gaze, display);
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

bool gz_attention_spent(struct gz_attention *attention, double frame_ms)
{
	/* In a saccade a frame is cheaper than those that follow. */
	bool cheap = attention->focus.scale > 1 && frame_ms <= attention->params.budget_ms;
	return !cheap && gz_budget_step(&attention->budget, frame_ms);
}

void gz_attention_forget_spent(struct gz_attention *attention)
{
	gz_budget_init(&attention->budget, attention->params.budget_ms);
}
