/* Light on the kernels: against the oracle, and as an eye would have it. */
#include "suite.h"

#include <stddef.h>
#include <stdint.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "oracle_check.h"
#include "render/plan/method.h"

static struct small_scene lit_waves(int nx, int ny, int nz, enum gz_voxel_type type)
{
	struct small_scene scene = small_scene_waves(nx, ny, nz, type);
	scene.rays.shading = GZ_SHADING_GRADIENT;
	return scene;
}

static void look_from(struct small_scene *scene, double x, double y, double z)
{
	memcpy(scene->camera.eye, (double[3]) { x, y, z }, 3 * sizeof(double));
}

static void light_from(struct small_scene *scene, int frame, double x, double y, double z)
{
	scene->rays.light.frame = frame;
	memcpy(scene->rays.light.direction, (double[3]) { x, y, z }, 3 * sizeof(double));
}

static void shading_of_every_voxel_type_equals_the_oracle(void **state)
{
	(void)state;
	for (int type = 0; type < GZ_VOXEL_TYPE_COUNT; type++) {
		struct small_scene scene = lit_waves(30, 33, 27, (enum gz_voxel_type)type);
		oracle_check(&scene, 45, 37);
	}
}

static void shading_by_nearest_voxel_equals_the_oracle_but_on_voxel_faces(void **state)
{
	(void)state;
	for (int type = 0; type < GZ_VOXEL_TYPE_COUNT; type++) {
		struct small_scene scene = lit_waves(20, 23, 17, (enum gz_voxel_type)type);
		scene.rays.interpolation = GZ_INTERPOLATION_NEAREST;
		oracle_check_but(&scene, 45, 37, 4);
		small_scene_free(&scene);
	}
}

static void shading_by_a_light_of_the_world_equals_the_oracle(void **state)
{
	(void)state;
	static const double towards[][3] = { { 1, 0, 0 },
					     { -0.2, -3, 0.4 },
					     { 1e-3, 2e-3, -5e-3 } };
	for (size_t i = 0; i < sizeof towards / sizeof towards[0]; i++) {
		struct small_scene scene = lit_waves(24, 20, 27, GZ_VOXEL_U8);
		light_from(&scene, GZ_LIGHT_WORLD, towards[i][0], towards[i][1], towards[i][2]);
		oracle_check(&scene, 41, 37);
	}
}

static void shading_by_light_from_behind_and_from_aside_equals_the_oracle(void **state)
{
	(void)state;
	static const double towards[][3] = { { 0, 0, 1 }, { 0.1, 0.2, -1 }, { 1, 0.1, 0.05 } };
	for (size_t i = 0; i < sizeof towards / sizeof towards[0]; i++) {
		struct small_scene scene = lit_waves(24, 20, 27, GZ_VOXEL_U8);
		light_from(&scene, GZ_LIGHT_CAMERA, towards[i][0], towards[i][1], towards[i][2]);
		oracle_check(&scene, 41, 37);
	}
}

/* The rims of floor tiles go either way. */
static void surroundings_behind_and_mirrored_equal_the_oracle(void **state)
{
	(void)state;
	for (int variant = 0; variant < 8; variant++) {
		struct small_scene scene = lit_waves(24, 20, 27, GZ_VOXEL_U8);
		struct gz_environment *around = &scene.rays.environment;
		around->kind = variant & 1 ? GZ_SURROUNDINGS_SKY : GZ_SURROUNDINGS_NONE;
		around->floor = variant & 2;
		around->tile = 0.4;
		memcpy(around->up, (double[3]) { 0.3, -0.2, 0.9 }, 3 * sizeof(double));
		memcpy(scene.rays.background, (double[3]) { 0.2, 0.9, 0.4 }, 3 * sizeof(double));
		scene.rays.light.reflection = variant & 4 ? 0.3 : 0;
		light_from(&scene, GZ_LIGHT_WORLD, 0.4, 0.7, 0.5);
		oracle_check_but(&scene, 45, 37, around->floor ? 8 : 0);
		small_scene_free(&scene);
	}
}

