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
#include "render/illustration/hatch_strokes.h"
#include "render/illustration/stipple_points.h"

struct gz_illustrate_scene;
struct gz_illustrate_shot;

/** Directions of the strokes of an object: along, and across. */
#define GZ_HATCH_DIRECTIONS 2

/** The marks of an object. Zero-initialised has none. */
struct gz_illustrate_marks {
	/** For how many points of the whole scene they were made; 0: they were not. */
	unsigned points_for, strokes_for;
	struct gz_stipple_points points;
	struct gz_hatch_strokes strokes[GZ_HATCH_DIRECTIONS];
};

/**
 * Make the marks that a shot needs and that a scene does not have. Larger pictures need more: those
 * that are there stay where they are, and more come between them. Points of files are kept.
 *
 * @param scene  with the vertices of all items
 * @param shot   one whose plan has no pixels needs none
 * @param[out] out_new  whether any were made; not written otherwise
 * @retval GZ_ERR_NO_MEM  out of memory
 */
enum gz_result gz_illustrate_marks_make(struct gz_illustrate_scene *scene,
					const struct gz_illustrate_shot *shot,
					struct gz_workers *workers, bool *out_new);

/** Free them. */
void gz_illustrate_marks_free(struct gz_illustrate_marks *marks);

#endif
