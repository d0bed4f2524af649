/* gazebench suggest: no more than the scene needs. */
#include "bench/gazebench/gazebench.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "bench/report/advice.h"
#include "bench/report/names.h"
#include "bench/report/summary_json.h"
#include "bench/study/study_folder.h"

#define GZ_LOG_MODULE "gazebench"

struct settings {
	struct gz_command_common common;
	char scene[GZ_PATH_SIZE];
	char transfer[GZ_STUDY_TEXT_SIZE];
	char backend[GZ_NAME_SIZE];
	int size[2];  /* 0 = all */
	double bound; /* NaN = not given */
	int metric, against;
	char out[GZ_PATH_SIZE];
	bool json;
};

_Static_assert(sizeof(enum gz_error_measure) == sizeof(int), "a CHOICE option writes an int");

enum { AGAINST_WHAT_IS_THERE };
static const char *const against_names[] = { "auto", "converged", "standard", NULL };

static const struct gz_option options[] = {
	GZ_COMMAND_HELP_OPTION,
	{ .key = "scene",
	  .type = GZ_OPTION_STRING,
	  .offset = offsetof(struct settings, scene),
	  .max = GZ_PATH_SIZE,
	  .preset = "",
	  .help = "the scene: its name in the study, or its file (default: the only one)" },
	{ .key = "transfer",
	  .type = GZ_OPTION_STRING,
	  .offset = offsetof(struct settings, transfer),
	  .max = GZ_STUDY_TEXT_SIZE,
	  .preset = "",
	  .help = "only this transfer function (default: all)" },
	{ .key = "size",
	  .type = GZ_OPTION_SIZE,
	  .offset = offsetof(struct settings, size),
	  .min = 1,
	  .max = GZ_IMAGE_SIDE_MAX,
	  .help = "only this size (default: all)" },
	{ .key = "backend",
	  .type = GZ_OPTION_STRING,
	  .offset = offsetof(struct settings, backend),
	  .max = GZ_NAME_SIZE,
	  .preset = "",
	  .help = "only this backend (default: all)" },
	{ .key = "metric",
	  .type = GZ_OPTION_CHOICE,
	  .offset = offsetof(struct settings, metric),
	  .choices = gz_error_metric_keys,
	  .preset = "perceived_flip",
	  .help = "the bounded error" },
	{ .key = "bound",
	  .type = GZ_OPTION_DOUBLE,
	  .offset = offsetof(struct settings, bound),
	  .min = 0,
	  .max = 1000,
	  .help = "its greatest value; for SSIM and PSNR, its least (default " GZ_ADVICE_BOUND
		  ", FLIP only)" },
	{ .key = "against",
	  .type = GZ_OPTION_CHOICE,
	  .offset = offsetof(struct settings, against),
	  .choices = against_names,
	  .preset = "auto",
	  .help = "reference of the error; auto = converged if measured" },
	{ .key = "out",
	  .type = GZ_OPTION_STRING,
	  .offset = offsetof(struct settings, out),
	  .max = GZ_PATH_SIZE,
	  .preset = "",
	  .help = "write a copy of the scene with these settings; must not exist yet" },
	{ .key = "json",
	  .type = GZ_OPTION_BOOL,
	  .offset = offsetof(struct settings, json),
	  .preset = "false",
	  .help = "print the result as JSON" },
};

/* "etc/scenes/head.scene" is the scene "head". */
static bool is_scene(const struct gz_study_scene *scene, const char *asked)
{
	const char *slash = strrchr(asked, '/'), *file = slash ? slash + 1 : asked;
	const size_t length = strlen(scene->name);
	return strcmp(scene->name, asked) == 0 || strcmp(scene->path, asked) == 0 ||
	       (strncmp(file, scene->name, length) == 0 && strcmp(file + length, ".scene") == 0);
}

static bool is_asked(const struct gz_study *study, const struct gz_group *group,
		     const struct settings *settings)
{
	const struct gz_study_scene *scene = &study->scenes[group->scene];
	const int *size = study->sizes[group->size];
	return (!settings->scene[0] || is_scene(scene, settings->scene)) &&
	       (!settings->transfer[0] || strcmp(scene->transfer, settings->transfer) == 0) &&
	       (!settings->backend[0] ||
		strcmp(study->backends[group->backend], settings->backend) == 0) &&
	       (settings->size[0] == 0 ||
		(size[0] == settings->size[0] && size[1] == settings->size[1]));
}

