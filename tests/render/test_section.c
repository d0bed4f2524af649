/* Sections of a volume, and distances in it, against what is known of them exactly. */
#include "suite.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "render/data/brick_value.h"
#include "render/data/format.h"
#include "render/data/voxel_colour.h"
#include "render/section/distances.h"
#include "render/section/section.h"
#include "volume_files.h"

enum { X = 5, Y = 4, Z = 3 };

/* Values 10 x + 100 y + 1000 z, of anisotropic voxels. */
static void make_ramp(struct gz_volume *volume, enum gz_voxel_type type)
{
	*volume = (struct gz_volume) {
		.dims = { X, Y, Z },
		.spacing = { 0.5, 1, 3 },
		.type = type,
		.slope = 2,
		.intercept = -7,
		.stored_min = 0,
		.stored_max = 2340,
	};
	volume->voxels = calloc(X * Y * Z, gz_voxel_size(type));
	assert_non_null(volume->voxels);
	for (int i = 0; i < X * Y * Z; i++) {
		const int value = 10 * (i % X) + 100 * (i / X % Y) + 1000 * (i / X / Y);
		if (type == GZ_VOXEL_U16)
			((uint16_t *)volume->voxels)[i] = (uint16_t)value;
		else
			((float *)volume->voxels)[i] = (float)value;
	}
}

/* The data value of the ramp at fractional voxels. */
static double ramp(double x, double y, double z)
{
	return 2 * (10 * x + 100 * y + 1000 * z) - 7;
}

static void values_are_exact_at_the_centres_of_voxels(void **state)
{
	(void)state;
	for (int type = GZ_VOXEL_U16; type <= GZ_VOXEL_F32; type++) {
		struct gz_volume volume;
		make_ramp(&volume, (enum gz_voxel_type)type);
		for (int i = 0; i < X * Y * Z; i++) {
			const int at[3] = { i % X, i / X % Y, i / X / Y };
			const double place[3] = { (at[0] + 0.5) / X, (at[1] + 0.5) / Y,
						  (at[2] + 0.5) / Z };
			int voxel[3];
			gz_section_voxel(&volume, place, voxel);
			assert_memory_equal(voxel, at, sizeof voxel);
			assert_true(gz_section_value(&volume, place) == ramp(at[0], at[1], at[2]));
		}
		free(volume.voxels);
	}
}

static double between(double least, double value, double greatest)
{
	return fmin(greatest, fmax(least, value));
}

/* A section of the ramp at twice its resolution, with a grey for each value. */
static void check_section(const struct gz_volume *volume, enum gz_section_plane plane)
{
	const struct gz_section_axes axes = gz_section_axes_of(plane, volume->oriented);
	const struct gz_section_request request = {
		.volume = volume,
		.plane = plane,
		.place = { 0.3, 0.4, 0.6 },
		.level = ramp(2, 1.5, 1),
		.width = ramp(4, 3, 2) - ramp(0, 0, 0),
	};
	struct gz_image image = { 0 };
	const int width = 2 * volume->dims[axes.across], height = 2 * volume->dims[axes.upward];
	assert_int_equal(gz_section_draw(&request, width, height, &image), GZ_OK);
	for (int i = 0; i < width * height; i++) {
		const double point[2] = { (i % width + 0.5) / width, (i / width + 0.5) / height };
		double place[3], at[3];
		memcpy(place, request.place, sizeof place);
		gz_section_place(axes, point, place);
		for (int axis = 0; axis < 3; axis++)
			at[axis] = between(0, place[axis] * volume->dims[axis] - 0.5,
					   volume->dims[axis] - 1);
		const double grey = (ramp(at[0], at[1], at[2]) - request.level) / request.width;
		assert_in_range(image.pixels[4 * i] + 256,
				lround(255 * between(0, grey + 0.5, 1)) + 255,
				lround(255 * between(0, grey + 0.5, 1)) + 257);
		assert_int_equal(image.pixels[4 * i + 1], image.pixels[4 * i]);
		assert_int_equal(image.pixels[4 * i + 3], 255);
	}
	gz_image_free(&image);
}

static void sections_show_the_values_of_their_plane(void **state)
{
	(void)state;
	struct gz_volume volume;
	make_ramp(&volume, GZ_VOXEL_F32);
	for (int oriented = 0; oriented < 2; oriented++)
		for (int plane = 0; plane < GZ_SECTION_COUNT; plane++) {
			volume.oriented = oriented;
			check_section(&volume, (enum gz_section_plane)plane);
		}
	free(volume.voxels);
}

