/* The bare loop for one instruction set; the vocabulary comes before what speaks it. */
#include "render/raycast/cpu/simd_avx512.h"

#include "bench/probes/cast_limit_loop.h"

DEFINE_LIMIT(gz_limit_avx512)
