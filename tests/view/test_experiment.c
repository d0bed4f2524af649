/* An experiment's file: what holds for each trial, and what is refused. */
#include "suite.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/captured_log.h"
#include "render/plan/method.h"
#include "view/experiment/experiment.h"

static struct captured_log captured;

static enum gz_result parse(const char *text, struct gz_experiment *experiment)
{
	captured_log_init(&captured, "*:debug");
	return gz_experiment_parse("/place/e.experiment", text, strlen(text), &captured.log,
				   experiment);
}

static void experiment_without_blocks_has_one_of_all_trials(void **state)
{
	(void)state;
	struct gz_experiment e;
	assert_int_equal(parse("[experiment]\nname = short\nscene = s.scene\n"
			       "[trial one]\n[trial two]\nduration_s = 3\n",
			       &e),
			 GZ_OK);
	assert_int_equal(captured.messages, 0);
	assert_int_equal(e.block_count, 1);
	assert_string_equal(e.blocks[0].label, "main");
	assert_int_equal(e.blocks[0].condition_count, 2);
	const struct gz_condition *two = &e.blocks[0].conditions[1];
	assert_string_equal(two->label, "two");
	assert_string_equal(two->alternatives[1].scene, "/place/s.scene");
	assert_true(two->params.duration_s == 3 && two->params.fixation_s == 1);
	assert_int_equal(two->params.asks, GZ_ASKS_INTERVAL);
	assert_int_equal(two->answer_count, 2);
	assert_int_equal(two->answers[1].key, '2');
	assert_string_equal(two->answers[1].name, "second");
	assert_int_equal(two->correct, -1);
	gz_experiment_free(&e);
}

static const char levels[] =
	"[experiment]\nname = levels\nscene = all.scene\nduration_s = 1\n"
	"a.foveation.method = standard\nfoveation.acuity_slope = 0.01\n"
	"[block one]\ntrials = x\nduration_s = 2\n"
	"[block two]\ntrials = x y\nb.scene = two.scene\nblank_s = 0.25\n"
	"foveation.acuity_slope = 0.02\n"
	"[trial x]\nduration_s = 5\nfoveation.acuity_slope = 0.03\n"
	"[trial y]\nb.foveation.method = mdc\na.foveation.acuity_slope = 0.04\n";

static void trial_overrides_block_and_block_overrides_experiment(void **state)
{
	(void)state;
	struct gz_experiment e;
	assert_int_equal(parse(levels, &e), GZ_OK);
	assert_int_equal(e.block_count, 2);
	assert_int_equal(e.blocks[0].condition_count, 1);
	assert_true(e.blocks[0].conditions[0].params.duration_s == 5);
	const struct gz_condition *y = &e.blocks[1].conditions[1];
	assert_true(y->params.duration_s == 1 && y->params.blank_s == 0.25);
	assert_string_equal(y->alternatives[0].scene, "/place/all.scene");
	assert_string_equal(y->alternatives[1].scene, "/place/two.scene");
	gz_experiment_free(&e);
}

static void scene_keys_reach_their_alternative(void **state)
{
	(void)state;
	struct gz_experiment e;
	char text[256];
	assert_int_equal(parse(levels, &e), GZ_OK);
	const struct gz_condition *x = &e.blocks[1].conditions[0], *y = x + 1;
	gz_alternative_print(&x->alternatives[0], text, sizeof text);
	assert_string_equal(text, "foveation.method=standard foveation.acuity_slope=0.03");
	gz_alternative_print(&x->alternatives[1], text, sizeof text);
	assert_string_equal(text, "foveation.acuity_slope=0.03");
	gz_alternative_print(&y->alternatives[0], text, sizeof text);
	assert_string_equal(text, "foveation.method=standard foveation.acuity_slope=0.04");
	gz_alternative_print(&y->alternatives[1], text, sizeof text);
	assert_string_equal(text, "foveation.acuity_slope=0.02 foveation.method=mdc");
	struct gz_scene_settings settings = { .foveation = { .acuity_slope = 1 } };
	assert_int_equal(gz_alternative_apply(&y->alternatives[1], &settings), GZ_OK);
	assert_int_equal(settings.foveation.method, GZ_METHOD_MDC);
	assert_true(settings.foveation.acuity_slope == 0.02);
	gz_experiment_free(&e);
}

static void star_selects_trials_in_file_order(void **state)
{
	(void)state;
	struct gz_experiment e;
	assert_int_equal(parse("[experiment]\nname = star\nscene = s\n[trial b-1]\n[trial a-1]\n"
			       "[trial b-2]\n[block z]\ntrials = a-1 b-*\nrepeats = 3\n",
			       &e),
			 GZ_OK);
	const struct gz_block *block = &e.blocks[0];
	assert_int_equal(block->condition_count, 3);
	assert_string_equal(block->conditions[0].label, "a-1");
	assert_string_equal(block->conditions[1].label, "b-1");
	assert_string_equal(block->conditions[2].label, "b-2");
	assert_int_equal(block->params.repeats, 3);
	gz_experiment_free(&e);
}

