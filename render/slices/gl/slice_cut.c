#include "render/slices/gl/slice_cut.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A polygon of n corners becomes n - 2 triangles. */
enum { TRIANGLE_CORNERS_MAX = 3 * (GZ_SLICE_CORNERS_MAX - 2) };

static void project_box(const struct gz_ray_inverse *inverse, const double least[3],
			const double greatest[3], double out_corners[8][4])
{
	for (int i = 0; i < 8; i++) {
		const double world[3] = {
			i & 1 ? greatest[0] : least[0],
			i & 2 ? greatest[1] : least[1],
			i & 4 ? greatest[2] : least[2],
		};
		gz_ray_inverse_point(inverse, world, out_corners[i]);
	}
}

static struct gz_slice_corner corner_of(const double from[4], double near)
{
	return (struct gz_slice_corner) {
		.x = (float)from[0],
		.y = (float)from[1],
		.w = (float)from[2],
		.depth = (float)(from[3] - near),
	};
}

/* Append the triangles of a polygon: a fan around its first corner. */
static void append_polygon(struct gz_slice_cut *cut, int *corner_count,
			   const double polygon[GZ_SLICE_CORNERS_MAX][4], int count)
{
	for (int i = 1; i + 1 < count; i++) {
		const int fan[3] = { 0, i, i + 1 };
		for (int k = 0; k < 3; k++)
			cut->corners[(*corner_count)++] = corner_of(polygon[fan[k]], cut->near);
	}
}

/* How far beyond the clip plane a corner lies. */
static double corner_beyond(const struct gz_slice_request *request, const double corner[4])
{
	const struct gz_ray_frame *rays = &request->rays;
	const double x = corner[0] / corner[2], y = corner[1] / corner[2];
	double at[3];
	for (int axis = 0; axis < 3; axis++)
		at[axis] = rays->origin00[axis] + x * rays->origin_dx[axis] +
			   y * rays->origin_dy[axis] +
			   corner[3] * (rays->direction00[axis] + x * rays->direction_dx[axis] +
					y * rays->direction_dy[axis]);
	return gz_clip_beyond(&request->shown, at);
}

/* Leave of a polygon what the clip plane keeps: Sutherland and Hodgman, Reentrant Polygon Clipping,
 * CACM 17(1), 1974. Returns the number of corners. */
static int keep_by_plane(const struct gz_slice_request *request, int count,
			 double polygon[GZ_SLICE_CORNERS_MAX][4])
{
	double kept[GZ_SLICE_CORNERS_MAX][4];
	int kept_count = 0;
	for (int i = 0; i < count; i++) {
		const double *from = polygon[i], *to = polygon[(i + 1) % count];
		const double here = corner_beyond(request, from), next = corner_beyond(request, to);
		if (here <= 0 && kept_count < GZ_SLICE_CORNERS_MAX)
			memcpy(kept[kept_count++], from, sizeof kept[0]);
		if ((here <= 0) == (next <= 0) || kept_count == GZ_SLICE_CORNERS_MAX)
			continue;
		for (int k = 0; k < 4; k++)
			kept[kept_count][k] = from[k] + here / (here - next) * (to[k] - from[k]);
		kept_count++;
	}
	memcpy(polygon, kept, (size_t)kept_count * sizeof kept[0]);
	return kept_count;
}

static void cut_shown_part(const struct gz_slice_request *request, const double shown[8][4],
			   struct gz_slice_cut *cut)
{
	int corner_count = 0;
	for (int i = 0; i < cut->count; i++) {
		double polygon[GZ_SLICE_CORNERS_MAX][4];
		const double depth = cut->near + (i + 0.5) * cut->distance;
		cut->first[i] = corner_count;
		const int of_box = gz_box_polygon(shown, depth, polygon);
		const int count = keep_by_plane(request, of_box, polygon);
		append_polygon(cut, &corner_count, polygon, count);
	}
	cut->first[cut->count] = corner_count;
}

static enum gz_result reserve_slices(struct gz_slice_cut *cut, int count)
{
	const size_t slices = (size_t)count;
	free(cut->corners);
	free(cut->first);
	cut->corners = malloc(slices * TRIANGLE_CORNERS_MAX * sizeof *cut->corners);
	cut->first = malloc((slices + 1) * sizeof *cut->first);
	return cut->corners && cut->first ? GZ_OK : GZ_ERR_NO_MEM;
}

static bool same_numbers(const double *a, const double *b, size_t count)
{
	for (size_t i = 0; i < count; i++)
		if (!(a[i] == b[i]))
			return false;
	return true;
}

static bool same_request(const struct gz_slice_request *a, const struct gz_slice_request *b)
{
	return same_numbers(a->rays.origin00, b->rays.origin00, 3) &&
	       same_numbers(a->rays.origin_dx, b->rays.origin_dx, 3) &&
	       same_numbers(a->rays.origin_dy, b->rays.origin_dy, 3) &&
	       same_numbers(a->rays.direction00, b->rays.direction00, 3) &&
	       same_numbers(a->rays.direction_dx, b->rays.direction_dx, 3) &&
	       same_numbers(a->rays.direction_dy, b->rays.direction_dy, 3) &&
	       same_numbers(a->half, b->half, 3) && a->count == b->count &&
	       same_numbers(a->shown.least, b->shown.least, 3) &&
	       same_numbers(a->shown.greatest, b->shown.greatest, 3) &&
	       same_numbers(a->shown.plane, b->shown.plane, 4);
}

/* From the nearest to the farthest corner, but not behind the eye. */
static void find_depths(const double box[8][4], double *out_near, double *out_far)
{
	double near = INFINITY, far = 0;
	for (int i = 0; i < 8; i++) {
		near = fmin(near, box[i][3]);
		far = fmax(far, box[i][3]);
	}
	*out_near = fmax(near, 0);
	*out_far = far;
}

enum gz_result gz_slice_cut_make(const struct gz_slice_request *request, struct gz_slice_cut *cut)
{
	struct gz_ray_inverse inverse;
	double whole[8][4], shown[8][4], far;
	if (cut->valid && same_request(&cut->made_for, request))
		return GZ_OK;
	cut->valid = false;
	cut->count = 0;
	if (request->count < 1 || !gz_ray_inverse_make(&request->rays, &inverse))
		return GZ_ERR_INVAL;
	const enum gz_result result = reserve_slices(cut, request->count);
	if (result != GZ_OK)
		return result;
	const double opposite[3] = { -request->half[0], -request->half[1], -request->half[2] };
	project_box(&inverse, opposite, request->half, whole);
	project_box(&inverse, request->shown.least, request->shown.greatest, shown);
	find_depths(whole, &cut->near, &far);
	cut->distance = (far - cut->near) / request->count;
	if (cut->distance > 0)
		cut->count = request->count;
	cut_shown_part(request, shown, cut);
	cut->made_for = *request;
	cut->valid = true;
	cut->revision++;
	return GZ_OK;
}

void gz_slice_cut_free(struct gz_slice_cut *cut)
{
	free(cut->corners);
	free(cut->first);
	*cut = (struct gz_slice_cut) { 0 };
}
