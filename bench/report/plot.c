#include "bench/report/plot.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Outside every axis: the content of an empty block. */
#define NOWHERE "nan\tnan\t0\t0\t-\n"

/* Mean width of a character, of its font's size. Chosen: sans-serif, a little wide. */
#define CHARACTER 0.56

bool gz_plot_start(struct gz_plot *plot, size_t curves)
{
	plot->curves = calloc(curves, sizeof plot->curves[0]);
	plot->curve_count = plot->curves ? curves : 0;
	return plot->curves != NULL;
}

bool gz_plot_curve_start(struct gz_plot_curve *curve, size_t points)
{
	curve->points = calloc(points, sizeof curve->points[0]);
	curve->point_count = curve->points ? points : 0;
	return curve->points != NULL;
}

void gz_plot_free(struct gz_plot *plot)
{
	for (size_t i = 0; i < plot->curve_count; i++)
		free(plot->curves[i].points);
	free(plot->curves);
	*plot = (struct gz_plot) { 0 };
}

static bool fits(const struct gz_plot_axis *axis, double value)
{
	return isfinite(value) && (!axis->logarithmic || value > 0);
}

static void keep_points_that_fit(struct gz_plot *plot)
{
	for (size_t i = 0; i < plot->curve_count; i++) {
		struct gz_plot_curve *curve = &plot->curves[i];
		size_t kept = 0;
		for (size_t k = 0; k < curve->point_count; k++)
			if (fits(&plot->x, curve->points[k].x) &&
			    fits(&plot->y, curve->points[k].y))
				curve->points[kept++] = curve->points[k];
		curve->point_count = kept;
	}
}

/* Ends of an axis round its values, with a margin. */
static void fit_axis(struct gz_plot_axis *axis, double least, double greatest)
{
	if (axis->logarithmic) {
		const double margin = pow(greatest / least, 0.09) * 1.04;
		axis->first = least / margin;
		axis->last = greatest * margin * pow(greatest / least, axis->name_room);
		return;
	}
	/* If all values are equal, the axis spans a tenth of the value. */
	const double span = greatest > least ? greatest - least
			    : greatest != 0  ? 0.1 * fabs(greatest)
					     : 1;
	axis->first = axis->from_zero ? fmin(0, least) : least - 0.08 * span;
	axis->last = greatest + 0.12 * (axis->from_zero ? fmax(greatest, span) : span);
	if (axis->falls) {
		const double swapped = axis->first;
		axis->first = axis->last;
		axis->last = swapped;
	}
}

static bool fit_axes(struct gz_plot *plot)
{
	double x[2] = { INFINITY, -INFINITY }, y[2] = { INFINITY, -INFINITY };
	for (size_t i = 0; i < plot->curve_count; i++)
		for (size_t k = 0; k < plot->curves[i].point_count; k++) {
			const struct gz_plot_point *point = &plot->curves[i].points[k];
			x[0] = fmin(x[0], point->x);
			x[1] = fmax(x[1], point->x);
			y[0] = fmin(y[0], point->y);
			y[1] = fmax(y[1], point->y);
		}
	if (x[0] > x[1])
		return false;
	if (plot->bound > 0) {
		x[0] = fmin(x[0], plot->bound);
		x[1] = fmax(x[1], plot->bound);
	}
	fit_axis(&plot->x, x[0], x[1]);
	fit_axis(&plot->y, y[0], y[1]);
	return true;
}

/* Position of a value on its axis, 0 to 1. */
static double share(const struct gz_plot_axis *axis, double value)
{
	if (axis->logarithmic)
		return log(value / axis->first) / log(axis->last / axis->first);
	return (value - axis->first) / (axis->last - axis->first);
}

static double axis_value_at(const struct gz_plot_axis *axis, double where)
{
	if (axis->logarithmic)
		return axis->first * pow(axis->last / axis->first, where);
	return axis->first + where * (axis->last - axis->first);
}

/* A plot on a canvas. */
struct placing {
	const struct gz_plot *plot;
	const struct gz_canvas *canvas;
	struct gz_label_field field;
};

