#include "view/panels/illustration_panel.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "render/scene/techniques.h"
#include "view/panels/widgets.h"
#include "view/settings/scene_keys.h"

/* Unscaled (chosen: four pictures side by side). */
#define ILLUSTRATION_WIDTH 392.0f
#define GAP                6.0f
#define CAPTION_HEIGHT     16.0f
#define CURVE_HEIGHT       130.0f
/* Distance from which a handle is grabbed (chosen: twice its disc). */
#define HANDLE_REACH  10.0f
#define HANDLE_RADIUS 5.0f
#define LABEL_SHARE   0.45f

enum { COLUMNS = 4, CURVE_STEPS = 64, TEMPLATES_MAX = 16 };

/* Handles of the curve: where haze begins, how it grows, where it ends. */
enum handle { HANDLE_NONE, HANDLE_NEAR, HANDLE_GROWTH, HANDLE_FAR, HANDLE_COUNT };

/* Least way between the ends of the haze (chosen: the curve stays one). */
#define HAZE_WAY_LEAST 0.02

static const struct gz_paint chosen_paint = { 255, 190, 60, 255 };
static const struct gz_paint quiet_paint = { 150, 150, 150, 255 };
static const struct gz_paint field_paint = { 20, 22, 26, 255 };

static const struct gz_option *show_option(void)
{
	return &gz_illustration_look_options[0];
}

int gz_illustration_gallery_count(void)
{
	int count = 0;
	while (count < GZ_GALLERY_MAX && show_option()->choices[count])
		count++;
	return count;
}

/* ---- settings ---- */

/* "none", the templates, and a file that the scene names. */
static bool draw_scene_template(struct gz_illustration_look *look)
{
	const char *names[TEMPLATES_MAX + 3] = { "none" };
	int count = 1, chosen = 0;
	for (size_t i = 0; gz_shading_template_name(i) && i < TEMPLATES_MAX; i++)
		names[count++] = gz_shading_template_name(i);
	for (int i = 1; i < count; i++)
		if (strcmp(names[i], look->template_name) == 0)
			chosen = i;
	if (chosen == 0 && look->template_name[0]) {
		names[count] = look->template_name;
		chosen = count;
	}
	gz_widget_label(gz_paint_plain, "template");
	gz_widgets_same_line(LABEL_SHARE);
	gz_widgets_next_width(0);
	if (!gz_widget_choice("##scene template", &chosen, names) || chosen == count)
		return false;
	snprintf(look->template_name, sizeof look->template_name, "%s",
		 chosen > 0 ? names[chosen] : "");
	return true;
}

static bool draw_combined(const struct gz_settings_panel *rows, struct gz_scene_settings *settings)
{
	static const char *const source[] = { "illustration.settings", NULL };
	static const char *const combined[] = {
		"illustration.edge_emphasis",    "illustration.detail_amplitude",
		"illustration.detail_frequency", "illustration.spatial_effect",
		"illustration.foreground",       "illustration.scene_information",
		"illustration.automatic",        "illustration.drawing",
		"illustration.hatch_direction",  "illustration.pen_width",
		"illustration.chosen_object",    NULL,
	};
	bool changed = gz_settings_rows_draw(rows, source);
	changed |= draw_scene_template(&settings->rays.illustration);
	changed |= gz_settings_rows_draw(rows, combined);
	return changed;
}

/* ---- gallery ---- */

static struct gz_place gallery_corner(const struct gz_canvas *canvas, int index)
{
	const float unit = gz_widgets_scale();
	return (struct gz_place) {
		canvas->corner.x + (float)(index % COLUMNS) * (GZ_GALLERY_WIDTH + GAP) * unit,
		canvas->corner.y +
			(float)(index / COLUMNS) * (GZ_GALLERY_HEIGHT + CAPTION_HEIGHT) * unit,
	};
}

