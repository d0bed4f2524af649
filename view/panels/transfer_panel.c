#include "view/panels/transfer_panel.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "render/data/voxel_colour.h"
#include "render/transfer/colour_map.h"
#include "render/transfer/transfer_presets.h"
#include "view/panels/widgets.h"

/* Unscaled (chosen: a bin of 256 is two coordinates wide). */
#define WIDTH 540.0f
/* Distance from which a point is grabbed, unscaled (chosen: twice its disc). */
#define REACH 10.0f
/* One notch of the wheel over the axis (chosen: seven notches double it). */
#define ZOOM_PER_NOTCH 0.9
#define PAN_PER_NOTCH  0.1
/* Narrowest part of the axis that can be shown, as a share (chosen: less than a 16-bit value's
 * share on a wide display). */
#define SHOWN_LEAST 1e-5
/* Step of an arrow key, as a share of the axis shown (chosen: 200 presses from side to side). */
#define ARROW_STEP      0.005
#define ARROW_STEP_FINE 0.0005

static const struct gz_transfer *edited(const struct gz_transfer_panel *panel)
{
	return gz_transfer_edit_now(panel->edit);
}

/* All changes during one press of a button or key are one step. */
static void begin_step(struct gz_transfer_panel *panel)
{
	if (!gz_transfer_edit_in_drag(panel->edit))
		gz_transfer_edit_begin(panel->edit);
}

static void data_range(const struct gz_volume *volume, double out_range[2])
{
	const double a = volume->slope * volume->stored_min + volume->intercept;
	const double b = volume->slope * volume->stored_max + volume->intercept;
	out_range[0] = fmin(a, b);
	out_range[1] = fmax(a, b);
}

static void shown_range(const struct gz_transfer_panel *panel, double out_range[2])
{
	data_range(panel->volume, out_range);
	if (edited(panel)->has_range) {
		out_range[0] = edited(panel)->range[0];
		out_range[1] = edited(panel)->range[1];
	}
	if (!(out_range[1] > out_range[0])) /* all values are one */
		out_range[1] = out_range[0] + 1;
}

/* All values of the data and of the function's range. */
static void whole_axis(const struct gz_transfer_panel *panel, double out_range[2])
{
	double range[2];
	data_range(panel->volume, out_range);
	shown_range(panel, range);
	out_range[0] = fmin(out_range[0], range[0]);
	out_range[1] = fmax(out_range[1], range[1]);
}

static void zoom_axis(struct gz_transfer_panel *panel, const struct gz_canvas *canvas)
{
	double whole[2], *shown = panel->plot.shown;
	whole_axis(panel, whole);
	const double width = shown[1] - shown[0];
	const double at =
		fmin(fmax((double)((canvas->mouse.x - panel->plot.corner.x) /
				   fmaxf(1, panel->plot.opposite.x - panel->plot.corner.x)),
			  0),
		     1);
	double wide = width, left = shown[0];
	if (canvas->shift) {
		left -= (double)canvas->wheel * PAN_PER_NOTCH * width;
	} else {
		wide = width * pow(ZOOM_PER_NOTCH, (double)canvas->wheel);
		wide = fmax(wide, (whole[1] - whole[0]) * SHOWN_LEAST);
		left += at * (width - wide);
	}
	panel->whole_lost = wide < whole[1] - whole[0];
	left = fmin(fmax(left, whole[0]), whole[1] - wide);
	shown[0] = left;
	shown[1] = left + wide;
}

static size_t nearest_point(const struct gz_transfer_panel *panel, struct gz_place at)
{
	const struct gz_transfer_plot *plot = &panel->plot;
	const struct gz_transfer_place place = {
		.value = gz_transfer_plot_value(plot, at.x),
		.height = gz_transfer_axis_of(gz_transfer_plot_opacity(plot, at.y),
					      plot->opacity_logarithmic),
		.per_value = (double)(gz_transfer_plot_x(plot, 1) - gz_transfer_plot_x(plot, 0)),
		.per_height = (double)(plot->opposite.y - plot->corner.y),
		.logarithmic = plot->opacity_logarithmic,
	};
	return gz_transfer_edit_nearest(panel->edit, &place, (double)(REACH * gz_widgets_scale()));
}

