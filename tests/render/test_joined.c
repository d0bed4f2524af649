/* Objects of several techniques in one picture: an opaque ball in a translucent field. */
#include "suite.h"

#include <math.h>
#include <string.h>

#include "joined_scene.h"
#include "oracle.h"
#include "render/opengl/gl_device.h"
#include "small_scene.h"

/* Linear, so that samples in the middle of segments stand for them. */
static double haze(const double place[3])
{
	return 0.5 + place[0] / 160 - place[1] / 200 + place[2] / 400;
}

/* Waves, for pictures that are compared with each other. */
static double clouds(const double place[3])
{
	return 0.5 + 0.5 * sin(place[0] / 5) * cos(place[1] / 7) * sin(place[2] / 6 + 1);
}

/* The colour of a ray by brute force: steps of a sixth of a voxel up to the ball, 0 to 255. */
static void brute_force(const struct joined *joined, const struct ray *ray, double hit,
			double out_rgb[3])
{
	const double step = 1.0 / EDGE / 6;
	double from, to, through = 1, sum[3] = { 0 };
	joined_cut_by_box(ray, &from, &to);
	to = fmin(to, hit);
	for (double at = from; at < to; at += step) {
		const double length = fmin(step, to - at);
		double place[3], rgba[4];
		for (int axis = 0; axis < 3; axis++)
			place[axis] = EDGE * (ray->origin[axis] + 0.5 +
					      (at + length / 2) * ray->direction[axis]);
		gz_transfer_evaluate(
			&joined->transfer,
			oracle_sample(&joined->volume, GZ_INTERPOLATION_TRILINEAR, place), rgba);
		const double opacity = 1 - pow(1 - rgba[3], length * EDGE);
		for (int i = 0; i < 3; i++)
			sum[i] += through * opacity * rgba[i];
		through *= 1 - opacity;
	}
	for (int i = 0; i < 3; i++)
		out_rgb[i] =
			255 * (sum[i] + through * (isfinite(hit) ? joined->rays.surface.colour[i]
								 : joined->rays.background[i]));
}

/* Compare a picture of every pixel with brute force, and count the rays that meet the ball. */
static int check_picture(const struct joined *joined, const char *what)
{
	int met = 0;
	for (int y = 1; y < HEIGHT; y += 7)
		for (int x = 2; x < WIDTH; x += 7) {
			const struct ray ray = joined_ray(joined, x, y);
			const uint8_t *pixel = joined->image->pixels + 4 * (y * WIDTH + x);
			double rim, rgb[3];
			const double hit = joined_meet_ball(joined, &ray, &rim);
			if (fabs(rim) < RIM)
				continue;
			met += isfinite(hit);
			brute_force(joined, &ray, hit, rgb);
			for (int i = 0; i < 3; i++)
				if (!(fabs(pixel[i] - rgb[i]) < 1.5))
					fail_msg("%s: pixel %d %d, channel %d: %d instead of %.2f",
						 what, x, y, i, pixel[i], rgb[i]);
		}
	return met;
}

/* Places of the ball, as shares of the way from the origin to the eye; the box ends at 0.357. */
static const struct {
	const char *name;
	double share;
	int least_met; /* of the 352 rays that are checked */
} places[] = {
	{ "in the field", 0.1, 6 },
	{ "cutting the box", 0.34, 10 },
	{ "in front", 0.55, 20 },
	{ "behind", -0.6, 2 },
};

static void place_of(double share, double out_centre[3])
{
	for (int axis = 0; axis < 3; axis++)
		out_centre[axis] = share * JOINED_CAMERA.eye[axis] * EDGE;
}

