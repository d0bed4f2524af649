/* A run of an experiment, with a clock set by the test. */
#include "suite.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/clock.h"
#include "view/experiment/experiment.h"
#include "view/experiment/run.h"
#include "view/made_experiment.h"

/* A display of 100 Hz: a frame is shown every 10 ms. */
#define REFRESH_NS (10 * GZ_NS_PER_MS)

/* A run and the sink of its events. */
struct stage {
	struct made_experiment made;
	struct gz_run run;
	int64_t now_ns;
	bool not_ready, no_gaze;
	char marks[4096];
	int results;
	struct gz_trial_result last;
	enum gz_result answer; /* of the sink */
};

static void take_mark(void *user, const char *label, int64_t time_ns)
{
	struct stage *stage = user;
	size_t used = strlen(stage->marks);
	snprintf(stage->marks + used, sizeof stage->marks - used, "%lld %s\n",
		 (long long)(time_ns / GZ_NS_PER_MS), label);
}

static enum gz_result take_result(void *user, const struct gz_trial_result *result)
{
	struct stage *stage = user;
	stage->results++;
	stage->last = *result;
	return stage->answer;
}

static void begin_at(struct stage *stage, const char *text, size_t first)
{
	*stage = (struct stage) { .now_ns = 1000 * GZ_NS_PER_MS };
	make_experiment(&stage->made, text);
	const struct gz_run_start start = {
		.experiment = &stage->made.experiment,
		.sequence = &stage->made.sequence,
		.participant = "07",
		.session = "1",
		.first = first,
		.sink = { stage, take_mark, take_result },
	};
	gz_run_begin(&stage->run, &start);
}

static void begin(struct stage *stage, const char *text)
{
	begin_at(stage, text, 0);
}

static void end(struct stage *stage)
{
	free_experiment(&stage->made);
}

/* One frame: a step, then the swap. */
static void frame(struct stage *stage)
{
	const struct gz_run_input input = {
		.now_ns = stage->now_ns,
		.refresh_ns = REFRESH_NS,
		.ready = !stage->not_ready,
		.gaze_there = !stage->no_gaze,
	};
	gz_run_step(&stage->run, &input);
	gz_run_shown(&stage->run, stage->now_ns);
	gz_run_frame(&stage->run,
		     &(struct gz_run_frame) { stage->now_ns, REFRESH_NS, true, !stage->no_gaze });
	stage->now_ns += REFRESH_NS;
}

static void frames(struct stage *stage, int count)
{
	for (int i = 0; i < count; i++)
		frame(stage);
}

/* Frames until the screen changes, with a limit. */
static enum gz_run_phase next_phase(struct stage *stage)
{
	const enum gz_run_phase before = stage->run.phase;
	const int interval = stage->run.interval;
	for (int i = 0; i < 1000; i++) {
		frame(stage);
		if (stage->run.phase != before || stage->run.interval != interval)
			break;
	}
	return stage->run.phase;
}

static void press(struct stage *stage, int key)
{
	gz_run_key(&stage->run, key, stage->now_ns);
}

/* Run a trial up to its question. */
static void watch(struct stage *stage)
{
	for (int i = 0; i < 10 && stage->run.phase != GZ_RUN_QUESTION; i++)
		next_phase(stage);
	assert_int_equal(stage->run.phase, GZ_RUN_QUESTION);
}

#define ONE                                                                         \
	"[experiment]\nname = one\nscene = s\nfixation_s = 0.1\nduration_s = 0.2\n" \
	"blank_s = 0.05\npause_s = 0.03\ninterval_order = ba\ncorrect = a\n"

