/* The file of answers. */
#include "suite.h"

#include <jansson.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/captured_log.h"
#include "base/clock.h"
#include "render/plan/method.h"
#include "view/experiment/answers.h"
#include "view/experiment/participants.h"
#include "view/experiment/staircase.h"
#include "view/made_experiment.h"

static struct captured_log captured;

/* An experiment of four trials and a folder for its answers. */
struct desk {
	struct made_experiment made;
	char folder[64], path[160], json[160], list[160], list_json[160];
	struct gz_answers *answers;
};

static void sit_down(struct desk *desk)
{
	*desk = (struct desk) { .answers = NULL };
	make_experiment(&desk->made, "[experiment]\nname = sharp\nscene = s.scene\ncorrect = a\n"
				     "b.foveation.method = mdc\nb.foveation.mdc_square_px = 200\n"
				     "interval_order = ba\n[trial t]\n[block b]\nrepeats = 4\n");
	desk->made.experiment.blocks[0].conditions[0].alternatives[1].method = GZ_METHOD_MDC;
	snprintf(desk->folder, sizeof desk->folder, "/tmp/gazecast-answers-XXXXXX");
	assert_non_null(mkdtemp(desk->folder));
	snprintf(desk->path, sizeof desk->path, "%s/sub-07_ses-1_task-sharp_events.tsv",
		 desk->folder);
	snprintf(desk->json, sizeof desk->json, "%s/sub-07_ses-1_task-sharp_events.json",
		 desk->folder);
	snprintf(desk->list, sizeof desk->list, "%s/participants.tsv", desk->folder);
	snprintf(desk->list_json, sizeof desk->list_json, "%s/participants.json", desk->folder);
	captured_log_init(&captured, "*:debug");
}

static void get_up(struct desk *desk)
{
	gz_answers_close(&desk->answers);
	unlink(desk->path);
	unlink(desk->json);
	unlink(desk->list);
	unlink(desk->list_json);
	assert_int_equal(rmdir(desk->folder), 0);
	free_experiment(&desk->made);
}

static enum gz_result open_answers_with(struct desk *desk, bool resume, const char *gaze_source)
{
	const struct gz_answers_request request = {
		.place = desk->folder,
		.participant = "07",
		.session = "1",
		.notes = "",
		.resume = resume,
		.version = "1.2",
		.gaze_source = gaze_source,
	};
	return gz_answers_open(&desk->made.experiment, &desk->made.sequence, &request,
			       &captured.log, &desk->answers);
}

static enum gz_result open_answers(struct desk *desk, bool resume)
{
	return open_answers_with(desk, resume, "daemon");
}

static void answer(struct desk *desk, size_t index)
{
	const struct gz_trial_result result = {
		.index = index,
		.presentation = &desk->made.sequence.presentations[index],
		.begin_ns = 5 * GZ_NS_PER_S,
		.on_ns = { 6 * GZ_NS_PER_S, 0 },
		.off_ns = { 8 * GZ_NS_PER_S, 0 },
		.question_ns = 9 * GZ_NS_PER_S,
		.end_ns = 9 * GZ_NS_PER_S + 123456789,
		.answer = 0,
		.chosen = 1,
		.right = 0,
		.frames = 240,
		.dropped = 2,
		.frame_ms = 16.65,
		.gaze_loss = NAN,
	};
	const struct gz_trial_equipment equipment = {
		.tracker = "spectrum",
		.tracker_serial = "TPSP1",
		.backend = "cpu",
		.display = { { 1920, 1080 }, { 527.04F, 296.46F }, 650 },
	};
	assert_int_equal(gz_answers_write(desk->answers, &result, 4 * GZ_NS_PER_S, &equipment),
			 GZ_OK);
}

static char *content_of(const char *path)
{
	static char text[65536];
	FILE *file = fopen(path, "rb");
	assert_non_null(file);
	size_t size = fread(text, 1, sizeof text - 1, file);
	text[size] = '\0';
	fclose(file);
	return text;
}

