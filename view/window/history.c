/* The part that undoes and redoes: settings, camera, what is clipped and transfer function, in the
 * order in which they were changed; and that knows what the scene's file has. */
#include <stdio.h>
#include <string.h>

#include "base/clock.h"
#include "view/panels/widgets.h"
#include "view/settings/setting_history.h"
#include "view/window/history.h"
#include "view/window/transfer.h"
#include "view/window/window_state.h"

#define GZ_LOG_MODULE "window"

struct gz_window_history {
	struct gz_setting_history *steps;
	int transfer_steps;             /* of the transfer function, that are among them */
	struct gz_scene_settings given; /* as the scene was opened or saved last */
	struct gz_view_live_tables given_tables, live_tables;
};

static enum gz_result open_history(struct gz_window *window)
{
	struct gz_window_history *self = window->history;
	gz_view_pick_live_tables(&self->given, &self->given_tables);
	return gz_setting_history_create(&window->settings, &self->steps);
}

/* What changes settings by itself is not the user's to undo. */
static bool is_watched(const struct gz_window *window)
{
	return window->maker && !window->alone && window->options->turn_deg == 0 &&
	       !window->options->replay[0];
}

/* The transfer function has steps of its own, which its panel can take too. */
static void note_transfer_steps(struct gz_window *window)
{
	struct gz_window_history *self = window->history;
	const int now = gz_window_transfer_steps(window);
	for (; self->transfer_steps < now; self->transfer_steps++)
		gz_setting_history_mark(self->steps);
	for (; self->transfer_steps > now; self->transfer_steps--)
		gz_setting_history_unmark(self->steps);
}

static void note_steps(struct gz_window *window)
{
	note_transfer_steps(window);
	(void)gz_setting_history_note(window->history->steps, gz_clock_now_ns());
}

/* A drag is one step. */
static void turn_history(struct gz_window *window)
{
	if (is_watched(window) && !window->grabber && !gz_widgets_in_use())
		note_steps(window);
}

static void begin_history(struct gz_window *window)
{
	struct gz_window_history *self = window->history;
	gz_setting_history_restart(self->steps);
	self->transfer_steps = gz_window_transfer_steps(window);
	self->given = window->settings;
	gz_view_pick_live_tables(&self->given, &self->given_tables);
	gz_view_pick_live_tables(&window->settings, &self->live_tables);
}

/* Not among what is asked about before the scene is left: where one looks from, and what is shown
 * of it in the window; but distances were measured by hand. */
static bool is_worth_saving(const struct gz_option *option)
{
	return (strncmp(option->key, "camera.", 7) != 0 && strncmp(option->key, "view.", 5) != 0) ||
	       strcmp(option->key, "view.distances") == 0;
}

bool gz_window_scene_changed(const struct gz_window *window)
{
	const struct gz_window_history *self = window->history;
	if (!is_watched(window))
		return false;
	if (gz_window_transfer_changed(window))
		return true;
	for (size_t i = 0; i < self->given_tables.count; i++) {
		const struct gz_option_binding *live = &self->live_tables.bindings[i];
		const void *given = self->given_tables.bindings[i].target;
		for (size_t k = 0; k < live->count; k++)
			if (is_worth_saving(&live->options[k]) &&
			    !gz_option_same(&live->options[k], live->target, given))
				return true;
	}
	return false;
}

const struct gz_option_binding *gz_window_given_settings(const struct gz_window *window)
{
	return window->history->given_tables.bindings;
}

void gz_window_scene_saved(struct gz_window *window)
{
	gz_setting_history_adopt(window->history->steps);
	window->history->given = window->settings;
}

/* ---- undo and redo ---- */

static void tell_step(const struct gz_window *window, bool again, const char *name)
{
	gz_info(window->log, "%s: %s", again ? "redone" : "undone", name);
}

/* @return whether the transfer function had such a step */
static bool take_transfer_step(struct gz_window *window, bool again)
{
	char name[GZ_SETTING_STEP_SIZE];
	const char *taken = gz_window_transfer_step(window, again);
	window->history->transfer_steps = gz_window_transfer_steps(window);
	if (!taken)
		return false;
	snprintf(name, sizeof name, "Transfer function, %s", taken);
	tell_step(window, again, name);
	return true;
}

static void step_through_history(struct gz_window *window, int again)
{
	struct gz_window_history *self = window->history;
	char name[GZ_SETTING_STEP_SIZE];
	enum gz_history_outcome outcome;
	note_steps(window);
	const struct gz_scene_settings before = window->settings;
	do {
		outcome = again ? gz_setting_history_redo(self->steps, name)
				: gz_setting_history_undo(self->steps, name);
	} while (outcome == GZ_HISTORY_FOREIGN && !take_transfer_step(window, again != 0));
	if (outcome == GZ_HISTORY_NOTHING)
		gz_info(window->log, "nothing to %s", again ? "redo" : "undo");
	if (outcome == GZ_HISTORY_SETTING) {
		tell_step(window, again != 0, name);
		gz_window_take_changes(window, &before);
	}
	gz_window_wake_panels(window);
}

static void close_history(struct gz_window *window)
{
	gz_setting_history_destroy(&window->history->steps);
}

static const struct gz_window_action history_actions[] = {
	{ .letter = 'z',
	  .modifiers = GZ_KEY_CONTROL,
	  .repeats = true,
	  .keys = "Ctrl+Z",
	  .help = "undo: settings, camera, transfer function",
	  .name = "Undo",
	  .menu = GZ_MENU_EDIT,
	  .on_picture = true,
	  .words = "back revert",
	  .applies = is_watched,
	  .run = step_through_history },
	{ .letter = 'z',
	  .modifiers = GZ_KEY_CONTROL | GZ_KEY_SHIFT,
	  .repeats = true,
	  .number = 1,
	  .keys = "Ctrl+Shift+Z",
	  .help = "redo what was undone",
	  .name = "Redo",
	  .menu = GZ_MENU_EDIT,
	  .words = "again repeat",
	  .applies = is_watched,
	  .run = step_through_history },
};

const struct gz_window_part gz_window_history_part = {
	.name = "history",
	.title = "picture",
	GZ_PART_ACTIONS(history_actions),
	GZ_PART_STATE(history),
	.open = open_history,
	.scene_shown = begin_history,
	.turn = turn_history,
	.close = close_history,
};
