/* Surfaces by triangles look as they do by rays, whatever the plan. */
#include "suite.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <GL/glew.h>

#include "base/captured_log.h"
#include "lent_context.h"
#include "mesh_fields.h"
#include "render/layers/gl_layers.h"
#include "render/mesh/isosurface.h"
#include "render/plan/method.h"
#include "render/surface/cpu/surface_caster.h"
#include "render/surface/gl/raster_clusters.h"
#include "render/surface/gl/raster_programs.h"
#include "render/surface/gl/surface_raster.h"
#include "render/surface/isosurface_technique.h"
#include "shader_check.h"
#include "volume_files.h"

enum { WIDTH = 100, HEIGHT = 76, PIXELS = WIDTH * HEIGHT };

static const double EVEN[3] = { 1, 1, 1 };
static const int DIMS[3] = { 48, 48, 48 };

/* One for all tests: its shaders are compiled once. */
static struct gz_surface_raster *raster;

/* What a test draws, and what it gets. */
struct stage {
	struct gz_camera camera;
	struct gz_ray_params rays;
	struct gz_foveation foveation;
	struct gz_point gaze;
	struct gz_plan plan;
	struct gz_image image;
	struct gz_plane depth, ids;
	struct gz_frame_stats stats;
};

static struct stage new_stage(void)
{
	struct stage stage = {
		.camera = { .eye = { 0.9, -1.4, 0.7 },
			    .up = { 0, 0, 1 },
			    .fov_deg = 35,
			    .height = 1.2 },
		.rays = gz_ray_params_default(),
		.foveation = gz_foveation_full(),
		.gaze = { 0.4F, 0.55F },
	};
	stage.rays.background[1] = 0.3;
	return stage;
}

static void free_stage(struct stage *stage)
{
	gz_plan_free(&stage->plan);
	gz_image_free(&stage->image);
	gz_plane_free(&stage->depth);
	gz_plane_free(&stage->ids);
}

static struct gz_surface_shot shot_of(struct stage *stage)
{
	const struct gz_display display = gz_display_default(WIDTH, HEIGHT);
	assert_int_equal(
		gz_plan_make(&stage->foveation, &display, stage->gaze, WIDTH, HEIGHT, &stage->plan),
		GZ_OK);
	return (struct gz_surface_shot) {
		.camera = &stage->camera,
		.rays = &stage->rays,
		.plan = &stage->plan,
	};
}

static void draw_triangles(struct stage *stage)
{
	const struct gz_surface_shot shot = shot_of(stage);
	const struct gz_surface_planes planes = { &stage->depth, &stage->ids };
	assert_int_equal(
		gz_surface_raster_draw(raster, &shot, &stage->image, &planes, &stage->stats),
		GZ_OK);
}

/* Show the objects, none of which has been shown before: volumes of several tests may lie in one
 * place. */
static void show_objects(const struct gz_object *objects, size_t count)
{
	static uint64_t revision;
	struct gz_object fresh[2];
	assert_in_range(count, 1, 2);
	memcpy(fresh, objects, count * sizeof *objects);
	revision++;
	for (size_t i = 0; i < count; i++)
		fresh[i].data_revision = revision;
	assert_int_equal(gz_surface_raster_show(raster, fresh, count), GZ_OK);
}

static void show_volume(const struct gz_volume *volume)
{
	const struct gz_object object = { .id = 7, .volume = volume };
	show_objects(&object, 1);
}

/* The same by rays. */
static struct stage draw_rays(const struct stage *stage, const struct gz_object *objects,
			      size_t count)
{
	struct stage by_rays = *stage;
	struct gz_surface_caster *caster = NULL;
	memset(&by_rays.plan, 0, sizeof by_rays.plan);
	memset(&by_rays.image, 0, sizeof by_rays.image);
	memset(&by_rays.depth, 0, sizeof by_rays.depth);
	memset(&by_rays.ids, 0, sizeof by_rays.ids);
	const struct gz_surface_shot shot = shot_of(&by_rays);
	const struct gz_surface_planes planes = { &by_rays.depth, &by_rays.ids };
	assert_int_equal(gz_surface_caster_create(NULL, NULL, &caster), GZ_OK);
	assert_int_equal(gz_surface_caster_show(caster, objects, count), GZ_OK);
	assert_int_equal(
		gz_surface_caster_draw(caster, &shot, &by_rays.image, &planes, &by_rays.stats),
		GZ_OK);
	gz_surface_caster_destroy(&caster);
	return by_rays;
}

/* Whether a word is at a pixel or beside it. */
static bool is_near(const uint32_t *words, int at, uint32_t word)
{
	const int x = at % WIDTH, y = at / WIDTH;
	for (int dy = -1; dy <= 1; dy++)
		for (int dx = -1; dx <= 1; dx++)
			if (x + dx >= 0 && x + dx < WIDTH && y + dy >= 0 && y + dy < HEIGHT &&
			    words[at + dy * WIDTH + dx] == word)
				return true;
	return false;
}

static int levels_apart(const struct gz_image *a, const struct gz_image *b, int pixel)
{
	int most = 0;
	for (int i = 4 * pixel; i < 4 * pixel + 3; i++) {
		const int apart = abs(a->pixels[i] - b->pixels[i]);
		most = apart > most ? apart : most;
	}
	return most;
}

/* How two pictures of every pixel differ. */
struct differences {
	int far;     /* objects that the other picture does not have within a pixel */
	int rim;     /* pixels of different objects */
	int colours; /* of one object, more than 2 levels apart */
	int depths;  /* of one object, more than a thousandth of the volume apart */
	int drawn;   /* pixels of objects */
};

