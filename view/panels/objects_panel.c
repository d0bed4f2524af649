#include "view/panels/objects_panel.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "view/panels/widgets.h"
#include "view/settings/scene_keys.h"

/* Unscaled (chosen: a name of an atlas fits in a line). */
#define OBJECTS_WIDTH 380.0f
#define ROW_HEIGHT    15.0f
#define SWATCH        11.0f
#define INDENT        14.0f
/* Where a row's importance and transparency end, from its right edge. */
#define IMPORTANCE_RIGHT   56.0f
#define TRANSPARENCY_RIGHT 4.0f
#define LABEL_SHARE        0.35f
/* Rows that are seen at once (chosen: half of a small window). */
enum { ROWS_SEEN = 14, TEMPLATES_MAX = 16 };

/* Paints of what is hidden, and of the row under the gaze. */
static const struct gz_paint hidden_paint = { 130, 130, 130, 255 };
static const struct gz_paint mark_paint = { 255, 190, 60, 40 };

/* How a row is shown. */
struct row_look {
	bool visible;
	struct gz_object_style style;
	char template_name[GZ_SCENE_FILE_SIZE];
};

/* ---- rows ---- */

void gz_objects_panel_forget(struct gz_objects_panel *panel)
{
	free(panel->rows);
	panel->rows = NULL;
	panel->count = panel->selected = 0;
}

static size_t count_labels(const struct gz_scene *scene, size_t object)
{
	return scene->labels ? scene->labels[object].count : 0;
}

void gz_objects_panel_list(struct gz_objects_panel *panel, const struct gz_scene *scene)
{
	const struct gz_scene_objects *objects = &scene->settings.objects;
	size_t count = 1;
	if (panel->rows)
		return;
	for (size_t i = 0; i < objects->count; i++)
		count += 1 + count_labels(scene, i);
	panel->rows = calloc(count, sizeof *panel->rows);
	panel->count = panel->selected = 0;
	if (!panel->rows)
		return;
	if (gz_scene_has_volume(&scene->settings) && !gz_scene_volume_object(&scene->settings))
		panel->rows[panel->count++] = (struct gz_object_row) { -1, -1 };
	for (size_t i = 0; i < objects->count; i++) {
		panel->rows[panel->count++] = (struct gz_object_row) { (int)i, -1 };
		for (size_t k = 0; k < count_labels(scene, i); k++)
			panel->rows[panel->count++] = (struct gz_object_row) { (int)i, (int)k };
	}
	panel->selected = panel->count;
}

static const struct gz_label_surface *label_of_row(const struct gz_scene *scene,
						   const struct gz_object_row *row)
{
	return row->label >= 0 ? &scene->labels[row->object].items[row->label] : NULL;
}

void gz_objects_panel_print(const struct gz_scene *scene, const struct gz_object_row *row,
			    char out_text[GZ_OBJECT_ROW_SIZE])
{
	const struct gz_label_surface *label = label_of_row(scene, row);
	if (label)
		snprintf(out_text, GZ_OBJECT_ROW_SIZE, "%" PRId32 "%s%s", label->number,
			 label->name[0] ? " " : "", label->name);
	else if (row->object < 0)
		snprintf(out_text, GZ_OBJECT_ROW_SIZE, "volume");
	else
		snprintf(out_text, GZ_OBJECT_ROW_SIZE, "%s",
			 gz_scene_object_name(&scene->settings.objects.items[row->object]));
}

/* The number of a row in lists of objects. */
static uint32_t id_of_row(const struct gz_scene *scene, const struct gz_object_row *row)
{
	const struct gz_scene_settings *settings = &scene->settings;
	if (row->label >= 0)
		return gz_scene_label_id((size_t)row->object, (size_t)row->label);
	if (row->object < 0 ||
	    &settings->objects.items[row->object] == gz_scene_volume_object(settings))
		return 1;
	return (uint32_t)row->object + 2;
}