static void one_interval_asks_for_an_answer(void **state)
{
	(void)state;
	struct gz_experiment e;
	assert_int_equal(parse("[experiment]\nname = one\nscene = s\nintervals = 1\n"
			       "keys = left space\nanswers = yes no\ncorrect = no\n"
			       "question = Two\\nlines?\nfeedback = yes\n[trial t]\n",
			       &e),
			 GZ_OK);
	const struct gz_condition *t = &e.blocks[0].conditions[0];
	assert_int_equal(t->params.asks, GZ_ASKS_ANSWER);
	assert_int_equal(t->correct, 1);
	assert_int_equal(t->answers[0].key, GZ_KEY_LEFT);
	assert_int_equal(t->answers[1].key, GZ_KEY_SPACE);
	assert_string_equal(t->answers[1].key_name, "space");
	assert_string_equal(t->params.question, "Two\nlines?");
	gz_experiment_free(&e);
}

#define HEAD "[experiment]\nname = n\nscene = s\n"

static const struct {
	const char *text, *message;
} refused[] = {
	{ "", "/place/e.experiment:1: [experiment] name: missing; use letters and digits" },
	{ "[experiment]\nscene = s\n[trial a]\n",
	  "/place/e.experiment:1: [experiment] name: missing; use letters and digits" },
	{ "[experiment]\nname = a b\n[trial a]\n",
	  "/place/e.experiment:2: [experiment] name: only letters and digits are allowed" },
	{ HEAD, "/place/e.experiment:2: [experiment] name: the file has no [trial NAME]; add one" },
	{ "[experiment]\nname = n\n[trial a]\n",
	  "/place/e.experiment:3: [trial a] scene: missing for a; name a scene file, as in "
	  "scene = shells.scene" },
	{ HEAD "[trials a]\n", "/place/e.experiment:4: [trials a]: unknown section; [experiment], "
			       "[trial NAME] and [block NAME] are allowed" },
	{ HEAD "[trial ]\n", "/place/e.experiment:4: [trial ]: not a name; use letters, digits and "
			     "_ . + -, as in [trial fine]" },
	{ HEAD "[trial a]\n[trial a]\n",
	  "/place/e.experiment:5: [trial a]: already used in line 4; rename one of them" },
	{ HEAD "[trial a]\nduration = 3\n",
	  "/place/e.experiment:5: [trial a] duration: unknown key; did you mean duration_s?" },
	{ HEAD "[trial a]\nduration_s = 0\n",
	  "/place/e.experiment:5: [trial a] duration_s: 0 is outside 0.01 to 3600" },
	{ HEAD "[trial a]\nblank_s = 1\nblank_s = 2\n",
	  "/place/e.experiment:6: [trial a] blank_s: given twice, first in line 5; keep one" },
	{ HEAD "[trial a]\na.blank_s = 1\n",
	  "/place/e.experiment:5: [trial a] a.blank_s: applies to both alternatives; only scene "
	  "and scene keys may have the prefix a. or b." },
	{ HEAD "[trial a]\nvolume.file = x.nii\n",
	  "/place/e.experiment:5: [trial a] volume.file: is allowed in a scene only; use another "
	  "scene, as in scene = other.scene" },
	{ HEAD "[trial a]\nb.foveation.method = sharp\n",
	  "/place/e.experiment:5: [trial a] b.foveation.method: sharp is not standard, mdc, "
	  "ddc, acuity, mdc3, uniform, table or contrast" },
	{ HEAD "[trial a]\nview.overlay = step\n",
	  "/place/e.experiment:5: [trial a] view.overlay: belongs to a window with panels; an "
	  "experiment shows only the picture" },
	{ HEAD "[trial a]\nrepeats = 3\n", "/place/e.experiment:5: [trial a] repeats: unknown key; "
					   "docs/experiments.md lists all keys" },
	{ HEAD "[trial a]\nkeys = 1 escape\n", "/place/e.experiment:5: [trial a] keys: escape is "
					       "not a key; a to z, 0 to 9, left, right, "
					       "up, down, space and return are allowed" },
	{ HEAD "[trial a]\nkeys = 1 1\n",
	  "/place/e.experiment:5: [trial a] keys: 1 is given twice; keep one" },
	{ HEAD "[trial a]\nanswers = yes\n",
	  "/place/e.experiment:5: [trial a] answers: 1 answers for 2 keys; give one for each" },
	{ HEAD "[trial a]\ncorrect = first\n",
	  "/place/e.experiment:5: [trial a] correct: first: a or b is allowed" },
	{ HEAD "[trial a]\nfeedback = yes\n", "/place/e.experiment:5: [trial a] feedback: needs a "
					      "correct answer; set correct as well" },
	{ HEAD "[trial a]\nintervals = 1\nb.foveation.method = mdc\nkeys = y n\n",
	  "/place/e.experiment:5: [trial a] intervals: 1, but line 6 is for a second one; set "
	  "intervals = 2 or remove it" },
	{ HEAD "[trial a]\nintervals = 1\nasks = interval\n",
	  "/place/e.experiment:6: [trial a] asks: interval, but there is only one; set intervals = "
	  "2 or asks = answer" },
	{ HEAD "[trial a]\ncorrect = a\nstaircase = b.foveation.method\n",
	  "/place/e.experiment:6: [trial a] staircase: b.foveation.method is not a scene key of "
	  "one "
	  "number that may have a fraction, as b.foveation.acuity_slope is" },
	{ HEAD "[trial a]\nstaircase = b.foveation.acuity_slope\n",
	  "/place/e.experiment:5: [trial a] staircase: needs a correct answer; set correct as "
	  "well" },
	{ HEAD "correct = a\n[trial a]\nstaircase = b.foveation.acuity_slope\n",
	  "/place/e.experiment:5: [trial a] staircase_range: two numbers above 0 are needed, the "
	  "smaller first" },
	{ HEAD "correct = a\n[trial a]\nstaircase = b.foveation.acuity_slope\n"
	       "staircase_range = 0.1 5000\n",
	  "/place/e.experiment:7: [trial a] staircase_range: foveation.acuity_slope is 0.001 to "
	  "1" },
	{ HEAD "correct = a\nstaircase_range = 0.1 1\n[trial a]\n"
	       "staircase = b.foveation.acuity_slope\nstaircase_start = 0.01\n",
	  "/place/e.experiment:8: [trial a] staircase_start: 0.01 is outside the range" },
	{ HEAD "correct = a\nstaircase_range = 0.1 1\n[trial a]\n"
	       "staircase = b.foveation.acuity_slope\nstaircase_target = 0.5\n",
	  "/place/e.experiment:8: [trial a] staircase_target: 0.5 cannot be a threshold; it lies "
	  "between what guessing gives (staircase_gamma) and what blind answers leave "
	  "(staircase_delta)" },
	{ HEAD "correct = a\nstaircase_range = 0.1 1\n[trial a]\n"
	       "staircase = b.foveation.acuity_slope\nstaircase_stop_sd = 0.6\n",
	  "/place/e.experiment:8: [trial a] staircase_stop_sd: reached before the first trial; it "
	  "must be less than staircase_sd" },
	{ HEAD "[trial a]\n[block b]\ntrials = a c\n",
	  "/place/e.experiment:6: [block b] trials: no [trial c]; correct the name" },
	{ HEAD "[trial a]\n[trial c]\n[block b]\nrepeats = 1000\n[block d]\nrepeats = 1000\n"
	       "[block e]\nrepeats = 1000\n[block f]\nrepeats = 1000\n[block g]\nrepeats = 1000\n"
	       "[block h]\n",
	  "/place/e.experiment:16: [block h] repeats: more than 10000 trials in total; reduce "
	  "them" },
	{ HEAD "instructions = x\ninstructions_file = y\n[trial a]\n",
	  "/place/e.experiment:5: [experiment] instructions_file: given together with "
	  "instructions; keep one" },
	{ HEAD "instructions_file = nowhere.txt\n[trial a]\n",
	  "/place/e.experiment:4: instructions_file: /place/nowhere.txt cannot be opened: No such "
	  "file or directory" },
};