static struct differences compare(const struct stage *a, const struct stage *b)
{
	struct differences found = { 0 };
	for (int i = 0; i < PIXELS; i++) {
		const uint32_t id = a->ids.words[i];
		found.drawn += id != 0;
		if (id != b->ids.words[i]) {
			found.rim++;
			found.far += !is_near(b->ids.words, i, id) ||
				     !is_near(a->ids.words, i, b->ids.words[i]);
			continue;
		}
		found.colours += levels_apart(&a->image, &b->image, i) > 2;
		const float nearer = gz_plane_value(&a->depth, i % WIDTH, i / WIDTH);
		const float farther = gz_plane_value(&b->depth, i % WIDTH, i / WIDTH);
		assert_int_equal(isfinite(nearer), id != 0);
		assert_int_equal(isfinite(farther), id != 0);
		found.depths += id != 0 && fabsf(nearer - farther) > 1e-3F;
	}
	return found;
}

/* Draw objects both ways. A few pixels of rims go either way, and where a rim is turned away from
 * the eye, the pixel beside it shows what lies behind. */
static void check_same(struct stage *stage, const struct gz_object *objects, size_t count,
		       const char *what)
{
	if (!gz_surface_caster_present())
		return;
	show_objects(objects, count);
	draw_triangles(stage);
	struct stage by_rays = draw_rays(stage, objects, count);
	const struct differences found = compare(stage, &by_rays);
	if (found.far > 0 || found.rim > PIXELS / 500 || found.colours > PIXELS / 500 ||
	    found.depths > PIXELS / 500 || found.drawn < PIXELS / 20)
		fail_msg("%s: of %d pixels %d have another object, %d of them farther than a "
			 "pixel; %d colours and %d depths differ",
			 what, found.drawn, found.rim, found.far, found.colours, found.depths);
	free_stage(&by_rays);
}

static void formula_looks_as_by_rays(field_formula *formula, const char *what)
{
	struct gz_volume volume = field_volume(formula, DIMS, EVEN, GZ_VOXEL_F32);
	const struct gz_object object = { .id = 7, .volume = &volume };
	struct stage stage = new_stage();
	check_same(&stage, &object, 1, what);
	stage.camera.projection = GZ_PROJECTION_ORTHOGRAPHIC;
	check_same(&stage, &object, 1, what);
	free_stage(&stage);
	gz_volume_free(&volume);
}

static void ball_and_ring_look_as_by_rays_in_both_projections(void **state)
{
	(void)state;
	formula_looks_as_by_rays(field_ball, "ball");
	formula_looks_as_by_rays(field_ring, "ring");
}

static void several_objects_hide_each_other_as_by_rays(void **state)
{
	(void)state;
	struct gz_volume ball = field_volume(field_ball, DIMS, EVEN, GZ_VOXEL_F32);
	struct gz_volume ring = field_volume(field_ring, DIMS, EVEN, GZ_VOXEL_F32);
	const struct gz_isosurface_request request = { .volume = &ring, .isovalue = 2 };
	struct gz_mesh mesh;
	assert_int_equal(gz_isosurface_make(&request, NULL, NULL, &mesh), GZ_OK);
	static const float green[3] = { 0.1F, 0.9F, 0.2F };
	const struct gz_object objects[2] = {
		{ .id = 3, .volume = &ball },
		{ .id = 500, .volume = &ball, .mesh = &mesh, .colour = green },
	};
	struct stage stage = new_stage();
	stage.rays.surface.isovalue = 4;
	check_same(&stage, objects, 2, "ball and ring");
	free_stage(&stage);
	gz_mesh_free(&mesh);
	gz_volume_free(&ball);
	gz_volume_free(&ring);
}

/* What is cut is open: its inside shows, lit alike. */
static void clip_box_cuts_as_it_cuts_rays(void **state)
{
	(void)state;
	struct gz_volume volume = field_volume(field_ball, DIMS, EVEN, GZ_VOXEL_F32);
	const struct gz_object object = { .id = 7, .volume = &volume };
	struct stage stage = new_stage();
	memcpy(stage.rays.clip.least, (double[3]) { 0.1, 0.5, 0.2 }, sizeof(double[3]));
	memcpy(stage.rays.clip.greatest, (double[3]) { 0.6, 1, 0.7 }, sizeof(double[3]));
	check_same(&stage, &object, 1, "clipped ball");
	free_stage(&stage);
	gz_volume_free(&volume);
}

/* Shadows and all: what is cut off casts none. */
static void clip_plane_cuts_as_it_cuts_rays(void **state)
{
	(void)state;
	struct gz_volume volume = field_volume(field_ball, DIMS, EVEN, GZ_VOXEL_F32);
	const struct gz_object object = { .id = 7, .volume = &volume };
	struct stage stage = new_stage();
	stage.rays.clip.plane = true;
	memcpy(stage.rays.clip.normal, (double[3]) { 0.5, -0.6, 0.6 }, sizeof(double[3]));
	stage.rays.clip.offset = 0.55;
	check_same(&stage, &object, 1, "ball cut by a plane");
	stage.rays.clip.least[2] = 0.3;
	check_same(&stage, &object, 1, "ball cut by a plane and the clip box");
	free_stage(&stage);
	gz_volume_free(&volume);
}

static void surface_around_the_eye_looks_as_by_rays(void **state)
{
	(void)state;
	struct gz_volume volume = field_volume(field_ring, DIMS, EVEN, GZ_VOXEL_F32);
	const struct gz_object object = { .id = 7, .volume = &volume };
	struct stage stage = new_stage();
	memcpy(stage.camera.eye, (double[3]) { 0.38, 0, 0.02 }, sizeof stage.camera.eye);
	memcpy(stage.camera.look_at, (double[3]) { 0.3, 1, 0 }, sizeof stage.camera.look_at);
	check_same(&stage, &object, 1, "from within");
	free_stage(&stage);
	gz_volume_free(&volume);
}

