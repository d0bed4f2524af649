/* Shadows between techniques in one picture: a ball of triangles beside a block of smoke. */
#include "suite.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/vector.h"
#include "joined_scene.h"
#include "oracle.h"
#include "render/opengl/gl_device.h"
#include "render/raycast/shared/raycaster.h"
#include "small_scene.h"

/* Nothing nearer to a place than this casts a shadow on smoke: GZ_SHADOW_START, mm. */
#define START_MM 3.0

/* A block of smoke, whose faces fade over 4 mm. */
static double block(const double place[3])
{
	const double half[3] = { 12, 14, 14 };
	double depth = 4;
	for (int axis = 0; axis < 3; axis++)
		depth = fmin(depth, half[axis] - fabs(place[axis] + (axis == 0 ? 14 : 0)));
	return fmax(depth, 0) / 4;
}

static const struct gz_backend_params TWO_THREADS = { .threads = 2 };

/* Which of both casts a shadow on which, and what is looked at, mm. */
static const struct {
	const char *name;
	double ball, light[3], look_at;
	bool on_ball;
} cases[] = {
	{ "ball on block", 16, { 1, 0.1, 0.35 }, 0, false },
	{ "block on ball", 16, { -1, -0.3, 0.2 }, 14, true },
	{ "block on ball outside of the volume's box", 46, { -1, -0.2, 0.1 }, 44, true },
};

static void set_up_shadows(int number, struct joined *joined)
{
	const double centre[3] = { cases[number].ball, 0, 0 };
	joined_set_up(block, centre, joined);
	joined->transfer.points[0].opacity = 0;
	joined->transfer.points[1].opacity = 0.15;
	joined->transfer.points[1].rgb[0] = 1;
	joined->camera.eye[0] = cases[number].on_ball ? 0.1 : 1;
	joined->camera.eye[1] = -1.5;
	joined->camera.eye[2] = -0.6;
	joined->camera.look_at[0] = cases[number].look_at / EDGE;
	joined->camera.fov_deg = 28;
	joined->rays.light.frame = GZ_LIGHT_WORLD;
	memcpy(joined->rays.light.direction, cases[number].light, sizeof cases[number].light);
	joined->rays.light.ambient = 0.2;
	joined->rays.light.diffuse = 0.8;
	joined->rays.light.shadow_steps = 64;
	joined->rays.surface.shadows = true;
}

/* The share of the light that smoke lets through on the way from a place, mm. */
static double smoke_lets_through(const struct joined *joined, const double at[3],
				 const double light[3])
{
	struct ray ray;
	double from, to, kept = 0;
	const double step = 0.5 / EDGE;
	for (int axis = 0; axis < 3; axis++) {
		ray.origin[axis] = at[axis] / EDGE;
		ray.direction[axis] = light[axis];
	}
	joined_cut_by_box(&ray, &from, &to);
	for (double way = fmax(from, START_MM / EDGE); way < to; way += step) {
		const double length = fmin(step, to - way);
		double place[3], rgba[4];
		for (int axis = 0; axis < 3; axis++)
			place[axis] = at[axis] + EDGE * (0.5 + (way + length / 2) * light[axis]);
		gz_transfer_evaluate(
			&joined->transfer,
			oracle_sample(&joined->volume, GZ_INTERPOLATION_TRILINEAR, place), rgba);
		kept -= log(1 - rgba[3]) * length * EDGE;
	}
	return exp(-kept);
}

/* Whether the ball lies between a place, mm, and the light, no nearer than START_MM. */
static bool ball_blocks(const struct joined *joined, const double at[3], const double light[3])
{
	double to[3];
	for (int axis = 0; axis < 3; axis++)
		to[axis] = joined->centre[axis] - at[axis];
	const double along = gz_dot3(to, light);
	const double inner = BALL_RADIUS * BALL_RADIUS - (gz_dot3(to, to) - along * along);
	return inner > 0 && along + sqrt(inner) > START_MM;
}

/* Brute force, with shadows of smoke and of the ball or without. */
struct reference {
	double light[3]; /* unit vector */
	bool smoke_casts, ball_casts;
};