/* Without light there are surroundings, too, and segments take in their ends. */
static void surroundings_behind_unlit_matter_equal_the_oracle(void **state)
{
	(void)state;
	struct small_scene scene = small_scene_waves(24, 20, 27, GZ_VOXEL_U16);
	scene.rays.environment.kind = GZ_SURROUNDINGS_SKY;
	scene.rays.environment.floor = false;
	scene.camera.projection = GZ_PROJECTION_ORTHOGRAPHIC;
	oracle_check(&scene, 45, 37);
}

static void shading_of_any_strength_equals_the_oracle(void **state)
{
	(void)state;
	/* ambient, diffuse, specular, shininess */
	static const double strengths[][4] = {
		{ 0, 0, 0, 1 }, { 1, 0, 0, 1 },      { 0, 1, 0, 1 },
		{ 0, 0, 1, 1 }, { 0.2, 1, 1, 1000 }, { 1, 1, 1, 8 }
	};
	for (size_t i = 0; i < sizeof strengths / sizeof strengths[0]; i++) {
		struct small_scene scene = lit_waves(24, 20, 27, GZ_VOXEL_U16);
		scene.rays.light.ambient = strengths[i][0];
		scene.rays.light.diffuse = strengths[i][1];
		scene.rays.light.specular = strengths[i][2];
		scene.rays.light.shininess = strengths[i][3];
		oracle_check(&scene, 37, 33);
	}
}

static void shading_orthographic_equals_the_oracle(void **state)
{
	(void)state;
	struct small_scene scene = lit_waves(24, 30, 18, GZ_VOXEL_U8);
	scene.camera.projection = GZ_PROJECTION_ORTHOGRAPHIC;
	oracle_check(&scene, 50, 38);
}

static void shading_along_an_axis_equals_the_oracle(void **state)
{
	(void)state;
	struct small_scene scene = lit_waves(24, 24, 24, GZ_VOXEL_U8);
	scene.camera.projection = GZ_PROJECTION_ORTHOGRAPHIC;
	look_from(&scene, 0, -2, 0);
	scene.camera.height = 1.0937; /* no ray on a voxel's face */
	oracle_check(&scene, 41, 41);
}

static void shading_from_inside_and_from_a_face_equals_the_oracle(void **state)
{
	(void)state;
	static const double eyes[][3] = { { 0.13, 0.21, 0.07 }, { 0.5, 0.03, 0.04 } };
	for (int i = 0; i < 2; i++) {
		struct small_scene scene = lit_waves(30, 30, 30, GZ_VOXEL_U8);
		look_from(&scene, eyes[i][0], eyes[i][1], eyes[i][2]);
		memcpy(scene.camera.look_at, (double[3]) { -0.3, -0.2, 0.1 }, 3 * sizeof(double));
		oracle_check(&scene, 40, 37);
	}
}

static void shading_of_anisotropic_voxels_equals_the_oracle(void **state)
{
	(void)state;
	struct small_scene scene = lit_waves(32, 32, 8, GZ_VOXEL_U8);
	scene.volume.spacing[2] = 10;
	oracle_check(&scene, 48, 40);
}

static void shading_of_flat_and_single_voxels_equals_the_oracle(void **state)
{
	(void)state;
	static const int dims[][3] = { { 1, 1, 1 },   { 1, 1, 40 },  { 40, 1, 1 },
				       { 1, 40, 40 }, { 40, 40, 1 }, { 2, 2, 2 } };
	for (size_t i = 0; i < sizeof dims / sizeof dims[0]; i++) {
		struct small_scene scene =
			lit_waves(dims[i][0], dims[i][1], dims[i][2], GZ_VOXEL_U8);
		scene.transfer.points[0].opacity = 0.2;
		oracle_check(&scene, 37, 31);
	}
}

static void shading_with_a_given_range_and_falling_slope_equals_the_oracle(void **state)
{
	(void)state;
	struct small_scene scene = lit_waves(24, 24, 24, GZ_VOXEL_U16);
	scene.volume.slope = -0.25;
	scene.volume.intercept = 9000;
	scene.transfer.has_range = true;
	scene.transfer.range[0] = -2000;
	scene.transfer.range[1] = 8000;
	oracle_check(&scene, 40, 40);
}