static void a_ball_in_a_field_equals_brute_force(void **state)
{
	(void)state;
	const char *const *sets = small_scene_simd_sets();
	for (size_t i = 0; i < sizeof places / sizeof places[0]; i++) {
		struct joined joined;
		double centre[3];
		place_of(places[i].share, centre);
		joined_set_up(haze, centre, &joined);
		for (size_t set = 0; sets[set]; set++) {
			const struct gz_backend_params params = { .threads = 2, .simd = sets[set] };
			joined_draw(&params, 2, &joined);
			const int met = check_picture(&joined, places[i].name);
			if (met < places[i].least_met)
				fail_msg("%s: only %d rays met the ball", places[i].name, met);
		}
		joined_take_down(&joined);
	}
}

/* Light, pre-integration, jitter, coarse levels and orthographic views have ways of their own
 * through the kernel. */
static void every_way_through_the_kernel_ends_at_the_ball(void **state)
{
	(void)state;
	for (int way = 0; way < 5; way++) {
		struct joined joined;
		double centre[3];
		place_of(0.1, centre);
		joined_set_up(haze, centre, &joined);
		if (way == 0)
			joined.rays.integration = GZ_INTEGRATION_PREINTEGRATED;
		else if (way == 1)
			joined.rays.shading = GZ_SHADING_GRADIENT; /* ambient light alone */
		else if (way == 2)
			joined.rays.jitter = 5;
		else if (way == 3)
			joined.rays.early_termination = false;
		else
			joined.camera.projection = GZ_PROJECTION_ORTHOGRAPHIC;
		joined.camera.height = 1.2;
		joined_draw(&(struct gz_backend_params) { .threads = 1 }, 2, &joined);
		assert_true(check_picture(&joined, "way") > 0);
		joined_take_down(&joined);
	}
}

static void pixels_that_meet_nothing_are_those_of_the_volume_alone(void **state)
{
	(void)state;
	const struct gz_backend_params params = { .threads = 1 };
	struct joined joined;
	double centre[3];
	int met = 0;
	place_of(0.1, centre);
	joined_set_up(clouds, centre, &joined);
	joined_draw(&params, 1, &joined);
	struct gz_image alone = joined_copy(joined.image);
	joined_draw(&params, 2, &joined);
	for (int y = 0; y < HEIGHT; y++)
		for (int x = 0; x < WIDTH; x++) {
			const struct ray ray = joined_ray(&joined, x, y);
			const size_t at = 4 * ((size_t)y * WIDTH + (size_t)x);
			double rim;
			(void)joined_meet_ball(&joined, &ray, &rim);
			met += rim > RIM;
			if (rim < -RIM)
				assert_memory_equal(alone.pixels + at, joined.image->pixels + at,
						    4);
		}
	assert_true(met > 200);
	gz_image_free(&alone);
	joined_take_down(&joined);
}

static void threads_give_the_same_bits_and_sets_nearly(void **state)
{
	(void)state;
	const char *const *sets = small_scene_simd_sets();
	struct gz_image portable = { 0 };
	struct joined joined;
	double centre[3];
	place_of(0.34, centre);
	joined_set_up(clouds, centre, &joined);
	joined.foveation = small_scene_foveation();
	joined.foveation.acuity_slope *= 20;
	joined_draw(&(struct gz_backend_params) { .threads = 1, .simd = "portable" }, 2, &joined);
	portable = joined_copy(joined.image);
	for (size_t i = 0; sets[i]; i++) {
		struct gz_backend_params params = { .threads = 1, .simd = sets[i] };
		joined_draw(&params, 2, &joined);
		struct gz_image one = joined_copy(joined.image);
		/* Rays at the rim may meet the ball or not: few pixels. */
		assert_true(image_pixels_apart(&portable, &one) < 10);
		params.threads = 3;
		joined_draw(&params, 2, &joined);
		assert_memory_equal(one.pixels, joined.image->pixels, (size_t)WIDTH * HEIGHT * 4);
		gz_image_free(&one);
	}
	gz_image_free(&portable);
	joined_take_down(&joined);
}

