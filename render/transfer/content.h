/**
 * @file
 * Where a transfer function shows something of a volume.
 */
#ifndef GZ_RENDER_TRANSFER_CONTENT_H
#define GZ_RENDER_TRANSFER_CONTENT_H

#include "render/data/clip_region.h"
#include "render/data/volume.h"
#include "render/transfer/transfer.h"

/**
 * Find the box around what a transfer function shows, without its last few specks: at most 4
 * million voxels on a grid are looked at.
 *
 * @param within  what lies outside is not shown
 * @param[out] out_content  a box within that of @p within, with the same plane; the same if the
 * volume has bricks, of which not all are in memory, or if nothing is seen of it
 *
 * Threads: any. Takes some 10 ms.
 */
void gz_content_find(const struct gz_volume *volume, const struct gz_transfer *transfer,
		     const struct gz_clip_region *within, struct gz_clip_region *out_content);

#endif