static void shading_with_clip_and_jitter_equals_the_oracle(void **state)
{
	(void)state;
	for (int inside = 0; inside <= 1; inside++) {
		struct small_scene scene = lit_waves(24, 24, 24, GZ_VOXEL_U8);
		memcpy(scene.rays.clip.least, (double[3]) { 0.2, 0.1, 0.2 }, 3 * sizeof(double));
		memcpy(scene.rays.clip.greatest, (double[3]) { 0.8, 0.9, 0.7 }, 3 * sizeof(double));
		scene.rays.jitter = 3;
		scene.rays.ray_sampling_rate = 0.7;
		if (inside)
			look_from(&scene, 0.07, 0.05, 0.02);
		oracle_check(&scene, 41, 37);
	}
}

static void shading_of_opaque_transparent_and_spiky_matter_equals_the_oracle(void **state)
{
	(void)state;
	struct small_scene opaque = lit_waves(20, 24, 22, GZ_VOXEL_U8);
	for (size_t i = 0; i < opaque.transfer.count; i++)
		opaque.transfer.points[i].opacity = 1;
	opaque.rays.light.occlusion = 1;
	oracle_check(&opaque, 41, 37);
	struct small_scene transparent = lit_waves(20, 24, 22, GZ_VOXEL_U8);
	for (size_t i = 0; i < transparent.transfer.count; i++)
		transparent.transfer.points[i].opacity = 0;
	transparent.rays.background[1] = 0.5;
	transparent.rays.light.occlusion = 1;
	oracle_check(&transparent, 41, 37);
	/* One entry of the table wide, at an entry, and held where data are whole numbers: voxels
	 * hit it or miss it, whatever the rounding. */
	struct small_scene spike = lit_waves(20, 24, 22, GZ_VOXEL_U8);
	spike.volume.stored_min = 0;
	spike.volume.stored_max = 255; /* entry 2184 is that of 136 */
	const double entry = 1.0 / (GZ_TRANSFER_TABLE_SIZE - 1);
	const double value = 2184 * entry;
	spike.rays.interpolation = GZ_INTERPOLATION_NEAREST;
	spike.transfer = (struct gz_transfer) {
		.count = 3,
		.points = { { value - entry, { 1, 0.5, 0.2 }, 0 },
			    { value, { 1, 0.5, 0.2 }, 1 },
			    { value + entry, { 1, 0.5, 0.2 }, 0 } },
	};
	oracle_check_but(&spike, 41, 37, 4);
	small_scene_free(&spike);
}

static void shading_with_up_along_the_view_shows_a_picture(void **state)
{
	(void)state;
	/* The camera's axes, and with them the light, are those of the axis put in its place. */
	struct small_scene scene = lit_waves(24, 20, 27, GZ_VOXEL_U8);
	struct gz_image degenerate = { 0 }, given = { 0 };
	look_from(&scene, 0, -2, 0);
	memcpy(scene.camera.up, (double[3]) { 0, 3, 0 }, 3 * sizeof(double));
	scene.foveation.method = GZ_METHOD_STANDARD;
	struct gz_raycaster *renderer = small_scene_renderer(&scene, 1, NULL);
	small_scene_render(renderer, &scene, 60, 50, &degenerate, NULL);
	memcpy(scene.camera.up, (double[3]) { 1, 0, 0 }, 3 * sizeof(double));
	small_scene_render(renderer, &scene, 60, 50, &given, NULL);
	assert_memory_equal(degenerate.pixels, given.pixels, 60 * 50 * 4);
	assert_true(degenerate.pixels[4 * (25 * 60 + 30)] > 0);
	gz_raycaster_destroy(&renderer);
	gz_image_free(&degenerate);
	gz_image_free(&given);
	small_scene_free(&scene);
}

static void shading_of_preintegrated_segments_equals_the_oracle(void **state)
{
	(void)state;
	/* smooth, so that a segment's pair of values is all there is to know of it */
	struct small_scene scene = lit_waves(30, 33, 27, GZ_VOXEL_F32);
	scene.rays.integration = GZ_INTEGRATION_PREINTEGRATED;
	scene.rays.light.occlusion = 0.7;
	oracle_check(&scene, 45, 37);
}

static void occlusion_of_every_voxel_type_equals_the_oracle(void **state)
{
	(void)state;
	for (int type = 0; type < GZ_VOXEL_TYPE_COUNT; type++) {
		struct small_scene scene = lit_waves(30, 33, 27, (enum gz_voxel_type)type);
		scene.transfer.points[2].opacity = 0.9;
		scene.rays.light.ambient = 1;
		scene.rays.light.occlusion = 1;
		oracle_check(&scene, 41, 33);
	}
}