/* The cell of a column in a row, from 0. */
static void cell_of(const char *path, const char *column, int row, char cell[256])
{
	char *lines = content_of(path), *line = strsep(&lines, "\n");
	int at = 0;
	for (char *name = strsep(&line, "\t"); name && strcmp(name, column) != 0;
	     name = strsep(&line, "\t"))
		at++;
	for (int i = 0; i <= row; i++)
		line = strsep(&lines, "\n");
	assert_non_null(line);
	const char *found = NULL;
	for (int i = 0; i <= at; i++)
		found = strsep(&line, "\t");
	assert_non_null(found);
	snprintf(cell, 256, "%s", found);
}

static void rows_have_what_was_shown_and_answered(void **state)
{
	(void)state;
	static const struct {
		const char *column, *value;
	} expected[] = {
		{ "onset", "1.000000" },
		{ "duration", "4.123457" },
		{ "trial_type", "t" },
		{ "trial", "1" },
		{ "block", "b" },
		{ "practice", "0" },
		{ "repetition", "1" },
		{ "order", "ba" },
		{ "scene_1", "s.scene" },
		{ "method_1", "mdc" },
		{ "settings_1", "foveation.method=mdc foveation.mdc_square_px=200" },
		{ "method_2", "standard" },
		{ "settings_2", "n/a" },
		{ "interval_1_onset", "2.000000" },
		{ "interval_1_duration", "2.000000" },
		{ "interval_2_onset", "n/a" },
		{ "response", "first" },
		{ "response_key", "1" },
		{ "response_time", "0.123457" },
		{ "chosen", "b" },
		{ "chosen_method", "mdc" },
		{ "correct", "0" },
		{ "dropped_frames", "2" },
		{ "median_frame_ms", "16.6" },
		{ "gaze_loss", "n/a" },
		{ "gaze_source", "daemon" },
		{ "tracker", "spectrum TPSP1" },
		{ "display_px", "1920x1080" },
		{ "display_mm", "527.0x296.5" },
		{ "distance_mm", "650.0" },
		{ "backend", "cpu" },
		{ "gazeview", "1.2" },
		{ "gazed", "n/a" },
		{ "participant", "07" },
		{ "session", "1" },
		{ "run", "1" },
		{ "seed", "1" },
		{ "host_ns", "5000000000" },
	};
	struct desk desk;
	char cell[256];
	sit_down(&desk);
	assert_int_equal(open_answers(&desk, false), GZ_OK);
	assert_int_equal(gz_answers_done(desk.answers), 0);
	answer(&desk, 0);
	for (size_t i = 0; i < sizeof expected / sizeof expected[0]; i++) {
		cell_of(desk.path, expected[i].column, 0, cell);
		if (strcmp(cell, expected[i].value) != 0 &&
		    !(strcmp(expected[i].column, "median_frame_ms") == 0 &&
		      strcmp(cell, "16.7") == 0))
			fail_msg("%s is %s, not %s", expected[i].column, cell, expected[i].value);
	}
	get_up(&desk);
}

static void every_column_is_described_beside_the_answers(void **state)
{
	(void)state;
	struct desk desk;
	sit_down(&desk);
	assert_int_equal(open_answers(&desk, false), GZ_OK);
	json_t *root = json_load_file(desk.json, 0, NULL);
	assert_non_null(root);
	char *header = content_of(desk.path), *names = strsep(&header, "\n");
	assert_memory_equal(names, "onset\tduration\t", 15);
	for (char *name = strsep(&names, "\t"); name; name = strsep(&names, "\t")) {
		const json_t *column = json_object_get(root, name);
		if (!json_string_value(json_object_get(column, "Description")))
			fail_msg("%s is not described", name);
	}
	const json_t *levels = json_object_get(json_object_get(root, "order"), "Levels");
	assert_string_equal(json_string_value(json_object_get(levels, "ab")), "a first");
	assert_string_equal(json_string_value(json_object_get(levels, "ba")), "b first");
	assert_string_equal(json_string_value(json_object_get(root, "TaskName")), "sharp");
	json_decref(root);
	get_up(&desk);
}

static void existing_file_is_not_changed(void **state)
{
	(void)state;
	struct desk desk;
	char expected[512];
	sit_down(&desk);
	assert_int_equal(open_answers(&desk, false), GZ_OK);
	answer(&desk, 0);
	gz_answers_close(&desk.answers);
	char *before = strdup(content_of(desk.path));
	assert_non_null(before);
	assert_int_equal(open_answers(&desk, false), GZ_ERR_BUSY);
	snprintf(expected, sizeof expected,
		 "%s: already exists, with 1 of 4 trials; continue it with --resume, or start "
		 "another --session",
		 desk.path);
	assert_string_equal(captured.last, expected);
	assert_string_equal(content_of(desk.path), before);
	free(before);
	get_up(&desk);
}

