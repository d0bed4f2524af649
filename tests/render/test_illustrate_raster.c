/* Illustrations by triangles look as they do by rays, whatever they show. */
#include "suite.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <GL/glew.h>

#include "base/captured_log.h"
#include "lent_context.h"
#include "mesh_fields.h"
#include "mesh_shapes.h"
#include "render/illustration/cpu/illustrate_caster.h"
#include "render/illustration/gl/illustrate_points.h"
#include "render/illustration/gl/illustrate_programs.h"
#include "render/illustration/gl/illustrate_raster.h"
#include "render/illustration/technique/illustrate_technique.h"
#include "render/layers/raster_layers.h"
#include "render/mesh/label_surfaces.h"
#include "render/plan/method.h"
#include "render/raycast/shared/ray_params.h"
#include "shader_check.h"

enum { WIDTH = 100, HEIGHT = 76, PIXELS = WIDTH * HEIGHT, BALLS_MAX = 6 };

/* One for all tests: its shaders are compiled once. */
/* Pictures wait until their marks are made. */
static const struct gz_backend_params waiting = { .wait_for_bricks = true };

static struct gz_illustrate_raster *raster;

/* What a test draws: balls in a world 40 mm wide. */
struct easel {
	struct gz_volume volume;
	struct gz_mesh meshes[BALLS_MAX];
	struct gz_object objects[BALLS_MAX];
	struct gz_object_style styles[BALLS_MAX];
	size_t count;
	struct gz_camera camera;
	struct gz_illustration_look look;
	struct gz_clip_region clip;
	uint32_t chosen_id;
	struct gz_foveation foveation;
	struct gz_plan plan;
};

/* What a test gets. */
struct print {
	struct gz_image image;
	struct gz_plane depth, ids;
	struct gz_frame_stats stats;
};

static void set_up_easel(struct easel *easel)
{
	static const int dims[3] = { 4, 4, 4 };
	static const double spacing[3] = { 10, 10, 10 };
	struct gz_option_binding bindings[GZ_ILLUSTRATION_BINDINGS];
	memset(easel, 0, sizeof *easel);
	easel->volume = field_volume(field_ball, dims, spacing, GZ_VOXEL_F32);
	gz_illustration_look_bind(&easel->look, bindings);
	for (int i = 0; i < GZ_ILLUSTRATION_BINDINGS; i++)
		assert_int_equal(gz_options_preset(&bindings[i]), GZ_OK);
	easel->look.combined.spatial_effect = 1;
	easel->clip = gz_clip_whole;
	easel->foveation = gz_foveation_full();
	easel->camera = (struct gz_camera) {
		.eye = { 0.4, -1.9, 0.3 }, .up = { 0, 0, 1 }, .fov_deg = 30, .height = 1
	};
}

static void take_down_easel(struct easel *easel)
{
	for (size_t i = 0; i < easel->count; i++)
		gz_mesh_free(&easel->meshes[i]);
	gz_volume_free(&easel->volume);
	gz_plan_free(&easel->plan);
}

static void free_print(struct print *print)
{
	gz_image_free(&print->image);
	gz_plane_free(&print->depth);
	gz_plane_free(&print->ids);
}

/* A ball with bumps, so that curvature and levels of normals differ from place to place. */
static void add_ball(struct easel *easel, double radius_mm, const double place[3])
{
	const size_t i = easel->count++;
	struct gz_mesh *mesh = &easel->meshes[i];
	assert_true(i < BALLS_MAX);
	*mesh = mesh_ball(radius_mm, 4);
	memset(mesh->normals, 0, mesh->vertex_count * sizeof mesh->normals[0]); /* made anew */
	for (size_t v = 0; v < mesh->vertex_count; v++) {
		const double bump = 1 + 0.04 * sin(mesh->positions[v][0]) *
						cos(0.8 * (double)mesh->positions[v][2]);
		for (int axis = 0; axis < 3; axis++)
			mesh->positions[v][axis] =
				(float)(place[axis] + bump * (double)mesh->positions[v][axis]);
	}
	easel->styles[i].importance = 1;
	easel->objects[i] = (struct gz_object) { .technique = &gz_illustrate_technique,
						 .id = 3 + 100 * (uint32_t)i,
						 .volume = &easel->volume,
						 .mesh = mesh,
						 .style = &easel->styles[i] };
}

