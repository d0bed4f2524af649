#include "drawing_planes.h"

#include <math.h>
#include <string.h>

#include "base/vector.h"

/* Corners of a triangle in the picture: x, y, 1 / w and depth. */
struct drawn_corner {
	double x, y, inverse, depth;
	const float *normal;
};

struct drawing {
	struct gz_ray_frame rays;
	struct gz_ray_inverse inverse;
	double light[3];
	struct drawing_planes *planes;
};

static void set_value(struct gz_plane *plane, size_t pixel, double value)
{
	const float stored = (float)value;
	memcpy(&plane->words[pixel], &stored, sizeof stored);
}

static void draw_pixel(const struct drawing *drawing, const struct drawn_corner corners[3],
		       const double shares[3], const int at[2])
{
	const struct gz_ray_frame *rays = &drawing->rays;
	struct drawing_planes *planes = drawing->planes;
	double inverse = 0, depth = 0, normal[3] = { 0 }, ray[3];
	for (int i = 0; i < 3; i++) {
		inverse += shares[i] * corners[i].inverse;
		depth += shares[i] * corners[i].inverse * corners[i].depth;
		for (int axis = 0; axis < 3; axis++)
			normal[axis] +=
				shares[i] * corners[i].inverse * (double)corners[i].normal[axis];
	}
	for (int axis = 0; axis < 3; axis++)
		ray[axis] = rays->direction00[axis] + at[0] * rays->direction_dx[axis] +
			    at[1] * rays->direction_dy[axis];
	const double distance = depth / inverse * gz_length3(ray);
	const size_t pixel = (size_t)at[1] * (size_t)planes->tone.width + (size_t)at[0];
	if (!(distance < (double)gz_plane_value(&planes->depth, at[0], at[1])))
		return;
	gz_normalise3(normal);
	set_value(&planes->depth, pixel, distance);
	set_value(&planes->tone, pixel, 0.5 + 0.5 * gz_dot3(normal, drawing->light));
	planes->ids.words[pixel] = 1;
}

static double doubled_area(const struct drawn_corner *a, const struct drawn_corner *b, double x,
			   double y)
{
	return (b->x - a->x) * (y - a->y) - (b->y - a->y) * (x - a->x);
}

static void draw_triangle(const struct drawing *drawing, const struct drawn_corner corners[3])
{
	const double area = doubled_area(&corners[0], &corners[1], corners[2].x, corners[2].y);
	const double least[2] = { fmin(corners[0].x, fmin(corners[1].x, corners[2].x)),
				  fmin(corners[0].y, fmin(corners[1].y, corners[2].y)) };
	const double most[2] = { fmax(corners[0].x, fmax(corners[1].x, corners[2].x)),
				 fmax(corners[0].y, fmax(corners[1].y, corners[2].y)) };
	const int width = drawing->planes->tone.width, height = drawing->planes->tone.height;
	if (area == 0 || most[0] < 0 || most[1] < 0 || least[0] > width || least[1] > height)
		return;
	for (int y = (int)fmax(0, ceil(least[1])); y <= fmin(height - 1, most[1]); y++)
		for (int x = (int)fmax(0, ceil(least[0])); x <= fmin(width - 1, most[0]); x++) {
			const double shares[3] = {
				doubled_area(&corners[1], &corners[2], x, y) / area,
				doubled_area(&corners[2], &corners[0], x, y) / area,
				doubled_area(&corners[0], &corners[1], x, y) / area,
			};
			if (shares[0] >= 0 && shares[1] >= 0 && shares[2] >= 0)
				draw_pixel(drawing, corners, shares, (const int[2]) { x, y });
		}
}

static enum gz_result clear_planes(const int size[2], struct drawing_planes *planes)
{
	enum gz_result result = gz_plane_resize(&planes->tone, GZ_PLANE_VALUE, size[0], size[1]);
	if (result == GZ_OK)
		result = gz_plane_resize(&planes->depth, GZ_PLANE_VALUE, size[0], size[1]);
	if (result == GZ_OK)
		result = gz_plane_resize(&planes->ids, GZ_PLANE_ID, size[0], size[1]);
	if (result != GZ_OK)
		return result;
	for (size_t i = 0; i < (size_t)size[0] * (size_t)size[1]; i++) {
		set_value(&planes->tone, i, 1);
		set_value(&planes->depth, i, INFINITY);
		planes->ids.words[i] = 0;
	}
	return GZ_OK;
}

static bool find_corner(const struct drawing *drawing, const float place[3], double world_per_mm,
			struct drawn_corner *out_corner)
{
	double world[3], at[4];
	for (int axis = 0; axis < 3; axis++)
		world[axis] = world_per_mm * (double)place[axis];
	gz_ray_inverse_point(&drawing->inverse, world, at);
	out_corner->x = at[0] / at[2];
	out_corner->y = at[1] / at[2];
	out_corner->inverse = 1 / at[2];
	out_corner->depth = at[3];
	return at[2] > 0;
}

enum gz_result drawing_planes_make(const struct gz_mesh *mesh, double world_per_mm,
				   const struct gz_camera *camera, const int size[2],
				   struct drawing_planes *planes)
{
	struct drawing drawing = { .planes = planes };
	enum gz_result result = gz_camera_rays(camera, size[0], size[1], &drawing.rays);
	if (result == GZ_OK && !gz_ray_inverse_make(&drawing.rays, &drawing.inverse))
		result = GZ_ERR_INVAL;
	if (result == GZ_OK)
		result = clear_planes(size, planes);
	if (result != GZ_OK)
		return result;
	/* from the upper left, and a little from the eye */
	const bool flat = drawing.inverse.orthographic;
	double right[3], down[3], forward[3];
	memcpy(right, flat ? drawing.rays.origin_dx : drawing.rays.direction_dx, sizeof right);
	memcpy(down, flat ? drawing.rays.origin_dy : drawing.rays.direction_dy, sizeof down);
	gz_normalise3(right);
	gz_normalise3(down);
	gz_cross3(right, down, forward);
	for (int axis = 0; axis < 3; axis++)
		drawing.light[axis] = -right[axis] - down[axis] - 0.8 * forward[axis];
	gz_normalise3(drawing.light);
	for (size_t i = 0; i < mesh->triangle_count; i++) {
		struct drawn_corner corners[3];
		bool in_front = true;
		for (int corner = 0; corner < 3; corner++) {
			const uint32_t vertex = mesh->triangles[i][corner];
			corners[corner].normal = mesh->normals[vertex];
			in_front &= find_corner(&drawing, mesh->positions[vertex], world_per_mm,
						&corners[corner]);
		}
		if (in_front)
			draw_triangle(&drawing, corners);
	}
	return GZ_OK;
}

void drawing_planes_free(struct drawing_planes *planes)
{
	gz_plane_free(&planes->tone);
	gz_plane_free(&planes->depth);
	gz_plane_free(&planes->ids);
}