static struct gz_place gallery_opposite(struct gz_place corner)
{
	const float unit = gz_widgets_scale();
	return (struct gz_place) { corner.x + GZ_GALLERY_WIDTH * unit,
				   corner.y + GZ_GALLERY_HEIGHT * unit };
}

static void draw_gallery_picture(const struct gz_illustration_panel *panel,
				 const struct gz_canvas *canvas, int index, bool chosen)
{
	const float unit = gz_widgets_scale();
	const struct gz_place corner = gallery_corner(canvas, index);
	const struct gz_place opposite = gallery_opposite(corner);
	const struct gz_place rim[2] = { { corner.x - 2 * unit, corner.y - 2 * unit },
					 { opposite.x + 2 * unit, opposite.y + 2 * unit } };
	const struct gz_place caption = { corner.x, opposite.y + unit };
	if (chosen)
		gz_draw_rectangle(GZ_LAYER_PANEL, rim[0], rim[1], chosen_paint, 2);
	gz_draw_rectangle(GZ_LAYER_PANEL, corner, opposite, field_paint, 0);
	if (panel->pictures[index])
		gz_draw_icon(GZ_LAYER_PANEL, corner, opposite, panel->pictures[index]);
	gz_draw_text(GZ_LAYER_PANEL, caption, 0.85F, chosen ? chosen_paint : gz_paint_plain,
		     show_option()->choices[index]);
}

static int gallery_at(const struct gz_canvas *canvas, int count)
{
	for (int i = 0; i < count; i++) {
		const struct gz_place corner = gallery_corner(canvas, i);
		const struct gz_place opposite = gallery_opposite(corner);
		if (canvas->mouse.x >= corner.x && canvas->mouse.x < opposite.x &&
		    canvas->mouse.y >= corner.y && canvas->mouse.y < opposite.y)
			return i;
	}
	return -1;
}

/* Arrows choose too, while the gallery has the keyboard. */
static int gallery_by_keys(const struct gz_canvas *canvas, int shown, int count)
{
	const int next = shown + canvas->arrow_x - COLUMNS * canvas->arrow_y;
	return next >= 0 && next < count ? next : shown;
}

static bool draw_gallery(const struct gz_illustration_panel *panel,
			 struct gz_illustration_look *look)
{
	const int count = gz_illustration_gallery_count(), before = look->show;
	const float rows = (float)((count + COLUMNS - 1) / COLUMNS);
	struct gz_canvas canvas;
	gz_widget_canvas("##gallery", rows * (GZ_GALLERY_HEIGHT + CAPTION_HEIGHT), &canvas);
	const int at = canvas.pressed ? gallery_at(&canvas, count) : -1;
	look->show = at >= 0 ? at : gallery_by_keys(&canvas, look->show, count);
	for (int i = 0; i < count; i++)
		draw_gallery_picture(panel, &canvas, i, i == look->show);
	gz_widget_canvas_end();
	return look->show != before;
}

/* ---- the curve of the haze ---- */

/* What a picture of the whole scene has. */
static struct gz_shading_settings resolved(const struct gz_illustration_look *look)
{
	struct gz_illustration_look map = *look;
	struct gz_shading_settings settings;
	map.show = GZ_SHOW_SHADING;
	gz_illustration_look_resolve(&map, NULL, &settings);
	return settings;
}

static double haze_at(const struct gz_shading_settings *settings, double depth)
{
	const double way = fmax(settings->haze_far - settings->haze_near, 1e-6);
	return pow(fmin(fmax((depth - settings->haze_near) / way, 0), 1), settings->haze_exponent);
}

/* The area of the curve: its handles lie on the field as a whole. */
struct curve_area {
	struct gz_place corner, size;
};

static struct curve_area area_of_curve(const struct gz_canvas *canvas)
{
	const float rim = (HANDLE_RADIUS + 2) * gz_widgets_scale();
	return (struct curve_area) {
		.corner = { canvas->corner.x + rim, canvas->corner.y + rim },
		.size = { canvas->size.x - 2 * rim, canvas->size.y - 2 * rim },
	};
}

