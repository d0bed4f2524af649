/**
 * @file
 * The bricks of any volume: those of a file, fetched as they are wanted, or cut out of a volume in
 * memory and its levels of detail. For a backend that keeps bricks in rooms of its own.
 */
#ifndef GZ_RENDER_RAYCAST_SHARED_BRICK_SOURCE_H
#define GZ_RENDER_RAYCAST_SHARED_BRICK_SOURCE_H

#include "base/result.h"
#include "render/data/brick_pool.h"
#include "render/raycast/shared/detail.h"

/** Zero-initialised is none. */
struct gz_brick_source {
	const struct gz_brick_layout *layout;
	const struct gz_brick_entry *entries; /**< by a brick's number; of one cut out of memory
						 only the range is known */
	size_t rooms_useful;                  /**< more bricks than this are never there at once */
	/* a file's */
	struct gz_brick_pool *pool; /**< borrowed; NULL for a volume in memory */
	struct gz_brick_view view;
	/* of a volume in memory */
	const struct gz_detail *detail; /**< borrowed */
	struct gz_brick_layout cut_layout;
	struct gz_brick_entry *cut_entries;
	void *cut; /**< the brick cut last */
};

/**
 * Begin.
 *
 * @param detail  the volume with its levels and their macrocells; both borrowed until
 *                gz_brick_source_close(). One in memory must have as many levels as it shall have
 * @retval GZ_ERR_NO_MEM  no room for the bricks' ranges; holds nothing
 * @retval GZ_ERR_INVAL   no volume
 */
enum gz_result gz_brick_source_open(struct gz_brick_source *source, const struct gz_detail *detail);

/** Between two pictures: send for what is wanted (gz_brick_pool_turn()). @return bricks that are
 *  coming; 0 for a volume in memory, which has all */
size_t gz_brick_source_turn(struct gz_brick_source *source, const struct gz_brick_want *wants,
			    size_t count, bool wait);

/** Voxels of a brick, GZ_BRICK_VOXELS of them, valid until the next call; NULL where it is not
 *  there, or not yet. After a turn. */
const void *gz_brick_source_read(struct gz_brick_source *source, size_t brick);

/** Free and zero. */
void gz_brick_source_close(struct gz_brick_source *source);

#endif