size_t gz_objects_panel_find(const struct gz_objects_panel *panel, const struct gz_scene *scene,
			     uint32_t id)
{
	size_t found = 0;
	while (found < panel->count && id_of_row(scene, &panel->rows[found]) != id)
		found++;
	return found;
}

/* ---- how rows are shown ---- */

static struct row_look look_of_row(const struct gz_scene *scene,
				   const struct gz_scene_settings *settings,
				   const struct gz_object_row *row)
{
	struct row_look look = { .visible = true, .style = gz_object_style_plain };
	if (row->object < 0)
		return look;
	const struct gz_scene_object *object = &settings->objects.items[row->object];
	const struct gz_label_surface *label = label_of_row(scene, row);
	const struct gz_scene_region *region =
		label ? gz_scene_region_of(&settings->regions, object, label->number) : NULL;
	look.visible = region ? region->visible : label ? true : object->visible;
	look.style = region ? region->style : object->style;
	snprintf(look.template_name, sizeof look.template_name, "%s",
		 region ? region->template_name : object->template_name);
	return look;
}

/* A region that is shown in another way than its object gets a section of its own. */
static enum gz_objects_outcome set_look(const struct gz_scene *scene,
					struct gz_scene_settings *settings,
					const struct gz_object_row *row,
					const struct row_look *look)
{
	struct gz_scene_object *object = &settings->objects.items[row->object];
	const struct gz_label_surface *label = label_of_row(scene, row);
	if (!label) {
		object->visible = look->visible;
		object->style = look->style;
		memcpy(object->template_name, look->template_name, sizeof look->template_name);
		return GZ_OBJECTS_CHANGED;
	}
	struct gz_scene_region *region =
		gz_scene_region_take(&settings->regions, object, label->number);
	if (!region)
		return GZ_OBJECTS_FULL;
	region->visible = look->visible;
	region->style = look->style;
	/* Longer names are those of objects, and the list below has short ones. */
	if (strlen(look->template_name) < sizeof region->template_name)
		memcpy(region->template_name, look->template_name, strlen(look->template_name) + 1);
	return GZ_OBJECTS_CHANGED;
}

static bool is_row_shown(const struct gz_scene *scene, const struct gz_scene_settings *settings,
			 const struct gz_object_row *row)
{
	return look_of_row(scene, settings, row).visible &&
	       (row->label < 0 || settings->objects.items[row->object].visible);
}

/* ---- the list ---- */

static uint8_t paint_of(float colour)
{
	return (uint8_t)(colour * 255 + 0.5F);
}

static void draw_swatch(const float colour[3], struct gz_place at, float size)
{
	const struct gz_paint paint = { paint_of(colour[0]), paint_of(colour[1]),
					paint_of(colour[2]), 255 };
	const struct gz_place opposite = { at.x + size, at.y + size };
	gz_draw_rectangle(GZ_LAYER_PANEL, at, opposite, paint, 2);
}

/* A share in per cent, its right edge @p right (unscaled) from that of the row. */
static void draw_share(const struct gz_tall_row *row, float right, double share,
		       struct gz_paint paint)
{
	char text[16];
	snprintf(text, sizeof text, "%.0f %%", share * 100);
	const struct gz_place room = gz_text_room(1, text);
	const struct gz_place at = { row->corner.x + row->size.x - right * gz_widgets_scale() -
					     room.x,
				     row->corner.y + (row->size.y - room.y) / 2 };
	gz_draw_text(GZ_LAYER_PANEL, at, 1, paint, text);
}