static void resumed_file_continues_after_its_last_trial(void **state)
{
	(void)state;
	struct desk desk;
	char cell[256];
	sit_down(&desk);
	assert_int_equal(open_answers(&desk, false), GZ_OK);
	answer(&desk, 0);
	answer(&desk, 1);
	gz_answers_close(&desk.answers);
	assert_int_equal(open_answers(&desk, true), GZ_OK);
	assert_int_equal(gz_answers_done(desk.answers), 2);
	answer(&desk, 2);
	cell_of(desk.path, "run", 1, cell);
	assert_string_equal(cell, "1");
	cell_of(desk.path, "run", 2, cell);
	assert_string_equal(cell, "2");
	cell_of(desk.path, "trial", 2, cell);
	assert_string_equal(cell, "3");
	answer(&desk, 3);
	gz_answers_close(&desk.answers);
	assert_int_equal(open_answers(&desk, true), GZ_ERR_BUSY);
	assert_non_null(strstr(captured.last, "all 4 trials are answered"));
	get_up(&desk);
}

static void answers_are_not_continued_with_another_source_of_the_gaze(void **state)
{
	(void)state;
	struct desk desk;
	sit_down(&desk);
	assert_int_equal(open_answers(&desk, false), GZ_OK);
	answer(&desk, 0);
	gz_answers_close(&desk.answers);
	assert_int_equal(open_answers_with(&desk, true, "fixed"), GZ_ERR_FORMAT);
	assert_non_null(strstr(captured.last, ":2: gaze_source is daemon, but this experiment has "
					      "fixed; continue with"));
	assert_int_equal(open_answers(&desk, true), GZ_OK);
	get_up(&desk);
}

#define STAIRS                                                                            \
	"[experiment]\nname = sharp\nscene = s.scene\ncorrect = a\ninterval_order = ba\n" \
	"staircase = b.foveation.acuity_slope\nstaircase_range = 0.01 1\n[trial t]\n"     \
	"[trial u]\n[block b]\nrepeats = 4\n"

/* Answer as a run does. */
static void answer_stairs(struct desk *desk, size_t index, bool right, bool late)
{
	const struct gz_presentation *presentation = &desk->made.sequence.presentations[index];
	const struct gz_trial_result result = {
		.index = index,
		.presentation = presentation,
		.answer = late ? -1 : right,
		.chosen = late ? -1 : !right,
		.right = right,
		.frame_ms = NAN,
		.gaze_loss = NAN,
	};
	const struct gz_trial_equipment equipment = { .backend = "cpu" };
	gz_staircase_place(presentation->condition->staircase);
	if (!late)
		gz_staircase_take(presentation->condition->staircase, right);
	assert_int_equal(gz_answers_write(desk->answers, &result, 0, &equipment), GZ_OK);
}

static void resumed_staircases_go_on_where_they_were(void **state)
{
	(void)state;
	struct desk desk;
	struct gz_quest before[2];
	char cell[256];
	sit_down(&desk);
	free_experiment(&desk.made);
	make_experiment(&desk.made, STAIRS);
	assert_int_equal(open_answers(&desk, false), GZ_OK);
	for (size_t i = 0; i < 6; i++)
		answer_stairs(&desk, i, i != 1 && i != 3, i == 3);
	gz_answers_close(&desk.answers);
	cell_of(desk.path, "staircase_value", 0, cell);
	assert_string_equal(cell, "0.1");
	cell_of(desk.path, "settings_1", 0, cell);
	assert_string_equal(cell, "foveation.acuity_slope=0.1");
	cell_of(desk.path, "response", 3, cell);
	assert_string_equal(cell, "n/a");
	for (size_t i = 0; i < 2; i++)
		before[i] = desk.made.experiment.blocks[0].conditions[i].staircase->quest;
	assert_int_equal(before[0].trials + before[1].trials, 5);
	free_experiment(&desk.made);
	make_experiment(&desk.made, STAIRS);
	assert_int_equal(open_answers(&desk, true), GZ_OK);
	assert_int_equal(gz_answers_next(desk.answers), 6);
	for (size_t i = 0; i < 2; i++)
		assert_memory_equal(&desk.made.experiment.blocks[0].conditions[i].staircase->quest,
				    &before[i], sizeof before[i]);
	get_up(&desk);
}

