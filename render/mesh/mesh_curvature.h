/**
 * @file
 * How surfaces bend: principal curvatures and their directions at each vertex.
 */
#ifndef GZ_RENDER_MESH_MESH_CURVATURE_H
#define GZ_RENDER_MESH_MESH_CURVATURE_H

#include "base/result.h"
#include "render/mesh/mesh.h"

/** Curvature at a vertex. Convex places, as of a ball, have positive curvatures. */
struct gz_curvature {
	float greatest, least; /**< principal curvatures, 1/mm; greatest >= least */
	float along[3];        /**< unit vector in which the surface bends by `greatest`; across the
				    normal. That of `least` is normal x along */
};

/**
 * Compute the curvature of each vertex from the normals of the triangles' corners (Rusinkiewicz,
 * "Estimating curvatures and their derivatives on triangle meshes", 3DPVT 2004): the second
 * fundamental form of each triangle by least squares, averaged over the triangles of a vertex by
 * the shares of their areas that lie nearest to it (Meyer et al. 2003). Triangles without an area
 * count nothing; a vertex without others has curvature 0. Which way round the corners of a triangle
 * are listed does not matter: the normals say where outside is.
 *
 * @param mesh  with normals; each number of a vertex is
 * below its vertex_count
 * @param[out] out_curvatures  vertex_count elements; written on GZ_OK
 * @retval GZ_ERR_NO_MEM  not logged
 *
 * Threads: any. The same bits each time.
 */
enum gz_result gz_mesh_curvatures(const struct gz_mesh *mesh, struct gz_curvature *out_curvatures);

#endif
