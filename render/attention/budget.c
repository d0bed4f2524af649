#include "render/attention/budget.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/order.h"

/* So many slow frames are more than 5 % of the window. */
#define OVER_MIN (GZ_BUDGET_WINDOW / 20 + 1)
/* Slow frames within this many frames have one cause. */
#define OVER_SPAN (OVER_MIN + 1)

/* Greatest ratio of the cost of neighbouring rungs: rays grow with the scale's square, 2^(2/4). */
#define RUNG_COST 1.4142135623730951

/* Share of the budget to aim at. Chosen: frame times may vary by a tenth without a change. */
#define AIM 0.9

/* The share when several rungs are skipped at once, since only part of a frame scales with its
 * rays. */
#define LEAP_AIM 0.8

/* Most doublings of a leap: from the first rung to the last. */
#define LEAPS_MAX 4

/* Frames below this share of their time at the failed trial are clearly cheaper (chosen). */
#define CHEAPER 0.8

/* Most doublings of the wait before the next trial (chosen: 40 * 2^8 frames are some minutes). */
#define FAILS_MAX 8

static const char *const state_names[] = { "off", "within", "over", "limit" };
_Static_assert(sizeof state_names / sizeof state_names[0] == GZ_BUDGET_STATE_COUNT,
	       "a name for each state");

const char *gz_budget_state_name(enum gz_budget_state state)
{
	return state_names[state];
}

void gz_budget_init(struct gz_budget *budget, double budget_ms)
{
	*budget = (struct gz_budget) { .budget_ms = budget_ms };
	budget->state = budget_ms > 0 ? GZ_BUDGET_WITHIN : GZ_BUDGET_OFF;
	for (int rung = 0; rung < GZ_BUDGET_RUNGS; rung++)
		budget->tries[rung].before_ms = INFINITY;
}

double gz_budget_scale(const struct gz_budget *budget)
{
	return exp2(budget->rung * 0.25);
}

static void add_frame_time(struct gz_budget *budget, double frame_ms)
{
	if (budget->count == GZ_BUDGET_WINDOW) {
		budget->count--;
		memmove(budget->frames_ms, budget->frames_ms + 1,
			sizeof budget->frames_ms - sizeof budget->frames_ms[0]);
	}
	budget->frames_ms[budget->count++] = frame_ms;
}

static int count_over(const struct gz_budget *budget, int newest)
{
	int over = 0;
	int first = budget->count > newest ? budget->count - newest : 0;
	for (int i = first; i < budget->count; i++)
		over += budget->frames_ms[i] > budget->budget_ms;
	return over;
}

/* The time that OVER_MIN - 1 of the newest frames exceed: for a whole window, its 95th percentile.
 */
static double upper_ms(const struct gz_budget *budget, int newest)
{
	double sorted[GZ_BUDGET_WINDOW];
	memcpy(sorted, budget->frames_ms + budget->count - newest,
	       (size_t)newest * sizeof sorted[0]);
	qsort(sorted, (size_t)newest, sizeof sorted[0], gz_compare_doubles);
	return sorted[newest - OVER_MIN];
}

static void go_to_rung(struct gz_budget *budget, int rung)
{
	budget->rung = rung < GZ_BUDGET_RUNGS ? rung : GZ_BUDGET_RUNGS - 1;
	budget->count = 0;
	budget->waited = 0;
}

/* Rungs that the excess needs if slow frames come together; 0 if they are scattered. */
static int rungs_needed(const struct gz_budget *budget)
{
	int newest = budget->count < OVER_SPAN ? budget->count : OVER_SPAN;
	if (count_over(budget, newest) < OVER_MIN)
		return 0;
	double excess = upper_ms(budget, newest) / (LEAP_AIM * budget->budget_ms);
	double rungs = ceil(log(excess) / log(RUNG_COST));
	/* Doubled after each attempt that did not help: rays may be the smaller part of a frame. */
	return (int)fmin(fmax(ldexp(rungs, budget->leaps), 1), GZ_BUDGET_RUNGS);
}

