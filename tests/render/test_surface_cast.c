/* Rays meet surfaces where formulas have them, whatever the plan, the threads and the instruction
 * set. */
#include "suite.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/captured_log.h"
#include "base/vector.h"
#include "mesh_fields.h"
#include "oracle.h"
#include "render/frame/picture_maker.h"
#include "render/mesh/isosurface.h"
#include "render/plan/method.h"
#include "render/surface/cpu/surface_caster.h"
#include "render/surface/isosurface_technique.h"
#include "small_scene.h"

enum { WIDTH = 150, HEIGHT = 110 };

static const double EVEN[3] = { 1, 1, 1 };
static const int BALL_DIMS[3] = { 64, 64, 64 };

/* What a test draws, and what it gets. */
struct stage {
	struct gz_camera camera;
	struct gz_ray_params rays;
	struct gz_foveation foveation;
	bool refines;
	struct gz_plan plan;
	struct gz_image image;
	struct gz_plane depth, ids;
	struct gz_frame_stats stats;
};

static void set_up_stage(struct stage *stage)
{
	memset(stage, 0, sizeof *stage);
	stage->camera = (struct gz_camera) {
		.eye = { 0.9, -1.4, 0.7 },
		.up = { 0, 0, 1 },
		.fov_deg = 35,
		.height = 1.2,
	};
	stage->rays = gz_ray_params_default();
	stage->foveation = gz_foveation_full();
}

static void take_down_stage(struct stage *stage)
{
	gz_plan_free(&stage->plan);
	gz_image_free(&stage->image);
	gz_plane_free(&stage->depth);
	gz_plane_free(&stage->ids);
}

static struct gz_surface_caster *caster_of(const struct gz_object *objects, size_t count,
					   int threads, const char *simd)
{
	const struct gz_backend_params params = { .threads = threads, .simd = simd };
	struct gz_surface_caster *caster = NULL;
	assert_int_equal(gz_surface_caster_create(&params, NULL, &caster), GZ_OK);
	assert_int_equal(gz_surface_caster_show(caster, objects, count), GZ_OK);
	return caster;
}

static void draw_with(struct gz_surface_caster *caster, struct stage *stage)
{
	const struct gz_display display = gz_display_default(WIDTH, HEIGHT);
	const struct gz_point gaze = { 0.4F, 0.55F };
	const struct gz_surface_shot shot = {
		.camera = &stage->camera,
		.rays = &stage->rays,
		.plan = &stage->plan,
		.refined = &stage->plan,
	};
	const struct gz_surface_planes planes = { &stage->depth, &stage->ids };
	struct gz_plan_request request =
		gz_plan_request_make(&stage->foveation, &display, gaze, WIDTH, HEIGHT);
	request.refines = stage->refines;
	assert_int_equal(gz_plan_update(&request, &stage->plan), GZ_OK);
	assert_int_equal(
		gz_surface_caster_draw(caster, &shot, &stage->image, &planes, &stage->stats),
		GZ_OK);
}

/* Draw the objects once. */
static void draw_objects(const struct gz_object *objects, size_t count, struct stage *stage)
{
	struct gz_surface_caster *caster = caster_of(objects, count, 2, NULL);
	draw_with(caster, stage);
	gz_surface_caster_destroy(&caster);
}

static struct gz_object object_of(const struct gz_volume *volume)
{
	return (struct gz_object) { .id = 7, .volume = volume };
}

/* The ray of a pixel, mm; the direction has length 1. */
struct ray {
	double origin[3], direction[3];
};

static struct ray ray_of(const struct stage *stage, int x, int y, double world_mm)
{
	struct gz_ray_frame frame;
	struct ray ray;
	double length2 = 0;
	assert_int_equal(gz_camera_rays(&stage->camera, WIDTH, HEIGHT, &frame), GZ_OK);
	for (int axis = 0; axis < 3; axis++) {
		ray.origin[axis] = world_mm * (frame.origin00[axis] + x * frame.origin_dx[axis] +
					       y * frame.origin_dy[axis]);
		ray.direction[axis] = frame.direction00[axis] + x * frame.direction_dx[axis] +
				      y * frame.direction_dy[axis];
		length2 += ray.direction[axis] * ray.direction[axis];
	}
	for (int axis = 0; axis < 3; axis++)
		ray.direction[axis] /= sqrt(length2);
	return ray;
}

static void point_on(const struct ray *ray, double distance, double out[3])
{
	for (int axis = 0; axis < 3; axis++)
		out[axis] = ray->origin[axis] + distance * ray->direction[axis];
}

