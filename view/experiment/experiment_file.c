#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "view/experiment/experiment.h"
#include "view/experiment/experiment_internal.h"
#include "view/settings/scene_keys.h"

#define GZ_LOG_MODULE "experiment"

static const char *const asks_names[] = { "auto", "interval", "answer", NULL };
static const char *const interval_order_names[] = { "balanced", "random", "ab", "ba", NULL };
static const char *const order_names[] = { "random", "full_random", "listed", NULL };
static const char *const block_order_names[] = { "listed", "random", "rotated", NULL };
static const char *const easier_names[] = { "greater", "smaller", NULL };
static const char *const gaze_names[] = { "optional", "required", NULL };

#define AT(field) offsetof(struct gz_trial_params, field)

const struct gz_option gz_trial_options[] = {
	{ "scene", GZ_OPTION_STRING, AT(scene), .max = GZ_INI_LINE_SIZE, .preset = "",
	  .help = "scene file, relative to the experiment's folder" },
	{ "intervals", GZ_OPTION_INT, AT(intervals), 1, 2, .preset = "2",
	  .help = "number of pictures shown one after the other" },
	{ "interval_order", GZ_OPTION_CHOICE, AT(interval_order), .choices = interval_order_names,
	  .preset = "balanced",
	  .help = "which alternative comes first: each in half of the repeats, drawn each time, a "
		  "or b" },
	{ "fixation_s", GZ_OPTION_DOUBLE, AT(fixation_s), 0, 60, .preset = "1",
	  .help = "time of the cross before the first interval, s" },
	{ "duration_s", GZ_OPTION_DOUBLE, AT(duration_s), 0.01, 3600, .preset = "2",
	  .help = "time of each interval, s" },
	{ "blank_s", GZ_OPTION_DOUBLE, AT(blank_s), 0, 60, .preset = "0.5",
	  .help = "time of the empty screen between the intervals, s" },
	{ "pause_s", GZ_OPTION_DOUBLE, AT(pause_s), 0, 60, .preset = "0.5",
	  .help = "time of the empty screen after the answer, s" },
	{ "question", GZ_OPTION_STRING, AT(question), .max = GZ_INI_LINE_SIZE,
	  .preset = "Which was sharper, the first or the second?",
	  .help = "text shown after the last interval" },
	{ "asks", GZ_OPTION_CHOICE, AT(asks), .choices = asks_names, .preset = "auto",
	  .help = "what a key stands for: interval (first key, first interval), answer, or auto: "
		  "by intervals" },
	{ "keys", GZ_OPTION_STRING, AT(keys), .max = GZ_INI_LINE_SIZE, .preset = "1 2",
	  .help = "keys that answer: a to z, 0 to 9, left, right, up, down, space, return" },
	{ "answers", GZ_OPTION_STRING, AT(answers), .max = GZ_INI_LINE_SIZE, .preset = "",
	  .help = "name of each key's answer; empty: first second, or the names of the keys" },
	{ "correct", GZ_OPTION_STRING, AT(correct), .max = GZ_INI_LINE_SIZE, .preset = "",
	  .help = "the correct alternative (a or b) or answer; empty: none is correct" },
	{ "timeout_s", GZ_OPTION_DOUBLE, AT(timeout_s), 0, 3600, .preset = "0",
	  .help = "longest wait for an answer, s; 0: no limit" },
	{ "feedback", GZ_OPTION_BOOL, AT(feedback), .preset = "no",
	  .help = "tell the participant whether the answer was correct" },
	{ "feedback_s", GZ_OPTION_DOUBLE, AT(feedback_s), 0.1, 60, .preset = "0.8",
	  .help = "time of the feedback, s" },
	{ "feedback_correct", GZ_OPTION_STRING, AT(feedback_correct), .max = GZ_INI_LINE_SIZE,
	  .preset = "Correct", .help = "text after a correct answer" },
	{ "feedback_wrong", GZ_OPTION_STRING, AT(feedback_wrong), .max = GZ_INI_LINE_SIZE,
	  .preset = "Wrong", .help = "text after a wrong answer" },
	{ "feedback_late", GZ_OPTION_STRING, AT(feedback_late), .max = GZ_INI_LINE_SIZE,
	  .preset = "Too late", .help = "text when the wait for an answer has ended" },
	{ "staircase", GZ_OPTION_STRING, AT(staircase), .max = GZ_INI_LINE_SIZE, .preset = "",
	  .help = "scene key that QUEST varies, as in b.foveation.acuity_slope; empty: none" },
	{ "staircase_range", GZ_OPTION_DOUBLE, AT(staircase_range), 0, 1e9, .count = 2,
	  .preset = "0 0", .help = "least and greatest value of that key" },
	{ "staircase_start", GZ_OPTION_DOUBLE, AT(staircase_start), 0, 1e9, .preset = "0",
	  .help = "guessed threshold, which the first trial shows; 0: the middle of the range" },
	{ "staircase_sd", GZ_OPTION_DOUBLE, AT(staircase_sd), 0.01, 100, .preset = "0.5",
	  .help = "standard deviation of that guess, decades" },
	{ "staircase_easier", GZ_OPTION_CHOICE, AT(staircase_easier), .choices = easier_names,
	  .preset = "greater", .help = "which values are answered right more often" },
	{ "staircase_beta", GZ_OPTION_DOUBLE, AT(staircase_beta), 0.1, 100, .preset = "3.5",
	  .help = "slope of the psychometric function over the logarithm of the value" },
	{ "staircase_delta", GZ_OPTION_DOUBLE, AT(staircase_delta), 0, 0.5, .preset = "0.01",
	  .help = "share of answers that are blind guesses" },
	{ "staircase_gamma", GZ_OPTION_DOUBLE, AT(staircase_gamma), 0, 0.99, .preset = "0.5",
	  .help = "share of right answers by guessing: 0.5 with two answers" },
	{ "staircase_target", GZ_OPTION_DOUBLE, AT(staircase_target), 0.01, 0.99, .preset = "0.82",
	  .help = "share of right answers at the threshold" },
	{ "staircase_stop_sd", GZ_OPTION_DOUBLE, AT(staircase_stop_sd), 0, 10, .preset = "0",
	  .help = "no more trials once the threshold is known so well, decades; 0: all repeats" },
};

