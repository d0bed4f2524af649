/* Fine cells: their values are those of their voxels, and their flags what a search says. */
#include "suite.h"

#include <stddef.h>
#include <stdint.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "render/raycast/cpu/fine_cells.h"
#include "small_scene.h"

/* The least and the greatest of the voxels from, to edge beyond, along each axis. */
static void search_voxels(const struct gz_volume *volume, const int from[3], double out[2])
{
	out[0] = INFINITY;
	out[1] = -INFINITY;
	for (int z = from[2]; z <= from[2] + GZ_FINE_EDGE && z < volume->dims[2]; z++)
		for (int y = from[1]; y <= from[1] + GZ_FINE_EDGE && y < volume->dims[1]; y++)
			for (int x = from[0]; x <= from[0] + GZ_FINE_EDGE && x < volume->dims[0];
			     x++) {
				const size_t i = ((size_t)z * (size_t)volume->dims[1] + (size_t)y) *
							 (size_t)volume->dims[0] +
						 (size_t)x;
				const double value =
					gz_voxel_stored(volume->type, volume->voxels, i);
				out[0] = fmin(out[0], value);
				out[1] = fmax(out[1], value);
			}
}

static void check_ranges(const struct gz_volume *volume, const struct gz_fine_cells *cells)
{
	const int *dims = cells->grid[0].dims;
	size_t cell = 0;
	for (int z = 0; z < dims[2]; z++)
		for (int y = 0; y < dims[1]; y++)
			for (int x = 0; x < dims[0]; x++, cell++) {
				const int from[3] = { GZ_FINE_EDGE * x, GZ_FINE_EDGE * y,
						      GZ_FINE_EDGE * z };
				const double found[2] = {
					gz_voxel_stored(volume->type, cells->least, cell),
					gz_voxel_stored(volume->type, cells->greatest, cell)
				};
				double wanted[2];
				search_voxels(volume, from, wanted);
				if (found[0] < wanted[0] || found[0] > wanted[0] ||
				    found[1] < wanted[1] || found[1] > wanted[1])
					fail_msg("cell %d %d %d: %g to %g, not %g to %g", x, y, z,
						 found[0], found[1], wanted[0], wanted[1]);
			}
}

static void ranges_are_those_of_the_voxels_that_samples_touch(void **state)
{
	(void)state;
	static const int dims[][3] = { { 37, 9, 17 }, { 8, 4, 5 }, { 1, 1, 1 }, { 1, 23, 2 } };
	for (int type = 0; type < GZ_VOXEL_TYPE_COUNT; type++)
		for (size_t i = 0; i < sizeof dims / sizeof dims[0]; i++) {
			struct small_scene scene = small_scene_waves(
				dims[i][0], dims[i][1], dims[i][2], (enum gz_voxel_type)type);
			struct gz_workers *workers;
			struct gz_fine_cells cells = { 0 };
			assert_int_equal(gz_workers_create(1 + (int)i, &workers), GZ_OK);
			assert_int_equal(gz_fine_cells_build(&scene.volume, workers, &cells),
					 GZ_OK);
			check_ranges(&scene.volume, &cells);
			gz_fine_cells_free(&cells);
			gz_workers_destroy(&workers);
			small_scene_free(&scene);
		}
}

/* What one volume and transfer function give. */
struct classified {
	struct gz_workers *workers;
	struct gz_macrocells coarse;
	struct gz_fine_cells cells;
	struct gz_transfer_table table;
};

static void classify(const struct small_scene *scene, struct classified *classified)
{
	gz_transfer_table_bake(&scene->transfer, &scene->volume, &classified->table);
	gz_macrocells_classify(&classified->coarse, &classified->table);
	gz_fine_cells_classify(&classified->cells, &classified->coarse, &classified->table,
			       classified->workers);
}

static struct classified *build(const struct small_scene *scene)
{
	struct classified *classified = calloc(1, sizeof *classified);
	assert_non_null(classified);
	assert_int_equal(gz_workers_create(3, &classified->workers), GZ_OK);
	assert_int_equal(gz_macrocells_build(&scene->volume, &classified->coarse), GZ_OK);
	assert_int_equal(
		gz_fine_cells_build(&scene->volume, classified->workers, &classified->cells),
		GZ_OK);
	classify(scene, classified);
	return classified;
}

