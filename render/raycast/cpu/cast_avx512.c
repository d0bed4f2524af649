/* The kernels for one instruction set: cast_kernel.h explains the scheme. */
#include "render/raycast/cpu/simd_avx512.h"

#include "render/raycast/cpu/cast_kernel.h"

const struct gz_cast_kernels gz_cast_avx512 = GZ_CAST_KERNELS("avx512");
