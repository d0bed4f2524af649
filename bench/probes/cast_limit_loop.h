/*
 * The bare loop: every sample of a tile's rays by gathers, summed, and nothing else. Included by
 * one file an instruction set, behind that set's vocabulary.
 */
#include "bench/probes/cast_limit.h"
#include "render/raycast/cpu/cast_fetch.h"
#include "render/raycast/cpu/cast_rays.h"

SIMD uint64_t gather_all(const struct gz_cast *cast, const struct gz_cast_tile *tile,
			 enum gz_voxel_type type, float sums[GZ_TILE_RAYS])
{
	uint64_t samples = 0;
	for (int first = 0; first < GZ_TILE_RAYS; first += SIMD_LANES) {
		struct rays rays;
		set_up_rays(cast, tile, first, &rays);
		vf sum = vf_set(0), k = rays.first + vf_set(0.5F);
		for (;;) {
			const vm active = vf_less(k, rays.end);
			if (!vm_any(active))
				break;
			samples += vm_count(active);
			sum = sum + sample_at(cast, type, 0, &rays, k, active);
			k = k + vf_set(1);
		}
		vf_store(sums + first, sum);
	}
	return samples;
}

#define DEFINE_LIMIT(name)                                                         \
	uint64_t name(const struct gz_cast *cast, const struct gz_cast_tile *tile, \
		      enum gz_voxel_type type, float sums[GZ_TILE_RAYS])           \
	{                                                                          \
		switch (type) {                                                    \
		case GZ_VOXEL_U8:                                                  \
			return gather_all(cast, tile, GZ_VOXEL_U8, sums);          \
		case GZ_VOXEL_U16:                                                 \
			return gather_all(cast, tile, GZ_VOXEL_U16, sums);         \
		default:                                                           \
			return gather_all(cast, tile, GZ_VOXEL_F32, sums);         \
		}                                                                  \
	}