/* The first place where a formula, which is a distance, is 0, and how close to it the ray comes. */
static double trace(field_formula *formula, const struct ray *ray, double *out_closest)
{
	double at = 0, place[3];
	*out_closest = INFINITY;
	for (int step = 0; step < 4000 && at < 1000; step++) {
		point_on(ray, at, place);
		const double away = -formula(place);
		*out_closest = fmin(*out_closest, away);
		if (away < 1e-7)
			return at;
		at += away;
	}
	return INFINITY;
}

static void normal_of(field_formula *formula, const double place[3], double out[3])
{
	double length2 = 0;
	for (int axis = 0; axis < 3; axis++) {
		double low[3] = { place[0], place[1], place[2] };
		double high[3] = { place[0], place[1], place[2] };
		low[axis] -= 1e-4;
		high[axis] += 1e-4;
		out[axis] = formula(low) - formula(high);
		length2 += out[axis] * out[axis];
	}
	for (int axis = 0; axis < 3; axis++)
		out[axis] /= sqrt(length2);
}

/* Greatest distance of the mesh from a formula's surface, mm: the cubes' chords. */
#define CHORD_MM 0.08

/* White light from the eye makes a colour the cosine of normal and view. */
static void shine_from_eye(struct gz_ray_params *rays)
{
	const double direction[3] = { 0, 0, 1 };
	memcpy(rays->light.direction, direction, sizeof direction);
	rays->light.frame = GZ_LIGHT_CAMERA;
	rays->light.ambient = rays->light.specular = 0;
	rays->light.diffuse = 1;
	for (int i = 0; i < 3; i++)
		rays->surface.colour[i] = 1;
}

/* The greatest difference of a pixel's depth from the formula's, mm along the normal, and of its
 * colour from the cosine. */
struct worst {
	double depth_mm, cosine;
	int holes, bodies; /* pixels that should hit and do not, and the other way round */
};

static void compare_pixel(field_formula *formula, const struct stage *stage, int x, int y,
			  struct worst *worst)
{
	const double world_mm = 64;
	const struct ray ray = ray_of(stage, x, y, world_mm);
	double closest, place[3], normal[3], cosine = 0, light = 0;
	const double wanted = trace(formula, &ray, &closest);
	const double depth = (double)gz_plane_value(&stage->depth, x, y) * world_mm;
	const bool met = stage->ids.words[y * WIDTH + x] == 7;
	assert_int_equal(met, isfinite(depth));
	if (!isfinite(wanted)) {
		worst->bodies += met && closest > CHORD_MM;
		return;
	}
	point_on(&ray, wanted, place);
	normal_of(formula, place, normal);
	const struct ray middle = ray_of(stage, WIDTH / 2, HEIGHT / 2, world_mm);
	for (int axis = 0; axis < 3; axis++) {
		cosine -= normal[axis] * ray.direction[axis];
		light -= normal[axis] * middle.direction[axis];
	}
	if (cosine < 0.15)
		return; /* the chords move the rim */
	worst->holes += !met;
	if (!met)
		return;
	worst->depth_mm = fmax(worst->depth_mm, fabs(depth - wanted) * cosine);
	if (light > 0)
		worst->cosine =
			fmax(worst->cosine,
			     fabs(stage->image.pixels[4 * (y * WIDTH + x)] / 255.0 - light));
}

static void formula_is_met(field_formula *formula, enum gz_projection projection, const char *simd)
{
	struct gz_volume volume = field_volume(formula, BALL_DIMS, EVEN, GZ_VOXEL_F32);
	const struct gz_object object = object_of(&volume);
	struct worst worst = { 0 };
	struct stage stage;
	set_up_stage(&stage);
	stage.camera.projection = projection;
	shine_from_eye(&stage.rays);
	struct gz_surface_caster *caster = caster_of(&object, 1, 2, simd);
	draw_with(caster, &stage);
	for (int y = 0; y < HEIGHT; y++)
		for (int x = 0; x < WIDTH; x++)
			compare_pixel(formula, &stage, x, y, &worst);
	if (worst.depth_mm > CHORD_MM || worst.cosine > 0.03 || worst.holes || worst.bodies)
		fail_msg("%s: depth %g mm, cosine %g, %d holes, %d bodies",
			 gz_surface_caster_describe(caster), worst.depth_mm, worst.cosine,
			 worst.holes, worst.bodies);
	gz_surface_caster_destroy(&caster);
	take_down_stage(&stage);
	gz_volume_free(&volume);
}

static void ball_and_ring_have_the_depth_and_normals_of_their_formulas(void **state)
{
	(void)state;
	for (const char *const *set = small_scene_simd_sets(); *set; set++)
		for (int orthographic = 0; orthographic < 2; orthographic++) {
			const enum gz_projection projection = orthographic
								      ? GZ_PROJECTION_ORTHOGRAPHIC
								      : GZ_PROJECTION_PERSPECTIVE;
			formula_is_met(field_ball, projection, *set);
			formula_is_met(field_ring, projection, *set);
		}
}

