#include "filter/classifier/whole.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "base/order.h"
#include "base/portable.h"

/* Samples whose features of what comes after are computed and kept together. Chosen: the state at
 * the end of each block and the rows of one block are a few bytes a sample. */
enum { BLOCK = 4096 };

/* Steps in time that count at most, in the costs, us. Chosen: no tracker has a lower rate. */
static const int64_t STEP_MOST_US = 100000;

/* Logarithms of odds: -0.2 for saccades, 0.3 for ringing. */
const struct gz_whole_costs gz_whole_preset_costs = { 4000, 40000, 16000, { 0, -819, 0, 0, 1229 } };

/* Odds of 20 count at most, and those of pursuit are 1.65 times as high. */
const struct gz_whole_odds gz_whole_preset_odds = { 150000, 12288, 2048, 0.5 };

/*
 * Features.
 */

/* Memory for the features of what comes after. */
struct backward {
	struct gz_movement *at_end; /* state behind the last sample of each block */
	struct gz_movement state;
	float rows[BLOCK][GZ_MOVEMENT_FEATURES];
};

/* Let time run backwards from the last sample. */
static void step_backward(struct gz_movement *state, const struct gz_display *display,
			  const struct gz_movement_input *input, int64_t last_ns,
			  float out_features[GZ_MOVEMENT_FEATURES])
{
	struct gz_movement_input reversed = *input;
	reversed.time_ns = last_ns - input->time_ns;
	(void)gz_movement_step(state, display, &reversed, out_features);
}

static size_t block_end(size_t block, size_t count)
{
	return count - block * BLOCK < BLOCK ? count : (block + 1) * BLOCK;
}

static void take_block(struct backward *backward, struct gz_movement *forward,
		       const struct gz_display *display, const struct gz_movement_input *input,
		       size_t begin, size_t end, int64_t last_ns, const struct gz_whole_rows *rows)
{
	float features[GZ_WHOLE_FEATURES];
	for (size_t i = end; i > begin; i--)
		step_backward(&backward->state, display, &input[i - 1], last_ns,
			      backward->rows[i - 1 - begin]);
	for (size_t i = begin; i < end; i++) {
		(void)gz_movement_step(forward, display, &input[i], features);
		memcpy(features + GZ_MOVEMENT_FEATURES, backward->rows[i - begin],
		       sizeof backward->rows[0]);
		rows->take(rows->user, i, features);
	}
}

enum gz_result gz_whole_features(const struct gz_display *display,
				 const struct gz_movement_input *input, size_t count,
				 const struct gz_whole_rows *rows)
{
	const size_t blocks = (count + BLOCK - 1) / BLOCK;
	if (count == 0)
		return GZ_OK;
	struct gz_movement *forward = calloc(1, sizeof *forward);
	struct backward *backward = calloc(1, sizeof *backward);
	if (backward)
		backward->at_end = calloc(blocks, sizeof *backward->at_end);
	bool good = forward && backward && backward->at_end;
	for (size_t block = blocks; good && block-- > 0;) {
		backward->at_end[block] = backward->state;
		for (size_t i = block_end(block, count); i > block * BLOCK; i--)
			step_backward(&backward->state, display, &input[i - 1],
				      input[count - 1].time_ns, backward->rows[0]);
	}
	for (size_t block = 0; good && block < blocks; block++) {
		backward->state = backward->at_end[block];
		take_block(backward, forward, display, input, block * BLOCK,
			   block_end(block, count), input[count - 1].time_ns, rows);
	}
	if (backward)
		free(backward->at_end);
	free(backward);
	free(forward);
	return good ? GZ_OK : GZ_ERR_NO_MEM;
}

/*
 * The odds of pursuit.
 */

/* The usual share of pursuit in slow movement, and the time of slow movement that says as much as
 * this knowledge. Chosen on recordings that the forest did not learn from
 * (docs/gaze-pipeline.md). */
static const double USUAL_SHARE = 0.1;
static const double USUAL_S = 4;

/* Rounds of expectation and maximisation. Chosen: more change nothing that is seen. */
enum { SHARE_ROUNDS = 10 };

/* Whether a sample is likeliest to be a fixation or a pursuit. */
static bool is_slow(const int32_t scores[GZ_FOREST_CLASSES])
{
	int best = 0;
	for (int k = 1; k < GZ_FOREST_CLASSES; k++)
		best = scores[k] > scores[best] ? k : best;
	return best == GZ_FOREST_FIXATION || best == GZ_FOREST_PURSUIT;
}