/* Where a foveated plan has a ray a pixel and full steps, the picture is that of every pixel. */
static void foveated_pictures_equal_every_pixel_where_rays_are(void **state)
{
	(void)state;
	const struct gz_backend_params params = { .threads = 2 };
	struct joined joined;
	double centre[3];
	long compared = 0;
	place_of(0.1, centre);
	joined_set_up(clouds, centre, &joined);
	joined_draw(&params, 2, &joined);
	struct gz_image full = joined_copy(joined.image);
	joined.foveation = small_scene_foveation();
	joined.foveation.acuity_slope *= 15; /* so that the rim is coarse */
	joined_draw(&params, 2, &joined);
	const struct gz_plan *plan = gz_picture_maker_plan(joined.maker);
	assert_true(plan->ray_count < (size_t)WIDTH * HEIGHT * 3 / 4);
	for (size_t i = 0; i < plan->tile_count; i++) {
		const struct gz_tile *tile = &plan->tiles[i];
		if (plan->steps[tile->step] != 1 || plan->layers[tile->layer].spacing != 1 ||
		    tile->pattern != GZ_TILE_SQUARE)
			continue;
		for (int k = 0; k < GZ_HITS_A_TILE; k++) {
			const int x = tile->x + gz_tile_columns[0][k],
				  y = tile->y + gz_tile_rows[k];
			const size_t at = 4 * ((size_t)y * WIDTH + (size_t)x);
			if (x >= WIDTH || y >= HEIGHT)
				continue;
			assert_memory_equal(full.pixels + at, joined.image->pixels + at, 4);
			compared++;
		}
	}
	assert_true(compared > 500);
	gz_image_free(&full);
	joined_take_down(&joined);
}

/* The volume's own surface inside the volume, as bone in skin. */
static void a_volume_hides_what_lies_behind_its_own_surface(void **state)
{
	(void)state;
	const struct gz_backend_params params = { .threads = 1 };
	const double far[3] = { 0, 0, 0 };
	struct joined joined;
	joined_set_up(field_ball, far, &joined);
	joined.objects[1].mesh = NULL;
	joined.rays.surface.isovalue = 0; /* a ball of 20 mm */
	joined.transfer.range[0] = 0;     /* all that shows lies in the ball, ... */
	joined.transfer.range[1] = 20;
	joined.transfer.points[0].opacity = 0;
	joined_draw(&params, 2, &joined);
	const uint8_t *middle = joined.image->pixels + 4 * (HEIGHT / 2 * WIDTH + WIDTH / 2);
	/* ... where no ray gets */
	assert_true(middle[0] == 51 && middle[1] == 204 && middle[2] == 102);
	joined_take_down(&joined);
}

static void accumulation_starts_again_when_any_technique_changes(void **state)
{
	(void)state;
	const struct gz_temporal_params temporal = { .accumulate = true, .weight = 0.9 };
	const double centre[3] = { 0 };
	struct joined joined;
	joined_set_up(clouds, centre, &joined);
	joined_draw(&(struct gz_backend_params) { .threads = 1 }, 2, &joined);
	struct gz_picture_request request = joined_request(&joined);
	request.temporal = &temporal;
	for (int picture = 0; picture < 3; picture++) {
		if (picture == 2)
			joined.rays.surface.colour[0] = 1; /* raycast does not use it */
		assert_int_equal(
			gz_picture_make(joined.maker, &request, &joined.image, &joined.cost),
			GZ_OK);
		assert_int_equal(joined.cost.kept, picture == 1);
	}
	joined_take_down(&joined);
}

/* The backend gl ends rays at what cpu has met, whatever the plan. */
static void graphics_device_draws_the_picture_of_the_cpu(void **state)
{
	(void)state;
	struct gz_gl_context *context = NULL;
	char reason[200];
	struct joined joined;
	double centre[3];
	if (gz_gl_context_egl(false, &context, reason, sizeof reason) != GZ_OK) {
		print_message("skipped: %s\n", reason);
		skip();
	}
	gz_gl_context_destroy(&context);
	place_of(0.1, centre);
	joined_set_up(clouds, centre, &joined);
	for (int plan = 0; plan < 2; plan++) {
		if (plan == 1)
			joined.foveation = small_scene_foveation();
		joined.backend = "cpu";
		joined_draw(&(struct gz_backend_params) { .threads = 1 }, 2, &joined);
		struct gz_image by_cpu = joined_copy(joined.image);
		joined.backend = "gl";
		joined_draw(&(struct gz_backend_params) { .threads = 1 }, 2, &joined);
		assert_string_equal(gz_picture_maker_backend(joined.maker), "gl");
		assert_true(image_pixels_apart(&by_cpu, joined.image) < 10);
		gz_image_free(&by_cpu);
	}
	joined_take_down(&joined);
}

