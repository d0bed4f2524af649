/* The gl backend beside the cpu's, and what it refuses. */
#include "suite.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include <GL/glew.h>

#include "lent_context.h"
#include "render/opengl/gl_device.h"
#include "render/plan/method.h"
#include "render/raycast/gl/gl_cast.h"
#include "render/reconstruct/gl/gl_reconstruct.h"
#include "small_scene.h"

/* Keeps the last message. */
struct heard {
	char text[512];
};

static void hear(void *user, enum gz_log_level level, const char *module, const char *message)
{
	struct heard *heard = user;
	(void)module;
	if (level >= GZ_LOG_INFO)
		snprintf(heard->text, sizeof heard->text, "%s", message);
}

static struct gz_raycaster *renderer_with(const char *backend,
					  const struct raycaster_params *params,
					  const struct small_scene *scene)
{
	struct gz_raycaster *renderer = NULL;
	assert_int_equal(raycaster_with(backend, params, NULL, &renderer), GZ_OK);
	assert_int_equal(gz_raycaster_set_volume(renderer, &scene->volume), GZ_OK);
	assert_int_equal(gz_raycaster_set_transfer(renderer, &scene->transfer), GZ_OK);
	return renderer;
}

static struct gz_raycaster *renderer_of(const char *backend, const struct small_scene *scene)
{
	static const struct raycaster_params defaults;
	return renderer_with(backend, &defaults, scene);
}

/* Both backends with one scene. */
struct pair {
	struct gz_raycaster *cpu, *gl;
	struct gz_image of_cpu, of_gl;
};

static struct pair pair_of(const struct small_scene *scene)
{
	return (struct pair) { .cpu = renderer_of("cpu", scene), .gl = renderer_of("gl", scene) };
}

static void pair_free(struct pair *pair)
{
	gz_raycaster_destroy(&pair->cpu);
	gz_raycaster_destroy(&pair->gl);
	gz_image_free(&pair->of_cpu);
	gz_image_free(&pair->of_gl);
}

/* The bound that both backends promise: within 1/255 for 99.9 % of the pixels. */
static void check_pair(struct pair *pair, const struct small_scene *scene, int width, int height,
		       const char *what)
{
	struct gz_frame_stats cpu, gl;
	small_scene_render(pair->cpu, scene, width, height, &pair->of_cpu, &cpu);
	small_scene_render(pair->gl, scene, width, height, &pair->of_gl, &gl);
	const int apart = image_pixels_apart(&pair->of_cpu, &pair->of_gl);
	if (apart * 1000 > width * height)
		fail_msg("%s, %s: %d of %d pixels differ", what,
			 gz_method_names[scene->foveation.method], apart, width * height);
	assert_int_equal(cpu.rays, gl.rays);
	/* The cpu fetches some samples before it knows that their ray has ended, and leaves out
	 * those that show nothing by smaller cells. */
	const double cpu_samples = (double)cpu.samples, gl_samples = (double)gl.samples;
	if (gl_samples < 0.95 * cpu_samples - 2 || gl_samples > 1.5 * cpu_samples + 2)
		fail_msg("%s, %s: %llu samples, cpu %llu", what,
			 gz_method_names[scene->foveation.method], (unsigned long long)gl.samples,
			 (unsigned long long)cpu.samples);
	assert_true(gl.cast_ms >= 0 && gl.reconstruct_ms >= 0);
}

static void check_every_method(struct small_scene *scene, const char *what)
{
	struct pair pair = pair_of(scene);
	for (int method = 0; method < GZ_METHOD_COUNT; method++)
		for (int nearest = 0; nearest < 2; nearest++) {
			scene->foveation.method = method;
			scene->rays.interpolation =
				nearest ? GZ_INTERPOLATION_NEAREST : GZ_INTERPOLATION_TRILINEAR;
			check_pair(&pair, scene, 331, 217, what);
		}
	pair_free(&pair);
	small_scene_free(scene);
}

static void pictures_of_8_bit_data_equal_the_cpus_by_every_method(void **state)
{
	(void)state;
	struct small_scene scene = small_scene_waves(50, 41, 60, GZ_VOXEL_U8);
	check_every_method(&scene, "8 bits");
}

