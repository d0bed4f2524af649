#include "render/surface/cpu/surface_normals.h"

#include <math.h>
#include <stdlib.h>

/* Triangles of a part of the work. Chosen: far more than a part costs, far fewer than a mesh has.
 */
enum { TRIANGLES_A_PART = 16384 };

/* What the workers share. */
struct pack_job {
	const struct gz_mesh *mesh;
	struct gz_corner_normals *normals;
};

uint32_t gz_normal_pack(const float vector[3])
{
	const float sum = fabsf(vector[0]) + fabsf(vector[1]) + fabsf(vector[2]);
	if (!(sum > 0) || isinf(sum))
		return GZ_NORMAL_OFFSET;
	float x = vector[0] / sum, y = vector[1] / sum;
	if (vector[2] < 0) {
		const float folded = copysignf(1 - fabsf(y), x);
		y = copysignf(1 - fabsf(x), y);
		x = folded;
	}
	const uint32_t low = (uint32_t)(lrintf(x * GZ_NORMAL_UNIT) + GZ_NORMAL_OFFSET);
	const uint32_t high = (uint32_t)lrintf(y * GZ_NORMAL_UNIT);
	return high << 16 | low;
}

static void pack_part(void *user, size_t part, int worker)
{
	const struct pack_job *job = user;
	const struct gz_mesh *mesh = job->mesh;
	const size_t from = part * TRIANGLES_A_PART, end = from + TRIANGLES_A_PART;
	(void)worker;
	for (size_t i = from; i < end && i < mesh->triangle_count; i++)
		for (int corner = 0; corner < 3; corner++)
			job->normals[i].corner[corner] =
				gz_normal_pack(mesh->normals[mesh->triangles[i][corner]]);
}

enum gz_result gz_corner_normals_make(const struct gz_mesh meshes[], size_t mesh_count,
				      struct gz_workers *workers,
				      struct gz_corner_normals **out_normals)
{
	size_t count = 0;
	*out_normals = NULL;
	for (size_t i = 0; i < mesh_count; i++)
		count += meshes[i].triangle_count;
	if (count == 0)
		return GZ_OK;
	struct gz_corner_normals *normals = malloc(count * sizeof *normals);
	if (!normals)
		return GZ_ERR_NO_MEM;
	*out_normals = normals;
	for (size_t i = 0; i < mesh_count; i++) {
		const size_t triangles = meshes[i].triangle_count;
		struct pack_job job = { .mesh = &meshes[i], .normals = normals };
		gz_workers_run(workers, pack_part, &job,
			       (triangles + TRIANGLES_A_PART - 1) / TRIANGLES_A_PART);
		normals += triangles;
	}
	return GZ_OK;
}