static void draw_row_content(const struct gz_scene *scene, const struct gz_scene_settings *settings,
			     const struct gz_object_row *row, const struct gz_tall_row *area)
{
	const float unit = gz_widgets_scale(), gap = (ROW_HEIGHT - SWATCH) / 2 * unit;
	const struct row_look look = look_of_row(scene, settings, row);
	const struct gz_label_surface *label = label_of_row(scene, row);
	const struct gz_scene_object *object =
		row->object < 0 ? NULL : &settings->objects.items[row->object];
	const struct gz_paint paint =
		is_row_shown(scene, settings, row) ? gz_paint_plain : hidden_paint;
	struct gz_place at = { area->corner.x + gap + (label ? INDENT * unit : 0),
			       area->corner.y + gap };
	char text[GZ_OBJECT_ROW_SIZE], shown[GZ_OBJECT_ROW_SIZE + 64];
	if (label) {
		draw_swatch(label->colour, at, SWATCH * unit);
		at.x += (SWATCH + 6) * unit;
	}
	gz_objects_panel_print(scene, row, text);
	if (label)
		gz_widgets_elide(text, 0.6F, false, shown, sizeof shown);
	else
		snprintf(shown, sizeof shown, "%s by %s", text,
			 gz_scene_technique(settings, object)->name);
	at.y = area->corner.y + (area->size.y - gz_text_room(1, shown).y) / 2;
	gz_draw_text(GZ_LAYER_PANEL, at, 1, paint, shown);
	if (!gz_object_style_applies(settings, object))
		return;
	draw_share(area, IMPORTANCE_RIGHT, look.style.importance, paint);
	draw_share(area, TRANSPARENCY_RIGHT, look.style.transparency, paint);
}

static enum gz_objects_outcome draw_row(struct gz_objects_panel *panel,
					const struct gz_scene *scene,
					struct gz_scene_settings *settings, size_t index)
{
	const struct gz_object_row *row = &panel->rows[index];
	struct row_look look = look_of_row(scene, settings, row);
	struct gz_tall_row area = { .height = ROW_HEIGHT, .selected = index == panel->selected };
	enum gz_objects_outcome outcome = GZ_OBJECTS_SAME;
	char id[32];
	snprintf(id, sizeof id, "%zu", index);
	gz_widgets_push_id(id);
	if (area.selected && panel->reveal)
		gz_widgets_scroll_here();
	gz_widgets_disable(row->object < 0);
	if (gz_widget_small_checkbox("##visible", &look.visible))
		outcome = set_look(scene, settings, row, &look);
	gz_widget_tooltip("visible");
	gz_widgets_enable();
	gz_widgets_same_line(0);
	if (gz_widget_tall_row("##row", &area))
		panel->selected = area.selected ? panel->count : index;
	if (panel->looked_at != 0 && id_of_row(scene, row) == panel->looked_at) {
		const struct gz_place opposite = { area.corner.x + area.size.x,
						   area.corner.y + area.size.y };
		gz_draw_rectangle(GZ_LAYER_PANEL, area.corner, opposite, mark_paint, 2);
	}
	draw_row_content(scene, settings, row, &area);
	gz_widgets_pop_id();
	return outcome;
}

static bool any_style_applies(const struct gz_scene_settings *settings)
{
	for (size_t i = 0; i < settings->objects.count; i++)
		if (gz_object_style_applies(settings, &settings->objects.items[i]))
			return true;
	return false;
}

static enum gz_objects_outcome draw_list(struct gz_objects_panel *panel,
					 const struct gz_scene *scene,
					 struct gz_scene_settings *settings)
{
	const int lines = panel->count < ROWS_SEEN ? (int)panel->count + 1 : ROWS_SEEN;
	enum gz_objects_outcome outcome = GZ_OBJECTS_SAME;
	if (any_style_applies(settings))
		gz_widget_text(hidden_paint,
			       "Per cent: importance, transparency. Click the picture to choose.");
	if (gz_widget_list_begin("##objects", lines))
		for (size_t i = 0; i < panel->count; i++) {
			const enum gz_objects_outcome now = draw_row(panel, scene, settings, i);
			outcome = now == GZ_OBJECTS_SAME ? outcome : now;
		}
	gz_widget_list_end();
	panel->reveal = false;
	return outcome;
}