/* Glass of one reflection and one refraction is that of rays which end after one surface. */
static void glass_over_a_floor_looks_as_by_rays_of_one_bounce(void **state)
{
	(void)state;
	struct gz_volume volume = field_volume(field_ball, DIMS, EVEN, GZ_VOXEL_F32);
	const struct gz_object object = { .id = 7, .volume = &volume };
	struct stage stage = new_stage();
	stage.rays.surface.material = GZ_MATERIAL_GLASS;
	stage.rays.surface.bounces = 1;
	stage.rays.environment.kind = GZ_SURROUNDINGS_SKY;
	stage.rays.environment.floor = false;
	check_same(&stage, &object, 1, "glass under a sky");
	stage.rays.environment.floor = true;
	stage.rays.environment.tile = 0.8;
	check_same(&stage, &object, 1, "glass over a floor");
	stage.rays.surface.material = GZ_MATERIAL_MATTE;
	check_same(&stage, &object, 1, "matter over a floor");
	stage.rays.light.reflection = 0.3;
	check_same(&stage, &object, 1, "matter that mirrors a floor");
	stage.rays.surface.material = GZ_MATERIAL_GLASS;
	stage.rays.environment.kind = GZ_SURROUNDINGS_NONE;
	check_same(&stage, &object, 1, "glass without a sky");
	free_stage(&stage);
	gz_volume_free(&volume);
}

/* Six pictures of noise in a folder of the test. */
static void write_cube(void)
{
	static const char *const names[] = { "right", "left", "front", "back", "up", "down" };
	uint32_t seed = 5;
	for (int face = 0; face < 6; face++) {
		char path[300];
		struct gz_image image = { 0 };
		assert_int_equal(gz_image_resize(&image, 8, 8), GZ_OK);
		for (int i = 0; i < 4 * 8 * 8; i++)
			image.pixels[i] = i % 4 == 3 ? 255 : (uint8_t)(255 * field_random(&seed));
		snprintf(path, sizeof path, "%s/%s.png", files_folder(), names[face]);
		assert_int_equal(gz_image_write_png(&image, path, NULL), GZ_OK);
		gz_image_free(&image);
	}
}

static void six_pictures_around_look_as_by_rays(void **state)
{
	(void)state;
	struct gz_volume volume = field_volume(field_ball, DIMS, EVEN, GZ_VOXEL_F32);
	const struct gz_object object = { .id = 7, .volume = &volume };
	struct stage stage = new_stage();
	struct gz_environment *environment = &stage.rays.environment;
	write_cube();
	environment->kind = GZ_SURROUNDINGS_CUBE;
	check_same(&stage, &object, 1, "pictures without their folder");
	snprintf(environment->cube_path, sizeof environment->cube_path, "%s", files_folder());
	stage.rays.surface.material = GZ_MATERIAL_GLASS;
	stage.rays.surface.bounces = 1;
	stage.camera.fov_deg = 130; /* several faces are in view */
	memcpy(stage.camera.eye, (double[3]) { 0.3, -0.6, 0.3 }, sizeof stage.camera.eye);
	check_same(&stage, &object, 1, "six pictures");
	memcpy(environment->up, (double[3]) { 1, -2, 0.4 }, sizeof environment->up);
	stage.camera.eye[1] = 0.6;
	check_same(&stage, &object, 1, "six pictures, turned");
	free_stage(&stage);
	gz_volume_free(&volume);
}

/* A ball above a plate. */
static double field_ball_above_plate(const double place[3])
{
	const double *p = place;
	const double ball = 8 - sqrt(p[0] * p[0] + p[1] * p[1] + (p[2] - 4) * (p[2] - 4));
	const double plate = fmin(-12 - p[2], p[2] + 20);
	return fmax(ball, fmin(plate, 21 - fmax(fabs(p[0]), fabs(p[1]))));
}

/* Whether the shadows of rays are the same two pixels around. */
static bool is_far_from_rims(const struct stage *dark, const struct stage *lit, int pixel)
{
	const int x = pixel % WIDTH, y = pixel / WIDTH;
	const bool shadow = levels_apart(&dark->image, &lit->image, pixel) > 2;
	for (int dy = -2; dy <= 2; dy++)
		for (int dx = -2; dx <= 2; dx++) {
			const int other = pixel + dy * WIDTH + dx;
			if (x + dx < 0 || x + dx >= WIDTH || y + dy < 0 || y + dy >= HEIGHT)
				continue;
			if (dark->ids.words[other] != dark->ids.words[pixel] ||
			    (levels_apart(&dark->image, &lit->image, other) > 2) != shadow)
				return false;
		}
	return true;
}

/* Neither spots on what the light sees, nor light in shadows. */
static void shadows_are_those_of_rays_but_at_their_rims(void **state)
{
	(void)state;
	static const double directions[][3] = { { 0, 0, 1 },
						{ 0.5, -0.2, 0.8 },
						{ -0.6, 0.2, 0.4 } };
	struct gz_volume volume = field_volume(field_ball_above_plate, DIMS, EVEN, GZ_VOXEL_F32);
	const struct gz_object object = { .id = 7, .volume = &volume };
	struct stage stage = new_stage();
	if (!gz_surface_caster_present())
		skip();
	show_volume(&volume);
	for (size_t i = 0; i < sizeof directions / sizeof directions[0]; i++) {
		int shadowed = 0, compared = 0, apart = 0;
		stage.rays.light.frame = GZ_LIGHT_WORLD;
		memcpy(stage.rays.light.direction, directions[i], sizeof directions[i]);
		stage.rays.surface.shadows = false;
		struct stage lit = draw_rays(&stage, &object, 1);
		stage.rays.surface.shadows = true;
		struct stage dark = draw_rays(&stage, &object, 1);
		draw_triangles(&stage);
		for (int pixel = 0; pixel < PIXELS; pixel++) {
			if (stage.ids.words[pixel] != dark.ids.words[pixel] ||
			    !is_far_from_rims(&dark, &lit, pixel))
				continue;
			compared++;
			shadowed += levels_apart(&dark.image, &lit.image, pixel) > 2;
			apart += levels_apart(&dark.image, &stage.image, pixel) > 4;
		}
		if (compared < PIXELS / 2 || shadowed < 20 || apart > compared / 500)
			fail_msg("light %zu: %d of %d pixels differ, %d in shadow", i, apart,
				 compared, shadowed);
		free_stage(&lit);
		free_stage(&dark);
	}
	free_stage(&stage);
	gz_volume_free(&volume);
}

