/**
 * @file
 * The marks of an object, which draw its shading map: points and strokes that live on its surface.
 * Within this room.
 */
#ifndef GZ_RENDER_ILLUSTRATION_SHARED_ILLUSTRATE_MARKS_H
#define GZ_RENDER_ILLUSTRATION_SHARED_ILLUSTRATE_MARKS_H

#include <stdbool.h>

#include "base/result.h"
#include "base/workers.h"
#include "render/illustration/shared/illustrate_making.h"

struct gz_illustrate_item;
struct gz_illustrate_scene;
struct gz_illustrate_shot;

/** How an object is to be drawn: as its style says, otherwise as the look does. */
enum gz_illustration_drawing gz_illustrate_item_asks(const struct gz_illustrate_item *item,
						     const struct gz_illustration_look *look);

/** How it can be drawn now: grey while it has no marks of the kind that it asks for. */
enum gz_illustration_drawing gz_illustrate_item_drawn(const struct gz_illustrate_item *item,
						      const struct gz_illustration_look *look);

/** The direction of its first layer of strokes. The second one crosses it. */
enum gz_hatch_direction gz_illustrate_item_direction(const struct gz_illustrate_item *item,
						     const struct gz_illustration_look *look);

/**
 * Make the marks that a shot needs and that a scene does not have. Larger pictures need more: those
 * that are there stay where they are, and more come between them. Marks are kept in files, unless
 * they are those of a volume's surface that came later.
 *
 * If the scene waits for marks, they are there on return. Otherwise a thread makes them from a copy
 * of the meshes, scene->marks_coming says so, and the objects are drawn by the marks that they
 * have, or grey.
 *
 * @param scene  with the vertices of all items
 * @param shot   one whose plan has no pixels needs none
 * @param[out] out_new  whether any were made; not written otherwise
 * @retval GZ_ERR_NO_MEM  out of memory
 */
enum gz_result gz_illustrate_marks_make(struct gz_illustrate_scene *scene,
					const struct gz_illustrate_shot *shot,
					struct gz_workers *workers, bool *out_new);

#endif