/* ---- the selected row ---- */

static bool draw_share_setting(const char *name, const char *help, double *share)
{
	static const struct gz_number_range range = {
		.least = 0, .greatest = 1, .slider = true, .format = "%.2f"
	};
	gz_widgets_push_id(name);
	gz_widget_label(gz_paint_plain, name);
	gz_widget_tooltip(help);
	gz_widgets_same_line(LABEL_SHARE);
	gz_widgets_next_width(0);
	const bool changed = gz_widget_doubles("##value", share, 1, &range);
	gz_widget_tooltip(help);
	gz_widgets_pop_id();
	return changed;
}

/* How it is drawn, or which way its strokes run: "scene" and the names of the scene's setting. */
static bool draw_said_setting(const char *name, const char *help, const char *const *names,
			      int *said)
{
	gz_widgets_push_id(name);
	gz_widget_label(gz_paint_plain, name);
	gz_widget_tooltip(help);
	gz_widgets_same_line(LABEL_SHARE);
	gz_widgets_next_width(0);
	const bool changed = gz_widget_choice("##said", said, names);
	gz_widget_tooltip(help);
	gz_widgets_pop_id();
	return changed;
}

/* "none", the templates, and a file that the scene names. */
static bool draw_template_setting(char template_name[GZ_SCENE_FILE_SIZE])
{
	static const char none[] = "none";
	const char *names[TEMPLATES_MAX + 3] = { none };
	int count = 1, chosen = 0;
	for (size_t i = 0; gz_shading_template_name(i) && i < TEMPLATES_MAX; i++)
		names[count++] = gz_shading_template_name(i);
	for (int i = 1; i < count; i++)
		if (strcmp(names[i], template_name) == 0)
			chosen = i;
	if (chosen == 0 && template_name[0]) {
		names[count] = template_name;
		chosen = count;
	}
	gz_widget_label(gz_paint_plain, "template");
	gz_widgets_same_line(LABEL_SHARE);
	gz_widgets_next_width(0);
	if (!gz_widget_choice("##template", &chosen, names))
		return false;
	if (chosen < count)
		snprintf(template_name, GZ_SCENE_FILE_SIZE, "%s", chosen > 0 ? names[chosen] : "");
	return true;
}

/* Show this object or region alone. */
static enum gz_objects_outcome show_alone(const struct gz_objects_panel *panel,
					  const struct gz_scene *scene,
					  struct gz_scene_settings *settings)
{
	const struct gz_object_row *alone = &panel->rows[panel->selected];
	enum gz_objects_outcome outcome = GZ_OBJECTS_CHANGED;
	for (size_t i = 0; i < panel->count && outcome == GZ_OBJECTS_CHANGED; i++) {
		const struct gz_object_row *row = &panel->rows[i];
		struct row_look look = look_of_row(scene, settings, row);
		const bool same_object = row->object == alone->object;
		const bool wanted = same_object && (row->label < 0 || alone->label < 0 ||
						    row->label == alone->label);
		if (row->object < 0 || look.visible == wanted || (row->label >= 0 && !same_object))
			continue;
		look.visible = wanted;
		outcome = set_look(scene, settings, row, &look);
	}
	return outcome;
}

static enum gz_objects_outcome show_all(const struct gz_objects_panel *panel,
					const struct gz_scene *scene,
					struct gz_scene_settings *settings)
{
	for (size_t i = 0; i < panel->count; i++) {
		struct row_look look = look_of_row(scene, settings, &panel->rows[i]);
		if (look.visible)
			continue;
		/* What is hidden has a section already. */
		look.visible = true;
		(void)set_look(scene, settings, &panel->rows[i], &look);
	}
	return GZ_OBJECTS_CHANGED;
}

