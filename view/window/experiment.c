#include "view/window/experiment.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <GL/glew.h>

#include <GLFW/glfw3.h>

#include "base/clock.h"
#include "client/viewer_link.h"
#include "view/experiment/experiment.h"
#include "view/panels/experiment_screen.h"
#include "view/window/displays.h"
#include "view/window/experiment_state.h"
#include "view/window/window_state.h"

#define GZ_LOG_MODULE "experiment"

/* Where the display does not tell its refresh. */
#define USUAL_REFRESH_HZ 60

/* Older gaze is as good as none, ns. Chosen: a few samples of a slow tracker. */
#define GAZE_AGE_NS (100 * GZ_NS_PER_MS)

/* How soon the bar of a loading is drawn anew, s (chosen). */
#define BAR_PATIENCE_S 0.1

static void mark(void *user, const char *label, int64_t time_ns)
{
	const struct gz_window *window = user;
	struct gz_viewer_link *link = window->link ? window->link : window->experiment->link;
	if (link)
		gz_viewer_link_annotate(link, label, time_ns);
}

static enum gz_result take_result(void *user, const struct gz_trial_result *result)
{
	const struct gz_window *window = user;
	return gz_answers_write(window->experiment->sitting->answers, result,
				window->experiment->start_ns);
}

static enum gz_result check_gaze(const struct gz_window *window,
				 const struct gz_experiment *experiment)
{
	const enum gz_gaze_kind kind = window->options->gaze.kind;
	const bool tracked =
		kind == GZ_GAZE_LATEST || kind == GZ_GAZE_POINTER || kind == GZ_GAZE_LOG;
	if (tracked || experiment->params.gaze != GZ_GAZE_REQUIRED)
		return GZ_OK;
	gz_err(window->log,
	       "--gaze %s: %s has gaze = required; take a tracker's, as by --gaze "
	       "daemon",
	       window->options->gaze_text, experiment->path);
	return GZ_ERR_INVAL;
}

/* What a scene says of a window with panels does not count; what the command line says of the
 * display does. */
static enum gz_result choose_view(struct gz_window *window)
{
	struct gz_scene_settings settings = { 0 };
	const struct gz_option_binding binding = { gz_view_setting_options,
						   gz_view_setting_option_count, &settings.view,
						   NULL };
	enum gz_result r = gz_options_preset(&binding);
	if (r == GZ_OK)
		r = gz_view_options_apply(window->options, &settings);
	window->settings.view = settings.view;
	window->experiment->view = settings.view;
	return r;
}

static void begin_run(struct gz_window *window)
{
	struct gz_window_experiment *state = window->experiment;
	const struct gz_sitting *sitting = state->sitting;
	const struct gz_run_sink sink = { .user = window, .mark = mark, .over = take_result };
	gz_run_begin(&state->run, &sitting->experiment, &sitting->sequence,
		     sitting->options->participant, sitting->options->session,
		     gz_answers_done(sitting->answers), &sink);
}

static enum gz_result open_state(struct gz_window *window)
{
	const struct gz_sitting_options *options = &window->options->sitting;
	if (!options->file[0])
		return GZ_OK;
	window->experiment = calloc(1, sizeof *window->experiment);
	if (!window->experiment)
		return GZ_ERR_NO_MEM;
	struct gz_window_experiment *state = window->experiment;
	window->alone = &gz_window_experiment_part;
	window->picture_hidden = true;
	enum gz_result r =
		gz_sitting_open(options, true, GAZECAST_VERSION, window->log, &state->sitting);
	if (r == GZ_OK)
		r = check_gaze(window, &state->sitting->experiment);
	if (r == GZ_OK)
		r = choose_view(window);
	/* A daemon may record though the gaze is not its own. */
	if (r == GZ_OK && !window->link)
		r = gz_viewer_link_open(NULL, window->log, &state->link);
	if (r == GZ_OK)
		begin_run(window);
	return r;
}

/* Full screen, without a cursor; whoever looks away does not end it. */
static enum gz_result gl_open(struct gz_window *window)
{
	struct gz_window_experiment *state = window->experiment;
	if (!state)
		return GZ_OK;
	glfwSetInputMode(window->glfw, GLFW_CURSOR, GLFW_CURSOR_HIDDEN);
	glfwSetDropCallback(window->glfw, NULL); /* nothing else is shown */
	glfwSetWindowAttrib(window->glfw, GLFW_AUTO_ICONIFY, GLFW_FALSE);
	if (!state->placed && !window->options->target.windowed)
		gz_window_toggle_fullscreen(window);
	state->placed = true;
	GLFWmonitor *monitor = gz_window_monitor(window->glfw);
	const GLFWvidmode *mode = monitor ? glfwGetVideoMode(monitor) : NULL;
	const int hz = mode && mode->refreshRate > 0 ? mode->refreshRate : USUAL_REFRESH_HZ;
	state->refresh_ns = GZ_NS_PER_S / hz;
	return GZ_OK;
}