/* Other shaders, timers and ways back than where a processor does the work. */
static void pictures_as_a_graphics_device_makes_them_equal_the_cpus(void **state)
{
	(void)state;
	const struct raycaster_params params = { .hooks.as_hardware = true };
	const enum gz_voxel_type types[] = { GZ_VOXEL_U8, GZ_VOXEL_F32 };
	for (int i = 0; i < 2; i++) {
		struct small_scene scene = small_scene_waves(50, 41, 60, types[i]);
		struct pair pair = { .cpu = renderer_of("cpu", &scene),
				     .gl = renderer_with("gl", &params, &scene) };
		for (int method = GZ_METHOD_STANDARD; method <= GZ_METHOD_ACUITY; method++) {
			scene.foveation.method = method;
			check_pair(&pair, &scene, 150, 110, "as on a device");
			check_pair(&pair, &scene, 150, 110, "the same plan again");
		}
		pair_free(&pair);
		small_scene_free(&scene);
	}
}

static void pictures_of_16_bit_data_equal_the_cpus_by_every_method(void **state)
{
	(void)state;
	struct small_scene scene = small_scene_waves(33, 47, 52, GZ_VOXEL_U16);
	scene.gaze = (struct gz_point) { 0.2F, 0.9F };
	check_every_method(&scene, "16 bits");
}

static void pictures_of_float_data_equal_the_cpus_by_every_method(void **state)
{
	(void)state;
	struct small_scene scene = small_scene_waves(40, 31, 27, GZ_VOXEL_F32);
	scene.gaze = (struct gz_point) { NAN, 0 };
	check_every_method(&scene, "float");
}

static void pictures_of_colours_equal_the_cpus_by_every_method(void **state)
{
	(void)state;
	struct small_scene scene = small_scene_coloured(50, 41, 60, GZ_COLOUR_ALPHA);
	check_every_method(&scene, "colours");
}

static void pictures_of_colours_as_a_graphics_device_makes_them_equal_the_cpus(void **state)
{
	(void)state;
	const struct raycaster_params params = { .hooks.as_hardware = true };
	struct small_scene scene = small_scene_coloured(50, 41, 60, GZ_COLOUR_LUMINANCE);
	struct pair pair = { .cpu = renderer_of("cpu", &scene),
			     .gl = renderer_with("gl", &params, &scene) };
	scene.foveation.method = GZ_METHOD_ACUITY;
	for (int variant = 0; variant < 8; variant++) {
		scene.rays.levels = variant & 1;
		scene.rays.integration =
			variant & 2 ? GZ_INTEGRATION_PREINTEGRATED : GZ_INTEGRATION_SAMPLED;
		scene.rays.shading = variant & 4 ? GZ_SHADING_GRADIENT : GZ_SHADING_NONE;
		check_pair(&pair, &scene, 320, 240, "colours as on a device");
	}
	pair_free(&pair);
	small_scene_free(&scene);
}

static void pre_integrated_pictures_and_levels_of_detail_equal_the_cpus(void **state)
{
	(void)state;
	for (int type = 0; type < GZ_VOXEL_TYPE_COUNT; type++) {
		struct small_scene scene = small_scene_waves(70, 81, 64, type);
		struct pair pair = pair_of(&scene);
		scene.foveation.method = GZ_METHOD_ACUITY;
		scene.rays.jitter = 7;
		scene.rays.clip.least[0] = 0.2;
		for (int variant = 0; variant < 4; variant++) {
			scene.rays.levels = variant & 1;
			scene.rays.integration =
				variant & 2 ? GZ_INTEGRATION_PREINTEGRATED : GZ_INTEGRATION_SAMPLED;
			scene.rays.environment.kind =
				variant == 1 ? GZ_SURROUNDINGS_SKY : GZ_SURROUNDINGS_NONE;
			check_pair(&pair, &scene, 640, 480, scene.rays.levels ? "levels" : "plain");
		}
		pair_free(&pair);
		small_scene_free(&scene);
	}
}

static void pictures_of_hidden_matter_equal_the_cpus(void **state)
{
	(void)state;
	static const double rates[] = { 3, 1, 0.3 };
	struct small_scene scene = small_scene_ball_in_hidden_matter();
	struct pair pair = pair_of(&scene);
	for (int i = 0; i < 3; i++) {
		scene.rays.ray_sampling_rate = rates[i];
		small_scene_render(pair.cpu, &scene, 200, 150, &pair.of_cpu, NULL);
		small_scene_render(pair.gl, &scene, 200, 150, &pair.of_gl, NULL);
		const int apart = image_pixels_apart(&pair.of_cpu, &pair.of_gl);
		if (apart * 1000 > 200 * 150)
			fail_msg("rate %g: %d pixels differ", rates[i], apart);
	}
	pair_free(&pair);
	small_scene_free(&scene);
}