/* The patient's right is on the left, front and head are on top; the face looks to the left. */
static void oriented_sections_lie_as_radiologists_have_them(void **state)
{
	(void)state;
	double place[3] = { 0.5, 0.5, 0.5 };
	const double corner[2] = { 0.1, 0.2 };
	gz_section_place(gz_section_axes_of(GZ_SECTION_AXIAL, true), corner, place);
	assert_true(fabs(place[0] - 0.9) < 1e-12 && fabs(place[1] - 0.8) < 1e-12);
	gz_section_place(gz_section_axes_of(GZ_SECTION_SAGITTAL, true), corner, place);
	assert_true(fabs(place[1] - 0.9) < 1e-12 && fabs(place[2] - 0.8) < 1e-12);
	gz_section_place(gz_section_axes_of(GZ_SECTION_CORONAL, false), corner, place);
	assert_true(fabs(place[0] - 0.1) < 1e-12 && fabs(place[2] - 0.8) < 1e-12);
	for (int plane = 0; plane < GZ_SECTION_COUNT; plane++) {
		const struct gz_section_axes axes =
			gz_section_axes_of((enum gz_section_plane)plane, true);
		double point[2];
		gz_section_place(axes, corner, place);
		gz_section_point(axes, place, point);
		assert_true(fabs(point[0] - 0.1) < 1e-12 && fabs(point[1] - 0.2) < 1e-12);
	}
}

static void millimetres_are_square(void **state)
{
	(void)state;
	struct gz_volume volume;
	double size[2];
	make_ramp(&volume, GZ_VOXEL_U16); /* 2.5 x 4 x 9 mm */
	gz_section_fit(&volume, GZ_SECTION_CORONAL, (const double[]) { 100, 90 }, size);
	assert_true(fabs(size[0] - 25) < 1e-9 && fabs(size[1] - 90) < 1e-9);
	gz_section_fit(&volume, GZ_SECTION_SAGITTAL, (const double[]) { 20, 90 }, size);
	assert_true(fabs(size[0] - 20) < 1e-9 && fabs(size[1] - 45) < 1e-9);
	free(volume.voxels);
}

static void labels_and_colours_are_not_mixed(void **state)
{
	(void)state;
	struct gz_volume volume;
	struct gz_image image = { 0 };
	make_ramp(&volume, GZ_VOXEL_U16);
	volume.labels = true;
	const struct gz_section_request request = { .volume = &volume,
						    .plane = GZ_SECTION_AXIAL,
						    .place = { 0.5, 0.5, 0.5 },
						    .level = ramp(2, 1, 1) + 1,
						    .width = 1e-3 };
	assert_int_equal(gz_section_draw(&request, 5 * X, 4 * Y, &image), GZ_OK);
	for (int i = 0; i < 5 * X * 4 * Y; i++) {
		const int x = i % (5 * X) / 5, y = Y - 1 - i / (5 * X) / 4;
		assert_int_equal(image.pixels[4 * i], ramp(x, y, 1) > request.level ? 255 : 0);
	}
	uint32_t colours[X * Y * Z];
	for (int i = 0; i < X * Y * Z; i++)
		colours[i] = (uint32_t)i * 197 + 11;
	volume.labels = false;
	volume.colours = colours;
	assert_int_equal(gz_section_draw(&request, X, Y, &image), GZ_OK);
	for (int i = 0; i < X * Y; i++) {
		const uint32_t colour = colours[X * Y + (Y - 1 - i / X) * X + i % X];
		for (int channel = 0; channel < 3; channel++)
			assert_int_equal(image.pixels[4 * i + channel],
					 gz_colour_byte(colour, channel));
	}
	gz_image_free(&image);
	free(volume.voxels);
}

static void steps_go_from_voxel_to_voxel_and_stay_inside(void **state)
{
	(void)state;
	struct gz_volume volume;
	double place[3] = { 0.1, 0.9, 0.99 };
	make_ramp(&volume, GZ_VOXEL_U16);
	gz_section_step(&volume, 2, 1, place);
	assert_true(fabs(place[2] - 2.5 / 3) < 1e-12);
	gz_section_step(&volume, 2, -1, place);
	assert_true(fabs(place[2] - 1.5 / 3) < 1e-12);
	gz_section_step(&volume, 0, -9, place);
	assert_true(fabs(place[0] - 0.1) < 1e-12 && place[1] == 0.9);
	free(volume.voxels);
}

