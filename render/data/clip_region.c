#include "render/data/clip_region.h"

#include <math.h>

#define AT(field) offsetof(struct gz_clip_region, field)

const struct gz_option gz_clip_options[] = {
	{ "clip.least", GZ_OPTION_DOUBLE, AT(least), 0, 1, .count = 3, .preset = "0 0 0",
	  .help = "lower clip bounds along x, y, z, as fractions of the box" },
	{ "clip.greatest", GZ_OPTION_DOUBLE, AT(greatest), 0, 1, .count = 3, .preset = "1 1 1",
	  .help = "upper clip bounds along x, y, z, as fractions of the box" },
};
const size_t gz_clip_option_count = sizeof gz_clip_options / sizeof gz_clip_options[0];

const struct gz_clip_region gz_clip_whole = { .greatest = { 1, 1, 1 } };

bool gz_clip_region_valid(const struct gz_clip_region *clip)
{
	for (int axis = 0; axis < 3; axis++)
		if (!(clip->least[axis] < clip->greatest[axis]))
			return false;
	return gz_options_hold(gz_clip_options, gz_clip_option_count, clip);
}

bool gz_clip_region_same(const struct gz_clip_region *a, const struct gz_clip_region *b)
{
	return gz_options_same(gz_clip_options, gz_clip_option_count, a, b);
}

void gz_clip_region_voxels(const struct gz_clip_region *clip, const int dims[3], int out_from[3],
			   int out_to[3])
{
	for (int axis = 0; axis < 3; axis++) {
		const int behind = (int)floor(clip->greatest[axis] * dims[axis] - 0.5) + 1;
		out_from[axis] = (int)ceil(clip->least[axis] * dims[axis] - 0.5);
		out_to[axis] = behind < dims[axis] ? behind : dims[axis];
	}
}

void gz_clip_region_place(const struct gz_clip_region *clip, const double scale[3],
			  const double shift[3], struct gz_clip_bounds *out_bounds)
{
	for (int axis = 0; axis < 3; axis++) {
		out_bounds->least[axis] = clip->least[axis] * scale[axis] + shift[axis];
		out_bounds->greatest[axis] = clip->greatest[axis] * scale[axis] + shift[axis];
	}
}

bool gz_clip_bounds_cross(const struct gz_clip_bounds *bounds, const double origin[3],
			  const double direction[3], double out_ends[2])
{
	out_ends[0] = 0;
	out_ends[1] = INFINITY;
	for (int i = 0; i < 3; i++) {
		const double low = bounds->least[i] - origin[i];
		const double high = bounds->greatest[i] - origin[i];
		const double a = low / direction[i], b = high / direction[i];
		if (direction[i] == 0 && (low > 0 || high < 0))
			return false;
		if (direction[i] == 0)
			continue;
		out_ends[0] = fmax(out_ends[0], fmin(a, b));
		out_ends[1] = fmin(out_ends[1], fmax(a, b));
	}
	return out_ends[0] < out_ends[1] && isfinite(out_ends[1]);
}