static void pictures_of_interleaved_steps_equal_the_cpus(void **state)
{
	(void)state;
	struct small_scene scene = small_scene_waves(70, 51, 64, GZ_VOXEL_U8);
	struct pair pair = pair_of(&scene);
	scene.foveation.method = GZ_METHOD_ACUITY;
	scene.foveation.acuity_slope = 0.2; /* so that every rung is taken */
	scene.foveation.step_phase = GZ_STEP_PHASE_INTERLEAVED;
	check_pair(&pair, &scene, 200, 150, "interleaved");
	scene.rays.integration = GZ_INTEGRATION_PREINTEGRATED;
	check_pair(&pair, &scene, 200, 150, "interleaved segments");
	pair_free(&pair);
	small_scene_free(&scene);
}

static void pictures_cut_by_a_plane_equal_the_cpus(void **state)
{
	(void)state;
	for (int type = 0; type < GZ_VOXEL_TYPE_COUNT; type++) {
		struct small_scene scene = small_scene_waves(70, 51, 64, type);
		struct pair pair = pair_of(&scene);
		scene.foveation.method = GZ_METHOD_ACUITY;
		scene.rays.clip.plane = true;
		memcpy(scene.rays.clip.normal, (double[3]) { -0.3, -0.7, 0.5 }, 3 * sizeof(double));
		for (int variant = 0; variant < 3; variant++) {
			scene.rays.levels = variant == 1;
			scene.rays.shading = variant == 2 ? GZ_SHADING_GRADIENT : GZ_SHADING_NONE;
			scene.rays.light.occlusion = variant == 2 ? 0.6 : 0;
			scene.rays.light.shadow_steps = variant == 2 ? 5 : 0;
			scene.rays.clip.offset = 0.4 + 0.1 * variant;
			check_pair(&pair, &scene, 300, 200, "cut by a plane");
		}
		pair_free(&pair);
		small_scene_free(&scene);
	}
}

static void soft_shadows_equal_the_cpus(void **state)
{
	(void)state;
	struct small_scene scene = small_scene_waves(70, 51, 64, GZ_VOXEL_U8);
	struct pair pair = pair_of(&scene);
	scene.foveation.method = GZ_METHOD_ACUITY;
	scene.rays.light.ambient = 0.1;
	scene.rays.light.shadow_steps = 6;
	check_pair(&pair, &scene, 200, 150, "shadows in smoke");
	scene.rays.shading = GZ_SHADING_GRADIENT;
	for (int variant = 0; variant < 4; variant++) {
		scene.rays.light.direction[0] = variant & 1 ? 0.8 : -0.6;
		scene.rays.light.occlusion = variant & 1 ? 0.5 : 0;
		scene.rays.clip.greatest[2] = variant & 2 ? 0.7 : 1;
		scene.rays.levels = variant == 3;
		check_pair(&pair, &scene, 200, 150, "shadows on surfaces");
	}
	scene.rays.light.shadow_steps = 0;
	check_pair(&pair, &scene, 200, 150, "no shadows after some");
	pair_free(&pair);
	small_scene_free(&scene);
}

static void soft_shadows_as_a_graphics_device_makes_them_equal_the_cpus(void **state)
{
	(void)state;
	const struct raycaster_params params = { .hooks.as_hardware = true };
	struct small_scene scene = small_scene_waves(70, 51, 64, GZ_VOXEL_F32);
	struct pair pair = { .cpu = renderer_of("cpu", &scene),
			     .gl = renderer_with("gl", &params, &scene) };
	scene.rays.shading = GZ_SHADING_GRADIENT;
	scene.rays.light.shadow_steps = 6;
	scene.rays.integration = GZ_INTEGRATION_PREINTEGRATED;
	check_pair(&pair, &scene, 200, 150, "shadows as on a device");
	pair_free(&pair);
	small_scene_free(&scene);
}

static void pictures_from_inside_and_orthographic_equal_the_cpus(void **state)
{
	(void)state;
	struct small_scene scene = small_scene_waves(48, 48, 48, GZ_VOXEL_U8);
	struct pair pair = pair_of(&scene);
	memcpy(scene.camera.eye, (double[3]) { 0.1, -0.1, 0.05 }, sizeof scene.camera.eye);
	check_pair(&pair, &scene, 200, 150, "inside");
	scene.camera.projection = GZ_PROJECTION_ORTHOGRAPHIC;
	check_pair(&pair, &scene, 200, 150, "orthographic");
	pair_free(&pair);
	small_scene_free(&scene);
}