/* The groups in question, all of one scene; NULL and logged if there are none. */
static const struct gz_group **choose_groups(const struct gz_summary *summary,
					     const struct settings *settings,
					     const struct gz_log *log, size_t *out_count)
{
	const struct gz_study *study = summary->study;
	const struct gz_group **groups = calloc(summary->group_count, sizeof(void *));
	size_t count = 0;
	for (size_t i = 0; groups && i < summary->group_count; i++)
		if (is_asked(study, &summary->groups[i], settings))
			groups[count++] = &summary->groups[i];
	const char *fault = !groups ? "not enough memory" : NULL;
	if (groups && count == 0)
		fault = "nothing was measured of this scene, transfer function, size and backend; "
			"summary.json lists what was";
	for (size_t i = 1; i < count; i++)
		if (strcmp(study->scenes[groups[i]->scene].name,
			   study->scenes[groups[0]->scene].name) != 0)
			fault = "several scenes were measured; say which with --scene";
	if (!fault) {
		*out_count = count;
		return groups;
	}
	gz_err(log, "%s", fault);
	free(groups);
	return NULL;
}

static void make_question(const struct settings *settings, const struct gz_group *group,
			  struct gz_advice_question *out_question)
{
	*out_question = gz_advice_preset(group);
	out_question->measure = (enum gz_error_measure)settings->metric;
	if (settings->against != AGAINST_WHAT_IS_THERE)
		out_question->reference = (enum gz_error_reference)(settings->against - 1);
	if (!isnan(settings->bound))
		out_question->bound = settings->bound;
}

/* Place of a variant among a group's series. */
static size_t series_of(const struct gz_group *group, size_t variant)
{
	for (size_t i = 0; i < group->series_count; i++)
		if (group->series[i].variant == variant)
			return i;
	return GZ_SERIES_NONE;
}

static void print_words(const struct gz_study *study, const struct gz_group *const *groups,
			size_t count, const struct gz_advice_question *question, size_t variant)
{
	for (size_t i = 0; i < count; i++) {
		struct gz_text text = { 0 };
		const size_t series =
			variant == GZ_SERIES_NONE ? GZ_SERIES_NONE : series_of(groups[i], variant);
		gz_advice_tell(study, groups[i], question, series, false, &text);
		printf("%s\n", text.bytes ? text.bytes : "");
		gz_text_free(&text);
	}
}

static json_t *advice_number(double value)
{
	return isfinite(value) ? json_real(value) : isnan(value) ? json_null() : json_string("inf");
}

static json_t *size_to_json(const struct gz_study *study, const struct gz_group *group,
			    const struct gz_advice_question *question, size_t place)
{
	const struct gz_series *series = &group->series[place];
	const struct gz_error_summary *errors =
		&series->errors[question->reference][question->measure];
	const double standard_ms =
		group->standard == GZ_SERIES_NONE ? NAN : group->series[group->standard].typical_ms;
	return json_pack("{s:s, s:[i,i], s:s, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:i}", "transfer",
			 study->scenes[group->scene].transfer, "size", study->sizes[group->size][0],
			 study->sizes[group->size][1], "backend", study->backends[group->backend],
			 "ms", advice_number(series->typical_ms), "standard_ms",
			 advice_number(standard_ms), "ratio", advice_number(series->ratio_of_means),
			 "rays", advice_number(series->rays), "mean", advice_number(errors->mean),
			 "p95", advice_number(errors->p95), "worst", advice_number(errors->worst),
			 "points", (int)errors->count);
}

static enum gz_result print_advice_json(const struct gz_study *study,
					const struct gz_group *const *groups, size_t count,
					const struct gz_advice_question *question, size_t variant,
					const char *out)
{
	json_t *list = json_array();
	const size_t shown = variant == GZ_SERIES_NONE ? 0 : variant;
	for (size_t i = 0; i < count; i++) {
		const size_t place = series_of(groups[i], shown);
		if (place != GZ_SERIES_NONE)
			json_array_append_new(list,
					      size_to_json(study, groups[i], question, place));
	}
	json_t *json =
		json_pack("{s:s, s:s, s:b, s:s, s:f, s:s, s:s?, s:o}", "scene",
			  study->scenes[groups[0]->scene].name, "variant",
			  study->variants[shown].text, "holds", variant != GZ_SERIES_NONE, "metric",
			  gz_error_metrics[question->measure].key, "bound", question->bound,
			  "against", gz_error_reference_names[question->reference], "file",
			  out[0] ? out : NULL, "measured", list);
	const bool printed =
		json && json_dumpf(json, stdout, JSON_INDENT(1) | JSON_REAL_PRECISION(9)) == 0;
	putchar('\n');
	json_decref(json);
	return printed ? GZ_OK : GZ_ERR_IO;
}

