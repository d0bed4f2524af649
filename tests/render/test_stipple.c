/* Stipples: which points show, how dark the drawing is, and how it is written for print. */
#include "suite.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/workers.h"
#include "drawn_meshes.h"
#include "kept_files.h"
#include "render/illustration/cached_points.h"
#include "render/illustration/stipple_png.h"
#include "render/illustration/stipple_points.h"
#include "render/illustration/stipple_sheet.h"
#include "render/illustration/stipple_svg.h"
#include "render/illustration/stipple_tone.h"
#include "render/mesh/point_grid.h"

enum { POINTS = 40000, EDGE = 200 };

/* The points of both bodies, which the tests share. */
static struct gz_mesh_points made_points[2];
static struct gz_stipple_points points_of[2];

static int make_points(void **state)
{
	(void)state;
	for (int body = 0; body < 2; body++) {
		struct gz_mesh mesh = drawn_mesh((enum drawn_body)body);
		if (gz_mesh_points_make(&mesh, POINTS, NULL, NULL, &made_points[body]) != GZ_OK ||
		    gz_stipple_points_make(&mesh, &made_points[body], &points_of[body]) != GZ_OK)
			return -1;
		gz_mesh_free(&mesh);
	}
	return 0;
}

static int free_points(void **state)
{
	(void)state;
	for (int body = 0; body < 2; body++) {
		gz_mesh_points_free(&made_points[body]);
		gz_stipple_points_free(&points_of[body]);
	}
	return 0;
}

static struct gz_stipple_discs discs_of(enum drawn_body body, const struct drawn_picture *picture)
{
	struct gz_stipple_discs discs = { 0 };
	assert_int_equal(gz_stipple_choose(&points_of[body], &picture->view, NULL, &discs), GZ_OK);
	return discs;
}

static struct gz_stipple_sheet sheet_of(const struct gz_stipple_discs *discs, int edge)
{
	struct gz_stipple_sheet sheet = { 0 };
	assert_int_equal(gz_stipple_sheet_clear(&sheet, edge, edge), GZ_OK);
	assert_int_equal(gz_stipple_sheet_add_discs(&sheet, discs->discs, discs->count, NULL),
			 GZ_OK);
	return sheet;
}

static double mean_ink(const struct gz_stipple_sheet *sheet, int from_x, int to_x, int from_y,
		       int to_y)
{
	double sum = 0;
	for (int y = from_y; y < to_y; y++)
		for (int x = from_x; x < to_x; x++)
			sum += sheet->ink[(size_t)y * sheet->stride + (size_t)x];
	return sum / 255 / (to_x - from_x) / (to_y - from_y);
}

/* A shading map that darkens from left to right is drawn as dark as it is, by ten columns. */
static void check_ramp(double radius, double tilt_deg, double height)
{
	enum { STEPS = 10, MARGIN = 12 };
	struct drawn_picture picture = { 0 };
	const struct gz_camera camera = drawn_camera(GZ_PROJECTION_ORTHOGRAPHIC, height, tilt_deg);
	drawn_picture_make(DRAWN_BOARD, &camera, EDGE, 1, &picture);
	picture.view.size_px = radius;
	for (int y = 0; y < EDGE; y++)
		for (int x = 0; x < EDGE; x++)
			drawn_set_value(&picture.tone, x, y, 1 - ((float)x + 0.5F) / EDGE);
	struct gz_stipple_discs discs = discs_of(DRAWN_BOARD, &picture);
	struct gz_stipple_sheet sheet = sheet_of(&discs, EDGE);
	const int rows = (int)(EDGE * cos(tilt_deg * 3.14159265 / 180) * 100 / height) / 2 - MARGIN;
	for (int step = 0; step < STEPS; step++) {
		const int from = MARGIN + step * (EDGE - 2 * MARGIN) / STEPS;
		const int to = MARGIN + (step + 1) * (EDGE - 2 * MARGIN) / STEPS;
		const double wanted = (from + to) / 2.0 / EDGE;
		const double drawn = mean_ink(&sheet, from, to, EDGE / 2 - rows, EDGE / 2 + rows);
		if (fabs(drawn - wanted) > 0.05)
			fail_msg("radius %g, tilt %g: ink %.3f instead of %.3f", radius, tilt_deg,
				 drawn, wanted);
	}
	gz_stipple_sheet_free(&sheet);
	gz_stipple_discs_free(&discs);
	drawn_picture_free(&picture);
}

static void drawing_is_as_dark_as_the_shading_map(void **state)
{
	(void)state;
	check_ramp(0.6, 0, 100);
	check_ramp(1.2, 0, 100);
	check_ramp(3, 0, 100);
}

static void slanted_surface_is_as_dark_as_the_shading_map(void **state)
{
	(void)state;
	check_ramp(1.2, 45, 100);
	check_ramp(1.2, 70, 100);
}

