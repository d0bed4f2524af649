/* The loops for AVX2: the same source, compiled for wider registers. */
#include "render/particles/particle_loops.h"

const struct gz_particle_kernels gz_particle_kernels_avx2 = GZ_PARTICLE_LOOPS;
