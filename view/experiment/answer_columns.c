/* The columns of a file of answers, as text and as the JSON file that describes them. */
#include "view/experiment/experiment_internal.h"

#include <inttypes.h>
#include <jansson.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/utsname.h>

#include "base/clock.h"
#include "render/plan/method.h"
#include "view/experiment/staircase.h"

static const struct gz_condition *condition_of(const struct gz_answer_row *row)
{
	return row->result->presentation->condition;
}

/* The alternative shown in an interval; NULL: the trial has no such interval. */
static const struct gz_alternative *shown_in(const struct gz_answer_row *row, int interval)
{
	const struct gz_condition *condition = condition_of(row);
	if (interval >= condition->params.intervals)
		return NULL;
	return &condition->alternatives[gz_presentation_alternative(row->result->presentation,
								    interval)];
}

static void print_none(char *text, size_t size)
{
	snprintf(text, size, "n/a");
}

static void print_span(int64_t from_ns, int64_t to_ns, char *text, size_t size)
{
	if (from_ns && to_ns)
		snprintf(text, size, "%.6f", gz_ns_to_s(to_ns - from_ns));
	else
		print_none(text, size);
}

static void print_text_cell(const char *value, char *text, size_t size)
{
	snprintf(text, size, "%s", value && value[0] ? value : "n/a");
}

static void print_number_cell(double value, const char *format, char *text, size_t size)
{
	if (isnan(value))
		print_none(text, size);
	else
		snprintf(text, size, strcmp(format, "%.1f") == 0 ? "%.1f" : "%.4f", value);
}

#define PRINTER(name) static void name(const struct gz_answer_row *row, char *text, size_t size)

PRINTER(print_onset)
{
	print_span(row->start_ns, row->result->begin_ns, text, size);
}

PRINTER(print_duration)
{
	print_span(row->result->begin_ns, row->result->end_ns, text, size);
}

PRINTER(print_type)
{
	print_text_cell(condition_of(row)->label, text, size);
}

PRINTER(print_trial)
{
	snprintf(text, size, "%zu", row->result->index + 1);
}

PRINTER(print_block)
{
	print_text_cell(row->result->presentation->block->label, text, size);
}

PRINTER(print_practice)
{
	snprintf(text, size, "%d", row->result->presentation->block->params.practice);
}

PRINTER(print_repetition)
{
	snprintf(text, size, "%d", row->result->presentation->repetition);
}

PRINTER(print_order)
{
	const struct gz_presentation *presentation = row->result->presentation;
	print_text_cell(presentation->condition->params.intervals == 1 ? "a"
			: presentation->swapped                        ? "ba"
								       : "ab",
			text, size);
}

static void print_scene(const struct gz_alternative *alternative, char *text, size_t size)
{
	const char *slash = alternative ? strrchr(alternative->scene, '/') : NULL;
	print_text_cell(slash ? slash + 1 : alternative ? alternative->scene : NULL, text, size);
}

PRINTER(print_scene_1)
{
	print_scene(shown_in(row, 0), text, size);
}

PRINTER(print_scene_2)
{
	print_scene(shown_in(row, 1), text, size);
}

static void print_method(const struct gz_alternative *alternative, char *text, size_t size)
{
	print_text_cell(alternative ? gz_method_names[alternative->method] : NULL, text, size);
}

PRINTER(print_method_1)
{
	print_method(shown_in(row, 0), text, size);
}

PRINTER(print_method_2)
{
	print_method(shown_in(row, 1), text, size);
}

static void print_settings(const struct gz_alternative *alternative, char *text, size_t size)
{
	if (alternative && alternative->setting_count > 0)
		gz_alternative_print(alternative, text, size);
	else
		print_none(text, size);
}

PRINTER(print_settings_1)
{
	print_settings(shown_in(row, 0), text, size);
}

PRINTER(print_settings_2)
{
	print_settings(shown_in(row, 1), text, size);
}

PRINTER(print_onset_1)
{
	print_span(row->start_ns, row->result->on_ns[0], text, size);
}

PRINTER(print_duration_1)
{
	print_span(row->result->on_ns[0], row->result->off_ns[0], text, size);
}

PRINTER(print_onset_2)
{
	print_span(row->start_ns, row->result->on_ns[1], text, size);
}

