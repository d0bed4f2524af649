/* The box around what a transfer function shows. */
#include "suite.h"

#include <string.h>

#include "render/transfer/content.h"

/* Values above the middle of the range are solid. */
static const struct gz_transfer upper_half = {
	.count = 2,
	.points = { { .value = 0.5 }, { .value = 0.51, .opacity = 0.9 } },
	.has_range = true,
	.range = { 0, 100 },
};

/* An empty volume of @p edge voxels with a bright box from @p least to below @p greatest. */
static struct gz_volume bright_box(enum gz_voxel_type type, int edge, const int least[3],
				   const int greatest[3])
{
	struct gz_volume volume = { .dims = { edge, edge, edge },
				    .spacing = { 1, 1, 1 },
				    .type = type };
	assert_int_equal(gz_volume_allocate(&volume), GZ_OK);
	memset(volume.voxels, 0, gz_volume_voxel_count(&volume) * gz_voxel_size(type));
	for (int z = least[2]; z < greatest[2]; z++)
		for (int y = least[1]; y < greatest[1]; y++)
			for (int x = least[0]; x < greatest[0]; x++) {
				const size_t at =
					((size_t)z * (size_t)edge + (size_t)y) * (size_t)edge +
					(size_t)x;
				if (type == GZ_VOXEL_U8)
					((uint8_t *)volume.voxels)[at] = 100;
				else if (type == GZ_VOXEL_U16)
					((uint16_t *)volume.voxels)[at] = 100;
				else
					((float *)volume.voxels)[at] = 100;
			}
	volume.slope = 1;
	volume.intercept = 0;
	gz_volume_find_range(&volume);
	return volume;
}

static void assert_box(const struct gz_clip_region *box, const double least[3],
		       const double greatest[3])
{
	for (int i = 0; i < 3; i++) {
		assert_float_equal(box->least[i], least[i], 1e-12);
		assert_float_equal(box->greatest[i], greatest[i], 1e-12);
	}
}

static void box_is_exact_for_each_type(void **state)
{
	(void)state;
	static const int least[3] = { 4, 10, 20 }, greatest[3] = { 30, 20, 40 };
	static const double shares[2][3] = { { 0.1, 0.25, 0.5 }, { 0.75, 0.5, 1 } };
	for (int type = 0; type < GZ_VOXEL_TYPE_COUNT; type++) {
		struct gz_volume volume = bright_box((enum gz_voxel_type)type, 40, least, greatest);
		struct gz_clip_region box;
		gz_content_find(&volume, &upper_half, &gz_clip_whole, &box);
		assert_box(&box, shares[0], shares[1]);
		gz_volume_free(&volume);
	}
}

/* Every second voxel is looked at. */
static void box_of_a_large_volume_is_exact_to_the_grid(void **state)
{
	(void)state;
	static const int least[3] = { 51, 0, 100 }, greatest[3] = { 120, 200, 151 };
	struct gz_volume volume = bright_box(GZ_VOXEL_U8, 200, least, greatest);
	struct gz_clip_region box;
	gz_content_find(&volume, &upper_half, &gz_clip_whole, &box);
	assert_box(&box, (const double[3]) { 0.26, 0, 0.5 }, (const double[3]) { 0.6, 1, 0.76 });
	gz_volume_free(&volume);
}

static void specks_what_is_clipped_and_nothing_do_not_count(void **state)
{
	(void)state;
	static const int least[3] = { 10, 10, 10 }, greatest[3] = { 30, 30, 30 };
	static const struct gz_clip_region left = { .greatest = { 0.5, 1, 1 } };
	struct gz_volume volume = bright_box(GZ_VOXEL_U8, 40, least, greatest);
	struct gz_transfer nothing = upper_half;
	struct gz_clip_region box;
	((uint8_t *)volume.voxels)[0] = 100;
	gz_content_find(&volume, &upper_half, &gz_clip_whole, &box);
	assert_box(&box, (const double[3]) { 0.25, 0.25, 0.25 },
		   (const double[3]) { 0.75, 0.75, 0.75 });
	gz_content_find(&volume, &upper_half, &left, &box);
	assert_box(&box, (const double[3]) { 0.25, 0.25, 0.25 },
		   (const double[3]) { 0.5, 0.75, 0.75 });
	/* Of the object's diagonal half the box is as large, of less than that smaller. */
	struct gz_clip_region cut = gz_clip_whole;
	cut.plane = true;
	memcpy(cut.normal, (double[3]) { 1, 1, 0 }, sizeof cut.normal);
	gz_content_find(&volume, &upper_half, &cut, &box);
	assert_box(&box, (const double[3]) { 0.25, 0.25, 0.25 },
		   (const double[3]) { 0.75, 0.75, 0.75 });
	cut.offset = 0.375;
	gz_content_find(&volume, &upper_half, &cut, &box);
	assert_box(&box, (const double[3]) { 0.25, 0.25, 0.25 },
		   (const double[3]) { 0.5, 0.5, 0.75 });
	nothing.points[1].opacity = 0;
	gz_content_find(&volume, &nothing, &left, &box);
	assert_true(gz_clip_region_same(&box, &left));
	gz_volume_free(&volume);
}

TEST_SUITE(content)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(box_is_exact_for_each_type),
		cmocka_unit_test(box_of_a_large_volume_is_exact_to_the_grid),
		cmocka_unit_test(specks_what_is_clipped_and_nothing_do_not_count),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