/* Acuity falls so fast that it matters in a small picture. */
static void foveate(struct gz_foveation *foveation)
{
	foveation->method = GZ_METHOD_ACUITY;
	foveation->acuity_slope = 0.5;
}

static void assert_same_stage(const struct stage *a, const struct stage *b)
{
	const size_t bytes = sizeof(uint32_t) * WIDTH * HEIGHT;
	assert_memory_equal(a->image.pixels, b->image.pixels, bytes);
	assert_memory_equal(a->depth.words, b->depth.words, bytes);
	assert_memory_equal(a->ids.words, b->ids.words, bytes);
}

/* Faces in planes of the grid, seen along an axis: rays along edges that triangles share. */
static double field_blocks(const double place[3])
{
	const double x = fabs(place[0]) - 11, y = fabs(place[1]) - 9, z = fabs(place[2]) - 13;
	return -fmax(x, fmax(y, z));
}

static void any_number_of_threads_makes_the_same_picture(void **state)
{
	(void)state;
	static const int threads[] = { 1, 2, 3, 7 };
	for (int which = 0; which < 2; which++) {
		struct gz_volume volume = field_volume(which ? field_blocks : field_ring, BALL_DIMS,
						       EVEN, GZ_VOXEL_U8);
		const struct gz_object object = object_of(&volume);
		struct stage first, other;
		set_up_stage(&first);
		set_up_stage(&other);
		first.rays.surface.shadows = other.rays.surface.shadows = true;
		foveate(&first.foveation);
		foveate(&other.foveation);
		if (which) {
			first.camera.projection = GZ_PROJECTION_ORTHOGRAPHIC;
			memcpy(first.camera.eye, (double[3]) { 0, -2, 0 }, sizeof first.camera.eye);
			first.camera.height = (double)HEIGHT / 128; /* two pixels a voxel */
			other.camera = first.camera;
		}
		for (size_t i = 0; i < sizeof threads / sizeof threads[0]; i++) {
			struct stage *stage = i == 0 ? &first : &other;
			struct gz_surface_caster *caster = caster_of(&object, 1, threads[i], NULL);
			draw_with(caster, stage);
			if (i > 0)
				assert_same_stage(&first, &other);
			gz_surface_caster_destroy(&caster);
		}
		take_down_stage(&first);
		take_down_stage(&other);
		gz_volume_free(&volume);
	}
}

/* Whether two pixels are alike but for rounding. */
static bool same_pixel(const struct gz_image *a, const struct gz_image *b, int x, int y)
{
	const size_t at = 4 * ((size_t)y * WIDTH + (size_t)x);
	bool same = true;
	for (size_t i = at; i < at + 3; i++)
		same = same && abs(a->pixels[i] - b->pixels[i]) <= 1;
	return same;
}

/* The rays of all tiles show what a ray for every pixel shows there. Returns how many. */
static size_t check_rays(const struct stage *full, const struct stage *coarse)
{
	size_t compared = 0;
	for (size_t i = 0; i < coarse->plan.tile_count; i++) {
		const struct gz_tile *tile = &coarse->plan.tiles[i];
		const int spacing = coarse->plan.layers[tile->layer].spacing;
		for (int k = 0; k < GZ_TILE_EDGE * GZ_TILE_EDGE && !tile->replaced; k++) {
			const int x = tile->x + gz_tile_columns[tile->pattern][k] * spacing;
			const int y = tile->y + gz_tile_rows[k] * spacing;
			if (x >= WIDTH || y >= HEIGHT)
				continue;
			compared++;
			if (!same_pixel(&full->image, &coarse->image, x, y))
				fail_msg("the ray at %d, %d differs", x, y);
			assert_int_equal(full->ids.words[y * WIDTH + x],
					 coarse->ids.words[y * WIDTH + x]);
		}
	}
	return compared;
}

static void plan_casts_the_same_rays_as_every_pixel(void **state)
{
	(void)state;
	struct gz_volume volume = field_volume(field_ring, BALL_DIMS, EVEN, GZ_VOXEL_U16);
	const struct gz_object object = object_of(&volume);
	struct stage full, coarse;
	set_up_stage(&full);
	set_up_stage(&coarse);
	full.rays.surface.shadows = coarse.rays.surface.shadows = true;
	foveate(&coarse.foveation);
	struct gz_surface_caster *caster = caster_of(&object, 1, 2, NULL);
	draw_with(caster, &full);
	draw_with(caster, &coarse);
	if (coarse.stats.rays >= full.stats.rays / 2)
		fail_msg("%d of %d rays", (int)coarse.stats.rays, (int)full.stats.rays);
	assert_true(full.stats.prepare_ms > 0);
	assert_true(check_rays(&full, &coarse) > 1000);
	gz_surface_caster_destroy(&caster);
	take_down_stage(&full);
	take_down_stage(&coarse);
	gz_volume_free(&volume);
}

