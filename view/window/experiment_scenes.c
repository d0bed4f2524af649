/* Scenes of an experiment. Those of a block are held ready as memory allows, so that nothing is
 * loaded while a trial is shown. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "view/window/experiment.h"
#include "view/window/window_state.h"

#define GZ_LOG_MODULE "experiment"

/* Share of free memory from which scenes of later trials are loaded, and below which they are
 * released (chosen: room for a volume as large as those loaded). */
#define FREE_TO_LOAD 0.5
#define FREE_TO_KEEP 0.25

/* Share of the machine's memory that is available; 1: not known. */
static double free_memory_share(void)
{
	double total = 0, available = 0;
	char line[128];
	FILE *file = fopen("/proc/meminfo", "r");
	while (file && fgets(line, sizeof line, file)) {
		sscanf(line, "MemTotal: %lf", &total);
		sscanf(line, "MemAvailable: %lf", &available);
	}
	if (file)
		fclose(file);
	return total > 0 && available > 0 ? available / total : 1;
}

static struct gz_experiment_scene *find_scene(const struct gz_window_experiment *state,
					      const char *path)
{
	struct gz_experiment_scene *scene = state->scenes;
	while (scene && strcmp(scene->path, path) != 0)
		scene = scene->next;
	return scene;
}

static struct gz_experiment_scene *find_or_add_scene(struct gz_window_experiment *state,
						     const char *path)
{
	struct gz_experiment_scene *scene = find_scene(state, path);
	if (scene)
		return scene;
	scene = calloc(1, sizeof *scene);
	if (!scene)
		return NULL;
	snprintf(scene->path, sizeof scene->path, "%s", path);
	scene->next = state->scenes;
	state->scenes = scene;
	return scene;
}

static const struct gz_presentation *current_trial(const struct gz_window_experiment *state)
{
	const struct gz_sequence *sequence = &state->sitting->sequence;
	return state->run.index < sequence->count ? &sequence->presentations[state->run.index]
						  : NULL;
}

static bool trial_shows(const struct gz_presentation *presentation, const char *path)
{
	const struct gz_condition *condition = presentation->condition;
	for (int i = 0; i < condition->params.intervals; i++)
		if (strcmp(condition->alternatives[i].scene, path) == 0)
			return true;
	return false;
}

/* Release scenes that the present trial does not show. @return whether there were any */
static bool release_other_scenes(struct gz_window *window)
{
	struct gz_window_experiment *state = window->experiment;
	const struct gz_presentation *presentation = current_trial(state);
	bool any = false;
	for (struct gz_experiment_scene *scene = state->scenes; scene; scene = scene->next) {
		if (!scene->held || (presentation && trial_shows(presentation, scene->path)))
			continue;
		if (state->shown && strcmp(state->shown->scene, scene->path) == 0)
			state->shown = NULL;
		gz_window_release(window, &scene->held);
		any = true;
	}
	return any;
}

static enum gz_result begin_preload(struct gz_window *window, struct gz_experiment_scene *scene)
{
	struct gz_window_load_request *request = calloc(1, sizeof *request);
	if (!request)
		return GZ_ERR_NO_MEM;
	memcpy(request->path, scene->path, sizeof request->path);
	const enum gz_result r = gz_window_preload(window, request, &scene->held);
	free(request);
	return r;
}

/* Load a scene that failed once more, after others have made room. */
static enum gz_result retry_failed(struct gz_window *window, struct gz_experiment_scene *scene)
{
	if (gz_window_held_state(scene->held, NULL) != GZ_HELD_FAILED)
		return GZ_OK;
	gz_window_release(window, &scene->held);
	if (!scene->retried && release_other_scenes(window)) {
		scene->retried = true;
		gz_warn(window->log, "%s: loading it again without the scenes of other trials",
			scene->path);
		return begin_preload(window, scene);
	}
	return GZ_ERR_IO;
}

static bool is_any_coming(const struct gz_window_experiment *state)
{
	for (const struct gz_experiment_scene *scene = state->scenes; scene; scene = scene->next)
		if (scene->held && gz_window_held_state(scene->held, NULL) == GZ_HELD_COMING)
			return true;
	return false;
}