static void trial_goes_from_cross_to_answer_with_marks_at_each_step(void **state)
{
	(void)state;
	struct stage stage;
	begin(&stage, ONE "b.foveation.method = mdc\n[trial t]\n");
	assert_int_equal(stage.run.phase, GZ_RUN_PREPARE);
	frame(&stage);
	assert_int_equal(stage.run.phase, GZ_RUN_FIXATION);
	assert_int_equal(next_phase(&stage), GZ_RUN_INTERVAL);
	struct gz_run_screen screen;
	gz_run_screen(&stage.run, &screen);
	assert_ptr_equal(screen.alternative,
			 &stage.made.experiment.blocks[0].conditions[0].alternatives[1]);
	assert_int_equal(next_phase(&stage), GZ_RUN_BLANK);
	gz_run_screen(&stage.run, &screen);
	assert_null(screen.alternative);
	assert_int_equal(next_phase(&stage), GZ_RUN_INTERVAL);
	gz_run_screen(&stage.run, &screen);
	assert_ptr_equal(screen.alternative,
			 &stage.made.experiment.blocks[0].conditions[0].alternatives[0]);
	assert_int_equal(next_phase(&stage), GZ_RUN_QUESTION);
	frames(&stage, 30);
	press(&stage, '2');
	assert_int_equal(stage.run.phase, GZ_RUN_PAUSE);
	assert_int_equal(next_phase(&stage), GZ_RUN_TEXT);
	press(&stage, GZ_KEY_SPACE);
	assert_int_equal(stage.run.phase, GZ_RUN_ENDED);
	assert_int_equal(stage.run.result, GZ_OK);
	assert_string_equal(stage.marks,
			    "1000 experiment one begins participant 07 session 1 seed 1\n"
			    "1000 trial 1 begins block main trial t order ba\n"
			    "1100 trial 1 interval 1 on b standard\n"
			    "1300 trial 1 interval 1 off\n"
			    "1350 trial 1 interval 2 on a standard\n"
			    "1550 trial 1 interval 2 off\n"
			    "1550 trial 1 question\n"
			    "1860 trial 1 answer second chosen a\n"
			    "1890 experiment one ends\n");
	end(&stage);
}

static void result_has_times_answer_and_correctness(void **state)
{
	(void)state;
	struct stage stage;
	begin(&stage, ONE "[trial t]\n");
	watch(&stage);
	frames(&stage, 30);
	press(&stage, '1');
	assert_int_equal(stage.results, 1);
	const struct gz_trial_result *r = &stage.last;
	assert_int_equal(r->answer, 0);
	assert_int_equal(r->chosen, 1); /* b came first */
	assert_int_equal(r->right, 0);
	assert_int_equal(r->on_ns[0] - r->begin_ns, 100 * GZ_NS_PER_MS);
	assert_int_equal(r->off_ns[0] - r->on_ns[0], 200 * GZ_NS_PER_MS);
	assert_int_equal(r->on_ns[1] - r->off_ns[0], 50 * GZ_NS_PER_MS);
	assert_int_equal(r->off_ns[1] - r->on_ns[1], 200 * GZ_NS_PER_MS);
	assert_int_equal(r->question_ns, r->off_ns[1]);
	assert_int_equal(r->end_ns - r->question_ns, 310 * GZ_NS_PER_MS);
	assert_int_equal(r->restarts, 0);
	end(&stage);
}

static void keys_count_only_while_the_question_is_shown(void **state)
{
	(void)state;
	struct stage stage;
	begin(&stage, ONE "[trial t]\n");
	frames(&stage, 15);
	assert_int_equal(stage.run.phase, GZ_RUN_INTERVAL);
	press(&stage, '1');
	watch(&stage);
	press(&stage, 'x');
	press(&stage, GZ_KEY_SPACE);
	assert_int_equal(stage.results, 0);
	stage.run.shown_ns = 0; /* due, but not swapped */
	press(&stage, '1');
	assert_int_equal(stage.results, 0);
	frame(&stage);
	press(&stage, '1');
	assert_int_equal(stage.results, 1);
	end(&stage);
}

static void trial_waits_for_its_pictures(void **state)
{
	(void)state;
	struct stage stage;
	begin(&stage, ONE "[trial t]\n");
	stage.not_ready = true;
	frames(&stage, 50);
	assert_int_equal(stage.run.phase, GZ_RUN_PREPARE);
	assert_string_equal(stage.marks, "");
	stage.not_ready = false;
	frame(&stage);
	assert_int_equal(stage.run.phase, GZ_RUN_FIXATION);
	end(&stage);
}

