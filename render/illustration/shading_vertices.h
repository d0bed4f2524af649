/**
 * @file
 * What shading knows of each vertex of a mesh, computed once and kept in a file.
 */
#ifndef GZ_RENDER_ILLUSTRATION_SHADING_VERTICES_H
#define GZ_RENDER_ILLUSTRATION_SHADING_VERTICES_H

#include <stddef.h>

#include "base/log.h"
#include "base/result.h"
#include "base/workers.h"
#include "render/illustration/shading_parameters.h"
#include "render/mesh/cache/mesh_cache.h"
#include "render/mesh/mesh.h"

/** The vertices of a mesh. Zero-initialised is empty. */
struct gz_shading_vertices {
	size_t count;
	/** GZ_SHADING_LEVELS arrays of count normals of length 1, one after the other: the mended
	 *  ones of the surface itself, then smoother and smoother ones. */
	float (*normals)[3];
	float (*along)[3];       /**< direction in which the surface bends most, of length 1 */
	float *greatest, *least; /**< principal curvatures, 1/mm; convex is positive */
	float curvature_scale;   /**< a curvature that shows clearly, 1/mm: the median curvedness */
};

/** Normals of level @p level, 0 to GZ_SHADING_LEVELS - 1. */
static inline const float (*gz_shading_vertices_level(const struct gz_shading_vertices *vertices,
						      int level))[3]
{
	return (const float(*)[3])(vertices->normals + (size_t)level * vertices->count);
}

/**
 * Compute what shading needs of a mesh, which may be broken: it is mended first (mesh_mend.h). If
 * @p place has a file of the same mesh, that is read instead; otherwise one is written. Where that
 * fails, a line in the log says so and the call succeeds.
 *
 * @param place    NULL: nothing is read or written
 * @param workers  share the smoothing; NULL: the calling thread alone. The same bits for any number
 * @param log      may be NULL
 * @param[out] out_vertices  written on GZ_OK; the caller frees it with gz_shading_vertices_free()
 * @retval GZ_ERR_FULL    too many triangles for gz_mesh_mend(); logged
 * @retval GZ_ERR_NO_MEM  logged
 *
 * Memory: 92 bytes for each vertex, and twice as much for a moment.
 */
enum gz_result gz_shading_vertices_make(const struct gz_mesh *mesh,
					const struct gz_mesh_cache_place *place,
					struct gz_workers *workers, const struct gz_log *log,
					struct gz_shading_vertices *out_vertices);

/** Free the arrays and zero the struct. */
void gz_shading_vertices_free(struct gz_shading_vertices *vertices);

#endif
