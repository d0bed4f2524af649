/**
 * @file
 * Small meshes of known shape, for the tests of what is computed of meshes.
 */
#ifndef GZ_TESTS_RENDER_MESH_SHAPES_H
#define GZ_TESTS_RENDER_MESH_SHAPES_H

#include "render/mesh/mesh.h"

/** A closed ball without a pole: an octahedron whose triangles are quartered @p depth times, with
 *  exact normals. 4^(depth + 1) * 2 triangles. */
struct gz_mesh mesh_ball(double radius_mm, int depth);

/** A flat square of @p side times @p side cells of 1 mm in the plane z = 0, facing up. */
struct gz_mesh mesh_sheet(int side);

/** Turn triangle @p t. */
void mesh_turn(struct gz_mesh *mesh, size_t t);

#endif