/* The tracker's display is known once a daemon has told of it. */
static void follow_display(struct gz_window *window)
{
	const struct gz_window_experiment *state = window->experiment;
	struct GLFWmonitor *wanted = gz_window_tracker_handle(window);
	struct GLFWmonitor *there = glfwGetWindowMonitor(window->glfw);
	if (!state->run.begun && wanted && there && wanted != there)
		gz_window_fill_monitor(window, wanted);
}

static void finish(struct gz_window *window, enum gz_result result)
{
	gz_run_stop(&window->experiment->run, result, gz_clock_now_ns());
	glfwSetWindowShouldClose(window->glfw, GLFW_TRUE);
}

/* Once before its first interval each picture of the trial is made, unseen, so that nothing is left
 * to be made ready later; the first interval's last, which is shown next. @return whether that is
 * done */
static bool warm(struct gz_window *window)
{
	struct gz_window_experiment *state = window->experiment;
	const struct gz_presentation *presentation = state->run.trial.presentation;
	if (state->run.phase != GZ_RUN_PREPARE || !state->run.shown_ns ||
	    !gz_experiment_scenes_ready(state))
		return false;
	if (state->warm_index != state->run.index + 1) {
		state->warm_index = state->run.index + 1;
		state->warm_left = presentation->condition->params.intervals;
		state->warming = false;
	}
	if (state->warming && !state->frame_made)
		return false;
	state->warm_left -= state->warming;
	state->warming = state->warm_left > 0;
	if (!state->warming)
		return true;
	const int which = gz_presentation_alternative(presentation, state->warm_left - 1);
	state->shown =
		state->shown == &presentation->condition->alternatives[which] ? NULL : state->shown;
	const enum gz_result r =
		gz_experiment_show(window, &presentation->condition->alternatives[which]);
	if (r != GZ_OK)
		finish(window, r);
	return false;
}

/* What the phase shows, or will show next, is made; in others nothing is. */
static void choose_picture(struct gz_window *window)
{
	struct gz_window_experiment *state = window->experiment;
	const struct gz_run *run = &state->run;
	const struct gz_presentation *presentation = run->trial.presentation;
	const bool seen = run->phase == GZ_RUN_INTERVAL;
	const bool next = (run->phase == GZ_RUN_FIXATION || run->phase == GZ_RUN_BLANK) &&
			  run->shown_ns; /* the screen in between comes first */
	window->picture_hidden =
		!seen && !next && !(run->phase == GZ_RUN_PREPARE && state->warming);
	if (!seen && !next)
		return;
	const int interval = run->phase == GZ_RUN_BLANK ? run->interval + 1 : run->interval;
	const int which = gz_presentation_alternative(presentation, interval);
	const enum gz_result r =
		gz_experiment_show(window, &presentation->condition->alternatives[which]);
	if (r != GZ_OK)
		finish(window, r);
}

static void tell_absence(struct gz_window *window)
{
	struct gz_window_experiment *state = window->experiment;
	const bool shown = state->run.phase == GZ_RUN_INTERVAL;
	if (state->absence_told || !state->gaze_told || state->gaze_there ||
	    (!shown && !state->run.gaze_missing))
		return;
	state->absence_told = true;
	if (shown)
		gz_warn(window->log, "no tracker's gaze: pictures are sharp where it was last, or "
				     "at the mouse; is gazed running, and does it see the eye?");
	else
		gz_warn(window->log, "no tracker's gaze: the experiment waits for it; is gazed "
				     "running, and does it see the eye?");
}

/* How long a frame takes now: the display's refresh, or the shorter of the last two turns in this
 * phase, so that the making of its first picture does not count. */
static int64_t frame_ns(struct gz_window_experiment *state, int64_t now_ns)
{
	const bool same = state->turn_phase == state->run.phase && state->run.shown_ns;
	const int64_t spent_ns = same ? now_ns - state->turn_ns : 0;
	const int64_t before_ns = same ? state->turn_spent_ns : 0;
	const int64_t usual_ns = spent_ns < before_ns ? spent_ns : before_ns;
	state->turn_ns = now_ns;
	state->turn_spent_ns = spent_ns;
	state->turn_phase = state->run.phase;
	return usual_ns > state->refresh_ns ? usual_ns : state->refresh_ns;
}

static void step(struct gz_window *window)
{
	struct gz_window_experiment *state = window->experiment;
	const int64_t now_ns = gz_clock_now_ns();
	const struct gz_run_input input = {
		.now_ns = now_ns,
		.refresh_ns = frame_ns(state, now_ns),
		.ready = warm(window),
		.gaze_there = state->gaze_there,
	};
	if (gz_run_step(&state->run, &input))
		window->present_needed = true;
	choose_picture(window);
	tell_absence(window);
	/* In an interval each refresh is a frame, so that times from one to the next tell of
	 * those that were missed. */
	if (state->run.phase == GZ_RUN_INTERVAL || gz_experiment_loaded_share(state) < 1)
		window->present_needed = true;
}

