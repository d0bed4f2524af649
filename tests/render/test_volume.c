#include "suite.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/captured_log.h"
#include "render/data/volume.h"

static struct gz_volume volume_of(int x, int y, int z, enum gz_voxel_type type)
{
	return (struct gz_volume) { .dims = { x, y, z }, .spacing = { 1, 1, 1 }, .type = type };
}

static void allocated_volume_is_aligned_and_padded_with_zeros(void **state)
{
	(void)state;
	struct gz_volume v = volume_of(7, 5, 3, GZ_VOXEL_U16);
	assert_int_equal(gz_volume_allocate(&v), GZ_OK);
	assert_int_equal((uintptr_t)v.voxels % 64, 0);
	assert_int_equal(gz_volume_voxel_count(&v), 105);
	for (size_t i = 0; i < GZ_VOLUME_PADDING; i++)
		assert_int_equal(((uint8_t *)v.voxels)[210 + i], 0);
	assert_true(v.slope == 1 && v.intercept == 0);
	gz_volume_free(&v);
	assert_null(v.voxels);
	gz_volume_free(&v);
}

static void dims_and_spacing_out_of_range_are_refused(void **state)
{
	(void)state;
	static const int bad_dims[] = { 0, -1, GZ_VOLUME_DIM_MAX + 1 };
	static const double bad_spacing[] = { 0, -1, NAN, INFINITY };
	for (size_t i = 0; i < 3; i++) {
		for (int axis = 0; axis < 3; axis++) {
			struct gz_volume v = volume_of(4, 4, 4, GZ_VOXEL_U8);
			v.dims[axis] = bad_dims[i];
			assert_int_equal(gz_volume_allocate(&v), GZ_ERR_INVAL);
			assert_null(v.voxels);
		}
	}
	for (size_t i = 0; i < 4; i++) {
		struct gz_volume v = volume_of(4, 4, 4, GZ_VOXEL_U8);
		v.spacing[1] = bad_spacing[i];
		assert_int_equal(gz_volume_allocate(&v), GZ_ERR_INVAL);
	}
	struct gz_volume v = volume_of(4, 4, 4, GZ_VOXEL_TYPE_COUNT);
	assert_int_equal(gz_volume_allocate(&v), GZ_ERR_INVAL);
}

static void volume_larger_than_the_machine_is_no_memory(void **state)
{
	(void)state;
	struct gz_volume v =
		volume_of(GZ_VOLUME_DIM_MAX, GZ_VOLUME_DIM_MAX, GZ_VOLUME_DIM_MAX, GZ_VOXEL_F32);
	assert_int_equal(gz_volume_allocate(&v), GZ_ERR_NO_MEM);
	assert_null(v.voxels);
}

/* Extremes at each place of an odd number of voxels, so that no lane is left out. */
static void range_is_found_wherever_the_extremes_are(void **state)
{
	(void)state;
	struct gz_volume v = volume_of(37, 1, 1, GZ_VOXEL_U8);
	assert_int_equal(gz_volume_allocate(&v), GZ_OK);
	for (int at = 0; at < 37; at++) {
		uint8_t *voxels = v.voxels;
		memset(voxels, 100, 37);
		voxels[at] = 200;
		voxels[36 - at] = at == 18 ? 200 : 7;
		gz_volume_find_range(&v);
		assert_int_equal((int)v.stored_max, 200);
		assert_int_equal((int)v.stored_min, at == 18 ? 100 : 7);
	}
	gz_volume_free(&v);
}

static void range_of_wider_types_is_found(void **state)
{
	(void)state;
	struct gz_volume v = volume_of(19, 1, 1, GZ_VOXEL_U16);
	assert_int_equal(gz_volume_allocate(&v), GZ_OK);
	for (int i = 0; i < 19; i++)
		((uint16_t *)v.voxels)[i] = (uint16_t)(65535 - 1000 * i);
	gz_volume_find_range(&v);
	assert_true(v.stored_min == 47535 && v.stored_max == 65535);
	gz_volume_free(&v);

	v = volume_of(19, 1, 1, GZ_VOXEL_F32);
	assert_int_equal(gz_volume_allocate(&v), GZ_OK);
	for (int i = 0; i < 19; i++)
		((float *)v.voxels)[i] = -0.5f * (float)i;
	gz_volume_find_range(&v);
	assert_true(v.stored_min == -9 && v.stored_max == 0);
	gz_volume_free(&v);
}

