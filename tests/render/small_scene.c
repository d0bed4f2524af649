#include "small_scene.h"

#include "render/data/voxel_colour.h"
#include "render/plan/method.h"

struct gz_foveation small_scene_foveation(void)
{
	struct gz_foveation foveation = gz_foveation_default();
	foveation.table = (struct gz_spacing_table) {
		.in_deg = true,
		.count = 3,
		.rows = { { 0, 0.01, 1 }, { 3, 0.05, 1 }, { 25, 0.4, 3 } },
	};
	return foveation;
}

/* cmocka.h wants these before it */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

static void put(struct gz_volume *volume, size_t index, double share)
{
	if (volume->type == GZ_VOXEL_U8)
		((uint8_t *)volume->voxels)[index] = (uint8_t)lround(share * 255);
	else if (volume->type == GZ_VOXEL_U16)
		((uint16_t *)volume->voxels)[index] = (uint16_t)lround(share * 60000);
	else
		((float *)volume->voxels)[index] = (float)(share * 3 - 1);
}

static struct small_scene base_scene(int nx, int ny, int nz, enum gz_voxel_type type)
{
	struct small_scene scene = {
		.volume = { .dims = { nx, ny, nz }, .spacing = { 1, 1, 1 }, .type = type },
		.camera = { .eye = { 0.8, 1.3, 0.35 },
			    .up = { 0, 0, 1 },
			    .fov_deg = 40,
			    .height = 1.2 },
		.rays = gz_ray_params_default(),
		.foveation = small_scene_foveation(),
		.gaze = { 0.5F, 0.5F },
	};
	assert_int_equal(gz_volume_allocate(&scene.volume), GZ_OK);
	return scene;
}

/* What a wave has of x and y alone: `cosine` and `sine` of the angle that z adds to. */
struct column_wave {
	double amplitude, cosine, sine, u;
};

static struct column_wave *column_waves(int nx, int ny)
{
	struct column_wave *waves = malloc((size_t)nx * (size_t)ny * sizeof *waves);
	assert_non_null(waves);
	for (int y = 0; y < ny; y++)
		for (int x = 0; x < nx; x++) {
			const double u = (x + 0.5) / nx, v = (y + 0.5) / ny;
			waves[(size_t)y * (size_t)nx + (size_t)x] =
				(struct column_wave) { sin(9 * u + 4 * v * v), cos(3 * u * v),
						       sin(3 * u * v), u };
		}
	return waves;
}

/* sin(9 u + 4 v v) cos(7 w - 3 u v) on one side of a plane, nothing on the other. */
struct small_scene small_scene_waves(int nx, int ny, int nz, enum gz_voxel_type type)
{
	struct small_scene scene = base_scene(nx, ny, nz, type);
	struct column_wave *waves = column_waves(nx, ny);
	const size_t columns = (size_t)nx * (size_t)ny;
	size_t index = 0;
	for (int z = 0; z < nz; z++) {
		const double w = (z + 0.5) / nz, cosine = cos(7 * w), sine = sin(7 * w);
		for (size_t i = 0; i < columns; i++) {
			const struct column_wave *at = &waves[i];
			const double wave = at->amplitude * (cosine * at->cosine + sine * at->sine);
			const double inside = at->u + 0.4 * w > 0.6 ? 1 : 0;
			put(&scene.volume, index++, inside * (0.5 + 0.5 * wave));
		}
	}
	free(waves);
	gz_volume_find_range(&scene.volume);
	scene.transfer = (struct gz_transfer){
		.count = 4,
		.points = {
			{ 0, { 0, 0, 0 }, 0 },
			{ 0.2, { 0.3, 0.1, 0.9 }, 0 },
			{ 0.6, { 0.8, 0.6, 0.2 }, 0.06 },
			{ 1, { 1, 1, 0.8 }, 0.3 },
		},
	};
	return scene;
}

