#include "view/window.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include <GLFW/glfw3.h>

#include "base/clock.h"
#include "client/viewer_link.h"
#include "view/context_loss.h"
#include "view/letters.h"
#include "view/panel.h"
#include "view/setting_applies.h"
#include "view/window_state.h"

#define GZ_LOG_MODULE "window"

/* Older gaze is called silent, not dated: a number that runs on would be redrawn for ever. */
#define SILENT_NS GZ_NS_PER_S

/* How soon a picture is made again of which bricks are still coming (chosen: some have come). */
#define BRICKS_PATIENCE_S 0.01

/* A running age is drawn anew no more often than this (chosen: readable, and cheap). */
#define LINE_INTERVAL_NS (GZ_NS_PER_S / 2)

static enum gz_result open_display(const struct gz_log *log)
{
	if (glfwInit())
		return GZ_OK;
	gz_err(log,
	       "no window: %s; set DISPLAY to an X server, or render without one by --headless",
	       gz_window_glfw_reason());
	return GZ_ERR_NO_DEVICE;
}

static void print_gaze(const struct gz_window_gaze *gaze, bool mouse_chosen, char *text,
		       size_t size)
{
	const struct gz_gaze_reading *reading = &gaze->reading;
	if (gaze->missing)
		snprintf(text, size, "no daemon (start gazed): mouse");
	else if (mouse_chosen || !reading->has_age)
		snprintf(text, size, "%s", gaze->source);
	else if (reading->age_ns > SILENT_NS)
		snprintf(text, size, "%s, silent", gaze->source);
	else
		snprintf(text, size, "%s %.0f ms %s", gaze->source, gz_ns_to_ms(reading->age_ns),
			 reading->has_event ? gz_event_name(reading->event) : "");
}

/* " of 20, 1.4 times coarser", as much of it as there is. */
static void print_budget(const struct gz_frame_record *record, char *text, size_t size)
{
	text[0] = '\0';
	if (record->budget_ms > 0 && record->focus.scale > 1)
		snprintf(text, size, " of %g, %.1f times coarser", record->budget_ms,
			 record->focus.scale);
	else if (record->budget_ms > 0)
		snprintf(text, size, " of %g", record->budget_ms);
}

/* The line that belongs to the frame on the screen; whether it says something new. */
static bool update_line(struct gz_window *window, const struct gz_window_gaze *gaze)
{
	char state[96], budget[48], line[GZ_WINDOW_LINE_SIZE];
	const struct gz_frame_record *record = &window->record;
	print_gaze(gaze, window->mouse_chosen, state, sizeof state);
	print_budget(record, budget, sizeof budget);
	snprintf(line, sizeof line, "%s  %dx%d  %.1f ms%s  %llu rays  |  gaze: %s  |  H: keys",
		 record->method, record->width, record->height, record->total_ms, budget,
		 (unsigned long long)record->rays, state);
	bool changed = strcmp(line, window->line) != 0;
	memcpy(window->line, line, sizeof line);
	window->line_missing = gaze->missing;
	return changed;
}

static bool same_display(const struct gz_display *a, const struct gz_display *b)
{
	return a->px[0] == b->px[0] && a->px[1] == b->px[1] && a->mm[0] == b->mm[0] &&
	       a->mm[1] == b->mm[1] && a->distance_mm == b->distance_mm;
}

static bool same_point(struct gz_point a, struct gz_point b)
{
	return a.x == b.x && a.y == b.y;
}

/* Whether where the picture is sharp, or what it is on, is another than in the one shown. */
static bool gaze_moved(struct gz_window *window, const struct gz_window_gaze *gaze)
{
	bool moved = gz_frame_attend(window->maker, &window->settings.attention, &gaze->reading,
				     &gaze->display, gz_clock_now_ns());
	return moved || gz_frame_settling(window->maker) ||
	       !same_display(&gaze->display, &window->shown_display);
}

