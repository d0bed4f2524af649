/* Glass and surroundings against optics by hand: a ball by Snell's law, a block with total
 * reflection, sky and floor by their formulas. */
#include "suite.h"

#include <math.h>
#include <string.h>

#include "mesh_fields.h"
#include "render/plan/method.h"
#include "render/surface/cpu/surface_caster.h"
#include "small_scene.h"

enum { WIDTH = 120, HEIGHT = 90 };

/* mm of a world unit: the box of 64 voxels of 1 mm. */
#define WORLD_MM 64.0

/* What a test draws, and what it gets. */
struct glass_stage {
	struct gz_volume volume;
	struct gz_camera camera;
	struct gz_ray_params rays;
	struct gz_image image;
	struct gz_plane depth, ids;
};

/* A body of glass under a tilted sky, seen along y without perspective. */
static void set_up_glass(field_formula *formula, struct glass_stage *stage)
{
	memset(stage, 0, sizeof *stage);
	stage->volume = field_volume(formula, (const int[3]) { 64, 64, 64 },
				     (const double[3]) { 1, 1, 1 }, GZ_VOXEL_F32);
	stage->camera = (struct gz_camera) {
		.eye = { 0, -2, 0 },
		.up = { 0, 0, 1 },
		.height = 0.8,
		.projection = GZ_PROJECTION_ORTHOGRAPHIC,
	};
	struct gz_ray_params *rays = &stage->rays;
	*rays = gz_ray_params_default();
	rays->light.frame = GZ_LIGHT_WORLD;
	memcpy(rays->light.direction, (double[3]) { 0.4, -0.7, 0.5 }, 3 * sizeof(double));
	rays->surface.material = GZ_MATERIAL_GLASS;
	rays->surface.refractive_index = 1.5;
	memcpy(rays->surface.colour, (double[3]) { 0.6, 0.9, 0.8 }, 3 * sizeof(double));
	rays->environment.kind = GZ_SURROUNDINGS_SKY;
	rays->environment.floor = false;
	memcpy(rays->environment.up, (double[3]) { 0.3, -0.2, 0.9 }, 3 * sizeof(double));
}

static void take_down_glass(struct glass_stage *stage)
{
	gz_volume_free(&stage->volume);
	gz_image_free(&stage->image);
	gz_plane_free(&stage->depth);
	gz_plane_free(&stage->ids);
}

static void draw_glass(struct glass_stage *stage, int threads, const char *simd)
{
	const struct gz_backend_params params = { .threads = threads, .simd = simd };
	const struct gz_object object = { .id = 7, .volume = &stage->volume };
	const struct gz_foveation full = gz_foveation_full();
	const struct gz_display display = gz_display_default(WIDTH, HEIGHT);
	const struct gz_surface_planes planes = { &stage->depth, &stage->ids };
	struct gz_plan plan = { 0 };
	const struct gz_surface_shot shot = { .camera = &stage->camera,
					      .rays = &stage->rays,
					      .plan = &plan };
	struct gz_surface_caster *caster = NULL;
	assert_int_equal(gz_plan_make(&full, &display, (struct gz_point) { 0.5F, 0.5F }, WIDTH,
				      HEIGHT, &plan),
			 GZ_OK);
	assert_int_equal(gz_surface_caster_create(&params, NULL, &caster), GZ_OK);
	assert_int_equal(gz_surface_caster_show(caster, &object, 1), GZ_OK);
	assert_int_equal(gz_surface_caster_draw(caster, &shot, &stage->image, &planes, NULL),
			 GZ_OK);
	gz_surface_caster_destroy(&caster);
	gz_plan_free(&plan);
}

static void unit(const double from[3], double out[3])
{
	const double length = sqrt(from[0] * from[0] + from[1] * from[1] + from[2] * from[2]);
	for (int axis = 0; axis < 3; axis++)
		out[axis] = from[axis] / length;
}