static void pictures_of_any_size_equal_the_cpus(void **state)
{
	(void)state;
	static const int sizes[][2] = { { 1, 1 },    { 2, 1 },     { 1, 300 },  { 17, 16 },
					{ 1031, 3 }, { 16384, 2 }, { 3, 16384 } };
	struct small_scene scene = small_scene_waves(24, 24, 24, GZ_VOXEL_U8);
	struct pair pair = pair_of(&scene);
	for (size_t i = 0; i < sizeof sizes / sizeof sizes[0]; i++) {
		scene.foveation.method = GZ_METHOD_ACUITY;
		check_pair(&pair, &scene, sizes[i][0], sizes[i][1], "size");
	}
	pair_free(&pair);
	small_scene_free(&scene);
}

/* As frames that are kept have it (render/accumulate/temporal.h): the plan's corner is not the
 * picture's. */
static void jittered_pictures_of_a_shifted_plan_equal_the_cpus(void **state)
{
	(void)state;
	enum { WIDTH = 331, HEIGHT = 217, SHIFT_X = 5, SHIFT_Y = 30 };
	struct small_scene scene = small_scene_waves(40, 44, 36, GZ_VOXEL_U8);
	scene.display = gz_display_default(WIDTH, HEIGHT);
	scene.rays.jitter = 7;
	scene.rays.ray_sampling_rate = 0.5;
	scene.rays.levels = true;
	struct pair pair = pair_of(&scene);
	struct gz_plan plan = { 0 };
	assert_int_equal(
		gz_plan_make(&scene.foveation, &scene.display, scene.gaze, WIDTH, HEIGHT, &plan),
		GZ_OK);
	plan.view = (struct gz_plan_view) { WIDTH - 32, HEIGHT - 32, { SHIFT_X, SHIFT_Y } };
	assert_int_equal(gz_raycaster_render(pair.cpu, &scene.camera, &scene.rays, &plan,
					     &pair.of_cpu, NULL),
			 GZ_OK);
	assert_int_equal(
		gz_raycaster_render(pair.gl, &scene.camera, &scene.rays, &plan, &pair.of_gl, NULL),
		GZ_OK);
	const int apart = image_pixels_apart(&pair.of_cpu, &pair.of_gl);
	if (apart * 1000 > WIDTH * HEIGHT)
		fail_msg("%d of %d pixels differ", apart, WIDTH * HEIGHT);
	gz_plan_free(&plan);
	pair_free(&pair);
	small_scene_free(&scene);
}

static void both_fade_values_under_light(void **state)
{
	static const double shares[] = { 0, 0.3, 0.7, 1, 0.5, 0 };
	(void)state;
	struct small_scene scene = small_scene_waves(30, 30, 30, GZ_VOXEL_U8);
	scene.rays.shading = GZ_SHADING_GRADIENT;
	scene.rays.light.occlusion = 0.9;
	scene.rays.light.occlusion_radius = 6;
	scene.rays.light.shadow_steps = 4;
	scene.rays.integration = GZ_INTEGRATION_PREINTEGRATED;
	struct pair pair = pair_of(&scene);
	for (size_t i = 0; i < sizeof shares / sizeof shares[0]; i++) {
		scene.transfer.emphasis = (struct gz_transfer_emphasis) { shares[i], 0.5, 0.7 };
		assert_int_equal(gz_raycaster_set_transfer(pair.cpu, &scene.transfer), GZ_OK);
		assert_int_equal(gz_raycaster_set_transfer(pair.gl, &scene.transfer), GZ_OK);
		check_pair(&pair, &scene, 90, 90, "fade");
	}
	pair_free(&pair);
	small_scene_free(&scene);
}