static int sum_of_differences(const struct gz_image *a, const struct gz_image *b)
{
	int sum = 0;
	for (int i = 0; i < 4 * WIDTH * HEIGHT; i++)
		sum += abs(a->pixels[i] - b->pixels[i]);
	return sum;
}

/* Draw by a method, with rounds or without, by so many threads. */
static void draw_by_method(const struct gz_object *object, int method, bool refines, int threads,
			   struct stage *stage)
{
	foveate(&stage->foveation);
	stage->foveation.acuity_slope = 0.15;
	stage->foveation.method = method;
	stage->foveation.edge_contrast = 0.3;
	stage->foveation.contrast_threshold = 0.05; /* coarse pixels show steep shades */
	stage->refines = refines;
	struct gz_surface_caster *caster = caster_of(object, 1, threads, NULL);
	draw_with(caster, stage);
	gz_surface_caster_destroy(&caster);
}

static void rays_are_added_where_surfaces_have_edges(void **state)
{
	(void)state;
	struct gz_volume volume = field_volume(field_ring, BALL_DIMS, EVEN, GZ_VOXEL_U16);
	const struct gz_object object = object_of(&volume);
	struct stage full, once, edges, alone;
	set_up_stage(&full);
	set_up_stage(&once);
	set_up_stage(&edges);
	set_up_stage(&alone);
	draw_objects(&object, 1, &full);
	draw_by_method(&object, GZ_METHOD_ACUITY, false, 2, &once);
	draw_by_method(&object, GZ_METHOD_ACUITY, true, 2, &edges);
	draw_by_method(&object, GZ_METHOD_ACUITY, true, 1, &alone);
	assert_true(edges.stats.rays > once.stats.rays);
	assert_true(edges.stats.rays < full.stats.rays / 2);
	assert_true(check_rays(&full, &edges) > 1000);
	assert_same_stage(&edges, &alone);
	const int before = sum_of_differences(&full.image, &once.image);
	const int after = sum_of_differences(&full.image, &edges.image);
	if (after > 0.7 * before)
		fail_msg("differences sum up to %d, without rays at edges to %d", after, before);
	take_down_stage(&full);
	take_down_stage(&once);
	take_down_stage(&edges);
	take_down_stage(&alone);
	gz_volume_free(&volume);
}

/* A ball from so near that it fills the picture. */
static void contrast_casts_fewer_rays_at_flat_surfaces(void **state)
{
	(void)state;
	struct gz_volume volume = field_volume(field_ball, BALL_DIMS, EVEN, GZ_VOXEL_U16);
	const struct gz_object object = object_of(&volume);
	struct stage full, once, rounds;
	set_up_stage(&full);
	set_up_stage(&once);
	set_up_stage(&rounds);
	full.camera.fov_deg = once.camera.fov_deg = rounds.camera.fov_deg = 15;
	draw_objects(&object, 1, &full);
	draw_by_method(&object, GZ_METHOD_CONTRAST, false, 2, &once);
	draw_by_method(&object, GZ_METHOD_CONTRAST, true, 2, &rounds);
	if (rounds.stats.rays > once.stats.rays * 8 / 10)
		fail_msg("%d rays, by acuity %d", (int)rounds.stats.rays, (int)once.stats.rays);
	assert_true(rounds.plan.tile_count > rounds.plan.first_round.tile_count);
	assert_true(check_rays(&full, &rounds) > 500);
	take_down_stage(&full);
	take_down_stage(&once);
	take_down_stage(&rounds);
	gz_volume_free(&volume);
}

#define PLATE_TOP   (-14.0)
#define BALL_RADIUS 8.0

/* A ball above a plate. */
static double field_ball_above_plate(const double place[3])
{
	const double *p = place;
	const double ball = BALL_RADIUS - sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]);
	const double plate = fmin(PLATE_TOP - p[2], p[2] + 22);
	return fmax(ball, fmin(plate, 28 - fmax(fabs(p[0]), fabs(p[1]))));
}

/* Leave NaN where later calls have their variables. */
static __attribute__((noinline)) void litter_stack(void)
{
	volatile uint32_t words[1 << 14];
	for (size_t i = 0; i < sizeof words / sizeof words[0]; i++)
		words[i] = UINT32_MAX;
}

