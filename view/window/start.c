/* The part that fills a window without a scene: what can be opened, with small pictures of what was
 * shown last; and that starts a simulated viewer and the example study. */
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include <GLFW/glfw3.h>

#include "base/clock.h"
#include "render/picture/image.h"
#include "view/draw/icon.h"
#include "view/files/folder.h"
#include "view/files/programs.h"
#include "view/files/recent.h"
#include "view/panels/widgets.h"
#include "view/window/displays.h"
#include "view/window/gaze.h"
#include "view/window/loading.h"
#include "view/window/window_state.h"

#define GZ_LOG_MODULE "window"

/* Unscaled (chosen: a picture, and a name beside it). */
#define WIDTH      560.0f
#define ROW_HEIGHT 40.0f
#define ICON_WIDTH 64.0f
/* Of the small pictures, px (chosen: sharp at scale 2). */
#define PICTURE_WIDTH  128
#define PICTURE_HEIGHT 80

/* Interval of asking whether the programs still run, s. */
#define CHILD_PATIENCE_S 1.0

/* Most recent files that are shown, and lines of the list of scenes (chosen: all fits in a window
 * of 720 px). */
enum { RECENT_SHOWN = 5, SCENE_LINES = 7 };

struct gz_window_start {
	unsigned icons[RECENT_SHOWN]; /* of the recent files; 0: there is no picture */
	bool icons_made;
	struct gz_folder scenes; /* that are shipped */
	bool scenes_read;
	pid_t simulator; /* gazed, as started here; 0: none */
	pid_t study;     /* gazeview with the example study; 0: none */
};

/* ---- small pictures ---- */

static void free_icons(struct gz_window *window)
{
	for (size_t i = 0; i < RECENT_SHOWN; i++)
		gz_icon_free(&window->start->icons[i]);
	window->start->icons_made = false;
}

static void make_icons(struct gz_window *window)
{
	const struct gz_recent *recent = gz_window_recent(window);
	struct gz_image image = { 0 };
	char path[GZ_PATH_SIZE];
	window->start->icons_made = true;
	for (size_t i = 0; i < recent->count && i < RECENT_SHOWN; i++)
		if (gz_recent_picture(recent->paths[i], path) == GZ_OK && access(path, R_OK) == 0 &&
		    gz_image_read_png(path, NULL, &image) == GZ_OK)
			window->start->icons[i] =
				gz_icon_make_colour(image.pixels, image.width, image.height);
	gz_image_free(&image);
}

/* The picture on the screen without what lies over it, small. */
static enum gz_result shrink_shown(struct gz_window *window, struct gz_image *small)
{
	struct gz_image image = { 0 };
	int width, height;
	gz_window_framebuffer(window, &width, &height);
	if (width < 1 || height < 1)
		return GZ_ERR_INVAL;
	gz_quad_draw(&window->quad, width, height);
	enum gz_result r = gz_window_read_back(width, height, &image);
	const double scale = fmin((double)PICTURE_WIDTH / width, (double)PICTURE_HEIGHT / height);
	if (r == GZ_OK)
		r = gz_image_resize(small, (int)fmax(1, width * scale),
				    (int)fmax(1, height * scale));
	if (r == GZ_OK)
		gz_image_resample(&image, small);
	gz_image_free(&image);
	return r;
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
	    shrink_shown(window, &small) == GZ_OK)
		gz_recent_write_picture(&small, path, window->log);
	gz_image_free(&small);
	free_icons(window);
}

/* ---- programs ---- */

static void start_simulator(struct gz_window *window)
{
	char path[GZ_PATH_SIZE];
	if (gz_program_path("gazed", path) != GZ_OK) {
		gz_err(window->log, "no simulated viewer: gazed is not beside gazeview");
		return;
	}
	char *const arguments[] = { path, (char *)"--driver=sim", (char *)"--tcp=off", NULL };
	if (gz_program_start(arguments, &window->start->simulator) != GZ_OK) {
		gz_err(window->log, "no simulated viewer: %s cannot be started", path);
		return;
	}
	gz_info(window->log, "a simulated viewer looks around; it ends with this window");
	gz_window_ask_for_gaze(window, "daemon");
}

bool gz_window_is_simulating(const struct gz_window *window)
{
	return window->start->simulator > 0;
}

static bool is_simulator_on(const struct gz_window *window, int number)
{
	(void)number;
	return gz_window_is_simulating(window);
}

static void toggle_simulator(struct gz_window *window, int number)
{
	(void)number;
	if (window->start->simulator > 0) {
		gz_program_stop(&window->start->simulator);
		gz_window_ask_for_gaze(window, "mouse");
	} else {
		start_simulator(window);
	}
	gz_window_wake_panels(window);
}

