/*
 * A sample whose colour has not been added yet: it is looked up while the next one is fetched, so
 * that neither waits for the other.
 * A part of the kernel: see cast_kernel.h.
 */
#ifndef GZ_RENDER_RAYCAST_CPU_CAST_SETTLE_H
#define GZ_RENDER_RAYCAST_CPU_CAST_SETTLE_H

#include "render/raycast/cpu/cast.h"
#include "render/raycast/cpu/cast_light.h"
#include "render/raycast/cpu/cast_rays.h"
#include "render/raycast/cpu/cast_shade.h"

struct waiting {
	vf at;
	vi entry;
	vm within; /* lanes that have one */
};

SIMD struct waiting none_waiting(void)
{
	return (struct waiting) { vf_set(0), vi_set(0), vf_less(vf_set(0), vf_set(0)) };
}

/* Add the sample that has been waiting; which lanes are alive then. */
SIMD uint32_t settle(const struct gz_cast *cast, enum gz_voxel_type type, int nearest, int step,
		     const struct rays *rays, const struct waiting *waiting, vm *alive,
		     struct light *light)
{
	vf opacity;
	vi colour;
	const vm needed = vm_and(waiting->within, *alive);
	load_pairs(cast->step_table[step], waiting->entry, &opacity, &colour);
	composite_at(cast, type, nearest, rays, waiting->at, colour, opacity, needed, light);
	*alive = vm_and(*alive, vf_less(vf_set(cast->end_transmittance), light->through));
	return vm_count(needed);
}

#endif
