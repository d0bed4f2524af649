/* The same loops for AVX2: plane_kernels.h. */
#include "render/illustration/plane_kernels.h"

#include "render/illustration/depth_blur_loops.h"
#include "render/illustration/feature_lines_loops.h"

const struct gz_plane_kernels gz_plane_kernels_avx2 = {
	blur_rows, blur_columns, share_depth, halve_rows, enlarge_row, find_lines,
};
