/* The part that shows a surface without triangles while its isovalue or its time point changes, and
 * until those of the new one are made. */
#include <math.h>

#include <GLFW/glfw3.h>

#include "render/light/surface_look.h"
#include "view/frame/surface_rest.h"
#include "view/settings/scene_keys.h"
#include "view/window/time.h"
#include "view/window/window_state.h"

struct gz_window_surface {
	struct gz_surface_rest rest;
};

/* Whether the surface may change again at any moment. */
static bool is_surface_held(const struct gz_window *window)
{
	return glfwGetMouseButton(window->glfw, GLFW_MOUSE_BUTTON_LEFT) == GLFW_PRESS ||
	       gz_window_time_plays(window);
}

/* Whether triangles are made of the scene's volume, and rays could find the surface without them.
 * A part that is alone, as an experiment, and a replay show each picture as it is asked for. */
static bool can_do_without_triangles(const struct gz_window *window,
				     const struct gz_window_gaze *gaze)
{
	const struct gz_volume *volume = &gz_frame_maker_scene(window->maker)->volume;
	return !window->alone && !gaze->focus &&
	       window->settings.rays.surface.source == GZ_SURFACE_TRIANGLES &&
	       gz_setting_applies(&window->settings, "isosurface.source") &&
	       gz_volume_voxel_count(volume) <= GZ_SURFACE_VOXELS_MAX;
}

/* Called on the thread that makes them. */
static void wake_loop_for_triangles(void *user)
{
	(void)user;
	glfwPostEmptyEvent();
}

static void forget_surface(struct gz_window *window)
{
	window->surface->rest = (struct gz_surface_rest) { 0 };
	window->without_triangles = false;
}

static void watch_surface(struct gz_window *window, struct gz_window_gaze *gaze)
{
	if (!can_do_without_triangles(window, gaze)) {
		forget_surface(window);
		return;
	}
	const bool before = window->without_triangles;
	const struct gz_surface_state state = {
		.isovalue = window->settings.rays.surface.isovalue,
		.time_point = gz_frame_time_point(window->maker),
	};
	const bool moves = gz_surface_rest_step(&window->surface->rest, &state,
						is_surface_held(window), gz_clock_now_ns());
	window->without_triangles =
		moves ||
		(before && gz_frame_prepare(window->maker, &window->settings,
					    wake_loop_for_triangles) == GZ_FRAME_PREPARING);
	window->cast_needed = window->cast_needed || window->without_triangles != before;
}

/* Letting go of the mouse is an event, and so is the end of playing. */
static double surface_patience_s(const struct gz_window *window)
{
	return window->surface->rest.moves && !is_surface_held(window)
		       ? gz_ns_to_s(
				 gz_surface_rest_left_ns(&window->surface->rest, gz_clock_now_ns()))
		       : INFINITY;
}

const struct gz_window_part gz_window_surface_part = {
	.name = "surface",
	GZ_PART_STATE(surface),
	.scene_shown = forget_surface,
	.scene_leaving = forget_surface,
	.gaze = watch_surface,
	.patience_s = surface_patience_s,
};