PRINTER(print_duration_2)
{
	print_span(row->result->on_ns[1], row->result->off_ns[1], text, size);
}

PRINTER(print_question)
{
	print_span(row->start_ns, row->result->question_ns, text, size);
}

static const struct gz_answer *answer_of(const struct gz_answer_row *row)
{
	return row->result->answer < 0 ? NULL : &condition_of(row)->answers[row->result->answer];
}

PRINTER(print_response)
{
	const struct gz_answer *answer = answer_of(row);
	print_text_cell(answer ? answer->name : NULL, text, size);
}

PRINTER(print_key)
{
	const struct gz_answer *answer = answer_of(row);
	print_text_cell(answer ? answer->key_name : NULL, text, size);
}

PRINTER(print_by)
{
	print_text_cell(!answer_of(row)         ? NULL
			: row->result->by_mouse ? "mouse"
						: "key",
			text, size);
}

PRINTER(print_chosen)
{
	int chosen = row->result->chosen;
	print_text_cell(chosen < 0 ? NULL : chosen == 0 ? "a" : "b", text, size);
}

PRINTER(print_chosen_method)
{
	int chosen = row->result->chosen;
	print_method(chosen < 0 ? NULL : &condition_of(row)->alternatives[chosen], text, size);
}

PRINTER(print_correct)
{
	int right = row->result->right;
	print_text_cell(right < 0 ? NULL : right ? "1" : "0", text, size);
}

PRINTER(print_response_time)
{
	const struct gz_trial_result *result = row->result;
	print_span(result->question_ns, result->answer < 0 ? 0 : result->end_ns, text, size);
}

PRINTER(print_staircase)
{
	const struct gz_staircase *staircase = condition_of(row)->staircase;
	print_text_cell(staircase ? staircase->setting.key : NULL, text, size);
}

PRINTER(print_staircase_value)
{
	const struct gz_staircase *staircase = condition_of(row)->staircase;
	print_text_cell(staircase ? staircase->setting.value : NULL, text, size);
}

/* The estimate after the answer; NULL: there is no staircase. */
static const struct gz_quest_estimate *estimate_of(const struct gz_answer_row *row,
						   struct gz_quest_estimate *estimate)
{
	const struct gz_staircase *staircase = condition_of(row)->staircase;
	if (!staircase)
		return NULL;
	*estimate = gz_quest_estimate(&staircase->quest);
	return estimate;
}

PRINTER(print_threshold)
{
	struct gz_quest_estimate estimate;
	if (estimate_of(row, &estimate))
		snprintf(text, size, "%.5g", estimate.threshold);
	else
		print_none(text, size);
}

PRINTER(print_threshold_interval)
{
	struct gz_quest_estimate estimate;
	if (estimate_of(row, &estimate))
		snprintf(text, size, "%.5g to %.5g", estimate.low, estimate.high);
	else
		print_none(text, size);
}

PRINTER(print_frames)
{
	snprintf(text, size, "%" PRIu64, row->result->frames);
}

PRINTER(print_dropped)
{
	snprintf(text, size, "%" PRIu64, row->result->dropped);
}

PRINTER(print_frame_ms)
{
	print_number_cell(row->result->frame_ms, "%.1f", text, size);
}

PRINTER(print_gaze_loss)
{
	print_number_cell(row->result->gaze_loss, "%.4f", text, size);
}

PRINTER(print_restarts)
{
	snprintf(text, size, "%d", row->result->restarts);
}

PRINTER(print_participant)
{
	print_text_cell(row->participant, text, size);
}

PRINTER(print_session)
{
	print_text_cell(row->session, text, size);
}

PRINTER(print_run)
{
	snprintf(text, size, "%d", row->run);
}

PRINTER(print_seed)
{
	snprintf(text, size, "%d", row->experiment->params.seed);
}

PRINTER(print_experiment)
{
	snprintf(text, size, "%016" PRIx64, row->experiment->fingerprint);
}

PRINTER(print_host_ns)
{
	snprintf(text, size, "%" PRId64, row->result->begin_ns);
}

PRINTER(print_gaze_source)
{
	print_text_cell(row->gaze_source, text, size);
}

PRINTER(print_tracker)
{
	const char *name = row->equipment->tracker, *serial = row->equipment->tracker_serial;
	if (name && serial && serial[0])
		snprintf(text, size, "%s %s", name, serial);
	else
		print_text_cell(name, text, size);
}

