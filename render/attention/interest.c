#include "render/attention/interest.h"

#include <math.h>

#include "base/clock.h"

/* Whether what is looked at now is what was looked at before. */
static bool same_thing(const struct gz_looked_at *before, const struct gz_looked_at *now)
{
	if (before->id != now->id)
		return false;
	return before->least == before->greatest
		       ? now->least == now->greatest
		       : now->value >= before->least && now->value <= before->greatest;
}

static void look_at(struct gz_interest *interest, const struct gz_looked_at *looked_at,
		    int64_t now_ns)
{
	if (interest->started && same_thing(&interest->looked_at, looked_at))
		return;
	interest->since_ns = now_ns;
	interest->looked_at = *looked_at;
	interest->started = true;
}

/* What is to be raised: a glance at something else changes nothing. */
static const struct gz_looked_at *wanted_thing(const struct gz_interest *interest,
					       const struct gz_attention_params *params)
{
	const double looked_ms = gz_ns_to_ms(interest->now_ns - interest->since_ns);
	return looked_ms >= params->importance_dwell_ms ? &interest->looked_at : &interest->raised;
}

static void fade(struct gz_interest *interest, const struct gz_looked_at *wanted, double step)
{
	if (!same_thing(&interest->raised, wanted)) {
		interest->fade = fmax(0, interest->fade - step);
		if (interest->fade > 0)
			return;
		/* It fades in from the next step on. */
		interest->raised = *wanted;
		return;
	}
	interest->fade = interest->raised.id == 0 ? 0 : fmin(1, interest->fade + step);
}

struct gz_interest gz_interest_step(struct gz_interest interest,
				    const struct gz_attention_params *params,
				    const struct gz_looked_at *looked_at, int64_t now_ns)
{
	if (interest.started && now_ns < interest.now_ns)
		now_ns = interest.now_ns;
	const double passed_ms = interest.started ? gz_ns_to_ms(now_ns - interest.now_ns) : 0;
	interest.now_ns = now_ns;
	look_at(&interest, looked_at, now_ns);
	fade(&interest, wanted_thing(&interest, params), passed_ms / params->importance_fade_ms);
	return interest;
}

struct gz_raised gz_interest_raised(const struct gz_interest *interest,
				    const struct gz_attention_params *params)
{
	const double fade = interest->fade, smooth = fade * fade * (3 - 2 * fade);
	const double share = params->importance * smooth;
	const struct gz_looked_at *raised = &interest->raised;
	return share > 0 ? (struct gz_raised) { raised->id, share, raised->least, raised->greatest }
			 : (struct gz_raised) { 0 };
}

bool gz_interest_at_rest(const struct gz_interest *interest)
{
	return same_thing(&interest->raised, &interest->looked_at) &&
	       (interest->raised.id == 0 || interest->fade >= 1);
}

bool gz_raised_same(const struct gz_raised *a, const struct gz_raised *b)
{
	return a->id == b->id && a->share == b->share && a->least == b->least &&
	       a->greatest == b->greatest;
}

double gz_raised_importance(double importance, double share)
{
	return importance + (1 - importance) * share;
}
