/**
 * @file
 * The strokes of a mesh (hatch_strokes.h), kept in a file so that the next start need not trace
 * them again.
 */
#ifndef GZ_RENDER_ILLUSTRATION_CACHED_STROKES_H
#define GZ_RENDER_ILLUSTRATION_CACHED_STROKES_H

#include <stddef.h>

#include "base/log.h"
#include "base/result.h"
#include "render/illustration/hatch_strokes.h"
#include "render/mesh/cache/mesh_cache.h"
#include "render/mesh/mesh.h"

/** What strokes are made of besides the mesh. */
struct gz_cached_strokes_kind {
	size_t points; /**< from which they start */
	int passes;    /**< of gz_hatch_directions() */
	double share;  /**< their last distance, in that of so many points */
	int across;    /**< 0: along the directions; 1: across them */
};

/**
 * Read strokes from the file of the same mesh and kind.
 *
 * @param log  may be NULL
 * @param[out] out_strokes  written on GZ_OK, the same as were stored; the caller frees it with
 *                          gz_hatch_strokes_free()
 * @retval GZ_ERR_NOT_FOUND  there is no such file; not logged
 * @retval GZ_ERR_FORMAT     what it has are no strokes
 * @return otherwise as gz_mesh_cache_load_whole()
 */
enum gz_result gz_cached_strokes_load(const struct gz_mesh *mesh,
				      const struct gz_cached_strokes_kind *kind,
				      const struct gz_mesh_cache_place *place,
				      const struct gz_log *log,
				      struct gz_hatch_strokes *out_strokes);

/**
 * Write strokes to a file. Those of more than 256 MiB are not kept.
 *
 * @return as gz_mesh_cache_store(); GZ_ERR_FULL: there are too many
 */
enum gz_result gz_cached_strokes_store(const struct gz_mesh *mesh,
				       const struct gz_cached_strokes_kind *kind,
				       const struct gz_mesh_cache_place *place,
				       const struct gz_log *log,
				       const struct gz_hatch_strokes *strokes);

#endif
