/* The kernel for one instruction set: illustrate_kernel.h. */
#include "render/illustration/cpu/illustrate_kernel.h"

const struct gz_illustrate_kernel gz_illustrate_avx2 = { "avx2", "avx2", cast_illustrate_tile };
