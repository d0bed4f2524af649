/* Marks are as dark as the shading map in every square of a picture, wherever strokes run together,
 * leave gaps or points are few, and stay where they are. */
#include "suite.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/workers.h"
#include "drawn_meshes.h"
#include "render/illustration/hatch_lines.h"
#include "render/illustration/mark_balance.h"
#include "render/illustration/stipple_points.h"
#include "render/mesh/mesh_points.h"

enum { POINTS = 40000, EDGE = 320, SQUARE = 32 };

/* How far the ink of a square may be from the map's, with lines of a width: what the documents
 * state. A line along the side of a square that lies just within it or just beside it makes a
 * difference of its width for the side. */
static double bound_of(double width_px)
{
	return fmax(0.05, width_px / SQUARE);
}

static struct gz_mesh meshes[2];
/* Of each body: strokes round the y axis, which run together at the poles of the ball, and others
 * that cross them. */
static struct gz_hatch_strokes strokes_of[2][2];

/* Points of each body. */
static struct gz_stipple_points points_of[2];

static enum gz_result spread_points(enum drawn_body body)
{
	struct gz_mesh_points points;
	enum gz_result result = gz_mesh_points_make(&meshes[body], POINTS, NULL, NULL, &points);
	if (result != GZ_OK)
		return result;
	result = gz_stipple_points_make(&meshes[body], &points, &points_of[body]);
	gz_mesh_points_free(&points);
	return result;
}

static int make_strokes(void **state)
{
	(void)state;
	for (int body = 0; body < 2; body++) {
		meshes[body] = drawn_mesh((enum drawn_body)body);
		if (drawn_strokes_make(&meshes[body], 2, strokes_of[body]) != GZ_OK ||
		    spread_points((enum drawn_body)body) != GZ_OK)
			return -1;
	}
	return 0;
}

static int free_strokes(void **state)
{
	(void)state;
	for (int body = 0; body < 2; body++) {
		gz_mesh_free(&meshes[body]);
		gz_stipple_points_free(&points_of[body]);
		for (int layer = 0; layer < 2; layer++)
			gz_hatch_strokes_free(&strokes_of[body][layer]);
	}
	return 0;
}

/* A picture and its lines. */
struct hatched_picture {
	struct drawn_picture picture;
	struct gz_hatch_lines lines;
	struct gz_stipple_discs discs;
	struct gz_mark_balance balance;
	struct gz_stipple_sheet sheet;
};

static void free_hatched(struct hatched_picture *hatched)
{
	drawn_picture_free(&hatched->picture);
	gz_hatch_lines_free(&hatched->lines);
	gz_stipple_discs_free(&hatched->discs);
	gz_mark_balance_free(&hatched->balance);
	gz_stipple_sheet_free(&hatched->sheet);
}

static void choose_lines(enum drawn_body body, struct hatched_picture *hatched)
{
	hatched->lines.count = 0;
	for (int layer = 0; layer < 2; layer++)
		assert_int_equal(gz_hatch_choose(&strokes_of[body][layer], &hatched->picture.view,
						 layer == 0 ? GZ_HATCH_FIRST : GZ_HATCH_CROSS, NULL,
						 &hatched->lines),
				 GZ_OK);
	assert_true(hatched->lines.count > 100);
}

static struct gz_mark_target target_of(const struct hatched_picture *hatched)
{
	static const bool all[1] = { true };
	const struct gz_stipple_view *view = &hatched->picture.view;
	return (struct gz_mark_target) { .tone = view->tone,
					 .ids = view->ids,
					 .drawn = all,
					 .drawn_count = 1,
					 .size_px = view->size_px,
					 .scale = view->scale };
}

static void balance_lines(struct hatched_picture *hatched, struct gz_workers *workers)
{
	const struct gz_mark_target target = target_of(hatched);
	assert_int_equal(gz_mark_balance_lines(&hatched->balance, &target, hatched->lines.pieces,
					       hatched->lines.count, workers),
			 GZ_OK);
}

