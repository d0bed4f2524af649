/**
 * @file
 * What tiles of a picture can show at most, so that marks that cannot show are passed over
 * together. For the sources of this room.
 */
#ifndef GZ_RENDER_ILLUSTRATION_STIPPLE_TILES_H
#define GZ_RENDER_ILLUSTRATION_STIPPLE_TILES_H

#include <stdbool.h>
#include <stddef.h>

#include "base/result.h"
#include "base/workers.h"
#include "render/illustration/stipple_project.h"

/** Edge of a tile, px: that of the lattice of scales. */
#define GZ_STIPPLE_TILE_PX GZ_STIPPLE_SCALE_STEP_PX

/** The bounds of a tile, or of several. */
struct gz_stipple_bound {
	float ink;      /**< the darkest pixel, [0, 1] */
	float farthest; /**< of the view's object, world units; -INFINITY: it is not seen here */
	float scale;    /**< the least of the view's scale */
};

/** A ball of places, mm from the projector's origin. */
struct gz_stipple_ball {
	float from[3], reach;
};

/** Tiles of the picture that a ball covers. Zero-initialised holds none. */
struct gz_stipple_tiles {
	int left, top, columns, rows; /**< in tiles; columns is 0 if nothing is in the picture */
	struct gz_stipple_bound *bounds;
	const struct gz_stipple_projector *projector;
};

/**
 * Find the bounds of all tiles that a ball covers.
 *
 * @param projector  borrowed
 * @param workers    share the work; NULL for the calling thread alone
 * @param[out] out_tiles  written on GZ_OK; the caller frees it with gz_stipple_tiles_free()
 * @retval GZ_ERR_NO_MEM  not logged
 */
enum gz_result gz_stipple_tiles_make(const struct gz_stipple_projector *projector,
				     const struct gz_stipple_ball *ball, struct gz_workers *workers,
				     struct gz_stipple_tiles *out_tiles);

/** The bounds of what a smaller ball covers. Returns false if nothing in it can be seen: it is out
 *  of the picture, or hidden. */
bool gz_stipple_tiles_bound(const struct gz_stipple_tiles *tiles,
			    const struct gz_stipple_ball *ball, struct gz_stipple_bound *out_bound);

/** Free what it holds and zero it. */
void gz_stipple_tiles_free(struct gz_stipple_tiles *tiles);

#endif
