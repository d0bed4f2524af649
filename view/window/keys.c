/* The part that lists the keys of all parts, searches them, and runs them. */
#include <ctype.h>
#include <stdio.h>
#include <string.h>

#include <GLFW/glfw3.h>

#include "base/clock.h"
#include "view/panels/keys_panel.h"
#include "view/panels/widgets.h"
#include "view/settings/setting_label.h"
#include "view/window/objects.h"
#include "view/window/window_state.h"

#define GZ_LOG_MODULE "window"

/* Time after a message that a key does nothing without another one (chosen: as long as it is
 * shown). */
#define IDLE_KEY_QUIET_NS (4 * GZ_NS_PER_S)

/* Most rows of actions and settings (chosen: more than twice as many as there are), and of objects
 * and their regions. */
enum { SETTINGS_MAX = 384, OBJECTS_MAX = GZ_SCENE_LISTED_MAX, SETTING_TEXT_SIZE = 256 };
enum { ROWS_MAX = 512 + OBJECTS_MAX, OBJECT_TEXT_SIZE = GZ_LABEL_NAME_SIZE + 64 };

struct gz_window_keys {
	struct gz_keys_panel panel;
	struct gz_keys_row rows[ROWS_MAX];
	/* What a row runs: an action, or else it shows a setting, or else an object. */
	const struct gz_window_action *actions[ROWS_MAX];
	const char *settings[ROWS_MAX];
	size_t count;
	size_t fixed; /* rows that are there without a scene; those of objects follow */
	/* Texts of the settings' rows. */
	char sections[SETTINGS_MAX][GZ_SETTING_LABEL_SIZE];
	char texts[SETTINGS_MAX][SETTING_TEXT_SIZE];
	size_t setting_count;
	char objects[OBJECTS_MAX][OBJECT_TEXT_SIZE]; /* texts of the objects' rows */
	int64_t idle_told_ns; /* when a key that does nothing was told last; 0: never */
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
		if (!action->help || rank_of(group) != rank)
			continue;
		state->actions[state->count] = action;
		state->rows[state->count++] = (struct gz_keys_row) {
			.group = group,
			.keys = action->keys,
			.help = action->help,
			.name = action->name,
			.words = action->words,
		};
	}
}

static void list_setting(struct gz_window_keys *state, const struct gz_option *option)
{
	char label[GZ_SETTING_LABEL_SIZE];
	if (state->setting_count == SETTINGS_MAX || state->count == ROWS_MAX)
		return;
	const size_t at = state->setting_count++;
	gz_setting_section(option, state->sections[at]);
	gz_setting_label(option, label);
	snprintf(state->texts[at], sizeof state->texts[at], "%s: %s", label, option->help);
	state->settings[state->count] = option->key;
	state->rows[state->count++] = (struct gz_keys_row) {
		.group = state->sections[at],
		.help = state->texts[at],
		.words = option->key,
	};
}

/* Only the search shows them. */
static void list_settings(struct gz_window *window)
{
	for (size_t i = 0; i < GZ_VIEW_SCENE_TABLES; i++) {
		const struct gz_option_binding *table = &window->tables.bindings[i];
		for (size_t k = 0; k < table->count; k++)
			list_setting(window->keys, &table->options[k]);
	}
}

static enum gz_result list_keys(struct gz_window *window)
{
	for (size_t rank = 0; rank <= GROUPS; rank++)
		GZ_FOR_EACH_PART (part)
			list_part_keys(window->keys, *part, rank);
	list_settings(window);
	window->keys->fixed = window->keys->count;
	return GZ_OK;
}

/* Those of the scene, which only the search shows. */
static void list_objects(struct gz_window *window)
{
	struct gz_window_keys *state = window->keys;
	const size_t count = gz_window_object_rows(window);
	state->count = state->fixed;
	for (size_t i = 0; i < count && i < OBJECTS_MAX && state->count < ROWS_MAX; i++) {
		gz_window_print_object_row(window, i, state->objects[i], sizeof state->objects[i]);
		state->rows[state->count++] = (struct gz_keys_row) {
			.group = "Objects",
			.help = state->objects[i],
			.words = "region label hide",
		};
	}
}

static void show_keys(struct gz_window *window, bool open, bool search)
{
	struct gz_keys_panel *panel = &window->keys->panel;
	list_objects(window);
	panel->open = open;
	panel->search = search;
	panel->filter[0] = '\0';
	panel->selected = 0;
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
	state->panel.open = false;
	gz_widgets_release_keyboard();
	gz_window_wake_panels(window);
	if (state->actions[chosen])
		gz_window_run_action(window, state->actions[chosen]);
	else if (chosen < state->fixed)
		gz_window_show_setting(window, state->settings[chosen]);
	else
		gz_window_show_object_row(window, chosen - state->fixed);
}

bool gz_window_is_search_starting(const struct gz_window *window)
{
	const struct gz_keys_panel *panel = &window->keys->panel;
	return panel->open && (panel->search || panel->activating);
}

