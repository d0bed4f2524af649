#include "render/raycast/shared/voxel_ranges.h"

#include <stdint.h>
#include <string.h>

/* Of each column of several rows of voxels, and of each block of columns, the least and the
 * greatest. Written out by type, so that each is a plain loop that compilers turn into vector code.
 */
#define DEFINE_COLUMNS(name, type)                                                                \
	static void name(const void *voxels, size_t from, int count, void *least, void *greatest) \
	{                                                                                         \
		const type *restrict row = (const type *)voxels + from;                           \
		type *restrict low = least, *restrict high = greatest;                            \
		for (int i = 0; i < count; i++) {                                                 \
			low[i] = row[i] < low[i] ? row[i] : low[i];                               \
			high[i] = row[i] > high[i] ? row[i] : high[i];                            \
		}                                                                                 \
	}                                                                                         \
	static void name##_block(const void *least, const void *greatest, int from, int to,       \
				 void *out_least, void *out_greatest, int block)                  \
	{                                                                                         \
		type low = ((const type *)least)[from], high = ((const type *)greatest)[from];    \
		for (int i = from + 1; i <= to; i++) {                                            \
			const type l = ((const type *)least)[i];                                  \
			const type h = ((const type *)greatest)[i];                               \
			low = l < low ? l : low;                                                  \
			high = h > high ? h : high;                                               \
		}                                                                                 \
		((type *)out_least)[block] = low;                                                 \
		((type *)out_greatest)[block] = high;                                             \
	}

DEFINE_COLUMNS(columns_u8, uint8_t)
DEFINE_COLUMNS(columns_u16, uint16_t)
DEFINE_COLUMNS(columns_f32, float)

/* How one type of voxel is gone through. */
static const struct voxel_kind {
	void (*columns)(const void *voxels, size_t from, int count, void *least, void *greatest);
	void (*block)(const void *least, const void *greatest, int from, int to, void *out_least,
		      void *out_greatest, int block);
} voxel_kinds[GZ_VOXEL_TYPE_COUNT] = {
	[GZ_VOXEL_U8] = { columns_u8, columns_u8_block },
	[GZ_VOXEL_U16] = { columns_u16, columns_u16_block },
	[GZ_VOXEL_F32] = { columns_f32, columns_f32_block },
};

/* The voxels of a block along one axis. */
static void block_span(const struct gz_range_blocks *blocks, int block, int dim, int *out_from,
		       int *out_to)
{
	const int from = block * blocks->edge - blocks->before;
	const int to = block * blocks->edge + blocks->edge - 1 + blocks->behind;
	*out_from = from > 0 ? from : 0;
	*out_to = to < dim - 1 ? to : dim - 1;
}

size_t gz_voxel_ranges_scratch(const struct gz_volume *volume)
{
	return 2 * (size_t)volume->dims[0] * gz_voxel_size(volume->type);
}

void gz_voxel_ranges_row(const struct gz_volume *volume, const struct gz_range_blocks *blocks,
			 int y, int z, int count, void *scratch, void *out_least,
			 void *out_greatest)
{
	const struct voxel_kind *kind = &voxel_kinds[volume->type];
	const size_t row = (size_t)volume->dims[0], slice = row * (size_t)volume->dims[1];
	const size_t row_bytes = row * gz_voxel_size(volume->type);
	char *least = scratch, *greatest = least + row_bytes;
	int from[3], to[3];
	block_span(blocks, y, volume->dims[1], &from[1], &to[1]);
	block_span(blocks, z, volume->dims[2], &from[2], &to[2]);
	const char *first =
		(const char *)volume->voxels +
		((size_t)from[2] * slice + (size_t)from[1] * row) * gz_voxel_size(volume->type);
	memcpy(least, first, row_bytes);
	memcpy(greatest, first, row_bytes);
	for (int k = from[2]; k <= to[2]; k++)
		for (int j = from[1]; j <= to[1]; j++)
			kind->columns(volume->voxels, (size_t)k * slice + (size_t)j * row,
				      volume->dims[0], least, greatest);
	for (int x = 0; x < count; x++) {
		block_span(blocks, x, volume->dims[0], &from[0], &to[0]);
		kind->block(least, greatest, from[0], to[0], out_least, out_greatest, x);
	}
}
