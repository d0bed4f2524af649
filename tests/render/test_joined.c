/* Objects of several techniques in one picture: an opaque ball in a translucent field. */
#include "suite.h"

#include <math.h>
#include <string.h>

#include "mesh_fields.h"
#include "oracle.h"
#include "render/frame/picture_maker.h"
#include "render/mesh/isosurface.h"
#include "render/mesh/mesh_read.h"
#include "render/opengl/gl_device.h"
#include "render/raycast/raycast.h"
#include "render/surface/isosurface_technique.h"
#include "small_scene.h"

enum { WIDTH = 150, HEIGHT = 110, EDGE = 64 };

#define BALL_RADIUS 8.0 /* mm */

/* How close to the ball's rim a ray meets the formula or the mesh by chance, mm. */
#define RIM 0.15

static const double EVEN[3] = { 1, 1, 1 };
static const int DIMS[3] = { EDGE, EDGE, EDGE };

static const struct gz_camera CAMERA = {
	.eye = { 0.9, -1.4, 0.7 },
	.up = { 0, 0, 1 },
	.fov_deg = 35,
};

static double small_ball(const double place[3])
{
	return BALL_RADIUS - sqrt(place[0] * place[0] + place[1] * place[1] + place[2] * place[2]);
}

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

/* A volume, a mesh of a ball, and what makes pictures of both. */
struct joined {
	struct gz_volume volume;
	struct gz_mesh ball;
	struct gz_transfer transfer;
	struct gz_camera camera;
	struct gz_ray_params rays;
	struct gz_foveation foveation;
	struct gz_display display;
	struct gz_object objects[2]; /* the volume, the ball */
	double centre[3];            /* of the ball, mm */
	const char *backend;
	struct gz_picture_maker *maker;
	struct gz_image *image; /* of the last picture */
	struct gz_picture_cost cost;
};

static void make_ball(const double centre[3], struct joined *joined)
{
	struct gz_volume volume = field_volume(small_ball, DIMS, EVEN, GZ_VOXEL_F32);
	const struct gz_isosurface_request request = { .volume = &volume };
	const double away[3] = { -centre[0], -centre[1], -centre[2] };
	assert_int_equal(gz_isosurface_make(&request, NULL, NULL, &joined->ball), GZ_OK);
	gz_mesh_move(&joined->ball, away);
	memcpy(joined->centre, centre, sizeof joined->centre);
	gz_volume_free(&volume);
}

static void set_up(field_formula *formula, const double centre[3], struct joined *joined)
{
	*joined = (struct joined) {
		.volume = field_volume(formula, DIMS, EVEN, GZ_VOXEL_F32),
		.transfer = { .has_range = true,
			      .range = { 0, 1 },
			      .count = 2,
			      .points = { { 0, { 1, 0.5, 0 }, 0.004 },
					  { 1, { 0, 0.5, 1 }, 0.08 } } },
		.camera = CAMERA,
		.rays = gz_ray_params_default(),
		.foveation = gz_foveation_full(),
		.display = gz_display_default(WIDTH, HEIGHT),
		.backend = "cpu",
	};
	make_ball(centre, joined);
	/* The ball's own colour, whatever its slope. */
	joined->rays.light.ambient = 1;
	joined->rays.light.diffuse = joined->rays.light.specular = 0;
	joined->rays.surface.colour[0] = 0.2;
	joined->rays.surface.colour[1] = 0.8;
	joined->rays.surface.colour[2] = 0.4;
	joined->rays.background[2] = 0.6;
	joined->objects[0] = (struct gz_object) {
		.technique = &gz_raycast_technique,
		.id = 1,
		.volume = &joined->volume,
		.transfer = &joined->transfer,
	};
	joined->objects[1] = joined->objects[0];
	joined->objects[1].technique = &gz_isosurface_technique;
	joined->objects[1].mesh = &joined->ball;
	joined->objects[1].id = 2;
}

static void take_down(struct joined *joined)
{
	gz_picture_maker_destroy(&joined->maker);
	gz_mesh_free(&joined->ball);
	gz_volume_free(&joined->volume);
}

/* Make a picture by a maker of its own. */
static void draw_by(const struct gz_backend_params *params, size_t object_count,
		    struct joined *joined)
{
	const struct gz_picture_maker_params maker = { .backend = joined->backend,
						       .backend_params = *params };
	const struct gz_picture_request request = {
		.camera = &joined->camera,
		.settings = &joined->rays,
		.foveation = &joined->foveation,
		.display = &joined->display,
		.focus = gz_focus_at((struct gz_point) { 0.5F, 0.5F }),
		.width = WIDTH,
		.height = HEIGHT,
	};
	gz_picture_maker_destroy(&joined->maker);
	assert_int_equal(gz_picture_maker_create(&maker, NULL, &joined->maker), GZ_OK);
	assert_int_equal(gz_picture_maker_show(joined->maker, joined->objects, object_count),
			 GZ_OK);
	assert_int_equal(gz_picture_make(joined->maker, &request, &joined->image, &joined->cost),
			 GZ_OK);
}

