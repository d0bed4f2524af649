#include "render/data/box_polygon.h"

#include <math.h>
#include <string.h>

/* Order corners by the angle at which their centre sees them. */
static void order_corners(double polygon[GZ_BOX_POLYGON_MAX][4], int count)
{
	double centre[2] = { 0, 0 }, angles[GZ_BOX_POLYGON_MAX];
	for (int i = 0; i < count; i++)
		for (int axis = 0; axis < 2; axis++)
			centre[axis] += polygon[i][axis] / count;
	for (int i = 0; i < count; i++) {
		double corner[4];
		const double angle = atan2(polygon[i][1] - centre[1], polygon[i][0] - centre[0]);
		int place = i;
		memcpy(corner, polygon[i], sizeof corner);
		for (; place > 0 && angles[place - 1] > angle; place--) {
			angles[place] = angles[place - 1];
			memcpy(polygon[place], polygon[place - 1], sizeof corner);
		}
		angles[place] = angle;
		memcpy(polygon[place], corner, sizeof corner);
	}
}

int gz_box_polygon(const double corners[8][4], double level,
		   double out_polygon[GZ_BOX_POLYGON_MAX][4])
{
	int count = 0;
	for (int axis = 0; axis < 3; axis++)
		for (int i = 0; i < 8; i++) {
			const double *a = corners[i], *b = corners[i | 1 << axis];
			/* A corner on the plane counts as behind it, for all its edges. */
			if (i >> axis & 1 || (a[3] < level) == (b[3] < level) ||
			    count == GZ_BOX_POLYGON_MAX)
				continue;
			const double share = (level - a[3]) / (b[3] - a[3]);
			for (int k = 0; k < 4; k++)
				out_polygon[count][k] = a[k] + share * (b[k] - a[k]);
			count++;
		}
	order_corners(out_polygon, count);
	return count;
}
