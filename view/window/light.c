/* The part that moves the light by dragging the picture. */
#include <math.h>

#include <GLFW/glfw3.h>

#include "render/light/light.h"
#include "render/picture/camera.h"
#include "view/panels/widgets.h"
#include "view/settings/scene_keys.h"
#include "view/window/window_state.h"

#define GZ_LOG_MODULE "window"

/* Rotation by a drag over the window's height (chosen: as the camera). */
#define DRAG_DEG_PER_HEIGHT 180.0

/* The ball that shows where the light is: radii of the ball and of the lamp on it, unscaled. */
#define BALL_RADIUS 60.0F
#define LAMP_RADIUS 7.0F

static const struct gz_paint ball_paint = { 255, 255, 255, 110 };
static const struct gz_paint lamp_paint = { 255, 220, 90, 255 };

static bool is_lit(const struct gz_window *window)
{
	return window->maker && !window->alone &&
	       gz_setting_applies(&window->settings, "light.direction");
}

/* Rays of a picture of the window's shape. */
static bool rays_of_window(const struct gz_window *window, struct gz_ray_frame *out_rays)
{
	int width, height;
	glfwGetWindowSize(window->glfw, &width, &height);
	return gz_camera_rays(&window->settings.camera, width, height, out_rays) == GZ_OK;
}

static bool grab_light(struct gz_window *window, int button, int modifiers)
{
	if (button != GLFW_MOUSE_BUTTON_LEFT || modifiers != GZ_KEY_CONTROL)
		return false;
	if (!is_lit(window))
		gz_info(window->log, "nothing in this scene depends on the light's direction");
	gz_window_wake_panels(window);
	return true;
}

static void drag_light(struct gz_window *window, double right, double down)
{
	int width, height;
	struct gz_ray_frame rays;
	glfwGetWindowSize(window->glfw, &width, &height);
	if (height < 1 || !is_lit(window) || !rays_of_window(window, &rays))
		return;
	const double deg = DRAG_DEG_PER_HEIGHT / height;
	gz_light_turn(&window->settings.rays.light, &rays, right * deg, down * deg);
	window->cast_needed = true;
	gz_window_wake_panels(window);
}

/* While the light is dragged, a ball around the middle of the picture has a lamp on it: filled in
 * front, a ring behind. */
static void draw_light(struct gz_window *window, const struct gz_window_gaze *gaze)
{
	struct gz_ray_frame rays;
	double at[3];
	(void)gaze;
	if (window->grabber != &gz_window_light_part || !is_lit(window) ||
	    !rays_of_window(window, &rays))
		return;
	gz_light_seen(&window->settings.rays.light, &rays, at);
	const struct gz_place room = gz_widgets_room();
	const struct gz_place middle = { room.x / 2, room.y / 2 };
	const float radius = BALL_RADIUS * gz_widgets_scale();
	const struct gz_place lamp = { middle.x + radius * (float)at[0],
				       middle.y - radius * (float)at[1] };
	gz_draw_circle(GZ_LAYER_PICTURE, middle, BALL_RADIUS, ball_paint, 1);
	gz_draw_line(GZ_LAYER_PICTURE, middle, lamp, lamp_paint, 2);
	if (at[2] >= 0)
		gz_draw_disc(GZ_LAYER_PICTURE, lamp, LAMP_RADIUS, lamp_paint);
	else
		gz_draw_circle(GZ_LAYER_PICTURE, lamp, LAMP_RADIUS, lamp_paint, 2);
}

static void reset_light(struct gz_window *window, int number)
{
	const struct gz_light *given = &gz_frame_maker_scene(window->maker)->settings.rays.light;
	struct gz_light *light = &window->settings.rays.light;
	(void)number;
	for (int i = 0; i < 3; i++)
		light->direction[i] = given->direction[i];
	light->frame = given->frame;
	window->cast_needed = true;
}

static const struct gz_window_action light_actions[] = {
	{ .letter = 'w',
	  .keys = "W",
	  .help = "put the light back where the scene has it; Ctrl+drag moves it",
	  .name = "Reset the light",
	  .menu = GZ_MENU_EDIT,
	  .section = 1,
	  .words = "lamp",
	  .applies = is_lit,
	  .run = reset_light },
};

const struct gz_window_part gz_window_light_part = {
	.name = "light",
	.title = "picture",
	GZ_PART_ACTIONS(light_actions),
	.grab = grab_light,
	.drag = drag_light,
	.panels = draw_light,
};
