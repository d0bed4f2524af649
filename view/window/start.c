/* The part that fills a window without a scene: what can be opened, with small pictures of what was
 * shown last; and that starts a simulated viewer and the example study. */
#include <glob.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#include <GLFW/glfw3.h>

#include "base/clock.h"
#include "render/picture/image.h"
#include "view/draw/icon.h"
#include "view/files/programs.h"
#include "view/files/recent.h"
#include "view/files/shipped_scenes.h"
#include "view/panels/widgets.h"
#include "view/window/effect.h"
#include "view/window/gaze.h"
#include "view/window/loading.h"
#include "view/window/simulator.h"
#include "view/window/window_state.h"

#define GZ_LOG_MODULE "window"

/* Unscaled (chosen: a picture, and a name beside it; scenes have their names below). */
#define WIDTH        600.0f
#define ROW_HEIGHT   40.0f
#define ICON_WIDTH   64.0f
#define SCENE_WIDTH  128.0f
#define SCENE_HEIGHT 80.0f
/* Of the small pictures, px (chosen: sharp at scale 2). */
#define PICTURE_WIDTH  128
#define PICTURE_HEIGHT 80

/* Interval of asking whether the programs still run, s. */
#define CHILD_PATIENCE_S 1.0

/* Most recent files that are shown, and scenes in a row (chosen: all fits in a window of 720 px).
 */
enum { RECENT_SHOWN = 3, SCENES_IN_ROW = 4 };

struct gz_window_start {
	unsigned icons[RECENT_SHOWN]; /* of the recent files; 0: there is no picture */
	bool icons_made;
	struct gz_shipped_scenes scenes;
	unsigned scene_icons[GZ_SHIPPED_SCENES_MAX]; /* as above */
	bool scenes_read, scene_icons_made;
	pid_t study;                /* gazeview with the example study; 0: none */
	time_t study_start_s;       /* the time of day at which it began */
	char answers[GZ_PATH_SIZE]; /* absolute folder of its answers; empty: not looked up */
};

/* ---- small pictures ---- */

/* @return an icon of a PNG file; 0: there is none */
static unsigned make_icon(const char *path)
{
	struct gz_image image = { 0 };
	unsigned icon = 0;
	if (access(path, R_OK) == 0 && gz_image_read_png(path, NULL, &image) == GZ_OK)
		icon = gz_icon_make_colour(image.pixels, image.width, image.height);
	gz_image_free(&image);
	return icon;
}

static void free_recent_icons(struct gz_window_start *self)
{
	for (size_t i = 0; i < RECENT_SHOWN; i++)
		gz_icon_free(&self->icons[i]);
	self->icons_made = false;
}

static void free_icons(struct gz_window *window)
{
	struct gz_window_start *self = window->start;
	free_recent_icons(self);
	for (size_t i = 0; i < GZ_SHIPPED_SCENES_MAX; i++)
		gz_icon_free(&self->scene_icons[i]);
	self->scene_icons_made = false;
}

static void make_recent_icons(struct gz_window *window)
{
	const struct gz_recent *recent = gz_window_recent(window);
	char path[GZ_PATH_SIZE];
	window->start->icons_made = true;
	for (size_t i = 0; i < recent->count && i < RECENT_SHOWN; i++)
		if (gz_recent_picture(recent->paths[i], path) == GZ_OK)
			window->start->icons[i] = make_icon(path);
}

static void make_scene_icons(struct gz_window_start *self)
{
	self->scene_icons_made = true;
	for (size_t i = 0; i < self->scenes.count; i++)
		self->scene_icons[i] = make_icon(self->scenes.items[i].picture);
}

/* Keep a picture of a recent file that is left. */
static void keep_small_picture(struct gz_window *window)
{
	const struct gz_recent *recent = gz_window_recent(window);
	struct gz_image small = { 0 };
	char path[GZ_PATH_SIZE];
	if (!window->any_shown || !window->glfw || window->context.display_lost || window->alone ||
	    recent->count == 0 || !gz_recent_is_first(recent, gz_window_scene_path(window)))
		return;
	if (gz_recent_picture(recent->paths[0], path) == GZ_OK &&
	    gz_window_shrink_shown(window, PICTURE_WIDTH, PICTURE_HEIGHT, &small) == GZ_OK)
		gz_recent_write_picture(&small, path, window->log);
	gz_image_free(&small);
	free_recent_icons(window->start);
}

/* ---- programs ---- */

/* The folder that the study writes its answers to. */
static const char *folder_of_answers(const struct gz_window *window)
{
	struct gz_window_start *self = window->start;
	const char *folder = window->options->pictures;
	if (self->answers[0])
		return self->answers;
	char *whole = realpath(folder[0] ? folder : ".", NULL);
	snprintf(self->answers, sizeof self->answers, "%s", whole ? whole : folder);
	free(whole);
	return self->answers;
}