static void distances_are_in_millimetres(void **state)
{
	(void)state;
	struct gz_volume volume;
	struct gz_distances read;
	char text[GZ_DISTANCES_SIZE];
	make_ramp(&volume, GZ_VOXEL_U16);
	assert_true(gz_distances_parse("0 0 0 1 1 1 0.25 0.5 0.75  0.25 0.75 0.75 ", &read));
	assert_int_equal(read.count, 2);
	assert_true(fabs(gz_distance_length(&volume, &read.lines[0]) -
			 sqrt(2.5 * 2.5 + 4 * 4 + 9 * 9)) < 1e-12);
	assert_true(fabs(gz_distance_length(&volume, &read.lines[1]) - 1) < 1e-12);
	gz_distances_print(&read, text);
	assert_string_equal(text, "0 0 0 1 1 1 0.25 0.5 0.75 0.25 0.75 0.75");
	static const char *const wrong[] = { "1", "0 0 0 1 1 1.5", "0 0 0 1 1 nan", "0 0 0 1 1 x",
					     "0 0 0 1 1 1,0 0 0 1 1 1" };
	for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++)
		assert_false(gz_distances_parse(wrong[i], &read));
	assert_int_equal(read.count, 2);
	assert_true(gz_distances_parse("", &read));
	assert_int_equal(read.count, 0);
	free(volume.voxels);
}

/* As many lines as there may be, with numbers as long as they get. */
static void all_distances_fit_their_text(void **state)
{
	(void)state;
	struct gz_distances many = { .count = GZ_DISTANCES_MAX }, read;
	char text[GZ_DISTANCES_SIZE];
	for (int i = 0; i < GZ_DISTANCES_MAX; i++)
		for (int n = 0; n < 6; n++)
			many.lines[i].ends[n / 3][n % 3] = 1.23456789e-5;
	gz_distances_print(&many, text);
	assert_true(gz_distances_parse(text, &read));
	assert_int_equal(read.count, GZ_DISTANCES_MAX);
	assert_true(fabs(read.lines[7].ends[1][2] - 1.23457e-5) < 1e-15);
}

static void a_ray_ends_where_it_becomes_opaque(void **state)
{
	(void)state;
	struct gz_volume volume;
	double place[3];
	make_ramp(&volume, GZ_VOXEL_F32); /* 9 mm are one unit of the world */
	const struct gz_transfer upper = {
		.count = 2,
		.points = { { .value = 0.5, .opacity = 0 }, { .value = 0.5, .opacity = 1 } },
		.has_range = true,
		.range = { ramp(0, 0, 0), 2 * ramp(2, 1.5, 1) - ramp(0, 0, 0) },
	};
	/* Upwards through the middle of x and y: the values pass the step at z = 1. */
	assert_true(gz_section_hit(&volume, &upper, (const double[]) { 0, 0, -2 },
				   (const double[]) { 0, 0, 1 }, place));
	assert_true(fabs(place[0] - 0.5) < 1e-9 && fabs(place[1] - 0.5) < 1e-9);
	assert_true(place[2] > 0.5 - 1e-9 && place[2] < 0.5 + 0.25 / 9);
	assert_false(gz_section_hit(&volume, &upper, (const double[]) { 1, 0, -2 },
				    (const double[]) { 0, 0, 1 }, place));
	assert_false(gz_section_hit(&volume, &upper, (const double[]) { 0, 0, -2 },
				    (const double[]) { 0, 0, -1 }, place));
	free(volume.voxels);
}

/* A column along z of the given voxels, in a box of 5 x 5 times so many. */
static void make_column(struct gz_volume *volume, const float *values, int count)
{
	*volume = (struct gz_volume) { .dims = { 5, 5, count },
				       .spacing = { 1, 1, 1 },
				       .type = GZ_VOXEL_F32,
				       .slope = 1,
				       .stored_max = 10 };
	float *voxels = calloc((size_t)25 * (size_t)count, sizeof *voxels);
	assert_non_null(voxels);
	for (int i = 0; i < 25 * count; i++)
		voxels[i] = values[i / 25];
	volume->voxels = voxels;
}

static bool look_up_z(const struct gz_volume *volume, const struct gz_transfer *transfer,
		      double until, struct gz_section_seen *seen)
{
	const struct gz_section_ray ray = {
		{ 0, 0, -2 }, { 0, 0, 1 }, until, { .greatest = { 1, 1, 1 } }
	};
	return gz_section_look(volume, transfer, &ray, seen);
}

