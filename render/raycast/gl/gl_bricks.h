/**
 * @file
 * Bricks on the graphics device: a 3D texture with rooms for some of them, the atlas, and a buffer
 * that tells the shaders which room each place of each level leads to. Coarse levels are there from
 * the beginning and stay, so that every place has a brick; finer ones come as pictures want them.
 * All calls need the context current.
 */
#ifndef GZ_RENDER_RAYCAST_GL_GL_BRICKS_H
#define GZ_RENDER_RAYCAST_GL_GL_BRICKS_H

#include <stdbool.h>

#include "base/log.h"
#include "base/result.h"
#include "render/data/brick_pool.h"
#include "render/opengl/gl_device.h"
#include "render/raycast/gl/cast_block.h"
#include "render/raycast/shared/brick_stream.h"
#include "render/raycast/shared/detail.h"

/** The bricks of any volume: those of a file, loaded when they are wanted, or cut out of a volume
 * in memory and its levels. Zero-initialised is none. */
struct gz_brick_source {
	const struct gz_brick_layout *layout;
	const struct gz_brick_entry
		*entries;    /**< by a brick's number; cut bricks: only the range */
	size_t rooms_useful; /**< no more bricks than this are loaded at once */
	/* for a file */
	struct gz_brick_pool *pool; /**< borrowed; NULL for a volume in memory */
	struct gz_brick_view view;
	/* for a volume in memory */
	const struct gz_detail *detail; /**< borrowed */
	struct gz_brick_layout cut_layout;
	struct gz_brick_entry *cut_entries;
	void *cut; /**< the brick cut last */
};

/** Zero-initialised is none. */
struct gz_gl_bricks {
	unsigned atlas, table; /**< texture and buffer, names of OpenGL; 0: none */
	enum gz_voxel_type type;
	struct gz_brick_source source;
	struct gz_brick_rooms rooms;
	int along[3];           /**< rooms of the atlas along each axis */
	uint32_t *entries;      /**< the table as the shaders read it */
	uint64_t table_changes; /**< of the books, that the buffer has */
	struct gz_brick_stream stream;
	size_t coming; /**< bricks that the last picture wanted and will have later */
};

/**
 * Make the atlas and put the coarse levels in: room for all bricks, or for as many as the device
 * has memory for.
 *
 * @param detail  the volume with its levels; borrowed until gz_gl_bricks_free()
 * @retval GZ_ERR_NO_MEM     not even the coarsest level has room; not logged
 * @retval GZ_ERR_NO_DEVICE  the context is lost; not logged
 */
enum gz_result gz_gl_bricks_open(struct gz_gl_bricks *bricks, const struct gz_gl_device *device,
				 const struct gz_detail *detail);

/**
 * Between two pictures: give the device what is wanted and has come, the greatest weight first.
 *
 * @param frame  what the picture is of; layout and entries are filled in here
 * @param wait   until all is there that has room; else only so much is given to the device as a
 *               picture has time for
 * @retval GZ_ERR_NO_MEM  no room for the list of what is wanted
 */
enum gz_result gz_gl_bricks_turn(struct gz_gl_bricks *bricks, struct gz_brick_stream_frame frame,
				 bool wait);

/** Fill what of @p block leads from a level of detail's places to bricks. @p level: of the bricks.
 */
void gz_gl_bricks_fill(const struct gz_gl_bricks *bricks, int level,
		       struct gz_gl_cast_block *block);

/** Bind the table. */
void gz_gl_bricks_bind(const struct gz_gl_bricks *bricks);

/** What is wanted has changed with the transfer function. */
void gz_gl_bricks_forget(struct gz_gl_bricks *bricks);

/** Delete the texture and the buffer, free the rest, and zero the struct. */
void gz_gl_bricks_free(struct gz_gl_bricks *bricks);

/** The same without a context, whose texture and buffer are gone with it. */
void gz_gl_bricks_abandon(struct gz_gl_bricks *bricks);

#endif
