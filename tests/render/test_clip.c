/* The clip box, the clip plane, jitter and phases: where rays are cut. */
#include "suite.h"

#include <stddef.h>
#include <stdint.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/vector.h"
#include "oracle_check.h"
#include "render/plan/method.h"

static void clip(struct small_scene *scene, const double least[3], const double greatest[3])
{
	memcpy(scene->rays.clip.least, least, 3 * sizeof *least);
	memcpy(scene->rays.clip.greatest, greatest, 3 * sizeof *greatest);
}

static void look_from(struct small_scene *scene, double x, double y, double z)
{
	memcpy(scene->camera.eye, (double[3]) { x, y, z }, 3 * sizeof(double));
}

static void clip_face_at_each_axis_equals_the_oracle(void **state)
{
	(void)state;
	for (int face = 0; face < 6; face++) {
		struct small_scene scene = small_scene_waves(24, 20, 27, GZ_VOXEL_U8);
		if (face < 3)
			scene.rays.clip.least[face] = 0.37;
		else
			scene.rays.clip.greatest[face - 3] = 0.61;
		oracle_check(&scene, 37, 33);
	}
}

static void clip_of_every_voxel_type_and_interpolation_equals_the_oracle(void **state)
{
	(void)state;
	static const double least[3] = { 0.3, 0.11, 0.2 }, greatest[3] = { 0.93, 0.8, 0.77 };
	for (int type = 0; type < GZ_VOXEL_TYPE_COUNT; type++)
		for (int nearest = 0; nearest <= 1; nearest++) {
			struct small_scene scene =
				small_scene_waves(24, 20, 27, (enum gz_voxel_type)type);
			clip(&scene, least, greatest);
			scene.rays.interpolation =
				nearest ? GZ_INTERPOLATION_NEAREST : GZ_INTERPOLATION_TRILINEAR;
			/* on a voxel's face either voxel is right */
			oracle_check_but(&scene, 41, 37, nearest ? 3 : 0);
			small_scene_free(&scene);
		}
}

static void clip_of_anisotropic_voxels_equals_the_oracle(void **state)
{
	(void)state;
	struct small_scene scene = small_scene_waves(32, 30, 8, GZ_VOXEL_U16);
	scene.volume.spacing[2] = 10;
	clip(&scene, (const double[3]) { 0.1, 0.2, 0.33 }, (const double[3]) { 1, 0.7, 0.71 });
	oracle_check(&scene, 40, 37);
}

static void clip_thinner_than_a_step_equals_the_oracle(void **state)
{
	(void)state;
	struct small_scene scene = small_scene_constant(20, 0.8);
	scene.rays.ray_sampling_rate = 0.5;
	clip(&scene, (const double[3]) { 0, 0, 0.5 }, (const double[3]) { 1, 1, 0.52 });
	oracle_check(&scene, 40, 37);
}

static void clip_with_the_eye_inside_at_and_beside_it_equals_the_oracle(void **state)
{
	(void)state;
	static const double eyes[][3] = {
		{ 0.07, 0.05, 0.02 }, /* within what is shown */
		{ 0.4, 0.05, 0.02 },  /* within the box, outside what is shown */
		{ 0.15, 0.03, 0.04 }, /* on its face */
		{ 0.5, 0.03, 0.04 },  /* on the box's */
	};
	for (size_t i = 0; i < sizeof eyes / sizeof eyes[0]; i++) {
		struct small_scene scene = small_scene_waves(24, 24, 24, GZ_VOXEL_U8);
		clip(&scene, (const double[3]) { 0.2, 0.1, 0.2 },
		     (const double[3]) { 0.65, 0.9, 0.9 });
		look_from(&scene, eyes[i][0], eyes[i][1], eyes[i][2]);
		memcpy(scene.camera.look_at, (double[3]) { -0.3, -0.2, 0.1 }, 3 * sizeof(double));
		oracle_check(&scene, 37, 33);
	}
}

static void clip_orthographic_along_an_axis_equals_the_oracle(void **state)
{
	(void)state;
	struct small_scene scene = small_scene_waves(24, 24, 24, GZ_VOXEL_U8);
	scene.camera.projection = GZ_PROJECTION_ORTHOGRAPHIC;
	look_from(&scene, 0, -2, 0);
	scene.camera.height = 1.0937; /* no ray on a voxel's face */
	clip(&scene, (const double[3]) { 0, 0.43, 0.1 }, (const double[3]) { 0.77, 0.9, 1 });
	oracle_check(&scene, 41, 41);
}

