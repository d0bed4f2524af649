/* Blocks of voxels in registers: what they give is what single loads give, to the bit within the
 * outer data, and what interpolation in double precision gives. */
#include "suite.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "block_look_up.h"
#include "small_scene.h"

/* How far a share of 1/32767 and single precision lead from the value, in units of a voxel. */
#define VALUE_SLACK (1.0 / 32767)

enum { ROUNDS = 400, WIDE_REACH = 7, REACH = 3 };

static const struct {
	const char *name;
	look_up_function *look_up;
} sets[] = {
	{ "avx2", look_up_avx2 },
	{ "avx512", look_up_avx512 },
};

/* A number from 0 to `most`, from a fixed row of numbers. */
static unsigned draw(uint32_t *state, unsigned most)
{
	*state = *state * 1664525U + 1013904223U;
	return (unsigned)((uint64_t)(*state >> 8) * (most + 1ULL) >> 24);
}

static double share(uint32_t *state)
{
	return draw(state, 0xFFFFFE) / (double)0xFFFFFF;
}

static double voxel(const struct gz_volume *volume, const int place[3])
{
	const size_t index = ((size_t)place[2] * (size_t)volume->dims[1] + (size_t)place[1]) *
				     (size_t)volume->dims[0] +
			     (size_t)place[0];
	return volume->type == GZ_VOXEL_U8 ? ((const uint8_t *)volume->voxels)[index]
					   : ((const uint16_t *)volume->voxels)[index];
}

/* Trilinear, clamped at the outer data. */
static double value_at(const struct gz_volume *volume, const double at[3])
{
	int low[3];
	double part[3], sum = 0;
	for (int axis = 0; axis < 3; axis++) {
		const double inside = fmin(fmax(at[axis], 0), volume->dims[axis] - 1);
		low[axis] = (int)fmin(floor(inside), fmax(volume->dims[axis] - 2, 0));
		part[axis] = inside - low[axis];
	}
	for (int corner = 0; corner < 8; corner++) {
		int place[3];
		double weight = 1;
		for (int axis = 0; axis < 3; axis++) {
			const int up = corner >> axis & 1;
			place[axis] = low[axis] + up;
			weight *= up ? part[axis] : 1 - part[axis];
		}
		if (weight > 0)
			sum += weight * voxel(volume, place);
	}
	return sum;
}

/* Calm 16-bit values differ by less than a signed word holds. */
static void fill_at_random(struct gz_volume *volume, bool calm, uint32_t *state)
{
	const size_t voxels =
		(size_t)volume->dims[0] * (size_t)volume->dims[1] * (size_t)volume->dims[2];
	const size_t bytes = voxels * (volume->type == GZ_VOXEL_U8 ? 1 : 2);
	uint8_t *byte = volume->voxels;
	for (size_t i = 0; i < bytes; i++)
		byte[i] = draw(state, 7) == 0 ? 0xFF : (uint8_t)draw(state, 255);
	for (size_t i = 1; calm && volume->type == GZ_VOXEL_U16 && i < bytes; i += 2)
		byte[i] = (uint8_t)(0x60 + (byte[i] & 0x3F));
}

/* Places within `reach` voxels of each other, from `rim` voxels inside the outer data to as many
 * outside. Some lie on voxels. */
static void draw_places(const struct gz_volume *volume, const int reach[3], double rim,
			uint32_t *state, struct look_up_places *places)
{
	for (int axis = 0; axis < 3; axis++) {
		const double first = rim, last = volume->dims[axis] - 1 - rim;
		const double room = fmax(last - first - reach[axis], 0);
		const double from = floor(first) + floor(share(state) * (room + 1.999));
		for (int i = 0; i < LOOK_UP_PLACES; i++) {
			double at = from + share(state) * (reach[axis] - 0.001);
			if (draw(state, 5) == 0)
				at = floor(at);
			places->at[axis][i] = (float)fmin(fmax(at, first), last);
		}
	}
}

/* Whether a place lies at or beyond the last datum along an axis. A block takes the float below for
 * it, 2^-22 away, so that values there may differ by that along each axis. */
static bool at_the_last(const struct gz_volume *volume, const struct look_up_places *places, int i)
{
	bool last = false;
	for (int axis = 0; axis < 3; axis++)
		last |= places->at[axis][i] >= (float)(volume->dims[axis] - 1);
	return last;
}

static void assert_same(const struct gz_volume *volume, const struct look_up_places *places,
			const float *a, const float *b, double unit, const char *set)
{
	const double most = volume->type == GZ_VOXEL_U8 ? 255 : 65535;
	for (int i = 0; i < LOOK_UP_PLACES; i++) {
		const double slack =
			at_the_last(volume, places, i) ? most * unit * ldexp(1, -20) : 0;
		if (!(fabs((double)a[i] - (double)b[i]) <= slack))
			fail_msg("%s: %d is %.9g by block, %.9g singly", set, i, (double)a[i],
				 (double)b[i]);
	}
}