static double x_px(const struct placing *placing, double x)
{
	const struct gz_canvas *canvas = placing->canvas;
	return canvas->left +
	       share(&placing->plot->x, x) * (canvas->width - canvas->left - canvas->right);
}

static double y_px(const struct placing *placing, double y)
{
	const struct gz_canvas *canvas = placing->canvas;
	return canvas->height - canvas->bottom -
	       share(&placing->plot->y, y) * (canvas->height - canvas->top - canvas->bottom);
}

static double x_at_px(const struct placing *placing, double px)
{
	const struct gz_canvas *canvas = placing->canvas;
	return axis_value_at(&placing->plot->x,
			     (px - canvas->left) / (canvas->width - canvas->left - canvas->right));
}

static double y_at_px(const struct placing *placing, double px)
{
	const struct gz_canvas *canvas = placing->canvas;
	return axis_value_at(&placing->plot->y,
			     (canvas->height - canvas->bottom - px) /
				     (canvas->height - canvas->top - canvas->bottom));
}

/* Characters, not bytes, of UTF-8. */
static double characters(const char *text)
{
	double count = 0;
	for (; *text; text++)
		count += ((unsigned char)*text & 0xc0) != 0x80;
	return count;
}

static void avoid_curves(struct placing *placing)
{
	for (size_t i = 0; i < placing->plot->curve_count; i++) {
		const struct gz_plot_curve *curve = &placing->plot->curves[i];
		for (size_t k = 0; k < curve->point_count; k++) {
			const double x = x_px(placing, curve->points[k].x);
			const double y = y_px(placing, curve->points[k].y);
			gz_labels_avoid(&placing->field,
					(struct gz_box) { x - 7, y - 7, x + 7, y + 7 },
					GZ_LABEL_ON_POINT);
			if (k > 0)
				gz_labels_avoid_line(&placing->field,
						     x_px(placing, curve->points[k - 1].x),
						     y_px(placing, curve->points[k - 1].y), x, y);
		}
	}
	if (placing->plot->bound > 0) { /* the text on the line too */
		const double x = x_px(placing, placing->plot->bound);
		const double side = share(&placing->plot->x, placing->plot->bound) < 0.5 ? 1 : -1;
		const double text = side * 1.6 * placing->canvas->font_px;
		gz_labels_avoid(&placing->field,
				(struct gz_box) { fmin(x, x + text), placing->canvas->top,
						  fmax(x, x + text), placing->canvas->height },
				GZ_LABEL_ON_POINT);
	}
}

/* A label that a narrow canvas has room for on one side of a point: cut, with an ellipsis. */
static const char *fit_label(const char *text, const struct gz_canvas *canvas,
			     char cut[GZ_PLOT_LABEL_SIZE])
{
	const size_t most = canvas->kind == GZ_CANVAS_NARROW ? 26 : 40;
	if (strlen(text) <= most)
		return text;
	size_t length = most - 1;
	while (length > 0 && ((unsigned char)text[length] & 0xc0) == 0x80)
		length--;
	snprintf(cut, GZ_PLOT_LABEL_SIZE, "%.*s…", (int)length, text);
	return cut;
}

/* A text at a point of a curve. */
struct point_label {
	const struct gz_plot_curve *curve;
	const struct gz_plot_point *point;
	const char *text;
	double font_px;
	bool must; /* it is placed whatever it lies on */
};

static void add_point_label(struct placing *placing, const struct point_label *label,
			    struct gz_text *table)
{
	char cut[GZ_PLOT_LABEL_SIZE];
	const char *text = fit_label(label->text, placing->canvas, cut);
	struct gz_label place = {
		.x = x_px(placing, label->point->x),
		.y = y_px(placing, label->point->y),
		.width = characters(text) * CHARACTER * label->font_px,
		.height = label->font_px * 1.1,
		.must = label->must,
	};
	if (!text[0] || !gz_labels_place(&placing->field, &place))
		return;
	gz_text_add(table, "%.9g\t%.9g\t%u\t%d\t", x_at_px(placing, place.anchor_x),
		    y_at_px(placing, place.anchor_y), (unsigned)label->curve->colour, place.side);
	gz_chart_add_cell(table, text);
	gz_text_add(table, "\n");
}

