/* Slices show what the ray caster shows, the better the more of them there are. */
#include "suite.h"

#include <math.h>
#include <string.h>

#include <GL/glew.h>

#include "base/captured_log.h"
#include "lent_context.h"
#include "render/layers/gl_layers.h"
#include "render/plan/method.h"
#include "render/slices/gl/gl_slicer.h"
#include "render/slices/slices_technique.h"
#include "shader_check.h"
#include "small_scene.h"

enum { WIDTH = 40, HEIGHT = 30 };

/* PSNR that 1024 slices reach against the ray caster, dB. */
#define CONVERGED_DB 38.0

/* One drawer for all tests: its shaders are compiled once. */
static struct gz_drawer *drawer;

static void show_scene(const struct small_scene *scene)
{
	static uint64_t revision;
	const struct gz_object object = {
		.technique = &gz_slices_technique,
		.id = 1,
		.volume = &scene->volume,
		.transfer = &scene->transfer,
		.data_revision = ++revision,
		.transfer_revision = revision,
	};
	assert_int_equal(drawer->ops->show(drawer, &object, 1), GZ_OK);
}

static enum gz_result draw_plan(const struct small_scene *scene, const struct gz_plan *plan,
				struct gz_image *image, struct gz_frame_stats *out_stats)
{
	const struct gz_shot shot = {
		.camera = &scene->camera,
		.settings = &scene->rays,
		.plan = plan,
	};
	return drawer->ops->draw(drawer, &shot, image, out_stats);
}

static void draw_sized(const struct small_scene *scene, int width, int height,
		       struct gz_image *image, struct gz_frame_stats *out_stats)
{
	const struct gz_display display = gz_display_default(width, height);
	struct gz_plan plan = { 0 };
	assert_int_equal(
		gz_plan_make(&scene->foveation, &display, scene->gaze, width, height, &plan),
		GZ_OK);
	assert_int_equal(draw_plan(scene, &plan, image, out_stats), GZ_OK);
	gz_plan_free(&plan);
}

static void draw(const struct small_scene *scene, struct gz_image *image,
		 struct gz_frame_stats *out_stats)
{
	draw_sized(scene, WIDTH, HEIGHT, image, out_stats);
}

/* PSNR of the channels red, green and blue, dB. */
static double psnr_db(const struct gz_image *a, const struct gz_image *b)
{
	double sum = 0;
	assert_true(a->width == b->width && a->height == b->height);
	for (int i = 0; i < 4 * a->width * a->height; i++)
		sum += (a->pixels[i] - b->pixels[i]) * (a->pixels[i] - b->pixels[i]);
	return 10 * log10(255 * 255 / fmax(sum / (3 * a->width * a->height), 1e-9));
}

/* The scene by rays with many samples. */
static struct gz_image converged_picture(const struct small_scene *scene)
{
	struct small_scene fine = *scene;
	struct gz_raycaster *renderer = NULL;
	struct gz_image image = { 0 };
	fine.rays.ray_sampling_rate = GZ_RAY_SAMPLING_RATE_MAX;
	assert_int_equal(gz_raycaster_create("cpu", NULL, NULL, &renderer), GZ_OK);
	assert_int_equal(gz_raycaster_set_volume(renderer, &scene->volume), GZ_OK);
	assert_int_equal(gz_raycaster_set_transfer(renderer, &scene->transfer), GZ_OK);
	small_scene_render(renderer, &fine, WIDTH, HEIGHT, &image, NULL);
	gz_raycaster_destroy(&renderer);
	return image;
}

/* More slices are nearer to the ray caster's picture. Frees the scene. */
static void check_convergence(struct small_scene *scene, const char *what)
{
	static const int counts[] = { 4, 32, 1024 };
	double reached[3];
	struct gz_image image = { 0 };
	scene->foveation = gz_foveation_full();
	struct gz_image goal = converged_picture(scene);
	show_scene(scene);
	for (int i = 0; i < 3; i++) {
		scene->rays.slicing.count = counts[i];
		draw(scene, &image, NULL);
		reached[i] = psnr_db(&image, &goal);
	}
	if (!(reached[0] < reached[1] && reached[1] < reached[2] && reached[2] >= CONVERGED_DB))
		fail_msg("%s: %.1f, %.1f and %.1f dB by 4, 32 and 1024 slices", what, reached[0],
			 reached[1], reached[2]);
	gz_image_free(&image);
	gz_image_free(&goal);
	small_scene_free(scene);
}

