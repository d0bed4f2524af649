#include "render/illustration/plane_kernels.h"

#include "render/illustration/depth_blur_loops.h"
#include "render/illustration/feature_lines_loops.h"

const struct gz_plane_kernels gz_plane_kernels_portable = {
	blur_rows, blur_columns, share_depth, halve_rows, enlarge_row, find_lines,
};

const struct gz_plane_kernels *gz_plane_kernels_find(void)
{
#ifdef GZ_ILLUSTRATION_X86
	if (__builtin_cpu_supports("avx2"))
		return &gz_plane_kernels_avx2;
#endif
	return &gz_plane_kernels_portable;
}
