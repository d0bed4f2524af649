/**
 * @file
 * Blocks of voxels in registers, by each instruction set that has them.
 */
#ifndef GZ_TESTS_RENDER_BLOCK_LOOK_UP_H
#define GZ_TESTS_RENDER_BLOCK_LOOK_UP_H

#include "render/raycast/cpu/cast.h"

enum { LOOK_UP_PLACES = 16 };

/** Places, counted from the first datum, and what is found there. */
struct look_up_places {
	float at[3][LOOK_UP_PLACES];
	/** Trilinear values, less 32768 if of 16 bits, times 32767: from a block and singly. */
	float by_block[LOOK_UP_PLACES], single[LOOK_UP_PLACES];
	/** Central differences along each axis, for places at least a voxel from the rim. */
	float difference_by_block[3][LOOK_UP_PLACES], difference_single[3][LOOK_UP_PLACES];
	bool held, differences_held; /**< whether blocks held all places */
};

/** Look voxels of 8 or 16 bits up around all places, and @p differences: find those, too, of places
 *  in the volume. @p wide: by wide blocks, which avx2 has not. */
typedef void look_up_function(const struct gz_cast *cast, enum gz_voxel_type type, bool wide,
			      bool differences, struct look_up_places *places);

look_up_function look_up_avx2, look_up_avx512;

#endif
