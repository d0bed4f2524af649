#include "view/panels/transfer_plot.h"

#include <math.h>
#include <stdio.h>

#include "view/panels/transfer_edit.h"

/* Unscaled. */
#define BAND_HEIGHT  16.0f
#define GAP          4.0f
#define MARGIN       8.0f /* room for the discs at the ends */
#define POINT_RADIUS 5.0f
/* Width of the columns that the curve and its colours are drawn in (chosen: fine enough). */
#define COLUMN 2.0f

enum { COLUMNS_MAX = 2048 };

static const struct gz_paint ground = { 16, 18, 22, 255 }, grid = { 255, 255, 255, 28 },
			     bars = { 120, 132, 150, 150 }, dim = { 190, 196, 205, 190 },
			     ring = { 20, 20, 20, 255 }, bright = { 255, 255, 255, 255 };

void gz_transfer_plot_lay_out(struct gz_transfer_plot *plot, const struct gz_canvas *canvas)
{
	const float scale = gz_widgets_scale();
	const float label = gz_text_room(1, "0").y;
	const float right = canvas->corner.x + canvas->size.x - MARGIN * scale;
	const float bottom = canvas->corner.y + canvas->size.y - label - GAP * scale;
	plot->corner = (struct gz_place) { canvas->corner.x + MARGIN * scale,
					   canvas->corner.y + MARGIN * scale };
	plot->opposite = (struct gz_place) { right, bottom - (BAND_HEIGHT + GAP + MARGIN) * scale };
	plot->band[0] = (struct gz_place) { plot->corner.x, bottom - BAND_HEIGHT * scale };
	plot->band[1] = (struct gz_place) { right, bottom };
}

static double width_of_range(const double range[2])
{
	return range[1] > range[0] ? range[1] - range[0] : 1;
}

double gz_transfer_plot_value(const struct gz_transfer_plot *plot, float x)
{
	const double share =
		(double)(x - plot->corner.x) / fmax(1, (double)(plot->opposite.x - plot->corner.x));
	const double data = plot->shown[0] + share * width_of_range(plot->shown);
	return (data - plot->range[0]) / width_of_range(plot->range);
}

static float x_of_data(const struct gz_transfer_plot *plot, double data)
{
	const double share = (data - plot->shown[0]) / width_of_range(plot->shown);
	return plot->corner.x + (float)(share * (double)(plot->opposite.x - plot->corner.x));
}

float gz_transfer_plot_x(const struct gz_transfer_plot *plot, double value)
{
	return x_of_data(plot, plot->range[0] + value * width_of_range(plot->range));
}

double gz_transfer_plot_opacity(const struct gz_transfer_plot *plot, float y)
{
	const double height = (double)(plot->opposite.y - y) /
			      fmax(1, (double)(plot->opposite.y - plot->corner.y));
	return gz_transfer_axis_opacity(height, plot->opacity_logarithmic);
}

float gz_transfer_plot_y(const struct gz_transfer_plot *plot, double opacity)
{
	const double height = gz_transfer_axis_of(opacity, plot->opacity_logarithmic);
	return plot->opposite.y - (float)height * (plot->opposite.y - plot->corner.y);
}

static struct gz_paint paint_of_rgb(const double rgba[4], uint8_t alpha)
{
	return (struct gz_paint) { (uint8_t)lround(rgba[0] * 255), (uint8_t)lround(rgba[1] * 255),
				   (uint8_t)lround(rgba[2] * 255), alpha };
}

/* Lines at some opacities. */
static void draw_opacity_grid(const struct gz_transfer_plot *plot)
{
	static const double linear[] = { 0, 0.25, 0.5, 0.75, 1 };
	static const double logarithmic[] = { 0, 0.0001, 0.001, 0.01, 0.1, 1 };
	const double *lines = plot->opacity_logarithmic ? logarithmic : linear;
	const int count = plot->opacity_logarithmic ? 6 : 5;
	gz_draw_rectangle(GZ_LAYER_PANEL, plot->corner, plot->opposite, ground, 0);
	for (int i = 0; i < count; i++) {
		const float y = gz_transfer_plot_y(plot, lines[i]);
		gz_draw_line(GZ_LAYER_PANEL, (struct gz_place) { plot->corner.x, y },
			     (struct gz_place) { plot->opposite.x, y }, grid, 1);
	}
}

