/* Empty space: found where it is, and nowhere else. */
#include "suite.h"

#include <stddef.h>
#include <stdint.h>

#include <math.h>
#include <stdlib.h>

#include "render/raycast/shared/macrocells.h"
#include "small_scene.h"

static size_t cell_index(const struct gz_macrocells *cells, int x, int y, int z)
{
	return ((size_t)z * (size_t)cells->dims[1] + (size_t)y) * (size_t)cells->dims[0] +
	       (size_t)x;
}

static void ranges_hold_every_voxel_an_interpolation_can_touch(void **state)
{
	(void)state;
	for (int type = 0; type < GZ_VOXEL_TYPE_COUNT; type++) {
		struct small_scene scene = small_scene_waves(37, 9, 17, (enum gz_voxel_type)type);
		struct gz_macrocells cells = { 0 };
		assert_int_equal(gz_macrocells_build(&scene.volume, &cells), GZ_OK);
		size_t voxel = 0;
		for (int z = 0; z < 17; z++)
			for (int y = 0; y < 9; y++)
				for (int x = 0; x < 37; x++, voxel++) {
					const double value =
						type == GZ_VOXEL_U8
							? ((uint8_t *)scene.volume.voxels)[voxel]
						: type == GZ_VOXEL_U16
							? ((uint16_t *)scene.volume.voxels)[voxel]
							: (double)((float *)scene.volume
									   .voxels)[voxel];
					/* the voxel's own cell and those it borders on */
					for (int n = 0; n < 27; n++) {
						const int i = (x + n % 3 - 1) / 8,
							  j = (y + n / 3 % 3 - 1) / 8;
						const int k = (z + n / 9 - 1) / 8;
						if (i >= cells.dims[0] || j >= cells.dims[1] ||
						    k >= cells.dims[2])
							continue;
						const size_t cell = cell_index(&cells, i, j, k);
						assert_true((double)cells.least[cell] <= value);
						assert_true((double)cells.greatest[cell] >= value);
					}
				}
		gz_macrocells_free(&cells);
		small_scene_free(&scene);
	}
}

static void distances_equal_a_search_over_all_cells(void **state)
{
	(void)state;
	struct small_scene scene = small_scene_waves(290, 70, 50, GZ_VOXEL_U8);
	struct gz_macrocells cells = { 0 };
	static struct gz_transfer_table table;
	/* only the brightest shows: few cells are occupied */
	scene.transfer.points[2].opacity = 0;
	scene.transfer.points[2].value = 0.97;
	assert_int_equal(gz_macrocells_build(&scene.volume, &cells), GZ_OK);
	gz_transfer_table_bake(&scene.transfer, &scene.volume, &table);
	gz_macrocells_classify(&cells, &table);
	int occupied = 0;
	for (int z = 0; z < cells.dims[2]; z++)
		for (int y = 0; y < cells.dims[1]; y++)
			for (int x = 0; x < cells.dims[0]; x++) {
				int nearest = 255, nearest_empty = 255;
				for (int k = 0; k < cells.dims[2]; k++)
					for (int j = 0; j < cells.dims[1]; j++)
						for (int i = 0; i < cells.dims[0]; i++) {
							const size_t cell =
								cell_index(&cells, i, j, k);
							int d = abs(i - x);
							d = abs(j - y) > d ? abs(j - y) : d;
							d = abs(k - z) > d ? abs(k - z) : d;
							int *least =
								gz_transfer_table_shows(
									&table,
									(double)cells.least[cell],
									(double)cells
										.greatest[cell])
									? &nearest
									: &nearest_empty;
							*least = d < *least ? d : *least;
						}
				occupied += nearest == 0;
				assert_int_equal(cells.distance[cell_index(&cells, x, y, z)],
						 nearest);
				assert_int_equal(cells.reach[cell_index(&cells, x, y, z)],
						 nearest ? GZ_REACH_BORDER + nearest
							 : GZ_REACH_BORDER - nearest_empty);
			}
	assert_true(occupied > 0);
	assert_true(occupied < cells.dims[0] * cells.dims[1] * cells.dims[2] / 2);
	gz_macrocells_free(&cells);
	small_scene_free(&scene);
}

static void table_follows_the_transfer_function(void **state)
{
	(void)state;
	struct small_scene scene = small_scene_waves(20, 20, 20, GZ_VOXEL_U16);
	static struct gz_transfer_table table;
	static struct gz_transfer_entry step[GZ_TRANSFER_TABLE_SIZE];
	gz_transfer_table_bake(&scene.transfer, &scene.volume, &table);
	gz_transfer_table_step(&table, 2.5, step);
	for (int i = 0; i < GZ_TRANSFER_TABLE_SIZE; i++) {
		double rgba[4];
		gz_transfer_evaluate(&scene.transfer, (double)i / (GZ_TRANSFER_TABLE_SIZE - 1),
				     rgba);
		const double exact = gz_transfer_opacity_over(rgba[3], 2.5);
		if (fabs((double)step[i].opacity - exact) > 1e-6)
			fail_msg("entry %d: %g, not %g", i, (double)step[i].opacity, exact);
		assert_true(fabs((step[i].colour >> 21) / 2047.0 - rgba[0]) < 0.0003);
		assert_true(fabs((step[i].colour >> 10 & 2047) / 2047.0 - rgba[1]) < 0.0003);
		assert_true(fabs((step[i].colour & 1023) / 1023.0 - rgba[2]) < 0.0006);
	}
	small_scene_free(&scene);
}

TEST_SUITE(macrocells)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(ranges_hold_every_voxel_an_interpolation_can_touch),
		cmocka_unit_test(distances_equal_a_search_over_all_cells),
		cmocka_unit_test(table_follows_the_transfer_function),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
