/* The part that starts a simulated viewer and stops it again. The places that attract it are the
 * salient points of a small picture of what the window shows. It is written again when that has
 * changed, and gazed reads it again. */
#include "view/window/simulator.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/clock.h"
#include "render/picture/image.h"
#include "view/files/programs.h"
#include "view/window/gaze.h"
#include "view/window/window_state.h"

#define GZ_LOG_MODULE "window"

/* Interval of asking whether the program still runs and whether the picture has changed (chosen: a
 * viewer that turns to something new takes about as long). */
#define INTERVAL_NS GZ_NS_PER_S

/* Largest size of the picture, px (chosen: salient places of some degrees are seen in it, and it
 * hides what foveation changes). */
enum { WIDTH = 320, HEIGHT = 200 };

/* A picture has changed if more than one pixel in this many has by more than this of 255 (chosen:
 * above what a move of the gaze changes). */
enum { CHANGED_ONE_IN = 100, CHANGED_LEVELS = 32 };

struct gz_window_simulator {
	pid_t child;                /* gazed; 0: none */
	char folder[32];            /* that holds the picture; empty: there is none */
	char picture[64];           /* its path */
	struct gz_image told, next; /* the picture that it has, and room for the next one */
	int64_t looked_ns;
};

/* The picture of a window without a scene: nothing attracts. */
static enum gz_result make_empty_picture(struct gz_image *image)
{
	const enum gz_result r = gz_image_resize(image, 16, 10);
	if (r == GZ_OK)
		memset(image->pixels, 0x20, (size_t)4 * 16 * 10);
	return r;
}

/* @return whether it is the window's picture; false: an empty one, or there is no memory */
static bool take_picture(struct gz_window *window, struct gz_image *out_image)
{
	if (window->maker && window->any_shown && !window->alone && !window->picture_hidden)
		return gz_window_shrink_shown(window, WIDTH, HEIGHT, out_image) == GZ_OK;
	return false;
}

static bool has_picture_changed(const struct gz_image *before, const struct gz_image *now)
{
	if (before->width != now->width || before->height != now->height)
		return true;
	const int count = now->width * now->height;
	int changed = 0;
	for (int i = 0; i < count; i++) {
		int most = 0;
		for (int k = 0; k < 3; k++) {
			const int by = abs(now->pixels[4 * i + k] - before->pixels[4 * i + k]);
			most = by > most ? by : most;
		}
		changed += most > CHANGED_LEVELS;
	}
	return changed > count / CHANGED_ONE_IN;
}

/* Show the next picture to the viewer. */
static enum gz_result tell_picture(struct gz_window *window)
{
	struct gz_window_simulator *self = window->simulator;
	const enum gz_result r = gz_image_write_png(&self->next, self->picture, window->log);
	const struct gz_image told = self->told;
	self->told = self->next;
	self->next = told;
	return r;
}

static enum gz_result make_folder(struct gz_window *window)
{
	struct gz_window_simulator *self = window->simulator;
	snprintf(self->folder, sizeof self->folder, "/tmp/gazeview-XXXXXX");
	if (!mkdtemp(self->folder)) {
		gz_err(window->log, "no simulated viewer: /tmp: %s", strerror(errno));
		self->folder[0] = '\0';
		return GZ_ERR_IO;
	}
	snprintf(self->picture, sizeof self->picture, "%s/shown.png", self->folder);
	return GZ_OK;
}

static void remove_folder(struct gz_window_simulator *self)
{
	if (!self->folder[0])
		return;
	unlink(self->picture);
	rmdir(self->folder);
	self->folder[0] = '\0';
	gz_image_free(&self->told);
	gz_image_free(&self->next);
}

static enum gz_result start_simulator(struct gz_window *window)
{
	struct gz_window_simulator *self = window->simulator;
	char path[GZ_PATH_SIZE], picture[sizeof self->picture + 16];
	if (gz_program_path("gazed", path) != GZ_OK) {
		gz_err(window->log, "no simulated viewer: gazed is not beside gazeview");
		return GZ_ERR_NOT_FOUND;
	}
	enum gz_result r = make_folder(window);
	if (r == GZ_OK && !take_picture(window, &self->next))
		r = make_empty_picture(&self->next);
	if (r == GZ_OK)
		r = tell_picture(window);
	if (r != GZ_OK)
		return r;
	snprintf(picture, sizeof picture, "--sim.picture=%s", self->picture);
	char *const arguments[] = { path, (char *)"--driver=sim", (char *)"--tcp=off", picture,
				    NULL };
	r = gz_program_start(arguments, &self->child);
	if (r != GZ_OK)
		gz_err(window->log, "no simulated viewer: %s cannot be started", path);
	return r;
}

static void stop_simulator(struct gz_window *window)
{
	gz_program_stop(&window->simulator->child);
	remove_folder(window->simulator);
}

bool gz_window_is_simulating(const struct gz_window *window)
{
	return window->simulator->child > 0;
}

void gz_window_toggle_simulator(struct gz_window *window)
{
	if (gz_window_is_simulating(window)) {
		stop_simulator(window);
		gz_window_ask_for_gaze(window, "mouse");
	} else if (start_simulator(window) == GZ_OK) {
		gz_info(window->log, "a simulated viewer looks around; it ends with this window");
		gz_window_ask_for_gaze(window, "daemon");
	} else {
		stop_simulator(window);
	}
	gz_window_wake_panels(window);
}

static void turn_simulator(struct gz_window *window)
{
	struct gz_window_simulator *self = window->simulator;
	const int64_t now_ns = gz_clock_now_ns();
	if (self->child == 0 || now_ns - self->looked_ns < INTERVAL_NS)
		return;
	self->looked_ns = now_ns;
	if (!gz_program_runs(&self->child)) {
		gz_warn(window->log, "the simulated viewer has ended; another gazed may be "
				     "running");
		remove_folder(self);
	} else if (take_picture(window, &self->next) &&
		   has_picture_changed(&self->told, &self->next)) {
		(void)tell_picture(window);
	}
}

static double simulator_patience_s(const struct gz_window *window)
{
	return gz_window_is_simulating(window) ? gz_ns_to_s(INTERVAL_NS) : INFINITY;
}

static bool is_simulator_on(const struct gz_window *window, int number)
{
	(void)number;
	return gz_window_is_simulating(window);
}

static void toggle_simulator(struct gz_window *window, int number)
{
	(void)number;
	gz_window_toggle_simulator(window);
}

static const struct gz_window_action simulator_actions[] = {
	{ .help = "a simulated viewer looks around, by gazed",
	  .group = "gaze",
	  .name = "Simulated viewer",
	  .menu = GZ_MENU_GAZE,
	  .words = "sim gazed daemon demo synthetic",
	  .is_on = is_simulator_on,
	  .run = toggle_simulator },
};

const struct gz_window_part gz_window_simulator_part = {
	.name = "simulator",
	.title = "gaze",
	GZ_PART_ACTIONS(simulator_actions),
	GZ_PART_STATE(simulator),
	.turn = turn_simulator,
	.patience_s = simulator_patience_s,
	.close = stop_simulator,
};