static void slices_of_8_bit_data_converge_to_rays(void **state)
{
	(void)state;
	struct small_scene scene = small_scene_waves(30, 21, 40, GZ_VOXEL_U8);
	check_convergence(&scene, "8 bits");
}

static void slices_of_lit_float_data_converge_to_rays_in_parallel(void **state)
{
	(void)state;
	struct small_scene scene = small_scene_waves(30, 21, 40, GZ_VOXEL_F32);
	scene.camera.projection = GZ_PROJECTION_ORTHOGRAPHIC;
	scene.rays.shading = GZ_SHADING_GRADIENT;
	scene.rays.environment.kind = GZ_SURROUNDINGS_SKY;
	scene.rays.light.reflection = 0.3;
	check_convergence(&scene, "lit floats");
}

static void slices_with_shadows_converge_to_rays(void **state)
{
	(void)state;
	for (int lit = 0; lit < 2; lit++) {
		struct small_scene scene = small_scene_waves(30, 21, 40, GZ_VOXEL_U8);
		scene.rays.shading = lit ? GZ_SHADING_GRADIENT : GZ_SHADING_NONE;
		scene.rays.light.shadow_steps = 6;
		scene.rays.light.ambient = 0.1;
		check_convergence(&scene, lit ? "shadows on surfaces" : "shadows in smoke");
	}
}

static void pre_integrated_slices_converge_to_rays_from_within(void **state)
{
	(void)state;
	struct small_scene scene = small_scene_waves(30, 21, 40, GZ_VOXEL_U16);
	scene.camera.eye[0] = 0.2;
	scene.camera.eye[1] = 0.1;
	scene.camera.eye[2] = 0.1;
	scene.camera.look_at[0] = -1;
	scene.rays.integration = GZ_INTEGRATION_PREINTEGRATED;
	check_convergence(&scene, "pre-integrated");
}

static void slices_of_labels_and_of_colours_converge_to_rays(void **state)
{
	(void)state;
	struct small_scene labels = small_scene_waves(12, 9, 14, GZ_VOXEL_U8);
	labels.volume.labels = true;
	check_convergence(&labels, "labels");
	struct small_scene coloured = small_scene_coloured(12, 9, 14, GZ_COLOUR_ALPHA);
	check_convergence(&coloured, "colours");
}

static void slices_of_a_clipped_volume_of_one_layer_converge_to_rays(void **state)
{
	(void)state;
	struct small_scene scene = small_scene_waves(30, 21, 1, GZ_VOXEL_U8);
	scene.rays.clip.least[0] = 0.6;
	scene.rays.clip.greatest[1] = 0.8;
	check_convergence(&scene, "one layer");
}

static void slices_cut_by_a_plane_converge_to_rays(void **state)
{
	(void)state;
	static const double normals[][3] = { { 0.4, 0.7, -0.3 }, { -0.2, -0.9, 0.5 } };
	for (int i = 0; i < 4; i++) {
		struct small_scene scene = small_scene_waves(30, 21, 27, GZ_VOXEL_U8);
		scene.camera.projection =
			i & 1 ? GZ_PROJECTION_ORTHOGRAPHIC : GZ_PROJECTION_PERSPECTIVE;
		scene.camera.height = 1.3;
		scene.rays.clip.greatest[0] = 0.9;
		scene.rays.clip.plane = true;
		memcpy(scene.rays.clip.normal, normals[i / 2], sizeof normals[0]);
		scene.rays.clip.offset = 0.55;
		check_convergence(&scene, "cut by a plane");
	}
}

