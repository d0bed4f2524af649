/* The technique illustrate, as programs use its row. */
#include "suite.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/captured_log.h"
#include "kept_files.h"
#include "mesh_fields.h"
#include "mesh_shapes.h"
#include "render/illustration/technique/illustrate_technique.h"
#include "render/plan/method.h"
#include "render/raycast/shared/ray_params.h"

enum { WIDTH = 96, HEIGHT = 72, PIXELS = WIDTH * HEIGHT };

/* A ball of 12 mm in a world 40 mm wide, as a mesh and as a volume, seen from the front. */
struct gallery {
	struct gz_volume volume;
	struct gz_mesh mesh;
	struct gz_object object;
	struct gz_camera camera;
	struct gz_ray_params rays;
	struct gz_plan plan;
	struct gz_image image;
	struct gz_drawer *drawer;
};

static void open_gallery(struct gallery *gallery)
{
	static const int dims[3] = { 40, 40, 40 };
	static const double spacing[3] = { 1, 1, 1 };
	const struct gz_backend_params params = { .threads = 2 };
	const struct gz_display display = gz_display_default(WIDTH, HEIGHT);
	const struct gz_foveation full = gz_foveation_full();
	const struct gz_point gaze = { 0.5F, 0.5F };
	memset(gallery, 0, sizeof *gallery);
	gallery->volume = field_volume(field_ball, dims, spacing, GZ_VOXEL_F32);
	gallery->mesh = mesh_ball(12, 4);
	gallery->object = (struct gz_object) { .technique = &gz_illustrate_technique,
					       .id = 2,
					       .volume = &gallery->volume,
					       .mesh = &gallery->mesh,
					       .name = "ball" };
	gallery->camera =
		(struct gz_camera) { .eye = { 0, -2, 0 }, .up = { 0, 0, 1 }, .fov_deg = 30 };
	gallery->rays = gz_ray_params_default();
	assert_int_equal(gz_plan_make(&full, &display, gaze, WIDTH, HEIGHT, &gallery->plan), GZ_OK);
	assert_int_equal(gz_illustrate_technique.create("auto", &params, NULL, &gallery->drawer),
			 GZ_OK);
}

static void close_gallery(struct gallery *gallery)
{
	gz_drawer_destroy(&gallery->drawer);
	gz_volume_free(&gallery->volume);
	gz_mesh_free(&gallery->mesh);
	gz_plan_free(&gallery->plan);
	gz_image_free(&gallery->image);
}

static void draw_gallery(struct gallery *gallery, struct gz_frame_stats *out_stats)
{
	const struct gz_shot shot = { .camera = &gallery->camera,
				      .settings = &gallery->rays,
				      .plan = &gallery->plan };
	assert_int_equal(
		gallery->drawer->ops->draw(gallery->drawer, &shot, &gallery->image, out_stats),
		GZ_OK);
}

static void show_and_draw(struct gallery *gallery)
{
	assert_int_equal(gallery->drawer->ops->show(gallery->drawer, &gallery->object, 1), GZ_OK);
	draw_gallery(gallery, NULL);
}

static int grey_at(const struct gallery *gallery, int x, int y)
{
	return (int)(gz_image_words(&((struct gallery *)gallery)->image)[y * WIDTH + x] & 255);
}

/* Pixels that are not white. */
static int drawn_pixels(const struct gallery *gallery)
{
	int count = 0;
	for (int i = 0; i < PIXELS; i++)
		count += grey_at(gallery, i % WIDTH, i / WIDTH) != 255;
	return count;
}

static int choice_of(const char *key, const char *name)
{
	for (size_t i = 0; i < gz_illustration_look_option_count; i++) {
		const struct gz_option *option = &gz_illustration_look_options[i];
		for (int k = 0; strcmp(option->key, key) == 0 && option->choices[k]; k++)
			if (strcmp(option->choices[k], name) == 0)
				return k;
	}
	fail_msg("%s has no %s", key, name);
	return -1;
}

static void show_alone(struct gallery *gallery, const char *name)
{
	gallery->rays.illustration.show = choice_of("illustration.show", name);
	draw_gallery(gallery, NULL);
}

/* The normal in the frame of the picture where the ray of a pixel meets the ball; false: it passes
 * by. */