static enum gz_objects_outcome draw_buttons(const struct gz_objects_panel *panel,
					    const struct gz_scene *scene,
					    struct gz_scene_settings *settings)
{
	enum gz_objects_outcome outcome = GZ_OBJECTS_SAME;
	const bool any = panel->selected < panel->count;
	gz_widgets_disable(!any || panel->rows[panel->selected].object < 0);
	if (gz_widget_button("Show it alone"))
		outcome = show_alone(panel, scene, settings);
	gz_widgets_enable();
	gz_widgets_same_line(LABEL_SHARE);
	if (gz_widget_button("Show all"))
		outcome = show_all(panel, scene, settings);
	return outcome;
}

/* Importance changes a picture in which objects fade by it. */
static bool draw_importance_hint(struct gz_scene_settings *settings)
{
	struct gz_illustration_look *look = &settings->rays.illustration;
	const bool fades = look->source == GZ_ILLUSTRATION_SINGLE
				   ? look->single.importance > 0
				   : look->combined.scene_information == GZ_SHOWS_IMPORTANCE;
	if (fades || look->source == GZ_ILLUSTRATION_SINGLE)
		return false;
	gz_widget_text(gz_paint_amber, "Importance does not show in the picture yet.");
	if (!gz_widget_button("Let unimportant objects fade"))
		return false;
	look->combined.scene_information = GZ_SHOWS_IMPORTANCE;
	return true;
}

static enum gz_objects_outcome draw_selected(const struct gz_objects_panel *panel,
					     const struct gz_scene *scene,
					     struct gz_scene_settings *settings)
{
	if (panel->selected >= panel->count)
		return GZ_OBJECTS_SAME;
	const struct gz_object_row *row = &panel->rows[panel->selected];
	const struct gz_scene_object *object =
		row->object < 0 ? NULL : &settings->objects.items[row->object];
	struct row_look look = look_of_row(scene, settings, row);
	char text[GZ_OBJECT_ROW_SIZE];
	gz_objects_panel_print(scene, row, text);
	gz_widget_text(gz_paint_amber, text);
	const bool applies = gz_object_style_applies(settings, object);
	gz_widgets_disable(!applies);
	bool changed = draw_share_setting("importance", "how important it is, in illustrations",
					  &look.style.importance);
	changed |= draw_share_setting("transparency",
				      "how much of what is behind it shows, in illustrations",
				      &look.style.transparency);
	changed |=
		draw_said_setting("drawing", "how illustrations draw it; scene: as the whole scene",
				  gz_illustration_said_drawings, &look.style.drawing);
	changed |= draw_said_setting("hatch direction",
				     "which way its strokes run: along tubes and ridges, or around",
				     gz_illustration_said_directions, &look.style.hatch_direction);
	changed |= draw_template_setting(look.template_name);
	gz_widgets_enable();
	enum gz_objects_outcome outcome =
		changed ? set_look(scene, settings, row, &look) : GZ_OBJECTS_SAME;
	if (applies && draw_importance_hint(settings))
		outcome = GZ_OBJECTS_CHANGED;
	return outcome;
}

enum gz_objects_outcome gz_objects_panel_draw(struct gz_objects_panel *panel,
					      const struct gz_scene *scene,
					      struct gz_scene_settings *settings)
{
	const struct gz_panel_place place = {
		.at = GZ_PANEL_TOP_LEFT,
		.margin_top = panel->margin_top,
		.margin_bottom = panel->margin_bottom,
		.width = OBJECTS_WIDTH,
	};
	enum gz_objects_outcome outcome = GZ_OBJECTS_SAME, next;
	gz_objects_panel_list(panel, scene);
	if (gz_panel_begin("Objects", &place, &panel->open)) {
		outcome = draw_list(panel, scene, settings);
		next = draw_buttons(panel, scene, settings);
		outcome = next == GZ_OBJECTS_SAME ? outcome : next;
		next = draw_selected(panel, scene, settings);
		outcome = next == GZ_OBJECTS_SAME ? outcome : next;
	}
	gz_panel_end();
	return outcome;
}