static void draw_lines(struct hatched_picture *hatched)
{
	assert_int_equal(gz_stipple_sheet_clear(&hatched->sheet, EDGE, EDGE), GZ_OK);
	assert_int_equal(gz_stipple_sheet_add_pieces(&hatched->sheet, hatched->lines.pieces,
						     hatched->lines.count, NULL),
			 GZ_OK);
}

/* The ink of a square less what the map wants; NAN where the square is not wholly on the body. */
static double excess_of_square(const struct hatched_picture *hatched, int left, int top)
{
	const struct drawn_picture *picture = &hatched->picture;
	double sum = 0;
	for (int y = top; y < top + SQUARE; y++)
		for (int x = left; x < left + SQUARE; x++) {
			if (picture->ids.words[y * EDGE + x] != 1)
				return NAN;
			sum += hatched->sheet.ink[(size_t)y * hatched->sheet.stride + (size_t)x] /
				       255.0 -
			       (1 - (double)gz_plane_value(&picture->tone, x, y));
		}
	return sum / SQUARE / SQUARE;
}

/* The most that a square differs, over squares at every place of a lattice of 8 px. */
static double worst_square(const struct hatched_picture *hatched, size_t *out_squares)
{
	double worst = 0;
	*out_squares = 0;
	for (int top = 0; top + SQUARE <= EDGE; top += 8)
		for (int left = 0; left + SQUARE <= EDGE; left += 8) {
			const double excess = excess_of_square(hatched, left, top);
			if (isnan(excess))
				continue;
			worst = fmax(worst, fabs(excess));
			++*out_squares;
		}
	return worst;
}

static double worst_drawn(enum drawn_body body, struct hatched_picture *hatched, bool balanced)
{
	size_t squares;
	choose_lines(body, hatched);
	if (balanced)
		balance_lines(hatched, NULL);
	draw_lines(hatched);
	const double worst = worst_square(hatched, &squares);
	assert_true(squares > 100);
	return worst;
}

static void every_square_of_an_even_tone_is_as_dark_as_the_map(void **state)
{
	(void)state;
	struct hatched_picture hatched = { 0 };
	const struct gz_camera camera = drawn_camera(GZ_PROJECTION_ORTHOGRAPHIC, 90, 0);
	for (int step = 1; step < 20; step++)
		for (double width = 1.5; width <= 2; width += 0.5) {
			const double ink = step / 20.0;
			drawn_picture_make(DRAWN_BOARD, &camera, EDGE, (float)(1 - ink),
					   &hatched.picture);
			hatched.picture.view.size_px = width;
			const double worst = worst_drawn(DRAWN_BOARD, &hatched, true);
			if (worst > bound_of(width))
				fail_msg("ink %.2f, %g px: a square differs by %.3f", ink, width,
					 worst);
		}
	free_hatched(&hatched);
}

/* A map that goes from light to dark along x, and waves along y. */
static void set_ramp(struct drawn_picture *picture)
{
	for (int y = 0; y < EDGE; y++)
		for (int x = 0; x < EDGE; x++)
			drawn_set_value(&picture->tone, x, y,
					0.95F - 0.9F * (float)x / EDGE +
						0.05F * sinf((float)y / 20));
}

static void every_square_of_a_ramp_is_as_dark_as_the_map(void **state)
{
	(void)state;
	struct hatched_picture hatched = { 0 };
	const struct gz_camera camera = drawn_camera(GZ_PROJECTION_ORTHOGRAPHIC, 90, 0);
	drawn_picture_make(DRAWN_BOARD, &camera, EDGE, 0.5F, &hatched.picture);
	hatched.picture.view.size_px = 2;
	set_ramp(&hatched.picture);
	const double worst = worst_drawn(DRAWN_BOARD, &hatched, true);
	if (worst > bound_of(2))
		fail_msg("a square differs by %.3f", worst);
	free_hatched(&hatched);
}

/* From above, strokes of a ball are circles round a pole, and those that cross them run together in
 * it. Without balance this is far too dark there. */
