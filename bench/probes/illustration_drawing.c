/* Draws a mesh with stipples and prints what it took, and how many points appear and vanish while
 * the view turns: illustration_drawing [--hatch] ball|ring|MESH WIDTHxHEIGHT OUT [POINTS
 * [RADIUS [TURN]]]. With --hatch, lines of that width instead of discs of that radius.
 * The light stays with the picture. Writes OUT.png and OUT.svg, 0.1 mm a pixel. The points of a
 * MESH are kept beside it. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/clock.h"
#include "base/log.h"
#include "base/order.h"
#include "base/text.h"
#include "base/vector.h"
#include "base/workers.h"
#include "drawing_planes.h"
#include "render/illustration/cached_points.h"
#include "render/illustration/hatch_lines.h"
#include "render/illustration/mark_balance.h"
#include "render/illustration/stipple_points.h"
#include "render/illustration/stipple_svg.h"
#include "render/mesh/mesh_read.h"

enum { TURNS = 20, COLUMNS = 512, ROWS = 256, RUNS = 15 };

#define PI 3.14159265358979323846

/* A mesh of a formula: a place for each of two angles, from 0 to 1. */
typedef void formula_place(double u, double v, double place[3], double normal[3]);

static void ball_place(double u, double v, double place[3], double normal[3])
{
	normal[0] = sin(PI * v) * cos(2 * PI * u);
	normal[1] = sin(PI * v) * sin(2 * PI * u);
	normal[2] = cos(PI * v);
	for (int axis = 0; axis < 3; axis++)
		place[axis] = 50 * normal[axis];
}

static void ring_place(double u, double v, double place[3], double normal[3])
{
	normal[0] = -cos(2 * PI * v) * cos(2 * PI * u);
	normal[1] = -cos(2 * PI * v) * sin(2 * PI * u);
	normal[2] = sin(2 * PI * v);
	place[0] = 35 * cos(2 * PI * u) + 15 * normal[0];
	place[1] = 35 * sin(2 * PI * u) + 15 * normal[1];
	place[2] = 15 * normal[2];
}

static enum gz_result make_formula(formula_place *formula, struct gz_mesh *out_mesh)
{
	struct gz_mesh mesh;
	const enum gz_result result = gz_mesh_allocate((uint64_t)COLUMNS * (ROWS + 1),
						       (uint64_t)2 * COLUMNS * ROWS, &mesh);
	if (result != GZ_OK)
		return result;
	for (uint32_t row = 0; row <= ROWS; row++)
		for (uint32_t column = 0; column < COLUMNS; column++) {
			const size_t vertex = (size_t)row * COLUMNS + column;
			double place[3], normal[3];
			formula((double)column / COLUMNS, (double)row / ROWS, place, normal);
			for (int axis = 0; axis < 3; axis++) {
				mesh.positions[vertex][axis] = (float)place[axis];
				mesh.normals[vertex][axis] = (float)normal[axis];
			}
		}
	uint32_t(*triangle)[3] = mesh.triangles;
	for (uint32_t row = 0; row < ROWS; row++)
		for (uint32_t column = 0; column < COLUMNS; column++) {
			const uint32_t a = row * COLUMNS + column, b = a + COLUMNS;
			const uint32_t c = row * COLUMNS + (column + 1) % COLUMNS, d = c + COLUMNS;
			const uint32_t both[2][3] = { { a, b, c }, { c, b, d } };
			memcpy(triangle, both, sizeof both);
			triangle += 2;
		}
	*out_mesh = mesh;
	return GZ_OK;
}

struct drawing_request {
	const char *what, *out;
	int size[2];
	size_t points;
	double radius, turn_deg;
	bool hatch;
};