static void close_view_with_too_few_points_keeps_its_tone(void **state)
{
	(void)state;
	/* 8 mm of the board hold 256 points; the darkest tone asks for more than ten thousand */
	struct drawn_picture picture = { 0 };
	const struct gz_camera camera = drawn_camera(GZ_PROJECTION_ORTHOGRAPHIC, 16, 0);
	drawn_picture_make(DRAWN_BOARD, &camera, EDGE, 0.5F, &picture);
	struct gz_stipple_discs discs = discs_of(DRAWN_BOARD, &picture);
	struct gz_stipple_sheet sheet = sheet_of(&discs, EDGE);
	assert_true(discs.discs[0].radius > 1.5F);
	assert_float_equal(mean_ink(&sheet, 10, EDGE - 10, 10, EDGE - 10), 0.5, 0.05);
	gz_stipple_sheet_free(&sheet);
	gz_stipple_discs_free(&discs);
	drawn_picture_free(&picture);
}

static void grey_ball_is_grey_up_to_its_rim(void **state)
{
	(void)state;
	struct drawn_picture picture = { 0 };
	const struct gz_camera camera = drawn_camera(GZ_PROJECTION_PERSPECTIVE, 200, 0);
	drawn_picture_make(DRAWN_BALL, &camera, EDGE, 0.6F, &picture);
	struct gz_stipple_discs discs = discs_of(DRAWN_BALL, &picture);
	struct gz_stipple_sheet sheet = sheet_of(&discs, EDGE);
	/* the outline's radius: tan(asin(50 / 200)) / tan(30 degrees) of half the edge */
	const double outline = 0.44721 * EDGE / 2;
	double sums[5] = { 0 }, counts[5] = { 0 };
	for (int y = 0; y < EDGE; y++)
		for (int x = 0; x < EDGE; x++) {
			const double r = hypot(x - (EDGE - 1) / 2.0, y - (EDGE - 1) / 2.0);
			const size_t ring = (size_t)(5 * r / (outline - 2));
			if (ring < 5) {
				sums[ring] += sheet.ink[(size_t)y * sheet.stride + (size_t)x];
				counts[ring]++;
			}
		}
	for (size_t ring = 0; ring < 5; ring++)
		assert_float_equal(sums[ring] / counts[ring] / 255, 0.4, 0.05);
	gz_stipple_sheet_free(&sheet);
	gz_stipple_discs_free(&discs);
	drawn_picture_free(&picture);
}

static void mark_shown(enum drawn_body body, const struct drawn_picture *picture, bool *shown)
{
	for (size_t i = 0; i < POINTS; i++)
		shown[i] = gz_stipple_shows(&points_of[body], &picture->view, i);
}

static size_t count_lost(const bool *before, const bool *after)
{
	size_t lost = 0;
	for (size_t i = 0; i < POINTS; i++)
		lost += before[i] && !after[i];
	return lost;
}

/* Going nearer in small steps, no point of the middle of the board is lost. */
static void check_nearing(enum gz_projection projection, double far, double near)
{
	enum { STEPS = 8 }; /* of 12 % more area each */
	bool *before = calloc(POINTS, 1), *after = calloc(POINTS, 1);
	assert_true(before && after);
	struct drawn_picture picture = { 0 };
	size_t first = 0, last = 0;
	for (int step = 0; step <= STEPS; step++) {
		const double height = far * pow(near / far, (double)step / STEPS);
		const struct gz_camera camera = drawn_camera(projection, height, 0);
		drawn_picture_make(DRAWN_BOARD, &camera, EDGE, 0.5F, &picture);
		mark_shown(DRAWN_BOARD, &picture, after);
		last = 0;
		for (size_t i = 0; i < POINTS; i++) {
			/* the others leave the picture */
			const float *place = points_of[DRAWN_BOARD].places[i];
			after[i] = after[i] && fabsf(place[0]) < 20 && fabsf(place[1]) < 20;
			last += after[i];
		}
		assert_int_equal(count_lost(before, after), 0);
		first = step == 0 ? last : first;
		memcpy(before, after, POINTS);
	}
	assert_true(first > 100 && last > 2 * first);
	drawn_picture_free(&picture);
	free(before);
	free(after);
}

static void zoom_only_adds_points(void **state)
{
	(void)state;
	check_nearing(GZ_PROJECTION_ORTHOGRAPHIC, 160, 100);
}

static void dolly_only_adds_points(void **state)
{
	(void)state;
	check_nearing(GZ_PROJECTION_PERSPECTIVE, 160, 100);
}

