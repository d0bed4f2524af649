#include "drivers/pupil/pupil_clock.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Offsets this far from the first one are told from a new one, ns: a double holds what is below to
 * a fraction of a nanosecond. */
static const int64_t REBASE_NS = INT64_C(1000000000000000);

static int by_delay(const void *left, const void *right)
{
	const struct gz_pupil_exchange *a = left, *b = right;
	return (a->delay_ns > b->delay_ns) - (a->delay_ns < b->delay_ns);
}

/* Least squares through the rounds; level where one round says nothing of a slope. */
static void fit(struct gz_pupil_clock *clock)
{
	double mean_at = 0, mean_offset = 0, across = 0, along = 0;
	int count = clock->round_count;
	for (int i = 0; i < count; i++) {
		mean_at += clock->rounds[i].at_ns / count;
		mean_offset += clock->rounds[i].offset_ns / count;
	}
	for (int i = 0; i < count; i++) {
		double at = clock->rounds[i].at_ns - mean_at;
		across += at * (clock->rounds[i].offset_ns - mean_offset);
		along += at * at;
	}
	double slope = along > 0 ? across / along : 0;
	clock->slope = fmax(-GZ_PUPIL_SKEW_MAX, fmin(GZ_PUPIL_SKEW_MAX, slope));
	clock->offset_ns = mean_offset - clock->slope * mean_at;
}

static double line_at(const struct gz_pupil_clock *clock, double at_ns)
{
	return clock->offset_ns + clock->slope * at_ns;
}

/* Forget all rounds but keep the answers, which never run backwards. */
static void begin_again(struct gz_pupil_clock *clock)
{
	bool mapped = clock->mapped;
	int64_t host_ns = clock->host_ns, pupil_ns = clock->pupil_ns;
	*clock = (struct gz_pupil_clock) { .set = clock->round_count > 0,
					   .mapped = mapped,
					   .host_ns = host_ns,
					   .pupil_ns = pupil_ns };
}

/* Mean and scatter of the fastest exchanges. A scatter that no delay explains is a clock that was
 * set half-way: false, and the round is for nothing. */
static bool settle(struct gz_pupil_clock *clock, double *out_offset_ns)
{
	double mean = 0, square = 0;
	qsort(clock->exchanges, GZ_PUPIL_EXCHANGES, sizeof *clock->exchanges, by_delay);
	for (int i = 0; i < GZ_PUPIL_EXCHANGES_KEPT; i++)
		mean += clock->exchanges[i].offset_ns / GZ_PUPIL_EXCHANGES_KEPT;
	for (int i = 0; i < GZ_PUPIL_EXCHANGES_KEPT; i++)
		square += pow(clock->exchanges[i].offset_ns - mean, 2) / GZ_PUPIL_EXCHANGES_KEPT;
	double slowest_ns = clock->exchanges[GZ_PUPIL_EXCHANGES_KEPT - 1].delay_ns;
	clock->exchange_count = 0;
	if (sqrt(square) > fmax(slowest_ns, (double)GZ_PUPIL_JUMP_NS))
		return false;
	clock->sigma_ns = sqrt(square);
	*out_offset_ns = mean;
	return true;
}

static enum gz_pupil_sync finish_round(struct gz_pupil_clock *clock, double at_ns)
{
	struct gz_pupil_round round = { .at_ns = at_ns };
	if (!settle(clock, &round.offset_ns))
		return GZ_PUPIL_SYNC_MORE;
	bool jumped = clock->set ||
		      (clock->round_count > 0 &&
		       fabs(round.offset_ns - line_at(clock, at_ns)) > (double)GZ_PUPIL_JUMP_NS);
	clock->set = false;
	if (jumped)
		clock->round_count = 0;
	if (clock->round_count == GZ_PUPIL_ROUNDS) {
		memmove(clock->rounds, clock->rounds + 1,
			sizeof *clock->rounds * (GZ_PUPIL_ROUNDS - 1));
		clock->round_count--;
	}
	clock->rounds[clock->round_count++] = round;
	fit(clock);
	return jumped ? GZ_PUPIL_SYNC_JUMPED : GZ_PUPIL_SYNC_DONE;
}

/* a - b where that fits. */
static bool difference(int64_t a, int64_t b, int64_t *out)
{
	return !__builtin_sub_overflow(a, b, out);
}

/* Until the first round is complete the fastest exchange has to do; its delay is what it may be
 * wrong by. */
