/* The part with the panel of illustrations. It makes the small pictures of its gallery while the
 * picture rests. */
#include <math.h>

#include <GLFW/glfw3.h>

#include "view/draw/icon.h"
#include "view/panels/illustration_panel.h"
#include "view/panels/widgets.h"
#include "view/settings/scene_keys.h"
#include "view/window/window_state.h"

/* How long the picture rests before the gallery is made again (chosen: no drag has such breaks). */
#define REST_NS (250 * GZ_NS_PER_MS)

struct gz_window_illustration {
	struct gz_illustration_panel panel;
	struct gz_image image;
	int64_t frame_ns; /* when the picture changed last */
	bool stale;       /* the gallery shows another picture */
	int next;         /* picture of the gallery to be made; their count: all are */
};

static bool is_gallery_wanted(const struct gz_window *window)
{
	return window->illustration->panel.open && window->maker && window->any_shown &&
	       !window->alone && gz_setting_applies(&window->made, "illustration.show");
}

static void note_shown_picture(struct gz_window *window)
{
	window->illustration->frame_ns = gz_clock_now_ns();
	window->illustration->stale = true;
}

/* Make the next picture: the parameter alone, as grey. */
static void make_gallery_picture(struct gz_window *window)
{
	struct gz_window_illustration *self = window->illustration;
	struct gz_scene_settings settings = window->made;
	const float scale = gz_widgets_scale();
	unsigned *picture = &self->panel.pictures[self->next];
	settings.rays.illustration.show = self->next++;
	settings.rays.illustration.drawing = GZ_DRAWING_GREY;
	gz_icon_free(picture);
	if (gz_frame_preview(window->maker, &settings, (int)(GZ_GALLERY_WIDTH * scale),
			     (int)(GZ_GALLERY_HEIGHT * scale), &self->image) == GZ_OK)
		*picture = gz_icon_make_colour(self->image.pixels, self->image.width,
					       self->image.height);
	gz_window_wake_panels(window);
}

static void turn_gallery(struct gz_window *window)
{
	struct gz_window_illustration *self = window->illustration;
	if (!is_gallery_wanted(window))
		return;
	if (self->stale && gz_clock_now_ns() - self->frame_ns >= REST_NS) {
		self->stale = false;
		self->next = 0;
	}
	if (!self->stale && self->next < gz_illustration_gallery_count())
		make_gallery_picture(window);
}

static double gallery_patience_s(const struct gz_window *window)
{
	const struct gz_window_illustration *self = window->illustration;
	if (!is_gallery_wanted(window))
		return INFINITY;
	if (self->stale)
		return fmax(0, gz_ns_to_s(self->frame_ns + REST_NS - gz_clock_now_ns()));
	return self->next < gz_illustration_gallery_count() ? 0 : INFINITY;
}

static void free_gallery(struct gz_window *window)
{
	for (int i = 0; i < GZ_GALLERY_MAX; i++)
		gz_icon_free(&window->illustration->panel.pictures[i]);
	window->illustration->stale = true;
}

static void close_illustration(struct gz_window *window)
{
	gz_image_free(&window->illustration->image);
}

static void draw_illustration(struct gz_window *window, const struct gz_window_gaze *gaze)
{
	struct gz_illustration_panel *panel = &window->illustration->panel;
	(void)gaze;
	if (!panel->open || !window->maker)
		return;
	const struct gz_settings_panel rows = gz_window_settings_rows(window);
	panel->margin_top = window->panels_top;
	(void)gz_illustration_panel_draw(panel, &rows, &window->settings);
}

static void toggle_illustration(struct gz_window *window, int number)
{
	(void)number;
	window->illustration->panel.open = !window->illustration->panel.open;
	window->illustration->stale = true;
	gz_window_wake_panels(window);
}

static bool is_illustration_open(const struct gz_window *window)
{
	return window->illustration->panel.open;
}

static bool is_illustration_on(const struct gz_window *window, int number)
{
	(void)number;
	return window->illustration->panel.open;
}

static const struct gz_window_action illustration_actions[] = {
	{ .key = GLFW_KEY_ESCAPE, .applies = is_illustration_open, .run = toggle_illustration },
	{ .letter = 'i',
	  .modifiers = GZ_KEY_SHIFT,
	  .keys = "Shift+I",
	  .help = "illustration: look, parameters, haze",
	  .name = "Illustration",
	  .menu = GZ_MENU_PICTURE,
	  .section = 2,
	  .words = "shading template gallery stipples hatches depth curve buffers atmosphere",
	  .is_on = is_illustration_on,
	  .run = toggle_illustration },
};

const struct gz_window_part gz_window_illustration_part = {
	.name = "illustration",
	.title = "picture",
	GZ_PART_ACTIONS(illustration_actions),
	GZ_PART_STATE(illustration),
	.turn = turn_gallery,
	.frame_made = note_shown_picture,
	.panels = draw_illustration,
	.patience_s = gallery_patience_s,
	.gl_close = free_gallery,
	.close = close_illustration,
};
