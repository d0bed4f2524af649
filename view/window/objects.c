/* The part that lists what is shown: each object with its colour and name, labels by theirs. */
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>

#include <GLFW/glfw3.h>

#include "view/panels/widgets.h"
#include "view/window/window_state.h"

/* Unscaled (chosen: a name of an atlas fits in a line). */
#define OBJECTS_WIDTH 360.0f
#define ROW_HEIGHT    20.0f
#define SWATCH        12.0f
/* Rows that are seen at once (chosen: half of a large window). */
enum { ROWS_SEEN = 22, TEXT_SIZE = GZ_LABEL_NAME_SIZE + 64 };

struct gz_window_objects {
	bool open;
	struct gz_object *items; /* of the scene shown; NULL: not listed yet */
	size_t count;
};

static void forget_objects(struct gz_window *window)
{
	free(window->objects->items);
	window->objects->items = NULL;
	window->objects->count = 0;
}

/* List what is shown, as far as there is memory. */
static void list_shown_objects(struct gz_window *window)
{
	struct gz_window_objects *self = window->objects;
	if (!self->items)
		self->items = calloc(GZ_SCENE_LISTED_MAX, sizeof *self->items);
	self->count = self->items ? gz_scene_list_objects(gz_frame_maker_scene(window->maker),
							  self->items, GZ_SCENE_LISTED_MAX)
				  : 0;
}

static void print_object_row(const struct gz_window *window, const struct gz_object *object,
			     char text[TEXT_SIZE])
{
	const struct gz_label_surface *label =
		gz_scene_label_of(gz_frame_maker_scene(window->maker), object->id);
	if (label)
		snprintf(text, TEXT_SIZE, "%" PRId32 " %s", label->number, label->name);
	else
		snprintf(text, TEXT_SIZE, "%s%s%s by %s", object->mesh ? "mesh" : "volume",
			 object->name ? " " : "", object->name ? object->name : "",
			 object->technique->name);
}

static uint8_t paint_of(float colour)
{
	return (uint8_t)(colour * 255 + 0.5F);
}

static void draw_object_row(const struct gz_window *window, size_t index)
{
	const struct gz_object *object = &window->objects->items[index];
	const float unit = gz_widgets_scale();
	struct gz_tall_row row = { .height = ROW_HEIGHT };
	char text[TEXT_SIZE], id[32];
	snprintf(id, sizeof id, "##object %zu", index);
	(void)gz_widget_tall_row(id, &row);
	const float gap = (ROW_HEIGHT - SWATCH) / 2 * unit;
	const struct gz_place corner = { row.corner.x + gap, row.corner.y + gap };
	const struct gz_place opposite = { corner.x + SWATCH * unit, corner.y + SWATCH * unit };
	if (object->colour) {
		const struct gz_paint paint = { paint_of(object->colour[0]),
						paint_of(object->colour[1]),
						paint_of(object->colour[2]), 255 };
		gz_draw_rectangle(GZ_LAYER_PANEL, corner, opposite, paint, 2);
	}
	print_object_row(window, object, text);
	const struct gz_place at = { opposite.x + 2 * gap,
				     row.corner.y +
					     (ROW_HEIGHT * unit - gz_text_room(1, text).y) / 2 };
	gz_draw_text(GZ_LAYER_PANEL, at, 1, gz_paint_plain, text);
}

static void draw_objects(struct gz_window *window, const struct gz_window_gaze *gaze)
{
	struct gz_window_objects *self = window->objects;
	const struct gz_panel_place place = {
		.at = GZ_PANEL_TOP_LEFT,
		.margin_top = window->panels_top,
		.margin_bottom = window->panels_bottom,
		.width = OBJECTS_WIDTH,
	};
	(void)gaze;
	if (!self->open || !window->maker)
		return;
	list_shown_objects(window);
	const int lines = self->count < ROWS_SEEN ? (int)self->count + 1 : ROWS_SEEN;
	if (gz_panel_begin("Objects", &place, &self->open)) {
		if (gz_widget_list_begin("##objects", lines))
			for (size_t i = 0; i < self->count; i++)
				draw_object_row(window, i);
		gz_widget_list_end();
	}
	gz_panel_end();
}

static void toggle_objects(struct gz_window *window, int number)
{
	(void)number;
	window->objects->open = !window->objects->open;
	gz_window_wake_panels(window);
}

static bool are_objects_listed(const struct gz_window *window)
{
	return window->objects->open;
}

static bool are_objects_on(const struct gz_window *window, int number)
{
	(void)number;
	return window->objects->open;
}

static const struct gz_window_action objects_actions[] = {
	{ .key = GLFW_KEY_ESCAPE, .applies = are_objects_listed, .run = toggle_objects },
	{ .letter = 'a',
	  .keys = "A",
	  .help = "list of all objects and labels",
	  .name = "Objects",
	  .menu = GZ_MENU_PICTURE,
	  .section = 2,
	  .words = "labels list panel",
	  .is_on = are_objects_on,
	  .run = toggle_objects },
};

const struct gz_window_part gz_window_objects_part = {
	.name = "objects",
	.title = "picture",
	GZ_PART_ACTIONS(objects_actions),
	GZ_PART_STATE(objects),
	.scene_leaving = forget_objects,
	.panels = draw_objects,
	.close = forget_objects,
};
