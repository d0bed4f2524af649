/* Planes beside the colours: depth, numbers, objects; reconstructed by both backends. */
#include "suite.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <GL/glew.h>

#include "base/workers.h"
#include "render/layers/gl_layers.h"
#include "render/opengl/gl_device.h"
#include "render/opengl/gl_program.h"
#include "render/opengl/gl_target.h"
#include "render/picture/plane.h"
#include "render/plan/method.h"
#include "render/raycast/cpu/cast.h"
#include "render/reconstruct/cpu/reconstruct.h"
#include "render/reconstruct/gl/gl_reconstruct.h"

enum { WIDTH = 301, HEIGHT = 187 };

/* What a plane shows: a ramp with an edge behind which there is nothing, or two objects. */
static uint32_t word_at(enum gz_plane_kind kind, int x, int y)
{
	const bool behind = x + y / 2 > 260;
	float value = behind ? INFINITY : 0.5F + 0.01F * (float)x + 0.003F * (float)y;
	uint32_t word = behind ? 0 : 7 + (x > 90);
	if (kind == GZ_PLANE_VALUE)
		memcpy(&word, &value, sizeof word);
	return word;
}

static struct gz_plan plan_of(int method, enum gz_filter filter, double blend_px)
{
	struct gz_plan plan = { 0 };
	struct gz_foveation foveation = gz_foveation_default();
	struct gz_display display = gz_display_default(WIDTH, HEIGHT);
	display.mm[0] = 0.1 * WIDTH; /* small pixels: all spacings are reached */
	display.mm[1] = 0.1 * HEIGHT;
	display.distance_mm = 300;
	foveation.method = method;
	foveation.filter = filter;
	foveation.blend_px = blend_px;
	foveation.acuity_slope = 0.3;
	foveation.mdc_square_px = 60;
	foveation.mdc3_square_px = 120;
	foveation.ddc_inner_px[0] = foveation.ddc_inner_px[1] = 25;
	foveation.ddc_middle_px[0] = foveation.ddc_middle_px[1] = 60;
	assert_int_equal(gz_plan_make(&foveation, &display, (struct gz_point) { 0.4F, 0.5F }, WIDTH,
				      HEIGHT, &plan),
			 GZ_OK);
	return plan;
}

/* Cast every tile: what the plane shows at its rays. */
static void cast_plane(const struct gz_plan *plan, enum gz_plane_kind kind,
		       struct gz_lattices *lattices)
{
	for (size_t t = 0; t < plan->tile_count; t++) {
		const struct gz_tile *tile = &plan->tiles[t];
		const int spacing = plan->layers[tile->layer].spacing;
		uint32_t words[GZ_TILE_EDGE * GZ_TILE_EDGE];
		for (int i = 0; i < GZ_TILE_EDGE * GZ_TILE_EDGE; i++)
			words[i] =
				word_at(kind, tile->x + gz_tile_columns[tile->pattern][i] * spacing,
					tile->y + gz_tile_rows[i] * spacing);
		gz_lattices_store(lattices, plan, tile, gz_plan_tile_active(plan, tile), words);
	}
}

static struct gz_plane reconstructed_by_cpu(const struct gz_plan *plan, enum gz_plane_kind kind,
					    struct gz_lattices *lattices)
{
	struct gz_plane plane = { 0 };
	struct gz_workers *workers = NULL;
	assert_int_equal(gz_plane_resize(&plane, kind, WIDTH, HEIGHT), GZ_OK);
	assert_int_equal(gz_lattices_prepare(lattices, plan, plane.words), GZ_OK);
	assert_int_equal(gz_workers_create(2, &workers), GZ_OK);
	cast_plane(plan, kind, lattices);
	const struct gz_row_filters filters =
		gz_row_filters_of_plane(kind, gz_row_filters_find("portable"));
	gz_reconstruct(plan, lattices, &filters, workers, plane.words);
	gz_workers_destroy(&workers);
	return plane;
}

/* Planes of each instruction set, and of several planes at once, have the bits of one by the
 * portable loops. */
