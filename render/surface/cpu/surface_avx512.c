/* The kernel for one instruction set: surface_kernel.h. */
#include "render/raycast/cpu/simd_avx512.h"

#include "render/surface/cpu/surface_kernel.h"

const struct gz_surface_kernel gz_surface_avx512 = { "avx512", "avx512", cast_surface_tile,
						     find_lit_places };
