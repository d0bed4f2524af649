/**
 * @file
 * The loops over rows of voxels for each instruction set; internal to the extraction of
 * isosurfaces. isosurface_kernels.c and isosurface_kernels_avx2.c compile the same loops
 * (isosurface_cubes.h, isosurface_vertices.h). Nothing in them is fused, so the bits are the same.
 */
#ifndef GZ_RENDER_MESH_ISOSURFACE_KERNELS_H
#define GZ_RENDER_MESH_ISOSURFACE_KERNELS_H

#include "render/mesh/isosurface_rows.h"

/** What is done with a row of voxels. Threads: any, for different rows. */
struct gz_iso_kernels {
	/** Count a row's edges and triangles; all bits are known. */
	void (*count_row)(const struct gz_iso_job *job, size_t row);
	/** Write a row's triangles; all rows are summed. */
	void (*write_triangles)(const struct gz_iso_job *job, size_t row);
	/** Write a row's vertices; all rows are summed. */
	void (*write_vertices)(const struct gz_iso_job *job, size_t row);
};

extern const struct gz_iso_kernels gz_iso_kernels_portable;
#ifdef GZ_MESH_X86
extern const struct gz_iso_kernels gz_iso_kernels_avx2;
#endif

/** The best that this processor runs. Static. */
const struct gz_iso_kernels *gz_iso_kernels_find(void);

#endif