static void clip_that_shows_everything_changes_no_bit(void **state)
{
	(void)state;
	/* The clip box as it stands when nothing is set is the whole box: rays cut twice by the
	 * same faces must be what they were. One beyond the data shows it. */
	struct small_scene scene = small_scene_waves(24, 20, 27, GZ_VOXEL_U8);
	struct gz_image whole = { 0 }, cut = { 0 };
	scene.transfer.points[0].opacity = scene.transfer.points[1].opacity = 0;
	struct gz_raycaster *renderer = small_scene_renderer(&scene, 1, NULL);
	small_scene_render(renderer, &scene, 60, 50, &whole, NULL);
	/* the waves' first voxels along x are empty */
	scene.rays.clip.least[0] = 0.05;
	small_scene_render(renderer, &scene, 60, 50, &cut, NULL);
	assert_memory_equal(whole.pixels, cut.pixels, 60 * 50 * 4);
	gz_raycaster_destroy(&renderer);
	gz_image_free(&whole);
	gz_image_free(&cut);
	small_scene_free(&scene);
}

static void clip_of_constant_matter_keeps_its_brightness_for_any_step(void **state)
{
	(void)state;
	struct small_scene scene = small_scene_constant(48, 0.02);
	struct gz_image reference = { 0 };
	clip(&scene, (const double[3]) { 0.21, 0.3, 0.13 }, (const double[3]) { 0.55, 0.77, 0.64 });
	scene.foveation.method = GZ_METHOD_STANDARD;
	scene.rays.ray_sampling_rate = 8;
	struct gz_raycaster *renderer = small_scene_renderer(&scene, 1, NULL);
	small_scene_render(renderer, &scene, 90, 80, &reference, NULL);
	static const double rates[] = { 0.06, 0.37, 1.5 };
	for (size_t i = 0; i < sizeof rates / sizeof rates[0]; i++) {
		struct gz_image image = { 0 };
		int x = 0, y = 0;
		scene.rays.ray_sampling_rate = rates[i];
		small_scene_render(renderer, &scene, 90, 80, &image, NULL);
		const int difference = image_difference(&reference, &image, &x, &y);
		if (difference > 1)
			fail_msg("rate %g: pixel %d %d differs by %d", rates[i], x, y, difference);
		gz_image_free(&image);
	}
	gz_raycaster_destroy(&renderer);
	gz_image_free(&reference);
	small_scene_free(&scene);
}

static void clip_box_that_holds_nothing_is_refused(void **state)
{
	(void)state;
	struct gz_ray_params rays = gz_ray_params_default();
	assert_true(gz_ray_params_valid(&rays));
	rays.clip.least[1] = 0.5;
	rays.clip.greatest[1] = 0.5;
	assert_false(gz_ray_params_valid(&rays));
	rays.clip.least[1] = 0.7;
	assert_false(gz_ray_params_valid(&rays));
	rays.clip.least[1] = NAN;
	assert_false(gz_ray_params_valid(&rays));
	rays.clip.least[1] = -0.1;
	assert_false(gz_ray_params_valid(&rays));
}

static void cut_by_plane(struct small_scene *scene, double x, double y, double z, double offset)
{
	scene->rays.clip.plane = true;
	memcpy(scene->rays.clip.normal, (double[3]) { x, y, z }, 3 * sizeof(double));
	scene->rays.clip.offset = offset;
}

static void plane_of_any_normal_equals_the_oracle(void **state)
{
	(void)state;
	static const double normals[][3] = {
		{ 1, 0, 0 },        { -1, 0, 0 },        { 0, 0.5, 0 },       { 0, 0, -1 },
		{ 0.3, -0.5, 0.8 }, { -0.9, 0.4, -0.2 }, { 0.01, 1, -0.003 },
	};
	for (size_t i = 0; i < sizeof normals / sizeof normals[0]; i++) {
		struct small_scene scene = small_scene_waves(24, 20, 27, GZ_VOXEL_U8);
		const double *normal = normals[i];
		cut_by_plane(&scene, normal[0], normal[1], normal[2], 0.3 + 0.06 * (double)i);
		oracle_check(&scene, 37, 33);
	}
}

