#include "bench/report/labels.h"

#include <math.h>
#include <stdlib.h>

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

bool gz_labels_place(struct gz_label_field *field, double x, double y, double width, double height,
		     bool must, double *out_x, double *out_y, int *out_side)
{
	/* Right, above, left, below, then the diagonals, then the same farther out. */
	static const double directions[][2] = { { 1, 0 },  { 0, -1 },  { -1, 0 }, { 0, 1 },
						{ 1, -1 }, { -1, -1 }, { 1, 1 },  { -1, 1 } };
	double best = INFINITY;
	struct gz_box box = { 0, 0, 0, 0 };
	int side = 0;
	for (int ring = 0; ring < 3; ring++)
		for (size_t i = 0; i < sizeof directions / sizeof directions[0]; i++) {
			const double far = GAP * (1 + 0.8 * ring);
			const double cx = x + directions[i][0] * (far + width / 2);
			const double cy = y + directions[i][1] * (far * 0.7 + height / 2);
			const struct gz_box here = { cx - width / 2, cy - height / 2,
						     cx + width / 2, cy + height / 2 };
			/* A little for each step away from the first choice. */
			const double cost = cost_of(field, here) + 0.1 * (double)i + 1.5 * ring;
			if (cost < best) {
				best = cost;
				box = here;
				side = (int)directions[i][0];
			}
		}
	if (!must && best >= GZ_LABEL_ON_LABEL)
		return false;
	gz_labels_avoid(field, box, GZ_LABEL_ON_LABEL);
	*out_x = side > 0 ? box.left : side < 0 ? box.right : (box.left + box.right) / 2;
	*out_side = side;
	*out_y = (box.top + box.bottom) / 2;
	return true;
}

void gz_labels_free(struct gz_label_field *field)
{
	free(field->taken);
	free(field->weights);
	*field = (struct gz_label_field) { 0 };
}