const size_t gz_trial_option_count = sizeof gz_trial_options / sizeof gz_trial_options[0];

#undef AT
#define AT(field) offsetof(struct gz_block_params, field)

const struct gz_option gz_block_options[] = {
	{ "trials", GZ_OPTION_STRING, AT(trials), .max = GZ_INI_LINE_SIZE, .preset = "*",
	  .help = "names of trials, separated by blanks; * matches any part of a name" },
	{ "repeats", GZ_OPTION_INT, AT(repeats), 1, 1000, .preset = "1",
	  .help = "number of times each trial comes" },
	{ "order", GZ_OPTION_CHOICE, AT(order), .choices = order_names, .preset = "random",
	  .help = "random: each trial once before any comes again; full_random: over all repeats; "
		  "listed" },
	{ "practice", GZ_OPTION_BOOL, AT(practice), .preset = "no",
	  .help = "mark the block's trials as practice in the answers" },
	{ "break_every", GZ_OPTION_INT, AT(break_every), 0, 10000, .preset = "0",
	  .help = "number of trials between breaks; 0: no breaks" },
	{ "break_text", GZ_OPTION_STRING, AT(break_text), .max = GZ_INI_LINE_SIZE,
	  .preset = "Have a break.\\nPress Space to continue.", .help = "text shown in a break" },
	{ "instructions", GZ_OPTION_STRING, AT(instructions), .max = GZ_INI_LINE_SIZE, .preset = "",
	  .help = "text shown before the block" },
	{ "instructions_file", GZ_OPTION_STRING, AT(instructions_file), .max = GZ_INI_LINE_SIZE,
	  .preset = "", .help = "text file to show before the block" },
};

const size_t gz_block_option_count = sizeof gz_block_options / sizeof gz_block_options[0];

#undef AT
#define AT(field) offsetof(struct gz_experiment_params, field)

