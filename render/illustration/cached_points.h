/**
 * @file
 * The points of a mesh (mesh_points.h), kept in a file so that the next start need not make them
 * again.
 */
#ifndef GZ_RENDER_ILLUSTRATION_CACHED_POINTS_H
#define GZ_RENDER_ILLUSTRATION_CACHED_POINTS_H

#include <stddef.h>

#include "base/log.h"
#include "base/result.h"
#include "base/stop.h"
#include "base/workers.h"
#include "render/mesh/cache/mesh_cache.h"
#include "render/mesh/mesh.h"
#include "render/mesh/mesh_points.h"

/**
 * Read the points of a mesh from the file of the same mesh and count; if there is none, make them
 * and write it. Where that fails, a line in the log says so and the call succeeds. Meshes of more
 * than 2^24 triangles are not kept.
 *
 * @param place  NULL: nothing is read or written
 * @param stop   as for gz_mesh_points_make()
 * @param log    may be NULL
 * @param[out] out_points  the same whether read or made; as for gz_mesh_points_make()
 * @return as gz_mesh_points_make()
 *
 * Memory: 12 bytes for each point besides.
 */
enum gz_result gz_cached_points_make(const struct gz_mesh *mesh, size_t count,
				     const struct gz_mesh_cache_place *place,
				     struct gz_workers *workers, const atomic_bool *stop,
				     const struct gz_log *log, struct gz_mesh_points *out_points);

#endif
