/* Illustrations by rays: tone by the formulas of lights, lines around objects, scene information,
 * by any plan and number of threads. */
#include "suite.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "mesh_fields.h"
#include "mesh_shapes.h"
#include "render/illustration/cpu/illustrate_caster.h"
#include "render/illustration/tone_curve.h"
#include "render/plan/method.h"
#include "render/raycast/cpu/cast.h"

enum { WIDTH = 160, HEIGHT = 120, PIXELS = WIDTH * HEIGHT };
enum { LARGE_WIDTH = 640, LARGE_HEIGHT = 480, SQUARE = 32 };

#define RADIUS_MM 12.0

/* What a test draws, and what it gets. */
struct easel {
	struct gz_volume volume; /* its box, 40 mm wide, is the world */
	struct gz_mesh meshes[2];
	struct gz_object objects[2];
	struct gz_object_style styles[2];
	size_t count;
	struct gz_camera camera;
	struct gz_illustration_look look; /* whose single settings count */
	struct gz_foveation foveation;
	uint32_t chosen_id;
	struct gz_point gaze;
	struct gz_plan plan;
	struct gz_image image;
	struct gz_plane depth, ids;
};

/* A ball in the middle, seen from the front. */
static void set_up_easel(struct easel *easel)
{
	static const int dims[3] = { 4, 4, 4 };
	static const double spacing[3] = { 10, 10, 10 };
	const struct gz_option_binding binding = { gz_shading_options, gz_shading_option_count,
						   &easel->look.single, NULL };
	memset(easel, 0, sizeof *easel);
	easel->volume = field_volume(field_ball, dims, spacing, GZ_VOXEL_F32);
	easel->meshes[0] = mesh_ball(RADIUS_MM, 4);
	easel->count = 1;
	for (int i = 0; i < 2; i++) {
		easel->objects[i] = (struct gz_object) { .id = 3 + (uint32_t)i,
							 .volume = &easel->volume,
							 .mesh = &easel->meshes[i] };
		easel->styles[i].importance = 1;
		easel->objects[i].style = &easel->styles[i];
	}
	easel->camera = (struct gz_camera) {
		.eye = { 0, -2, 0 }, .up = { 0, 0, 1 }, .fov_deg = 30, .height = 1
	};
	assert_int_equal(gz_options_preset(&binding), GZ_OK);
	easel->look.source = GZ_ILLUSTRATION_SINGLE;
	easel->look.pen_width = 2;
	easel->gaze = (struct gz_point) { 0.4F, 0.45F };
	easel->foveation = gz_foveation_full();
}

static void take_down_easel(struct easel *easel)
{
	gz_volume_free(&easel->volume);
	gz_mesh_free(&easel->meshes[0]);
	gz_mesh_free(&easel->meshes[1]);
	gz_plan_free(&easel->plan);
	gz_image_free(&easel->image);
	gz_plane_free(&easel->depth);
	gz_plane_free(&easel->ids);
}

/* A second, smaller ball at some place. */
static void add_ball(struct easel *easel, double x, double y, double z)
{
	const double place[3] = { x, y, z };
	easel->meshes[1] = mesh_ball(4, 3);
	for (size_t v = 0; v < easel->meshes[1].vertex_count; v++)
		for (int axis = 0; axis < 3; axis++)
			easel->meshes[1].positions[v][axis] += (float)place[axis];
	easel->count = 2;
}

/* No steps over the picture but equalisation, and one light. */
static void plain_look(struct easel *easel)
{
	struct gz_shading_settings *settings = &easel->look.single;
	settings->main_light = 1;
	settings->plateau_light = settings->grazing_light = 0;
	settings->edge_light = settings->overlap_shadow = settings->haze = settings->lines = 0;
}

static enum gz_result draw_counted(struct gz_illustrate_caster *caster, struct easel *easel,
				   struct gz_frame_stats *out_stats)
{
	const struct gz_display display = gz_display_default(WIDTH, HEIGHT);
	const struct gz_illustrate_planes planes = { &easel->depth, &easel->ids };
	const struct gz_illustrate_shot shot = {
		.camera = &easel->camera,
		.plan = &easel->plan,
		.look = &easel->look,
		.chosen_id = easel->chosen_id,
	};
	assert_int_equal(
		gz_plan_make(&easel->foveation, &display, easel->gaze, WIDTH, HEIGHT, &easel->plan),
		GZ_OK);
	return gz_illustrate_caster_draw(caster, &shot, &easel->image, &planes, out_stats);
}

static enum gz_result draw_shot(struct gz_illustrate_caster *caster, struct easel *easel)
{
	return draw_counted(caster, easel, NULL);
}

static void move_image(struct gz_image *from, struct gz_image *to)
{
	gz_image_free(to);
	*to = *from;
	*from = (struct gz_image) { 0 };
}

static struct gz_illustrate_caster *new_caster(int threads, const char *simd)
{
	const struct gz_backend_params params = { .threads = threads,
						  .simd = simd,
						  .wait_for_bricks = true };
	struct gz_illustrate_caster *caster = NULL;
	assert_int_equal(gz_illustrate_caster_create(&params, NULL, &caster), GZ_OK);
	return caster;
}

static void draw_easel(struct easel *easel, int threads)
{
	struct gz_illustrate_caster *caster = new_caster(threads, NULL);
	assert_int_equal(gz_illustrate_caster_show(caster, easel->objects, easel->count), GZ_OK);
	assert_int_equal(draw_shot(caster, easel), GZ_OK);
	gz_illustrate_caster_destroy(&caster);
}

static int grey_at(const struct easel *easel, int x, int y)
{
	return (int)(gz_image_words(&((struct easel *)easel)->image)[y * WIDTH + x] & 255);
}

static uint32_t id_at(const struct easel *easel, int x, int y)
{
	return easel->ids.words[y * WIDTH + x];
}