static void occlusion_of_any_radius_equals_the_oracle(void **state)
{
	(void)state;
	static const double radii[] = { 2, 3.3, 8, 13.7 };
	for (size_t i = 0; i < sizeof radii / sizeof radii[0]; i++) {
		struct small_scene scene = lit_waves(25, 30, 27, GZ_VOXEL_U8);
		scene.transfer.points[2].opacity = 0.9;
		scene.rays.light.occlusion = 0.8;
		scene.rays.light.occlusion_radius = radii[i];
		oracle_check(&scene, 31, 33);
	}
}

static void occlusion_of_anisotropic_and_flat_volumes_equals_the_oracle(void **state)
{
	(void)state;
	struct small_scene scene = lit_waves(30, 24, 8, GZ_VOXEL_U8);
	scene.volume.spacing[2] = 3;
	scene.transfer.points[2].opacity = 0.9;
	scene.rays.light.occlusion = 1;
	oracle_check(&scene, 41, 33);
	static const int dims[][3] = { { 1, 1, 1 }, { 1, 1, 40 }, { 40, 1, 1 }, { 1, 40, 40 } };
	for (size_t i = 0; i < sizeof dims / sizeof dims[0]; i++) {
		struct small_scene flat =
			lit_waves(dims[i][0], dims[i][1], dims[i][2], GZ_VOXEL_U8);
		flat.transfer.points[0].opacity = 0.7;
		flat.rays.light.occlusion = 1;
		oracle_check(&flat, 37, 31);
	}
}

static void occlusion_with_clip_equals_the_oracle(void **state)
{
	(void)state;
	struct small_scene scene = lit_waves(25, 30, 27, GZ_VOXEL_U8);
	scene.transfer.points[2].opacity = 0.9;
	scene.rays.light.occlusion = 1;
	scene.rays.clip.least[0] = 0.4;
	scene.rays.clip.greatest[2] = 0.53;
	oracle_check(&scene, 41, 33);
}

static void occlusion_and_light_at_a_clip_plane_equal_the_oracle(void **state)
{
	(void)state;
	for (int occlusion = 0; occlusion < 2; occlusion++) {
		struct small_scene scene = lit_waves(25, 30, 27, GZ_VOXEL_U8);
		scene.transfer.points[2].opacity = 0.9;
		scene.rays.light.occlusion = occlusion;
		scene.rays.clip.plane = true;
		memcpy(scene.rays.clip.normal, (double[3]) { -0.3, -0.8, 0.5 }, 3 * sizeof(double));
		scene.rays.clip.offset = 0.45;
		oracle_check(&scene, 41, 33);
	}
}

/* A solid ball, or what else a function of the place says is inside. */
static struct small_scene solid(double (*share)(double x, double y, double z))
{
	enum { EDGE = 64 };
	struct small_scene scene = small_scene_constant(EDGE, 0);
	uint8_t *voxels = scene.volume.voxels;
	for (int z = 0; z < EDGE; z++)
		for (int y = 0; y < EDGE; y++)
			for (int x = 0; x < EDGE; x++)
				*voxels++ = (uint8_t)lround(255 * share(x + 0.5 - EDGE / 2.0,
									y + 0.5 - EDGE / 2.0,
									z + 0.5 - EDGE / 2.0));
	scene.volume.stored_min = 0;
	scene.volume.stored_max = 255;
	scene.transfer = (struct gz_transfer) {
		.count = 2,
		.points = { { 0.45, { 0.8, 0.8, 0.8 }, 0 }, { 0.5, { 0.8, 0.8, 0.8 }, 0.98 } },
	};
	scene.camera.projection = GZ_PROJECTION_ORTHOGRAPHIC;
	look_from(&scene, 0, -2, 0);
	scene.camera.height = 1.03;
	scene.rays.shading = GZ_SHADING_GRADIENT;
	scene.rays.ray_sampling_rate = 4;
	scene.foveation.method = GZ_METHOD_STANDARD;
	return scene;
}

