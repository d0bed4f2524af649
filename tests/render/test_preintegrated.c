/* Pre-integrated transfer functions: the tables, the kernels that take them, and thin layers. */
#include "suite.h"

#include <stddef.h>
#include <stdint.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/clock.h"
#include "oracle.h"
#include "render/plan/method.h"
#include "render/transfer/segment_kernels.h"
#include "render/transfer/transfer_preintegrated.h"
#include "small_scene.h"

enum { SIZE = GZ_PREINTEGRATED_SIZE, STRIDE = GZ_PREINTEGRATED_STRIDE(GZ_TRANSFER_TABLE_SIZE) };

static const char *const sets[] = { "portable", "avx2", "avx512" };

static bool runs_here(const char *set)
{
	const struct gz_backend_params params = { .threads = 1, .simd = set };
	struct gz_raycaster *renderer = NULL;
	const bool runs = gz_raycaster_create("cpu", &params, NULL, &renderer) == GZ_OK;
	gz_raycaster_destroy(&renderer);
	return runs;
}

/* A table, its sums and one pre-integrated table of it. */
struct tables {
	struct gz_transfer_table table;
	struct gz_transfer_sums sums;
	struct gz_transfer_entry *entries;
};

static struct tables *make_tables(void)
{
	struct tables *tables = calloc(1, sizeof *tables);
	assert_non_null(tables);
	tables->table.count = GZ_TRANSFER_TABLE_SIZE;
	tables->entries = calloc(GZ_PREINTEGRATED_ENTRIES, sizeof *tables->entries);
	assert_non_null(tables->entries);
	return tables;
}

/* Fill the entries of a table of one length. */
static void integrate(const struct tables *from, double length, struct gz_workers *workers,
		      struct tables *out_tables)
{
	gz_transfer_preintegrate(&from->sums, &length, 1, workers, &out_tables->entries);
}

static void free_tables(struct tables *tables)
{
	free(tables->entries);
	free(tables);
}

static uint32_t red(uint32_t colour)
{
	return colour >> 21;
}

/* A segment in 1/16 of entries: colour (red alone, 0 to 2047) and opacity, one after another. */
static void integrate_finely(const struct gz_transfer_table *table, double length, int front,
			     int back, double *out_red, double *out_opacity)
{
	const int first = front * STRIDE + STRIDE / 2, last = back * STRIDE + STRIDE / 2;
	const int parts = 16 * abs(last - first);
	double through = 1, sum = 0;
	for (int i = 0; i < parts; i++) {
		const int entry = (int)floor(first + (last - first) * (i + 0.5) / parts);
		const struct gz_transfer_entry *is = &table->entries[entry];
		const double opacity = 1 - exp2(length / parts * (double)is->extinction);
		sum += through * opacity * red(is->colour);
		through *= 1 - opacity;
	}
	*out_opacity = 1 - through;
	*out_red = sum;
}

static void check_pair(const struct tables *tables, double length, int front, int back)
{
	const struct gz_transfer_entry *is = &tables->entries[front * SIZE + back];
	double colour, opacity;
	integrate_finely(&tables->table, length, front, back, &colour, &opacity);
	if (fabs((double)is->opacity - opacity) > 1e-6)
		fail_msg("length %g, %d to %d: opacity %g, not %g", length, front, back,
			 (double)is->opacity, opacity);
	/* order within a quarter of a segment is not kept: half a grey level */
	if (fabs((double)is->opacity * red(is->colour) - colour) > 2047 * 0.5 / 255)
		fail_msg("length %g, %d to %d: red %g, not %g", length, front, back,
			 (double)is->opacity * red(is->colour), colour);
}

static void tables_equal_fine_integration_between_two_values(void **state)
{
	(void)state;
	struct small_scene scene = small_scene_waves(20, 20, 20, GZ_VOXEL_U16);
	struct tables *tables = make_tables();
	gz_transfer_table_bake(&scene.transfer, &scene.volume, &tables->table);
	gz_transfer_sums_make(&tables->table, &tables->sums);
	static const double lengths[] = { 1.0 / 32, 2.0 / 3, 4 };
	for (int i = 0; i < 3; i++) {
		integrate(tables, lengths[i], NULL, tables);
		for (int front = 3; front < SIZE; front += 61)
			for (int back = 11; back < SIZE; back += 57)
				if (front != back)
					check_pair(tables, lengths[i], front, back);
	}
	free_tables(tables);
	small_scene_free(&scene);
}

