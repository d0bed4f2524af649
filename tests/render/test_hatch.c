/* Hatches: strokes traced over meshes, which of them show, and how dark the drawing is. */
#include "suite.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/workers.h"
#include "drawn_meshes.h"
#include "kept_files.h"
#include "render/illustration/cached_strokes.h"
#include "render/illustration/hatch_lines.h"
#include "render/mesh/point_grid.h"

enum { POINTS = 20000, EDGE = 200 };

static struct gz_mesh meshes[2];
static struct gz_hatch_strokes strokes_of[2];

static int make_strokes(void **state)
{
	(void)state;
	for (int body = 0; body < 2; body++) {
		meshes[body] = drawn_mesh((enum drawn_body)body);
		if (drawn_strokes_make(&meshes[body], 1, &strokes_of[body]) != GZ_OK)
			return -1;
	}
	return 0;
}

static int free_strokes(void **state)
{
	(void)state;
	for (int body = 0; body < 2; body++) {
		gz_mesh_free(&meshes[body]);
		gz_hatch_strokes_free(&strokes_of[body]);
	}
	return 0;
}

static void strokes_follow_their_directions_on_the_surface(void **state)
{
	(void)state;
	const struct gz_hatch_strokes *strokes = &strokes_of[DRAWN_BALL];
	assert_true(strokes->stroke_count > 500);
	for (size_t i = 0; i < strokes->stroke_count; i++) {
		const struct gz_hatch_node *nodes = strokes->nodes + strokes->strokes[i].first;
		assert_true(strokes->strokes[i].count >= 2);
		for (uint32_t k = 0; k < strokes->strokes[i].count; k++) {
			const float *at = nodes[k].place;
			const float radius = sqrtf(at[0] * at[0] + at[1] * at[1] + at[2] * at[2]);
			assert_float_equal(radius, DRAWN_BALL_MM, 0.15);
			/* they stay at their height, but for the corners of the mesh */
			if (fabsf(at[1]) < 40)
				assert_float_equal(at[1], nodes[0].place[1], 1.5);
		}
	}
}

static void nodes_of_a_stroke_follow_each_other(void **state)
{
	(void)state;
	for (int body = 0; body < 2; body++) {
		const struct gz_hatch_strokes *strokes = &strokes_of[body];
		for (size_t i = 0; i < strokes->stroke_count; i++) {
			const struct gz_hatch_node *nodes =
				strokes->nodes + strokes->strokes[i].first;
			for (uint32_t k = 1; k < strokes->strokes[i].count; k++) {
				double square = 0;
				for (int axis = 0; axis < 3; axis++)
					square += pow((double)nodes[k].place[axis] -
							      (double)nodes[k - 1].place[axis],
						      2);
				assert_true(sqrt(square) < 1.01 * DRAWN_STROKE_MM);
			}
		}
	}
}

/* The least distance between the middles of two of the first strokes. */
static double least_distance(const struct gz_hatch_strokes *strokes, size_t count)
{
	double least = INFINITY;
	for (size_t i = 0; i < count; i++)
		for (size_t k = 0; k < i; k++) {
			const struct gz_hatch_stroke *a = &strokes->strokes[i];
			const struct gz_hatch_stroke *b = &strokes->strokes[k];
			const float *from = strokes->nodes[a->first + a->count / 2].place;
			for (uint32_t node = 0; node < b->count; node++) {
				const float *to = strokes->nodes[b->first + node].place;
				double square = 0;
				for (int axis = 0; axis < 3; axis++)
					square += pow((double)to[axis] - (double)from[axis], 2);
				least = fmin(least, square);
			}
		}
	return sqrt(least);
}

static void any_beginning_of_the_strokes_lies_evenly(void **state)
{
	(void)state;
	const struct gz_hatch_strokes *strokes = &strokes_of[DRAWN_BOARD];
	const size_t counts[3] = { 20, 60, 200 };
	for (size_t i = 0; i < 3; i++) {
		const struct gz_hatch_stroke *last = &strokes->strokes[counts[i]];
		/* the mean distance of so much length on so much area */
		const double mean = strokes->area_mm2 / (double)last->before_mm;
		const double least = least_distance(strokes, counts[i]);
		if (least < 0.3 * mean)
			fail_msg("the first %zu strokes: %.2f mm apart, mean %.2f", counts[i],
				 least, mean);
	}
}