static void crowded_strokes_of_a_ball_are_as_dark_as_the_map(void **state)
{
	(void)state;
	struct hatched_picture hatched = { 0 };
	struct gz_camera camera = drawn_camera(GZ_PROJECTION_PERSPECTIVE, 150, 0);
	for (int step = 2; step < 10; step++) {
		const double ink = step / 10.0;
		camera.eye[0] = 0;
		camera.eye[1] = -1.3;
		camera.eye[2] = 0.5;
		camera.up[1] = 0;
		camera.up[2] = 1;
		drawn_picture_make(DRAWN_BALL, &camera, EDGE, (float)(1 - ink), &hatched.picture);
		hatched.picture.view.size_px = 1.5;
		const double before = worst_drawn(DRAWN_BALL, &hatched, false);
		const double after = worst_drawn(DRAWN_BALL, &hatched, true);
		if (after > bound_of(1.5) || after > before)
			fail_msg("ink %.1f: a square differs by %.3f, before by %.3f", ink, after,
				 before);
	}
	free_hatched(&hatched);
}

/* Strokes that are gone in half of the picture, as where a mesh has no directions: those around the
 * gap cannot fill it, and do not become blots either. */
static void gap_makes_no_blots(void **state)
{
	(void)state;
	struct hatched_picture hatched = { 0 };
	const struct gz_camera camera = drawn_camera(GZ_PROJECTION_ORTHOGRAPHIC, 90, 0);
	drawn_picture_make(DRAWN_BOARD, &camera, EDGE, 0.5F, &hatched.picture);
	hatched.picture.view.size_px = 1.5;
	choose_lines(DRAWN_BOARD, &hatched);
	size_t kept = 0;
	for (size_t i = 0; i < hatched.lines.count; i++)
		if (hatched.lines.pieces[i].from[0] < EDGE / 2)
			hatched.lines.pieces[kept++] = hatched.lines.pieces[i];
	hatched.lines.count = kept;
	float widest[2] = { 0 };
	for (int balanced = 0; balanced < 2; balanced++) {
		if (balanced)
			balance_lines(&hatched, NULL);
		for (size_t i = 0; i < kept; i++)
			widest[balanced] =
				fmaxf(widest[balanced], hatched.lines.pieces[i].from_width);
	}
	assert_true(widest[1] > widest[0]);
	assert_true(widest[1] <= 1.001F * GZ_HATCH_WIDTH_CHANGE * widest[0]);
	free_hatched(&hatched);
}

static void only_widths_change_and_no_line_vanishes(void **state)
{
	(void)state;
	struct hatched_picture hatched = { 0 };
	const struct gz_camera camera = drawn_camera(GZ_PROJECTION_PERSPECTIVE, 150, 20);
	drawn_picture_make(DRAWN_BALL, &camera, EDGE, 0.4F, &hatched.picture);
	choose_lines(DRAWN_BALL, &hatched);
	const size_t count = hatched.lines.count;
	struct gz_stipple_piece *before = malloc(count * sizeof *before);
	assert_non_null(before);
	memcpy(before, hatched.lines.pieces, count * sizeof *before);
	balance_lines(&hatched, NULL);
	size_t changed = 0;
	for (size_t i = 0; i < count; i++) {
		const struct gz_stipple_piece *now = &hatched.lines.pieces[i];
		assert_memory_equal(now->from, before[i].from, sizeof now->from);
		assert_memory_equal(now->to, before[i].to, sizeof now->to);
		assert_true((now->from_width > 0) == (before[i].from_width > 0));
		assert_true((now->to_width > 0) == (before[i].to_width > 0));
		changed += now->from_width != before[i].from_width;
	}
	assert_true(changed > count / 2);
	free(before);
	free_hatched(&hatched);
}