/* In the band of colours only the value counts. */
static size_t nearest_in_band(const struct gz_transfer_panel *panel, float x)
{
	size_t found = 0;
	for (size_t i = 1; i < edited(panel)->count; i++)
		if (fabsf(gz_transfer_plot_x(&panel->plot, edited(panel)->points[i].value) - x) <
		    fabsf(gz_transfer_plot_x(&panel->plot, edited(panel)->points[found].value) - x))
			found = i;
	return found;
}

static void grip_point(struct gz_transfer_panel *panel, size_t point, struct gz_place mouse)
{
	const struct gz_transfer_point *p = &edited(panel)->points[point];
	panel->selected = point;
	panel->dragged = true;
	panel->grip_at = mouse;
	panel->grip = (struct gz_place) { gz_transfer_plot_x(&panel->plot, p->value) - mouse.x,
					  gz_transfer_plot_y(&panel->plot, p->opacity) - mouse.y };
	panel->grip_value = p->value;
	panel->grip_opacity = p->opacity;
}

static void press_on_plot(struct gz_transfer_panel *panel, struct gz_place mouse)
{
	if (mouse.y > panel->plot.opposite.y + REACH * gz_widgets_scale()) {
		panel->selected = nearest_in_band(panel, mouse.x);
		return;
	}
	begin_step(panel);
	size_t point = nearest_point(panel, mouse);
	if (point == GZ_TRANSFER_EDIT_NONE)
		point = gz_transfer_edit_add(panel->edit,
					     gz_transfer_plot_value(&panel->plot, mouse.x),
					     gz_transfer_plot_opacity(&panel->plot, mouse.y));
	if (point != GZ_TRANSFER_EDIT_NONE)
		grip_point(panel, point, mouse);
}

/* The point follows the mouse; with Shift only along the axis on which it has moved farther. */
static void drag_point(struct gz_transfer_panel *panel, const struct gz_canvas *canvas)
{
	const struct gz_place mouse = canvas->mouse;
	if (mouse.x == panel->grip_at.x && mouse.y == panel->grip_at.y)
		return; /* a click, or not moved yet */
	double value = gz_transfer_plot_value(&panel->plot, mouse.x + panel->grip.x);
	double opacity = gz_transfer_plot_opacity(&panel->plot, mouse.y + panel->grip.y);
	if (canvas->shift) {
		const bool along =
			fabsf(mouse.x - panel->grip_at.x) > fabsf(mouse.y - panel->grip_at.y);
		value = along ? value : panel->grip_value;
		opacity = along ? panel->grip_opacity : opacity;
	}
	gz_transfer_edit_move(panel->edit, panel->selected, value, opacity);
}

static void remove_point(struct gz_transfer_panel *panel, size_t point)
{
	begin_step(panel);
	if (gz_transfer_edit_remove(panel->edit, point) && panel->selected > point)
		panel->selected--;
}

/* Halfway to the next point, or to the end. */
static void insert_point(struct gz_transfer_panel *panel)
{
	const struct gz_transfer *transfer = edited(panel);
	const size_t at = panel->selected;
	const double from = transfer->points[at].value;
	const double to = at + 1 < transfer->count ? transfer->points[at + 1].value : 1;
	double rgba[4];
	gz_transfer_evaluate(transfer, (from + to) / 2, rgba);
	begin_step(panel);
	const size_t point = gz_transfer_edit_add(panel->edit, (from + to) / 2, rgba[3]);
	if (point != GZ_TRANSFER_EDIT_NONE)
		panel->selected = point;
}