static void stroke_knows_the_length_before_it(void **state)
{
	(void)state;
	const struct gz_hatch_strokes *strokes = &strokes_of[DRAWN_BOARD];
	double sum = 0;
	for (size_t i = 0; i < strokes->stroke_count; i++) {
		const struct gz_hatch_stroke *stroke = &strokes->strokes[i];
		assert_float_equal(stroke->before_mm, sum, 1e-3 * sum + 1e-3);
		for (uint32_t k = 1; k < stroke->count; k++) {
			const struct gz_hatch_node *to = &strokes->nodes[stroke->first + k];
			sum += hypot((double)to->place[0] - (double)to[-1].place[0],
				     (double)to->place[1] - (double)to[-1].place[1]);
		}
		sum -= GZ_HATCH_POINTED * DRAWN_STROKE_MM;
	}
	assert_float_equal(strokes->length_mm, sum, 1e-3 * sum);
}

static struct gz_hatch_lines lines_of(enum drawn_body body, const struct drawn_picture *picture,
				      struct gz_workers *workers)
{
	struct gz_hatch_lines lines = { 0 };
	assert_int_equal(
		gz_hatch_choose(&strokes_of[body], &picture->view, GZ_HATCH_ONLY, workers, &lines),
		GZ_OK);
	return lines;
}

static double mean_of_sheet(const struct gz_stipple_sheet *sheet, const int from[2],
			    const int to[2])
{
	double sum = 0;
	for (int y = from[1]; y < to[1]; y++)
		for (int x = from[0]; x < to[0]; x++)
			sum += sheet->ink[(size_t)y * sheet->stride + (size_t)x];
	return sum / 255 / (to[0] - from[0]) / (to[1] - from[1]);
}

static double mean_drawn(enum drawn_body body, const struct drawn_picture *picture,
			 const int from[2], const int to[2])
{
	struct gz_stipple_sheet sheet = { 0 };
	struct gz_hatch_lines lines = lines_of(body, picture, NULL);
	assert_int_equal(gz_stipple_sheet_clear(&sheet, EDGE, EDGE), GZ_OK);
	assert_int_equal(gz_stipple_sheet_add_pieces(&sheet, lines.pieces, lines.count, NULL),
			 GZ_OK);
	const double mean = mean_of_sheet(&sheet, from, to);
	gz_stipple_sheet_free(&sheet);
	gz_hatch_lines_free(&lines);
	return mean;
}

static void check_tones(double width, double height, double tilt_deg)
{
	struct drawn_picture picture = { 0 };
	const struct gz_camera camera = drawn_camera(GZ_PROJECTION_ORTHOGRAPHIC, height, tilt_deg);
	for (int step = 1; step < 10; step++) {
		const float ink = (float)step / 10;
		drawn_picture_make(DRAWN_BOARD, &camera, EDGE, 1 - ink, &picture);
		picture.view.size_px = width;
		const double drawn = mean_drawn(DRAWN_BOARD, &picture, (const int[2]) { 60, 60 },
						(const int[2]) { EDGE - 60, EDGE - 60 });
		if (fabs(drawn - (double)ink) > 0.05)
			fail_msg("width %g, tilt %g: ink %.3f instead of %.1f", width, tilt_deg,
				 drawn, (double)ink);
	}
	drawn_picture_free(&picture);
}

static void hatching_is_as_dark_as_the_shading_map(void **state)
{
	(void)state;
	check_tones(1.5, 60, 0);
	check_tones(2.5, 100, 0);
}

static void slanted_hatching_is_as_dark_as_the_shading_map(void **state)
{
	(void)state;
	check_tones(2, 80, 50);
}

static void close_view_with_too_few_strokes_keeps_its_tone(void **state)
{
	(void)state;
	check_tones(1, 60, 0);
}