/* In a window of its own: this one goes on behind it. */
static void run_example_study(struct gz_window *window, int number)
{
	char program[GZ_PATH_SIZE], experiment[GZ_PATH_SIZE], session[32];
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
	snprintf(session, sizeof session, "%lld", (long long)(gz_clock_now_ns() / GZ_NS_PER_S));
	char *const arguments[] = { program,
				    (char *)"--experiment",
				    experiment,
				    (char *)"--participant",
				    (char *)"example",
				    (char *)"--session",
				    session,
				    (char *)"--answers",
				    (char *)window->options->pictures,
				    (char *)"--gaze",
				    (char *)(self->simulator > 0 ? "daemon" : "mouse"),
				    NULL };
	if (gz_program_start(arguments, &self->study) != GZ_OK)
		gz_err(window->log, "%s cannot be started", program);
}

static void turn_start(struct gz_window *window)
{
	struct gz_window_start *self = window->start;
	if (self->simulator > 0 && !gz_program_runs(&self->simulator))
		gz_warn(window->log, "the simulated viewer has ended; another gazed may be "
				     "running");
	(void)gz_program_runs(&self->study);
}

static double start_patience_s(const struct gz_window *window)
{
	const struct gz_window_start *self = window->start;
	return self->simulator > 0 || self->study > 0 ? CHILD_PATIENCE_S : INFINITY;
}

/* ---- the panel ---- */

static const char *last_name(const char *path)
{
	const char *slash = strrchr(path, '/');
	return slash && slash[1] ? slash + 1 : path;
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
	if (icon)
		gz_draw_icon(GZ_LAYER_PANEL, row.corner, end, icon);
	else
		gz_draw_rectangle(GZ_LAYER_PANEL, row.corner, end, gz_paint_ground, 3);
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
		make_icons(window);
	for (size_t i = 0; i < recent->count && i < RECENT_SHOWN; i++)
		if (draw_recent_row(window, i))
			chosen = recent->paths[i];
	return chosen;
}

static void read_shipped_scenes(struct gz_window *window)
{
	const struct gz_folder_filter filter = { 0 };
	char path[GZ_PATH_SIZE], message[128];
	window->start->scenes_read = true;
	if (gz_shipped_path("scenes", path) == GZ_OK)
		(void)gz_folder_read(path, &filter, &window->start->scenes, message,
				     sizeof message);
}

/* @return whether one was chosen */
static bool draw_shipped_scenes(struct gz_window *window, char out_path[GZ_PATH_SIZE])
{
	const struct gz_folder *scenes = &window->start->scenes;
	bool chosen = false;
	if (!window->start->scenes_read)
		read_shipped_scenes(window);
	if (scenes->count == 0)
		return false;
	gz_widget_separator();
	gz_widget_text(gz_paint_amber, "Scenes that come with it");
	if (gz_widget_list_begin("##scenes", SCENE_LINES))
		for (size_t i = 0; i < scenes->count; i++) {
			const struct gz_folder_entry *entry = &scenes->entries[i];
			if (entry->is_folder || entry->kind != GZ_FILE_SCENE)
				continue;
			if (gz_widget_row(entry->name, false, NULL))
				chosen = gz_folder_path_of(scenes, entry->name, out_path) == GZ_OK;
		}
	gz_widget_list_end();
	return chosen;
}

static void draw_start_buttons(struct gz_window *window)
{
	gz_widget_separator();
	if (gz_widget_button(window->start->simulator > 0 ? "Stop the simulated viewer"
							  : "Simulated viewer"))
		toggle_simulator(window, 0);
	gz_widget_tooltip("starts gazed --driver sim: its gaze wanders over the picture");
	gz_widgets_same_line(0);
	if (gz_widget_button("Run the example study"))
		run_example_study(window, 0);
	gz_widget_tooltip("pairs of pictures: which was sharper? Esc leaves it");
}

static void draw_start(struct gz_window *window, const struct gz_window_gaze *gaze)
{
	static const struct gz_panel_place place = { .at = GZ_PANEL_MIDDLE, .width = WIDTH };
	char path[GZ_PATH_SIZE];
	bool open = false, scene = false;
	const char *recent = NULL;
	(void)gaze;
	if (window->maker || gz_window_is_loading(window) || gz_widgets_have_dialog())
		return;
	if (gz_panel_begin("##start", &place, NULL)) {
		open = gz_widget_button("Open...");
		gz_widgets_same_line(0);
		gz_widget_label(gz_paint_plain,
				"or drop a volume or a scene here. H lists the keys.");
		recent = draw_recent_rows(window);
		scene = draw_shipped_scenes(window, path);
		draw_start_buttons(window);
	}
	gz_panel_end();
	if (open)
		gz_window_ask_for_file(window);
	else if (recent)
		gz_window_open_file(window, recent);
	else if (scene)
		gz_window_open_file(window, path);
}

static void close_start(struct gz_window *window)
{
	gz_program_stop(&window->start->simulator);
	gz_program_stop(&window->start->study);
	gz_folder_free(&window->start->scenes);
}

static const struct gz_window_action start_actions[] = {
	{ .help = "a simulated viewer looks around, by gazed",
	  .group = "gaze",
	  .name = "Simulated viewer",
	  .menu = GZ_MENU_GAZE,
	  .words = "sim gazed daemon demo synthetic",
	  .is_on = is_simulator_on,
	  .run = toggle_simulator },
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