PRINTER(print_display_px)
{
	const struct gz_display *display = &row->equipment->display;
	snprintf(text, size, "%dx%d", display->px[0], display->px[1]);
}

PRINTER(print_display_mm)
{
	const struct gz_display *display = &row->equipment->display;
	snprintf(text, size, "%.1fx%.1f", display->mm[0], display->mm[1]);
}

PRINTER(print_distance)
{
	print_number_cell(row->equipment->display.distance_mm, "%.1f", text, size);
}

PRINTER(print_backend)
{
	print_text_cell(row->equipment->backend, text, size);
}

PRINTER(print_gazeview)
{
	print_text_cell(row->version, text, size);
}

PRINTER(print_gazed)
{
	print_text_cell(row->equipment->daemon_version, text, size);
}

/* clang-format off */
const struct gz_answer_column gz_answer_columns[] = {
	{ "onset", "Time of the trial's first screen, from the start of the run's first trial.", "s", NULL, false, print_onset },
	{ "duration", "From the onset to the answer, or to the end of the wait for it.", "s", NULL, false, print_duration },
	{ "trial_type", "Name of the trial in the experiment file.", NULL, NULL, true, print_type },
	{ "trial", "Number of the trial in the session, from 1.", NULL, NULL, true, print_trial },
	{ "block", "Name of the block in the experiment file.", NULL, NULL, true, print_block },
	{ "practice", "Whether the trial is practice.", NULL, "0: counts | 1: practice", true, print_practice },
	{ "repetition", "Number of the repeat of the trial in its block, from 1.", NULL, NULL, true, print_repetition },
	{ "order", "Order in which the alternatives were shown.", NULL, "a: one interval | ab: a first | ba: b first", true, print_order },
	{ "scene_1", "Scene file of the first interval.", NULL, NULL, true, print_scene_1 },
	{ "method_1", "Foveation method in the first interval.", NULL, NULL, true, print_method_1 },
	{ "settings_1", "Scene keys that the experiment set in the first interval.", NULL, NULL, true, print_settings_1 },
	{ "scene_2", "Scene file of the second interval.", NULL, NULL, true, print_scene_2 },
	{ "method_2", "Foveation method in the second interval.", NULL, NULL, true, print_method_2 },
	{ "settings_2", "Scene keys that the experiment set in the second interval.", NULL, NULL, true, print_settings_2 },
	{ "interval_1_onset", "Time of the first frame of the first interval.", "s", NULL, false, print_onset_1 },
	{ "interval_1_duration", "From that frame to the next screen.", "s", NULL, false, print_duration_1 },
	{ "interval_2_onset", "Time of the first frame of the second interval.", "s", NULL, false, print_onset_2 },
	{ "interval_2_duration", "From that frame to the next screen.", "s", NULL, false, print_duration_2 },
	{ "question_onset", "Time the question was shown.", "s", NULL, false, print_question },
	{ "response", "Name of the answer in the experiment file.", NULL, NULL, false, print_response },
	{ "response_key", "Key of the answer.", NULL, NULL, false, print_key },
	{ "response_by", "How the answer was given.", NULL, "key: its key | mouse: a click on its button", false, print_by },
	{ "response_time", "From the question to the answer.", "s", NULL, false, print_response_time },
	{ "chosen", "Alternative shown in the interval that was chosen.", NULL, "a: alternative a | b: alternative b", false, print_chosen },
	{ "chosen_method", "Foveation method of that alternative.", NULL, NULL, false, print_chosen_method },
	{ "correct", "Whether the answer was correct according to the experiment file.", NULL, "0: wrong or too late | 1: correct", false, print_correct },
	{ "staircase", "Scene key that the staircase varied.", NULL, NULL, true, print_staircase },
	{ "staircase_value", "Its value in this trial.", NULL, NULL, true, print_staircase_value },
	{ "threshold", "The staircase's estimate of the threshold after this trial: mean of the posterior of QUEST.", NULL, NULL, false, print_threshold },
	{ "threshold_interval", "Where the threshold is with a probability of 95 %, by the same posterior.", NULL, NULL, false, print_threshold_interval },
	{ "frames", "Number of frame times measured in the intervals.", NULL, NULL, false, print_frames },
	{ "dropped_frames", "Number of display refreshes without a new frame in the intervals.", NULL, NULL, false, print_dropped },
	{ "median_frame_ms", "Median time between frames in the intervals.", "ms", NULL, false, print_frame_ms },
	{ "gaze_loss", "Fraction of the intervals in which the tracker did not see the eye.", NULL, NULL, false, print_gaze_loss },
	{ "gaze_source", "Where the gaze came from.", NULL, "daemon: a tracker, by gazed | mouse: the mouse | pointer: the mouse, by gazed | fixed: one place | log: a gaze log", true, print_gaze_source },
	{ "tracker", "The tracker's name and serial number, as gazed has them.", NULL, NULL, false, print_tracker },
	{ "display_px", "Size of the display.", "px", NULL, false, print_display_px },
	{ "display_mm", "Size of the display.", "mm", NULL, false, print_display_mm },
	{ "distance_mm", "Distance from the eyes to the display.", "mm", NULL, false, print_distance },
	{ "backend", "What rendered the pictures.", NULL, NULL, false, print_backend },
	{ "gazeview", "Version of gazeview.", NULL, NULL, false, print_gazeview },
	{ "gazed", "Version of gazed.", NULL, NULL, false, print_gazed },
	{ "restarts", "Number of times the trial was interrupted and restarted.", NULL, NULL, false, print_restarts },
	{ "participant", "Label of the participant.", NULL, NULL, true, print_participant },
	{ "session", "Label of the session.", NULL, NULL, true, print_session },
	{ "run", "Number of the run of the session, from 1; onsets are relative to the start of each run.", NULL, NULL, false, print_run },
	{ "seed", "Random seed of the experiment.", NULL, NULL, true, print_seed },
	{ "experiment", "Fingerprint of the experiment file: 64-bit FNV-1a.", NULL, NULL, true, print_experiment },
	{ "host_ns", "Onset of the trial on the host's monotonic clock, which the gaze log uses.", "ns", NULL, false, print_host_ns },
};
/* clang-format on */