static void crossed_layers_together_have_all_the_ink(void **state)
{
	(void)state;
	for (int step = 0; step <= 100; step++) {
		const float ink = (float)step / 100;
		const float first = gz_hatch_layer_ink(GZ_HATCH_FIRST, ink);
		const float cross = gz_hatch_layer_ink(GZ_HATCH_CROSS, ink);
		assert_true(first >= 0 && first <= 1 && cross >= 0 && cross <= 1);
		assert_float_equal(1 - (1 - first) * (1 - cross), ink, 1e-6);
		assert_float_equal(gz_hatch_layer_ink(GZ_HATCH_ONLY, ink), ink, 0);
	}
	assert_float_equal(gz_hatch_layer_ink(GZ_HATCH_CROSS, 0.3F), 0, 0);
}

/* Which strokes of the board's middle show. */
static void mark_strokes(const struct drawn_picture *picture, bool *shown)
{
	const struct gz_hatch_strokes *strokes = &strokes_of[DRAWN_BOARD];
	struct gz_hatch_lines lines = { 0 };
	for (size_t i = 0; i < strokes->stroke_count; i++) {
		const struct gz_hatch_stroke *stroke = &strokes->strokes[i];
		const float *middle = strokes->nodes[stroke->first + stroke->count / 2].place;
		shown[i] = false;
		if (fabsf(middle[0]) > 40 || fabsf(middle[1]) > 40)
			continue; /* ends at the border of the board, where pixels beside it hide it
				   */
		/* a set of this stroke alone, whose order is that of all */
		struct gz_hatch_strokes one = *strokes;
		one.strokes = &strokes->strokes[i];
		one.stroke_count = 1;
		lines.count = 0;
		assert_int_equal(gz_hatch_choose(&one, &picture->view, GZ_HATCH_ONLY, NULL, &lines),
				 GZ_OK);
		shown[i] = lines.count > 0;
	}
	gz_hatch_lines_free(&lines);
}

static void zoom_only_adds_strokes(void **state)
{
	(void)state;
	enum { STEPS = 8 };
	enum { STROKES_MAX = 20000 };
	static bool before[STROKES_MAX], after[STROKES_MAX];
	const size_t count = strokes_of[DRAWN_BOARD].stroke_count;
	assert_in_range(count, 100, STROKES_MAX);
	struct drawn_picture picture = { 0 };
	size_t first = 0, last = 0;
	for (int step = 0; step <= STEPS; step++) {
		const struct gz_camera camera =
			drawn_camera(GZ_PROJECTION_ORTHOGRAPHIC, 200 - 10 * step, 0);
		drawn_picture_make(DRAWN_BOARD, &camera, EDGE, 0.6F, &picture);
		mark_strokes(&picture, after);
		last = 0;
		for (size_t i = 0; i < count; i++) {
			assert_true(after[i] || !before[i]);
			last += after[i];
		}
		first = step == 0 ? last : first;
		memcpy(before, after, count);
	}
	assert_true(first > 20 && last > 2 * first);
	drawn_picture_free(&picture);
}

static void hidden_strokes_do_not_shine_through(void **state)
{
	(void)state;
	struct drawn_picture picture = { 0 };
	const struct gz_camera camera = drawn_camera(GZ_PROJECTION_ORTHOGRAPHIC, 100, 0);
	drawn_picture_make(DRAWN_BOARD, &camera, EDGE, 0.3F, &picture);
	for (int y = 50; y < 150; y++)
		for (int x = 50; x < 150; x++)
			drawn_set_value(&picture.depth, x, y,
					gz_plane_value(&picture.depth, x, y) - 0.015F);
	const double within = mean_drawn(DRAWN_BOARD, &picture, (const int[2]) { 53, 53 },
					 (const int[2]) { 147, 147 });
	assert_float_equal(within, 0, 0);
	drawn_picture_free(&picture);
}