static void invalid_experiments_are_refused_with_their_line(void **state)
{
	(void)state;
	for (size_t i = 0; i < sizeof refused / sizeof refused[0]; i++) {
		struct gz_experiment e;
		assert_int_not_equal(parse(refused[i].text, &e), GZ_OK);
		assert_string_equal(captured.last, refused[i].message);
		assert_int_equal(captured.messages, 1);
	}
}

/* A folder with an experiment, a scene and a text. */
struct place {
	char folder[64], path[128];
};

static void write_file(const struct place *place, const char *name, const char *text)
{
	char path[128];
	snprintf(path, sizeof path, "%s/%s", place->folder, name);
	FILE *file = fopen(path, "w");
	assert_non_null(file);
	fputs(text, file);
	fclose(file);
}

static void make_place(struct place *place)
{
	snprintf(place->folder, sizeof place->folder, "/tmp/gazecast-experiment-XXXXXX");
	assert_non_null(mkdtemp(place->folder));
	snprintf(place->path, sizeof place->path, "%s/e.experiment", place->folder);
	write_file(place, "s.scene",
		   "[volume]\nprocedural = shells\n[transfer]\nfile = s.tf\n"
		   "[foveation]\nmethod = ddc\n");
	write_file(place, "s.tf", "0 0 0 0 0\n1 1 1 1 1\n");
	write_file(place, "intro.txt", "Look here.\nThen answer.\n");
	captured_log_init(&captured, "*:debug");
}

