/* The bare loop for one instruction set; the vector types come first. */
#include "render/raycast/cpu/simd_avx2.h"

#include "bench/probes/cast_limit_loop.h"

DEFINE_LIMIT(gz_limit_avx2)