/* A large ball, and a small one before it. */
static void add_two_balls(struct easel *easel)
{
	add_ball(easel, 11, (double[3]) { 0, 2, 0 });
	add_ball(easel, 5, (double[3]) { 6, -9, -3 });
}

static struct gz_illustrate_shot shot_of(struct easel *easel)
{
	const struct gz_display display = gz_display_default(WIDTH, HEIGHT);
	const struct gz_point gaze = { 0.45F, 0.5F };
	assert_int_equal(
		gz_plan_make(&easel->foveation, &display, gaze, WIDTH, HEIGHT, &easel->plan),
		GZ_OK);
	return (struct gz_illustrate_shot) {
		.camera = &easel->camera,
		.plan = &easel->plan,
		.look = &easel->look,
		.clip = &easel->clip,
		.chosen_id = easel->chosen_id,
	};
}

/* Show the objects, none of which has been shown before: meshes of several tests may lie in one
 * place. */
static void show_all(struct easel *easel)
{
	static uint64_t revision;
	revision++;
	for (size_t i = 0; i < easel->count; i++)
		easel->objects[i].data_revision = revision;
	assert_int_equal(gz_illustrate_raster_show(raster, easel->objects, easel->count), GZ_OK);
}

static void draw_triangles(struct easel *easel, struct print *print)
{
	const struct gz_illustrate_shot shot = shot_of(easel);
	const struct gz_illustrate_planes planes = { &print->depth, &print->ids };
	assert_int_equal(
		gz_illustrate_raster_draw(raster, &shot, &print->image, &planes, &print->stats),
		GZ_OK);
}

static void draw_rays(struct easel *easel, struct print *print)
{
	const struct gz_illustrate_shot shot = shot_of(easel);
	const struct gz_illustrate_planes planes = { &print->depth, &print->ids };
	struct gz_illustrate_caster *caster = NULL;
	assert_int_equal(gz_illustrate_caster_create(&waiting, NULL, &caster), GZ_OK);
	assert_int_equal(gz_illustrate_caster_show(caster, easel->objects, easel->count), GZ_OK);
	assert_int_equal(
		gz_illustrate_caster_draw(caster, &shot, &print->image, &planes, &print->stats),
		GZ_OK);
	gz_illustrate_caster_destroy(&caster);
}

static int levels_apart(const struct print *a, const struct print *b, int pixel)
{
	return abs(a->image.pixels[4 * pixel] - b->image.pixels[4 * pixel]);
}

/* How two pictures differ. */
struct differences {
	int objects;  /* pixels of different ones */
	int tones;    /* of one object, more than 3 levels apart */
	int depths;   /* of one object, more than 0.05 mm apart */
	int drawn;    /* pixels of objects */
	int contrast; /* between the brightest and the darkest of them */
};

static struct differences compare(const struct print *a, const struct print *b)
{
	struct differences found = { 0 };
	int least = 255, greatest = 0;
	for (int i = 0; i < PIXELS; i++) {
		const uint32_t id = a->ids.words[i];
		const float near = gz_plane_value(&a->depth, i % WIDTH, i / WIDTH);
		const float far = gz_plane_value(&b->depth, i % WIDTH, i / WIDTH);
		assert_int_equal(isfinite(near) != 0, id != 0);
		found.drawn += id != 0;
		found.objects += id != b->ids.words[i];
		if (id != b->ids.words[i])
			continue;
		found.tones += levels_apart(a, b, i) > 3;
		found.depths += id != 0 && fabsf(near - far) > 0.05F;
		if (id != 0 && a->image.pixels[4 * i] < least)
			least = a->image.pixels[4 * i];
		if (id != 0 && a->image.pixels[4 * i] > greatest)
			greatest = a->image.pixels[4 * i];
	}
	found.contrast = greatest - least;
	return found;
}