static double share_of_light(const struct joined *joined, const struct reference *reference,
			     const double at[3], bool on_ball)
{
	/* The ball's own far side is dark by its slope. */
	if (reference->ball_casts && !on_ball && ball_blocks(joined, at, reference->light))
		return 0;
	return reference->smoke_casts ? smoke_lets_through(joined, at, reference->light) : 1;
}

/* How bright the ball is where a ray meets it. */
static double light_of_ball(const struct joined *joined, const struct reference *reference,
			    const struct ray *ray, double hit)
{
	const struct gz_light *light = &joined->rays.light;
	double at[3], normal[3];
	for (int axis = 0; axis < 3; axis++) {
		at[axis] = EDGE * (ray->origin[axis] + hit * ray->direction[axis]);
		normal[axis] = (at[axis] - joined->centre[axis]) / BALL_RADIUS;
	}
	const double facing = fmin(-gz_dot3(normal, ray->direction) / 0.0625, 1);
	return light->ambient + light->diffuse *
					fmax(facing * gz_dot3(normal, reference->light), 0) *
					share_of_light(joined, reference, at, true);
}

/* The colour of a ray, 0 to 255. */
static void follow_ray(const struct joined *joined, const struct reference *reference,
		       const struct ray *ray, double hit, double out_rgb[3])
{
	const double step = 0.5 / EDGE, ambient = joined->rays.light.ambient;
	double from, to, through = 1, sum[3] = { 0 };
	joined_cut_by_box(ray, &from, &to);
	to = fmin(to, hit);
	for (double way = from; way < to && through > 1e-3; way += step) {
		const double length = fmin(step, to - way);
		double at[3], voxel[3], rgba[4];
		for (int axis = 0; axis < 3; axis++) {
			at[axis] = EDGE *
				   (ray->origin[axis] + (way + length / 2) * ray->direction[axis]);
			voxel[axis] = at[axis] + EDGE / 2.0;
		}
		gz_transfer_evaluate(
			&joined->transfer,
			oracle_sample(&joined->volume, GZ_INTERPOLATION_TRILINEAR, voxel), rgba);
		if (rgba[3] <= 0)
			continue;
		const double opacity = 1 - pow(1 - rgba[3], length * EDGE);
		const double lit =
			ambient + (1 - ambient) * share_of_light(joined, reference, at, false);
		for (int i = 0; i < 3; i++)
			sum[i] += through * opacity * rgba[i] * lit;
		through *= 1 - opacity;
	}
	const double ball = isfinite(hit) ? light_of_ball(joined, reference, ray, hit) : 1;
	const double *behind =
		isfinite(hit) ? joined->rays.surface.colour : joined->rays.background;
	for (int i = 0; i < 3; i++)
		out_rgb[i] = 255 * (sum[i] + through * behind[i] * ball);
}

/* How a picture differs from brute force at some rays, grey levels. */
struct errors {
	double mean, shadow; /* shadow: by how much the shadow in question changes brute force */
	int rays, met, far;  /* met: those that meet the ball; far: that differ by more than 12 */
};

static void add_errors(const struct joined *joined, const struct reference *reference, bool on_ball,
		       int x, int y, struct errors *errors)
{
	const struct ray ray = joined_ray(joined, x, y);
	const uint8_t *pixel = joined->image->pixels + 4 * (y * WIDTH + x);
	struct reference without = *reference;
	double rim, with_rgb[3], without_rgb[3], worst = 0;
	const double hit = joined_meet_ball(joined, &ray, &rim);
	if (fabs(rim) < 4 * RIM)
		return;
	if (on_ball)
		without.smoke_casts = false;
	else
		without.ball_casts = false;
	follow_ray(joined, reference, &ray, hit, with_rgb);
	follow_ray(joined, &without, &ray, hit, without_rgb);
	errors->rays++;
	errors->met += isfinite(hit);
	for (int i = 0; i < 3; i++) {
		errors->mean += fabs(pixel[i] - with_rgb[i]) / 3;
		worst = fmax(worst, fabs(pixel[i] - with_rgb[i]));
		if (isfinite(hit) == on_ball)
			errors->shadow += fabs(with_rgb[i] - without_rgb[i]) / 3;
	}
	errors->far += worst > 12;
}

