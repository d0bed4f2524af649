/* The kernel for one instruction set; compiled with its flags. The vocabulary comes before the
 * kernel that speaks it. */
#include "render/raycast/cpu/simd_avx2.h"

#include "render/raycast/cpu/cast_kernel.h"

const struct gz_cast_kernels gz_cast_avx2 = GZ_CAST_KERNELS("avx2");