static void new_transfer_function_and_volume_replace_the_old(void **state)
{
	(void)state;
	struct small_scene scene = small_scene_waves(30, 30, 30, GZ_VOXEL_U8);
	struct small_scene other = small_scene_waves(17, 40, 21, GZ_VOXEL_F32);
	struct pair pair = pair_of(&scene);
	check_pair(&pair, &scene, 90, 90, "first");
	scene.transfer.points[1].opacity = 0.5;
	scene.transfer.points[3].rgb[0] = 0;
	assert_int_equal(gz_raycaster_set_transfer(pair.cpu, &scene.transfer), GZ_OK);
	assert_int_equal(gz_raycaster_set_transfer(pair.gl, &scene.transfer), GZ_OK);
	check_pair(&pair, &scene, 90, 90, "transfer");
	scene.transfer.emphasis = (struct gz_transfer_emphasis) { 0.7, 0.4, 0.6 };
	assert_int_equal(gz_raycaster_set_transfer(pair.cpu, &scene.transfer), GZ_OK);
	assert_int_equal(gz_raycaster_set_transfer(pair.gl, &scene.transfer), GZ_OK);
	check_pair(&pair, &scene, 90, 90, "emphasis");
	assert_int_equal(gz_raycaster_set_volume(pair.cpu, &other.volume), GZ_OK);
	assert_int_equal(gz_raycaster_set_volume(pair.gl, &other.volume), GZ_OK);
	assert_int_equal(gz_raycaster_set_transfer(pair.cpu, &other.transfer), GZ_OK);
	assert_int_equal(gz_raycaster_set_transfer(pair.gl, &other.transfer), GZ_OK);
	check_pair(&pair, &other, 90, 90, "volume");
	pair_free(&pair);
	small_scene_free(&scene);
	small_scene_free(&other);
}

static struct gz_raycaster *renderer_in(struct lent_context *lent, const struct small_scene *scene,
					const struct gz_log *log)
{
	const struct gz_backend_params params = { .gl_context = &lent->base };
	struct gz_raycaster *renderer = NULL;
	assert_int_equal(gz_raycaster_create("gl", &params, log, &renderer), GZ_OK);
	assert_int_equal(gz_raycaster_set_volume(renderer, &scene->volume), GZ_OK);
	assert_int_equal(gz_raycaster_set_transfer(renderer, &scene->transfer), GZ_OK);
	return renderer;
}

static void picture_left_on_the_device_equals_the_one_read_back(void **state)
{
	(void)state;
	struct small_scene scene = small_scene_waves(24, 24, 24, GZ_VOXEL_U8);
	struct lent_context lent = lend_context();
	struct gz_raycaster *renderer = renderer_in(&lent, &scene, NULL);
	struct gz_image image = { 0 };
	enum { WIDTH = 77, HEIGHT = 50 };
	uint8_t *pixels = calloc(WIDTH * HEIGHT, 4);
	for (int round = 0; round < 2; round++) {
		scene.rays.background[0] = round;
		small_scene_render(renderer, &scene, WIDTH, HEIGHT, &image, NULL);
		small_scene_render(renderer, &scene, WIDTH, HEIGHT, NULL, NULL);
		const unsigned texture = gz_raycaster_picture_texture(renderer);
		assert_int_not_equal(texture, 0);
		assert_int_equal(lent.egl->ops->make_current(lent.egl), GZ_OK);
		glBindTexture(GL_TEXTURE_2D, texture);
		glGetTexImage(GL_TEXTURE_2D, 0, GL_RGBA, GL_UNSIGNED_BYTE, pixels);
		assert_int_equal(glGetError(), GL_NO_ERROR);
		lent.egl->ops->release(lent.egl);
		assert_memory_equal(pixels, image.pixels, WIDTH * HEIGHT * 4);
	}
	free(pixels);
	gz_image_free(&image);
	gz_raycaster_destroy(&renderer);
	gz_gl_context_destroy(&lent.egl);
	small_scene_free(&scene);
}

static void picture_without_an_image_is_refused_by_the_cpu(void **state)
{
	(void)state;
	struct small_scene scene = small_scene_waves(8, 8, 8, GZ_VOXEL_U8);
	struct gz_raycaster *renderer = renderer_of("cpu", &scene);
	struct gz_plan plan = { 0 };
	const struct gz_display display = gz_display_default(16, 16);
	assert_int_equal(gz_plan_make(&scene.foveation, &display, scene.gaze, 16, 16, &plan),
			 GZ_OK);
	assert_int_equal(
		gz_raycaster_render(renderer, &scene.camera, &scene.rays, &plan, NULL, NULL),
		GZ_ERR_INVAL);
	assert_int_equal(gz_raycaster_picture_texture(renderer), 0);
	gz_plan_free(&plan);
	gz_raycaster_destroy(&renderer);
	small_scene_free(&scene);
}

