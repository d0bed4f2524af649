/**
 * @file
 * A grey picture from three planes of a frame: tone before equalisation, depth and object ids. All
 * steps of a shading map that need the whole picture happen here, at its full resolution
 * (shading_map.h has their order).
 */
#ifndef GZ_RENDER_ILLUSTRATION_SHADING_PICTURE_H
#define GZ_RENDER_ILLUSTRATION_SHADING_PICTURE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/result.h"
#include "base/workers.h"
#include "render/illustration/shading_map.h"
#include "render/illustration/shading_settings.h"

/** What a frame found. All planes are width by height, row 0 on top; borrowed. Those of `void` hold
 *  floats, which may have been stored as words (struct gz_plane). */
struct gz_shading_frame {
	int width, height;   /**< 1 or more */
	const void *tone;    /**< weighted mean of surface parameters; not used where ids are 0 */
	const void *depth;   /**< distance along the ray, in any unit; likewise */
	const uint32_t *ids; /**< of objects; 0 is the background */
	const void *object_distance_mm; /**< distance to a chosen object; NULL: none is chosen, and
					     its weight counts as 0 */
	float near, far;                /**< of the scene, in the unit of depth; near < far */
	const float *importances;       /**< of object 1 to @p objects, [0, 1]; others have 0 */
	/** Of object 1 to @p objects, where they differ from the settings; those are the greatest
	 * of each then. NULL: the settings' for all. */
	const struct gz_shading_weights *weights;
	size_t objects;
	/** width * height brightnesses that lines leave of white, [0, 1]: they are written here and
	 *  not drawn into the map. NULL: they are drawn. */
	float *lines_apart;
	bool keeps_curve; /**< keep the tone curve of the frame before: of a layer behind that */
};

/** The weights of settings. That of scene information is 1: its parameters have their weights in
 * the plane that they make together. */
struct gz_shading_weights gz_shading_weights_of(const struct gz_shading_settings *settings);

/** Room for the planes in between; keep it from frame to frame. */
struct gz_shading_picture;

/** Make an empty one. @param[out] out_picture  owned by the caller; gz_shading_picture_destroy()
 *  @retval GZ_ERR_NO_MEM */
enum gz_result gz_shading_picture_create(struct gz_shading_picture **out_picture);

/**
 * Compose the shading map of a frame. Allocates only if the frame is larger than those before. What
 * is drawn depends on the frame and the settings alone.
 *
 * @param settings  within the ranges of their table
 * @param workers   share the rows. The same bits for any number
 * @param[out] out_pixels  width * height pixels as gz_shading_grey() makes them; NULL: not wanted
 * @param[out] out_map  width * height brightnesses, [0, 1]; owned by the picture, valid until the
 *                      next call; NULL: not wanted, which saves time
 * @retval GZ_ERR_INVAL   a side below 1, near not below far, or settings out of range
 * @retval GZ_ERR_NO_MEM  out of memory; not logged
 */
enum gz_result gz_shading_picture_compose(struct gz_shading_picture *picture,
					  const struct gz_shading_frame *frame,
					  const struct gz_shading_settings *settings,
					  struct gz_workers *workers, uint32_t *out_pixels,
					  const float **out_map);

/** Write a map as opaque grey pixels, R, G, B, A in memory order. */
void gz_shading_grey(const float *map, size_t count, uint32_t *out_pixels);

/** Free all and set the pointer to NULL. Accepts a pointer to NULL. */
void gz_shading_picture_destroy(struct gz_shading_picture **picture);

#endif