static void longest_edge_of_the_box_is_one(void **state)
{
	(void)state;
	struct gz_volume v = volume_of(100, 50, 20, GZ_VOXEL_U8);
	v.spacing[0] = 0.5;
	v.spacing[2] = 5; /* edges 50, 50, 100 */
	double half[3];
	gz_volume_half_extent(&v, half);
	assert_true(half[0] == 0.25 && half[1] == 0.25 && half[2] == 0.5);
	assert_true(gz_volume_voxel_length(&v) == 0.005);
}

static const double cubes[3] = { 1, 1, 1 };

static uint64_t hash_of(const struct gz_volume *v)
{
	uint64_t hash = 14695981039346656037u; /* FNV-1a */
	size_t size = gz_volume_voxel_count(v) * gz_voxel_size(v->type);
	for (size_t i = 0; i < size; i++)
		hash = (hash ^ ((const uint8_t *)v->voxels)[i]) * 1099511628211u;
	return hash;
}

static void procedural_volumes_are_the_same_bits_everywhere(void **state)
{
	(void)state;
	static const struct {
		enum gz_procedural which;
		enum gz_voxel_type type;
		uint64_t hash;
	} cases[] = {
		{ GZ_PROCEDURAL_SHELLS, GZ_VOXEL_U8, 0xb1ee43d0248f6bf5 },
		{ GZ_PROCEDURAL_SUPERNOVA, GZ_VOXEL_F32, 0x9deb32d3a6a708d0 },
		{ GZ_PROCEDURAL_CHAMELEON, GZ_VOXEL_U16, 0xf3490e828045cc34 },
		{ GZ_PROCEDURAL_SPLASH, GZ_VOXEL_U8, 0xa2299837ac7aebca },
	};
	static const int dims[3] = { 40, 36, 30 };
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		struct gz_volume v;
		assert_int_equal(
			gz_volume_generate(&(struct gz_procedural_request) { cases[i].which, dims,
									     cubes, cases[i].type },
					   NULL, NULL, &v),
			GZ_OK);
		assert_int_equal(v.type, cases[i].type);
		assert_true(v.stored_min == 0);
		assert_true(v.stored_max > 0.8);
		assert_int_equal(hash_of(&v), cases[i].hash);
		gz_volume_free(&v);
	}
}

static void procedural_shape_keeps_its_proportions_whatever_the_spacing(void **state)
{
	(void)state;
	static const int fine[3] = { 48, 48, 54 }, flat[3] = { 48, 48, 18 };
	static const double twice[3] = { 2, 2, 2 }, tall[3] = { 1, 1, 3 };
	struct gz_volume a, b, c;
	assert_int_equal(
		gz_volume_generate(&(struct gz_procedural_request) { GZ_PROCEDURAL_CHAMELEON, fine,
								     cubes, GZ_VOXEL_U16 },
				   NULL, NULL, &a),
		GZ_OK);
	assert_int_equal(
		gz_volume_generate(&(struct gz_procedural_request) { GZ_PROCEDURAL_CHAMELEON, fine,
								     twice, GZ_VOXEL_U16 },
				   NULL, NULL, &b),
		GZ_OK);
	assert_int_equal(
		gz_volume_generate(&(struct gz_procedural_request) { GZ_PROCEDURAL_SHELLS, flat,
								     tall, GZ_VOXEL_U8 },
				   NULL, NULL, &c),
		GZ_OK);
	assert_int_equal(hash_of(&a), hash_of(&b));
	assert_true(b.spacing[2] == 2 && c.spacing[2] == 3);
	gz_volume_free(&a);
	assert_int_equal(
		gz_volume_generate(&(struct gz_procedural_request) { GZ_PROCEDURAL_SHELLS, fine,
								     cubes, GZ_VOXEL_U8 },
				   NULL, NULL, &a),
		GZ_OK);
	/* A thick slice lies where the middle one of three thin ones does. */
	const size_t slice = (size_t)48 * 48;
	for (size_t z = 0; z < 18; z++)
		assert_memory_equal((uint8_t *)c.voxels + z * slice,
				    (uint8_t *)a.voxels + (3 * z + 1) * slice, slice);
	gz_volume_free(&a);
	gz_volume_free(&b);
	gz_volume_free(&c);
}