static bool normal_of_ball(const struct gallery *gallery, int x, int y, double out_normal[3],
			   double *out_facing)
{
	struct gz_ray_frame frame;
	double origin[3], direction[3], b = 0, c = -144, length2 = 0;
	assert_int_equal(gz_camera_rays(&gallery->camera, WIDTH, HEIGHT, &frame), GZ_OK);
	for (int axis = 0; axis < 3; axis++) {
		origin[axis] = 40 * frame.origin00[axis];
		direction[axis] = frame.direction00[axis] + x * frame.direction_dx[axis] +
				  y * frame.direction_dy[axis];
		length2 += direction[axis] * direction[axis];
		b += origin[axis] * direction[axis];
		c += origin[axis] * origin[axis];
	}
	const double root = b * b - length2 * c;
	if (root < 0)
		return false;
	const double at = (-b - sqrt(root)) / length2;
	double place[3];
	*out_facing = 0;
	for (int axis = 0; axis < 3; axis++) {
		place[axis] = (origin[axis] + at * direction[axis]) / 12;
		*out_facing -= place[axis] * direction[axis] / sqrt(length2);
	}
	out_normal[0] = place[0];
	out_normal[1] = place[2];
	out_normal[2] = -place[1];
	return true;
}

/* Lights alone are what their formulas say, neither equalised nor covered by lines. The mesh is a
 * little flatter than the ball at its rim. */
static void lights_alone_are_their_formulas(void **state)
{
	(void)state;
	struct gallery gallery;
	open_gallery(&gallery);
	show_and_draw(&gallery);
	for (int light = 0; light < 3; light++) {
		static const char *const names[] = { "main-light", "plateau-light", "plain" };
		int compared = 0;
		show_alone(&gallery, names[light]);
		for (int i = 0; i < PIXELS; i++) {
			double n[3], facing;
			const int x = i % WIDTH, y = i / WIDTH;
			if (!normal_of_ball(&gallery, x, y, n, &facing) || facing < 0.4)
				continue;
			const double plain = fmax((-0.5 * n[0] + 0.5 * n[1] + n[2]) / sqrt(1.5), 0);
			const double tones[] = { 0.5 + 0.5 * (n[1] - n[0]) / sqrt(2), facing,
						 0.2 + 0.8 * plain };
			compared++;
			if (abs(grey_at(&gallery, x, y) - (int)(255 * tones[light] + 0.5)) > 3)
				fail_msg("%s at %d, %d: %d, not %.1f", names[light], x, y,
					 grey_at(&gallery, x, y), 255 * tones[light]);
		}
		assert_true(compared > 600);
	}
	close_gallery(&gallery);
}

static void every_parameter_can_be_shown_alone(void **state)
{
	(void)state;
	static uint32_t before[PIXELS];
	struct gallery gallery;
	open_gallery(&gallery);
	show_and_draw(&gallery);
	strcpy(gallery.rays.illustration.chosen_object, "ball");
	const char *const *names = NULL;
	for (size_t i = 0; i < gz_illustration_look_option_count; i++)
		if (strcmp(gz_illustration_look_options[i].key, "illustration.show") == 0)
			names = gz_illustration_look_options[i].choices;
	assert_non_null(names);
	for (int k = 0; names[k]; k++) {
		memcpy(before, gz_image_words(&gallery.image), sizeof before);
		show_alone(&gallery, names[k]);
		if (k > 0 && memcmp(before, gz_image_words(&gallery.image), sizeof before) == 0)
			fail_msg("%s shows what %s does", names[k], names[k - 1]);
	}
	show_alone(&gallery, "importance"); /* 1/2 where nothing else is said */
	assert_in_range(grey_at(&gallery, WIDTH / 2, HEIGHT / 2), 127, 128);
	show_alone(&gallery, "object-distance"); /* of the object itself */
	assert_int_equal(grey_at(&gallery, WIDTH / 2, HEIGHT / 2), 0);
	show_alone(&gallery, "lines");
	assert_int_equal(grey_at(&gallery, WIDTH / 2, HEIGHT / 2), 255);
	assert_in_range(drawn_pixels(&gallery), 80, 600);
	close_gallery(&gallery);
}

static void single_settings_count_only_if_asked_for(void **state)
{
	(void)state;
	static uint32_t before[PIXELS];
	struct gallery gallery;
	open_gallery(&gallery);
	show_and_draw(&gallery);
	memcpy(before, gz_image_words(&gallery.image), sizeof before);
	gallery.rays.illustration.single.main_light = 0;
	draw_gallery(&gallery, NULL);
	assert_memory_equal(before, gz_image_words(&gallery.image), sizeof before);
	gallery.rays.illustration.source = GZ_ILLUSTRATION_SINGLE;
	draw_gallery(&gallery, NULL);
	assert_memory_not_equal(before, gz_image_words(&gallery.image), sizeof before);
	close_gallery(&gallery);
}