struct drawing_state {
	struct gz_mesh mesh;
	struct gz_stipple_points points;
	struct gz_hatch_strokes strokes[2]; /* the second ones cross the first */
	struct gz_workers *workers;
	struct drawing_planes planes;
	struct gz_stipple_discs discs;
	struct gz_hatch_lines lines;
	struct gz_mark_balance balance;
	struct gz_stipple_sheet sheet;
	double world_per_mm;
	struct gz_camera camera;
};

static enum gz_result load_mesh(const char *what, const struct gz_log *log, struct gz_mesh *mesh)
{
	if (strcmp(what, "ball") == 0)
		return make_formula(ball_place, mesh);
	if (strcmp(what, "ring") == 0)
		return make_formula(ring_place, mesh);
	return gz_mesh_read(what, log, mesh);
}

/* Strokes by curvature, and others that cross them. */
static enum gz_result prepare_strokes(struct drawing_state *state,
				      const struct gz_mesh_points *points)
{
	enum { PASSES = 60 };
	const struct gz_mesh *mesh = &state->mesh;
	const double distance_mm = 0.8 * sqrt(points->area_mm2 / (double)points->count);
	struct gz_curvature *curvatures = malloc(mesh->vertex_count * sizeof *curvatures);
	float(*directions)[3] = malloc(mesh->vertex_count * sizeof *directions);
	const int64_t start_ns = gz_clock_now_ns();
	enum gz_result result = curvatures && directions ? GZ_OK : GZ_ERR_NO_MEM;
	if (result == GZ_OK)
		result = gz_mesh_curvatures(mesh, curvatures);
	if (result == GZ_OK)
		result = gz_hatch_directions(mesh, curvatures, PASSES, NULL, directions);
	const int64_t directions_ns = gz_clock_now_ns();
	for (int layer = 0; layer < 2 && result == GZ_OK; layer++) {
		if (layer == 1)
			gz_hatch_cross_directions(mesh, (const float(*)[3])directions, directions);
		result = gz_hatch_strokes_make(mesh, (const float(*)[3])directions, points,
					       distance_mm, NULL, &state->strokes[layer]);
		printf("strokes %zu nodes %zu length %.0f mm\n", state->strokes[layer].stroke_count,
		       state->strokes[layer].node_count, state->strokes[layer].length_mm);
	}
	printf("directions_ms %.0f strokes_ms %.0f\n", gz_ns_to_ms(directions_ns - start_ns),
	       gz_ns_to_ms(gz_clock_now_ns() - directions_ns));
	free(curvatures);
	free(directions);
	return result;
}

static enum gz_result prepare_points(struct drawing_state *state,
				     const struct drawing_request *request,
				     const struct gz_log *log)
{
	struct gz_mesh_points points = { 0 };
	const int64_t start_ns = gz_clock_now_ns();
	const bool is_file =
		strcmp(request->what, "ball") != 0 && strcmp(request->what, "ring") != 0;
	const struct gz_mesh_cache_place place = { request->what, "points" };
	enum gz_result result =
		gz_cached_points_make(&state->mesh, request->points, is_file ? &place : NULL,
				      state->workers, NULL, log, &points);
	const int64_t made_ns = gz_clock_now_ns();
	if (result == GZ_OK)
		result = gz_stipple_points_make(&state->mesh, &points, &state->points);
	const int64_t ready_ns = gz_clock_now_ns();
	if (result == GZ_OK && request->hatch)
		result = prepare_strokes(state, &points);
	printf("triangles %zu points %zu made_ms %.0f ready_ms %.0f\n", state->mesh.triangle_count,
	       points.count, gz_ns_to_ms(made_ns - start_ns), gz_ns_to_ms(ready_ns - made_ns));
	gz_mesh_points_free(&points);
	return result;
}