static void wait_for_an_answer_times_out(void **state)
{
	(void)state;
	struct stage stage;
	begin(&stage, ONE "timeout_s = 0.5\nfeedback = yes\n[trial t]\n");
	watch(&stage);
	assert_int_equal(next_phase(&stage), GZ_RUN_FEEDBACK);
	struct gz_run_screen screen;
	gz_run_screen(&stage.run, &screen);
	assert_string_equal(screen.text, "Too late");
	assert_int_equal(stage.last.answer, -1);
	assert_int_equal(stage.last.chosen, -1);
	assert_int_equal(stage.last.right, 0);
	assert_int_equal(stage.last.end_ns - stage.last.question_ns, 500 * GZ_NS_PER_MS);
	assert_non_null(strstr(stage.marks, "trial 1 no answer\n"));
	end(&stage);
}

static void feedback_says_whether_the_answer_was_correct(void **state)
{
	(void)state;
	struct stage stage;
	struct gz_run_screen screen;
	for (int right = 0; right < 2; right++) {
		begin(&stage, ONE "feedback = yes\nfeedback_s = 0.4\n[trial t]\n");
		watch(&stage);
		press(&stage, right ? '2' : '1');
		assert_int_equal(stage.run.phase, GZ_RUN_FEEDBACK);
		gz_run_screen(&stage.run, &screen);
		assert_string_equal(screen.text, right ? "Correct" : "Wrong");
		const int64_t from_ns = stage.now_ns;
		assert_int_equal(next_phase(&stage), GZ_RUN_PAUSE);
		assert_true(stage.now_ns - from_ns >= 400 * GZ_NS_PER_MS);
		end(&stage);
	}
}

static void texts_come_in_order_and_wait_for_space(void **state)
{
	(void)state;
	static const char *const expected[] = { "Hello", "Block", "Rest", "Bye" };
	struct stage stage;
	struct gz_run_screen screen;
	size_t page = 0;
	begin(&stage,
	      ONE "instructions = Hello\ngoodbye = Bye\n[trial t]\n[block b]\n"
		  "instructions = Block\nrepeats = 3\nbreak_every = 2\nbreak_text = Rest\n");
	for (int i = 0; i < 60 && stage.run.phase != GZ_RUN_ENDED; i++) {
		gz_run_screen(&stage.run, &screen);
		if (screen.phase == GZ_RUN_QUESTION) {
			press(&stage, '1');
		} else if (screen.phase == GZ_RUN_TEXT) {
			assert_true(page < 4);
			assert_string_equal(screen.text, expected[page]);
			assert_int_equal(screen.done, page < 2 ? 0 : page);
			page++;
			frames(&stage, 20);
			assert_int_equal(stage.run.phase, GZ_RUN_TEXT);
			press(&stage, '1');
			assert_int_equal(stage.run.phase, GZ_RUN_TEXT);
			press(&stage, GZ_KEY_SPACE);
			continue;
		}
		next_phase(&stage);
	}
	assert_int_equal(page, 4);
	assert_int_equal(stage.results, 3);
	end(&stage);
}

static void escape_asks_and_space_restarts_the_trial(void **state)
{
	(void)state;
	struct stage stage;
	struct gz_run_screen screen;
	begin(&stage, ONE "[trial t]\n");
	frames(&stage, 15);
	assert_int_equal(stage.run.phase, GZ_RUN_INTERVAL);
	press(&stage, GZ_KEY_ESCAPE);
	assert_int_equal(stage.run.phase, GZ_RUN_LEAVING);
	gz_run_screen(&stage.run, &screen);
	assert_non_null(screen.text);
	frames(&stage, 100);
	press(&stage, '1');
	assert_int_equal(stage.run.phase, GZ_RUN_LEAVING);
	press(&stage, GZ_KEY_SPACE);
	assert_int_equal(stage.run.phase, GZ_RUN_PREPARE);
	watch(&stage);
	frame(&stage);
	press(&stage, '1');
	assert_int_equal(stage.results, 1);
	assert_int_equal(stage.last.restarts, 1);
	assert_int_equal(stage.last.off_ns[0] - stage.last.on_ns[0], 200 * GZ_NS_PER_MS);
	assert_non_null(strstr(stage.marks, "trial 1 interrupted\n"));
	end(&stage);
}