const struct gz_option gz_experiment_options[] = {
	{ "name", GZ_OPTION_STRING, AT(name), .max = GZ_EXPERIMENT_LABEL_SIZE, .preset = "",
	  .help = "name of the task in the names of files: letters and digits" },
	{ "seed", GZ_OPTION_INT, AT(seed), 0, 2147483647, .preset = "1",
	  .help = "random seed of all orders, together with participant and session" },
	{ "block_order", GZ_OPTION_CHOICE, AT(block_order), .choices = block_order_names,
	  .preset = "listed",
	  .help = "order of the blocks; rotated: participant n starts with block n; practice keeps "
		  "its place" },
	{ "gaze", GZ_OPTION_CHOICE, AT(gaze), .choices = gaze_names, .preset = "optional",
	  .help = "required: no interval starts without gaze from a tracker" },
	{ "gaze_lost_s", GZ_OPTION_DOUBLE, AT(gaze_lost_s), 0, 3600, .preset = "1",
	  .help = "gaze = required: a trial starts again if an interval has no gaze for so long, "
		  "s; "
		  "0: never" },
	{ "instructions", GZ_OPTION_STRING, AT(instructions), .max = GZ_INI_LINE_SIZE, .preset = "",
	  .help = "text shown first" },
	{ "instructions_file", GZ_OPTION_STRING, AT(instructions_file), .max = GZ_INI_LINE_SIZE,
	  .preset = "", .help = "text file to show first" },
	{ "goodbye", GZ_OPTION_STRING, AT(goodbye), .max = GZ_INI_LINE_SIZE,
	  .preset = "That was all. Thank you.\\nPress Space to finish.",
	  .help = "text shown last; empty: none" },
	{ "buttons", GZ_OPTION_BOOL, AT(buttons), .preset = "yes",
	  .help = "show the mouse and a button for each answer; no: keys only" },
	{ "ground", GZ_OPTION_DOUBLE, AT(ground), 0, 1, .count = 3, .preset = "0.5 0.5 0.5",
	  .help = "red, green, blue of the screen between pictures" },
	{ "text_size", GZ_OPTION_DOUBLE, AT(text_size), 0.005, 0.2, .preset = "0.035",
	  .help = "height of a line of text, as a fraction of the screen's" },
	{ "fixation_deg", GZ_OPTION_DOUBLE, AT(fixation_deg), 0.05, 10, .preset = "0.6",
	  .help = "width of the cross, degrees" },
};

const size_t gz_experiment_option_count =
	sizeof gz_experiment_options / sizeof gz_experiment_options[0];

/* Longest file, bytes. Chosen: like other settings files. */
enum { MOST_BYTES = 1 << 20 };

/* Size of a message of gz_option_parse(). */
enum { MESSAGE_SIZE = 512 };

/* A file being read. */
struct reader {
	struct gz_experiment *experiment;
	const struct gz_log *log;
	struct gz_experiment_section *section; /* the current section */
	bool common_begun;
	/* Values are parsed into these to check them. */
	struct gz_trial_params trial;
	struct gz_block_params block;
	struct gz_scene_settings scene;
	struct gz_view_scene_tables tables;
};

static enum gz_result refuse_experiment_section(const struct reader *reader,
						const struct gz_ini_item *item, const char *what)
{
	gz_err(reader->log, "%s:%d: [%s]: %s", reader->experiment->path, item->line, item->section,
	       what);
	return GZ_ERR_FORMAT;
}

static enum gz_result refuse_value(const struct reader *reader, const struct gz_ini_item *item,
				   const char *what)
{
	gz_err(reader->log, "%s:%d: [%s] %s: %s", reader->experiment->path, item->line,
	       item->section, item->name, what);
	return GZ_ERR_FORMAT;
}

static struct gz_experiment_section *find_section(struct gz_experiment_section *sections,
						  size_t count, const char *label)
{
	for (size_t i = 0; i < count; i++)
		if (strcmp(sections[i].label, label) == 0)
			return &sections[i];
	return NULL;
}

/* Add a section to a list of at most GZ_EXPERIMENT_SECTIONS_MAX. */
static enum gz_result begin_named(struct reader *reader, const struct gz_ini_item *item,
				  const char *label, struct gz_experiment_section *sections,
				  size_t *count)
{
	char what[96];
	const struct gz_experiment_section *first = find_section(sections, *count, label);
	if (!gz_experiment_is_label(label))
		return refuse_experiment_section(
			reader, item,
			"not a name; use letters, digits and _ . + -, as in [trial fine]");
	if (first) {
		snprintf(what, sizeof what, "already used in line %d; rename one of them",
			 first->line);
		return refuse_experiment_section(reader, item, what);
	}
	if (*count == GZ_EXPERIMENT_SECTIONS_MAX)
		return refuse_experiment_section(reader, item,
						 "more than 256 of these; split the file");
	reader->section = &sections[(*count)++];
	*reader->section = (struct gz_experiment_section) { .line = item->line };
	memcpy(reader->section->label, label, strlen(label) + 1);
	return GZ_OK;
}