static void list_file(const struct desk *desk, const char *text)
{
	FILE *file = fopen(desk->list, "w");
	assert_non_null(file);
	fputs(text, file);
	fclose(file);
}

static void first_answer_lists_the_participant(void **state)
{
	(void)state;
	struct desk desk;
	sit_down(&desk);
	assert_int_equal(open_answers(&desk, false), GZ_OK);
	assert_int_not_equal(access(desk.list, F_OK), 0);
	answer(&desk, 0);
	answer(&desk, 1);
	assert_string_equal(content_of(desk.list), "participant_id\tnotes\nsub-07\tn/a\n");
	json_t *json = json_load_file(desk.list_json, 0, NULL);
	assert_non_null(json_object_get(json_object_get(json, "notes"), "Description"));
	json_decref(json);
	get_up(&desk);
}

static void list_of_participants_keeps_what_others_wrote(void **state)
{
	(void)state;
	struct desk desk;
	const struct gz_participant first = { "07", "1", "tired" }, second = { "07", "2", "awake" };
	const struct gz_participant other = { "09", "", "glasses" };
	sit_down(&desk);
	list_file(&desk, "participant_id\tage\nsub-03\t31\nsub-07\t28\n");
	assert_int_equal(gz_participants_list(desk.folder, &first, &captured.log), GZ_OK);
	assert_int_equal(gz_participants_list(desk.folder, &first, &captured.log), GZ_OK);
	assert_int_equal(gz_participants_list(desk.folder, &second, &captured.log), GZ_OK);
	assert_int_equal(gz_participants_list(desk.folder, &other, &captured.log), GZ_OK);
	assert_string_equal(content_of(desk.list),
			    "participant_id\tage\tnotes\nsub-03\t31\tn/a\n"
			    "sub-07\t28\tses-1: tired; ses-2: awake\nsub-09\tn/a\tglasses\n");
	list_file(&desk, "participant_id\tage\nsub-03\n");
	assert_int_equal(gz_participants_list(desk.folder, &other, &captured.log), GZ_ERR_FORMAT);
	assert_non_null(strstr(captured.last, ":2: not as many cells as columns"));
	list_file(&desk, "name\n");
	assert_int_equal(gz_participants_list(desk.folder, &other, &captured.log), GZ_ERR_FORMAT);
	assert_string_equal(content_of(desk.list), "name\n");
	get_up(&desk);
}

static void incomplete_row_is_repeated(void **state)
{
	(void)state;
	struct desk desk;
	sit_down(&desk);
	assert_int_equal(open_answers(&desk, false), GZ_OK);
	answer(&desk, 0);
	answer(&desk, 1);
	gz_answers_close(&desk.answers);
	const size_t size = strlen(content_of(desk.path));
	assert_int_equal(truncate(desk.path, (off_t)size - 5), 0);
	assert_int_equal(open_answers(&desk, true), GZ_OK);
	assert_int_equal(gz_answers_done(desk.answers), 1);
	assert_non_null(strstr(captured.last, "the last row is incomplete; its trial is repeated"));
	answer(&desk, 1);
	gz_answers_close(&desk.answers);
	assert_int_equal(strlen(content_of(desk.path)), size);
	get_up(&desk);
}

static void answers_of_another_order_cannot_be_resumed(void **state)
{
	(void)state;
	struct desk desk;
	sit_down(&desk);
	assert_int_equal(open_answers(&desk, false), GZ_OK);
	answer(&desk, 0);
	gz_answers_close(&desk.answers);
	desk.made.experiment.params.seed = 2;
	assert_int_equal(open_answers(&desk, true), GZ_ERR_FORMAT);
	assert_non_null(strstr(captured.last, ":2: seed is 1, but this experiment has 2; continue "
					      "with the experiment, seed, session and --gaze"));
	desk.made.experiment.params.seed = 1;
	desk.made.experiment.fingerprint++;
	assert_int_equal(open_answers(&desk, true), GZ_ERR_FORMAT);
	assert_non_null(strstr(captured.last, ":2: experiment is "));
	get_up(&desk);
}

