#include "render/illustration/plane_kernels.h"

#include "render/illustration/shading_tile_loops.h"

const struct gz_plane_kernels gz_plane_kernels_portable = {
	blur_rows,  blur_columns, share_depth, halve_rows,   enlarge_cells,
	find_lines, count_tones,  survey_row,  compose_tile,
};

const struct gz_plane_kernels *gz_plane_kernels_find(void)
{
#ifdef GZ_ILLUSTRATION_X86
	if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512bw") &&
	    __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512vl"))
		return &gz_plane_kernels_avx512;
	if (__builtin_cpu_supports("avx2"))
		return &gz_plane_kernels_avx2;
#endif
	return &gz_plane_kernels_portable;
}
