/* The part that lists the keys of all parts, searches them, and runs them. */
#include <string.h>

#include <GLFW/glfw3.h>

#include "view/panels/keys_panel.h"
#include "view/panels/widgets.h"
#include "view/window/window_state.h"

/* Most rows (chosen: more than twice as many as there are). */
enum { ROWS_MAX = 256 };

struct gz_window_keys {
	struct gz_keys_panel panel;
	struct gz_keys_row rows[ROWS_MAX];
	const struct gz_window_action *actions[ROWS_MAX];
	size_t count;
};

/* Groups in the order of the list (chosen: what is needed most comes first). */
static const char *const groups[] = {
	"gaze", "picture", "transfer function", "camera", "files", "record", "window",
};
enum { GROUPS = sizeof groups / sizeof groups[0] };

static const char *group_of(const struct gz_window_part *part,
			    const struct gz_window_action *action)
{
	return action->group ? action->group : part->title ? part->title : part->name;
}

/* Index in groups; GROUPS: not among them. */
static size_t rank_of(const char *group)
{
	size_t rank = 0;
	while (rank < GROUPS && strcmp(groups[rank], group) != 0)
		rank++;
	return rank;
}

static void list_part_keys(struct gz_window_keys *state, const struct gz_window_part *part,
			   size_t rank)
{
	for (size_t i = 0; i < part->action_count && state->count < ROWS_MAX; i++) {
		const struct gz_window_action *action = &part->actions[i];
		const char *group = group_of(part, action);
		if (!action->keys || rank_of(group) != rank)
			continue;
		state->actions[state->count] = action;
		state->rows[state->count++] = (struct gz_keys_row) {
			.group = group,
			.keys = action->keys,
			.help = action->help,
		};
	}
}

static enum gz_result list_keys(struct gz_window *window)
{
	for (size_t rank = 0; rank <= GROUPS; rank++)
		GZ_FOR_EACH_PART (part)
			list_part_keys(window->keys, *part, rank);
	return GZ_OK;
}

static void show_keys(struct gz_window *window, bool open, bool search)
{
	struct gz_keys_panel *panel = &window->keys->panel;
	panel->open = open;
	panel->search = search;
	panel->filter[0] = '\0';
	if (!open)
		gz_widgets_release_keyboard();
	gz_window_wake_panels(window);
}

static void draw_keys(struct gz_window *window, const struct gz_window_gaze *gaze)
{
	struct gz_window_keys *state = window->keys;
	(void)gaze;
	if (!state->panel.open)
		return;
	const size_t chosen = gz_keys_panel_draw(&state->panel, state->rows, state->count);
	if (gz_dialog_escaped())
		show_keys(window, false, false);
	if (chosen >= state->count)
		return;
	const struct gz_window_action *action = state->actions[chosen];
	state->panel.open = false;
	gz_widgets_release_keyboard();
	gz_window_wake_panels(window);
	if (!action->applies || action->applies(window))
		action->run(window, action->number);
}

static void toggle_keys(struct gz_window *window, int number)
{
	(void)number;
	show_keys(window, !window->keys->panel.open, false);
}

static void find_key(struct gz_window *window, int number)
{
	(void)number;
	show_keys(window, true, true);
}

static void leave_key_to_panel(struct gz_window *window, int number)
{
	(void)window;
	(void)number;
}

static bool are_keys_open(const struct gz_window *window)
{
	return window->keys->panel.open;
}

static const struct gz_window_action keys_actions[] = {
	{ .letter = 'h', .keys = "H or ?", .help = "show or hide this list", .run = toggle_keys },
	{ .letter = '?', .run = toggle_keys },
	{ .letter = 'p',
	  .modifiers = GZ_KEY_CONTROL,
	  .keys = "Ctrl+P",
	  .help = "find a key by a word; Enter runs it",
	  .run = find_key },
	/* The panel takes it itself, even while a text is typed there. */
	{ .key = GLFW_KEY_ESCAPE, .applies = are_keys_open, .run = leave_key_to_panel },
};

const struct gz_window_part gz_window_keys_part = {
	.name = "keys",
	.title = "window",
	GZ_PART_ACTIONS(keys_actions),
	GZ_PART_STATE(keys),
	.open = list_keys,
	.panels = draw_keys,
};
