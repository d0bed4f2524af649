/**
 * @file
 * What somebody sees at a place of a picture: an object, or of a volume the values that look alike.
 */
#ifndef GZ_VIEW_FRAME_LOOKED_AT_H
#define GZ_VIEW_FRAME_LOOKED_AT_H

#include <stddef.h>

#include "render/attention/interest.h"
#include "render/frame/picture_maker.h"

/**
 * Find what is seen most at a place. Of a volume that rays pass, it is a range of values: of labels
 * the one label, otherwise what its transfer function shows as one thing around the value that is
 * seen (gz_section_look(), gz_transfer_find_alike()), in both cases without the function's
 * emphasis, so that what is raised does not decide what is seen. Of a volume of bricks, those in
 * memory are looked at.
 *
 * @param pictures  shows the objects
 * @param objects   @p count of them
 * @param request   the place; its settings are a struct gz_ray_params
 * @return an id of 0: nothing is there, or the place is not in the picture
 */
struct gz_looked_at gz_looked_at_find(struct gz_picture_maker *pictures,
				      const struct gz_object *objects, size_t count,
				      const struct gz_pick_request *request);

#endif
