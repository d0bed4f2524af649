/* Meshes from anywhere: whatever the bytes, what is read keeps the header's promises. */
#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include "render/mesh/mesh_read.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void require(bool holds)
{
	if (!holds)
		abort();
}

static void check_parser(gz_mesh_parser *parse, const uint8_t *data, size_t size)
{
	struct gz_mesh mesh;
	if (parse("fuzz", data, size, NULL, &mesh) != GZ_OK)
		return;
	for (size_t v = 0; v < mesh.vertex_count; v++) {
		double length2 = 0;
		for (int axis = 0; axis < 3; axis++) {
			require(fabs((double)mesh.positions[v][axis]) <=
				GZ_MESH_COORDINATE_MAX * 1.000001);
			length2 += (double)mesh.normals[v][axis] * (double)mesh.normals[v][axis];
		}
		require(fabs(length2 - 1) < 1e-5);
	}
	for (size_t i = 0; i < 3 * mesh.triangle_count; i++)
		require(mesh.triangles[i / 3][i % 3] < mesh.vertex_count);
	gz_mesh_free(&mesh);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	check_parser(gz_mesh_parse_ply, data, size);
	check_parser(gz_mesh_parse_obj, data, size);
	check_parser(gz_mesh_parse_stl, data, size);
	return 0;
}
