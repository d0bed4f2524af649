#include "view/window/keys.h"

#include <stdlib.h>
#include <string.h>

#include <GLFW/glfw3.h>

#include "view/panels/keys_panel.h"
#include "view/panels/widgets.h"
#include "view/window/window_state.h"

/* Listed at most (chosen: more than twice what there is). */
enum { ROWS_MAX = 256 };

struct gz_window_keys_state {
	struct gz_keys_panel panel;
	struct gz_keys_row rows[ROWS_MAX];
	const struct gz_window_action *actions[ROWS_MAX];
	size_t count;
};

/* What is looked for most comes first (chosen). */
static const char *const groups[] = {
	"gaze", "picture", "transfer function", "camera", "files", "record", "window",
};
enum { GROUPS = sizeof groups / sizeof groups[0] };

static const char *group_of(const struct gz_window_part *part,
			    const struct gz_window_action *action)
{
	return action->group ? action->group : part->title ? part->title : part->name;
}

/* Its number in groups; GROUPS: it has none. */
static size_t rank_of(const char *group)
{
	size_t rank = 0;
	while (rank < GROUPS && strcmp(groups[rank], group) != 0)
		rank++;
	return rank;
}

static void list_part(struct gz_window_keys_state *state, const struct gz_window_part *part,
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

static enum gz_result open_state(struct gz_window *window)
{
	window->keys = calloc(1, sizeof *window->keys);
	if (!window->keys)
		return GZ_ERR_NO_MEM;
	for (size_t rank = 0; rank <= GROUPS; rank++)
		for (const struct gz_window_part *const *part = gz_window_parts; *part; part++)
			list_part(window->keys, *part, rank);
	return GZ_OK;
}

static void close_state(struct gz_window *window)
{
	free(window->keys);
	window->keys = NULL;
}

static void show(struct gz_window *window, bool open, bool search)
{
	struct gz_keys_panel *panel = &window->keys->panel;
	panel->open = open;
	panel->search = search;
	panel->filter[0] = '\0';
	if (!open)
		gz_widgets_release_keyboard();
	gz_window_wake_panels(window);
}

static void draw_panels(struct gz_window *window, const struct gz_window_gaze *gaze)
{
	struct gz_window_keys_state *state = window->keys;
	(void)gaze;
	if (!state->panel.open)
		return;
	const size_t chosen = gz_keys_panel_draw(&state->panel, state->rows, state->count);
	if (gz_dialog_escaped())
		show(window, false, false);
	if (chosen >= state->count)
		return;
	const struct gz_window_action *action = state->actions[chosen];
	state->panel.open = false;
	gz_widgets_release_keyboard();
	gz_window_wake_panels(window);
	if (!action->applies || action->applies(window))
		action->run(window, action->number);
}

static void toggle(struct gz_window *window, int number)
{
	(void)number;
	show(window, !window->keys->panel.open, false);
}

static void find(struct gz_window *window, int number)
{
	(void)number;
	show(window, true, true);
}

static void leave_alone(struct gz_window *window, int number)
{
	(void)window;
	(void)number;
}

static bool is_open(const struct gz_window *window)
{
	return window->keys && window->keys->panel.open;
}

static const struct gz_window_action actions[] = {
	{ .letter = 'h', .keys = "H or ?", .help = "show or hide this list", .run = toggle },
	{ .letter = '?', .run = toggle },
	{ .letter = 'p',
	  .modifiers = GZ_KEY_CONTROL,
	  .keys = "Ctrl+P",
	  .help = "find a key by what it does; Enter runs it",
	  .run = find },
	/* The panel itself takes it: also while a text is typed there. */
	{ .key = GLFW_KEY_ESCAPE, .applies = is_open, .run = leave_alone },
};

const struct gz_window_part gz_window_keys = {
	.name = "keys",
	.title = "window",
	.actions = actions,
	.action_count = sizeof actions / sizeof actions[0],
	.open = open_state,
	.panels = draw_panels,
	.close = close_state,
};
