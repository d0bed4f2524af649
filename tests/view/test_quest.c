/* QUEST, and the staircase of a condition. */
#include "suite.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "sim/random.h"
#include "view/experiment/quest.h"
#include "view/experiment/sequence.h"
#include "view/experiment/staircase.h"
#include "view/made_experiment.h"

static const struct gz_quest_params usual = {
	.from = 0.01,
	.to = 1,
	.start = 0.1,
	.sd = 0.5,
	.beta = 3.5,
	.delta = 0.01,
	.gamma = 0.5,
	.target = 0.82,
};

static void assert_near(const char *what, double value, double expected)
{
	if (!(fabs(value - expected) <= 1e-6 * fabs(expected)))
		fail_msg("%s is %.9g, not %.9g", what, value, expected);
}

struct told {
	double value;
	bool right;
};

/* Next value, mean, ends of the interval and sd. */
static void assert_state(const struct gz_quest *quest, const double expected[5])
{
	const struct gz_quest_estimate estimate = gz_quest_estimate(quest);
	assert_near("next", gz_quest_next(quest), expected[0]);
	assert_near("mean", estimate.threshold, expected[1]);
	assert_near("low", estimate.low, expected[2]);
	assert_near("high", estimate.high, expected[3]);
	assert_near("sd", estimate.sd, expected[4]);
}

/* Expected numbers: a direct sum over densities, not their logarithms, in Python's floats. */
static void posterior_is_that_of_a_direct_sum(void **state)
{
	(void)state;
	static const struct told told[] = { { 0.1, true },  { 0.06, true },   { 0.04, false },
					    { 0.05, true }, { 0.045, false }, { 0.07, true } };
	struct gz_quest quest;
	assert_int_equal(gz_quest_begin(&quest, &usual), GZ_OK);
	assert_state(&quest, (double[]) { 0.1, 0.1, 0.014433373, 0.69283874, 0.44033024 });
	for (size_t i = 0; i < sizeof told / sizeof told[0]; i++)
		gz_quest_take(&quest, told[i].value, told[i].right);
	assert_state(&quest,
		     (double[]) { 0.062373484, 0.09901575, 0.041783665, 0.58242694, 0.29882635 });
	assert_int_equal(quest.trials, 6);
}

static void smaller_values_can_be_the_easier_ones(void **state)
{
	(void)state;
	static const struct told told[] = { { 0.5, false }, { 0.3, true },  { 0.4, false },
					    { 0.35, true }, { 0.38, true }, { 0.42, false } };
	const struct gz_quest_params params = {
		.from = 0.05,
		.to = 4,
		.falling = true,
		.start = 0.8,
		.sd = 0.4,
		.beta = 2,
		.delta = 0.02,
		.gamma = 0.25,
		.target = 0.7,
	};
	struct gz_quest quest;
	assert_int_equal(gz_quest_begin(&quest, &params), GZ_OK);
	for (size_t i = 0; i < sizeof told / sizeof told[0]; i++)
		gz_quest_take(&quest, told[i].value, told[i].right);
	assert_state(&quest,
		     (double[]) { 0.33636759, 0.29520789, 0.11522987, 0.56183377, 0.17354333 });
}

static void share_at_the_threshold_is_the_target(void **state)
{
	(void)state;
	assert_near("at", gz_quest_share(&usual, 0.2, 0.2), 0.82);
	assert_near("far above", gz_quest_share(&usual, 0.2, 200), 0.995);
	assert_near("far below", gz_quest_share(&usual, 0.2, 0.0002), 0.5);
}

/* Observers with a known threshold. Of 95 % intervals of a binomial share of 200 runs, less than 86
 * % would be worse than chance by five of its standard deviations. */
static void interval_holds_the_threshold_of_simulated_observers(void **state)
{
	(void)state;
	enum { OBSERVERS = 200, TRIALS = 60 };
	struct gz_random random = gz_random_seeded(7, 1);
	int held = 0;
	double error = 0, sd = 0;
	for (int i = 0; i < OBSERVERS; i++) {
		const double threshold = 0.1 * pow(10, 0.3 * gz_random_normal(&random));
		struct gz_quest quest;
		assert_int_equal(gz_quest_begin(&quest, &usual), GZ_OK);
		for (int k = 0; k < TRIALS; k++) {
			const double value = gz_quest_next(&quest);
			const double share = gz_quest_share(&usual, threshold, value);
			gz_quest_take(&quest, value, gz_random_uniform(&random) < share);
		}
		const struct gz_quest_estimate found = gz_quest_estimate(&quest);
		held += found.low <= threshold && threshold <= found.high;
		error += log10(found.threshold / threshold) / OBSERVERS;
		sd += found.sd / OBSERVERS;
	}
	if (held < 172 || fabs(error) > 0.03 || sd > 0.1)
		fail_msg("%d of %d intervals hold it; mean error %g, sd %g decades", held,
			 OBSERVERS, error, sd);
}

