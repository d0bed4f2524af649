/* Builds conditions from the sections of an experiment file: collects the settings of each trial in
 * each block and checks them against each other. */
#include <fnmatch.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "base/text.h"
#include "view/experiment/experiment.h"
#include "view/experiment/experiment_internal.h"
#include "view/experiment/staircase.h"
#include "view/settings/scene_keys.h"

#define GZ_LOG_MODULE "experiment"

/* A condition being built, and its sections; later ones override earlier ones. */
enum { LEVELS = 3 };
struct maker {
	const struct gz_experiment *experiment;
	const struct gz_log *log;
	const struct gz_experiment_section *levels[LEVELS]; /* NULL: no such section */
	struct gz_condition *condition;
};

/* The setting that applies; NULL: none. Within a section, one for the alternative overrides one for
 * both. */
static const struct gz_experiment_setting *find_setting(const struct maker *maker, const char *key,
							int alternative)
{
	for (int level = LEVELS - 1; level >= 0; level--) {
		const struct gz_experiment_section *section = maker->levels[level];
		const struct gz_experiment_setting *setting = NULL;
		if (section && alternative >= 0)
			setting = gz_experiment_find_setting(section, key, alternative);
		if (section && !setting)
			setting = gz_experiment_find_setting(section, key, -1);
		if (setting)
			return setting;
	}
	return NULL;
}

__attribute__((format(printf, 3, 4))) static enum gz_result refuse_trial(const struct maker *maker,
									 const char *key,
									 const char *format, ...)
{
	char what[512];
	va_list arguments;
	const struct gz_experiment_setting *setting = find_setting(maker, key, -1);
	va_start(arguments, format);
	vsnprintf(what, sizeof what, format, arguments);
	va_end(arguments);
	gz_err(maker->log, "%s:%d: [trial %s] %s: %s", maker->experiment->path,
	       setting ? setting->line : maker->condition->line, maker->condition->label, key,
	       what);
	return GZ_ERR_FORMAT;
}

/* Replace "\n" by a line break. */
static void unescape(char *text)
{
	char *to = text;
	for (const char *from = text; *from; from++) {
		if (from[0] == '\\' && from[1] == 'n') {
			*to++ = '\n';
			from++;
		} else {
			*to++ = *from;
		}
	}
	*to = '\0';
}

static enum gz_result take_params(const struct maker *maker)
{
	struct gz_trial_params *params = &maker->condition->params;
	const struct gz_option_binding binding = { gz_trial_options, gz_trial_option_count, params,
						   NULL };
	enum gz_result result = gz_options_preset(&binding);
	for (size_t i = 0; i < gz_trial_option_count && result == GZ_OK; i++) {
		const struct gz_experiment_setting *setting =
			find_setting(maker, gz_trial_options[i].key, -1);
		if (setting)
			result = gz_option_parse(&gz_trial_options[i], setting->value, params, NULL,
						 0);
	}
	unescape(params->question);
	unescape(params->feedback_correct);
	unescape(params->feedback_wrong);
	unescape(params->feedback_late);
	return result;
}

static const char *alternative_name(int alternative)
{
	return alternative == 0 ? "a" : "b";
}

static enum gz_result take_scene_file(const struct maker *maker, int which)
{
	struct gz_alternative *alternative = &maker->condition->alternatives[which];
	const struct gz_experiment_setting *setting = find_setting(maker, "scene", which);
	if (!setting || !setting->value[0])
		return refuse_trial(maker, "scene",
				    "missing for %s; name a scene file, as in scene = shells.scene",
				    alternative_name(which));
	if (gz_path_beside(maker->experiment->path, setting->value, alternative->scene,
			   sizeof alternative->scene) != GZ_OK)
		return refuse_trial(maker, "scene", "the path is too long; move the file");
	return GZ_OK;
}

/* Whether a scene setting applies to the alternative and is not overridden. */
static bool setting_counts(const struct maker *maker, const struct gz_experiment_setting *setting,
			   int alternative)
{
	return setting->of_scene &&
	       (setting->alternative < 0 || setting->alternative == alternative) &&
	       find_setting(maker, setting->key, alternative) == setting;
}

static enum gz_result take_alternative(const struct maker *maker, int which)
{
	struct gz_alternative *alternative = &maker->condition->alternatives[which];
	enum gz_result result = take_scene_file(maker, which);
	for (int level = 0; level < LEVELS && result == GZ_OK; level++) {
		const struct gz_experiment_section *section = maker->levels[level];
		for (size_t i = 0; section && i < section->setting_count; i++) {
			if (!setting_counts(maker, &section->settings[i], which))
				continue;
			if (alternative->setting_count == GZ_EXPERIMENT_SETTINGS_MAX)
				return refuse_trial(
					maker, section->settings[i].key,
					"more than 64 scene keys; put them into a scene");
			alternative->settings[alternative->setting_count++] = &section->settings[i];
		}
	}
	return result;
}

