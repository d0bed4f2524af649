/* The same loops for AVX2: segment_kernels.h. */
#include "render/transfer/segment_kernels.h"

#include "render/transfer/segment_loops.h"

const struct gz_segment_kernels gz_segment_kernels_avx2 = {
	"avx2", average_segments, blend_segments, segment_in_cell, mix_segments, mix_in_cell,
};