static void chameleon_is_air_and_tissue_and_bone(void **state)
{
	(void)state;
	static const int dims[3] = { 160, 160, 169 };
	struct gz_volume v;
	assert_int_equal(
		gz_volume_generate(&(struct gz_procedural_request) { GZ_PROCEDURAL_CHAMELEON, dims,
								     cubes, GZ_VOXEL_U16 },
				   NULL, NULL, &v),
		GZ_OK);
	const size_t count = gz_volume_voxel_count(&v);
	size_t air = 0, tissue = 0, bone = 0;
	for (size_t i = 0; i < count; i++) {
		const uint16_t value = ((const uint16_t *)v.voxels)[i];
		air += value == 0;
		tissue += value > 0 && value < 65535 / 2;
		bone += value > 65535 * 3 / 5;
	}
	assert_in_range(air, count * 80 / 100, count * 99 / 100);
	assert_in_range(tissue, count / 100, count * 20 / 100);
	/* Most bones are thinner than a voxel here, and so fainter. */
	assert_in_range(bone, count / 10000, count / 50);
	assert_true(((const uint16_t *)v.voxels)[0] == 0); /* nothing is cut off by the box */
	gz_volume_free(&v);
}

/* Bodies of liquid: what a flood from each voxel of it reaches. */
static int bodies_of(const struct gz_volume *v, uint8_t *liquid, size_t *stack)
{
	const size_t count = gz_volume_voxel_count(v);
	const size_t steps[3] = { 1, (size_t)v->dims[0], (size_t)v->dims[0] * (size_t)v->dims[1] };
	int bodies = 0;
	for (size_t i = 0; i < count; i++)
		liquid[i] = ((const uint8_t *)v->voxels)[i] > 127;
	for (size_t i = 0; i < count; i++) {
		if (!liquid[i])
			continue;
		size_t depth = 0;
		bodies++;
		liquid[i] = 0;
		stack[depth++] = i;
		while (depth > 0) {
			const size_t at = stack[--depth];
			for (int k = 0; k < 6; k++) {
				const size_t next = k & 1 ? at + steps[k / 2] : at - steps[k / 2];
				if (next < count && liquid[next]) {
					liquid[next] = 0;
					stack[depth++] = next;
				}
			}
		}
	}
	return bodies;
}

static void splash_is_a_puddle_and_drops_that_the_box_does_not_cut(void **state)
{
	(void)state;
	static const int dims[3] = { 168, 168, 96 };
	struct gz_volume v;
	assert_int_equal(
		gz_volume_generate(&(struct gz_procedural_request) { GZ_PROCEDURAL_SPLASH, dims,
								     cubes, GZ_VOXEL_U8 },
				   NULL, NULL, &v),
		GZ_OK);
	const size_t count = gz_volume_voxel_count(&v);
	const uint8_t *voxels = v.voxels;
	for (size_t i = 0; i < count; i++) {
		const int x = (int)(i % 168), y = (int)(i / 168 % 168), z = (int)(i / 168 / 168);
		if (x == 0 || y == 0 || z == 0 || x == 167 || y == 167 || z == 95)
			assert_int_equal(voxels[i], 0);
	}
	uint8_t *liquid = malloc(count);
	size_t *stack = malloc(count * sizeof *stack);
	assert_non_null(liquid);
	assert_non_null(stack);
	/* The puddle with its crown, the drop in the middle, and at least five that flew off. */
	assert_in_range(bodies_of(&v, liquid, stack), 7, 32);
	free(liquid);
	free(stack);
	gz_volume_free(&v);
}