static size_t split_names(char *text, char **out_words, size_t room)
{
	size_t count = 0;
	char *rest = text, *word;
	while ((word = gz_number_next_word(&rest, " ")) != NULL) {
		if (count < room)
			out_words[count] = word;
		count++;
	}
	return count;
}

static enum gz_result take_answer_keys(const struct maker *maker)
{
	struct gz_condition *condition = maker->condition;
	char text[GZ_INI_LINE_SIZE], *words[GZ_EXPERIMENT_ANSWERS_MAX];
	memcpy(text, condition->params.keys, sizeof text);
	size_t count = split_names(text, words, GZ_EXPERIMENT_ANSWERS_MAX);
	if (count == 0 || count > GZ_EXPERIMENT_ANSWERS_MAX)
		return refuse_trial(maker, "keys", "%zu keys; 1 to %d are allowed", count,
				    GZ_EXPERIMENT_ANSWERS_MAX);
	for (size_t i = 0; i < count; i++) {
		int key = gz_answer_key_of(words[i]);
		if (key == GZ_KEY_NONE)
			return refuse_trial(maker, "keys",
					    "%.20s is not a key; a to z, 0 to 9, left, right, up, "
					    "down, space and return are allowed",
					    words[i]);
		for (size_t k = 0; k < i; k++)
			if (condition->answers[k].key == key)
				return refuse_trial(maker, "keys", "%s is given twice; keep one",
						    words[i]);
		condition->answers[i].key = key;
		snprintf(condition->answers[i].key_name, sizeof condition->answers[i].key_name,
			 "%s", words[i]);
	}
	condition->answer_count = count;
	return GZ_OK;
}

/* Default names of the answers. */
static void name_answers(struct gz_condition *condition)
{
	static const char *const ordinals[] = { "first", "second" };
	for (size_t i = 0; i < condition->answer_count; i++) {
		struct gz_answer *answer = &condition->answers[i];
		bool interval = condition->params.asks == GZ_ASKS_INTERVAL && i < 2;
		snprintf(answer->name, sizeof answer->name, "%s",
			 interval ? ordinals[i] : answer->key_name);
	}
}

static enum gz_result take_answers(const struct maker *maker)
{
	struct gz_condition *condition = maker->condition;
	char text[GZ_INI_LINE_SIZE], *words[GZ_EXPERIMENT_ANSWERS_MAX];
	memcpy(text, condition->params.answers, sizeof text);
	size_t count = split_names(text, words, GZ_EXPERIMENT_ANSWERS_MAX);
	name_answers(condition);
	if (count == 0)
		return GZ_OK;
	if (count != condition->answer_count)
		return refuse_trial(maker, "answers", "%zu answers for %zu keys; give one for each",
				    count, condition->answer_count);
	for (size_t i = 0; i < count; i++) {
		if (!gz_experiment_is_label(words[i]))
			return refuse_trial(maker, "answers",
					    "%.60s: not a name; use letters, digits and _ . + -, "
					    "at most 49 bytes",
					    words[i]);
		for (size_t k = 0; k < i; k++)
			if (strcmp(condition->answers[k].name, words[i]) == 0)
				return refuse_trial(maker, "answers", "%s is given twice; keep one",
						    words[i]);
		snprintf(condition->answers[i].name, sizeof condition->answers[i].name, "%s",
			 words[i]);
	}
	return GZ_OK;
}

static enum gz_result check_asks(const struct maker *maker)
{
	struct gz_condition *condition = maker->condition;
	struct gz_trial_params *params = &condition->params;
	if (params->asks == GZ_ASKS_AUTO)
		params->asks = params->intervals == 2 ? GZ_ASKS_INTERVAL : GZ_ASKS_ANSWER;
	if (params->asks == GZ_ASKS_INTERVAL && params->intervals != 2)
		return refuse_trial(
			maker, "asks",
			"interval, but there is only one; set intervals = 2 or asks = answer");
	if (params->asks == GZ_ASKS_INTERVAL && condition->answer_count < 2)
		return refuse_trial(maker, "keys", "one key for two intervals; give one for each");
	return GZ_OK;
}

