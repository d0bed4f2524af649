/**
 * @file
 * The clip region: section [clip] of a scene.
 */
#ifndef GZ_RENDER_DATA_CLIP_REGION_H
#define GZ_RENDER_DATA_CLIP_REGION_H

#include <stdbool.h>
#include <stddef.h>

#include "base/option.h"
#include "render/data/box_polygon.h"
#include "render/data/volume.h"

/**
 * The part of the volume that is shown: what lies in the clip box, and with a clip plane only what
 * lies on the side that its normal points away from. A ray is divided into segments from where it
 * enters the whole box, so samples do not move when the clip region changes. A segment that is cut
 * by a face of the region is sampled in the middle of the part that remains and has the opacity of
 * its length, like the last segment of every ray.
 */
struct gz_clip_region {
	/** Of the clip box, as fractions of the volume's edges along x, y, z, 0 to 1; least is
	 * below greatest. */
	double least[3], greatest[3];
	bool plane; /**< there is a clip plane */
	/** Of the plane, along the axes of the world; any length but 0. It points to what is cut
	 *  off. */
	double normal[3];
	/** Where the plane crosses the volume's box, as a fraction of the box's width along the
	 *  normal, 0 to 1: 0 leaves nothing and 1 everything. With a normal along an axis it
	 *  equals greatest there; with the opposite normal it equals 1 minus least. */
	double offset;
};

/** Table over struct gz_clip_region: "clip.…". */
extern const struct gz_option gz_clip_options[];
extern const size_t gz_clip_option_count;

/** The region that holds the whole volume: the table's presets. */
extern const struct gz_clip_region gz_clip_whole;

/** Whether two regions hold equal values. */
bool gz_clip_region_same(const struct gz_clip_region *a, const struct gz_clip_region *b);

/** Whether the clip box is not empty and lies within the volume's box, and the normal is not 0. */
bool gz_clip_region_valid(const struct gz_clip_region *clip);

/** Whether a region leaves out anything of the volume. A plane at an offset of 1 counts, too. */
bool gz_clip_region_cuts(const struct gz_clip_region *clip);

/** A clip region in a caller's own coordinates. */
struct gz_clip_bounds {
	double least[3], greatest[3]; /**< corners of the clip box */
	/** A place (x, y, z) is kept where plane[0] x + plane[1] y + plane[2] z <= plane[3]. The
	 *  greatest of the first three is 1 or -1; without a clip plane they are 0 and the last is
	 *  1, which keeps all. */
	double plane[4];
};

/**
 * Turn a region into coordinates of one's own: a place is the fraction of the box's edge times
 * @p scale, which is above 0, plus @p shift, along each axis.
 *
 * @param volume  whose box it is; only its dims and spacing are read
 */
void gz_clip_region_place(const struct gz_clip_region *clip, const struct gz_volume *volume,
			  const double scale[3], const double shift[3],
			  struct gz_clip_bounds *out_bounds);

/** How far beyond the clip plane a place lies, in units of plane: above 0 where it is cut off. */
static inline double gz_clip_beyond(const struct gz_clip_bounds *bounds, const double at[3])
{
	const double *plane = bounds->plane;
	return plane[0] * at[0] + plane[1] * at[1] + plane[2] * at[2] - plane[3];
}

/**
 * The part of a ray within a region, as multiples of the ray's direction.
 *
 * @param[out] out_ends  where it begins, 0 or more, and ends; may be empty or infinite
 * @return whether it is neither
 */
bool gz_clip_bounds_cross(const struct gz_clip_bounds *bounds, const double origin[3],
			  const double direction[3], double out_ends[2]);

/** The voxels whose middles lie in a region. */
struct gz_clip_voxels {
	int from[3], to[3];           /**< those of the clip box: from is in, to is not */
	bool plane;                   /**< there is a clip plane */
	struct gz_clip_bounds bounds; /**< the middle of voxel i is at i */
};

/** Find a volume's voxels in a region. Only the volume's dims and spacing are read. */
void gz_clip_region_voxels(const struct gz_clip_region *clip, const struct gz_volume *volume,
			   struct gz_clip_voxels *out_voxels);

/** Whether a voxel is among them. */
bool gz_clip_voxels_hold(const struct gz_clip_voxels *voxels, const int at[3]);

/** Narrow a row of voxels at (y, z), from @p from to before @p to, to those that the clip plane
 *  keeps, which are neighbours. The row lies in the clip box. */
void gz_clip_voxels_keep(const struct gz_clip_voxels *voxels, int y, int z, int *from, int *to);

/**
 * The polygon in which the clip plane crosses the clip box, whether or not the plane is on.
 *
 * @param volume  whose box it is; only its dims and spacing are read
 * @param[out] out_corners  in order around it, as fractions of the volume's edges
 * @return their number: 0, or 3 to GZ_BOX_POLYGON_MAX
 */
int gz_clip_plane_outline(const struct gz_clip_region *clip, const struct gz_volume *volume,
			  double out_corners[GZ_BOX_POLYGON_MAX][3]);

/**
 * The line in which the clip plane crosses a plane across an axis, within the clip box, whether or
 * not the clip plane is on.
 *
 * @param volume  whose box it is; only its dims and spacing are read
 * @param share   where the other plane lies, as a fraction of the volume's edge along @p axis
 * @param[out] out_ends  as fractions of the volume's edges; written on success
 * @return false: they do not cross, or at a corner only, or are the same
 */
bool gz_clip_plane_trace(const struct gz_clip_region *clip, const struct gz_volume *volume,
			 int axis, double share, double out_ends[2][3]);

/** Move the clip plane, with its normal, to a place in the world. Beyond the box it stops at the
 *  box's corner. @param volume  whose box it is; only its dims and spacing are read */
void gz_clip_plane_through(struct gz_clip_region *clip, const struct gz_volume *volume,
			   const double world[3]);

#endif