static void other_files_are_refused(void **state)
{
	(void)state;
	static const char *const texts[] = { "onset\tduration\n1\t2\n", "\n", "a\tb" };
	struct desk desk;
	sit_down(&desk);
	for (size_t i = 0; i < sizeof texts / sizeof texts[0]; i++) {
		FILE *file = fopen(desk.path, "w");
		fputs(texts[i], file);
		fclose(file);
		assert_int_equal(open_answers(&desk, true), GZ_ERR_FORMAT);
		assert_non_null(
			strstr(captured.last, ":1: the columns differ from those of this version"));
		assert_string_equal(content_of(desk.path), texts[i]);
	}
	get_up(&desk);
}

static void resuming_without_a_file_is_refused(void **state)
{
	(void)state;
	struct desk desk;
	sit_down(&desk);
	assert_int_equal(open_answers(&desk, true), GZ_ERR_NOT_FOUND);
	assert_non_null(strstr(captured.last, "leave out --resume"));
	get_up(&desk);
}

static void file_being_written_is_locked(void **state)
{
	(void)state;
	struct desk desk, other;
	sit_down(&desk);
	assert_int_equal(open_answers(&desk, false), GZ_OK);
	answer(&desk, 0);
	other = desk;
	other.answers = NULL;
	assert_int_equal(open_answers(&other, true), GZ_ERR_BUSY);
	assert_non_null(strstr(captured.last, "another gazeview is writing it"));
	get_up(&desk);
}

static void file_without_a_trial_is_removed(void **state)
{
	(void)state;
	struct desk desk;
	sit_down(&desk);
	assert_int_equal(open_answers(&desk, false), GZ_OK);
	assert_int_equal(access(desk.path, F_OK), 0);
	gz_answers_close(&desk.answers);
	assert_int_not_equal(access(desk.path, F_OK), 0);
	assert_int_not_equal(access(desk.json, F_OK), 0);
	get_up(&desk);
}

static void missing_folder_is_refused(void **state)
{
	(void)state;
	struct desk desk;
	sit_down(&desk);
	const struct gz_answers_request request = { .place = "/nowhere/at/all",
						    .participant = "07",
						    .session = "",
						    .gaze_source = "mouse" };
	assert_int_equal(gz_answers_open(&desk.made.experiment, &desk.made.sequence, &request,
					 &captured.log, &desk.answers),
			 GZ_ERR_IO);
	assert_string_equal(
		captured.last,
		"/nowhere/at/all/sub-07_task-sharp_events.tsv: cannot be created: No such "
		"file or directory; free some space or choose another --answers");
	get_up(&desk);
}

static void labels_are_letters_and_digits(void **state)
{
	(void)state;
	assert_true(gz_answers_label_valid("07") && gz_answers_label_valid("Ann3"));
	assert_false(gz_answers_label_valid("") || gz_answers_label_valid("a/b") ||
		     gz_answers_label_valid("a_b") || gz_answers_label_valid("a b") ||
		     gz_answers_label_valid("0123456789012345678901234567890123456789"));
}

TEST_SUITE(answers)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(rows_have_what_was_shown_and_answered),
		cmocka_unit_test(every_column_is_described_beside_the_answers),
		cmocka_unit_test(existing_file_is_not_changed),
		cmocka_unit_test(resumed_file_continues_after_its_last_trial),
		cmocka_unit_test(answers_are_not_continued_with_another_source_of_the_gaze),
		cmocka_unit_test(resumed_staircases_go_on_where_they_were),
		cmocka_unit_test(first_answer_lists_the_participant),
		cmocka_unit_test(list_of_participants_keeps_what_others_wrote),
		cmocka_unit_test(incomplete_row_is_repeated),
		cmocka_unit_test(answers_of_another_order_cannot_be_resumed),
		cmocka_unit_test(other_files_are_refused),
		cmocka_unit_test(resuming_without_a_file_is_refused),
		cmocka_unit_test(file_being_written_is_locked),
		cmocka_unit_test(file_without_a_trial_is_removed),
		cmocka_unit_test(missing_folder_is_refused),
		cmocka_unit_test(labels_are_letters_and_digits),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