static void check_planes_together(const struct gz_plan *plan, const char *set)
{
	enum { KINDS = 2 };
	const enum gz_plane_kind kinds[KINDS] = { GZ_PLANE_VALUE, GZ_PLANE_ID };
	const uint32_t untouched = 0x12345678, no_value = 0x7F800000;
	struct gz_lattices together[KINDS] = { 0 }, alone[KINDS] = { 0 };
	struct gz_plane planes[KINDS] = { 0 };
	struct gz_row_filters filters[KINDS];
	struct gz_reconstructed made[KINDS];
	struct gz_workers *workers = NULL;
	size_t left = 0;
	for (int i = 0; i < KINDS; i++) {
		assert_int_equal(gz_plane_resize(&planes[i], kinds[i], WIDTH, HEIGHT), GZ_OK);
		for (int k = 0; k < WIDTH * HEIGHT; k++)
			planes[i].words[k] = untouched;
		assert_int_equal(gz_lattices_prepare(&together[i], plan, planes[i].words), GZ_OK);
		filters[i] = gz_row_filters_of_plane(kinds[i], gz_row_filters_find(set));
		made[i] = (struct gz_reconstructed) { &together[i], &filters[i], planes[i].words,
						      kinds[i] == GZ_PLANE_VALUE };
	}
	for (size_t t = 0; t < plan->tile_count; t++) {
		const struct gz_tile *tile = &plan->tiles[t];
		const int spacing = plan->layers[tile->layer].spacing;
		uint32_t words[KINDS][GZ_TILE_EDGE * GZ_TILE_EDGE];
		for (int i = 0; i < KINDS; i++)
			for (int k = 0; k < GZ_TILE_EDGE * GZ_TILE_EDGE; k++)
				words[i][k] = word_at(kinds[i],
						      tile->x + gz_tile_columns[tile->pattern][k] *
									spacing,
						      tile->y + gz_tile_rows[k] * spacing);
		gz_lattices_store_planes(together, KINDS, plan, tile,
					 gz_plan_tile_active(plan, tile),
					 (const uint32_t(*)[GZ_TILE_EDGE * GZ_TILE_EDGE]) words);
	}
	assert_int_equal(gz_workers_create(2, &workers), GZ_OK);
	gz_reconstruct_planes(plan, made, KINDS, workers);
	gz_workers_destroy(&workers);
	for (int i = 0; i < KINDS; i++) {
		struct gz_plane plane = reconstructed_by_cpu(plan, kinds[i], &alone[i]);
		for (int k = 0; k < WIDTH * HEIGHT; k++) {
			const bool is_left = planes[i].words[k] == untouched;
			left += is_left;
			assert_int_equal(is_left ? no_value : planes[i].words[k], plane.words[k]);
		}
		gz_plane_free(&plane);
		gz_plane_free(&planes[i]);
		gz_lattices_free(&together[i]);
		gz_lattices_free(&alone[i]);
	}
	/* Something is left as it was where a plan makes points from coarser ones. */
	assert_true(plan->reconstruction != GZ_RECONSTRUCT_PYRAMID || left > 0);
}

static void check_planes_by_sets(const struct gz_plan *plan, const char *name)
{
	static const char *const sets[] = { "portable", "avx2", "avx512" };
	(void)name;
	for (size_t k = 0; k < sizeof sets / sizeof *sets; k++)
		if (gz_cast_kernels_find(sets[k]))
			check_planes_together(plan, sets[k]);
}

/* Whether what a pixel shows is near, within the widest spacing, where the plane has an edge. */
static bool is_near_edge(enum gz_plane_kind kind, int x, int y)
{
	enum { NEAR = 3 * GZ_PYRAMID_SPACING_MAX };
	const uint32_t own = word_at(kind, x, y);
	if (kind == GZ_PLANE_VALUE)
		return abs(x + y / 2 - 260) < NEAR;
	for (int dx = -NEAR; dx <= NEAR; dx += 4)
		for (int dy = -NEAR; dy <= NEAR; dy += 4)
			if (word_at(kind, x + dx, y + dy) != own)
				return true;
	return false;
}