/* The newest file of answers in their folder. @return false: none is as new as the study */
static bool find_answers(const struct gz_window *window, char path[GZ_PATH_SIZE])
{
	char pattern[GZ_PATH_SIZE + sizeof "/sub-*_events.tsv"];
	time_t newest_s = window->start->study_start_s - 1;
	glob_t found = { 0 };
	path[0] = '\0';
	snprintf(pattern, sizeof pattern, "%s/sub-*_events.tsv", folder_of_answers(window));
	if (glob(pattern, 0, NULL, &found) == 0)
		for (size_t i = 0; i < found.gl_pathc; i++) {
			struct stat status;
			if (stat(found.gl_pathv[i], &status) != 0 || status.st_mtime <= newest_s)
				continue;
			newest_s = status.st_mtime;
			snprintf(path, GZ_PATH_SIZE, "%s", found.gl_pathv[i]);
		}
	globfree(&found);
	return path[0] != '\0';
}

static void tell_study_ended(struct gz_window *window)
{
	char path[GZ_PATH_SIZE];
	if (find_answers(window, path))
		gz_info(window->log, "the example study has ended; its answers are in %s", path);
	else
		gz_info(window->log, "the example study has ended without answers");
}

/* In a window of its own, which asks who takes part: this one goes on behind it. */
static void run_example_study(struct gz_window *window, int number)
{
	char program[GZ_PATH_SIZE], experiment[GZ_PATH_SIZE];
	struct gz_window_start *self = window->start;
	(void)number;
	if (gz_program_runs(&self->study)) {
		gz_warn(window->log, "the example study is running; leave it by Esc first");
		return;
	}
	if (gz_program_path("gazeview", program) != GZ_OK ||
	    gz_shipped_path("experiments/which-was-sharper.experiment", experiment) != GZ_OK) {
		gz_err(window->log, "the example study is not installed");
		return;
	}
	char *const arguments[] = { program,
				    (char *)"--experiment",
				    experiment,
				    (char *)"--answers",
				    (char *)window->options->pictures,
				    (char *)"--gaze",
				    (char *)(gz_window_is_simulating(window) ? "daemon" : "mouse"),
				    NULL };
	self->study_start_s = time(NULL);
	if (gz_program_start(arguments, &self->study) != GZ_OK)
		gz_err(window->log, "%s cannot be started", program);
	else
		gz_info(window->log,
			"the example study opens a window of its own; its answers go "
			"to a file in %s",
			folder_of_answers(window));
}

static void turn_start(struct gz_window *window)
{
	struct gz_window_start *self = window->start;
	const bool ran = self->study > 0;
	if (ran && !gz_program_runs(&self->study))
		tell_study_ended(window);
}

static double start_patience_s(const struct gz_window *window)
{
	const struct gz_window_start *self = window->start;
	return self->study > 0 ? CHILD_PATIENCE_S : INFINITY;
}

/* ---- the panel ---- */

static const char *last_name(const char *path)
{
	const char *slash = strrchr(path, '/');
	return slash && slash[1] ? slash + 1 : path;
}

static void draw_small_picture(struct gz_place corner, struct gz_place end, unsigned icon)
{
	if (icon)
		gz_draw_icon(GZ_LAYER_PANEL, corner, end, icon);
	else
		gz_draw_rectangle(GZ_LAYER_PANEL, corner, end, gz_paint_ground, 3);
}

static bool draw_recent_row(struct gz_window *window, size_t index)
{
	const char *path = gz_window_recent(window)->paths[index];
	const unsigned icon = window->start->icons[index];
	const float unit = gz_widgets_scale(), line = gz_widgets_line_height();
	struct gz_tall_row row = { .height = ROW_HEIGHT };
	char id[32], name[GZ_PATH_SIZE], folder[GZ_PATH_SIZE];
	snprintf(id, sizeof id, "##recent %zu", index);
	const bool chosen = gz_widget_tall_row(id, &row);
	gz_widget_tooltip(path);
	const struct gz_place end = { row.corner.x + ICON_WIDTH * unit,
				      row.corner.y + ROW_HEIGHT * unit };
	draw_small_picture(row.corner, end, icon);
	gz_widgets_elide(last_name(path), 0.8F, false, name, sizeof name);
	gz_widgets_elide(path, 0.8F, true, folder, sizeof folder);
	const struct gz_paint faint = { 170, 175, 185, 255 };
	struct gz_place at = { end.x + line / 2, row.corner.y + 2 * unit };
	gz_draw_text(GZ_LAYER_PANEL, at, 1, gz_paint_plain, name);
	at.y += 1.3F * line;
	gz_draw_text(GZ_LAYER_PANEL, at, 1, faint, folder);
	return chosen;
}

/* @return the file that was chosen; NULL: none */
static const char *draw_recent_rows(struct gz_window *window)
{
	const struct gz_recent *recent = gz_window_recent(window);
	const char *chosen = NULL;
	if (recent->count == 0)
		return NULL;
	gz_widget_separator();
	gz_widget_text(gz_paint_amber, "Recent");
	if (!window->start->icons_made)
		make_recent_icons(window);
	for (size_t i = 0; i < recent->count && i < RECENT_SHOWN; i++)
		if (draw_recent_row(window, i))
			chosen = recent->paths[i];
	return chosen;
}