static void make_do(struct gz_pupil_clock *clock, const struct gz_pupil_exchange *exchange)
{
	if (clock->round_count > 0 ||
	    (clock->exchange_count > 1 && exchange->delay_ns >= clock->sigma_ns))
		return;
	clock->offset_ns = exchange->offset_ns;
	clock->slope = 0;
	clock->sigma_ns = exchange->delay_ns;
}

/* Whether the new offset can be told from the first one without loss. */
static bool relates(const struct gz_pupil_clock *clock, int64_t offset_ns, int64_t pupil_ns,
		    int64_t *out_delta_ns, int64_t *out_at_ns)
{
	return difference(offset_ns, clock->base_ns, out_delta_ns) &&
	       difference(pupil_ns, clock->first_ns, out_at_ns) &&
	       *out_delta_ns<REBASE_NS && * out_delta_ns> - REBASE_NS;
}

enum gz_pupil_sync gz_pupil_clock_exchange(struct gz_pupil_clock *clock, int64_t sent_ns,
					   int64_t pupil_ns, int64_t received_ns)
{
	int64_t middle_ns = sent_ns + (received_ns - sent_ns) / 2;
	int64_t offset_ns, delta_ns = 0, at_ns = 0;
	if (!difference(middle_ns, pupil_ns, &offset_ns))
		return GZ_PUPIL_SYNC_MORE;
	if (clock->begun && !relates(clock, offset_ns, pupil_ns, &delta_ns, &at_ns))
		begin_again(clock);
	if (!clock->begun) {
		clock->begun = true;
		clock->base_ns = offset_ns;
		clock->first_ns = pupil_ns;
		delta_ns = at_ns = 0;
	}
	struct gz_pupil_exchange *exchange = &clock->exchanges[clock->exchange_count++];
	exchange->delay_ns = (double)(received_ns - sent_ns);
	exchange->offset_ns = (double)delta_ns;
	make_do(clock, exchange);
	if (clock->exchange_count < GZ_PUPIL_EXCHANGES)
		return GZ_PUPIL_SYNC_MORE;
	return finish_round(clock, (double)at_ns);
}

/* Later than the last answer comes before not later than the arrival. */
static int64_t answer(struct gz_pupil_clock *clock, int64_t host_ns, int64_t pupil_ns,
		      int64_t arrival_ns)
{
	if (host_ns > arrival_ns)
		host_ns = arrival_ns;
	if (clock->mapped && host_ns <= clock->host_ns)
		host_ns = clock->host_ns + 1;
	clock->mapped = true;
	clock->host_ns = host_ns;
	clock->pupil_ns = pupil_ns;
	return host_ns;
}

int64_t gz_pupil_clock_map(struct gz_pupil_clock *clock, int64_t pupil_ns, int64_t arrival_ns,
			   bool *out_believed)
{
	int64_t at_ns, offset_ns, host_ns, age_ns;
	bool fits = clock->begun && difference(pupil_ns, clock->first_ns, &at_ns) &&
		    !__builtin_add_overflow(clock->base_ns, (int64_t)line_at(clock, (double)at_ns),
					    &offset_ns) &&
		    !__builtin_add_overflow(pupil_ns, offset_ns, &host_ns) &&
		    difference(arrival_ns, host_ns, &age_ns) && age_ns > -GZ_PUPIL_EARLY_NS &&
		    age_ns < GZ_PUPIL_LATE_NS;
	*out_believed = fits;
	return answer(clock, fits ? host_ns : arrival_ns, pupil_ns, arrival_ns);
}

struct gz_clock_status gz_pupil_clock_status(const struct gz_pupil_clock *clock)
{
	if (!clock->begun)
		return (struct gz_clock_status) { .tick = GZ_CLOCK_NONE };
	int64_t at_ns = 0;
	if (clock->mapped && !difference(clock->pupil_ns, clock->first_ns, &at_ns))
		at_ns = 0;
	/* By unsigned numbers: Pupil may say any time, and its difference may not fit. */
	uint64_t offset =
		(uint64_t)clock->base_ns + (uint64_t)(int64_t)line_at(clock, (double)at_ns);
	return (struct gz_clock_status) {
		.offset_ns = (int64_t)offset,
		/* The offset grows where Pupil's clock is slow. */
		.skew_ppm = -clock->slope / (1 + clock->slope) * 1e6,
		.sigma_ns = clock->sigma_ns,
		.tick = GZ_CLOCK_DECLARED,
	};
}
