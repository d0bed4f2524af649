/* Pictures of volumes that are files of bricks: those of the volume in memory once all bricks are
 * there, and never without a part before. */
#include "suite.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/captured_log.h"
#include "render/data/brick_pool.h"
#include "render/data/format.h"
#include "render/data/levels.h"
#include "render/plan/method.h"
#include "render/raycast/cpu/cast.h"
#include "render/raycast/shared/raycaster.h"
#include "small_scene.h"
#include "volume_files.h"

enum { WIDTH = 96, HEIGHT = 80 };

static struct gz_volume bricks_of(const struct gz_volume *volume, const char *name,
				  size_t brick_bytes)
{
	const char *path = files_path(name);
	const struct gz_loading loading = { .brick_bytes = brick_bytes };
	struct gz_volume bricks;
	assert_int_equal(gz_bricks_write(volume, path, NULL, NULL), GZ_OK);
	assert_int_equal(gz_volume_load(path, NULL, &loading, NULL, &bricks), GZ_OK);
	return bricks;
}

static struct gz_raycaster *renderer_of(const struct small_scene *scene, const char *simd,
					bool wait)
{
	const struct gz_backend_params params = { .simd = simd, .wait_for_bricks = wait };
	struct gz_raycaster *renderer = NULL;
	assert_int_equal(gz_raycaster_create("cpu", &params, NULL, &renderer), GZ_OK);
	assert_int_equal(gz_raycaster_set_volume(renderer, &scene->volume), GZ_OK);
	assert_int_equal(gz_raycaster_set_transfer(renderer, &scene->transfer), GZ_OK);
	return renderer;
}

static struct gz_frame_stats render(const struct small_scene *scene, const char *simd, bool wait,
				    struct gz_image *image)
{
	struct gz_frame_stats stats;
	struct gz_raycaster *renderer = renderer_of(scene, simd, wait);
	small_scene_render(renderer, scene, WIDTH, HEIGHT, image, &stats);
	gz_raycaster_destroy(&renderer);
	return stats;
}

/* The least memory that the bricks of a scene's volume are given. */
static size_t least_bytes(const struct small_scene *scene)
{
	return GZ_BRICK_POOL_LEAST * GZ_BRICK_VOXELS * gz_voxel_size(scene->volume.type);
}

/* The same scene with its volume as bricks; the volume in memory stays the caller's. */
static struct small_scene as_bricks(const struct small_scene *scene, size_t brick_bytes)
{
	struct small_scene bricks = *scene;
	bricks.volume = bricks_of(&scene->volume, "scene.gzb", brick_bytes);
	return bricks;
}

/* To so many levels at every pixel. */
static void check_close(const struct small_scene *memory, const struct small_scene *bricks,
			const char *simd, const char *what, int most)
{
	struct gz_image a = { 0 }, b = { 0 };
	int x = 0, y = 0;
	render(memory, simd, true, &a);
	const struct gz_frame_stats stats = render(bricks, simd, true, &b);
	assert_int_equal(stats.bricks_coming, 0);
	const int difference = image_difference(&a, &b, &x, &y);
	if (difference > most)
		fail_msg("%s %s: differs by %d at (%d, %d)", what, simd, difference, x, y);
	gz_image_free(&a);
	gz_image_free(&b);
}

static void check_same(const struct small_scene *memory, const struct small_scene *bricks,
		       const char *simd, const char *what)
{
	check_close(memory, bricks, simd, what, 1);
}

static void picture_of_all_bricks_is_that_of_the_volume_in_memory(void **state)
{
	(void)state;
	static const char *const sets[] = { "auto", "avx2", "portable" };
	static const struct {
		int dims[3];
		enum gz_voxel_type type;
		int interpolation;
	} cases[] = {
		{ { 70, 65, 50 }, GZ_VOXEL_U8, GZ_INTERPOLATION_TRILINEAR },
		{ { 64, 64, 64 }, GZ_VOXEL_U16, GZ_INTERPOLATION_TRILINEAR },
		{ { 33, 40, 97 }, GZ_VOXEL_F32, GZ_INTERPOLATION_TRILINEAR },
		{ { 70, 65, 50 }, GZ_VOXEL_U16, GZ_INTERPOLATION_NEAREST },
		{ { 50, 1, 40 }, GZ_VOXEL_U8, GZ_INTERPOLATION_TRILINEAR },
		{ { 1, 1, 1 }, GZ_VOXEL_U16, GZ_INTERPOLATION_TRILINEAR },
		{ { 1, 45, 40 }, GZ_VOXEL_F32, GZ_INTERPOLATION_NEAREST },
	};
	for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
		const int *d = cases[i].dims;
		struct small_scene scene = small_scene_waves(d[0], d[1], d[2], cases[i].type);
		scene.rays.interpolation = cases[i].interpolation;
		struct small_scene bricks = as_bricks(&scene, 0);
		for (size_t k = 0; k < 3; k++)
			if (gz_cast_kernels_find(sets[k]))
				check_same(&scene, &bricks, sets[k], "whole");
		scene.camera.projection = bricks.camera.projection = GZ_PROJECTION_ORTHOGRAPHIC;
		check_same(&scene, &bricks, "auto", "orthographic");
		small_scene_free(&bricks);
		small_scene_free(&scene);
	}
}