static enum gz_result begin_section(struct reader *reader, const struct gz_ini_item *item)
{
	struct gz_experiment *experiment = reader->experiment;
	if (strncmp(item->section, "trial ", 6) == 0)
		return begin_named(reader, item, item->section + 6, experiment->trials,
				   &experiment->trial_count);
	if (strncmp(item->section, "block ", 6) == 0)
		return begin_named(reader, item, item->section + 6, experiment->sections,
				   &experiment->section_count);
	if (strcmp(item->section, "experiment") != 0)
		return refuse_experiment_section(
			reader, item,
			"unknown section; [experiment], [trial NAME] and [block NAME] are allowed");
	if (reader->common_begun)
		return refuse_experiment_section(reader, item, "given twice; keep one");
	reader->common_begun = true;
	reader->section = &experiment->common;
	reader->section->line = item->line;
	return GZ_OK;
}

static bool of_trials(const struct reader *reader)
{
	const struct gz_experiment *experiment = reader->experiment;
	return reader->section >= experiment->trials &&
	       reader->section < experiment->trials + experiment->trial_count;
}

/* The table of the section's own settings; empty in a trial. */
static struct gz_option_binding own_binding(struct reader *reader)
{
	if (reader->section == &reader->experiment->common)
		return (struct gz_option_binding) { gz_experiment_options,
						    gz_experiment_option_count,
						    &reader->experiment->params, NULL };
	if (of_trials(reader))
		return (struct gz_option_binding) { 0 };
	return (struct gz_option_binding) { gz_block_options, gz_block_option_count, &reader->block,
					    NULL };
}

enum { TABLES_MAX = GZ_VIEW_SCENE_TABLES + 2 };

/* All tables with keys for the section: its own, the trials', the scene's. */
static size_t all_tables(struct reader *reader, struct gz_option_binding out_tables[TABLES_MAX])
{
	out_tables[0] = own_binding(reader);
	out_tables[1] = (struct gz_option_binding) { gz_trial_options, gz_trial_option_count,
						     &reader->trial, NULL };
	memcpy(&out_tables[2], reader->tables.bindings, sizeof reader->tables.bindings);
	return TABLES_MAX;
}

static enum gz_result refuse_unknown(struct reader *reader, const struct gz_ini_item *item,
				     const char *key)
{
	struct gz_option_binding tables[TABLES_MAX];
	size_t count = all_tables(reader, tables);
	const char *near = gz_options_nearest(tables, count, key);
	char what[160] = "unknown key; docs/experiments.md lists all keys";
	if (strncmp(key, "volume.", 7) == 0 || strncmp(key, "transfer.", 9) == 0 ||
	    strncmp(key, "display.", 8) == 0)
		snprintf(
			what, sizeof what,
			"is allowed in a scene only; use another scene, as in scene = other.scene");
	else if (near)
		snprintf(what, sizeof what, "unknown key; did you mean %s?", near);
	return refuse_value(reader, item, what);
}

/* Skip a prefix "a." or "b.". @return its alternative; -1: no prefix */
static int take_prefix(const char **key)
{
	if (((*key)[0] != 'a' && (*key)[0] != 'b') || (*key)[1] != '.')
		return -1;
	int alternative = (*key)[0] - 'a';
	*key += 2;
	return alternative;
}

/* Add a setting to its section; refuse a repeated one. */
static enum gz_result keep_setting(struct reader *reader, const struct gz_ini_item *item,
				   const struct gz_experiment_setting *setting)
{
	struct gz_experiment_section *section = reader->section;
	const struct gz_experiment_setting *first =
		gz_experiment_find_setting(section, setting->key, setting->alternative);
	char what[64];
	if (first) {
		snprintf(what, sizeof what, "given twice, first in line %d; keep one", first->line);
		return refuse_value(reader, item, what);
	}
	if (section->setting_count == section->setting_room) {
		size_t room = section->setting_room ? 2 * section->setting_room : 8;
		struct gz_experiment_setting *grown =
			realloc(section->settings, room * sizeof *grown);
		if (!grown)
			return GZ_ERR_NO_MEM;
		section->settings = grown;
		section->setting_room = room;
	}
	section->settings[section->setting_count++] = *setting;
	return GZ_OK;
}

static bool has_control(const char *text)
{
	for (; *text; text++)
		if ((unsigned char)*text < ' ' || *text == 0x7f)
			return true;
	return false;
}

