/**
 * @file
 * Measures of a mesh: its size, and whether its triangles form a surface.
 */
#ifndef GZ_RENDER_MESH_MESH_MEASURE_H
#define GZ_RENDER_MESH_MESH_MEASURE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/result.h"
#include "render/mesh/mesh.h"

/** What gz_mesh_measure() finds. An edge joins two corners of a triangle; all triangles with both
 *  corners share it. */
struct gz_mesh_measures {
	double area;   /**< sum over all triangles, mm² */
	double volume; /**< enclosed, mm³; above 0 if the triangles face outwards. Means something
			    only if the mesh is closed */
	size_t edges;
	size_t border_edges;  /**< of one triangle */
	size_t crowded_edges; /**< of more than two triangles */
	size_t turned_edges;  /**< of two triangles that face opposite sides */
	/** Vertices that triangles use, less edges, plus triangles: 2 for each closed surface
	 * without a handle, 2 less for each handle. */
	int64_t euler;
};

/**
 * Measure a mesh. The same result each time.
 *
 * @param mesh  each number of a vertex is below its vertex_count
 * @param[out] out_measures  written on GZ_OK; all 0 for an empty mesh
 * @retval GZ_ERR_NO_MEM  not logged
 *
 * Memory: 12 bytes for each triangle and 8 for each vertex. Threads: any, for any meshes.
 */
enum gz_result gz_mesh_measure(const struct gz_mesh *mesh, struct gz_mesh_measures *out_measures);

/** Whether every edge belongs to exactly two triangles that face the same side. True for an empty
 *  mesh. */
bool gz_mesh_closed(const struct gz_mesh_measures *measures);

#endif