static double within(double inside)
{
	return fmin(fmax(0.5 + inside / 3, 0), 1);
}

static double ball(double x, double y, double z)
{
	return within(22 - sqrt(x * x + y * y + z * z));
}

/* Two walls that meet at a right angle along z, open to the front. */
static double corner(double x, double y, double z)
{
	(void)z;
	return within(fmax(x + y, y - x) / M_SQRT2);
}

enum { SIDE = 96 };

static void render(struct small_scene *scene, struct gz_image *image)
{
	struct gz_raycaster *renderer = small_scene_renderer(scene, 2, NULL);
	small_scene_render(renderer, scene, SIDE, SIDE, image, NULL);
	gz_raycaster_destroy(&renderer);
}

static int grey(const struct gz_image *image, int x, int y)
{
	return image->pixels[4 * (y * image->width + x)];
}

static void ball_is_as_bright_as_its_angle_to_the_light(void **state)
{
	(void)state;
	struct small_scene scene = solid(ball);
	struct gz_image image = { 0 };
	light_from(&scene, GZ_LIGHT_CAMERA, 1, 0, 1);
	scene.rays.light.ambient = 0;
	scene.rays.light.diffuse = 1;
	scene.rays.light.specular = 0;
	render(&scene, &image);
	const double radius = 22.0 / 64 * SIDE / 1.03;
	for (int x = 0; x < SIDE; x++) {
		const double u = (x + 0.5 - SIDE / 2.0) / radius;
		/* near the rim the picture is of what lies behind it */
		if (fabs(u) > 0.93)
			continue;
		const double expected = 204 * fmax(0, (u + sqrt(1 - u * u)) / M_SQRT2);
		const int found = grey(&image, x, SIDE / 2);
		if (fabs(found - expected) > 6)
			fail_msg("at %.2f of the radius: %d, not %.1f", u, found, expected);
	}
	gz_image_free(&image);
	small_scene_free(&scene);
}

static void inside_of_a_ball_is_lit_as_its_outside(void **state)
{
	(void)state;
	struct small_scene scene = solid(ball);
	struct gz_image image = { 0 };
	light_from(&scene, GZ_LIGHT_CAMERA, 0, 0, 1);
	scene.rays.light = (struct gz_light) {
		.direction = { 0, 0, 1 },
		.diffuse = 1,
		.shininess = 1,
		.occlusion_radius = 8,
		.shadow_reach = 4,
	};
	/* cut open: what is left of it is a bowl, thin as a wall */
	scene.transfer = (struct gz_transfer) {
		.count = 4,
		.points = { { 0.1, { 0.8, 0.8, 0.8 }, 0 },
			    { 0.3, { 0.8, 0.8, 0.8 }, 0.98 },
			    { 0.7, { 0.8, 0.8, 0.8 }, 0.98 },
			    { 0.9, { 0.8, 0.8, 0.8 }, 0 } },
	};
	scene.rays.clip.least[1] = 0.5;
	render(&scene, &image);
	const int middle = grey(&image, SIDE / 2, SIDE / 2);
	assert_in_range(middle, 195, 204);
	gz_image_free(&image);
	small_scene_free(&scene);
}

static void even_matter_keeps_its_colour(void **state)
{
	(void)state;
	struct small_scene scene = small_scene_constant(24, 0.3);
	struct gz_image plain = { 0 }, lit = { 0 };
	scene.foveation.method = GZ_METHOD_STANDARD;
	render(&scene, &plain);
	scene.rays.shading = GZ_SHADING_GRADIENT;
	render(&scene, &lit);
	assert_memory_equal(plain.pixels, lit.pixels, SIDE * SIDE * 4);
	gz_image_free(&plain);
	gz_image_free(&lit);
	small_scene_free(&scene);
}

static void occlusion_darkens_a_corner_and_leaves_walls(void **state)
{
	(void)state;
	struct small_scene scene = solid(corner);
	struct gz_image image = { 0 };
	scene.rays.light.ambient = 1;
	scene.rays.light.diffuse = 0;
	scene.rays.light.specular = 0;
	scene.rays.light.occlusion = 1;
	render(&scene, &image);
	/* the walls are seen at 45 degrees; in the corner three quarters of what is around is
	 * filled, so half of the light is kept away there, and of the walls next to none */
	const int edge = grey(&image, SIDE / 2, SIDE / 2), wall = grey(&image, SIDE / 5, SIDE / 2);
	assert_in_range(edge, 70, 125);
	assert_in_range(wall, 175, 204);
	gz_image_free(&image);
	small_scene_free(&scene);
}