/* Names first, each at the last point of its curve; then as many labels as have room. */
static void add_labels(struct placing *placing, struct gz_text *table)
{
	const double font_px = placing->canvas->font_px;
	struct gz_text names = { 0 }, labels = { 0 };
	placing->field.area = (struct gz_box) { placing->canvas->left, placing->canvas->top,
						placing->canvas->width - 2,
						placing->canvas->height - placing->canvas->bottom };
	avoid_curves(placing);
	for (size_t i = 0; i < placing->plot->curve_count; i++) {
		const struct gz_plot_curve *curve = &placing->plot->curves[i];
		if (curve->point_count > 0) {
			const struct point_label name = {
				curve, &curve->points[curve->point_count - 1], curve->name, font_px,
				true,
			};
			add_point_label(placing, &name, &names);
		}
	}
	for (size_t i = 0; i < placing->plot->curve_count; i++)
		for (size_t k = 0; k < placing->plot->curves[i].point_count; k++) {
			const struct gz_plot_curve *curve = &placing->plot->curves[i];
			const struct point_label label = { curve, &curve->points[k],
							   curve->points[k].label, 0.84 * font_px,
							   false };
			add_point_label(placing, &label, &labels);
		}
	gz_text_add(table, NOWHERE "%s\n\n" NOWHERE "%s", labels.bytes ? labels.bytes : "",
		    names.bytes ? names.bytes : "");
	table->failed |= labels.failed || names.failed;
	gz_text_free(&labels);
	gz_text_free(&names);
	gz_labels_free(&placing->field);
}

static int compare_x(const void *a, const void *b)
{
	const struct gz_plot_point *const *p = a, *const *q = b;
	return ((*p)->x > (*q)->x) - ((*p)->x < (*q)->x);
}

static void add_front(const struct gz_plot *plot, struct gz_text *table)
{
	size_t count = 0, all = 0;
	for (size_t i = 0; i < plot->curve_count; i++)
		all += plot->curves[i].point_count;
	const struct gz_plot_point **marked = calloc(all + 1, sizeof(void *));
	table->failed |= !marked;
	for (size_t i = 0; marked && plot->join_marked && i < plot->curve_count; i++)
		for (size_t k = 0; k < plot->curves[i].point_count; k++)
			if (plot->curves[i].points[k].marked)
				marked[count++] = &plot->curves[i].points[k];
	if (count > 0)
		qsort(marked, count, sizeof(void *), compare_x);
	else
		gz_text_add(table, NOWHERE);
	for (size_t i = 0; i < count; i++)
		gz_text_add(table, "%.9g\t%.9g\n", marked[i]->x, marked[i]->y);
	free(marked);
}

/* Points of all curves, or those with a ring; an empty line ends a curve. */
static void add_plot_points(const struct gz_plot *plot, bool only_marked, struct gz_text *table)
{
	gz_text_add(table, NOWHERE);
	for (size_t i = 0; i < plot->curve_count; i++) {
		const struct gz_plot_curve *curve = &plot->curves[i];
		gz_text_add(table, curve->point_count > 0 ? "\n" : "");
		for (size_t k = 0; k < curve->point_count; k++)
			if (!only_marked || curve->points[k].marked)
				gz_text_add(table, "%.9g\t%.9g\t%u\t%d\n", curve->points[k].x,
					    curve->points[k].y, (unsigned)curve->colour,
					    curve->point_type);
			else
				gz_text_add(table, NOWHERE);
	}
}

static double nice_step(double span, int steps)
{
	const double rough = fabs(span) / steps, power = pow(10, floor(log10(rough)));
	const double digit = rough / power;
	return power * (digit <= 1 ? 1 : digit <= 2 ? 2 : digit <= 5 ? 5 : 10);
}