/* Draw both ways. A few pixels of rims go either way, and lines beside them. */
static struct differences check_same(struct easel *easel, const char *what)
{
	struct print by_triangles = { 0 }, by_rays = { 0 };
	show_all(easel);
	draw_triangles(easel, &by_triangles);
	draw_rays(easel, &by_rays);
	const struct differences found = compare(&by_triangles, &by_rays);
	if (found.objects > PIXELS / 500 || found.tones > PIXELS / 200 ||
	    found.depths > PIXELS / 500 || found.drawn < PIXELS / 20)
		fail_msg("%s: of %d pixels %d have another object; %d tones and %d depths differ",
			 what, found.drawn, found.objects, found.tones, found.depths);
	free_print(&by_triangles);
	free_print(&by_rays);
	return found;
}

static void all_steps_look_as_by_rays_in_both_projections(void **state)
{
	(void)state;
	struct easel easel;
	set_up_easel(&easel);
	add_two_balls(&easel);
	assert_true(check_same(&easel, "two balls").contrast > 100);
	easel.camera.projection = GZ_PROJECTION_ORTHOGRAPHIC;
	assert_true(check_same(&easel, "two balls, orthographic").contrast > 100);
	take_down_easel(&easel);
}

/* So each formula of the shaders is that of the rays. Curvature makes small contrasts. */
static void every_parameter_alone_looks_as_by_rays(void **state)
{
	(void)state;
	struct easel easel;
	set_up_easel(&easel);
	add_two_balls(&easel);
	easel.styles[1].importance = 0.25;
	easel.chosen_id = easel.objects[1].id;
	const struct gz_option *show = NULL;
	for (size_t i = 0; i < gz_illustration_look_option_count; i++)
		if (strcmp(gz_illustration_look_options[i].key, "illustration.show") == 0)
			show = &gz_illustration_look_options[i];
	assert_non_null(show);
	for (int i = GZ_SHOW_PLAIN; show->choices[i]; i++) {
		easel.look.show = i;
		const struct differences found = check_same(&easel, show->choices[i]);
		if (found.contrast < 10)
			fail_msg("%s shows nothing: %d levels", show->choices[i], found.contrast);
	}
	take_down_easel(&easel);
}

static void surface_around_the_eye_looks_as_by_rays(void **state)
{
	(void)state;
	struct easel easel;
	set_up_easel(&easel);
	add_ball(&easel, 16, (double[3]) { 0, 0, 0 });
	memcpy(easel.camera.eye, (double[3]) { 0.05, -0.1, 0.1 }, sizeof easel.camera.eye);
	memcpy(easel.camera.look_at, (double[3]) { 0.1, 1, 0 }, sizeof easel.camera.look_at);
	easel.camera.fov_deg = 70;
	(void)check_same(&easel, "from within");
	take_down_easel(&easel);
}

static void clip_box_cuts_as_it_cuts_rays(void **state)
{
	(void)state;
	struct easel easel;
	set_up_easel(&easel);
	add_two_balls(&easel);
	memcpy(easel.clip.least, (double[3]) { 0.1, 0.4, 0.3 }, sizeof easel.clip.least);
	memcpy(easel.clip.greatest, (double[3]) { 0.6, 1, 0.7 }, sizeof easel.clip.greatest);
	(void)check_same(&easel, "clipped balls");
	take_down_easel(&easel);
}

static void clip_plane_cuts_as_it_cuts_rays(void **state)
{
	(void)state;
	struct easel easel;
	set_up_easel(&easel);
	add_two_balls(&easel);
	easel.clip.plane = true;
	memcpy(easel.clip.normal, (double[3]) { 0.6, -0.7, 0.3 }, sizeof easel.clip.normal);
	easel.clip.offset = 0.45;
	(void)check_same(&easel, "balls cut by a plane");
	take_down_easel(&easel);
}