static struct gz_image copy_of(const struct gz_image *image)
{
	struct gz_image copy = { 0 };
	assert_int_equal(gz_image_resize(&copy, image->width, image->height), GZ_OK);
	memcpy(copy.pixels, image->pixels, (size_t)image->width * (size_t)image->height * 4);
	return copy;
}

/* A ray of the reference, world units; the direction has length 1. */
struct ray {
	double origin[3], direction[3];
};

static struct ray ray_of(const struct joined *joined, int x, int y)
{
	struct gz_ray_frame frame;
	struct ray ray;
	double length2 = 0;
	assert_int_equal(gz_camera_rays(&joined->camera, WIDTH, HEIGHT, &frame), GZ_OK);
	for (int axis = 0; axis < 3; axis++) {
		ray.origin[axis] = frame.origin00[axis] + x * frame.origin_dx[axis] +
				   y * frame.origin_dy[axis];
		ray.direction[axis] = frame.direction00[axis] + x * frame.direction_dx[axis] +
				      y * frame.direction_dy[axis];
		length2 += ray.direction[axis] * ray.direction[axis];
	}
	for (int axis = 0; axis < 3; axis++)
		ray.direction[axis] /= sqrt(length2);
	return ray;
}

/* Where a ray meets the ball, world units; INFINITY: nowhere. out_rim is how far it passes inside
 * the rim, or outside of it if negative, mm. */
static double meet_ball(const struct joined *joined, const struct ray *ray, double *out_rim)
{
	double along = 0, length2 = 0;
	for (int axis = 0; axis < 3; axis++) {
		const double to = joined->centre[axis] / EDGE - ray->origin[axis];
		along += to * ray->direction[axis];
		length2 += to * to;
	}
	const double radius = BALL_RADIUS / EDGE, across2 = length2 - along * along;
	*out_rim = BALL_RADIUS - sqrt(fmax(across2, 0)) * EDGE;
	return across2 < radius * radius ? along - sqrt(radius * radius - across2) : INFINITY;
}

/* The part of a ray in the box. */
static void cut_by_box(const struct ray *ray, double *from, double *to)
{
	*from = 0;
	*to = INFINITY;
	for (int axis = 0; axis < 3; axis++) {
		const double a = (-0.5 - ray->origin[axis]) / ray->direction[axis];
		const double b = (0.5 - ray->origin[axis]) / ray->direction[axis];
		*from = fmax(*from, fmin(a, b));
		*to = fmin(*to, fmax(a, b));
	}
}

/* The colour of a ray by brute force: steps of a sixth of a voxel up to the ball, 0 to 255. */
static void brute_force(const struct joined *joined, const struct ray *ray, double hit,
			double out_rgb[3])
{
	const double step = 1.0 / EDGE / 6;
	double from, to, through = 1, sum[3] = { 0 };
	cut_by_box(ray, &from, &to);
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
			const struct ray ray = ray_of(joined, x, y);
			const uint8_t *pixel = joined->image->pixels + 4 * (y * WIDTH + x);
			double rim, rgb[3];
			const double hit = meet_ball(joined, &ray, &rim);
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
		out_centre[axis] = share * CAMERA.eye[axis] * EDGE;
}

