/**
 * @file
 * The normals of a triangle's corners in one record of 12 bytes. A ray that has met the triangle
 * reads one or two lines of memory; it would read up to four for the numbers of the corners and
 * three floats of each.
 *
 * A normal is a point of an octahedron that is unfolded into a square (Cigolle et al., "A Survey of
 * Efficient Representations for Independent Unit Vectors", JCGT 2014), 16 bits along each edge: it
 * is kept to 0.00007 radians.
 */
#ifndef GZ_RENDER_SURFACE_CPU_SURFACE_NORMALS_H
#define GZ_RENDER_SURFACE_CPU_SURFACE_NORMALS_H

#include <stddef.h>
#include <stdint.h>

#include "base/result.h"
#include "base/workers.h"
#include "render/mesh/mesh.h"

/** A coordinate of the square from -1 to 1, times this, is a whole number: the second one in the
 *  upper half of a word, signed, and the first one in the lower half, with GZ_NORMAL_OFFSET added.
 */
#define GZ_NORMAL_UNIT   32767
#define GZ_NORMAL_OFFSET 32768

/** The normals of a triangle's corners. */
struct gz_corner_normals {
	uint32_t corner[3];
};

/** Pack a vector of any length. One that has no direction, such as 0 or NaN, becomes (0, 0, 1). */
uint32_t gz_normal_pack(const float vector[3]);

/**
 * Pack the normals of all triangles of some meshes.
 *
 * @param[out] out_normals  of each triangle of the first mesh, then of the next ones; NULL if there
 *                          are no triangles; the caller frees it with free()
 * @retval GZ_ERR_NO_MEM  not logged
 */
enum gz_result gz_corner_normals_make(const struct gz_mesh meshes[], size_t mesh_count,
				      struct gz_workers *workers,
				      struct gz_corner_normals **out_normals);

#endif