static void count_failure(struct gz_budget *budget, int from)
{
	if (budget->tries[from].fails < FAILS_MAX)
		budget->tries[from].fails++;
}

/* A trial has failed: go back at least to the rung before it, which kept the budget. */
static void end_trial(struct gz_budget *budget, int needed)
{
	int from = budget->tried_from, rung = budget->rung + needed;
	count_failure(budget, from);
	budget->tried_from = 0;
	go_to_rung(budget, rung > from ? rung : from);
}

/* Scattered slow frames: one rung coarser, and a long wait before the next trial. */
static void go_one_coarser(struct gz_budget *budget)
{
	go_to_rung(budget, budget->rung + 1);
	budget->tries[budget->rung].before_ms = AIM * budget->budget_ms / RUNG_COST;
	count_failure(budget, budget->rung);
}

/* Returns true the first time that there is no coarser rung. */
static bool go_coarser(struct gz_budget *budget)
{
	if (budget->rung == GZ_BUDGET_RUNGS - 1) {
		bool first = !budget->limit_told;
		budget->state = GZ_BUDGET_LIMIT;
		budget->limit_told = true;
		return first;
	}
	int needed = rungs_needed(budget);
	if (budget->tried_from > 0)
		end_trial(budget, needed);
	else if (needed == 0)
		go_one_coarser(budget);
	else
		go_to_rung(budget, budget->rung + needed);
	if (needed > 0 && budget->leaps < LEAPS_MAX)
		budget->leaps++;
	return false;
}

static bool may_try(struct gz_budget *budget, double percentile_ms)
{
	int rung = budget->rung;
	if (percentile_ms < CHEAPER * budget->tries[rung].before_ms)
		budget->tries[rung].fails = 0; /* the scene has changed */
	return budget->tries[rung].fails == 0 || budget->waited >= 1 << budget->tries[rung].fails;
}

/* Go to the finest rung that should still be fast enough; after a failure, only to the next one. */
static void try_finer(struct gz_budget *budget)
{
	double percentile_ms = upper_ms(budget, GZ_BUDGET_WINDOW);
	double ms = percentile_ms * RUNG_COST, aim_ms = AIM * budget->budget_ms;
	int from = budget->rung, rung = from;
	budget->waited++;
	if (!may_try(budget, percentile_ms))
		return;
	int least = budget->tries[from].fails > 0 ? from - 1 : 0;
	for (; rung > least && ms <= aim_ms; ms *= RUNG_COST)
		rung--;
	if (rung == from)
		return;
	budget->tries[from].before_ms = percentile_ms;
	go_to_rung(budget, rung);
	budget->tried_from = from;
}

/* A whole window was fast enough: a trial has passed. */
static void take_window(struct gz_budget *budget)
{
	budget->tried_from = 0;
	budget->leaps = 0;
	if (budget->rung > 0)
		try_finer(budget);
	budget->count = 0;
}

bool gz_budget_step(struct gz_budget *budget, double frame_ms)
{
	if (budget->state == GZ_BUDGET_OFF || !(frame_ms >= 0) || !isfinite(frame_ms))
		return false;
	add_frame_time(budget, frame_ms);
	if (budget->state != GZ_BUDGET_LIMIT || frame_ms <= budget->budget_ms)
		budget->state = frame_ms > budget->budget_ms ? GZ_BUDGET_OVER : GZ_BUDGET_WITHIN;
	if (count_over(budget, GZ_BUDGET_WINDOW) >= OVER_MIN)
		return go_coarser(budget);
	if (budget->count == GZ_BUDGET_WINDOW)
		take_window(budget);
	return false;
}

bool gz_budget_at_rest(const struct gz_budget *budget)
{
	return budget->rung == 0 || budget->waited > 0 || budget->state == GZ_BUDGET_LIMIT;
}
