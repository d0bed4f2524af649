#include "view/window/window.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <GLFW/glfw3.h>

#include "base/clock.h"
#include "render/plan/method.h"
#include "render/scene/techniques.h"
#include "view/panels/widgets.h"
#include "view/window/capture.h"
#include "view/window/displays.h"
#include "view/window/experiment.h"
#include "view/window/gaze.h"
#include "view/window/glfw.h"
#include "view/window/loading.h"
#include "view/window/sections.h"
#include "view/window/uncovered.h"
#include "view/window/window_state.h"

#define GZ_LOG_MODULE "window"

/* Time until a picture is made again while its bricks are still being read (chosen: some have come
 * by then). */
#define BRICKS_PATIENCE_S 0.01
/* Least time between turns of a window that nobody can see (chosen: costs nothing; the event of its
 * return ends the wait). */
#define HIDDEN_PATIENCE_S 0.1

#define PART_ADDRESS(name) &gz_window_##name##_part,
const struct gz_window_part *const gz_window_parts[] = { GZ_WINDOW_PARTS(PART_ADDRESS) NULL };
#undef PART_ADDRESS

static enum gz_result open_display(const struct gz_log *log)
{
	if (glfwInit())
		return GZ_OK;
	gz_err(log,
	       "no window: %s; set DISPLAY to an X server, or render without one by --headless",
	       gz_glfw_reason());
	return GZ_ERR_NO_DEVICE;
}

/* Whether the focus or the display differs from that of the picture shown. */
static bool gaze_moved(struct gz_window *window, const struct gz_window_gaze *gaze)
{
	if (gaze->focus) {
		gz_frame_set_focus(window->maker, &gaze->reading, gaze->focus);
		return gaze->focus_new || !gz_display_same(&gaze->display, &window->shown_display);
	}
	bool moved = !window->gaze_frozen &&
		     gz_frame_attend(window->maker, &window->settings.attention, &gaze->reading,
				     &gaze->display, gz_clock_now_ns());
	return moved || gz_frame_settling(window->maker) ||
	       !gz_display_same(&gaze->display, &window->shown_display);
}

/* A frame could be made with these settings. One without triangles does not prove that there is
 * room for those of its isovalue. */
static void note_made(struct gz_window *window, const struct gz_scene_settings *settings)
{
	const double proved = window->shown.rays.surface.isovalue;
	window->made = *settings;
	window->shown = window->settings;
	if (window->any_shown && window->without_triangles)
		window->shown.rays.surface.isovalue = proved;
	window->any_shown = true;
}