/* The main light on the ball, by its formula; false where the ray passes. */
static bool tone_of_ball(const struct easel *easel, int x, int y, double *out_tone)
{
	struct gz_ray_frame frame;
	double origin[3], direction[3], b = 0, c = -RADIUS_MM * RADIUS_MM, length2 = 0;
	assert_int_equal(gz_camera_rays(&easel->camera, WIDTH, HEIGHT, &frame), GZ_OK);
	for (int axis = 0; axis < 3; axis++) {
		origin[axis] = 40 * frame.origin00[axis];
		direction[axis] = frame.direction00[axis] + x * frame.direction_dx[axis] +
				  y * frame.direction_dy[axis];
		length2 += direction[axis] * direction[axis];
		b += origin[axis] * direction[axis];
		c += origin[axis] * origin[axis];
	}
	const double root = b * b - length2 * c;
	if (root < 0)
		return false;
	const double at = (-b - sqrt(root)) / length2;
	/* From upper left: -x and +z of the world. */
	const double normal_x = (origin[0] + at * direction[0]) / RADIUS_MM;
	const double normal_z = (origin[2] + at * direction[2]) / RADIUS_MM;
	*out_tone = 0.5 + 0.5 * (normal_z - normal_x) / sqrt(2);
	return true;
}

/* Equalisation keeps the order of tones: of two pixels of the ball, the one that the light meets
 * more squarely is brighter. */
static void main_light_falls_from_upper_left(void **state)
{
	(void)state;
	struct easel easel;
	uint32_t seed = 8;
	int compared = 0;
	set_up_easel(&easel);
	plain_look(&easel);
	draw_easel(&easel, 2);
	for (int i = 0; i < 80000; i++) {
		int x[2], y[2];
		double tones[2];
		bool met = true;
		for (int k = 0; k < 2; k++) {
			x[k] = (int)(WIDTH * 0.9999 * field_random(&seed));
			y[k] = (int)(HEIGHT * 0.9999 * field_random(&seed));
			met = met && id_at(&easel, x[k], y[k]) == 3 &&
			      tone_of_ball(&easel, x[k], y[k], &tones[k]);
		}
		if (!met || tones[0] < tones[1] + 0.02)
			continue;
		compared++;
		assert_true(grey_at(&easel, x[0], y[0]) >= grey_at(&easel, x[1], y[1]));
	}
	assert_true(compared > 1000);
	assert_int_equal(grey_at(&easel, 2, 2), 255);
	assert_int_equal(id_at(&easel, 2, 2), 0);
	take_down_easel(&easel);
}

static void dark_line_runs_around_the_ball(void **state)
{
	(void)state;
	struct easel easel;
	int border = 0;
	set_up_easel(&easel);
	draw_easel(&easel, 2);
	for (int y = 1; y < HEIGHT - 1; y++)
		for (int x = 1; x < WIDTH - 1; x++) {
			if (id_at(&easel, x, y) == 0)
				continue;
			const bool edge =
				id_at(&easel, x - 1, y) == 0 || id_at(&easel, x + 1, y) == 0 ||
				id_at(&easel, x, y - 1) == 0 || id_at(&easel, x, y + 1) == 0;
			border += edge;
			assert_true(!edge || grey_at(&easel, x, y) <= 52);
		}
	assert_true(border > 150);
	take_down_easel(&easel);
}

/* A ball that is turned inside out is seen from behind, and drawn as if it were not. */
static void inside_out_looks_the_same(void **state)
{
	(void)state;
	static uint32_t right[PIXELS];
	struct easel easel;
	int apart = 0;
	set_up_easel(&easel);
	easel.look.single.surface_shape = easel.look.single.curvature = 0.5;
	draw_easel(&easel, 1);
	memcpy(right, gz_image_words(&easel.image), sizeof right);
	struct gz_mesh *mesh = &easel.meshes[0];
	for (size_t t = 0; t < mesh->triangle_count; t++)
		mesh_turn(mesh, t);
	for (size_t v = 0; v < mesh->vertex_count; v++)
		for (int axis = 0; axis < 3; axis++)
			mesh->normals[v][axis] = -mesh->normals[v][axis];
	draw_easel(&easel, 1);
	for (int i = 0; i < PIXELS; i++) {
		const int a = (int)(right[i] & 255);
		const int b = (int)(gz_image_words(&easel.image)[i] & 255);
		apart = abs(a - b) > apart ? abs(a - b) : apart;
	}
	print_message("most %d levels apart\n", apart);
	assert_true(apart <= 3);
	take_down_easel(&easel);
}

static void threads_give_the_same_bits(void **state)
{
	(void)state;
	static uint32_t alone[PIXELS];
	struct easel easel;
	set_up_easel(&easel);
	add_ball(&easel, -9, -15, 3);
	easel.look.single.object_distance = 0.5;
	easel.chosen_id = 4;
	draw_easel(&easel, 1);
	memcpy(alone, gz_image_words(&easel.image), sizeof alone);
	draw_easel(&easel, 3);
	assert_memory_equal(alone, gz_image_words(&easel.image), sizeof alone);
	take_down_easel(&easel);
}

/* Where the eye looks, a foveated plan gives what all rays give, but for the histogram, which has
 * fewer points in the periphery. */
static void foveated_picture_is_sharp_at_the_gaze(void **state)
{
	(void)state;
	static uint32_t full[PIXELS];
	struct easel easel;
	int apart = 0;
	set_up_easel(&easel);
	draw_easel(&easel, 2);
	memcpy(full, gz_image_words(&easel.image), sizeof full);
	const uint64_t all = easel.plan.ray_count;
	easel.foveation = gz_foveation_full();
	easel.foveation.method = gz_method_find("acuity");
	easel.foveation.acuity_slope = 0.15; /* the small picture is coarse already */
	draw_easel(&easel, 2);
	assert_true(easel.plan.ray_count < all);
	for (int y = 50; y < 58; y++)
		for (int x = 60; x < 68; x++) {
			const int a = (int)(full[y * WIDTH + x] & 255);
			const int b = grey_at(&easel, x, y);
			apart = abs(a - b) > apart ? abs(a - b) : apart;
		}
	print_message("%llu of %llu rays, most %d levels apart\n",
		      (unsigned long long)easel.plan.ray_count, (unsigned long long)all, apart);
	assert_true(apart <= 6);
	take_down_easel(&easel);
}

static double mean_of_object(const struct easel *easel, uint32_t id)
{
	double sum = 0;
	int count = 0;
	for (int i = 0; i < PIXELS; i++)
		if (easel->ids.words[i] == id) {
			sum += grey_at(easel, i % WIDTH, i / WIDTH);
			count++;
		}
	assert_true(count > 50);
	return sum / count;
}