static struct gz_place curve_place(const struct gz_canvas *canvas, double depth, double haze)
{
	const struct curve_area area = area_of_curve(canvas);
	return (struct gz_place) { area.corner.x + (float)depth * area.size.x,
				   area.corner.y + (1 - (float)haze) * area.size.y };
}

static struct gz_place handle_place(const struct gz_canvas *canvas,
				    const struct gz_shading_settings *settings, int handle)
{
	const double middle = (settings->haze_near + settings->haze_far) / 2;
	if (handle == HANDLE_NEAR)
		return curve_place(canvas, settings->haze_near, 0);
	if (handle == HANDLE_FAR)
		return curve_place(canvas, settings->haze_far, 1);
	return curve_place(canvas, middle, haze_at(settings, middle));
}

/* Combined settings tie the beginning and the growth together, and a template may fix both. */
static bool handle_moves(const struct gz_scene_settings *settings, int handle)
{
	const struct gz_illustration_look *look = &settings->rays.illustration;
	if (look->source == GZ_ILLUSTRATION_SINGLE || handle == HANDLE_FAR)
		return true;
	return handle == HANDLE_NEAR && gz_setting_applies(settings, "illustration.foreground");
}

static int handle_near_mouse(const struct gz_canvas *canvas,
			     const struct gz_shading_settings *shown,
			     const struct gz_scene_settings *settings)
{
	int nearest = HANDLE_NONE;
	float least = HANDLE_REACH * gz_widgets_scale();
	for (int handle = HANDLE_NEAR; handle < HANDLE_COUNT; handle++) {
		const struct gz_place at = handle_place(canvas, shown, handle);
		const float way = hypotf(at.x - canvas->mouse.x, at.y - canvas->mouse.y);
		if (way >= least || !handle_moves(settings, handle))
			continue;
		least = way;
		nearest = handle;
	}
	return nearest;
}

/* gz_illustration_apply(): haze begins at 0.6 times the foreground. */
static void move_near(struct gz_illustration_look *look, double depth)
{
	if (look->source == GZ_ILLUSTRATION_SINGLE)
		look->single.haze_near =
			fmax(0, fmin(depth, look->single.haze_far - HAZE_WAY_LEAST));
	else
		look->combined.foreground = fmin(fmax(depth / GZ_HAZE_NEAR_OF_FOREGROUND, 0), 1);
}

/* Half way to the end, haze is 0.5 to the power of the exponent. */
static void move_growth(struct gz_illustration_look *look, double haze)
{
	const double exponent = log(fmin(fmax(haze, 1e-4), 0.97)) / log(0.5);
	look->single.haze_exponent = fmin(fmax(exponent, 0.1), 10);
}

static bool drag_handle(const struct gz_illustration_panel *panel, const struct gz_canvas *canvas,
			const struct gz_shading_settings *shown, struct gz_illustration_look *look)
{
	const struct curve_area area = area_of_curve(canvas);
	const double depth = (double)((canvas->mouse.x - area.corner.x) / area.size.x);
	const double haze = 1 - (double)((canvas->mouse.y - area.corner.y) / area.size.y);
	if (panel->handle == HANDLE_NEAR)
		move_near(look, depth);
	else if (panel->handle == HANDLE_FAR)
		look->single.haze_far = fmin(fmax(depth, shown->haze_near + HAZE_WAY_LEAST), 1);
	else if (panel->handle == HANDLE_GROWTH)
		move_growth(look, haze);
	return panel->handle != HANDLE_NONE;
}

