/* The part that moves and tilts the clip plane by handles in the picture. A handle in the plane
 * moves it along its normal. A ring around that handle is as a ball of glass with the plane in it:
 * a drag on the ring rolls the ball, and the plane tilts about the handle. */
#include <math.h>
#include <string.h>

#include <GLFW/glfw3.h>

#include "base/vector.h"
#include "render/picture/camera.h"
#include "view/panels/widgets.h"
#include "view/window/handles.h"
#include "view/window/window_state.h"

/* Radius of the ring and length of the arrow along the normal where they lie in the picture's plane
 * (chosen: a finger's width), and the disc at the arrow's tip; unscaled. */
#define RING_RADIUS 46.0F
#define TIP_RADIUS  3.5F

/* If the picture shows the whole way of the plane across the box shorter than this, unscaled, drags
 * up push the plane away, over the window's height for the whole way (chosen: a pixel of the mouse
 * would else be a sixtieth of the way). */
#define LEAST_WAY 60.0

enum held { NOTHING, MIDDLE, RING };

struct gz_window_clip_plane {
	bool shown;
	enum held held;
	double middle[3]; /* the handle's place in the world, on the plane once it is shown */
};

static const struct gz_paint paint = { 96, 220, 255, 255 };

static struct gz_clip_region *clip_of(struct gz_window *window)
{
	return &window->settings.rays.clip;
}

static const struct gz_volume *volume_of(const struct gz_window *window)
{
	return &gz_frame_maker_scene(window->maker)->volume;
}

static bool plane_has_handles(const struct gz_window *window)
{
	return window->clip_plane->shown && window->settings.rays.clip.plane &&
	       gz_window_has_handles(window);
}

static void world_of_share(const struct gz_window *window, const double share[3],
			   double out_world[3])
{
	double half[3];
	gz_volume_half_extent(volume_of(window), half);
	for (int axis = 0; axis < 3; axis++)
		out_world[axis] = (2 * share[axis] - 1) * half[axis];
}

/* The clip region in the world. */
static struct gz_clip_bounds bounds_of(const struct gz_window *window)
{
	struct gz_clip_bounds bounds;
	double edges[3], corner[3];
	gz_volume_half_extent(volume_of(window), edges);
	for (int axis = 0; axis < 3; axis++) {
		corner[axis] = -edges[axis];
		edges[axis] *= 2;
	}
	gz_clip_region_place(&window->settings.rays.clip, volume_of(window), edges, corner,
			     &bounds);
	return bounds;
}

static void normal_of(const struct gz_window *window, double out_normal[3])
{
	memcpy(out_normal, window->settings.rays.clip.normal, 3 * sizeof *out_normal);
	(void)gz_normalise3(out_normal);
}

/* Move a place to the nearest one on the plane. */
static void drop_on_plane(const struct gz_window *window, const struct gz_clip_bounds *bounds,
			  double world[3])
{
	double normal[3];
	normal_of(window, normal);
	const double away = gz_clip_beyond(bounds, world) / gz_length3(bounds->plane);
	for (int axis = 0; axis < 3; axis++)
		world[axis] -= away * normal[axis];
}

static bool is_in_box(const struct gz_clip_bounds *bounds, const double world[3])
{
	bool inside = true;
	for (int axis = 0; axis < 3; axis++)
		inside = inside && world[axis] >= bounds->least[axis] &&
			 world[axis] <= bounds->greatest[axis];
	return inside;
}

/* The middle of the plane's outline, or without one the plane's place nearest to the box's middle.
 */
static void middle_of_outline(struct gz_window *window, const struct gz_clip_bounds *bounds,
			      double out_world[3])
{
	double corners[GZ_BOX_POLYGON_MAX][3], share[3] = { 0, 0, 0 };
	const int count = gz_clip_plane_outline(clip_of(window), volume_of(window), corners);
	for (int i = 0; i < count; i++)
		for (int axis = 0; axis < 3; axis++)
			share[axis] += corners[i][axis] / count;
	world_of_share(window, share, out_world);
	for (int axis = 0; axis < 3 && count == 0; axis++)
		out_world[axis] = (bounds->least[axis] + bounds->greatest[axis]) / 2;
	drop_on_plane(window, bounds, out_world);
}

