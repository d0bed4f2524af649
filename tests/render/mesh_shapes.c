#include "mesh_shapes.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

static void require_ok(enum gz_result result)
{
	if (result == GZ_OK)
		return;
	fprintf(stderr, "mesh_shapes: %s\n", gz_result_text(result));
	abort();
}

/* The vertex of row @p row and column @p column of a triangular lattice with @p side rows of
 * cells; row 0 has one vertex. */
static uint32_t lattice_vertex(int row, int column)
{
	return (uint32_t)(row * (row + 1) / 2 + column);
}

/* One face of the octahedron, its corners on the axes with the signs given. */
static void make_octant(struct gz_mesh *mesh, int octant, int side, double radius_mm)
{
	const size_t vertices = (size_t)(side + 1) * (size_t)(side + 2) / 2;
	const uint32_t first = (uint32_t)((size_t)octant * vertices);
	size_t triangle = (size_t)octant * (size_t)side * (size_t)side;
	const double sign[3] = { octant & 1 ? -1 : 1, octant & 2 ? -1 : 1, octant & 4 ? -1 : 1 };
	for (int row = 0; row <= side; row++)
		for (int column = 0; column <= row; column++) {
			const uint32_t v = first + lattice_vertex(row, column);
			const double at[3] = { side - row, row - column, column };
			const double length = sqrt(at[0] * at[0] + at[1] * at[1] + at[2] * at[2]);
			for (int axis = 0; axis < 3; axis++) {
				const double part = sign[axis] * at[axis] / length;
				mesh->normals[v][axis] = (float)part;
				mesh->positions[v][axis] = (float)(radius_mm * part);
			}
		}
	for (int row = 0; row < side; row++)
		for (int k = 0; k < 2 * row + 1; k++, triangle++) {
			const int column = k / 2, down = k % 2;
			uint32_t *corners = mesh->triangles[triangle];
			corners[0] = first + lattice_vertex(row, column);
			corners[1] = first + lattice_vertex(row + 1, column + down);
			corners[2] = first + (down ? lattice_vertex(row, column + 1)
						   : lattice_vertex(row + 1, column + 1));
			/* An odd number of mirrors turns the face. */
			if (sign[0] * sign[1] * sign[2] < 0)
				mesh_turn(mesh, triangle);
		}
}

/* Give vertices at one place one number, so that faces share their edges. */
static void join_places(struct gz_mesh *mesh)
{
	for (size_t i = 0; i < 3 * mesh->triangle_count; i++) {
		uint32_t *corner = &mesh->triangles[i / 3][i % 3];
		const float *place = mesh->positions[*corner];
		if (place[0] * place[1] * place[2] != 0)
			continue; /* within a face */
		for (uint32_t v = 0; v < *corner; v++) {
			double far = 0;
			for (int axis = 0; axis < 3; axis++)
				far += fabs((double)mesh->positions[v][axis] -
					    (double)mesh->positions[*corner][axis]);
			if (far == 0) {
				*corner = v;
				break;
			}
		}
	}
}

struct gz_mesh mesh_ball(double radius_mm, int depth)
{
	const int side = 1 << depth;
	const uint64_t wide = (uint64_t)side;
	struct gz_mesh mesh;
	require_ok(gz_mesh_allocate(4 * (wide + 1) * (wide + 2), 8 * wide * wide, &mesh));
	for (int octant = 0; octant < 8; octant++)
		make_octant(&mesh, octant, side, radius_mm);
	join_places(&mesh);
	return mesh;
}

struct gz_mesh mesh_sheet(int side)
{
	struct gz_mesh mesh;
	const uint32_t row = (uint32_t)side + 1;
	require_ok(
		gz_mesh_allocate((uint64_t)row * row, 2 * (uint64_t)side * (uint64_t)side, &mesh));
	for (uint32_t v = 0; v < row * row; v++) {
		mesh.positions[v][0] = (float)(v % row);
		mesh.positions[v][1] = (float)(v / row);
		mesh.positions[v][2] = mesh.normals[v][0] = mesh.normals[v][1] = 0;
		mesh.normals[v][2] = 1;
	}
	for (size_t cell = 0; cell < (size_t)side * (size_t)side; cell++) {
		const uint32_t v =
			(uint32_t)(cell / (size_t)side) * row + (uint32_t)(cell % (size_t)side);
		const uint32_t both[2][3] = { { v, v + 1, v + row + 1 },
					      { v, v + row + 1, v + row } };
		for (size_t i = 0; i < 6; i++)
			mesh.triangles[2 * cell + i / 3][i % 3] = both[i / 3][i % 3];
	}
	return mesh;
}

void mesh_turn(struct gz_mesh *mesh, size_t t)
{
	const uint32_t swap = mesh->triangles[t][1];
	mesh->triangles[t][1] = mesh->triangles[t][2];
	mesh->triangles[t][2] = swap;
}