static void shaded_clipped_and_preintegrated_it_is_the_same(void **state)
{
	(void)state;
	struct small_scene scene = small_scene_waves(70, 65, 50, GZ_VOXEL_U16);
	struct small_scene bricks = as_bricks(&scene, 0);
	scene.rays.shading = GZ_SHADING_GRADIENT;
	scene.rays.clip.least[0] = 0.2;
	scene.rays.clip.greatest[2] = 0.7;
	bricks.rays = scene.rays;
	check_same(&scene, &bricks, "auto", "shaded");
	check_same(&scene, &bricks, "portable", "shaded");
	scene.rays.integration = GZ_INTEGRATION_PREINTEGRATED;
	scene.rays.shading = GZ_SHADING_NONE;
	bricks.rays = scene.rays;
	check_same(&scene, &bricks, "auto", "pre-integrated");
	check_same(&scene, &bricks, "portable", "pre-integrated");
	small_scene_free(&bricks);
	small_scene_free(&scene);
}

/* Of a volume in memory, the segments of a tile's rays are found side by side, by what cells show;
 * of bricks, each ray finds its own. Layers of values lie between those that show nothing, so a
 * segment that is left out, or its colour from another place, is seen. Interpolation rounds in two
 * ways, which the walls of layers make two levels. */
static void segments_side_by_side_are_those_of_each_ray(void **state)
{
	(void)state;
	static const double rates[] = { 3, 1, 0.3, 0.15 };
	static const int spacings[] = { 1, 5, 16 };
	/* Voxels of 60 show nothing, but share a cell of the pre-integrated table with what does.
	 */
	static const double wall = 966.0 / 4095;
	struct small_scene scene = small_scene_waves(70, 65, 50, GZ_VOXEL_U8);
	scene.transfer = (struct gz_transfer) {
		.count = 6,
		.points = { { 0, { 0, 0, 0 }, 0 },
			    { wall, { 0, 0, 0 }, 0 },
			    { wall, { 1, 0.8, 0.3 }, 0.6 },
			    { 0.5, { 1, 0.8, 0.3 }, 0.6 },
			    { 0.5, { 0, 0, 0 }, 0 },
			    { 1, { 0, 0, 0 }, 0 } },
	};
	scene.rays.integration = GZ_INTEGRATION_PREINTEGRATED;
	scene.foveation.method = GZ_METHOD_UNIFORM;
	struct small_scene bricks = as_bricks(&scene, 0);
	for (const char *const *set = small_scene_simd_sets(); *set; set++)
		for (size_t i = 0; i < 12; i++) {
			scene.rays.ray_sampling_rate = rates[i / 3];
			scene.foveation.uniform_spacing = spacings[i % 3];
			bricks.rays = scene.rays;
			bricks.foveation = scene.foveation;
			char what[64];
			snprintf(what, sizeof what, "rate %g, spacing %d", rates[i / 3],
				 spacings[i % 3]);
			check_close(&scene, &bricks, *set, what, 2);
			scene.rays.shading = bricks.rays.shading = GZ_SHADING_GRADIENT;
			check_close(&scene, &bricks, *set, what, 3);
			scene.rays.shading = GZ_SHADING_NONE;
		}
	small_scene_free(&bricks);
	small_scene_free(&scene);
}

static void values_that_show_nothing_stay_bare_in_bricks(void **state)
{
	(void)state;
	struct small_scene scene = small_scene_ball_in_hidden_matter();
	struct small_scene bricks = as_bricks(&scene, 0);
	for (const char *const *set = small_scene_simd_sets(); *set; set++)
		check_same(&scene, &bricks, *set, "hidden matter");
	small_scene_free(&bricks);
	small_scene_free(&scene);
}