/* Room on the left for the widest number of an even axis, as 0.9975; a digit is 0.62 em wide. */
static int left_px(const struct gz_plot *plot, const struct gz_canvas *canvas)
{
	if (plot->y.logarithmic)
		return canvas->left;
	const double step = nice_step(plot->y.last - plot->y.first, 6);
	const double greatest = fmax(fabs(plot->y.first), fabs(plot->y.last));
	const int before = greatest >= 10 ? 1 + (int)floor(log10(greatest)) : 1;
	const int behind = step < 1 ? 1 + (int)ceil(-log10(step) - 1e-9) : 0;
	const int wanted = (int)((before + behind + 1.6) * canvas->font_px * 0.62);
	return wanted > canvas->left ? wanted : canvas->left;
}

/* What a reader must know of an axis that is not even, or runs the other way. */
static const char *axis_remark(const struct gz_plot_axis *axis)
{
	if (axis->logarithmic)
		return axis->falls ? ", logarithmic, reversed" : ", logarithmic";
	return axis->falls ? ", reversed" : "";
}

static void set_axis_text(struct gz_text *settings, const char *name, const char *title,
			  const struct gz_plot_axis *axis)
{
	char text[3 * GZ_PLOT_LABEL_SIZE];
	snprintf(text, sizeof text, "%s%s", title, axis_remark(axis));
	gz_chart_set_text(settings, name, text);
}

static void add_plot_settings(const struct gz_plot *plot, const struct gz_canvas *canvas,
			      struct gz_text *settings)
{
	set_axis_text(settings, "title_text", plot->title, &plot->y);
	set_axis_text(settings, "x_title", plot->x.title, &plot->x);
	gz_chart_set_text(settings, "bound_text", plot->bound_text);
	const double span = plot->y.logarithmic ? 1 : plot->y.last - plot->y.first;
	gz_text_add(settings,
		    "x_first = %.9g\nx_last = %.9g\ny_first = %.9g\ny_last = %.9g\n"
		    "x_logarithmic = %d\ny_logarithmic = %d\nx_decades = %.9g\ny_decades = %.9g\n"
		    "y_step = %.9g\nbound = %.9g\nbound_left = %d\n",
		    plot->x.first, plot->x.last, plot->y.first, plot->y.last, plot->x.logarithmic,
		    plot->y.logarithmic,
		    plot->x.logarithmic ? fabs(log10(plot->x.last / plot->x.first)) *
						  (canvas->kind == GZ_CANVAS_NARROW ? 1.3 : 1)
					: 0,
		    plot->y.logarithmic ? fabs(log10(plot->y.last / plot->y.first)) : 0,
		    nice_step(span, 6), plot->bound > 0 ? plot->bound : 0,
		    plot->bound > 0 && share(&plot->x, plot->bound) < 0.5);
}

static enum gz_result draw_plot_on(struct gz_charts *charts, const char *name,
				   enum gz_canvas_kind kind, const struct gz_plot *plot)
{
	struct gz_canvas canvas = gz_canvas_of(kind);
	canvas.left = left_px(plot, &canvas);
	struct gz_text settings = { 0 }, table = { 0 };
	struct placing placing = { .plot = plot, .canvas = &canvas };
	add_plot_settings(plot, &canvas, &settings);
	add_front(plot, &table);
	gz_text_add(&table, "\n\n");
	add_plot_points(plot, false, &table); /* as lines */
	gz_text_add(&table, "\n\n");
	add_plot_points(plot, false, &table);
	gz_text_add(&table, "\n\n");
	add_plot_points(plot, true, &table);
	gz_text_add(&table, "\n\n");
	add_labels(&placing, &table);
	const enum gz_result result =
		gz_charts_draw(charts, "curves.gp", name, &canvas, &settings, &table);
	gz_text_free(&settings);
	gz_text_free(&table);
	return result;
}