static void segment_within_a_cell_has_its_mean(void **state)
{
	(void)state;
	struct small_scene scene = small_scene_waves(20, 20, 20, GZ_VOXEL_U16);
	struct tables *tables = make_tables();
	gz_transfer_table_bake(&scene.transfer, &scene.volume, &tables->table);
	gz_transfer_sums_make(&tables->table, &tables->sums);
	integrate(tables, 2, NULL, tables);
	for (int cell = 0; cell < SIZE; cell++) {
		double mean = 0;
		for (int i = 0; i < STRIDE; i++)
			mean += (double)tables->table.entries[cell * STRIDE + i].extinction /
				STRIDE;
		const double opacity = 1 - exp2(2 * mean);
		const double is = (double)tables->entries[cell * SIZE + cell].opacity;
		if (fabs(is - opacity) > 1e-6)
			fail_msg("cell %d: %g, not %g", cell, is, opacity);
	}
	free_tables(tables);
	small_scene_free(&scene);
}

static void spike_one_entry_wide_is_exact_for_every_segment_over_it(void **state)
{
	(void)state;
	enum { SPIKE = 1237 };
	struct tables *tables = make_tables();
	tables->table.entries[SPIKE].extinction = (float)log2(1 - 0.9);
	tables->table.entries[SPIKE].colour = 2047U << 21;
	gz_transfer_sums_make(&tables->table, &tables->sums);
	integrate(tables, 1.5, NULL, tables);
	int over = 0;
	for (int front = 0; front < SIZE; front++)
		for (int back = front % 5; back < SIZE; back += 5) {
			if (front == back)
				continue;
			const int from = (front < back ? front : back) * STRIDE + STRIDE / 2;
			const int to = (front < back ? back : front) * STRIDE + STRIDE / 2;
			const bool holds = from <= SPIKE && SPIKE < to;
			/* one entry of to - from */
			const double exact = holds ? 1 - pow(0.1, 1.5 / (to - from)) : 0;
			const struct gz_transfer_entry *is = &tables->entries[front * SIZE + back];
			if (fabs((double)is->opacity - exact) > 1e-6)
				fail_msg("%d to %d: %g, not %g", front, back, (double)is->opacity,
					 exact);
			if (holds)
				assert_true(red(is->colour) == 2047);
			over += holds;
		}
	assert_true(over > 10000);
	free_tables(tables);
}

static void opaque_spike_lets_nothing_through(void **state)
{
	(void)state;
	struct tables *tables = make_tables();
	tables->table.entries[2000].extinction = -INFINITY;
	gz_transfer_sums_make(&tables->table, &tables->sums);
	integrate(tables, 1.0 / 32, NULL, tables);
	assert_true(tables->entries[SIZE - 1].opacity == 1);
	assert_true(tables->entries[(SIZE - 1) * SIZE].opacity == 1);
	assert_true(tables->entries[10 * SIZE + 100].opacity == 0);
	free_tables(tables);
}

static void front_colour_hides_the_back_one(void **state)
{
	(void)state;
	struct tables *tables = make_tables();
	for (int i = 0; i < GZ_TRANSFER_TABLE_SIZE; i++) {
		tables->table.entries[i].extinction = -4;
		tables->table.entries[i].colour = i < 2048 ? 2047U << 21 : 1023;
	}
	gz_transfer_sums_make(&tables->table, &tables->sums);
	integrate(tables, 4, NULL, tables);
	assert_true(red(tables->entries[SIZE - 1].colour) > 2000);
	assert_true(red(tables->entries[(SIZE - 1) * SIZE].colour) < 47);
	free_tables(tables);
}

