#include "bench/report/advice.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/file.h"
#include "base/ini.h"
#include "bench/report/names.h"
#include "bench/report/template.h"
#include "render/plan/plan.h"
#include "render/raycast/shared/ray_params.h"
#include "render/scene/scene.h"
#include "render/scene/scene_files.h"

#define GZ_LOG_MODULE "scene"

struct gz_advice_question gz_advice_preset(const struct gz_group *group)
{
	return (struct gz_advice_question) { GZ_PERCEIVED_FLIP, gz_group_reference(group),
					     strtod(GZ_ADVICE_BOUND, NULL) };
}

size_t gz_advice_find(const struct gz_group *group, const struct gz_advice_question *question)
{
	const enum gz_error_kind kind = gz_error_metrics[question->measure].kind;
	return gz_group_cheapest_within(group, question->reference, question->measure,
					gz_error_cost(kind, question->bound));
}

static const struct gz_error_summary *errors_of(const struct gz_group *group, size_t series,
						const struct gz_advice_question *question)
{
	return &group->series[series].errors[question->reference][question->measure];
}

size_t gz_advice_nearest(const struct gz_group *group, const struct gz_advice_question *question)
{
	const enum gz_error_kind kind = gz_error_metrics[question->measure].kind;
	size_t best = GZ_SERIES_NONE;
	double least = INFINITY;
	for (size_t i = 0; i < group->series_count; i++) {
		const double cost = gz_error_cost(kind, errors_of(group, i, question)->worst);
		if (i != group->standard && cost < least) {
			least = cost;
			best = i;
		}
	}
	return best;
}

bool gz_advice_has_errors(const struct gz_group *const *groups, size_t count,
			  const struct gz_advice_question *question)
{
	for (size_t i = 0; i < count; i++)
		for (size_t k = 0; k < groups[i]->series_count; k++)
			if (errors_of(groups[i], k, question)->count > 0)
				return true;
	return false;
}

/* Logarithm of a variant's time over standard's in a group; NaN where it does not hold the bound,
 * which points without an error do not. */
static double log_time(const struct gz_group *group, size_t variant,
		       const struct gz_advice_question *question)
{
	const enum gz_error_kind kind = gz_error_metrics[question->measure].kind;
	const double limit = gz_error_cost(kind, question->bound);
	for (size_t i = 0; i < group->series_count; i++) {
		const struct gz_series *series = &group->series[i];
		const struct gz_error_summary *errors = errors_of(group, i, question);
		if (series->variant != variant)
			continue;
		if (errors->count < series->point_count ||
		    !(gz_error_cost(kind, errors->worst) <= limit))
			return NAN;
		return log(series->typical_ms) -
		       (group->standard == GZ_SERIES_NONE
				? 0
				: log(group->series[group->standard].typical_ms));
	}
	return NAN;
}

size_t gz_advice_choose(const struct gz_study *study, const struct gz_group *const *groups,
			size_t count, const struct gz_advice_question *question)
{
	size_t best = GZ_SERIES_NONE;
	double least = INFINITY;
	for (size_t variant = 0; variant < study->variant_count; variant++) {
		double sum = 0;
		for (size_t i = 0; i < count; i++)
			sum += log_time(groups[i], variant, question);
		if (sum < least) { /* not if it is NaN */
			least = sum;
			best = variant;
		}
	}
	return best;
}

/* Writes words, for a page or a terminal. */
struct teller {
	const struct gz_study *study;
	const struct gz_group *group;
	const struct gz_advice_question *question;
	bool html;
	struct gz_text *out;
};

static void say(const struct teller *teller, const char *text)
{
	if (teller->html)
		gz_text_add_escaped(teller->out, text);
	else
		gz_text_add(teller->out, "%s", text);
}

static void stress(const struct teller *teller, const char *text)
{
	gz_text_add(teller->out, "%s", teller->html ? "<strong>" : "");
	say(teller, text);
	gz_text_add(teller->out, "%s", teller->html ? "</strong>" : "");
}

/* Never as a power of ten: 110 %, 31 %, 2.5 %. */
static void percent_words(double share, char text[static GZ_NAMES_SIZE])
{
	const double percent = 100 * share;
	snprintf(text, GZ_NAMES_SIZE, percent < 9.95 ? "%.2g %%" : "%.0f %%", percent);
}