static enum gz_result take_value(struct reader *reader, const struct gz_ini_item *item)
{
	const char *key = item->name;
	int alternative = take_prefix(&key);
	struct gz_option_binding tables[TABLES_MAX];
	size_t count = all_tables(reader, tables), table = 0;
	const struct gz_option *option = gz_options_find(tables, count, key, &table);
	if (!option)
		return refuse_unknown(reader, item, key);
	if (strncmp(key, "view.", 5) == 0 || strncmp(key, "views.", 6) == 0)
		return refuse_value(
			reader, item,
			"belongs to a window with panels; an experiment shows only the picture");
	if (alternative >= 0 && table < 2 && strcmp(key, "scene") != 0)
		return refuse_value(reader, item,
				    "applies to both alternatives; only scene and scene keys may "
				    "have the prefix a. or b.");
	if (has_control(item->value))
		return refuse_value(reader, item,
				    "contains a tab or control character; use blanks");
	char message[MESSAGE_SIZE];
	if (gz_option_parse(option, item->value, tables[table].target, message, sizeof message) !=
	    GZ_OK)
		return refuse_value(reader, item, message);
	struct gz_experiment_setting setting = {
		.alternative = alternative,
		.of_scene = table >= 2,
		.own = table == 0,
		.line = item->line,
	};
	snprintf(setting.key, sizeof setting.key, "%s", key);
	snprintf(setting.value, sizeof setting.value, "%s", item->value);
	return keep_setting(reader, item, &setting);
}

static enum gz_result read_experiment_item(void *user, const struct gz_ini_item *item)
{
	struct reader *reader = user;
	return item->name ? take_value(reader, item) : begin_section(reader, item);
}

static enum gz_result begin_experiment_file(struct reader *reader, const char *path)
{
	struct gz_experiment *experiment = reader->experiment;
	*experiment = (struct gz_experiment) { 0 };
	if (strlen(path) >= sizeof experiment->path) {
		gz_err(reader->log, "%.40s...: the path is longer than %zu bytes; move it", path,
		       sizeof experiment->path - 1);
		return GZ_ERR_FORMAT;
	}
	memcpy(experiment->path, path, strlen(path) + 1);
	experiment->trials = calloc(GZ_EXPERIMENT_SECTIONS_MAX, sizeof *experiment->trials);
	experiment->sections = calloc(GZ_EXPERIMENT_SECTIONS_MAX, sizeof *experiment->sections);
	if (!experiment->trials || !experiment->sections)
		return GZ_ERR_NO_MEM;
	gz_view_pick_scene_tables(&reader->scene, &reader->tables);
	return gz_options_preset(&(struct gz_option_binding) {
		gz_experiment_options, gz_experiment_option_count, &experiment->params, NULL });
}

enum gz_result gz_experiment_parse(const char *path, const char *text, size_t size,
				   const struct gz_log *log, struct gz_experiment *out_experiment)
{
	struct gz_experiment experiment;
	struct reader *reader = calloc(1, sizeof *reader);
	if (!reader)
		return GZ_ERR_NO_MEM;
	reader->experiment = &experiment;
	reader->log = log;
	enum gz_result result = begin_experiment_file(reader, path);
	if (result == GZ_OK)
		result = gz_ini_read_text(path, text, size, read_experiment_item, reader, log);
	free(reader);
	if (result == GZ_OK) {
		experiment.fingerprint = gz_experiment_hash(GZ_EXPERIMENT_HASH_START, text, size);
		result = gz_experiment_resolve(&experiment, log);
	}
	if (result == GZ_OK)
		result = gz_experiment_read_texts(&experiment, log);
	if (result != GZ_OK) {
		gz_experiment_free(&experiment);
		return result;
	}
	*out_experiment = experiment;
	return GZ_OK;
}

enum gz_result gz_experiment_load(const char *path, const struct gz_log *log,
				  struct gz_experiment *out_experiment)
{
	FILE *file = fopen(path, "rb");
	if (!file) {
		bool missing = errno == ENOENT;
		gz_err(log, "%s: cannot be opened: %s; check the path", path, strerror(errno));
		return missing ? GZ_ERR_NOT_FOUND : GZ_ERR_IO;
	}
	enum gz_result result = GZ_ERR_NO_MEM;
	char *text = malloc(MOST_BYTES + 1);
	size_t size = text ? fread(text, 1, MOST_BYTES + 1, file) : 0;
	if (text && ferror(file)) {
		gz_err(log, "%s: cannot be read: %s", path, strerror(errno));
		result = GZ_ERR_IO;
	} else if (size > MOST_BYTES) {
		gz_err(log,
		       "%s: longer than %d bytes and therefore not an experiment; check the path",
		       path, MOST_BYTES);
		result = GZ_ERR_FORMAT;
	} else if (text) {
		result = gz_experiment_parse(path, text, size, log, out_experiment);
	}
	free(text);
	fclose(file);
	return result;
}