static void tables_are_the_same_bits_for_any_number_of_workers(void **state)
{
	(void)state;
	struct small_scene scene = small_scene_waves(20, 20, 20, GZ_VOXEL_U8);
	struct tables *alone = make_tables(), *shared = make_tables();
	struct gz_workers *workers = NULL;
	assert_int_equal(gz_workers_create(3, &workers), GZ_OK);
	gz_transfer_table_bake(&scene.transfer, &scene.volume, &alone->table);
	gz_transfer_sums_make(&alone->table, &alone->sums);
	const int64_t start_ns = gz_clock_now_ns();
	integrate(alone, 1.5, NULL, alone);
	print_message("a table of one step length: %.2f ms on one core\n",
		      gz_ns_to_ms(gz_clock_now_ns() - start_ns));
	integrate(alone, 1.5, workers, shared);
	assert_memory_equal(alone->entries, shared->entries,
			    GZ_PREINTEGRATED_ENTRIES * sizeof *alone->entries);
	gz_workers_destroy(&workers);
	free_tables(alone);
	free_tables(shared);
	small_scene_free(&scene);
}

static void tables_of_several_lengths_are_those_of_each(void **state)
{
	(void)state;
	static const double lengths[] = { 0.5, 2, 3.25 };
	struct small_scene scene = small_scene_waves(20, 20, 20, GZ_VOXEL_U8);
	struct tables *tables[4];
	struct gz_transfer_entry *entries[3];
	for (int i = 0; i < 4; i++)
		tables[i] = make_tables();
	for (int i = 0; i < 3; i++)
		entries[i] = tables[i]->entries;
	gz_transfer_table_bake(&scene.transfer, &scene.volume, &tables[0]->table);
	gz_transfer_sums_make(&tables[0]->table, &tables[0]->sums);
	gz_transfer_preintegrate(&tables[0]->sums, lengths, 3, NULL, entries);
	for (int i = 0; i < 3; i++) {
		integrate(tables[0], lengths[i], NULL, tables[3]);
		assert_memory_equal(entries[i], tables[3]->entries,
				    GZ_PREINTEGRATED_ENTRIES * sizeof *entries[i]);
	}
	for (int i = 0; i < 4; i++)
		free_tables(tables[i]);
	small_scene_free(&scene);
}

/* The rows of two sets of kernels, by their bits. */
static void check_segment_kernels(const struct gz_segment_kernels *one,
				  const struct gz_segment_kernels *other,
				  const struct gz_transfer_sums *sums)
{
	static struct gz_segment_means means[2];
	static struct gz_transfer_entry rising[2][SIZE], falling[2][SIZE], mixed[2][SIZE];
	const struct gz_segment_kernels *const of[2] = { one, other };
	for (int low = 0; low < SIZE; low += 37) {
		const int count = SIZE - 1 - low;
		for (int i = 0; i < 2; i++) {
			of[i]->average(sums, low, count, &means[i]);
			of[i]->blend(&means[i], count, 0.7F, rising[i], falling[i]);
			of[i]->segment_in_cell(sums, low, 0.7F, &rising[i][count]);
			of[i]->mix(sums, low, count, mixed[i]);
			of[i]->mix_in_cell(sums, low, &mixed[i][count]);
		}
		const size_t bytes = (size_t)count * sizeof rising[0][0];
		assert_memory_equal(rising[0], rising[1], bytes + sizeof rising[0][0]);
		assert_memory_equal(falling[0], falling[1], bytes);
		assert_memory_equal(mixed[0], mixed[1], bytes + sizeof mixed[0][0]);
	}
}

static void tables_are_the_same_bits_by_all_instruction_sets(void **state)
{
	(void)state;
	struct small_scene scene = small_scene_waves(20, 20, 20, GZ_VOXEL_U8);
	struct tables *tables = make_tables();
	scene.transfer.points[1].opacity = 1;
	gz_transfer_table_bake(&scene.transfer, &scene.volume, &tables->table);
	gz_transfer_sums_make(&tables->table, &tables->sums);
	const struct gz_segment_kernels *portable = gz_segment_kernels_find(sets[0]);
	assert_non_null(portable);
	assert_null(gz_segment_kernels_find("sse9"));
	for (size_t i = 1; i < sizeof sets / sizeof sets[0]; i++) {
		const struct gz_segment_kernels *kernels = gz_segment_kernels_find(sets[i]);
		if (kernels)
			check_segment_kernels(portable, kernels, &tables->sums);
	}
	free_tables(tables);
	small_scene_free(&scene);
}

