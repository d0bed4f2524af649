#include <math.h>

#include "render/plan/plan.h"

void gz_region_columns(const struct gz_region *region, int y, int width, int *out_from, int *out_to)
{
	double half = region->half_px[0];
	const double v = (y - region->centre_px[1]) / region->half_px[1];
	*out_from = 0;
	*out_to = width;
	if (region->shape == GZ_REGION_ALL)
		return;
	if (fabs(v) > 1) {
		*out_to = 0;
		return;
	}
	if (region->shape == GZ_REGION_ELLIPSE)
		half *= sqrt(1 - v * v);
	int from = (int)fmin(fmax(ceil(region->centre_px[0] - half), 0), width);
	int to = (int)fmin(fmax(floor(region->centre_px[0] + half) + 1, 0), width);
	/* The formula rounds in its own way: the region itself decides on the columns at its rim.
	 */
	while (from < to && !gz_region_holds(region, from, y))
		from++;
	while (from > 0 && gz_region_holds(region, from - 1, y))
		from--;
	while (to > from && !gz_region_holds(region, to - 1, y))
		to--;
	while (to < width && gz_region_holds(region, to, y))
		to++;
	*out_from = from;
	*out_to = to;
}