static void turning_ball_shows_the_first_points_of_each_place(void **state)
{
	(void)state;
	/* From any side, of two points on one triangle the later one shows only if the first one
	 * does: what is shown changes with the angle, and nothing else. */
	struct gz_mesh mesh = drawn_mesh(DRAWN_BALL);
	bool *shown = calloc(POINTS, 1);
	uint32_t *first_hidden = malloc(mesh.triangle_count * sizeof *first_hidden);
	assert_true(shown && first_hidden);
	const struct gz_stipple_points *drawn = &points_of[DRAWN_BALL];
	struct drawn_picture picture = { 0 };
	size_t compared = 0;
	for (int turn = 0; turn < 4; turn++) {
		const struct gz_camera camera =
			drawn_camera(GZ_PROJECTION_ORTHOGRAPHIC, 110, 7.0 * turn);
		drawn_picture_make(DRAWN_BALL, &camera, EDGE, 0.7F, &picture);
		mark_shown(DRAWN_BALL, &picture, shown);
		memset(first_hidden, 0xff, mesh.triangle_count * sizeof *first_hidden);
		for (int pass = 0; pass < 2; pass++)
			for (size_t i = 0; i < POINTS; i++) {
				const double facing =
					(double)drawn->normals[i][2] * camera.eye[2] / 3 +
					(double)drawn->normals[i][1] * camera.eye[1] / 3;
				const uint32_t rank = drawn->ranks[i];
				uint32_t *hidden =
					&first_hidden
						[made_points[DRAWN_BALL].points[rank].triangle];
				if (facing < 0.3) /* may be hidden behind the rim */
					continue;
				if (pass == 0 && !shown[i])
					*hidden = rank < *hidden ? rank : *hidden;
				if (pass == 1 && shown[i]) {
					assert_true(rank < *hidden);
					compared++;
				}
			}
	}
	assert_true(compared > 1000);
	drawn_picture_free(&picture);
	free(shown);
	free(first_hidden);
	gz_mesh_free(&mesh);
}

/* What share of all points' ranks may show at a point of the ball: by the rule, written anew. A
 * projection shrinks an area by the cosine of its slant and by the square of its distance, and rays
 * off the axis stretch it. Returns false where it might be hidden or out of the picture. */
static bool share_of_ball(const struct gz_stipple_points *points, size_t i,
			  const struct gz_camera *camera, float tone, double *out_share)
{
	double from[3], away2 = 0, facing = 0, axis_mm = 0, eye2 = 0, down = 0;
	for (int axis = 0; axis < 3; axis++) {
		const double eye = 100 * camera->eye[axis];
		from[axis] = (double)points->places[i][axis] - eye;
		away2 += from[axis] * from[axis];
		facing -= from[axis] * (double)points->normals[i][axis];
		axis_mm -= from[axis] * eye;
		eye2 += eye * eye;
	}
	axis_mm /= sqrt(eye2);
	facing /= sqrt(away2);
	const double half = axis_mm * tan(camera->fov_deg / 2 * 3.14159265358979 / 180);
	down = sqrt(fmax(0, away2 - axis_mm * axis_mm));
	if (facing < 0.25 || down > 0.9 * half)
		return false;
	/* px² of a mm²: facing / cos of the angle to the axis, over the pixel's area there */
	const double pixel_mm = 2 * half / EDGE;
	const double px2_per_mm2 = facing * sqrt(away2) / axis_mm / (pixel_mm * pixel_mm);
	*out_share = px2_per_mm2 * (double)gz_stipple_density(1 - tone, (float)facing, 1.2F);
	return true;
}

/* What changes from one picture to the next may only follow the rule: a point that comes has a
 * greater share than before, and one that goes a smaller one. */
static void check_nesting(const struct gz_camera *cameras, int count, float tone)
{
	const struct gz_stipple_points *points = &points_of[DRAWN_BALL];
	static bool shown[2][POINTS];
	static double shares[2][POINTS];
	struct drawn_picture picture = { 0 };
	size_t compared = 0, come = 0, gone = 0, violations = 0;
	for (int step = 0; step < count; step++) {
		const int now = step % 2, before = 1 - now;
		drawn_picture_make(DRAWN_BALL, &cameras[step], EDGE, tone, &picture);
		mark_shown(DRAWN_BALL, &picture, shown[now]);
		for (size_t i = 0; i < POINTS; i++) {
			if (!share_of_ball(points, i, &cameras[step], tone, &shares[now][i]))
				shares[now][i] = 0;
			if (step == 0 || shares[now][i] == 0 || shares[before][i] == 0)
				continue;
			const double ratio = shares[now][i] / shares[before][i];
			compared++;
			come += !shown[before][i] && shown[now][i];
			gone += shown[before][i] && !shown[now][i];
			violations += !shown[before][i] && shown[now][i] && ratio < 1 - 1e-4;
			violations += shown[before][i] && !shown[now][i] && ratio > 1 + 1e-4;
		}
	}
	if (violations > 0)
		fail_msg("tone %g: %zu violations of %zu", (double)tone, violations, compared);
	assert_true(compared > 20000 && come + gone > 20);
	drawn_picture_free(&picture);
}

static void dolly_and_turn_of_a_ball_follow_the_rule(void **state)
{
	(void)state;
	enum { STEPS = 12 };
	const float tones[] = { 0.85F, 0.6F, 0.35F, 0.15F };
	struct gz_camera dolly[STEPS], turn[STEPS], both[STEPS];
	for (int step = 0; step < STEPS; step++) {
		dolly[step] = drawn_camera(GZ_PROJECTION_PERSPECTIVE, 260 - 10 * step, 15);
		turn[step] = drawn_camera(GZ_PROJECTION_PERSPECTIVE, 170, 4.0 * step);
		both[step] = drawn_camera(GZ_PROJECTION_PERSPECTIVE, 150 + 8 * step, 3.0 * step);
	}
	for (size_t i = 0; i < sizeof tones / sizeof tones[0]; i++) {
		check_nesting(dolly, STEPS, tones[i]);
		check_nesting(turn, STEPS, tones[i]);
		check_nesting(both, STEPS, tones[i]);
	}
}