/* Every pixel of the picture by one instruction set against the oracle. */
static void check_set(struct small_scene *scene, const char *set, int width, int height)
{
	struct gz_raycaster *renderer = small_scene_renderer(scene, 2, set);
	struct gz_image image = { 0 };
	scene->foveation.method = GZ_METHOD_STANDARD;
	scene->rays.integration = GZ_INTEGRATION_PREINTEGRATED;
	small_scene_render(renderer, scene, width, height, &image, NULL);
	double worst = 0;
	for (int y = 0; y < height; y++)
		for (int x = 0; x < width; x++) {
			double rgb[3];
			oracle_pixel(&scene->volume, &scene->transfer, &scene->camera, &scene->rays,
				     width, height, x, y, rgb);
			for (int channel = 0; channel < 3; channel++)
				worst = fmax(worst,
					     fabs(image.pixels[4 * (y * width + x) + channel] -
						  255 * rgb[channel]));
		}
	/* half a grey level is rounding, the rest that values are told apart by cells */
	if (worst > 1.25)
		fail_msg("%s: %.2f grey levels from the oracle", set, worst);
	gz_raycaster_destroy(&renderer);
	gz_image_free(&image);
}

static void check(struct small_scene *scene, int width, int height)
{
	for (size_t i = 0; i < sizeof sets / sizeof sets[0]; i++)
		if (runs_here(sets[i]))
			check_set(scene, sets[i], width, height);
	small_scene_free(scene);
}

static void cast_of_every_type_equals_the_oracle(void **state)
{
	(void)state;
	for (int type = 0; type < GZ_VOXEL_TYPE_COUNT; type++) {
		struct small_scene scene = small_scene_waves(40, 33, 27, (enum gz_voxel_type)type);
		check(&scene, 31, 23);
	}
}

static void cast_by_nearest_voxel_inside_and_of_flat_volumes_equals_the_oracle(void **state)
{
	(void)state;
	struct small_scene inside = small_scene_waves(30, 30, 30, GZ_VOXEL_U8);
	memcpy(inside.camera.eye, (double[3]) { 0.13, 0.21, 0.07 }, sizeof inside.camera.eye);
	memcpy(inside.camera.look_at, (double[3]) { -0.3, -0.2, 0.1 },
	       sizeof inside.camera.look_at);
	check(&inside, 20, 20);
	static const int dims[][3] = { { 1, 1, 1 }, { 40, 1, 1 }, { 1, 40, 40 }, { 2, 2, 2 } };
	for (size_t i = 0; i < sizeof dims / sizeof dims[0]; i++) {
		struct small_scene scene =
			small_scene_waves(dims[i][0], dims[i][1], dims[i][2], GZ_VOXEL_U8);
		scene.transfer.points[0].opacity = 0.2;
		check(&scene, 17, 13);
	}
	/* constant data are the same by nearest voxel */
	struct small_scene constant = small_scene_constant(20, 0.05);
	constant.rays.interpolation = GZ_INTERPOLATION_NEAREST;
	check(&constant, 15, 15);
}

static void cast_with_steps_of_several_voxels_equals_the_oracle(void **state)
{
	(void)state;
	static const double steps[] = { 1, 2, 4 };
	for (int i = 0; i < 3; i++) {
		struct small_scene scene = small_scene_waves(48, 48, 48, GZ_VOXEL_U16);
		scene.rays.ray_sampling_rate = 1 / steps[i];
		check(&scene, 23, 23);
	}
}

static void cast_with_clip_box_and_jitter_equals_the_oracle(void **state)
{
	(void)state;
	struct small_scene scene = small_scene_waves(36, 40, 31, GZ_VOXEL_U8);
	memcpy(scene.rays.clip.least, (double[3]) { 0.21, 0.33, 0.1 },
	       sizeof scene.rays.clip.least);
	memcpy(scene.rays.clip.greatest, (double[3]) { 0.9, 0.77, 0.83 },
	       sizeof scene.rays.clip.greatest);
	scene.rays.jitter = 7;
	scene.rays.ray_sampling_rate = 0.6;
	check(&scene, 25, 25);
}

