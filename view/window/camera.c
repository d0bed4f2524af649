/* The part that moves the camera: by mouse and keys, to views along an axis, and to saved views. */
#include <math.h>
#include <stdlib.h>

#include <GLFW/glfw3.h>

#include "render/picture/camera.h"
#include "render/scene/view_settings.h"
#include "view/window/window_state.h"

#define GZ_LOG_MODULE "window"

/* Rotation by a drag over the window's height (chosen: half a turn in one sweep). */
#define DRAG_DEG_PER_HEIGHT 180.0
/* Change of distance per notch of the wheel or press of a key (chosen: seven halve it). */
#define ZOOM_PER_NOTCH 0.9
/* Per press of a key (chosen: a quarter turn in nine presses; the picture's height in twenty). */
#define KEY_DEG     10.0
#define KEY_HEIGHTS 0.05

enum direction { LEFT, RIGHT, UP, DOWN };

static const double rightward[] = { [LEFT] = -1, [RIGHT] = 1, [UP] = 0, [DOWN] = 0 };
static const double upward[] = { [LEFT] = 0, [RIGHT] = 0, [UP] = 1, [DOWN] = -1 };

/* The camera, which is about to change. */
static struct gz_camera *changed_camera(struct gz_window *window)
{
	window->cast_needed = true;
	return &window->settings.camera;
}

static bool has_scene(const struct gz_window *window)
{
	return window->maker != NULL;
}

/* The eye moves to where the arrow points. */
static void orbit_by_key(struct gz_window *window, int direction)
{
	gz_camera_orbit(changed_camera(window), -rightward[direction] * KEY_DEG,
			upward[direction] * KEY_DEG);
}

static void pan_by_key(struct gz_window *window, int direction)
{
	gz_camera_pan(changed_camera(window), -rightward[direction] * KEY_HEIGHTS,
		      -upward[direction] * KEY_HEIGHTS);
}

static void zoom_by_key(struct gz_window *window, int notches)
{
	gz_camera_zoom(changed_camera(window), pow(ZOOM_PER_NOTCH, notches));
}

static void switch_projection(struct gz_window *window, int number)
{
	(void)number;
	struct gz_camera *camera = changed_camera(window);
	gz_camera_set_projection(camera, camera->projection == GZ_PROJECTION_PERSPECTIVE
						 ? GZ_PROJECTION_ORTHOGRAPHIC
						 : GZ_PROJECTION_PERSPECTIVE);
}

static void reset_camera(struct gz_window *window, int number)
{
	(void)number;
	*changed_camera(window) = gz_frame_maker_scene(window->maker)->settings.camera;
}

/* Axes 1 to 3; negative: from the other side. */
static void look_along(struct gz_window *window, int axis)
{
	gz_camera_look_along(changed_camera(window), abs(axis) - 1, axis < 0);
}

static void save_view(struct gz_window *window, int number)
{
	gz_saved_view_print(&window->settings.camera, window->settings.view.saved[number]);
	gz_info(window->log, "view stored: F%d shows it; save the scene to keep it", number + 1);
}

static void show_view(struct gz_window *window, int number)
{
	const char *text = window->settings.view.saved[number];
	if (!text[0])
		gz_info(window->log, "no view stored on F%d yet; Shift+F%d stores this one",
			number + 1, number + 1);
	else
		gz_saved_view_parse(text, changed_camera(window));
}

static const char *lacks_view(const struct gz_window *window, int number)
{
	return window->settings.view.saved[number][0] ? NULL : "empty";
}

static bool is_orthographic(const struct gz_window *window, int number)
{
	(void)number;
	return window->settings.camera.projection == GZ_PROJECTION_ORTHOGRAPHIC;
}

#define ARROW(name, what, with, function)                                                       \
	{                                                                                       \
		.key = GLFW_KEY_##name, .modifiers = (with), .repeats = true, .number = (what), \
		.applies = has_scene, .run = (function)                                         \
	}

#define AXIS(character, with, what, side)                                                     \
	{                                                                                     \
		.letter = (character), .modifiers = (with), .number = (what), .name = (side), \
		.menu = GZ_MENU_VIEW, .submenu = "Look from", .applies = has_scene,           \
		.run = look_along                                                             \
	}

#define VIEW(which, with, text, where, fails, function)                                 \
	{                                                                               \
		.key = GLFW_KEY_F##which, .modifiers = (with), .number = (which)-1,     \
		.name = (text), .menu = GZ_MENU_VIEW, .section = 1, .submenu = (where), \
		.lacks = (fails), .applies = has_scene, .run = (function)               \
	}