static void remove_place(const struct place *place)
{
	static const char *const names[] = { "e.experiment", "s.scene", "s.tf", "intro.txt" };
	for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
		char path[128];
		snprintf(path, sizeof path, "%s/%s", place->folder, names[i]);
		unlink(path);
	}
	assert_int_equal(rmdir(place->folder), 0);
}

static void check_sets_methods_and_texts_are_read(void **state)
{
	(void)state;
	struct place place;
	struct gz_experiment e;
	make_place(&place);
	write_file(&place, "e.experiment",
		   "[experiment]\nname = n\nscene = s.scene\ninstructions_file = intro.txt\n"
		   "[trial t]\nb.foveation.method = acuity\n");
	assert_int_equal(gz_experiment_load(place.path, &captured.log, &e), GZ_OK);
	assert_string_equal(e.instructions, "Look here.\nThen answer.\n");
	assert_int_equal(gz_experiment_check(&e, &captured.log), GZ_OK);
	assert_int_equal(e.blocks[0].conditions[0].alternatives[0].method, GZ_METHOD_DDC);
	assert_int_equal(e.blocks[0].conditions[0].alternatives[1].method, GZ_METHOD_ACUITY);
	gz_experiment_free(&e);
	remove_place(&place);
}

static void refuse_check(const char *trial, enum gz_result result, const char *what)
{
	struct place place;
	struct gz_experiment e;
	char text[512];
	make_place(&place);
	snprintf(text, sizeof text, "[experiment]\nname = n\nscene = s.scene\n[trial t]\n%s",
		 trial);
	write_file(&place, "e.experiment", text);
	assert_int_equal(gz_experiment_load(place.path, &captured.log, &e), GZ_OK);
	assert_int_equal(gz_experiment_check(&e, &captured.log), result);
	if (!strstr(captured.last, what))
		fail_msg("%s does not say %s", captured.last, what);
	gz_experiment_free(&e);
	remove_place(&place);
}

static void missing_scenes_and_tables_are_refused(void **state)
{
	(void)state;
	refuse_check("b.scene = other.scene\n", GZ_ERR_NOT_FOUND,
		     "e.experiment:4: [trial t] b: no scene ");
	refuse_check("foveation.method = table\n", GZ_ERR_FORMAT, "e.experiment:5: [trial t] a: ");
	refuse_check("a.camera.eye = 0 0 0\n", GZ_ERR_FORMAT, "e.experiment:5: [trial t] a: ");
	refuse_check("b.foveation.method = table\nb.foveation.table = none.txt\n", GZ_ERR_NOT_FOUND,
		     "e.experiment:6: [trial t] b: ");
}

static void text_files_change_the_fingerprint(void **state)
{
	(void)state;
	struct place place;
	struct gz_experiment e;
	make_place(&place);
	write_file(&place, "e.experiment",
		   "[experiment]\nname = n\nscene = s.scene\ninstructions_file = intro.txt\n"
		   "[trial t]\n");
	assert_int_equal(gz_experiment_load(place.path, &captured.log, &e), GZ_OK);
	const uint64_t before = e.fingerprint;
	gz_experiment_free(&e);
	assert_int_equal(gz_experiment_load(place.path, &captured.log, &e), GZ_OK);
	assert_true(e.fingerprint == before);
	gz_experiment_free(&e);
	write_file(&place, "intro.txt", "Look there.\n");
	assert_int_equal(gz_experiment_load(place.path, &captured.log, &e), GZ_OK);
	assert_true(e.fingerprint != before);
	gz_experiment_free(&e);
	remove_place(&place);
}

TEST_SUITE(experiment)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(experiment_without_blocks_has_one_of_all_trials),
		cmocka_unit_test(trial_overrides_block_and_block_overrides_experiment),
		cmocka_unit_test(scene_keys_reach_their_alternative),
		cmocka_unit_test(star_selects_trials_in_file_order),
		cmocka_unit_test(one_interval_asks_for_an_answer),
		cmocka_unit_test(invalid_experiments_are_refused_with_their_line),
		cmocka_unit_test(check_sets_methods_and_texts_are_read),
		cmocka_unit_test(missing_scenes_and_tables_are_refused),
		cmocka_unit_test(text_files_change_the_fingerprint),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