static void constant_box_keeps_its_brightness_for_any_step(void **state)
{
	(void)state;
	struct small_scene scene = small_scene_constant(64, 0.013);
	struct gz_raycaster *renderer = small_scene_renderer(&scene, 2, NULL);
	struct gz_image reference = { 0 };
	scene.foveation.method = GZ_METHOD_STANDARD;
	scene.rays.ray_sampling_rate = 8;
	small_scene_render(renderer, &scene, 120, 100, &reference, NULL);
	scene.rays.integration = GZ_INTEGRATION_PREINTEGRATED;
	static const double rates[] = { 0.25, 0.37, 1, 1.5, 3 };
	for (size_t i = 0; i < sizeof rates / sizeof rates[0]; i++) {
		struct gz_image image = { 0 };
		int x = 0, y = 0;
		scene.rays.ray_sampling_rate = rates[i];
		small_scene_render(renderer, &scene, 120, 100, &image, NULL);
		if (image_difference(&reference, &image, &x, &y) > 1)
			fail_msg("rate %g: pixel %d %d differs", rates[i], x, y);
		gz_image_free(&image);
	}
	gz_raycaster_destroy(&renderer);
	gz_image_free(&reference);
	small_scene_free(&scene);
}

static void picture_is_the_same_bits_for_any_number_of_threads(void **state)
{
	(void)state;
	struct small_scene scene = small_scene_waves(50, 41, 60, GZ_VOXEL_U8);
	scene.rays.integration = GZ_INTEGRATION_PREINTEGRATED;
	scene.foveation.method = GZ_METHOD_ACUITY;
	struct gz_image images[2] = { { 0 }, { 0 } };
	struct gz_frame_stats stats[2];
	for (int i = 0; i < 2; i++) {
		struct gz_raycaster *renderer = small_scene_renderer(&scene, 1 + 4 * i, NULL);
		small_scene_render(renderer, &scene, 317, 203, &images[i], &stats[i]);
		gz_raycaster_destroy(&renderer);
	}
	assert_memory_equal(images[0].pixels, images[1].pixels, 317 * 203 * 4);
	assert_int_equal(stats[0].samples, stats[1].samples);
	gz_image_free(&images[0]);
	gz_image_free(&images[1]);
	small_scene_free(&scene);
}

static void draw_by_set(const struct small_scene *scene, const char *set, struct gz_image *image)
{
	struct gz_raycaster *renderer = small_scene_renderer(scene, 2, set);
	small_scene_render(renderer, scene, 96, 80, image, NULL);
	gz_raycaster_destroy(&renderer);
}

/* The ball's pixels are those of samples, but for segments that meet it between two samples. */
static void check_bare_around_ball(struct small_scene *scene)
{
	for (const char *const *set = small_scene_simd_sets(); *set; set++) {
		struct gz_image samples = { 0 }, segments = { 0 };
		scene->rays.integration = GZ_INTEGRATION_SAMPLED;
		draw_by_set(scene, *set, &samples);
		scene->rays.integration = GZ_INTEGRATION_PREINTEGRATED;
		draw_by_set(scene, *set, &segments);
		int ball = 0, fog = 0;
		for (int i = 0; i < 4 * 96 * 80; i += 4) {
			const bool bare = memcmp(samples.pixels + i, samples.pixels, 3) == 0;
			ball += !bare;
			fog += bare && memcmp(segments.pixels + i, samples.pixels, 3) != 0;
		}
		print_message("%s: %d pixels beside %d of the ball\n", *set, fog, ball);
		assert_true(ball > 300);
		assert_true(fog <= ball / 20);
		gz_image_free(&samples);
		gz_image_free(&segments);
	}
}

static void values_that_show_nothing_stay_bare(void **state)
{
	(void)state;
	struct small_scene scene = small_scene_ball_in_hidden_matter();
	check_bare_around_ball(&scene);
	small_scene_free(&scene);
}

/* The ball by a finer table, because of a narrow gap in a colour. Matter varies, so that the ends
 * of segments are entries apart. */