static void free_classified(struct classified *classified)
{
	gz_workers_destroy(&classified->workers);
	gz_macrocells_free(&classified->coarse);
	gz_fine_cells_free(&classified->cells);
	free(classified);
}

/* Whether any fine cell from (inclusive) to (exclusive) shows something, by its values. */
static bool any_shows(const struct small_scene *scene, const struct classified *classified,
		      const int from[3], const int to[3])
{
	const struct gz_fine_cells *cells = &classified->cells;
	const int *dims = cells->grid[0].dims;
	for (int z = from[2]; z < to[2] && z < dims[2]; z++)
		for (int y = from[1]; y < to[1] && y < dims[1]; y++)
			for (int x = from[0]; x < to[0] && x < dims[0]; x++) {
				const size_t i = ((size_t)z * (size_t)dims[1] + (size_t)y) *
							 (size_t)dims[0] +
						 (size_t)x;
				if (gz_transfer_table_shows(
					    &classified->table,
					    gz_voxel_stored(scene->volume.type, cells->least, i),
					    gz_voxel_stored(scene->volume.type, cells->greatest,
							    i)))
					return true;
			}
	return false;
}

/* All bits of one cell of a grid. */
static void check_flags(const struct small_scene *scene, const struct classified *classified,
			int index, int x, int y, int z)
{
	const struct gz_fine_grid *grid = &classified->cells.grid[index];
	const size_t cell =
		((size_t)z * (size_t)grid->dims[1] + (size_t)y) * (size_t)grid->dims[0] + (size_t)x;
	for (int axes = 0; axes < 8; axes++) {
		const int at[3] = { x, y, z };
		int from[3], to[3];
		for (int axis = 0; axis < 3; axis++) {
			from[axis] = at[axis] << index;
			to[axis] = (at[axis] + 1 + (axes >> axis & 1)) << index;
		}
		const bool found = grid->flags[cell] & GZ_FINE_FLAG(axes);
		const bool wanted = any_shows(scene, classified, from, to);
		if (found != wanted)
			fail_msg("grid %d, cell %d %d %d, axes %d: %d, not %d", index, x, y, z,
				 axes, found, wanted);
	}
}

/* How many cells of the finest grid show something by themselves. */
static int check_all_flags(const struct small_scene *scene, const struct classified *classified)
{
	for (int index = 0; index < GZ_FINE_GRIDS; index++) {
		const int *dims = classified->cells.grid[index].dims;
		for (int z = 0; z < dims[2]; z++)
			for (int y = 0; y < dims[1]; y++)
				for (int x = 0; x < dims[0]; x++)
					check_flags(scene, classified, index, x, y, z);
	}
	const struct gz_fine_grid *finest = &classified->cells.grid[0];
	int showing = 0;
	for (int i = 0; i < finest->dims[0] * finest->dims[1] * finest->dims[2]; i++)
		showing += finest->flags[i] & GZ_FINE_FLAG(0);
	return showing;
}

static void flags_of_every_grid_equal_a_search_over_cells(void **state)
{
	(void)state;
	for (int type = 0; type < GZ_VOXEL_TYPE_COUNT; type++) {
		struct small_scene scene = small_scene_waves(90, 37, 25, (enum gz_voxel_type)type);
		/* only the brightest shows: few cells are occupied */
		scene.transfer.points[2].opacity = 0;
		scene.transfer.points[2].value = 0.97;
		struct classified *classified = build(&scene);
		const int showing = check_all_flags(&scene, classified);
		assert_in_range(showing, 1, 23 * 10 * 7 / 2);
		free_classified(classified);
		small_scene_free(&scene);
	}
}

static void flags_forget_the_transfer_function_before(void **state)
{
	(void)state;
	struct small_scene scene = small_scene_waves(40, 33, 27, GZ_VOXEL_U8);
	struct classified *classified = build(&scene);
	const int before = check_all_flags(&scene, classified);
	scene.transfer.points[2].opacity = 0;
	scene.transfer.points[2].value = 0.97;
	classify(&scene, classified);
	const int after = check_all_flags(&scene, classified);
	assert_true(after < before);
	free_classified(classified);
	small_scene_free(&scene);
}

TEST_SUITE(fine_cells)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(ranges_are_those_of_the_voxels_that_samples_touch),
		cmocka_unit_test(flags_of_every_grid_equal_a_search_over_cells),
		cmocka_unit_test(flags_forget_the_transfer_function_before),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
