#include "render/surface/gl/raster_view.h"

#include <math.h>

#include "base/vector.h"

/* Texels around the box that stay free, so that filters read no texel twice. */
enum { SHADOW_RIM = 3 };

static void corner_of(const struct gz_raster_box *box, int number, double out[3])
{
	for (int axis = 0; axis < 3; axis++)
		out[axis] = number >> axis & 1 ? box->greatest[axis] : box->least[axis];
}

/* A range of numbers. */
struct span {
	double least, greatest;
};

static struct span widen_span(struct span span, double number)
{
	return (struct span) { fmin(span.least, number), fmax(span.greatest, number) };
}

static struct span find_depths(const struct gz_ray_inverse *inverse,
			       const struct gz_raster_box *box, double world_mm)
{
	struct span span = { INFINITY, -INFINITY };
	for (int i = 0; i < 8; i++) {
		double place[3], at[4];
		corner_of(box, i, place);
		for (int axis = 0; axis < 3; axis++)
			place[axis] /= world_mm;
		gz_ray_inverse_point(inverse, place, at);
		span = widen_span(span, at[3]);
	}
	return span;
}

/* OpenGL's clip coordinate z, as factors of depth and of 1: -1 at the nearest depth and 1 at the
 * farthest, after the division by w. */
static void depth_factors(const struct gz_ray_inverse *inverse, struct span depths,
			  double *of_depth, double *of_one)
{
	const double range = depths.greatest - depths.least;
	const double sum = depths.greatest + depths.least;
	*of_depth = (inverse->orthographic ? 2 : sum) / range;
	*of_one = (inverse->orthographic ? -sum : -2 * depths.greatest * depths.least) / range;
}

bool gz_raster_view_make(const struct gz_ray_frame *rays, double world_mm,
			 const struct gz_raster_box *box, struct gz_raster_view *out_view)
{
	struct gz_ray_inverse inverse;
	double of_depth, of_one;
	for (int axis = 0; axis < 3; axis++)
		if (!(box->least[axis] <= box->greatest[axis]))
			return false;
	if (!gz_ray_inverse_make(rays, &inverse))
		return false;
	struct span depths = find_depths(&inverse, box, world_mm);
	if (!(depths.greatest > 0))
		return false;
	/* a little more, since a flat mesh has no depth of its own */
	const double margin = 1e-3 * depths.greatest;
	depths.greatest += margin;
	depths.least = fmax(depths.least - margin,
			    inverse.orthographic ? 0 : GZ_RASTER_NEAREST * depths.greatest);
	depth_factors(&inverse, depths, &of_depth, &of_one);
	for (int column = 0; column < 4; column++) {
		/* the image of a unit vector, or of the origin; both are linear */
		double unit[3] = { 0, 0, 0 }, at[4], zero[4];
		gz_ray_inverse_point(&inverse, unit, zero);
		if (column < 3)
			unit[column] = 1 / world_mm;
		gz_ray_inverse_point(&inverse, unit, at);
		for (int i = 0; i < 4 && column < 3; i++)
			at[i] -= zero[i];
		const double one = column == 3;
		out_view->rows[0][column] = (float)at[0];
		out_view->rows[1][column] = (float)at[1];
		out_view->rows[2][column] = (float)(of_depth * at[3] + of_one * one);
		out_view->rows[3][column] = (float)at[2];
	}
	return true;
}

/* Sides of a rectangle of the picture, and of its depths. */
enum { SIDES = 6 };

/* How far a place lies within each side, times w: what is negative lies outside. */
static void find_insides(const struct gz_raster_view *view, const double place[3],
			 const double from[2], const double to[2], double out_insides[SIDES])
{
	double at[4];
	for (int row = 0; row < 4; row++)
		at[row] = (double)view->rows[row][0] * place[0] +
			  (double)view->rows[row][1] * place[1] +
			  (double)view->rows[row][2] * place[2] + (double)view->rows[row][3];
	for (int axis = 0; axis < 2; axis++) {
		out_insides[2 * axis] = at[axis] - from[axis] * at[3];
		out_insides[2 * axis + 1] = to[axis] * at[3] - at[axis];
	}
	out_insides[4] = at[2] + at[3];
	out_insides[5] = at[3] - at[2];
}

bool gz_raster_view_shows(const struct gz_raster_view *view, const struct gz_raster_box *box,
			  const double from[2], const double to[2])
{
	bool is_beyond[SIDES] = { true, true, true, true, true, true };
	for (int i = 0; i < 8; i++) {
		double place[3], insides[SIDES];
		corner_of(box, i, place);
		find_insides(view, place, from, to, insides);
		for (int side = 0; side < SIDES; side++)
			is_beyond[side] = is_beyond[side] && insides[side] < 0;
	}
	bool shows = true;
	for (int side = 0; side < SIDES; side++)
		shows = shows && !is_beyond[side];
	return shows;
}

bool gz_raster_view_holds(const struct gz_raster_view *view, const struct gz_raster_box *box,
			  const double from[2], const double to[2])
{
	bool holds = true;
	for (int i = 0; i < 8; i++) {
		double place[3], insides[SIDES];
		corner_of(box, i, place);
		find_insides(view, place, from, to, insides);
		for (int side = 0; side < SIDES; side++)
			holds = holds && insides[side] > 0;
	}
	return holds;
}

struct gz_raster_shadow gz_raster_shadow_make(const float towards[3],
					      const struct gz_raster_box *box, int edge)
{
	struct gz_raster_shadow shadow = { 0 };
	const double light[3] = { towards[0], towards[1], towards[2] };
	double axes[3][3] = { { 0 } };
	double *across = axes[0], *along = axes[1], *away = axes[2];
	/* any axis that the light is not parallel to */
	across[fabs(light[0]) < 0.6 ? 0 : 1] = 1;
	gz_cross3(light, across, along);
	(void)gz_normalise3(along);
	gz_cross3(along, light, across);
	for (int axis = 0; axis < 3; axis++)
		away[axis] = -light[axis];
	for (int row = 0; row < 3; row++) {
		struct span span = { INFINITY, -INFINITY };
		for (int i = 0; i < 8; i++) {
			double place[3];
			corner_of(box, i, place);
			span = widen_span(span, gz_dot3(axes[row], place));
		}
		const double length = fmax(span.greatest - span.least, 1e-6);
		const double rim =
			row < 2 ? length * SHADOW_RIM / (edge - 2 * SHADOW_RIM) : length * 1e-3;
		const double whole = length + 2 * rim;
		for (int axis = 0; axis < 3; axis++)
			shadow.rows[row][axis] = (float)(axes[row][axis] / whole);
		shadow.rows[row][3] = (float)((rim - span.least) / whole);
		if (row < 2)
			shadow.texel_mm = fmaxf(shadow.texel_mm, (float)(whole / edge));
		else
			shadow.depth_mm = (float)whole;
	}
	return shadow;
}
