#include "drivers/pupil/pupil_clock.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "drivers/device/clock_model.h"

/* Offsets further than this from the first one get a new base, ns: a double holds smaller ones to a
 * fraction of a nanosecond. */
static const int64_t REBASE_NS = INT64_C(1000000000000000);

static int compare_exchange_delays(const void *left, const void *right)
{
	const struct gz_pupil_exchange *a = left, *b = right;
	return (a->delay_ns > b->delay_ns) - (a->delay_ns < b->delay_ns);
}

/* Least squares through the rounds. With one round the line is level. */
static void fit_pupil_rounds(struct gz_pupil_clock *clock)
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

static double pupil_offset_at(const struct gz_pupil_clock *clock, double at_ns)
{
	return clock->offset_ns + clock->slope * at_ns;
}

/* Forget all rounds. Keep the newest answer, because answers never run backwards. */
static void restart_pupil_clock(struct gz_pupil_clock *clock)
{
	bool mapped = clock->mapped;
	int64_t host_ns = clock->host_ns, pupil_ns = clock->pupil_ns;
	*clock = (struct gz_pupil_clock) { .set = clock->round_count > 0,
					   .mapped = mapped,
					   .host_ns = host_ns,
					   .pupil_ns = pupil_ns };
}

/* Mean and scatter of the fastest exchanges. @return false if the scatter is larger than any delay
 * explains: a clock was set during the round, which is then useless */
static bool average_pupil_round(struct gz_pupil_clock *clock, double *out_offset_ns)
{
	double mean = 0, square = 0;
	qsort(clock->exchanges, GZ_PUPIL_EXCHANGES, sizeof *clock->exchanges,
	      compare_exchange_delays);
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

static enum gz_pupil_sync finish_pupil_round(struct gz_pupil_clock *clock, double at_ns)
{
	struct gz_pupil_round round = { .at_ns = at_ns };
	if (!average_pupil_round(clock, &round.offset_ns))
		return GZ_PUPIL_SYNC_MORE;
	bool jumped = clock->set || (clock->round_count > 0 &&
				     fabs(round.offset_ns - pupil_offset_at(clock, at_ns)) >
					     (double)GZ_PUPIL_JUMP_NS);
	clock->set = false;
	if (jumped)
		clock->round_count = 0;
	if (clock->round_count == GZ_PUPIL_ROUNDS) {
		memmove(clock->rounds, clock->rounds + 1,
			sizeof *clock->rounds * (GZ_PUPIL_ROUNDS - 1));
		clock->round_count--;
	}
	clock->rounds[clock->round_count++] = round;
	fit_pupil_rounds(clock);
	return jumped ? GZ_PUPIL_SYNC_JUMPED : GZ_PUPIL_SYNC_DONE;
}

/* a - b. @return false if it does not fit */
static bool subtract_fits(int64_t a, int64_t b, int64_t *out)
{
	return !__builtin_sub_overflow(a, b, out);
}

/* Until the first round is complete, use the fastest exchange. Its error is at most its delay. */
static void use_fastest_exchange(struct gz_pupil_clock *clock,
				 const struct gz_pupil_exchange *exchange)
{
	if (clock->round_count > 0 ||
	    (clock->exchange_count > 1 && exchange->delay_ns >= clock->sigma_ns))
		return;
	clock->offset_ns = exchange->offset_ns;
	clock->slope = 0;
	clock->sigma_ns = exchange->delay_ns;
}

/* Whether the new offset can be expressed relative to the first one without loss. */
static bool is_near_base(const struct gz_pupil_clock *clock, int64_t offset_ns, int64_t pupil_ns,
			 int64_t *out_delta_ns, int64_t *out_at_ns)
{
	return subtract_fits(offset_ns, clock->base_ns, out_delta_ns) &&
	       subtract_fits(pupil_ns, clock->first_ns, out_at_ns) && -REBASE_NS < *out_delta_ns &&
	       *out_delta_ns < REBASE_NS;
}

enum gz_pupil_sync gz_pupil_clock_exchange(struct gz_pupil_clock *clock, int64_t sent_ns,
					   int64_t pupil_ns, int64_t received_ns)
{
	int64_t middle_ns = sent_ns + (received_ns - sent_ns) / 2;
	int64_t offset_ns, delta_ns = 0, at_ns = 0;
	if (!subtract_fits(middle_ns, pupil_ns, &offset_ns))
		return GZ_PUPIL_SYNC_MORE;
	if (clock->begun && !is_near_base(clock, offset_ns, pupil_ns, &delta_ns, &at_ns))
		restart_pupil_clock(clock);
	if (!clock->begun) {
		clock->begun = true;
		clock->base_ns = offset_ns;
		clock->first_ns = pupil_ns;
		delta_ns = at_ns = 0;
	}
	struct gz_pupil_exchange *exchange = &clock->exchanges[clock->exchange_count++];
	exchange->delay_ns = (double)(received_ns - sent_ns);
	exchange->offset_ns = (double)delta_ns;
	use_fastest_exchange(clock, exchange);
	if (clock->exchange_count < GZ_PUPIL_EXCHANGES)
		return GZ_PUPIL_SYNC_MORE;
	return finish_pupil_round(clock, (double)at_ns);
}

static int64_t answer_pupil_time(struct gz_pupil_clock *clock, int64_t host_ns, int64_t pupil_ns,
				 int64_t arrival_ns)
{
	clock->host_ns =
		gz_clock_in_order(host_ns, arrival_ns, clock->mapped ? &clock->host_ns : NULL);
	clock->mapped = true;
	clock->pupil_ns = pupil_ns;
	return clock->host_ns;
}

int64_t gz_pupil_clock_map(struct gz_pupil_clock *clock, int64_t pupil_ns, int64_t arrival_ns,
			   bool *out_believed)
{
	int64_t at_ns, offset_ns, host_ns, age_ns;
	bool fits = clock->begun && subtract_fits(pupil_ns, clock->first_ns, &at_ns) &&
		    !__builtin_add_overflow(clock->base_ns,
					    (int64_t)pupil_offset_at(clock, (double)at_ns),
					    &offset_ns) &&
		    !__builtin_add_overflow(pupil_ns, offset_ns, &host_ns) &&
		    subtract_fits(arrival_ns, host_ns, &age_ns) && age_ns > -GZ_PUPIL_EARLY_NS &&
		    age_ns < GZ_PUPIL_LATE_NS;
	*out_believed = fits;
	return answer_pupil_time(clock, fits ? host_ns : arrival_ns, pupil_ns, arrival_ns);
}

struct gz_clock_status gz_pupil_clock_status(const struct gz_pupil_clock *clock)
{
	if (!clock->begun)
		return (struct gz_clock_status) { .tick = GZ_CLOCK_NONE };
	int64_t at_ns = 0;
	if (clock->mapped && !subtract_fits(clock->pupil_ns, clock->first_ns, &at_ns))
		at_ns = 0;
	/* In unsigned numbers: Pupil may send any time, and the difference may not fit. */
	uint64_t offset =
		(uint64_t)clock->base_ns + (uint64_t)(int64_t)pupil_offset_at(clock, (double)at_ns);
	return (struct gz_clock_status) {
		.offset_ns = (int64_t)offset,
		/* The offset grows if Pupil's clock is slow. */
		.skew_ppm = -clock->slope / (1 + clock->slope) * 1e6,
		.sigma_ns = clock->sigma_ns,
		.tick = GZ_CLOCK_DECLARED,
	};
}
