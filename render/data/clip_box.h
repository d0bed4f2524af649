/**
 * @file
 * The clip box: section [clip] of a scene.
 */
#ifndef GZ_RENDER_DATA_CLIP_BOX_H
#define GZ_RENDER_DATA_CLIP_BOX_H

#include <stdbool.h>
#include <stddef.h>

#include "base/option.h"

/**
 * The part of the box that is shown: shares of its edges, 0 to 1 along x, y, z, least below
 * greatest. A ray is cut into segments from where it enters the whole box, so samples stay where
 * they are without it; a segment that a face of the clip box cuts is sampled in the middle of what
 * is left of it and has the opacity of that length, as the last segment of every ray.
 */
struct gz_clip_box {
	double least[3], greatest[3];
};

/** Table over struct gz_clip_box: "clip.…". */
extern const struct gz_option gz_clip_options[];
extern const size_t gz_clip_option_count;

/** Whether two boxes hold equal values. */
bool gz_clip_box_same(const struct gz_clip_box *a, const struct gz_clip_box *b);

/** Whether the box holds something and lies within the volume's. */
bool gz_clip_box_valid(const struct gz_clip_box *clip);

#endif