static void lost_context_is_told_and_the_renderer_can_be_destroyed(void **state)
{
	(void)state;
	struct small_scene scene = small_scene_waves(16, 16, 16, GZ_VOXEL_U8);
	struct lent_context lent = lend_context();
	struct heard heard = { "" };
	struct gz_log log;
	gz_log_init(&log, hear, &heard, NULL);
	struct gz_raycaster *renderer = renderer_in(&lent, &scene, &log);
	struct gz_image image = { 0 };
	struct gz_plan plan = { 0 };
	const struct gz_display display = gz_display_default(16, 16);
	assert_int_equal(gz_plan_make(&scene.foveation, &display, scene.gaze, 16, 16, &plan),
			 GZ_OK);
	lent.lost = true;
	assert_int_equal(
		gz_raycaster_render(renderer, &scene.camera, &scene.rays, &plan, &image, NULL),
		GZ_ERR_NO_DEVICE);
	assert_non_null(strstr(heard.text, "context"));
	gz_raycaster_destroy(&renderer);
	gz_gl_context_destroy(&lent.egl);
	gz_plan_free(&plan);
	gz_image_free(&image);
	small_scene_free(&scene);
}

static void volume_beyond_the_texture_limit_is_shown_by_bricks_with_a_line(void **state)
{
	(void)state;
	struct small_scene scene = small_scene_waves(8, 40, 8, GZ_VOXEL_U8);
	struct heard heard = { "" };
	struct gz_log log;
	gz_log_init(&log, hear, &heard, NULL);
	const struct raycaster_params params = { .hooks.volume_edge_max = 39 };
	struct gz_raycaster *renderer = NULL;
	assert_int_equal(raycaster_with("gl", &params, &log, &renderer), GZ_OK);
	assert_int_equal(gz_raycaster_set_volume(renderer, &scene.volume), GZ_OK);
	if (!strstr(heard.text, "of 39") || !strstr(heard.text, "bricks"))
		fail_msg("'%s' names neither limit nor consequence", heard.text);
	/* and what fits is taken as before */
	struct small_scene small = small_scene_waves(8, 39, 8, GZ_VOXEL_U8);
	heard.text[0] = '\0';
	assert_int_equal(gz_raycaster_set_volume(renderer, &small.volume), GZ_OK);
	assert_string_equal(heard.text, "");
	gz_raycaster_destroy(&renderer);
	small_scene_free(&scene);
	small_scene_free(&small);
}

static void colours_beyond_the_texture_limit_are_refused_because_bricks_have_none(void **state)
{
	(void)state;
	struct small_scene scene = small_scene_coloured(8, 40, 8, GZ_COLOUR_ALPHA);
	struct small_scene small = small_scene_coloured(8, 39, 8, GZ_COLOUR_ALPHA);
	struct heard heard = { "" };
	struct gz_log log;
	gz_log_init(&log, hear, &heard, NULL);
	const struct raycaster_params params = { .hooks.volume_edge_max = 39 };
	struct gz_raycaster *renderer = NULL;
	assert_int_equal(raycaster_with("gl", &params, &log, &renderer), GZ_OK);
	assert_int_equal(gz_raycaster_set_volume(renderer, &scene.volume), GZ_ERR_UNSUPPORTED);
	if (!strstr(heard.text, "bricks hold no colours") || !strstr(heard.text, "--backend cpu"))
		fail_msg("'%s' names neither reason nor remedy", heard.text);
	assert_int_equal(gz_raycaster_set_transfer(renderer, &scene.transfer), GZ_ERR_INVAL);
	/* What fits is taken afterwards. */
	assert_int_equal(gz_raycaster_set_volume(renderer, &small.volume), GZ_OK);
	gz_raycaster_destroy(&renderer);
	small_scene_free(&scene);
	small_scene_free(&small);
}

/* What a process with another environment says of a backend: 0 and how it describes it, or 1 and
 * why not. */
static int probe(const char *backend)
{
	struct gz_log log;
	struct gz_raycaster *renderer = NULL;
	gz_log_init(&log, NULL, NULL, NULL);
	if (gz_raycaster_create(backend, NULL, &log, &renderer) != GZ_OK)
		return 1;
	fprintf(stderr, "%s: %s\n", renderer->ops->name, gz_raycaster_describe(renderer));
	gz_raycaster_destroy(&renderer);
	return 0;
}