/* The solid rectangle of the finest layer. */
static bool is_in_fovea(const struct gz_plan *plan, int pixel)
{
	struct gz_raster_layer layers[GZ_PLAN_RECTANGLES_MAX];
	const struct gz_raster_layer *finest = &layers[gz_raster_layers_make(plan, layers) - 1];
	const int x = pixel % WIDTH, y = pixel / WIDTH;
	return finest->spacing == 1 && x >= finest->solid[0][0] && x < finest->solid[1][0] &&
	       y >= finest->solid[0][1] && y < finest->solid[1][1];
}

static void foveated_picture_is_full_at_the_gaze_and_has_no_holes(void **state)
{
	(void)state;
	static const int methods[] = { GZ_METHOD_ACUITY, GZ_METHOD_MDC, GZ_METHOD_MDC3 };
	struct gz_volume volume = field_volume(field_ring, DIMS, EVEN, GZ_VOXEL_U16);
	struct stage full = new_stage(), foveated = new_stage();
	full.rays.surface.shadows = foveated.rays.surface.shadows = true;
	foveated.foveation.acuity_slope = 0.4; /* so that a small picture has coarse places */
	foveated.foveation.mdc_square_px = 24;
	foveated.foveation.mdc3_square_px = 60;
	show_volume(&volume);
	draw_triangles(&full);
	assert_int_equal(full.stats.rays, PIXELS);
	for (size_t i = 0; i < sizeof methods / sizeof methods[0]; i++) {
		int sharp = 0, apart = 0, others = 0;
		foveated.foveation.method = methods[i];
		draw_triangles(&foveated);
		assert_in_range(foveated.stats.rays, 1, PIXELS * 2 / 3);
		for (int pixel = 0; pixel < PIXELS; pixel++) {
			const bool same_object = full.ids.words[pixel] == foveated.ids.words[pixel];
			others += !same_object;
			if (!is_in_fovea(&foveated.plan, pixel))
				continue;
			sharp++;
			apart += !same_object ||
				 levels_apart(&full.image, &foveated.image, pixel) > 1;
		}
		/* A triangle's edge through the middle of a pixel goes either way. */
		if (sharp < 100 || apart > sharp / 500 || others > PIXELS / 10)
			fail_msg("%s: %d of %d sharp pixels differ, and %d objects",
				 gz_method_names[methods[i]], apart, sharp, others);
	}
	free_stage(&full);
	free_stage(&foveated);
	gz_volume_free(&volume);
}

static void nothing_in_view_leaves_the_background(void **state)
{
	(void)state;
	struct gz_volume volume = field_volume(field_ball, DIMS, EVEN, GZ_VOXEL_F32);
	show_volume(&volume);
	for (int which = 0; which < 3; which++) {
		struct stage stage = new_stage();
		stage.rays.surface.shadows = true;
		if (which == 0)
			stage.rays.surface.isovalue = 1000; /* no triangles */
		if (which == 1)
			memcpy(stage.camera.look_at, (double[3]) { 2, -3, 1.4 },
			       sizeof stage.camera.look_at); /* behind the eye */
		if (which == 2)
			stage.rays.clip.greatest[0] = 0.02;
		draw_triangles(&stage);
		for (int i = 0; i < PIXELS; i++) {
			assert_int_equal(gz_image_words(&stage.image)[i], 0xFF004D00);
			assert_int_equal(stage.ids.words[i], 0);
			assert_true(isinf(gz_plane_value(&stage.depth, i % WIDTH, i / WIDTH)));
		}
		free_stage(&stage);
	}
	gz_volume_free(&volume);
}

static void meshes_are_uploaded_when_they_change_and_no_more(void **state)
{
	(void)state;
	struct gz_volume volume = field_volume(field_ball, DIMS, EVEN, GZ_VOXEL_F32);
	struct stage stage = new_stage();
	int small = 0, large = 0;
	show_volume(&volume);
	draw_triangles(&stage);
	assert_true(stage.stats.prepare_ms > 0);
	for (int i = 0; i < PIXELS; i++)
		large += stage.ids.words[i] == 7;
	draw_triangles(&stage);
	assert_true(stage.stats.prepare_ms == 0);
	stage.rays.surface.isovalue = 8; /* a smaller ball */
	draw_triangles(&stage);
	assert_true(stage.stats.prepare_ms > 0);
	for (int i = 0; i < PIXELS; i++)
		small += stage.ids.words[i] == 7;
	assert_in_range(small, 1, large / 2);
	free_stage(&stage);
	gz_volume_free(&volume);
}