/* Shells in one another: more layers than show. The third is opaque, or none is. */
static void transparent_shells_blend_as_by_rays(void **state)
{
	(void)state;
	struct easel easel;
	set_up_easel(&easel);
	for (int i = 0; i < 6; i++) {
		add_ball(&easel, 13 - 1.8 * i, (double[3]) { i % 2, 0, -0.5 * i });
		easel.styles[i].transparency = 0.4 + 0.05 * i;
	}
	assert_true(check_same(&easel, "transparent shells").contrast > 20);
	easel.styles[2].transparency = 0;
	assert_true(check_same(&easel, "an opaque shell in transparent ones").contrast > 20);
	take_down_easel(&easel);
}

static void object_with_a_template_of_its_own_looks_as_by_rays(void **state)
{
	(void)state;
	struct gz_shading_template vessels;
	struct easel easel;
	struct print with = { 0 }, without = { 0 };
	int apart = 0;
	set_up_easel(&easel);
	add_two_balls(&easel);
	show_all(&easel);
	draw_triangles(&easel, &without);
	assert_int_equal(gz_shading_template_named("vessels", &vessels), GZ_OK);
	easel.objects[1].shading_template = &vessels;
	(void)check_same(&easel, "template of an object");
	draw_triangles(&easel, &with);
	for (int i = 0; i < PIXELS; i++)
		apart += with.ids.words[i] == easel.objects[1].id &&
			 levels_apart(&with, &without, i) > 3;
	assert_true(apart > 100);
	free_print(&with);
	free_print(&without);
	take_down_easel(&easel);
}

/* Two halves of a ball, of which one shows the other: their common wall belongs to both. */
static void regions_with_a_common_wall_look_as_by_rays(void **state)
{
	(void)state;
	enum { EDGE = 20 };
	struct easel easel;
	struct gz_label_surfaces surfaces;
	struct gz_volume labels = { .dims = { EDGE, EDGE, EDGE },
				    .spacing = { 2, 2, 2 },
				    .type = GZ_VOXEL_U8,
				    .slope = 1 };
	const struct gz_label_look look = { .smoothing = 10, .reach = 0.5 };
	const struct gz_label_request request = { .volume = &labels,
						  .name = "labels",
						  .look = &look };
	set_up_easel(&easel);
	assert_int_equal(gz_volume_allocate(&labels), GZ_OK);
	for (int i = 0; i < EDGE * EDGE * EDGE; i++) {
		const double x = i % EDGE - 9.5, y = i / EDGE % EDGE - 9.5;
		const double z = i / (EDGE * EDGE) - 9.5;
		const bool within = x * x + y * y + z * z < 49;
		((uint8_t *)labels.voxels)[i] = (uint8_t)(within ? 1 + (y + x > 0) : 0);
	}
	gz_volume_find_range(&labels);
	assert_int_equal(gz_label_surfaces_make(&request, NULL, NULL, &surfaces), GZ_OK);
	assert_int_equal(surfaces.count, 2);
	for (int i = 0; i < 2; i++) {
		assert_true(surfaces.items[i].mesh.shared_count > 100);
		easel.objects[i] = (struct gz_object) { .id = 1 + (uint32_t)i,
							.volume = &labels,
							.mesh = &surfaces.items[i].mesh,
							.style = &easel.styles[i] };
	}
	easel.count = 2;
	(void)check_same(&easel, "two regions");
	easel.styles[0].transparency = 0.7;
	(void)check_same(&easel, "a region that shows the other");
	easel.count = 0;
	gz_label_surfaces_free(&surfaces);
	gz_volume_free(&labels);
	take_down_easel(&easel);
}

static double mean_level(const struct print *print)
{
	double sum = 0;
	for (int i = 0; i < PIXELS; i++)
		sum += print->image.pixels[4 * i];
	return sum / PIXELS;
}

