/**
 * @file
 * Points spread over a mesh, in an order of which every beginning is spread evenly: blue noise at
 * each density. Nothing needs texture coordinates.
 *
 * The method is Poisson-disc sampling by darts with a radius that shrinks (McCool and Fiume,
 * "Hierarchical Poisson disk sampling distributions", Graphics Interface 1992) on the triangles
 * themselves. The radius falls in steps by the eighth root of 2. In each step darts are thrown
 * evenly by area, and those that are at least the radius away from all points before them stay. The
 * first n points are therefore at least GZ_MESH_POINTS_APART * sqrt(area / n) apart for every n,
 * up to the accuracy with which darts fill the surface, and cover it without large gaps.
 *
 * Distances are Euclidean. Points whose normals are more than 120 degrees apart are on two sides
 * of a thin part and do not keep others away.
 */
#ifndef GZ_RENDER_MESH_MESH_POINTS_H
#define GZ_RENDER_MESH_MESH_POINTS_H

#include <stddef.h>
#include <stdint.h>

#include "base/result.h"
#include "base/stop.h"
#include "base/workers.h"
#include "render/mesh/mesh.h"

/** Most points of a mesh. Chosen: sixteen for each pixel of a large screen. */
#define GZ_MESH_POINTS_MAX ((size_t)1 << 25)

/** Least distance of the first n points as a share of sqrt(area / n): 1.0746 is that of a hexagonal
 *  lattice. Measured on a ball, a ring and a plane, for n from 100 on. */
#define GZ_MESH_POINTS_APART 0.63

/** A point on a triangle. Its place is (1 - across[0] - across[1]) times the triangle's first
 *  corner, plus across[0] times the second, plus across[1] times the third. */
struct gz_mesh_point {
	uint32_t triangle;
	float across[2]; /**< 0 or more, of sum 1 or less */
};

/** The points of a mesh. Zero-initialised is empty. A point's rank is its number. */
struct gz_mesh_points {
	size_t count;
	struct gz_mesh_point *points; /**< by rank; NULL if there are none */
	double area_mm2;              /**< of all triangles */
};

/**
 * Spread points over a mesh. The same points for any number of threads.
 *
 * @param mesh     as gz_mesh_read() and the makers of surfaces leave it; @p count points need
 *                 triangles of some area, otherwise there are none
 * @param count    0 to GZ_MESH_POINTS_MAX
 * @param workers  share the work; NULL for the calling thread alone
 * @param stop     ends it early (base/stop.h); NULL: nothing does
 * @param[out] out_points  written on GZ_OK; the caller frees it with gz_mesh_points_free()
 * @retval GZ_ERR_INVAL   @p count is above GZ_MESH_POINTS_MAX; not logged
 * @retval GZ_ERR_CANCELLED  it was ended
 * @retval GZ_ERR_NO_MEM  not logged
 *
 * Memory: about 140 bytes for each point while it works, 12 afterwards; 8 for each triangle.
 */
enum gz_result gz_mesh_points_make(const struct gz_mesh *mesh, size_t count,
				   struct gz_workers *workers, const atomic_bool *stop,
				   struct gz_mesh_points *out_points);

/** Where a point lies, mm. */
void gz_mesh_point_place(const struct gz_mesh *mesh, const struct gz_mesh_point *point,
			 float out_place[3]);

/** Free what it holds and zero it. Accepts a zero-initialised struct. */
void gz_mesh_points_free(struct gz_mesh_points *points);

#endif
