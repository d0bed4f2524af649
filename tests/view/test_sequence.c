/* The order of trials. */
#include "suite.h"

#include <string.h>

#include "base/captured_log.h"
#include "view/made_experiment.h"

static struct captured_log captured;

static const char factorial[] = "[experiment]\nname = n\nscene = s\nseed = 3\n"
				"[trial a]\n[trial b]\n[trial c]\n"
				"[block main]\nrepeats = 6\n";

static struct gz_sequence order_of(const struct gz_experiment *experiment, const char *participant,
				   const char *session)
{
	struct gz_sequence sequence;
	captured_log_init(&captured, "*:debug");
	assert_int_equal(
		gz_sequence_make(experiment, participant, session, &captured.log, &sequence),
		GZ_OK);
	return sequence;
}

static bool same(const struct gz_sequence *a, const struct gz_sequence *b)
{
	bool equal = a->count == b->count;
	for (size_t i = 0; equal && i < a->count; i++)
		equal = a->presentations[i].condition == b->presentations[i].condition &&
			a->presentations[i].swapped == b->presentations[i].swapped;
	return equal;
}

static void order_depends_on_seed_participant_and_session_only(void **state)
{
	(void)state;
	struct made_experiment made;
	make_experiment(&made, factorial);
	struct gz_sequence again = order_of(&made.experiment, "07", "1");
	struct gz_sequence other = order_of(&made.experiment, "08", "1");
	struct gz_sequence later = order_of(&made.experiment, "07", "2");
	made.experiment.params.seed++;
	struct gz_sequence seeded = order_of(&made.experiment, "07", "1");
	assert_true(same(&made.sequence, &again));
	assert_false(same(&made.sequence, &other));
	assert_false(same(&made.sequence, &later));
	assert_false(same(&made.sequence, &seeded));
	gz_sequence_free(&again);
	gz_sequence_free(&other);
	gz_sequence_free(&later);
	gz_sequence_free(&seeded);
	free_experiment(&made);
}

static void each_condition_comes_once_before_any_comes_again(void **state)
{
	(void)state;
	struct made_experiment made;
	make_experiment(&made, factorial);
	assert_int_equal(made.sequence.count, 18);
	for (size_t round = 0; round < 6; round++) {
		bool seen[3] = { false };
		for (size_t i = 0; i < 3; i++) {
			const struct gz_presentation *p =
				&made.sequence.presentations[3 * round + i];
			assert_int_equal(p->repetition, round + 1);
			assert_int_equal(p->number, 3 * round + i + 1);
			seen[p->condition - p->block->conditions] = true;
		}
		assert_true(seen[0] && seen[1] && seen[2]);
	}
	free_experiment(&made);
}

static void balanced_intervals_have_each_order_equally_often(void **state)
{
	(void)state;
	struct made_experiment made;
	make_experiment(&made, factorial);
	int swapped[3] = { 0 };
	for (size_t i = 0; i < made.sequence.count; i++) {
		const struct gz_presentation *p = &made.sequence.presentations[i];
		swapped[p->condition - p->block->conditions] += p->swapped;
	}
	for (int i = 0; i < 3; i++)
		assert_int_equal(swapped[i], 3);
	free_experiment(&made);
}

static void odd_repeat_gets_either_order(void **state)
{
	(void)state;
	struct made_experiment made;
	make_experiment(&made, "[experiment]\nname = n\nscene = s\n[trial a]\n"
			       "[block main]\nrepeats = 5\n");
	int with_two = 0, with_three = 0;
	for (int i = 0; i < 40; i++) {
		char participant[8];
		snprintf(participant, sizeof participant, "%d", i);
		struct gz_sequence s = order_of(&made.experiment, participant, "");
		int swapped = 0;
		for (size_t k = 0; k < s.count; k++)
			swapped += s.presentations[k].swapped;
		with_two += swapped == 2;
		with_three += swapped == 3;
		gz_sequence_free(&s);
	}
	assert_int_equal(with_two + with_three, 40);
	assert_true(with_two > 8 && with_three > 8);
	free_experiment(&made);
}

