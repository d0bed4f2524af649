#include "view/experiment/sequence.h"

#include <stdlib.h>
#include <string.h>

#include "base/text.h"
#include "sim/random.h"
#include "view/experiment/experiment_internal.h"
#include "view/experiment/staircase.h"

#define GZ_LOG_MODULE "experiment"

/* A sequence being made. */
struct maker {
	const struct gz_experiment *experiment;
	struct gz_random random;
	struct gz_sequence sequence;
};

/* Swap half of a condition's repeats, at random. With an odd number, one more or one less. */
static void balance_order(struct gz_random *random, bool *swapped, size_t count)
{
	bool more = gz_random_uniform(random) < 0.5;
	for (size_t i = 0; i < count; i++)
		swapped[i] = i < count / 2 || (i == count - 1 && count % 2 && more);
	gz_random_shuffle(random, swapped, count, sizeof *swapped);
}

static void draw_ways(struct gz_random *random, const struct gz_condition *condition, bool *swapped,
		      size_t count)
{
	memset(swapped, 0, count * sizeof *swapped);
	if (condition->params.intervals != 2)
		return;
	switch ((enum gz_experiment_interval_order)condition->params.interval_order) {
	case GZ_INTERVALS_BALANCED:
		balance_order(random, swapped, count);
		return;
	case GZ_INTERVALS_RANDOM:
		for (size_t i = 0; i < count; i++)
			swapped[i] = gz_random_uniform(random) < 0.5;
		return;
	case GZ_INTERVALS_AB:
		return;
	case GZ_INTERVALS_BA:
		memset(swapped, 1, count * sizeof *swapped);
		return;
	}
}

/* List all repeats of all conditions, repeat by repeat. */
static enum gz_result list_block(struct maker *maker, const struct gz_block *block,
				 struct gz_presentation *items)
{
	const size_t repeats = (size_t)block->params.repeats;
	bool *swapped = calloc(repeats, sizeof *swapped);
	if (!swapped)
		return GZ_ERR_NO_MEM;
	for (size_t i = 0; i < block->condition_count; i++) {
		draw_ways(&maker->random, &block->conditions[i], swapped, repeats);
		for (size_t k = 0; k < repeats; k++)
			items[k * block->condition_count + i] = (struct gz_presentation) {
				.block = block,
				.condition = &block->conditions[i],
				.swapped = swapped[k],
			};
	}
	free(swapped);
	return GZ_OK;
}

/* Number the presentations, and the repeats of each condition, in their order. */
static enum gz_result number_repeats(const struct gz_block *block, struct gz_presentation *items,
				     size_t count)
{
	int *seen = calloc(block->condition_count, sizeof *seen);
	if (!seen)
		return GZ_ERR_NO_MEM;
	for (size_t i = 0; i < count; i++) {
		items[i].number = (int)i + 1;
		items[i].repetition = ++seen[items[i].condition - block->conditions];
	}
	free(seen);
	return GZ_OK;
}

static enum gz_result add_block(struct maker *maker, const struct gz_block *block)
{
	const size_t each = block->condition_count, repeats = (size_t)block->params.repeats;
	struct gz_presentation *items = maker->sequence.presentations + maker->sequence.count;
	enum gz_result result = list_block(maker, block, items);
	if (result != GZ_OK)
		return result;
	if (block->params.order == GZ_ORDER_FULL)
		gz_random_shuffle(&maker->random, items, each * repeats, sizeof *items);
	for (size_t i = 0; block->params.order == GZ_ORDER_RANDOM && i < repeats; i++)
		gz_random_shuffle(&maker->random, items + i * each, each, sizeof *items);
	maker->sequence.count += each * repeats;
	return number_repeats(block, items, each * repeats);
}

