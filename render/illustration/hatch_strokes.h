/**
 * @file
 * Hatching: strokes traced over a mesh along directions of its vertices, in an order of which every
 * beginning lies evenly: few long strokes far apart first, then ever shorter ones between them.
 * This is what tonal art maps (Praun, Hoppe, Webb and Finkelstein, "Real-time hatching", SIGGRAPH
 * 2001) hold for a flat patch, nested over tones and scales, made for the surface itself, so that
 * nothing needs texture coordinates.
 *
 * Strokes are streamlines that keep a distance (Jobard and Lefer, "Creating evenly-spaced
 * streamlines of arbitrary density", 1997). The distance falls in steps by the square root of 2. In
 * each step strokes start from the points of mesh_points.h that are at least the distance away
 * from all strokes, and run both ways until they come nearer than GZ_HATCH_NEAR of it to one, are
 * long enough, or reach a border.
 */
#ifndef GZ_RENDER_ILLUSTRATION_HATCH_STROKES_H
#define GZ_RENDER_ILLUSTRATION_HATCH_STROKES_H

#include <stddef.h>
#include <stdint.h>

#include "base/result.h"
#include "base/stop.h"
#include "render/mesh/mesh.h"
#include "render/mesh/mesh_curvature.h"
#include "render/mesh/mesh_points.h"

/** How near strokes come to others, as a share of the step's distance. Chosen, as by
 * Jobard and Lefer: half would leave pairs, all of it many short pieces. */
#define GZ_HATCH_NEAR 0.6

/** Most corners of all strokes. Chosen: 1.5 GiB while strokes are traced. */
#define GZ_HATCH_NODES_MAX ((size_t)1 << 25)

/** A corner of a stroke. */
struct gz_hatch_node {
	float place[3];  /**< mm */
	float normal[3]; /**< of the triangle, of length 1 */
};

/** Nodes at each end of a stroke over which it becomes pointed, as a pen does. */
#define GZ_HATCH_POINTED 2

/** A stroke: its corners, and the length of all strokes before it, less their points. */
struct gz_hatch_stroke {
	uint32_t first, count; /**< nodes; at least 2 */
	float before_mm;
};

/** The strokes of a mesh. Zero-initialised is empty. Read-only once made; any number of threads may
 *  share it. */
struct gz_hatch_strokes {
	size_t stroke_count, node_count;
	struct gz_hatch_stroke *strokes; /**< in their order */
	struct gz_hatch_node *nodes;
	double length_mm; /**< of all strokes, less their points */
	double area_mm2;  /**< of the mesh */
};

/**
 * Directions along which illustrators hatch: that of the least curvature, along a tube and across
 * the bend of a ridge. Where both curvatures are alike there is none; directions of other vertices
 * spread there. So they do where directions contradict each other, from about four times as far: on
 * noisy scans strokes run along the form, not along the noise.
 *
 * @param curvatures  of each vertex of @p mesh, by gz_mesh_curvatures()
 * @param passes      how far directions spread and are smoothed, in edges, 0 to 1000
 * @param stop        ends it early (base/stop.h); NULL: nothing does
 * @param[out] out_directions  of each vertex: a unit vector across the normal, of either sign, or 0
 *                             where none came; written on GZ_OK
 * @retval GZ_ERR_INVAL   @p passes is out of range; not logged
 * @retval GZ_ERR_CANCELLED  it was ended
 * @retval GZ_ERR_NO_MEM  not logged
 */
enum gz_result gz_hatch_directions(const struct gz_mesh *mesh,
				   const struct gz_curvature *curvatures, int passes,
				   const atomic_bool *stop, float (*out_directions)[3]);

/** Turn directions by a right angle about the normals, for a second layer that crosses the first.
 */
void gz_hatch_cross_directions(const struct gz_mesh *mesh, const float (*directions)[3],
			       float (*out_directions)[3]);

/**
 * Trace the strokes of a mesh. The same bits each time.
 *
 * @param directions   of each vertex: along the strokes, mm of any length; the sign does not count;
 * 0 and NaN: no stroke passes
 * @param points       of this mesh; a step starts strokes from the first four for the square of its
 *                     distance, or from all if there are fewer
 * @param distance_mm  of the last step, above 0; the mean distance of all strokes is about 1.1 of
 *                     it
 * @param stop         ends it early (base/stop.h); NULL: nothing does
 * @param[out] out_strokes  written on GZ_OK; the caller frees it with gz_hatch_strokes_free()
 * @retval GZ_ERR_INVAL   @p distance_mm is out of range; not logged
 * @retval GZ_ERR_CANCELLED  it was ended
 * @retval GZ_ERR_NO_MEM  not logged
 *
 * If strokes reach GZ_HATCH_NODES_MAX corners, the others are left out.
 */
enum gz_result gz_hatch_strokes_make(const struct gz_mesh *mesh, const float (*directions)[3],
				     const struct gz_mesh_points *points, double distance_mm,
				     const atomic_bool *stop, struct gz_hatch_strokes *out_strokes);

/** Free what it holds and zero it. */
void gz_hatch_strokes_free(struct gz_hatch_strokes *strokes);

#endif