/* Single marks come and go with the last bit of a tone, but as many are drawn. */
static void marks_are_as_dark_as_those_of_rays(void **state)
{
	(void)state;
	static const int drawings[] = { GZ_DRAWING_STIPPLES, GZ_DRAWING_HATCHES };
	struct easel easel;
	set_up_easel(&easel);
	add_two_balls(&easel);
	easel.styles[1].transparency = 0.5;
	for (int i = 0; i < 2; i++) {
		struct print by_triangles = { 0 }, by_rays = { 0 };
		int apart = 0;
		easel.look.drawing = drawings[i];
		show_all(&easel);
		draw_triangles(&easel, &by_triangles);
		draw_rays(&easel, &by_rays);
		for (int pixel = 0; pixel < PIXELS; pixel++)
			apart += levels_apart(&by_triangles, &by_rays, pixel) > 64;
		assert_true(mean_level(&by_rays) < 250);
		assert_true(fabs(mean_level(&by_triangles) - mean_level(&by_rays)) < 1);
		assert_in_range(apart, 0, PIXELS / 100);
		free_print(&by_triangles);
		free_print(&by_rays);
	}
	take_down_easel(&easel);
}

/* The solid rectangle of the finest lattice. */
static bool is_in_fovea(const struct gz_plan *plan, int pixel)
{
	struct gz_raster_layer layers[GZ_PLAN_RECTANGLES_MAX];
	const struct gz_raster_layer *finest = &layers[gz_raster_layers_make(plan, layers) - 1];
	const int x = pixel % WIDTH, y = pixel / WIDTH;
	return finest->spacing == 1 && x >= finest->solid[0][0] && x < finest->solid[1][0] &&
	       y >= finest->solid[0][1] && y < finest->solid[1][1];
}

/* Where every pixel has a point, nothing of what is found differs. Tones do a little everywhere,
 * because equalisation and blurred depth see the coarse places. */
static void foveated_picture_is_that_of_rays_at_the_gaze(void **state)
{
	(void)state;
	static const int methods[] = { GZ_METHOD_ACUITY, GZ_METHOD_MDC, GZ_METHOD_MDC3 };
	struct easel easel;
	set_up_easel(&easel);
	add_two_balls(&easel);
	easel.styles[1].transparency = 0.5;
	easel.foveation.acuity_slope = 0.4; /* so that a small picture has coarse places */
	easel.foveation.mdc_square_px = 24;
	easel.foveation.mdc3_square_px = 60;
	show_all(&easel);
	for (size_t i = 0; i < sizeof methods / sizeof methods[0]; i++) {
		struct print foveated = { 0 }, full = { 0 };
		int sharp = 0, found = 0, tones = 0, others = 0;
		easel.foveation.method = GZ_METHOD_STANDARD;
		draw_rays(&easel, &full);
		easel.foveation.method = methods[i];
		draw_triangles(&easel, &foveated);
		assert_in_range(foveated.stats.rays, 1, PIXELS * 2 / 3);
		for (int pixel = 0; pixel < PIXELS; pixel++) {
			const bool same = full.ids.words[pixel] == foveated.ids.words[pixel];
			const bool near = levels_apart(&full, &foveated, pixel) <= 8;
			others += !same || !near;
			if (!is_in_fovea(&easel.plan, pixel))
				continue;
			sharp++;
			found += !same;
			tones += !near;
		}
		if (sharp < 100 || found > sharp / 200 || tones > sharp / 25 || others > PIXELS / 5)
			fail_msg("%s: of %d sharp pixels %d have other objects, %d other tones; of "
				 "all, %d differ",
				 gz_method_names[methods[i]], sharp, found, tones, others);
		free_print(&foveated);
		free_print(&full);
	}
	take_down_easel(&easel);
}

/* A plane in space, which filters and fading keep as it is. */
static float level_at(double x, double y)
{
	return (float)(0.1 + 0.004 * x + 0.003 * y);
}

