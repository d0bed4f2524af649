#include "view/settings/setting_history.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "view/settings/scene_keys.h"

/* A key and its values. */
struct change {
	size_t table;
	const struct gz_option *option;
	char *before, *after;
};

/* No changes: a foreign step. */
struct step {
	struct change *changes;
	size_t count;
	int64_t time_ns;
};

struct gz_setting_history {
	struct gz_scene_settings *live;
	struct gz_view_live_tables live_tables;
	struct gz_scene_settings noted; /* as of the last note */
	struct gz_view_live_tables noted_tables;
	struct step steps[GZ_SETTING_HISTORY_STEPS];
	size_t count; /* of the steps, the oldest first */
	size_t done;  /* of them, the ones that are not undone */
};

/* A panel that opens is no change to be undone. */
static bool is_watched(const struct gz_option *option)
{
	return strcmp(option->key, "view.frame_times") != 0;
}

/* Begin with what the settings are now. Other scenes have other objects. */
static void note_all(struct gz_setting_history *history)
{
	history->noted = *history->live;
	gz_view_pick_live_tables(history->live, &history->live_tables);
	gz_view_pick_live_tables(&history->noted, &history->noted_tables);
}

static void free_step(struct step *step)
{
	for (size_t i = 0; i < step->count; i++) {
		free(step->changes[i].before);
		free(step->changes[i].after);
	}
	free(step->changes);
	*step = (struct step) { 0 };
}

enum gz_result gz_setting_history_create(struct gz_scene_settings *settings,
					 struct gz_setting_history **out_history)
{
	struct gz_setting_history *history = calloc(1, sizeof *history);
	if (!history)
		return GZ_ERR_NO_MEM;
	history->live = settings;
	note_all(history);
	*out_history = history;
	return GZ_OK;
}

void gz_setting_history_destroy(struct gz_setting_history **history)
{
	if (!*history)
		return;
	for (size_t i = 0; i < (*history)->count; i++)
		free_step(&(*history)->steps[i]);
	free(*history);
	*history = NULL;
}

void gz_setting_history_restart(struct gz_setting_history *history)
{
	for (size_t i = 0; i < history->count; i++)
		free_step(&history->steps[i]);
	history->count = history->done = 0;
	note_all(history);
}

/* ---- noting ---- */

static char *value_text(const struct gz_option *option, const void *target)
{
	char text[GZ_OPTION_TEXT_SIZE];
	return gz_option_format(option, target, text, sizeof text) == GZ_OK ? strdup(text) : NULL;
}

/* Add a change to a step. @return false: no memory */
static bool add_change(struct step *step, size_t table, const struct gz_option *option,
		       const void *before, const void *after)
{
	struct change *grown = realloc(step->changes, (step->count + 1) * sizeof *grown);
	if (!grown)
		return false;
	step->changes = grown;
	grown[step->count++] = (struct change) {
		.table = table,
		.option = option,
		.before = value_text(option, before),
		.after = value_text(option, after),
	};
	return grown[step->count - 1].before && grown[step->count - 1].after;
}

/* @return false: no memory */
static bool find_changes(const struct gz_setting_history *history, struct step *step)
{
	for (size_t i = 0; i < history->live_tables.count; i++) {
		const struct gz_option_binding *live = &history->live_tables.bindings[i];
		const struct gz_option_binding *noted = &history->noted_tables.bindings[i];
		for (size_t k = 0; k < live->count; k++) {
			const struct gz_option *option = &live->options[k];
			if (is_watched(option) &&
			    !gz_option_same(option, noted->target, live->target) &&
			    !add_change(step, i, option, noted->target, live->target))
				return false;
		}
	}
	return true;
}

static void forget_undone(struct gz_setting_history *history)
{
	while (history->count > history->done)
		free_step(&history->steps[--history->count]);
}

/* Append a step; the oldest one makes room. */
static void push_step(struct gz_setting_history *history, struct step step)
{
	forget_undone(history);
	if (history->count == GZ_SETTING_HISTORY_STEPS) {
		free_step(&history->steps[0]);
		memmove(history->steps, history->steps + 1,
			(history->count - 1) * sizeof history->steps[0]);
		history->count--;
	}
	history->steps[history->count++] = step;
	history->done = history->count;
}