static void a_ball_in_a_field_equals_brute_force(void **state)
{
	(void)state;
	const char *const *sets = small_scene_simd_sets();
	for (size_t i = 0; i < sizeof places / sizeof places[0]; i++) {
		struct joined joined;
		double centre[3];
		place_of(places[i].share, centre);
		set_up(haze, centre, &joined);
		for (size_t set = 0; sets[set]; set++) {
			const struct gz_backend_params params = { .threads = 2, .simd = sets[set] };
			draw_by(&params, 2, &joined);
			const int met = check_picture(&joined, places[i].name);
			if (met < places[i].least_met)
				fail_msg("%s: only %d rays met the ball", places[i].name, met);
		}
		take_down(&joined);
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
		set_up(haze, centre, &joined);
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
		draw_by(&(struct gz_backend_params) { .threads = 1 }, 2, &joined);
		assert_true(check_picture(&joined, "way") > 0);
		take_down(&joined);
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
	set_up(clouds, centre, &joined);
	draw_by(&params, 1, &joined);
	struct gz_image alone = copy_of(joined.image);
	draw_by(&params, 2, &joined);
	for (int y = 0; y < HEIGHT; y++)
		for (int x = 0; x < WIDTH; x++) {
			const struct ray ray = ray_of(&joined, x, y);
			const size_t at = 4 * ((size_t)y * WIDTH + (size_t)x);
			double rim;
			(void)meet_ball(&joined, &ray, &rim);
			met += rim > RIM;
			if (rim < -RIM)
				assert_memory_equal(alone.pixels + at, joined.image->pixels + at,
						    4);
		}
	assert_true(met > 200);
	gz_image_free(&alone);
	take_down(&joined);
}

static void threads_give_the_same_bits_and_sets_nearly(void **state)
{
	(void)state;
	const char *const *sets = small_scene_simd_sets();
	struct gz_image portable = { 0 };
	struct joined joined;
	double centre[3];
	place_of(0.34, centre);
	set_up(clouds, centre, &joined);
	joined.foveation = small_scene_foveation();
	joined.foveation.acuity_slope *= 20;
	draw_by(&(struct gz_backend_params) { .threads = 1, .simd = "portable" }, 2, &joined);
	portable = copy_of(joined.image);
	for (size_t i = 0; sets[i]; i++) {
		struct gz_backend_params params = { .threads = 1, .simd = sets[i] };
		draw_by(&params, 2, &joined);
		struct gz_image one = copy_of(joined.image);
		/* Rays at the rim may meet the ball or not: few pixels. */
		assert_true(image_pixels_apart(&portable, &one) < 10);
		params.threads = 3;
		draw_by(&params, 2, &joined);
		assert_memory_equal(one.pixels, joined.image->pixels, (size_t)WIDTH * HEIGHT * 4);
		gz_image_free(&one);
	}
	gz_image_free(&portable);
	take_down(&joined);
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
	set_up(clouds, centre, &joined);
	draw_by(&params, 2, &joined);
	struct gz_image full = copy_of(joined.image);
	joined.foveation = small_scene_foveation();
	joined.foveation.acuity_slope *= 20; /* so that the rim is coarse */
	draw_by(&params, 2, &joined);
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
	take_down(&joined);
}

/* The volume's own surface inside the volume, as bone in skin. */
static void a_volume_hides_what_lies_behind_its_own_surface(void **state)
{
	(void)state;
	const struct gz_backend_params params = { .threads = 1 };
	const double far[3] = { 0, 0, 0 };
	struct joined joined;
	set_up(field_ball, far, &joined);
	joined.objects[1].mesh = NULL;
	joined.rays.surface.isovalue = 0; /* a ball of 20 mm */
	joined.transfer.range[0] = 0;     /* all that shows lies in the ball, ... */
	joined.transfer.range[1] = 20;
	joined.transfer.points[0].opacity = 0;
	draw_by(&params, 2, &joined);
	const uint8_t *middle = joined.image->pixels + 4 * (HEIGHT / 2 * WIDTH + WIDTH / 2);
	/* ... where no ray gets */
	assert_true(middle[0] == 51 && middle[1] == 204 && middle[2] == 102);
	take_down(&joined);
}

static void accumulation_starts_again_when_any_technique_changes(void **state)
{
	(void)state;
	const struct gz_temporal_params temporal = { .accumulate = true, .weight = 0.9 };
	const double centre[3] = { 0 };
	struct joined joined;
	set_up(clouds, centre, &joined);
	draw_by(&(struct gz_backend_params) { .threads = 1 }, 2, &joined);
	const struct gz_picture_request request = {
		.camera = &joined.camera,
		.settings = &joined.rays,
		.foveation = &joined.foveation,
		.display = &joined.display,
		.focus = gz_focus_at((struct gz_point) { 0.5F, 0.5F }),
		.width = WIDTH,
		.height = HEIGHT,
		.temporal = &temporal,
	};
	for (int picture = 0; picture < 3; picture++) {
		if (picture == 2)
			joined.rays.surface.colour[0] = 1; /* raycast does not use it */
		assert_int_equal(
			gz_picture_make(joined.maker, &request, &joined.image, &joined.cost),
			GZ_OK);
		assert_int_equal(joined.cost.kept, picture == 1);
	}
	take_down(&joined);
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
	set_up(clouds, centre, &joined);
	for (int plan = 0; plan < 2; plan++) {
		if (plan == 1)
			joined.foveation = small_scene_foveation();
		joined.backend = "cpu";
		draw_by(&(struct gz_backend_params) { .threads = 1 }, 2, &joined);
		struct gz_image by_cpu = copy_of(joined.image);
		joined.backend = "gl";
		draw_by(&(struct gz_backend_params) { .threads = 1 }, 2, &joined);
		assert_string_equal(gz_picture_maker_backend(joined.maker), "gl");
		assert_true(image_pixels_apart(&by_cpu, joined.image) < 10);
		gz_image_free(&by_cpu);
	}
	take_down(&joined);
}

/* One technique after two, and two after one: drawers that stay keep what they have made. */
static void objects_come_and_go(void **state)
{
	(void)state;
	const double centre[3] = { 0 };
	struct joined joined;
	set_up(clouds, centre, &joined);
	draw_by(&(struct gz_backend_params) { .threads = 1 }, 2, &joined);
	struct gz_image both = copy_of(joined.image);
	const struct gz_picture_request request = {
		.camera = &joined.camera,
		.settings = &joined.rays,
		.foveation = &joined.foveation,
		.display = &joined.display,
		.focus = gz_focus_at((struct gz_point) { 0.5F, 0.5F }),
		.width = WIDTH,
		.height = HEIGHT,
	};
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
	take_down(&joined);
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
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