/* Embree checks each packet that it is given, also those that it makes of a larger one. */
static void shadow_rays_that_are_not_cast_are_valid_with_every_instruction_set(void **state)
{
	(void)state;
	struct gz_volume volume =
		field_volume(field_ball_above_plate, BALL_DIMS, EVEN, GZ_VOXEL_F32);
	const struct gz_object object = object_of(&volume);
	const char *const *sets = small_scene_simd_sets();
	struct stage first, other;
	set_up_stage(&first);
	set_up_stage(&other);
	first.rays.surface.shadows = other.rays.surface.shadows = true;
	for (int i = 0; sets[i]; i++) {
		struct stage *stage = i == 0 ? &first : &other;
		struct gz_surface_caster *caster = caster_of(&object, 1, 1, sets[i]);
		litter_stack();
		draw_with(caster, stage);
		gz_surface_caster_destroy(&caster);
		/* Few rays meet a surface, or the rim of a shadow, by chance. */
		assert_true(i == 0 || image_pixels_apart(&first.image, &other.image) < 10);
	}
	take_down_stage(&first);
	take_down_stage(&other);
	gz_volume_free(&volume);
}

static void ball_casts_a_round_shadow_and_none_on_its_lit_side(void **state)
{
	(void)state;
	struct gz_volume volume =
		field_volume(field_ball_above_plate, BALL_DIMS, EVEN, GZ_VOXEL_F32);
	const struct gz_object object = object_of(&volume);
	struct stage lit, dark;
	int in_shadow = 0, in_light = 0, on_ball = 0;
	set_up_stage(&lit);
	set_up_stage(&dark);
	for (int i = 0; i < 2; i++) {
		struct gz_light *light = i ? &lit.rays.light : &dark.rays.light;
		memcpy(light->direction, (double[3]) { 0, 0, 1 }, sizeof light->direction);
		light->frame = GZ_LIGHT_WORLD;
	}
	dark.rays.surface.shadows = true;
	draw_objects(&object, 1, &lit);
	draw_objects(&object, 1, &dark);
	for (int y = 0; y < HEIGHT; y++)
		for (int x = 0; x < WIDTH; x++) {
			const struct ray ray = ray_of(&lit, x, y, 64);
			const double depth = (double)gz_plane_value(&lit.depth, x, y) * 64;
			const bool same = same_pixel(&lit.image, &dark.image, x, y);
			double place[3];
			if (!isfinite(depth))
				continue;
			point_on(&ray, depth, place);
			const double away = hypot(place[0], place[1]);
			if (fabs(place[2] - PLATE_TOP) < 0.1 && fabs(place[0]) < 26 &&
			    fabs(place[1]) < 26) {
				if (away < BALL_RADIUS - 0.3) {
					in_shadow++;
					assert_false(same);
				} else if (away > BALL_RADIUS + 0.3) {
					in_light++;
					assert_true(same);
				}
			} else if (place[2] > 0.1 * BALL_RADIUS && away < BALL_RADIUS) {
				on_ball++;
				if (!same)
					fail_msg("a shadow on the ball's lit side at %d, %d", x, y);
			}
		}
	assert_true(in_shadow > 50 && in_light > 1000 && on_ball > 100);
	take_down_stage(&lit);
	take_down_stage(&dark);
	gz_volume_free(&volume);
}

static void nearest_of_several_objects_shows(void **state)
{
	(void)state;
	struct gz_volume ball = field_volume(field_ball, BALL_DIMS, EVEN, GZ_VOXEL_F32);
	struct gz_volume ring = field_volume(field_ring, BALL_DIMS, EVEN, GZ_VOXEL_F32);
	const struct gz_object objects[2] = { { .id = 3, .volume = &ball },
					      { .id = 500, .volume = &ring } };
	struct stage both, alone[2];
	int shown[2] = { 0, 0 };
	set_up_stage(&both);
	draw_objects(objects, 2, &both);
	for (int i = 0; i < 2; i++) {
		set_up_stage(&alone[i]);
		draw_objects(&objects[i], 1, &alone[i]);
	}
	for (int i = 0; i < WIDTH * HEIGHT; i++) {
		const float a = gz_plane_value(&alone[0].depth, i % WIDTH, i / WIDTH);
		const float b = gz_plane_value(&alone[1].depth, i % WIDTH, i / WIDTH);
		const int nearer = b < a;
		const uint32_t *pixels = (const uint32_t *)(const void *)alone[nearer].image.pixels;
		if (fabsf(a - b) < 1e-5F)
			continue;
		assert_int_equal(both.ids.words[i], alone[nearer].ids.words[i]);
		assert_int_equal(gz_image_words(&both.image)[i], pixels[i]);
		if (both.ids.words[i] != 0)
			shown[nearer]++;
	}
	assert_true(shown[0] > 500 && shown[1] > 500);
	take_down_stage(&both);
	for (int i = 0; i < 2; i++)
		take_down_stage(&alone[i]);
	gz_volume_free(&ball);
	gz_volume_free(&ring);
}