static void hatching_is_the_same_for_any_number_of_threads(void **state)
{
	(void)state;
	struct drawn_picture picture = { 0 };
	struct gz_workers *workers;
	const struct gz_camera camera = drawn_camera(GZ_PROJECTION_PERSPECTIVE, 150, 10);
	drawn_picture_make(DRAWN_BALL, &camera, EDGE, 0.3F, &picture);
	assert_int_equal(gz_workers_create(3, &workers), GZ_OK);
	struct gz_hatch_lines alone = lines_of(DRAWN_BALL, &picture, NULL);
	struct gz_hatch_lines shared = lines_of(DRAWN_BALL, &picture, workers);
	assert_true(alone.count > 1000);
	assert_int_equal(alone.count, shared.count);
	assert_memory_equal(alone.pieces, shared.pieces, alone.count * sizeof *alone.pieces);
	gz_workers_destroy(&workers);
	gz_hatch_lines_free(&alone);
	gz_hatch_lines_free(&shared);
	drawn_picture_free(&picture);
}

static void directions_of_a_tube_run_along_it(void **state)
{
	(void)state;
	/* Curvatures of a tube along y, and none at every third vertex: its neighbours know. */
	const struct gz_mesh *mesh = &meshes[DRAWN_BOARD];
	struct gz_curvature *curvatures = calloc(mesh->vertex_count, sizeof *curvatures);
	float(*directions)[3] = malloc(mesh->vertex_count * sizeof *directions);
	assert_true(curvatures && directions);
	for (size_t i = 0; i < mesh->vertex_count; i++)
		if (i % 3)
			curvatures[i] = (struct gz_curvature) { 0.5F, 0, { i % 2 ? 1 : -1, 0, 0 } };
	assert_int_equal(gz_hatch_directions(mesh, curvatures, 10, NULL, directions), GZ_OK);
	for (size_t i = 0; i < mesh->vertex_count; i++)
		assert_float_equal(fabsf(directions[i][1]), 1, 1e-4);
	gz_hatch_cross_directions(mesh, (const float(*)[3])directions, directions);
	for (size_t i = 0; i < mesh->vertex_count; i++)
		assert_float_equal(fabsf(directions[i][0]), 1, 1e-4);
	assert_int_equal(gz_hatch_directions(mesh, curvatures, -1, NULL, directions), GZ_ERR_INVAL);
	free(curvatures);
	free(directions);
}

static void directions_of_noise_are_those_around_it(void **state)
{
	(void)state;
	/* A tube along y of which two vertices of three bend at random: noise cancels out. */
	const struct gz_mesh *mesh = &meshes[DRAWN_BOARD];
	struct gz_curvature *curvatures = calloc(mesh->vertex_count, sizeof *curvatures);
	float(*directions)[3] = malloc(mesh->vertex_count * sizeof *directions), place[3];
	assert_true(curvatures && directions);
	memcpy(place, mesh->positions[7], sizeof place);
	for (size_t i = 0; i < mesh->vertex_count; i++) {
		const double noise = (double)(gz_mixed_bits(5, i) >> 11) * 0x1p-53;
		const double angle = gz_mixed_bits(6, i) % 3 ? 3.14159265 * noise : 0;
		curvatures[i] = (struct gz_curvature) {
			0.5F, 0, { (float)cos(angle), (float)sin(angle), 0 }
		};
	}
	assert_int_equal(gz_hatch_directions(mesh, curvatures, 60, NULL, directions), GZ_OK);
	double least = 1;
	for (size_t i = 0; i < mesh->vertex_count; i++)
		least = fmin(least, fabs((double)directions[i][1]));
	if (least < 0.96)
		fail_msg("a direction is %.1f degrees off", acos(least) * 180 / 3.14159265);
	/* a vertex without a normal has no direction, and one out of this world does no harm */
	memset(mesh->normals[7], 0, sizeof mesh->normals[7]);
	mesh->positions[7][0] = 1e37F;
	assert_int_equal(gz_hatch_directions(mesh, curvatures, 1, NULL, directions), GZ_OK);
	for (int axis = 0; axis < 3; axis++)
		assert_true(directions[7][axis] == 0 && isfinite(directions[8][axis]));
	memcpy(mesh->normals[7], mesh->normals[8], sizeof mesh->normals[7]);
	memcpy(mesh->positions[7], place, sizeof place);
	free(curvatures);
	free(directions);
}

