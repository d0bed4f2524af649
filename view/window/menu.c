/* The part that shows the actions of all parts as menus: a bar at the top, and a menu of the
 * picture at a right click. */
#include <stdio.h>
#include <string.h>

#include <GLFW/glfw3.h>

#include "view/panels/widgets.h"
#include "view/window/window_state.h"

#define GZ_LOG_MODULE "window"

enum { SECTIONS = 4, KEY_SIZE = 48, NAME_SIZE = 64 };

struct gz_window_menu_bar {
	bool shown;
	bool popup_wanted; /* the menu of the picture is to open */
};

static const char *const menu_names[GZ_MENU_COUNT] = {
	[GZ_MENU_NONE] = NULL,     [GZ_MENU_FILE] = "File", [GZ_MENU_EDIT] = "Edit",
	[GZ_MENU_VIEW] = "View",   [GZ_MENU_GAZE] = "Gaze", [GZ_MENU_PICTURE] = "Picture",
	[GZ_MENU_STUDY] = "Study", [GZ_MENU_HELP] = "Help",
};

/* A menu in the making. */
struct menu_drawing {
	struct gz_window *window;
	enum gz_window_menu menu; /* GZ_MENU_NONE: the one of the picture, of rows of all menus */
	const char *submenu;      /* the open one; NULL: none */
	bool submenu_shown;       /* its rows are */
	bool line_due;            /* before the next row */
	const struct gz_window_action *chosen;
};

static bool is_in_menu(const struct gz_window_action *action, enum gz_window_menu menu)
{
	return action->name && (menu == GZ_MENU_NONE ? action->on_picture : action->menu == menu);
}

static void end_submenu(struct menu_drawing *drawing)
{
	if (drawing->submenu && drawing->submenu_shown)
		gz_menu_end();
	drawing->submenu = NULL;
}

/* @return whether the row is to be drawn: its submenu is open, or it lies in none */
static bool enter_submenu(struct menu_drawing *drawing, const char *submenu)
{
	if (drawing->submenu && (!submenu || strcmp(drawing->submenu, submenu) != 0))
		end_submenu(drawing);
	if (!submenu)
		return true;
	if (!drawing->submenu) {
		drawing->submenu_shown = gz_menu_begin(submenu);
		drawing->submenu = submenu;
	}
	return drawing->submenu_shown;
}

static void draw_menu_row(struct menu_drawing *drawing, const struct gz_window_action *action)
{
	const struct gz_window *window = drawing->window;
	char key[KEY_SIZE], name[NAME_SIZE];
	const char *lacks = action->lacks ? action->lacks(window, action->number) : NULL;
	if (drawing->line_due)
		gz_menu_line();
	drawing->line_due = false;
	if (!enter_submenu(drawing, action->submenu))
		return;
	gz_window_print_key(action, key, sizeof key);
	snprintf(name, sizeof name, lacks ? "%s (%s)" : "%s", action->name, lacks);
	const struct gz_menu_row row = {
		.name = name,
		.keys = key,
		.on = action->is_on && action->is_on(window, action->number),
		.enabled = !lacks && (!action->applies || action->applies(window)),
	};
	if (gz_menu_choice(&row))
		drawing->chosen = action;
	if (action->help)
		gz_widget_tooltip(action->help);
}

/* A section of a menu, in the order of the parts. @return whether it has rows */
static bool draw_menu_section(struct menu_drawing *drawing, enum gz_window_menu menu, int section)
{
	bool any = false;
	GZ_FOR_EACH_PART (part)
		for (size_t i = 0; i < (*part)->action_count; i++) {
			const struct gz_window_action *action = &(*part)->actions[i];
			if (!is_in_menu(action, drawing->menu) || action->menu != menu ||
			    action->section != section)
				continue;
			draw_menu_row(drawing, action);
			any = true;
		}
	end_submenu(drawing);
	return any;
}