static void move_by_arrows(struct gz_transfer_panel *panel, const struct gz_canvas *canvas)
{
	const struct gz_transfer_plot *plot = &panel->plot;
	const struct gz_transfer_point *p = &edited(panel)->points[panel->selected];
	const double step = canvas->control ? ARROW_STEP_FINE : ARROW_STEP;
	const double wide = gz_transfer_plot_value(plot, plot->opposite.x) -
			    gz_transfer_plot_value(plot, plot->corner.x);
	const double height = gz_transfer_axis_of(p->opacity, plot->opacity_logarithmic);
	double value = p->value, opacity = p->opacity;
	if (canvas->arrow_x)
		value += canvas->arrow_x * step * wide;
	if (canvas->arrow_y)
		opacity = gz_transfer_axis_opacity(height + canvas->arrow_y * step,
						   plot->opacity_logarithmic);
	begin_step(panel);
	gz_transfer_edit_move(panel->edit, panel->selected, value, opacity);
}

/* @return whether Tab moves on to the next widget, behind the last point */
static bool take_canvas_keys(struct gz_transfer_panel *panel, const struct gz_canvas *canvas)
{
	if (canvas->arrow_x || canvas->arrow_y)
		move_by_arrows(panel, canvas);
	if (canvas->delete_pressed)
		remove_point(panel, panel->selected);
	if (canvas->insert_pressed)
		insert_point(panel);
	const bool last = panel->selected + 1 >= edited(panel)->count;
	if (canvas->step > 0 && !last)
		panel->selected++;
	if (canvas->step < 0 && panel->selected > 0)
		panel->selected--;
	return canvas->step > 0 && last;
}

static void take_canvas_mouse(struct gz_transfer_panel *panel, const struct gz_canvas *canvas)
{
	if (canvas->wheel != 0)
		zoom_axis(panel, canvas);
	if (canvas->pressed)
		press_on_plot(panel, canvas->mouse);
	/* An undo ends the drag. */
	panel->dragged = panel->dragged && gz_transfer_edit_in_drag(panel->edit);
	if (panel->dragged && (canvas->held || canvas->released))
		drag_point(panel, canvas);
	if (!canvas->held)
		panel->dragged = false;
	if (canvas->right_pressed) {
		const size_t point = nearest_point(panel, canvas->mouse);
		if (point != GZ_TRANSFER_EDIT_NONE)
			remove_point(panel, point);
	}
}

/* After undo or load there may be fewer points. */
static void keep_selection(struct gz_transfer_panel *panel)
{
	if (panel->selected >= edited(panel)->count)
		panel->selected = edited(panel)->count - 1;
}

static void prepare_plot(struct gz_transfer_panel *panel, const struct gz_canvas *canvas)
{
	gz_transfer_plot_lay_out(&panel->plot, canvas);
	panel->plot.opacity_logarithmic = !panel->opacity_linear;
	panel->plot.counts_logarithmic = !panel->counts_linear;
	shown_range(panel, panel->plot.range);
	if (!panel->whole_lost)
		whole_axis(panel, panel->plot.shown);
}

static void print_plot_note(const struct gz_transfer_panel *panel, const struct gz_canvas *canvas,
			    char *text, size_t size)
{
	const struct gz_transfer_plot *plot = &panel->plot;
	text[0] = '\0';
	if (canvas->hovered)
		snprintf(text, size, "%.6g : %.3g",
			 plot->range[0] + gz_transfer_plot_value(plot, canvas->mouse.x) *
						  (plot->range[1] - plot->range[0]),
			 gz_transfer_plot_opacity(plot, canvas->mouse.y));
	else if (!panel->histogram)
		snprintf(text, size, "counting voxels");
	else if (panel->histogram->approximate)
		snprintf(text, size, "histogram of a coarser level");
	else if (panel->volume->time_points > 1)
		snprintf(text, size, "histogram of time point %d", panel->histogram_point + 1);
}

static void draw_colour_popup(struct gz_transfer_panel *panel, bool open)
{
	double rgb[3];
	for (int i = 0; i < 3; i++)
		rgb[i] = edited(panel)->points[panel->selected].rgb[i];
	if (!gz_widget_colour_popup("colour of a point", open, rgb))
		return;
	begin_step(panel);
	gz_transfer_edit_colour(panel->edit, panel->selected, rgb);
}