static void assert_same_strokes(const struct gz_hatch_strokes *a, const struct gz_hatch_strokes *b)
{
	assert_int_equal(a->stroke_count, b->stroke_count);
	assert_int_equal(a->node_count, b->node_count);
	assert_true(a->length_mm == b->length_mm && a->area_mm2 == b->area_mm2);
	assert_memory_equal(a->strokes, b->strokes, a->stroke_count * sizeof *a->strokes);
	assert_memory_equal(a->nodes, b->nodes, a->node_count * sizeof *a->nodes);
}

static void strokes_are_kept(void **state)
{
	(void)state;
	const struct gz_mesh_cache_place place = { NULL, "strokes" };
	const struct gz_hatch_strokes *strokes = &strokes_of[DRAWN_BALL];
	const struct gz_mesh *mesh = &meshes[DRAWN_BALL];
	struct gz_cached_strokes_kind kind = { POINTS, 60, 0.8, 0 };
	struct gz_hatch_strokes read = { 0 };
	(void)kept_files_open();
	assert_int_equal(gz_cached_strokes_load(mesh, &kind, &place, NULL, &read),
			 GZ_ERR_NOT_FOUND);
	assert_int_equal(gz_cached_strokes_store(mesh, &kind, &place, NULL, strokes), GZ_OK);
	assert_int_equal(kept_files_count(), 1);
	assert_int_equal(gz_cached_strokes_load(mesh, &kind, &place, NULL, &read), GZ_OK);
	assert_same_strokes(&read, strokes);
	gz_hatch_strokes_free(&read);
	const struct gz_hatch_strokes none = { 0 };
	assert_int_equal(gz_cached_strokes_store(mesh, &kind, &place, NULL, &none), GZ_OK);
	assert_int_equal(gz_cached_strokes_load(mesh, &kind, &place, NULL, &read), GZ_OK);
	assert_int_equal(read.stroke_count, 0);
	gz_hatch_strokes_free(&read);
	/* those of another kind or mesh are others */
	kind.across = 1;
	assert_int_equal(gz_cached_strokes_load(mesh, &kind, &place, NULL, &read),
			 GZ_ERR_NOT_FOUND);
	assert_int_equal(gz_cached_strokes_load(&meshes[DRAWN_BOARD], &kind, &place, NULL, &read),
			 GZ_ERR_NOT_FOUND);
	kept_files_close();
}

/* A file with the right hash can still hold no strokes. */
static void kept_floats_that_are_no_strokes_are_refused(void **state)
{
	(void)state;
	enum { HEAD = 8, ALL = HEAD + 2 * 2 + 5 * 6 };
	static const struct {
		int at;
		float value;
	} lies[] = {
		{ 0, 1 }, /* more strokes than there is room for */
		{ 0, -1 },       { 1, 0.5F },  { 1, 1 },        { 1, 3 },        { 1, 1e30F },
		{ HEAD, 1 }, /* a stroke of one node */
		{ HEAD, 4 }, /* more nodes than there are */
		{ HEAD, 2.5F },  { HEAD, -2 }, { HEAD, 1e30F }, { HEAD + 2, 2 }, /* a node is left
										    over */
		{ HEAD + 1, 8 }, /* the length before strokes falls */
	};
	const struct gz_mesh_cache_place place = { NULL, "strokes" };
	const struct gz_mesh *mesh = &meshes[DRAWN_BALL];
	const struct gz_cached_strokes_kind kind = { 7, 60, 0.8, 0 };
	struct gz_mesh_key key;
	struct gz_hatch_strokes read = { 0 };
	(void)kept_files_open();
	assert_int_equal(
		gz_mesh_key_make(mesh, "mesh strokes 1, 7, 60, 0.80000000000000004, 0", &key),
		GZ_OK);
	for (int i = -1; i < (int)(sizeof lies / sizeof lies[0]); i++) {
		float floats[ALL] = { 0, 2, 7, 0, 0, 9 };
		const struct gz_mesh_cache_array all = { floats, ALL };
		floats[HEAD] = 2;
		floats[HEAD + 2] = 3;
		floats[HEAD + 3] = 4;
		if (i >= 0)
			floats[lies[i].at] = lies[i].value;
		assert_int_equal(gz_mesh_cache_store(&place, &key, &all, 1, NULL), GZ_OK);
		const enum gz_result result =
			gz_cached_strokes_load(mesh, &kind, &place, NULL, &read);
		if (result != (i < 0 ? GZ_OK : GZ_ERR_FORMAT))
			fail_msg("lie %d: %d", i, (int)result);
		if (i < 0)
			assert_true(read.node_count == 5 && read.strokes[1].first == 2 &&
				    read.length_mm == 7 && read.area_mm2 == 9);
		gz_hatch_strokes_free(&read);
	}
	kept_files_close();
}