struct small_scene small_scene_coloured(int nx, int ny, int nz, enum gz_volume_colour colour)
{
	struct small_scene scene = small_scene_waves(nx, ny, nz, GZ_VOXEL_U8);
	struct gz_volume coloured = scene.volume;
	coloured.colour = colour;
	assert_int_equal(gz_volume_allocate(&coloured), GZ_OK);
	const size_t count = gz_volume_voxel_count(&coloured);
	const uint8_t *values = scene.volume.voxels;
	memcpy(coloured.voxels, values, count);
	for (size_t i = 0; i < count; i++) {
		const double x = (double)(i % (size_t)nx) / nx;
		const double y = (double)(i / (size_t)nx % (size_t)ny) / ny;
		const double z = (double)(i / ((size_t)nx * (size_t)ny)) / nz;
		const uint8_t rgb[3] = { (uint8_t)lround(127 + 127 * sin(11 * x + 3 * z)),
					 (uint8_t)lround(127 + 127 * cos(7 * y - 5 * x)),
					 (uint8_t)lround(255 * z * (1 - y)) };
		coloured.colours[i] =
			gz_colour_pack(rgb, colour == GZ_COLOUR_ALPHA ? values[i] : 255);
	}
	gz_volume_free(&scene.volume);
	gz_volume_find_range(&coloured);
	scene.volume = coloured;
	return scene;
}

struct small_scene small_scene_constant(int edge, double opacity)
{
	struct small_scene scene = base_scene(edge, edge, edge, GZ_VOXEL_U8);
	for (size_t i = 0; i < gz_volume_voxel_count(&scene.volume); i++)
		put(&scene.volume, i, 0.5);
	gz_volume_find_range(&scene.volume);
	scene.transfer = (struct gz_transfer) {
		.count = 1,
		.points = { { 0.5, { 0.9, 0.6, 0.3 }, opacity } },
	};
	return scene;
}

struct small_scene small_scene_ball_in_hidden_matter(void)
{
	enum { EDGE = 40 };
	struct small_scene scene = base_scene(EDGE, EDGE, EDGE, GZ_VOXEL_U8);
	uint8_t *voxels = scene.volume.voxels;
	for (int z = 0; z < EDGE; z++)
		for (int y = 0; y < EDGE; y++)
			for (int x = 0; x < EDGE; x++) {
				const int u = x - 20, v = y - 20, w = z - 20;
				*voxels++ = u * u + v * v + w * w < 64 ? 120 : 60;
			}
	scene.volume.stored_min = 0;
	scene.volume.stored_max = 255;
	scene.transfer = (struct gz_transfer) {
		.count = 3,
		.points = { { 966.0 / 4095, { 0, 0, 0 }, 0 },
			    { 966.0 / 4095, { 1, 0.8, 0.3 }, 0.6 },
			    { 1, { 1, 1, 1 }, 0.6 } },
	};
	scene.foveation.method = GZ_METHOD_STANDARD;
	scene.rays.integration = GZ_INTEGRATION_PREINTEGRATED;
	return scene;
}

const char *small_scene_backend(void)
{
	const char *backend = getenv("GZ_TEST_BACKEND");
	return backend ? backend : "cpu";
}

const char *const *small_scene_simd_sets(void)
{
	static const char *const cpu[] = { "portable", "avx2", "avx512" };
	static const char *sets[4];
	size_t count = 0;
	if (sets[0])
		return sets;
	for (size_t i = 0; i < sizeof cpu / sizeof cpu[0]; i++) {
		const struct gz_backend_params params = { .threads = 1, .simd = cpu[i] };
		struct gz_raycaster *renderer = NULL;
		if (strcmp(small_scene_backend(), "cpu") == 0 &&
		    gz_raycaster_create("cpu", &params, NULL, &renderer) == GZ_OK)
			sets[count++] = cpu[i];
		gz_raycaster_destroy(&renderer);
	}
	if (!sets[0])
		sets[0] = "auto";
	return sets;
}

bool small_scene_backend_runs(void)
{
	struct gz_log log;
	struct gz_raycaster *renderer = NULL;
	gz_log_init(&log, NULL, NULL, NULL);
	const bool runs =
		gz_raycaster_create(small_scene_backend(), NULL, &log, &renderer) == GZ_OK;
	gz_raycaster_destroy(&renderer);
	return runs;
}

