/**
 * @file
 * The clip region: section [clip] of a scene.
 */
#ifndef GZ_RENDER_DATA_CLIP_REGION_H
#define GZ_RENDER_DATA_CLIP_REGION_H

#include <stdbool.h>
#include <stddef.h>

#include "base/option.h"

/**
 * The part of the volume that is shown: the clip box, as fractions of the box's edges along x, y,
 * z, 0 to 1; least is below greatest. A ray is divided into segments from where it enters the whole
 * box, so samples do not move when the clip region changes. A segment that is cut by a face of the
 * region is sampled in the middle of the part that remains and has the opacity of its length, like
 * the last segment of every ray.
 */
struct gz_clip_region {
	double least[3], greatest[3];
};

/** Table over struct gz_clip_region: "clip.…". */
extern const struct gz_option gz_clip_options[];
extern const size_t gz_clip_option_count;

/** The region that holds the whole volume: the table's presets. */
extern const struct gz_clip_region gz_clip_whole;

/** Whether two regions hold equal values. */
bool gz_clip_region_same(const struct gz_clip_region *a, const struct gz_clip_region *b);

/** Whether the clip box is not empty and lies within the volume's box. */
bool gz_clip_region_valid(const struct gz_clip_region *clip);

/** The voxels whose middles lie in the clip box, from @p out_from up to but without @p out_to along
 *  each axis. @param dims  of the volume */
void gz_clip_region_voxels(const struct gz_clip_region *clip, const int dims[3], int out_from[3],
			   int out_to[3]);

/** A clip region in coordinates of somebody's own. */
struct gz_clip_bounds {
	double least[3], greatest[3]; /**< corners of the clip box */
};

/** Turn a region into coordinates of one's own: a place is the fraction of the box's edge times
 *  @p scale, which is above 0, plus @p shift, along each axis. */
void gz_clip_region_place(const struct gz_clip_region *clip, const double scale[3],
			  const double shift[3], struct gz_clip_bounds *out_bounds);

/**
 * The part of a ray within a region, as multiples of the ray's direction.
 *
 * @param[out] out_ends  where it begins, 0 or more, and ends; may be empty or infinite
 * @return whether it is neither
 */
bool gz_clip_bounds_cross(const struct gz_clip_bounds *bounds, const double origin[3],
			  const double direction[3], double out_ends[2]);

#endif