static void meshes_beyond_the_devices_memory_are_refused_with_one_line(void **state)
{
	(void)state;
	struct gz_volume volume = field_volume(field_ball, DIMS, EVEN, GZ_VOXEL_F32);
	const struct gz_object object = { .id = 7, .volume = &volume };
	const struct gz_backend_params params = { .gl_memory_bytes = 1000 };
	struct captured_log captured;
	struct gz_surface_raster *own = NULL;
	struct stage stage = new_stage();
	const struct gz_surface_shot shot = shot_of(&stage);
	captured_log_init(&captured, "*:warn");
	assert_int_equal(gz_surface_raster_create(&params, &captured.log, &own), GZ_OK);
	assert_int_equal(gz_surface_raster_draw(own, &shot, &stage.image, NULL, NULL),
			 GZ_ERR_INVAL); /* shows nothing */
	assert_int_equal(gz_surface_raster_show(own, &object, 1), GZ_OK);
	assert_int_equal(gz_surface_raster_draw(own, &shot, &stage.image, NULL, NULL),
			 GZ_ERR_NO_MEM);
	assert_int_equal(captured.messages, 1);
	assert_non_null(strstr(captured.last, "--backend cpu"));
	gz_surface_raster_destroy(&own);
	free_stage(&stage);
	gz_volume_free(&volume);
}

/* Counts alone are looked at: such a mesh has 8 GiB. */
static void meshes_of_more_elements_than_corners_can_be_counted_are_refused(void **state)
{
	(void)state;
	struct gz_volume volume = field_volume(field_ball, DIMS, EVEN, GZ_VOXEL_F32);
	for (int which = 0; which < 2; which++) {
		struct gz_mesh huge = { .vertex_count = 3, .triangle_count = 1 };
		*(which ? &huge.triangle_count : &huge.vertex_count) = GZ_SURFACE_ELEMENTS_MAX + 1;
		const struct gz_object object = { .id = 7, .volume = &volume, .mesh = &huge };
		struct captured_log captured;
		bool new_meshes = true;
		captured_log_init(&captured, "*:warn");
		struct gz_surface_meshes meshes = { .log = &captured.log };
		assert_int_equal(gz_surface_meshes_show(&meshes, &object, 1), GZ_OK);
		assert_int_equal(gz_surface_meshes_make(&meshes, 0, NULL, &new_meshes),
				 GZ_ERR_FULL);
		assert_false(new_meshes);
		assert_int_equal(captured.messages, 1);
		assert_non_null(strstr(captured.last, "at most 715827882 vertices and triangles"));
		gz_surface_meshes_free(&meshes);
	}
	gz_volume_free(&volume);
}

/* As in a window: the picture stays on the device, and what the window draws next is not upset. */
static void picture_left_in_a_lent_context_equals_the_one_read_back(void **state)
{
	(void)state;
	struct gz_volume volume = field_volume(field_ball, DIMS, EVEN, GZ_VOXEL_F32);
	const struct gz_object object = {
		.technique = &gz_isosurface_technique,
		.id = 7,
		.volume = &volume,
	};
	struct lent_context lent = lend_context();
	const struct gz_backend_params params = { .gl_context = &lent.base };
	struct stage stage = new_stage();
	struct gz_drawer *drawer = NULL;
	static uint8_t pixels[4 * PIXELS];
	GLint viewport[4];
	stage.rays.surface.shadows = true;
	stage.rays.clip.least[0] = 0.4;
	const struct gz_surface_shot surfaces = shot_of(&stage);
	const struct gz_shot shot = { .camera = surfaces.camera,
				      .settings = surfaces.rays,
				      .plan = surfaces.plan };
	assert_int_equal(gz_isosurface_technique.create("gl", &params, NULL, &drawer), GZ_OK);
	assert_string_equal(drawer->ops->backend(drawer), "gl");
	assert_int_equal(drawer->ops->show(drawer, &object, 1), GZ_OK);
	assert_int_equal(drawer->ops->draw(drawer, &shot, &stage.image, NULL), GZ_OK);
	assert_int_equal(lent.egl->ops->make_current(lent.egl), GZ_OK);
	glViewport(1, 2, 3, 4);
	assert_true(drawer->ops->keeps_on_device(drawer, &shot));
	assert_int_equal(drawer->ops->draw(drawer, &shot, NULL, NULL), GZ_OK);
	assert_int_equal(lent.egl->ops->make_current(lent.egl), GZ_OK);
	glGetIntegerv(GL_VIEWPORT, viewport);
	assert_true(viewport[0] == 1 && viewport[1] == 2 && viewport[2] == 3 && viewport[3] == 4);
	assert_false(glIsEnabled(GL_BLEND) || glIsEnabled(GL_DEPTH_TEST) ||
		     glIsEnabled(GL_SCISSOR_TEST) || glIsEnabled(GL_CLIP_DISTANCE0));
	glBindTexture(GL_TEXTURE_2D, drawer->ops->picture_texture(drawer));
	glGetTexImage(GL_TEXTURE_2D, 0, GL_RGBA, GL_UNSIGNED_BYTE, pixels);
	assert_int_equal(glGetError(), GL_NO_ERROR);
	lent.egl->ops->release(lent.egl);
	assert_memory_equal(pixels, stage.image.pixels, sizeof pixels);
	lent.lost = true;
	assert_int_equal(drawer->ops->draw(drawer, &shot, &stage.image, NULL), GZ_ERR_NO_DEVICE);
	gz_drawer_destroy(&drawer);
	gz_gl_context_destroy(&lent.egl);
	free_stage(&stage);
	gz_volume_free(&volume);
}