static void draw_opacity_labels(const struct gz_transfer_plot *plot)
{
	static const double linear[] = { 0.25, 0.5, 0.75 };
	static const double logarithmic[] = { 0.001, 0.01, 0.1 };
	const double *lines = plot->opacity_logarithmic ? logarithmic : linear;
	const float room = gz_text_room(1, "0").y;
	for (int i = 0; i < 3; i++) {
		char text[16];
		snprintf(text, sizeof text, "%g", lines[i]);
		const float x = plot->opposite.x - gz_text_room(1, text).x - GAP;
		const float y = gz_transfer_plot_y(plot, lines[i]) - room;
		gz_draw_text(GZ_LAYER_PANEL, (struct gz_place) { x, y }, 1, dim, text);
	}
}

/* The count that fills the height. On a linear axis the second largest: a bin of background would
 * flatten all others. */
static uint64_t full_count(const struct gz_histogram *histogram, bool logarithmic)
{
	uint64_t second = 0;
	bool passed = false;
	for (int i = 0; i < histogram->bins; i++) {
		const uint64_t count = histogram->counts[i];
		if (count == histogram->most && !passed)
			passed = true;
		else if (count > second)
			second = count;
	}
	return logarithmic || second == 0 ? histogram->most : second;
}

/* The greatest count of the bins in a column of the plot. */
static uint64_t column_count(const struct gz_histogram *histogram, double from, double to)
{
	uint64_t greatest = 0;
	if (to < histogram->data_min || from > histogram->data_max)
		return 0;
	const int last = gz_histogram_bin_of(histogram, to);
	for (int bin = gz_histogram_bin_of(histogram, from); bin <= last; bin++)
		if (histogram->counts[bin] > greatest)
			greatest = histogram->counts[bin];
	return greatest;
}

static void draw_histogram(const struct gz_transfer_plot *plot,
			   const struct gz_histogram *histogram)
{
	const double full = (double)full_count(histogram, plot->counts_logarithmic);
	const double per_x =
		width_of_range(plot->shown) / (double)(plot->opposite.x - plot->corner.x);
	const float height = plot->opposite.y - plot->corner.y;
	for (float x = plot->corner.x; x < plot->opposite.x; x += 1) {
		const double from = plot->shown[0] + (double)(x - plot->corner.x) * per_x;
		const double count = (double)column_count(histogram, from, from + per_x);
		const double share =
			plot->counts_logarithmic ? log1p(count) / log1p(full) : count / full;
		if (count > 0)
			gz_draw_rectangle(
				GZ_LAYER_PANEL,
				(struct gz_place) { x, plot->opposite.y -
							       (float)fmin(share, 1) * height },
				(struct gz_place) { x + 1, plot->opposite.y }, bars, 0);
	}
}

/* The colours under the curve and in the band; beyond its range the function has the colours of its
 * ends. */
static void draw_colours(const struct gz_transfer_plot *plot, const struct gz_transfer *transfer)
{
	double left[4], right[4];
	gz_transfer_evaluate(transfer, gz_transfer_plot_value(plot, plot->corner.x), left);
	for (float x = plot->corner.x; x < plot->opposite.x; x += COLUMN) {
		const float end = fminf(x + COLUMN, plot->opposite.x);
		gz_transfer_evaluate(transfer, gz_transfer_plot_value(plot, end), right);
		const float top = gz_transfer_plot_y(plot, (left[3] + right[3]) / 2);
		gz_draw_fading_rectangle(GZ_LAYER_PANEL, (struct gz_place) { x, top },
					 (struct gz_place) { end, plot->opposite.y },
					 paint_of_rgb(left, 110), paint_of_rgb(right, 110));
		gz_draw_fading_rectangle(GZ_LAYER_PANEL, (struct gz_place) { x, plot->band[0].y },
					 (struct gz_place) { end, plot->band[1].y },
					 paint_of_rgb(left, 255), paint_of_rgb(right, 255));
		for (int i = 0; i < 4; i++)
			left[i] = right[i];
	}
}

