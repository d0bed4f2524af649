/* The kernel for one instruction set: surface_kernel.h. */
#include "render/raycast/cpu/simd_portable.h"

#include "render/surface/cpu/surface_kernel.h"

const struct gz_surface_kernel gz_surface_portable = { "portable", "sse2", cast_surface_tile,
						       find_lit_places };
