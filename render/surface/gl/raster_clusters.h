/**
 * @file
 * The triangles of a mesh in clusters that lie close together, so that a layer draws only those
 * that it may show. Pure geometry, without a context.
 */
#ifndef GZ_RENDER_SURFACE_GL_RASTER_CLUSTERS_H
#define GZ_RENDER_SURFACE_GL_RASTER_CLUSTERS_H

#include <stddef.h>
#include <stdint.h>

#include "base/result.h"
#include "render/layers/raster_layers.h"
#include "render/mesh/mesh.h"
#include "render/surface/gl/raster_view.h"

/** Triangles that lie in one block of space. */
struct gz_raster_cluster {
	size_t first, corners; /**< in the reordered list of corners, three a triangle */
	struct gz_raster_box box;
};

/** Consecutive corners to draw. */
struct gz_raster_run {
	size_t first, corners;
};

/** The clusters of a mesh. Zero-initialised is empty. */
struct gz_raster_clusters {
	struct gz_raster_cluster *items; /**< in the order of their corners */
	size_t count;
	size_t own_count; /**< of triangles that no neighbour has too; they come first */
};

/**
 * Sort the triangles of a mesh into clusters. Those that a neighbour has too stay behind the others
 * (gz_mesh.shared_count); within a cluster the mesh's order stays.
 *
 * @param[out] out_triangles  room for as many as the mesh has
 * @param[out] out_clusters   the caller's: gz_raster_clusters_free()
 * @retval GZ_ERR_NO_MEM  not logged
 */
enum gz_result gz_raster_clusters_make(const struct gz_mesh *mesh, uint32_t (*out_triangles)[3],
				       struct gz_raster_clusters *out_clusters);

/**
 * Choose what a lattice may show of clusters: neither what lies beside it nor what lies where only
 * finer layers show.
 *
 * @param from, to       clusters [from, to)
 * @param[out] out_runs  room for to - from of them
 * @return how many; clusters behind each other share one
 */
size_t gz_raster_clusters_choose(const struct gz_raster_clusters *clusters, size_t from, size_t to,
				 const struct gz_raster_view *view,
				 const struct gz_raster_layer *lattice,
				 struct gz_raster_run *out_runs);

/** Free and zero. */
void gz_raster_clusters_free(struct gz_raster_clusters *clusters);

#endif