static void levels_of_detail_are_those_of_the_volume_in_memory(void **state)
{
	(void)state;
	struct small_scene scene = small_scene_waves(150, 140, 130, GZ_VOXEL_U16);
	scene.rays.levels = true;
	scene.foveation.method = GZ_METHOD_ACUITY;
	scene.rays.ray_sampling_rate = 0.5;
	struct small_scene bricks = as_bricks(&scene, 0);
	check_same(&scene, &bricks, "auto", "acuity");
	/* From afar all rays take a coarse level. */
	for (int axis = 0; axis < 3; axis++)
		scene.camera.eye[axis] *= 4;
	bricks.camera = scene.camera;
	check_same(&scene, &bricks, "auto", "far");
	small_scene_free(&bricks);
	small_scene_free(&scene);
}

static void eye_inside_sees_the_same(void **state)
{
	(void)state;
	struct small_scene scene = small_scene_waves(100, 90, 80, GZ_VOXEL_U8);
	scene.camera.eye[0] = 0.1;
	scene.camera.eye[1] = 0.2;
	scene.camera.eye[2] = 0.05;
	scene.camera.fov_deg = 100;
	struct small_scene bricks = as_bricks(&scene, 0);
	check_same(&scene, &bricks, "auto", "inside");
	small_scene_free(&bricks);
	small_scene_free(&scene);
}

/* Sum of absolute differences of all channels. */
static long total_difference(const struct gz_image *a, const struct gz_image *b)
{
	long sum = 0;
	for (int i = 0; i < a->width * a->height * 4; i++)
		sum += labs((long)a->pixels[i] - b->pixels[i]);
	return sum;
}

/* Draw a picture that may take rays of earlier ones, as in a window at rest. */
static struct gz_frame_stats render_again(struct gz_raycaster *renderer,
					  const struct small_scene *scene, struct gz_image *image)
{
	const struct gz_display display = gz_display_default(WIDTH, HEIGHT);
	struct gz_frame_stats stats = { 0 };
	struct gz_plan plan = { 0 };
	assert_int_equal(
		gz_plan_make(&scene->foveation, &display, scene->gaze, WIDTH, HEIGHT, &plan),
		GZ_OK);
	const struct gz_shot shot = { .camera = &scene->camera,
				      .settings = &scene->rays,
				      .plan = &plan,
				      .keeps_rays = true };
	assert_int_equal(gz_raycaster_draw(renderer, &shot, image, &stats), GZ_OK);
	assert_true(stats.kept_rays == 0);
	gz_plan_free(&plan);
	return stats;
}

/* Wait until the next frame lacks nothing; each is to be nearer to the whole picture. */
static void picture_is_whole_from_the_first_and_sharper_later(void **state)
{
	(void)state;
	struct small_scene scene = small_scene_waves(220, 200, 210, GZ_VOXEL_U8);
	struct small_scene bricks = as_bricks(&scene, least_bytes(&scene));
	struct gz_image whole = { 0 }, image = { 0 };
	render(&scene, "auto", true, &whole);
	struct gz_raycaster *renderer = renderer_of(&bricks, "auto", false);
	struct gz_frame_stats stats = render_again(renderer, &bricks, &image);
	assert_true(stats.bricks_coming > 0);
	const long first = total_difference(&whole, &image);
	/* Coarse, but all there: nothing like the picture of an empty box. */
	struct gz_image none = { 0 };
	assert_int_equal(gz_image_resize(&none, WIDTH, HEIGHT), GZ_OK);
	for (int i = 0; i < WIDTH * HEIGHT; i++)
		memcpy(none.pixels + 4 * i, "\0\0\0\377", 4);
	const long empty = total_difference(&whole, &none);
	if (first == 0 || 4 * first > empty)
		fail_msg("the first picture differs by %ld, an empty one by %ld", first, empty);
	for (int frame = 0; stats.bricks_coming > 0; frame++) {
		assert_true(frame < 100000);
		stats = render_again(renderer, &bricks, &image);
	}
	assert_true(total_difference(&whole, &image) * 50 < first);
	gz_raycaster_destroy(&renderer);
	gz_image_free(&whole);
	gz_image_free(&image);
	gz_image_free(&none);
	small_scene_free(&bricks);
	small_scene_free(&scene);
}