static void hidden_points_do_not_shine_through(void **state)
{
	(void)state;
	/* Over a part of the picture something lies 3 pixels nearer than the board. */
	struct drawn_picture picture = { 0 };
	const struct gz_camera camera = drawn_camera(GZ_PROJECTION_ORTHOGRAPHIC, 100, 30);
	drawn_picture_make(DRAWN_BOARD, &camera, EDGE, 0.3F, &picture);
	struct gz_stipple_discs free_view = discs_of(DRAWN_BOARD, &picture);
	for (int y = 80; y < 120; y++)
		for (int x = 50; x < 150; x++)
			drawn_set_value(&picture.depth, x, y,
					gz_plane_value(&picture.depth, x, y) - 0.015F);
	struct gz_stipple_discs discs = discs_of(DRAWN_BOARD, &picture);
	size_t within = 0;
	for (size_t i = 0; i < free_view.count; i++)
		within += free_view.discs[i].x >= 49.5F && free_view.discs[i].x < 149.5F &&
			  free_view.discs[i].y >= 79.5F && free_view.discs[i].y < 119.5F;
	assert_true(within > 300);
	assert_int_equal(discs.count, free_view.count - within);
	gz_stipple_discs_free(&discs);
	gz_stipple_discs_free(&free_view);
	drawn_picture_free(&picture);
}

static void far_side_of_a_ball_is_not_drawn(void **state)
{
	(void)state;
	/* The far side shows only if backs are drawn and nothing is in front of them. */
	struct drawn_picture picture = { 0 };
	const struct gz_camera camera = drawn_camera(GZ_PROJECTION_ORTHOGRAPHIC, 110, 0);
	drawn_picture_make(DRAWN_BALL, &camera, EDGE, 0.5F, &picture);
	picture.view.backs = true;
	for (size_t i = 0; i < POINTS; i++)
		assert_false(points_of[DRAWN_BALL].places[i][2] < -10 &&
			     gz_stipple_shows(&points_of[DRAWN_BALL], &picture.view, i));
	drawn_picture_free(&picture);
}

static void board_from_behind_shows_only_with_backs(void **state)
{
	(void)state;
	struct drawn_picture picture = { 0 };
	const struct gz_camera camera = drawn_camera(GZ_PROJECTION_PERSPECTIVE, 150, 180);
	drawn_picture_make(DRAWN_BOARD, &camera, EDGE, 0.5F, &picture);
	struct gz_stipple_discs discs = discs_of(DRAWN_BOARD, &picture);
	assert_int_equal(discs.count, 0);
	picture.view.backs = true;
	gz_stipple_discs_free(&discs);
	discs = discs_of(DRAWN_BOARD, &picture);
	assert_true(discs.count > 1000);
	gz_stipple_discs_free(&discs);
	drawn_picture_free(&picture);
}

static void points_of_other_objects_are_not_drawn(void **state)
{
	(void)state;
	struct drawn_picture picture = { 0 };
	const struct gz_camera camera = drawn_camera(GZ_PROJECTION_PERSPECTIVE, 150, 0);
	drawn_picture_make(DRAWN_BOARD, &camera, EDGE, 0.5F, &picture);
	picture.view.id = 2;
	struct gz_stipple_discs discs = discs_of(DRAWN_BOARD, &picture);
	assert_int_equal(discs.count, 0);
	gz_stipple_discs_free(&discs);
	drawn_picture_free(&picture);
}

static void culling_loses_no_point(void **state)
{
	(void)state;
	/* Near the ball most of it is out of the picture, turned away or behind the eye. */
	struct drawn_picture picture = { 0 };
	const struct gz_camera cameras[3] = { drawn_camera(GZ_PROJECTION_PERSPECTIVE, 60, 20),
					      drawn_camera(GZ_PROJECTION_ORTHOGRAPHIC, 30, 50),
					      drawn_camera(GZ_PROJECTION_PERSPECTIVE, 400, 0) };
	for (int i = 0; i < 3; i++) {
		drawn_picture_make(DRAWN_BALL, &cameras[i], EDGE, 0.5F, &picture);
		struct gz_stipple_discs discs = discs_of(DRAWN_BALL, &picture);
		size_t shown = 0;
		for (size_t point = 0; point < POINTS; point++)
			shown += gz_stipple_shows(&points_of[DRAWN_BALL], &picture.view, point);
		assert_int_equal(discs.count, shown);
		assert_true(shown > 50);
		gz_stipple_discs_free(&discs);
	}
	drawn_picture_free(&picture);
}

/* The tilt of both sides of a valley. */
#define VALLEY_TILT_DEG 20.0

