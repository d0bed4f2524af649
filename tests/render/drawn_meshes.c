#include "drawn_meshes.h"

#include "suite.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/vector.h"

#define PI 3.14159265358979323846

enum { COLUMNS = 64, ROWS = 32, STROKE_POINTS = 20000 };

static void place_vertex(enum drawn_body body, double u, double v, float place[3], float normal[3])
{
	if (body == DRAWN_BOARD) {
		place[0] = (float)(DRAWN_BOARD_MM * (u - 0.5));
		place[1] = (float)(DRAWN_BOARD_MM * (v - 0.5));
		place[2] = normal[0] = normal[1] = 0;
		normal[2] = 1;
		return;
	}
	normal[0] = (float)(sin(PI * v) * cos(2 * PI * u));
	normal[1] = (float)(sin(PI * v) * sin(2 * PI * u));
	normal[2] = (float)-cos(PI * v);
	for (int axis = 0; axis < 3; axis++)
		place[axis] = (float)DRAWN_BALL_MM * normal[axis];
}

struct gz_mesh drawn_mesh(enum drawn_body body)
{
	struct gz_mesh mesh;
	assert_int_equal(gz_mesh_allocate((COLUMNS + 1) * (ROWS + 1), 2 * COLUMNS * ROWS, &mesh),
			 GZ_OK);
	for (uint32_t row = 0; row <= ROWS; row++)
		for (uint32_t column = 0; column <= COLUMNS; column++) {
			const size_t vertex = (size_t)row * (COLUMNS + 1) + column;
			place_vertex(body, (double)column / COLUMNS, (double)row / ROWS,
				     mesh.positions[vertex], mesh.normals[vertex]);
		}
	for (uint32_t i = 0; i < COLUMNS * ROWS; i++) {
		const uint32_t a = i / COLUMNS * (COLUMNS + 1) + i % COLUMNS, b = a + COLUMNS + 1;
		const uint32_t both[2][3] = { { a, a + 1, b }, { a + 1, b + 1, b } };
		memcpy(mesh.triangles[2 * (size_t)i], both, sizeof both);
	}
	return mesh;
}

/* Directions that go round the y axis. */
static void find_directions(const struct gz_mesh *mesh, float (*directions)[3])
{
	for (size_t i = 0; i < mesh->vertex_count; i++) {
		const float sign = i % 2 ? -1 : 1; /* it does not count */
		directions[i][0] = sign * mesh->normals[i][2];
		directions[i][1] = 0;
		directions[i][2] = -sign * mesh->normals[i][0];
	}
}

enum gz_result drawn_strokes_make(const struct gz_mesh *mesh, int layers,
				  struct gz_hatch_strokes *out_strokes)
{
	struct gz_mesh_points points;
	float(*directions)[3] = malloc(mesh->vertex_count * sizeof *directions);
	assert_non_null(directions);
	find_directions(mesh, directions);
	const enum gz_result made = gz_mesh_points_make(mesh, STROKE_POINTS, NULL, NULL, &points);
	enum gz_result result = made;
	for (int layer = 0; layer < layers && result == GZ_OK; layer++) {
		if (layer == 1)
			gz_hatch_cross_directions(mesh, (const float(*)[3])directions, directions);
		result = gz_hatch_strokes_make(mesh, (const float(*)[3])directions, &points,
					       DRAWN_STROKE_MM, NULL, &out_strokes[layer]);
	}
	free(directions);
	if (made == GZ_OK)
		gz_mesh_points_free(&points);
	return result;
}

void drawn_set_value(struct gz_plane *plane, int x, int y, float value)
{
	memcpy(&plane->words[(ptrdiff_t)y * plane->width + x], &value, sizeof value);
}

/* How far along a unit vector a ray meets a body, mm; INFINITY if it does not. */
static double meet_body(enum drawn_body body, const double origin[3], const double way[3])
{
	if (body == DRAWN_BOARD) {
		const double t = -origin[2] / way[2];
		const double half = DRAWN_BOARD_MM / 2;
		return t > 0 && fabs(origin[0] + t * way[0]) <= half &&
				       fabs(origin[1] + t * way[1]) <= half
			       ? t
			       : INFINITY;
	}
	const double along = gz_dot3(origin, way);
	const double rest = along * along - gz_dot3(origin, origin) + DRAWN_BALL_MM * DRAWN_BALL_MM;
	return rest > 0 ? -along - sqrt(rest) : INFINITY;
}

static double meet_pixel(enum drawn_body body, const struct gz_ray_frame *rays, int x, int y)
{
	double origin[3], way[3];
	for (int axis = 0; axis < 3; axis++) {
		origin[axis] = 100 * (rays->origin00[axis] + x * rays->origin_dx[axis] +
				      y * rays->origin_dy[axis]);
		way[axis] = rays->direction00[axis] + x * rays->direction_dx[axis] +
			    y * rays->direction_dy[axis];
	}
	assert_true(gz_normalise3(way));
	return meet_body(body, origin, way);
}

void drawn_picture_make(enum drawn_body body, const struct gz_camera *camera, int edge_px,
			float tone, struct drawn_picture *picture)
{
	assert_int_equal(gz_camera_rays(camera, edge_px, edge_px, &picture->rays), GZ_OK);
	assert_int_equal(gz_plane_resize(&picture->tone, GZ_PLANE_VALUE, edge_px, edge_px), GZ_OK);
	assert_int_equal(gz_plane_resize(&picture->depth, GZ_PLANE_VALUE, edge_px, edge_px), GZ_OK);
	assert_int_equal(gz_plane_resize(&picture->ids, GZ_PLANE_ID, edge_px, edge_px), GZ_OK);
	for (int y = 0; y < edge_px; y++)
		for (int x = 0; x < edge_px; x++) {
			const double distance = meet_pixel(body, &picture->rays, x, y);
			drawn_set_value(&picture->tone, x, y, tone);
			drawn_set_value(&picture->depth, x, y, (float)(distance / 100));
			picture->ids.words[y * edge_px + x] = isfinite(distance);
		}
	picture->view = (struct gz_stipple_view) { .rays = &picture->rays,
						   .world_per_mm = 0.01,
						   .tone = &picture->tone,
						   .depth = &picture->depth,
						   .ids = &picture->ids,
						   .id = 1,
						   .size_px = 1.2,
						   .tolerance_px = GZ_STIPPLE_TOLERANCE_PX };
}

void drawn_picture_free(struct drawn_picture *picture)
{
	gz_plane_free(&picture->tone);
	gz_plane_free(&picture->depth);
	gz_plane_free(&picture->ids);
}

struct gz_camera drawn_camera(enum gz_projection projection, double height, double tilt_deg)
{
	const double tilt = tilt_deg * PI / 180;
	const double away = projection == GZ_PROJECTION_ORTHOGRAPHIC ? 3 : height / 100;
	return (struct gz_camera) { .eye = { 0, -away * sin(tilt), away * cos(tilt) },
				    .up = { 0, 1, 0 },
				    .fov_deg = 60,
				    .height = height / 100,
				    .projection = projection };
}