static void draw_curve_canvas(struct gz_transfer_panel *panel)
{
	struct gz_canvas canvas;
	char note[64];
	if (panel->focus)
		gz_widgets_focus_canvas();
	panel->focus = false;
	gz_widget_canvas("curve", GZ_TRANSFER_PLOT_HEIGHT, &canvas);
	prepare_plot(panel, &canvas);
	take_canvas_mouse(panel, &canvas);
	keep_selection(panel);
	const bool leave = canvas.focused && take_canvas_keys(panel, &canvas);
	keep_selection(panel);
	prepare_plot(panel, &canvas);
	panel->plot.selected = panel->selected;
	print_plot_note(panel, &canvas, note, sizeof note);
	gz_transfer_plot_draw(&panel->plot, edited(panel), panel->histogram, note);
	gz_widget_canvas_end();
	draw_colour_popup(panel, canvas.double_pressed);
	if (leave)
		gz_widgets_focus_next();
}

/* Value in data units, opacity and colour of the selected point. */
static void draw_point_fields(struct gz_transfer_panel *panel)
{
	const struct gz_transfer_point point = edited(panel)->points[panel->selected];
	double range[2], rgb[3] = { point.rgb[0], point.rgb[1], point.rgb[2] };
	shown_range(panel, range);
	const double wide = range[1] - range[0];
	double value = range[0] + point.value * wide, opacity = point.opacity;
	const struct gz_number_range values = {
		.least = range[0], .greatest = range[1], .speed = wide / 500, .format = "value %.6g"
	};
	const struct gz_number_range opacities = { .greatest = 1,
						   .speed = 0.002,
						   .format = "opacity %.5g" };
	gz_widgets_next_width(0.24f);
	if (gz_widget_doubles("##value", &value, 1, &values)) {
		begin_step(panel);
		gz_transfer_edit_move(panel->edit, panel->selected, (value - range[0]) / wide, NAN);
	}
	gz_widget_tooltip("data value of the point");
	gz_widgets_same_line(0);
	gz_widgets_next_width(0.23f);
	if (gz_widget_doubles("##opacity", &opacity, 1, &opacities)) {
		begin_step(panel);
		gz_transfer_edit_move(panel->edit, panel->selected, NAN, opacity);
	}
	gz_widget_tooltip("opacity of the point per voxel length, 0 to 1");
	gz_widgets_same_line(0);
	gz_widgets_next_width(0.35f);
	if (gz_widget_colour("##colour", rgb)) {
		begin_step(panel);
		gz_transfer_edit_colour(panel->edit, panel->selected, rgb);
	}
	gz_widgets_same_line(0);
	gz_widgets_disable(edited(panel)->count < 2);
	if (gz_widget_button("Remove"))
		remove_point(panel, panel->selected);
	gz_widgets_enable();
}

/* The presets that make sense for a volume. */
struct preset_list {
	enum gz_transfer_preset presets[GZ_PRESET_COUNT];
	char lines[GZ_PRESET_COUNT][96];
	const char *names[GZ_PRESET_COUNT + 2]; /* a title and the lines; NULL-terminated */
};

static void list_presets(const struct gz_transfer_panel *panel, struct preset_list *list)
{
	size_t count = 0;
	list->names[0] = "Presets";
	for (int i = 0; i < GZ_PRESET_COUNT; i++) {
		const enum gz_transfer_preset preset = (enum gz_transfer_preset)i;
		const struct gz_transfer_preset_text *text = gz_transfer_preset_text(preset);
		if (!panel->histogram ||
		    !gz_transfer_preset_fits(preset, panel->histogram, panel->volume->modality))
			continue;
		snprintf(list->lines[count], sizeof list->lines[count], "%s: %s", text->title,
			 text->about);
		list->presets[count] = preset;
		list->names[1 + count] = list->lines[count];
		count++;
	}
	list->names[1 + count] = NULL;
}