static void plane_of_every_voxel_type_and_interpolation_equals_the_oracle(void **state)
{
	(void)state;
	for (int type = 0; type < GZ_VOXEL_TYPE_COUNT; type++)
		for (int nearest = 0; nearest <= 1; nearest++) {
			struct small_scene scene =
				small_scene_waves(24, 20, 27, (enum gz_voxel_type)type);
			cut_by_plane(&scene, -0.4, 0.7, 0.3, 0.55);
			scene.rays.interpolation =
				nearest ? GZ_INTERPOLATION_NEAREST : GZ_INTERPOLATION_TRILINEAR;
			oracle_check_but(&scene, 41, 37, nearest ? 3 : 0);
			small_scene_free(&scene);
		}
}

static void plane_with_clip_box_jitter_and_segments_equals_the_oracle(void **state)
{
	(void)state;
	for (int integration = 0; integration < 2; integration++) {
		struct small_scene scene = small_scene_waves(32, 30, 8, GZ_VOXEL_U16);
		scene.volume.spacing[2] = 4;
		clip(&scene, (const double[3]) { 0.1, 0.2, 0.13 },
		     (const double[3]) { 1, 0.8, 0.9 });
		cut_by_plane(&scene, 0.6, 0.5, -0.7, 0.6);
		scene.rays.jitter = 5;
		scene.rays.integration = integration;
		oracle_check(&scene, 41, 41);
	}
}

static void plane_around_the_eye_and_along_parallel_rays_equals_the_oracle(void **state)
{
	(void)state;
	static const double eyes[][3] = { { 0.1, 0.2, 0.05 }, { -0.2, 0.1, 0 }, { 2, 0.1, 0.1 } };
	for (size_t i = 0; i < 2 * sizeof eyes / sizeof eyes[0]; i++) {
		struct small_scene scene = small_scene_waves(24, 20, 27, GZ_VOXEL_U8);
		const double *eye = eyes[i / 2];
		look_from(&scene, eye[0], eye[1], eye[2]);
		cut_by_plane(&scene, i & 1 ? 1 : -1, 0.3, -0.2, 0.5);
		oracle_check(&scene, 39, 35);
	}
	for (int side = -1; side <= 1; side += 2) { /* rays lie along the plane, and across it */
		struct small_scene scene = small_scene_waves(24, 20, 27, GZ_VOXEL_U8);
		scene.camera.projection = GZ_PROJECTION_ORTHOGRAPHIC;
		scene.camera.height = 1.2;
		look_from(&scene, 0, -2, 0);
		memset(scene.camera.look_at, 0, sizeof scene.camera.look_at);
		cut_by_plane(&scene, side, side > 0 ? 0 : 1, 0.4, 0.47);
		oracle_check(&scene, 41, 37);
	}
}

static void plane_along_an_axis_is_a_face_of_the_clip_box(void **state)
{
	(void)state;
	for (int face = 0; face < 6; face++) {
		struct small_scene scene = small_scene_waves(24, 20, 27, GZ_VOXEL_U8);
		struct gz_image by_box = { 0 }, by_plane = { 0 };
		int x = 0, y = 0;
		double normal[3] = { 0, 0, 0 };
		struct gz_raycaster *renderer = small_scene_renderer(&scene, 1, NULL);
		(face < 3 ? scene.rays.clip.least : scene.rays.clip.greatest)[face % 3] = 0.4;
		small_scene_render(renderer, &scene, 60, 50, &by_box, NULL);
		scene.rays.clip = gz_clip_whole;
		normal[face % 3] = face < 3 ? -0.7 : 0.7;
		cut_by_plane(&scene, normal[0], normal[1], normal[2], face < 3 ? 0.6 : 0.4);
		small_scene_render(renderer, &scene, 60, 50, &by_plane, NULL);
		const int difference = image_difference(&by_box, &by_plane, &x, &y);
		if (difference > 1)
			fail_msg("face %d: pixel %d %d differs by %d", face, x, y, difference);
		gz_raycaster_destroy(&renderer);
		gz_image_free(&by_box);
		gz_image_free(&by_plane);
		small_scene_free(&scene);
	}
}

/* A block of matter of one opacity, seen straight from the front and cut by a plane at 45 degrees:
 * the way of each ray through what is left is known, and so is its brightness. */
