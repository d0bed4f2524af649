#include "render/data/clip_region.h"

#include <math.h>
#include <string.h>

#include "base/vector.h"

#define AT(field) offsetof(struct gz_clip_region, field)

const struct gz_option gz_clip_options[] = {
	{ "clip.least", GZ_OPTION_DOUBLE, AT(least), 0, 1, .count = 3, .preset = "0 0 0",
	  .help = "lower clip bounds along x, y, z, as fractions of the box" },
	{ "clip.greatest", GZ_OPTION_DOUBLE, AT(greatest), 0, 1, .count = 3, .preset = "1 1 1",
	  .help = "upper clip bounds along x, y, z, as fractions of the box" },
	{ "clip.plane", GZ_OPTION_BOOL, AT(plane), .preset = "no",
	  .help = "cut off what lies on the side of a plane that its normal points to" },
	{ "clip.normal", GZ_OPTION_DOUBLE, AT(normal), -1, 1, .count = 3, .preset = "1 0 0",
	  .help = "the clip plane's normal along x, y, z, any length; points to what is cut off" },
	{ "clip.offset", GZ_OPTION_DOUBLE, AT(offset), 0, 1, .preset = "0.5",
	  .help = "where the clip plane crosses the box along its normal, as a fraction of the "
		  "box's width; 0 leaves nothing, 1 everything" },
};
const size_t gz_clip_option_count = sizeof gz_clip_options / sizeof gz_clip_options[0];

const struct gz_clip_region gz_clip_whole = { .greatest = { 1, 1, 1 },
					      .normal = { 1, 0, 0 },
					      .offset = 0.5 };

bool gz_clip_region_valid(const struct gz_clip_region *clip)
{
	for (int axis = 0; axis < 3; axis++)
		if (!(clip->least[axis] < clip->greatest[axis]))
			return false;
	return gz_options_hold(gz_clip_options, gz_clip_option_count, clip) &&
	       (clip->normal[0] != 0 || clip->normal[1] != 0 || clip->normal[2] != 0);
}

bool gz_clip_region_same(const struct gz_clip_region *a, const struct gz_clip_region *b)
{
	return gz_options_same(gz_clip_options, gz_clip_option_count, a, b);
}

bool gz_clip_region_cuts(const struct gz_clip_region *clip)
{
	bool cuts = clip->plane;
	for (int axis = 0; axis < 3; axis++)
		cuts = cuts || clip->least[axis] > 0 || clip->greatest[axis] < 1;
	return cuts;
}

/* The plane's normal with length 1. Returns how far the box's corners reach along it from the
 * volume's centre, world units. */
static double unit_normal(const struct gz_clip_region *clip, const struct gz_volume *volume,
			  double out_normal[3])
{
	double half[3], reach = 0;
	gz_volume_half_extent(volume, half);
	for (int axis = 0; axis < 3; axis++)
		out_normal[axis] = clip->normal[axis];
	(void)gz_normalise3(out_normal);
	for (int axis = 0; axis < 3; axis++)
		reach += fabs(out_normal[axis]) * half[axis];
	return reach;
}

static void place_plane(const struct gz_clip_region *clip, const struct gz_volume *volume,
			const double scale[3], const double shift[3], double out_plane[4])
{
	double half[3], normal[3], greatest = 0;
	const double reach = unit_normal(clip, volume, normal);
	gz_volume_half_extent(volume, half);
	out_plane[3] = (2 * clip->offset - 1) * reach;
	for (int axis = 0; axis < 3; axis++) {
		/* world = (2 (at - shift) / scale - 1) half */
		out_plane[axis] = 2 * normal[axis] * half[axis] / scale[axis];
		out_plane[3] += normal[axis] * half[axis] + out_plane[axis] * shift[axis];
		greatest = fmax(greatest, fabs(out_plane[axis]));
	}
	for (int i = 0; i < 4; i++)
		out_plane[i] /= greatest;
}

void gz_clip_region_place(const struct gz_clip_region *clip, const struct gz_volume *volume,
			  const double scale[3], const double shift[3],
			  struct gz_clip_bounds *out_bounds)
{
	*out_bounds = (struct gz_clip_bounds) { .plane = { 0, 0, 0, 1 } };
	for (int axis = 0; axis < 3; axis++) {
		out_bounds->least[axis] = clip->least[axis] * scale[axis] + shift[axis];
		out_bounds->greatest[axis] = clip->greatest[axis] * scale[axis] + shift[axis];
	}
	if (clip->plane)
		place_plane(clip, volume, scale, shift, out_bounds->plane);
}

/* Leave of a ray what lies where low <= at * along <= high, for at from ends[0] to ends[1].
 * Returns false if that is nothing for any at. */
static bool cut_ends(double low, double high, double along, double ends[2])
{
	if (along == 0)
		return low <= 0 && high >= 0;
	ends[0] = fmax(ends[0], fmin(low / along, high / along));
	ends[1] = fmin(ends[1], fmax(low / along, high / along));
	return true;
}

