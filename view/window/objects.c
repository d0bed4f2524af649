/* The part that lists what is shown, with what each object is shown by, and finds the object under
 * the mouse and at the gaze. */
#include <stdio.h>

#include <GLFW/glfw3.h>

#include "view/panels/marks.h"
#include "view/panels/objects_panel.h"
#include "view/panels/widgets.h"
#include "view/window/displays.h"
#include "view/window/objects.h"

#define GZ_LOG_MODULE "window"

/* From the mouse to the name of the object under it, unscaled (chosen: clear of the arrow). */
#define NAME_OFFSET 18.0f

struct gz_window_objects {
	struct gz_objects_panel panel;
	struct gz_point looked_at; /* point of panel.looked_at */
	struct gz_point gaze;      /* of this turn */
	bool gaze_known;
};

static const struct gz_scene *scene_of(const struct gz_window *window)
{
	return gz_frame_maker_scene(window->maker);
}

static uint32_t object_at(const struct gz_window *window, struct gz_point point)
{
	if (!window->any_shown)
		return 0;
	return gz_frame_object_at(window->maker, &window->made, window->record.width,
				  window->record.height, point);
}

static void forget_objects(struct gz_window *window)
{
	gz_objects_panel_forget(&window->objects->panel);
	window->objects->panel.looked_at = 0;
}

/* Other labels may be there afterwards. */
static bool leave_listed_data(struct gz_window *window)
{
	forget_objects(window);
	return true;
}

/* ---- choosing ---- */

static void select_row(struct gz_window *window, size_t row)
{
	struct gz_objects_panel *panel = &window->objects->panel;
	panel->selected = row;
	panel->reveal = true;
	gz_window_wake_panels(window);
}

/* Choose an object, and say its name. */
static void select_object(struct gz_window *window, uint32_t id)
{
	struct gz_objects_panel *panel = &window->objects->panel;
	char text[GZ_OBJECT_ROW_SIZE];
	gz_objects_panel_list(panel, scene_of(window));
	const size_t row = gz_objects_panel_find(panel, scene_of(window), id);
	select_row(window, row);
	if (row == panel->count || panel->open)
		return;
	gz_objects_panel_print(scene_of(window), &panel->rows[row], text);
	gz_info(window->log, "%s; A lists all objects", text);
}

static void click_object(struct gz_window *window)
{
	struct gz_point point;
	const uint32_t id = gz_window_mouse_point(window, &point) ? object_at(window, point) : 0;
	if (id > 0 || window->objects->panel.open)
		select_object(window, id);
}

static void select_looked_at(struct gz_window *window, int number)
{
	const struct gz_window_objects *self = window->objects;
	const uint32_t id = self->gaze_known ? object_at(window, self->gaze) : 0;
	(void)number;
	if (id == 0)
		gz_info(window->log, "no object with a surface is at the gaze");
	else
		select_object(window, id);
}

/* ---- rows for the search ---- */

size_t gz_window_object_rows(struct gz_window *window)
{
	if (!window->maker)
		return 0;
	gz_objects_panel_list(&window->objects->panel, scene_of(window));
	return window->objects->panel.count;
}

void gz_window_print_object_row(const struct gz_window *window, size_t row, char *text, size_t size)
{
	char name[GZ_OBJECT_ROW_SIZE];
	gz_objects_panel_print(scene_of(window), &window->objects->panel.rows[row], name);
	snprintf(text, size, "%s: visible, importance, transparency, template", name);
}

void gz_window_show_object_row(struct gz_window *window, size_t row)
{
	window->objects->panel.open = true;
	if (row < window->objects->panel.count)
		select_row(window, row);
}

/* ---- each turn ---- */

static void note_objects_gaze(struct gz_window *window, struct gz_window_gaze *gaze)
{
	window->objects->gaze = gaze->reading.point;
	window->objects->gaze_known = gaze->reading.known;
}