static void what_does_not_matter_fades(void **state)
{
	(void)state;
	struct easel easel;
	set_up_easel(&easel);
	add_ball(&easel, -9, -15, 3);
	plain_look(&easel);
	draw_easel(&easel, 2);
	const double plain[2] = { mean_of_object(&easel, 3), mean_of_object(&easel, 4) };
	easel.look.single.importance = 1;
	easel.styles[0].importance = 0.25;
	draw_easel(&easel, 2);
	assert_float_equal(mean_of_object(&easel, 3), 0.25 * plain[0] + 0.75 * 255, 0.6);
	assert_float_equal(mean_of_object(&easel, 4), plain[1], 0.6);
	/* Of an object as far as the other, nothing is left; the chosen one stays. */
	easel.look.single.importance = 0;
	easel.look.single.object_distance = 1;
	easel.look.single.object_distance_mm = 0.5;
	easel.chosen_id = 4;
	draw_easel(&easel, 2);
	assert_float_equal(mean_of_object(&easel, 4), plain[1], 0.6);
	assert_true(mean_of_object(&easel, 3) > 250);
	take_down_easel(&easel);
}

/* ---- several objects ---- */

enum { SHEETS = 9 };

/* Rectangles across the view, in mm of the picture: right and up from its middle. */
struct sheet {
	double least[2], greatest[2], depth; /* away from the viewer */
	double importance, transparency;
};

/* A mesh of one sheet. The viewer looks along +y. */
static struct gz_mesh mesh_of_sheet(const struct sheet *sheet)
{
	struct gz_mesh mesh;
	assert_int_equal(gz_mesh_allocate(4, 2, &mesh), GZ_OK);
	for (int v = 0; v < 4; v++) {
		const double corner[3] = { v & 1 ? sheet->greatest[0] : sheet->least[0],
					   sheet->depth,
					   v & 2 ? sheet->greatest[1] : sheet->least[1] };
		for (int axis = 0; axis < 3; axis++) {
			mesh.positions[v][axis] = (float)corner[axis];
			mesh.normals[v][axis] = axis == 1 ? -1 : 0;
		}
	}
	static const uint32_t triangles[2][3] = { { 0, 1, 2 }, { 1, 3, 2 } };
	memcpy(mesh.triangles, triangles, sizeof triangles);
	return mesh;
}

static int nearer_first(const void *a, const void *b)
{
	const double x = ((const struct sheet *)a)->depth, y = ((const struct sheet *)b)->depth;
	return (x > y) - (x < y);
}

/* What sheets in the order of their depth show at a place: each as bright as it is unimportant.
 * Three transparent ones count, and the next opaque one behind them. false: too near to a border.
 */
static bool blend_sheets(const struct sheet sorted[SHEETS], const double place[2], double *out_tone)
{
	double through = 1, sum = 0;
	int layers = 0;
	for (int i = 0; i < SHEETS; i++) {
		const struct sheet *sheet = &sorted[i];
		bool covers = true;
		for (int axis = 0; axis < 2; axis++) {
			if (fabs(place[axis] - sheet->least[axis]) < 0.2 ||
			    fabs(place[axis] - sheet->greatest[axis]) < 0.2)
				return false;
			covers = covers && place[axis] > sheet->least[axis] &&
				 place[axis] < sheet->greatest[axis];
		}
		if (!covers || (layers == 3 && sheet->transparency > 0))
			continue;
		sum += through * (1 - sheet->transparency) * (1 - sheet->importance);
		through *= sheet->transparency;
		layers++;
	}
	*out_tone = sum + through;
	return true;
}

static void make_sheets(uint32_t *seed, struct sheet sheets[SHEETS])
{
	for (int i = 0; i < SHEETS; i++) {
		struct sheet *sheet = &sheets[i];
		for (int axis = 0; axis < 2; axis++) {
			sheet->least[axis] = -18 + 14 * field_random(seed);
			sheet->greatest[axis] = 18 - 14 * field_random(seed);
		}
		sheet->depth = -18 + 36 * field_random(seed);
		sheet->importance = field_random(seed);
		sheet->transparency = i % 3 == 0 ? 0 : field_random(seed);
	}
}

static void transparent_objects_blend_by_depth(void **state)
{
	(void)state;
	struct easel easel;
	uint32_t seed = 5;
	set_up_easel(&easel);
	plain_look(&easel);
	easel.camera.projection = GZ_PROJECTION_ORTHOGRAPHIC;
	easel.look.single.main_light = easel.look.single.flat = 0;
	easel.look.single.equalisation = 0;
	easel.look.single.importance = 1;
	for (int round = 0; round < 4; round++) {
		struct sheet sheets[SHEETS];
		struct gz_mesh meshes[SHEETS];
		struct gz_object objects[SHEETS];
		struct gz_object_style styles[SHEETS];
		struct gz_illustrate_caster *caster = new_caster(2, NULL);
		int compared = 0;
		make_sheets(&seed, sheets);
		for (int i = 0; i < SHEETS; i++) {
			meshes[i] = mesh_of_sheet(&sheets[i]);
			styles[i] = (struct gz_object_style) {
				.importance = sheets[i].importance,
				.transparency = sheets[i].transparency,
			};
			objects[i] = (struct gz_object) { .id = 20 - (uint32_t)i,
							  .volume = &easel.volume,
							  .mesh = &meshes[i],
							  .style = &styles[i] };
		}
		assert_int_equal(gz_illustrate_caster_show(caster, objects, SHEETS), GZ_OK);
		assert_int_equal(draw_shot(caster, &easel), GZ_OK);
		qsort(sheets, SHEETS, sizeof sheets[0], nearer_first);
		for (int i = 0; i < PIXELS; i++) {
			const int x = i % WIDTH, y = i / WIDTH;
			const double place[2] = { 40 * (x + 0.5 - WIDTH / 2) / HEIGHT,
						  -40 * (y + 0.5 - HEIGHT / 2) / HEIGHT };
			double tone;
			if (!blend_sheets(sheets, place, &tone))
				continue;
			compared++;
			if (fabs(grey_at(&easel, x, y) - 255 * tone) > 0.6)
				fail_msg("at %d, %d: %d, not %.2f", x, y, grey_at(&easel, x, y),
					 255 * tone);
		}
		assert_true(compared > PIXELS / 3);
		gz_illustrate_caster_destroy(&caster);
		for (int i = 0; i < SHEETS; i++)
			gz_mesh_free(&meshes[i]);
	}
	take_down_easel(&easel);
}

/* The curve of a sheet of one tone, 1/2: nothing of the sheet can be seen, but the ball behind it
 * has its curve. */
