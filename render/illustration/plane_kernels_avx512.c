/* The same loops for AVX-512: plane_kernels.h. */
#include "render/illustration/plane_kernels.h"

#include "render/illustration/shading_tile_loops.h"

const struct gz_plane_kernels gz_plane_kernels_avx512 = {
	blur_rows,  blur_columns, share_depth, halve_rows,   enlarge_cells,
	find_lines, count_tones,  survey_row,  compose_tile,
};