/* The ratio of the mean times, and between which values it lies. */
static void say_ratio(const struct teller *teller, const struct gz_series *series)
{
	char text[GZ_NAMES_SIZE];
	const struct gz_interval *interval = &series->ratio_interval;
	const double ratio = series->ratio_of_means;
	const bool slower = ratio < 1;
	snprintf(text, sizeof text, "%.3g times as %s", slower ? 1 / ratio : ratio,
		 slower ? "long" : "fast");
	stress(teller, text);
	if (isnan(interval->low)) {
		say(teller, " (mean time over mean time)");
		return;
	}
	snprintf(text, sizeof text,
		 " (mean time over mean time; 95 %% confidence interval %.3g to %.3g)",
		 slower ? 1 / interval->high : interval->low,
		 slower ? 1 / interval->low : interval->high);
	say(teller, text);
}

static void say_time(const struct teller *teller, const struct gz_series *series, const char *takes)
{
	char text[GZ_NAMES_SIZE], share[GZ_NAMES_SIZE];
	const struct gz_group *group = teller->group;
	gz_variant_words(&teller->study->variants[series->variant], text);
	stress(teller, text);
	say(teller, takes);
	snprintf(text, sizeof text, "%.3g ms", series->typical_ms);
	stress(teller, text);
	say(teller, " a frame");
	if (group->standard == GZ_SERIES_NONE || series == &group->series[group->standard])
		return;
	snprintf(text, sizeof text, " where a ray for every pixel takes %.3g ms: ",
		 group->series[group->standard].typical_ms);
	say(teller, text);
	say_ratio(teller, series);
	const int *size = teller->study->sizes[group->size];
	percent_words(series->rays / ((double)size[0] * size[1]), share);
	say(teller, ", with ");
	say(teller, share);
	say(teller, " of the rays");
}

static void say_errors(const struct teller *teller, size_t series)
{
	char text[2 * GZ_NAMES_SIZE];
	const struct gz_error_metric *metric = &gz_error_metrics[teller->question->measure];
	const struct gz_error_summary *errors = errors_of(teller->group, series, teller->question);
	snprintf(text, sizeof text,
		 "%s against %s is %.3g on average and %.3g at worst of %zu %s of the gaze%s.",
		 metric->title, gz_error_reference_names[teller->question->reference], errors->mean,
		 errors->worst, errors->count, errors->count == 1 ? "place" : "places",
		 metric->kind == GZ_ERROR_FLIP ? " (0 = identical, 1 = maximally different)" : "");
	say(teller, text);
}

static void tell_winner(const struct teller *teller, size_t winner)
{
	char text[GZ_NAMES_SIZE];
	const struct gz_error_metric *metric = &gz_error_metrics[teller->question->measure];
	say_time(teller, &teller->group->series[winner], " takes ");
	snprintf(text, sizeof text, ". The difference stays %s the bound of %g everywhere: ",
		 gz_error_rises(metric->kind) ? "above" : "below", teller->question->bound);
	say(teller, text);
	say_errors(teller, winner);
}

/* Slower variants may hold the bound too; then standard is not called the only one. */
static void tell_standard(const struct teller *teller, size_t winner)
{
	char text[GZ_NAMES_SIZE];
	const struct gz_error_metric *metric = &gz_error_metrics[teller->question->measure];
	const size_t nearest = gz_advice_nearest(teller->group, teller->question);
	snprintf(text, sizeof text, "%s keeps %s %s %g everywhere",
		 winner == GZ_SERIES_NONE ? "nothing that was measured" : "nothing faster",
		 metric->title, gz_error_rises(metric->kind) ? "above" : "below",
		 teller->question->bound);
	stress(teller, text);
	say(teller, ", so that standard remains. ");
	if (nearest == GZ_SERIES_NONE)
		return;
	say(teller, "Nearest comes ");
	say_time(teller, &teller->group->series[nearest], ", which takes ");
	say(teller, "; its ");
	say_errors(teller, nearest);
}

/* How far times can be trusted, and what of the claim they leave open. */
static void tell_noise(const struct teller *teller, size_t told)
{
	char text[2 * GZ_NAMES_SIZE], noise[GZ_NAMES_SIZE], words[GZ_NAMES_SIZE];
	const struct gz_group *group = teller->group;
	const enum gz_error_kind kind = gz_error_metrics[teller->question->measure].kind;
	if (isnan(group->noise))
		return;
	percent_words(group->noise, noise);
	say(teller, " Noise: ");
	say(teller, group->noise_of_frames
			    ? "standard's frames of one place should take equally long"
			    : "standard ignores the gaze and should take equally long everywhere");
	snprintf(text, sizeof text, "; 90 of 100 of its times lie within ±%s.", noise);
	say(teller, text);
	if (told == GZ_SERIES_NONE)
		return;
	const size_t rival =
		gz_group_rival(group, told, teller->question->reference, teller->question->measure,
			       gz_error_cost(kind, teller->question->bound));
	if (rival == GZ_SERIES_NONE)
		return;
	gz_variant_words(&teller->study->variants[group->series[rival].variant], words);
	snprintf(text, sizeof text,
		 "Warning: %s holds the bound too, and its time (%.3g ms) differs by less than "
		 "this noise. Which of both is faster is not known.",
		 words, group->series[rival].typical_ms);
	say(teller, " ");
	stress(teller, text);
}

