/**
 * @file
 * The surface where the data have one value, as a mesh, by marching cubes (Lorensen and Cline,
 * "Marching cubes: a high resolution 3D surface construction algorithm", SIGGRAPH 1987).
 *
 * Voxel centres are the corners of cubes. Each edge of a cube that the surface crosses has one
 * vertex, placed by linear interpolation. Ambiguous faces are decided by the saddle of the values'
 * bilinear interpolation (Nielson and Hamann, "The asymptotic decider: resolving the ambiguity in
 * marching cubes", Visualization 1991), which both cubes beside the face find alike. The surface is
 * therefore closed except where it leaves the volume: any other edge of a triangle belongs to
 * exactly two triangles, which run along it in opposite directions.
 *
 * The work is shared out by rows of voxels, as in Schroeder, Maynard and Geveci, "Flying edges: a
 * high-performance scalable isocontouring algorithm", LDAV 2015, with one bit a voxel: voxels are
 * classified, vertices and triangles of each row counted and their places summed up, then all are
 * written where they belong. The same mesh, bits and order, for any number of threads.
 */
#ifndef GZ_RENDER_MESH_ISOSURFACE_H
#define GZ_RENDER_MESH_ISOSURFACE_H

#include <stdbool.h>

#include "base/log.h"
#include "base/result.h"
#include "base/workers.h"
#include "render/data/volume.h"
#include "render/mesh/mesh.h"

/** Ranges of the stored values of blocks of voxels, by which voxels need not be read. The ray
 *  caster's macrocells are such blocks. */
struct gz_value_blocks {
	int edge;    /**< of a block, voxels; above 0 */
	int dims[3]; /**< blocks along x, y, z: dims of the volume / edge, rounded up */
	/** Of each block (i, j, k): bounds of the voxels from edge * i, edge * j, edge * k on.
	 * Wider ones are right too. Volumes with NaN have no such bounds. Borrowed. */
	const float *least, *greatest;
};

/** Which surface to make. */
struct gz_isosurface_request {
	const struct gz_volume *volume;       /**< in memory; borrowed */
	double isovalue;                      /**< data value: slope and intercept applied */
	const struct gz_value_blocks *blocks; /**< optional: makes skipping faster; borrowed */
	/** Most vertices, and most triangles; 0 or more than GZ_MESH_COUNT_MAX: that many. */
	uint64_t elements_max;
	bool portable; /**< without the loops for AVX2, which give the same bits: for comparison */
};

/**
 * Make the surface. What is at or above the isovalue is inside; normals are central differences of
 * the data, interpolated along the edge, and point outwards. Where the data have no gradient, the
 * normal runs along the vertex's edge.
 *
 * NaN counts as a stored value below the isovalue. Where it meets a value above, the vertex lies
 * midway. The surface is as closed as any other. Loaded volumes contain no NaN
 * (render/data/volume.h).
 *
 * @param workers  share the work; NULL for the calling thread alone
 * @param[out] out_mesh  written on GZ_OK; the caller frees it with gz_mesh_free(). Empty if the
 * data do not cross the isovalue or the volume has an edge of one voxel, which is logged as a
 * warning
 * @retval GZ_ERR_INVAL        the isovalue is not finite; logged
 * @retval GZ_ERR_UNSUPPORTED  the volume is stored in bricks; logged
 * @retval GZ_ERR_FULL         more vertices or triangles than elements_max; logged
 * @retval GZ_ERR_NO_MEM       logged
 *
 * Memory besides the mesh: a bit for each voxel and 12 bytes for each row of voxels.
 */
enum gz_result gz_isosurface_make(const struct gz_isosurface_request *request,
				  struct gz_workers *workers, const struct gz_log *log,
				  struct gz_mesh *out_mesh);

/** Log a warning that a volume has no surface at an isovalue, and which values it has. */
void gz_isosurface_warn_of_emptiness(const struct gz_volume *volume, double isovalue,
				     const struct gz_log *log);

#endif