static double dot(const double a[3], const double b[3])
{
	return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* The sky in a unit direction. */
static void sky_at(const struct gz_ray_params *rays, const double direction[3], double rgb[3])
{
	const struct gz_environment *environment = &rays->environment;
	double up[3], towards[3];
	unit(environment->up, up);
	unit(rays->light.direction, towards);
	const double h = fmax(dot(direction, up), 0);
	const double s = fmin(fmax((dot(direction, towards) - 0.9962) / 0.0032, 0), 1);
	for (int i = 0; i < 3; i++) {
		const double sky = environment->horizon[i] +
				   h * (2 - h) * (environment->zenith[i] - environment->horizon[i]);
		rgb[i] = sky + s * s * (1 - sky);
	}
}

/* Add a share of the sky in the direction `along` times y plus `across` times a unit vector in the
 * plane of x and z. */
static void add_sky(const struct gz_ray_params *rays, double along, double across,
		    const double outwards[2], const double share[3], double rgb[3])
{
	const double direction[3] = { across * outwards[0], along, across * outwards[1] };
	double sky[3];
	sky_at(rays, direction, sky);
	for (int i = 0; i < 3; i++)
		rgb[i] += share[i] * sky[i];
}

static double schlick(double cosine, double index)
{
	const double root = (index - 1) / (index + 1);
	return root * root + (1 - root * root) * pow(1 - cosine, 5);
}

/* A ray that enters glass at the angle a to the normal, in the plane of y and `outwards`, goes on
 * inside at the angle b, and leaves it in the direction of the angle `leaves`; what is reflected
 * there sees the sky in that of `back`. Angles from y, towards the axis. */
struct way {
	double a, enters, leaves, back, inside_mm;
};

static void colour_by_hand(const struct glass_stage *stage, const struct way *way,
			   const double outwards[2], double rgb[3])
{
	const struct gz_ray_params *rays = &stage->rays;
	const double mirrored = schlick(cos(way->a), rays->surface.refractive_index);
	double first[3], through[3], back[3];
	memset(rgb, 0, 3 * sizeof *rgb);
	for (int i = 0; i < 3; i++) {
		const double tint = pow(rays->surface.colour[i], way->inside_mm / WORLD_MM);
		first[i] = mirrored;
		through[i] = (1 - mirrored) * (1 - mirrored) * tint;
		back[i] = (1 - mirrored) * mirrored * tint;
	}
	add_sky(rays, -cos(2 * way->a), sin(2 * way->a), outwards, first, rgb);
	if (rays->surface.bounces == 1) {
		for (int i = 0; i < 3; i++)
			through[i] = 1 - mirrored;
		add_sky(rays, cos(way->enters), -sin(way->enters), outwards, through, rgb);
		return;
	}
	add_sky(rays, cos(way->leaves), -sin(way->leaves), outwards, through, rgb);
	add_sky(rays, cos(way->back), -sin(way->back), outwards, back, rgb);
}

/* How far a pixel's colour is from another, grey levels. */
static double off_by(const struct glass_stage *stage, int x, int y, const double rgb[3])
{
	double worst = 0;
	for (int i = 0; i < 3; i++)
		worst = fmax(worst, fabs(stage->image.pixels[4 * (y * WIDTH + x) + i] -
					 255 * fmin(rgb[i], 1)));
	return worst;
}

/* Place of a pixel in the plane of x and z, mm. */
static void place_of(int x, int y, const struct glass_stage *stage, double out[2])
{
	const double pixel = stage->camera.height / HEIGHT * WORLD_MM;
	out[0] = (x + 0.5 - 0.5 * WIDTH) * pixel;
	out[1] = (0.5 * HEIGHT - y - 0.5) * pixel;
}

static void ball_by_snell(enum gz_surface_source source, int bounces, const char *simd)
{
	const double radius = 20;
	struct glass_stage stage;
	double sum = 0;
	int count = 0, apart = 0;
	set_up_glass(field_ball, &stage);
	stage.rays.surface.source = source;
	stage.rays.surface.bounces = bounces;
	draw_glass(&stage, 2, simd);
	for (int y = 0; y < HEIGHT; y++)
		for (int x = 0; x < WIDTH; x++) {
			double place[2], rgb[3];
			place_of(x, y, &stage, place);
			const double share = hypot(place[0], place[1]) / radius;
			if (share > 0.9 || share < 1e-6)
				continue; /* chords move the rim */
			const double a = asin(share);
			const double b = asin(share / stage.rays.surface.refractive_index);
			const double outwards[2] = { place[0] / radius / share,
						     place[1] / radius / share };
			const struct way way = {
				.a = a,
				.enters = a - b,
				.leaves = 2 * (a - b),
				.back = a - b + M_PI - 2 * b,
				.inside_mm = 2 * radius * cos(b),
			};
			colour_by_hand(&stage, &way, outwards, rgb);
			const double off = off_by(&stage, x, y, rgb);
			/* the sun's rim is steep: there a little of a normal's error is much */
			apart += off > 2;
			sum += off;
			count++;
		}
	if (count < 2000 || apart > count / 100 || sum / count > 0.6)
		fail_msg("source %d, %s, %d bounces: mean %.2f grey levels, %d of %d pixels off by "
			 "more than "
			 "2",
			 source, simd, bounces, sum / count, apart, count);
	take_down_glass(&stage);
}

static void ball_of_glass_bends_rays_by_snells_law(void **state)
{
	(void)state;
	for (const char *const *set = small_scene_simd_sets(); *set; set++) {
		ball_by_snell(GZ_SURFACE_TRIANGLES, 4, *set);
		ball_by_snell(GZ_SURFACE_VOXELS, 4, *set);
	}
}

static void ray_that_may_meet_no_more_sees_the_sky_ahead(void **state)
{
	(void)state;
	ball_by_snell(GZ_SURFACE_TRIANGLES, 1, "auto");
	ball_by_snell(GZ_SURFACE_VOXELS, 1, "auto");
}

/* A block of 40 mm, its sides at x, y and z. */
static double field_block(const double place[3])
{
	return 20 - fmax(fabs(place[0]), fmax(fabs(place[1]), fabs(place[2])));
}

/*
 * Seen at 45 degrees, the front of a block sends rays to its side beyond the critical angle. They
 * are reflected there, and leave through the back with x turned round.
 */
static void block_by_snell(enum gz_surface_source source)
{
	const double index = 1.5, a = M_PI / 4, b = asin(sin(a) / index), edge = 20, rim = 3;
	struct glass_stage stage;
	int count = 0;
	set_up_glass(field_block, &stage);
	stage.rays.surface.source = source;
	/* looks along (1, 1, 0) */
	memcpy(stage.camera.eye, (double[3]) { -1.5, -1.5, 0 }, 3 * sizeof(double));
	draw_glass(&stage, 2, NULL);
	const double mirrored = schlick(cos(a), index);
	for (int y = 0; y < HEIGHT; y++)
		for (int x = 0; x < WIDTH; x++) {
			double place[2], rgb[3] = { 0 }, sky[3][3];
			place_of(x, y, &stage, place);
			/* the pixel's point on the front y = -edge; right is (1, -1, 0) / sqrt 2 */
			const double at = place[0] * M_SQRT2 - edge;
			const double side_y = -edge + (edge - at) / tan(b);
			const double back_x = edge - (edge - side_y) * tan(b);
			if (at < -edge + rim || at > edge - rim || fabs(place[1]) > edge - rim ||
			    side_y < -edge + rim || side_y > edge - rim || back_x < -edge + rim ||
			    back_x > edge - rim)
				continue;
			const double directions[3][3] = {
				{ sin(a), -cos(a), 0 },  /* reflected by the front */
				{ -sin(a), cos(a), 0 },  /* leaves through the back */
				{ -sin(b), -cos(b), 0 }, /* reflected by the back */
			};
			for (int i = 0; i < 3; i++)
				sky_at(&stage.rays, directions[i], sky[i]);
			for (int i = 0; i < 3; i++) {
				const double tint = pow(stage.rays.surface.colour[i],
							2 * edge / cos(b) / WORLD_MM);
				rgb[i] =
					mirrored * sky[0][i] +
					(1 - mirrored) * tint *
						((1 - mirrored) * sky[1][i] + mirrored * sky[2][i]);
			}
			const double off = off_by(&stage, x, y, rgb);
			if (off > 2)
				fail_msg("pixel %d %d is off by %.1f", x, y, off);
			count++;
		}
	assert_true(count > 100);
	take_down_glass(&stage);
}

static void block_of_glass_reflects_all_beyond_the_critical_angle(void **state)
{
	(void)state;
	block_by_snell(GZ_SURFACE_TRIANGLES);
	block_by_snell(GZ_SURFACE_VOXELS);
}

/* The floor, or the sky, from a place in world units. */
static void floor_at(const struct glass_stage *stage, const double origin[3],
		     const double direction[3], double rgb[3])
{
	const struct gz_environment *environment = &stage->rays.environment;
	const struct gz_light *light = &stage->rays.light;
	double towards[3];
	sky_at(&stage->rays, direction, rgb);
	if (direction[2] > -1e-4)
		return;
	unit(light->direction, towards);
	const double lamp = light->ambient + light->diffuse * fmax(towards[2], 0);
	const double distance = (origin[2] + 0.5) / -direction[2];
	const double x = (origin[0] + distance * direction[0]) / environment->tile;
	const double y = (origin[1] + distance * direction[1]) / environment->tile;
	/* axes along the floor are y and -x */
	const bool odd = fmod(floor(-x) + floor(y), 2) != 0;
	for (int i = 0; i < 3; i++) {
		const double tile = (odd ? environment->dark : environment->bright)[i] * lamp;
		rgb[i] = environment->horizon[i] +
			 exp2(-distance / 3) * (tile - environment->horizon[i]);
	}
}

static void floor_and_sky_behind_bodies_are_those_of_their_formulas(void **state)
{
	(void)state;
	for (int material = GZ_MATERIAL_MATTE; material <= GZ_MATERIAL_GLASS; material++) {
		struct glass_stage stage;
		struct gz_ray_frame frame;
		int off = 0, seen = 0;
		set_up_glass(field_ball, &stage);
		stage.rays.surface.material = material;
		stage.rays.environment.floor = true;
		stage.rays.environment.tile = 0.25;
		memcpy(stage.rays.environment.up, (double[3]) { 0, 0, 3 }, 3 * sizeof(double));
		stage.camera.projection = GZ_PROJECTION_PERSPECTIVE;
		stage.camera.fov_deg = 50;
		memcpy(stage.camera.eye, (double[3]) { 0.6, -1.7, 0.3 }, 3 * sizeof(double));
		draw_glass(&stage, 2, NULL);
		assert_int_equal(gz_camera_rays(&stage.camera, WIDTH, HEIGHT, &frame), GZ_OK);
		for (int y = 0; y < HEIGHT; y++)
			for (int x = 0; x < WIDTH; x++) {
				double direction[3], rgb[3];
				if (stage.ids.words[y * WIDTH + x] != 0)
					continue;
				for (int axis = 0; axis < 3; axis++)
					direction[axis] = frame.direction00[axis] +
							  x * frame.direction_dx[axis] +
							  y * frame.direction_dy[axis];
				unit(direction, direction);
				floor_at(&stage, stage.camera.eye, direction, rgb);
				off += off_by(&stage, x, y, rgb) > 1;
				seen++;
			}
		/* edges of tiles go either way */
		if (seen < 5000 || off > seen / 200)
			fail_msg("material %d: %d of %d pixels are off", material, off, seen);
		take_down_glass(&stage);
	}
}

/* How many rays of a plan have a hit, for other techniques, that no surface of the ball is. */
static int count_sky_hits(enum gz_surroundings kind)
{
	struct glass_stage stage;
	struct gz_plan plan = { 0 };
	struct gz_ray_hits hits = { 0 };
	const struct gz_foveation full = gz_foveation_full();
	const struct gz_display display = gz_display_default(WIDTH, HEIGHT);
	const struct gz_surface_shot shot = {
		.camera = &stage.camera, .rays = &stage.rays, .plan = &plan, .hits = &hits
	};
	struct gz_surface_caster *caster = NULL;
	int count = 0;
	set_up_glass(field_ball, &stage);
	stage.rays.environment.kind = kind;
	const struct gz_object object = { .id = 7, .volume = &stage.volume };
	assert_int_equal(gz_plan_make(&full, &display, (struct gz_point) { 0.5F, 0.5F }, WIDTH,
				      HEIGHT, &plan),
			 GZ_OK);
	assert_int_equal(gz_ray_hits_clear(&hits, &plan), GZ_OK);
	assert_int_equal(gz_surface_caster_create(NULL, NULL, &caster), GZ_OK);
	assert_int_equal(gz_surface_caster_show(caster, &object, 1), GZ_OK);
	assert_int_equal(gz_surface_caster_draw(caster, &shot, NULL, NULL, NULL), GZ_OK);
	for (size_t tile = 0; tile < plan.tile_count; tile++)
		for (size_t k = 0; k < GZ_HITS_A_TILE; k++) {
			const float depth = hits.depth[tile * GZ_HITS_A_TILE + k];
			count += gz_plan_tile_active(&plan, &plan.tiles[tile]) >> k & 1 &&
				 isfinite(depth) && depth > 10;
		}
	gz_surface_caster_destroy(&caster);
	gz_ray_hits_free(&hits);
	gz_plan_free(&plan);
	take_down_glass(&stage);
	return count;
}

static void sky_is_a_hit_behind_everything_for_other_techniques(void **state)
{
	(void)state;
	assert_int_equal(count_sky_hits(GZ_SURROUNDINGS_NONE), 0);
	assert_true(count_sky_hits(GZ_SURROUNDINGS_SKY) > WIDTH * HEIGHT / 2);
}

/* Matter that mirrors everything is a mirror, and else what it is without, and the sky by Schlick's
 * share. */
static void ball_of_matter_mirrors_the_sky(enum gz_surface_source source, double reflection,
					   const char *simd)
{
	struct glass_stage plain, stage;
	double sum = 0;
	int count = 0;
	set_up_glass(field_ball, &plain);
	plain.rays.surface.material = GZ_MATERIAL_MATTE;
	plain.rays.surface.source = source;
	set_up_glass(field_ball, &stage);
	stage.rays.surface = plain.rays.surface;
	stage.rays.light.reflection = reflection;
	draw_glass(&plain, 2, simd);
	draw_glass(&stage, 2, simd);
	for (int y = 0; y < HEIGHT; y++)
		for (int x = 0; x < WIDTH; x++) {
			double place[2], rgb[3];
			place_of(x, y, &stage, place);
			const double across2 = (place[0] * place[0] + place[1] * place[1]) / 400;
			if (across2 > 0.8)
				continue; /* chords move the rim */
			const double facing = sqrt(1 - across2);
			const double direction[3] = { 2 * facing * place[0] / 20,
						      1 - 2 * facing * facing,
						      2 * facing * place[1] / 20 };
			const double share = reflection + (1 - reflection) * pow(1 - facing, 5);
			sky_at(&stage.rays, direction, rgb);
			for (int i = 0; i < 3; i++) {
				const double own =
					plain.image.pixels[4 * (y * WIDTH + x) + i] / 255.0;
				rgb[i] = own + share * (rgb[i] - own);
			}
			sum += off_by(&stage, x, y, rgb);
			count++;
		}
	if (count < 2000 || sum / count > 0.7)
		fail_msg("source %d, %s, %g: mean %.2f grey levels of %d pixels", source, simd,
			 reflection, sum / count, count);
	take_down_glass(&plain);
	take_down_glass(&stage);
}

static void matter_mirrors_the_sky_by_schlicks_share(void **state)
{
	(void)state;
	for (const char *const *set = small_scene_simd_sets(); *set; set++) {
		ball_of_matter_mirrors_the_sky(GZ_SURFACE_TRIANGLES, 1, *set);
		ball_of_matter_mirrors_the_sky(GZ_SURFACE_VOXELS, 0.2, *set);
	}
}

static void glass_without_a_sky_sees_the_background(void **state)
{
	(void)state;
	struct glass_stage stage;
	set_up_glass(field_ball, &stage);
	stage.rays.environment.kind = GZ_SURROUNDINGS_NONE;
	memcpy(stage.rays.background, (double[3]) { 0.2, 0.4, 0.6 }, 3 * sizeof(double));
	memcpy(stage.rays.surface.colour, (double[3]) { 1, 1, 1 }, 3 * sizeof(double));
	draw_glass(&stage, 2, NULL);
	for (int i = 0; i < WIDTH * HEIGHT; i++)
		for (int channel = 0; channel < 3; channel++)
			assert_in_range(stage.image.pixels[4 * i + channel], 51 * (channel + 1) - 1,
					51 * (channel + 1) + 1);
	take_down_glass(&stage);
}

static void glass_has_the_planes_of_matter_and_the_same_bits_for_any_threads(void **state)
{
	(void)state;
	enum { PIXELS = WIDTH * HEIGHT };
	struct glass_stage one, three, matte;
	set_up_glass(field_ring, &one);
	set_up_glass(field_ring, &three);
	set_up_glass(field_ring, &matte);
	matte.rays.surface.material = GZ_MATERIAL_MATTE;
	draw_glass(&one, 1, NULL);
	draw_glass(&three, 3, NULL);
	draw_glass(&matte, 2, NULL);
	assert_memory_equal(one.image.pixels, three.image.pixels, (size_t)PIXELS * 4);
	assert_memory_equal(one.depth.words, matte.depth.words, (size_t)PIXELS * 4);
	assert_memory_equal(one.ids.words, matte.ids.words, (size_t)PIXELS * 4);
	take_down_glass(&one);
	take_down_glass(&three);
	take_down_glass(&matte);
}

static void glass_and_surroundings_beyond_their_ranges_are_refused(void **state)
{
	(void)state;
	struct gz_ray_params rays = gz_ray_params_default();
	assert_true(gz_ray_params_valid(&rays));
	rays.surface.refractive_index = 0.9;
	assert_false(gz_ray_params_valid(&rays));
	rays = gz_ray_params_default();
	rays.surface.bounces = 0;
	assert_false(gz_ray_params_valid(&rays));
	rays = gz_ray_params_default();
	memset(rays.environment.up, 0, sizeof rays.environment.up);
	assert_false(gz_ray_params_valid(&rays));
	rays = gz_ray_params_default();
	rays.environment.tile = 0;
	assert_false(gz_ray_params_valid(&rays));
}

TEST_SUITE(surface_glass)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(ball_of_glass_bends_rays_by_snells_law),
		cmocka_unit_test(ray_that_may_meet_no_more_sees_the_sky_ahead),
		cmocka_unit_test(block_of_glass_reflects_all_beyond_the_critical_angle),
		cmocka_unit_test(floor_and_sky_behind_bodies_are_those_of_their_formulas),
		cmocka_unit_test(sky_is_a_hit_behind_everything_for_other_techniques),
		cmocka_unit_test(matter_mirrors_the_sky_by_schlicks_share),
		cmocka_unit_test(glass_without_a_sky_sees_the_background),
		cmocka_unit_test(glass_has_the_planes_of_matter_and_the_same_bits_for_any_threads),
		cmocka_unit_test(glass_and_surroundings_beyond_their_ranges_are_refused),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