static void aim_camera(struct drawing_state *state)
{
	double least[3] = { INFINITY, INFINITY, INFINITY };
	double greatest[3] = { -INFINITY, -INFINITY, -INFINITY };
	gz_mesh_bound(&state->mesh, least, greatest);
	double longest = 0;
	for (int axis = 0; axis < 3; axis++)
		longest = fmax(longest, greatest[axis] - least[axis]);
	state->world_per_mm = 1 / longest;
	state->camera = (struct gz_camera) { .up = { 0, 0, 1 }, .fov_deg = 30 };
	for (int axis = 0; axis < 3; axis++)
		state->camera.look_at[axis] =
			(least[axis] + greatest[axis]) / 2 * state->world_per_mm;
	memcpy(state->camera.eye, state->camera.look_at, sizeof state->camera.eye);
	state->camera.eye[0] += 0.9;
	state->camera.eye[1] += 1.8;
	state->camera.eye[2] += 0.7;
}

/* The view of the camera; its planes are drawn anew. */
static enum gz_result make_view(struct drawing_state *state, const struct drawing_request *request,
				struct gz_ray_frame *rays, struct gz_stipple_view *out_view)
{
	enum gz_result result = drawing_planes_make(&state->mesh, state->world_per_mm,
						    &state->camera, request->size, &state->planes);
	if (result == GZ_OK)
		result = gz_camera_rays(&state->camera, request->size[0], request->size[1], rays);
	*out_view = (struct gz_stipple_view) { .rays = rays,
					       .world_per_mm = state->world_per_mm,
					       .tone = &state->planes.tone,
					       .depth = &state->planes.depth,
					       .ids = &state->planes.ids,
					       .id = 1,
					       .size_px = request->radius,
					       .tolerance_px = GZ_STIPPLE_TOLERANCE_PX };
	return result;
}

/* The median and the least of the times of all runs. */
static void print_times(const char *what, double times_ms[RUNS])
{
	qsort(times_ms, RUNS, sizeof *times_ms, gz_compare_doubles);
	printf("%s best_ms %.2f median_ms %.2f\n", what, times_ms[0], times_ms[RUNS / 2]);
}

/* Make the lines as dark as the map around each place. */
static enum gz_result balance_lines(struct drawing_state *state, const struct gz_stipple_view *view)
{
	static const bool hatched[1] = { true };
	const struct gz_mark_target target = { .tone = view->tone,
					       .ids = view->ids,
					       .drawn = hatched,
					       .drawn_count = 1,
					       .size_px = view->size_px };
	return gz_mark_balance_lines(&state->balance, &target, state->lines.pieces,
				     state->lines.count, state->workers);
}

static enum gz_result choose_once(struct drawing_state *state, const struct gz_stipple_view *view,
				  bool hatch)
{
	enum gz_result result = GZ_OK;
	state->discs.count = 0;
	state->lines.count = 0;
	if (!hatch)
		return gz_stipple_choose(&state->points, view, state->workers, &state->discs);
	for (int layer = 0; layer < 2 && result == GZ_OK; layer++)
		result = gz_hatch_choose(&state->strokes[layer], view,
					 layer == 0 ? GZ_HATCH_FIRST : GZ_HATCH_CROSS,
					 state->workers, &state->lines);
	return result == GZ_OK ? balance_lines(state, view) : result;
}

static enum gz_result choose_points(struct drawing_state *state,
				    const struct drawing_request *request)
{
	struct gz_ray_frame rays;
	struct gz_stipple_view view;
	double times_ms[RUNS];
	enum gz_result result = make_view(state, request, &rays, &view);
	for (int run = 0; run < RUNS && result == GZ_OK; run++) {
		const int64_t start_ns = gz_clock_now_ns();
		result = choose_once(state, &view, request->hatch);
		times_ms[run] = gz_ns_to_ms(gz_clock_now_ns() - start_ns);
	}
	if (result != GZ_OK)
		return result;
	printf("%zu discs, %zu pieces of lines\n", state->discs.count, state->lines.count);
	print_times("chosen", times_ms);
	return GZ_OK;
}