struct gz_raycaster *small_scene_renderer(const struct small_scene *scene, int threads,
					  const char *simd)
{
	const struct gz_backend_params params = { .threads = threads, .simd = simd };
	struct gz_raycaster *renderer = NULL;
	assert_int_equal(gz_raycaster_create(small_scene_backend(), &params, NULL, &renderer),
			 GZ_OK);
	assert_int_equal(gz_raycaster_set_volume(renderer, &scene->volume), GZ_OK);
	assert_int_equal(gz_raycaster_set_transfer(renderer, &scene->transfer), GZ_OK);
	return renderer;
}

void small_scene_render_plan(struct gz_raycaster *renderer, const struct small_scene *scene,
			     const struct gz_display *display, int width, int height,
			     struct gz_plan *plan, struct gz_image *image,
			     struct gz_frame_stats *out_stats)
{
	struct gz_plan_request request =
		gz_plan_request_make(&scene->foveation, display, scene->gaze, width, height);
	request.refines = renderer->ops->refines(renderer);
	assert_int_equal(gz_plan_update(&request, plan), GZ_OK);
	const struct gz_shot shot = {
		.camera = &scene->camera, .settings = &scene->rays, .plan = plan, .refined = plan
	};
	assert_int_equal(gz_raycaster_draw(renderer, &shot, image, out_stats), GZ_OK);
}

void small_scene_render(struct gz_raycaster *renderer, const struct small_scene *scene, int width,
			int height, struct gz_image *image, struct gz_frame_stats *out_stats)
{
	const struct gz_display display =
		scene->display.px[0] ? scene->display : gz_display_default(width, height);
	struct gz_plan plan = { 0 };
	small_scene_render_plan(renderer, scene, &display, width, height, &plan, image, out_stats);
	gz_plan_free(&plan);
}

int image_difference(const struct gz_image *a, const struct gz_image *b, int *out_x, int *out_y)
{
	int worst = 0;
	assert_int_equal(a->width, b->width);
	assert_int_equal(a->height, b->height);
	for (int i = 0; i < a->width * a->height * 4; i++) {
		const int difference = abs(a->pixels[i] - b->pixels[i]);
		if (difference > worst) {
			worst = difference;
			*out_x = i / 4 % a->width;
			*out_y = i / 4 / a->width;
		}
	}
	return worst;
}

int image_pixels_apart(const struct gz_image *a, const struct gz_image *b)
{
	int apart = 0;
	for (int i = 0; i < a->width * a->height; i++) {
		int worst = 0;
		for (int c = 0; c < 4; c++) {
			const int difference = abs(a->pixels[4 * i + c] - b->pixels[4 * i + c]);
			worst = difference > worst ? difference : worst;
		}
		apart += worst > 1;
	}
	return apart;
}

void small_scene_free(struct small_scene *scene)
{
	gz_volume_free(&scene->volume);
}

enum gz_result raycaster_with(const char *backend, const struct raycaster_params *params,
			      const struct gz_log *log, struct gz_raycaster **out_raycaster)
{
	if (strcmp(backend, "gl") == 0)
		return gz_gl_raycaster_create(&params->backend, &params->hooks, log, out_raycaster);
	return gz_raycaster_create(backend, &params->backend, log, out_raycaster);
}

void small_scene_sets_agree(struct small_scene *scene)
{
	const char *const *const sets = small_scene_simd_sets();
	for (int method = 0; method < GZ_METHOD_COUNT; method++) {
		struct gz_image first = { 0 };
		scene->foveation.method = method;
		for (size_t i = 0; sets[i]; i++) {
			struct gz_raycaster *renderer = small_scene_renderer(scene, 2, sets[i]);
			struct gz_image image = { 0 };
			int x = 0, y = 0;
			small_scene_render(renderer, scene, 317, 203, &image, NULL);
			if (i == 0)
				first = image;
			else if (image_difference(&first, &image, &x, &y) > 1)
				fail_msg("%s, %s: pixel %d %d differs", gz_method_names[method],
					 sets[i], x, y);
			if (i > 0)
				gz_image_free(&image);
			gz_raycaster_destroy(&renderer);
		}
		gz_image_free(&first);
	}
}