/* Pieces of both views follow the order of the strokes, so that each finds itself again. */
static void widths_change_little_while_the_view_turns(void **state)
{
	(void)state;
	enum { RIM = 16 }; /* lines that leave the picture take their ink with them at once */
	struct hatched_picture views[2] = { 0 };
	double changes = 0, most = 0;
	size_t compared = 0;
	for (int i = 0; i < 2; i++) {
		const struct gz_camera camera =
			drawn_camera(GZ_PROJECTION_ORTHOGRAPHIC, 90, 20 + 0.2 * i);
		drawn_picture_make(DRAWN_BOARD, &camera, EDGE, 0.6F, &views[i].picture);
		views[i].picture.view.size_px = 1.5;
		choose_lines(DRAWN_BOARD, &views[i]);
		balance_lines(&views[i], NULL);
	}
	size_t k = 0;
	for (size_t i = 0; i < views[0].lines.count; i++) {
		const struct gz_stipple_piece *a = &views[0].lines.pieces[i], *b = NULL;
		/* of two views so near, a piece lies within a pixel of itself and far from others
		 */
		for (size_t j = k; j < views[1].lines.count && j < k + 40 && !b; j++)
			if (hypotf(views[1].lines.pieces[j].from[0] - a->from[0],
				   views[1].lines.pieces[j].from[1] - a->from[1]) < 1) {
				b = &views[1].lines.pieces[j];
				k = j + 1;
			}
		const float rim =
			fminf(fminf(a->from[0], a->from[1]), EDGE - fmaxf(a->from[0], a->from[1]));
		if (!b || rim < RIM)
			continue;
		const double change = fabs((double)b->from_width - (double)a->from_width);
		changes += change;
		most = fmax(most, change);
		compared++;
	}
	assert_true(compared > views[0].lines.count / 2);
	if (changes / (double)compared > 0.02 || most > 0.3)
		fail_msg("%zu widths change by %.4f px in the mean, by %.3f at most", compared,
			 changes / (double)compared, most);
	for (int i = 0; i < 2; i++)
		free_hatched(&views[i]);
}

static void balance_is_the_same_for_any_number_of_threads(void **state)
{
	(void)state;
	struct hatched_picture hatched[2] = { 0 };
	struct gz_workers *workers;
	const struct gz_camera camera = drawn_camera(GZ_PROJECTION_PERSPECTIVE, 150, 10);
	assert_int_equal(gz_workers_create(3, &workers), GZ_OK);
	for (int i = 0; i < 2; i++) {
		drawn_picture_make(DRAWN_BALL, &camera, EDGE, 0.3F, &hatched[i].picture);
		choose_lines(DRAWN_BALL, &hatched[i]);
		balance_lines(&hatched[i], i == 0 ? NULL : workers);
	}
	assert_int_equal(hatched[0].lines.count, hatched[1].lines.count);
	assert_memory_equal(hatched[0].lines.pieces, hatched[1].lines.pieces,
			    hatched[0].lines.count * sizeof *hatched[0].lines.pieces);
	gz_workers_destroy(&workers);
	for (int i = 0; i < 2; i++)
		free_hatched(&hatched[i]);
}

/* Marks that grow away from the gaze are compared over wider surroundings: four times as wide, they
 * are as dark as the map in squares four times as wide. */
static void larger_lines_are_as_dark_as_the_map(void **state)
{
	(void)state;
	enum { POINTS_OF_SCALE = (EDGE / GZ_STIPPLE_SCALE_STEP_PX + 2) };
	static float factors[POINTS_OF_SCALE * POINTS_OF_SCALE];
	struct hatched_picture hatched = { 0 };
	struct gz_stipple_scale scale = { .columns = POINTS_OF_SCALE,
					  .rows = POINTS_OF_SCALE,
					  .factors = factors };
	for (int i = 0; i < POINTS_OF_SCALE * POINTS_OF_SCALE; i++)
		factors[i] = 4;
	const struct gz_camera camera = drawn_camera(GZ_PROJECTION_ORTHOGRAPHIC, 90, 0);
	for (int step = 2; step < 9; step++) {
		const double ink = step / 10.0;
		drawn_picture_make(DRAWN_BOARD, &camera, EDGE, (float)(1 - ink), &hatched.picture);
		hatched.picture.view.size_px = 1.5;
		hatched.picture.view.scale = &scale;
		choose_lines(DRAWN_BOARD, &hatched);
		balance_lines(&hatched, NULL);
		draw_lines(&hatched);
		for (int part = 0; part < 9; part++) {
			double sum = 0;
			const int at[2] = { 96 * (part % 3), 96 * (part / 3) };
			for (int square = 0; square < 16; square++)
				sum += excess_of_square(&hatched, at[0] + SQUARE * (square % 4),
							at[1] + SQUARE * (square / 4));
			if (!(fabs(sum / 16) <= bound_of(1.5)))
				fail_msg("ink %.1f: part %d differs by %.3f", ink, part, sum / 16);
		}
	}
	free_hatched(&hatched);
}