/* The widest steps of a plan lie apart by less than this: a ramp may be mirrored at the rim. */
static void check_values(const struct gz_plane *plane, const char *name)
{
	enum { RIM = 2 * GZ_PYRAMID_SPACING_MAX };
	for (int y = 0; y < HEIGHT; y++)
		for (int x = 0; x < WIDTH; x++) {
			const float value = gz_plane_value(plane, x, y);
			float wanted;
			const uint32_t word = word_at(GZ_PLANE_VALUE, x, y);
			memcpy(&wanted, &word, sizeof wanted);
			if (isnan(value))
				fail_msg("%s: pixel %d %d is no number", name, x, y);
			if (is_near_edge(GZ_PLANE_VALUE, x, y) || x < RIM || y < RIM ||
			    x >= WIDTH - RIM || y >= HEIGHT - RIM)
				continue;
			if (isinf(wanted) ? !isinf(value) : !(fabsf(value - wanted) < 1e-4F))
				fail_msg("%s: pixel %d %d is %g, not %g", name, x, y, (double)value,
					 (double)wanted);
		}
}

static void check_ids(const struct gz_plane *plane, const char *name)
{
	for (int y = 0; y < HEIGHT; y++)
		for (int x = 0; x < WIDTH; x++) {
			const uint32_t id = plane->words[y * WIDTH + x];
			if (id != 0 && id != 7 && id != 8)
				fail_msg("%s: pixel %d %d is object %u", name, x, y, id);
			if (!is_near_edge(GZ_PLANE_ID, x, y) && id != word_at(GZ_PLANE_ID, x, y))
				fail_msg("%s: pixel %d %d is object %u, not %u", name, x, y, id,
					 word_at(GZ_PLANE_ID, x, y));
		}
}

/* Calls @p check for every method that needs no table, filter and border. */
static void for_all_plans(void (*check)(const struct gz_plan *plan, const char *name))
{
	for (int method = 0; method < GZ_METHOD_COUNT; method++)
		for (int variant = 0; variant < 2 && !gz_methods[method].needs_table; variant++) {
			char name[64];
			struct gz_plan plan = plan_of(
				method, variant ? GZ_FILTER_BILINEAR : GZ_FILTER_CATMULL_ROM,
				variant ? 12 : 0);
			snprintf(name, sizeof name, "%s, variant %d", gz_method_names[method],
				 variant);
			check(&plan, name);
			gz_plan_free(&plan);
		}
}

static void check_on_cpu(const struct gz_plan *plan, const char *name)
{
	struct gz_lattices lattices = { 0 };
	struct gz_plane values = reconstructed_by_cpu(plan, GZ_PLANE_VALUE, &lattices);
	check_values(&values, name);
	struct gz_plane ids = reconstructed_by_cpu(plan, GZ_PLANE_ID, &lattices);
	check_ids(&ids, name);
	gz_plane_free(&values);
	gz_plane_free(&ids);
	gz_lattices_free(&lattices);
}

static void planes_together_are_as_alone(void **state)
{
	(void)state;
	for_all_plans(check_planes_by_sets);
}

static void numbers_and_objects_are_reconstructed_by_every_method(void **state)
{
	(void)state;
	for_all_plans(check_on_cpu);
}

/* The device, and what a frame needs of it. */
struct gl {
	struct gz_gl_device device;
	struct gz_gl_plan plan;
	struct gz_gl_points points;
	struct gz_gl_reconstruct programs;
};

static struct gl gl;

static void open_gl(void)
{
	const struct gz_gl_setup setup = { .lent = NULL };
	if (gz_gl_device_create(&setup, NULL, &gl.device) != GZ_OK)
		skip();
	assert_int_equal(gz_gl_device_enter(&gl.device), GZ_OK);
}

static void close_gl(void)
{
	gz_gl_plan_free(&gl.plan);
	gz_gl_points_free(&gl.points);
	gz_gl_reconstruct_free(&gl.programs);
	gz_gl_device_leave(&gl.device);
	gz_gl_device_destroy(&gl.device);
}

/* The cast lattices as the device lays them out: the picture, then the others. */
static void upload_lattices(const struct gz_plan *plan, const struct gz_lattices *lattices,
			    const uint32_t *picture)
{
	uint32_t *words = calloc(gl.plan.point_count, sizeof *words);
	size_t next = (size_t)WIDTH * HEIGHT;
	assert_non_null(words);
	memcpy(words, picture, next * sizeof *words);
	for (int i = 0; i < plan->layer_count; i++) {
		const struct gz_lattice *lattice = &lattices->layers[i];
		const size_t count = (size_t)lattice->columns * (size_t)lattice->rows;
		if (lattice->points == picture)
			continue;
		memcpy(words + next, lattice->points, count * sizeof *words);
		next += count;
	}
	assert_int_equal(next, gl.plan.point_count);
	glBindBuffer(GL_SHADER_STORAGE_BUFFER, gl.points.points.name);
	glBufferSubData(GL_SHADER_STORAGE_BUFFER, 0, (GLsizeiptr)(next * sizeof *words), words);
	free(words);
}