static void mesh_looks_like_the_surface_it_was_made_of(void **state)
{
	(void)state;
	struct gz_volume volume = field_volume(field_ring, BALL_DIMS, EVEN, GZ_VOXEL_F32);
	const struct gz_isosurface_request request = { .volume = &volume };
	struct gz_mesh mesh;
	assert_int_equal(gz_isosurface_make(&request, NULL, NULL, &mesh), GZ_OK);
	const struct gz_object objects[2] = { object_of(&volume),
					      { .id = 7, .volume = &volume, .mesh = &mesh } };
	struct stage stages[2];
	for (int i = 0; i < 2; i++) {
		set_up_stage(&stages[i]);
		stages[i].rays.surface.isovalue = i == 1 ? 5 : 0; /* nothing to a mesh */
		draw_objects(&objects[i], 1, &stages[i]);
	}
	assert_same_stage(&stages[0], &stages[1]);
	for (int i = 0; i < 2; i++)
		take_down_stage(&stages[i]);
	gz_mesh_free(&mesh);
	gz_volume_free(&volume);
}

static void isovalue_outside_the_data_shows_the_background_and_says_so(void **state)
{
	(void)state;
	struct gz_volume volume = field_volume(field_ball, BALL_DIMS, EVEN, GZ_VOXEL_U8);
	const struct gz_object object = object_of(&volume);
	struct captured_log captured;
	struct gz_surface_caster *caster = NULL;
	struct stage stage;
	set_up_stage(&stage);
	stage.rays.surface.isovalue = 4000;
	stage.rays.background[1] = 1;
	captured_log_init(&captured, "*:warn");
	assert_int_equal(gz_surface_caster_create(NULL, &captured.log, &caster), GZ_OK);
	assert_int_equal(gz_surface_caster_show(caster, &object, 1), GZ_OK);
	draw_with(caster, &stage);
	assert_non_null(strstr(captured.last, "the isovalue 4000"));
	captured.messages = 0;
	draw_with(caster, &stage);
	assert_int_equal(captured.messages, 0);
	for (int i = 0; i < WIDTH * HEIGHT; i++) {
		assert_memory_equal(stage.image.pixels + 4 * i, "\0\xFF\0\xFF", 4);
		assert_int_equal(stage.ids.words[i], 0);
		assert_true(isinf(gz_plane_value(&stage.depth, i % WIDTH, i / WIDTH)));
	}
	assert_int_equal(gz_surface_caster_size(caster).triangles, 0);
	stage.rays.surface.isovalue = 0; /* and back */
	draw_with(caster, &stage);
	assert_true(gz_surface_caster_size(caster).triangles > 1000);
	assert_int_equal(stage.ids.words[HEIGHT / 2 * WIDTH + WIDTH / 2], 7);
	gz_surface_caster_destroy(&caster);
	take_down_stage(&stage);
	gz_volume_free(&volume);
}

static void clip_box_cuts_what_is_outside(void **state)
{
	(void)state;
	struct gz_volume volume = field_volume(field_ball, BALL_DIMS, EVEN, GZ_VOXEL_F32);
	const struct gz_object object = object_of(&volume);
	struct stage stage;
	int met = 0;
	set_up_stage(&stage);
	memcpy(stage.rays.clip.least, (double[3]) { 0.1, 0.5, 0.2 }, sizeof(double[3]));
	memcpy(stage.rays.clip.greatest, (double[3]) { 0.6, 1, 0.7 }, sizeof(double[3]));
	draw_objects(&object, 1, &stage);
	for (int y = 0; y < HEIGHT; y++)
		for (int x = 0; x < WIDTH; x++) {
			const struct ray ray = ray_of(&stage, x, y, 64);
			const double depth = (double)gz_plane_value(&stage.depth, x, y) * 64;
			double place[3];
			if (!isfinite(depth))
				continue;
			met++;
			point_on(&ray, depth, place);
			for (int axis = 0; axis < 3; axis++) {
				const double share = place[axis] / 64 + 0.5;
				assert_true(share > stage.rays.clip.least[axis] - 1e-4 &&
					    share < stage.rays.clip.greatest[axis] + 1e-4);
			}
		}
	assert_true(met > 300);
	take_down_stage(&stage);
	gz_volume_free(&volume);
}

/* A ball of radius r about the origin, and n . p <= d is left of it, in mm. Rays meet it where the
 * formula says: at its front if that is left, else at its back if that is, from within. */
