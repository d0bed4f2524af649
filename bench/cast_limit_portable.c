/* The bare loop for one instruction set; the vocabulary comes before what speaks it. */
#include "render/cpu/simd_portable.h"

#include "bench/cast_limit_loop.h"

DEFINE_LIMIT(gz_limit_portable)