/* A valley along y, whose points are one cluster: both sides rise from x = 0. */
static struct gz_stipple_points valley_points(void)
{
	enum { VALLEY_POINTS = 200 };
	static const uint32_t triangles[4][3] = {
		{ 0, 1, 3 }, { 1, 4, 3 }, { 1, 2, 4 }, { 2, 5, 4 }
	};
	const float rise = (float)(20 * tan(VALLEY_TILT_DEG * 3.14159265 / 180));
	struct gz_mesh mesh;
	struct gz_mesh_points points;
	struct gz_stipple_points valley;
	assert_int_equal(gz_mesh_allocate(6, 4, &mesh), GZ_OK);
	for (int i = 0; i < 6; i++) {
		const int column = i % 3 - 1;
		const float position[3] = { 20 * (float)column, 10 * (float)(i / 3) - 5,
					    column == 0 ? 0 : rise };
		memcpy(mesh.positions[i], position, sizeof position);
		memcpy(mesh.normals[i], (const float[3]) { 0, 0, 1 }, sizeof mesh.normals[i]);
	}
	memcpy(mesh.triangles, triangles, sizeof triangles);
	assert_int_equal(gz_mesh_points_make(&mesh, VALLEY_POINTS, NULL, NULL, &points), GZ_OK);
	assert_int_equal(gz_stipple_points_make(&mesh, &points, &valley), GZ_OK);
	assert_int_equal(valley.cluster_count, 1);
	gz_mesh_points_free(&points);
	gz_mesh_free(&mesh);
	return valley;
}

/* How many discs a view has: one for each point that shows by itself. */
static size_t count_discs(const struct gz_stipple_points *points,
			  const struct gz_stipple_view *view)
{
	struct gz_stipple_discs discs = { 0 };
	size_t shown = 0;
	assert_int_equal(gz_stipple_choose(points, view, NULL, &discs), GZ_OK);
	for (size_t i = 0; i < points->count; i++)
		shown += gz_stipple_shows(points, view, i);
	assert_int_equal(discs.count, shown);
	gz_stipple_discs_free(&discs);
	return shown;
}

static void culling_knows_how_far_a_cluster_reaches(void **state)
{
	(void)state;
	/* The eye is a little above the plane of the left side, and below a parallel plane through
	 * the middle of the cluster: seen from there, the left side would be turned away. Nothing
	 * is hidden, so that this alone decides. */
	enum { SMALL = 40 };
	struct gz_stipple_points points = valley_points();
	size_t shown = 0;
	struct drawn_picture picture = { 0 };
	struct gz_camera camera = drawn_camera(GZ_PROJECTION_PERSPECTIVE, 100, 0);
	drawn_picture_make(DRAWN_BOARD, &camera, SMALL, 0, &picture);
	picture.view.ids = NULL;
	picture.view.tolerance_px = 1e6;
	picture.view.size_px = 0.25;
	for (int away = 30; away <= 120; away += 15) {
		const double tilt = VALLEY_TILT_DEG * 3.14159265 / 180;
		camera.eye[0] = away / 100.0;
		camera.eye[2] = (2 - away * sin(tilt)) / cos(tilt) / 100;
		assert_int_equal(gz_camera_rays(&camera, SMALL, SMALL, &picture.rays), GZ_OK);
		shown += count_discs(&points, &picture.view);
	}
	assert_true(shown > 10);
	gz_stipple_points_free(&points);
	drawn_picture_free(&picture);
}

static void drawing_is_the_same_for_any_number_of_threads(void **state)
{
	(void)state;
	struct drawn_picture picture = { 0 };
	struct gz_workers *workers;
	const struct gz_camera camera = drawn_camera(GZ_PROJECTION_PERSPECTIVE, 150, 10);
	drawn_picture_make(DRAWN_BALL, &camera, EDGE, 0.2F, &picture);
	assert_int_equal(gz_workers_create(3, &workers), GZ_OK);
	struct gz_stipple_discs alone = discs_of(DRAWN_BALL, &picture), shared = { 0 };
	assert_int_equal(gz_stipple_choose(&points_of[DRAWN_BALL], &picture.view, workers, &shared),
			 GZ_OK);
	assert_int_equal(shared.count, alone.count);
	assert_memory_equal(shared.discs, alone.discs, alone.count * sizeof *alone.discs);
	struct gz_stipple_sheet one = sheet_of(&alone, EDGE), other = { 0 };
	assert_int_equal(gz_stipple_sheet_clear(&other, EDGE, EDGE), GZ_OK);
	assert_int_equal(gz_stipple_sheet_add_discs(&other, shared.discs, shared.count, workers),
			 GZ_OK);
	assert_memory_equal(one.ink, other.ink, one.stride * EDGE);
	gz_workers_destroy(&workers);
	gz_stipple_sheet_free(&one);
	gz_stipple_sheet_free(&other);
	gz_stipple_discs_free(&alone);
	gz_stipple_discs_free(&shared);
	drawn_picture_free(&picture);
}

