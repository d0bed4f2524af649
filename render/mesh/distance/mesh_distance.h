/**
 * @file
 * The distance of points from the surface of a mesh.
 */
#ifndef GZ_RENDER_MESH_DISTANCE_MESH_DISTANCE_H
#define GZ_RENDER_MESH_DISTANCE_MESH_DISTANCE_H

#include <stddef.h>

#include "base/log.h"
#include "base/result.h"
#include "base/workers.h"
#include "render/mesh/mesh.h"

/**
 * Find how far each of some points is from the nearest point of a mesh's triangles. Exact but for
 * the rounding of doubles: Embree's point query only leaves out triangles that cannot be nearest.
 * Triangles without an area count as what they are, a line or a point.
 *
 * @param target   each number of a vertex is below its vertex_count
 * @param places   @p count points in the same frame, mm; finite
 * @param workers  share the points; NULL: the calling thread alone. The same bits for any number
 * @param log      may be NULL
 * @param[out] out_distances_mm  @p count distances, 0 or more; INFINITY if the target has no
 *                               triangles
 * @retval GZ_ERR_UNSUPPORTED  this build has no Embree, or it does not start here; logged
 * @retval GZ_ERR_NO_MEM       logged
 */
enum gz_result gz_mesh_distances(const struct gz_mesh *target, const float (*places)[3],
				 size_t count, struct gz_workers *workers, const struct gz_log *log,
				 float *out_distances_mm);

#endif
