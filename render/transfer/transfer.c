#include "render/transfer/transfer.h"

#include <math.h>
#include <string.h>

/* The last point at or below value, or count where there is none. */
static size_t point_before(const struct gz_transfer *transfer, double value)
{
	size_t low = 0, high = transfer->count; /* points[0, low) are at or below value */
	while (low < high) {
		size_t middle = low + (high - low) / 2;
		if (transfer->points[middle].value <= value)
			low = middle + 1;
		else
			high = middle;
	}
	return low > 0 ? low - 1 : transfer->count;
}

/* Quadratic: two parabolas, flat at both ends, that meet in the middle with the same slope. */
static double eased_weight(enum gz_transfer_interpolation interpolation, double t)
{
	if (interpolation == GZ_TRANSFER_LINEAR)
		return t;
	return t < 0.5 ? 2 * t * t : 1 - 2 * (1 - t) * (1 - t);
}

static void point_rgba(const struct gz_transfer_point *point, double out_rgba[4])
{
	for (int i = 0; i < 3; i++)
		out_rgba[i] = point->rgb[i];
	out_rgba[3] = point->opacity;
}

/* Colour and opacity without emphasis. */
static void evaluate_points(const struct gz_transfer *transfer, double value, double out_rgba[4])
{
	size_t before = point_before(transfer, value);
	if (before == transfer->count) { /* below the first point, or NaN */
		point_rgba(&transfer->points[0], out_rgba);
		return;
	}
	const struct gz_transfer_point *a = &transfer->points[before];
	point_rgba(a, out_rgba);
	if (before + 1 == transfer->count)
		return;
	const struct gz_transfer_point *b = a + 1;
	double weight =
		eased_weight(transfer->interpolation, (value - a->value) / (b->value - a->value));
	for (int i = 0; i < 3; i++)
		out_rgba[i] += weight * (b->rgb[i] - a->rgb[i]);
	out_rgba[3] += weight * (b->opacity - a->opacity);
}

void gz_transfer_evaluate(const struct gz_transfer *transfer, double value, double out_rgba[4])
{
	evaluate_points(transfer, value, out_rgba);
	if (transfer->emphasis.share > 0)
		out_rgba[3] = gz_transfer_emphasised(&transfer->emphasis, value, out_rgba[3]);
}

double gz_transfer_opacity_over(double opacity, double length)
{
	return 1 - pow(1 - opacity, length);
}

bool gz_transfer_point_same(const struct gz_transfer_point *a, const struct gz_transfer_point *b)
{
	return a->value == b->value && a->opacity == b->opacity && a->rgb[0] == b->rgb[0] &&
	       a->rgb[1] == b->rgb[1] && a->rgb[2] == b->rgb[2];
}

bool gz_transfer_same(const struct gz_transfer *a, const struct gz_transfer *b)
{
	if (a->count != b->count || a->interpolation != b->interpolation ||
	    a->has_range != b->has_range)
		return false;
	if (a->has_range && (a->range[0] != b->range[0] || a->range[1] != b->range[1]))
		return false;
	for (size_t i = 0; i < a->count; i++)
		if (!gz_transfer_point_same(&a->points[i], &b->points[i]))
			return false;
	return gz_transfer_emphasis_same(&a->emphasis, &b->emphasis);
}

static double opacity_of(const struct gz_transfer *transfer, double value)
{
	double rgba[4];
	gz_transfer_evaluate(transfer, value, rgba);
	return rgba[3];
}

bool gz_transfer_shows(const struct gz_transfer *transfer, double least, double greatest)
{
	double range[2] = { least, greatest };
	if (transfer->has_range)
		memcpy(range, transfer->range, sizeof range);
	const double width = fmax(range[1] - range[0], 1e-300);
	const double begin = (least - range[0]) / width, end = (greatest - range[0]) / width;
	bool shows = opacity_of(transfer, begin) > 0 || opacity_of(transfer, end) > 0;
	for (size_t i = 0; i < transfer->count && !shows; i++) {
		const struct gz_transfer_point *point = &transfer->points[i];
		shows = point->opacity > 0 && point->value >= begin && point->value <= end;
	}
	return shows;
}