const size_t gz_answer_column_count = sizeof gz_answer_columns / sizeof gz_answer_columns[0];

static void set_text_member(json_t *object, const char *key, const char *text)
{
	if (text && text[0])
		json_object_set_new(object, key, json_string(text));
}

/* Convert "a: one | b: two" to an object. */
static json_t *levels_of(const char *text)
{
	json_t *levels = json_object();
	while (levels && text && *text) {
		size_t length = strcspn(text, "|"), key = strcspn(text, ":");
		bool more = text[length] == '|';
		char *name = strndup(text, key);
		const char *value = text + key + 2; /* after ": " */
		size_t value_length = length - key - 2 - (more ? 1 : 0);
		if (name)
			json_object_set_new(levels, name, json_stringn(value, value_length));
		free(name);
		text += length + (more ? 2 : 0); /* after "| " */
	}
	return levels;
}

static json_t *column_json(const struct gz_answer_column *column)
{
	json_t *object = json_object();
	set_text_member(object, "Description", column->help);
	set_text_member(object, "Units", column->units);
	if (column->levels)
		json_object_set_new(object, "Levels", levels_of(column->levels));
	return object;
}

static json_t *software_of(const char *version)
{
	struct utsname system;
	json_t *object = json_object();
	if (uname(&system) == 0)
		set_text_member(object, "OperatingSystem", system.sysname);
	set_text_member(object, "SoftwareName", "gazeview");
	set_text_member(object, "SoftwareVersion", version);
	return object;
}

enum gz_result gz_answer_columns_write(const char *path, const struct gz_experiment *experiment,
				       const char *version)
{
	json_t *root = json_object();
	set_text_member(root, "TaskName", experiment->params.name);
	set_text_member(root, "Instructions", experiment->instructions);
	json_object_set_new(root, "StimulusPresentation", software_of(version));
	for (size_t i = 0; i < gz_answer_column_count; i++)
		json_object_set_new(root, gz_answer_columns[i].name,
				    column_json(&gz_answer_columns[i]));
	if (!root)
		return GZ_ERR_NO_MEM;
	int failed = json_dump_file(root, path, JSON_INDENT(2));
	json_decref(root);
	return failed ? GZ_ERR_IO : GZ_OK;
}