/* Surfaces in the voxels are found by rays, and triangles that a caster has made are taken. */
static void drawer_of_gl_finds_surfaces_in_voxels_and_takes_triangles(void **state)
{
	(void)state;
	struct gz_volume volume = field_volume(field_ring, DIMS, EVEN, GZ_VOXEL_F32);
	const struct gz_object object = { .technique = &gz_isosurface_technique,
					  .id = 7,
					  .volume = &volume };
	struct stage stage = new_stage();
	struct gz_image other = { 0 };
	struct gz_drawer *gl = NULL, *cpu = NULL;
	const struct gz_surface_shot surfaces = shot_of(&stage);
	const struct gz_shot shot = { .camera = surfaces.camera,
				      .settings = surfaces.rays,
				      .plan = surfaces.plan };
	struct gz_frame_stats stats;
	assert_int_equal(gz_isosurface_technique.create("gl", NULL, NULL, &gl), GZ_OK);
	assert_int_equal(gz_isosurface_technique.create("cpu", NULL, NULL, &cpu), GZ_OK);
	assert_int_equal(gl->ops->show(gl, &object, 1), GZ_OK);
	assert_int_equal(cpu->ops->show(cpu, &object, 1), GZ_OK);
	stage.rays.surface.source = GZ_SURFACE_VOXELS;
	assert_false(gl->ops->keeps_on_device(gl, &shot));
	assert_int_equal(gl->ops->draw(gl, &shot, &stage.image, NULL), GZ_OK);
	assert_int_equal(cpu->ops->draw(cpu, &shot, &other, NULL), GZ_OK);
	assert_memory_equal(other.pixels, stage.image.pixels, 4 * PIXELS);
	stage.rays.surface.source = GZ_SURFACE_TRIANGLES;
	assert_true(gl->ops->keeps_on_device(gl, &shot));
	assert_int_equal(gl->ops->draw(gl, &shot, &other, NULL), GZ_OK);
	stage.rays.surface.isovalue -= 0.25;
	assert_int_equal(gl->ops->draw(gl, &shot, &stage.image, NULL), GZ_OK);
	stage.rays.surface.isovalue += 0.25;
	assert_int_equal(cpu->ops->draw(cpu, &shot, &stage.image, NULL), GZ_OK);
	memset(volume.voxels, 0, gz_volume_bytes(&volume)); /* triangles made anew would differ */
	gl->ops->take_prepared(gl, cpu);
	gz_drawer_destroy(&cpu);
	assert_int_equal(gl->ops->draw(gl, &shot, &stage.image, &stats), GZ_OK);
	assert_memory_equal(other.pixels, stage.image.pixels, 4 * PIXELS);
	assert_true(stats.prepare_ms > 0); /* the upload */
	gz_drawer_destroy(&gl);
	gz_image_free(&other);
	free_stage(&stage);
	gz_volume_free(&volume);
}

/* In pictures of several techniques, rays meet surfaces also if the backend is gl. */
static void drawer_of_gl_casts_the_hits_of_the_one_of_cpu(void **state)
{
	(void)state;
	struct gz_volume volume = field_volume(field_ring, DIMS, EVEN, GZ_VOXEL_F32);
	const struct gz_object object = { .technique = &gz_isosurface_technique,
					  .id = 7,
					  .volume = &volume };
	static const char *const backends[2] = { "cpu", "gl" };
	struct gz_ray_hits hits[2] = { { 0 }, { 0 } };
	struct stage stage = new_stage();
	if (!gz_surface_caster_present())
		skip();
	const struct gz_surface_shot surfaces = shot_of(&stage);
	for (int i = 0; i < 2; i++) {
		struct gz_drawer *drawer = NULL;
		const struct gz_shot shot = { .camera = surfaces.camera,
					      .settings = surfaces.rays,
					      .plan = surfaces.plan,
					      .hits = &hits[i] };
		assert_int_equal(gz_ray_hits_clear(&hits[i], surfaces.plan), GZ_OK);
		assert_int_equal(gz_isosurface_technique.create(backends[i], NULL, NULL, &drawer),
				 GZ_OK);
		assert_int_equal(drawer->ops->show(drawer, &object, 1), GZ_OK);
		assert_int_equal(drawer->ops->cast_hits(drawer, &shot, NULL), GZ_OK);
		gz_drawer_destroy(&drawer);
	}
	const size_t count = surfaces.plan->tile_count * GZ_HITS_A_TILE;
	size_t met = 0;
	for (size_t i = 0; i < count; i++)
		met += isfinite(hits[0].depth[i]) != 0;
	assert_in_range(met, 100, count);
	assert_memory_equal(hits[0].depth, hits[1].depth, count * sizeof(float));
	for (int i = 0; i < 2; i++)
		gz_ray_hits_free(&hits[i]);
	free_stage(&stage);
	gz_volume_free(&volume);
}

/* A point on the ray of a pixel lies in the middle of the pixel, within the range of depths. */
static void points_on_rays_are_drawn_at_their_pixels(void **state)
{
	(void)state;
	const struct gz_raster_box box = { { -30, -20, -25 }, { 30, 20, 25 } };
	for (int projection = 0; projection < 2; projection++) {
		struct stage stage = new_stage();
		struct gz_ray_frame rays;
		struct gz_raster_view view;
		stage.camera.projection = (enum gz_projection)projection;
		assert_int_equal(gz_camera_rays(&stage.camera, WIDTH, HEIGHT, &rays), GZ_OK);
		assert_true(gz_raster_view_make(&rays, 60, &box, &view));
		for (int i = 0; i < 25; i++) {
			const int x = i % 5 * 20, y = i / 5 * 15;
			const double along = 1.6 + 0.05 * (i % 3);
			double at[4] = { 0 };
			for (int row = 0; row < 4; row++) {
				at[row] = (double)view.rows[row][3];
				for (int axis = 0; axis < 3; axis++)
					at[row] += (double)view.rows[row][axis] * 60 *
						   (rays.origin00[axis] + x * rays.origin_dx[axis] +
						    y * rays.origin_dy[axis] +
						    along * (rays.direction00[axis] +
							     x * rays.direction_dx[axis] +
							     y * rays.direction_dy[axis]));
			}
			assert_true(fabs(at[0] / at[3] - x) < 1e-3);
			assert_true(fabs(at[1] / at[3] - y) < 1e-3);
			assert_true(fabs(at[2]) < at[3]);
		}
		/* looks away */
		for (int axis = 0; axis < 3; axis++)
			stage.camera.look_at[axis] = 2 * stage.camera.eye[axis];
		assert_int_equal(gz_camera_rays(&stage.camera, WIDTH, HEIGHT, &rays), GZ_OK);
		assert_false(gz_raster_view_make(&rays, 60, &box, &view));
	}
}