static int64_t step_before_us(const struct gz_movement_input *input, size_t index)
{
	const int64_t step_us =
		index > 0 ? (input[index].time_ns - input[index - 1].time_ns) / 1000 : 0;
	return step_us < STEP_MOST_US ? step_us : STEP_MOST_US;
}

/* Logarithm of the odds of pursuit, GZ_FOREST_UNIT. */
static double log_odds(double share)
{
	return gz_portable_log(share / (1 - share)) / GZ_FOREST_UNIT;
}

/* How likely a pursuit is, rather than a fixation, by its odds. */
static double pursuit_part(int64_t odds)
{
	return 1 / (1 + gz_portable_exp(-fmax(-50, fmin(50, GZ_FOREST_UNIT * (double)odds))));
}

/* The slow movement of a recording. */
struct slow_movement {
	size_t count;  /* of its samples */
	size_t *index; /* of each, in the recording */
	int32_t *odds; /* of pursuit against fixation, GZ_FOREST_UNIT */
	int64_t *us;   /* its time */
};

static void free_slow_movement(struct slow_movement *slow)
{
	free(slow->index);
	free(slow->odds);
	free(slow->us);
}

static enum gz_result find_slow_movement(const struct gz_movement_input *input,
					 const int32_t (*scores)[GZ_FOREST_CLASSES], size_t count,
					 struct slow_movement *out)
{
	*out = (struct slow_movement) {
		.index = malloc(count * sizeof *out->index),
		.odds = malloc(count * sizeof *out->odds),
		.us = malloc(count * sizeof *out->us),
	};
	if (!out->index || !out->odds || !out->us) {
		free_slow_movement(out);
		return GZ_ERR_NO_MEM;
	}
	for (size_t i = 0; i < count; i++) {
		if (!input[i].valid || !is_slow(scores[i]))
			continue;
		out->index[out->count] = i;
		out->odds[out->count] =
			scores[i][GZ_FOREST_PURSUIT] - scores[i][GZ_FOREST_FIXATION];
		out->us[out->count++] = step_before_us(input, i);
	}
	return GZ_OK;
}

/* By how much the share of pursuit raises its odds. */
static int32_t share_lead(const struct slow_movement *slow)
{
	int32_t lead = 0;
	for (int round = 0; round < SHARE_ROUNDS; round++) {
		double pursuit_s = USUAL_S * USUAL_SHARE, slow_s = USUAL_S;
		for (size_t i = 0; i < slow->count; i++) {
			const double step_s = 1e-6 * (double)slow->us[i];
			pursuit_s += step_s * pursuit_part((int64_t)slow->odds[i] + lead);
			slow_s += step_s;
		}
		lead = (int32_t)floor(log_odds(pursuit_s / slow_s) - log_odds(USUAL_SHARE) + 0.5);
	}
	return lead;
}

static void limit_odds(struct slow_movement *slow, int32_t lead, int32_t limit)
{
	for (size_t i = 0; i < slow->count; i++) {
		const int64_t odds = (int64_t)slow->odds[i] + lead;
		slow->odds[i] = (int32_t)(odds > limit ? limit : odds < -limit ? -limit : odds);
	}
}

/* Change the worse one of fixation and pursuit, or the better one, so that the better one of both
 * is as likely as before. */
static void set_odds(int32_t scores[GZ_FOREST_CLASSES], int32_t odds)
{
	int32_t *fixation = &scores[GZ_FOREST_FIXATION], *pursuit = &scores[GZ_FOREST_PURSUIT];
	const int32_t better = *fixation > *pursuit ? *fixation : *pursuit;
	*fixation = better - (odds > 0 ? odds : 0);
	*pursuit = better + (odds < 0 ? odds : 0);
}

/* Give each sample the mean of the odds around it, weighted by time. */
static void spread_odds(const struct gz_movement_input *input, const struct slow_movement *slow,
			int64_t reach_us, int32_t (*scores)[GZ_FOREST_CLASSES])
{
	int64_t sum = 0, us = 0;
	size_t begin = 0, end = 0;
	for (size_t i = 0; i < slow->count; i++) {
		const int64_t now_ns = input[slow->index[i]].time_ns;
		for (; end < slow->count &&
		       (input[slow->index[end]].time_ns - now_ns) / 1000 <= reach_us;
		     end++) {
			sum += slow->odds[end] * slow->us[end];
			us += slow->us[end];
		}
		for (; (now_ns - input[slow->index[begin]].time_ns) / 1000 > reach_us; begin++) {
			sum -= slow->odds[begin] * slow->us[begin];
			us -= slow->us[begin];
		}
		set_odds(scores[slow->index[i]], us > 0 ? (int32_t)(sum / us) : slow->odds[i]);
	}
}

