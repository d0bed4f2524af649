/* The loops that every processor runs, and the choice between them and faster ones. */
#include "render/particles/particle_loops.h"

const struct gz_particle_kernels gz_particle_kernels_portable = GZ_PARTICLE_LOOPS;

const struct gz_particle_kernels *gz_particle_kernels_find(bool portable)
{
#ifdef GZ_PARTICLES_X86
	if (!portable && __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma"))
		return &gz_particle_kernels_avx2;
#endif
	(void)portable;
	return &gz_particle_kernels_portable;
}