static void layers_behind_have_the_curve_of_the_front(void **state)
{
	(void)state;
	static struct gz_tone_histogram histogram;
	static struct gz_tone_curve curve;
	const struct sheet whole = { { -19, -19 }, { 19, 19 }, -18, 1, 1 };
	struct easel easel;
	int compared = 0;
	set_up_easel(&easel);
	plain_look(&easel);
	easel.meshes[1] = mesh_of_sheet(&whole);
	easel.styles[1].transparency = 1;
	easel.count = 2;
	draw_easel(&easel, 2);
	memset(&histogram, 0, sizeof histogram);
	histogram.counts[GZ_TONE_BINS / 2] = 1;
	gz_tone_curve_make(&histogram, 1, &curve);
	gz_tone_curve_steady(&curve);
	for (int i = 0; i < PIXELS; i++) {
		const uint32_t object = 1;
		double tone;
		const int x = i % WIDTH, y = i / WIDTH;
		const bool within = tone_of_ball(&easel, x - 4, y, &tone) &&
				    tone_of_ball(&easel, x + 4, y, &tone) &&
				    tone_of_ball(&easel, x, y - 4, &tone) &&
				    tone_of_ball(&easel, x, y + 4, &tone) &&
				    tone_of_ball(&easel, x, y, &tone);
		if (!within)
			continue;
		float shown = (float)tone;
		gz_tone_apply(&curve, &object, 1, &shown);
		compared++;
		if (fabs(grey_at(&easel, i % WIDTH, i / WIDTH) - 255 * (double)shown) > 8)
			fail_msg("pixel %d: %d, not %.1f", i, grey_at(&easel, i % WIDTH, i / WIDTH),
				 255 * (double)shown);
	}
	assert_true(compared > 1500);
	take_down_easel(&easel);
}

static void template_of_an_object_changes_it_alone(void **state)
{
	(void)state;
	static uint32_t before[PIXELS];
	struct easel easel;
	struct gz_shading_template vessels;
	int changed = 0;
	set_up_easel(&easel);
	add_ball(&easel, -9, -15, 3);
	easel.look.source = GZ_ILLUSTRATION_COMBINED;
	easel.look.combined = (struct gz_illustration_settings) { 0.2, 0.5, 0.5, 0.5, 0.5, 0 };
	easel.look.single.equalisation = 0;
	draw_easel(&easel, 2);
	memcpy(before, gz_image_words(&easel.image), sizeof before);
	assert_int_equal(gz_shading_template_named("vessels", &vessels), GZ_OK);
	easel.objects[1].shading_template = &vessels;
	draw_easel(&easel, 2);
	for (int i = 0; i < PIXELS; i++) {
		const bool same = before[i] == gz_image_words(&easel.image)[i];
		changed += !same;
		if (!same && easel.ids.words[i] != 4)
			fail_msg("pixel %d of object %u changed", i, (unsigned)easel.ids.words[i]);
	}
	assert_true(changed > 200);
	take_down_easel(&easel);
}

/* Draw once more and return the time that preparing took, ms. */
static double prepare_ms_of(struct gz_illustrate_caster *caster, struct easel *easel)
{
	const struct gz_illustrate_shot shot = { .camera = &easel->camera,
						 .plan = &easel->plan,
						 .look = &easel->look };
	struct gz_frame_stats stats;
	assert_int_equal(gz_illustrate_caster_draw(caster, &shot, &easel->image, NULL, &stats),
			 GZ_OK);
	return stats.prepare_ms;
}

static void other_styles_make_nothing_again(void **state)
{
	(void)state;
	struct easel easel;
	struct gz_illustrate_caster *caster = new_caster(1, NULL);
	set_up_easel(&easel);
	add_ball(&easel, -9, -15, 3);
	assert_int_equal(gz_illustrate_caster_show(caster, easel.objects, 2), GZ_OK);
	assert_int_equal(draw_shot(caster, &easel), GZ_OK);
	easel.styles[1].transparency = 0.5;
	assert_int_equal(gz_illustrate_caster_show(caster, easel.objects, 2), GZ_OK);
	assert_true(prepare_ms_of(caster, &easel) == 0);
	assert_int_equal(gz_illustrate_caster_show(caster, easel.objects + 1, 1), GZ_OK);
	assert_true(prepare_ms_of(caster, &easel) > 0); /* another tree */
	easel.objects[1].data_revision++;
	assert_int_equal(gz_illustrate_caster_show(caster, easel.objects + 1, 1), GZ_OK);
	assert_true(prepare_ms_of(caster, &easel) > 0);
	assert_true(prepare_ms_of(caster, &easel) == 0);
	gz_illustrate_caster_destroy(&caster);
	take_down_easel(&easel);
}

/* A wall behind a ball, while the view turns by a tenth of a degree a frame, and then while the
 * gaze wanders: from frame to frame the wall keeps its brightness within 2 of 255. */
static void frames_that_differ_little_stay_alike(void **state)
{
	(void)state;
	const struct sheet wall = { { -17, -13 }, { 17, 13 }, 15, 1, 0 };
	struct easel easel;
	struct gz_illustrate_caster *caster = new_caster(2, NULL);
	double before = 0, most = 0;
	set_up_easel(&easel);
	plain_look(&easel);
	easel.meshes[1] = mesh_of_sheet(&wall);
	easel.foveation.method = GZ_METHOD_ACUITY;
	assert_int_equal(gz_illustrate_caster_show(caster, easel.objects, 2), GZ_OK);
	for (int frame = 0; frame < 80; frame++) {
		const double turn = 0.1 * (frame < 40 ? frame : 40) * 0.0174533;
		easel.camera.eye[0] = 2 * sin(turn);
		easel.camera.eye[1] = -2 * cos(turn);
		if (frame >= 40)
			easel.gaze.x = 0.1F + 0.02F * (float)(frame - 40);
		assert_int_equal(draw_shot(caster, &easel), GZ_OK);
		const double now = mean_of_object(&easel, 4);
		if (frame > 0 && fabs(now - before) > most)
			most = fabs(now - before);
		before = now;
	}
	print_message("greatest change of the wall from frame to frame: %.2f of 255\n", most);
	assert_true(most <= 2);
	gz_illustrate_caster_destroy(&caster);
	take_down_easel(&easel);
}