static enum gz_result cast_picture(struct gz_window *window, const struct gz_window_gaze *gaze,
				   int width, int height)
{
	struct gz_scene_settings settings = window->settings;
	if (window->without_triangles)
		settings.rays.surface.source = GZ_SURFACE_VOXELS;
	const struct gz_frame_request request = {
		.settings = &settings,
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
	/* One that was refused is not in force. Why has been logged. */
	settings.technique = gz_frame_maker_scene(window->maker)->settings.technique;
	if (!window->alone)
		window->settings.technique = settings.technique;
	if (!window->any_shown || !gz_scene_settings_same(&window->made, &settings))
		window->motion_ns = gz_clock_now_ns();
	note_made(window, &settings);
	window->taken_back = false;
	if (image)
		gz_quad_upload(&window->quad, image);
	else
		gz_quad_show(&window->quad, gz_frame_texture(window->maker));
	window->shown_display = gaze->display;
	window->cast_needed = window->record.bricks_coming > 0;
	return GZ_OK;
}

/* Rules between values, which the option tables cannot check. */
static bool settings_valid(const struct gz_scene_settings *settings)
{
	const struct gz_foveation *foveation = &settings->foveation;
	bool table_there = !gz_method_of(foveation)->needs_table || foveation->table.count > 0;
	return table_there && gz_scene_settings_check(settings, "settings", NULL) == GZ_OK;
}

/* Read a table of spacings before anything uses it. What is wrong with it is logged. */
static bool take_table(struct gz_window *window, const struct gz_scene_settings *before)
{
	struct gz_foveation *foveation = &window->settings.foveation;
	if (strcmp(foveation->table_file, before->foveation.table_file) == 0)
		return true;
	if (!foveation->table_file[0])
		foveation->table = (struct gz_spacing_table) { 0 };
	return gz_scene_load_table(gz_window_scene_path(window), window->log, foveation) == GZ_OK;
}

/* Find the pictures of the surroundings before anything shows them. What is wrong with them is
 * logged. */
static bool take_cube(struct gz_window *window, const struct gz_scene_settings *before)
{
	struct gz_environment *environment = &window->settings.rays.environment;
	const struct gz_environment *old = &before->rays.environment;
	return (environment->kind == old->kind && strcmp(environment->cube, old->cube) == 0) ||
	       gz_scene_find_cube(gz_window_scene_path(window), window->log, environment) == GZ_OK;
}

/* Find the templates of illustrations before anything uses them. What is wrong with one is logged.
 */
static bool take_templates(struct gz_window *window, const struct gz_scene_settings *before)
{
	return gz_scene_templates_same(&window->settings, before) ||
	       gz_scene_find_templates(gz_window_scene_path(window), window->log,
				       &window->settings) == GZ_OK;
}

/* Values that contradict each other are not taken. */
void gz_window_take_changes(struct gz_window *window, const struct gz_scene_settings *before)
{
	if (!take_table(window, before) || !take_cube(window, before) ||
	    !take_templates(window, before) || !settings_valid(&window->settings))
		window->settings = *before;
	window->cast_needed = true;
	gz_window_wake_panels(window);
}

/* Return to the settings of the last frame after a frame could not be made, such as with too many
 * rays; why has been logged. Not in the settings of a part that is alone, which must not be shown
 * others. @return whether there were such settings */
static bool take_back(struct gz_window *window)
{
	if (!window->any_shown || window->taken_back || window->alone)
		return false;
	window->taken_back = true;
	window->settings = window->shown;
	window->cast_needed = true;
	return true;
}

bool gz_window_let_data_go(struct gz_window *window)
{
	bool all = true;
	GZ_FOR_EACH_PART (part)
		if ((*part)->data_leaving && !(*part)->data_leaving(window))
			all = false;
	return all;
}

/* They are laid out first, as the picture need not be drawn beneath them. */
static void lay_out_panels(struct gz_window *window, const struct gz_window_gaze *gaze)
{
	gz_widgets_begin();
	window->panels_top = 0;
	window->panels_bottom = 0;
	GZ_FOR_EACH_PART (part)
		if ((*part)->panels && (!window->alone || *part == window->alone))
			(*part)->panels(window, gaze);
	gz_widgets_end();
}

/* The picture may be smaller than the framebuffer; both have the lower left corner. */
static void paint_picture(struct gz_window *window, int width, int height)
{
	int size_px[2];
	gz_window_picture_size(window, &size_px[0], &size_px[1]);
	const bool smaller = gz_window_has_sections(window);
	if (!window->any_shown || smaller)
		gz_quad_clear(width, height);
	width = smaller ? size_px[0] : width;
	height = smaller ? size_px[1] : height;
	if (window->any_shown && (smaller || gz_window_reads_picture(window)))
		gz_quad_draw(&window->quad, width, height);
	else if (window->any_shown)
		gz_window_draw_uncovered(window, width, height);
	GZ_FOR_EACH_PART (part)
		if ((*part)->paint && (!window->alone || *part == window->alone))
			(*part)->paint(window, width, height);
}

void gz_window_present(struct gz_window *window, const struct gz_window_gaze *gaze, int width,
		       int height)
{
	const struct gz_scene_settings before = window->settings;
	window->present_needed = false;
	lay_out_panels(window, gaze);
	paint_picture(window, width, height);
	gz_widgets_draw();
	GZ_FOR_EACH_PART (part)
		if ((*part)->drawn)
			(*part)->drawn(window, width, height);
	window->swap_ns = gz_clock_now_ns();
	glfwSwapBuffers(window->glfw);
	GZ_FOR_EACH_PART (part)
		if ((*part)->presented)
			(*part)->presented(window);
	if (!gz_scene_settings_same(&before, &window->settings))
		gz_window_take_changes(window, &before);
}

/* Whether what lies over the picture must be drawn again. */
static bool parts_follow(struct gz_window *window, const struct gz_window_gaze *gaze)
{
	bool any = false;
	GZ_FOR_EACH_PART (part)
		if ((*part)->follows && (*part)->follows(window, gaze))
			any = true;
	return any;
}

/* Make a new picture if something has changed since the last turn. */
static enum gz_result refresh_picture(struct gz_window *window, struct gz_window_gaze *gaze,
				      int width, int height)
{
	if (window->options->turn_deg != 0) {
		gz_camera_turn(&window->settings.camera, window->options->turn_deg);
		window->cast_needed = true;
	}
	gz_window_gaze_now(window, width, height, gaze);
	GZ_FOR_EACH_PART (part)
		if ((*part)->gaze)
			(*part)->gaze(window, gaze);
	if (!gaze_moved(window, gaze) && !window->cast_needed && !gz_frame_refinable(window->maker))
		return GZ_OK;
	enum gz_result r = cast_picture(window, gaze, width, height);
	if (r == GZ_ERR_NO_DEVICE)
		return r;
	if (r != GZ_OK && !take_back(window)) {
		/* Why has been logged. */
		gz_window_close_scene(window);
		return GZ_OK;
	}
	window->frame_new = true;
	GZ_FOR_EACH_PART (part)
		if (r == GZ_OK && (*part)->frame_made)
			(*part)->frame_made(window);
	return GZ_OK;
}

/* One turn of the loop: make and draw what has changed since the last one. */
static enum gz_result refresh_window(struct gz_window *window)
{
	struct gz_window_gaze gaze = { 0 };
	int width, height;
	gz_window_follow_cursor(window);
	GZ_FOR_EACH_PART (part)
		if ((*part)->turn)
			(*part)->turn(window);
	gz_window_framebuffer(window, &width, &height);
	if (width < 1 || height < 1) { /* minimised */
		window->panel_frames = 0;
		return GZ_OK;
	}
	window->frame_new = false;
	if (window->maker && !window->picture_hidden) {
		int picture_px[2];
		gz_window_picture_size(window, &picture_px[0], &picture_px[1]);
		enum gz_result r = refresh_picture(window, &gaze, picture_px[0], picture_px[1]);
		if (r != GZ_OK)
			return r;
	} else if (window->cast_needed) {
		window->cast_needed = false;
		window->present_needed = true;
	}
	const bool panels_due = window->panel_frames > 0;
	const bool follow = parts_follow(window, &gaze);
	window->panel_frames -= panels_due;
	if (window->frame_new || window->present_needed || panels_due || follow)
		gz_window_present(window, &gaze, width, height);
	return GZ_OK;
}

static bool is_window_hidden(const struct gz_window *window)
{
	int width, height;
	gz_window_framebuffer(window, &width, &height);
	return width < 1 || height < 1;
}

static double loop_patience_s(const struct gz_window *window)
{
	double patience = gz_window_gaze_patience_s(window);
	GZ_FOR_EACH_PART (part)
		if ((*part)->patience_s)
			patience = fmin(patience, (*part)->patience_s(window));
	/* Bricks are coming. */
	if (window->maker && window->cast_needed)
		patience = fmin(patience, BRICKS_PATIENCE_S);
	/* The window is hidden: poll slowly, even if parts wait for a picture. */
	return is_window_hidden(window) ? fmax(patience, HIDDEN_PATIENCE_S) : patience;
}

static enum gz_result run_loop(struct gz_window *window)
{
	window->cast_needed = true;
	if (window->options->fullscreen)
		gz_window_toggle_fullscreen(window);
	while (!glfwWindowShouldClose(window->glfw)) {
		int64_t start_ns = gz_clock_now_ns();
		gz_window_report(window);
		enum gz_result r =
			gz_glfw_context_lost() ? GZ_ERR_NO_DEVICE : refresh_window(window);
		if (r == GZ_ERR_NO_DEVICE) {
			r = gz_window_rebuild(window);
			start_ns = gz_clock_now_ns();
		}
		if (r != GZ_OK)
			return r;
		if (window->options->measure_window > 0 && window->any_shown)
			return gz_window_measure(window);
		if (window->options->measure_window > 0 &&
		    gz_window_loading_outcome(window) != GZ_OK)
			return GZ_OK; /* the caller asks for the outcome */
		/* The time that the frame took is part of the wait. */
		double spent_s = gz_ns_to_s(gz_clock_now_ns() - start_ns);
		glfwWaitEventsTimeout(fmax(0, loop_patience_s(window) - spent_s));
	}
	return GZ_OK;
}

/* Where struct gz_window points to the state of a part. */
static void *part_state_slot(struct gz_window *window, const struct gz_window_part *part)
{
	return (char *)window + part->state_at;
}

static void *part_state(struct gz_window *window, const struct gz_window_part *part)
{
	void *state;
	memcpy(&state, part_state_slot(window, part), sizeof state);
	return state;
}

static void set_part_state(struct gz_window *window, const struct gz_window_part *part, void *state)
{
	memcpy(part_state_slot(window, part), &state, sizeof state);
}

/* States first: parts may ask each other while they open. */
static enum gz_result open_parts(struct gz_window *window)
{
	enum gz_result r = GZ_OK;
	GZ_FOR_EACH_PART (part)
		if ((*part)->state_size > 0)
			set_part_state(window, *part, calloc(1, (*part)->state_size));
	GZ_FOR_EACH_PART (part)
		if ((*part)->state_size > 0 && !part_state(window, *part)) {
			gz_err(window->log, "no memory for the window; close other programs");
			return GZ_ERR_NO_MEM;
		}
	GZ_FOR_EACH_PART (part)
		if (r == GZ_OK && (*part)->open)
			r = (*part)->open(window);
	return r;
}

static void close_parts(struct gz_window *window)
{
	GZ_FOR_EACH_PART (part) {
		const bool stateless = (*part)->state_size == 0;
		void *state = stateless ? NULL : part_state(window, *part);
		if ((*part)->close && (stateless || state))
			(*part)->close(window);
	}
	GZ_FOR_EACH_PART (part)
		if ((*part)->state_size > 0) {
			free(part_state(window, *part));
			set_part_state(window, *part, NULL);
		}
}

static void close_window(struct gz_window *window)
{
	/* The renderer may live in the window's context. */
	gz_window_close_scene(window);
	if (!window->context.display_lost)
		gz_window_drawing_close(window);
	/* Threads of parts may still wake the loop. */
	close_parts(window);
	if (!window->context.display_lost)
		glfwTerminate();
}

/* Errors in the command line are reported before there is a window. */
static enum gz_result check_backend(const struct gz_view_options *options, const struct gz_log *log)
{
	const struct gz_backend_params params = { .threads = options->threads,
						  .simd = options->simd };
	return gz_techniques[0]->check(options->backend, &params, log);
}

/* The scene of the command line is loaded like any other. */
static enum gz_result load_first(struct gz_window *window)
{
	struct gz_window_load_request *request = calloc(1, sizeof *request);
	if (!request)
		return GZ_ERR_NO_MEM;
	memcpy(request->path, window->options->scene, sizeof request->path);
	request->by_options = true;
	const enum gz_result r = gz_window_load(window, request);
	free(request);
	return r;
}

static enum gz_result run_window(struct gz_window *window)
{
	enum gz_result r = open_parts(window);
	if (r == GZ_OK)
		r = gz_window_context_open(window);
	if (r == GZ_OK)
		r = gz_window_drawing_open(window);
	if (r == GZ_OK && window->options->scene[0] && !gz_window_ask_layout(window))
		r = load_first(window);
	if (r == GZ_OK)
		r = run_loop(window);
	if (r == GZ_OK)
		r = gz_window_loading_outcome(window);
	return r == GZ_OK ? gz_window_experiment_outcome(window) : r;
}

/* Finish what needs no display: recordings, threads. */
static void end_without_display(void *user)
{
	struct gz_window *window = user;
	window->context.display_lost = true;
	gz_notices_wake_by(window->notices, NULL);
	gz_err(window->log,
	       "the display is gone: its X server has ended or is out of reach; what was recorded "
	       "until now is kept");
	close_window(window);
}

enum gz_result gz_view_window(const struct gz_view_options *options, const struct gz_log *log,
			      struct gz_notices *notices)
{
	/* Without a display there is no use in loading. */
	enum gz_result r = check_backend(options, log);
	if (r == GZ_OK)
		r = open_display(log);
	struct gz_window *window = r == GZ_OK ? calloc(1, sizeof *window) : NULL;
	if (!window)
		return r == GZ_OK ? GZ_ERR_NO_MEM : r;
	window->options = options;
	window->log = log;
	window->notices = notices;
	memcpy(window->size_px, options->size_px, sizeof window->size_px);
	gz_view_pick_scene_tables(&window->settings, &window->tables);
	struct gz_display_loss loss = { .lost = end_without_display, .user = window };
	gz_glfw_watch_display(&loss);
	r = run_window(window);
	close_window(window);
	free(window);
	return r;
}