static enum gz_result take_correct(const struct maker *maker)
{
	struct gz_condition *condition = maker->condition;
	const char *correct = condition->params.correct;
	condition->correct = -1;
	if (!correct[0])
		return condition->params.feedback
			       ? refuse_trial(maker, "feedback",
					      "needs a correct answer; set correct as well")
			       : GZ_OK;
	if (condition->params.asks == GZ_ASKS_INTERVAL) {
		if (strcmp(correct, "a") != 0 && strcmp(correct, "b") != 0)
			return refuse_trial(maker, "correct", "%.60s: a or b is allowed", correct);
		condition->correct = correct[0] - 'a';
		return GZ_OK;
	}
	for (size_t i = 0; i < condition->answer_count; i++)
		if (strcmp(condition->answers[i].name, correct) == 0)
			condition->correct = (int)i;
	return condition->correct >= 0
		       ? GZ_OK
		       : refuse_trial(maker, "correct",
				      "%.60s is not one of the answers; name one of them", correct);
}

/* Refuse settings for alternative b in a trial with one interval. */
static enum gz_result check_second(const struct maker *maker)
{
	const struct gz_experiment_section *trial = maker->levels[LEVELS - 1];
	for (size_t i = 0; i < trial->setting_count; i++)
		if (trial->settings[i].alternative == 1)
			return refuse_trial(maker, "intervals",
					    "1, but line %d is for a second one; set intervals = 2 "
					    "or remove it",
					    trial->settings[i].line);
	return GZ_OK;
}

/* Skip the prefix of a staircase's key. @return its alternative; -1: both */
static int take_prefix(const char **key)
{
	const int which = (*key)[0] - 'a';
	if ((which != 0 && which != 1) || (*key)[1] != '.')
		return -1;
	*key += 2;
	return which;
}

/* The key must be a number of a scene, whose limits hold the range. */
static enum gz_result check_varied_key(const struct maker *maker, const char *key)
{
	const double *range = maker->condition->params.staircase_range;
	struct gz_scene_settings *settings = calloc(1, sizeof *settings);
	struct gz_view_scene_tables tables;
	if (!settings)
		return GZ_ERR_NO_MEM;
	gz_view_pick_scene_tables(settings, &tables);
	const struct gz_option *option =
		gz_options_find(tables.bindings, GZ_VIEW_SCENE_TABLES, key, NULL);
	free(settings);
	if (!option || option->type != GZ_OPTION_DOUBLE || gz_option_count(option) != 1)
		return refuse_trial(maker, "staircase",
				    "%.60s is not a scene key of one number that may have a "
				    "fraction, as b.foveation.acuity_slope is",
				    maker->condition->params.staircase);
	if (!(range[0] > 0 && range[1] > range[0]))
		return refuse_trial(maker, "staircase_range",
				    "two numbers above 0 are needed, the smaller first");
	if (range[0] < option->min || range[1] > option->max)
		return refuse_trial(maker, "staircase_range", "%s is %g to %g", key, option->min,
				    option->max);
	return GZ_OK;
}

/* Let the alternative show what the staircase asks for. */
static enum gz_result vary_alternative(const struct maker *maker, int which)
{
	struct gz_alternative *alternative = &maker->condition->alternatives[which];
	const struct gz_experiment_setting *setting = &maker->condition->staircase->setting;
	size_t at = 0;
	while (at < alternative->setting_count &&
	       strcmp(alternative->settings[at]->key, setting->key) != 0)
		at++;
	if (at == GZ_EXPERIMENT_SETTINGS_MAX)
		return refuse_trial(maker, "staircase",
				    "more than 64 scene keys; put them into a scene");
	alternative->settings[at] = setting;
	alternative->setting_count += at == alternative->setting_count;
	return GZ_OK;
}

static struct gz_quest_params quest_params_of(const struct gz_trial_params *params)
{
	const double *range = params->staircase_range;
	return (struct gz_quest_params) {
		.from = range[0],
		.to = range[1],
		.falling = params->staircase_easier == GZ_EASIER_SMALLER,
		.start = params->staircase_start > 0 ? params->staircase_start
						     : sqrt(range[0] * range[1]),
		.sd = params->staircase_sd,
		.beta = params->staircase_beta,
		.delta = params->staircase_delta,
		.gamma = params->staircase_gamma,
		.target = params->staircase_target,
	};
}

static enum gz_result begin_staircase(const struct maker *maker)
{
	struct gz_condition *condition = maker->condition;
	struct gz_staircase *staircase = condition->staircase;
	const struct gz_quest_params params = quest_params_of(&condition->params);
	staircase->stop_sd = condition->params.staircase_stop_sd;
	if (params.start < params.from || params.start > params.to)
		return refuse_trial(maker, "staircase_start", "%g is outside the range",
				    params.start);
	if (gz_quest_begin(&staircase->quest, &params) != GZ_OK)
		return refuse_trial(maker, "staircase_target",
				    "%g cannot be a threshold; it lies between what guessing gives "
				    "(staircase_gamma) and what blind answers leave "
				    "(staircase_delta)",
				    params.target);
	if (gz_staircase_finished(staircase))
		return refuse_trial(maker, "staircase_stop_sd",
				    "reached before the first trial; it must be less than "
				    "staircase_sd");
	gz_staircase_place(staircase);
	return GZ_OK;
}