/* What the coarsest level alone shows: every pixel of a picture with no room for more. */
static void without_bricks_every_pixel_is_that_of_the_coarsest_level(void **state)
{
	(void)state;
	struct small_scene scene = small_scene_waves(60, 58, 62, GZ_VOXEL_F32);
	/* Opacity in one step, so that it can be converted to another voxel length exactly. */
	scene.transfer.points[1] = (struct gz_transfer_point) { 0.4, { 0.3, 0.1, 0.9 }, 0 };
	scene.transfer.points[2] = (struct gz_transfer_point) { 0.4, { 0.8, 0.6, 0.2 }, 0.05 };
	scene.transfer.points[3].opacity = 0.05;
	struct small_scene bricks = as_bricks(&scene, 0);
	struct small_scene coarse = scene;
	assert_int_equal(gz_volume_halve(&scene.volume, NULL, &coarse.volume), GZ_OK);
	coarse.rays.ray_sampling_rate *= 2; /* the same steps */
	struct gz_image a = { 0 }, b = { 0 };
	/* Opacity is per voxel length, which is twice as long there. */
	for (size_t i = 0; i < coarse.transfer.count; i++)
		coarse.transfer.points[i].opacity =
			gz_transfer_opacity_over(coarse.transfer.points[i].opacity, 2);
	render(&coarse, "portable", true, &a);

	/* All of the finer level's voxels are spoilt in the file. */
	const struct gz_brick_file *file = gz_brick_pool_file(bricks.volume.bricks);
	const uint64_t from = file->entries[0].offset;
	assert_int_equal(file->layout.level_count, 2);
	const size_t spoilt = (size_t)(file->entries[8].offset - from);
	FILE *out = fopen(files_path("scene.gzb"), "r+b");
	assert_non_null(out);
	assert_int_equal(fseek(out, (long)from, SEEK_SET), 0);
	for (size_t i = 0; i < spoilt; i++)
		fputc(0x55, out);
	fclose(out);
	struct captured_log log;
	captured_log_init(&log, NULL);
	struct small_scene damaged = bricks;
	assert_int_equal(
		gz_volume_load(files_path("scene.gzb"), NULL, NULL, &log.log, &damaged.volume),
		GZ_OK);
	const struct gz_frame_stats stats = render(&damaged, "portable", true, &b);
	assert_int_equal(stats.bricks_coming, 0);
	assert_true(log.messages > 0);
	assert_non_null(strstr(log.last, "damaged brick at byte"));
	/* Empty cells of the finer level are passed over, so a few pixels at rims have less. */
	int other = 0;
	for (int i = 0; i < WIDTH * HEIGHT; i++) {
		int difference = 0;
		for (int channel = 0; channel < 3; channel++)
			difference += abs(a.pixels[4 * i + channel] - b.pixels[4 * i + channel]);
		other += difference > 3;
	}
	print_message("%d of %d pixels differ\n", other, WIDTH * HEIGHT);
	assert_true(50 * other < WIDTH * HEIGHT);
	gz_image_free(&a);
	gz_image_free(&b);
	small_scene_free(&damaged);
	small_scene_free(&bricks);
	gz_volume_free(&coarse.volume);
	small_scene_free(&scene);
}

/* 512 bricks of the finest level, room for 256 of all levels. */
static struct small_scene large_scene(void)
{
	return small_scene_waves(256, 256, 256, GZ_VOXEL_U8);
}