/* The left half of the box alone: the ball's left half, and its inside behind that. */
static void clip_box_cuts(void **state)
{
	(void)state;
	struct gallery gallery;
	open_gallery(&gallery);
	show_and_draw(&gallery);
	const int whole = drawn_pixels(&gallery);
	gallery.rays.clip.greatest[0] = 0.5;
	draw_gallery(&gallery, NULL);
	const int half = drawn_pixels(&gallery);
	assert_in_range(half, whole * 45 / 100, whole * 55 / 100);
	assert_int_equal(grey_at(&gallery, WIDTH / 2 + 4, HEIGHT / 2), 255);
	gallery.rays.clip.greatest[0] = 0.1;
	draw_gallery(&gallery, NULL);
	assert_int_equal(drawn_pixels(&gallery), 0);
	/* A plane cuts like the box's face there. */
	gallery.rays.clip.greatest[0] = 1;
	gallery.rays.clip.plane = true;
	draw_gallery(&gallery, NULL);
	assert_int_equal(drawn_pixels(&gallery), half);
	assert_int_equal(grey_at(&gallery, WIDTH / 2 + 4, HEIGHT / 2), 255);
	gallery.rays.clip.offset = 0.1;
	draw_gallery(&gallery, NULL);
	assert_int_equal(drawn_pixels(&gallery), 0);
	close_gallery(&gallery);
}

/* Of a volume the surface is made when the isovalue changes, and only then. */
static void surface_of_a_volume_follows_the_isovalue(void **state)
{
	(void)state;
	struct gallery gallery;
	struct gz_frame_stats stats;
	open_gallery(&gallery);
	gallery.object.mesh = NULL;
	gallery.rays.surface.isovalue = 4.01;
	show_and_draw(&gallery);
	const int large = drawn_pixels(&gallery);
	assert_true(large > 200);
	draw_gallery(&gallery, &stats);
	assert_true(stats.prepare_ms == 0 && stats.rays == PIXELS);
	gallery.rays.surface.isovalue = 10.01;
	draw_gallery(&gallery, &stats);
	assert_true(stats.prepare_ms > 0);
	assert_in_range(drawn_pixels(&gallery), large / 10, large * 9 / 10);
	gallery.rays.surface.isovalue = 1000; /* the object vanishes */
	draw_gallery(&gallery, &stats);
	assert_int_equal(drawn_pixels(&gallery), 0);
	gallery.rays.surface.isovalue = 4.01;
	draw_gallery(&gallery, &stats);
	assert_int_equal(drawn_pixels(&gallery), large);
	close_gallery(&gallery);
}

/* Another scene, in which the object has another place, finds what was computed of its mesh. */
static void what_is_computed_of_a_mesh_is_kept_once(void **state)
{
	(void)state;
	struct gallery gallery;
	(void)kept_files_open();
	open_gallery(&gallery);
	gallery.object.input = "/nowhere/ball.ply";
	show_and_draw(&gallery);
	close_gallery(&gallery);
	assert_int_equal(kept_files_count(), 1);
	open_gallery(&gallery);
	gallery.object.input = "/nowhere/ball.ply";
	gallery.object.id = 9;
	show_and_draw(&gallery);
	close_gallery(&gallery);
	assert_int_equal(kept_files_count(), 1);
	kept_files_close();
}

/* The surface of a volume that a scene begins with is kept, those of a moving isovalue are not. */
static void first_surface_of_a_volume_is_kept(void **state)
{
	(void)state;
	struct gallery gallery;
	(void)kept_files_open();
	for (int start = 0; start < 2; start++) {
		open_gallery(&gallery);
		gallery.object.mesh = NULL;
		gallery.object.input = "/nowhere/ball.raw";
		gallery.rays.surface.isovalue = 4;
		show_and_draw(&gallery);
		assert_int_equal(kept_files_count(), 1);
		gallery.rays.surface.isovalue = 5;
		show_and_draw(&gallery);
		close_gallery(&gallery);
		assert_int_equal(kept_files_count(), 1);
	}
	kept_files_close();
}

static void unknown_backends_are_refused_by_name(void **state)
{
	(void)state;
	struct captured_log heard;
	const struct gz_backend_params params = { 0 };
	struct gz_drawer *drawer = NULL;
	captured_log_init(&heard, NULL);
	assert_int_equal(gz_illustrate_technique.check("vulkan", &params, &heard.log),
			 GZ_ERR_NOT_FOUND);
	assert_non_null(strstr(heard.last, "'vulkan'"));
	assert_non_null(strstr(heard.last, "gl, cpu"));
	assert_int_equal(gz_illustrate_technique.create("vulkan", &params, &heard.log, &drawer),
			 GZ_ERR_NOT_FOUND);
	assert_null(drawer);
}

TEST_SUITE(illustrate_technique)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(lights_alone_are_their_formulas),
		cmocka_unit_test(every_parameter_can_be_shown_alone),
		cmocka_unit_test(single_settings_count_only_if_asked_for),
		cmocka_unit_test(clip_box_cuts),
		cmocka_unit_test(surface_of_a_volume_follows_the_isovalue),
		cmocka_unit_test(what_is_computed_of_a_mesh_is_kept_once),
		cmocka_unit_test(first_surface_of_a_volume_is_kept),
		cmocka_unit_test(unknown_backends_are_refused_by_name),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
