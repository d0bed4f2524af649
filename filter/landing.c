#include "filter/landing.h"

#include <math.h>
#include <string.h>

#include "base/clock.h"
#include "base/vector.h"
#include "filter/angle.h"

/* Where the saccade began is the mean of the points of this age when it was noticed. Chosen: people
 * see it begin up to 16 ms before. */
static const double BEGAN_MS = 16, BEGAN_SPAN_MS = 12;

/* Speed is taken over this time, half a sample of 1000 Hz less. */
static const double SPEED_MS = 3.5;

/* Samples farther apart do not tell how the speed changes within a saccade. Chosen: 160 Hz. */
static const double SLOW_INTERVAL_MS = 6.25;

/* Smaller saccades say little about how far those of a person go. */
static const double TELLING_DEG = 2;

/* By this share the person's sizes follow each saccade, up or down, so that half of the saccades go
 * farther than predicted and half less far. At most so many times as far. Chosen: a screen that is
 * looked over for ten seconds. */
static const double FOLLOWING = 0.02, RATIO_MOST = 1.5;

static const struct gz_landing_place *place_before(const struct gz_landing_state *state,
						   uint64_t back)
{
	if (back >= state->count || back >= GZ_LANDING_RING)
		return NULL;
	return &state->ring[(state->count - 1 - back) % GZ_LANDING_RING];
}

static void add_place(struct gz_landing_state *state, const struct gz_display *display,
		      const struct gz_landing_input *input)
{
	struct gz_landing_place *place = &state->ring[state->count++ % GZ_LANDING_RING];
	place->time_ns = input->time_ns;
	gz_direction_deg(display, input->point, place->deg);
}

static double age_ms(const struct gz_landing_place *place, int64_t now_ns)
{
	return gz_ns_to_ms(now_ns - place->time_ns);
}

/* Where the eye was before the saccade; the newest old point if no sample is of the right age. */
static bool find_start(const struct gz_landing_state *state, int64_t now_ns, double out_deg[3])
{
	double sum[3] = { 0, 0, 0 };
	int count = 0;
	const struct gz_landing_place *place;
	for (uint64_t back = 0; (place = place_before(state, back)); back++) {
		const double age = age_ms(place, now_ns);
		if (age < BEGAN_MS)
			continue;
		if (age > BEGAN_MS + BEGAN_SPAN_MS && count > 0)
			break;
		for (int i = 0; i < 3; i++)
			sum[i] += place->deg[i];
		count++;
		if (age > BEGAN_MS + BEGAN_SPAN_MS)
			break;
	}
	for (int i = 0; i < 3; i++)
		out_deg[i] = count > 0 ? sum[i] / count : 0;
	return count > 0;
}

static void difference3(const double a[3], const double b[3], double out[3])
{
	for (int i = 0; i < 3; i++)
		out[i] = a[i] - b[i];
}

/* The unit vector halfway between two directions of any length. */
static void between(const double way[3], const double step[3], double out[3])
{
	double a[3], b[3];
	memcpy(a, way, sizeof a);
	memcpy(b, step, sizeof b);
	const bool moved = gz_normalise3(a), moves = gz_normalise3(b);
	for (int i = 0; i < 3; i++)
		out[i] = (moved ? a[i] : 0) + (moves ? b[i] : 0);
	(void)gz_normalise3(out);
}

static bool look_at_saccade(struct gz_landing_state *state)
{
	struct gz_landing_look *look = &state->look;
	const struct gz_landing_place *now = place_before(state, 0), *last = place_before(state, 1);
	const struct gz_landing_place *before = last;
	for (uint64_t back = 2; before && age_ms(before, now->time_ns) < SPEED_MS; back++)
		before = place_before(state, back);
	if (!before)
		return false;
	double way[3], step[3];
	difference3(now->deg, state->start_deg, way);
	difference3(now->deg, before->deg, step);
	look->elapsed_ms = gz_ns_to_ms(now->time_ns - state->begin_ns);
	look->interval_ms = age_ms(last, now->time_ns);
	look->way_deg = gz_length3(way);
	look->speed_deg_s = gz_length3(step) / age_ms(before, now->time_ns) * 1e3;
	look->peak_deg_s = fmax(look->peak_deg_s, look->speed_deg_s);
	memcpy(look->place_deg, now->deg, sizeof look->place_deg);
	between(way, step, look->heading);
	return true;
}

void gz_landing_terms(const struct gz_landing_look *look, double out_terms[GZ_LANDING_TERMS])
{
	out_terms[0] = 1;
	out_terms[1] = look->way_deg;
	out_terms[2] = look->speed_deg_s;
	out_terms[3] = look->peak_deg_s;
	for (int i = 0; i < 3; i++)
		out_terms[4 + i] = sqrt(out_terms[1 + i]);
}