bool gz_clip_bounds_cross(const struct gz_clip_bounds *bounds, const double origin[3],
			  const double direction[3], double out_ends[2])
{
	bool any = true;
	out_ends[0] = 0;
	out_ends[1] = INFINITY;
	for (int i = 0; i < 3; i++)
		any = any && cut_ends(bounds->least[i] - origin[i], bounds->greatest[i] - origin[i],
				      direction[i], out_ends);
	any = any && cut_ends(-INFINITY, -gz_clip_beyond(bounds, origin),
			      gz_dot3(bounds->plane, direction), out_ends);
	return any && out_ends[0] < out_ends[1] && isfinite(out_ends[1]);
}

void gz_clip_region_voxels(const struct gz_clip_region *clip, const struct gz_volume *volume,
			   struct gz_clip_voxels *out_voxels)
{
	static const double first_datum[3] = { -0.5, -0.5, -0.5 };
	const double dims[3] = { volume->dims[0], volume->dims[1], volume->dims[2] };
	struct gz_clip_bounds *bounds = &out_voxels->bounds;
	gz_clip_region_place(clip, volume, dims, first_datum, bounds);
	out_voxels->plane = clip->plane;
	for (int axis = 0; axis < 3; axis++) {
		const int behind = (int)floor(bounds->greatest[axis]) + 1;
		out_voxels->from[axis] = (int)ceil(bounds->least[axis]);
		out_voxels->to[axis] = behind < volume->dims[axis] ? behind : volume->dims[axis];
	}
}

static bool plane_keeps(const struct gz_clip_voxels *voxels, int x, int y, int z)
{
	return gz_clip_beyond(&voxels->bounds, (const double[3]) { x, y, z }) <= 0;
}

bool gz_clip_voxels_hold(const struct gz_clip_voxels *voxels, const int at[3])
{
	for (int axis = 0; axis < 3; axis++)
		if (at[axis] < voxels->from[axis] || at[axis] >= voxels->to[axis])
			return false;
	return !voxels->plane || plane_keeps(voxels, at[0], at[1], at[2]);
}

void gz_clip_voxels_keep(const struct gz_clip_voxels *voxels, int y, int z, int *from, int *to)
{
	while (voxels->plane && *from < *to && !plane_keeps(voxels, *from, y, z))
		++*from;
	while (voxels->plane && *from < *to && !plane_keeps(voxels, *to - 1, y, z))
		--*to;
}

int gz_clip_plane_outline(const struct gz_clip_region *clip, const struct gz_volume *volume,
			  double out_corners[GZ_BOX_POLYGON_MAX][3])
{
	static const double one[3] = { 1, 1, 1 }, none[3] = { 0, 0, 0 };
	double plane[4], corners[8][4], polygon[GZ_BOX_POLYGON_MAX][4];
	place_plane(clip, volume, one, none, plane);
	int last = 0; /* the axis along which the polygon is seen the largest */
	for (int axis = 1; axis < 3; axis++)
		last = fabs(plane[axis]) > fabs(plane[last]) ? axis : last;
	const int axes[3] = { (last + 1) % 3, (last + 2) % 3, last };
	for (int i = 0; i < 8; i++) {
		corners[i][3] = -plane[3];
		for (int k = 0; k < 3; k++) {
			const int axis = axes[k];
			corners[i][k] = (i >> k & 1 ? clip->greatest : clip->least)[axis];
			corners[i][3] += plane[axis] * corners[i][k];
		}
	}
	const int count = gz_box_polygon(corners, 0, polygon);
	for (int i = 0; i < count; i++)
		for (int k = 0; k < 3; k++)
			out_corners[i][axes[k]] = polygon[i][k];
	return count;
}

bool gz_clip_plane_trace(const struct gz_clip_region *clip, const struct gz_volume *volume,
			 int axis, double share, double out_ends[2][3])
{
	double corners[GZ_BOX_POLYGON_MAX][3], ends[GZ_BOX_POLYGON_MAX][3];
	const int count = gz_clip_plane_outline(clip, volume, corners);
	int found = 0;
	for (int i = 0; i < count; i++) {
		const double *a = corners[i], *b = corners[(i + 1) % count];
		if ((a[axis] < share) == (b[axis] < share))
			continue;
		const double way = (share - a[axis]) / (b[axis] - a[axis]);
		for (int k = 0; k < 3; k++)
			ends[found][k] = a[k] + way * (b[k] - a[k]);
		ends[found++][axis] = share;
	}
	if (found == 2) /* a convex outline is crossed twice, or not at all */
		memcpy(out_ends, ends, 2 * sizeof ends[0]);
	return found == 2;
}

void gz_clip_plane_through(struct gz_clip_region *clip, const struct gz_volume *volume,
			   const double world[3])
{
	double normal[3];
	const double reach = unit_normal(clip, volume, normal);
	clip->offset = fmin(fmax((gz_dot3(normal, world) / reach + 1) / 2, 0), 1);
}