static struct gz_plane reconstructed_by_gl(const struct gz_plan *plan, enum gz_plane_kind kind)
{
	static const struct gz_gl_tile_levels finest;
	struct gz_plane plane = { 0 };
	struct gz_lattices lattices = { 0 };
	assert_int_equal(gz_plane_resize(&plane, kind, WIDTH, HEIGHT), GZ_OK);
	assert_int_equal(gz_lattices_prepare(&lattices, plan, plane.words), GZ_OK);
	cast_plane(plan, kind, &lattices);
	assert_int_equal(gz_gl_plan_prepare(&gl.plan, &gl.device, plan, &finest, NULL), GZ_OK);
	assert_int_equal(gz_gl_points_prepare(&gl.points, &gl.device, gl.plan.point_count), GZ_OK);
	upload_lattices(plan, &lattices, plane.words);
	gz_gl_plan_bind(&gl.plan);
	const struct gz_gl_reconstruct_job job = {
		.device = &gl.device,
		.gl_plan = &gl.plan,
		.plan = plan,
		.points = &gl.points,
		.kind = kind,
	};
	assert_int_equal(gz_gl_reconstruct(&gl.programs, &job), GZ_OK);
	assert_int_equal(
		gz_gl_points_read(&gl.points, &gl.device, 0, (size_t)WIDTH * HEIGHT, plane.words),
		GZ_OK);
	gz_lattices_free(&lattices);
	return plane;
}

static bool same_word(enum gz_plane_kind kind, uint32_t a, uint32_t b)
{
	float x, y;
	memcpy(&x, &a, sizeof x);
	memcpy(&y, &b, sizeof y);
	return a == b || (kind == GZ_PLANE_VALUE && fabsf(x - y) < 1e-4F);
}

static void check_on_gl(const struct gz_plan *plan, const char *name)
{
	for (int kind = GZ_PLANE_VALUE; kind <= GZ_PLANE_ID; kind++) {
		struct gz_lattices lattices = { 0 };
		struct gz_plane of_cpu =
			reconstructed_by_cpu(plan, (enum gz_plane_kind)kind, &lattices);
		struct gz_plane of_gl = reconstructed_by_gl(plan, (enum gz_plane_kind)kind);
		int apart = 0;
		for (int i = 0; i < WIDTH * HEIGHT; i++)
			apart += !same_word((enum gz_plane_kind)kind, of_cpu.words[i],
					    of_gl.words[i]);
		/* A pixel halfway between two points may round either way. */
		if (apart > WIDTH * HEIGHT / 1000)
			fail_msg("%s, plane %d: %d pixels differ", name, kind, apart);
		gz_plane_free(&of_cpu);
		gz_plane_free(&of_gl);
		gz_lattices_free(&lattices);
	}
}

static void planes_of_gl_equal_the_cpus_by_every_method(void **state)
{
	(void)state;
	open_gl();
	for_all_plans(check_on_gl);
	close_gl();
}

static void planes_beyond_the_longest_side_are_refused(void **state)
{
	(void)state;
	struct gz_plane plane = { 0 };
	assert_int_equal(gz_plane_resize(&plane, GZ_PLANE_ID, 4, 3), GZ_OK);
	assert_int_equal(gz_plane_resize(&plane, GZ_PLANE_VALUE, 0, 3), GZ_ERR_INVAL);
	assert_int_equal(gz_plane_resize(&plane, GZ_PLANE_VALUE, 1 << 20, 3), GZ_ERR_INVAL);
	assert_true(plane.width == 4 && plane.kind == GZ_PLANE_ID);
	gz_plane_free(&plane);
}

/* Two overlapping triangles at different depths, each with its number. */
static const char triangles_vert[] =
	"flat out uint id;\n"
	"out float far;\n"
	"void main()\n"
	"{\n"
	"	uint which = uint(gl_VertexID) / 3U;\n"
	"	vec2 at = vec2(float(gl_VertexID % 3 == 1) * 2.0, float(gl_VertexID % 3 == 2) * "
	"2.0);\n"
	"	id = which + 1U;\n"
	"	far = which == 0U ? 0.75 : 0.25;\n"
	"	gl_Position = vec4(at - (which == 0U ? 1.0 : 0.5), 2.0 * far - 1.0, 1.0);\n"
	"}\n";
