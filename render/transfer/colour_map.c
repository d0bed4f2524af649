#include "render/transfer/colour_map.h"

#include <math.h>
#include <stdbool.h>

/* Colours at equal distances, 0 to 255. Chosen: with 17 the straight lines between them are nowhere
 * more than 7 of 255 from the maps of 256 colours. */
enum { KNOTS = 17 };

/* Straight lines that stand for the curve between two points. Chosen: they are nowhere farther from
 * it than .012 of what the opacity rises or falls there. */
enum { LINES_OF_CURVE = 8 };

/* By S. van der Walt, N. Smith and E. Firing, https://bids.github.io/colormap/ (CC0), and cividis
 * by J. R. Nunez, C. R. Anderton and R. S. Renslow, Optimizing colormaps with consideration for
 * color vision deficiency, PLOS ONE 13(7), 2018. */
static const unsigned char maps[GZ_COLOUR_MAP_COUNT][KNOTS][3] = {
	[GZ_COLOUR_MAP_VIRIDIS] = { { 68, 1, 84 },
				    { 72, 24, 106 },
				    { 71, 45, 123 },
				    { 66, 64, 134 },
				    { 59, 82, 139 },
				    { 51, 99, 141 },
				    { 44, 114, 142 },
				    { 38, 129, 142 },
				    { 33, 144, 140 },
				    { 31, 159, 136 },
				    { 40, 174, 128 },
				    { 62, 188, 116 },
				    { 93, 201, 99 },
				    { 130, 211, 76 },
				    { 171, 220, 50 },
				    { 213, 226, 26 },
				    { 253, 231, 37 } },
	[GZ_COLOUR_MAP_MAGMA] = { { 0, 0, 4 },
				  { 10, 8, 34 },
				  { 29, 17, 70 },
				  { 54, 16, 106 },
				  { 80, 18, 124 },
				  { 105, 28, 129 },
				  { 130, 38, 129 },
				  { 156, 46, 127 },
				  { 182, 55, 121 },
				  { 207, 65, 112 },
				  { 230, 81, 99 },
				  { 245, 105, 92 },
				  { 251, 135, 97 },
				  { 254, 165, 113 },
				  { 254, 195, 135 },
				  { 253, 224, 162 },
				  { 252, 253, 191 } },
	[GZ_COLOUR_MAP_INFERNO] = { { 0, 0, 4 },
				    { 11, 7, 36 },
				    { 33, 12, 74 },
				    { 60, 9, 101 },
				    { 87, 16, 109 },
				    { 112, 25, 110 },
				    { 137, 34, 106 },
				    { 163, 43, 97 },
				    { 187, 55, 85 },
				    { 209, 70, 68 },
				    { 227, 89, 50 },
				    { 241, 113, 30 },
				    { 249, 141, 10 },
				    { 252, 171, 15 },
				    { 249, 202, 50 },
				    { 242, 232, 101 },
				    { 252, 255, 164 } },
	[GZ_COLOUR_MAP_PLASMA] = { { 13, 8, 135 },
				   { 49, 5, 150 },
				   { 76, 2, 161 },
				   { 102, 0, 167 },
				   { 126, 3, 168 },
				   { 149, 17, 162 },
				   { 169, 35, 150 },
				   { 187, 53, 135 },
				   { 203, 71, 120 },
				   { 217, 89, 106 },
				   { 230, 108, 92 },
				   { 240, 127, 79 },
				   { 248, 148, 65 },
				   { 253, 171, 51 },
				   { 253, 195, 40 },
				   { 249, 221, 37 },
				   { 240, 249, 33 } },
	[GZ_COLOUR_MAP_CIVIDIS] = { { 0, 32, 77 },
				    { 0, 44, 104 },
				    { 5, 54, 110 },
				    { 44, 66, 108 },
				    { 65, 77, 107 },
				    { 82, 89, 108 },
				    { 97, 100, 111 },
				    { 111, 112, 115 },
				    { 124, 123, 120 },
				    { 140, 136, 121 },
				    { 156, 148, 119 },
				    { 172, 161, 116 },
				    { 189, 175, 111 },
				    { 206, 189, 104 },
				    { 224, 203, 94 },
				    { 242, 218, 80 },
				    { 255, 234, 70 } },
};

const char *const gz_colour_map_names[] = {
	"viridis", "magma", "inferno", "plasma", "cividis", NULL
};

void gz_colour_map_at(enum gz_colour_map map, double value, double out_rgb[3])
{
	const double at = fmin(fmax(value, 0), 1) * (KNOTS - 1);
	const int knot = at < KNOTS - 1 ? (int)at : KNOTS - 2;
	const double share = at - knot;
	for (int i = 0; i < 3; i++)
		out_rgb[i] =
			((1 - share) * maps[map][knot][i] + share * maps[map][knot + 1][i]) / 255;
}

/* A function that is being made. */
struct colouring {
	enum gz_colour_map map;
	const struct gz_transfer *from;
	struct gz_transfer made;
};

static void add_coloured_point(struct colouring *colouring, double value, double opacity)
{
	struct gz_transfer *made = &colouring->made;
	if (made->count == GZ_TRANSFER_POINTS_MAX)
		return;
	struct gz_transfer_point *point = &made->points[made->count++];
	point->value = value;
	point->opacity = opacity;
	gz_colour_map_at(colouring->map, value, point->rgb);
}

/* The next multiple of @p step after @p at, both counted from @p begin. */
static double next_multiple(double begin, double step, double at)
{
	return begin + (floor((at - begin) / step + 1e-6) + 1) * step;
}

/* Points between two of the function's: at the map's own and, on a curve, at more. */
static void add_points_between(struct colouring *colouring, double begin, double end)
{
	const bool curved = colouring->from->interpolation != GZ_TRANSFER_LINEAR;
	double at = begin;
	while (at < end) {
		double rgba[4];
		const double knot = next_multiple(0, 1.0 / (KNOTS - 1), at);
		const double part = next_multiple(begin, (end - begin) / LINES_OF_CURVE, at);
		at = curved ? fmin(knot, part) : knot;
		if (at >= end - 1e-9)
			return;
		gz_transfer_evaluate(colouring->from, at, rgba);
		add_coloured_point(colouring, at, rgba[3]);
	}
}

void gz_transfer_colour(struct gz_transfer *transfer, enum gz_colour_map map)
{
	const struct gz_transfer_point *points = transfer->points;
	const size_t last = transfer->count - 1;
	struct colouring colouring = { .map = map, .from = transfer, .made = *transfer };
	colouring.made.count = 0;
	colouring.made.interpolation = GZ_TRANSFER_LINEAR;
	if (points[0].value > 0)
		add_coloured_point(&colouring, 0, points[0].opacity);
	add_points_between(&colouring, 0, points[0].value);
	for (size_t i = 0; i <= last; i++) {
		add_coloured_point(&colouring, points[i].value, points[i].opacity);
		add_points_between(&colouring, points[i].value, i < last ? points[i + 1].value : 1);
	}
	if (points[last].value < 1)
		add_coloured_point(&colouring, 1, points[last].opacity);
	*transfer = colouring.made;
}