static int run_probe(const char *environment, const char *backend, char *said, size_t size)
{
	char self[512] = "", command[1024];
	assert_true(readlink("/proc/self/exe", self, sizeof self - 1) > 0);
	snprintf(command, sizeof command, "%s '%s' test_gl --probe %s 2>&1", environment, self,
		 backend);
	FILE *out = popen(command, "r");
	assert_non_null(out);
	said[fread(said, 1, size - 1, out)] = '\0';
	return WEXITSTATUS(pclose(out));
}

static void old_or_missing_opengl_is_refused_with_reason_and_remedy(void **state)
{
	(void)state;
	static const char *const environments[][2] = {
		{ "LIBGL_ALWAYS_SOFTWARE=1 MESA_GL_VERSION_OVERRIDE=3.3", "4.3" },
		{ "__EGL_VENDOR_LIBRARY_FILENAMES=/no/such/file.json", "EGL" },
	};
	for (size_t i = 0; i < sizeof environments / sizeof environments[0]; i++) {
		char said[512];
		const int status = run_probe(environments[i][0], "gl", said, sizeof said);
		if (status != 1 || !strstr(said, environments[i][1]) ||
		    !strstr(said, "--backend cpu") || strchr(said, '\n') != strrchr(said, '\n'))
			fail_msg("%s: %d, '%s'", environments[i][0], status, said);
		assert_int_equal(run_probe(environments[i][0], "auto", said, sizeof said), 0);
		assert_non_null(strstr(said, "cpu: "));
	}
}

static void software_opengl_is_not_what_auto_takes(void **state)
{
	(void)state;
	char said[512];
	assert_int_equal(run_probe("LIBGL_ALWAYS_SOFTWARE=1", "auto", said, sizeof said), 0);
	if (!strstr(said, "cpu: ") && strstr(said, "llvmpipe"))
		fail_msg("auto took '%s'", said);
	assert_int_equal(run_probe("EGL_PLATFORM=nonsense", "gl", said, sizeof said), 0);
	assert_non_null(strstr(said, "gl: gl: "));
}

/* Made from shaders/ when the library is built. */
extern const char gz_glsl_pyramid_glsl[], gz_glsl_fill_comp[], gz_glsl_quincunx_comp[],
	gz_glsl_regions_comp[];

/* Drivers forgive what the reference compiler does not. It is asked once for all shaders, which are
 * files of a folder. */
struct shader_folder {
	char path[40];
	int count;
};

static struct shader_folder shader_folder_make(void)
{
	struct shader_folder folder = { .path = "/tmp/gazecast-shaders-XXXXXX" };
	if (system("glslangValidator --version >/dev/null 2>&1") != 0)
		skip();
	assert_non_null(mkdtemp(folder.path));
	return folder;
}

static void shader_folder_add(struct shader_folder *folder, const struct gz_gl_shader *shader)
{
	char path[64];
	const char *pieces[GZ_GL_PIECES_MAX];
	const int count = gz_gl_shader_source(shader, pieces);
	snprintf(path, sizeof path, "%s/%d.comp", folder->path, folder->count++);
	FILE *out = fopen(path, "w");
	assert_non_null(out);
	for (int i = 0; i < count; i++)
		fputs(pieces[i], out);
	assert_int_equal(fclose(out), 0);
}

static void shader_folder_check(const struct shader_folder *folder)
{
	char command[128];
	snprintf(command, sizeof command, "glslangValidator %s/*.comp", folder->path);
	assert_int_equal(system(command), 0);
	snprintf(command, sizeof command, "rm -r %s", folder->path);
	assert_int_equal(system(command), 0);
}

static void cast_shaders_are_valid_for_the_reference_compiler(void **state)
{
	(void)state;
	struct shader_folder folder = shader_folder_make();
	for (int type = 0; type < GZ_VOXEL_TYPE_COUNT; type++)
		for (int texels = 0; texels < GZ_GL_TEXELS_COUNT; texels++)
			for (int variant = 0; variant < 128; variant++) {
				/* Colours are those of bytes, and never in bricks. */
				if (variant & 32 &&
				    (type != GZ_VOXEL_U8 || texels == GZ_GL_TEXELS_BRICKS))
					continue;
				const struct gz_gl_cast_kind kind = {
					.texels = (enum gz_gl_texels)texels,
					.type = (enum gz_voxel_type)type,
					.nearest = variant & 1,
					.segments = variant & 2,
					.shaded = variant & 4,
					/* half of them, others for each type */
					.shadowed =
						(__builtin_popcount((unsigned)variant) + type) & 1,
					.fine = variant & 16,
					.coloured = variant & 32,
					.hits = variant & 64,
				};
				const struct gz_gl_device device = { .software = variant & 8 };
				char defines[GZ_GL_CAST_DEFINES_SIZE];
				const struct gz_gl_shader shader =
					gz_gl_cast_shader(kind, &device, defines);
				shader_folder_add(&folder, &shader);
			}
	shader_folder_check(&folder);
}

