/**
 * @file
 * What a camera sees of a mesh, without a renderer: distance, number and a shading map by a plain
 * depth buffer. For illustration_drawing.
 */
#ifndef GZ_BENCH_PROBES_DRAWING_PLANES_H
#define GZ_BENCH_PROBES_DRAWING_PLANES_H

#include "base/result.h"
#include "render/mesh/mesh.h"
#include "render/picture/camera.h"
#include "render/picture/plane.h"

/** Planes of one picture. Zero-initialised is empty. */
struct drawing_planes {
	struct gz_plane tone, depth, ids;
};

/** Draw a mesh whose number is 1, lit from the upper left: tone is (1 + l·n) / 2, and 1 beside the
 *  mesh. Triangles that reach behind the eye are left out. */
enum gz_result drawing_planes_make(const struct gz_mesh *mesh, double world_per_mm,
				   const struct gz_camera *camera, const int size[2],
				   struct drawing_planes *planes);

/** Free the planes. */
void drawing_planes_free(struct drawing_planes *planes);

#endif
