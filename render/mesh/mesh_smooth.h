/**
 * @file
 * Normals of a mesh smoothed over wider and wider neighbourhoods.
 */
#ifndef GZ_RENDER_MESH_MESH_SMOOTH_H
#define GZ_RENDER_MESH_MESH_SMOOTH_H

#include "base/result.h"
#include "base/workers.h"
#include "render/mesh/mesh.h"

/** Most levels of smoothed normals, without the mesh's own. Chosen: the last one has spread over
 *  about 16 edges, beyond which only the whole form is left. */
#define GZ_MESH_SMOOTH_LEVELS_MAX 8

/**
 * Smooth the normals of a mesh in levels, as exaggerated shading wants them (Rusinkiewicz, Burns
 * and DeCarlo, "Exaggerated shading for depicting shape and detail", SIGGRAPH 2006): from each
 * level to the next the neighbourhood widens by about the square root of 2.
 *
 * A step gives each vertex the mean of its own normal and those of its neighbours, weighted by the
 * area around each and by a Gaussian of its distance, whose standard deviation is the root of the
 * mean squared edge length of the mesh. Variances add up, so level i, from 0, is the normals after
 * 2^(i+1) - 1 steps. Where a mean has no length the vertex keeps its normal. Vertices of no
 * triangle keep theirs in all levels; rims of holes have the neighbours that are there.
 *
 * @param mesh     with normals of length 1; each number of a vertex is below its vertex_count
 * @param levels   1 to GZ_MESH_SMOOTH_LEVELS_MAX
 * @param workers  share the vertices; NULL: the calling thread alone. The same bits for any number
 * @param[out] out_normals  @p levels arrays of vertex_count normals of length 1, one after the
 * other
 * @retval GZ_ERR_INVAL   @p levels is out of range
 * @retval GZ_ERR_NO_MEM  not logged
 *
 * Memory: 32 bytes for each vertex and 48 for each triangle.
 */
enum gz_result gz_mesh_smooth_normals(const struct gz_mesh *mesh, int levels,
				      struct gz_workers *workers, float (*out_normals)[3]);

#endif