static void discs_grow_away_from_the_gaze_and_tone_stays(void **state)
{
	(void)state;
	struct drawn_picture picture = { 0 };
	struct gz_stipple_scale scale = { 0 };
	const struct gz_camera camera = drawn_camera(GZ_PROJECTION_ORTHOGRAPHIC, 90, 0);
	const struct gz_foveation foveation = gz_foveation_default();
	const struct gz_display display = { .px = { 1000, 1000 },
					    .mm = { 300, 300 },
					    .distance_mm = 400 };
	drawn_picture_make(DRAWN_BOARD, &camera, 2 * EDGE, 0.5F, &picture);
	assert_int_equal(gz_stipple_scale_make(&foveation, &display, (struct gz_point) { 0, 0.5F },
					       2 * EDGE, 2 * EDGE, &scale),
			 GZ_OK);
	assert_float_equal(gz_stipple_scale_at(&scale, 0, EDGE), 1, 0.01);
	const float far = gz_stipple_scale_at(&scale, 2 * EDGE, EDGE);
	assert_true(far > 1.5F);
	picture.view.scale = &scale;
	struct gz_stipple_discs discs = discs_of(DRAWN_BOARD, &picture);
	struct gz_stipple_sheet sheet = sheet_of(&discs, 2 * EDGE);
	for (size_t i = 0; i < discs.count; i++)
		assert_float_equal(
			discs.discs[i].radius,
			1.2F * gz_stipple_scale_at(&scale, discs.discs[i].x, discs.discs[i].y),
			1e-4);
	for (int from = 10; from + 76 < 2 * EDGE; from += 76)
		assert_float_equal(mean_ink(&sheet, from, from + 76, 10, 2 * EDGE - 10), 0.5, 0.05);
	gz_stipple_sheet_free(&sheet);
	gz_stipple_discs_free(&discs);
	gz_stipple_scale_free(&scale);
	drawn_picture_free(&picture);
}

static void view_out_of_range_is_refused(void **state)
{
	(void)state;
	struct drawn_picture picture = { 0 };
	struct gz_stipple_discs discs = { 0 };
	const struct gz_camera camera = drawn_camera(GZ_PROJECTION_ORTHOGRAPHIC, 90, 0);
	drawn_picture_make(DRAWN_BOARD, &camera, 16, 0.5F, &picture);
	const struct gz_stipple_view valid = picture.view;
	struct gz_stipple_view views[5] = { valid, valid, valid, valid, valid };
	views[0].size_px = 0.2;
	views[1].size_px = NAN;
	views[2].depth = NULL;
	views[3].ids = &picture.depth;
	views[4].world_per_mm = 0;
	for (int i = 0; i < 5; i++)
		assert_int_equal(gz_stipple_choose(&points_of[0], &views[i], NULL, &discs),
				 GZ_ERR_INVAL);
	assert_int_equal(discs.count, 0);
	drawn_picture_free(&picture);
}

static void disc_adds_as_much_ink_as_its_area(void **state)
{
	(void)state;
	const float radii[5] = { 0.3F, 0.8F, 1, 2.5F, 9 };
	for (int i = 0; i < 5; i++) {
		struct gz_stipple_sheet sheet = { 0 };
		double sum = 0;
		for (int place = 0; place < 25; place++) {
			const struct gz_stipple_disc disc = { 20 + (float)(place % 5) / 5,
							      20 + (float)(place / 5) / 5,
							      radii[i] };
			assert_int_equal(gz_stipple_sheet_clear(&sheet, 40, 40), GZ_OK);
			assert_int_equal(gz_stipple_sheet_add_discs(&sheet, &disc, 1, NULL), GZ_OK);
			sum += 1600 * mean_ink(&sheet, 0, 40, 0, 40) / 25;
		}
		const double area = 3.14159265 * (double)(radii[i] * radii[i]);
		assert_float_equal(sum, area, 0.02 * area + 0.01);
		gz_stipple_sheet_free(&sheet);
	}
}

static void marks_at_the_border_stay_on_the_sheet(void **state)
{
	(void)state;
	struct gz_stipple_sheet sheet = { 0 };
	const struct gz_stipple_disc discs[6] = { { -2, -2, 3 },   { 72, 69, 5 }, { -50, 3, 4 },
						  { 30, 1e9F, 2 }, { NAN, 3, 2 }, { 3, NAN, 2 } };
	assert_int_equal(gz_stipple_sheet_clear(&sheet, 70, 70), GZ_OK);
	assert_int_equal(gz_stipple_sheet_add_discs(&sheet, discs, 6, NULL), GZ_OK);
	assert_true(sheet.ink[0] > 0);
	assert_true(sheet.ink[69 * sheet.stride + 69] > 0);
	assert_int_equal(sheet.ink[35 * sheet.stride + 30], 0);
	assert_int_equal(gz_stipple_sheet_clear(&sheet, 0, 70), GZ_ERR_INVAL);
	gz_stipple_sheet_free(&sheet);
}

