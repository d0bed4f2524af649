/* The look-ups of one instruction set, behind whose vocabulary this is included. */
#include <math.h>

#include "block_look_up.h"
#include "render/raycast/cpu/cast_block.h"
#include "render/raycast/cpu/cast_near.h"

SIMD void load_places(const struct look_up_places *places, int first, vf at[3])
{
	for (int axis = 0; axis < 3; axis++)
		at[axis] = vf_load(places->at[axis] + first);
}

/* The block that begins before all places. */
SIMD void load_block(const struct gz_cast *cast, enum gz_voxel_type type, int wide,
		     const struct look_up_places *places, struct block *block)
{
	float least[4] = { 0 };
	for (int axis = 0; axis < 3; axis++) {
		least[axis] = places->at[axis][0];
		for (int i = 1; i < LOOK_UP_PLACES; i++)
			least[axis] = fminf(least[axis], places->at[axis][i]);
	}
	block_take(cast, type, wide, _mm_loadu_ps(least), block);
}

SIMD void look_up_values(const struct gz_cast *cast, enum gz_voxel_type type, int wide,
			 struct look_up_places *places)
{
	struct block block;
	load_block(cast, type, wide, places, &block);
	places->held = true;
	for (int first = 0; first < LOOK_UP_PLACES; first += SIMD_LANES) {
		vf at[3], inside[3];
		load_places(places, first, at);
		for (int axis = 0; axis < 3; axis++)
			inside[axis] = at[axis] - block.base[axis];
		if (block_places(cast, &block, wide, vm_all(), inside))
			vf_store(places->by_block + first,
				 block_sample(&block, type, wide, inside));
		else
			places->held = false;
		vf_store(places->single + first, scattered_sample(cast, type, at, vm_all()));
	}
}

/* Rays go down along y and up along the other axes. */
SIMD void look_up_differences(const struct gz_cast *cast, enum gz_voxel_type type,
			      struct look_up_places *places)
{
	const struct rays rays = { .delta = { vf_set(1), vf_set(-1), vf_set(1) } };
	struct near_voxels near;
	near_nothing(&rays, &near);
	places->differences_held = true;
	for (int first = 0; first < LOOK_UP_PLACES; first += SIMD_LANES) {
		struct places here = { .mask = vm_all() };
		vf by_block[3], single[3];
		load_places(places, first, here.at);
		difference_words(cast, type, &here, single);
		const int held = near_differences(cast, type, &here, &here, &near, by_block);
		places->differences_held = places->differences_held && held;
		for (int axis = 0; axis < 3; axis++) {
			vf_store(places->difference_single[axis] + first, single[axis]);
			if (held)
				vf_store(places->difference_by_block[axis] + first, by_block[axis]);
		}
	}
}

#define DEFINE_LOOK_UP(name)                                                      \
	void name(const struct gz_cast *cast, enum gz_voxel_type type, bool wide, \
		  bool differences, struct look_up_places *places)                \
	{                                                                         \
		if (wide && block_exists(type, 1))                                \
			look_up_values(cast, type, 1, places);                    \
		else                                                              \
			look_up_values(cast, type, 0, places);                    \
		if (differences)                                                  \
			look_up_differences(cast, type, places);                  \
	}
