/**
 * @file
 * Sections of a volume across its axes, as pictures: axial, coronal and sagittal. Places are
 * fractions of the volume's box along x, y, z, 0 to 1; the centre of voxel k of n lies at (k + 0.5)
 * / n. Pure functions; any number of threads.
 */
#ifndef GZ_RENDER_SECTION_SECTION_H
#define GZ_RENDER_SECTION_SECTION_H

#include <stdbool.h>

#include "base/result.h"
#include "render/data/clip_region.h"
#include "render/data/volume.h"
#include "render/picture/image.h"
#include "render/transfer/transfer.h"

/** The planes. */
enum gz_section_plane {
	GZ_SECTION_AXIAL,    /**< across z */
	GZ_SECTION_CORONAL,  /**< across y */
	GZ_SECTION_SAGITTAL, /**< across x */
	GZ_SECTION_COUNT,
};

/** The axes of a volume, 0 to 2, in the picture of a section. */
struct gz_section_axes {
	int across; /**< to the right */
	int upward;
	int normal;
	bool mirrored; /**< the axis runs to the left */
};

/**
 * The axes of a section. Those of an oriented volume lie as radiologists have them: the patient's
 * right is on the left, and the face of a sagittal section looks to the left. Others run to the
 * right and upwards.
 */
struct gz_section_axes gz_section_axes_of(enum gz_section_plane plane, bool oriented);

/** Whether sections of a volume can be drawn: its voxels are in memory, not in a file of bricks.
 * Looks along rays need no more than the bricks that are in memory. */
bool gz_section_possible(const struct gz_volume *volume);

/**
 * The size of a section's picture that fits an area, with square millimetres.
 *
 * @param room           width and height of the area, above 0, any unit
 * @param[out] out_size  width and height, the same unit
 */
void gz_section_fit(const struct gz_volume *volume, enum gz_section_plane plane,
		    const double room[2], double out_size[2]);

/** The place of a point of a section's picture, 0 to 1 from its top left corner. Along the normal
 *  @p place stays. The result is kept within the box. */
void gz_section_place(struct gz_section_axes axes, const double point[2], double place[3]);

/** The inverse: where on a section's picture a place lies. */
void gz_section_point(struct gz_section_axes axes, const double place[3], double out_point[2]);

/** The voxel that a place lies in. */
void gz_section_voxel(const struct gz_volume *volume, const double place[3], int out_voxel[3]);

/** Move a place by whole voxels along an axis, to a voxel's centre within the box. */
void gz_section_step(const struct gz_volume *volume, int axis, int steps, double place[3]);

/** The data value of the voxel that a place lies in. */
double gz_section_value(const struct gz_volume *volume, const double place[3]);

/** What a section shows. */
struct gz_section_request {
	const struct gz_volume *volume; /**< for which gz_section_possible() holds */
	enum gz_section_plane plane;
	double place[3]; /**< the section goes through it */
	double level;    /**< data value of middle grey */
	double width;    /**< of the grey window, data values, above 0 */
	/** Its colours lie over the grey, as opaque as a voxel length is. NULL: grey alone. */
	const struct gz_transfer *transfer;
};

/**
 * Draw a section. Values are interpolated linearly between the centres of voxels, where they are
 * exact; labels are those of the nearest voxel, and so are voxels with colours of their own, which
 * the grey window does not change.
 *
 * @param[in,out] image  resized to @p width times @p height px, which is the whole box; opaque
 * @return what gz_image_resize() returns
 */
enum gz_result gz_section_draw(const struct gz_section_request *request, int width, int height,
			       struct gz_image *image);

/**
 * Where a ray becomes more opaque than not: what somebody sees who looks along it. Volumes of
 * bricks as for gz_section_look().
 *
 * @param origin, direction  of the ray, in the world of render/data/volume.h
 * @param[out] out_place  written on success
 * @return false: it does not
 */
bool gz_section_hit(const struct gz_volume *volume, const struct gz_transfer *transfer,
		    const double origin[3], const double direction[3], double out_place[3]);

/** A ray through a volume, in the world of render/data/volume.h. */
struct gz_section_ray {
	double origin[3], direction[3];
	double until; /**< where it ends, multiples of the direction; may be INFINITY */
	struct gz_clip_region clip; /**< nothing is seen outside */
};

/** What is seen of a volume along a ray. */
struct gz_section_seen {
	double value;   /**< at the place that is seen, of the transfer function: 0 to 1 over its
			   range, and beyond */
	double unit;    /**< growth of that value for 1 of the data */
	double depth;   /**< of the place, multiples of the ray's direction */
	double opacity; /**< of all that the ray passes, (0, 1] */
};

/**
 * Find what somebody sees who looks along a ray: the place in front of which half of all opacity
 * lies, and from there up to three voxel lengths on, as long as opacity rises. So a surface gives
 * the value of its matter, not one in between. Of a volume of bricks, those that are in memory are
 * looked at, so call it between two turns of their pool.
 *
 * @param[out] out_seen  written on success
 * @return false: the ray passes nothing, or too little to be seen
 */
bool gz_section_look(const struct gz_volume *volume, const struct gz_transfer *transfer,
		     const struct gz_section_ray *ray, struct gz_section_seen *out_seen);

#endif