static bool is_of_camera(const struct step *step)
{
	for (size_t i = 0; i < step->count; i++)
		if (strncmp(step->changes[i].option->key, "camera.", 7) != 0)
			return false;
	return step->count > 0;
}

/* The change of the same key in another step; NULL: none. */
static struct change *same_change(struct step *step, const struct gz_option *option)
{
	for (size_t i = 0; i < step->count; i++)
		if (step->changes[i].option == option)
			return &step->changes[i];
	return NULL;
}

/* Make a step part of the last one, if it goes on with it. @return whether it does */
static bool merge_step(struct gz_setting_history *history, struct step *step)
{
	struct step *last = history->done > 0 ? &history->steps[history->done - 1] : NULL;
	if (!last || history->count > history->done || !is_of_camera(last) || !is_of_camera(step) ||
	    step->time_ns - last->time_ns > GZ_SETTING_HISTORY_MERGE_NS)
		return false;
	for (size_t i = 0; i < step->count; i++)
		if (!same_change(last, step->changes[i].option))
			return false;
	for (size_t i = 0; i < step->count; i++) {
		struct change *kept = same_change(last, step->changes[i].option);
		free(kept->after);
		kept->after = step->changes[i].after;
		step->changes[i].after = NULL;
	}
	last->time_ns = step->time_ns;
	free_step(step);
	return true;
}

bool gz_setting_history_note(struct gz_setting_history *history, int64_t now_ns)
{
	struct step step = { .time_ns = now_ns };
	const bool whole = find_changes(history, &step);
	const bool any = step.count > 0;
	if (any)
		history->noted = *history->live;
	if (!whole || !any)
		free_step(&step); /* without memory the step cannot be undone */
	else if (!merge_step(history, &step))
		push_step(history, step);
	return any;
}

void gz_setting_history_adopt(struct gz_setting_history *history)
{
	history->noted = *history->live;
}

void gz_setting_history_mark(struct gz_setting_history *history)
{
	push_step(history, (struct step) { 0 });
}

void gz_setting_history_unmark(struct gz_setting_history *history)
{
	for (size_t at = history->done; at > 0; at--) {
		if (history->steps[at - 1].count > 0)
			continue;
		memmove(history->steps + at - 1, history->steps + at,
			(history->count - at) * sizeof history->steps[0]);
		history->count--;
		history->done--;
		return;
	}
}

/* ---- undo and redo ---- */

bool gz_setting_history_can_undo(const struct gz_setting_history *history)
{
	return history->done > 0;
}

bool gz_setting_history_can_redo(const struct gz_setting_history *history)
{
	return history->done < history->count;
}

/* One key by its name, several by their section. */
static void print_step(const struct step *step, char out_name[GZ_SETTING_STEP_SIZE])
{
	char section[GZ_SETTING_LABEL_SIZE], name[GZ_SETTING_LABEL_SIZE];
	gz_setting_section(step->changes[0].option, section);
	gz_setting_name(step->changes[0].option, name);
	snprintf(out_name, GZ_SETTING_STEP_SIZE, "%s%s%s", section, step->count == 1 ? ", " : "",
		 step->count == 1 ? name : "");
}

static enum gz_history_outcome take_step(struct gz_setting_history *history,
					 const struct step *step, bool back,
					 char out_name[GZ_SETTING_STEP_SIZE])
{
	if (step->count == 0)
		return GZ_HISTORY_FOREIGN;
	for (size_t i = 0; i < step->count; i++) {
		const struct change *change = &step->changes[i];
		/* It was formatted from a valid value. */
		(void)gz_option_parse(change->option, back ? change->before : change->after,
				      history->live_tables.bindings[change->table].target, NULL, 0);
	}
	history->noted = *history->live;
	print_step(step, out_name);
	return GZ_HISTORY_SETTING;
}

enum gz_history_outcome gz_setting_history_undo(struct gz_setting_history *history,
						char out_name[GZ_SETTING_STEP_SIZE])
{
	if (!gz_setting_history_can_undo(history))
		return GZ_HISTORY_NOTHING;
	return take_step(history, &history->steps[--history->done], true, out_name);
}

enum gz_history_outcome gz_setting_history_redo(struct gz_setting_history *history,
						char out_name[GZ_SETTING_STEP_SIZE])
{
	if (!gz_setting_history_can_redo(history))
		return GZ_HISTORY_NOTHING;
	return take_step(history, &history->steps[history->done++], false, out_name);
}