static struct small_scene ball_by_finer_table(void)
{
	const double wall = 60.2 / 255;
	struct small_scene scene = small_scene_ball_in_hidden_matter();
	struct tables *tables = make_tables();
	uint8_t *voxels = scene.volume.voxels;
	for (size_t i = 0; i < gz_volume_voxel_count(&scene.volume); i += 4)
		voxels[i]--;
	scene.transfer = (struct gz_transfer) {
		.count = 5,
		.points = { { wall, { 0, 0, 0 }, 0 },
			    { wall, { 1, 1, 1 }, 0.6 },
			    { 0.3, { 1, 1, 1 }, 0.6 },
			    { 0.30001, { 0, 1, 1 }, 0.6 },
			    { 0.30002, { 1, 1, 1 }, 0.6 } },
	};
	gz_transfer_table_bake(&scene.transfer, &scene.volume, &tables->table);
	assert_int_equal(tables->table.count, GZ_TRANSFER_TABLE_MOST);
	free_tables(tables);
	return scene;
}

static void values_that_show_nothing_stay_bare_by_finer_tables(void **state)
{
	(void)state;
	struct small_scene scene = ball_by_finer_table();
	check_bare_around_ball(&scene);
	small_scene_free(&scene);
}

/* The rays of a plan that lie a spacing apart are those of every pixel. */
static void check_spacing(struct small_scene *scene, const char *set, int spacing)
{
	struct gz_image every = { 0 }, few = { 0 };
	scene->foveation.method = GZ_METHOD_STANDARD;
	draw_by_set(scene, set, &every);
	scene->foveation.method = GZ_METHOD_UNIFORM;
	scene->foveation.uniform_spacing = spacing;
	draw_by_set(scene, set, &few);
	for (int y = 0; y < 80; y += spacing)
		for (int x = 0; x < 96; x += spacing) {
			const int at = 4 * (y * 96 + x);
			if (memcmp(every.pixels + at, few.pixels + at, 4) != 0)
				fail_msg("%s: rate %g, spacing %d: %d, %d differs", set,
					 scene->rays.ray_sampling_rate, spacing, x, y);
		}
	gz_image_free(&every);
	gz_image_free(&few);
}

static void check_tiles(struct small_scene *scene)
{
	static const double rates[] = { 3, 1, 0.3, 0.15 };
	static const int spacings[] = { 3, 5, 16 };
	for (const char *const *set = small_scene_simd_sets(); *set; set++)
		for (int i = 0; i < 12; i++) {
			scene->rays.ray_sampling_rate = rates[i / 3];
			check_spacing(scene, *set, spacings[i % 3]);
		}
	small_scene_free(scene);
}

static void rays_show_the_same_in_every_tile(void **state)
{
	(void)state;
	struct small_scene usual = small_scene_ball_in_hidden_matter();
	struct small_scene finer = ball_by_finer_table();
	check_tiles(&usual);
	check_tiles(&finer);
}

static void empty_space_takes_no_samples(void **state)
{
	(void)state;
	struct small_scene scene = small_scene_constant(64, 0);
	scene.rays.integration = GZ_INTEGRATION_PREINTEGRATED;
	struct gz_raycaster *renderer = small_scene_renderer(&scene, 1, NULL);
	struct gz_image image = { 0 };
	struct gz_frame_stats stats;
	small_scene_render(renderer, &scene, 64, 64, &image, &stats);
	/* a lane takes one segment where it meets the box's far face */
	if (stats.samples > 2 * 64 * 64)
		fail_msg("%llu samples", (unsigned long long)stats.samples);
	gz_raycaster_destroy(&renderer);
	gz_image_free(&image);
	small_scene_free(&scene);
}

/* A ball of smooth data, of which the transfer function shows one shell as thick as a voxel: an
 * isosurface. Seen by rays through its middle, which cross it twice. */