/* Load one scene at a time, in the order in which they are shown. */
static enum gz_result load_scenes_of(struct gz_window *window,
				     const struct gz_presentation *presentation, bool needed)
{
	struct gz_window_experiment *state = window->experiment;
	const struct gz_condition *condition = presentation->condition;
	for (int i = 0; i < condition->params.intervals; i++) {
		const int which = gz_presentation_alternative(presentation, i);
		struct gz_experiment_scene *scene =
			find_or_add_scene(state, condition->alternatives[which].scene);
		if (!scene)
			return GZ_ERR_NO_MEM;
		if (scene->held) {
			const enum gz_result r = needed ? retry_failed(window, scene) : GZ_OK;
			if (r != GZ_OK)
				return r;
		} else if (!is_any_coming(state)) {
			if (!needed && free_memory_share() < FREE_TO_LOAD)
				return GZ_OK;
			if (needed && free_memory_share() < FREE_TO_KEEP)
				release_other_scenes(window);
			return begin_preload(window, scene);
		}
	}
	return GZ_OK;
}

enum gz_result gz_experiment_load_ahead(struct gz_window *window)
{
	const struct gz_window_experiment *state = window->experiment;
	const struct gz_sequence *sequence = &state->sitting->sequence;
	const struct gz_presentation *presentation = current_trial(state);
	/* Loading begins only while no picture is shown. */
	const bool resting = state->run.phase == GZ_RUN_TEXT || state->run.phase == GZ_RUN_PREPARE;
	if (!presentation)
		return GZ_OK;
	enum gz_result r = load_scenes_of(window, presentation, true);
	for (size_t i = state->run.index; r == GZ_OK && resting && i < sequence->count; i++) {
		if (sequence->presentations[i].block != presentation->block || is_any_coming(state))
			break;
		r = load_scenes_of(window, &sequence->presentations[i], false);
	}
	return r;
}

bool gz_experiment_scenes_ready(const struct gz_window_experiment *state)
{
	const struct gz_presentation *presentation = current_trial(state);
	if (!presentation || is_any_coming(state))
		return false;
	for (int i = 0; i < presentation->condition->params.intervals; i++) {
		const struct gz_experiment_scene *scene =
			find_scene(state, presentation->condition->alternatives[i].scene);
		if (!scene || !scene->held ||
		    gz_window_held_state(scene->held, NULL) != GZ_HELD_READY)
			return false;
	}
	return true;
}

double gz_experiment_loaded_share(const struct gz_window_experiment *state)
{
	double done = 0, count = 0;
	for (const struct gz_experiment_scene *scene = state->scenes; scene; scene = scene->next) {
		double share = 0;
		if (scene->held)
			gz_window_held_state(scene->held, &share);
		done += share;
		count++;
	}
	return is_any_coming(state) && count > 0 ? done / count : 1;
}

enum gz_result gz_experiment_show(struct gz_window *window,
				  const struct gz_alternative *alternative)
{
	struct gz_window_experiment *state = window->experiment;
	const struct gz_experiment_scene *scene = find_scene(state, alternative->scene);
	const bool there = window->maker && state->shown &&
			   strcmp(state->shown->scene, alternative->scene) == 0;
	if (there && state->shown == alternative)
		return GZ_OK;
	if (!scene || !scene->held)
		return GZ_ERR_INVAL;
	enum gz_result r = there ? GZ_OK : gz_window_show(window, scene->held);
	if (r != GZ_OK)
		return r;
	struct gz_scene_settings settings = gz_frame_maker_scene(window->maker)->settings;
	settings.view = state->view;
	r = gz_alternative_apply(alternative, &settings);
	if (r == GZ_OK)
		r = gz_scene_load_table(alternative->scene, window->log, &settings.foveation);
	if (r == GZ_OK)
		r = gz_scene_find_cube(alternative->scene, window->log, &settings.rays.environment);
	if (r != GZ_OK)
		return r;
	window->settings = settings;
	window->cast_needed = true;
	state->shown = alternative;
	state->frame_made = false;
	return GZ_OK;
}

void gz_experiment_release_scenes(struct gz_window *window)
{
	struct gz_window_experiment *state = window->experiment;
	while (state->scenes) {
		struct gz_experiment_scene *scene = state->scenes;
		state->scenes = scene->next;
		gz_window_release(window, &scene->held);
		free(scene);
	}
}