/* Beer and Lambert: through a block of one opacity comes as much light by any number of slices. */
static void opacity_of_a_block_does_not_depend_on_the_slices(void **state)
{
	(void)state;
	static const int counts[] = { 1, 2, 7, 100, GZ_SLICES_MAX };
	struct small_scene scene = small_scene_constant(16, 0.08);
	struct gz_image image = { 0 };
	scene.foveation = gz_foveation_full();
	scene.camera.eye[0] = scene.camera.eye[2] = 0;
	scene.camera.eye[1] = -3;
	scene.camera.projection = GZ_PROJECTION_ORTHOGRAPHIC;
	show_scene(&scene);
	const double opacity = 1 - pow(1 - 0.08, 16);
	for (size_t i = 0; i < sizeof counts / sizeof counts[0]; i++) {
		scene.rays.slicing.count = counts[i];
		draw(&scene, &image, NULL);
		const uint8_t *pixel = &image.pixels[4 * (HEIGHT / 2 * WIDTH + WIDTH / 2)];
		const double red = 255 * 0.9 * opacity;
		if (fabs(pixel[0] - red) > 1)
			fail_msg("%d slices: red is %d, not %.1f", counts[i], pixel[0], red);
	}
	gz_image_free(&image);
	small_scene_free(&scene);
}

static void closing_opaque_points_saves_samples_and_changes_no_pixel_by_two(void **state)
{
	(void)state;
	struct small_scene scene = small_scene_constant(16, 0.7);
	struct gz_image ended = { 0 }, whole = { 0 };
	struct gz_frame_stats few, all;
	scene.foveation = gz_foveation_full();
	scene.rays.slicing.count = 64;
	show_scene(&scene);
	draw(&scene, &ended, &few);
	scene.rays.early_termination = false;
	draw(&scene, &whole, &all);
	assert_int_equal(image_pixels_apart(&ended, &whole), 0);
	assert_in_range(few.samples, 1, all.samples * 2 / 3);
	gz_image_free(&ended);
	gz_image_free(&whole);
	small_scene_free(&scene);
}

/* Where the finest layer shows, nothing differs; elsewhere points are fewer. */
static void foveated_picture_is_full_at_the_gaze_and_takes_fewer_points(void **state)
{
	(void)state;
	enum { WIDE = 4 * WIDTH, HIGH = 4 * HEIGHT, X = WIDE * 3 / 10, Y = HIGH * 2 / 5 };
	struct small_scene scene = small_scene_waves(30, 21, 40, GZ_VOXEL_U8);
	struct gz_image full = { 0 }, foveated = { 0 };
	struct gz_frame_stats many, few;
	scene.gaze = (struct gz_point) { 0.3F, 0.4F };
	scene.rays.slicing.count = 24;
	scene.foveation.acuity_slope = 0.1; /* so that a small picture has coarse places */
	scene.foveation.acuity_far_share = 1;
	scene.foveation.mdc_square_px = 40;
	show_scene(&scene);
	scene.foveation.method = gz_method_full();
	draw_sized(&scene, WIDE, HIGH, &full, &many);
	assert_int_equal(many.rays, WIDE * HIGH);
	for (int method = 0; method < GZ_METHOD_COUNT; method++) {
		scene.foveation.method = method;
		draw_sized(&scene, WIDE, HIGH, &foveated, &few);
		assert_true(few.rays <= many.rays);
		if (gz_methods[method].sharp_at_gaze)
			assert_memory_equal(&full.pixels[4 * (Y * WIDE + X)],
					    &foveated.pixels[4 * (Y * WIDE + X)], 4);
		if (method == GZ_METHOD_ACUITY || method == GZ_METHOD_MDC)
			assert_in_range(few.rays, 1, many.rays * 2 / 3);
		/* Holes or misplaced layers would be far below. */
		if (psnr_db(&full, &foveated) < 25)
			fail_msg("%s: %.1f dB", gz_method_names[method], psnr_db(&full, &foveated));
	}
	gz_image_free(&full);
	gz_image_free(&foveated);
	small_scene_free(&scene);
}