static enum gz_result take_staircase(const struct maker *maker)
{
	struct gz_condition *condition = maker->condition;
	const char *key = condition->params.staircase;
	if (!key[0])
		return GZ_OK;
	const int which = take_prefix(&key);
	if (condition->correct < 0)
		return refuse_trial(maker, "staircase",
				    "needs a correct answer; set correct as well");
	if (which >= condition->params.intervals)
		return refuse_trial(maker, "staircase", "b is not shown, as intervals = 1");
	enum gz_result result = check_varied_key(maker, key);
	if (result != GZ_OK)
		return result;
	condition->staircase = calloc(1, sizeof *condition->staircase);
	if (!condition->staircase)
		return GZ_ERR_NO_MEM;
	const struct gz_experiment_setting *given = find_setting(maker, "staircase", -1);
	condition->staircase->setting = (struct gz_experiment_setting) {
		.alternative = which,
		.of_scene = true,
		.line = given->line,
	};
	memcpy(condition->staircase->setting.key, key, strlen(key) + 1);
	for (int i = 0; i < condition->params.intervals && result == GZ_OK; i++)
		if (which < 0 || i == which)
			result = vary_alternative(maker, i);
	return result == GZ_OK ? begin_staircase(maker) : result;
}

static enum gz_result make_condition(const struct maker *maker)
{
	enum gz_result result = take_params(maker);
	const int intervals = maker->condition->params.intervals;
	if (result == GZ_OK && intervals == 1)
		result = check_second(maker);
	for (int which = 0; which < intervals && result == GZ_OK; which++)
		result = take_alternative(maker, which);
	if (result == GZ_OK)
		result = take_answer_keys(maker);
	if (result == GZ_OK)
		result = check_asks(maker);
	if (result == GZ_OK)
		result = take_answers(maker);
	if (result == GZ_OK)
		result = take_correct(maker);
	return result == GZ_OK ? take_staircase(maker) : result;
}

/* An experiment whose blocks are being built. */
struct resolver {
	struct gz_experiment *experiment;
	const struct gz_log *log;
	size_t presentations;
};

static enum gz_result refuse_block(const struct resolver *resolver,
				   const struct gz_experiment_section *section, const char *key,
				   const char *what)
{
	const struct gz_experiment_setting *setting = gz_experiment_find_setting(section, key, -1);
	gz_err(resolver->log, "%s:%d: [block %s] %s: %s", resolver->experiment->path,
	       setting ? setting->line : section->line, section->label, key, what);
	return GZ_ERR_FORMAT;
}

/* Add the trials that match a name. @return whether any does */
static bool choose_named(const struct gz_experiment *experiment, const char *name,
			 size_t chosen[GZ_EXPERIMENT_SECTIONS_MAX], size_t *count)
{
	bool any = false;
	for (size_t i = 0; i < experiment->trial_count; i++) {
		bool there = false;
		if (fnmatch(name, experiment->trials[i].label, 0) != 0)
			continue;
		any = true;
		for (size_t k = 0; k < *count; k++)
			there = there || chosen[k] == i;
		if (!there)
			chosen[(*count)++] = i;
	}
	return any;
}

static enum gz_result choose_trials(const struct resolver *resolver,
				    const struct gz_experiment_section *section,
				    const struct gz_block_params *params,
				    size_t chosen[GZ_EXPERIMENT_SECTIONS_MAX], size_t *out_count)
{
	char text[GZ_INI_LINE_SIZE], what[96];
	char *words[GZ_INI_LINE_SIZE];
	memcpy(text, params->trials, sizeof text);
	size_t words_count = split_names(text, words, GZ_INI_LINE_SIZE), count = 0;
	for (size_t i = 0; i < words_count; i++) {
		if (choose_named(resolver->experiment, words[i], chosen, &count))
			continue;
		snprintf(what, sizeof what, "no [trial %.50s]; correct the name", words[i]);
		return refuse_block(resolver, section, "trials", what);
	}
	if (count == 0)
		return refuse_block(resolver, section, "trials", "no trial named; * matches all");
	*out_count = count;
	return GZ_OK;
}