/* Points of a plane in space; those that are not drawn have another object's. */
static void fill_points(struct gz_illustrate_lattice *lattice)
{
	const struct gz_raster_layer *layer = &lattice->layer;
	for (int row = 0; row < layer->points[1]; row++)
		for (int column = 0; column < layer->points[0]; column++) {
			const bool hidden = column >= layer->hidden[0][0] &&
					    column < layer->hidden[1][0] &&
					    row >= layer->hidden[0][1] && row < layer->hidden[1][1];
			const float level = level_at(layer->from[0] + column * layer->spacing,
						     layer->from[1] + row * layer->spacing);
			float *vector = lattice->vectors[row * layer->points[0] + column];
			vector[GZ_ILLUSTRATE_VECTOR_TONE] = hidden ? 9 : level;
			vector[GZ_ILLUSTRATE_VECTOR_DEPTH] = hidden ? 9 : 2 * level;
			vector[GZ_ILLUSTRATE_VECTOR_OBJECT] = hidden ? 9 : -5;
			vector[GZ_ILLUSTRATE_VECTOR_DISTANCE] = hidden ? 9 : 3 * level;
		}
}

/* 1 in the solid rectangle, 0 beyond the band, and falling between. */
static void check_shares(const struct gz_raster_layer *layer)
{
	const int x = layer->solid[0][0], y = layer->solid[0][1];
	assert_true(gz_raster_layer_share(layer, x, y) == 1);
	assert_true(gz_raster_layer_share(layer, x, y - layer->band - 1) == 0);
	for (int i = 0; i <= layer->band; i++)
		assert_true(gz_raster_layer_share(layer, x - i, y) >
			    gz_raster_layer_share(layer, x - i - 1, y));
}

static void planes_have_what_is_drawn_of_all_lattices(void **state)
{
	(void)state;
	static const int methods[] = { GZ_METHOD_STANDARD, GZ_METHOD_ACUITY, GZ_METHOD_MDC,
				       GZ_METHOD_MDC3 };
	struct gz_illustrate_points points = { 0 };
	struct gz_plane planes[GZ_ILLUSTRATE_FOUND] = { 0 };
	struct gz_workers *workers = NULL;
	struct easel easel;
	set_up_easel(&easel);
	easel.foveation.acuity_slope = 0.4;
	easel.foveation.mdc_square_px = 24;
	easel.foveation.mdc3_square_px = 60;
	assert_int_equal(gz_workers_create(2, &workers), GZ_OK);
	for (int i = 0; i < GZ_ILLUSTRATE_FOUND; i++)
		assert_int_equal(
			gz_plane_resize(&planes[i], gz_illustrate_found_kinds[i], WIDTH, HEIGHT),
			GZ_OK);
	for (size_t i = 0; i < sizeof methods / sizeof methods[0]; i++) {
		easel.foveation.method = methods[i];
		(void)shot_of(&easel);
		assert_int_equal(
			gz_illustrate_points_prepare(&points, &easel.plan, GZ_ILLUSTRATE_FOUND, 2),
			GZ_OK);
		assert_true(points.count > 1 || methods[i] == GZ_METHOD_STANDARD);
		for (int k = 0; k < points.count; k++)
			fill_points(&points.lattices[k]);
		for (int k = 1; k < points.count; k++)
			check_shares(&points.lattices[k].layer);
		gz_illustrate_points_to_planes(&points, workers, planes);
		for (int pixel = 0; pixel < PIXELS; pixel++) {
			const int x = pixel % WIDTH, y = pixel / WIDTH;
			const float level = level_at(x, y);
			assert_int_equal(planes[GZ_ILLUSTRATE_IDS].words[pixel], 5);
			assert_true(fabsf(gz_plane_value(&planes[GZ_ILLUSTRATE_TONE], x, y) -
					  level) < 1e-5F);
			assert_true(fabsf(gz_plane_value(&planes[GZ_ILLUSTRATE_DEPTH], x, y) -
					  2 * level) < 1e-5F);
			assert_true(fabsf(gz_plane_value(&planes[GZ_ILLUSTRATE_DISTANCE], x, y) -
					  3 * level) < 1e-5F);
		}
	}
	for (int i = 0; i < GZ_ILLUSTRATE_FOUND; i++)
		gz_plane_free(&planes[i]);
	gz_illustrate_points_free(&points);
	gz_workers_destroy(&workers);
	take_down_easel(&easel);
}

