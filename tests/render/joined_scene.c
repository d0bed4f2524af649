#include "joined_scene.h"

/* cmocka.h wants these before it */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <math.h>
#include <string.h>

#include "render/mesh/isosurface.h"
#include "render/mesh/mesh_read.h"
#include "render/raycast/raycast.h"
#include "render/surface/isosurface_technique.h"

static const double EVEN[3] = { 1, 1, 1 };
static const int DIMS[3] = { EDGE, EDGE, EDGE };

const struct gz_camera JOINED_CAMERA = {
	.eye = { 0.9, -1.4, 0.7 },
	.up = { 0, 0, 1 },
	.fov_deg = 35,
};

static double small_ball(const double place[3])
{
	return BALL_RADIUS - sqrt(place[0] * place[0] + place[1] * place[1] + place[2] * place[2]);
}

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

void joined_set_up(field_formula *formula, const double centre[3], struct joined *joined)
{
	*joined = (struct joined) {
		.volume = field_volume(formula, DIMS, EVEN, GZ_VOXEL_F32),
		.transfer = { .has_range = true,
			      .range = { 0, 1 },
			      .count = 2,
			      .points = { { 0, { 1, 0.5, 0 }, 0.004 },
					  { 1, { 0, 0.5, 1 }, 0.08 } } },
		.camera = JOINED_CAMERA,
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

void joined_move_ball(const double centre[3], struct joined *joined)
{
	gz_mesh_free(&joined->ball);
	make_ball(centre, joined);
	joined->objects[1].data_revision++;
}

void joined_take_down(struct joined *joined)
{
	gz_picture_maker_destroy(&joined->maker);
	gz_mesh_free(&joined->ball);
	gz_volume_free(&joined->volume);
}

struct gz_picture_request joined_request(const struct joined *joined)
{
	return (struct gz_picture_request) {
		.camera = &joined->camera,
		.settings = &joined->rays,
		.foveation = &joined->foveation,
		.display = &joined->display,
		.focus = gz_focus_at((struct gz_point) { 0.5F, 0.5F }),
		.width = WIDTH,
		.height = HEIGHT,
	};
}

void joined_draw(const struct gz_backend_params *params, size_t object_count, struct joined *joined)
{
	const struct gz_picture_maker_params maker = { .backend = joined->backend,
						       .backend_params = *params };
	const struct gz_picture_request request = joined_request(joined);
	gz_picture_maker_destroy(&joined->maker);
	assert_int_equal(gz_picture_maker_create(&maker, NULL, &joined->maker), GZ_OK);
	assert_int_equal(gz_picture_maker_show(joined->maker, joined->objects, object_count),
			 GZ_OK);
	assert_int_equal(gz_picture_make(joined->maker, &request, &joined->image, &joined->cost),
			 GZ_OK);
}

struct gz_image joined_copy(const struct gz_image *image)
{
	struct gz_image copy = { 0 };
	assert_int_equal(gz_image_resize(&copy, image->width, image->height), GZ_OK);
	memcpy(copy.pixels, image->pixels, (size_t)image->width * (size_t)image->height * 4);
	return copy;
}

struct ray joined_ray(const struct joined *joined, int x, int y)
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

double joined_meet_ball(const struct joined *joined, const struct ray *ray, double *out_rim)
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

void joined_cut_by_box(const struct ray *ray, double *from, double *to)
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