static void second_escape_leaves(void **state)
{
	(void)state;
	struct stage stage;
	begin(&stage, ONE "[trial t]\n");
	watch(&stage);
	press(&stage, GZ_KEY_ESCAPE);
	press(&stage, GZ_KEY_ESCAPE);
	assert_int_equal(stage.run.phase, GZ_RUN_ENDED);
	assert_int_equal(stage.run.result, GZ_ERR_CANCELLED);
	assert_non_null(strstr(stage.marks, "experiment one left\n"));
	press(&stage, '1');
	frames(&stage, 10);
	assert_int_equal(stage.results, 0);
	assert_int_equal(stage.run.phase, GZ_RUN_ENDED);
	end(&stage);
}

static void answered_trial_is_not_repeated_after_escape(void **state)
{
	(void)state;
	struct stage stage;
	begin(&stage, ONE "[trial t]\n[block b]\nrepeats = 2\n");
	watch(&stage);
	frame(&stage);
	press(&stage, '1');
	assert_int_equal(stage.run.phase, GZ_RUN_PAUSE);
	press(&stage, GZ_KEY_ESCAPE);
	press(&stage, GZ_KEY_SPACE);
	assert_int_equal(stage.run.index, 1);
	watch(&stage);
	frame(&stage);
	press(&stage, '1');
	assert_int_equal(stage.results, 2);
	assert_int_equal(stage.last.index, 1);
	end(&stage);
}

static void resumed_run_starts_at_the_first_unanswered_trial(void **state)
{
	(void)state;
	struct stage stage;
	struct gz_run_screen screen;
	begin_at(&stage,
		 ONE "[trial t]\n[block b]\ninstructions = Block\nrepeats = 4\nbreak_every = 2\n",
		 2);
	gz_run_screen(&stage.run, &screen);
	assert_string_equal(screen.text, "Block");
	frame(&stage);
	press(&stage, GZ_KEY_SPACE);
	watch(&stage);
	frame(&stage);
	press(&stage, '1');
	assert_int_equal(stage.last.index, 2);
	assert_non_null(strstr(stage.marks, "trial 3 answer"));
	end(&stage);
}

static void dropped_frames_and_lost_gaze_are_counted_in_intervals_only(void **state)
{
	(void)state;
	struct stage stage;
	begin(&stage, ONE "[trial t]\n");
	while (stage.run.phase != GZ_RUN_INTERVAL)
		frame(&stage);
	frames(&stage, 5);
	stage.now_ns += 3 * REFRESH_NS; /* three refreshes without a frame */
	frames(&stage, 2);
	stage.no_gaze = true;
	frames(&stage, 5);
	stage.no_gaze = false;
	watch(&stage);
	stage.now_ns += 10 * REFRESH_NS;
	frame(&stage);
	press(&stage, '1');
	assert_int_equal(stage.last.dropped, 3);
	/* Of two intervals of 20 refreshes, the gaps between their frames. */
	assert_int_equal(stage.last.frames, 19 - 3 + 19);
	if (fabs(stage.last.frame_ms - 10.05) > 1e-9)
		fail_msg("median %g, not 10.05", stage.last.frame_ms);
	if (fabs(stage.last.gaze_loss - 5.0 / 38) > 1e-9)
		fail_msg("loss %g, not %g", stage.last.gaze_loss, 5.0 / 38);
	end(&stage);
}

static void required_gaze_extends_the_cross(void **state)
{
	(void)state;
	struct stage stage;
	struct gz_run_screen screen;
	begin(&stage, ONE "gaze = required\n[trial t]\n");
	stage.no_gaze = true;
	frames(&stage, 60);
	assert_int_equal(stage.run.phase, GZ_RUN_FIXATION);
	gz_run_screen(&stage.run, &screen);
	assert_false(screen.gaze_missing);
	frames(&stage, 100);
	gz_run_screen(&stage.run, &screen);
	assert_true(screen.gaze_missing);
	stage.no_gaze = false;
	frame(&stage);
	assert_int_equal(stage.run.phase, GZ_RUN_INTERVAL);
	end(&stage);
}