static void darker_tones_ask_for_denser_discs(void **state)
{
	(void)state;
	for (float facing = 0.05F; facing < 1; facing += 0.1F)
		for (float radius = 0.4F; radius < 8; radius *= 1.5F)
			for (int step = 0; step < 100; step++) {
				const float ink = (float)step / 100;
				const float density = gz_stipple_density(ink, facing, radius);
				assert_true(density <=
					    gz_stipple_density(ink + 0.01F, facing, radius));
				const float most = gz_stipple_density_most(ink, facing);
				assert_true(density * facing <= most * 1.0001F);
				assert_true(most <= 1.5F * gz_stipple_density(ink, 1, 8) + 1e-6F);
				/* discs that do not overlap cover their area, all others less */
				assert_true(density >= ink - 0.021F);
			}
}

/* The file of the points of a folder; the second time they are read from it, and a file of another
 * mesh is not used. */
/* All bytes of a file. */
static size_t read_bytes(const char *path, char *out, size_t size)
{
	FILE *file = fopen(path, "rb");
	assert_non_null(file);
	const size_t count = fread(out, 1, size, file);
	assert_in_range(count, 1, size - 1);
	(void)fclose(file);
	return count;
}

static void strips_make_the_same_picture_bit_for_bit(void **state)
{
	(void)state;
	enum { WIDE = 150, HIGH = 131, DISCS = 300 };
	static const int heights[5] = { HIGH, 1, 32, 50, 1000 };
	static char whole[1 << 16], strips[1 << 16];
	struct gz_stipple_disc discs[DISCS];
	const struct gz_stipple_piece pieces[2] = { { { -5, 3 }, { 140, 125 }, 1, 7 },
						    { { 140, 125 }, { 60, 90.5F }, 7, 0 } };
	char path[] = "/tmp/gazecast_strips_XXXXXX.png";
	for (size_t i = 0; i < DISCS; i++) {
		const double x = (double)(gz_mixed_bits(1, i) >> 11) * 0x1p-53;
		const double y = (double)(gz_mixed_bits(2, i) >> 11) * 0x1p-53;
		discs[i] = (struct gz_stipple_disc) { (float)(x * 170 - 10), (float)(y * 151 - 10),
						      i % 50 ? 1.3F : 20 };
	}
	const struct gz_stipple_marks marks = { discs, DISCS, pieces, 2 };
	const int fd = mkstemps(path, 4);
	assert_true(fd >= 0);
	close(fd);
	size_t bytes = 0;
	for (int i = 0; i < 5; i++) {
		assert_int_equal(gz_stipple_write_png(&marks, (const int[2]) { WIDE, HIGH },
						      heights[i], NULL, path, NULL),
				 GZ_OK);
		if (i == 0)
			bytes = read_bytes(path, whole, sizeof whole);
		assert_int_equal(read_bytes(path, strips, sizeof strips), bytes);
		assert_memory_equal(strips, whole, bytes);
	}
	/* and it is the picture of a sheet */
	struct gz_image read = { 0 }, drawn = { 0 };
	struct gz_stipple_sheet sheet = { 0 };
	assert_int_equal(gz_stipple_sheet_clear(&sheet, WIDE, HIGH), GZ_OK);
	assert_int_equal(gz_stipple_sheet_add_discs(&sheet, discs, DISCS, NULL), GZ_OK);
	assert_int_equal(gz_stipple_sheet_add_pieces(&sheet, pieces, 2, NULL), GZ_OK);
	assert_int_equal(gz_stipple_sheet_to_image(&sheet, &drawn), GZ_OK);
	assert_int_equal(gz_image_read_png(path, NULL, &read), GZ_OK);
	assert_memory_equal(read.pixels, drawn.pixels, (size_t)4 * WIDE * HIGH);
	assert_int_equal(
		gz_stipple_write_png(&marks, (const int[2]) { WIDE, 0 }, 32, NULL, path, NULL),
		GZ_ERR_INVAL);
	unlink(path);
	gz_image_free(&read);
	gz_image_free(&drawn);
	gz_stipple_sheet_free(&sheet);
}