static void assert_value(const struct gz_volume *volume, const struct look_up_places *places,
			 const char *set)
{
	const double most = volume->type == GZ_VOXEL_U8 ? 255 : 65535;
	const double offset = volume->type == GZ_VOXEL_U8 ? 0 : 32768;
	for (int i = 0; i < LOOK_UP_PLACES; i++) {
		const double at[3] = { places->at[0][i], places->at[1][i], places->at[2][i] };
		const double found = places->single[i] / 32767.0 + offset;
		const double true_value = value_at(volume, at);
		if (fabs(found - true_value) > most * VALUE_SLACK)
			fail_msg("%s: %.6f at %.4f %.4f %.4f, not %.6f", set, found, at[0], at[1],
				 at[2], true_value);
	}
}

static void assert_differences(const struct gz_volume *volume, const struct look_up_places *places,
			       const char *set)
{
	const double most = volume->type == GZ_VOXEL_U8 ? 255 : 65535;
	for (int axis = 0; axis < 3; axis++)
		for (int i = 0; i < LOOK_UP_PLACES; i++) {
			double before[3], after[3];
			for (int other = 0; other < 3; other++)
				before[other] = after[other] = places->at[other][i];
			before[axis] -= 1;
			after[axis] += 1;
			const double difference =
				value_at(volume, after) - value_at(volume, before);
			if (fabs(places->difference_single[axis][i] - difference) >
			    2 * most * VALUE_SLACK)
				fail_msg("%s: difference %d is %.6f, not %.6f", set, axis,
					 places->difference_single[axis][i], difference);
		}
}

/* Volumes of these sizes are so small that most blocks touch the rim. */
static void check(enum gz_voxel_type type, bool wide, double rim)
{
	static const int sizes[][3] = { { 8, 6, 6 }, { 13, 7, 9 }, { 21, 19, 11 } };
	const bool differences = !wide && rim >= 0;
	const int reach[3] = { wide ? WIDE_REACH : REACH, REACH, REACH };
	uint32_t state = 7;
	for (size_t set = 0; set < sizeof sets / sizeof sets[0]; set++) {
		int held = 0, differences_held = 0;
		if (!gz_cast_kernels_find(sets[set].name) || (wide && set == 0))
			continue;
		for (int round = 0; round < ROUNDS; round++) {
			/* Blocks for differences are copied where they touch the rim. */
			const int *size = sizes[round % 3],
				  more = rim >= 1 && round % 4 > 0 ? 9 : 0;
			struct small_scene scene = small_scene_waves(size[0] + more, size[1] + more,
								     size[2] + more, type);
			struct gz_cast cast = { 0 };
			struct look_up_places places = { 0 };
			fill_at_random(&scene.volume, round & 1, &state);
			gz_cast_fill_voxels(&scene.volume, &cast);
			draw_places(&scene.volume, reach, rim, &state, &places);
			sets[set].look_up(&cast, type, wide, differences, &places);
			if (places.held)
				assert_same(&scene.volume, &places, places.by_block, places.single,
					    32767, sets[set].name);
			assert_value(&scene.volume, &places, sets[set].name);
			if (differences) {
				assert_differences(&scene.volume, &places, sets[set].name);
				for (int axis = 0; axis < 3 && places.differences_held; axis++)
					assert_same(&scene.volume, &places,
						    places.difference_by_block[axis],
						    places.difference_single[axis], 2,
						    sets[set].name);
			}
			held += places.held;
			differences_held += (round & 1) && places.differences_held;
			small_scene_free(&scene);
		}
		/* Most places are chosen to fit. */
		assert_true(held > ROUNDS / 2);
		assert_true(!differences || differences_held > ROUNDS / 4);
	}
}

static void blocks_of_8_bits_hold_what_single_loads_find(void **state)
{
	(void)state;
	check(GZ_VOXEL_U8, false, -0.5);
	check(GZ_VOXEL_U8, false, 0);
}

static void blocks_of_16_bits_hold_what_single_loads_find(void **state)
{
	(void)state;
	check(GZ_VOXEL_U16, false, -0.5);
	check(GZ_VOXEL_U16, false, 0);
}

static void wide_blocks_hold_what_single_loads_find(void **state)
{
	(void)state;
	check(GZ_VOXEL_U8, true, -0.5);
	check(GZ_VOXEL_U16, true, -0.5);
}

static void differences_by_blocks_are_those_of_single_loads(void **state)
{
	(void)state;
	check(GZ_VOXEL_U8, false, 1.01);
	check(GZ_VOXEL_U8, false, 0);
	check(GZ_VOXEL_U16, false, 1.01);
	check(GZ_VOXEL_U16, false, 0);
}

TEST_SUITE(block_look_up)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(blocks_of_8_bits_hold_what_single_loads_find),
		cmocka_unit_test(blocks_of_16_bits_hold_what_single_loads_find),
		cmocka_unit_test(wide_blocks_hold_what_single_loads_find),
		cmocka_unit_test(differences_by_blocks_are_those_of_single_loads),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