void gz_window_type_into_search(struct gz_window *window, unsigned codepoint)
{
	struct gz_keys_panel *panel = &window->keys->panel;
	const size_t length = strlen(panel->filter);
	if (panel->search && codepoint >= ' ' && codepoint < 0x7f &&
	    length + 1 < sizeof panel->filter) {
		panel->filter[length] = (char)codepoint;
		panel->filter[length + 1] = '\0';
	}
}

void gz_window_run_action(struct gz_window *window, const struct gz_window_action *action)
{
	if (!action->applies || action->applies(window))
		action->run(window, action->number);
	else
		gz_info(window->log, "%s: not possible at present",
			action->name ? action->name : action->help);
	gz_window_wake_panels(window);
}

void gz_window_toggle_keys(struct gz_window *window)
{
	show_keys(window, !window->keys->panel.open, false);
}

enum { KEY_NAME_SIZE = 16 };

/* Names of keys that are no letters. */
static const struct {
	int key;
	const char *name;
} key_names[] = {
	{ GLFW_KEY_ESCAPE, "Esc" },      { GLFW_KEY_LEFT, "Left" },
	{ GLFW_KEY_RIGHT, "Right" },     { GLFW_KEY_UP, "Up" },
	{ GLFW_KEY_DOWN, "Down" },       { GLFW_KEY_TAB, "Tab" },
	{ GLFW_KEY_ENTER, "Enter" },     { GLFW_KEY_BACKSPACE, "Backspace" },
	{ GLFW_KEY_INSERT, "Insert" },   { GLFW_KEY_DELETE, "Delete" },
	{ GLFW_KEY_HOME, "Home" },       { GLFW_KEY_END, "End" },
	{ GLFW_KEY_PAGE_UP, "Page Up" }, { GLFW_KEY_PAGE_DOWN, "Page Down" },
};

static void print_key_name(const struct gz_window_action *action, char name[KEY_NAME_SIZE])
{
	name[0] = '\0';
	if (action->letter == ' ')
		snprintf(name, KEY_NAME_SIZE, "Space");
	else if (action->letter)
		snprintf(name, KEY_NAME_SIZE, "%c", toupper((unsigned char)action->letter));
	else if (action->key >= GLFW_KEY_F1 && action->key <= GLFW_KEY_F25)
		snprintf(name, KEY_NAME_SIZE, "F%d", action->key - GLFW_KEY_F1 + 1);
	else if (action->key >= GLFW_KEY_0 && action->key <= GLFW_KEY_9)
		snprintf(name, KEY_NAME_SIZE, "%d", action->key - GLFW_KEY_0);
	for (size_t i = 0; i < sizeof key_names / sizeof key_names[0]; i++)
		if (action->key == key_names[i].key)
			snprintf(name, KEY_NAME_SIZE, "%s", key_names[i].name);
}

void gz_window_print_key(const struct gz_window_action *action, char *text, size_t size)
{
	char name[KEY_NAME_SIZE];
	print_key_name(action, name);
	snprintf(text, size, "%s%s%s", name[0] && action->modifiers & GZ_KEY_CONTROL ? "Ctrl+" : "",
		 name[0] && action->modifiers & GZ_KEY_SHIFT ? "Shift+" : "", name);
}

/* A letter's key goes by the user's layout, others by their code. */
static void print_idle_key(const struct gz_window_idle_key *idle, char *text, size_t size)
{
	const struct gz_window_action as_action = {
		.key = idle->key,
		.letter = idle->letter,
		.modifiers = idle->modifiers,
	};
	gz_window_print_key(&as_action, text, size);
}

void gz_window_tell_idle_key(struct gz_window *window)
{
	struct gz_window_idle_key *idle = &window->idle_key;
	const int64_t now_ns = gz_clock_now_ns(), told_ns = window->keys->idle_told_ns;
	char text[2 * KEY_NAME_SIZE] = "";
	if (idle->noted)
		print_idle_key(idle, text, sizeof text);
	idle->noted = false;
	if (!text[0] || (told_ns > 0 && now_ns < told_ns + IDLE_KEY_QUIET_NS))
		return;
	window->keys->idle_told_ns = now_ns;
	if (idle->other)
		gz_info(window->log, "%s, %s: not possible at present; H lists the keys", text,
			idle->other->name);
	else
		gz_info(window->log, "%s does nothing here; H lists the keys", text);
}

static void toggle_keys(struct gz_window *window, int number)
{
	(void)number;
	gz_window_toggle_keys(window);
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
	{ .letter = 'h',
	  .keys = "H or ?",
	  .help = "show or hide this list",
	  .name = "Keys",
	  .menu = GZ_MENU_HELP,
	  .on_picture = true,
	  .words = "help shortcuts keyboard manual",
	  .run = toggle_keys },
	{ .letter = '?', .run = toggle_keys },
	{ .letter = 'p',
	  .modifiers = GZ_KEY_CONTROL,
	  .keys = "Ctrl+P",
	  .help = "find anything by a word; Enter runs it",
	  .name = "Find...",
	  .menu = GZ_MENU_EDIT,
	  .section = 2,
	  .words = "search palette command help",
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