static void points_are_kept(void **state)
{
	(void)state;
	struct gz_mesh mesh = drawn_mesh(DRAWN_BALL);
	struct gz_mesh_points made, read, other;
	const struct gz_mesh_cache_place place = { NULL, "points" };
	(void)kept_files_open();
	assert_int_equal(gz_cached_points_make(&mesh, 500, &place, NULL, NULL, NULL, &made), GZ_OK);
	assert_int_equal(kept_files_count(), 1);
	assert_int_equal(gz_cached_points_make(&mesh, 500, &place, NULL, NULL, NULL, &read), GZ_OK);
	assert_int_equal(read.count, 500);
	assert_memory_equal(read.points, made.points, 500 * sizeof *made.points);
	assert_true(read.area_mm2 == made.area_mm2);
	gz_mesh_points_free(&read);
	/* a file that belongs to the key is believed: another area shows that it was read */
	struct gz_mesh_key key;
	float floats[3 * 500] = { 0 }, area[3] = { 7, 0.5F, 0 };
	const struct gz_mesh_cache_array arrays[2] = { { floats, 3 * 500 }, { area, 3 } };
	assert_int_equal(gz_mesh_key_make(&mesh, "mesh points 1, 500", &key), GZ_OK);
	assert_int_equal(gz_mesh_cache_store(&place, &key, arrays, 2, NULL), GZ_OK);
	assert_int_equal(gz_cached_points_make(&mesh, 500, &place, NULL, NULL, NULL, &read), GZ_OK);
	assert_true(read.area_mm2 == 7.5);
	gz_mesh_points_free(&read);
	/* but a triangle that the mesh lacks is not, and another mesh has another key */
	floats[3] = (float)mesh.triangle_count;
	assert_int_equal(gz_mesh_cache_store(&place, &key, arrays, 2, NULL), GZ_OK);
	assert_int_equal(gz_cached_points_make(&mesh, 500, &place, NULL, NULL, NULL, &read), GZ_OK);
	assert_memory_equal(read.points, made.points, 500 * sizeof *made.points);
	mesh.positions[0][0] += 1;
	assert_int_equal(gz_cached_points_make(&mesh, 500, &place, NULL, NULL, NULL, &other),
			 GZ_OK);
	assert_true(other.area_mm2 != made.area_mm2);
	gz_mesh_points_free(&read);
	gz_mesh_points_free(&made);
	gz_mesh_points_free(&other);
	gz_mesh_free(&mesh);
	kept_files_close();
}

static void print_is_an_svg_in_millimetres(void **state)
{
	(void)state;
	if (PYTHON[0] == '\0' || strstr(PYTHON, "NOTFOUND"))
		skip();
	char path[] = "/tmp/gazecast_stipple_XXXXXX.svg", command[512];
	struct gz_stipple_svg svg;
	const int fd = mkstemps(path, 4);
	assert_true(fd >= 0);
	close(fd);
	const struct gz_stipple_disc discs[2] = { { 9.5F, 19.5F, 2 }, { 0.25F, 3, 1.5F } };
	const struct gz_stipple_piece pieces[3] = { { { 10, 10 }, { 20, 10 }, 0, 2 },
						    { { 20, 10 }, { 30, 15 }, 2, 1 },
						    { { 50, 50 }, { 60, 50 }, 1, 1 } };
	assert_int_equal(gz_stipple_svg_open(&svg, path, (const int[2]) { 400, 300 }, 0.25, NULL),
			 GZ_OK);
	gz_stipple_svg_add_discs(&svg, discs, 2);
	gz_stipple_svg_add_pieces(&svg, pieces, 3);
	assert_int_equal(gz_stipple_svg_close(&svg), GZ_OK);
	snprintf(command, sizeof command, "%s -B %s %s", PYTHON, READ_SVG, path);
	const int status = system(command); /* NOLINT(cert-env33-c) */
	unlink(path);
	assert_int_equal(status, 0);
}

static void print_that_cannot_be_written_is_refused(void **state)
{
	(void)state;
	struct gz_stipple_svg svg;
	const int size[2] = { 10, 10 };
	assert_int_equal(gz_stipple_svg_open(&svg, "/nonexistent/a.svg", size, 0.25, NULL),
			 GZ_ERR_IO);
	assert_int_equal(gz_stipple_svg_open(&svg, "/tmp/a.svg", size, 0, NULL), GZ_ERR_INVAL);
}

TEST_SUITE(stipple)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(drawing_is_as_dark_as_the_shading_map),
		cmocka_unit_test(slanted_surface_is_as_dark_as_the_shading_map),
		cmocka_unit_test(close_view_with_too_few_points_keeps_its_tone),
		cmocka_unit_test(grey_ball_is_grey_up_to_its_rim),
		cmocka_unit_test(zoom_only_adds_points),
		cmocka_unit_test(dolly_only_adds_points),
		cmocka_unit_test(turning_ball_shows_the_first_points_of_each_place),
		cmocka_unit_test(dolly_and_turn_of_a_ball_follow_the_rule),
		cmocka_unit_test(hidden_points_do_not_shine_through),
		cmocka_unit_test(far_side_of_a_ball_is_not_drawn),
		cmocka_unit_test(board_from_behind_shows_only_with_backs),
		cmocka_unit_test(points_of_other_objects_are_not_drawn),
		cmocka_unit_test(culling_loses_no_point),
		cmocka_unit_test(culling_knows_how_far_a_cluster_reaches),
		cmocka_unit_test(drawing_is_the_same_for_any_number_of_threads),
		cmocka_unit_test(discs_grow_away_from_the_gaze_and_tone_stays),
		cmocka_unit_test(view_out_of_range_is_refused),
		cmocka_unit_test(disc_adds_as_much_ink_as_its_area),
		cmocka_unit_test(marks_at_the_border_stay_on_the_sheet),
		cmocka_unit_test(darker_tones_ask_for_denser_discs),
		cmocka_unit_test(strips_make_the_same_picture_bit_for_bit),
		cmocka_unit_test(points_are_kept),
		cmocka_unit_test(print_is_an_svg_in_millimetres),
		cmocka_unit_test(print_that_cannot_be_written_is_refused),
	};
	return cmocka_run_group_tests(tests, make_points, free_points);
}