static const char triangles_frag[] = "flat in uint id;\n"
				     "in float far;\n"
				     "layout(location = 0) out vec4 colour;\n"
				     "layout(location = 1) out uint object;\n"
				     "layout(location = 2) out uint value;\n"
				     "void main()\n"
				     "{\n"
				     "	colour = id == 1U ? vec4(1, 0, 0, 1) : vec4(0, 1, 0, 1);\n"
				     "	object = id;\n"
				     "	value = floatBitsToUint(far);\n"
				     "}\n";

static void draw_triangles(const struct gz_gl_target *target)
{
	static const float background[4] = { 0, 0, 1, 1 };
	const struct gz_gl_shader shaders[2] = {
		{ .stage = GZ_GL_VERTEX,
		  .name = "triangles.vert",
		  .parts = { triangles_vert },
		  .with_430 = true },
		{ .stage = GZ_GL_FRAGMENT,
		  .name = "triangles.frag",
		  .parts = { triangles_frag },
		  .with_430 = true },
	};
	const unsigned program = gz_gl_program(shaders, 2, "use --backend cpu", NULL);
	const struct gz_gl_outer_state outer = gz_gl_outer_state_leave();
	GLuint vertices = 0;
	assert_int_not_equal(program, 0);
	glGenVertexArrays(1, &vertices);
	glBindVertexArray(vertices);
	gz_gl_target_begin(target);
	gz_gl_target_clear(target, background);
	glUseProgram(program);
	glDrawArrays(GL_TRIANGLES, 0, 6);
	gz_gl_outer_state_return(&outer);
	glUseProgram(0);
	glDeleteVertexArrays(1, &vertices);
	glDeleteProgram(program);
}

static void target_holds_colour_object_and_value_of_what_is_nearest(void **state)
{
	(void)state;
	enum { SIDE = 64 };
	struct gz_gl_target target = { 0 };
	uint32_t words[SIDE * SIDE];
	open_gl();
	assert_int_equal(gz_gl_target_reserve(&target, &gl.device, (1U << GZ_GL_TARGET_PLANES) - 1,
					      SIDE, SIDE, NULL),
			 GZ_OK);
	draw_triangles(&target);
	/* the first covers the lower left half, the second, nearer, begins in a quarter */
	static const struct {
		int x, y;
		uint32_t colour, object;
		float value;
	} places[] = {
		{ 4, 4, 0xFF0000FF, 1, 0.75F },
		{ 20, 20, 0xFF00FF00, 2, 0.25F },
		{ 62, 62, 0xFFFF0000, 0, INFINITY },
	};
	for (size_t i = 0; i < sizeof places / sizeof places[0]; i++) {
		const int k = places[i].y * SIDE + places[i].x;
		gz_gl_target_read(&target, GZ_GL_TARGET_COLOUR, target.width, target.height, words);
		assert_int_equal(words[k], places[i].colour);
		gz_gl_target_read(&target, GZ_GL_TARGET_ID, target.width, target.height, words);
		assert_int_equal(words[k], places[i].object);
		gz_gl_target_read(&target, GZ_GL_TARGET_VALUE, target.width, target.height, words);
		float value;
		memcpy(&value, &words[k], sizeof value);
		assert_true(value == places[i].value);
	}
	assert_int_equal(
		gz_gl_target_reserve(&target, &gl.device, 1U << GZ_GL_TARGET_ID, 8, 8, NULL),
		GZ_OK);
	assert_true(target.width == SIDE && target.planes[GZ_GL_TARGET_COLOUR] == 0);
	assert_int_equal(gz_gl_device_errors(&gl.device), GZ_OK);
	gz_gl_target_free(&target);
	close_gl();
}

TEST_SUITE(planes)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(numbers_and_objects_are_reconstructed_by_every_method),
		cmocka_unit_test(planes_together_are_as_alone),
		cmocka_unit_test(planes_of_gl_equal_the_cpus_by_every_method),
		cmocka_unit_test(planes_beyond_the_longest_side_are_refused),
		cmocka_unit_test(target_holds_colour_object_and_value_of_what_is_nearest),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