static void nothing_in_view_is_white(void **state)
{
	(void)state;
	for (int which = 0; which < 2; which++) {
		struct easel easel;
		struct print print = { 0 };
		set_up_easel(&easel);
		add_two_balls(&easel);
		if (which == 0)
			memcpy(easel.camera.look_at, (double[3]) { 0.8, -3.8, 0.6 },
			       sizeof easel.camera.look_at); /* behind the eye */
		else
			easel.clip.greatest[0] = 0.02;
		show_all(&easel);
		draw_triangles(&easel, &print);
		for (int i = 0; i < PIXELS; i++) {
			assert_int_equal(gz_image_words(&print.image)[i], 0xFFFFFFFF);
			assert_int_equal(print.ids.words[i], 0);
			assert_true(isinf(gz_plane_value(&print.depth, i % WIDTH, i / WIDTH)));
		}
		free_print(&print);
		take_down_easel(&easel);
	}
}

static void meshes_are_uploaded_when_they_change_and_no_more(void **state)
{
	(void)state;
	struct easel easel;
	struct print print = { 0 };
	set_up_easel(&easel);
	add_two_balls(&easel);
	show_all(&easel);
	draw_triangles(&easel, &print);
	assert_true(print.stats.prepare_ms > 0);
	easel.styles[1].transparency = 0.5;
	assert_int_equal(gz_illustrate_raster_show(raster, easel.objects, easel.count), GZ_OK);
	draw_triangles(&easel, &print);
	assert_true(print.stats.prepare_ms == 0);
	easel.look.combined.scene_information = GZ_SHOWS_OBJECT_DISTANCE;
	easel.chosen_id = easel.objects[1].id;
	draw_triangles(&easel, &print);
	assert_true(print.stats.prepare_ms > 0); /* distances are new */
	assert_int_equal(gz_illustrate_raster_show(raster, easel.objects, 1), GZ_OK);
	draw_triangles(&easel, &print);
	assert_true(print.stats.prepare_ms > 0);
	free_print(&print);
	take_down_easel(&easel);
}

static void what_the_device_cannot_hold_is_refused_with_one_line(void **state)
{
	(void)state;
	const struct gz_backend_params params = { .gl_memory_bytes = 1000 };
	struct captured_log captured;
	struct gz_illustrate_raster *own = NULL;
	struct gz_image image = { 0 };
	struct easel easel;
	set_up_easel(&easel);
	add_ball(&easel, 10, (double[3]) { 0, 0, 0 });
	const struct gz_illustrate_shot shot = shot_of(&easel);
	captured_log_init(&captured, "*:warn");
	assert_int_equal(gz_illustrate_raster_create(&params, &captured.log, &own), GZ_OK);
	assert_int_equal(gz_illustrate_raster_draw(own, &shot, &image, NULL, NULL),
			 GZ_ERR_INVAL); /* shows nothing */
	assert_int_equal(gz_illustrate_raster_show(own, easel.objects, 1), GZ_OK);
	assert_int_equal(gz_illustrate_raster_draw(own, &shot, &image, NULL, NULL), GZ_ERR_NO_MEM);
	assert_int_equal(captured.messages, 1);
	assert_non_null(strstr(captured.last, "--backend cpu"));
	gz_illustrate_raster_destroy(&own);
	gz_image_free(&image);
	take_down_easel(&easel);
}