static void shading_is_the_same_bits_for_any_number_of_threads(void **state)
{
	(void)state;
	struct small_scene scene = lit_waves(50, 41, 60, GZ_VOXEL_U8);
	scene.rays.light.occlusion = 1;
	scene.rays.jitter = 1;
	scene.transfer.points[2].opacity = 0.9;
	for (int method = 0; method < GZ_METHOD_COUNT; method++) {
		struct gz_image first = { 0 };
		scene.foveation.method = method;
		for (int threads = 1; threads <= 5; threads += 2) {
			struct gz_raycaster *renderer = small_scene_renderer(&scene, threads, NULL);
			struct gz_image image = { 0 };
			small_scene_render(renderer, &scene, 171, 103, &image, NULL);
			if (threads == 1) {
				first = image;
			} else {
				assert_memory_equal(first.pixels, image.pixels, 171 * 103 * 4);
				gz_image_free(&image);
			}
			gz_raycaster_destroy(&renderer);
		}
		gz_image_free(&first);
	}
	small_scene_free(&scene);
}

/* Rays of coarse tiles have other neighbours than those of fine ones. */
static void lit_rays_have_the_same_colour_in_tiles_of_any_spacing(void **state)
{
	(void)state;
	enum { EDGE = 96 };
	for (int type = 0; type < GZ_VOXEL_TYPE_COUNT; type++) {
		struct small_scene scene = lit_waves(12, 14, 13, (enum gz_voxel_type)type);
		struct gz_raycaster *renderer = small_scene_renderer(&scene, 1, NULL);
		struct gz_image full = { 0 }, coarse = { 0 };
		scene.foveation.method = GZ_METHOD_STANDARD;
		small_scene_render(renderer, &scene, EDGE, EDGE, &full, NULL);
		scene.foveation.method = GZ_METHOD_UNIFORM;
		scene.foveation.uniform_spacing = 3;
		small_scene_render(renderer, &scene, EDGE, EDGE, &coarse, NULL);
		for (int y = 0; y < EDGE; y += 3)
			for (int x = 0; x < EDGE; x += 3) {
				const int at = 4 * (y * EDGE + x);
				if (memcmp(full.pixels + at, coarse.pixels + at, 4) != 0)
					fail_msg("type %d, pixel %d %d: %d %d %d, in a coarse tile "
						 "%d %d %d",
						 type, x, y, full.pixels[at], full.pixels[at + 1],
						 full.pixels[at + 2], coarse.pixels[at],
						 coarse.pixels[at + 1], coarse.pixels[at + 2]);
			}
		gz_image_free(&full);
		gz_image_free(&coarse);
		gz_raycaster_destroy(&renderer);
		small_scene_free(&scene);
	}
}

static void light_without_direction_or_beyond_its_range_is_refused(void **state)
{
	(void)state;
	struct gz_ray_params rays = gz_ray_params_default();
	memset(rays.light.direction, 0, sizeof rays.light.direction);
	assert_false(gz_ray_params_valid(&rays));
	rays = gz_ray_params_default();
	rays.light.direction[1] = NAN;
	assert_false(gz_ray_params_valid(&rays));
	rays = gz_ray_params_default();
	rays.light.shininess = 0.5;
	assert_false(gz_ray_params_valid(&rays));
	rays = gz_ray_params_default();
	rays.light.occlusion_radius = 1;
	assert_false(gz_ray_params_valid(&rays));
	rays = gz_ray_params_default();
	rays.light.ambient = 1.5;
	assert_false(gz_ray_params_valid(&rays));
}

/* Check where the viewer sees the light. */
static void assert_light_seen(const struct gz_light *light, const struct gz_ray_frame *rays,
			      const double expected[3])
{
	double seen[3];
	gz_light_seen(light, rays, seen);
	for (int i = 0; i < 3; i++)
		if (fabs(seen[i] - expected[i]) > 2e-5)
			fail_msg("seen at %g %g %g, not %g %g %g", seen[0], seen[1], seen[2],
				 expected[0], expected[1], expected[2]);
}

