/* The kernel for one instruction set: illustrate_kernel.h. */
#include "render/illustration/cpu/illustrate_kernel.h"

const struct gz_illustrate_kernel gz_illustrate_avx512 = { "avx512", "avx512",
							   cast_illustrate_tile };