static void procedural_volume_has_the_same_data_in_every_type(void **state)
{
	(void)state;
	static const int dims[3] = { 20, 18, 16 };
	for (int which = 0; which < GZ_PROCEDURAL_COUNT; which++) {
		struct gz_volume v[GZ_VOXEL_TYPE_COUNT];
		for (int type = 0; type < GZ_VOXEL_TYPE_COUNT; type++)
			assert_int_equal(gz_volume_generate(
						 &(struct gz_procedural_request) {
							 (enum gz_procedural)which, dims, cubes,
							 (enum gz_voxel_type)type },
						 NULL, NULL, &v[type]),
					 GZ_OK);
		for (size_t i = 0; i < gz_volume_voxel_count(&v[0]); i++) {
			const double exact = (double)((const float *)v[GZ_VOXEL_F32].voxels)[i];
			const double bytes = v[0].slope * ((const uint8_t *)v[0].voxels)[i];
			const double words = v[1].slope * ((const uint16_t *)v[1].voxels)[i];
			assert_true(fabs(bytes - exact) <= 0.501 * v[0].slope);
			assert_true(fabs(words - exact) <= 0.501 * v[1].slope);
		}
		for (int type = 0; type < GZ_VOXEL_TYPE_COUNT; type++)
			gz_volume_free(&v[type]);
	}
}

static void procedural_volume_of_bad_dims_is_refused_with_a_line(void **state)
{
	(void)state;
	struct captured_log log;
	captured_log_init(&log, NULL);
	struct gz_volume v = { 0 };
	assert_int_equal(gz_volume_generate(&(struct gz_procedural_request) { GZ_PROCEDURAL_SHELLS,
									      (int[3]) { 0, 4, 4 },
									      cubes, GZ_VOXEL_U8 },
					    NULL, &log.log, &v),
			 GZ_ERR_INVAL);
	assert_int_equal(log.messages, 1);
	assert_non_null(strstr(log.last, "0 x 4 x 4"));
	assert_int_equal(gz_volume_generate(&(struct gz_procedural_request) { GZ_PROCEDURAL_COUNT,
									      (int[3]) { 4, 4, 4 },
									      cubes, GZ_VOXEL_U8 },
					    NULL, &log.log, &v),
			 GZ_ERR_INVAL);
	assert_null(v.voxels);
}

static void names_match_their_enums(void **state)
{
	(void)state;
	int raw = 0, procedural = 0;
	while (gz_raw_type_names[raw])
		raw++;
	while (gz_procedural_names[procedural])
		procedural++;
	assert_int_equal(raw, GZ_RAW_TYPE_COUNT);
	assert_int_equal(procedural, GZ_PROCEDURAL_COUNT);
}

TEST_SUITE(volume)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(allocated_volume_is_aligned_and_padded_with_zeros),
		cmocka_unit_test(dims_and_spacing_out_of_range_are_refused),
		cmocka_unit_test(volume_larger_than_the_machine_is_no_memory),
		cmocka_unit_test(range_is_found_wherever_the_extremes_are),
		cmocka_unit_test(range_of_wider_types_is_found),
		cmocka_unit_test(longest_edge_of_the_box_is_one),
		cmocka_unit_test(procedural_volumes_are_the_same_bits_everywhere),
		cmocka_unit_test(procedural_shape_keeps_its_proportions_whatever_the_spacing),
		cmocka_unit_test(chameleon_is_air_and_tissue_and_bone),
		cmocka_unit_test(splash_is_a_puddle_and_drops_that_the_box_does_not_cut),
		cmocka_unit_test(procedural_volume_has_the_same_data_in_every_type),
		cmocka_unit_test(procedural_volume_of_bad_dims_is_refused_with_a_line),
		cmocka_unit_test(names_match_their_enums),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
