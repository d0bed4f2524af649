#include <stddef.h>
#include <string.h>

#include "render/raycast/cpu/cast.h"

#ifdef GZ_CAST_X86
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

const struct gz_cast_kernels *gz_cast_kernels_find(const char *name)
{
	const bool any = !name || strcmp(name, "auto") == 0;
#ifdef GZ_CAST_X86
	if ((any || strcmp(name, gz_cast_avx512.name) == 0) && runs_avx512())
		return &gz_cast_avx512;
	if ((any || strcmp(name, gz_cast_avx2.name) == 0) && runs_avx2())
		return &gz_cast_avx2;
#endif
	if (any || strcmp(name, gz_cast_portable.name) == 0)
		return &gz_cast_portable;
	return NULL;
}