static void plane_leaves_of_each_ray_exactly_its_part(void **state)
{
	(void)state;
	enum { EDGE = 48, SIZE = 96 };
	const double opacity = 0.03;
	struct small_scene scene = small_scene_constant(EDGE, opacity);
	struct gz_image image = { 0 };
	scene.camera.projection = GZ_PROJECTION_ORTHOGRAPHIC;
	scene.camera.height = 1;
	look_from(&scene, 0, -2, 0);
	memset(scene.camera.look_at, 0, sizeof scene.camera.look_at);
	scene.foveation.method = GZ_METHOD_STANDARD;
	for (int behind = 0; behind < 2; behind++) {
		/* y < x - 0.2 is left, or the other side */
		cut_by_plane(&scene, behind ? 0.5 : -0.5, behind ? -0.5 : 0.5, 0,
			     behind ? 0.6 : 0.4);
		struct gz_raycaster *renderer = small_scene_renderer(&scene, 1, NULL);
		small_scene_render(renderer, &scene, SIZE, SIZE, &image, NULL);
		gz_raycaster_destroy(&renderer);
		for (int x = 0; x < SIZE; x++) {
			const double at = (x + 0.5) / SIZE - 0.5;
			const double front = fmin(fmax(at - 0.2 + 0.5, 0), 1);
			const double way = EDGE * (behind ? 1 - front : front);
			const double red = 255 * 0.9 * (1 - pow(1 - opacity, way));
			const int pixel = image.pixels[4 * (SIZE / 2 * SIZE + x)];
			if (fabs(pixel - red) > 1)
				fail_msg("side %d, column %d: red is %d, not %.1f", behind, x,
					 pixel, red);
		}
	}
	gz_image_free(&image);
	small_scene_free(&scene);
}

/* A solid ball: what a plane cuts off is as if those voxels held nothing, to a voxel's width. */
static void cut_ball_looks_like_a_ball_without_those_voxels(void **state)
{
	(void)state;
	enum { EDGE = 64, SIZE = 120 };
	static const double normal[3] = { 0.48, -0.6, 0.64 };
	struct small_scene scene = small_scene_constant(EDGE, 0.4);
	struct gz_image cut = { 0 }, zeroed = { 0 };
	uint8_t *voxels = scene.volume.voxels;
	const double middle = EDGE / 2.0 - 0.5;
	for (int i = 0; i < EDGE * EDGE * EDGE; i++) {
		const double at[3] = { i % EDGE - middle, i / EDGE % EDGE - middle,
				       i / EDGE / EDGE - middle };
		voxels[i] = gz_length3(at) < 26 ? 255 : 0;
	}
	gz_volume_find_range(&scene.volume);
	scene.transfer.count = 2; /* opaque from half of the range on */
	scene.transfer.points[1] = scene.transfer.points[0];
	scene.transfer.points[0].opacity = 0;
	scene.foveation.method = GZ_METHOD_STANDARD;
	cut_by_plane(&scene, normal[0], normal[1], normal[2], 0.5);
	struct gz_raycaster *renderer = small_scene_renderer(&scene, 1, NULL);
	small_scene_render(renderer, &scene, SIZE, SIZE, &cut, NULL);
	gz_raycaster_destroy(&renderer);
	scene.rays.clip.plane = false;
	for (int i = 0; i < EDGE * EDGE * EDGE; i++) {
		const double at[3] = { i % EDGE - middle, i / EDGE % EDGE - middle,
				       i / EDGE / EDGE - middle };
		voxels[i] = gz_dot3(at, normal) > 0 ? 0 : voxels[i];
	}
	renderer = small_scene_renderer(&scene, 1, NULL);
	small_scene_render(renderer, &scene, SIZE, SIZE, &zeroed, NULL);
	gz_raycaster_destroy(&renderer);
	int apart = 0, shown = 0, lost = 0;
	for (int i = 0; i < SIZE * SIZE; i++) {
		const int a = cut.pixels[4 * i], b = zeroed.pixels[4 * i];
		shown += a > 30;
		lost += (a > 30) != (b > 30);
		apart += abs(a - b) > 40; /* rims, which half a voxel moves */
	}
	if (shown < 2000 || lost > shown / 20 || apart > shown / 10)
		fail_msg("of %d pixels %d have another outline, %d another brightness", shown, lost,
			 apart);
	gz_image_free(&cut);
	gz_image_free(&zeroed);
	small_scene_free(&scene);
}

static void plane_without_a_normal_is_refused(void **state)
{
	(void)state;
	struct gz_ray_params rays = gz_ray_params_default();
	rays.clip.plane = true;
	assert_true(gz_ray_params_valid(&rays));
	rays.clip.normal[0] = 0;
	assert_false(gz_ray_params_valid(&rays));
	rays.clip.normal[1] = NAN;
	assert_false(gz_ray_params_valid(&rays));
	rays.clip.normal[1] = -0.01;
	assert_true(gz_ray_params_valid(&rays));
	rays.clip.offset = 1.5;
	assert_false(gz_ray_params_valid(&rays));
}