static void draw_menu_rows(struct menu_drawing *drawing)
{
	const bool all = drawing->menu == GZ_MENU_NONE;
	for (int menu = all ? GZ_MENU_FILE : drawing->menu;
	     menu <= (all ? GZ_MENU_HELP : (int)drawing->menu); menu++)
		for (int section = 0; section < SECTIONS; section++)
			if (draw_menu_section(drawing, (enum gz_window_menu)menu, section))
				drawing->line_due = true;
}

/* @return what was chosen; NULL: nothing */
static const struct gz_window_action *draw_menu_bar(struct gz_window *window)
{
	struct menu_drawing drawing = { .window = window };
	gz_widgets_disable(gz_widgets_have_dialog());
	window->panels_top = gz_menu_bar_begin();
	for (int menu = GZ_MENU_FILE; menu < GZ_MENU_COUNT && window->panels_top > 0; menu++) {
		if (!gz_menu_begin(menu_names[menu]))
			continue;
		drawing.menu = (enum gz_window_menu)menu;
		drawing.line_due = false;
		draw_menu_rows(&drawing);
		gz_menu_end();
	}
	if (window->panels_top > 0 && gz_menu_bar_button("H: keys"))
		gz_window_toggle_keys(window);
	gz_menu_bar_end();
	gz_widgets_enable();
	return drawing.chosen;
}

static const struct gz_window_action *draw_picture_menu(struct gz_window *window)
{
	struct menu_drawing drawing = { .window = window, .menu = GZ_MENU_NONE };
	if (gz_menu_popup_begin("##picture menu", window->menu->popup_wanted)) {
		draw_menu_rows(&drawing);
		gz_menu_popup_end();
	}
	window->menu->popup_wanted = false;
	return drawing.chosen;
}

static void draw_menus(struct gz_window *window, const struct gz_window_gaze *gaze)
{
	const struct gz_window_action *chosen = NULL, *on_picture = NULL;
	(void)gaze;
	if (window->menu->shown)
		chosen = draw_menu_bar(window);
	else if (gz_corner_button("H: keys"))
		gz_window_toggle_keys(window);
	on_picture = draw_picture_menu(window);
	chosen = chosen ? chosen : on_picture;
	if (chosen)
		gz_window_run_action(window, chosen);
}

void gz_window_ask_for_menu(struct gz_window *window)
{
	window->menu->popup_wanted = true;
	gz_window_wake_panels(window);
}

static void toggle_menu_bar(struct gz_window *window, int number)
{
	(void)number;
	window->menu->shown = !window->menu->shown;
	gz_window_wake_panels(window);
}

static bool is_menu_bar_on(const struct gz_window *window, int number)
{
	(void)number;
	return window->menu->shown;
}

static enum gz_result open_menus(struct gz_window *window)
{
	window->menu->shown = window->options->menu;
	return GZ_OK;
}

static void tell_version(struct gz_window *window, int number)
{
	(void)number;
	gz_info(window->log,
		"gazeview " GAZECAST_VERSION " of Gazecast: volumes, sharp where someone looks");
}

static const struct gz_window_action menu_actions[] = {
	{ .help = "version of the program",
	  .name = "About",
	  .menu = GZ_MENU_HELP,
	  .section = 1,
	  .words = "version help",
	  .run = tell_version },
	{ .letter = 'u',
	  .keys = "U",
	  .help = "show or hide the menu bar",
	  .name = "Menu bar",
	  .menu = GZ_MENU_VIEW,
	  .section = 3,
	  .on_picture = true,
	  .words = "menus",
	  .is_on = is_menu_bar_on,
	  .run = toggle_menu_bar },
};

const struct gz_window_part gz_window_menu_part = {
	.name = "menus",
	.title = "window",
	GZ_PART_ACTIONS(menu_actions),
	GZ_PART_STATE(menu),
	.open = open_menus,
	.panels = draw_menus,
};