static void fixed_interval_orders_are_kept(void **state)
{
	(void)state;
	struct made_experiment made;
	make_experiment(&made, "[experiment]\nname = n\nscene = s\n[trial a]\ninterval_order = ab\n"
			       "[trial b]\ninterval_order = ba\n[trial c]\nintervals = 1\n"
			       "keys = y n\n[block m]\nrepeats = 4\norder = listed\n");
	for (size_t i = 0; i < made.sequence.count; i++) {
		assert_int_equal(made.sequence.presentations[i].condition -
					 made.experiment.blocks[0].conditions,
				 i % 3);
		assert_int_equal(made.sequence.presentations[i].swapped, i % 3 == 1);
	}
	free_experiment(&made);
}

static void full_random_order_mixes_repeats(void **state)
{
	(void)state;
	struct made_experiment made;
	make_experiment(&made, "[experiment]\nname = n\nscene = s\n[trial a]\n[trial b]\n"
			       "[block m]\nrepeats = 20\norder = full_random\n");
	int rounds_with_both = 0, first = 0;
	for (size_t i = 0; i < made.sequence.count; i += 2)
		rounds_with_both += made.sequence.presentations[i].condition !=
				    made.sequence.presentations[i + 1].condition;
	for (size_t i = 0; i < made.sequence.count; i++)
		first += made.sequence.presentations[i].condition ==
			 made.experiment.blocks[0].conditions;
	assert_int_equal(first, 20);
	assert_true(rounds_with_both < 20);
	free_experiment(&made);
}

static const char blocks[] = "[experiment]\nname = n\nscene = s\nblock_order = %s\n[trial t]\n"
			     "[block try]\npractice = yes\n[block a]\n[block b]\n[block c]\n";

/* The labels of the blocks, in the order in which they come. */
static void print_blocks(const struct gz_sequence *sequence, char text[32])
{
	text[0] = '\0';
	for (size_t i = 0; i < sequence->count; i++)
		strcat(text, sequence->presentations[i].block->label);
}

static void rotated_blocks_start_one_further_for_each_participant(void **state)
{
	(void)state;
	static const char *const expected[] = { "tryabc", "trybca", "trycab", "tryabc" };
	struct made_experiment made;
	char text[512], order[32];
	snprintf(text, sizeof text, blocks, "rotated");
	make_experiment(&made, text);
	for (int i = 0; i < 4; i++) {
		char participant[8];
		snprintf(participant, sizeof participant, "%02d", i);
		struct gz_sequence s = order_of(&made.experiment, participant, "");
		print_blocks(&s, order);
		assert_string_equal(order, expected[i]);
		gz_sequence_free(&s);
	}
	struct gz_sequence none;
	assert_int_equal(gz_sequence_make(&made.experiment, "ann", "", &captured.log, &none),
			 GZ_ERR_INVAL);
	assert_string_equal(captured.last, "/place/e.experiment: block_order: rotated needs a "
					   "number, and --participant ann is not one; give digits");
	free_experiment(&made);
}

static void random_blocks_leave_practice_in_place(void **state)
{
	(void)state;
	struct made_experiment made;
	char text[512], order[32], first[32] = "";
	int others = 0;
	snprintf(text, sizeof text, blocks, "random");
	make_experiment(&made, text);
	for (int i = 0; i < 20; i++) {
		char participant[8];
		snprintf(participant, sizeof participant, "%d", i);
		struct gz_sequence s = order_of(&made.experiment, participant, "");
		print_blocks(&s, order);
		assert_int_equal(strlen(order), 6);
		assert_memory_equal(order, "try", 3);
		if (i == 0)
			memcpy(first, order, sizeof first);
		others += strcmp(first, order) != 0;
		gz_sequence_free(&s);
	}
	assert_true(others > 5);
	free_experiment(&made);
}

TEST_SUITE(sequence)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(order_depends_on_seed_participant_and_session_only),
		cmocka_unit_test(each_condition_comes_once_before_any_comes_again),
		cmocka_unit_test(balanced_intervals_have_each_order_equally_often),
		cmocka_unit_test(odd_repeat_gets_either_order),
		cmocka_unit_test(fixed_interval_orders_are_kept),
		cmocka_unit_test(full_random_order_mixes_repeats),
		cmocka_unit_test(rotated_blocks_start_one_further_for_each_participant),
		cmocka_unit_test(random_blocks_leave_practice_in_place),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