/* Whether another object is at the gaze. */
static bool looks_elsewhere(struct gz_window *window, const struct gz_window_gaze *gaze)
{
	struct gz_window_objects *self = window->objects;
	const struct gz_point at = gaze->reading.point;
	if (!self->panel.open || !window->maker ||
	    (!window->frame_new && at.x == self->looked_at.x && at.y == self->looked_at.y))
		return false;
	const uint32_t before = self->panel.looked_at;
	self->looked_at = at;
	self->panel.looked_at = gaze->reading.known ? object_at(window, at) : 0;
	return self->panel.looked_at != before;
}

/* The name of the object under the mouse, beside it. */
static void draw_name_at_mouse(struct gz_window *window)
{
	const struct gz_objects_panel *panel = &window->objects->panel;
	const float offset = NAME_OFFSET * gz_widgets_scale();
	char text[GZ_OBJECT_ROW_SIZE];
	struct gz_point point;
	if (!window->cursor_inside || window->grabber || gz_widgets_have_mouse() ||
	    !gz_window_mouse_point(window, &point))
		return;
	const uint32_t id = object_at(window, point);
	const size_t row = gz_objects_panel_find(panel, scene_of(window), id);
	if (id == 0 || row == panel->count)
		return;
	gz_objects_panel_print(scene_of(window), &panel->rows[row], text);
	const struct gz_place room = gz_widgets_room(), size = gz_text_room(1, text);
	struct gz_place at = { (float)window->cursor[0] + offset,
			       (float)window->cursor[1] + offset };
	at.x = at.x + size.x + offset > room.x ? room.x - size.x - offset : at.x;
	at.y = at.y + size.y + offset > room.y ? (float)window->cursor[1] - 2 * offset : at.y;
	(void)gz_draw_caption(GZ_LAYER_PICTURE, at, gz_paint_plain, text);
}

static void draw_objects(struct gz_window *window, const struct gz_window_gaze *gaze)
{
	struct gz_objects_panel *panel = &window->objects->panel;
	(void)gaze;
	if (!panel->open || !window->maker)
		return;
	panel->margin_top = window->panels_top;
	panel->margin_bottom = window->panels_bottom;
	const enum gz_objects_outcome outcome =
		gz_objects_panel_draw(panel, scene_of(window), &window->settings);
	if (outcome == GZ_OBJECTS_FULL)
		gz_warn(window->log, "at most %d regions can be shown in a way of their own",
			GZ_SCENE_REGIONS_MAX);
	draw_name_at_mouse(window);
}

static void toggle_objects(struct gz_window *window, int number)
{
	(void)number;
	window->objects->panel.open = !window->objects->panel.open;
	gz_window_wake_panels(window);
}

static bool are_objects_listed(const struct gz_window *window)
{
	return window->objects->panel.open;
}

static bool are_objects_on(const struct gz_window *window, int number)
{
	(void)number;
	return window->objects->panel.open;
}

static bool is_scene_shown(const struct gz_window *window)
{
	return window->maker != NULL;
}

static const struct gz_window_action objects_actions[] = {
	{ .key = GLFW_KEY_ESCAPE, .applies = are_objects_listed, .run = toggle_objects },
	{ .letter = 'a',
	  .keys = "A",
	  .help = "objects and labels: which are shown, and how",
	  .name = "Objects",
	  .menu = GZ_MENU_PICTURE,
	  .section = 2,
	  .words = "labels regions list panel visible hide importance transparency template",
	  .is_on = are_objects_on,
	  .run = toggle_objects },
	{ .letter = 'a',
	  .modifiers = GZ_KEY_SHIFT,
	  .keys = "Shift+A",
	  .help = "choose the object at the gaze; or click it",
	  .name = "Choose the object at the gaze",
	  .menu = GZ_MENU_PICTURE,
	  .section = 2,
	  .words = "pick select look label region",
	  .applies = is_scene_shown,
	  .run = select_looked_at },
};

const struct gz_window_part gz_window_objects_part = {
	.name = "objects",
	.title = "picture",
	GZ_PART_ACTIONS(objects_actions),
	GZ_PART_STATE(objects),
	.scene_leaving = forget_objects,
	.data_leaving = leave_listed_data,
	.gaze = note_objects_gaze,
	.click = click_object,
	.follows = looks_elsewhere,
	.panels = draw_objects,
	.close = forget_objects,
};