static void random_place(uint32_t *seed, double size, double out[3])
{
	for (int axis = 0; axis < 3; axis++)
		out[axis] = size * (field_random(seed) - 0.5);
}

/* No box is left out of which a point is in the rectangle, and most others are. */
static void boxes_are_left_out_only_if_nothing_of_them_shows(void **state)
{
	(void)state;
	const struct gz_raster_box all = { { -60, -60, -60 }, { 60, 60, 60 } };
	uint32_t seed = 3;
	int out = 0, in = 0;
	for (int i = 0; i < 2000; i++) {
		struct stage stage = new_stage();
		struct gz_ray_frame rays;
		struct gz_raster_view view;
		double middle[3], size[3];
		const double from[2] = { 60 * field_random(&seed), 40 * field_random(&seed) };
		const double to[2] = { from[0] + 30, from[1] + 20 };
		bool any = false;
		stage.camera.projection = (enum gz_projection)(i % 2);
		assert_int_equal(gz_camera_rays(&stage.camera, WIDTH, HEIGHT, &rays), GZ_OK);
		assert_true(gz_raster_view_make(&rays, 60, &all, &view));
		random_place(&seed, 100, middle);
		random_place(&seed, 40, size);
		struct gz_raster_box box;
		for (int axis = 0; axis < 3; axis++) {
			box.least[axis] = middle[axis] - fabs(size[axis]) / 2;
			box.greatest[axis] = middle[axis] + fabs(size[axis]) / 2;
		}
		for (int k = 0; k < 100; k++) {
			double place[3], at[4];
			random_place(&seed, 1, place);
			for (int axis = 0; axis < 3; axis++)
				place[axis] = middle[axis] + place[axis] * fabs(size[axis]);
			for (int row = 0; row < 4; row++)
				at[row] = (double)view.rows[row][0] * place[0] +
					  (double)view.rows[row][1] * place[1] +
					  (double)view.rows[row][2] * place[2] +
					  (double)view.rows[row][3];
			any = any || (at[3] > 0 && fabs(at[2]) < at[3] && at[0] > from[0] * at[3] &&
				      at[0] < to[0] * at[3] && at[1] > from[1] * at[3] &&
				      at[1] < to[1] * at[3]);
		}
		const bool shows = gz_raster_view_shows(&view, &box, from, to);
		assert_true(shows || !any);
		in += any;
		out += !shows;
	}
	assert_true(in > 100 && out > 1000);
}

enum { CLUSTERED = 5000, CLUSTERED_SHARED = 700 };

/* Small triangles all over a cube, of three vertices of their own. */
static struct gz_mesh scattered_triangles(void)
{
	struct gz_mesh mesh;
	uint32_t seed = 11;
	assert_int_equal(gz_mesh_allocate(3 * CLUSTERED, CLUSTERED, &mesh), GZ_OK);
	mesh.shared_count = CLUSTERED_SHARED;
	for (uint32_t i = 0; i < CLUSTERED; i++) {
		double middle[3], away[3];
		random_place(&seed, 110, middle);
		for (uint32_t k = 0; k < 3; k++) {
			random_place(&seed, 4, away);
			for (int axis = 0; axis < 3; axis++)
				mesh.positions[3 * i + k][axis] =
					(float)(middle[axis] + away[axis]);
			mesh.triangles[i][k] = 3 * i + k;
		}
	}
	return mesh;
}

/* Whether the view has a vertex on a point of the lattice's rectangle that it draws. */
static bool vertex_shows(const struct gz_raster_view *view, const float place[3],
			 const struct gz_raster_layer *lattice)
{
	double at[4];
	bool hidden = true;
	for (int row = 0; row < 4; row++)
		at[row] = (double)view->rows[row][0] * (double)place[0] +
			  (double)view->rows[row][1] * (double)place[1] +
			  (double)view->rows[row][2] * (double)place[2] +
			  (double)view->rows[row][3];
	if (!(at[3] > 0 && fabs(at[2]) < at[3]))
		return false;
	for (int axis = 0; axis < 2; axis++) {
		const double point = (at[axis] / at[3] - lattice->from[axis]) / lattice->spacing;
		if (point < 0 || point > lattice->points[axis] - 1)
			return false;
		hidden = hidden && point > lattice->hidden[0][axis] &&
			 point < lattice->hidden[1][axis] - 1;
	}
	return !hidden;
}