static void parameters_out_of_range_are_refused(void **state)
{
	(void)state;
	struct gz_quest quest;
	struct gz_quest_params params = usual;
	params.target = 0.5; /* guessing gives as much */
	assert_int_equal(gz_quest_begin(&quest, &params), GZ_ERR_INVAL);
	params.target = 0.995; /* blind answers leave no more */
	assert_int_equal(gz_quest_begin(&quest, &params), GZ_ERR_INVAL);
	params = usual;
	params.from = 0;
	assert_int_equal(gz_quest_begin(&quest, &params), GZ_ERR_INVAL);
	params = usual;
	params.start = 2;
	assert_int_equal(gz_quest_begin(&quest, &params), GZ_ERR_INVAL);
	params = usual;
	params.sd = NAN;
	assert_int_equal(gz_quest_begin(&quest, &params), GZ_ERR_INVAL);
}

#define STAIRS                                                             \
	"[experiment]\nname = n\nscene = s\ncorrect = a\n"                 \
	"staircase = b.foveation.acuity_slope\nstaircase_range = 0.01 1\n" \
	"b.foveation.acuity_slope = 0.3\n[trial x]\n[trial y]\n"

static void staircase_replaces_the_key_of_its_alternative(void **state)
{
	(void)state;
	struct made_experiment made;
	char text[256];
	make_experiment(&made, STAIRS);
	struct gz_condition *condition = &made.experiment.blocks[0].conditions[0];
	gz_alternative_print(&condition->alternatives[1], text, sizeof text);
	assert_string_equal(text, "foveation.acuity_slope=0.1");
	gz_alternative_print(&condition->alternatives[0], text, sizeof text);
	assert_string_equal(text, "");
	gz_staircase_take(condition->staircase, true);
	gz_staircase_place(condition->staircase);
	gz_alternative_print(&condition->alternatives[1], text, sizeof text);
	assert_true(strtod(strchr(text, '=') + 1, NULL) < 0.1);
	/* Each condition has its own. */
	gz_alternative_print(&condition[1].alternatives[1], text, sizeof text);
	assert_string_equal(text, "foveation.acuity_slope=0.1");
	free_experiment(&made);
}

static void finished_staircase_leaves_its_last_trials_out(void **state)
{
	(void)state;
	struct made_experiment made;
	make_experiment(&made, STAIRS "[block b]\nstaircase_stop_sd = 0.25\nrepeats = 50\n"
				      "order = listed\n");
	struct gz_condition *condition = made.experiment.blocks[0].conditions;
	assert_int_equal(gz_sequence_next(&made.sequence, 0), 0);
	for (int i = 0; i < 50 && !gz_staircase_finished(condition[0].staircase); i++) {
		gz_staircase_place(condition[0].staircase);
		gz_staircase_take(condition[0].staircase,
				  strtod(condition[0].staircase->setting.value, NULL) > 0.07);
	}
	assert_in_range(condition[0].staircase->quest.trials, 5, 40);
	assert_int_equal(gz_sequence_next(&made.sequence, 0), 1); /* y goes on */
	assert_int_equal(gz_sequence_next(&made.sequence, 2), 3);
	condition[1].staircase->quest = condition[0].staircase->quest;
	assert_int_equal(gz_sequence_next(&made.sequence, 2), made.sequence.count);
	free_experiment(&made);
}

TEST_SUITE(quest)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(posterior_is_that_of_a_direct_sum),
		cmocka_unit_test(smaller_values_can_be_the_easier_ones),
		cmocka_unit_test(share_at_the_threshold_is_the_target),
		cmocka_unit_test(interval_holds_the_threshold_of_simulated_observers),
		cmocka_unit_test(parameters_out_of_range_are_refused),
		cmocka_unit_test(staircase_replaces_the_key_of_its_alternative),
		cmocka_unit_test(finished_staircase_leaves_its_last_trials_out),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