static enum gz_transfer_wish draw_preset_choice(struct gz_transfer_panel *panel)
{
	struct preset_list list;
	enum gz_transfer_wish wish = GZ_TRANSFER_WISH_NONE;
	int chosen = 0;
	list_presets(panel, &list);
	gz_widgets_disable(!panel->histogram);
	gz_widgets_next_width(0.2f);
	if (gz_widget_choice("##presets", &chosen, list.names) && chosen > 0) {
		struct gz_transfer made;
		const enum gz_transfer_preset preset = list.presets[chosen - 1];
		gz_transfer_preset_make(preset, panel->histogram, panel->volume, &made);
		gz_transfer_edit_end(panel->edit);
		gz_transfer_edit_replace(panel->edit, &made);
		panel->whole_lost = false;
		wish = gz_transfer_preset_text(preset)->lit ? GZ_TRANSFER_WISH_LIGHT
							    : GZ_TRANSFER_WISH_NO_LIGHT;
	}
	gz_widgets_enable();
	gz_widget_tooltip("transfer functions fitted to the histogram of this volume; they also "
			  "switch lighting on or off");
	return wish;
}

static void draw_colour_choice(struct gz_transfer_panel *panel)
{
	const char *names[GZ_COLOUR_MAP_COUNT + 2] = { "Colours" };
	int chosen = 0;
	memcpy(names + 1, gz_colour_map_names, GZ_COLOUR_MAP_COUNT * sizeof names[0]);
	gz_widgets_same_line(0);
	gz_widgets_next_width(0.15f);
	if (gz_widget_choice("##colours", &chosen, names) && chosen > 0) {
		struct gz_transfer coloured = *edited(panel);
		gz_transfer_colour(&coloured, (enum gz_colour_map)(chosen - 1));
		gz_transfer_edit_end(panel->edit);
		gz_transfer_edit_replace(panel->edit, &coloured);
	}
	gz_widget_tooltip("perceptually uniform colours over the whole range; opacity stays");
}

static void draw_undo_buttons(struct gz_transfer_panel *panel)
{
	gz_widgets_same_line(0);
	gz_widgets_disable(!gz_transfer_edit_can_undo(panel->edit));
	if (gz_widget_button("Undo"))
		gz_transfer_edit_undo(panel->edit);
	gz_widgets_enable();
	gz_widget_tooltip("Ctrl+Z");
	gz_widgets_same_line(0);
	gz_widgets_disable(!gz_transfer_edit_can_redo(panel->edit));
	if (gz_widget_button("Redo"))
		gz_transfer_edit_redo(panel->edit);
	gz_widgets_enable();
	gz_widget_tooltip("Ctrl+Shift+Z");
	keep_selection(panel);
}

static void draw_interpolation_choice(struct gz_transfer_panel *panel)
{
	static const char *const names[] = { "linear", "quadratic", NULL };
	int interpolation = (int)edited(panel)->interpolation;
	gz_widgets_same_line(0);
	gz_widgets_next_width(0.18f);
	if (gz_widget_choice("##interpolation", &interpolation, names)) {
		begin_step(panel);
		gz_transfer_edit_interpolate(panel->edit,
					     (enum gz_transfer_interpolation)interpolation);
	}
	gz_widget_tooltip("between points: straight lines, or easing in and out");
}

static void draw_axis_switches(struct gz_transfer_panel *panel)
{
	bool opacity = !panel->opacity_linear, counts = !panel->counts_linear;
	gz_widgets_same_line(0);
	if (gz_widget_checkbox("log opacity", &opacity))
		panel->opacity_linear = !opacity;
	gz_widgets_same_line(0);
	if (gz_widget_checkbox("log counts", &counts))
		panel->counts_linear = !counts;
}

static void draw_range_fields(struct gz_transfer_panel *panel)
{
	bool own = edited(panel)->has_range;
	double range[2];
	shown_range(panel, range);
	if (gz_widget_checkbox("range", &own)) {
		begin_step(panel);
		gz_transfer_edit_range(panel->edit, own ? range : NULL);
	}
	gz_widget_tooltip("data values of the left and right end; off: least and greatest value of "
			  "the volume");
	gz_widgets_same_line(0);
	gz_widgets_disable(!own);
	gz_widgets_next_width(0.27f);
	const struct gz_number_range limits = { .least = -1e38,
						.greatest = 1e38,
						.speed = (range[1] - range[0]) / 500,
						.format = "%.6g" };
	if (gz_widget_doubles("##range", range, 2, &limits)) {
		begin_step(panel);
		gz_transfer_edit_range(panel->edit, range);
	}
	gz_widgets_enable();
	gz_widgets_same_line(0);
	gz_widgets_disable(!panel->whole_lost);
	if (gz_widget_button("Whole axis"))
		panel->whole_lost = false;
	gz_widgets_enable();
	gz_widget_tooltip("the wheel zooms; with Shift it scrolls");
}

