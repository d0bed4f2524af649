/* The same loops for AVX-512: segment_kernels.h. */
#include "render/transfer/segment_kernels.h"

#include "render/transfer/segment_loops.h"

const struct gz_segment_kernels gz_segment_kernels_avx512 = {
	"avx512", average_segments, blend_segments, segment_in_cell, mix_segments, mix_in_cell,
};