static void what_lies_behind_the_eye_leaves_the_background(void **state)
{
	(void)state;
	struct small_scene scene = small_scene_constant(8, 0.5);
	struct gz_image image = { 0 };
	struct gz_frame_stats stats;
	scene.rays.background[0] = 1;
	for (int axis = 0; axis < 3; axis++)
		scene.camera.look_at[axis] = 2 * scene.camera.eye[axis];
	show_scene(&scene);
	draw(&scene, &image, &stats);
	for (int i = 0; i < WIDTH * HEIGHT; i++)
		assert_int_equal(gz_image_words(&image)[i], 0xFF0000FF);
	assert_int_equal(stats.samples, 0);
	gz_image_free(&image);
	small_scene_free(&scene);
}

static void counts_out_of_range_are_refused(void **state)
{
	(void)state;
	struct small_scene scene = small_scene_constant(8, 0.5);
	struct gz_image image = { 0 };
	struct gz_plan plan = { 0 };
	const struct gz_display display = gz_display_default(WIDTH, HEIGHT);
	static const int counts[] = { -1, 0, GZ_SLICES_MAX + 1 };
	assert_int_equal(gz_plan_make(&scene.foveation, &display, scene.gaze, WIDTH, HEIGHT, &plan),
			 GZ_OK);
	show_scene(&scene);
	for (size_t i = 0; i < sizeof counts / sizeof counts[0]; i++) {
		scene.rays.slicing.count = counts[i];
		assert_int_equal(draw_plan(&scene, &plan, &image, NULL), GZ_ERR_INVAL);
	}
	gz_plan_free(&plan);
	gz_image_free(&image);
	small_scene_free(&scene);
}

static void other_backends_and_meshes_are_refused_with_one_line(void **state)
{
	(void)state;
	struct captured_log captured;
	struct gz_drawer *own = NULL;
	const struct gz_mesh mesh = { 0 };
	const struct gz_object object = { .technique = &gz_slices_technique, .mesh = &mesh };
	captured_log_init(&captured, "*:warn");
	assert_int_equal(gz_slices_technique.create("cpu", NULL, &captured.log, &own),
			 GZ_ERR_NOT_FOUND);
	assert_int_equal(captured.messages, 1);
	assert_non_null(strstr(captured.last, "--backend gl"));
	assert_int_equal(gz_slices_technique.create("auto", NULL, &captured.log, &own), GZ_OK);
	assert_int_equal(own->ops->show(own, &object, 1), GZ_ERR_UNSUPPORTED);
	assert_int_equal(captured.messages, 2);
	assert_non_null(strstr(captured.last, "isosurface"));
	gz_drawer_destroy(&own);
}

/* As in a window: the picture stays on the device, and what the window draws next is not upset. */
static void picture_left_in_a_lent_context_equals_the_one_read_back(void **state)
{
	(void)state;
	struct small_scene scene = small_scene_constant(8, 0.5);
	struct lent_context lent = lend_context();
	const struct gz_backend_params params = { .gl_context = &lent.base };
	struct gz_drawer *shared = drawer;
	struct gz_image image = { 0 };
	struct gz_plan plan = { 0 };
	const struct gz_display display = gz_display_default(WIDTH, HEIGHT);
	static uint8_t pixels[4 * WIDTH * HEIGHT];
	GLint viewport[4];
	assert_int_equal(gz_slices_technique.create("gl", &params, NULL, &drawer), GZ_OK);
	show_scene(&scene);
	assert_int_equal(gz_plan_make(&scene.foveation, &display, scene.gaze, WIDTH, HEIGHT, &plan),
			 GZ_OK);
	assert_int_equal(draw_plan(&scene, &plan, &image, NULL), GZ_OK);
	assert_int_equal(lent.egl->ops->make_current(lent.egl), GZ_OK);
	glViewport(1, 2, 3, 4);
	assert_int_equal(draw_plan(&scene, &plan, NULL, NULL), GZ_OK);
	assert_int_equal(lent.egl->ops->make_current(lent.egl), GZ_OK);
	glGetIntegerv(GL_VIEWPORT, viewport);
	assert_true(viewport[0] == 1 && viewport[1] == 2 && viewport[2] == 3 && viewport[3] == 4);
	assert_false(glIsEnabled(GL_BLEND) || glIsEnabled(GL_DEPTH_TEST) ||
		     glIsEnabled(GL_SCISSOR_TEST));
	assert_true(drawer->ops->keeps_on_device(drawer, NULL));
	glBindTexture(GL_TEXTURE_2D, drawer->ops->picture_texture(drawer));
	glGetTexImage(GL_TEXTURE_2D, 0, GL_RGBA, GL_UNSIGNED_BYTE, pixels);
	assert_int_equal(glGetError(), GL_NO_ERROR);
	lent.egl->ops->release(lent.egl);
	assert_memory_equal(pixels, image.pixels, sizeof pixels);
	lent.lost = true;
	assert_int_equal(draw_plan(&scene, &plan, &image, NULL), GZ_ERR_NO_DEVICE);
	gz_drawer_destroy(&drawer);
	drawer = shared;
	gz_plan_free(&plan);
	gz_image_free(&image);
	gz_gl_context_destroy(&lent.egl);
	small_scene_free(&scene);
}