static enum gz_result cast(struct gz_window *window, const struct gz_window_gaze *gaze, int width,
			   int height)
{
	const struct gz_frame_request request = {
		.settings = &window->settings,
		.display = &gaze->display,
		.width = width,
		.height = height,
		.on_device = true,
		.loss_is_callers = true,
	};
	struct gz_image *image;
	enum gz_result r = gz_frame_make(window->maker, &request, &image, &window->record);
	if (r != GZ_OK)
		return r;
	window->shown = window->settings;
	window->any_shown = true;
	window->taken_back = false;
	if (image)
		gz_quad_upload(&window->quad, image);
	else
		gz_quad_show(&window->quad, gz_frame_texture(window->maker));
	window->shown_display = gaze->display;
	window->cast_needed = window->record.bricks_coming > 0;
	return GZ_OK;
}

/* What the tables cannot say of each value by itself. */
static bool settings_valid(const struct gz_scene_settings *settings)
{
	const struct gz_foveation *foveation = &settings->foveation;
	bool table_there = foveation->method != GZ_METHOD_TABLE || foveation->table.count > 0;
	return table_there && gz_scene_settings_check(settings, "settings", NULL) == GZ_OK;
}

/* Another table of spacings is read before anything goes by it; what is wrong with it is logged. */
static bool take_table(struct gz_window *window, const struct gz_scene_settings *before)
{
	struct gz_foveation *foveation = &window->settings.foveation;
	if (strcmp(foveation->table_file, before->foveation.table_file) == 0)
		return true;
	if (!foveation->table_file[0])
		foveation->table = (struct gz_spacing_table) { 0 };
	return gz_scene_load_table(window->options->scene, window->log, foveation) == GZ_OK;
}

/* Values that do not go together stay what they were. */
static void take_changes(struct gz_window *window, const struct gz_scene_settings *before)
{
	if (!take_table(window, before) || !settings_valid(&window->settings))
		window->settings = *before;
	window->cast_needed = true;
	gz_window_wake_panel(window);
}

/* A frame that cannot be made with what the user has set, such as too many rays, is made as the one
 * before; why has been logged. @return whether there was one */
static bool take_back(struct gz_window *window)
{
	if (!window->any_shown || window->taken_back)
		return false;
	window->taken_back = true;
	window->settings = window->shown;
	window->cast_needed = true;
	return true;
}

static bool setting_applies(const void *user, const char *key)
{
	return gz_setting_applies(user, key);
}

static void present(struct gz_window *window, const struct gz_window_gaze *gaze, int width,
		    int height)
{
	int columns, rows;
	glfwGetWindowSize(window->glfw, &columns, &rows);
	struct gz_letters letters;
	bool lettered = window->letters && gz_frame_maker_scene(window->maker)->volume.oriented &&
			gz_letters_of_camera(&window->settings.camera, &letters) == GZ_OK;
	const struct gz_panel_content content = {
		.line = window->line,
		.warn = gaze->missing ||
			(gaze->reading.has_age && gaze->reading.age_ns > SILENT_NS),
		.keys = window->keys_shown ? gz_window_keys_text() : NULL,
		.cross = window->cross && gaze->reading.known,
		.cross_at = { gaze->reading.point.x * (float)columns,
			      gaze->reading.point.y * (float)rows },
		.letters = lettered ? &letters : NULL,
		.settings = window->panel_shown ? window->tables.bindings : NULL,
		.settings_count = GZ_SCENE_BINDINGS,
		.applies = setting_applies,
		.applies_user = &window->settings,
	};
	const struct gz_scene_settings before = window->settings;
	window->present_needed = false;
	gz_quad_draw(&window->quad, width, height);
	bool changed = gz_panel_draw(&content);
	glfwSwapBuffers(window->glfw);
	if (changed)
		take_changes(window, &before);
}