/* The handle stays where it is as long as the plane and the clip box leave it there. */
static void settle_middle(struct gz_window *window)
{
	struct gz_window_clip_plane *self = window->clip_plane;
	const struct gz_clip_bounds bounds = bounds_of(window);
	drop_on_plane(window, &bounds, self->middle);
	if (self->held == NOTHING && !is_in_box(&bounds, self->middle))
		middle_of_outline(window, &bounds, self->middle);
}

/* Unit vectors of the picture in the world: right, up, and towards the viewer. */
static bool axes_of_picture(const struct gz_window *window, double axes[3][3])
{
	int width, height;
	struct gz_ray_frame rays;
	glfwGetWindowSize(window->glfw, &width, &height);
	if (gz_camera_rays(&window->settings.camera, width, height, &rays) != GZ_OK)
		return false;
	for (int i = 0; i < 3; i++) {
		axes[0][i] = rays.origin_dx[i] + rays.direction_dx[i];
		axes[1][i] = -rays.origin_dy[i] - rays.direction_dy[i];
	}
	(void)gz_normalise3(axes[0]);
	(void)gz_normalise3(axes[1]);
	gz_cross3(axes[0], axes[1], axes[2]);
	return true;
}

/* How far the window shows a small step in the world from the handle, screen coordinates for each
 * unit of length. @return false: behind the eye */
static bool way_of_step(const struct gz_window *window, const double direction[3],
			double out_way[2])
{
	const double step = 1e-3;
	const double *middle = window->clip_plane->middle;
	struct gz_place at, ahead;
	double world[3];
	for (int axis = 0; axis < 3; axis++)
		world[axis] = middle[axis] + step * direction[axis];
	if (!gz_handle_place(window, middle, &at) || !gz_handle_place(window, world, &ahead))
		return false;
	out_way[0] = (double)(ahead.x - at.x) / step;
	out_way[1] = (double)(ahead.y - at.y) / step;
	return true;
}

/* What of the plane is under the mouse. */
static enum held held_at_mouse(const struct gz_window *window)
{
	struct gz_place at;
	if (!gz_handle_place(window, window->clip_plane->middle, &at))
		return NOTHING;
	const double away = gz_handle_away(window, at), reach = (double)GZ_HANDLE_REACH;
	if (away <= reach)
		return MIDDLE;
	return fabs(away - (double)RING_RADIUS) <= reach / 2 ? RING : NOTHING;
}

static bool grab_plane(struct gz_window *window, int button, int modifiers)
{
	struct gz_window_clip_plane *self = window->clip_plane;
	self->held = NOTHING;
	if (button != GLFW_MOUSE_BUTTON_LEFT || modifiers != 0 || !plane_has_handles(window))
		return false;
	settle_middle(window);
	self->held = held_at_mouse(window);
	return self->held != NOTHING;
}

/* The box's width along the plane's normal, world units. */
static double width_along(const struct gz_window *window, const double normal[3])
{
	double half[3], width = 0;
	gz_volume_half_extent(volume_of(window), half);
	for (int axis = 0; axis < 3; axis++)
		width += 2 * fabs(normal[axis]) * half[axis];
	return width;
}

/* How far along its normal a drag moves the plane, world units. */
static double move_of_drag(const struct gz_window *window, const double normal[3], double right,
			   double down)
{
	double axes[3][3], way[2];
	if (!axes_of_picture(window, axes) || !way_of_step(window, normal, way))
		return 0;
	const double length = hypot(way[0], way[1]), width = width_along(window, normal);
	if (length * width >= LEAST_WAY * (double)gz_widgets_scale())
		return (right * way[0] + down * way[1]) / (length * length);
	const double towards = gz_dot3(normal, axes[2]) < 0 ? -1 : 1;
	return towards * down / (double)gz_widgets_room().y * width;
}

/* Turn a vector about an axis of length 1: Rodrigues. */
static void turn_about(const double axis[3], double angle, double vector[3])
{
	double across[3];
	const double along = gz_dot3(axis, vector) * (1 - cos(angle));
	gz_cross3(axis, vector, across);
	for (int i = 0; i < 3; i++)
		vector[i] = vector[i] * cos(angle) + across[i] * sin(angle) + axis[i] * along;
}