/* Points of the curve: one a column, and the control points, as peaks may be narrower. */
struct opacity_curve {
	struct gz_place places[COLUMNS_MAX + GZ_TRANSFER_POINTS_MAX];
	size_t count;
	size_t next; /* control point */
};

static void add_points_before(struct opacity_curve *curve, const struct gz_transfer_plot *plot,
			      const struct gz_transfer *transfer, float x)
{
	for (; curve->next < transfer->count; curve->next++) {
		const struct gz_transfer_point *point = &transfer->points[curve->next];
		const float at = gz_transfer_plot_x(plot, point->value);
		if (at > x)
			return;
		if (at >= plot->corner.x)
			curve->places[curve->count++] =
				(struct gz_place) { at, gz_transfer_plot_y(plot, point->opacity) };
	}
}

static void draw_curve(const struct gz_transfer_plot *plot, const struct gz_transfer *transfer)
{
	struct opacity_curve curve;
	curve.count = curve.next = 0;
	const float width = plot->opposite.x - plot->corner.x;
	const float column = fmaxf(COLUMN, width / (COLUMNS_MAX - 2));
	for (float x = 0; x <= width; x += column) {
		double rgba[4];
		const float at = plot->corner.x + x;
		add_points_before(&curve, plot, transfer, at);
		gz_transfer_evaluate(transfer, gz_transfer_plot_value(plot, at), rgba);
		curve.places[curve.count++] =
			(struct gz_place) { at, gz_transfer_plot_y(plot, rgba[3]) };
	}
	gz_draw_lines(GZ_LAYER_PANEL, curve.places, curve.count, dim, 1.5f);
}

static void draw_control_points(const struct gz_transfer_plot *plot,
				const struct gz_transfer *transfer)
{
	for (size_t i = 0; i < transfer->count; i++) {
		const struct gz_transfer_point *point = &transfer->points[i];
		const struct gz_place at = { gz_transfer_plot_x(plot, point->value),
					     gz_transfer_plot_y(plot, point->opacity) };
		if (at.x < plot->corner.x - 1 || at.x > plot->opposite.x + 1)
			continue;
		const bool selected = i == plot->selected;
		const double rgba[4] = { point->rgb[0], point->rgb[1], point->rgb[2] };
		gz_draw_disc(GZ_LAYER_PANEL, at, POINT_RADIUS + (selected ? 3.5f : 2), ring);
		gz_draw_disc(GZ_LAYER_PANEL, at, POINT_RADIUS + (selected ? 2.5f : 1),
			     selected ? bright : dim);
		gz_draw_disc(GZ_LAYER_PANEL, at, POINT_RADIUS, paint_of_rgb(rgba, 255));
	}
}

/* The data values at both ends of the axis. */
static void draw_value_axis(const struct gz_transfer_plot *plot)
{
	char text[32];
	const float y = plot->band[1].y + GAP * gz_widgets_scale();
	snprintf(text, sizeof text, "%.6g", plot->shown[0]);
	gz_draw_text(GZ_LAYER_PANEL, (struct gz_place) { plot->corner.x, y }, 1, dim, text);
	snprintf(text, sizeof text, "%.6g", plot->shown[1]);
	const float room = gz_text_room(1, text).x;
	gz_draw_text(GZ_LAYER_PANEL, (struct gz_place) { plot->opposite.x - room, y }, 1, dim,
		     text);
}

void gz_transfer_plot_draw(const struct gz_transfer_plot *plot, const struct gz_transfer *transfer,
			   const struct gz_histogram *histogram, const char *note)
{
	draw_opacity_grid(plot);
	if (histogram && histogram->total > 0)
		draw_histogram(plot, histogram);
	draw_colours(plot, transfer);
	draw_opacity_labels(plot);
	draw_curve(plot, transfer);
	draw_control_points(plot, transfer);
	draw_value_axis(plot);
	if (note) {
		const float room = gz_text_room(1, note).x;
		const struct gz_place at = { (plot->corner.x + plot->opposite.x - room) / 2,
					     plot->band[1].y + GAP * gz_widgets_scale() };
		gz_draw_text(GZ_LAYER_PANEL, at, 1, dim, note);
	}
}