static void reconstruction_shaders_are_valid_for_the_reference_compiler(void **state)
{
	(void)state;
	static const char *const planes[] = { "", "#define PLANE_VALUE\n", "#define PLANE_ID\n" };
	const char *const files[][2] = {
		{ gz_glsl_pyramid_glsl, gz_glsl_fill_comp },
		{ gz_glsl_pyramid_glsl, gz_glsl_quincunx_comp },
		{ gz_glsl_regions_comp, NULL },
	};
	struct shader_folder folder = shader_folder_make();
	for (size_t plane = 0; plane < sizeof planes / sizeof planes[0]; plane++)
		for (size_t file = 0; file < sizeof files / sizeof files[0]; file++)
			for (int variant = 0; variant < 4; variant++) {
				char defines[120];
				snprintf(defines, sizeof defines, "%s%s%s", planes[plane],
					 variant & 1 ? "#define BILINEAR\n" : "",
					 variant & 2 ? "#define FETCH_IMAGES\n" : "");
				struct gz_gl_shader shader = { .stage = GZ_GL_COMPUTE,
							       .defines = defines };
				memcpy(shader.parts, gz_gl_plan_parts, sizeof gz_gl_plan_parts);
				shader.parts[GZ_GL_PLAN_PARTS] = files[file][0];
				shader.parts[GZ_GL_PLAN_PARTS + 1] = files[file][1];
				shader_folder_add(&folder, &shader);
			}
	shader_folder_check(&folder);
}

TEST_SUITE(gl)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(pictures_of_8_bit_data_equal_the_cpus_by_every_method),
		cmocka_unit_test(pictures_of_16_bit_data_equal_the_cpus_by_every_method),
		cmocka_unit_test(pictures_of_float_data_equal_the_cpus_by_every_method),
		cmocka_unit_test(pictures_of_colours_equal_the_cpus_by_every_method),
		cmocka_unit_test(
			pictures_of_colours_as_a_graphics_device_makes_them_equal_the_cpus),
		cmocka_unit_test(pre_integrated_pictures_and_levels_of_detail_equal_the_cpus),
		cmocka_unit_test(pictures_of_hidden_matter_equal_the_cpus),
		cmocka_unit_test(pictures_of_interleaved_steps_equal_the_cpus),
		cmocka_unit_test(pictures_cut_by_a_plane_equal_the_cpus),
		cmocka_unit_test(soft_shadows_equal_the_cpus),
		cmocka_unit_test(soft_shadows_as_a_graphics_device_makes_them_equal_the_cpus),
		cmocka_unit_test(pictures_from_inside_and_orthographic_equal_the_cpus),
		cmocka_unit_test(pictures_of_any_size_equal_the_cpus),
		cmocka_unit_test(jittered_pictures_of_a_shifted_plan_equal_the_cpus),
		cmocka_unit_test(both_fade_values_under_light),
		cmocka_unit_test(new_transfer_function_and_volume_replace_the_old),
		cmocka_unit_test(picture_left_on_the_device_equals_the_one_read_back),
		cmocka_unit_test(picture_without_an_image_is_refused_by_the_cpu),
		cmocka_unit_test(lost_context_is_told_and_the_renderer_can_be_destroyed),
		cmocka_unit_test(pictures_as_a_graphics_device_makes_them_equal_the_cpus),
		cmocka_unit_test(volume_beyond_the_texture_limit_is_shown_by_bricks_with_a_line),
		cmocka_unit_test(
			colours_beyond_the_texture_limit_are_refused_because_bricks_have_none),
		cmocka_unit_test(old_or_missing_opengl_is_refused_with_reason_and_remedy),
		cmocka_unit_test(software_opengl_is_not_what_auto_takes),
		cmocka_unit_test(cast_shaders_are_valid_for_the_reference_compiler),
		cmocka_unit_test(reconstruction_shaders_are_valid_for_the_reference_compiler),
	};
	if (argc == 3 && strcmp(argv[1], "--probe") == 0)
		return probe(argv[2]);
	if (probe("gl") != 0)
		return 77;
	return cmocka_run_group_tests(tests, NULL, NULL);
}
