#include "render/mesh/mesh.h"

#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>

#include "render/data/volume.h"

/* Arrays of HUGE_PAGE bytes or more use such pages: writing a mesh for the first time would
 * otherwise spend much of its time on page faults. */
#define HUGE_PAGE   ((size_t)2 << 20)
#define SMALL_ALIGN ((size_t)64)

static void *allocate_elements(size_t count, size_t size)
{
	const size_t used = count * size, align = used >= HUGE_PAGE ? HUGE_PAGE : SMALL_ALIGN;
	const size_t bytes = (used + GZ_MESH_PADDING + align - 1) / align * align;
	char *elements = aligned_alloc(align, bytes);
	if (!elements)
		return NULL;
	if (align == HUGE_PAGE)
		(void)madvise(elements, bytes, MADV_HUGEPAGE); /* only a hint */
	memset(elements + used, 0, GZ_MESH_PADDING);
	return elements;
}

enum gz_result gz_mesh_allocate(uint64_t vertex_count, uint64_t triangle_count,
				struct gz_mesh *out_mesh)
{
	if (vertex_count > GZ_MESH_COUNT_MAX || triangle_count > GZ_MESH_COUNT_MAX)
		return GZ_ERR_FULL;
	struct gz_mesh mesh = { .vertex_count = (size_t)vertex_count,
				.triangle_count = (size_t)triangle_count };
	const size_t vertex_bytes = sizeof *mesh.positions + sizeof *mesh.normals;
	if (!gz_memory_fits_machine(mesh.vertex_count * vertex_bytes +
				    mesh.triangle_count * sizeof *mesh.triangles))
		return GZ_ERR_NO_MEM;
	if (vertex_count > 0) {
		mesh.positions = allocate_elements(mesh.vertex_count, sizeof *mesh.positions);
		mesh.normals = allocate_elements(mesh.vertex_count, sizeof *mesh.normals);
	}
	if (triangle_count > 0)
		mesh.triangles = allocate_elements(mesh.triangle_count, sizeof *mesh.triangles);
	if ((vertex_count > 0 && (!mesh.positions || !mesh.normals)) ||
	    (triangle_count > 0 && !mesh.triangles)) {
		gz_mesh_free(&mesh);
		return GZ_ERR_NO_MEM;
	}
	*out_mesh = mesh;
	return GZ_OK;
}

enum gz_result gz_mesh_copy(const struct gz_mesh *mesh, struct gz_mesh *out_copy)
{
	const enum gz_result result =
		gz_mesh_allocate(mesh->vertex_count, mesh->triangle_count, out_copy);
	if (result != GZ_OK)
		return result;
	out_copy->shared_count = mesh->shared_count;
	if (mesh->vertex_count > 0) {
		memcpy(out_copy->positions, mesh->positions,
		       mesh->vertex_count * sizeof *mesh->positions);
		memcpy(out_copy->normals, mesh->normals,
		       mesh->vertex_count * sizeof *mesh->normals);
	}
	if (mesh->triangle_count > 0)
		memcpy(out_copy->triangles, mesh->triangles,
		       mesh->triangle_count * sizeof *mesh->triangles);
	return GZ_OK;
}

void gz_mesh_free(struct gz_mesh *mesh)
{
	free(mesh->positions);
	free(mesh->normals);
	free(mesh->triangles);
	*mesh = (struct gz_mesh) { 0 };
}
