/* Voxels of a file in a volume whose axes are turned and flipped in every way. */
#include "suite.h"

#include <stdlib.h>
#include <string.h>

#include "render/data/voxel_place.h"

static const int permutations[6][3] = { { 0, 1, 2 }, { 0, 2, 1 }, { 1, 0, 2 },
					{ 1, 2, 0 }, { 2, 0, 1 }, { 2, 1, 0 } };

/* A volume into which a file is to be placed, and how. */
struct turned {
	struct gz_volume volume;
	struct gz_voxel_place place;
};

static void make(struct turned *t, const int dims[3], const int world[3], int flips,
		 enum gz_voxel_type type)
{
	*t = (struct turned) { .volume.type = type };
	for (int axis = 0; axis < 3; axis++)
		t->volume.dims[world[axis]] = t->place.dims[axis] = dims[axis];
	const ptrdiff_t step[3] = { 1, t->volume.dims[0],
				    (ptrdiff_t)t->volume.dims[0] * t->volume.dims[1] };
	for (int axis = 0; axis < 3; axis++) {
		const ptrdiff_t stride = step[world[axis]];
		const bool flip = flips >> axis & 1;
		t->place.first += flip ? stride * (dims[axis] - 1) : 0;
		t->place.stride[axis] = flip ? -stride : stride;
	}
	t->volume.voxels = calloc(gz_volume_voxel_count(&t->volume), gz_voxel_size(type));
	assert_non_null(t->volume.voxels);
}

/* Voxels that tell their number: numbers of a slab that begins at `index`. */
static void number(uint8_t *out, uint64_t index, size_t count, size_t size)
{
	for (size_t i = 0; i < count; i++) {
		const uint32_t value = (uint32_t)(index + i) * 2654435761u;
		memcpy(out + i * size, &value, size); /* the low bytes */
	}
}

static void place_all(const struct turned *t)
{
	const size_t size = gz_voxel_size(t->volume.type);
	const size_t all = gz_volume_voxel_count(&t->volume);
	const size_t most = gz_voxel_place_most(&t->place, t->volume.type);
	uint8_t *slab = malloc(most * size);
	assert_non_null(slab);
	for (uint64_t index = 0; index < all;) {
		const size_t count = gz_voxel_place_next(&t->place, t->volume.type, index);
		assert_in_range(count, 1, most);
		assert_true(index + count <= all);
		number(slab, index, count, size);
		gz_voxel_place(&t->place, &t->volume, slab, index, count);
		index += count;
	}
	free(slab);
}

static void check_all(const struct turned *t)
{
	const size_t size = gz_voxel_size(t->volume.type);
	const uint8_t *voxels = t->volume.voxels;
	const int *dims = t->place.dims;
	uint64_t index = 0;
	for (int z = 0; z < dims[2]; z++)
		for (int y = 0; y < dims[1]; y++)
			for (int x = 0; x < dims[0]; x++, index++) {
				uint8_t wanted[4];
				const ptrdiff_t at = t->place.first + x * t->place.stride[0] +
						     y * t->place.stride[1] +
						     z * t->place.stride[2];
				number(wanted, index, 1, size);
				if (memcmp(voxels + at * (ptrdiff_t)size, wanted, size) != 0)
					fail_msg("voxel %d %d %d of %d x %d x %d, strides %td %td "
						 "%td, %zu bytes: %#x, not %#x",
						 x, y, z, dims[0], dims[1], dims[2],
						 t->place.stride[0], t->place.stride[1],
						 t->place.stride[2], size,
						 voxels[at * (ptrdiff_t)size], wanted[0]);
			}
}

static void every_turn_puts_every_voxel_in_its_place(void **state)
{
	(void)state;
	/* Around the edges of tiles and lines, and axes of one voxel. */
	static const int sizes[][3] = { { 37, 70, 45 }, { 32, 64, 64 }, { 33, 1, 65 },
					{ 1, 40, 33 },  { 40, 33, 1 },  { 1, 1, 5 } };
	for (size_t s = 0; s < sizeof sizes / sizeof sizes[0]; s++)
		for (int p = 0; p < 6; p++)
			for (int flips = 0; flips < 8; flips++)
				for (int type = 0; type < GZ_VOXEL_TYPE_COUNT; type++) {
					struct turned t;
					make(&t, sizes[s], permutations[p], flips,
					     (enum gz_voxel_type)type);
					place_all(&t);
					check_all(&t);
					free(t.volume.voxels);
				}
}

/* Slabs of a scanner's sagittal slices are lines of the volume, those of huge slices are bounded.
 */
static void slab_fills_lines_and_stays_small_beside_the_volume(void **state)
{
	(void)state;
	struct gz_voxel_place place = { .dims = { 256, 256, 256 }, .stride = { 256, 65536, 1 } };
	assert_int_equal(gz_voxel_place_most(&place, GZ_VOXEL_U16), 16 * 65536);
	place = (struct gz_voxel_place) { .dims = { 256, 256, 256 }, .stride = { 65536, 1, 256 } };
	assert_int_equal(gz_voxel_place_most(&place, GZ_VOXEL_U16), 32 * 256);
	place = (struct gz_voxel_place) { .dims = { 16384, 16384, 2 }, .stride = { 2, 32768, 1 } };
	assert_int_equal(gz_voxel_place_most(&place, GZ_VOXEL_U8), (size_t)16384 * 16384);
	place = (struct gz_voxel_place) { .dims = { 1024, 1024, 1024 },
					  .stride = { 1024, 1048576, 1 } };
	const size_t slab = gz_voxel_place_most(&place, GZ_VOXEL_U16) * 2;
	assert_in_range(slab, 2 << 20, ((size_t)2 << 30) / 128);
}

TEST_SUITE(voxel_place)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(every_turn_puts_every_voxel_in_its_place),
		cmocka_unit_test(slab_fills_lines_and_stays_small_beside_the_volume),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