static void objects_that_are_not_hatched_do_not_count(void **state)
{
	(void)state;
	struct hatched_picture hatched = { 0 };
	const struct gz_camera camera = drawn_camera(GZ_PROJECTION_ORTHOGRAPHIC, 90, 0);
	drawn_picture_make(DRAWN_BOARD, &camera, EDGE, 0.5F, &hatched.picture);
	choose_lines(DRAWN_BOARD, &hatched);
	struct gz_stipple_piece *pieces = hatched.lines.pieces;
	const struct gz_stipple_piece first = pieces[0];
	struct gz_mark_target target = target_of(&hatched);
	static const bool none[1] = { false };
	target.drawn = none;
	assert_int_equal(
		gz_mark_balance_lines(&hatched.balance, &target, pieces, hatched.lines.count, NULL),
		GZ_OK);
	assert_memory_equal(&pieces[0], &first, sizeof first);
	/* numbers that no object has, and tones that are none */
	target = target_of(&hatched);
	for (int x = 0; x < EDGE; x++) {
		hatched.picture.ids.words[x] = x % 2 ? 77 : UINT32_MAX;
		drawn_set_value(&hatched.picture.tone, x, 5, x % 2 ? NAN : -3);
	}
	assert_int_equal(
		gz_mark_balance_lines(&hatched.balance, &target, pieces, hatched.lines.count, NULL),
		GZ_OK);
	for (size_t i = 0; i < hatched.lines.count; i++)
		assert_true(isfinite(pieces[i].from_width) && isfinite(pieces[i].to_width));
	free_hatched(&hatched);
}

static void targets_out_of_range_are_refused(void **state)
{
	(void)state;
	struct hatched_picture hatched = { 0 };
	struct gz_plane small = { 0 };
	const struct gz_camera camera = drawn_camera(GZ_PROJECTION_ORTHOGRAPHIC, 90, 0);
	struct gz_stipple_piece piece = { .to = { 5, 5 }, .from_width = 1, .to_width = 1 };
	drawn_picture_make(DRAWN_BOARD, &camera, EDGE, 0.5F, &hatched.picture);
	assert_int_equal(gz_plane_resize(&small, GZ_PLANE_ID, 8, 8), GZ_OK);
	struct gz_mark_target target = target_of(&hatched);
	target.ids = &small;
	assert_int_equal(gz_mark_balance_lines(&hatched.balance, &target, &piece, 1, NULL),
			 GZ_ERR_INVAL);
	target = target_of(&hatched);
	target.size_px = 0;
	assert_int_equal(gz_mark_balance_lines(&hatched.balance, &target, &piece, 1, NULL),
			 GZ_ERR_INVAL);
	target = target_of(&hatched);
	assert_int_equal(gz_mark_balance_lines(&hatched.balance, &target, &piece, 0, NULL), GZ_OK);
	gz_plane_free(&small);
	free_hatched(&hatched);
}

/* ---- discs ---- */

