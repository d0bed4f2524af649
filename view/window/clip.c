/* The part that moves the faces of the clip box by handles in the picture. */
#include <math.h>

#include <GLFW/glfw3.h>

#include "view/panels/widgets.h"
#include "view/window/handles.h"
#include "view/window/window_state.h"

/* The least that remains of an edge of the box (chosen: a slice of most volumes). */
#define LEAST_SHARE 0.005

/* A face whose whole way across the box is shorter than this in the picture is seen from the front
 * and cannot be dragged (chosen: a pixel of the mouse would be a tenth of the box), unscaled. */
#define LEAST_WAY 10.0

enum { FACES = 6, NO_FACE = -1 };

struct gz_window_clip {
	bool shown;
	int face; /* that is dragged: axis, + 3 for the greatest; NO_FACE: none */
};

static const struct gz_paint paint = { 255, 214, 64, 255 };

static bool handles_are_there(const struct gz_window *window)
{
	return window->clip->shown && gz_window_has_handles(window);
}

static struct gz_clip_region *box_of(struct gz_window *window)
{
	return &window->settings.rays.clip;
}

/* Where a place in the box, as shares of its edges, is in the window. @return false: behind the eye
 */
static bool place_in_window(const struct gz_window *window, const double share[3],
			    struct gz_place *out_place)
{
	double half[3], world[3];
	gz_volume_half_extent(&gz_frame_maker_scene(window->maker)->volume, half);
	for (int axis = 0; axis < 3; axis++)
		world[axis] = (2 * share[axis] - 1) * half[axis];
	return gz_handle_place(window, world, out_place);
}

/* The middle of a face; with `moved`, moved outwards along its axis by this share of the edge. */
static bool face_in_window(struct gz_window *window, int face, double moved,
			   struct gz_place *out_place)
{
	const struct gz_clip_region *box = box_of(window);
	double share[3];
	for (int axis = 0; axis < 3; axis++)
		share[axis] = (box->least[axis] + box->greatest[axis]) / 2;
	share[face % 3] = (face < 3 ? box->least : box->greatest)[face % 3] + moved;
	return place_in_window(window, share, out_place);
}

/* The face whose handle is under the mouse, the nearest one. */
static int face_at_mouse(struct gz_window *window)
{
	double nearest = (double)GZ_HANDLE_REACH;
	int found = NO_FACE;
	for (int face = 0; face < FACES; face++) {
		struct gz_place at;
		if (!face_in_window(window, face, 0, &at))
			continue;
		const double away = gz_handle_away(window, at);
		if (away <= nearest) {
			nearest = away;
			found = face;
		}
	}
	return found;
}

static bool grab_face(struct gz_window *window, int button, int modifiers)
{
	if (button != GLFW_MOUSE_BUTTON_LEFT || modifiers != 0 || !handles_are_there(window))
		return false;
	window->clip->face = face_at_mouse(window);
	return window->clip->face != NO_FACE;
}

/* Move the face by as much of its way as the mouse went along it in the picture. */
static void drag_face(struct gz_window *window, double right, double down)
{
	const int face = window->clip->face, axis = face % 3;
	const double step = 0.01;
	struct gz_clip_region *box = box_of(window);
	struct gz_place at, ahead;
	if (!handles_are_there(window) || !face_in_window(window, face, 0, &at) ||
	    !face_in_window(window, face, step, &ahead))
		return;
	const double way[2] = { (double)(ahead.x - at.x) / step, (double)(ahead.y - at.y) / step };
	const double length = hypot(way[0], way[1]);
	if (length < LEAST_WAY * (double)gz_widgets_scale())
		return;
	const double moved = (right * way[0] + down * way[1]) / (length * length);
	double *bound = &(face < 3 ? box->least : box->greatest)[axis];
	const double low = face < 3 ? 0 : box->least[axis] + LEAST_SHARE;
	const double high = face < 3 ? box->greatest[axis] - LEAST_SHARE : 1;
	*bound = fmin(fmax(*bound + moved, fmin(low, high)), fmax(low, high));
	window->cast_needed = true;
	gz_window_wake_panels(window);
}

static void draw_edges(struct gz_window *window)
{
	const struct gz_clip_region *box = box_of(window);
	for (int axis = 0; axis < 3; axis++)
		for (int side = 0; side < 4; side++) {
			const int other = (axis + 1) % 3, third = (axis + 2) % 3;
			struct gz_place from, to;
			double share[3];
			share[other] = (side & 1 ? box->greatest : box->least)[other];
			share[third] = (side & 2 ? box->greatest : box->least)[third];
			share[axis] = box->least[axis];
			const bool begins = place_in_window(window, share, &from);
			share[axis] = box->greatest[axis];
			if (begins && place_in_window(window, share, &to))
				gz_handle_draw_line(from, to, paint);
		}
}

static void draw_handles(struct gz_window *window, const struct gz_window_gaze *gaze)
{
	(void)gaze;
	if (!handles_are_there(window))
		return;
	const bool dragged = window->grabber == &gz_window_clip_part;
	const int marked = dragged ? window->clip->face : face_at_mouse(window);
	draw_edges(window);
	for (int face = 0; face < FACES; face++) {
		struct gz_place at;
		if (face_in_window(window, face, 0, &at))
			gz_handle_draw(at, paint, face == marked);
	}
}

static void toggle_handles(struct gz_window *window, int number)
{
	(void)number;
	window->clip->shown = !window->clip->shown;
	gz_handles_toggled(window, window->clip->shown, "clip box");
}

static bool are_handles_on(const struct gz_window *window, int number)
{
	(void)number;
	return window->clip->shown;
}

static bool is_clipped(const struct gz_window *window)
{
	struct gz_clip_region box = window->settings.rays.clip;
	box.plane = false;
	return gz_window_can_clip(window) && gz_clip_region_cuts(&box);
}

static void show_whole_box(struct gz_window *window, int number)
{
	(void)number;
	struct gz_clip_region *box = box_of(window);
	for (int axis = 0; axis < 3; axis++) {
		box->least[axis] = gz_clip_whole.least[axis];
		box->greatest[axis] = gz_clip_whole.greatest[axis];
	}
	window->cast_needed = true;
}

static const struct gz_window_action clip_actions[] = {
	{ .letter = 'c',
	  .modifiers = GZ_KEY_SHIFT,
	  .keys = "Shift+C",
	  .help = "handles on the faces of the clip box, to drag",
	  .name = "Clip box",
	  .menu = GZ_MENU_EDIT,
	  .section = 1,
	  .on_picture = true,
	  .words = "clip cut crop slab handles faces",
	  .is_on = are_handles_on,
	  .applies = gz_window_can_clip,
	  .run = toggle_handles },
	{ .help = "show again what the clip box cuts off",
	  .name = "Remove the clip box",
	  .menu = GZ_MENU_EDIT,
	  .section = 1,
	  .words = "clip cut crop reset whole",
	  .applies = is_clipped,
	  .run = show_whole_box },
};

const struct gz_window_part gz_window_clip_part = {
	.name = "clip",
	.title = "picture",
	GZ_PART_STATE(clip),
	GZ_PART_ACTIONS(clip_actions),
	.grab = grab_face,
	.drag = drag_face,
	.panels = draw_handles,
};
