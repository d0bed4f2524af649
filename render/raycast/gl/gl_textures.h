/**
 * @file
 * Textures of the ray caster: voxels, macrocells and transfer tables. All calls need a current
 * context.
 */
#ifndef GZ_RENDER_RAYCAST_GL_GL_TEXTURES_H
#define GZ_RENDER_RAYCAST_GL_GL_TEXTURES_H

#include <stddef.h>

#include "base/result.h"
#include "render/data/volume.h"
#include "render/opengl/gl_device.h"
#include "render/plan/plan.h"
#include "render/raycast/shared/macrocells.h"
#include "render/transfer/transfer_table.h"

/** How voxels are stored in textures. The shaders have a variant for each (shaders/fetch.glsl). */
enum gz_gl_texels {
	/** 32 bits: a voxel and as many neighbours along x and y as fit. Fewest fetches. */
	GZ_GL_TEXELS_PACKED,
	GZ_GL_TEXELS_SINGLE, /**< one voxel, of its own size */
	GZ_GL_TEXELS_BRICKS, /**< one voxel, in the rooms of an atlas (gl_bricks.h) */
	GZ_GL_TEXELS_COUNT,
};

/** A texel format, by OpenGL's names. */
struct gz_gl_texel_format {
	unsigned internal, external, type;
	size_t bytes; /**< of a texel */
};

/** The format of texels for a voxel type. Static. */
const struct gz_gl_texel_format *gz_gl_texel_format(enum gz_gl_texels texels,
						    enum gz_voxel_type type);

/** A volume and its macrocells as textures; OpenGL's names, 0 = none. Zero-initialised holds
 * nothing. */
struct gz_gl_volume {
	unsigned voxels, reach;
	unsigned colours;         /**< of a volume that has such: a word for each voxel */
	enum gz_gl_texels texels; /**< GZ_GL_TEXELS_BRICKS: voxels is borrowed */
};

/**
 * Upload a whole volume in memory, with its colours, in place of the earlier one: packed, or if
 * there is no room for that, as single voxels. Nothing is logged.
 *
 * @retval GZ_ERR_UNSUPPORTED  an edge is beyond the device's 3D textures
 * @retval GZ_ERR_NO_MEM       the device has no room for it
 * @retval GZ_ERR_NO_DEVICE    the context is lost
 */
enum gz_result gz_gl_volume_load(struct gz_gl_volume *gl, const struct gz_gl_device *device,
				 const struct gz_volume *volume);

/** Use bricks in a borrowed @p atlas as the voxels, in place of the earlier ones. */
void gz_gl_volume_lend(struct gz_gl_volume *gl, unsigned atlas);

/** Upload the reach of classified cells, which are always those of the same volume. */
void gz_gl_volume_classify(struct gz_gl_volume *gl, const struct gz_macrocells *cells);

/** Bind both to their units, of textures and of images. */
void gz_gl_volume_bind(const struct gz_gl_volume *gl, enum gz_voxel_type type);

/** Delete the textures and zero the struct. */
void gz_gl_volume_free(struct gz_gl_volume *gl);

/** Tables of samples and of segments: one for each step of a plan, and one for extinction. */
#define GZ_GL_TABLE_ROWS (GZ_PLAN_STEPS_MAX + 1)

/** The row of samples after them: for each entry, which one is the next that shows something. */
#define GZ_GL_NEXT_VISIBLE_ROW GZ_GL_TABLE_ROWS
#define GZ_GL_SAMPLE_ROWS      (GZ_GL_TABLE_ROWS + 1)

/** Transfer tables as textures, kept by step length; OpenGL's names, 0 = none. Zero-initialised
 * holds nothing. */
struct gz_gl_tables {
	unsigned samples, segments;
	int sample_rows; /**< of the texture for each step: a finer table takes several of
			    GZ_TRANSFER_TABLE_SIZE entries, one after the other */
	/** Step length of each row or layer, voxel lengths; 0 = not yet filled. */
	double sample_length[GZ_GL_SAMPLE_ROWS], segment_length[GZ_GL_TABLE_ROWS];
};

/** The transfer function has changed: all rows are empty. */
void gz_gl_tables_forget(struct gz_gl_tables *tables);

/** Make sure that row @p row holds @p table for steps of @p length voxel lengths; row
 *  GZ_PLAN_STEPS_MAX holds the extinction and GZ_GL_NEXT_VISIBLE_ROW what shows, both for a length
 *  of 1. A row is sample_rows rows of the texture. GZ_ERR_NO_MEM: out of memory; not logged. */
enum gz_result gz_gl_tables_samples(struct gz_gl_tables *tables,
				    const struct gz_transfer_table *table, int row, double length);

/** Make sure that layer @p layer holds pre-integrated @p entries, which are for @p length. */
void gz_gl_tables_segments(struct gz_gl_tables *tables, int layer, double length,
			   const struct gz_transfer_entry *entries);

/** Bind both to their units, of textures and of images. */
void gz_gl_tables_bind(const struct gz_gl_tables *tables);

/** Delete the textures and zero the struct. */
void gz_gl_tables_free(struct gz_gl_tables *tables);

#endif