static enum gz_result take_block_params(const struct gz_experiment_section *section,
					struct gz_block_params *params)
{
	const struct gz_option_binding binding = { gz_block_options, gz_block_option_count, params,
						   NULL };
	enum gz_result result = gz_options_preset(&binding);
	for (size_t i = 0; i < section->setting_count && result == GZ_OK; i++) {
		const struct gz_experiment_setting *setting = &section->settings[i];
		if (setting->own)
			result = gz_option_parse(gz_options_find(&binding, 1, setting->key, NULL),
						 setting->value, params, NULL, 0);
	}
	unescape(params->break_text);
	unescape(params->instructions);
	return result;
}

static enum gz_result make_conditions(const struct resolver *resolver,
				      const struct gz_experiment_section *section,
				      const size_t *chosen, struct gz_block *block)
{
	enum gz_result result = GZ_OK;
	for (size_t i = 0; i < block->condition_count && result == GZ_OK; i++) {
		const struct gz_experiment_section *trial =
			&resolver->experiment->trials[chosen[i]];
		struct gz_condition *condition = &block->conditions[i];
		memcpy(condition->label, trial->label, sizeof condition->label);
		condition->line = trial->line;
		const struct maker maker = {
			.experiment = resolver->experiment,
			.log = resolver->log,
			.levels = { &resolver->experiment->common, section, trial },
			.condition = condition,
		};
		result = make_condition(&maker);
	}
	return result;
}

static enum gz_result make_block(struct resolver *resolver,
				 const struct gz_experiment_section *section,
				 struct gz_block *block)
{
	size_t chosen[GZ_EXPERIMENT_SECTIONS_MAX] = { 0 }, count = 0;
	memcpy(block->label, section->label, sizeof block->label);
	block->line = section->line;
	enum gz_result result = take_block_params(section, &block->params);
	if (result == GZ_OK && block->params.instructions[0] && block->params.instructions_file[0])
		result = refuse_block(resolver, section, "instructions_file",
				      "given together with instructions; keep one");
	if (result == GZ_OK)
		result = choose_trials(resolver, section, &block->params, chosen, &count);
	if (result != GZ_OK)
		return result;
	resolver->presentations += count * (size_t)block->params.repeats;
	if (resolver->presentations > GZ_EXPERIMENT_TRIALS_MAX)
		return refuse_block(resolver, section, "repeats",
				    "more than 10000 trials in total; reduce them");
	block->conditions = calloc(count, sizeof *block->conditions);
	if (!block->conditions)
		return GZ_ERR_NO_MEM;
	block->condition_count = count;
	return make_conditions(resolver, section, chosen, block);
}

static enum gz_result refuse_common(const struct resolver *resolver, const char *key,
				    const char *what)
{
	const struct gz_experiment *experiment = resolver->experiment;
	const struct gz_experiment_setting *setting =
		gz_experiment_find_setting(&experiment->common, key, -1);
	gz_err(resolver->log, "%s:%d: [experiment] %s: %s", experiment->path,
	       setting                   ? setting->line
	       : experiment->common.line ? experiment->common.line
					 : 1,
	       key, what);
	return GZ_ERR_FORMAT;
}

static enum gz_result check_common(const struct resolver *resolver)
{
	struct gz_experiment *experiment = resolver->experiment;
	struct gz_experiment_params *params = &experiment->params;
	if (!gz_experiment_is_word(params->name))
		return refuse_common(resolver, "name",
				     params->name[0] ? "only letters and digits are allowed"
						     : "missing; use letters and digits");
	if (params->instructions[0] && params->instructions_file[0])
		return refuse_common(resolver, "instructions_file",
				     "given together with instructions; keep one");
	if (experiment->trial_count == 0)
		return refuse_common(resolver, "name", "the file has no [trial NAME]; add one");
	unescape(params->instructions);
	unescape(params->goodbye);
	return GZ_OK;
}

enum gz_result gz_experiment_resolve(struct gz_experiment *experiment, const struct gz_log *log)
{
	static const struct gz_experiment_section all = { .label = "main" };
	struct resolver resolver = { .experiment = experiment, .log = log };
	size_t count = experiment->section_count ? experiment->section_count : 1;
	enum gz_result result = check_common(&resolver);
	if (result != GZ_OK)
		return result;
	experiment->blocks = calloc(count, sizeof *experiment->blocks);
	if (!experiment->blocks)
		return GZ_ERR_NO_MEM;
	experiment->block_count = count;
	for (size_t i = 0; i < count && result == GZ_OK; i++)
		result = make_block(&resolver,
				    experiment->section_count ? &experiment->sections[i] : &all,
				    &experiment->blocks[i]);
	return result;
}