static enum gz_result rotate_blocks(const struct gz_experiment *experiment, const char *participant,
				    const struct gz_log *log, const struct gz_block **blocks,
				    size_t count)
{
	long long whole;
	const struct gz_block *rotated[GZ_EXPERIMENT_SECTIONS_MAX];
	if (!gz_number_parse_whole(participant, &whole) || whole < 0) {
		gz_err(log,
		       "%s: block_order: rotated needs a number, and --participant %s is not one; "
		       "give digits",
		       experiment->path, participant);
		return GZ_ERR_INVAL;
	}
	for (size_t i = 0; i < count; i++)
		rotated[i] = blocks[(i + (size_t)whole % count) % count];
	for (size_t i = 0; i < count; i++)
		blocks[i] = rotated[i];
	return GZ_OK;
}

/* Order the blocks; practice blocks keep their places. */
static enum gz_result order_blocks(struct maker *maker, const char *participant,
				   const struct gz_log *log,
				   const struct gz_block *out_blocks[GZ_EXPERIMENT_SECTIONS_MAX])
{
	const struct gz_experiment *experiment = maker->experiment;
	const struct gz_block *counted[GZ_EXPERIMENT_SECTIONS_MAX] = { NULL };
	size_t count = 0, next = 0;
	enum gz_result result = GZ_OK;
	for (size_t i = 0; i < experiment->block_count; i++)
		if (!experiment->blocks[i].params.practice)
			counted[count++] = &experiment->blocks[i];
	if (experiment->params.block_order == GZ_BLOCKS_RANDOM)
		gz_random_shuffle(&maker->random, counted, count, sizeof(const struct gz_block *));
	else if (experiment->params.block_order == GZ_BLOCKS_ROTATED && count > 0)
		result = rotate_blocks(experiment, participant, log, counted, count);
	for (size_t i = 0; i < experiment->block_count; i++)
		out_blocks[i] = experiment->blocks[i].params.practice ? &experiment->blocks[i]
								      : counted[next++];
	return result;
}

/* Each participant and session has an order of its own. */
static uint64_t stream_of(const char *participant, const char *session)
{
	uint64_t hash =
		gz_experiment_hash(GZ_EXPERIMENT_HASH_START, participant, strlen(participant) + 1);
	return gz_experiment_hash(hash, session, strlen(session) + 1);
}

static size_t count_presentations(const struct gz_experiment *experiment)
{
	size_t count = 0;
	for (size_t i = 0; i < experiment->block_count; i++)
		count += experiment->blocks[i].condition_count *
			 (size_t)experiment->blocks[i].params.repeats;
	return count;
}

enum gz_result gz_sequence_make(const struct gz_experiment *experiment, const char *participant,
				const char *session, const struct gz_log *log,
				struct gz_sequence *out_sequence)
{
	const struct gz_block *blocks[GZ_EXPERIMENT_SECTIONS_MAX] = { NULL };
	struct maker maker = {
		.experiment = experiment,
		.random = gz_random_seeded((uint64_t)experiment->params.seed,
					   stream_of(participant, session)),
	};
	const size_t count = count_presentations(experiment);
	if (count == 0)
		return GZ_ERR_INVAL; /* the experiment was not read */
	maker.sequence.presentations = calloc(count, sizeof *maker.sequence.presentations);
	if (!maker.sequence.presentations)
		return GZ_ERR_NO_MEM;
	enum gz_result result = order_blocks(&maker, participant, log, blocks);
	for (size_t i = 0; i < experiment->block_count && blocks[i] && result == GZ_OK; i++)
		result = add_block(&maker, blocks[i]);
	if (result != GZ_OK) {
		gz_sequence_free(&maker.sequence);
		return result;
	}
	*out_sequence = maker.sequence;
	return GZ_OK;
}

size_t gz_sequence_next(const struct gz_sequence *sequence, size_t index)
{
	while (index < sequence->count &&
	       gz_staircase_finished(sequence->presentations[index].condition->staircase))
		index++;
	return index;
}

void gz_sequence_free(struct gz_sequence *sequence)
{
	free(sequence->presentations);
	*sequence = (struct gz_sequence) { 0 };
}