/* A picture that could not be made has closed its scene. Why has been logged. */
static enum gz_result check_picture(const struct gz_window *window)
{
	const struct gz_alternative *shown = window->experiment->shown;
	if (!shown || window->maker)
		return GZ_OK;
	gz_err(window->log,
	       "%s: its picture cannot be made, so that the experiment ends; what was answered is "
	       "kept",
	       shown->scene);
	return GZ_ERR_UNSUPPORTED;
}

static void turn(struct gz_window *window)
{
	struct gz_window_experiment *state = window->experiment;
	if (!state)
		return;
	follow_display(window);
	enum gz_result r = state->run.phase == GZ_RUN_ENDED ? GZ_OK : check_picture(window);
	if (r == GZ_OK)
		r = gz_experiment_load_ahead(window);
	if (r != GZ_OK)
		finish(window, r);
	else if (state->run.phase != GZ_RUN_ENDED)
		step(window);
	if (state->run.phase == GZ_RUN_ENDED)
		glfwSetWindowShouldClose(window->glfw, GLFW_TRUE);
}

static void take_gaze(struct gz_window *window, struct gz_window_gaze *gaze)
{
	struct gz_window_experiment *state = window->experiment;
	if (!state)
		return;
	const enum gz_gaze_kind kind = window->options->gaze.kind;
	const struct gz_gaze_reading *reading = &gaze->reading;
	const bool closed = reading->has_event &&
			    (reading->event == GZ_EVENT_BLINK || reading->event == GZ_EVENT_LOST);
	state->gaze_told = kind == GZ_GAZE_LATEST || kind == GZ_GAZE_POINTER || kind == GZ_GAZE_LOG;
	state->gaze_there = !gaze->missing && reading->known && reading->connected && !closed &&
			    !(reading->has_age && reading->age_ns > GAZE_AGE_NS);
	state->px_per_deg = gz_display_px_per_deg(&gaze->display);
}

static void frame_made(struct gz_window *window)
{
	if (window->experiment && window->record.bricks_coming == 0)
		window->experiment->frame_made = true;
}

static void paint(struct gz_window *window, int width, int height)
{
	const struct gz_window_experiment *state = window->experiment;
	if (!state || (state->run.phase == GZ_RUN_INTERVAL && window->any_shown))
		return;
	const double *ground = state->sitting->experiment.params.ground;
	glViewport(0, 0, width, height);
	glClearColor((float)ground[0], (float)ground[1], (float)ground[2], 1);
	glClear(GL_COLOR_BUFFER_BIT);
}

/* The cross's width in the window's screen coordinates. */
static float cross_width(const struct gz_window *window)
{
	const struct gz_window_experiment *state = window->experiment;
	int width = 1, height = 1;
	glfwGetFramebufferSize(window->glfw, &width, &height);
	const double px = state->px_per_deg * state->sitting->experiment.params.fixation_deg;
	return (float)(px * gz_widgets_room().x / fmax(1, width));
}

static void draw_panels(struct gz_window *window, const struct gz_window_gaze *gaze)
{
	const struct gz_window_experiment *state = window->experiment;
	(void)gaze;
	if (!state)
		return;
	struct gz_run_screen screen;
	gz_run_screen(&state->run, &screen);
	const struct gz_experiment_params *params = &state->sitting->experiment.params;
	const struct gz_experiment_look look = {
		.ground = { params->ground[0], params->ground[1], params->ground[2] },
		.text_size = params->text_size,
	};
	if (screen.phase == GZ_RUN_FIXATION && screen.gaze_missing)
		gz_experiment_screen_text(&look, "The eye tracker does not see your eyes.\nSit as "
						 "before: it goes on by itself.");
	else if (screen.phase == GZ_RUN_FIXATION)
		gz_experiment_screen_cross(&look, cross_width(window));
	else if (screen.text)
		gz_experiment_screen_text(&look, screen.text);
	if (screen.phase == GZ_RUN_TEXT && screen.done > 0 && screen.done < screen.count) {
		char note[64];
		snprintf(note, sizeof note, "%zu of %zu", screen.done, screen.count);
		gz_experiment_screen_note(&look, note);
	}
	const double share = gz_experiment_loaded_share(state);
	if (share < 1 && (screen.phase == GZ_RUN_TEXT || screen.phase == GZ_RUN_PREPARE))
		gz_experiment_screen_bar(&look, share);
}

