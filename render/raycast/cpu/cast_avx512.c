/* The kernel for one instruction set; compiled with its flags. The vocabulary comes before the
 * kernel that speaks it. */
#include "render/raycast/cpu/simd_avx512.h"

#include "render/raycast/cpu/cast_kernel.h"

const struct gz_cast_kernels gz_cast_avx512 = GZ_CAST_KERNELS("avx512");