static struct errors compare_with_brute_force(const struct joined *joined, bool on_ball)
{
	struct reference reference = { .smoke_casts = true, .ball_casts = true };
	struct errors errors = { 0 };
	memcpy(reference.light, joined->rays.light.direction, sizeof reference.light);
	(void)gz_normalise3(reference.light);
	for (int y = 3; y < HEIGHT; y += 8)
		for (int x = 3; x < WIDTH; x += 8)
			add_errors(joined, &reference, on_ball, x, y, &errors);
	errors.mean /= errors.rays;
	errors.shadow /= on_ball ? errors.met : errors.rays - errors.met;
	return errors;
}

static void check_shadows(struct joined *joined, int number, const char *backend)
{
	joined->backend = backend;
	joined_draw(&TWO_THREADS, 2, joined);
	const struct errors errors = compare_with_brute_force(joined, cases[number].on_ball);
	printf("%s by %s: mean error %.2f, %d of %d rays off by 12; the shadow changes %.2f\n",
	       cases[number].name, backend, errors.mean, errors.far, errors.rays, errors.shadow);
	assert_true(errors.mean < 0.4 && errors.far * 50 < errors.rays);
	assert_true(errors.met >= 10 && errors.shadow > 2);
}

static void a_ball_and_a_block_shade_each_other_as_brute_force_says(void **state)
{
	(void)state;
	for (int i = 0; i < (int)(sizeof cases / sizeof cases[0]); i++) {
		struct joined joined;
		set_up_shadows(i, &joined);
		check_shadows(&joined, i, "cpu");
		joined_take_down(&joined);
	}
}

static bool gl_runs(void)
{
	struct gz_gl_context *context = NULL;
	char reason[200];
	const bool runs = gz_gl_context_egl(false, &context, reason, sizeof reason) == GZ_OK;
	if (!runs)
		print_message("skipped: %s\n", reason);
	gz_gl_context_destroy(&context);
	return runs;
}

static void graphics_device_shows_the_shadows_of_the_cpu(void **state)
{
	(void)state;
	if (!gl_runs())
		skip();
	for (int i = 0; i < 2; i++) {
		struct joined joined;
		set_up_shadows(i, &joined);
		joined_draw(&TWO_THREADS, 2, &joined);
		struct gz_image by_cpu = joined_copy(joined.image);
		joined.backend = "gl";
		joined_draw(&TWO_THREADS, 2, &joined);
		assert_string_equal(gz_picture_maker_backend(joined.maker), "gl");
		assert_true(image_pixels_apart(&by_cpu, joined.image) < 10);
		gz_image_free(&by_cpu);
		joined_take_down(&joined);
	}
}

static struct gz_image draw_copy(const struct gz_backend_params *params, struct joined *joined)
{
	joined_draw(params, 2, joined);
	return joined_copy(joined->image);
}

static void threads_give_the_same_shadows_and_sets_nearly(void **state)
{
	(void)state;
	const char *const *sets = small_scene_simd_sets();
	for (int i = 0; i < 2; i++) {
		struct joined joined;
		set_up_shadows(i, &joined);
		struct gz_image portable = draw_copy(
			&(struct gz_backend_params) { .threads = 1, .simd = "portable" }, &joined);
		for (int set = 0; sets[set]; set++) {
			struct gz_backend_params params = { .threads = 1, .simd = sets[set] };
			struct gz_image one = draw_copy(&params, &joined);
			assert_true(image_pixels_apart(&portable, &one) < 20);
			params.threads = 3;
			joined_draw(&params, 2, &joined);
			assert_memory_equal(one.pixels, joined.image->pixels,
					    (size_t)WIDTH * HEIGHT * 4);
			gz_image_free(&one);
		}
		gz_image_free(&portable);
		joined_take_down(&joined);
	}
}

/* Make the next picture by the maker that is there. */
static void draw_again(struct joined *joined)
{
	const struct gz_picture_request request = joined_request(joined);
	assert_int_equal(gz_picture_maker_show(joined->maker, joined->objects, 2), GZ_OK);
	assert_int_equal(gz_picture_make(joined->maker, &request, &joined->image, &joined->cost),
			 GZ_OK);
}