static void jitter_equals_the_oracle(void **state)
{
	(void)state;
	for (int type = 0; type < GZ_VOXEL_TYPE_COUNT; type++) {
		struct small_scene scene = small_scene_waves(24, 20, 27, (enum gz_voxel_type)type);
		scene.rays.jitter = 7 + 100000 * type;
		scene.rays.ray_sampling_rate = 0.4;
		oracle_check(&scene, 41, 37);
	}
}

static void jitter_with_clip_from_inside_equals_the_oracle(void **state)
{
	(void)state;
	struct small_scene scene = small_scene_waves(24, 24, 24, GZ_VOXEL_U8);
	scene.rays.jitter = 2147483647;
	scene.rays.ray_sampling_rate = 0.3;
	clip(&scene, (const double[3]) { 0.2, 0.1, 0.2 }, (const double[3]) { 0.65, 0.9, 0.9 });
	look_from(&scene, 0.07, 0.05, 0.02);
	memcpy(scene.camera.look_at, (double[3]) { -0.3, -0.2, 0.1 }, 3 * sizeof(double));
	oracle_check(&scene, 37, 33);
}

static void jitter_is_even_from_0_to_1_and_changes_with_its_seed(void **state)
{
	(void)state;
	enum { SIDE = 128, BINS = 16 };
	int bins[BINS] = { 0 }, same = 0;
	double neighbours = 0;
	for (int y = 0; y < SIDE; y++)
		for (int x = 0; x < SIDE; x++) {
			const float shift = gz_ray_jitter(x, y, 1);
			assert_true(shift >= 0 && shift < 1);
			bins[(int)(shift * BINS)]++;
			same += shift == gz_ray_jitter(x, y, 2);
			neighbours +=
				((double)shift - 0.5) * ((double)gz_ray_jitter(x + 1, y, 1) - 0.5);
		}
	assert_in_range(same, 0, 2);
	const int expected = SIDE * SIDE / BINS;
	for (int i = 0; i < BINS; i++)
		assert_in_range(bins[i], expected * 9 / 10, expected * 11 / 10);
	/* as a share of the variance of one */
	assert_true(fabs(neighbours / (SIDE * SIDE) * 12) < 0.03);
	assert_true(gz_ray_jitter(3, 5, 0) == 0);
}

static void jitter_keeps_the_brightness_of_constant_matter(void **state)
{
	(void)state;
	struct small_scene scene = small_scene_constant(48, 0.02);
	struct gz_image still = { 0 }, jittered = { 0 };
	int x = 0, y = 0;
	scene.foveation.method = GZ_METHOD_STANDARD;
	struct gz_raycaster *renderer = small_scene_renderer(&scene, 1, NULL);
	small_scene_render(renderer, &scene, 90, 80, &still, NULL);
	scene.rays.jitter = 5;
	scene.rays.ray_sampling_rate = 0.2;
	small_scene_render(renderer, &scene, 90, 80, &jittered, NULL);
	assert_in_range(image_difference(&still, &jittered, &x, &y), 0, 1);
	gz_raycaster_destroy(&renderer);
	gz_image_free(&still);
	gz_image_free(&jittered);
	small_scene_free(&scene);
}

/* Mean difference of two pictures' blocks of 4 x 4 pixels, which have all phases of a step. */
static double blocks_apart(const struct gz_image *a, const struct gz_image *b)
{
	double sum = 0;
	for (int y = 0; y + 4 <= a->height; y += 4)
		for (int x = 0; x + 4 <= a->width; x += 4) {
			int difference = 0;
			for (int i = 0; i < 16; i++) {
				const int at = 4 * ((y + i / 4) * a->width + x + i % 4);
				difference += a->pixels[at] - b->pixels[at];
			}
			sum += abs(difference) / 16.0;
		}
	return sum / (a->width / 4 * (a->height / 4));
}