static void room_for_less_than_is_wanted_holds_what_weighs_most(void **state)
{
	(void)state;
	struct small_scene scene = large_scene();
	scene.gaze = (struct gz_point) { 0.3F, 0.4F };
	struct small_scene bricks = as_bricks(&scene, least_bytes(&scene));
	assert_int_equal(gz_brick_pool_rooms(bricks.volume.bricks), 256);
	struct gz_image whole = { 0 }, image = { 0 };
	render(&scene, "auto", true, &whole);
	struct gz_raycaster *renderer = renderer_of(&bricks, "auto", true);
	struct gz_frame_stats stats;
	small_scene_render(renderer, &bricks, WIDTH, HEIGHT, &image, &stats);
	assert_int_equal(stats.bricks_coming, 0);
	long near = 0, far = 0, near_pixels = 0, far_pixels = 0;
	for (int i = 0; i < WIDTH * HEIGHT; i++) {
		const double off = hypot(i % WIDTH - 0.3 * WIDTH, i / WIDTH - 0.4 * HEIGHT);
		long difference = 0;
		for (int channel = 0; channel < 3; channel++)
			difference += labs((long)whole.pixels[4 * i + channel] -
					   image.pixels[4 * i + channel]);
		*(off < 12 ? &near : &far) += difference;
		*(off < 12 ? &near_pixels : &far_pixels) += 1;
	}
	print_message("a pixel near the gaze differs by %.3f, far from it by %.3f\n",
		      (double)near / (double)near_pixels, (double)far / (double)far_pixels);
	assert_true(near * far_pixels <= far * near_pixels);

	/* Looked at again, nothing is sent for: rooms are not taken from each other in turns. */
	small_scene_render(renderer, &bricks, WIDTH, HEIGHT, &whole, &stats);
	int x, y;
	assert_int_equal(image_difference(&whole, &image, &x, &y), 0);
	gz_raycaster_destroy(&renderer);
	gz_image_free(&whole);
	gz_image_free(&image);
	small_scene_free(&bricks);
	small_scene_free(&scene);
}

static void memory_too_little_for_the_bricks_is_refused_with_the_least(void **state)
{
	(void)state;
	struct small_scene scene = large_scene();
	const struct gz_loading loading = { .brick_bytes = least_bytes(&scene) - 1 };
	const char *path = files_path("scene.gzb");
	struct captured_log log;
	struct gz_volume bricks;
	char least[32];
	const size_t mib = (least_bytes(&scene) + (1 << 20) - 1) >> 20;
	assert_int_equal(gz_bricks_write(&scene.volume, path, NULL, NULL), GZ_OK);
	captured_log_init(&log, NULL);
	assert_int_equal(gz_volume_load(path, NULL, &loading, &log.log, &bricks), GZ_ERR_INVAL);
	assert_int_equal(log.messages, 1);
	assert_non_null(strstr(log.last, "volume.memory_mib"));
	snprintf(least, sizeof least, "least %zu,", mib);
	assert_non_null(strstr(log.last, least));
	small_scene_free(&scene);
}

/* Bricks that the first picture sends for. */
static uint64_t sent_for(struct gz_raycaster *renderer, const struct small_scene *bricks)
{
	struct gz_image image = { 0 };
	struct gz_frame_stats stats = { 0 };
	small_scene_render(renderer, bricks, WIDTH, HEIGHT, &image, &stats);
	gz_image_free(&image);
	return stats.bricks_coming;
}

/* And what the box then leaves open is sent for, though camera and gaze are where they were. */
static void what_is_clipped_away_is_not_sent_for(void **state)
{
	(void)state;
	struct small_scene scene = small_scene_waves(220, 200, 210, GZ_VOXEL_U8);
	struct small_scene bricks = as_bricks(&scene, 0);
	struct gz_raycaster *renderer = renderer_of(&bricks, "auto", false);
	const uint64_t all = sent_for(renderer, &bricks);
	small_scene_free(&bricks);
	gz_raycaster_destroy(&renderer);

	bricks = as_bricks(&scene, 0);
	renderer = renderer_of(&bricks, "auto", false);
	bricks.rays.clip.greatest[0] = 0.25;
	const uint64_t quarter = sent_for(renderer, &bricks);
	/* 2 of 7 bricks along x. */
	if (quarter == 0 || 3 * quarter > all)
		fail_msg("%llu bricks sent for, %llu of them for a quarter of the box",
			 (unsigned long long)all, (unsigned long long)quarter);
	gz_raycaster_destroy(&renderer);

	renderer = renderer_of(&bricks, "auto", true);
	struct gz_image image = { 0 };
	for (int i = 0; i < 2; i++) {
		struct gz_frame_stats stats;
		struct gz_image whole = { 0 };
		int x = 0, y = 0;
		scene.rays.clip.greatest[0] = bricks.rays.clip.greatest[0] = i ? 0.9 : 0.3;
		render(&scene, "auto", true, &whole);
		small_scene_render(renderer, &bricks, WIDTH, HEIGHT, &image, &stats);
		const int difference = image_difference(&whole, &image, &x, &y);
		if (difference > 1)
			fail_msg("clip %d: differs by %d at (%d, %d)", i, difference, x, y);
		gz_image_free(&whole);
	}
	gz_image_free(&image);
	gz_raycaster_destroy(&renderer);
	small_scene_free(&bricks);
	small_scene_free(&scene);
}

