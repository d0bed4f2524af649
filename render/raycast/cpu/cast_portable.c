/* The kernels for one instruction set: cast_kernel.h explains the scheme. */
#include "render/raycast/cpu/simd_portable.h"

#include "render/raycast/cpu/cast_kernel.h"

const struct gz_cast_kernels gz_cast_portable = GZ_CAST_KERNELS("portable");
