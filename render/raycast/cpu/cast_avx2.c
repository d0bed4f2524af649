/* The kernels for one instruction set: cast_kernel.h explains the scheme. */
#include "render/raycast/cpu/simd_avx2.h"

#include "render/raycast/cpu/cast_kernel.h"

const struct gz_cast_kernels gz_cast_avx2 = GZ_CAST_KERNELS("avx2");