static void draw_curve(const struct gz_canvas *canvas, const struct gz_shading_settings *shown,
		       const struct gz_scene_settings *settings, int hovered)
{
	const struct gz_place opposite = { canvas->corner.x + canvas->size.x,
					   canvas->corner.y + canvas->size.y };
	struct gz_place places[CURVE_STEPS + 1];
	for (int i = 0; i <= CURVE_STEPS; i++) {
		const double depth = (double)i / CURVE_STEPS;
		places[i] = curve_place(canvas, depth, haze_at(shown, depth));
	}
	gz_draw_rectangle(GZ_LAYER_PANEL, canvas->corner, opposite, field_paint, 0);
	gz_draw_lines(GZ_LAYER_PANEL, places, CURVE_STEPS + 1, gz_paint_plain, 1.5F);
	for (int handle = HANDLE_NEAR; handle < HANDLE_COUNT; handle++) {
		const struct gz_place at = handle_place(canvas, shown, handle);
		if (handle_moves(settings, handle))
			gz_draw_disc(GZ_LAYER_PANEL, at, HANDLE_RADIUS,
				     handle == hovered ? chosen_paint : gz_paint_plain);
		else
			gz_draw_circle(GZ_LAYER_PANEL, at, HANDLE_RADIUS, quiet_paint, 1);
	}
}

static bool draw_haze(struct gz_illustration_panel *panel, const struct gz_settings_panel *rows,
		      struct gz_scene_settings *settings)
{
	static const char *const combined[] = { "illustration.spatial_effect",
						"shading_map.haze_background", NULL };
	static const char *const single[] = { "shading_map.haze", NULL };
	struct gz_illustration_look *look = &settings->rays.illustration;
	const struct gz_shading_settings before = resolved(look);
	struct gz_canvas canvas;
	bool changed = false;
	gz_widget_text(quiet_paint, "Haze, from the nearest (left) to the farthest depth: drag "
				    "where it begins, how it grows, where it ends.");
	gz_widget_canvas("##haze", CURVE_HEIGHT, &canvas);
	const int hovered = handle_near_mouse(&canvas, &before, settings);
	if (canvas.pressed)
		panel->handle = hovered;
	if (!canvas.held)
		panel->handle = HANDLE_NONE;
	if (canvas.held)
		changed = drag_handle(panel, &canvas, &before, look);
	const struct gz_shading_settings now = resolved(look);
	draw_curve(&canvas, &now, settings, panel->handle ? panel->handle : hovered);
	gz_widget_canvas_end();
	if (look->source == GZ_ILLUSTRATION_COMBINED)
		gz_widget_text(quiet_paint, "Combined settings tie growth to the beginning; with "
					    "single ones it has a handle of its own.");
	gz_widgets_push_id("haze");
	changed |= gz_settings_rows_draw(rows, look->source == GZ_ILLUSTRATION_SINGLE ? single
										      : combined);
	gz_widgets_pop_id();
	return changed;
}

/* ---- the panel ---- */

/* render.technique, by the name of the technique. */
static bool offer_technique(struct gz_scene_settings *settings)
{
	gz_widget_text(gz_paint_plain, "This scene is not shown as an illustration.");
	if (!gz_widget_button("Show it as one"))
		return false;
	for (int i = 0; gz_techniques[i]; i++)
		if (strcmp(gz_techniques[i]->name, "illustrate") == 0)
			settings->technique = i + 1;
	return true;
}

bool gz_illustration_panel_draw(struct gz_illustration_panel *panel,
				const struct gz_settings_panel *rows,
				struct gz_scene_settings *settings)
{
	const struct gz_panel_place place = {
		.at = GZ_PANEL_TOP_RIGHT,
		.margin_top = panel->margin_top,
		.width = ILLUSTRATION_WIDTH,
	};
	bool changed = false;
	if (gz_panel_begin("Illustration", &place, &panel->open)) {
		if (!gz_setting_applies(settings, "illustration.show")) {
			changed = offer_technique(settings);
		} else {
			if (gz_widget_heading("Look", true))
				changed |= draw_combined(rows, settings);
			if (gz_widget_heading("Parameters", true))
				changed |= draw_gallery(panel, &settings->rays.illustration);
			if (gz_widget_heading("Haze by depth", false))
				changed |= draw_haze(panel, rows, settings);
		}
	}
	gz_panel_end();
	return changed;
}
