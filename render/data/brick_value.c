#include "render/data/brick_value.h"

#include <math.h>

/* A place in the voxels of a brick: those before and after it along an axis, and its share of the
 * one after. */
struct between {
	size_t before, after;
	double share;
};

/* The brick of level 0 that a place lies in. */
static void finest_brick(const struct gz_brick_level *finest, const double place[3],
			 int out_brick[3])
{
	for (int axis = 0; axis < 3; axis++) {
		const double at = floor(place[axis] * finest->dims[axis] / GZ_BRICK_EDGE);
		const int last = finest->bricks[axis] - 1;
		out_brick[axis] = at < 0 ? 0 : at < last ? (int)at : last;
	}
}

/* Where a place lies in the stored voxels of a brick of a level, along one axis. A level's box ends
 * with the volume's, though its last voxel may reach farther. */
static struct between between_of(const struct gz_brick_level *finest,
				 const struct gz_brick_level *level, int axis, int brick,
				 double place, bool nearest)
{
	static const size_t strides[3] = { 1, GZ_BRICK_STORED_EDGE,
					   GZ_BRICK_STORED_EDGE * GZ_BRICK_STORED_EDGE };
	const double voxel = ldexp(place * finest->dims[axis], -level->halvings[axis]);
	/* The first stored voxel belongs to the brick before. Data sit at centres of voxels. */
	const double at = voxel - brick * GZ_BRICK_EDGE + 0.5;
	const double limit = GZ_BRICK_STORED_EDGE - 1;
	const double kept = fmin(limit, fmax(0, nearest ? floor(at + 0.5) : at));
	const double first = fmin(limit - 1, floor(kept));
	const size_t before = (size_t)first * strides[axis];
	return (struct between) { before, before + strides[axis], kept - first };
}

static double mix(double before, double after, double share)
{
	return before + (after - before) * share;
}

static double value_between(enum gz_voxel_type type, const void *voxels, const struct between at[3])
{
	double face[2], line[2];
	for (int z = 0; z < 2; z++) {
		for (int y = 0; y < 2; y++) {
			const size_t row =
				(z ? at[2].after : at[2].before) + (y ? at[1].after : at[1].before);
			line[y] =
				mix(gz_voxel_stored(type, voxels, row + at[0].before),
				    gz_voxel_stored(type, voxels, row + at[0].after), at[0].share);
		}
		face[z] = mix(line[0], line[1], at[1].share);
	}
	return mix(face[0], face[1], at[2].share);
}

double gz_brick_value(const struct gz_brick_pool *pool, const double place[3], bool nearest)
{
	const struct gz_brick_file *file = gz_brick_pool_file(pool);
	const struct gz_brick_layout *layout = &file->layout;
	struct gz_brick_view view;
	struct between at[3];
	int brick[3];
	gz_brick_pool_view(pool, &view);
	finest_brick(&layout->levels[0], place, brick);
	const int32_t entry = view.table[gz_brick_number(layout, 0, brick)];
	const struct gz_brick_level *level =
		&layout->levels[entry & ((1 << GZ_BRICK_LEVEL_BITS) - 1)];
	for (int axis = 0; axis < 3; axis++)
		at[axis] = between_of(&layout->levels[0], level, axis,
				      brick[axis] >> level->halvings[axis], place[axis], nearest);
	const size_t room = (size_t)(entry >> GZ_BRICK_LEVEL_BITS);
	const size_t bytes = GZ_BRICK_VOXELS * gz_voxel_size(file->header.type);
	return value_between(file->header.type, (const char *)view.voxels + room * bytes, at);
}