static void rays_meet_what_a_plane_leaves_of_a_ball(void **state)
{
	(void)state;
	static const double normal[3] = { 0.8, 0, 0.6 };
	struct gz_volume volume = field_volume(field_ball, BALL_DIMS, EVEN, GZ_VOXEL_F32);
	const struct gz_object object = object_of(&volume);
	struct stage stage;
	int front = 0, back = 0, none = 0;
	set_up_stage(&stage);
	stage.rays.clip.plane = true;
	memcpy(stage.rays.clip.normal, normal, sizeof normal);
	draw_objects(&object, 1, &stage);
	struct gz_plane whole = stage.depth;
	stage.rays.clip.plane = false;
	stage.depth = (struct gz_plane) { 0 };
	draw_objects(&object, 1, &stage);
	for (int y = 0; y < HEIGHT; y++)
		for (int x = 0; x < WIDTH; x++) {
			const struct ray ray = ray_of(&stage, x, y, 64);
			const double first = (double)gz_plane_value(&stage.depth, x, y) * 64;
			const double cut = (double)gz_plane_value(&whole, x, y) * 64;
			double place[3];
			if (!isfinite(first))
				continue;
			point_on(&ray, first, place);
			const double radius = gz_length3(place);
			const double here = gz_dot3(place, normal);
			/* The ray's other end in the ball, by the chord. */
			const double chord = -2 * gz_dot3(place, ray.direction);
			const double there = here + chord * gz_dot3(ray.direction, normal);
			if (fabs(here) < 1 || fabs(there) < 1 || chord < 0.3 * radius)
				continue;
			if (here < 0) {
				front++;
				assert_float_equal(cut, first, 1e-3);
			} else if (there < 0) {
				back++;
				assert_float_equal(cut, first + chord, 0.4);
			} else {
				none++;
				assert_false(isfinite(cut));
			}
		}
	assert_true(front > 200 && back > 200 && none > 200);
	gz_plane_free(&whole);
	take_down_stage(&stage);
	gz_volume_free(&volume);
}

/* Distance along a ray, mm, at which trilinear data first reach the isovalue; NaN if they do so
 * where the ray enters. */
static double first_hit(const struct gz_volume *volume, const struct ray *ray, double isovalue)
{
	bool entered = false;
	for (double at = 0; at < 400; at += 0.02) {
		double place[3];
		bool within = true;
		point_on(ray, at, place);
		for (int axis = 0; axis < 3; axis++) {
			place[axis] =
				place[axis] / volume->spacing[axis] + 0.5 * volume->dims[axis];
			within = within && place[axis] >= 0.5 &&
				 place[axis] <= volume->dims[axis] - 0.5;
		}
		if (within && oracle_sample(volume, GZ_INTERPOLATION_TRILINEAR, place) >= isovalue)
			return entered ? at : NAN;
		entered = entered || within;
	}
	return INFINITY;
}

static void first_hit_of_the_data_lies_within_a_voxel(void **state)
{
	(void)state;
	struct small_scene scene = small_scene_waves(40, 36, 30, GZ_VOXEL_U8);
	const struct gz_object object = object_of(&scene.volume);
	const double isovalue = 0.5 * (scene.volume.stored_min + scene.volume.stored_max);
	double half[3];
	int compared = 0, apart = 0;
	struct stage stage;
	set_up_stage(&stage);
	stage.rays.surface.isovalue = scene.volume.slope * isovalue + scene.volume.intercept;
	draw_objects(&object, 1, &stage);
	gz_volume_half_extent(&scene.volume, half);
	const double world_mm = scene.volume.dims[0] * scene.volume.spacing[0] / (2 * half[0]);
	const double voxel_mm = world_mm * gz_volume_voxel_length(&scene.volume);
	for (int y = 0; y < HEIGHT; y += 3)
		for (int x = 0; x < WIDTH; x += 3) {
			const struct ray ray = ray_of(&stage, x, y, world_mm);
			const double depth = (double)gz_plane_value(&stage.depth, x, y) * world_mm;
			const double wanted = first_hit(&scene.volume, &ray, isovalue);
			if (isnan(wanted))
				continue;
			if (!isfinite(depth) || !isfinite(wanted)) {
				apart += isfinite(depth) != isfinite(wanted);
				continue;
			}
			compared++;
			apart += fabs(depth - wanted) > voxel_mm;
		}
	/* Rims move. */
	if (compared < 300 || apart > compared / 25)
		fail_msg("%d of %d rays end elsewhere", apart, compared);
	take_down_stage(&stage);
	small_scene_free(&scene);
}