static void trial_starts_again_after_too_long_without_required_gaze(void **state)
{
	(void)state;
	struct stage stage;
	struct gz_run_screen screen;
	begin(&stage, ONE "gaze = required\ngaze_lost_s = 0.1\n[trial t]\n");
	while (stage.run.phase != GZ_RUN_INTERVAL)
		frame(&stage);
	stage.no_gaze = true;
	frames(&stage, 5); /* a blink */
	assert_int_equal(stage.run.phase, GZ_RUN_INTERVAL);
	stage.no_gaze = false;
	frame(&stage);
	stage.no_gaze = true;
	assert_int_equal(next_phase(&stage), GZ_RUN_PREPARE);
	assert_non_null(strstr(stage.marks, "trial 1 interrupted without gaze"));
	frames(&stage, 160);
	gz_run_screen(&stage.run, &screen);
	assert_int_equal(screen.phase, GZ_RUN_FIXATION);
	assert_true(screen.gaze_missing);
	stage.no_gaze = false;
	watch(&stage);
	press(&stage, '1');
	assert_int_equal(stage.last.restarts, 1);
	assert_true(stage.last.gaze_loss == 0);
	end(&stage);
}

static void optional_gaze_may_be_missing(void **state)
{
	(void)state;
	struct stage stage;
	begin(&stage, ONE "gaze_lost_s = 0.1\n[trial t]\n");
	stage.no_gaze = true;
	watch(&stage);
	assert_int_equal(stage.run.trial.restarts, 0);
	end(&stage);
}

static void phases_of_zero_length_are_skipped(void **state)
{
	(void)state;
	struct stage stage;
	begin(&stage, "[experiment]\nname = one\nscene = s\nfixation_s = 0\nduration_s = 0.1\n"
		      "blank_s = 0\npause_s = 0\ngoodbye =\n[trial t]\n");
	frame(&stage);
	assert_int_equal(stage.run.phase, GZ_RUN_INTERVAL);
	assert_int_equal(next_phase(&stage), GZ_RUN_INTERVAL);
	assert_int_equal(stage.run.interval, 1);
	assert_int_equal(stage.run.trial.off_ns[0], stage.run.trial.on_ns[1]);
	assert_int_equal(next_phase(&stage), GZ_RUN_QUESTION);
	press(&stage, '1');
	frame(&stage);
	assert_int_equal(stage.run.phase, GZ_RUN_ENDED);
	assert_int_equal(stage.results, 1);
	end(&stage);
}

static void answer_that_cannot_be_stored_ends_the_run(void **state)
{
	(void)state;
	struct stage stage;
	begin(&stage, ONE "[trial t]\n[block b]\nrepeats = 2\n");
	stage.answer = GZ_ERR_IO;
	watch(&stage);
	frame(&stage);
	press(&stage, '1');
	assert_int_equal(stage.run.phase, GZ_RUN_ENDED);
	assert_int_equal(stage.run.result, GZ_ERR_IO);
	end(&stage);
}

TEST_SUITE(run)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(trial_goes_from_cross_to_answer_with_marks_at_each_step),
		cmocka_unit_test(result_has_times_answer_and_correctness),
		cmocka_unit_test(keys_count_only_while_the_question_is_shown),
		cmocka_unit_test(trial_waits_for_its_pictures),
		cmocka_unit_test(wait_for_an_answer_times_out),
		cmocka_unit_test(feedback_says_whether_the_answer_was_correct),
		cmocka_unit_test(texts_come_in_order_and_wait_for_space),
		cmocka_unit_test(escape_asks_and_space_restarts_the_trial),
		cmocka_unit_test(second_escape_leaves),
		cmocka_unit_test(answered_trial_is_not_repeated_after_escape),
		cmocka_unit_test(resumed_run_starts_at_the_first_unanswered_trial),
		cmocka_unit_test(dropped_frames_and_lost_gaze_are_counted_in_intervals_only),
		cmocka_unit_test(required_gaze_extends_the_cross),
		cmocka_unit_test(trial_starts_again_after_too_long_without_required_gaze),
		cmocka_unit_test(optional_gaze_may_be_missing),
		cmocka_unit_test(phases_of_zero_length_are_skipped),
		cmocka_unit_test(answer_that_cannot_be_stored_ends_the_run),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