static enum gz_transfer_wish draw_file_row(struct gz_transfer_panel *panel)
{
	enum gz_transfer_wish wish = GZ_TRANSFER_WISH_NONE;
	gz_widgets_next_width(0.6f);
	gz_widget_text_field("##file", panel->file, sizeof panel->file, false);
	gz_widget_tooltip("file of the transfer function (.tf)");
	gz_widgets_same_line(0);
	gz_widgets_disable(!panel->file[0]);
	if (gz_widget_button("Load"))
		wish = GZ_TRANSFER_WISH_LOAD;
	gz_widgets_same_line(0);
	if (gz_widget_button("Save"))
		wish = GZ_TRANSFER_WISH_SAVE;
	gz_widgets_enable();
	gz_widgets_same_line(0);
	gz_widget_label(gz_paint_plain, gz_transfer_edit_differs(panel->edit) ? "changed"
					: panel->file[0]                      ? "as in the file"
									      : "not saved");
	return wish;
}

/* Colours of the curve have no effect if voxels have their own. */
static void draw_colour_note(const struct gz_transfer_panel *panel)
{
	char note[96];
	if (!panel->volume || panel->volume->colour == GZ_COLOUR_NONE)
		return;
	snprintf(note, sizeof note, "Voxels have colours: the curve gives opacity by %s",
		 gz_volume_colour_text(panel->volume->colour));
	gz_widget_label(gz_paint_plain, note);
}

/* A curve for other data may lie wholly beside these. */
static void draw_stretch_offer(struct gz_transfer_panel *panel)
{
	char note[96];
	const struct gz_histogram *histogram = panel->histogram;
	if (!histogram || !edited(panel)->has_range ||
	    gz_transfer_shows(edited(panel), histogram->data_min, histogram->data_max))
		return;
	snprintf(note, sizeof note, "Nothing is seen: the data are %.6g to %.6g",
		 histogram->data_min, histogram->data_max);
	gz_widget_label(gz_paint_amber, note);
	gz_widgets_same_line(0);
	if (gz_widget_button("Stretch to the data")) {
		const double range[2] = { histogram->data_min, histogram->data_max };
		gz_transfer_edit_end(panel->edit);
		begin_step(panel);
		gz_transfer_edit_range(panel->edit, range[0] < range[1] ? range : NULL);
		gz_transfer_edit_end(panel->edit);
	}
}

static enum gz_transfer_wish draw_transfer_content(struct gz_transfer_panel *panel)
{
	keep_selection(panel);
	draw_colour_note(panel);
	const enum gz_transfer_wish light = draw_preset_choice(panel);
	draw_colour_choice(panel);
	draw_undo_buttons(panel);
	draw_interpolation_choice(panel);
	draw_curve_canvas(panel);
	draw_point_fields(panel);
	draw_range_fields(panel);
	draw_axis_switches(panel);
	draw_stretch_offer(panel);
	const enum gz_transfer_wish wish = draw_file_row(panel);
	return wish != GZ_TRANSFER_WISH_NONE ? wish : light;
}

enum gz_transfer_wish gz_transfer_panel_draw(struct gz_transfer_panel *panel)
{
	const struct gz_panel_place place = {
		.at = GZ_PANEL_BOTTOM_LEFT,
		.width = WIDTH,
		.margin_top = panel->margin_top,
		.margin_bottom = panel->margin_bottom,
	};
	enum gz_transfer_wish wish = GZ_TRANSFER_WISH_NONE;
	if (!gz_widgets_in_use())
		gz_transfer_edit_end(panel->edit);
	if (gz_panel_begin("Transfer function", &place, &panel->open))
		wish = draw_transfer_content(panel);
	gz_panel_end();
	return wish;
}