static enum gz_result write_scene(const struct gz_study *study, const struct gz_group *group,
				  const struct settings *settings, size_t variant,
				  const struct gz_log *log)
{
	const struct gz_study_variant standard = { .text = "standard", .method = "standard" };
	const char *path = study->scenes[group->scene].path;
	const size_t length = strlen(settings->scene);
	if (length > 6 && strcmp(settings->scene + length - 6, ".scene") == 0)
		path = settings->scene;
	return gz_scene_copy_with(path, settings->out,
				  variant == GZ_SERIES_NONE ? &standard : &study->variants[variant],
				  log);
}

static enum gz_result suggest(const struct gz_summary *summary, const struct settings *settings,
			      const struct gz_log *log)
{
	const struct gz_study *study = summary->study;
	struct gz_advice_question question;
	size_t count;
	const struct gz_group **groups = choose_groups(summary, settings, log, &count);
	if (!groups)
		return GZ_ERR_NOT_FOUND;
	enum gz_result result = GZ_OK;
	make_question(settings, groups[0], &question);
	if (!gz_advice_has_errors(groups, count, &question)) {
		gz_err(log, "%s against %s was not measured in this study",
		       gz_error_metrics[question.measure].title,
		       gz_error_reference_names[question.reference]);
		result = GZ_ERR_NOT_FOUND;
	}
	if (result == GZ_OK) {
		const size_t variant = gz_advice_choose(study, groups, count, &question);
		if (settings->out[0])
			result = write_scene(study, groups[0], settings, variant, log);
		if (result == GZ_OK && settings->json)
			result = print_advice_json(study, groups, count, &question, variant,
						   settings->out);
		else if (result == GZ_OK)
			print_words(study, groups, count, &question, variant);
	}
	free(groups);
	return result;
}

static enum gz_result suggest_from(const char *folder, const struct settings *settings,
				   const struct gz_log *log)
{
	struct gz_study study;
	struct gz_summary summary;
	enum gz_result result = gz_study_read(folder, log, &study);
	if (result != GZ_OK)
		return result;
	result = gz_summary_make(&study, &summary);
	if (result != GZ_OK)
		gz_err(log, "%s: %s", folder,
		       result == GZ_ERR_END ? "no frame was measured yet" : gz_result_text(result));
	if (result == GZ_OK && (!study.complete || study.shard_count > 1))
		gz_warn(log, "%s: a partial study: its other points may need more", folder);
	if (result == GZ_OK) {
		result = suggest(&summary, settings, log);
		gz_summary_free(&summary);
	}
	gz_study_free(&study);
	return result;
}

static int run_suggest(int argc, char *const *argv, const struct gz_log *log)
{
	struct settings settings = { .bound = NAN };
	struct gz_operands operands;
	int status = gz_command_read_arguments(&gazebench_suggest, argc, argv, log, &settings,
					       &operands);
	if (status != GZ_COMMAND_GO_ON)
		return status;
	if (operands.count != 1) {
		gz_err(log, "give one folder: gazebench suggest DIR");
		return GAZEBENCH_USAGE;
	}
	if (isnan(settings.bound) && gz_error_rises(gz_error_metrics[settings.metric].kind)) {
		gz_err(log, "give --bound: the least %s", gz_error_metrics[settings.metric].title);
		return GAZEBENCH_USAGE;
	}
	return suggest_from(operands.items[0], &settings, log) == GZ_OK ? GAZEBENCH_DONE
									: GAZEBENCH_FAILED;
}

const struct gz_command gazebench_suggest = {
	.program = "gazebench",
	.name = "suggest",
	.operands = "DIR",
	.operands_max = 1,
	.summary = "name the cheapest setting whose error stays within a bound",
	.details =
		"Chooses the fastest variant of the study that stays within the bound at every "
		"measured gaze\n"
		"point, at all sizes and backends in question. If none does, standard remains.\n"
		"--out writes a copy of the scene with its settings; other lines do not change.\n",
	.options = options,
	.option_count = sizeof options / sizeof options[0],
	.run = run_suggest,
};