enum gz_result gz_whole_weigh(const struct gz_movement_input *input, size_t count,
			      const struct gz_whole_odds *odds,
			      int32_t (*scores)[GZ_FOREST_CLASSES])
{
	struct slow_movement slow;
	if (count == 0)
		return GZ_OK;
	enum gz_result result = find_slow_movement(
		input, (const int32_t(*)[GZ_FOREST_CLASSES])scores, count, &slow);
	if (result != GZ_OK)
		return result;
	const double lead = odds->share * share_lead(&slow);
	limit_odds(&slow, odds->lead + (int32_t)floor(lead + 0.5), odds->limit);
	spread_odds(input, &slow, odds->reach_us, scores);
	free_slow_movement(&slow);
	return GZ_OK;
}

/*
 * The best sequence of labels.
 */

enum gz_result gz_whole_gap_ns(const struct gz_movement_input *input, size_t count,
			       int64_t *out_gap_ns)
{
	*out_gap_ns = GZ_WHOLE_DROPOUT_NS;
	if (count < 2)
		return GZ_OK;
	int64_t *steps = malloc((count - 1) * sizeof *steps);
	if (!steps)
		return GZ_ERR_NO_MEM;
	for (size_t i = 1; i < count; i++)
		steps[i - 1] = input[i].time_ns - input[i - 1].time_ns;
	qsort(steps, count - 1, sizeof *steps, gz_compare_int64s);
	int64_t median_ns = steps[(count - 1) / 2];
	free(steps);
	if (median_ns > *out_gap_ns / 3)
		*out_gap_ns = median_ns > INT64_MAX / 3 ? INT64_MAX : 3 * median_ns;
	return GZ_OK;
}

/* What is known of a sample before its scores are read. */
enum known { MEASURED, DROPOUT, LOSS };

/* Judge the samples from @p index on: if they are a loss, all of it. @return the one behind them */
static size_t judge_loss(const struct gz_movement_input *input, size_t count, size_t index,
			 enum known *out_known)
{
	size_t end = index;
	while (end < count && !input[end].valid)
		end++;
	bool inside = index > 0 && end < count;
	bool brief = inside && (end - index == 1 || input[end].time_ns - input[index - 1].time_ns <
							    GZ_WHOLE_DROPOUT_NS);
	*out_known = end == index ? MEASURED : brief ? DROPOUT : LOSS;
	return end == index ? end + 1 : end;
}

/* The best sequences up to the present sample. */
struct decoder {
	const struct gz_whole_costs *costs;
	int64_t best[GZ_FOREST_CLASSES];    /* relative to the best one; GZ_FOREST_UNIT us */
	uint8_t (*from)[GZ_FOREST_CLASSES]; /* of each sample and class: the class before it */
};

/* Less than any sum of scores. */
static const int64_t IMPOSSIBLE = INT64_MIN / 4;

static int64_t cost_of(const struct gz_whole_costs *costs, int from, int to)
{
	const int64_t unit = (int64_t)(1 / GZ_FOREST_UNIT);
	if (from == to)
		return 0;
	const bool from_slow = from == GZ_FOREST_FIXATION || from == GZ_FOREST_PURSUIT;
	const bool to_slow = to == GZ_FOREST_FIXATION || to == GZ_FOREST_PURSUIT;
	const bool saccade = (from == GZ_FOREST_SACCADE && (to_slow || to == GZ_FOREST_NOISE)) ||
			     (from == GZ_FOREST_NOISE && to == GZ_FOREST_SACCADE);
	return unit * (from_slow && to_slow ? costs->pursuit_us
		       : saccade            ? costs->saccade_us
					    : costs->change_us);
}