static void light_turns_as_the_viewer_sees_it_in_both_frames(void **state)
{
	(void)state;
	static const double front[3] = { 0, 0, 1 }, right[3] = { 1, 0, 0 }, down[3] = { 0, -1, 0 },
			    behind[3] = { 0, 0, -1 };
	for (int frame = GZ_LIGHT_CAMERA; frame <= GZ_LIGHT_WORLD; frame++) {
		struct small_scene scene = lit_waves(8, 8, 8, GZ_VOXEL_U8);
		struct gz_ray_frame rays;
		struct gz_light *light = &scene.rays.light;
		look_from(&scene, 2, -3, 1);
		assert_int_equal(gz_camera_rays(&scene.camera, 40, 30, &rays), GZ_OK);
		/* Towards the eye. */
		light_from(&scene, frame, frame == GZ_LIGHT_WORLD ? 2 : 0,
			   frame == GZ_LIGHT_WORLD ? -3 : 0, 1);
		assert_light_seen(light, &rays, front);
		gz_light_turn(light, &rays, 90, 0);
		assert_light_seen(light, &rays, right);
		gz_light_turn(light, &rays, -90, 0);
		gz_light_turn(light, &rays, 0, 90);
		assert_light_seen(light, &rays, down);
		gz_light_turn(light, &rays, 0, 90);
		assert_light_seen(light, &rays, behind);
		assert_int_equal(light->frame, frame);
		small_scene_free(&scene);
	}
}

TEST_SUITE(shading)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(shading_of_every_voxel_type_equals_the_oracle),
		cmocka_unit_test(light_turns_as_the_viewer_sees_it_in_both_frames),
		cmocka_unit_test(shading_by_nearest_voxel_equals_the_oracle_but_on_voxel_faces),
		cmocka_unit_test(shading_by_a_light_of_the_world_equals_the_oracle),
		cmocka_unit_test(shading_by_light_from_behind_and_from_aside_equals_the_oracle),
		cmocka_unit_test(shading_of_any_strength_equals_the_oracle),
		cmocka_unit_test(shading_orthographic_equals_the_oracle),
		cmocka_unit_test(shading_along_an_axis_equals_the_oracle),
		cmocka_unit_test(shading_from_inside_and_from_a_face_equals_the_oracle),
		cmocka_unit_test(shading_of_anisotropic_voxels_equals_the_oracle),
		cmocka_unit_test(shading_of_flat_and_single_voxels_equals_the_oracle),
		cmocka_unit_test(shading_with_a_given_range_and_falling_slope_equals_the_oracle),
		cmocka_unit_test(shading_with_clip_and_jitter_equals_the_oracle),
		cmocka_unit_test(shading_of_opaque_transparent_and_spiky_matter_equals_the_oracle),
		cmocka_unit_test(shading_with_up_along_the_view_shows_a_picture),
		cmocka_unit_test(shading_of_preintegrated_segments_equals_the_oracle),
		cmocka_unit_test(occlusion_of_every_voxel_type_equals_the_oracle),
		cmocka_unit_test(occlusion_of_any_radius_equals_the_oracle),
		cmocka_unit_test(occlusion_of_anisotropic_and_flat_volumes_equals_the_oracle),
		cmocka_unit_test(occlusion_with_clip_equals_the_oracle),
		cmocka_unit_test(occlusion_and_light_at_a_clip_plane_equal_the_oracle),
		cmocka_unit_test(ball_is_as_bright_as_its_angle_to_the_light),
		cmocka_unit_test(inside_of_a_ball_is_lit_as_its_outside),
		cmocka_unit_test(even_matter_keeps_its_colour),
		cmocka_unit_test(occlusion_darkens_a_corner_and_leaves_walls),
		cmocka_unit_test(surroundings_behind_and_mirrored_equal_the_oracle),
		cmocka_unit_test(surroundings_behind_unlit_matter_equal_the_oracle),
		cmocka_unit_test(shading_is_the_same_bits_for_any_number_of_threads),
		cmocka_unit_test(lit_rays_have_the_same_colour_in_tiles_of_any_spacing),
		cmocka_unit_test(light_without_direction_or_beyond_its_range_is_refused),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