/* As in a window: the picture stays on the device, and what the window draws next is not upset. */
static void picture_left_in_a_lent_context_equals_the_one_read_back(void **state)
{
	(void)state;
	struct lent_context lent = lend_context();
	const struct gz_backend_params params = { .gl_context = &lent.base };
	struct gz_ray_params rays = gz_ray_params_default();
	struct gz_drawer *drawer = NULL;
	struct gz_image image = { 0 };
	static uint8_t pixels[4 * PIXELS];
	struct easel easel;
	GLint viewport[4];
	set_up_easel(&easel);
	add_two_balls(&easel);
	easel.styles[1].transparency = 0.5;
	rays.clip.least[0] = 0.4;
	rays.illustration = easel.look;
	const struct gz_illustrate_shot illustrated = shot_of(&easel);
	const struct gz_shot shot = { .camera = illustrated.camera,
				      .settings = &rays,
				      .plan = illustrated.plan };
	assert_int_equal(gz_illustrate_technique.create("gl", &params, NULL, &drawer), GZ_OK);
	assert_string_equal(drawer->ops->backend(drawer), "gl");
	assert_int_equal(drawer->ops->show(drawer, easel.objects, easel.count), GZ_OK);
	assert_int_equal(drawer->ops->draw(drawer, &shot, &image, NULL), GZ_OK);
	assert_int_equal(lent.egl->ops->make_current(lent.egl), GZ_OK);
	glViewport(1, 2, 3, 4);
	assert_true(drawer->ops->keeps_on_device(drawer, &shot));
	assert_int_equal(drawer->ops->draw(drawer, &shot, NULL, NULL), GZ_OK);
	assert_int_equal(lent.egl->ops->make_current(lent.egl), GZ_OK);
	glGetIntegerv(GL_VIEWPORT, viewport);
	assert_true(viewport[0] == 1 && viewport[1] == 2 && viewport[2] == 3 && viewport[3] == 4);
	assert_false(glIsEnabled(GL_BLEND) || glIsEnabled(GL_DEPTH_TEST) ||
		     glIsEnabled(GL_SCISSOR_TEST) || glIsEnabled(GL_CLIP_DISTANCE0));
	glBindTexture(GL_TEXTURE_2D, drawer->ops->picture_texture(drawer));
	glGetTexImage(GL_TEXTURE_2D, 0, GL_RGBA, GL_UNSIGNED_BYTE, pixels);
	assert_int_equal(glGetError(), GL_NO_ERROR);
	lent.egl->ops->release(lent.egl);
	assert_memory_equal(pixels, image.pixels, sizeof pixels);
	lent.lost = true;
	assert_int_equal(drawer->ops->draw(drawer, &shot, &image, NULL), GZ_ERR_NO_DEVICE);
	gz_drawer_destroy(&drawer);
	gz_gl_context_destroy(&lent.egl);
	gz_image_free(&image);
	take_down_easel(&easel);
}

static void shaders_of_illustrations_are_valid_for_the_reference_compiler(void **state)
{
	(void)state;
	shader_check_needs_validator();
	struct gz_gl_shader shaders[2];
	gz_illustrate_shaders(shaders);
	shader_check(&shaders[0]);
	shader_check(&shaders[1]);
}

TEST_SUITE(illustrate_raster)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(all_steps_look_as_by_rays_in_both_projections),
		cmocka_unit_test(every_parameter_alone_looks_as_by_rays),
		cmocka_unit_test(surface_around_the_eye_looks_as_by_rays),
		cmocka_unit_test(clip_box_cuts_as_it_cuts_rays),
		cmocka_unit_test(clip_plane_cuts_as_it_cuts_rays),
		cmocka_unit_test(transparent_shells_blend_as_by_rays),
		cmocka_unit_test(object_with_a_template_of_its_own_looks_as_by_rays),
		cmocka_unit_test(regions_with_a_common_wall_look_as_by_rays),
		cmocka_unit_test(marks_are_as_dark_as_those_of_rays),
		cmocka_unit_test(foveated_picture_is_that_of_rays_at_the_gaze),
		cmocka_unit_test(planes_have_what_is_drawn_of_all_lattices),
		cmocka_unit_test(nothing_in_view_is_white),
		cmocka_unit_test(meshes_are_uploaded_when_they_change_and_no_more),
		cmocka_unit_test(what_the_device_cannot_hold_is_refused_with_one_line),
		cmocka_unit_test(picture_left_in_a_lent_context_equals_the_one_read_back),
		cmocka_unit_test(shaders_of_illustrations_are_valid_for_the_reference_compiler),
	};
	if (gz_illustrate_raster_create(&waiting, NULL, &raster) != GZ_OK)
		return 77;
	const int failed = cmocka_run_group_tests(tests, NULL, NULL);
	gz_illustrate_raster_destroy(&raster);
	return failed;
}