/* The mean difference of ink and shading map over what is seen, whole and by blocks of 32 px. */
static void print_tone(const struct drawing_state *state)
{
	enum { BLOCK = 32 };
	const struct gz_plane *tone = &state->planes.tone;
	double worst = 0, squares = 0, mean = 0;
	size_t blocks = 0;
	for (int top = 0; top + BLOCK <= tone->height; top += BLOCK)
		for (int left = 0; left + BLOCK <= tone->width; left += BLOCK) {
			double sum = 0;
			bool whole = true;
			for (int y = top; y < top + BLOCK; y++)
				for (int x = left; x < left + BLOCK; x++) {
					whole &= state->planes.ids
							 .words[(size_t)y * (size_t)tone->width +
								(size_t)x] == 1;
					sum += 1 - (double)gz_plane_value(tone, x, y) -
					       state->sheet.ink[(size_t)y * state->sheet.stride +
								(size_t)x] /
						       255.0;
				}
			if (!whole)
				continue;
			sum /= BLOCK * BLOCK;
			worst = fmax(worst, fabs(sum));
			squares += sum * sum;
			mean += sum;
			blocks++;
		}
	printf("tone: wanted less drawn: mean %.4f rms %.4f worst %.4f over %zu blocks\n",
	       mean / (double)blocks, sqrt(squares / (double)blocks), worst, blocks);
}

static enum gz_result draw_marks(struct drawing_state *state, const struct drawing_request *request)
{
	double times_ms[RUNS];
	enum gz_result result = GZ_OK;
	for (int run = 0; run < RUNS && result == GZ_OK; run++) {
		const int64_t start_ns = gz_clock_now_ns();
		result = gz_stipple_sheet_clear(&state->sheet, request->size[0], request->size[1]);
		if (result == GZ_OK)
			result = gz_stipple_sheet_add_discs(&state->sheet, state->discs.discs,
							    state->discs.count, state->workers);
		if (result == GZ_OK)
			result = gz_stipple_sheet_add_pieces(&state->sheet, state->lines.pieces,
							     state->lines.count, state->workers);
		times_ms[run] = gz_ns_to_ms(gz_clock_now_ns() - start_ns);
	}
	if (result == GZ_OK)
		print_times("drawn", times_ms);
	return result;
}

static enum gz_result write_svg(const struct drawing_state *state,
				const struct drawing_request *request, const struct gz_log *log)
{
	struct gz_stipple_svg svg;
	char path[GZ_PATH_SIZE];
	enum gz_result result = gz_text_print(path, sizeof path, "%s.svg", request->out);
	if (result == GZ_OK)
		result = gz_stipple_svg_open(&svg, path, request->size, 0.1, log);
	if (result != GZ_OK)
		return result;
	gz_stipple_svg_add_discs(&svg, state->discs.discs, state->discs.count);
	gz_stipple_svg_add_pieces(&svg, state->lines.pieces, state->lines.count);
	return gz_stipple_svg_close(&svg);
}

static enum gz_result draw_sheet(struct drawing_state *state, const struct drawing_request *request,
				 const struct gz_log *log)
{
	struct gz_image image = { 0 };
	char path[GZ_PATH_SIZE];
	enum gz_result result = draw_marks(state, request);
	if (result == GZ_OK)
		result = gz_stipple_sheet_to_image(&state->sheet, &image);
	if (result == GZ_OK)
		result = gz_text_print(path, sizeof path, "%s.png", request->out);
	if (result == GZ_OK)
		result = gz_image_write_png(&image, path, log);
	if (result == GZ_OK)
		result = write_svg(state, request, log);
	gz_image_free(&image);
	return result;
}

/* Turns the view by a degree at a time, and the light with it, and counts the points that appear
 * and vanish. */
