#include "render/transfer/segment_kernels.h"

#include <string.h>

#include "render/transfer/segment_loops.h"

const struct gz_segment_kernels gz_segment_kernels_portable = {
	"portable", average_segments, blend_segments, segment_in_cell, mix_segments, mix_in_cell,
};

#ifdef GZ_TRANSFER_X86
static bool runs_avx512(void)
{
	return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512bw") &&
	       __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512vl");
}

static bool runs_avx2(void)
{
	return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
}
#endif

const struct gz_segment_kernels *gz_segment_kernels_find(const char *name)
{
#ifdef GZ_TRANSFER_X86
	if ((!name || strcmp(name, gz_segment_kernels_avx512.name) == 0) && runs_avx512())
		return &gz_segment_kernels_avx512;
	if ((!name || strcmp(name, gz_segment_kernels_avx2.name) == 0) && runs_avx2())
		return &gz_segment_kernels_avx2;
#endif
	if (!name || strcmp(name, gz_segment_kernels_portable.name) == 0)
		return &gz_segment_kernels_portable;
	return NULL;
}
