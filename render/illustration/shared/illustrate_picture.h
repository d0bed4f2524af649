/**
 * @file
 * From what a backend found of a picture, layer by layer, to the picture: each layer gets a shading
 * map of its own (render/illustration/shading_picture.h), and they are blended by depth.
 */
#ifndef GZ_RENDER_ILLUSTRATION_SHARED_ILLUSTRATE_PICTURE_H
#define GZ_RENDER_ILLUSTRATION_SHARED_ILLUSTRATE_PICTURE_H

#include <stddef.h>

#include "base/result.h"
#include "base/workers.h"
#include "render/illustration/shading_measures.h"
#include "render/illustration/shading_picture.h"
#include "render/illustration/shared/illustrate_drawing.h"
#include "render/illustration/shared/illustrate_frame.h"
#include "render/illustration/shared/illustrate_scene.h"
#include "render/illustration/shared/illustrate_shot.h"
#include "render/picture/image.h"
#include "render/picture/plane.h"

/** What is found of each pixel. Where there is nothing, ids are 0 and all else is INFINITY. */
enum gz_illustrate_found {
	GZ_ILLUSTRATE_TONE,     /**< weighted mean of the surface parameters, [0, 1] */
	GZ_ILLUSTRATE_DEPTH,    /**< along the ray, mm */
	GZ_ILLUSTRATE_IDS,      /**< numbers of objects */
	GZ_ILLUSTRATE_DISTANCE, /**< to the chosen object, mm; only if it is wanted */
	GZ_ILLUSTRATE_FOUND,
};

/** What each of them is. */
extern const enum gz_plane_kind gz_illustrate_found_kinds[GZ_ILLUSTRATE_FOUND];

/** Planes of a picture, and room to compose them. Zero-initialised is closed. */
struct gz_illustrate_picture {
	/** Filled by the backend, the nearest layer first. */
	struct gz_plane planes[GZ_ILLUSTRATE_LAYERS_MAX][GZ_ILLUSTRATE_FOUND];
	int layers;      /**< 1 to GZ_ILLUSTRATE_LAYERS_MAX; 1: no object is transparent */
	int plane_count; /**< GZ_ILLUSTRATE_FOUND, or one less without distances */
	struct gz_illustrate_drawing drawing; /**< by marks, if the look asks for it */
	bool measured;                        /**< the look asks for measures */
	struct gz_shading_measures measures;  /**< of the nearest layer, if measured */
	/** Within shared/: */
	struct gz_shading_picture *shading;
	float *sums, *shares; /**< of the layers before one: their map, and what they let through */
	float *together;      /**< brightness of the layers up to one */
	size_t blend_room;
};

/** Open it. @retval GZ_ERR_NO_MEM */
enum gz_result gz_illustrate_picture_open(struct gz_illustrate_picture *picture);

/** Make room for the layers and planes of a shot. @retval GZ_ERR_NO_MEM, GZ_ERR_INVAL  as
 *  gz_plane_resize() */
enum gz_result gz_illustrate_picture_prepare(struct gz_illustrate_picture *picture,
					     const struct gz_illustrate_scene *scene,
					     const struct gz_illustrate_shot *shot);

/**
 * Compose the picture of its planes. The same bits for any number of threads.
 *
 * @param image   of the planes' size; every pixel is written
 * @param planes  NULL: no planes are wanted. They get those of the nearest layer
 * @retval GZ_ERR_INVAL   settings out of range
 * @retval GZ_ERR_NO_MEM  out of memory
 */
enum gz_result gz_illustrate_picture_compose(struct gz_illustrate_picture *picture,
					     const struct gz_illustrate_scene *scene,
					     const struct gz_illustrate_frame *frame,
					     struct gz_workers *workers, struct gz_image *image,
					     const struct gz_illustrate_planes *planes);

/** What the composed picture is like; NULL: its look asks for no measures. */
const struct gz_shading_measures *gz_illustrate_picture_measures(
	const struct gz_illustrate_picture *picture);

/** Free all and zero it. */
void gz_illustrate_picture_close(struct gz_illustrate_picture *picture);

#endif