static void a_look_finds_the_value_that_is_seen(void **state)
{
	(void)state;
	/* Skin of 3, a gap, bone of 8. */
	static const float values[20] = {
		0, 0, 3, 3, 0, 0, 0, 0, 0, 0, 8, 8, 8, 8, 8, 8, 8, 8, 8, 8
	};
	struct gz_volume volume;
	struct gz_section_seen seen;
	struct gz_transfer transfer = {
		.count = 4,
		.points = { { .value = 0.1, .opacity = 0 },
			    { .value = 0.3, .opacity = 0.1 },
			    { .value = 0.5, .opacity = 0.1 },
			    { .value = 0.8, .opacity = 0.9 } },
	};
	make_column(&volume, values, 20);
	/* Bone is seen through thin skin, and its own value, not one on the way to it. */
	assert_true(look_up_z(&volume, &transfer, INFINITY, &seen));
	assert_float_equal(seen.value, 0.8, 1e-6);
	assert_true(seen.opacity > 0.99 && fabs(seen.unit - 0.1) < 1e-12);
	assert_true(seen.depth > 2 && seen.depth < 2 + 2.0 / 20);
	/* Up to something in front of it only the skin, of which less than half hides it. */
	assert_true(look_up_z(&volume, &transfer, 1.8, &seen));
	assert_float_equal(seen.value, 0.3, 1e-6);
	assert_true(seen.opacity > 0.15 && seen.opacity < 0.4);
	transfer.points[1].opacity = transfer.points[2].opacity = 0.9;
	assert_true(look_up_z(&volume, &transfer, INFINITY, &seen));
	assert_float_equal(seen.value, 0.3, 1e-6);
	/* Nothing but air, too little of anything, or a box of which nothing is shown there. */
	assert_false(look_up_z(&volume, &transfer, 1.55, &seen));
	for (int i = 0; i < 4; i++)
		transfer.points[i].opacity *= 0.003;
	assert_false(look_up_z(&volume, &transfer, INFINITY, &seen));
	free(volume.voxels);
}

static void a_look_sees_what_the_clip_box_leaves(void **state)
{
	(void)state;
	static const float values[4] = { 3, 3, 8, 8 };
	const struct gz_transfer solid = {
		.count = 2,
		.points = { { .value = 0.1, .opacity = 0 }, { .value = 0.1, .opacity = 1 } },
	};
	struct gz_section_ray ray = { { 0, 0, -2 }, { 0, 0, 1 }, INFINITY, gz_clip_whole };
	struct gz_volume volume;
	struct gz_section_seen seen;
	make_column(&volume, values, 4);
	assert_true(gz_section_look(&volume, &solid, &ray, &seen));
	assert_float_equal(seen.value, 0.3, 1e-6);
	ray.clip.least[2] = 0.7;
	assert_true(gz_section_look(&volume, &solid, &ray, &seen));
	assert_float_equal(seen.value, 0.8, 1e-6);
	ray.clip.least[0] = 0.6;
	assert_false(gz_section_look(&volume, &solid, &ray, &seen));
	/* The clip plane leaves the upper part. */
	ray.clip = gz_clip_whole;
	ray.clip.plane = true;
	memcpy(ray.clip.normal, (double[3]) { 0.1, 0, -1 }, sizeof ray.clip.normal);
	ray.clip.offset = 0.3;
	assert_true(gz_section_look(&volume, &solid, &ray, &seen));
	assert_float_equal(seen.value, 0.8, 1e-6);
	ray.clip.offset = 0;
	assert_false(gz_section_look(&volume, &solid, &ray, &seen));
	/* Labels are not mixed. */
	ray.clip = gz_clip_whole;
	ray.clip.least[2] = 0.49;
	volume.labels = true;
	assert_true(gz_section_look(&volume, &solid, &ray, &seen));
	assert_true(seen.value == 0.3 || seen.value == 0.8);
	free(volume.voxels);
}

/* A volume of noise, and the same in a file of bricks. No edge is a multiple of a brick's. */
static void make_noise_and_bricks(struct gz_volume *volume, struct gz_volume *bricks)
{
	*volume = (struct gz_volume) { .dims = { 70, 45, 101 },
				       .spacing = { 1, 1, 1.2 },
				       .type = GZ_VOXEL_U8,
				       .slope = 2,
				       .intercept = -7 };
	assert_int_equal(gz_volume_allocate(volume), GZ_OK);
	uint32_t random = 1;
	for (size_t i = 0; i < gz_volume_voxel_count(volume); i++) {
		random = random * 1664525 + 1013904223;
		((uint8_t *)volume->voxels)[i] = (uint8_t)(random >> 24);
	}
	gz_volume_find_range(volume);
	assert_int_equal(gz_bricks_write(volume, files_path("noise.gzb"), NULL, NULL), GZ_OK);
	assert_int_equal(gz_volume_load(files_path("noise.gzb"), NULL, NULL, NULL, bricks), GZ_OK);
}

