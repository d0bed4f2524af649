/**
 * @file
 * Transfer tables as textures, kept by the step length that they are for. All calls need the
 * context current.
 */
#ifndef GZ_RENDER_RAYCAST_GL_GL_TABLES_H
#define GZ_RENDER_RAYCAST_GL_GL_TABLES_H

#include "render/plan/plan.h"
#include "render/transfer/transfer_table.h"

/** Rows of tables: one for each step of a plan, and one with extinction. */
#define GZ_GL_TABLE_ROWS (GZ_PLAN_STEPS_MAX + 1)

/** Textures; names of OpenGL, 0: none. Zero-initialised holds nothing. */
struct gz_gl_tables {
	unsigned samples, segments;
	/** Voxel lengths that a row or layer is for; 0 = none yet. */
	double sample_length[GZ_GL_TABLE_ROWS], segment_length[GZ_GL_TABLE_ROWS];
};

/** The transfer function has changed: no row holds anything. */
void gz_gl_tables_forget(struct gz_gl_tables *tables);

/** Make sure that row @p row holds @p table for steps of @p length voxel lengths; row
 *  GZ_PLAN_STEPS_MAX holds the extinction, for a length of 1. */
void gz_gl_tables_samples(struct gz_gl_tables *tables, const struct gz_transfer_table *table,
			  int row, double length);

/** Make sure that layer @p layer holds pre-integrated @p entries, which are for @p length. */
void gz_gl_tables_segments(struct gz_gl_tables *tables, int layer, double length,
			   const struct gz_transfer_entry *entries);

/** Bind both to their units, of textures and of images. */
void gz_gl_tables_bind(const struct gz_gl_tables *tables);

/** Delete the textures and zero the struct. */
void gz_gl_tables_free(struct gz_gl_tables *tables);

#endif
