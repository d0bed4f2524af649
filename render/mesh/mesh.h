/**
 * @file
 * Triangle meshes in memory.
 */
#ifndef GZ_RENDER_MESH_MESH_H
#define GZ_RENDER_MESH_MESH_H

#include <stddef.h>
#include <stdint.h>

#include "base/result.h"

/** Most vertices, and most triangles, of a mesh. Files and renderers number them in 32 bits, some
 *  of them with a sign. */
#define GZ_MESH_COUNT_MAX INT32_MAX

/** The limit of a request: @p asked, or GZ_MESH_COUNT_MAX if that is 0 or more. */
static inline uint64_t gz_mesh_count_limit(uint64_t asked)
{
	return asked > 0 && asked < GZ_MESH_COUNT_MAX ? asked : GZ_MESH_COUNT_MAX;
}

/** Readable bytes after the last element of each array, for loads of 16 bytes. */
#define GZ_MESH_PADDING 16

/**
 * A mesh: vertices, and triangles that share them. Zero-initialised is empty. Read-only once it is
 * made; any number of threads may share it.
 *
 * Positions are in the frame of the volume that the mesh stems from, in mm (or whatever unit its
 * spacing has): x right, y front, z up, and the origin at the centre of the volume's box. Divided
 * by the longest edge of the box they are world coordinates (render/data/volume.h).
 */
struct gz_mesh {
	size_t vertex_count;      /**< at most GZ_MESH_COUNT_MAX */
	size_t triangle_count;    /**< at most GZ_MESH_COUNT_MAX */
	float (*positions)[3];    /**< of each vertex; finite; NULL if there are no vertices */
	float (*normals)[3];      /**< of each vertex, of length 1, out of the object */
	uint32_t (*triangles)[3]; /**< numbers of vertices, counter-clockwise seen from outside;
				       NULL if there are no triangles */
	/** How many of the triangles, the last ones, a neighbouring mesh has, too, reversed: what
	 *  is seen of them from behind is the neighbour. */
	size_t shared_count;
};

/**
 * Allocate a mesh whose elements are undefined.
 *
 * @param[out] out_mesh  written on GZ_OK; the caller frees it with gz_mesh_free()
 * @retval GZ_ERR_FULL    a count is above GZ_MESH_COUNT_MAX; not logged
 * @retval GZ_ERR_NO_MEM  not logged
 */
enum gz_result gz_mesh_allocate(uint64_t vertex_count, uint64_t triangle_count,
				struct gz_mesh *out_mesh);

/**
 * Copy a mesh.
 *
 * @param[out] out_copy  written on GZ_OK; the caller frees it with gz_mesh_free()
 * @return otherwise as gz_mesh_allocate()
 */
enum gz_result gz_mesh_copy(const struct gz_mesh *mesh, struct gz_mesh *out_copy);

/** Free the arrays and zero the struct. Accepts a zero-initialised mesh. */
void gz_mesh_free(struct gz_mesh *mesh);

#endif