enum gz_result gz_plot_draw(struct gz_charts *charts, const char *name, struct gz_plot *plot)
{
	enum gz_result result = GZ_OK;
	if (!charts->available)
		return GZ_OK;
	keep_points_that_fit(plot);
	if (!fit_axes(plot))
		return GZ_OK;
	for (int kind = 0; kind < GZ_CANVAS_KINDS && result == GZ_OK; kind++)
		result = draw_plot_on(charts, name, kind, plot);
	return result;
}

/* ---- labels ---- */

/* From a point to the nearest edge of its label, px. Chosen: clear of a point's ring. */
#define GAP 12.0

/* A line is kept clear by boxes of this many pixels. */
#define LINE_STEP 6.0

void gz_labels_avoid(struct gz_label_field *field, struct gz_box box, double weight)
{
	if (field->count == field->room) {
		const size_t room = field->room * 2 + 64;
		struct gz_box *taken = realloc(field->taken, room * sizeof taken[0]);
		if (!taken)
			return;
		field->taken = taken;
		double *weights = realloc(field->weights, room * sizeof weights[0]);
		if (!weights)
			return;
		field->weights = weights;
		field->room = room;
	}
	field->taken[field->count] = box;
	field->weights[field->count++] = weight;
}

void gz_labels_avoid_line(struct gz_label_field *field, double x0, double y0, double x1, double y1)
{
	const int steps = (int)fmin(hypot(x1 - x0, y1 - y0) / LINE_STEP, 1000) + 1;
	for (int i = 0; i <= steps; i++) {
		const double x = x0 + (x1 - x0) * i / steps, y = y0 + (y1 - y0) * i / steps;
		gz_labels_avoid(field, (struct gz_box) { x - 1, y - 1, x + 1, y + 1 },
				GZ_LABEL_ON_LINE);
	}
}

static bool overlap(struct gz_box a, struct gz_box b)
{
	return a.left < b.right && b.left < a.right && a.top < b.bottom && b.top < a.bottom;
}

static double cost_of(const struct gz_label_field *field, struct gz_box box)
{
	double cost = 0;
	if (box.left < field->area.left || box.right > field->area.right ||
	    box.top < field->area.top || box.bottom > field->area.bottom)
		cost += 50 * GZ_LABEL_ON_LABEL;
	for (size_t i = 0; i < field->count; i++)
		if (overlap(box, field->taken[i]))
			cost += field->weights[i];
	return cost;
}

bool gz_labels_place(struct gz_label_field *field, struct gz_label *label)
{
	/* Right, above, left, below, then the diagonals, then the same farther out. */
	static const double directions[][2] = { { 1, 0 },  { 0, -1 },  { -1, 0 }, { 0, 1 },
						{ 1, -1 }, { -1, -1 }, { 1, 1 },  { -1, 1 } };
	const double half_width = label->width / 2, half_height = label->height / 2;
	double best = INFINITY;
	struct gz_box box = { 0, 0, 0, 0 };
	int side = 0;
	for (int ring = 0; ring < 3; ring++)
		for (size_t i = 0; i < sizeof directions / sizeof directions[0]; i++) {
			const double far = GAP * (1 + 0.8 * ring);
			const double cx = label->x + directions[i][0] * (far + half_width);
			const double cy = label->y + directions[i][1] * (far * 0.7 + half_height);
			const struct gz_box here = { cx - half_width, cy - half_height,
						     cx + half_width, cy + half_height };
			/* A little for each step away from the first choice. */
			const double cost = cost_of(field, here) + 0.1 * (double)i + 1.5 * ring;
			if (cost < best) {
				best = cost;
				box = here;
				side = (int)directions[i][0];
			}
		}
	if (!label->must && best >= GZ_LABEL_ON_LABEL)
		return false;
	gz_labels_avoid(field, box, GZ_LABEL_ON_LABEL);
	label->anchor_x = side > 0 ? box.left : side < 0 ? box.right : (box.left + box.right) / 2;
	label->anchor_y = (box.top + box.bottom) / 2;
	label->side = side;
	return true;
}

void gz_labels_free(struct gz_label_field *field)
{
	free(field->taken);
	free(field->weights);
	*field = (struct gz_label_field) { 0 };
}
