/**
 * @file
 * Bricks on the graphics device: a 3D texture with rooms for some of them, the atlas, and a buffer,
 * the table, that says for each brick of each level which room to read. Coarse levels are uploaded
 * at the beginning and stay, so every place has a brick; finer ones come as pictures want them. All
 * calls need a current context.
 */
#ifndef GZ_RENDER_RAYCAST_GL_GL_BRICKS_H
#define GZ_RENDER_RAYCAST_GL_GL_BRICKS_H

#include <stdbool.h>

#include "base/log.h"
#include "base/result.h"
#include "render/data/brick_pool.h"
#include "render/opengl/gl_device.h"
#include "render/raycast/gl/gl_cast.h"
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
	unsigned atlas, table; /**< texture and buffer, OpenGL's names; 0 = none */
	enum gz_voxel_type type;
	struct gz_brick_source source;
	struct gz_brick_rooms rooms;
	int along[3];           /**< rooms of the atlas along each axis */
	uint32_t *entries;      /**< the table as the shaders read it */
	uint64_t table_changes; /**< rooms.changes when the table was uploaded last */
	struct gz_brick_stream stream;
	size_t coming; /**< bricks that the last picture wanted and that come later */
};

/**
 * Make the atlas, with room for all bricks or for as many as the device has memory for, and upload
 * the coarse levels.
 *
 * @param detail  the volume with its levels; borrowed until gz_gl_bricks_free()
 * @retval GZ_ERR_NO_MEM     not even the coarsest level has room; not logged
 * @retval GZ_ERR_NO_DEVICE  the context is lost; not logged
 */
enum gz_result gz_gl_bricks_open(struct gz_gl_bricks *bricks, const struct gz_gl_device *device,
				 const struct gz_detail *detail);

/**
 * Between two pictures: upload wanted bricks that are loaded, the greatest weight first.
 *
 * @param frame  the picture; layout and entries are filled in here
 * @param wait   wait until all bricks are there that have room; else upload only as many as a
 * picture has time for
 * @retval GZ_ERR_NO_MEM  no memory for the list of wanted bricks
 */
enum gz_result gz_gl_bricks_turn(struct gz_gl_bricks *bricks, struct gz_brick_stream_frame frame,
				 bool wait);

/** Fill in the fields of @p block that lead to bricks. @p level is one of the bricks'. */
void gz_gl_bricks_fill(const struct gz_gl_bricks *bricks, int level,
		       struct gz_gl_cast_block *block);

/** Bind the table. */
void gz_gl_bricks_bind(const struct gz_gl_bricks *bricks);

/** The transfer function has changed: find the wants again. */
void gz_gl_bricks_forget(struct gz_gl_bricks *bricks);

/** Delete the texture and the buffer, free the rest, and zero the struct. */
void gz_gl_bricks_free(struct gz_gl_bricks *bricks);

/** Free and zero without a context: a lost one took texture and buffer with it. */
void gz_gl_bricks_abandon(struct gz_gl_bricks *bricks);

#endif
