/* Transfer functions with peaks far narrower than an entry of the usual table: what they show is
 * what the same function shows over a part of the range that the usual table resolves. */
#include "suite.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "render/plan/method.h"
#include "render/transfer/transfer_table.h"
#include "small_scene.h"

/* Width of the peak, and of the window around it that the usual table resolves, as shares of the
 * range of values. */
#define PEAK   (1.0 / 20000)
#define WINDOW (40 * PEAK)

/* Of integers: four numbers, so that its walls lie between numbers. */
static double peak_of(enum gz_voxel_type type)
{
	return type == GZ_VOXEL_U16 ? 4.0 / 65535 : PEAK;
}

static void put(struct gz_volume *volume, size_t index, double share)
{
	if (volume->type == GZ_VOXEL_U16)
		((uint16_t *)volume->voxels)[index] = (uint16_t)lround(share * 65535);
	else
		((float *)volume->voxels)[index] = (float)share;
}

/* Values 0 and 1 at two corners, and in a ball a slow slope through the window: a twentieth of the
 * peak, or for integers a quarter of a number, from voxel to voxel. */
static void fill_slope(struct gz_volume *volume)
{
	const int *dims = volume->dims;
	const double per_voxel = volume->type == GZ_VOXEL_U16 ? 0.25 / 65535 : PEAK / 20;
	size_t index = 0;
	for (int z = 0; z < dims[2]; z++)
		for (int y = 0; y < dims[1]; y++)
			for (int x = 0; x < dims[0]; x++) {
				const double u = x - 0.5 * dims[0], v = y - 0.5 * dims[1],
					     w = z - 0.5 * dims[2];
				const bool in = u * u + v * v + w * w < 15 * 15;
				put(volume, index++, in ? 0.5 + (u + 0.3 * v) * per_voxel : 0.25);
			}
	put(volume, 0, 0);
	put(volume, index - 1, 1);
	gz_volume_find_range(volume);
}

/* A peak with walls around the middle of [low, high], `width` wide. */
static struct gz_transfer peak_function(double width)
{
	const double from = 0.5 - 0.5 * width, to = 0.5 + 0.5 * width;
	return (struct gz_transfer){
		.count = 6,
		.points = {
			{ 0, { 0.2, 0.4, 0.9 }, 0 },
			{ from, { 0.2, 0.4, 0.9 }, 0 },
			{ from, { 0.9, 0.6, 0.2 }, 0.08 },
			{ to, { 0.9, 0.6, 0.2 }, 0.08 },
			{ to, { 0.2, 0.4, 0.9 }, 0 },
			{ 1, { 0.2, 0.4, 0.9 }, 0 },
		},
	};
}

static struct small_scene sloping_scene(enum gz_voxel_type type)
{
	struct small_scene scene = small_scene_waves(64, 56, 48, type);
	fill_slope(&scene.volume);
	scene.foveation.method = GZ_METHOD_STANDARD;
	scene.transfer = peak_function(peak_of(type));
	return scene;
}

/* The same function over the window alone. */
static struct small_scene windowed(const struct small_scene *scene)
{
	struct small_scene window = *scene;
	const double greatest = scene->volume.stored_max;
	window.transfer = peak_function(peak_of(scene->volume.type) / WINDOW);
	window.transfer.has_range = true;
	window.transfer.range[0] = greatest * (0.5 - 0.5 * WINDOW);
	window.transfer.range[1] = greatest * (0.5 + 0.5 * WINDOW);
	return window;
}

static void render_by(const struct small_scene *scene, const char *set, struct gz_image *image)
{
	struct gz_raycaster *renderer = small_scene_renderer(scene, 2, set);
	small_scene_render(renderer, scene, 71, 53, image, NULL);
	gz_raycaster_destroy(&renderer);
}

static int lit_pixels(const struct gz_image *image)
{
	int lit = 0;
	for (int i = 0; i < image->width * image->height; i++)
		lit += image->pixels[4 * i] > 40;
	return lit;
}

/* The mean difference of the red of all pixels that show the peak in either picture, levels. */
static double mean_difference(const struct gz_image *a, const struct gz_image *b)
{
	int sum = 0, count = 0;
	for (int i = 0; i < a->width * a->height; i++) {
		const int one = a->pixels[4 * i], other = b->pixels[4 * i];
		sum += abs(one - other);
		count += one > 40 || other > 40;
	}
	return (double)sum / count;
}

/* Walls of the peak lie within an entry of where they should be, which a ray sees as a sample more
 * or less: of 13 levels, at opacity 0.08 and 1.5 samples a voxel length. */
#define MEAN_OFF 6.0

static void check_beside_window(struct small_scene *scene, const char *what)
{
	const struct small_scene window = windowed(scene);
	for (const char *const *set = small_scene_simd_sets(); *set; set++) {
		struct gz_image wanted = { 0 }, got = { 0 };
		render_by(&window, *set, &wanted);
		render_by(scene, *set, &got);
		const double apart = mean_difference(&wanted, &got);
		if (lit_pixels(&wanted) < 300 || lit_pixels(&got) < 300)
			fail_msg("%s, %s: %d pixels show the peak, %d with the window", what, *set,
				 lit_pixels(&got), lit_pixels(&wanted));
		if (apart > MEAN_OFF)
			fail_msg("%s, %s: %.2f levels from the window's picture", what, *set,
				 apart);
		gz_image_free(&wanted);
		gz_image_free(&got);
	}
}

