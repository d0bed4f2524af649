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
 * The part of the volume that is shown, as fractions of the box's edges along x, y, z, 0 to 1;
 * least is below greatest. A ray is divided into segments from where it enters the whole box, so
 * samples do not move when the clip box changes. A segment that is cut by a face of the clip box is
 * sampled in the middle of the part that remains and has the opacity of its length, like the last
 * segment of every ray.
 */
struct gz_clip_box {
	double least[3], greatest[3];
};

/** Table over struct gz_clip_box: "clip.…". */
extern const struct gz_option gz_clip_options[];
extern const size_t gz_clip_option_count;

/** Whether two boxes hold equal values. */
bool gz_clip_box_same(const struct gz_clip_box *a, const struct gz_clip_box *b);

/** Whether the clip box is not empty and lies within the volume's box. */
bool gz_clip_box_valid(const struct gz_clip_box *clip);

#endif