static void tilt_by_drag(const struct gz_window *window, double right, double down,
			 double normal[3])
{
	double axes[3][3], axis[3];
	const double radius = (double)(RING_RADIUS * gz_widgets_scale());
	if (!axes_of_picture(window, axes))
		return;
	for (int i = 0; i < 3; i++)
		axis[i] = right * axes[1][i] + down * axes[0][i];
	if (gz_normalise3(axis))
		turn_about(axis, hypot(right, down) / radius, normal);
	(void)gz_normalise3(normal);
}

static void drag_plane(struct gz_window *window, double right, double down)
{
	struct gz_window_clip_plane *self = window->clip_plane;
	struct gz_clip_region *clip = clip_of(window);
	double normal[3];
	if (!plane_has_handles(window))
		return;
	normal_of(window, normal);
	if (self->held == RING) {
		tilt_by_drag(window, right, down, normal);
	} else {
		const double moved = move_of_drag(window, normal, right, down);
		for (int axis = 0; axis < 3; axis++)
			self->middle[axis] += moved * normal[axis];
	}
	memcpy(clip->normal, normal, sizeof normal);
	gz_clip_plane_through(clip, volume_of(window), self->middle);
	settle_middle(window);
	window->cast_needed = true;
	gz_window_wake_panels(window);
}

static void draw_outline(struct gz_window *window)
{
	double corners[GZ_BOX_POLYGON_MAX][3];
	const int count = gz_clip_plane_outline(clip_of(window), volume_of(window), corners);
	for (int i = 0; i < count; i++) {
		double ends[2][3];
		struct gz_place from, to;
		world_of_share(window, corners[i], ends[0]);
		world_of_share(window, corners[(i + 1) % count], ends[1]);
		if (gz_handle_place(window, ends[0], &from) &&
		    gz_handle_place(window, ends[1], &to))
			gz_handle_draw_line(from, to, paint);
	}
}

/* An arrow from the handle to the side that is cut off. */
static void draw_arrow(const struct gz_window *window, struct gz_place from)
{
	double axes[3][3], normal[3], across[2], tip[3];
	struct gz_place to;
	if (!axes_of_picture(window, axes) || !way_of_step(window, axes[0], across))
		return;
	const double scale = hypot(across[0], across[1]);
	normal_of(window, normal);
	for (int axis = 0; axis < 3; axis++)
		tip[axis] = window->clip_plane->middle[axis] +
			    (double)(RING_RADIUS * gz_widgets_scale()) / scale * normal[axis];
	if (!gz_handle_place(window, tip, &to))
		return;
	gz_handle_draw_line(from, to, paint);
	gz_draw_disc(GZ_LAYER_PICTURE, to, TIP_RADIUS, paint);
}

static void draw_plane(struct gz_window *window, const struct gz_window_gaze *gaze)
{
	struct gz_window_clip_plane *self = window->clip_plane;
	struct gz_place at;
	(void)gaze;
	if (window->grabber != &gz_window_clip_plane_part)
		self->held = NOTHING;
	if (!plane_has_handles(window))
		return;
	settle_middle(window);
	const enum held marked = self->held != NOTHING ? self->held : held_at_mouse(window);
	draw_outline(window);
	if (!gz_handle_place(window, self->middle, &at))
		return;
	gz_handle_draw_ring(at, RING_RADIUS, paint, marked == RING ? 3 : 1.5F);
	draw_arrow(window, at);
	gz_handle_draw(at, paint, marked == MIDDLE);
}

/* Nobody has placed the plane yet. */
static bool is_plane_preset(const struct gz_clip_region *clip)
{
	bool same = clip->offset == gz_clip_whole.offset;
	for (int axis = 0; axis < 3; axis++)
		same = same && clip->normal[axis] == gz_clip_whole.normal[axis];
	return same;
}

/* Let the plane lie across the axis along which the viewer looks the most, and cut off what is on
 * the viewer's side: seen from elsewhere, it would seem to do nothing. */