static struct small_scene shell_scene(void)
{
	struct small_scene scene = small_scene_waves(64, 64, 64, GZ_VOXEL_U16);
	uint16_t *voxels = scene.volume.voxels;
	for (int i = 0; i < 64 * 64 * 64; i++) {
		const double x = i % 64 - 31.5, y = i / 64 % 64 - 31.5, z = i / 4096 - 31.5;
		voxels[i] = (uint16_t)fmin(sqrt(x * x + y * y + z * z) * 1000, 60000);
	}
	gz_volume_find_range(&scene.volume);
	/* values are 1000 a voxel; the range is 866 to 54559 */
	const double low = (20000 - 866) / 53693.0, high = (20250 - 866) / 53693.0;
	scene.transfer = (struct gz_transfer){
		.count = 6,
		.points = {
			{ 0, { 1, 1, 1 }, 0 },
			{ low, { 1, 1, 1 }, 0 },
			{ low + 1e-6, { 1, 1, 1 }, 0.98 },
			{ high, { 1, 1, 1 }, 0.98 },
			{ high + 1e-6, { 1, 1, 1 }, 0 },
			{ 1, { 1, 1, 1 }, 0 },
		},
	};
	scene.foveation.method = GZ_METHOD_STANDARD;
	return scene;
}

/* Share of pixels, of those within the shell's outline, that show less than half of what they do
 * with fine steps. */
static double share_lost(struct gz_raycaster *renderer, struct small_scene *scene, double step,
			 int integration, const struct gz_image *fine)
{
	struct gz_image image = { 0 };
	scene->rays.ray_sampling_rate = 1 / step;
	scene->rays.integration = integration;
	small_scene_render(renderer, scene, fine->width, fine->height, &image, NULL);
	int within = 0, lost = 0;
	for (int i = 0; i < fine->width * fine->height; i++) {
		within += fine->pixels[4 * i] > 60;
		lost += fine->pixels[4 * i] > 60 && image.pixels[4 * i] < fine->pixels[4 * i] / 2;
	}
	assert_true(within > 400);
	gz_image_free(&image);
	return (double)lost / within;
}

static void thin_shell_is_lost_by_samples_but_not_by_segments(void **state)
{
	(void)state;
	struct small_scene scene = shell_scene();
	struct gz_raycaster *renderer = small_scene_renderer(&scene, 2, NULL);
	struct gz_image fine = { 0 };
	scene.rays.ray_sampling_rate = 32;
	small_scene_render(renderer, &scene, 160, 120, &fine, NULL);
	for (int step = 1; step <= 4; step++) {
		const double sampled =
			share_lost(renderer, &scene, step, GZ_INTEGRATION_SAMPLED, &fine);
		const double preintegrated =
			share_lost(renderer, &scene, step, GZ_INTEGRATION_PREINTEGRATED, &fine);
		print_message("a shell a quarter of a voxel thick, steps of %d: %.1f %% of its "
			      "pixels lost "
			      "by samples, %.1f %% by segments\n",
			      step, 100 * sampled, 100 * preintegrated);
		assert_true(sampled > 0.1);
		/* a ray that only grazes the shell may dip into it between two ends */
		if (preintegrated > (step <= 1 ? 0 : 0.01))
			fail_msg("steps of %d: %g of the shell lost", step, preintegrated);
	}
	gz_image_free(&fine);
	gz_raycaster_destroy(&renderer);
	small_scene_free(&scene);
}

/* Wires one voxel thick in empty space, along an axis and askew. One that lies between two samples
 * is seen by neither, and is no value between those of both: segments lose it as samples do. A
 * share is bounded, not forbidden. */
static struct small_scene wire_scene(void)
{
	struct small_scene scene = small_scene_waves(64, 64, 64, GZ_VOXEL_U8);
	uint8_t *voxels = scene.volume.voxels;
	memset(voxels, 0, gz_volume_voxel_count(&scene.volume));
	for (int i = 4; i < 60; i++) {
		voxels[(32 * 64 + 20) * 64 + i] = 255;
		voxels[((10 + i / 2) * 64 + i) * 64 + 64 - i] = 255;
	}
	gz_volume_find_range(&scene.volume);
	scene.transfer = (struct gz_transfer) {
		.count = 2,
		.points = { { 0.1, { 1, 1, 1 }, 0 }, { 0.4, { 1, 1, 1 }, 0.95 } },
	};
	scene.foveation.method = GZ_METHOD_STANDARD;
	return scene;
}

