/**
 * @file
 * Which bricks a picture would show, and how much the absence of each would be seen.
 *
 * A brick is wanted where the transfer function shows something of it, it reaches into the clip
 * box, the camera sees it, and its level is the one that rays take there or a coarser one, which is
 * shown meanwhile. Its weight is the size in pixels that its voxels would be shown at without it,
 * that is of the next coarser ones, over what the eye resolves there: 1 + d / 90 pixels at d pixels
 * from the gaze. So bricks near the gaze come first, and everywhere coarse ones before fine ones.
 */
#ifndef GZ_RENDER_RAYCAST_SHARED_BRICK_WANTS_H
#define GZ_RENDER_RAYCAST_SHARED_BRICK_WANTS_H

#include "base/result.h"
#include "render/data/brick_rooms.h"
#include "render/picture/camera.h"
#include "render/plan/plan.h"
#include "render/raycast/shared/ray_params.h"
#include "render/transfer/transfer_table.h"

/** Edge of the blocks that the picture's levels are told in, px. Chosen: far smaller than what is
 *  worth fetching alone. */
#define GZ_WANTS_BLOCK 64

/** What is to be shown. */
struct gz_brick_scene {
	const struct gz_volume *volume;
	const struct gz_brick_layout *layout; /**< of its bricks */
	const struct gz_brick_entry *entries; /**< by number; only their ranges are looked at */
	const struct gz_transfer_table *table;
	const struct gz_camera *camera;
	const struct gz_clip_box *clip;
	int width, height;          /**< of the picture, px */
	const double *focus_px;     /**< two: where the eye looks */
	const uint8_t *block_level; /**< the finest level that rays of each block take, row by row,
				       (width + 63) / 64 columns; NULL: level 0 everywhere */
};

/** Wanted bricks, the greatest weight first. Zero-initialised is empty; keep it from picture to
 *  picture. */
struct gz_brick_wants {
	struct gz_brick_want *want;
	size_t count, capacity;
};

/**
 * Find what is wanted.
 *
 * @param[in,out] wants  overwritten; its array grows where needed
 * @retval GZ_ERR_INVAL   no valid camera
 * @retval GZ_ERR_NO_MEM  no room
 */
enum gz_result gz_brick_wants_find(const struct gz_brick_scene *scene,
				   struct gz_brick_wants *wants);

/** Free and zero. */
void gz_brick_wants_free(struct gz_brick_wants *wants);

#endif
