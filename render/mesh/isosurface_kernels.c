#include "render/mesh/isosurface_kernels.h"

#include "render/mesh/isosurface_cubes.h"
#include "render/mesh/isosurface_vertices.h"

const struct gz_iso_kernels gz_iso_kernels_portable = { count_iso_row, write_iso_triangles,
							write_iso_vertices };

const struct gz_iso_kernels *gz_iso_kernels_find(void)
{
#ifdef GZ_MESH_X86
	if (__builtin_cpu_supports("avx2"))
		return &gz_iso_kernels_avx2;
#endif
	return &gz_iso_kernels_portable;
}