/* A small picture with its name below. @return whether it was chosen */
static bool draw_shipped_scene(const struct gz_shipped_scene *scene, unsigned icon)
{
	const float unit = gz_widgets_scale(), line = gz_widgets_line_height();
	struct gz_tall_row row = { .height = SCENE_HEIGHT + 1.2F * line / unit };
	char id[80];
	snprintf(id, sizeof id, "##scene %s", scene->name);
	const bool chosen = gz_widget_tall_row(id, &row);
	gz_widget_tooltip(scene->path);
	const struct gz_place end = { row.corner.x + SCENE_WIDTH * unit,
				      row.corner.y + SCENE_HEIGHT * unit };
	draw_small_picture(row.corner, end, icon);
	const struct gz_place at = { row.corner.x, end.y };
	gz_draw_text(GZ_LAYER_PANEL, at, 1, gz_paint_plain, scene->name);
	return chosen;
}

/* @return the scene that was chosen; NULL: none */
static const char *draw_shipped_scenes(struct gz_window_start *self)
{
	const struct gz_shipped_scenes *scenes = &self->scenes;
	const char *chosen = NULL;
	if (!self->scenes_read)
		(void)gz_shipped_scenes_read(&self->scenes);
	self->scenes_read = true;
	if (scenes->count == 0)
		return NULL;
	if (!self->scene_icons_made)
		make_scene_icons(self);
	gz_widget_separator();
	gz_widget_text(gz_paint_amber, "Scenes that come with it");
	gz_widget_columns_begin("##scenes", SCENES_IN_ROW);
	for (size_t i = 0; i < scenes->count; i++) {
		if (i > 0)
			gz_widget_columns_next();
		if (draw_shipped_scene(&scenes->items[i], self->scene_icons[i]))
			chosen = scenes->items[i].path;
	}
	gz_widget_columns_end();
	return chosen;
}

/* Which scenes are not offered, and why. */
static void draw_scenes_left_out(const struct gz_shipped_scenes *scenes)
{
	char text[96];
	if (scenes->without_data == 0)
		return;
	snprintf(text, sizeof text,
		 "%zu more show data that you fetch yourself: docs/fetched-scenes.md",
		 scenes->without_data);
	gz_widget_text(gz_paint_plain, text);
}

/* What is not about a file. */
static void draw_start_buttons(struct gz_window *window)
{
	char folder[GZ_PATH_SIZE], text[GZ_PATH_SIZE + 32];
	if (gz_widget_button(gz_window_is_simulating(window) ? "Stop the simulated viewer"
							     : "Simulated viewer"))
		gz_window_toggle_simulator(window);
	gz_widget_tooltip("starts gazed --driver sim: its gaze wanders over what is shown");
	gz_widgets_same_line(0);
	if (gz_widget_button("Run the example study"))
		run_example_study(window, 0);
	gz_widget_tooltip("pairs of pictures: which was sharper? Esc leaves it");
	gz_widgets_same_line(0);
	gz_widgets_elide(folder_of_answers(window), 0.4F, true, folder, sizeof folder);
	snprintf(text, sizeof text, "answers go to %s", folder);
	gz_widget_label(gz_paint_plain, text);
	gz_widget_tooltip(folder_of_answers(window));
}

static void draw_start(struct gz_window *window, const struct gz_window_gaze *gaze)
{
	const struct gz_panel_place place = {
		.at = GZ_PANEL_MIDDLE,
		.width = WIDTH,
		.margin_top = window->panels_top,
	};
	bool open = false, effect = false;
	const char *recent = NULL, *scene = NULL;
	(void)gaze;
	if (window->maker || gz_window_is_loading(window) || gz_widgets_have_dialog())
		return;
	if (gz_panel_begin("##start", &place, NULL)) {
		effect = gz_widget_button("See what foveation does");
		gz_widget_tooltip("a picture that is sharp only at the mouse, beside a sharp one");
		gz_widgets_same_line(0);
		open = gz_widget_button("Open...");
		gz_widgets_same_line(0);
		gz_widget_label(gz_paint_plain, "or drop a volume or a scene here");
		draw_start_buttons(window);
		recent = draw_recent_rows(window);
		scene = draw_shipped_scenes(window->start);
		draw_scenes_left_out(&window->start->scenes);
	}
	gz_panel_end();
	if (effect)
		gz_window_show_effect(window);
	else if (open)
		gz_window_ask_for_file(window);
	else if (recent || scene)
		gz_window_open_file(window, recent ? recent : scene);
}

static void close_start(struct gz_window *window)
{
	gz_program_stop(&window->start->study);
}

static const struct gz_window_action start_actions[] = {
	{ .help = "run the example study",
	  .name = "Run the example study",
	  .menu = GZ_MENU_STUDY,
	  .section = 1,
	  .words = "experiment trial questions",
	  .run = run_example_study },
};

const struct gz_window_part gz_window_start_part = {
	.name = "start",
	.title = "record",
	GZ_PART_ACTIONS(start_actions),
	GZ_PART_STATE(start),
	.scene_leaving = keep_small_picture,
	.turn = turn_start,
	.panels = draw_start,
	.patience_s = start_patience_s,
	.gl_close = free_icons,
	.close = close_start,
};
