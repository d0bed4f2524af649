/**
 * @file
 * Inside the bench cast_limit: the bare loops that a cast is measured against.
 */
#ifndef GZ_BENCH_PROBES_CAST_LIMIT_H
#define GZ_BENCH_PROBES_CAST_LIMIT_H

#include <stdint.h>

#include "render/raycast/cpu/cast.h"

/** Take every sample of a tile's rays trilinearly by gathers, sum them and return their number. */
typedef uint64_t gz_limit_function(const struct gz_cast *cast, const struct gz_cast_tile *tile,
				   enum gz_voxel_type type, float sums[GZ_TILE_RAYS]);

/** One an instruction set. */
gz_limit_function gz_limit_portable, gz_limit_avx2, gz_limit_avx512;

#endif