static void mesh_without_directions_has_no_strokes(void **state)
{
	(void)state;
	const struct gz_mesh *mesh = &meshes[DRAWN_BOARD];
	struct gz_mesh_points points;
	struct gz_hatch_strokes strokes;
	float(*directions)[3] = calloc(mesh->vertex_count, sizeof *directions);
	assert_non_null(directions);
	assert_int_equal(gz_mesh_points_make(mesh, 100, NULL, NULL, &points), GZ_OK);
	directions[0][0] = NAN;
	assert_int_equal(gz_hatch_strokes_make(mesh, (const float(*)[3])directions, &points, 5,
					       NULL, &strokes),
			 GZ_OK);
	assert_int_equal(strokes.stroke_count, 0);
	gz_hatch_strokes_free(&strokes);
	assert_int_equal(gz_hatch_strokes_make(mesh, (const float(*)[3])directions, &points, 0,
					       NULL, &strokes),
			 GZ_ERR_INVAL);
	gz_mesh_points_free(&points);
	free(directions);
}

/* What is stopped traces no strokes and finds no directions. */
static void stopped_work_is_cancelled(void **state)
{
	(void)state;
	const struct gz_mesh *mesh = &meshes[DRAWN_BOARD];
	const atomic_bool stop = true;
	struct gz_mesh_points points;
	struct gz_hatch_strokes strokes = { 0 };
	struct gz_curvature *curvatures = calloc(mesh->vertex_count, sizeof *curvatures);
	float(*directions)[3] = calloc(mesh->vertex_count, sizeof *directions);
	assert_true(directions && curvatures);
	assert_int_equal(gz_mesh_points_make(mesh, 100, NULL, NULL, &points), GZ_OK);
	assert_int_equal(gz_hatch_directions(mesh, curvatures, 10, &stop, directions),
			 GZ_ERR_CANCELLED);
	assert_int_equal(gz_hatch_strokes_make(mesh, (const float(*)[3])directions, &points, 5,
					       &stop, &strokes),
			 GZ_ERR_CANCELLED);
	assert_null(strokes.nodes);
	gz_mesh_points_free(&points);
	free(curvatures);
	free(directions);
}

TEST_SUITE(hatch)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(strokes_follow_their_directions_on_the_surface),
		cmocka_unit_test(nodes_of_a_stroke_follow_each_other),
		cmocka_unit_test(any_beginning_of_the_strokes_lies_evenly),
		cmocka_unit_test(stroke_knows_the_length_before_it),
		cmocka_unit_test(hatching_is_as_dark_as_the_shading_map),
		cmocka_unit_test(slanted_hatching_is_as_dark_as_the_shading_map),
		cmocka_unit_test(close_view_with_too_few_strokes_keeps_its_tone),
		cmocka_unit_test(crossed_layers_together_have_all_the_ink),
		cmocka_unit_test(zoom_only_adds_strokes),
		cmocka_unit_test(hidden_strokes_do_not_shine_through),
		cmocka_unit_test(hatching_is_the_same_for_any_number_of_threads),
		cmocka_unit_test(directions_of_a_tube_run_along_it),
		cmocka_unit_test(directions_of_noise_are_those_around_it),
		cmocka_unit_test(mesh_without_directions_has_no_strokes),
		cmocka_unit_test(stopped_work_is_cancelled),
		cmocka_unit_test(strokes_are_kept),
		cmocka_unit_test(kept_floats_that_are_no_strokes_are_refused),
	};
	return cmocka_run_group_tests(tests, make_strokes, free_strokes);
}