/* One technique after two, and two after one: drawers that stay keep what they have made. */
static void objects_come_and_go(void **state)
{
	(void)state;
	const double centre[3] = { 0 };
	struct joined joined;
	joined_set_up(clouds, centre, &joined);
	joined_draw(&(struct gz_backend_params) { .threads = 1 }, 2, &joined);
	struct gz_image both = joined_copy(joined.image);
	const struct gz_picture_request request = joined_request(&joined);
	for (int round = 0; round < 4; round++) {
		const bool alone = round == 1;
		const struct gz_object reversed[2] = { joined.objects[1], joined.objects[0] };
		const struct gz_object *objects = round == 3 ? reversed : joined.objects;
		assert_int_equal(
			gz_picture_maker_show(joined.maker, objects + alone, alone ? 1 : 2), GZ_OK);
		assert_int_equal(
			gz_picture_make(joined.maker, &request, &joined.image, &joined.cost),
			GZ_OK);
		const bool same =
			memcmp(both.pixels, joined.image->pixels, (size_t)WIDTH * HEIGHT * 4) == 0;
		assert_true(same == !alone);
	}
	gz_image_free(&both);
	joined_take_down(&joined);
}

/* Rays end where the other technique has met something, so they are not kept. */
static void rays_that_meet_other_techniques_are_cast_each_time(void **state)
{
	(void)state;
	struct joined joined;
	joined_set_up(clouds, (const double[3]) { 0, 0, 0 }, &joined);
	joined_draw(&(struct gz_backend_params) { .threads = 2 }, 2, &joined);
	struct gz_image before = joined_copy(joined.image);
	const struct gz_temporal_params temporal = gz_temporal_default();
	struct gz_picture_request request = joined_request(&joined);
	request.temporal = &temporal;
	for (int i = 0; i < 4; i++) {
		if (i == 3) /* the ball is another one, and the volume the same */
			joined_move_ball((const double[3]) { 0, 8, 0 }, &joined);
		assert_int_equal(gz_picture_maker_show(joined.maker, joined.objects, 2), GZ_OK);
		assert_int_equal(
			gz_picture_make(joined.maker, &request, &joined.image, &joined.cost),
			GZ_OK);
		assert_true(joined.cost.stats.kept_rays == 0);
		const bool same = memcmp(before.pixels, joined.image->pixels,
					 (size_t)WIDTH * HEIGHT * 4) == 0;
		assert_true(same == (i < 3));
	}
	gz_image_free(&before);
	joined_take_down(&joined);
}

TEST_SUITE(joined)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_ball_in_a_field_equals_brute_force),
		cmocka_unit_test(every_way_through_the_kernel_ends_at_the_ball),
		cmocka_unit_test(pixels_that_meet_nothing_are_those_of_the_volume_alone),
		cmocka_unit_test(threads_give_the_same_bits_and_sets_nearly),
		cmocka_unit_test(foveated_pictures_equal_every_pixel_where_rays_are),
		cmocka_unit_test(a_volume_hides_what_lies_behind_its_own_surface),
		cmocka_unit_test(accumulation_starts_again_when_any_technique_changes),
		cmocka_unit_test(graphics_device_draws_the_picture_of_the_cpu),
		cmocka_unit_test(objects_come_and_go),
		cmocka_unit_test(rays_that_meet_other_techniques_are_cast_each_time),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