/* Bring the bricks of all levels into memory. */
static void read_all_bricks(const struct gz_volume *volume)
{
	struct gz_brick_want wants[64];
	struct gz_brick_view view;
	const size_t count = gz_brick_pool_file(volume->bricks)->layout.brick_count;
	assert_in_range(count, 2, 64);
	for (uint32_t i = 0; i < count; i++)
		wants[i] = (struct gz_brick_want) { 1, i };
	gz_brick_pool_turn(volume->bricks, wants, count, true, &view);
	assert_int_equal(view.coming, 0);
}

static void looks_into_bricks_see_what_looks_into_memory_see(void **state)
{
	(void)state;
	struct gz_volume volume, bricks;
	const struct gz_transfer transfer = {
		.count = 2,
		.points = { { .value = 0, .opacity = 0 }, { .value = 1, .opacity = 0.1 } },
	};
	struct gz_section_ray ray = { .until = INFINITY, .clip = gz_clip_whole };
	int seen_count = 0;
	make_noise_and_bricks(&volume, &bricks);
	read_all_bricks(&bricks);
	for (int i = 0; i < 200; i++) {
		struct gz_section_seen seen[2];
		const double turn = i * 0.7, height = i / 100.0 - 1;
		memcpy(ray.origin, (double[]) { 2 * cos(turn), 2 * sin(turn), height },
		       sizeof ray.origin);
		for (int axis = 0; axis < 3; axis++)
			ray.direction[axis] = 0.1 * sin(i + axis) - ray.origin[axis];
		bricks.labels = volume.labels = i % 2; /* nearest voxels */
		const bool sees = gz_section_look(&volume, &transfer, &ray, &seen[0]);
		assert_int_equal(gz_section_look(&bricks, &transfer, &ray, &seen[1]), sees);
		if (!sees)
			continue;
		assert_float_equal(seen[0].value, seen[1].value, 1e-9);
		assert_float_equal(seen[0].depth, seen[1].depth, 1e-12);
		assert_float_equal(seen[0].opacity, seen[1].opacity, 1e-9);
		seen_count++;
	}
	assert_true(seen_count > 150);
	gz_volume_free(&volume);
	gz_volume_free(&bricks);
}

static void values_of_bricks_come_from_coarser_ones_until_they_are_there(void **state)
{
	(void)state;
	struct gz_volume volume, bricks;
	const double corner[3] = { 0, 0, 0 }, end[3] = { 1, 1, 1 }, middle[3] = { 0.5, 0.5, 0.5 };
	make_noise_and_bricks(&volume, &bricks);
	/* Coarse voxels of noise lie near its mean. */
	assert_float_equal(gz_brick_value(bricks.bricks, middle, false), 127, 40);
	read_all_bricks(&bricks);
	const uint8_t *voxels = volume.voxels;
	assert_true(gz_brick_value(bricks.bricks, corner, false) == voxels[0]);
	assert_true(gz_brick_value(bricks.bricks, corner, true) == voxels[0]);
	assert_true(gz_brick_value(bricks.bricks, end, false) ==
		    voxels[gz_volume_voxel_count(&volume) - 1]);
	assert_true(gz_brick_value(bricks.bricks, end, true) ==
		    voxels[gz_volume_voxel_count(&volume) - 1]);
	gz_volume_free(&volume);
	gz_volume_free(&bricks);
}

TEST_SUITE(section)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(values_are_exact_at_the_centres_of_voxels),
		cmocka_unit_test(sections_show_the_values_of_their_plane),
		cmocka_unit_test(oriented_sections_lie_as_radiologists_have_them),
		cmocka_unit_test(millimetres_are_square),
		cmocka_unit_test(labels_and_colours_are_not_mixed),
		cmocka_unit_test(steps_go_from_voxel_to_voxel_and_stay_inside),
		cmocka_unit_test(distances_are_in_millimetres),
		cmocka_unit_test(all_distances_fit_their_text),
		cmocka_unit_test(a_ray_ends_where_it_becomes_opaque),
		cmocka_unit_test(a_look_finds_the_value_that_is_seen),
		cmocka_unit_test(a_look_sees_what_the_clip_box_leaves),
		cmocka_unit_test(looks_into_bricks_see_what_looks_into_memory_see),
		cmocka_unit_test(values_of_bricks_come_from_coarser_ones_until_they_are_there),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