#define SHOW_VIEW(which) VIEW(which, 0, "View " #which, "Stored views", lacks_view, show_view)
#define STORE_VIEW(which) \
	VIEW(which, GZ_KEY_SHIFT, "As view " #which, "Store this view", NULL, save_view)

static const struct gz_window_action camera_actions[] = {
	{ .key = GLFW_KEY_LEFT,
	  .repeats = true,
	  .number = LEFT,
	  .keys = "arrows",
	  .help = "turn; or drag the picture",
	  .applies = has_scene,
	  .run = orbit_by_key },
	ARROW(RIGHT, RIGHT, 0, orbit_by_key),
	ARROW(UP, UP, 0, orbit_by_key),
	ARROW(DOWN, DOWN, 0, orbit_by_key),
	{ .key = GLFW_KEY_LEFT,
	  .modifiers = GZ_KEY_SHIFT,
	  .repeats = true,
	  .number = LEFT,
	  .keys = "Shift+arrows",
	  .help = "move sideways; or drag with the right button",
	  .applies = has_scene,
	  .run = pan_by_key },
	ARROW(RIGHT, RIGHT, GZ_KEY_SHIFT, pan_by_key),
	ARROW(UP, UP, GZ_KEY_SHIFT, pan_by_key),
	ARROW(DOWN, DOWN, GZ_KEY_SHIFT, pan_by_key),
	{ .letter = '+',
	  .repeats = true,
	  .number = 1,
	  .keys = "+ -",
	  .help = "zoom; or the wheel. Shift+drag rolls",
	  .applies = has_scene,
	  .run = zoom_by_key },
	ARROW(KP_ADD, 1, 0, zoom_by_key),
	{ .letter = '-', .repeats = true, .number = -1, .applies = has_scene, .run = zoom_by_key },
	ARROW(KP_SUBTRACT, -1, 0, zoom_by_key),
	{ .letter = 'o',
	  .keys = "O",
	  .help = "perspective or orthographic",
	  .name = "Orthographic",
	  .menu = GZ_MENU_VIEW,
	  .words = "parallel projection perspective",
	  .is_on = is_orthographic,
	  .applies = has_scene,
	  .run = switch_projection },
	{ .letter = 'x',
	  .number = 1,
	  .keys = "X Y Z",
	  .help = "look from right, front, above; Shift: opposite",
	  .name = "The right",
	  .menu = GZ_MENU_VIEW,
	  .submenu = "Look from",
	  .words = "axis sagittal coronal axial left back below",
	  .applies = has_scene,
	  .run = look_along },
	AXIS('y', 0, 2, "The front"),
	AXIS('z', 0, 3, "Above"),
	AXIS('x', GZ_KEY_SHIFT, -1, "The left"),
	AXIS('y', GZ_KEY_SHIFT, -2, "Behind"),
	AXIS('z', GZ_KEY_SHIFT, -3, "Below"),
	{ .letter = 'r',
	  .keys = "R",
	  .help = "reset the camera to the scene's",
	  .name = "Reset the camera",
	  .menu = GZ_MENU_VIEW,
	  .on_picture = true,
	  .words = "home fit centre center view",
	  .applies = has_scene,
	  .run = reset_camera },
	{ .key = GLFW_KEY_F1,
	  .number = 0,
	  .keys = "F1 to F8",
	  .help = "show a stored view; with Shift store this one",
	  .name = "View 1",
	  .menu = GZ_MENU_VIEW,
	  .section = 1,
	  .submenu = "Stored views",
	  .words = "bookmark camera",
	  .lacks = lacks_view,
	  .applies = has_scene,
	  .run = show_view },
	SHOW_VIEW(2),
	SHOW_VIEW(3),
	SHOW_VIEW(4),
	SHOW_VIEW(5),
	SHOW_VIEW(6),
	SHOW_VIEW(7),
	SHOW_VIEW(8),
	STORE_VIEW(1),
	STORE_VIEW(2),
	STORE_VIEW(3),
	STORE_VIEW(4),
	STORE_VIEW(5),
	STORE_VIEW(6),
	STORE_VIEW(7),
	STORE_VIEW(8),
};

/* What a drag does. */
enum drag { DRAG_ORBIT, DRAG_PAN, DRAG_ROLL };

static bool grab_camera(struct gz_window *window, int button, int modifiers)
{
	if (button == GLFW_MOUSE_BUTTON_MIDDLE || button == GLFW_MOUSE_BUTTON_RIGHT)
		window->camera_drag = DRAG_PAN;
	else if (modifiers == GZ_KEY_SHIFT)
		window->camera_drag = DRAG_ROLL;
	else
		window->camera_drag = DRAG_ORBIT;
	return true;
}

/* The picture follows the mouse. */
static void drag_camera(struct gz_window *window, double right, double down)
{
	int width, height;
	glfwGetWindowSize(window->glfw, &width, &height);
	if (height < 1)
		return;
	const double deg = DRAG_DEG_PER_HEIGHT / height;
	struct gz_camera *camera = changed_camera(window);
	if (window->camera_drag == DRAG_PAN)
		gz_camera_pan(camera, right / height, -down / height);
	else if (window->camera_drag == DRAG_ROLL)
		gz_camera_roll(camera, -right * deg);
	else
		gz_camera_orbit(camera, -right * deg, -down * deg);
}

static bool zoom_by_wheel(struct gz_window *window, double up)
{
	gz_camera_zoom(changed_camera(window), pow(ZOOM_PER_NOTCH, up));
	return true;
}

const struct gz_window_part gz_window_camera_part = {
	.name = "camera",
	GZ_PART_ACTIONS(camera_actions),
	.grab = grab_camera,
	.drag = drag_camera,
	.wheel = zoom_by_wheel,
};