static enum gz_result print_changes(struct drawing_state *state,
				    const struct drawing_request *request)
{
	const size_t count = state->points.count;
	bool *shown = calloc(count, sizeof *shown);
	size_t shown_count = 0, appeared = 0, vanished = 0;
	enum gz_result result = shown ? GZ_OK : GZ_ERR_NO_MEM;
	for (int turn = 0; turn <= TURNS && result == GZ_OK; turn++) {
		struct gz_ray_frame rays;
		struct gz_stipple_view view;
		result = make_view(state, request, &rays, &view);
		for (size_t i = 0; i < count && result == GZ_OK; i++) {
			const bool shows = gz_stipple_shows(&state->points, &view, i);
			appeared += turn > 0 && shows && !shown[i];
			vanished += turn > 0 && !shows && shown[i];
			shown_count += turn > 0 && shows;
			shown[i] = shows;
		}
		gz_camera_turn(&state->camera, 1);
	}
	if (result == GZ_OK)
		printf("by degree of turning: shown %zu, appear %zu, vanish %zu\n",
		       shown_count / TURNS, appeared / TURNS, vanished / TURNS);
	free(shown);
	return result;
}

static enum gz_result run_drawing(struct drawing_state *state,
				  const struct drawing_request *request, const struct gz_log *log)
{
	enum gz_result result = load_mesh(request->what, log, &state->mesh);
	if (result == GZ_OK)
		result = gz_workers_create(0, &state->workers);
	if (result == GZ_OK)
		result = prepare_points(state, request, log);
	if (result != GZ_OK)
		return result;
	aim_camera(state);
	gz_camera_turn(&state->camera, request->turn_deg);
	result = choose_points(state, request);
	if (result == GZ_OK)
		result = draw_sheet(state, request, log);
	if (result == GZ_OK)
		print_tone(state);
	if (result == GZ_OK && !request->hatch)
		result = print_changes(state, request);
	return result;
}

static bool parse_request(int argc, char **argv, struct drawing_request *out_request)
{
	long long points = 1000000;
	double radius = 1.2, turn_deg = 0;
	struct drawing_request request = { 0 };
	request.hatch = argc > 1 && strcmp(argv[1], "--hatch") == 0;
	argc -= request.hatch;
	argv += request.hatch;
	if (argc < 4 || argc > 7 ||
	    sscanf(argv[2], "%dx%d", &request.size[0], &request.size[1]) != 2)
		return false;
	if ((argc > 4 && !gz_number_parse_whole(argv[4], &points)) ||
	    (argc > 5 && !gz_number_parse(argv[5], &radius)) ||
	    (argc > 6 && !gz_number_parse(argv[6], &turn_deg)) || points < 1)
		return false;
	request.what = argv[1];
	request.out = argv[3];
	request.points = (size_t)points;
	request.radius = radius;
	request.turn_deg = turn_deg;
	*out_request = request;
	return true;
}

int main(int argc, char **argv)
{
	struct gz_log log;
	struct drawing_request request;
	struct drawing_state state = { 0 };
	gz_log_init(&log, NULL, NULL, "*:warn");
	if (!parse_request(argc, argv, &request)) {
		fprintf(stderr,
			"illustration_drawing [--hatch] ball|ring|MESH WIDTHxHEIGHT OUT [POINTS "
			"[RADIUS [TURN_DEG]]]\n");
		return 2;
	}
	const enum gz_result result = run_drawing(&state, &request, &log);
	if (result != GZ_OK)
		fprintf(stderr, "illustration_drawing: %s\n", gz_result_text(result));
	gz_mesh_free(&state.mesh);
	gz_stipple_points_free(&state.points);
	gz_hatch_strokes_free(&state.strokes[0]);
	gz_hatch_strokes_free(&state.strokes[1]);
	gz_hatch_lines_free(&state.lines);
	gz_mark_balance_free(&state.balance);
	gz_workers_destroy(&state.workers);
	drawing_planes_free(&state.planes);
	gz_stipple_discs_free(&state.discs);
	gz_stipple_sheet_free(&state.sheet);
	return result == GZ_OK ? 0 : 1;
}
