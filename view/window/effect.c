/* The part that shows what foveation does: a picture that is sharp only at the mouse, on the left
 * of one that is sharp everywhere. */
#include "view/window/effect.h"

#include <stdlib.h>
#include <string.h>

#include "render/plan/method.h"
#include "view/files/shipped_scenes.h"
#include "view/window/gaze.h"
#include "view/window/loading.h"
#include "view/window/simulator.h"
#include "view/window/window_state.h"

#define GZ_LOG_MODULE "window"

/* Degrees per cycle and degree of eccentricity (chosen: nearly three times what the eye resolves,
 * so that nobody overlooks it). */
#define SLOPE 0.06

struct gz_window_effect {
	bool pending; /* until the scene that is being opened is shown */
};

static void apply_effect(struct gz_window *window)
{
	struct gz_scene_settings *settings = &window->settings;
	settings->foveation.method = gz_method_find("acuity");
	settings->foveation.acuity_slope = SLOPE;
	settings->view.compare = GZ_COMPARE_SPLIT;
	settings->view.split = 0.5;
	settings->view.gaze_mark = true;
	window->gaze_frozen = false;
	if (!gz_window_is_simulating(window))
		gz_window_ask_for_gaze(window, "mouse");
	window->cast_needed = true;
	gz_info(window->log, "move the mouse: on the left only its surroundings are sharp, on the "
			     "right everything");
}

/* The first of some scenes with fine detail whose data are there. */
static void open_scene_of_effect(struct gz_window *window)
{
	static const char *const names[] = { "brain", "chameleon" };
	struct gz_shipped_scenes *scenes = malloc(sizeof *scenes);
	const struct gz_shipped_scene *scene = NULL;
	if (scenes && gz_shipped_scenes_read(scenes) == GZ_OK)
		for (size_t i = 0; !scene && i < sizeof names / sizeof names[0]; i++)
			scene = gz_shipped_scenes_find(scenes, names[i]);
	if (scene) {
		window->effect->pending = true;
		gz_window_open_file(window, scene->path);
	} else {
		gz_err(window->log, "no scene to show it on is installed; open one first");
	}
	free(scenes);
}

void gz_window_show_effect(struct gz_window *window)
{
	if (window->maker)
		apply_effect(window);
	else
		open_scene_of_effect(window);
	gz_window_wake_panels(window);
}

static void show_pending_effect(struct gz_window *window)
{
	if (window->effect->pending)
		apply_effect(window);
	window->effect->pending = false;
}

/* A scene that cannot be opened is not waited for. */
static void turn_effect(struct gz_window *window)
{
	if (!window->maker && !gz_window_is_loading(window))
		window->effect->pending = false;
}

static void show_effect(struct gz_window *window, int number)
{
	(void)number;
	gz_window_show_effect(window);
}

static const struct gz_window_action effect_actions[] = {
	{ .help = "what foveation does, beside full quality",
	  .name = "See what foveation does",
	  .menu = GZ_MENU_HELP,
	  .words = "effect demo demonstration fovea split compare mouse tour",
	  .run = show_effect },
};

const struct gz_window_part gz_window_effect_part = {
	.name = "effect",
	.title = "picture",
	GZ_PART_ACTIONS(effect_actions),
	GZ_PART_STATE(effect),
	.scene_shown = show_pending_effect,
	.turn = turn_effect,
};