static void choose_discs(enum drawn_body body, double radius_px, struct hatched_picture *hatched)
{
	hatched->picture.view.size_px = radius_px;
	hatched->discs.count = 0;
	assert_int_equal(
		gz_stipple_choose(&points_of[body], &hatched->picture.view, NULL, &hatched->discs),
		GZ_OK);
	assert_true(hatched->discs.count > 100);
}

static void balance_discs(struct hatched_picture *hatched, struct gz_workers *workers)
{
	struct gz_mark_target target = target_of(hatched);
	target.size_px = 2 * hatched->picture.view.size_px;
	assert_int_equal(gz_mark_balance_discs(&hatched->balance, &target, hatched->discs.discs,
					       hatched->discs.count, workers),
			 GZ_OK);
}

static double worst_of_discs(struct hatched_picture *hatched)
{
	size_t squares;
	assert_int_equal(gz_stipple_sheet_clear(&hatched->sheet, EDGE, EDGE), GZ_OK);
	assert_int_equal(gz_stipple_sheet_add_discs(&hatched->sheet, hatched->discs.discs,
						    hatched->discs.count, NULL),
			 GZ_OK);
	const double worst = worst_square(hatched, &squares);
	assert_true(squares > 100);
	return worst;
}

static void squares_of_discs_are_as_dark_as_the_map(void **state)
{
	(void)state;
	struct hatched_picture hatched = { 0 };
	const struct gz_camera camera = drawn_camera(GZ_PROJECTION_PERSPECTIVE, 110, 25);
	for (int body = 0; body < 2; body++)
		for (int step = 1; step < 10; step++) {
			const double ink = step / 10.0;
			drawn_picture_make((enum drawn_body)body, &camera, EDGE, (float)(1 - ink),
					   &hatched.picture);
			choose_discs((enum drawn_body)body, 1.2, &hatched);
			const double before = worst_of_discs(&hatched);
			balance_discs(&hatched, NULL);
			const double after = worst_of_discs(&hatched);
			if (after > 0.05 || after > before)
				fail_msg("body %d, ink %.1f: a square differs by %.3f, before by "
					 "%.3f",
					 body, ink, after, before);
		}
	free_hatched(&hatched);
}

static void only_radii_change_and_not_by_much(void **state)
{
	(void)state;
	struct hatched_picture hatched = { 0 };
	const struct gz_camera camera = drawn_camera(GZ_PROJECTION_PERSPECTIVE, 150, 20);
	drawn_picture_make(DRAWN_BALL, &camera, EDGE, 0.4F, &hatched.picture);
	choose_discs(DRAWN_BALL, 1.2, &hatched);
	const size_t count = hatched.discs.count;
	struct gz_stipple_disc *before = malloc(count * sizeof *before);
	assert_non_null(before);
	memcpy(before, hatched.discs.discs, count * sizeof *before);
	/* Half of the picture is to be white: discs there cannot become as small as that. */
	for (int y = 0; y < EDGE; y++)
		for (int x = 0; x < EDGE / 2; x++)
			drawn_set_value(&hatched.picture.tone, x, y, 1);
	balance_discs(&hatched, NULL);
	float least = INFINITY;
	for (size_t i = 0; i < count; i++) {
		const struct gz_stipple_disc *now = &hatched.discs.discs[i];
		const float ratio = now->radius / before[i].radius;
		assert_true(now->x == before[i].x && now->y == before[i].y);
		assert_true(ratio <= 1.001F * GZ_STIPPLE_RADIUS_CHANGE);
		assert_true(ratio >= 0.999F / GZ_STIPPLE_RADIUS_CHANGE);
		least = fminf(least, ratio);
	}
	assert_true(least < 1.01F / GZ_STIPPLE_RADIUS_CHANGE);
	free(before);
	free_hatched(&hatched);
}

/* The disc of a place in another view that is turned by little. */
static const struct gz_stipple_disc *disc_near(const struct gz_stipple_discs *discs,
					       const struct gz_stipple_disc *place)
{
	for (size_t i = 0; i < discs->count; i++)
		if (hypotf(discs->discs[i].x - place->x, discs->discs[i].y - place->y) < 0.6F)
			return &discs->discs[i];
	return NULL;
}