static void aim_first(struct gz_window *window)
{
	double axes[3][3];
	int nearest = 0;
	if (!axes_of_picture(window, axes))
		return;
	const double *viewer = axes[2];
	for (int axis = 1; axis < 3; axis++)
		nearest = fabs(viewer[axis]) > fabs(viewer[nearest]) ? axis : nearest;
	for (int axis = 0; axis < 3; axis++)
		clip_of(window)->normal[axis] = 0;
	clip_of(window)->normal[nearest] = viewer[nearest] < 0 ? -1 : 1;
}

static void turn_plane_on(struct gz_window *window)
{
	clip_of(window)->plane = true;
	window->clip_plane->shown = true;
	window->cast_needed = true;
	gz_handles_toggled(window, true, "clip plane");
}

static bool is_plane_shown(const struct gz_window *window, int number)
{
	(void)number;
	return window->clip_plane->shown && window->settings.rays.clip.plane;
}

static void toggle_plane(struct gz_window *window, int number)
{
	if (!is_plane_shown(window, number)) {
		if (!window->settings.rays.clip.plane && is_plane_preset(clip_of(window)))
			aim_first(window);
		turn_plane_on(window);
		return;
	}
	window->clip_plane->shown = false;
	gz_handles_toggled(window, false, "clip plane");
}

static bool has_plane(const struct gz_window *window)
{
	return gz_window_can_clip(window) && window->settings.rays.clip.plane;
}

static void face_camera(struct gz_window *window, int number)
{
	double axes[3][3];
	(void)number;
	if (!axes_of_picture(window, axes))
		return;
	turn_plane_on(window);
	settle_middle(window);
	memcpy(clip_of(window)->normal, axes[2], sizeof axes[2]);
	gz_clip_plane_through(clip_of(window), volume_of(window), window->clip_plane->middle);
}

static void turn_round(struct gz_window *window, int number)
{
	struct gz_clip_region *clip = clip_of(window);
	(void)number;
	for (int axis = 0; axis < 3; axis++)
		clip->normal[axis] = 0 - clip->normal[axis];
	clip->offset = 1 - clip->offset;
	window->cast_needed = true;
}

static void remove_plane(struct gz_window *window, int number)
{
	(void)number;
	clip_of(window)->plane = false;
	window->clip_plane->shown = false;
	window->cast_needed = true;
	gz_handles_toggled(window, false, "clip plane");
}

static const struct gz_window_action clip_plane_actions[] = {
	{ .letter = 'p',
	  .modifiers = GZ_KEY_SHIFT,
	  .keys = "Shift+P",
	  .help = "cut by an oblique clip plane, to drag and to tilt",
	  .name = "Clip plane",
	  .menu = GZ_MENU_EDIT,
	  .section = 1,
	  .on_picture = true,
	  .words = "clip cut section oblique slab handles tilt",
	  .is_on = is_plane_shown,
	  .applies = gz_window_can_clip,
	  .run = toggle_plane },
	{ .help = "turn the clip plane across the view; its near side is cut off",
	  .name = "Clip plane faces the camera",
	  .menu = GZ_MENU_EDIT,
	  .section = 1,
	  .words = "clip cut section oblique view front",
	  .applies = gz_window_can_clip,
	  .run = face_camera },
	{ .help = "cut off the clip plane's other side",
	  .name = "Turn the clip plane round",
	  .menu = GZ_MENU_EDIT,
	  .section = 1,
	  .words = "clip cut section flip invert other side back",
	  .applies = has_plane,
	  .run = turn_round },
	{ .help = "show again what the clip plane cuts off",
	  .name = "Remove the clip plane",
	  .menu = GZ_MENU_EDIT,
	  .section = 1,
	  .words = "clip cut section reset whole",
	  .applies = has_plane,
	  .run = remove_plane },
};

const struct gz_window_part gz_window_clip_plane_part = {
	.name = "clip plane",
	.title = "picture",
	GZ_PART_STATE(clip_plane),
	GZ_PART_ACTIONS(clip_plane_actions),
	.grab = grab_plane,
	.drag = drag_plane,
	.panels = draw_plane,
};