static void shadows_follow_a_ball_that_moves(void **state)
{
	(void)state;
	const double there[3] = { 16, 2, 7 };
	struct joined joined;
	set_up_shadows(0, &joined);
	struct gz_image before = draw_copy(&TWO_THREADS, &joined);
	joined_move_ball(there, &joined);
	draw_again(&joined);
	struct gz_image moved = joined_copy(joined.image);
	struct gz_image fresh = draw_copy(&TWO_THREADS, &joined);
	assert_memory_equal(moved.pixels, fresh.pixels, (size_t)WIDTH * HEIGHT * 4);
	assert_true(image_pixels_apart(&before, &moved) > 500);
	gz_image_free(&before);
	gz_image_free(&moved);
	gz_image_free(&fresh);
	joined_take_down(&joined);
}

/* How many pixels, by one maker, a change of the settings changes. */
static int count_changed(struct joined *joined)
{
	struct gz_image before = joined_copy(joined->image);
	draw_again(joined);
	const int changed = image_pixels_apart(&before, joined->image);
	gz_image_free(&before);
	return changed;
}

static void keys_say_what_casts_a_shadow(void **state)
{
	(void)state;
	struct joined joined;
	set_up_shadows(0, &joined);
	joined_draw(&TWO_THREADS, 2, &joined);
	joined.rays.surface.shadows = false; /* the ball casts none */
	assert_true(count_changed(&joined) > 300);
	joined.rays.surface.shadows = true;
	assert_true(count_changed(&joined) > 300);
	joined.rays.surface.material = GZ_MATERIAL_GLASS; /* glass casts none */
	joined.rays.surface.shadows = false;
	(void)count_changed(&joined);
	joined.rays.surface.shadows = true;
	assert_int_equal(count_changed(&joined), 0);
	joined_take_down(&joined);
	set_up_shadows(1, &joined);
	joined_draw(&TWO_THREADS, 2, &joined);
	joined.rays.surface.shadows = false;      /* smoke still does */
	assert_true(count_changed(&joined) < 10); /* the ball on itself, along its terminator */
	joined.rays.light.shadow_steps = 0;
	assert_true(count_changed(&joined) > 300);
	joined_take_down(&joined);
}

/* The clip box cuts away what would cast a shadow. */
static void what_the_clip_box_cuts_off_casts_no_shadow(void **state)
{
	(void)state;
	struct joined joined;
	set_up_shadows(1, &joined);
	joined.rays.clip.least[0] = 0.55; /* the block ends at 0.47 */
	joined.rays.background[2] = 0;
	struct gz_image without_block = draw_copy(&TWO_THREADS, &joined);
	joined.rays.light.shadow_steps = 0;
	assert_int_equal(count_changed(&joined), 0);
	gz_image_free(&without_block);
	joined_take_down(&joined);
	set_up_shadows(0, &joined);
	joined.rays.clip.greatest[0] = 0.55; /* the ball begins at 0.62 */
	joined_draw(&TWO_THREADS, 2, &joined);
	joined.rays.surface.shadows = false;
	assert_int_equal(count_changed(&joined), 0);
	joined_take_down(&joined);
}

/* The same by a plane: what is left is beside the block, and beside the ball. */
static void what_the_clip_plane_cuts_off_casts_no_shadow(void **state)
{
	(void)state;
	struct joined joined;
	set_up_shadows(1, &joined);
	joined.rays.clip.plane = true;
	joined.rays.clip.normal[0] = -1;
	joined.rays.clip.offset = 0.45;
	joined.rays.background[2] = 0;
	struct gz_image without_block = draw_copy(&TWO_THREADS, &joined);
	joined.rays.light.shadow_steps = 0;
	assert_int_equal(count_changed(&joined), 0);
	gz_image_free(&without_block);
	joined_take_down(&joined);
	set_up_shadows(0, &joined);
	joined.rays.clip.plane = true;
	joined.rays.clip.offset = 0.55;
	joined_draw(&TWO_THREADS, 2, &joined);
	joined.rays.surface.shadows = false;
	assert_int_equal(count_changed(&joined), 0);
	joined_take_down(&joined);
}