static void radii_change_little_while_the_view_turns(void **state)
{
	(void)state;
	enum { RIM = 16 };
	struct hatched_picture views[2] = { 0 };
	double changes = 0, most = 0;
	size_t compared = 0;
	for (int i = 0; i < 2; i++) {
		const struct gz_camera camera =
			drawn_camera(GZ_PROJECTION_ORTHOGRAPHIC, 90, 20 + 0.2 * i);
		drawn_picture_make(DRAWN_BOARD, &camera, EDGE, 0.6F, &views[i].picture);
		choose_discs(DRAWN_BOARD, 1.2, &views[i]);
		balance_discs(&views[i], NULL);
	}
	for (size_t i = 0; i < views[0].discs.count; i++) {
		const struct gz_stipple_disc *a = &views[0].discs.discs[i];
		const struct gz_stipple_disc *b = disc_near(&views[1].discs, a);
		const float rim = fminf(fminf(a->x, a->y), EDGE - fmaxf(a->x, a->y));
		if (!b || rim < RIM)
			continue;
		const double change = fabs((double)b->radius - (double)a->radius);
		changes += change;
		most = fmax(most, change);
		compared++;
	}
	assert_true(compared > views[0].discs.count / 2);
	print_message("%zu radii change by %.4f px in the mean, by %.3f at most\n", compared,
		      changes / (double)compared, most);
	if (changes / (double)compared > 0.01 || most > 0.1)
		fail_msg("%zu radii change by %.4f px in the mean, by %.3f at most", compared,
			 changes / (double)compared, most);
	for (int i = 0; i < 2; i++)
		free_hatched(&views[i]);
}

static void discs_are_the_same_for_any_number_of_threads(void **state)
{
	(void)state;
	struct hatched_picture hatched[2] = { 0 };
	struct gz_workers *workers;
	const struct gz_camera camera = drawn_camera(GZ_PROJECTION_PERSPECTIVE, 150, 10);
	assert_int_equal(gz_workers_create(3, &workers), GZ_OK);
	for (int i = 0; i < 2; i++) {
		drawn_picture_make(DRAWN_BALL, &camera, EDGE, 0.3F, &hatched[i].picture);
		choose_discs(DRAWN_BALL, 1.2, &hatched[i]);
		balance_discs(&hatched[i], i == 0 ? NULL : workers);
	}
	assert_int_equal(hatched[0].discs.count, hatched[1].discs.count);
	assert_memory_equal(hatched[0].discs.discs, hatched[1].discs.discs,
			    hatched[0].discs.count * sizeof *hatched[0].discs.discs);
	gz_workers_destroy(&workers);
	for (int i = 0; i < 2; i++)
		free_hatched(&hatched[i]);
}

TEST_SUITE(mark_balance)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(every_square_of_an_even_tone_is_as_dark_as_the_map),
		cmocka_unit_test(every_square_of_a_ramp_is_as_dark_as_the_map),
		cmocka_unit_test(crowded_strokes_of_a_ball_are_as_dark_as_the_map),
		cmocka_unit_test(gap_makes_no_blots),
		cmocka_unit_test(only_widths_change_and_no_line_vanishes),
		cmocka_unit_test(widths_change_little_while_the_view_turns),
		cmocka_unit_test(balance_is_the_same_for_any_number_of_threads),
		cmocka_unit_test(larger_lines_are_as_dark_as_the_map),
		cmocka_unit_test(objects_that_are_not_hatched_do_not_count),
		cmocka_unit_test(targets_out_of_range_are_refused),
		cmocka_unit_test(squares_of_discs_are_as_dark_as_the_map),
		cmocka_unit_test(only_radii_change_and_not_by_much),
		cmocka_unit_test(radii_change_little_while_the_view_turns),
		cmocka_unit_test(discs_are_the_same_for_any_number_of_threads),
	};
	return cmocka_run_group_tests(tests, make_strokes, free_strokes);
}