static void what_the_clip_plane_cuts_off_is_not_sent_for(void **state)
{
	(void)state;
	struct small_scene scene = small_scene_waves(220, 200, 210, GZ_VOXEL_U8);
	uint64_t counts[2];
	for (int cut = 0; cut < 2; cut++) {
		struct small_scene bricks = as_bricks(&scene, 0);
		struct gz_raycaster *renderer = renderer_of(&bricks, "auto", false);
		bricks.rays.clip.plane = cut;
		memcpy(bricks.rays.clip.normal, (double[3]) { 1, 1, 0 }, 3 * sizeof(double));
		bricks.rays.clip.offset = 0.25; /* an eighth of the box */
		counts[cut] = sent_for(renderer, &bricks);
		gz_raycaster_destroy(&renderer);
		small_scene_free(&bricks);
	}
	if (counts[1] == 0 || 3 * counts[1] > counts[0])
		fail_msg("%llu bricks sent for, %llu of them for a corner of the box",
			 (unsigned long long)counts[0], (unsigned long long)counts[1]);
	struct small_scene bricks = as_bricks(&scene, 0);
	struct gz_raycaster *renderer = renderer_of(&bricks, "auto", true);
	struct gz_image whole = { 0 }, image = { 0 };
	int x = 0, y = 0;
	scene.rays.clip.plane = true;
	memcpy(scene.rays.clip.normal, (double[3]) { 0.5, 0.8, -0.4 }, 3 * sizeof(double));
	scene.rays.clip.offset = 0.55;
	bricks.rays.clip = scene.rays.clip;
	render(&scene, "auto", true, &whole);
	small_scene_render(renderer, &bricks, WIDTH, HEIGHT, &image, NULL);
	const int difference = image_difference(&whole, &image, &x, &y);
	if (difference > 1)
		fail_msg("differs by %d at (%d, %d)", difference, x, y);
	gz_image_free(&whole);
	gz_image_free(&image);
	gz_raycaster_destroy(&renderer);
	small_scene_free(&bricks);
	small_scene_free(&scene);
}

static void rooms_go_to_what_is_looked_at_now(void **state)
{
	(void)state;
	struct small_scene scene = large_scene();
	struct small_scene bricks = as_bricks(&scene, least_bytes(&scene));
	struct gz_raycaster *renderer = renderer_of(&bricks, "auto", true);
	struct gz_raycaster *in_memory = renderer_of(&scene, "auto", true);
	/* A close look at one corner, then at others: each needs less than there is room for. */
	for (int corner = 0; corner < 8; corner++) {
		struct gz_image whole = { 0 }, image = { 0 };
		struct gz_frame_stats stats;
		for (int axis = 0; axis < 3; axis++) {
			const double side = corner >> axis & 1 ? 1 : -1;
			bricks.camera.look_at[axis] = 0.3 * side;
			bricks.camera.eye[axis] = 0.62 * side;
		}
		bricks.camera.fov_deg = scene.camera.fov_deg = 10;
		scene.camera = bricks.camera;
		small_scene_render(in_memory, &scene, WIDTH, HEIGHT, &whole, &stats);
		small_scene_render(renderer, &bricks, WIDTH, HEIGHT, &image, &stats);
		int x = 0, y = 0;
		const int difference = image_difference(&whole, &image, &x, &y);
		if (difference > 1)
			fail_msg("corner %d differs by %d at (%d, %d)", corner, difference, x, y);
		gz_image_free(&whole);
		gz_image_free(&image);
	}
	gz_raycaster_destroy(&in_memory);
	gz_raycaster_destroy(&renderer);
	small_scene_free(&bricks);
	small_scene_free(&scene);
}

static void file_that_becomes_shorter_shows_the_coarse_level(void **state)
{
	(void)state;
	struct small_scene scene = small_scene_waves(70, 65, 50, GZ_VOXEL_U8);
	struct small_scene bricks = as_bricks(&scene, 0);
	assert_int_equal(truncate(files_path("scene.gzb"), 100), 0);
	struct gz_image image = { 0 };
	const struct gz_frame_stats stats = render(&bricks, "auto", true, &image);
	assert_int_equal(stats.bricks_coming, 0);
	long sum = 0;
	for (int i = 0; i < WIDTH * HEIGHT; i++)
		sum += image.pixels[4 * i];
	assert_true(sum > 0);
	gz_image_free(&image);
	small_scene_free(&bricks);
	small_scene_free(&scene);
}

