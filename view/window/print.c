/* The part that writes stipples and hatches for print: SVG in millimetres, or PNG of any size. */
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include <GLFW/glfw3.h>

#include "base/file.h"
#include "view/files/scene_save.h"
#include "view/panels/file_dialogs.h"
#include "view/panels/widgets.h"
#include "view/settings/scene_keys.h"
#include "view/window/loading.h"
#include "view/window/window_state.h"

#define GZ_LOG_MODULE "print"

/* Unscaled (chosen: a number beside its name). */
#define PRINT_WIDTH 300.0f
#define LABEL_SHARE 0.5f

/* Widest sheet, mm, and finest dots (chosen: as of --print-mm and --print-dpi). */
#define SHEET_MAX_MM 10000.0
#define DPI_MAX      20000.0

struct gz_window_print {
	bool open;       /* the panel is */
	double width_mm; /* of the picture on paper */
	double dpi;      /* of a PNG */
	struct gz_save_panel save;
};

static const struct gz_save_words print_words = {
	.title = "Write a drawing",
	.what = "Stipples or hatches are written for print, .svg or .png, to:",
	.verb = "Write",
};

static enum gz_result open_print(struct gz_window *window)
{
	window->print->width_mm = window->options->print_mm;
	window->print->dpi = window->options->print_dpi;
	return GZ_OK;
}

static bool is_drawn_by_marks(const struct gz_window *window)
{
	const struct gz_scene_settings *settings = &window->settings;
	const struct gz_illustration_look *look = &settings->rays.illustration;
	bool any = gz_illustration_look_drawing(look, 0) != GZ_DRAWING_GREY;
	for (size_t i = 0; i < settings->objects.count && !any; i++)
		any = gz_illustration_look_drawing(
			      look, settings->objects.items[i].style.drawing) != GZ_DRAWING_GREY;
	return gz_setting_applies(settings, "illustration.show") && any;
}

/* "NAME.svg" beside the scene. */
static void ask_for_print_path(struct gz_window *window)
{
	char path[GZ_PATH_SIZE], suggested[GZ_PATH_SIZE];
	gz_scene_save_suggest(gz_window_scene_path(window), path);
	char *ending = strrchr(path, '.');
	if (ending)
		*ending = '\0';
	const int length = snprintf(suggested, sizeof suggested, "%s.svg", path);
	if (length < 0 || length >= GZ_PATH_SIZE)
		snprintf(suggested, sizeof suggested, "drawing.svg");
	gz_save_panel_show(&window->print->save, &print_words, suggested);
}

/* The picture of the window, with every pixel cast. */
static enum gz_result write_print(struct gz_window *window, const char *path)
{
	const struct gz_window_print *self = window->print;
	const struct gz_print print = { path, self->width_mm, self->dpi, 0 };
	const struct gz_frame_request request = {
		.settings = &window->settings,
		.display = &window->shown_display,
		.width = window->record.width,
		.height = window->record.height,
	};
	const enum gz_result r = gz_frame_print(window->maker, &request, &print);
	if (r == GZ_OK)
		gz_info(window->log, "%s written, %g mm wide", path, self->width_mm);
	window->cast_needed = true; /* the picture on the screen has become another */
	return r;
}

static void accept_print_path(struct gz_window *window, bool sure)
{
	struct gz_save_panel *panel = &window->print->save;
	char question[GZ_PANEL_MESSAGE_SIZE];
	if (!gz_path_ends(panel->path, ".svg") && !gz_path_ends(panel->path, ".png")) {
		snprintf(panel->message, sizeof panel->message,
			 "the name must end in .svg or .png");
	} else if (!sure && access(panel->path, F_OK) == 0) {
		snprintf(question, sizeof question, "%.200s exists. Replace?", panel->path);
		gz_save_panel_ask(panel, question);
	} else if (write_print(window, panel->path) == GZ_OK) {
		panel->open = window->print->open = false;
	} else {
		snprintf(panel->message, sizeof panel->message,
			 "it cannot be written; the messages say why");
	}
	panel->focus_wanted = panel->open; /* Enter has left the field */
	gz_window_wake_panels(window);
}

static void draw_number(const char *name, const char *help, double most, double *value)
{
	const struct gz_number_range range = {
		.least = 1, .greatest = most, .speed = 1, .format = "%.0f"
	};
	gz_widgets_push_id(name);
	gz_widget_label(gz_paint_plain, name);
	gz_widgets_same_line(LABEL_SHARE);
	gz_widgets_next_width(0);
	(void)gz_widget_doubles("##value", value, 1, &range);
	gz_widget_tooltip(help);
	gz_widgets_pop_id();
}

/* Grey pictures have no marks. */
static void draw_print_offer(struct gz_window *window)
{
	int *drawing = &window->settings.rays.illustration.drawing;
	const bool illustrated = gz_setting_applies(&window->settings, "illustration.show");
	gz_widget_text(gz_paint_plain,
		       illustrated ? "Only stipples and hatches are written for print."
				   : "Only illustrations are written for print; Shift+I shows the "
				     "scene as one.");
	if (!illustrated)
		return;
	if (gz_widget_button("Draw by stipples"))
		*drawing = GZ_DRAWING_STIPPLES;
	gz_widgets_same_line(LABEL_SHARE);
	if (gz_widget_button("Draw by hatches"))
		*drawing = GZ_DRAWING_HATCHES;
}

static void draw_print(struct gz_window *window, const struct gz_window_gaze *gaze)
{
	struct gz_window_print *self = window->print;
	const struct gz_panel_place place = { .at = GZ_PANEL_TOP_RIGHT,
					      .margin_top = window->panels_top,
					      .width = PRINT_WIDTH };
	bool sure = false;
	(void)gaze;
	if (!window->maker || !window->any_shown)
		return;
	if (gz_save_panel_draw(&self->save, &sure))
		accept_print_path(window, sure);
	if (!self->open)
		return;
	if (gz_panel_begin("Drawing for print", &place, &self->open)) {
		if (is_drawn_by_marks(window)) {
			draw_number("width, mm", "of the picture on paper", SHEET_MAX_MM,
				    &self->width_mm);
			draw_number("dots per inch", "of a PNG; an SVG has none", DPI_MAX,
				    &self->dpi);
			if (gz_widget_button("Write..."))
				ask_for_print_path(window);
		} else {
			draw_print_offer(window);
		}
	}
	gz_panel_end();
}

static void leave_printed_scene(struct gz_window *window)
{
	window->print->save.open = false;
}

static void toggle_print(struct gz_window *window, int number)
{
	(void)number;
	window->print->open = !window->print->open;
	gz_window_wake_panels(window);
}

static bool is_print_open(const struct gz_window *window)
{
	return window->print->open;
}

static const struct gz_window_action print_actions[] = {
	{ .key = GLFW_KEY_ESCAPE, .applies = is_print_open, .run = toggle_print },
	{ .letter = 'e',
	  .modifiers = GZ_KEY_CONTROL | GZ_KEY_SHIFT,
	  .keys = "Ctrl+Shift+E",
	  .help = "write stipples or hatches for print",
	  .name = "Write drawing for print...",
	  .menu = GZ_MENU_FILE,
	  .section = 2,
	  .words = "export svg png vector paper dots lines",
	  .group = "files",
	  .run = toggle_print },
};

const struct gz_window_part gz_window_print_part = {
	.name = "print",
	GZ_PART_ACTIONS(print_actions),
	GZ_PART_STATE(print),
	.open = open_print,
	.scene_leaving = leave_printed_scene,
	.panels = draw_print,
};