static void peak_of_floats_shows_as_in_a_window(void **state)
{
	(void)state;
	struct small_scene scene = sloping_scene(GZ_VOXEL_F32);
	check_beside_window(&scene, "trilinear");
	scene.rays.interpolation = GZ_INTERPOLATION_NEAREST;
	check_beside_window(&scene, "nearest");
	scene.rays.interpolation = GZ_INTERPOLATION_TRILINEAR;
	scene.rays.shading = GZ_SHADING_GRADIENT;
	scene.rays.light.occlusion = 0.7;
	check_beside_window(&scene, "lit");
	small_scene_free(&scene);
}

static void peak_of_16_bit_numbers_shows_as_in_a_window(void **state)
{
	(void)state;
	struct small_scene scene = sloping_scene(GZ_VOXEL_U16);
	check_beside_window(&scene, "16 bits");
	small_scene_free(&scene);
}

static void pre_integrated_peak_shows_as_in_a_window(void **state)
{
	(void)state;
	struct small_scene scene = sloping_scene(GZ_VOXEL_F32);
	scene.rays.integration = GZ_INTEGRATION_PREINTEGRATED;
	check_beside_window(&scene, "pre-integrated");
	small_scene_free(&scene);
}

static void pre_integrated_peak_between_distant_values_has_its_share(void **state)
{
	(void)state;
	/* Steep: the peak is passed within a small part of a step. What it adds is its extinction
	 * times that part, however coarse the table. */
	struct small_scene scene = small_scene_waves(48, 40, 32, GZ_VOXEL_F32);
	scene.foveation.method = GZ_METHOD_STANDARD;
	scene.rays.integration = GZ_INTEGRATION_PREINTEGRATED;
	scene.transfer = peak_function(PEAK);
	for (size_t i = 0; i < scene.transfer.count; i++)
		if (scene.transfer.points[i].opacity > 0)
			scene.transfer.points[i].opacity = 1; /* an opaque wall, however thin */
	for (const char *const *set = small_scene_simd_sets(); *set; set++) {
		struct gz_image image = { 0 };
		render_by(&scene, *set, &image);
		if (lit_pixels(&image) < 500)
			fail_msg("%s: %d pixels show the wall", *set, lit_pixels(&image));
		gz_image_free(&image);
	}
	small_scene_free(&scene);
}

static void table_is_as_fine_as_the_narrowest_peak_needs(void **state)
{
	(void)state;
	static struct gz_transfer_table table;
	static const struct {
		double width;
		int least;
	} cases[] = {
		{ 0.3, GZ_TRANSFER_TABLE_SIZE }, { 2.0 / 4095, GZ_TRANSFER_TABLE_SIZE },
		{ 1.0 / 4096, 16384 },           { PEAK, 80000 },
		{ 1.0 / 30000, 120000 },         { 1e-7, GZ_TRANSFER_TABLE_MOST },
	};
	struct small_scene scene = sloping_scene(GZ_VOXEL_F32);
	for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
		const struct gz_transfer transfer = peak_function(cases[i].width);
		gz_transfer_table_bake(&transfer, &scene.volume, &table);
		if (table.count < cases[i].least || table.count > 2 * cases[i].least)
			fail_msg("a peak of %g has %d entries", cases[i].width, table.count);
	}
	/* A narrow gap counts, a narrow stripe of colour, and a step does not. */
	struct gz_transfer transfer = peak_function(PEAK);
	for (size_t i = 0; i < transfer.count; i++)
		transfer.points[i].opacity = 0.08 - transfer.points[i].opacity;
	gz_transfer_table_bake(&transfer, &scene.volume, &table);
	assert_true(table.count > 80000);
	for (size_t i = 0; i < transfer.count; i++)
		transfer.points[i].opacity = 0.1;
	gz_transfer_table_bake(&transfer, &scene.volume, &table);
	assert_true(table.count > 80000);
	transfer.points[4] = transfer.points[5];
	transfer.count = 5;
	gz_transfer_table_bake(&transfer, &scene.volume, &table);
	assert_int_equal(table.count, GZ_TRANSFER_TABLE_SIZE);
	small_scene_free(&scene);
}

static void empty_space_is_told_from_the_peak_by_the_finer_table(void **state)
{
	(void)state;
	static struct gz_transfer_table table;
	struct small_scene scene = sloping_scene(GZ_VOXEL_F32);
	gz_transfer_table_bake(&scene.transfer, &scene.volume, &table);
	assert_true(gz_transfer_table_shows(&table, 0.5 - 0.4 * PEAK, 0.5 - 0.3 * PEAK));
	assert_true(gz_transfer_table_shows(&table, 0.1, 0.9));
	assert_true(gz_transfer_table_shows(&table, 0.5 + 0.45 * PEAK, 0.6));
	assert_false(gz_transfer_table_shows(&table, 0.5 + 3 * PEAK, 0.9));
	assert_false(gz_transfer_table_shows(&table, 0, 0.5 - 3 * PEAK));
	small_scene_free(&scene);
}

TEST_SUITE(narrow_peaks)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(peak_of_floats_shows_as_in_a_window),
		cmocka_unit_test(peak_of_16_bit_numbers_shows_as_in_a_window),
		cmocka_unit_test(pre_integrated_peak_shows_as_in_a_window),
		cmocka_unit_test(pre_integrated_peak_between_distant_values_has_its_share),
		cmocka_unit_test(table_is_as_fine_as_the_narrowest_peak_needs),
		cmocka_unit_test(empty_space_is_told_from_the_peak_by_the_finer_table),
	};
	if (!small_scene_backend_runs())
		return 77;
	return cmocka_run_group_tests(tests, NULL, NULL);
}