/* A volume's own surface, by triangles and by voxels: both cast the shadow on its smoke. */
static void surface_in_the_voxels_casts_the_shadow_of_its_triangles(void **state)
{
	(void)state;
	struct joined joined;
	set_up_shadows(0, &joined);
	joined.objects[1].mesh = NULL;
	joined.rays.surface.isovalue = 0.9;
	joined.transfer.points[1].opacity = 0.05;
	struct gz_image triangles = draw_copy(&TWO_THREADS, &joined);
	joined.rays.surface.source = GZ_SURFACE_VOXELS;
	draw_again(&joined);
	assert_true(image_pixels_apart(&triangles, joined.image) < WIDTH * HEIGHT / 50);
	struct gz_image voxels = joined_copy(joined.image);
	joined.rays.surface.isovalue = 0.5; /* the cells of light follow */
	draw_again(&joined);
	struct gz_image changed = joined_copy(joined.image);
	joined_draw(&TWO_THREADS, 2, &joined);
	assert_memory_equal(changed.pixels, joined.image->pixels, (size_t)WIDTH * HEIGHT * 4);
	assert_true(image_pixels_apart(&voxels, &changed) > 300);
	gz_image_free(&triangles);
	gz_image_free(&voxels);
	gz_image_free(&changed);
	joined_take_down(&joined);
}

/* The share of the light that smoke leaves at a row of places, with steps this many times as long
 * as the scene's. */
static void find_shares(const struct joined *joined, int steps, float longer,
			float out_shares[GZ_SHADE_PLACES])
{
	struct gz_raycaster *caster = NULL;
	struct gz_ray_params rays = joined->rays;
	struct gz_plan plan = { 0 };
	struct gz_shade shade;
	struct gz_shade_places places = { .active = 0xFFFF, .step = longer };
	rays.light.shadow_steps = steps;
	for (int i = 0; i < GZ_SHADE_PLACES; i++)
		places.at[0][i] = 0.1F + 0.02F * (float)i;
	const struct gz_shot shot = { .camera = &joined->camera, .settings = &rays, .plan = &plan };
	assert_int_equal(gz_plan_make(&joined->foveation, &joined->display,
				      (struct gz_point) { 0.5F, 0.5F }, WIDTH, HEIGHT, &plan),
			 GZ_OK);
	assert_int_equal(gz_raycaster_create("cpu", &TWO_THREADS, NULL, &caster), GZ_OK);
	assert_int_equal(gz_raycaster_set_volume(caster, &joined->volume), GZ_OK);
	assert_int_equal(gz_raycaster_set_transfer(caster, &joined->transfer), GZ_OK);
	assert_int_equal(gz_raycaster_shade(caster, &shot, &shade), GZ_OK);
	shade.find(shade.user, &places, out_shares);
	gz_raycaster_destroy(&caster);
	gz_plan_free(&plan);
}

static void steps_towards_the_light_grow_with_those_of_the_plan(void **state)
{
	(void)state;
	struct joined joined;
	float fine[GZ_SHADE_PLACES], grown[GZ_SHADE_PLACES];
	set_up_shadows(1, &joined);
	find_shares(&joined, 31, 1, fine);
	find_shares(&joined, 31, 0, grown); /* not said: as long as the scene's */
	assert_memory_equal(grown, fine, sizeof grown);
	find_shares(&joined, 31, 2.5F, grown);
	assert_memory_not_equal(grown, fine, sizeof grown);
	for (int i = 0; i < GZ_SHADE_PLACES; i++)
		assert_float_equal(grown[i], fine[i], 0.1);
	find_shares(&joined, 4, 1, fine); /* the first ones are never lengthened */
	find_shares(&joined, 4, 2.5F, grown);
	assert_memory_equal(grown, fine, sizeof grown);
	joined_take_down(&joined);
}

TEST_SUITE(joined_shadows)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_ball_and_a_block_shade_each_other_as_brute_force_says),
		cmocka_unit_test(graphics_device_shows_the_shadows_of_the_cpu),
		cmocka_unit_test(threads_give_the_same_shadows_and_sets_nearly),
		cmocka_unit_test(shadows_follow_a_ball_that_moves),
		cmocka_unit_test(keys_say_what_casts_a_shadow),
		cmocka_unit_test(what_the_clip_box_cuts_off_casts_no_shadow),
		cmocka_unit_test(what_the_clip_plane_cuts_off_casts_no_shadow),
		cmocka_unit_test(steps_towards_the_light_grow_with_those_of_the_plan),
		cmocka_unit_test(surface_in_the_voxels_casts_the_shadow_of_its_triangles),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