/* One turn of the loop: cast and draw what has changed since the last one. */
static enum gz_result refresh(struct gz_window *window)
{
	struct gz_window_gaze gaze;
	int width, height;
	glfwGetFramebufferSize(window->glfw, &width, &height);
	/* Minimised: X11 leaves such a window its size. */
	if (width < 1 || height < 1 || glfwGetWindowAttrib(window->glfw, GLFW_ICONIFIED)) {
		window->panel_frames = 0;
		return GZ_OK;
	}
	if (window->options->turn_deg != 0) {
		gz_camera_turn(&window->settings.camera, window->options->turn_deg);
		window->cast_needed = true;
	}
	gz_window_gaze_now(window, width, height, &gaze);
	bool must_cast = gaze_moved(window, &gaze) || window->cast_needed ||
			 gz_frame_refinable(window->maker);
	bool cross_moved = window->cross && !same_point(gaze.reading.point, window->cross_drawn);
	if (must_cast) {
		enum gz_result r = cast(window, &gaze, width, height);
		if (r == GZ_ERR_NO_DEVICE || (r != GZ_OK && !take_back(window)))
			return r;
	}
	bool age_runs = gaze.reading.has_age && gaze.reading.age_ns <= SILENT_NS;
	bool line_due = must_cast || !age_runs || gz_clock_now_ns() >= window->line_due_ns;
	bool line_changed = line_due && update_line(window, &gaze);
	bool panel_due = window->panel_frames > 0;
	window->panel_frames -= panel_due;
	if (must_cast || cross_moved || line_changed || window->present_needed || panel_due) {
		window->line_due_ns = gz_clock_now_ns() + LINE_INTERVAL_NS;
		window->cross_drawn = gaze.reading.point;
		present(window, &gaze, width, height);
	}
	return GZ_OK;
}

static enum gz_result loop(struct gz_window *window)
{
	window->start_ns = gz_clock_now_ns();
	window->cast_needed = true;
	if (window->options->fullscreen)
		gz_window_toggle_fullscreen(window);
	while (!glfwWindowShouldClose(window->glfw)) {
		int64_t start_ns = gz_clock_now_ns();
		gz_window_report(window);
		enum gz_result r = gz_context_is_lost() ? GZ_ERR_NO_DEVICE : refresh(window);
		if (r == GZ_ERR_NO_DEVICE) {
			r = gz_window_rebuild(window);
			start_ns = gz_clock_now_ns();
		}
		if (r != GZ_OK)
			return r;
		/* What the frame took is not waited for again. */
		double spent_s = gz_ns_to_s(gz_clock_now_ns() - start_ns);
		double patience_s = gz_window_gaze_patience_s(window);
		if (window->cast_needed) /* bricks are coming */
			patience_s = fmin(patience_s, BRICKS_PATIENCE_S);
		glfwWaitEventsTimeout(fmax(0, patience_s - spent_s));
	}
	return GZ_OK;
}

static void close_window(struct gz_window *window)
{
	/* The renderer may live in the window's context. */
	gz_frame_maker_destroy(&window->maker);
	gz_window_drawing_close(window);
	glfwTerminate();
	gz_gaze_source_destroy(&window->source);
	gz_gaze_source_destroy(&window->mouse);
	gz_viewer_link_close(&window->link);
}

enum gz_result gz_view_window(const struct gz_view_options *options, const struct gz_log *log)
{
	struct gz_window window = {
		.options = options,
		.log = log,
		.size_px = { options->size_px[0], options->size_px[1] },
		.cross = options->cross,
		.letters = options->letters,
	};
	/* The display first: without one there is no use in loading. */
	enum gz_result r = open_display(log);
	if (r != GZ_OK)
		return r;
	r = gz_window_gaze_open(&window);
	if (r == GZ_OK)
		r = gz_window_report_open(&window);
	if (r == GZ_OK)
		r = gz_frame_maker_create(options, log, &window.maker);
	if (r == GZ_OK) {
		window.settings = gz_frame_maker_scene(window.maker)->settings;
		gz_view_pick_scene_tables(&window.settings, &window.tables);
		if (options->letters)
			gz_frame_tell_unoriented(window.maker);
		r = gz_window_context_open(&window);
	}
	if (r == GZ_OK)
		r = gz_frame_maker_start(window.maker, options, &window.context.base);
	if (r == GZ_OK)
		r = gz_window_drawing_open(&window);
	if (r == GZ_OK)
		r = loop(&window);
	close_window(&window);
	return r;
}