static void errors_of_interleaved_steps_cancel_among_neighbours(void **state)
{
	(void)state;
	enum { SIDE = 96 };
	struct small_scene scene = small_scene_waves(24, 20, 27, GZ_VOXEL_U8);
	struct gz_image fine = { 0 }, aligned = { 0 }, interleaved = { 0 };
	struct gz_raycaster *renderer = small_scene_renderer(&scene, 1, NULL);
	scene.foveation.method = GZ_METHOD_STANDARD;
	small_scene_render(renderer, &scene, SIDE, SIDE, &fine, NULL);
	scene.foveation.step_rule = GZ_STEP_DISTANCE;
	scene.foveation.step_floor = 0.0625;
	scene.gaze = (struct gz_point) { 0, 0 };
	scene.rays.ray_sampling_rate = 1;
	scene.foveation.step_phase = GZ_STEP_PHASE_ALIGNED;
	small_scene_render(renderer, &scene, SIDE, SIDE, &aligned, NULL);
	scene.foveation.step_phase = GZ_STEP_PHASE_INTERLEAVED;
	small_scene_render(renderer, &scene, SIDE, SIDE, &interleaved, NULL);
	const double apart = blocks_apart(&aligned, &fine);
	const double interleaved_apart = blocks_apart(&interleaved, &fine);
	if (!(interleaved_apart < 0.75 * apart))
		fail_msg("interleaved %.3f, aligned %.3f", interleaved_apart, apart);
	gz_raycaster_destroy(&renderer);
	gz_image_free(&fine);
	gz_image_free(&aligned);
	gz_image_free(&interleaved);
	small_scene_free(&scene);
}

static void interleaved_steps_keep_the_brightness_of_constant_matter(void **state)
{
	(void)state;
	struct small_scene scene = small_scene_constant(48, 0.02);
	struct gz_image aligned = { 0 }, interleaved = { 0 };
	int x = 0, y = 0;
	struct gz_raycaster *renderer = small_scene_renderer(&scene, 1, NULL);
	scene.foveation.method = GZ_METHOD_STANDARD;
	scene.foveation.step_rule = GZ_STEP_DISTANCE;
	scene.foveation.step_phase = GZ_STEP_PHASE_ALIGNED;
	small_scene_render(renderer, &scene, 90, 80, &aligned, NULL);
	scene.foveation.step_phase = GZ_STEP_PHASE_INTERLEAVED;
	small_scene_render(renderer, &scene, 90, 80, &interleaved, NULL);
	assert_in_range(image_difference(&aligned, &interleaved, &x, &y), 0, 1);
	gz_raycaster_destroy(&renderer);
	gz_image_free(&aligned);
	gz_image_free(&interleaved);
	small_scene_free(&scene);
}

TEST_SUITE(clip)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(clip_face_at_each_axis_equals_the_oracle),
		cmocka_unit_test(clip_of_every_voxel_type_and_interpolation_equals_the_oracle),
		cmocka_unit_test(clip_of_anisotropic_voxels_equals_the_oracle),
		cmocka_unit_test(clip_thinner_than_a_step_equals_the_oracle),
		cmocka_unit_test(clip_with_the_eye_inside_at_and_beside_it_equals_the_oracle),
		cmocka_unit_test(clip_orthographic_along_an_axis_equals_the_oracle),
		cmocka_unit_test(clip_that_shows_everything_changes_no_bit),
		cmocka_unit_test(clip_of_constant_matter_keeps_its_brightness_for_any_step),
		cmocka_unit_test(clip_box_that_holds_nothing_is_refused),
		cmocka_unit_test(plane_of_any_normal_equals_the_oracle),
		cmocka_unit_test(plane_of_every_voxel_type_and_interpolation_equals_the_oracle),
		cmocka_unit_test(plane_with_clip_box_jitter_and_segments_equals_the_oracle),
		cmocka_unit_test(plane_around_the_eye_and_along_parallel_rays_equals_the_oracle),
		cmocka_unit_test(plane_along_an_axis_is_a_face_of_the_clip_box),
		cmocka_unit_test(plane_leaves_of_each_ray_exactly_its_part),
		cmocka_unit_test(cut_ball_looks_like_a_ball_without_those_voxels),
		cmocka_unit_test(plane_without_a_normal_is_refused),
		cmocka_unit_test(jitter_equals_the_oracle),
		cmocka_unit_test(jitter_with_clip_from_inside_equals_the_oracle),
		cmocka_unit_test(jitter_is_even_from_0_to_1_and_changes_with_its_seed),
		cmocka_unit_test(jitter_keeps_the_brightness_of_constant_matter),
		cmocka_unit_test(errors_of_interleaved_steps_cancel_among_neighbours),
		cmocka_unit_test(interleaved_steps_keep_the_brightness_of_constant_matter),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