/* Drivers forgive what the reference compiler does not. */
static void shaders_of_slices_are_valid_for_the_reference_compiler(void **state)
{
	(void)state;
	char defines[GZ_GL_CAST_DEFINES_SIZE];
	struct gz_gl_shader shaders[2];
	shader_check_needs_validator();
	for (int variant = 0; variant < 16; variant++) {
		const int bits = __builtin_popcount((unsigned)variant);
		const struct gz_gl_cast_kind kind = {
			.texels = variant & 1 ? GZ_GL_TEXELS_BRICKS : GZ_GL_TEXELS_PACKED,
			.type = GZ_VOXEL_U16,
			.nearest = variant & 1,
			.segments = variant & 2,
			.shaded = variant & 4,
			.shadowed = bits & 1,
			.fine = variant & 8,
		};
		const struct gz_gl_device device = { .software = variant & 8 };
		gz_gl_slice_shaders(kind, &device, defines, shaders);
		shader_check(&shaders[1]);
	}
	shader_check(&shaders[0]);
	gz_gl_behind_shaders((struct gz_gl_cast_kind) { .type = GZ_VOXEL_U8 },
			     &(const struct gz_gl_device) { 0 }, defines, shaders);
	shader_check(&shaders[1]);
	gz_gl_hide_shaders(shaders);
	shader_check(&shaders[0]);
	shader_check(&shaders[1]);
	shaders[0] = gz_gl_join_shader();
	shader_check(&shaders[0]);
}

TEST_SUITE(slices)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(slices_of_8_bit_data_converge_to_rays),
		cmocka_unit_test(slices_of_lit_float_data_converge_to_rays_in_parallel),
		cmocka_unit_test(slices_with_shadows_converge_to_rays),
		cmocka_unit_test(pre_integrated_slices_converge_to_rays_from_within),
		cmocka_unit_test(slices_of_labels_and_of_colours_converge_to_rays),
		cmocka_unit_test(slices_of_a_clipped_volume_of_one_layer_converge_to_rays),
		cmocka_unit_test(slices_cut_by_a_plane_converge_to_rays),
		cmocka_unit_test(opacity_of_a_block_does_not_depend_on_the_slices),
		cmocka_unit_test(closing_opaque_points_saves_samples_and_changes_no_pixel_by_two),
		cmocka_unit_test(foveated_picture_is_full_at_the_gaze_and_takes_fewer_points),
		cmocka_unit_test(what_lies_behind_the_eye_leaves_the_background),
		cmocka_unit_test(counts_out_of_range_are_refused),
		cmocka_unit_test(other_backends_and_meshes_are_refused_with_one_line),
		cmocka_unit_test(picture_left_in_a_lent_context_equals_the_one_read_back),
		cmocka_unit_test(shaders_of_slices_are_valid_for_the_reference_compiler),
	};
	if (gz_slices_technique.create("gl", NULL, NULL, &drawer) != GZ_OK)
		return 77;
	const int failed = cmocka_run_group_tests(tests, NULL, NULL);
	gz_drawer_destroy(&drawer);
	return failed;
}
