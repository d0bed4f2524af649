/* block_look_up.h by one instruction set. */
#include "render/raycast/cpu/simd_avx2.h"

#include "block_look_up_loop.h"

DEFINE_LOOK_UP(look_up_avx2)
