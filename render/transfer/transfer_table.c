#include "render/transfer/transfer_table.h"

#include <math.h>

/* A peak of fewer entries than the first may fall between two of them; a finer table then gives it
 * the second. Chosen: a peak of 1.5 entries has at least a third of its height somewhere, one of 4
 * three quarters. */
#define PEAK_LEAST  1.5
#define PEAK_WANTED 4.0

/* Rounding errors of interpolation and look-up, as a share of the values: eight roundings. */
#define ROUNDING 0x1p-21

_Static_assert(GZ_TRANSFER_TABLE_MOST % GZ_TRANSFER_TABLE_SIZE == 0, "sizes are powers of two");

static uint32_t pack_double_colour(const double rgba[4])
{
	const uint32_t red = (uint32_t)lround(rgba[0] * 2047);
	const uint32_t green = (uint32_t)lround(rgba[1] * 2047);
	const uint32_t blue = (uint32_t)lround(rgba[2] * 1023);
	return red << 21 | green << 10 | blue;
}

/* The least span of stored values that single precision can divide, as a share of the values at its
 * ends and of the greatest value in the volume: below the first, neighbouring floats lie farther
 * apart; below the second (chosen), the number of entries times a value may be infinite. */
#define SPAN_OF_ENDS 0x1p-24
#define SPAN_OF_DATA 0x1p-100

/* Widen a span within the data that single precision cannot divide. Returns whether it did. */
static bool widen_span(const struct gz_volume *volume, double *low, double *high)
{
	const double least = volume->stored_min, greatest = volume->stored_max;
	const double ends = fmax(fabs(*low), fabs(*high));
	const double data = fmax(fabs(least), fabs(greatest));
	const double width = fmax(ends * SPAN_OF_ENDS, data * SPAN_OF_DATA);
	if (*high - *low >= width || (*low == *high && (*low == least || *low == greatest)))
		return false;
	*high = fmin(*low + width, greatest);
	*low = fmax(*high - width, least);
	return true;
}

/* The stored values at the ends of the table: the overlap of the function's range and the data. If
 * they do not overlap, both ends are the data's end next to the range. Returns false if the table
 * is wider than the overlap because single precision cannot divide that. */
static bool table_span(const double range[2], const struct gz_volume *volume, double *out_low,
		       double *out_high)
{
	double low = (range[0] - volume->intercept) / volume->slope;
	double high = (range[1] - volume->intercept) / volume->slope;
	if (low > high) {
		const double swap = low;
		low = high;
		high = swap;
	}
	low = fmin(fmax(low, volume->stored_min), volume->stored_max);
	high = fmin(fmax(high, volume->stored_min), volume->stored_max);
	const bool widened = widen_span(volume, &low, &high);
	*out_low = low;
	*out_high = high;
	return !widened;
}

/* The data values that 0 and 1 of the function stand for. */
static void data_range_of_function(const struct gz_transfer *transfer,
				   const struct gz_volume *volume, double out_range[2])
{
	const double a = volume->slope * volume->stored_min + volume->intercept;
	const double b = volume->slope * volume->stored_max + volume->intercept;
	out_range[0] = transfer->has_range ? transfer->range[0] : volume->slope > 0 ? a : b;
	out_range[1] = transfer->has_range ? transfer->range[1] : volume->slope > 0 ? b : a;
}

bool gz_transfer_range_divides(const struct gz_transfer *transfer, const struct gz_volume *volume)
{
	double range[2], low, high;
	data_range_of_function(transfer, volume, range);
	return table_span(range, volume, &low, &high);
}

static double point_channel(const struct gz_transfer_point *point, int channel)
{
	return channel < 3 ? point->rgb[channel] : point->opacity;
}

/* Whether anything shows between two points. */
static bool stretch_shows(const struct gz_transfer *transfer, size_t from, size_t to)
{
	for (size_t i = from; i <= to; i++)
		if (transfer->points[i].opacity > 0)
			return true;
	return false;
}

/* The narrowest peak or gap of a channel that lies at least partly within [low, high] of the
 * function's values: from the point before to the point after. INFINITY if there is none. */
static double narrowest_peak(const struct gz_transfer *transfer, int channel, double low,
			     double high)
{
	const struct gz_transfer_point *points = transfer->points;
	double narrowest = INFINITY;
	for (size_t first = 1, last; first + 1 < transfer->count; first = last + 1) {
		const double level = point_channel(&points[first], channel);
		for (last = first; last + 1 < transfer->count &&
				   point_channel(&points[last + 1], channel) == level;)
			last++;
		if (last + 1 == transfer->count)
			break;
		const double before = point_channel(&points[first - 1], channel) - level;
		const double after = point_channel(&points[last + 1], channel) - level;
		const double from = points[first - 1].value, to = points[last + 1].value;
		/* Of three points of one value the middle one is never seen. */
		if (before * after > 0 && to > from && to >= low && from <= high &&
		    stretch_shows(transfer, first - 1, last + 1))
			narrowest = fmin(narrowest, to - from);
	}
	return narrowest;
}