/* Nothing at all, triangles without area, and one of which all corners are one vertex. */
static void broken_meshes_are_drawn_as_far_as_they_go(void **state)
{
	(void)state;
	struct easel easel;
	set_up_easel(&easel);
	plain_look(&easel); /* depths begin at the farthest vertex */
	draw_easel(&easel, 2);
	const double whole = mean_of_object(&easel, 3);
	easel.count = 2;
	draw_easel(&easel, 2); /* the second mesh is empty */
	assert_true(mean_of_object(&easel, 3) == whole);
	easel.meshes[1] = mesh_of_sheet(&(struct sheet) { { 5, 5 }, { 5, 5 }, -18, 1, 0 });
	memset(easel.meshes[1].normals, 0, 4 * sizeof easel.meshes[1].normals[0]);
	easel.meshes[1].triangles[0][1] = easel.meshes[1].triangles[0][2] = 0;
	draw_easel(&easel, 2);
	assert_true(mean_of_object(&easel, 3) == whole);
	take_down_easel(&easel);
}

/* Instruction sets draw the same picture: Embree may find a place some last bits apart. */
static void instruction_sets_draw_alike(void **state)
{
	(void)state;
	static const char *const sets[] = { "avx2", "avx512" };
	static uint32_t portable[WIDTH * HEIGHT];
	for (size_t k = 0; k < 2 * sizeof sets / sizeof *sets; k++) {
		struct easel easel;
		size_t others = 0;
		const char *simd = sets[k / 2];
		if (!gz_cast_kernels_find(simd))
			continue;
		set_up_easel(&easel);
		easel.styles[0].transparency = k % 2 == 0 ? 0 : 0.5;
		easel.look.single.surface_shape = easel.look.single.curvature = 0.5;
		easel.look.single.plain_light = easel.look.single.plateau_light = 0.5;
		for (int i = 0; i < 2; i++) {
			struct gz_illustrate_caster *caster =
				new_caster(2, i == 0 ? "portable" : simd);
			assert_int_equal(
				gz_illustrate_caster_show(caster, easel.objects, easel.count),
				GZ_OK);
			assert_int_equal(draw_shot(caster, &easel), GZ_OK);
			const uint32_t *words = gz_image_words(&easel.image);
			for (int at = 0; at < WIDTH * HEIGHT && i > 0; at++)
				others +=
					abs((int)(words[at] & 255) - (int)(portable[at] & 255)) > 1;
			memcpy(portable, words, sizeof portable);
			gz_illustrate_caster_destroy(&caster);
		}
		if (others > WIDTH * HEIGHT / 1000)
			fail_msg("%s: %zu pixels differ", simd, others);
		take_down_easel(&easel);
	}
}

static void what_cannot_be_drawn_is_refused(void **state)
{
	(void)state;
	struct easel easel;
	struct gz_illustrate_caster *caster = new_caster(1, "portable");
	set_up_easel(&easel);
	assert_string_equal(gz_illustrate_caster_describe(caster), "portable, 1 threads");
	assert_int_equal(draw_shot(caster, &easel), GZ_ERR_INVAL); /* nothing is shown */
	assert_int_equal(gz_illustrate_caster_show(caster, easel.objects, 0), GZ_ERR_INVAL);
	easel.styles[0].importance = 2;
	assert_int_equal(gz_illustrate_caster_show(caster, easel.objects, 1), GZ_ERR_INVAL);
	easel.styles[0] = (struct gz_object_style) { .importance = 1, .transparency = -0.1 };
	assert_int_equal(gz_illustrate_caster_show(caster, easel.objects, 1), GZ_ERR_INVAL);
	easel.styles[0].transparency = 0;
	easel.objects[0].id = 0;
	assert_int_equal(gz_illustrate_caster_show(caster, easel.objects, 1), GZ_ERR_INVAL);
	easel.objects[0].id = 3;
	assert_int_equal(gz_illustrate_caster_show(caster, easel.objects, 1), GZ_OK);
	assert_int_equal(draw_shot(caster, &easel), GZ_OK);
	easel.objects[0].volume = NULL;
	assert_int_equal(gz_illustrate_caster_show(caster, easel.objects, 1), GZ_ERR_UNSUPPORTED);
	assert_int_equal(draw_shot(caster, &easel), GZ_OK); /* what was there */
	easel.look.single.line_width = 9;
	assert_int_equal(draw_shot(caster, &easel), GZ_ERR_INVAL);
	gz_illustrate_caster_destroy(&caster);
	assert_null(caster);
	gz_illustrate_caster_destroy(&caster);
	take_down_easel(&easel);
}

/* The mean brightness of all objects. */
static double mean_of_objects(const struct easel *easel)
{
	double sum = 0;
	size_t count = 0;
	for (int i = 0; i < PIXELS; i++)
		if (easel->ids.words[i] != 0) {
			sum += gz_image_words(&((struct easel *)easel)->image)[i] & 255;
			count++;
		}
	return sum / 255 / (double)count;
}

/* A drawing is as dark as the grey picture, with every pixel cast and foveated. */
static void check_darkness(struct easel *easel, int drawing)
{
	const int methods[] = { GZ_METHOD_STANDARD, GZ_METHOD_ACUITY };
	easel->look.pen_width = 1.5;
	for (int i = 0; i < 2; i++) {
		easel->foveation.method = methods[i];
		easel->look.drawing = GZ_DRAWING_GREY;
		draw_easel(easel, 2);
		const double grey = mean_of_objects(easel);
		easel->look.drawing = drawing;
		draw_easel(easel, 2);
		const double drawn = mean_of_objects(easel);
		if (fabs(drawn - grey) > 0.05)
			fail_msg("drawing %d, method %d: %g, the map %g", drawing, methods[i],
				 drawn, grey);
	}
}

/* A picture of 640 x 480 pixels. */
static void draw_large(struct easel *easel, int drawing, struct gz_image *out_image)
{
	struct gz_illustrate_caster *caster = new_caster(2, NULL);
	const struct gz_display display = gz_display_default(LARGE_WIDTH, LARGE_HEIGHT);
	const struct gz_illustrate_planes planes = { &easel->depth, &easel->ids };
	const struct gz_illustrate_shot shot = { .camera = &easel->camera,
						 .plan = &easel->plan,
						 .look = &easel->look };
	easel->look.drawing = drawing;
	assert_int_equal(gz_plan_make(&easel->foveation, &display, easel->gaze, LARGE_WIDTH,
				      LARGE_HEIGHT, &easel->plan),
			 GZ_OK);
	assert_int_equal(gz_illustrate_caster_show(caster, easel->objects, easel->count), GZ_OK);
	assert_int_equal(gz_illustrate_caster_draw(caster, &shot, out_image, &planes, NULL), GZ_OK);
	gz_illustrate_caster_destroy(&caster);
}