static void thin_wires_lose_a_bounded_share_of_pixels(void **state)
{
	(void)state;
	struct small_scene scene = wire_scene();
	struct gz_raycaster *renderer = small_scene_renderer(&scene, 2, NULL);
	struct gz_image fine = { 0 };
	scene.rays.ray_sampling_rate = 32;
	small_scene_render(renderer, &scene, 240, 180, &fine, NULL);
	static const double most[] = { 0.06, 0.5, 0.62, 0.72 };
	for (int step = 1; step <= 4; step++) {
		const double sampled =
			share_lost(renderer, &scene, step, GZ_INTEGRATION_SAMPLED, &fine);
		const double preintegrated =
			share_lost(renderer, &scene, step, GZ_INTEGRATION_PREINTEGRATED, &fine);
		print_message("wires one voxel thick, steps of %d: %.1f %% of their pixels lost by "
			      "samples, %.1f %% by segments\n",
			      step, 100 * sampled, 100 * preintegrated);
		if (sampled > most[step - 1] || preintegrated > most[step - 1])
			fail_msg("steps of %d: %g lost by samples, %g by segments", step, sampled,
				 preintegrated);
	}
	gz_image_free(&fine);
	gz_raycaster_destroy(&renderer);
	small_scene_free(&scene);
}

static void new_transfer_function_makes_new_tables(void **state)
{
	(void)state;
	struct small_scene scene = small_scene_waves(32, 32, 32, GZ_VOXEL_U8);
	scene.rays.integration = GZ_INTEGRATION_PREINTEGRATED;
	struct gz_raycaster *used = small_scene_renderer(&scene, 2, NULL);
	struct gz_image first = { 0 }, second = { 0 };
	small_scene_render(used, &scene, 60, 50, &first, NULL);
	scene.transfer.points[0].opacity = 0.2;
	assert_int_equal(gz_raycaster_set_transfer(used, &scene.transfer), GZ_OK);
	small_scene_render(used, &scene, 60, 50, &first, NULL);
	struct gz_raycaster *fresh = small_scene_renderer(&scene, 2, NULL);
	small_scene_render(fresh, &scene, 60, 50, &second, NULL);
	assert_memory_equal(first.pixels, second.pixels, 60 * 50 * 4);
	gz_raycaster_destroy(&used);
	gz_raycaster_destroy(&fresh);
	gz_image_free(&first);
	gz_image_free(&second);
	small_scene_free(&scene);
}

TEST_SUITE(preintegrated)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(tables_equal_fine_integration_between_two_values),
		cmocka_unit_test(segment_within_a_cell_has_its_mean),
		cmocka_unit_test(spike_one_entry_wide_is_exact_for_every_segment_over_it),
		cmocka_unit_test(opaque_spike_lets_nothing_through),
		cmocka_unit_test(front_colour_hides_the_back_one),
		cmocka_unit_test(tables_are_the_same_bits_for_any_number_of_workers),
		cmocka_unit_test(tables_of_several_lengths_are_those_of_each),
		cmocka_unit_test(tables_are_the_same_bits_by_all_instruction_sets),
		cmocka_unit_test(cast_of_every_type_equals_the_oracle),
		cmocka_unit_test(
			cast_by_nearest_voxel_inside_and_of_flat_volumes_equals_the_oracle),
		cmocka_unit_test(cast_with_steps_of_several_voxels_equals_the_oracle),
		cmocka_unit_test(cast_with_clip_box_and_jitter_equals_the_oracle),
		cmocka_unit_test(constant_box_keeps_its_brightness_for_any_step),
		cmocka_unit_test(picture_is_the_same_bits_for_any_number_of_threads),
		cmocka_unit_test(values_that_show_nothing_stay_bare),
		cmocka_unit_test(values_that_show_nothing_stay_bare_by_finer_tables),
		cmocka_unit_test(rays_show_the_same_in_every_tile),
		cmocka_unit_test(empty_space_takes_no_samples),
		cmocka_unit_test(thin_shell_is_lost_by_samples_but_not_by_segments),
		cmocka_unit_test(thin_wires_lose_a_bounded_share_of_pixels),
		cmocka_unit_test(new_transfer_function_makes_new_tables),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