static void technique_draws_by_the_picture_maker(void **state)
{
	(void)state;
	struct gz_volume volume = field_volume(field_ball, BALL_DIMS, EVEN, GZ_VOXEL_U8);
	const struct gz_picture_maker_params params = { .backend = "auto" };
	struct gz_object object = object_of(&volume);
	struct gz_picture_maker *maker = NULL;
	struct gz_image *image = NULL, first = { 0 };
	struct gz_picture_cost cost;
	struct stage stage;
	const struct gz_display display = gz_display_default(WIDTH, HEIGHT);
	set_up_stage(&stage);
	struct gz_picture_request request = {
		.camera = &stage.camera,
		.settings = &stage.rays,
		.foveation = &stage.foveation,
		.display = &display,
		.focus = gz_focus_at((struct gz_point) { 0.5F, 0.5F }),
		.width = WIDTH,
		.height = HEIGHT,
		.on_device = true,
	};
	object.technique = &gz_isosurface_technique;
	assert_int_equal(gz_picture_maker_create(&params, NULL, &maker), GZ_OK);
	assert_int_equal(gz_picture_maker_show(maker, &object, 1), GZ_OK);
	assert_string_equal(gz_picture_maker_backend(maker), "cpu");
	assert_int_equal(gz_picture_make(maker, &request, &image, &cost), GZ_OK);
	assert_non_null(image);
	assert_int_equal(gz_image_resize(&first, WIDTH, HEIGHT), GZ_OK);
	memcpy(first.pixels, image->pixels, (size_t)4 * WIDTH * HEIGHT);
	stage.rays.surface.isovalue = 5; /* a smaller ball */
	assert_int_equal(gz_picture_make(maker, &request, &image, &cost), GZ_OK);
	assert_true(image_pixels_apart(&first, image) > 100);
	assert_int_equal(gz_picture_maker_show(maker, &object, 1), GZ_OK);
	assert_int_equal(gz_picture_make(maker, &request, &image, &cost), GZ_OK);
	gz_image_free(&first);
	gz_picture_maker_destroy(&maker);
	take_down_stage(&stage);
	gz_volume_free(&volume);
}

static void what_cannot_be_drawn_is_refused(void **state)
{
	(void)state;
	struct captured_log captured;
	struct gz_surface_caster *caster = NULL;
	struct gz_drawer *drawer = NULL;
	const struct gz_object nothing = { .id = 1 };
	const struct gz_backend_params unknown = { .simd = "mmx" }, many = { .threads = 1000 };
	captured_log_init(&captured, "*:warn");
	assert_int_equal(gz_isosurface_technique.check("vulkan", NULL, &captured.log),
			 GZ_ERR_NOT_FOUND);
	assert_non_null(strstr(captured.last, "no backend 'vulkan'"));
	assert_int_equal(gz_isosurface_technique.create("cpu", &unknown, &captured.log, &drawer),
			 GZ_ERR_UNSUPPORTED);
	assert_null(drawer);
	assert_int_equal(gz_surface_caster_create(&many, &captured.log, &caster), GZ_ERR_INVAL);
	assert_int_equal(gz_surface_caster_create(NULL, &captured.log, &caster), GZ_OK);
	assert_int_equal(gz_surface_caster_show(caster, &nothing, 1), GZ_ERR_UNSUPPORTED);
	assert_non_null(strstr(captured.last, "object 1 is neither"));
	gz_surface_caster_destroy(&caster);
}

TEST_SUITE(surface_cast)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(ball_and_ring_have_the_depth_and_normals_of_their_formulas),
		cmocka_unit_test(any_number_of_threads_makes_the_same_picture),
		cmocka_unit_test(plan_casts_the_same_rays_as_every_pixel),
		cmocka_unit_test(rays_are_added_where_surfaces_have_edges),
		cmocka_unit_test(contrast_casts_fewer_rays_at_flat_surfaces),
		cmocka_unit_test(
			shadow_rays_that_are_not_cast_are_valid_with_every_instruction_set),
		cmocka_unit_test(ball_casts_a_round_shadow_and_none_on_its_lit_side),
		cmocka_unit_test(nearest_of_several_objects_shows),
		cmocka_unit_test(mesh_looks_like_the_surface_it_was_made_of),
		cmocka_unit_test(isovalue_outside_the_data_shows_the_background_and_says_so),
		cmocka_unit_test(clip_box_cuts_what_is_outside),
		cmocka_unit_test(rays_meet_what_a_plane_leaves_of_a_ball),
		cmocka_unit_test(first_hit_of_the_data_lies_within_a_voxel),
		cmocka_unit_test(technique_draws_by_the_picture_maker),
		cmocka_unit_test(what_cannot_be_drawn_is_refused),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
