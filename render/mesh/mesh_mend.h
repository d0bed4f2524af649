/**
 * @file
 * Mending meshes of uncertain origin: triangles that face different sides, and normals that are
 * missing or point into the object.
 */
#ifndef GZ_RENDER_MESH_MESH_MEND_H
#define GZ_RENDER_MESH_MESH_MEND_H

#include <stddef.h>

#include "base/result.h"
#include "render/mesh/mesh.h"

/** What gz_mesh_mend() changed. */
struct gz_mesh_mending {
	size_t turned_triangles; /**< whose corners are now listed the other way round */
	size_t flat_triangles;   /**< without an area: left in place, they count nothing */
	size_t new_normals;      /**< that were not of length 1, or opposed their triangles */
};

/**
 * Turn triangles so that neighbours face the same side, and make the normals that are missing.
 *
 * Triangles that share an edge with exactly one other are neighbours. Each connected part faces the
 * side to which most of its normals point, by area; without normals, the side that makes its volume
 * positive. Of a surface with one side only (a Moebius strip) some edge stays turned. A normal that
 * is not finite or not of length 1 within 0.001, or that points away from the mean of its vertex's
 * triangles by area, becomes that mean; 0 0 1 if there is none. Holes stay holes.
 *
 * @param mesh  each number of a vertex is below its vertex_count; triangles and normals are changed
 * @param[out] out_mending  written on GZ_OK; may be NULL
 * @retval GZ_ERR_FULL    more than 1431655764 triangles; the mesh is unchanged; not logged
 * @retval GZ_ERR_NO_MEM  the mesh is unchanged; not logged
 *
 * Memory: about 60 bytes for each triangle. Threads: any, for any meshes. The same result each
 * time.
 */
enum gz_result gz_mesh_mend(struct gz_mesh *mesh, struct gz_mesh_mending *out_mending);

#endif