/* The mean brightness of a square of pixels, or -1 if some of it is background. */
static double tone_of_square(const struct easel *easel, const struct gz_image *image, int left,
			     int top)
{
	double sum = 0;
	for (int y = top; y < top + SQUARE; y++)
		for (int x = left; x < left + SQUARE; x++) {
			if (easel->ids.words[y * LARGE_WIDTH + x] == 0)
				return -1;
			sum += image->pixels[4 * (y * LARGE_WIDTH + x)];
		}
	return sum / 255 / (SQUARE * SQUARE);
}

/* Squares of 32 pixels are as dark as their map, at light and dark tones. A ball is the worst body
 * for strokes: it bends alike in all directions, so they turn and end everywhere. */
static void squares_of_drawings_are_as_dark_as_the_map(void **state)
{
	(void)state;
	struct easel easel;
	set_up_easel(&easel);
	plain_look(&easel);
	easel.camera.eye[1] = -1.1;
	easel.look.pen_width = 1.5;
	static const struct {
		double rms, beyond, worst;
	} most[] = { [GZ_DRAWING_STIPPLES] = { 0.012, 0, 0.04 },
		     [GZ_DRAWING_HATCHES] = { 0.03, 0.04, 0.09 } };
	for (int drawing = GZ_DRAWING_STIPPLES; drawing <= GZ_DRAWING_HATCHES; drawing++) {
		struct gz_image grey = { 0 }, drawn = { 0 };
		double sum = 0, worst = 0, lightest = 0, darkest = 1;
		int squares = 0, beyond = 0;
		draw_large(&easel, GZ_DRAWING_GREY, &grey);
		draw_large(&easel, drawing, &drawn);
		for (int top = 0; top + SQUARE <= LARGE_HEIGHT; top += SQUARE)
			for (int left = 0; left + SQUARE <= LARGE_WIDTH; left += SQUARE) {
				const double map = tone_of_square(&easel, &grey, left, top);
				if (map < 0)
					continue;
				const double tone = tone_of_square(&easel, &drawn, left, top);
				worst = fmax(worst, fabs(tone - map));
				lightest = fmax(lightest, map);
				darkest = fmin(darkest, map);
				sum += (tone - map) * (tone - map);
				beyond += fabs(tone - map) > 0.05;
				squares++;
			}
		print_message("drawing %d: %d squares, rms %.3f, %d beyond 0.05, worst %.3f\n",
			      drawing, squares, sqrt(sum / squares), beyond, worst);
		assert_true(squares > 60 && lightest > 0.85 && darkest < 0.2);
		assert_true(sqrt(sum / squares) < most[drawing].rms);
		assert_true(beyond <= most[drawing].beyond * squares);
		assert_true(worst < most[drawing].worst);
		gz_image_free(&grey);
		gz_image_free(&drawn);
	}
	take_down_easel(&easel);
}

static void drawings_are_as_dark_as_the_map(void **state)
{
	(void)state;
	struct easel easel;
	set_up_easel(&easel);
	plain_look(&easel);
	easel.camera.eye[1] = -1;
	check_darkness(&easel, GZ_DRAWING_STIPPLES);
	check_darkness(&easel, GZ_DRAWING_HATCHES);
	take_down_easel(&easel);
}

/* The ball behind is drawn by points of its own through the transparent one. */
static void points_of_all_layers_together_have_the_tone(void **state)
{
	(void)state;
	struct easel easel;
	set_up_easel(&easel);
	plain_look(&easel);
	add_ball(&easel, 0, 0, 0);
	easel.camera.eye[1] = -1;
	easel.styles[0].transparency = 0.6;
	check_darkness(&easel, GZ_DRAWING_STIPPLES);
	take_down_easel(&easel);
}

static void drawing_has_ink_and_paper_and_lines(void **state)
{
	(void)state;
	struct easel easel;
	struct gz_image alone = { 0 };
	size_t between = 0;
	set_up_easel(&easel);
	easel.look.drawing = GZ_DRAWING_STIPPLES;
	easel.look.pen_width = 8;
	easel.look.single.lines = 1;
	draw_easel(&easel, 2);
	for (int i = 0; i < PIXELS; i++) {
		const int grey = grey_at(&easel, i % WIDTH, i / WIDTH);
		between += grey > 0 && grey < 255;
		if (easel.ids.words[i] != 0 && easel.ids.words[i - 1] == 0)
			assert_int_equal(grey, 0); /* a line all around */
	}
	assert_true(between < PIXELS / 20); /* rims of points alone */
	memcpy(&alone, &easel.image, sizeof alone);
	memset(&easel.image, 0, sizeof easel.image);
	draw_easel(&easel, 1);
	assert_memory_equal(alone.pixels, easel.image.pixels, 4 * (size_t)PIXELS);
	gz_image_free(&alone);
	take_down_easel(&easel);
}

/* As an object that vanishes at an isovalue, and one whose triangles have no area. */
static void surface_without_area_has_no_marks(void **state)
{
	(void)state;
	struct easel easel;
	set_up_easel(&easel);
	for (size_t i = 0; i < easel.meshes[0].triangle_count; i++)
		easel.meshes[0].triangles[i][1] = easel.meshes[0].triangles[i][0];
	for (int i = 0; i < 2; i++) {
		for (int drawing = GZ_DRAWING_STIPPLES; drawing <= GZ_DRAWING_HATCHES; drawing++) {
			easel.look.drawing = drawing;
			draw_easel(&easel, 2);
			for (int pixel = 0; pixel < PIXELS; pixel++)
				assert_int_equal(grey_at(&easel, pixel % WIDTH, pixel / WIDTH),
						 255);
		}
		easel.meshes[0].triangle_count = easel.meshes[0].vertex_count = 0;
	}
	take_down_easel(&easel);
}