/* Find the best way to each class. @param apart  something is missing before this sample */
static void change_labels(struct decoder *decoder, bool apart, uint8_t from[GZ_FOREST_CLASSES])
{
	int64_t next[GZ_FOREST_CLASSES];
	for (int to = 0; to < GZ_FOREST_CLASSES; to++) {
		next[to] = IMPOSSIBLE;
		from[to] = GZ_FOREST_NOISE;
		for (int k = 0; k < GZ_FOREST_CLASSES; k++) {
			bool rings = to == GZ_FOREST_RINGING;
			if (rings && (apart || (k != GZ_FOREST_RINGING && k != GZ_FOREST_SACCADE)))
				continue;
			int64_t sum =
				decoder->best[k] - (apart ? 0 : cost_of(decoder->costs, k, to));
			if (sum > next[to]) {
				next[to] = sum;
				from[to] = (uint8_t)k;
			}
		}
	}
	memcpy(decoder->best, next, sizeof next);
}

/* Add what a sample says for each class, and keep the numbers small. */
static void add_evidence(struct decoder *decoder, enum known known,
			 const int32_t scores[GZ_FOREST_CLASSES], int64_t step_us)
{
	int64_t most = INT64_MIN;
	for (int k = 0; k < GZ_FOREST_CLASSES; k++) {
		if (known == MEASURED)
			decoder->best[k] +=
				((int64_t)scores[k] + decoder->costs->added[k]) * step_us;
		else if (known == LOSS && k != GZ_FOREST_NOISE)
			decoder->best[k] = IMPOSSIBLE;
		most = decoder->best[k] > most ? decoder->best[k] : most;
	}
	for (int k = 0; k < GZ_FOREST_CLASSES; k++) {
		decoder->best[k] -= most;
		decoder->best[k] = decoder->best[k] < IMPOSSIBLE ? IMPOSSIBLE : decoder->best[k];
	}
}

static void read_backwards(const struct decoder *decoder, size_t count, uint8_t *out_class)
{
	int now = 0;
	for (int k = 1; k < GZ_FOREST_CLASSES; k++)
		now = decoder->best[k] > decoder->best[now] ? k : now;
	for (size_t i = count; i > 0; i--) {
		out_class[i - 1] = (uint8_t)now;
		now = decoder->from[i - 1][now];
	}
}

enum gz_result gz_whole_decode(const struct gz_movement_input *input,
			       const int32_t (*scores)[GZ_FOREST_CLASSES], size_t count,
			       const struct gz_whole_costs *costs, uint8_t *out_class)
{
	struct decoder decoder = { .costs = costs };
	int64_t gap_ns, step_us = 0;
	enum gz_result result = gz_whole_gap_ns(input, count, &gap_ns);
	if (result != GZ_OK || count == 0)
		return result;
	decoder.from = malloc(count * sizeof *decoder.from);
	if (!decoder.from)
		return GZ_ERR_NO_MEM;
	enum known known = MEASURED;
	for (size_t i = 0, end = 0; i < count; i++) {
		if (i == end)
			end = judge_loss(input, count, i, &known);
		int64_t step_ns = i > 0 ? input[i].time_ns - input[i - 1].time_ns : gap_ns;
		bool apart = i == 0 || step_ns > gap_ns;
		step_us = step_ns / 1000 < STEP_MOST_US ? step_ns / 1000 : STEP_MOST_US;
		if (apart && step_us > gap_ns / 3000)
			step_us = gap_ns / 3000;
		change_labels(&decoder, apart, decoder.from[i]);
		add_evidence(&decoder, known, scores[i], step_us);
	}
	read_backwards(&decoder, count, out_class);
	free(decoder.from);
	return GZ_OK;
}

/*
 * All together.
 */

static void score_row(void *user, size_t index, const float features[GZ_WHOLE_FEATURES])
{
	int32_t(*scores)[GZ_FOREST_CLASSES] = user;
	gz_whole_score(features, scores[index]);
}

enum gz_result gz_whole_label(const struct gz_display *display,
			      const struct gz_movement_input *input, size_t count,
			      uint8_t *out_class)
{
	int32_t(*scores)[GZ_FOREST_CLASSES] = calloc(count ? count : 1, sizeof *scores);
	if (!scores)
		return GZ_ERR_NO_MEM;
	const struct gz_whole_rows rows = { scores, score_row };
	enum gz_result result = gz_whole_features(display, input, count, &rows);
	if (result == GZ_OK)
		result = gz_whole_weigh(input, count, &gz_whole_preset_odds, scores);
	if (result == GZ_OK)
		result = gz_whole_decode(input, (const int32_t(*)[GZ_FOREST_CLASSES])scores, count,
					 &gz_whole_preset_costs, out_class);
	free(scores);
	return result;
}