/* How many entries a table from low to high needs, in values of the function. */
static int count_entries(const struct gz_transfer *transfer, double low, double high)
{
	double narrowest = INFINITY;
	for (int channel = 0; channel < 4; channel++)
		narrowest = fmin(narrowest, narrowest_peak(transfer, channel, low, high));
	const struct gz_transfer_emphasis *emphasis = &transfer->emphasis;
	if (emphasis->share > 0)
		narrowest = fmin(narrowest, emphasis->greatest - emphasis->least);
	const double share = high > low ? narrowest / (high - low) : 1;
	int count = GZ_TRANSFER_TABLE_SIZE;
	if (share * (count - 1) >= PEAK_LEAST)
		return count;
	while (count < GZ_TRANSFER_TABLE_MOST && share * (count - 1) < PEAK_WANTED)
		count *= 2;
	return count;
}

void gz_transfer_table_bake(const struct gz_transfer *transfer, const struct gz_volume *volume,
			    struct gz_transfer_table *out_table)
{
	double range[2], low, high;
	data_range_of_function(transfer, volume, range);
	const bool divides = table_span(range, volume, &low, &high);

	out_table->value_per_stored =
		range[1] != range[0] ? volume->slope / (range[1] - range[0]) : 0;
	if (!divides)
		out_table->value_per_stored = copysign(1 / (high - low), volume->slope);
	const double width = range[1] - range[0];
	const double ends[2] = { (volume->slope * low + volume->intercept - range[0]) / width,
				 (volume->slope * high + volume->intercept - range[0]) / width };
	out_table->count =
		width != 0 ? count_entries(transfer, fmin(ends[0], ends[1]), fmax(ends[0], ends[1]))
			   : GZ_TRANSFER_TABLE_SIZE;
	const int last = out_table->count - 1;
	out_table->scale = high > low ? last / (high - low) : 0;
	out_table->bias = -low * out_table->scale;
	out_table->rounding = out_table->count > GZ_TRANSFER_TABLE_SIZE
				      ? ROUNDING * fmax(fabs(low), fabs(high)) * out_table->scale
				      : 0;
	out_table->visible_before[0] = 0;
	for (int i = 0; i <= last; i++) {
		const double stored = low + i * (high - low) / last;
		const double value = volume->slope * stored + volume->intercept;
		double rgba[4];
		gz_transfer_evaluate(transfer, width != 0 ? (value - range[0]) / width : 0, rgba);
		out_table->entries[i].extinction = (float)log2(1 - rgba[3]);
		out_table->entries[i].colour = pack_double_colour(rgba);
		out_table->visible_before[i + 1] = out_table->visible_before[i] + (rgba[3] > 0);
	}
}

void gz_transfer_table_step(const struct gz_transfer_table *table, double length,
			    struct gz_transfer_entry *out_entries)
{
	for (int i = 0; i < table->count; i++) {
		const double extinction = (double)table->entries[i].extinction;
		out_entries[i] = (struct gz_transfer_entry) {
			.opacity = extinction < 0 ? (float)-expm1(length * extinction * M_LN2) : 0,
			.colour = table->entries[i].colour,
		};
	}
}

static int entry_at_or_below(const struct gz_transfer_table *table, double stored, double rounding)
{
	const double entry = floor(stored * table->scale + table->bias + rounding);
	const int last = table->count - 1;
	return entry < 0 ? 0 : entry > last ? last : (int)entry;
}

int gz_transfer_table_nearest(const struct gz_transfer_table *table, float stored)
{
	const float last = (float)(table->count - 1);
	const float entry = stored * (float)table->scale + (float)table->bias + 0.5F;
	return entry > 0 ? (int)(entry < last ? entry : last) : 0;
}

bool gz_transfer_table_shows(const struct gz_transfer_table *table, double least, double greatest)
{
	/* One entry wider than rounding needs, because kernels compute in single precision. */
	const int from = entry_at_or_below(table, least, -0.5 - table->rounding);
	const int to = entry_at_or_below(table, greatest, 1.5 + table->rounding);
	return table->visible_before[to + 1] > table->visible_before[from];
}