/* Shells within the ball, as one object: most of all area is hidden. */
static void add_shells_within(struct easel *easel)
{
	enum { SHELLS = 8 };
	const struct gz_mesh *ball = &easel->meshes[0];
	struct gz_mesh shells;
	assert_int_equal(gz_mesh_allocate(SHELLS * ball->vertex_count,
					  SHELLS * ball->triangle_count, &shells),
			 GZ_OK);
	for (size_t i = 0; i < shells.vertex_count; i++)
		for (int axis = 0; axis < 3; axis++) {
			const size_t from = i % ball->vertex_count;
			const float share = 0.95F - 0.02F * (float)(i / ball->vertex_count);
			shells.positions[i][axis] = share * ball->positions[from][axis];
			shells.normals[i][axis] = ball->normals[from][axis];
		}
	for (size_t i = 0; i < shells.triangle_count; i++)
		for (int k = 0; k < 3; k++)
			shells.triangles[i][k] =
				ball->triangles[i % ball->triangle_count][k] +
				(uint32_t)(i / ball->triangle_count * ball->vertex_count);
	easel->meshes[1] = shells;
	easel->count = 2;
}

/* How often rows of a large drawing go from paper to ink. */
static size_t count_marks_met(struct easel *easel, int drawing)
{
	struct gz_image image = { 0 };
	size_t met = 0;
	draw_large(easel, drawing, &image);
	for (int y = 0; y < LARGE_HEIGHT; y++)
		for (int x = 1; x < LARGE_WIDTH; x++) {
			const uint8_t *pixel =
				image.pixels + 4 * ((size_t)y * LARGE_WIDTH + (size_t)x);
			met += pixel[0] < 128 && pixel[-4] >= 128;
		}
	gz_image_free(&image);
	return met;
}

static void marks_are_fine_though_objects_hide_others(void **state)
{
	(void)state;
	struct easel easel;
	size_t alone[2];
	set_up_easel(&easel);
	plain_look(&easel);
	easel.camera.eye[1] = -1;
	easel.look.pen_width = 1.5;
	for (int i = 0; i < 2; i++)
		alone[i] = count_marks_met(&easel, i ? GZ_DRAWING_HATCHES : GZ_DRAWING_STIPPLES);
	add_shells_within(&easel);
	for (int i = 0; i < 2; i++) {
		const size_t met =
			count_marks_met(&easel, i ? GZ_DRAWING_HATCHES : GZ_DRAWING_STIPPLES);
		/* A seventh of the area with a seventh of the marks would be 0.38 of them. */
		if (met < 0.6 * (double)alone[i])
			fail_msg("drawing %d: %zu marks are met, alone %zu", i, met, alone[i]);
	}
	take_down_easel(&easel);
}

static void parameter_alone_is_grey(void **state)
{
	(void)state;
	struct easel easel;
	struct gz_image grey = { 0 };
	set_up_easel(&easel);
	easel.look.show = GZ_SHOW_PLAIN;
	draw_easel(&easel, 2);
	memcpy(&grey, &easel.image, sizeof grey);
	memset(&easel.image, 0, sizeof easel.image);
	easel.look.drawing = GZ_DRAWING_HATCHES;
	draw_easel(&easel, 2);
	assert_memory_equal(grey.pixels, easel.image.pixels, 4 * (size_t)PIXELS);
	gz_image_free(&grey);
	take_down_easel(&easel);
}

/* While a thread makes points the picture is grey, to the last bit; then it is the drawing. */
static void picture_is_grey_until_its_marks_are_made(void **state)
{
	(void)state;
	static const struct timespec pause = { .tv_nsec = 1000 * 1000 };
	for (int drawing = GZ_DRAWING_STIPPLES; drawing <= GZ_DRAWING_HATCHES; drawing++) {
		const struct gz_backend_params params = { .threads = 2 };
		struct easel easel;
		struct gz_image grey = { 0 }, drawn = { 0 };
		struct gz_illustrate_caster *caster = NULL;
		struct gz_frame_stats stats;
		set_up_easel(&easel);
		draw_easel(&easel, 2);
		move_image(&easel.image, &grey);
		easel.look.drawing = drawing;
		draw_easel(&easel, 2);
		move_image(&easel.image, &drawn);
		assert_int_equal(gz_illustrate_caster_create(&params, NULL, &caster), GZ_OK);
		assert_int_equal(gz_illustrate_caster_show(caster, easel.objects, easel.count),
				 GZ_OK);
		assert_int_equal(draw_counted(caster, &easel, &stats), GZ_OK);
		assert_int_equal(stats.bricks_coming, 1);
		assert_memory_equal(easel.image.pixels, grey.pixels, 4 * (size_t)PIXELS);
		while (stats.bricks_coming > 0) {
			(void)nanosleep(&pause, NULL);
			assert_int_equal(draw_counted(caster, &easel, &stats), GZ_OK);
		}
		assert_memory_equal(easel.image.pixels, drawn.pixels, 4 * (size_t)PIXELS);
		/* what a thread makes of meshes that have gone is left, also by the end */
		add_ball(&easel, 9, 0, 9);
		assert_int_equal(gz_illustrate_caster_show(caster, easel.objects, 2), GZ_OK);
		assert_int_equal(draw_counted(caster, &easel, &stats), GZ_OK);
		assert_int_equal(stats.bricks_coming, 1);
		assert_int_equal(gz_illustrate_caster_show(caster, easel.objects + 1, 1), GZ_OK);
		assert_int_equal(draw_counted(caster, &easel, &stats), GZ_OK);
		gz_illustrate_caster_destroy(&caster);
		gz_image_free(&grey);
		gz_image_free(&drawn);
		take_down_easel(&easel);
	}
}

/* The mean brightness of one object, and what share of its pixels is bare paper. */
static double tone_of_object(const struct easel *easel, uint32_t id, double *out_bare)
{
	double sum = 0;
	int count = 0, bare = 0;
	for (int i = 0; i < PIXELS; i++)
		if (easel->ids.words[i] == id) {
			const int grey = grey_at(easel, i % WIDTH, i / WIDTH);
			sum += grey;
			bare += grey == 255;
			count++;
		}
	assert_true(count > 300);
	*out_bare = (double)bare / count;
	return sum / 255 / count;
}