static void clusters_hold_each_triangle_once_and_are_drawn_where_they_show(void **state)
{
	(void)state;
	static const struct gz_raster_box all = { { -60, -60, -60 }, { 60, 60, 60 } };
	static const struct gz_raster_layer lattices[] = {
		{ .from = { 0, 0 }, .spacing = 1, .points = { WIDTH, HEIGHT } },
		{ .from = { 12, 8 }, .spacing = 2, .points = { 16, 12 } },
		{ .from = { 0, 0 },
		  .spacing = 2,
		  .points = { WIDTH / 2, HEIGHT / 2 },
		  .hidden = { { 6, 4 }, { WIDTH / 2 - 6, HEIGHT / 2 - 4 } } },
	};
	static uint32_t triangles[CLUSTERED][3];
	static struct gz_raster_run runs[CLUSTERED];
	static bool seen[CLUSTERED], drawn[CLUSTERED];
	struct gz_mesh mesh = scattered_triangles();
	struct gz_raster_clusters clusters;
	struct stage stage = new_stage();
	struct gz_ray_frame rays;
	struct gz_raster_view view;
	assert_int_equal(gz_raster_clusters_make(&mesh, triangles, &clusters), GZ_OK);
	size_t corners = 0;
	for (size_t i = 0; i < clusters.count; i++) {
		const struct gz_raster_cluster *cluster = &clusters.items[i];
		assert_int_equal(cluster->first, corners);
		corners += cluster->corners;
		for (size_t k = cluster->first / 3; k < corners / 3; k++) {
			const uint32_t number = triangles[k][0] / 3;
			assert_false(seen[number]);
			seen[number] = true;
			assert_memory_equal(triangles[k], mesh.triangles[number],
					    sizeof triangles[k]);
			assert_int_equal(number >= CLUSTERED - CLUSTERED_SHARED,
					 i >= clusters.own_count);
			for (int c = 0; c < 9; c++) {
				const double x = (double)mesh.positions[triangles[k][c / 3]][c % 3];
				assert_true(x >= cluster->box.least[c % 3] &&
					    x <= cluster->box.greatest[c % 3]);
			}
		}
	}
	assert_int_equal(corners, 3 * CLUSTERED);
	for (int i = 0; i < 6; i++) {
		const struct gz_raster_layer *lattice = &lattices[i / 2];
		size_t chosen = 0;
		stage.camera.projection = (enum gz_projection)(i % 2);
		assert_int_equal(gz_camera_rays(&stage.camera, WIDTH, HEIGHT, &rays), GZ_OK);
		assert_true(gz_raster_view_make(&rays, 60, &all, &view));
		memset(drawn, 0, sizeof drawn);
		const size_t count = gz_raster_clusters_choose(&clusters, 0, clusters.count, &view,
							       lattice, runs);
		for (size_t run = 0; run < count; run++) {
			chosen += runs[run].corners;
			for (size_t k = 0; k < runs[run].corners; k += 3)
				drawn[triangles[(runs[run].first + k) / 3][0] / 3] = true;
		}
		for (size_t v = 0; v < mesh.vertex_count; v++)
			if (vertex_shows(&view, mesh.positions[v], lattice))
				assert_true(drawn[v / 3]);
		if (i >= 2)
			assert_true(chosen < 3 * CLUSTERED * 3 / 4 && chosen > 0);
	}
	gz_raster_clusters_free(&clusters);
	gz_mesh_free(&mesh);
}

static void unknown_backends_are_refused_with_one_line(void **state)
{
	(void)state;
	struct captured_log captured;
	struct gz_drawer *own = NULL;
	captured_log_init(&captured, "*:warn");
	assert_int_equal(gz_isosurface_technique.create("vulkan", NULL, &captured.log, &own),
			 GZ_ERR_NOT_FOUND);
	assert_int_equal(captured.messages, 1);
	assert_non_null(strstr(captured.last, "cpu"));
}

static void shaders_of_surfaces_are_valid_for_the_reference_compiler(void **state)
{
	(void)state;
	shader_check_needs_validator();
	for (int program = 0; program < GZ_RASTER_PROGRAMS; program++) {
		struct gz_gl_shader shaders[2];
		gz_raster_shaders((enum gz_raster_program)program, shaders);
		shader_check(&shaders[0]);
		shader_check(&shaders[1]);
	}
	const struct gz_gl_shader pick = gz_gl_pick_shader();
	shader_check(&pick);
}

TEST_SUITE(surface_raster)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(ball_and_ring_look_as_by_rays_in_both_projections),
		cmocka_unit_test(several_objects_hide_each_other_as_by_rays),
		cmocka_unit_test(clip_box_cuts_as_it_cuts_rays),
		cmocka_unit_test(clip_plane_cuts_as_it_cuts_rays),
		cmocka_unit_test(surface_around_the_eye_looks_as_by_rays),
		cmocka_unit_test(glass_over_a_floor_looks_as_by_rays_of_one_bounce),
		cmocka_unit_test(six_pictures_around_look_as_by_rays),
		cmocka_unit_test(shadows_are_those_of_rays_but_at_their_rims),
		cmocka_unit_test(foveated_picture_is_full_at_the_gaze_and_has_no_holes),
		cmocka_unit_test(nothing_in_view_leaves_the_background),
		cmocka_unit_test(meshes_are_uploaded_when_they_change_and_no_more),
		cmocka_unit_test(meshes_beyond_the_devices_memory_are_refused_with_one_line),
		cmocka_unit_test(meshes_of_more_elements_than_corners_can_be_counted_are_refused),
		cmocka_unit_test(picture_left_in_a_lent_context_equals_the_one_read_back),
		cmocka_unit_test(drawer_of_gl_finds_surfaces_in_voxels_and_takes_triangles),
		cmocka_unit_test(drawer_of_gl_casts_the_hits_of_the_one_of_cpu),
		cmocka_unit_test(points_on_rays_are_drawn_at_their_pixels),
		cmocka_unit_test(boxes_are_left_out_only_if_nothing_of_them_shows),
		cmocka_unit_test(clusters_hold_each_triangle_once_and_are_drawn_where_they_show),
		cmocka_unit_test(unknown_backends_are_refused_with_one_line),
		cmocka_unit_test(shaders_of_surfaces_are_valid_for_the_reference_compiler),
	};
	if (gz_surface_raster_create(NULL, NULL, &raster) != GZ_OK)
		return 77;
	const int failed = cmocka_run_group_tests(tests, NULL, NULL);
	gz_surface_raster_destroy(&raster);
	return failed;
}