static void tell_fastest(const struct teller *teller)
{
	const struct gz_group *group = teller->group;
	size_t fastest = 0;
	for (size_t i = 1; i < group->series_count; i++)
		if (group->series[i].typical_ms < group->series[fastest].typical_ms)
			fastest = i;
	say_time(teller, &group->series[fastest], " takes ");
	say(teller, ". Errors of this kind were not measured, so that what it costs is not known.");
}

void gz_advice_tell(const struct gz_study *study, const struct gz_group *group,
		    const struct gz_advice_question *question, size_t series, bool html,
		    struct gz_text *out)
{
	char words[GZ_NAMES_SIZE];
	const struct teller teller = { study, group, question, html, out };
	gz_group_words(study, group, words);
	say(&teller, "On ");
	say(&teller, words);
	say(&teller, ", ");
	if (!gz_advice_has_errors(&group, 1, question))
		tell_fastest(&teller);
	else if (series == GZ_SERIES_NONE || series == group->standard)
		tell_standard(&teller, series);
	else
		tell_winner(&teller, series);
	tell_noise(&teller, series);
}

/* ---- scene files ---- */

/* The section of an option in scenes; NULL if it has none. */
static const char *section_of(const char *name)
{
	struct gz_foveation foveation;
	struct gz_ray_params rays;
	const struct {
		const char *section;
		struct gz_option_binding binding;
	} tables[] = {
		{ "foveation",
		  { gz_foveation_options, gz_foveation_option_count, &foveation, NULL } },
		{ "render", { gz_ray_options, gz_ray_option_count, &rays, NULL } },
	};
	for (size_t i = 0; i < sizeof tables / sizeof tables[0]; i++) {
		char key[GZ_STUDY_TEXT_SIZE + 16];
		snprintf(key, sizeof key, "%s.%s", tables[i].section, name);
		if (gz_options_find(&tables[i].binding, 1, key, NULL))
			return tables[i].section;
	}
	return NULL;
}

enum gz_result gz_scene_text_set_variant(struct gz_text *text,
					 const struct gz_study_variant *variant,
					 const struct gz_log *log)
{
	char copy[GZ_STUDY_TEXT_SIZE];
	snprintf(copy, sizeof copy, "%s", variant->text);
	char *rest = copy;
	strsep(&rest, ":");
	gz_ini_text_set(text, "foveation", "method", variant->method);
	for (char *option = strsep(&rest, ":"); option; option = strsep(&rest, ":")) {
		char *value = strchr(option, '=');
		if (value)
			*value++ = '\0';
		const char *section = section_of(option);
		if (!section || !value) {
			gz_err(log, "%s: %s is not an option of a scene", variant->text, option);
			return GZ_ERR_INVAL;
		}
		gz_ini_text_set(text, section, option, value);
	}
	return GZ_OK;
}

/* Names of files must be found from the copy's place too. */
static enum gz_result move_copy(struct gz_text *text, const char *scene, const char *copy,
				const struct gz_log *log)
{
	struct gz_scene_settings settings;
	bool has_display;
	const enum gz_result result =
		gz_scene_parse(copy, text->bytes, text->length, log, &settings, &has_display);
	return result == GZ_OK ? gz_scene_text_move_files(text, &settings, scene, copy, log)
			       : result;
}

enum gz_result gz_scene_copy_with(const char *scene, const char *copy,
				  const struct gz_study_variant *variant, const struct gz_log *log)
{
	struct gz_text text = { 0 };
	if (access(copy, F_OK) == 0) {
		gz_err(log, "%s already exists: name another file, or remove it", copy);
		return GZ_ERR_BUSY;
	}
	enum gz_result result = gz_text_add_file(&text, scene);
	if (result != GZ_OK)
		gz_err(log, "%s: cannot be read (%s): --scene takes the path of the scene, too",
		       scene, gz_result_text(result));
	if (result == GZ_OK)
		result = gz_scene_text_set_variant(&text, variant, log);
	if (result == GZ_OK && !text.failed)
		result = move_copy(&text, scene, copy, log);
	if (result == GZ_OK)
		result = gz_text_write(&text, copy, log);
	gz_text_free(&text);
	return result;
}