/* Each object is drawn in its own way, whatever the scene says, and is as dark as its map. */
static void objects_are_drawn_each_in_its_own_way(void **state)
{
	(void)state;
	struct easel easel;
	struct gz_image grey = { 0 };
	double bare[2][2];
	set_up_easel(&easel);
	plain_look(&easel);
	add_ball(&easel, 0, -14, 0);
	easel.camera.eye[1] = -1;
	easel.look.pen_width = 1.5;
	draw_easel(&easel, 2);
	const double map[2] = { tone_of_object(&easel, 3, &bare[0][0]),
				tone_of_object(&easel, 4, &bare[0][1]) };
	move_image(&easel.image, &grey);
	for (int drawn = 0; drawn < 2; drawn++) {
		easel.styles[drawn].drawing = 1 + GZ_DRAWING_STIPPLES;
		easel.styles[1 - drawn].drawing = 0; /* as the scene: grey */
		draw_easel(&easel, 2);
		for (int i = 0; i < 2; i++)
			assert_float_equal(tone_of_object(&easel, 3 + (uint32_t)i, &bare[1][i]),
					   map[i], 0.05);
		assert_true(bare[1][drawn] > bare[0][drawn] + 0.1);
		assert_float_equal(bare[1][1 - drawn], bare[0][1 - drawn], 0.02);
	}
	/* the grey ball inside keeps its pixels, but for marks that reach over its rim */
	int other = 0;
	for (int i = 0; i < PIXELS; i++)
		other += easel.ids.words[i] == 3 && grey_at(&easel, i % WIDTH, i / WIDTH) !=
							    (int)(gz_image_words(&grey)[i] & 255);
	assert_in_range(other, 0, 300);
	/* what all objects say replaces what the scene says */
	easel.look.drawing = GZ_DRAWING_HATCHES;
	easel.styles[0].drawing = easel.styles[1].drawing = 1 + GZ_DRAWING_GREY;
	draw_easel(&easel, 2);
	assert_memory_equal(easel.image.pixels, grey.pixels, 4 * (size_t)PIXELS);
	gz_image_free(&grey);
	take_down_easel(&easel);
}

/* Of a grey object behind a transparent one that is drawn, and the other way round. */
static void grey_and_drawn_layers_together_have_the_tone(void **state)
{
	(void)state;
	for (int drawn = 0; drawn < 2; drawn++) {
		struct easel easel;
		set_up_easel(&easel);
		plain_look(&easel);
		add_ball(&easel, 0, 0, 0);
		easel.camera.eye[1] = -1;
		easel.styles[0].transparency = 0.6;
		draw_easel(&easel, 2);
		const double grey = mean_of_objects(&easel);
		easel.look.pen_width = 1.5;
		easel.styles[drawn].drawing = 1 + GZ_DRAWING_STIPPLES;
		draw_easel(&easel, 2);
		assert_float_equal(mean_of_objects(&easel), grey, 0.05);
		take_down_easel(&easel);
	}
}

/* How the ink of a picture changes from pixel to pixel, to the right and down. */
static void measure_steps(const struct easel *easel, double out_steps[2])
{
	out_steps[0] = out_steps[1] = 0;
	for (int y = HEIGHT / 2 - 12; y < HEIGHT / 2 + 12; y++)
		for (int x = WIDTH / 2 - 12; x < WIDTH / 2 + 12; x++) {
			out_steps[0] += abs(grey_at(easel, x + 1, y) - grey_at(easel, x, y));
			out_steps[1] += abs(grey_at(easel, x, y + 1) - grey_at(easel, x, y));
		}
}

/* A ball that is pulled long stands for a tube: along it strokes are upright, around it level. */
static void strokes_run_along_or_around_a_tube(void **state)
{
	(void)state;
	double along[2], around[2], said[2];
	struct easel easel;
	set_up_easel(&easel);
	plain_look(&easel);
	for (size_t v = 0; v < easel.meshes[0].vertex_count; v++) {
		float *place = easel.meshes[0].positions[v], *normal = easel.meshes[0].normals[v];
		place[2] *= 4;
		normal[2] /= 4;
		const float length = sqrtf(normal[0] * normal[0] + normal[1] * normal[1] +
					   normal[2] * normal[2]);
		for (int axis = 0; axis < 3; axis++)
			normal[axis] /= length;
	}
	easel.camera.eye[1] = -1;
	easel.look.drawing = GZ_DRAWING_HATCHES;
	draw_easel(&easel, 2);
	measure_steps(&easel, along);
	easel.look.hatch_direction = GZ_HATCH_AROUND;
	draw_easel(&easel, 2);
	measure_steps(&easel, around);
	assert_true(along[0] > 1.5 * along[1]);
	assert_true(around[1] > 1.5 * around[0]);
	easel.styles[0].hatch_direction = 1 + GZ_HATCH_ALONG; /* of the object alone */
	draw_easel(&easel, 2);
	measure_steps(&easel, said);
	assert_true(said[0] == along[0] && said[1] == along[1]);
	easel.styles[0].hatch_direction = 3;
	struct gz_illustrate_caster *caster = new_caster(1, NULL);
	assert_int_equal(gz_illustrate_caster_show(caster, easel.objects, 1), GZ_ERR_INVAL);
	gz_illustrate_caster_destroy(&caster);
	take_down_easel(&easel);
}

TEST_SUITE(illustrate)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(main_light_falls_from_upper_left),
		cmocka_unit_test(dark_line_runs_around_the_ball),
		cmocka_unit_test(inside_out_looks_the_same),
		cmocka_unit_test(threads_give_the_same_bits),
		cmocka_unit_test(foveated_picture_is_sharp_at_the_gaze),
		cmocka_unit_test(what_does_not_matter_fades),
		cmocka_unit_test(transparent_objects_blend_by_depth),
		cmocka_unit_test(layers_behind_have_the_curve_of_the_front),
		cmocka_unit_test(template_of_an_object_changes_it_alone),
		cmocka_unit_test(other_styles_make_nothing_again),
		cmocka_unit_test(frames_that_differ_little_stay_alike),
		cmocka_unit_test(broken_meshes_are_drawn_as_far_as_they_go),
		cmocka_unit_test(instruction_sets_draw_alike),
		cmocka_unit_test(what_cannot_be_drawn_is_refused),
		cmocka_unit_test(drawings_are_as_dark_as_the_map),
		cmocka_unit_test(squares_of_drawings_are_as_dark_as_the_map),
		cmocka_unit_test(points_of_all_layers_together_have_the_tone),
		cmocka_unit_test(drawing_has_ink_and_paper_and_lines),
		cmocka_unit_test(surface_without_area_has_no_marks),
		cmocka_unit_test(marks_are_fine_though_objects_hide_others),
		cmocka_unit_test(parameter_alone_is_grey),
		cmocka_unit_test(picture_is_grey_until_its_marks_are_made),
		cmocka_unit_test(objects_are_drawn_each_in_its_own_way),
		cmocka_unit_test(grey_and_drawn_layers_together_have_the_tone),
		cmocka_unit_test(strokes_run_along_or_around_a_tube),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
