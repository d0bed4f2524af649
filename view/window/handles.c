#include "view/window/handles.h"

#include <math.h>

#include <GLFW/glfw3.h>

#include "render/picture/camera.h"
#include "view/window/sections.h"
#include "view/window/window_state.h"

#define GZ_LOG_MODULE "window"

/* Radius of a handle, and by how much wider what is drawn is darkened, so that it shows on bright
 * matter; unscaled. */
#define HANDLE_RADIUS 6.0F
#define HALO          2.0F

static const struct gz_paint halo_paint = { 0, 0, 0, 90 };

/* Opacity of lines, of 255. */
enum { LINE_ALPHA = 150 };

bool gz_window_can_clip(const struct gz_window *window)
{
	return window->maker && !window->alone;
}

bool gz_window_has_handles(const struct gz_window *window)
{
	return gz_window_can_clip(window) && !gz_window_has_sections(window);
}

bool gz_handle_place(const struct gz_window *window, const double world[3],
		     struct gz_place *out_place)
{
	int width, height;
	struct gz_point point;
	glfwGetWindowSize(window->glfw, &width, &height);
	if (width < 1 || height < 1 ||
	    !gz_camera_project(&window->settings.camera, width, height, world, &point))
		return false;
	const struct gz_place room = gz_widgets_room();
	*out_place = (struct gz_place) { (float)point.x * room.x, (float)point.y * room.y };
	return true;
}

double gz_handle_away(const struct gz_window *window, struct gz_place at)
{
	return hypot((double)at.x - window->cursor[0], (double)at.y - window->cursor[1]) /
	       (double)gz_widgets_scale();
}

void gz_handle_draw_ring(struct gz_place at, float radius, struct gz_paint paint, float thickness)
{
	gz_draw_circle(GZ_LAYER_PICTURE, at, radius, halo_paint, thickness + HALO);
	gz_draw_circle(GZ_LAYER_PICTURE, at, radius, paint, thickness);
}

void gz_handle_draw(struct gz_place at, struct gz_paint paint, bool marked)
{
	if (!marked) {
		gz_handle_draw_ring(at, HANDLE_RADIUS, paint, 2);
		return;
	}
	gz_draw_disc(GZ_LAYER_PICTURE, at, HANDLE_RADIUS + HALO / 2, halo_paint);
	gz_draw_disc(GZ_LAYER_PICTURE, at, HANDLE_RADIUS, paint);
}

void gz_handle_draw_line(struct gz_place from, struct gz_place to, struct gz_paint paint)
{
	paint.alpha = LINE_ALPHA;
	gz_draw_line(GZ_LAYER_PICTURE, from, to, halo_paint, 1 + HALO);
	gz_draw_line(GZ_LAYER_PICTURE, from, to, paint, 1);
}

void gz_handles_toggled(struct gz_window *window, bool shown, const char *what)
{
	if (shown && gz_window_has_sections(window))
		gz_info(window->log, "handles of the %s show only in the picture without slices",
			what);
	gz_window_wake_panels(window);
}