static void damaged_bricks_are_told_by_the_first_and_their_number(void **state)
{
	(void)state;
	struct small_scene scene = small_scene_waves(100, 90, 95, GZ_VOXEL_U8);
	struct small_scene bricks = scene;
	struct captured_log log;
	const char *path = files_path("scene.gzb");
	assert_int_equal(gz_bricks_write(&scene.volume, path, NULL, NULL), GZ_OK);
	captured_log_init(&log, NULL);
	/* Fewer rooms than would keep the fine levels from the beginning. */
	const struct gz_loading loading = { .brick_bytes = least_bytes(&scene) };
	assert_int_equal(gz_volume_load(path, NULL, &loading, &log.log, &bricks.volume), GZ_OK);
	assert_int_equal(truncate(path, 100), 0);
	struct gz_image image = { 0 };
	render(&bricks, "auto", true, &image);
	assert_int_equal(log.messages, 1);
	assert_non_null(strstr(log.last, "a coarser level is shown there"));
	gz_image_free(&image);
	small_scene_free(&bricks);
	assert_int_equal(log.messages, 2);
	assert_non_null(strstr(log.last, "bricks could not be read"));
	assert_true(atoi(strstr(log.last, "gzb: ") + 5) > 10);
	small_scene_free(&scene);
}

static void coarsest_level_that_cannot_be_read_is_refused(void **state)
{
	(void)state;
	struct small_scene scene = small_scene_waves(70, 65, 50, GZ_VOXEL_U8);
	struct small_scene bricks = as_bricks(&scene, 0);
	const struct gz_brick_file *file = gz_brick_pool_file(bricks.volume.bricks);
	const long at = (long)file->entries[file->layout.brick_count - 1].offset;
	FILE *out = fopen(files_path("scene.gzb"), "r+b");
	assert_non_null(out);
	assert_int_equal(fseek(out, at, SEEK_SET), 0);
	fputc(0x77, out);
	fputc(0x78, out);
	fclose(out);
	struct captured_log log;
	struct gz_volume volume = { 0 };
	captured_log_init(&log, NULL);
	assert_int_equal(gz_volume_load(files_path("scene.gzb"), NULL, NULL, &log.log, &volume),
			 GZ_ERR_FORMAT);
	assert_int_equal(log.messages, 1);
	assert_null(volume.bricks);
	small_scene_free(&bricks);
	small_scene_free(&scene);
}

TEST_SUITE(bricks)
{
	/* Bricks come while pictures are made. */
	static const struct CMUnitTest coming[] = {
		cmocka_unit_test(picture_is_whole_from_the_first_and_sharper_later),
		cmocka_unit_test(room_for_less_than_is_wanted_holds_what_weighs_most),
		cmocka_unit_test(what_is_clipped_away_is_not_sent_for),
		cmocka_unit_test(what_the_clip_plane_cuts_off_is_not_sent_for),
		cmocka_unit_test(rooms_go_to_what_is_looked_at_now),
		cmocka_unit_test(file_that_becomes_shorter_shows_the_coarse_level),
		cmocka_unit_test(damaged_bricks_are_told_by_the_first_and_their_number),
	};
	/* By the same threads, so that a thread sanitizer would see nothing else here. */
	static const struct CMUnitTest there[] = {
		cmocka_unit_test(picture_of_all_bricks_is_that_of_the_volume_in_memory),
		cmocka_unit_test(shaded_clipped_and_preintegrated_it_is_the_same),
		cmocka_unit_test(segments_side_by_side_are_those_of_each_ray),
		cmocka_unit_test(values_that_show_nothing_stay_bare_in_bricks),
		cmocka_unit_test(levels_of_detail_are_those_of_the_volume_in_memory),
		cmocka_unit_test(eye_inside_sees_the_same),
		cmocka_unit_test(without_bricks_every_pixel_is_that_of_the_coarsest_level),
		cmocka_unit_test(memory_too_little_for_the_bricks_is_refused_with_the_least),
		cmocka_unit_test(coarsest_level_that_cannot_be_read_is_refused),
	};
	const int failed = cmocka_run_group_tests(coming, NULL, NULL);
	return THREADS_ONLY ? failed : failed + cmocka_run_group_tests(there, NULL, NULL);
}