size_t gz_landing_bin(double elapsed_ms)
{
	const double bin = elapsed_ms / GZ_LANDING_BIN_MS;
	return bin < 1 ? 0 : bin >= GZ_LANDING_BINS - 1 ? GZ_LANDING_BINS - 1 : (size_t)bin;
}

bool gz_landing_is_slow(double interval_ms)
{
	return interval_ms > SLOW_INTERVAL_MS;
}

static double weigh(const double weights[GZ_LANDING_TERMS], const double terms[GZ_LANDING_TERMS],
		    double most)
{
	double sum = 0;
	for (int i = 0; i < GZ_LANDING_TERMS; i++)
		sum += weights[i] * terms[i];
	return fmax(0, fmin(most, sum));
}

/* The distance to go as this person goes it; the size that it makes is kept for comparison. */
static double adapt_to_person(struct gz_landing_state *state, size_t bin, double to_go_deg)
{
	const double whole_deg = state->look.way_deg + to_go_deg;
	state->whole_deg[bin] = whole_deg;
	return fmax(0, fmin(GZ_LANDING_DEG_MAX,
			    whole_deg * (1 + state->longer[bin]) - state->look.way_deg));
}

static void learn_from_person(struct gz_landing_state *state)
{
	const struct gz_landing_place *end = place_before(state, 0);
	if (!end)
		return;
	double way[3];
	difference3(end->deg, state->start_deg, way);
	const double true_deg = gz_length3(way);
	for (size_t bin = 0; bin < GZ_LANDING_BINS; bin++) {
		if (state->whole_deg[bin] > TELLING_DEG && true_deg > TELLING_DEG) {
			const double ratio = 1 + state->longer[bin];
			const double followed = true_deg > ratio * state->whole_deg[bin]
							? ratio * (1 + FOLLOWING)
							: ratio / (1 + FOLLOWING);
			state->longer[bin] = fmax(1 / RATIO_MOST, fmin(RATIO_MOST, followed)) - 1;
		}
		state->whole_deg[bin] = 0;
	}
}

/* Where a direction meets the display. */
static bool point_of_direction(const struct gz_display *display, const double deg[3],
			       struct gz_point *out_point)
{
	if (!(deg[2] > 0))
		return false;
	const double scale = display->distance_mm / deg[2];
	*out_point = (struct gz_point) { (float)(deg[0] * scale / display->mm[0] + 0.5),
					 (float)(deg[1] * scale / display->mm[1] + 0.5) };
	return true;
}

static struct gz_landing predict(struct gz_landing_state *state,
				 const struct gz_landing_model *model,
				 const struct gz_display *display, int64_t now_ns)
{
	const struct gz_landing_look *look = &state->look;
	const size_t bin = gz_landing_bin(look->elapsed_ms);
	const struct gz_landing_weights *weights =
		gz_landing_is_slow(look->interval_ms) ? &model->slow[bin] : &model->fast[bin];
	double terms[GZ_LANDING_TERMS], end_deg[3];
	gz_landing_terms(look, terms);
	const double to_go_deg =
		adapt_to_person(state, bin, weigh(weights->deg, terms, GZ_LANDING_DEG_MAX));
	const double to_go_ms = weigh(weights->ms, terms, GZ_LANDING_MS_MAX);
	for (int i = 0; i < 3; i++)
		end_deg[i] = look->place_deg[i] + to_go_deg * look->heading[i];
	struct gz_landing landing = {
		.time_ns = now_ns + (int64_t)(to_go_ms * (double)GZ_NS_PER_MS),
		.sigma_deg = (float)(weights->sigma[0] + weights->sigma[1] * to_go_deg),
	};
	landing.known = point_of_direction(display, end_deg, &landing.point);
	return landing;
}

struct gz_landing gz_landing_step(struct gz_landing_state *state,
				  const struct gz_landing_model *model,
				  const struct gz_display *display,
				  const struct gz_landing_input *input)
{
	if (input->valid)
		add_place(state, display, input);
	if (input->event != GZ_EVENT_SACCADE) {
		const bool ended =
			input->event == GZ_EVENT_FIXATION || input->event == GZ_EVENT_PURSUIT;
		if (state->running && ended && input->valid)
			learn_from_person(state);
		memset(state->whole_deg, 0, sizeof state->whole_deg);
		state->running = state->waiting = false;
		return (struct gz_landing) { .known = false };
	}
	if (!state->running && !state->waiting) {
		state->running = find_start(state, input->time_ns, state->start_deg);
		state->waiting = !state->running;
		state->begin_ns = input->time_ns;
		state->look = (struct gz_landing_look) { .elapsed_ms = 0 };
	}
	if (!state->running || !input->valid || !look_at_saccade(state))
		return (struct gz_landing) { .known = false };
	return predict(state, model, display, input->time_ns);
}