/* When what was swapped is there: the driver has no more to do. */
static void presented(struct gz_window *window)
{
	struct gz_window_experiment *state = window->experiment;
	if (!state)
		return;
	glFinish();
	const int64_t now_ns = gz_clock_now_ns();
	gz_run_shown(&state->run, now_ns);
	gz_run_frame(&state->run, &(struct gz_run_frame) {
					  .shown_ns = now_ns,
					  .refresh_ns = state->refresh_ns,
					  .gaze_told = state->gaze_told,
					  .gaze_there = state->gaze_there,
				  });
	if (!state->start_ns)
		state->start_ns = state->run.trial.begin_ns;
}

static double patience_s(const struct gz_window *window)
{
	const struct gz_window_experiment *state = window->experiment;
	if (!state)
		return INFINITY;
	/* The swap waits for the display where it can: less than a refresh is left to wait. */
	const double refresh_s = gz_ns_to_s(state->refresh_ns) / 2;
	const struct gz_presentation *presentation = state->run.trial.presentation;
	switch (state->run.phase) {
	case GZ_RUN_TEXT:
	case GZ_RUN_LEAVING:
		return gz_experiment_loaded_share(state) < 1 ? BAR_PATIENCE_S : INFINITY;
	case GZ_RUN_PREPARE:
		return state->warming || gz_experiment_scenes_ready(state) ? 0 : BAR_PATIENCE_S / 2;
	case GZ_RUN_QUESTION:
		return presentation->condition->params.timeout_s > 0 ? refresh_s : INFINITY;
	default:
		return refresh_s;
	}
}

/* Letters by the user's layout, digits by their place: some layouts have them with Shift. */
static int answer_key(int key, int scancode)
{
	static const struct {
		int glfw, key;
	} keys[] = {
		{ GLFW_KEY_SPACE, GZ_KEY_SPACE },   { GLFW_KEY_LEFT, GZ_KEY_LEFT },
		{ GLFW_KEY_RIGHT, GZ_KEY_RIGHT },   { GLFW_KEY_UP, GZ_KEY_UP },
		{ GLFW_KEY_DOWN, GZ_KEY_DOWN },     { GLFW_KEY_ENTER, GZ_KEY_RETURN },
		{ GLFW_KEY_ESCAPE, GZ_KEY_ESCAPE }, { GLFW_KEY_KP_ENTER, GZ_KEY_RETURN },
	};
	for (size_t i = 0; i < sizeof keys / sizeof keys[0]; i++)
		if (keys[i].glfw == key)
			return keys[i].key;
	if (key >= GLFW_KEY_0 && key <= GLFW_KEY_9)
		return '0' + key - GLFW_KEY_0;
	if (key >= GLFW_KEY_KP_0 && key <= GLFW_KEY_KP_9)
		return '0' + key - GLFW_KEY_KP_0;
	const char *name = glfwGetKeyName(key, scancode);
	return name ? gz_answer_key_of(name) : GZ_KEY_NONE;
}

static bool take_key(struct gz_window *window, int key, int scancode, bool repeated)
{
	struct gz_window_experiment *state = window->experiment;
	const int answer = repeated ? GZ_KEY_NONE : answer_key(key, scancode);
	if (answer != GZ_KEY_NONE && gz_run_key(&state->run, answer, gz_clock_now_ns()))
		window->present_needed = true;
	return true;
}

enum gz_result gz_window_experiment_outcome(struct gz_window *window)
{
	struct gz_window_experiment *state = window->experiment;
	if (!state)
		return GZ_OK;
	const struct gz_answers *answers = state->sitting->answers;
	gz_run_stop(&state->run, GZ_ERR_CANCELLED, gz_clock_now_ns());
	const size_t done = gz_answers_done(answers), count = state->sitting->sequence.count;
	if (done == count)
		gz_info(window->log, "%s: all %zu trials are answered", gz_answers_file(answers),
			count);
	else if (done > 0)
		gz_info(window->log, "%s: %zu of %zu trials are answered; --resume goes on",
			gz_answers_file(answers), done, count);
	else
		gz_info(window->log, "left before the first answer: nothing is kept");
	return state->run.result;
}

static void close_state(struct gz_window *window)
{
	struct gz_window_experiment *state = window->experiment;
	if (!state)
		return;
	gz_experiment_release_scenes(window);
	gz_viewer_link_close(&state->link);
	gz_sitting_close(&state->sitting);
	free(state);
	window->experiment = NULL;
	window->alone = NULL;
}

const struct gz_window_part gz_window_experiment_part = {
	.name = "experiment",
	.open = open_state,
	.gl_open = gl_open,
	.turn = turn,
	.gaze = take_gaze,
	.frame_made = frame_made,
	.paint = paint,
	.panels = draw_panels,
	.presented = presented,
	.patience_s = patience_s,
	.key = take_key,
	.close = close_state,
};
