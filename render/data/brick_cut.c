#include "render/data/brick_cut.h"

#include <string.h>

static int clamp(int value, int last)
{
	return value < 0 ? 0 : value > last ? last : value;
}

/* A row of a brick: voxels from x - 1 on, the volume's ends repeated. */
static void copy_row(const char *row, int from, int last, size_t size, char *out)
{
	for (int i = 0; i < GZ_BRICK_STORED_EDGE;) {
		const int x = from + i;
		int run = 1;
		if (x >= 0 && x < last) {
			run = last - x;
			run = run < GZ_BRICK_STORED_EDGE - i ? run : GZ_BRICK_STORED_EDGE - i;
		}
		memcpy(out + (size_t)i * size, row + (size_t)clamp(x, last) * size,
		       (size_t)run * size);
		i += run;
	}
}

void gz_brick_cut(const struct gz_volume *volume, const int brick[3], void *out_voxels)
{
	const size_t size = gz_voxel_size(volume->type);
	const int *dims = volume->dims;
	const int from[3] = { brick[0] * GZ_BRICK_EDGE - 1, brick[1] * GZ_BRICK_EDGE - 1,
			      brick[2] * GZ_BRICK_EDGE - 1 };
	char *to = out_voxels;
	for (int k = 0; k < GZ_BRICK_STORED_EDGE; k++) {
		const size_t z = (size_t)clamp(from[2] + k, dims[2] - 1);
		for (int j = 0; j < GZ_BRICK_STORED_EDGE; j++) {
			const size_t y = (size_t)clamp(from[1] + j, dims[1] - 1);
			const size_t row = (z * (size_t)dims[1] + y) * (size_t)dims[0];
			copy_row((const char *)volume->voxels + row * size, from[0], dims[0] - 1,
				 size, to);
			to += GZ_BRICK_STORED_EDGE * size;
		}
	}
}
